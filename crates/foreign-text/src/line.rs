//! Text that a person reads: on a page, in a picture, on a terminal.

use crate::kept;

/// Whether a character is a letter, a digit, a space or a mark that can be seen. Those that move the cursor, hide, or change the order
/// of the text are none of these.
#[must_use]
pub fn is_printable(c: char) -> bool {
    c.is_alphanumeric()
        || matches!(c,
            ' '..='~'
            // Latin marks without the soft hyphen: ° ² µ · × and others.
            | '\u{a1}'..='\u{ac}' | '\u{ae}'..='\u{bf}' | '×' | '÷'
            // Dashes, quotes, dots and primes; not the separators of lines and the marks of direction that stand among them.
            // The narrow space divides the digits of a number.
            | '\u{2010}'..='\u{2027}' | '\u{202f}'..='\u{205e}'
            // Signs up and down of a line, currencies, arrows, operators, technical signs.
            | '\u{207a}'..='\u{207e}' | '\u{208a}'..='\u{208e}' | '\u{20a0}'..='\u{20c0}' | '\u{2190}'..='\u{23ff}'
            // Lines, shapes, marks; and what stands for a character that is none.
            | '\u{2500}'..='\u{27bf}' | '\u{fffd}')
}

/// The text in one line: letters, digits, spaces and visible marks.
#[must_use]
pub fn in_a_line(text: &str) -> String {
    kept(text, is_printable, '?')
}

/// As [`in_a_line`], with the ends of lines.
///
/// This is for a whole page or picture whose text is escaped already, and for a message.
#[must_use]
pub fn in_lines(text: &str) -> String {
    kept(text, |c| c == '\n' || is_printable(c), '?')
}

#[cfg(test)]
mod tests {
    use proptest::prelude::*;

    use super::*;
    use crate::hostile::NAMES;

    #[test]
    fn what_people_write_stays() {
        for plain in
            ["Gehäuse 2.nc", "|δ| ≤ 1.0·10⁻⁶, 3 mm/s² × ½ – “a” → ✗…", "часть.nc", "部品.nc", "<a & \"b\">"]
        {
            assert_eq!(in_a_line(plain), plain);
        }
        assert_eq!((in_a_line("a\nb"), in_lines("a\r\nb")), ("a?b".to_string(), "a?\nb".to_string()));
    }

    /// Characters that act: controls, separators of lines, and the formats of Unicode's chapters 23.2 and 23.3.
    fn acts(c: char) -> bool {
        c.is_control()
            || matches!(c, '\u{ad}' | '\u{61c}' | '\u{180e}' | '\u{200b}'..='\u{200f}' | '\u{2028}'..='\u{202e}'
                | '\u{2060}'..='\u{206f}' | '\u{feff}' | '\u{fff9}'..='\u{fffb}' | '\u{fffe}' | '\u{ffff}' | '\u{e0000}'..='\u{e007f}')
    }

    #[test]
    fn no_character_that_acts_is_printable() {
        assert!(('\0'..=char::MAX).filter(|c| acts(*c)).all(|c| !is_printable(c)));
        assert!(NAMES.iter().all(|name| !in_a_line(name).contains(acts)));
    }

    proptest! {
        #[test]
        fn no_text_acts(text in any::<String>()) {
            prop_assert!(!in_a_line(&text).contains(acts));
            prop_assert!(!in_lines(&text).replace('\n', "").contains(acts));
            prop_assert_eq!(in_lines(&text).matches('\n').count(), text.matches('\n').count());
        }
    }
}
