//! Text in a cell of a table in CSV.

use crate::line::in_a_line;

/// The text in a cell of a table in CSV, which the library then quotes.
///
/// A spreadsheet computes a cell that begins with `=`, `+`, `-` or `@`, so a `'` is put before it: the cell is then words. The same is
/// done after `,` and `;`, where a program that takes the other one for the separator begins a cell. For words alone: a number is
/// written as it is.
#[must_use]
pub fn in_a_cell(text: &str) -> String {
    let line = in_a_line(text);
    let mut cell = String::with_capacity(line.len());
    let mut begins = true;
    for c in line.chars() {
        if begins && matches!(c, '=' | '+' | '-' | '@') {
            cell.push('\'');
        }
        cell.push(c);
        begins = matches!(c, ',' | ';') || (begins && c == ' ');
    }
    cell
}

#[cfg(test)]
mod tests {
    use proptest::prelude::*;

    use super::*;
    use crate::hostile::NAMES;

    #[test]
    fn words_stay_and_formulas_become_words() {
        for plain in ["I4F28", "fluctuation 2.0e-5 > 1.0e-6; chord error", "refused: a-b", ""] {
            assert_eq!(in_a_cell(plain), plain);
        }
        assert_eq!(in_a_cell("=1+1.nc"), "'=1+1.nc");
        assert_eq!(in_a_cell(" @x"), " '@x");
        assert_eq!(in_a_cell("x;=1, -2"), "x;'=1, '-2");
        assert_eq!(in_a_cell("\t=1"), "?=1");
    }

    /// Whether a program that splits at `;` or at `,`, and ignores blanks, finds a formula.
    fn has_a_formula(cell: &str) -> bool {
        let cells = cell.split([';', ',']).map(|cell| cell.trim_start_matches([' ', '\t', '\r', '\n']));
        cells.into_iter().any(|cell| cell.starts_with(['=', '+', '-', '@']))
    }

    proptest! {
        #[test]
        fn no_text_is_a_formula(text in any::<String>(), odd in "[-=+@;, \t\r\n'\"]{0,9}") {
            for text in NAMES.into_iter().chain([text.as_str(), &odd, &format!("{odd}{text}")]) {
                let cell = in_a_cell(text);
                prop_assert!(!has_a_formula(&cell) && !cell.contains(char::is_control), "{cell:?}");
            }
        }
    }
}
