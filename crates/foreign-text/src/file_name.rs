//! Text in the name of a file.

use crate::kept;

/// The longest name, in bytes. Systems of files take 255, some of which endings and unfinished files need.
const LONGEST: usize = 100;

/// The text as the name of a file in a folder that is known: letters and digits of ASCII, `-`, `_` and `.`, at most 100, the first of
/// them a letter or a digit. Everything else becomes a `_`.
///
/// Different texts may have the same name.
#[must_use]
pub fn in_a_file_name(text: &str) -> String {
    let name = kept(text, |c| c.is_ascii_alphanumeric() || matches!(c, '-' | '_' | '.'), '_');
    let name = name.trim_start_matches(['-', '_', '.']);
    let name = name.get(..LONGEST).unwrap_or(name);
    if name.is_empty() { "nameless".to_string() } else { name.to_string() }
}

#[cfg(test)]
mod tests {
    use std::path::{Component, Path};

    use proptest::prelude::*;

    use super::*;
    use crate::hostile::NAMES;

    #[test]
    fn plain_names_stay() {
        for plain in ["cortex-m4f", "path-I4F28_pieces-xz", "c28x.1"] {
            assert_eq!(in_a_file_name(plain), plain);
        }
        assert_eq!(in_a_file_name("I4F28-floor raw, taylor 1"), "I4F28-floor_raw_taylor_1");
        assert_eq!(in_a_file_name("../a/b"), "a_b");
        assert_eq!(in_a_file_name("-rf"), "rf");
        assert_eq!(in_a_file_name("/"), "nameless");
    }

    proptest! {
        #[test]
        fn every_text_is_one_file_of_its_folder(text in any::<String>(), odd in r"[-./\\:_~$\x00 ]{0,9}") {
            for text in NAMES.into_iter().chain([text.as_str(), &odd, &format!("{odd}{text}")]) {
                let name = in_a_file_name(text);
                let parts: Vec<_> = Path::new(&name).components().collect();
                prop_assert!(matches!(parts[..], [Component::Normal(part)] if part == name.as_str()), "{name:?}");
                prop_assert!(name.is_ascii() && name.len() <= LONGEST && !name.contains(['\\', ':']), "{name:?}");
                prop_assert_eq!(in_a_file_name(&name), name);
            }
        }
    }
}
