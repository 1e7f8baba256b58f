//! Whether the path has a corner at a joint.

use real::Real;

use crate::vector::{over, sub};

/// Whether the tangent breaks where a path arrives along `before` and goes on along `after`:
/// `|after/|after| - before/|before|| > 2⁻¹²`, a turn of 0.014°.
///
/// `before` and `after` are derivatives of any length and unit; only their directions count. A zero vector has no
/// direction: the path rests there, or its direction is unknown. Neither is a break. A turn back by 180° is one.
///
/// Domain: the lengths and the quotients, up to 1, fit the format. A format of 14 fraction bits or fewer may take its
/// own rounding of the quotients for a break.
pub fn tangent_breaks<R: Real, const D: usize>(before: &[R; D], after: &[R; D]) -> bool {
    let [arriving, leaving] = [R::norm(before), R::norm(after)];
    if !(arriving > R::zero() && leaving > R::zero()) {
        return false;
    }
    let turn = sub(&over(after, leaving), &over(before, arriving));
    R::norm(&turn) > R::from_ratio(1, 4096)
}

#[cfg(test)]
mod tests {
    use real::{Backend, DoubleDouble, I8F24, I16F16};

    use super::*;

    fn turned<R: Backend>(by_rad: f64, lengths: [f64; 2]) -> bool {
        let (sine, cosine) = by_rad.sin_cos();
        let scaled =
            |length: f64, [x, y]: [f64; 2]| [x, y].map(|component| R::from_f64(length * component).unwrap());
        tangent_breaks(&scaled(lengths[0], [0.6, -0.8]), &{
            let [x, y] = [0.6 * cosine + 0.8 * sine, 0.6 * sine - 0.8 * cosine];
            scaled(lengths[1], [x, y])
        })
    }

    fn keeps_to_the_bound<R: Backend>() {
        let bound = 2.0 * f64::powi(2.0, -13).asin();
        for lengths in [[1.0, 1.0], [3.0, 20.0], [20.0, 0.5]] {
            for (by_rad, breaks) in [
                (0.0, false),
                (0.7 * bound, false),
                (1.3 * bound, true),
                (-1.3 * bound, true),
                (1.5, true),
                (core::f64::consts::PI, true),
            ] {
                assert_eq!(turned::<R>(by_rad, lengths), breaks, "{:?} {by_rad} {lengths:?}", R::name());
            }
        }
    }

    #[test]
    fn a_break_is_a_turn_by_more_than_the_bound_whatever_the_lengths() {
        keeps_to_the_bound::<f64>();
        keeps_to_the_bound::<f32>();
        keeps_to_the_bound::<I8F24>();
        keeps_to_the_bound::<I16F16>();
        keeps_to_the_bound::<DoubleDouble>();
    }

    /// At a cusp or a joint of a move without length nothing is passed.
    #[test]
    fn what_has_no_direction_does_not_break() {
        for (before, after) in [([0.0; 2], [1.0, 0.0]), ([1.0, 0.0], [0.0; 2]), ([f64::NAN, 0.0], [1.0, 0.0])]
        {
            assert!(!tangent_breaks(&before, &after), "{before:?} {after:?}");
        }
    }
}
