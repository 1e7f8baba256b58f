//! A target: its kind, its units, and the cost of each operation.

use domains::shown;
use domains::target::{
    BUSY, CLOCK, CLOCK_BITS, DSP_BLOCKS, ISSUE_PER_CYCLE, LUTS, NAME, PER_BIT, PER_FRACTION_BIT, ROW_BITS,
    ROW_CYCLES, TITLE, UNITS,
};
use foreign_text::in_a_file_name;
use real::{FormatName, Overflow, Rounding};
use serde::{Deserialize, Serialize};

use crate::cycles::Cycles;
use crate::error::TargetError;
use crate::place::Place;
use crate::task::Priced;

/// What three numbers must do.
const RISES: &str = "low <= typical <= high";

/// The longest name of a target.
const LONGEST_NAME: usize = 64;

/// A processor or an FPGA.
#[derive(Clone, Debug, Serialize, Deserialize)]
#[serde(deny_unknown_fields)]
pub struct Target {
    /// The name on the command line, and in the names of a report's files: letters and digits of ASCII, `-`, `_` and `.`, at most 64,
    /// the first of them a letter or a digit.
    pub name: String,
    /// The name for people.
    pub title: String,
    /// How the operations of a step are ordered.
    pub kind: Kind,
    /// The unit of the figures.
    #[serde(default)]
    pub measure: Measure,
    /// Number of operations that may begin in the same cycle; absent if there is no limit.
    #[serde(default)]
    pub issue_per_cycle: Option<u32>,
    /// Clocks. The first one that is wide enough for a format counts; a processor has one clock. An empty list:
    /// unknown.
    #[serde(default)]
    pub clock: Vec<Clock>,
    /// Units that several operations share.
    #[serde(default)]
    pub unit: Vec<Unit>,
    /// Whether the costs of the operations were counted on the instruction set.
    #[serde(default)]
    pub calibrated: bool,
    /// The costs.
    #[serde(default)]
    pub operation: Vec<Row>,
}

/// How the operations of a step are ordered.
#[derive(Clone, Copy, Debug, PartialEq, Eq, Serialize, Deserialize)]
#[serde(rename_all = "snake_case")]
pub enum Kind {
    /// In program order: an operation begins no earlier than the one before it.
    Processor,
    /// A compiler orders them, for several units that begin in the same cycle.
    Vliw,
    /// A list schedule on units that are bought for the step.
    Fpga,
}

/// The unit of a target's figures.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq, Serialize, Deserialize)]
#[serde(rename_all = "snake_case")]
pub enum Measure {
    /// Clock cycles.
    #[default]
    Cycles,
    /// Executed instructions, where the processor's timing is not published.
    Instructions,
}

/// A clock, for formats up to a width.
#[derive(Clone, Debug, PartialEq, Serialize, Deserialize)]
#[serde(deny_unknown_fields)]
pub struct Clock {
    /// The only format, by its name; absent for every format.
    #[serde(default)]
    pub numbers: Option<String>,
    /// The widest format; absent for every width.
    #[serde(default)]
    pub max_bits: Option<u32>,
    /// In MHz.
    pub mhz: Mhz,
    /// The source of the number.
    pub source: String,
}

/// The rate of a clock, in MHz.
#[derive(Clone, Copy, Debug, PartialEq, Serialize, Deserialize)]
#[serde(untagged)]
pub enum Mhz {
    /// One that is chosen, or stated.
    Exactly(f64),
    /// Between the slowest and the fastest that place and route give.
    Range(Cycles),
}

impl Mhz {
    /// The three rates; those of a stated one are equal.
    #[must_use]
    pub const fn range(self) -> Cycles {
        match self {
            Self::Exactly(mhz) => Cycles::exactly(mhz),
            Self::Range(range) => range,
        }
    }
}

/// Units that several operations share.
#[derive(Clone, Debug, PartialEq, Eq, Serialize, Deserialize)]
#[serde(deny_unknown_fields)]
pub struct Unit {
    /// Its name.
    pub name: String,
    /// How many there are.
    pub count: u32,
}

/// The cost of one operation in some formats.
#[derive(Clone, Debug, PartialEq, Serialize, Deserialize)]
#[serde(deny_unknown_fields)]
pub struct Row {
    /// The operation.
    pub name: Priced,
    /// The formats: `fixed`, or one format by its name.
    pub numbers: String,
    /// The widest fixed-point format.
    #[serde(default)]
    pub max_bits: Option<u32>,
    /// Cycles until the result is ready.
    pub cycles: Known,
    /// More cycles for each bit of the format.
    #[serde(default)]
    pub per_bit: f64,
    /// More cycles for each fraction bit of the format.
    #[serde(default)]
    pub per_fraction_bit: f64,
    /// Cycles for which the operation occupies its unit, or blocks the issue of the next operation. If absent: until
    /// the result is ready on a processor, one cycle elsewhere.
    #[serde(default)]
    pub busy: Option<f64>,
    /// The unit that does it; absent if there is no limit on their number.
    #[serde(default)]
    pub unit: Option<String>,
    /// DSP blocks in a unit.
    #[serde(default)]
    pub dsp_blocks: u32,
    /// LUTs in a unit, in the format of the row that takes most.
    #[serde(default)]
    pub luts: u32,
    /// Manual and table, or the derivation.
    pub source: String,
    /// How reliable the number is.
    pub confidence: Confidence,
}

