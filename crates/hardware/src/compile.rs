//! From the C of a part to its core.

use std::collections::HashMap;

use secant_interp::PositionChecksum;

use crate::coalesce::coalesce;
use crate::control::{positions, program};
use crate::error::CoreError;
use crate::executor::{self, Run};
use crate::graph::{Graph, graph};
use crate::image::Image;
use crate::liveness::Liveness;
use crate::machine::{self, Made};
use crate::microcode::{Microcode, microcode};
use crate::pace::{Pace, least_period};
use crate::paths::{tidy, ways};
use crate::program::{BlockId, Numbers, Program};
use crate::verilog::{Texts, texts};

/// Operations and words of a run a setpoint, at most, and beside that.
const MOST: (u64, u64) = (20_000, 1_000_000);

/// What a part's core is made from: the files that `c-code` writes.
#[derive(Clone, Debug)]
pub struct CoreRequest<'a> {
    /// `NAME.h`.
    pub header: &'a str,
    /// `NAME.c`.
    pub source: &'a str,
    /// The begin of the public names.
    pub name: &'a str,
    /// What the files are of, in a line.
    pub about: &'a str,
    /// Bits of a number.
    pub bits: u32,
    /// Those of them behind the point.
    pub fraction_bits: u32,
    /// Setpoints of the run, and the checksum of their positions.
    pub periods: usize,
    /// See [`PositionChecksum`].
    pub checksum: u64,
}

/// A core and its part.
#[derive(Clone, Debug)]
pub struct CoreFiles {
    /// `core.v`.
    pub core: String,
    /// `microcode.hex`.
    pub microcode: String,
    /// `part.hex`.
    pub part: String,
    /// `testbench.v`.
    pub testbench: String,
    /// What it takes.
    pub figures: Figures,
    /// What each setpoint is in the executor of microcode: the words by the names of the core's outputs.
    pub setpoints: Vec<Vec<u64>>,
    /// The names of those words, with their bits.
    pub outputs: Vec<(String, u32)>,
}

/// What a core takes, by its executor.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Figures {
    /// Words of microcode, and bits of each.
    pub words: usize,
    /// Words of 64 bits in the tables.
    pub table_words: usize,
    /// Registers.
    pub registers: usize,
    /// Cycles from when a setpoint is taken until the next one stands at the output: mean and worst.
    pub cycles: (f64, u64),
    /// Cycles until the core can be asked for the one after that: mean and worst.
    pub until_ready: (f64, u64),
    /// For each depth of [`QUEUES`] the least period in cycles with which no setpoint is late.
    pub least_periods: [u64; QUEUES.len()],
}

/// Depths of the queue of finished setpoints, the parameter `QUEUE` of the core, for which the least period is said.
pub const QUEUES: [usize; 5] = [1, 2, 4, 8, 16];

/// Compiles a part's step for the core. Its microcode is run in the executor over the whole part, which must give what the blocks of
/// the C give.
///
/// # Errors
/// [`CoreError`]: the C is not of the subset, or the core has no room.
pub fn compile(request: &CoreRequest<'_>) -> Result<CoreFiles, CoreError> {
    let CoreRequest { bits, fraction_bits, .. } = *request;
    if !(16..=32).contains(&bits) || fraction_bits == 0 || fraction_bits >= bits {
        return Err(CoreError::Width { bits });
    }
    let mut program = program(request.header, request.source, request.name, Numbers { bits, fraction_bits })?;
    let sections = sections(&program);
    let most = MOST.0 * request.periods as u64 + MOST.1;
    tidy(&mut program);
    let run = executor::run(&program, sections, most)?;
    coalesce(&mut program, &run);
    let graphs = graphs(&mut program, &run);
    let microcode = microcode(&program, &graphs, &run)?;
    let image = Image::of(&program, &microcode);
    let made = machine::run(&microcode, &image, program.numbers, program.outputs.len(), sections, most)?;
    let checksum = checksum(request, &made)?;
    let periods = made.setpoints.len();
    if periods != request.periods || checksum != request.checksum {
        return Err(CoreError::Differs { periods, checksum });
    }
    if made.setpoints != run.setpoints {
        return Err(CoreError::Differs { periods, checksum });
    }
    let Texts { core, microcode: words, part, testbench } =
        texts(&program, &microcode, &image, request.about, (periods, sections))?;
    Ok(CoreFiles {
        core,
        microcode: words,
        part,
        testbench,
        figures: figures(&microcode, &image, &made),
        setpoints: made.setpoints.iter().map(|words| cut(&program, words)).collect(),
        outputs: program.outputs.clone(),
    })
}

/// The checksum of all positions, which the C's own function gives.
fn checksum(request: &CoreRequest<'_>, made: &Made) -> Result<u64, CoreError> {
    let CoreRequest { header, source, name, bits, fraction_bits, .. } = *request;
    let positions = positions(header, source, name, Numbers { bits, fraction_bits })?;
    let mut registers = vec![0_i64; positions.program.registers as usize];
    let mut checksum = PositionChecksum::default();
    for words in &made.setpoints {
        for (register, word) in positions.words.iter().zip(words) {
            registers[*register as usize] = *word;
        }
        executor::run_with(&positions.program, &mut registers, 0, MOST.0)?;
        let axis =
            |axis: usize| positions.position.get(axis).map_or(0, |register| registers[*register as usize]);
        if positions.position.len() == 3 {
            checksum.add([axis(0), axis(1), axis(2)]);
        } else {
            checksum.add([axis(0), axis(1)]);
        }
    }
    Ok(checksum.value())
}

fn sections(program: &Program) -> u32 {
    let found = program.parameters.iter().find(|(name, _)| name.ends_with("_SECTIONS"));
    found.and_then(|(_, count)| u32::try_from(*count).ok()).unwrap_or(1)
}

fn graphs(program: &mut Program, run: &Run) -> HashMap<BlockId, Graph> {
    let ways = ways(program, run);
    let liveness = Liveness::of(program);
    ways.iter().map(|way| (way.blocks[0], graph(program, way, &liveness))).collect()
}

/// Output words, each cut to its bits.
fn cut(program: &Program, words: &[i64]) -> Vec<u64> {
    let bits = program.outputs.iter().map(|(_, bits)| *bits);
    words.iter().zip(bits).map(|(word, bits)| word.cast_unsigned() & (u64::MAX >> (64 - bits))).collect()
}

fn figures(microcode: &Microcode, image: &Image, made: &Made) -> Figures {
    let paces: Vec<_> = made.sections.iter().flat_map(|section| &section.setpoints).collect();
    let of = |cycles: &dyn Fn(&Pace) -> u64| {
        let sum: u64 = paces.iter().map(|pace| cycles(pace)).sum();
        (sum as f64 / paces.len().max(1) as f64, paces.iter().map(|pace| cycles(pace)).max().unwrap_or(0))
    };
    Figures {
        words: microcode.words.len(),
        table_words: image.words.len(),
        registers: microcode.slots,
        cycles: of(&|pace| pace.until_whole),
        until_ready: of(&|pace| pace.until_ready),
        least_periods: QUEUES.map(|queue| least_period(&made.sections, queue)),
    }
}
