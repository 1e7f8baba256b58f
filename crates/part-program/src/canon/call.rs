//! One line that `rs274` prints: its own number, the N word of the block, and the call of a canonical function.
//!
//! ```text
//!    10 N..... STRAIGHT_FEED(3.0000, 6.0000, 0.0000, 0.0000, 0.0000, 0.0000)
//!    11 N120   SET_SPINDLE_MODE(0 0.0000)
//!    12 N1234567FLOOD_ON()
//! ```
//!
//! Numbers are separated by commas or by blanks alone. An N word of more than six digits has no blank behind it.

use crate::source::Span;

/// The most numbers that a call has.
const MAX_NUMBERS: usize = 16;

/// The call of a canonical function.
#[derive(Clone, Copy, Debug, PartialEq)]
pub(crate) struct Call<'t> {
    /// `STRAIGHT_FEED`.
    pub(crate) name: &'t str,
    /// The text between the parentheses; `None` if there are no parentheses.
    pub(crate) arguments: Option<&'t str>,
    /// From the name to the end of the line.
    pub(crate) span: Span,
}

impl<'t> Call<'t> {
    /// The call in a line that begins at byte `start` of the text; `None` if the line does not begin as `rs274` begins it.
    pub(crate) fn of(line: &'t str, start: usize) -> Option<Self> {
        let numbered = line.trim_start();
        let block = numbered.trim_start_matches(|c: char| c.is_ascii_digit());
        let is_numbered = block.len() < numbered.len() && block.starts_with([' ', '\t']);
        let block = block.trim_start().strip_prefix('N').filter(|_| is_numbered)?;
        let call = block.trim_start_matches(|c: char| c.is_ascii_digit() || c == '.').trim_start();
        let is_name = |c: char| c.is_ascii_uppercase() || c.is_ascii_digit() || c == '_' || c == '.';
        let rest = call.trim_start_matches(is_name);
        let name = call.get(..call.len() - rest.len())?;
        let is_canonical = name.len() > 3 && name.starts_with(|c: char| c.is_ascii_uppercase());
        if !is_canonical || !rest.starts_with('(') {
            return None;
        }
        let arguments = rest.trim_end().strip_prefix('(').and_then(|rest| rest.strip_suffix(')'));
        let from = start + line.len() - call.len();
        Some(Self { name, arguments, span: Span::new(from, from + call.trim_end().len()) })
    }

    /// The numbers between the parentheses; `None` if there is anything else.
    pub(crate) fn numbers(&self) -> Option<Numbers> {
        let mut numbers = Numbers { values: [0.0; MAX_NUMBERS], count: 0 };
        let words = self.arguments?.split([',', ' ']).filter(|word| !word.is_empty());
        for word in words {
            let value = word.parse::<f64>().ok().filter(|value| value.is_finite())?;
            *numbers.values.get_mut(numbers.count)? = value;
            numbers.count += 1;
        }
        Some(numbers)
    }
}

/// The numbers of a call.
#[derive(Clone, Copy, Debug)]
pub(crate) struct Numbers {
    values: [f64; MAX_NUMBERS],
    count: usize,
}

impl Numbers {
    /// The first `N`, if there are so many, and those that follow.
    pub(crate) fn split<const N: usize>(&self) -> Option<([f64; N], &[f64])> {
        let (first, rest) = self.values.get(..self.count)?.split_first_chunk::<N>()?;
        Some((*first, rest))
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn lines_are_told_from_blocks() {
        let name = |line| Call::of(line, 0).map(|call| call.name);
        assert_eq!(name("    1 N..... USE_LENGTH_UNITS(CANON_UNITS_MM)"), Some("USE_LENGTH_UNITS"));
        assert_eq!(name("   12 N1234567FLOOD_ON()\r\n"), Some("FLOOD_ON"));
        assert_eq!(
            name("  9 N10    SPINDLE.0.WAIT_ORIENT_COMPLETE(1.0)"),
            Some("SPINDLE.0.WAIT_ORIENT_COMPLETE")
        );
        for other in [
            "",
            "executing",
            "N10 G1 X5 (FEED)",
            "10 N10 G1(FEED)",
            "10 N..... G1 X5",
            "1N.....FLOOD_ON()",
            "1 N1",
        ] {
            assert_eq!(name(other), None, "{other}");
        }
    }

    #[test]
    fn numbers_are_apart_by_commas_or_blanks() {
        fn numbers(line: &str) -> Option<Vec<f64>> {
            Call::of(line, 0)?.numbers().map(|numbers| numbers.values[..numbers.count].to_vec())
        }
        assert_eq!(numbers("1 N..... SET_SPINDLE_MODE(0 0.5000)"), Some(vec![0.0, 0.5]));
        assert_eq!(
            numbers("1 N..... USE_TOOL_LENGTH_OFFSET(0 0 1, 0 0 2)"),
            Some(vec![0.0, 0.0, 1.0, 0.0, 0.0, 2.0])
        );
        assert_eq!(numbers("1 N..... ON_RESET()"), Some(vec![]));
        for wrong in
            ["X(1", "X_Y_Z(1, b)", "X_Y_Z(nan)", "X_Y_Z(inf)", "X_Y_Z(1,2,3,4,5,6,7,8,9,0,1,2,3,4,5,6,7)"]
        {
            let line = format!("1 N..... {wrong}");
            assert_eq!(numbers(&line), None, "{wrong}");
        }
    }
}
