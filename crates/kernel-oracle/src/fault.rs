//! A result of a kernel that is not the right one.

use std::fmt;

use real::Backend;

/// What a kernel gave, and what it had to give.
#[derive(Clone, Debug, PartialEq, Eq)]
pub struct KernelFault {
    /// The operation or the step, with its operands.
    pub what: String,
    /// The format.
    pub format: String,
    /// The value that it gave.
    pub found: String,
    /// The right value, or the bound that was passed.
    pub expected: String,
}

impl KernelFault {
    /// A fault of what that names in R, unless both are equal.
    pub(crate) fn unless_equal<R: Backend, T: PartialEq + fmt::Debug>(
        what: impl FnOnce() -> String,
        found: T,
        expected: T,
    ) -> Result<(), Self> {
        if found == expected {
            return Ok(());
        }
        Err(Self {
            what: what(),
            format: R::name().to_string(),
            found: format!("{found:?}"),
            expected: format!("{expected:?}"),
        })
    }
}

impl fmt::Display for KernelFault {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        let Self { what, format, found, expected } = self;
        write!(f, "{what} in {format}: {found}, but right is {expected}")
    }
}

impl std::error::Error for KernelFault {}
