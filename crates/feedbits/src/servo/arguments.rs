//! Options of `feedbits servo`.

use std::path::PathBuf;

use clap::Args;
use clap_complete::ArgValueCandidates;
use domains::options::{CIRCLE, CIRCLE_FEED};

use crate::input::Input;
use crate::numbers::number;
use crate::run_arguments::RunArguments;
use crate::{candidates, output};

/// Options of `servo`.
#[derive(Args)]
pub(crate) struct Arguments {
    #[command(flatten)]
    pub(super) input: Input,
    /// Servo file (TOML with a table `servo`). Default: the built-in example, data/servo.toml.
    #[arg(long, value_name = "FILE")]
    pub(super) servo: Option<PathBuf>,
    #[command(flatten)]
    pub(super) run: RunArguments,
    /// The formats to run, comma-separated. Default: all; see `feedbits formats`. Names in Q notation are
    /// read by the register that they fill: Q8.24 (Arm) and Q7.24 (TI) are I8F24.
    #[arg(long, visible_alias = "format", value_delimiter = ',', value_parser = crate::formats::name, value_name = "F,F", add = ArgValueCandidates::new(candidates::formats))]
    pub(super) formats: Vec<String>,
    /// Radius of the circle test, in mm.
    #[arg(long, value_name = "MM", default_value_t = 10.0, value_parser = number(&CIRCLE))]
    pub(super) circle: f64,
    /// Feedrate of the circle test, in mm/min, as an F word has it.
    #[arg(long, value_name = "MM_PER_MIN", default_value_t = 4000.0, value_parser = number(&CIRCLE_FEED))]
    pub(super) feed: f64,
    /// Write the magnified roundness plot of the circle test to this SVG file.
    #[arg(long, value_name = "FILE.svg")]
    pub(super) plot: Option<PathBuf>,
    /// Print table 2 of paper D, its four settings of the circle test, beside the figures of the drive and of the printed
    /// position gain of 30 1/s, and nothing else.
    #[arg(long, conflicts_with_all = ["part", "plot", "wide", "formats"])]
    pub(super) paper_table: bool,
    /// Print all figures of each format, also of the textbook way *raw*: about 170 columns.
    #[arg(long)]
    pub(super) wide: bool,
    #[command(flatten)]
    pub(super) output: output::Output,
}
