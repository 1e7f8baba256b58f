//! A result of a kernel that is not the right one.

use std::fmt;

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

impl fmt::Display for KernelFault {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        let Self { what, format, found, expected } = self;
        write!(f, "{what} in {format}: {found}, but right is {expected}")
    }
}

impl std::error::Error for KernelFault {}
