//! The keys of a target file.

use crate::domain::Domain;
use crate::key::{Key, LeftOut, Value};

const BITS: [u32; 2] = [1, 1024];
const CYCLES: Domain = Domain::of(0.0, 1e9, "cycles");

const fn text(name: &'static str, meaning: &'static str) -> Key {
    Key { name, value: Value::Text, left_out: LeftOut::Required, meaning }
}

/// The name on the command line.
pub const NAME: Key = text("name", "the name on the command line");
/// The name for people.
pub const TITLE: Key = text("title", "the name for people");
/// How operations are ordered.
pub const KIND: Key = Key {
    name: "kind",
    value: Value::Word(&["processor", "vliw", "fpga"]),
    left_out: LeftOut::Required,
    meaning: "how the operations of a step are ordered: in program order, by a compiler for several units, on units that are \
              bought",
};
/// The unit of the figures.
pub const MEASURE: Key = Key {
    name: "measure",
    value: Value::Word(&["cycles", "instructions"]),
    left_out: LeftOut::Words("`\"cycles\"`"),
    meaning: "the unit of the figures",
};
/// Issues a cycle.
pub const ISSUE_PER_CYCLE: Key =
    Key::whole("issue_per_cycle", [1, 1024], "", "operations that may begin in the same cycle")
        .optional("no limit");
/// Whether the costs were counted.
pub const CALIBRATED: Key = Key {
    name: "calibrated",
    value: Value::Truth,
    left_out: LeftOut::Words("false"),
    meaning: "whether the costs were counted on the instruction set: built-in targets alone",
};
/// The widest format of a clock.
pub const CLOCK_BITS: Key =
    Key::whole("clock.max_bits", BITS, "", "the widest format of this clock").optional("every format");
/// A clock, from a kilohertz to a terahertz.
pub const CLOCK: Key = Key::number(
    "clock.mhz",
    Domain::of(1e-3, 1e6, "MHz"),
    "the clock, or its `low`, `typical` and `high` in this order",
);
/// The only format of a clock.
pub const CLOCK_NUMBERS: Key = Key {
    name: "clock.numbers",
    value: Value::Text,
    left_out: LeftOut::Words("every format"),
    meaning: "the only format of this clock, by its name",
};
/// How many of a unit.
pub const UNITS: Key = Key::whole("unit.count", [1, 65_536], "", "how many of this unit there are");
/// The widest format of a row.
pub const ROW_BITS: Key =
    Key::whole("operation.max_bits", BITS, "", "the widest fixed-point format of this row")
        .optional("every format");
/// Cycles until the result is ready.
pub const ROW_CYCLES: Key = Key::number(
    "operation.cycles",
    CYCLES,
    "cycles until the result is ready, `low`, `typical` and `high` in this order, or `\"unknown\"`",
);
/// More for each bit.
pub const PER_BIT: Key = Key::number("operation.per_bit", CYCLES, "more for each bit of the format").or(0.0);
/// More for each fraction bit.
pub const PER_FRACTION_BIT: Key =
    Key::number("operation.per_fraction_bit", CYCLES, "more for each fraction bit of the format").or(0.0);
/// How long the unit is occupied.
pub const BUSY: Key =
    Key::number("operation.busy", CYCLES, "cycles for which the operation occupies its unit")
        .optional("until the result is ready on a processor, one elsewhere");
/// DSP blocks.
pub const DSP_BLOCKS: Key = Key::whole("operation.dsp_blocks", [0, 1024], "", "DSP blocks in a unit").or(0.0);

/// LUTs.
pub const LUTS: Key = Key::whole(
    "operation.luts",
    [0, 1_000_000],
    "",
    "LUTs in a unit, in the format of this row that takes most",
)
.or(0.0);

/// The keys of a target file. Each table `[[clock]]`, `[[unit]]` and `[[operation]]` also names its `source` or `name`.
pub const KEYS: [Key; 17] = [
    NAME,
    TITLE,
    KIND,
    MEASURE,
    ISSUE_PER_CYCLE,
    CALIBRATED,
    CLOCK_NUMBERS,
    CLOCK_BITS,
    CLOCK,
    UNITS,
    ROW_BITS,
    ROW_CYCLES,
    PER_BIT,
    PER_FRACTION_BIT,
    BUSY,
    DSP_BLOCKS,
    LUTS,
];
