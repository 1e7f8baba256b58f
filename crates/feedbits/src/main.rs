//! `feedbits`: how many bits does your feed need?

mod check;
mod compare;
mod convert;
mod formats;
mod input;
mod interpolate;
mod output;
mod plan;
mod servo;
mod size;
mod smooth;
mod targets;

use std::process::ExitCode;

use clap::{Parser, Subcommand};

/// How many bits does your feed need?
///
/// Runs a NURBS part program with a machine's limits in many number formats, through the same planner and the same
/// real-time interpolator, and says which format is the cheapest that is good enough. Without arguments it compares the
/// built-in example.
#[derive(Parser)]
#[command(
    version,
    about,
    after_help = "Exit status: 0 good, 1 a stated requirement is not met, 2 bad input or usage."
)]
struct Arguments {
    #[command(subcommand)]
    command: Option<Command>,
}

#[derive(Subcommand)]
enum Command {
    /// Compare number formats: fluctuation, overflow, chord error, verdict, recommendation.
    Compare(compare::Arguments),
    /// Interpolate in one format and write a setpoint a period.
    Interpolate(interpolate::Arguments),
    /// Plan the feed and print the stages, or write them sampled.
    Plan(plan::Arguments),
    /// Find the fewest bits that are enough.
    Size(size::Arguments),
    /// Simulate the axis servo loops: following and contour error per format, circle test, tuning table.
    Servo(servo::Arguments),
    /// Smooth the corners of straight moves and arcs within a tolerance: corner by corner, and the time it saves.
    Smooth(smooth::Arguments),
    /// List the targets that a period is priced on, with every number's source.
    Targets(targets::Arguments),
    /// Say what a part holds, its joints and bends, and what in it is suspicious.
    Check(check::Arguments),
    /// Write a part in another dialect, as straight moves within a tolerance, or as a curve file.
    Convert(convert::Arguments),
    /// List the number formats.
    Formats(formats::Arguments),
}

/// How a command that did not fail ended.
#[derive(Clone, Copy, PartialEq, Eq)]
enum Ending {
    Good,
    RequirementNotMet,
}

fn main() -> ExitCode {
    let by_default = || Arguments::parse_from(["feedbits", "compare"]).command;
    let Some(command) = Arguments::parse().command.or_else(by_default) else {
        return ExitCode::from(2);
    };
    let ending = match command {
        Command::Compare(arguments) => compare::run(&arguments),
        Command::Interpolate(arguments) => interpolate::run(&arguments),
        Command::Plan(arguments) => plan::run(&arguments),
        Command::Size(arguments) => size::run(&arguments),
        Command::Servo(arguments) => servo::run(&arguments),
        Command::Smooth(arguments) => smooth::run(&arguments),
        Command::Targets(arguments) => targets::run(&arguments),
        Command::Check(arguments) => check::run(&arguments),
        Command::Convert(arguments) => convert::run(&arguments),
        Command::Formats(arguments) => formats::run(&arguments),
    };
    match ending {
        Ok(Ending::Good) => ExitCode::SUCCESS,
        Ok(Ending::RequirementNotMet) => ExitCode::from(1),
        Err(error) => {
            eprintln!("feedbits: {error:#}");
            ExitCode::from(2)
        }
    }
}
