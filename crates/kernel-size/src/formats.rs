//! The formats that a kernel is run in.

use real::{FormatName, RuntimeFormat, Work, in_few_backends};

/// The formats that are compared by default, narrow before wide, fixed point before float.
#[must_use]
pub fn built_in() -> Vec<FormatName> {
    let fixed = FormatName::fixed;
    let float = |bits| FormatName::Float { bits };
    let narrow = [fixed(16, 16), fixed(8, 24), fixed(4, 28), fixed(3, 29), fixed(2, 30), float(32)];
    let wide = [fixed(32, 32), fixed(16, 48), fixed(4, 60), float(64)];
    narrow.into_iter().chain(wide).collect()
}

/// The format of this name, if a kernel can be run in it: `f32`, `f64`, or `I5F13` with 3 to 64 bits, at least two of them
/// before the point. `-floor` and `-sat` may follow, as [`FormatName::named`] says.
#[must_use]
pub fn named(name: &str) -> Option<FormatName> {
    let format = FormatName::named(name)?;
    (matches!(format, FormatName::Float { .. }) || RuntimeFormat::named(name).is_some()).then_some(format)
}

/// Does `work` in a format, which [`named`] knows: a kernel is compiled three times and not once for each format.
pub(crate) fn in_format<W: Work>(format: FormatName, work: W) -> W::Output {
    in_few_backends::<0, _>(format, work)
}
