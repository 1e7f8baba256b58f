//! Text from outside, such as a part's name, in a comment of a file that is generated.

/// Replaces what would end a comment or its line in C, Rust, VHDL or MATLAB, what a compiler reads in comments too, and
/// what would change the order of the text on a screen.
#[must_use]
pub fn in_a_comment(text: &str) -> String {
    let is_odd = |c: char| {
        c.is_control()
            || matches!(c, '\u{200e}'..='\u{200f}' | '\u{2028}'..='\u{202e}' | '\u{2066}'..='\u{2069}')
    };
    // `??/` is a backslash, and a backslash at a line's end joins it with the next.
    text.replace(is_odd, "?")
        .replace("*/", "* /")
        .replace("/*", "/ *")
        .replace("??", "? ?")
        .replace('\\', "/")
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn no_name_ends_a_comment() {
        assert_eq!(in_a_comment("part.nc"), "part.nc");
        assert_eq!(in_a_comment("a */ int x; /* b"), "a * / int x; / * b");
        for odd in ["/*/", "*/*/", "a\nb", "a\u{202e}b", "what??/", "end\\"] {
            let text = in_a_comment(odd);
            assert!(!text.contains("*/") && !text.contains("/*") && !text.contains("??"), "{text}");
            assert!(!text.contains(['\n', '\\', '\u{202e}']), "{text}");
        }
    }
}
