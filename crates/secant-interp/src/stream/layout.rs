//! How long the parts of a stream are. `docs/stream.md` has every byte.

/// The first eight bytes of a stream.
pub(crate) const MAGIC: [u8; 8] = *b"feedbits";

/// The version of the layout. It changes when a byte changes its place or its meaning.
pub(crate) const LAYOUT: u16 = 2;

/// Bytes of the head of a section: they say how many bytes the section has.
pub const SECTION_HEAD_BYTES: usize = 28;

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
        self.row_bytes() + self.number * (2 + self.degree * self.dimension + self.weights())
    }

    /// Bytes of a straight piece in its short row: the same with one step per chord, the words by which the other lies beside
    /// what this implies, and one coefficient a coordinate. In the plane and in space, in numbers of 32 bits, 36 and 48 bytes.
    pub(crate) fn straight_bytes(&self) -> usize {
        self.row_bytes() + self.beside_bytes() + self.number * (1 + self.dimension)
    }

    /// Bytes of origin, exponents and joint.
    fn row_bytes(&self) -> usize {
        8 * self.dimension + 7
    }

    /// Bytes of the words by which a step per chord lies beside: two for numbers of 64 bits, whose range is computed in floats.
    pub(crate) fn beside_bytes(&self) -> usize {
        if self.number > 4 { 2 } else { 1 }
    }

    /// Bytes of a stage: duration, shape and three numbers.
    pub(crate) fn stage_bytes(&self) -> usize {
        8 + 1 + 3 * self.number
    }

    /// Bytes of a section; `None` where no machine has that many, or there are more straight pieces than pieces.
    pub(crate) fn section_bytes(&self, rows: &SectionRows) -> Option<usize> {
        let curved = self.piece_bytes().checked_mul(rows.pieces.checked_sub(rows.straight)?)?;
        let straight = self.straight_bytes().checked_mul(rows.straight)?;
        let stages = self.stage_bytes().checked_mul(rows.stages)?;
        (SECTION_HEAD_BYTES + CRC_BYTES).checked_add(curved)?.checked_add(straight)?.checked_add(stages)
    }
}

/// How many rows a section has.
#[derive(Clone, Copy, Debug)]
pub(crate) struct SectionRows {
    pub(crate) pieces: usize,
    /// Those of the pieces that have the short row of a straight one.
    pub(crate) straight: usize,
    pub(crate) stages: usize,
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn a_straight_move_of_32_bits_takes_48_bytes_at_most() {
        for (dimension, bytes) in [(2, 36), (3, 48)] {
            for (degree, has_weights) in [(1, false), (2, true), (3, false), (9, true)] {
                let shape = RowShape { dimension, degree, has_weights, number: 4 };
                assert_eq!(shape.straight_bytes(), bytes);
                assert!(shape.piece_bytes() >= bytes + 3);
            }
        }
    }
}
