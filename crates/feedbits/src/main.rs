//! `feedbits`: how many bits does your feed need?

mod check;
mod compare;
mod convert;
mod formats;
mod input;
mod interpolate;
mod merge;
mod output;
mod plan;
mod progress;
mod report;
mod servo;
mod size;
mod smooth;
mod sweep;
mod targets;

use std::process::ExitCode;

use clap::{Parser, Subcommand};

/// How many bits does your feed need?
///
/// Runs a NURBS part program with a machine's limits in many number formats, through the same planner and the same
/// real-time interpolator, and says which format is the cheapest that is good enough. Without arguments it compares the
/// built-in example and writes a report into feedbits-report/.
#[derive(Parser)]
#[command(
    version,
    about,
    after_help = "Exit status: 0 good, 1 a stated requirement is not met, 2 bad input or usage."
)]
struct Arguments {
    /// Print nothing but results, warnings and errors: no progress, no notes.
    #[arg(long, short, global = true)]
    quiet: bool,
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
    /// Compare over interpolation periods, feeds and part sizes: where does a format stay good?
    Sweep(sweep::Arguments),
    /// Join the files of a sweep's shards.
    Merge(merge::Arguments),
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
    let arguments = Arguments::parse();
    if arguments.quiet {
        output::be_quiet();
    }
    let by_default = || Arguments::parse_from(["feedbits", "compare", "--report", report::FOLDER]).command;
    let Some(command) = arguments.command.or_else(by_default) else {
        return ExitCode::from(2);
    };
    let ending = match command {
        Command::Compare(arguments) => compare::run(&arguments),
        Command::Interpolate(arguments) => interpolate::run(&arguments),
        Command::Plan(arguments) => plan::run(&arguments),
        Command::Size(arguments) => size::run(&arguments),
        Command::Sweep(arguments) => sweep::run(&arguments),
        Command::Merge(arguments) => merge::run(&arguments),
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
