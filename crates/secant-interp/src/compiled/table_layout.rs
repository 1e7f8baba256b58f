//! The version of the tables that a compiled run lies in.

/// The version of the tables' layout: of what [`PieceInterpolator`](crate::PieceInterpolator) and its rows hold, and of what
/// they mean. It changes when a field comes, goes, or changes its meaning. A [stream](crate::StreamReader) has a version of its
/// own, because its bytes are others.
pub const TABLE_LAYOUT: u16 = 1;

/// Tables of the layout V, as `feedbits compile` wrote them.
///
/// ```
/// const _: () = secant_interp::TablesOf::<{ secant_interp::TABLE_LAYOUT }>::ARE_READ;
/// ```
///
/// Tables of another layout do not compile. The error names both versions:
///
/// ```compile_fail,E0080
/// const _: () = secant_interp::TablesOf::<99>::ARE_READ;
/// ```
#[derive(Clone, Copy, Debug)]
pub struct TablesOf<const V: u16>;

impl<const V: u16> TablesOf<V> {
    /// Compiles only where these kernels read the layout V.
    pub const ARE_READ: () = assert!(V == TABLE_LAYOUT, "{}", Self::REFUSAL.text());

    /// What the compiler says otherwise.
    const REFUSAL: Refusal = Refusal::of(V, TABLE_LAYOUT);
}

/// Room for the message with two numbers of up to five digits.
const MOST: usize = 128;

/// A message that is put together while a program is compiled.
struct Refusal {
    bytes: [u8; MOST],
    length: usize,
}

impl Refusal {
    const fn of(found: u16, expected: u16) -> Self {
        Self { bytes: [0; MOST], length: 0 }
            .with(b"the tables have layout ")
            .with_number(found)
            .with(b", and these kernels read layout ")
            .with_number(expected)
            .with(b": run `feedbits compile` again")
    }

    const fn with(mut self, text: &[u8]) -> Self {
        let mut at = 0;
        while at < text.len() && self.length < MOST {
            self.bytes[self.length] = text[at];
            (at, self.length) = (at + 1, self.length + 1);
        }
        self
    }

    const fn with_number(self, number: u16) -> Self {
        let before = if number < 10 { self } else { self.with_number(number / 10) };
        before.with(&[b'0' + (number % 10).to_le_bytes()[0]])
    }

    const fn text(&self) -> &str {
        match core::str::from_utf8(self.bytes.split_at(self.length).0) {
            Ok(text) => text,
            Err(_) => "the tables have another layout",
        }
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn a_refusal_names_both_versions() {
        let expected =
            "the tables have layout 65535, and these kernels read layout 7: run `feedbits compile` again";
        assert_eq!(Refusal::of(u16::MAX, 7).text(), expected);
    }
}
