//! Test vectors of a run: what a step holds in each period, bit by bit, for whoever builds another implementation.

use std::fmt::Write;

use nurbs_core::ORIGIN_EXPONENT;
use real::{Backend, FormatName, Named, Real, named_words, word_of};
use secant_interp::{PieceInterpolator, Section};
use serde::Serialize;

use crate::refusal::Refusal;
use crate::run::job::Job;
use crate::run::on_pieces;

/// The version of the tables' layout.
const VERSION: u32 = 1;
const AXES: [&str; 3] = ["x", "y", "z"];

/// The test vectors of a run on pieces.
#[derive(Clone, Debug)]
pub struct Vectors {
    /// What the tables hold.
    pub about: VectorsAbout,
    /// A row for each period.
    pub periods: VectorTable,
    /// A row for each named value, in the order in which the steps compute them.
    pub signals: VectorTable,
}

/// What the tables hold: format, units, columns, and names of signals.
#[derive(Clone, Debug, Serialize)]
pub struct VectorsAbout {
    /// The version of the layout.
    pub version: u32,
    /// The number format.
    pub format: String,
    /// T, in s.
    pub period_s: f64,
    /// How many periods.
    pub periods: usize,
    /// An offset is a number of the format times 2 to this power, in mm.
    pub coordinate_exponent: i32,
    /// A length is a number of the format over 2 to this power, in mm.
    pub chord_exponent: i32,
    /// A position counts units of 2 to this power, in mm.
    pub position_exponent: i32,
    /// The columns of the periods.
    pub period_columns: Vec<VectorColumn>,
    /// The columns of the signals.
    pub signal_columns: Vec<VectorColumn>,
    /// The signals, in the order of their numbers from 0.
    pub signals: Vec<&'static str>,
    /// The register of each signal, in the order in which `size` lists them; none where all numbers have one format.
    #[serde(skip_serializing_if = "Vec::is_empty")]
    pub registers: Vec<RegisterWord>,
}

/// The width of a register's words.
#[derive(Clone, Debug, Serialize)]
pub struct RegisterWord {
    /// Name of the signal.
    pub signal: &'static str,
    /// The register's format.
    pub format: String,
    /// Its width.
    pub bits: u32,
}

impl RegisterWord {
    fn of(&(signal, format): &(&'static str, FormatName)) -> Self {
        Self { signal, format: format.to_string(), bits: format.bits() }
    }
}

/// What the words of a run are.
#[derive(Clone, Copy)]
pub(crate) enum Words<'a> {
    /// Numbers of one format, as wide as this.
    OfFormat(FormatName),
    /// Numbers of [`Quantized`](real::Quantized): each signal has the word of its register, which has this format.
    Registers(&'a [(&'static str, FormatName)]),
}

impl Words<'_> {
    /// What holds a signal; what no register holds is an f64.
    fn held_in(self, signal: &str) -> FormatName {
        match self {
            Words::OfFormat(format) => format,
            Words::Registers(registers) => {
                let register = registers.iter().find(|(name, _)| *name == signal);
                register.map_or(FormatName::Float { bits: 64 }, |(_, format)| *format)
            }
        }
    }

    /// A signal's number as its register holds it, from the bits of the number that was computed with.
    fn word(self, signal: &str, bits: u64) -> u64 {
        match (self, self.held_in(signal)) {
            (Words::Registers(_), FormatName::Fixed { integer_bits, fraction_bits, .. }) => {
                let units = f64::from_bits(bits).ldexp(fraction_bits.cast_signed()).round();
                let mask = u64::MAX >> (64 - (integer_bits + fraction_bits).clamp(1, 64));
                let size = units.abs().to_phase(-64);
                if units < 0.0 { size.wrapping_neg() & mask } else { size & mask }
            }
            _ => bits,
        }
    }

    fn bits(self, signal: &str) -> u32 {
        self.held_in(signal).bits()
    }

    /// The width of the widest signal.
    fn widest(self) -> u32 {
        match self {
            Words::OfFormat(format) => format.bits(),
            Words::Registers(registers) => {
                registers.iter().map(|(_, format)| format.bits()).max().unwrap_or(64)
            }
        }
    }
}

/// A column of a table.
#[derive(Clone, Debug, Serialize)]
pub struct VectorColumn {
    /// Its name.
    pub name: String,
    /// Its width. In a memory image it is right-aligned in a whole number of hexadecimal digits.
    pub bits: u32,
    /// Whether it is a count, which is decimal in the CSV; everything else is hexadecimal.
    pub is_count: bool,
}

/// A table as CSV and as memory image.
#[derive(Clone, Debug)]
pub struct VectorTable {
    columns: Vec<VectorColumn>,
    /// The table as CSV.
    pub csv: String,
    /// A line for each row: the hexadecimal digits of all columns, the first one first, as `$readmemh` reads them.
    pub image: String,
}

impl VectorTable {
    fn new(counts: &[(&str, u32)], words: impl IntoIterator<Item = (String, u32)>) -> Self {
        let counts = counts.iter().map(|(name, bits)| (name.to_string(), *bits, true));
        let words = words.into_iter().map(|(name, bits)| (name, bits, false));
        let columns: Vec<_> =
            counts.chain(words).map(|(name, bits, is_count)| VectorColumn { name, bits, is_count }).collect();
        let names: Vec<&str> = columns.iter().map(|column| column.name.as_str()).collect();
        Self { csv: names.join(",") + "\n", columns, image: String::new() }
    }

