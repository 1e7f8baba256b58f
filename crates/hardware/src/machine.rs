//! The executor of microcode: cycle by cycle what the core does, with results that come late and a register file of one write port.

use crate::error::CoreError;
use crate::image::Image;
use crate::microcode::{Action, Microcode, Slot, Source, Word};
use crate::pace::{Pace, SectionPace};
use crate::program::{Event, Numbers, OUTPUT_DONE, OUTPUT_WHOLE, Op};
use crate::timing::{BUBBLE, CHOICE, SUM, latency};

/// The setpoints of a run, and the cycles that each section takes.
#[derive(Clone, Debug, Default)]
pub(crate) struct Made {
    /// For each setpoint the output words.
    pub(crate) setpoints: Vec<Vec<i64>>,
    pub(crate) sections: Vec<SectionPace>,
}

impl Made {
    /// A wait is passed, `since` the last one.
    fn asked(&mut self, since: u64) {
        if let Some(last) = self.sections.last_mut().and_then(|section| section.setpoints.last_mut()) {
            last.until_ready = since;
        }
    }

    /// A setpoint is whole.
    fn whole(&mut self, words: &[i64], until_whole: u64) {
        self.setpoints.push(words.to_owned());
        if let Some(section) = self.sections.last_mut() {
            section.setpoints.push(Pace { until_whole, until_ready: 0 });
        }
    }

    /// A section is over.
    fn done(&mut self, until_done: u64) {
        if let Some(section) = self.sections.last_mut() {
            section.until_done = until_done;
        }
    }
}

/// Runs these sections; there is room for each setpoint at once.
///
/// # Errors
/// [`CoreError::Endless`] after `most` words; [`CoreError::TooMany`] if two results come in one cycle.
pub(crate) fn run(
    microcode: &Microcode,
    image: &Image,
    numbers: Numbers,
    outputs: usize,
    sections: u32,
    most: u64,
) -> Result<Made, CoreError> {
    let mut slots = vec![0_i64; 512];
    let mut coming: Vec<(u64, Slot, i64)> = Vec::new();
    let (mut at, mut cycle, mut calls, mut begun) = (0, 0_u64, Vec::new(), 0_u32);
    let (mut words, mut made) = (vec![0; outputs], Made::default());
    let mut asked = 0;
    for _ in 0..most {
        let Some(word) = microcode.words.get(at) else { break };
        coming.retain(|(when, to, value)| {
            let is_here = *when <= cycle;
            if is_here {
                slots[usize::from(*to)] = *value;
            }
            !is_here
        });
        let [a, b, c] = read(word, &slots, image);
        let (mut next, mut then) = (at + 1, cycle + 1 + u64::from(word.wait));
        match word.action {
            Action::Nothing => {}
            Action::Load(row) => {
                write(&mut coming, cycle + u64::from(CHOICE), word.to, row)?;
            }
            Action::Compute(Op::Output(OUTPUT_WHOLE)) => {
                made.whole(&words, cycle + u64::from(SUM) - asked);
            }
            Action::Compute(Op::Output(OUTPUT_DONE)) => made.done(cycle + u64::from(SUM) - asked),
            Action::Compute(Op::Output(place)) => {
                words.iter_mut().skip(place.into()).take(1).for_each(|word| *word = a)
            }
            Action::Compute(op) => {
                let value = match op {
                    Op::Input => i64::from(begun) - 1,
                    op if !is_held(op, b) => UNDEFINED,
                    op => numbers.value(op, [a, b, c]),
                };
                write(&mut coming, cycle + u64::from(latency(op, numbers)), word.to, value)?;
            }
            Action::Branch { compare, on } => {
                if compare.holds(a, b) == on {
                    (next, then) = (word.target, cycle + 1 + u64::from(BUBBLE));
                }
            }
            Action::Jump | Action::Call => {
                if word.action == Action::Call {
                    calls.push(at + 1);
                }
                (next, then) = (word.target, cycle + 1 + u64::from(BUBBLE));
            }
            Action::Return => {
                next = calls.pop().unwrap_or(usize::MAX);
                then = cycle + 1 + u64::from(BUBBLE);
            }
            Action::Wait(Event::Start) => {
                if begun == sections {
                    return Ok(made);
                }
                begun += 1;
                made.sections.push(SectionPace::default());
            }
            Action::Wait(Event::Taken) => {
                made.asked(cycle - asked);
                asked = cycle;
            }
        }
        (at, cycle) = (next, then);
    }
    Err(CoreError::Endless { steps: most })
}

/// What stands in a result that the core does not give as the formula says. It is made ahead of a branch that leads elsewhere, and
/// read by nobody: else the run differs from that of the blocks, and the part is refused.
const UNDEFINED: i64 = 0x5a5a_a5a5_3c3c_c3c3;

/// Whether the core's shifter does what the formula says.
fn is_held(op: Op, distance: i64) -> bool {
    match op {
        Op::ShiftLeft | Op::ShiftRight => (0..=255).contains(&distance),
        Op::Scale => (-255..=255).contains(&distance),
        Op::ToPhase => (0..=63).contains(&distance),
        Op::PowerOfTwo => false,
        _ => true,
    }
}

fn write(coming: &mut Vec<(u64, Slot, i64)>, when: u64, to: Slot, value: i64) -> Result<(), CoreError> {
    if coming.iter().any(|(other, ..)| *other == when) {
        return Err(CoreError::TooMany { what: "results in one cycle", needed: 2, most: 1 });
    }
    coming.push((when, to, value));
    Ok(())
}

fn read(word: &Word, slots: &[i64], image: &Image) -> [i64; 3] {
    word.sources.map(|source| match source {
        Source::Slot(slot) => slots[usize::from(slot)],
        Source::Table { pointer, column } => {
            let address = slots[usize::from(pointer)] | i64::from(column);
            usize::try_from(address).ok().and_then(|address| image.words.get(address)).copied().unwrap_or(0)
        }
    })
}
