//! A run as Rust source, for a controller's flash.

use core::fmt;

use nurbs_core::Piece;
use real::{Backend, FormatName, Real};

use crate::{Crossing, LengthStage, PieceInterpolator, StageShape};

/// Shows a run as a Rust expression of a constant, every number exactly.
///
/// The expression uses names of this crate and of nurbs-core. Fixed-point numbers are calls of the function that
/// [`number_function`] writes, as in `i4f28(-134217728)`.
#[derive(Clone, Copy, Debug)]
pub struct Constant<'a, R, const D: usize>(pub &'a PieceInterpolator<'a, R, D>);

impl<R: Backend, const D: usize> fmt::Display for Constant<'_, R, D> {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        let PieceInterpolator { pieces, lengths, tolerance, landing_step } = self.0;
        writeln!(f, "PieceInterpolator {{")?;
        writeln!(f, "    pieces: Pieces {{")?;
        lines(f, "        pieces", pieces.pieces, row)?;
        lines(f, "        numerators", pieces.numerators, numbers)?;
        lines(f, "        weights", pieces.weights, |weight| number(*weight))?;
        writeln!(f, "        degree: {},", pieces.degree)?;
        writeln!(f, "        coordinate_exponent: {},", pieces.coordinate_exponent)?;
        writeln!(f, "        chord_exponent: {},", pieces.chord_exponent)?;
        writeln!(f, "    }},")?;
        writeln!(f, "    lengths: StepLengths {{")?;
        lines(f, "        stages", lengths.stages, stage)?;
        lines(f, "        crossings", lengths.crossings, crossing)?;
        writeln!(f, "    }},")?;
        writeln!(f, "    tolerance: ChordTolerance {{")?;
        writeln!(f, "        residual: {},", number(tolerance.residual))?;
        writeln!(f, "        growth: {},", number(tolerance.growth))?;
        writeln!(f, "        fluctuation: {},", number(tolerance.fluctuation))?;
        writeln!(f, "        max_evaluations: {},", tolerance.max_evaluations)?;
        writeln!(f, "    }},")?;
        writeln!(f, "    landing_step: {},", number(*landing_step))?;
        write!(f, "}}")
    }
}

/// The type of the numbers as Rust source, with names of `real`; `None` for a format that `real` has no type for.
#[must_use]
pub fn number_type(format: FormatName) -> Option<String> {
    match format {
        FormatName::Float { .. } => Some(format.to_string()),
        FormatName::Fixed { integer_bits: integer_bits @ 2.., fraction_bits, .. }
            if [8, 16, 32, 64].contains(&format.bits())
                && format == FormatName::fixed(integer_bits, fraction_bits) =>
        {
            Some(format!("real::FixedPoint<real::fixed::types::{format}>"))
        }
        _ => None,
    }
}

/// The function that makes a fixed-point number from its bits, as Rust source; `None` for a format without bits or
/// without a type.
#[must_use]
pub fn number_function(format: FormatName) -> Option<String> {
    let FormatName::Fixed { .. } = format else { return None };
    let (name, number, bits) = (format.to_string().to_lowercase(), number_type(format)?, format.bits());
    Some(format!(
        "const fn {name}(bits: i{bits}) -> {number} {{\n    real::FixedPoint(real::fixed::types::{format}::from_bits(bits))\n}}\n"
    ))
}

/// A field that is a slice, with one element on a line.
fn lines<T>(
    f: &mut fmt::Formatter<'_>,
    field: &str,
    elements: &[T],
    show: impl Fn(&T) -> String,
) -> fmt::Result {
    let indent = field.len() - field.trim_start().len();
    if elements.is_empty() {
        return writeln!(f, "{field}: &[],");
    }
    writeln!(f, "{field}: &[")?;
    for element in elements {
        writeln!(f, "{:indent$}    {},", "", show(element))?;
    }
    writeln!(f, "{:indent$}],", "")
}

fn row<R: Backend, const D: usize>(row: &Piece<R, D>) -> String {
    let Piece {
        origin,
        coordinate_exponent,
        step_exponent,
        range_exponent,
        joint_ratio,
        joint_exponent,
        joint,
        step_per_chord,
    } = row;
    format!(
        "Piece {{ origin: {origin:?}, coordinate_exponent: {coordinate_exponent}, step_exponent: {step_exponent}, \
         range_exponent: {range_exponent}, joint_ratio: {joint_ratio}, joint_exponent: {joint_exponent}, \
         joint: Joint::{joint:?}, step_per_chord: {} }}",
        numbers(step_per_chord)
    )
}