    /// Adds a row. A word of the last column may have fewer `bits` than the column: the CSV has as many digits as these take.
    fn push(&mut self, values: impl IntoIterator<Item = u64>, bits: u32) {
        let last = self.columns.len().saturating_sub(1);
        for (index, (column, value)) in self.columns.iter().zip(values).enumerate() {
            let digits = column.bits.div_ceil(4) as usize;
            let own = if index == last { bits.div_ceil(4) as usize } else { digits };
            let comma = if index == 0 { "" } else { "," };
            // Writing to a text cannot fail.
            let _ = match column.is_count {
                true => write!(self.csv, "{comma}{value}"),
                false => write!(self.csv, "{comma}{value:0own$x}"),
            };
            let _ = write!(self.image, "{value:0digits$x}");
        }
        self.csv.push('\n');
        self.image.push('\n');
    }
}

/// Runs the part on pieces and writes every period down. The plan must rest at each gap of the part.
pub(crate) fn vectors<R: Backend, const D: usize>(
    job: &Job<'_, D>,
    words: Words<'_>,
) -> Result<Vectors, Refusal> {
    let path = on_pieces::compiled::<Named<R>, D>(job)?;
    let mut writer = Writer::new::<D>(words);
    let whole = path.interpolator();
    for section in path.sections() {
        writer.run(&whole.on(section), section, job.most_periods())?;
    }
    let pieces = path.table().as_pieces();
    let Writer { periods, signals, names, period, .. } = writer;
    let about = VectorsAbout {
        version: VERSION,
        format: match words {
            Words::OfFormat(format) => format.to_string(),
            Words::Registers(_) => "a register for each signal".to_string(),
        },
        period_s: job.problem.period_s(),
        periods: period,
        coordinate_exponent: pieces.coordinate_exponent,
        chord_exponent: pieces.chord_exponent,
        position_exponent: ORIGIN_EXPONENT,
        period_columns: periods.columns.clone(),
        signal_columns: signals.columns.clone(),
        signals: names,
        registers: match words {
            Words::OfFormat(_) => Vec::new(),
            Words::Registers(registers) => registers.iter().map(RegisterWord::of).collect(),
        },
    };
    Ok(Vectors { about, periods, signals })
}

/// The tables so far.
struct Writer<'a> {
    words: Words<'a>,
    periods: VectorTable,
    signals: VectorTable,
    /// The signals that have been met.
    names: Vec<&'static str>,
    /// The number of the next period, and of the next section.
    period: usize,
    section: u64,
}

impl<'a> Writer<'a> {
    fn new<const D: usize>(words: Words<'a>) -> Self {
        let of_axes = |what: &str, bits: u32| {
            AXES.iter().take(D).map(move |axis| (format!("{what}_{axis}"), bits)).collect::<Vec<_>>()
        };
        let places = [("phase".to_string(), 64), ("length".to_string(), words.bits("chord_length"))];
        let periods = VectorTable::new(
            &[("period", 32), ("section", 32), ("piece", 32), ("evaluations", 8)],
            places.into_iter().chain(of_axes("offset", words.bits("offset"))).chain(of_axes("position", 64)),
        );
        let signals =
            VectorTable::new(&[("period", 32), ("signal", 8)], [("word".to_string(), words.widest())]);
        Self { words, periods, signals, names: Vec::new(), period: 0, section: 0 }
    }

    /// Runs from one rest to the next.
    fn run<R: Backend, const D: usize>(
        &mut self,
        interpolator: &PieceInterpolator<'_, Named<R>, D>,
        section: &Section,
        most: u64,
    ) -> Result<(), Refusal> {
        let mut state = interpolator.start();
        loop {
            let (setpoint, named) = named_words(|| interpolator.step(&mut state));
            let Some(setpoint) = setpoint else { break };
            if self.period as u64 >= most {
                return Err(Refusal::Unfinished { periods: self.period, format: R::name() });
            }
            let position = interpolator.pieces.position(setpoint.piece, &setpoint.offset);
            let counts = [
                self.period as u64,
                self.section,
                (section.pieces.start + setpoint.piece) as u64,
                u64::from(setpoint.evaluations),
            ];
            let words = [setpoint.phase, self.words.word("chord_length", word_of(setpoint.length.0))];
            let offset = setpoint.offset.map(|x| self.words.word("offset", word_of(x.0)));
            let position = position.map(i64::cast_unsigned);
            self.periods.push(counts.into_iter().chain(words).chain(offset).chain(position), 64);
            for (name, word) in named {
                let signal = self.number(name);
                let word = self.words.word(name, word);
                self.signals.push([self.period as u64, signal, word], self.words.bits(name));
            }
            self.period += 1;
        }
        self.section += 1;
        Ok(())
    }

    /// The number of a signal.
    fn number(&mut self, name: &'static str) -> u64 {
        let number = self.names.iter().position(|one| *one == name).unwrap_or_else(|| {
            self.names.push(name);
            self.names.len() - 1
        });
        number as u64
    }
}
