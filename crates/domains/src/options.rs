//! The options of the command line that take a number. Where an option means another thing to another command, its key
//! begins with the name of that command.

use crate::curve::POINTS;
use crate::domain::Domain;
use crate::key::{Key, LeftOut};
use crate::machine::{FEED, FEEDRATE, FLUCTUATION_LIMIT, PERIOD};

const LENGTH: Domain = Domain::of(1e-9, 1e2, "mm");
const RATIO: Domain = Domain::ratio(1e-16);

const fn like(name: &'static str, key: Key, meaning: &'static str) -> Key {
    Key { name, value: key.value, left_out: LeftOut::Words(""), meaning }
}

/// Longest compiled piece. Shorter ones than a thousandth of a step of most machines take memory and gain nothing.
pub const PIECE_LENGTH: Key =
    Key::number("--piece-length", Domain::of(1e-3, 1e6, "mm"), "longest compiled piece").or(32.0);
/// Feed at the start of the path.
pub const START_FEED: Key =
    Key::number("--start-feed", FEED.or_zero(), "feed at the start of the path").or(0.0);
/// Feed at the end of the path.
pub const END_FEED: Key = Key::number("--end-feed", FEED.or_zero(), "feed at the end of the path").or(0.0);
/// How far a plan looks ahead.
pub const WINDOW: Key = Key::number("--window", Domain::of(1e-2, 1e7, "mm"), "how far a plan looks ahead")
    .optional("the whole path");
/// In place of the machine's.
pub const FLUCTUATION: Key = like("--fluctuation", FLUCTUATION_LIMIT, "the fluctuation that is good enough");
/// At which a solver stops.
pub const SOLVER_TOLERANCE: Key =
    Key::number("--solver-tolerance", RATIO, "the fluctuation that the solver stops at").optional("");
/// Samples of `plan --out`.
pub const OVERSAMPLE: Key =
    Key::whole("--oversample", [1, 1000], "a period", "samples in the file of `plan`").or(1.0);
/// Times of overrides: eleven days.
pub const OVERRIDE_TIME: Key =
    Key::number("--override S", Domain::of(0.0, 1e6, "s"), "from when on an override holds");
/// Overrides, 0 is feed hold.
pub const OVERRIDE: Key = Key::number(
    "--override PERCENT",
    Domain::of(1.0, 200.0, "%").or_zero(),
    "share of the commanded feed; 0 is feed hold",
);
/// The highest override of a compiled part.
pub const FEED_OVERRIDE: Key =
    Key::number("--feed-override", Domain::of(100.0, 200.0, "%"), "the highest override of a compiled part")
        .optional("none");
/// What is kept for overrides.
pub const RESERVE: Key = Key::number(
    "--reserve",
    Domain::of(0.1, 99.0, "%"),
    "share of acceleration and jerk that the plan leaves for changes of the override",
)
.or(20.0);
/// Bytes of a reader's buffer.
pub const BUFFER: Key =
    Key::whole("--buffer", [1, u32::MAX], "bytes", "the buffer of a stream's reader").optional("any");
/// Bytes of flash.
pub const FLASH: Key = Key::whole("--flash", [1, u32::MAX], "bytes", "flash for the tables").optional("any");
/// Periods of a sweep.
pub const SWEEP_PERIOD: Key = like("--period", PERIOD, "interpolation periods of a sweep");
/// Feeds of a sweep.
pub const SWEEP_FEED: Key = like("sweep --feed", FEEDRATE, "commanded feeds of a sweep");
/// Sizes of a sweep.
pub const SWEEP_SCALE: Key =
    Key::number("--scale", Domain::of(1e-3, 2e7, "mm"), "largest extent of the part in a sweep")
        .optional("as it is");
/// Points of a span.
pub const SWEEP_POINTS: Key = Key::whole("--points", [1, 1000], "", "points of a span").or(5.0);
/// Periods of a cell.
pub const MOST_PERIODS: Key =
    Key::whole("--most-periods", [1, 100_000_000], "periods", "the most periods of a cell's run")
        .or(100_000.0);
