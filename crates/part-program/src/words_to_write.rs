//! Words that do not move the tool, each written at its move.

use crate::auxiliary::Auxiliary;

/// Words that do not move the tool and are still to be written, in the order of the program.
pub(crate) struct Words<'w, 'p>(pub(crate) &'w [&'p Auxiliary]);

impl<'w, 'p> Words<'w, 'p> {
    /// Takes the words of the blocks before a block.
    pub(crate) fn before(&mut self, block: u32) -> &'w [&'p Auxiliary] {
        let (before, rest) = self.0.split_at(self.0.partition_point(|word| word.block < block));
        self.0 = rest;
        before
    }

    /// Takes the words of a move's own block, if `is_last` of its moves: those ahead of the move, and those behind it.
    pub(crate) fn of_block(&mut self, block: u32, is_last: bool) -> [Vec<&'p Auxiliary>; 2] {
        let own = if is_last { self.before(block.saturating_add(1)) } else { &[] };
        let (behind, ahead) = own.iter().copied().partition(|word| word.is_behind());
        [ahead, behind]
    }
}

impl Auxiliary {
    /// Whether the word acts after the move of its block.
    fn is_behind(&self) -> bool {
        self.letter == 'M' && [0.0, 1.0, 5.0, 9.0].contains(&self.value)
    }
}
