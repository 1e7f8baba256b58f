//! Which instructions belong to which call.
//!
//! The firmware makes its calls in a known order, so a call is told by its turn and only confirmed by its address: the
//! linker may have merged kernels that are the same code.

use std::collections::{BTreeMap, VecDeque};

use kernel::Record;

use crate::Failure;
use crate::emulator::Executed;
use crate::instruction::Class;

/// Executions of one class.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq)]
pub(crate) struct Tally {
    pub(crate) count: u64,
    /// Of them, branches that were taken.
    pub(crate) taken: u64,
    /// Words that loads and stores of several moved.
    pub(crate) words: u64,
}

/// What a group of calls executed.
#[derive(Clone, Debug, Default)]
pub(crate) struct Counts {
    /// Instructions of each call.
    pub(crate) calls: Vec<u64>,
    /// Executions by class, over all calls.
    pub(crate) classes: BTreeMap<Class, Tally>,
}

impl Counts {
    pub(crate) fn total(&self) -> u64 {
        self.calls.iter().sum()
    }
}

/// A call in progress.
struct Call {
    /// The address at which it is over.
    back: u32,
    instructions: u64,
}

/// Follows the stream from call to call.
pub(crate) struct Walk {
    /// Groups still to come: address of the kernel, calls left.
    expected: VecDeque<(u32, u32)>,
    /// Groups that are over.
    done: Vec<Counts>,
    /// The group of the next call.
    current: Counts,
    call: Option<Call>,
    before: Option<Executed>,
}

impl Walk {
    pub(crate) fn new(records: &[Record], symbols: &BTreeMap<String, u32>) -> Result<Self, Failure> {
        let expected = records
            .iter()
            .map(|record| {
                let address = symbols.get(record.symbol);
                address
                    .map(|a| (*a, record.calls))
                    .ok_or_else(|| format!("the image has no `{}`", record.symbol))
            })
            .collect::<Result<_, _>>()?;
        Ok(Self { expected, done: Vec::new(), current: Counts::default(), call: None, before: None })
    }

    /// The next executed instruction.
    pub(crate) fn step(&mut self, executed: Executed) -> Result<(), Failure> {
        let before = self.before.replace(executed);
        if let Some(call) = &mut self.call {
            // Whether the last branch was taken is known only now, and it may be the last instruction of the call.
            if let Some(before) = before
                && executed.address != before.address + before.instruction.bytes
            {
                self.current.classes.entry(before.instruction.class).or_default().taken += 1;
            }
            if executed.address == call.back {
                let instructions = call.instructions;
                self.leave(instructions);
            }
        }
        if self.call.is_none() {
            self.enter(before, executed);
        }
        if let Some(call) = &mut self.call {
            call.instructions += 1;
            let tally = self.current.classes.entry(executed.instruction.class).or_default();
            tally.count += 1;
            tally.words += u64::from(executed.instruction.words);
        }
        Ok(())
    }

    fn enter(&mut self, before: Option<Executed>, executed: Executed) {
        let (Some(before), Some((address, _))) = (before, self.expected.front()) else { return };
        if executed.address == *address && before.instruction.class == Class::Call {
            self.call = Some(Call { back: before.address + before.instruction.bytes, instructions: 0 });
        }
    }

    /// A call is over, and with the last of its group the group.
    fn leave(&mut self, instructions: u64) {
        self.call = None;
        self.current.calls.push(instructions);
        if let Some((_, left)) = self.expected.front_mut() {
            *left -= 1;
            if *left == 0 {
                self.expected.pop_front();
                self.done.push(std::mem::take(&mut self.current));
            }
        }
    }

    /// The counts of all groups, in the order of the records.
    pub(crate) fn finish(self) -> Result<Vec<Counts>, Failure> {
        match self.expected.len() {
            0 => Ok(self.done),
            left => Err(format!("the run ended with {left} groups of calls still expected").into()),
        }
    }
}