/// Cycles, or that nobody has published them.
#[derive(Clone, Copy, Debug, PartialEq, Serialize, Deserialize)]
#[serde(untagged)]
pub enum Known {
    /// Known.
    Cycles(Cycles),
    /// The word `unknown`.
    Not(Unknown),
}

/// The word `unknown`.
#[derive(Clone, Copy, Debug, PartialEq, Eq, Serialize, Deserialize)]
#[serde(rename_all = "snake_case")]
pub enum Unknown {
    /// Nobody has published it.
    Unknown,
}

/// How reliable a number is.
#[derive(Clone, Copy, Debug, PartialEq, Eq, Serialize, Deserialize)]
#[serde(rename_all = "snake_case")]
pub enum Confidence {
    /// Read in the source, or measured.
    High,
    /// Derived from the source, or from a second-hand source.
    Medium,
    /// An estimate.
    Low,
}

/// The cost of an operation in one format.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Price {
    /// Cycles until the result is ready.
    pub latency: Cycles,
    /// How long its unit is occupied.
    pub busy: Option<f64>,
    /// The unit, by its place in [`Target::unit`].
    pub unit: Option<usize>,
    /// DSP blocks in the unit.
    pub dsp_blocks: u32,
    /// LUTs in the unit.
    pub luts: u32,
}

impl Target {
    /// Whether every value of a file is one that it may be; `text` is the file's.
    pub(crate) fn validate(&self, file: &str, text: &str) -> Result<(), TargetError> {
        let wrong = |place: Place, value: String, expected: String| {
            let (key, line) = (place.to_string(), place.line_in(text));
            Err(TargetError::Value { file: file.to_string(), line, key, value, expected })
        };
        if in_a_file_name(&self.name) != self.name || self.name.len() > LONGEST_NAME {
            let expected =
                "letters and digits of ASCII, `-`, `_` and `.`, at most 64, the first a letter or a digit";
            return wrong(Place::of(&NAME), format!("{:?}", self.name), expected.into());
        }
        if self.title.trim().is_empty() {
            return wrong(Place::of(&TITLE), format!("{:?}", self.title), "a name".into());
        }
        for (place, value) in self.numbers() {
            if !place.key.holds(value) {
                let expected = place.key.expected();
                return wrong(place, shown(value), expected);
            }
        }
        for (index, clock) in self.clock.iter().enumerate() {
            let (at, mhz) = (|| Place::in_table(&CLOCK, index), clock.mhz.range());
            if let Some(numbers) = clock.numbers.as_ref().filter(|name| FormatName::named(name).is_none()) {
                return wrong(at().field("numbers"), numbers.clone(), "a format such as f32 or I4F28".into());
            }
            if !mhz.rises() {
                return wrong(at(), mhz.in_a_file(), RISES.into());
            }
        }
        for (index, row) in self.operation.iter().enumerate() {
            let at = |key: &'static str| Place::in_table(&ROW_CYCLES, index).field(key);
            if row.numbers != "fixed" && FormatName::named(&row.numbers).is_none() {
                let expected = "`fixed` or a format such as f32 or I4F28".into();
                return wrong(at("numbers"), row.numbers.clone(), expected);
            }
            if let Known::Cycles(cycles) = row.cycles
                && !cycles.rises()
            {
                return wrong(at("cycles"), cycles.in_a_file(), RISES.into());
            }
            if let Some(name) = &row.unit
                && !self.unit.iter().any(|unit| unit.name == *name)
            {
                return wrong(at("unit"), format!("{name:?}"), "a unit of the list `unit`".into());
            }
        }
        Ok(())
    }