fn stage<R: Backend>(stage: &LengthStage<R>) -> String {
    let LengthStage { duration, reciprocal, reciprocal_exponent, period_share, feed, change, shape } = stage;
    format!(
        "LengthStage {{ duration: {duration}, reciprocal: {reciprocal}, reciprocal_exponent: {reciprocal_exponent}, \
         period_share: {}, feed: {}, change: {}, shape: StageShape::{} }}",
        number(*period_share),
        number(*feed),
        number(*change),
        match shape {
            StageShape::Bent(by) => format!("Bent({})", number(*by)),
            other => format!("{other:?}"),
        }
    )
}

fn crossing<R: Backend>(crossing: &Crossing<R>) -> String {
    let Crossing { rest, time, stages, distance } = crossing;
    format!("Crossing {{ rest: {rest}, time: {time}, stages: {stages}, distance: {} }}", number(*distance))
}

fn numbers<R: Backend, const N: usize>(numbers: &[R; N]) -> String {
    format!("[{}]", numbers.map(number).join(", "))
}

/// A literal of the format: for a float, the digits that no other float has; for a fixed-point number, its bits.
#[allow(clippy::cast_possible_truncation, reason = "a number of 32 bits is one")]
fn number<R: Backend>(x: R) -> String {
    match R::name() {
        FormatName::Float { bits: 32 } => format!("{:?}", x.to_f64() as f32),
        name @ FormatName::Fixed { .. } => {
            format!("{}({})", name.to_string().to_lowercase(), fixed_point_word(x))
        }
        _ => format!("{:?}", x.to_f64()),
    }
}

/// The bits of a fixed-point number, as a signed word; 0 for a number of another kind.
#[allow(clippy::cast_possible_truncation, reason = "words have 64 bits at most")]
#[must_use]
pub fn fixed_point_word<R: Backend>(x: R) -> i64 {
    let FormatName::Fixed { fraction_bits, .. } = R::name() else { return 0 };
    let exponent = fraction_bits.cast_signed();
    let (high, low) = x.to_f64_pair();
    // The greatest words round up to 2⁶³ in `high`: the sum in 128 bits takes that back.
    (high.ldexp(exponent) as i128 + low.ldexp(exponent) as i128) as i64
}

#[cfg(test)]
mod tests {
    use super::*;
    use proptest::prelude::*;
    use real::{I4F28, I4F60};

    #[test]
    fn numbers_are_rust() {
        assert_eq!(number(-0.1_f64), "-0.1");
        assert_eq!(number(3.0_f32), "3.0");
        assert_eq!(number(1e-7_f32), "1e-7");
        assert_eq!(number(I4F28::from_ratio(-1, 2)), "i4f28(-134217728)");
        assert_eq!(number(I4F60::from_bits(i64::MAX)), format!("i4f60({})", i64::MAX));
        assert_eq!(number(I4F60::from_bits(i64::MIN)), format!("i4f60({})", i64::MIN));
    }

    #[test]
    fn types_are_those_of_machine_words() {
        let fixed = FormatName::fixed;
        assert_eq!(number_type(FormatName::Float { bits: 32 }).as_deref(), Some("f32"));
        assert_eq!(number_type(fixed(5, 11)).as_deref(), Some("real::FixedPoint<real::fixed::types::I5F11>"));
        assert_eq!(number_type(fixed(5, 13)), None, "18 bits are no machine word");
        assert_eq!(number_type(fixed(1, 31)), None, "it does not hold 1");
        assert_eq!(number_function(FormatName::Float { bits: 64 }), None);
        assert_eq!(number_function(fixed(5, 13)), None);
    }

    proptest! {
        #[test]
        fn numbers_come_back(bits: i64, float: u32) {
            let digits = number(I4F60::from_bits(bits)).replace("i4f60(", "").replace(')', "");
            prop_assert_eq!(digits.parse(), Ok(bits));
            let word = (bits >> 32) as i32;
            let digits = number(I4F28::from_bits(word)).replace("i4f28(", "").replace(')', "");
            prop_assert_eq!(digits.parse(), Ok(word));
            let float = f32::from_bits(float);
            prop_assert!(float.is_nan() || number(float).parse() == Ok(float));
        }
    }
}
