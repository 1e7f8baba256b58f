//! Text in a comment of a language that is compiled.

use crate::kept;

/// Marks that mean nothing within a comment of C, C++, VHDL, MATLAB or Rust. Where one of them begins or ends a comment, it takes
/// another that is not here, or stands first: `/*`, `*/`, `%{`.
const MARKS: &str = " .,:;-_+=()/%<>`";

/// The text in a comment of C, C++, VHDL, MATLAB or Rust: one line of letters and digits of ASCII, spaces and `.,:;-_+=()/%<>` and
/// `` ` ``.
///
/// Neither `*` nor `\` passes, so the text ends no comment and joins no lines, and there are no two `?` in a row, so no trigraph
/// does either. Some tools take orders from the first words of a comment, as in `-- pragma translate_off`: whoever writes a comment
/// begins it with words of their own.
#[must_use]
pub fn in_a_comment(text: &str) -> String {
    kept(text, |c| c.is_ascii_alphanumeric() || MARKS.contains(c), '?')
}

#[cfg(test)]
mod tests {
    use proptest::prelude::*;

    use super::*;
    use crate::hostile::NAMES;

    #[test]
    fn plain_names_and_sentences_stay() {
        for plain in ["part.nc", "../parts/b-2_1 (new).nc at 200 mm/s, in I4F28", "`a` 1.2e-5 > 1e-6; 3 %"] {
            assert_eq!(in_a_comment(plain), plain);
        }
        assert_eq!(in_a_comment("Gehäuse.nc"), "Geh?use.nc");
        assert_eq!(in_a_comment("a\u{202e}\n\u{2028}b"), "a?b");
    }

    /// What each language takes for the end of a comment, the end of a line, or an order to its compiler.
    fn is_harmless(text: &str) -> bool {
        let acts = ["*", "\\", "??", "{", "}", "#", "@", "$", "\"", "'", "!", "[", "]", "\n", "\r", "\t"];
        text.is_ascii()
            && !text.bytes().any(|byte| byte < b' ' || byte == 0x7f)
            && !acts.iter().any(|one| text.contains(one))
    }

    #[test]
    fn no_name_ends_a_comment() {
        for name in NAMES.into_iter().chain(["a */ int x; /* b", "*/*/", "*\\", "\\*/", "what??/", "end\\"]) {
            assert!(is_harmless(&in_a_comment(name)), "{name:?}");
        }
    }

    proptest! {
        #[test]
        fn no_text_ends_a_comment(text in ".*", odd in r"[*/\\?%{}#\r\n-]{0,9}") {
            for text in [&text, &odd, &format!("{odd}{text}{odd}")] {
                let once = in_a_comment(text);
                prop_assert!(is_harmless(&once), "{once:?}");
                prop_assert_eq!(&in_a_comment(&once), &once);
                prop_assert!(once.len() <= text.len());
            }
        }
    }
}
