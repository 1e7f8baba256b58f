//! The core in Verilog-2005, its microcode and its tables as memory images, and a testbench.

use askama::Template;

use crate::error::CoreError;
use crate::image::Image;
use crate::microcode::{Action, Microcode, POINTERS, Slot, Source, Word};
use crate::program::{Compare, Event, Numbers, OUTPUT_DONE, OUTPUT_WHOLE, Op, Program};

/// An output of the core.
#[derive(Clone)]
pub(crate) struct Output {
    name: String,
    bits: u32,
    /// Bits that continue it to whole bytes.
    padding: u32,
}

impl Output {
    fn new(name: &str, bits: u32) -> Self {
        Self { name: name.to_owned(), bits, padding: bits.next_multiple_of(8) - bits }
    }
}

#[derive(Template)]
#[template(path = "core.v", escape = "none")]
struct Core {
    about: String,
    version: &'static str,
    bits: u32,
    fraction_bits: u32,
    table_bits: u32,
    table_words: usize,
    words: usize,
    field_bits: u32,
    slot_bits: u32,
    column_bits: u32,
    address_bits: u32,
    pointer_bits: u32,
    pointers: usize,
    output_done: u8,
    output_whole: u8,
    outputs: Vec<Output>,
    /// The outputs as bits are written, the highest first.
    highest_first: Vec<Output>,
    setpoint_bits: u32,
    stream_bits: u32,
}

#[derive(Template)]
#[template(path = "testbench.v", escape = "none")]
struct Testbench {
    periods: usize,
    sections: u32,
    bits: u32,
    number_digits: u32,
    axes: usize,
    axis_names: Vec<String>,
    table_bits: u32,
    outputs: Vec<Output>,
    highest_first: Vec<Output>,
    stream_bits: u32,
}

/// The files of a core.
#[derive(Clone, Debug, PartialEq, Eq)]
pub(crate) struct Texts {
    pub(crate) core: String,
    pub(crate) microcode: String,
    pub(crate) part: String,
    pub(crate) testbench: String,
}

/// Bits of a register's number.
const SLOT_BITS: u32 = 9;

/// Bits that count to `count`.
fn bits_for(count: usize) -> u32 {
    count.next_power_of_two().trailing_zeros().max(1)
}

/// Writes all texts.
pub(crate) fn texts(
    program: &Program,
    microcode: &Microcode,
    image: &Image,
    about: &str,
    (periods, sections): (usize, u32),
) -> Result<Texts, CoreError> {
    let Numbers { bits, fraction_bits } = program.numbers;
    let pointer_bits = bits_for(POINTERS);
    let field_bits = SLOT_BITS.max(pointer_bits + microcode.column_bits);
    let table_bits = bits_for(image.words.len()).max(microcode.column_bits + 1);
    if table_bits > bits - 1 {
        let most = 1 << (bits - 1);
        return Err(CoreError::TooMany { what: "words of tables", needed: image.words.len(), most });
    }
    let outputs = || program.outputs.iter().map(|(name, bits)| Output::new(name, *bits));
    let core = Core {
        about: foreign_text::in_a_comment(about),
        version: env!("CARGO_PKG_VERSION"),
        bits,
        fraction_bits,
        table_bits,
        table_words: image.words.len(),
        words: microcode.words.len(),
        field_bits,
        slot_bits: SLOT_BITS,
        column_bits: microcode.column_bits,
        address_bits: bits_for(microcode.words.len()),
        pointer_bits,
        pointers: POINTERS,
        output_done: OUTPUT_DONE,
        output_whole: OUTPUT_WHOLE,
        outputs: outputs().collect(),
        highest_first: outputs().rev().collect(),
        setpoint_bits: outputs().map(|output| output.bits).sum(),
        stream_bits: outputs().map(|output| output.bits + output.padding).sum(),
    };
    let axis_names: Vec<_> = program
        .outputs
        .iter()
        .filter_map(|(name, _)| name.strip_prefix("offset_"))
        .map(str::to_owned)
        .collect();
    let testbench = Testbench {
        periods,
        sections,
        bits,
        number_digits: bits.div_ceil(4),
        axes: axis_names.len(),
        axis_names,
        table_bits,
        outputs: outputs().collect(),
        highest_first: core.highest_first.clone(),
        stream_bits: core.stream_bits,
    };
    let text = |rendered: askama::Result<String>| rendered.unwrap_or_default();
    let encoder = Encoder { field_bits, column_bits: microcode.column_bits };
    let digits = usize::try_from(14 + 4 * field_bits).unwrap_or(64).div_ceil(4);
    let lines = microcode.words.iter().map(|word| format!("{:0digits$x}\n", encoder.encoded(word)));
    Ok(Texts {
        core: text(core.render()),
        microcode: lines.collect(),
        part: image.words.iter().map(|word| format!("{word:016x}\n")).collect(),
        testbench: text(testbench.render()),
    })
}

