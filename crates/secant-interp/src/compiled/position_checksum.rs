//! A checksum that shows whether two machines made the same run.

/// A checksum over 64-bit words: the coordinates of one position after the other, as
/// [`Pieces::position`](nurbs_core::Pieces::position) gives them.
///
/// For each word `h ← (h ⊕ word) · 0x100000001b3` modulo 2⁶⁴, then `h ← h ⊕ ⌊h/2³²⌋`, starting with
/// `h = 0xcbf29ce484222325`. Both operations are bijections, so runs that differ in one word differ in the checksum;
/// runs that differ in more words very likely do. A person can construct two runs with the same checksum.
///
/// # Source
/// The multiplier and the start value are those of Fowler G., Noll L. C., Vo K.-P., Eastlake D., "The FNV
/// Non-Cryptographic Hash Algorithm", which takes the input byte by byte. The second operation brings high bits down,
/// because coordinates on whole mm have no low bits.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub struct PositionChecksum(u64);

impl Default for PositionChecksum {
    fn default() -> Self {
        Self(0xcbf2_9ce4_8422_2325)
    }
}

impl PositionChecksum {
    /// Takes the next position.
    pub fn add<const D: usize>(&mut self, position: [i64; D]) {
        for word in position {
            self.0 = (self.0 ^ word.cast_unsigned()).wrapping_mul(0x100_0000_01b3);
            self.0 ^= self.0 >> 32;
        }
    }

    /// The checksum of the positions so far.
    #[must_use]
    pub fn value(&self) -> u64 {
        self.0
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use proptest::prelude::*;

    fn of(positions: &[[i64; 2]]) -> u64 {
        let mut checksum = PositionChecksum::default();
        positions.iter().for_each(|position| checksum.add(*position));
        checksum.value()
    }

    /// Computed from the formula by another language's integers.
    #[test]
    fn it_is_the_formula() {
        assert_eq!(PositionChecksum::default().value(), 0xcbf2_9ce4_8422_2325);
        let mut checksum = PositionChecksum::default();
        checksum.add([i64::from(b'a')]);
        assert_eq!(checksum.value(), 0xaf63_dc4c_2962_30c0);
        assert_eq!(of(&[[-1, 1 << 39]]), 0x5b8a_a6ef_0a19_fa68);
    }

    #[test]
    fn positions_on_whole_millimetres_differ() {
        let grid = (0..300_i64).flat_map(|x| (0..300_i64).map(move |y| of(&[[x << 39, y << 39]])));
        let found: std::collections::BTreeSet<u64> = grid.collect();
        assert_eq!(found.len(), 300 * 300);
        assert_ne!(of(&[[0, 0]]), of(&[[i64::MIN, i64::MIN]]));
    }

    proptest! {
        #[test]
        fn one_coordinate_makes_a_difference(
            run in prop::collection::vec(any::<[i64; 2]>(), 1..20), at: prop::sample::Index, axis in 0..2_usize, by in 1..i64::MAX,
        ) {
            let mut other = run.clone();
            let changed = &mut other[at.index(run.len())][axis];
            *changed = changed.wrapping_add(by);
            prop_assert_ne!(of(&run), of(&other));
        }
    }
}
