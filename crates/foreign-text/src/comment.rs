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

    /// Where a compiler of C sees the end of the comment with which `text` begins: trigraphs are replaced and lines joined first.
    fn end_of_comment(text: &str, end: &str) -> Option<usize> {
        let replaced = text.replace("??/", "\\");
        let joined = replaced.replace("\\\r\n", "").replace("\\\n", "");
        joined.get(2..)?.find(end).map(|at| 2 + at + end.len()).filter(|_| joined.len() == text.len())
    }

    /// The comments of C that hold a text, with code behind them, end where they were written to end.
    fn ends_where_it_should(text: &str) -> bool {
        let (block, line) = (format!("/* {text} */"), format!("// {text}\n"));
        end_of_comment(&format!("{block}int x;\n"), "*/") == Some(block.len())
            && end_of_comment(&format!("{line}int x;\n"), "\n") == Some(line.len())
    }

    #[test]
    fn no_name_ends_a_comment() {
        let hostile = ["a */ int x; /* b", "*/*/", "*\\\n/", "*??/\n/", "what??/", "end\\", "line\nint x;"];
        // As they are, these do: the rules above see it.
        for name in hostile {
            assert!(!ends_where_it_should(name) && !is_harmless(name), "{name:?}");
        }
        let mut would = 0;
        for name in NAMES.into_iter().chain(hostile).chain(["*\\", "\\*/"]) {
            would += u32::from(!ends_where_it_should(name));
            let named = in_a_comment(name);
            assert!(is_harmless(&named) && ends_where_it_should(&named), "{name:?}");
        }
        assert!(would >= 12, "{would} of the names would end a comment");
    }

    proptest! {
        #[test]
        fn no_text_ends_a_comment(text in ".*", odd in r"[*/\\?%{}#\r\n-]{0,9}") {
            for text in [&text, &odd, &format!("{odd}{text}{odd}")] {
                let once = in_a_comment(text);
                prop_assert!(is_harmless(&once) && ends_where_it_should(&once), "{once:?}");
                prop_assert_eq!(&in_a_comment(&once), &once);
                prop_assert!(once.len() <= text.len());
            }
        }
    }
}
