//! A number by which two machines know that they made the same run.

/// FNV-1a over 64-bit words: the coordinates of one position after the other, as
/// [`Pieces::position`](nurbs_core::Pieces::position) gives them.
///
/// `h ← (h ⊕ word) · 0x100000001b3` modulo 2⁶⁴, from `h = 0xcbf29ce484222325` on. Runs that differ in one coordinate differ in
/// it, for every step is a bijection; of other runs one in 2⁶⁴ does not.
///
/// # Source
/// Fowler G., Noll L. C., Vo K.-P., Eastlake D., "The FNV Non-Cryptographic Hash Algorithm", which goes byte by byte.
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

    #[test]
    fn it_is_the_published_one_on_single_bytes() {
        // The published test vector of 64-bit FNV-1a for the byte "a"; a word below 256 is one byte of it.
        let mut checksum = PositionChecksum::default();
        assert_eq!(checksum.value(), 0xcbf2_9ce4_8422_2325);
        checksum.add([i64::from(b'a')]);
        assert_eq!(checksum.value(), 0xaf63_dc4c_8601_ec8c);
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