/// Shards.
pub const SHARDS: Key = Key::whole("--shard", [1, 1_000_000], "", "i and n of shard i of n").optional("1/1");
/// The circle test's radius.
pub const CIRCLE: Key =
    Key::number("--circle", Domain::of(1e-6, 1e5, "mm"), "radius of the circle test").or(10.0);
/// The circle test's feed, in mm/min.
pub const CIRCLE_FEED: Key =
    Key::number("servo --feed", Domain::of(6e-5, 6e6, "mm/min"), "feedrate of the circle test").or(4000.0);
/// Of smoothing.
pub const SMOOTH_TOLERANCE: Key =
    Key::number("smooth --tolerance", LENGTH, "largest distance of the smoothed path from the moves");
/// λ of corners.
pub const CORNER_LAMBDA: Key =
    Key::number("--lambda", Domain::of(-2.0, 2.0, ""), "shape factor of the corners' splines, or `auto`")
        .or(1.0);
/// Of fitted curves.
pub const FIT: Key =
    Key::number("--fit", LENGTH, "largest distance of fitted curves from the moves").optional("none");
/// What is a corner.
pub const CORNER: Key =
    Key::number("--corner", Domain::of(0.01, 90.0, "°"), "a change of direction above this is a corner")
        .or(30.0);
/// Of straight moves.
pub const CONVERT_TOLERANCE: Key =
    Key::number("convert --tolerance", LENGTH, "largest distance of straight moves from the curves").or(1e-3);
/// Decimals.
pub const DIGITS: Key = Key::whole("--digits", [0, 15], "", "decimals of coordinates").optional("all");
/// The largest ratio, digit by digit.
pub const RATIOS: Key =
    Key::number("--ratios", Domain::of(1.0, 1e9, ""), "the largest knot or weight, with its decimals")
        .optional("");
/// By how much a figure may grow.
pub const WORSE_BY: Key = Key::number(
    "--worse-by",
    Domain::of(0.0, 1000.0, "%"),
    "by how much a figure may grow over the baseline's",
)
.or(1.0);
/// Multipliers of an FPGA.
pub const MULTIPLIERS: Key = like("--multipliers", crate::target::UNITS, "multipliers on an FPGA");
/// Dividers of an FPGA.
pub const DIVIDERS: Key = like("--dividers", crate::target::UNITS, "dividers on an FPGA");
/// The clock of a target.
pub const CLOCK: Key = like("--clock", crate::target::CLOCK, "the clock of every target");
/// Where the tool is.
pub const START: Key = Key {
    name: "--start",
    value: POINTS.value,
    left_out: LeftOut::Words(""),
    meaning: "where the tool is when a program begins, three numbers",
};

/// Periods of a log.
pub const LOG_PERIOD: Key = like("judge --period", PERIOD, "the time between two setpoints of a log");
/// How far a motion may be from the positions of its log.
pub const RESOLUTION: Key =
    Key::number("--resolution", LENGTH, "how far the motion may be from the positions of a log")
        .optional("half of a unit of their last decimal");

/// Of a log around a part.
pub const LOG_TOLERANCE: Key =
    Key::number("judge --tolerance", LENGTH, "largest distance between a log and the path of its part")
        .optional("not judged");

/// The options.
pub const KEYS: [Key; 36] = [
    LOG_TOLERANCE,
    LOG_PERIOD,
    RESOLUTION,
    START,
    PIECE_LENGTH,
    START_FEED,
    END_FEED,
    WINDOW,
    FLUCTUATION,
    SOLVER_TOLERANCE,
    OVERSAMPLE,
    OVERRIDE_TIME,
    OVERRIDE,
    RESERVE,
    FEED_OVERRIDE,
    BUFFER,
    FLASH,
    SWEEP_PERIOD,
    SWEEP_FEED,
    SWEEP_SCALE,
    SWEEP_POINTS,
    MOST_PERIODS,
    SHARDS,
    CIRCLE,
    CIRCLE_FEED,
    SMOOTH_TOLERANCE,
    CORNER_LAMBDA,
    FIT,
    CORNER,
    CONVERT_TOLERANCE,
    DIGITS,
    RATIOS,
    WORSE_BY,
    MULTIPLIERS,
    DIVIDERS,
    CLOCK,
];
