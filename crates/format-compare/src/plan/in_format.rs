//! Conversion of numbers from f64 and double-double into a format, and back.

use feed_plan::{Junction, KinematicLimits};
use real::{Backend, DoubleDouble};

use crate::refusal::Refusal;

/// `value` in the format `R`: refused when it is out of range, or positive and rounds to zero.
pub(crate) fn in_format<R: Backend>(what: &'static str, value: f64) -> Result<R, Refusal> {
    let number = R::from_f64(value).filter(|x| value <= 0.0 || *x > R::zero());
    number.ok_or(Refusal::Limit { what, value, format: R::name() })
}

/// As [`in_format`], and the largest number where `value` is beyond the range: a limit that limits nothing.
pub(crate) fn in_format_or_most<R: Backend>(what: &'static str, value: f64) -> Result<R, Refusal> {
    if value > R::max_value().to_f64_pair().0 { Ok(R::max_value()) } else { in_format(what, value) }
}

/// Limits in mm and periods in the format `R`.
pub(crate) fn limits_in_format<R: Backend>(
    limits: &KinematicLimits<f64>,
) -> Result<KinematicLimits<R>, Refusal> {
    let Junction::VelocityJump(jumps) = limits.junction else { return limits.try_map(in_format) };
    // A velocity jump that rounds to zero has the effect of a stop, so it is not refused.
    let jumps = jumps.map(|jump| R::from_f64(jump).unwrap_or_default().max(R::resolution()));
    let others = KinematicLimits { junction: Junction::Stop, ..*limits }.try_map(in_format)?;
    Ok(KinematicLimits { junction: Junction::VelocityJump(jumps), ..others })
}

/// The number of `R` nearest to `x`; `None` if `x` is beyond its range.
pub(crate) fn nearest<R: Backend>(x: DoubleDouble) -> Option<R> {
    let (high, low) = x.to_f64_pair();
    R::from_f64_pair(high, low)
}

/// A number of any format, exactly: two floats hold it.
pub(crate) fn exact<R: Backend>(x: R) -> DoubleDouble {
    of_pair(x.to_f64_pair())
}

/// The sum of two floats.
pub(crate) fn of_pair((high, low): (f64, f64)) -> DoubleDouble {
    DoubleDouble::new(high, low)
}