    /// Every number, with its place.
    fn numbers(&self) -> impl Iterator<Item = (Place, f64)> {
        let issue = self.issue_per_cycle.map(|width| (Place::of(&ISSUE_PER_CYCLE), f64::from(width)));
        let clocks = self.clock.iter().enumerate().flat_map(|(index, clock)| {
            let bits = clock.max_bits.map(|bits| (Place::in_table(&CLOCK_BITS, index), f64::from(bits)));
            let Cycles { low, typical, high } = clock.mhz.range();
            [low, typical, high].map(|mhz| (Place::in_table(&CLOCK, index), mhz)).into_iter().chain(bits)
        });
        let units = self.unit.iter().enumerate();
        let units = units.map(|(index, unit)| (Place::in_table(&UNITS, index), f64::from(unit.count)));
        let rows = self.operation.iter().enumerate().flat_map(|(index, row)| {
            let place = |key| Place::in_table(key, index);
            let cycles = match row.cycles {
                Known::Cycles(cycles) => [cycles.low, cycles.typical, cycles.high],
                Known::Not(Unknown::Unknown) => [0.0; 3],
            };
            let bits = row.max_bits.map(|bits| (place(&ROW_BITS), f64::from(bits)));
            let busy = row.busy.map(|busy| (place(&BUSY), busy));
            let always = [
                (place(&PER_BIT), row.per_bit),
                (place(&PER_FRACTION_BIT), row.per_fraction_bit),
                (place(&DSP_BLOCKS), f64::from(row.dsp_blocks)),
                (place(&LUTS), f64::from(row.luts)),
            ];
            cycles
                .map(|cycles| (place(&ROW_CYCLES), cycles))
                .into_iter()
                .chain(always)
                .chain(bits)
                .chain(busy)
        });
        issue.into_iter().chain(clocks).chain(units).chain(rows)
    }

    /// This target with `count` units of this name, at least one.
    #[must_use]
    pub fn with_units(mut self, name: &str, count: u32) -> Self {
        for unit in self.unit.iter_mut().filter(|unit| unit.name == name) {
            unit.count = count.max(1);
        }
        self
    }

    /// This target with one clock for every format, as a user states it.
    #[must_use]
    pub fn with_clock(mut self, mhz: f64) -> Self {
        let source = "stated".to_string();
        self.clock = vec![Clock { numbers: None, max_bits: None, mhz: Mhz::Exactly(mhz), source }];
        self
    }

    /// The clock in MHz for a format: the first that is its own, or wide enough and no format's own.
    #[must_use]
    pub fn clock_mhz(&self, format: FormatName) -> Option<Cycles> {
        let (name, bits) = (format.to_string(), format.bits());
        let own = |clock: &&Clock| clock.numbers.as_ref() == Some(&name);
        let fits = |clock: &&Clock| clock.numbers.is_none() && clock.max_bits.is_none_or(|most| bits <= most);
        let clocks = || self.clock.iter();
        clocks().find(own).or_else(|| clocks().find(fits)).map(|clock| clock.mhz.range())
    }

    /// The row that prices an operation in a format: the format's own row, else the narrowest fixed-point row that is
    /// wide enough. A format that rounds toward -∞ is priced like one that rounds to nearest. Formats that round in
    /// other ways, or saturate, are priced only by rows of their own.
    #[must_use]
    pub fn row(&self, operation: Priced, format: FormatName) -> Option<&Row> {
        let named = |format: FormatName| {
            let name = format.to_string();
            self.operation.iter().find(|row| row.name == operation && row.numbers == name)
        };
        let FormatName::Fixed { integer_bits, fraction_bits, datapath } = format else {
            return named(format);
        };
        // Rounding to nearest takes no less than dropping the bits; other ways may take more.
        let is_no_dearer = matches!(datapath.rounding, Rounding::Nearest | Rounding::Floor);
        if !is_no_dearer || datapath.overflow != Overflow::Wrap {
            return named(format);
        }
        let own = named(format).or_else(|| named(FormatName::fixed(integer_bits, fraction_bits)));
        if own.is_some() {
            return own;
        }
        let fits = |row: &&Row| {
            row.name == operation
                && row.numbers == "fixed"
                && row.max_bits.is_none_or(|most| format.bits() <= most)
        };
        self.operation.iter().filter(fits).min_by_key(|row| row.max_bits.unwrap_or(u32::MAX))
    }

    /// The price of an operation in a format; `None` if there is no row, or its cycles are unknown.
    #[must_use]
    pub fn price(&self, operation: Priced, format: FormatName) -> Option<Price> {
        let row = self.row(operation, format)?;
        let Known::Cycles(cycles) = row.cycles else { return None };
        let bits =
            f64::from(format.bits()) * row.per_bit + f64::from(fraction_bits(format)) * row.per_fraction_bit;
        Some(Price {
            latency: cycles + Cycles::exactly(bits),
            busy: row.busy.map(|busy| if bits > 0.0 { busy.max(bits) } else { busy }),
            unit: row.unit.as_ref().and_then(|name| self.unit.iter().position(|unit| unit.name == *name)),
            dsp_blocks: row.dsp_blocks,
            luts: row.luts,
        })
    }
}

fn fraction_bits(format: FormatName) -> u32 {
    match format {
        FormatName::Fixed { fraction_bits, .. } | FormatName::Fraction { fraction_bits, .. } => fraction_bits,
        _ => 0,
    }
}
