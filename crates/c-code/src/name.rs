//! The name with which all public names of the C files begin, and why files cannot be written.

use std::fmt;

use real::FormatName;

/// A name for the files `NAME.h` and `NAME.c`, and the begin of every public name in them: letters of ASCII, digits and
/// underscores, the first a letter, and no word of C.
#[derive(Clone, Debug, PartialEq, Eq)]
pub struct CName(String);

/// Why a path cannot be written in C.
#[derive(Clone, Debug, PartialEq, Eq)]
#[non_exhaustive]
pub enum CError {
    /// C has no type for the format.
    NoType(FormatName),
    /// A description has no numbers of the format.
    NoWidth(FormatName),
    /// The path has no pieces or no sections.
    Empty,
    /// The text is no identifier of C.
    Name(String),
    /// The run with feed override comes to no end.
    Unfinished,
    /// The path has more pieces or stages than an index of 32 bits can count.
    TooLong,
}

impl fmt::Display for CError {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        match self {
            Self::NoType(format) => {
                write!(
                    f,
                    "{format} is no type of C: expected a float, or fixed point of 8, 16, 32 or 64 bits"
                )
            }
            Self::NoWidth(format) => {
                write!(
                    f,
                    "the core has no numbers of {format}: expected fixed point of 16 to 32 bits that rounds to nearest and wraps"
                )
            }
            Self::Empty => f.write_str("the path has no pieces"),
            Self::Name(name) => write!(
                f,
                "{name:?} cannot begin names in C: expected letters of ASCII, digits and underscores, the first a letter, and no \
                 word of C"
            ),
            Self::Unfinished => {
                f.write_str("the run with feed override is not at the end of the path in time")
            }
            Self::TooLong => f.write_str("the path has more than 2^32 pieces or stages"),
        }
    }
}

impl std::error::Error for CError {}

/// Words that C keeps for itself, and those of the headers that the files include. A prefix is followed by an underscore,
/// so that only whole prefixes of such words matter.
const KEPT: [&str; 3] = ["int", "uint", "size"];

impl CName {
    /// The name, if C takes it.
    ///
    /// # Errors
    /// [`CError::Name`].
    pub fn try_new(name: &str) -> Result<Self, CError> {
        let is_word = name.bytes().all(|c| c.is_ascii_alphanumeric() || c == b'_');
        let begins = name.bytes().next().is_some_and(|c| c.is_ascii_alphabetic());
        let is_short = name.len() <= 31;
        let is_kept = KEPT.contains(&name.to_ascii_lowercase().as_str());
        if is_word && begins && is_short && !is_kept {
            Ok(Self(name.to_owned()))
        } else {
            Err(CError::Name(name.to_owned()))
        }
    }

    /// The name as it is given.
    #[must_use]
    pub fn as_str(&self) -> &str {
        &self.0
    }

    /// The name as the begin of macros.
    #[must_use]
    pub fn upper(&self) -> String {
        self.0.to_ascii_uppercase()
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn only_identifiers_are_names() {
        for good in ["part", "Part_2", "a"] {
            assert_eq!(CName::try_new(good).map(|name| name.0).as_deref(), Ok(good));
        }
        for bad in ["", "2d", "_x", "a-b", "a.c", "ä", "a b", "int", "UINT", &"a".repeat(32)] {
            assert_eq!(CName::try_new(bad), Err(CError::Name(bad.to_owned())), "{bad}");
        }
    }
}
