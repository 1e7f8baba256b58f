//! The step as blocks of operations on registers: what the front end writes, and what becomes microcode.

pub(crate) use crate::operation::{Numbers, OUTPUT_DONE, OUTPUT_WHOLE, Op, Operand, Operation, Register};
use crate::tables::Tables;

/// The place of a block in the program.
pub(crate) type BlockId = usize;

/// How a branch compares a and b.
#[derive(Clone, Copy, Debug, PartialEq, Eq, Hash)]
pub(crate) enum Compare {
    Equal,
    Less,
    AtMost,
    LessUnsigned,
    AtMostUnsigned,
    /// |a| ≤ b.
    WithinMagnitude,
}

impl Compare {
    pub(crate) fn holds(self, a: i64, b: i64) -> bool {
        match self {
            Self::Equal => a == b,
            Self::Less => a < b,
            Self::AtMost => a <= b,
            Self::LessUnsigned => a.cast_unsigned() < b.cast_unsigned(),
            Self::AtMostUnsigned => a.cast_unsigned() <= b.cast_unsigned(),
            Self::WithinMagnitude => a.saturating_abs() <= b,
        }
    }
}

/// What a program waits for.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub(crate) enum Event {
    /// A section shall begin.
    Start,
    /// The last setpoint was taken.
    Taken,
}

/// How a block ends.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub(crate) enum End {
    Jump(BlockId),
    Branch { compare: Compare, a: Operand, b: Operand, then: BlockId, other: BlockId },
    Call { entry: BlockId, then: BlockId },
    Return,
    Wait(Event, BlockId),
}

impl End {
    /// Where it leads within the same routine.
    pub(crate) fn targets(self) -> impl Iterator<Item = BlockId> {
        let [first, second] = match self {
            Self::Jump(to) | Self::Wait(_, to) | Self::Call { then: to, .. } => [Some(to), None],
            Self::Branch { then, other, .. } => [Some(then), Some(other)],
            Self::Return => [None, None],
        };
        first.into_iter().chain(second)
    }

    /// The same with other targets.
    pub(crate) fn with_targets(self, mut to: impl FnMut(BlockId) -> BlockId) -> Self {
        match self {
            Self::Jump(target) => Self::Jump(to(target)),
            Self::Wait(event, target) => Self::Wait(event, to(target)),
            Self::Call { entry, then } => Self::Call { entry, then: to(then) },
            Self::Branch { compare, a, b, then, other } => {
                Self::Branch { compare, a, b, then: to(then), other: to(other) }
            }
            Self::Return => Self::Return,
        }
    }
}

/// Operations one after the other.
#[derive(Clone, Debug)]
pub(crate) struct Block {
    pub(crate) operations: Vec<Operation>,
    pub(crate) end: End,
}

/// A program and its tables.
#[derive(Clone, Debug)]
pub(crate) struct Program {
    pub(crate) numbers: Numbers,
    pub(crate) blocks: Vec<Block>,
    pub(crate) entry: BlockId,
    pub(crate) registers: Register,
    pub(crate) tables: Tables,
    /// Constants that belong to the part, with their names.
    pub(crate) parameters: Vec<(String, i64)>,
    /// What each output word is, with its bits.
    pub(crate) outputs: Vec<(String, u32)>,
}
