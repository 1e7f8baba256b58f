//! Little-endian numbers, taken from bytes one after the other.

use real::FromWord;

/// The bytes that are left.
pub(crate) struct Bytes<'a>(pub(crate) &'a [u8]);

impl Bytes<'_> {
    /// The next N bytes; `None` if there are fewer.
    pub(crate) fn next<const N: usize>(&mut self) -> Option<[u8; N]> {
        let (first, rest) = self.0.split_first_chunk()?;
        self.0 = rest;
        Some(*first)
    }

    pub(crate) fn u8(&mut self) -> Option<u8> {
        self.next().map(u8::from_le_bytes)
    }

    pub(crate) fn i8(&mut self) -> Option<i8> {
        self.next().map(i8::from_le_bytes)
    }

    pub(crate) fn u16(&mut self) -> Option<u16> {
        self.next().map(u16::from_le_bytes)
    }

    pub(crate) fn u32(&mut self) -> Option<u32> {
        self.next().map(u32::from_le_bytes)
    }

    pub(crate) fn i16(&mut self) -> Option<i16> {
        self.next().map(i16::from_le_bytes)
    }

    pub(crate) fn i32(&mut self) -> Option<i32> {
        self.next().map(i32::from_le_bytes)
    }

    pub(crate) fn u64(&mut self) -> Option<u64> {
        self.next().map(u64::from_le_bytes)
    }

    pub(crate) fn i64(&mut self) -> Option<i64> {
        self.next().map(i64::from_le_bytes)
    }

    /// A number of the format, in as many bytes as its word has.
    pub(crate) fn number<R: FromWord>(&mut self) -> Option<R> {
        let (first, rest) = self.0.split_at_checked(R::BYTES)?;
        self.0 = rest;
        let mut word = [0; 8];
        word.iter_mut().zip(first).for_each(|(to, byte)| *to = *byte);
        Some(R::from_word(u64::from_le_bytes(word)))
    }

    /// N of what `one` takes; `None` if one of them is not there.
    pub(crate) fn array<T: Copy + Default, const N: usize>(
        &mut self,
        one: impl Fn(&mut Self) -> Option<T>,
    ) -> Option<[T; N]> {
        let mut all = [T::default(); N];
        for slot in &mut all {
            *slot = one(self)?;
        }
        Some(all)
    }
}
