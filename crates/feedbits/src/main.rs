//! `feedbits`: how many bits does your feed need?

mod answer;
mod baseline;
mod bounds;
mod candidates;
mod check;
mod claims;
mod compare;
mod compile;
mod completions;
mod convert;
mod ending;
mod examples;
mod files;
mod fingerprint;
mod formats;
#[cfg(test)]
mod frozen;
mod input;
mod interpolate;
mod interrupt;
mod judge;
mod machine;
mod machine_from;
mod merge;
mod numbers;
mod output;
mod papers;
mod period_costs;
mod places;
mod plan;
mod presets;
mod progress;
mod report;
mod resumed_file;
mod run_arguments;
mod screen;
mod servo;
mod set;
mod shard;
mod size;
mod smooth;
mod sweep;
mod sweep_file;
mod targets;
mod unfinished;
mod zoo;

use std::process::ExitCode;

use clap::{CommandFactory, FromArgMatches, Parser, Subcommand};

/// How many bits does your feed need?
///
/// Runs a NURBS part program with a machine's limits in many number formats, through the same planner and the same
/// real-time interpolator, and says which format is the cheapest that is good enough. Without arguments it compares the
/// built-in example and writes a report into feedbits-report/.
#[derive(Parser)]
#[command(
    version,
    about,
    after_help = "Exit status: 0 good; 1 a stated requirement is not met, or `check` found something suspicious; 2 bad input or \
                  usage; 3 worse than the baseline; 4 parts of a set cannot be read or run; 130 ended by Ctrl-C."
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
    #[command(after_help = examples::COMPARE)]
    Compare(compare::Arguments),
    /// Interpolate in one format and write a setpoint a period.
    #[command(after_help = examples::INTERPOLATE)]
    Interpolate(interpolate::Arguments),
    /// Compile part and plan in one format for a controller: as constants that its firmware includes, or as a file that it reads.
    #[command(after_help = examples::COMPILE)]
    Compile(compile::Arguments),
    /// Plan the feed and print the stages, or write them sampled.
    #[command(after_help = examples::PLAN)]
    Plan(plan::Arguments),
    /// Find the fewest bits that are enough.
    #[command(after_help = examples::SIZE)]
    Size(size::Arguments),
    /// Compare over interpolation periods, feeds and part sizes: where does a format stay good?
    #[command(after_help = examples::SWEEP)]
    Sweep(sweep::Arguments),
    /// Join the files of shards, of a sweep or of a set of parts.
    #[command(after_help = examples::MERGE)]
    Merge(merge::Arguments),
    /// Simulate the axis servo loops: following and contour error per format, circle test, tuning table.
    #[command(after_help = examples::SERVO)]
    Servo(servo::Arguments),
    /// Print every figure of papers A to D beside the one that comes out here, with the setting and why they differ.
    #[command(after_help = examples::PAPERS)]
    Papers(papers::Arguments),
    /// Smooth the corners of straight moves and arcs within a tolerance: corner by corner, and the time it saves.
    #[command(after_help = examples::SMOOTH)]
    Smooth(smooth::Arguments),
    /// List the targets that a period is priced on, with every number's source.
    #[command(after_help = examples::TARGETS)]
    Targets(targets::Arguments),
    /// Say what a part holds, its joints and bends, and what in it is suspicious.
    #[command(after_help = examples::CHECK)]
    Check(check::Arguments),
    /// Judge what a controller really did, by a log of its setpoints: which limits does it keep, and are rows missing?
    #[command(after_help = examples::JUDGE)]
    Judge(judge::Arguments),
    /// Write a part in another dialect, as straight moves within a tolerance, or as a curve file.
    #[command(after_help = examples::CONVERT)]
    Convert(convert::Arguments),
    /// List machines that have a name, with the sources of their values, or print one as a machine file to start from.
    #[command(after_help = examples::MACHINE)]
    Machine(machine::Arguments),
    /// List the number formats.
    #[command(after_help = examples::FORMATS)]
    Formats(formats::Arguments),
    /// Run kernels of controllers whose numbers failed in public, and say which format cures each, or that none does.
    #[command(after_help = examples::ZOO)]
    Zoo(zoo::Arguments),
    /// Print a script by which a shell completes this command's words.
    #[command(after_help = examples::COMPLETIONS)]
    Completions(completions::Arguments),
}

fn main() -> ExitCode {
    if let Some(status) = completions::answer(Arguments::command) {
        return status;
    }
    let matches = numbers::with_domains(Arguments::command()).try_get_matches();
    let arguments = match matches.and_then(|mut matches| Arguments::from_arg_matches_mut(&mut matches)) {
        Ok(arguments) => arguments,
        Err(error) => return output::usage(&error),
    };
    if arguments.quiet {
        output::be_quiet();
    }
    let by_default = || Arguments::parse_from(report::default_command()).command;
    let Some(command) = arguments.command.or_else(by_default) else {
        return ExitCode::from(2);
    };
    interrupt::watch();
    let ending = match command {
        Command::Compare(arguments) => compare::run(&arguments),
        Command::Interpolate(arguments) => interpolate::run(&arguments),
        Command::Compile(arguments) => compile::run(&arguments),
        Command::Plan(arguments) => plan::run(&arguments),
        Command::Size(arguments) => size::run(&arguments),
        Command::Sweep(arguments) => sweep::run(&arguments),
        Command::Merge(arguments) => merge::run(&arguments),
        Command::Servo(arguments) => servo::run(&arguments),
        Command::Papers(arguments) => papers::run(&arguments),
        Command::Smooth(arguments) => smooth::run(&arguments),
        Command::Targets(arguments) => targets::run(&arguments),
        Command::Check(arguments) => check::run(&arguments),
        Command::Judge(arguments) => judge::run(&arguments),
        Command::Convert(arguments) => convert::run(&arguments),
        Command::Machine(arguments) => machine::run(&arguments),
        Command::Formats(arguments) => formats::run(&arguments),
        Command::Zoo(arguments) => zoo::run(&arguments),
        Command::Completions(arguments) => completions::run(&arguments),
    };
    if ending.is_ok() {
        output::begin_work();
    }
    match ending {
        Ok(ending) => ExitCode::from(ending.status()),
        Err(error) => output::status_of(Err(error)),
    }
}
