//! How long the parts of a stream are. `docs/stream.md` has every byte.

/// The first eight bytes of a stream.
pub(crate) const MAGIC: [u8; 8] = *b"feedbits";

/// The version of the layout. It changes when a byte changes its place or its meaning.
pub(crate) const LAYOUT: u16 = 1;

/// Bytes of the head of a section: they say how many bytes the section has.
pub const SECTION_HEAD_BYTES: usize = 24;

/// Bytes of a CRC.
pub(crate) const CRC_BYTES: usize = 4;

/// What the lengths of rows depend on.
#[derive(Clone, Copy, Debug)]
pub(crate) struct RowShape {
    /// D.
    pub(crate) dimension: usize,
    /// p.
    pub(crate) degree: usize,
    /// Whether pieces have weights.
    pub(crate) has_weights: bool,
    /// Bytes of a number of the format.
    pub(crate) number: usize,
}

impl RowShape {
    /// Weights of a piece.
    pub(crate) fn weights(&self) -> usize {
        if self.has_weights { self.degree + 1 } else { 0 }
    }

    /// Bytes of a piece: its origin, seven bytes of exponents and joint, two steps per chord, and its coefficients.
    pub(crate) fn piece_bytes(&self) -> usize {
        8 * self.dimension + 7 + self.number * (2 + self.degree * self.dimension + self.weights())
    }

    /// Bytes of a stage: duration, shape and three numbers.
    pub(crate) fn stage_bytes(&self) -> usize {
        8 + 1 + 3 * self.number
    }

    /// Bytes of a section; `None` where no machine has that many.
    pub(crate) fn section_bytes(&self, pieces: usize, stages: usize) -> Option<usize> {
        let pieces = self.piece_bytes().checked_mul(pieces)?;
        let stages = self.stage_bytes().checked_mul(stages)?;
        (SECTION_HEAD_BYTES + CRC_BYTES).checked_add(pieces)?.checked_add(stages)
    }
}
