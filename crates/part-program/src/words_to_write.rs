//! Words that do not move the tool, each at its move.

use crate::auxiliary::Auxiliary;

/// Words that do not move the tool and are still to be written, in the order of the program.
pub(crate) struct Words<'w, 'p>(pub(crate) &'w [&'p Auxiliary]);

impl<'w, 'p> Words<'w, 'p> {
    /// Takes those of the blocks before one.
    pub(crate) fn before(&mut self, block: u32) -> &'w [&'p Auxiliary] {
        let (before, rest) = self.0.split_at(self.0.partition_point(|word| word.block < block));
        self.0 = rest;
        before
    }

    /// Takes those of a move's own block, if `is_last` of its moves: ahead of the move, and behind it.
    pub(crate) fn of_block(&mut self, block: u32, is_last: bool) -> [Vec<&'p Auxiliary>; 2] {
        let own = if is_last { self.before(block.saturating_add(1)) } else { &[] };
        let (behind, ahead) = own.iter().copied().partition(|word| word.is_behind());
        [ahead, behind]
    }
}

impl Auxiliary {
    /// Whether the word acts when the move of its block is over.
    fn is_behind(&self) -> bool {
        self.letter == 'M' && [0.0, 1.0, 5.0, 9.0].contains(&self.value)
    }
}