struct Encoder {
    field_bits: u32,
    column_bits: u32,
}

impl Encoder {
    fn encoded(&self, word: &Word) -> u128 {
        let mut table = 0;
        let mut fields = [0_u128; 3];
        for ((place, field), source) in (1..).zip(&mut fields).zip(word.sources) {
            *field = match source {
                Source::Slot(slot) => slot.into(),
                Source::Table { pointer, column } => {
                    if table == 0 {
                        table = place;
                    }
                    u128::from(pointer) << self.column_bits | u128::from(column)
                }
            };
        }
        let mut to: u128 = word.to.into();
        let code = match word.action {
            Action::Nothing => 0,
            Action::Compute(op) => {
                if let Op::Output(place) = op {
                    to = place.into();
                }
                code(op)
            }
            Action::Load(value) => {
                let value = u128::from(value.cast_unsigned());
                fields[0] = value >> self.field_bits;
                fields[1] = value & ((1 << self.field_bits) - 1);
                16
            }
            Action::Branch { .. } => 18,
            Action::Jump => 19,
            Action::Call => 20,
            Action::Return => 21,
            Action::Wait(Event::Start) => 22,
            Action::Wait(Event::Taken) => 23,
        };
        if let Action::Branch { .. } | Action::Jump | Action::Call = word.action {
            let target = word.target as u128;
            fields[2] = target & ((1 << self.field_bits) - 1);
            to = target >> self.field_bits;
        }
        if let Action::Branch { compare, on } = word.action {
            to |= u128::from(comparison(compare)) << 3 | u128::from(on) << 6;
        }
        let [a, b, c] = fields;
        let head = u128::from(code) << 8 | u128::from(word.wait) << 2 | table;
        [to, a, b, c].into_iter().fold(head, |word, field| word << self.field_bits | field)
    }
}

fn comparison(compare: Compare) -> u8 {
    match compare {
        Compare::Equal => 0,
        Compare::Less => 1,
        Compare::AtMost => 2,
        Compare::LessUnsigned => 3,
        Compare::AtMostUnsigned => 4,
        Compare::WithinMagnitude => 5,
    }
}

fn code(op: Op) -> u8 {
    match op {
        Op::Move => 1,
        Op::Add => 2,
        Op::Sub => 3,
        Op::AddNumbers => 4,
        Op::SubNumbers => 5,
        Op::Min => 6,
        Op::Max => 7,
        Op::And => 10,
        Op::Or => 11,
        Op::Input => 15,
        Op::Output(_) => 17,
        Op::ShiftLeft => 24,
        Op::ShiftRight => 25,
        Op::Scale => 26,
        Op::ToPhase => 28,
        Op::Product => 32,
        Op::Sum | Op::Row => 33,
        Op::RoundedSum => 34,
        Op::Divide => 36,
        Op::Root => 37,
        Op::Limbs(i, j) => 48 | i << 2 | j,
        // A power of two is a column, or the part is refused.
        Op::PowerOfTwo => 0,
    }
}

/// The slot type is narrower than the field that holds it.
const _: () = assert!(Slot::BITS > SLOT_BITS, "a slot's number fits");
