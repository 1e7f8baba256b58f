//! What a step over the joint of two pieces carries on: steps per chord in the scale of the next piece, and the way so far.

use nurbs_core::{LONGEST_ROUND_CORNER, Piece};
use real::Real;

use crate::chord_step::Chord;

/// A step per chord on one piece in the scale of the next, and within its range.
pub(crate) fn into_next<R: Real, const D: usize>(row: &Piece<R, D>, next: &Piece<R, D>, sigma: R) -> R {
    next.step_per_chord[0].max(part_into_next(row, next, sigma)).signal("step_per_chord")
}

/// A part of a step per chord in the scale of the next piece, and no more than its greatest.
pub(crate) fn part_into_next<R: Real, const D: usize>(row: &Piece<R, D>, next: &Piece<R, D>, part: R) -> R {
    let greatest = next.step_per_chord[1];
    let exponent = i32::from(row.joint_exponent);
    let part = part * row.ratio_at_joint();
    // Compared in the smaller scale, for in the larger it might not fit a format without exponents.
    let small = if !R::IS_FLOATING && exponent > 0 { part.min(greatest.scale(-exponent)) } else { part };
    small.scale(exponent).min(greatest).signal("joint_step_per_chord")
}

/// A part of one piece, as a part of the next one of the same span: their widths are as 1 to a power of two.
/// `None` if it is longer than that.
pub(crate) fn part_of_next<R: Real, const D: usize>(
    row: &Piece<R, D>,
    next: &Piece<R, D>,
    phase: u64,
) -> Option<u64> {
    // joint_ratio is ½, so that 2^(joint_exponent - 1) takes steps η = h 2^s to steps.
    let [joint, step, onward] = [row.joint_exponent, row.step_exponent, next.step_exponent].map(i32::from);
    let exponent = joint - 1 + step - onward;
    let distance = exponent.unsigned_abs();
    if exponent <= 0 {
        return Some(phase.checked_shr(distance).unwrap_or(0));
    }
    if phase.leading_zeros() < distance { None } else { Some(phase.checked_shl(distance).unwrap_or(0)) }
}

/// What a step over a joint has travelled up to there.
pub(crate) struct Travelled<R, const D: usize> {
    /// The way, over the length.
    pub(crate) before: [R; D],
    /// The step, over the length.
    pub(crate) part: R,
    /// What is left of the length, over it.
    pub(crate) left: R,
}

impl<R: Real, const D: usize> Travelled<R, D> {
    pub(crate) fn new(before: [R; D], part: R) -> Self {
        Self { before, part, left: R::one() - R::norm(&before) }
    }

    /// Behind a corner, the step per chord of the rest if the path goes straight on there along v, the chord per step, and the
    /// greatest one: [`LONGEST_ROUND_CORNER`] of a whole chord where v leads back along the chord up to there, or `greatest`. `None`
    /// unless it turns there by more than 25°, to go by `expected`, the step per chord on v: up to that, `left` of it is as good.
    ///
    /// With the unit vector `w = v/|v|` it is `σ = (√((b·w)² + 1 - |b|²) - b·w)/|v|`, the greater root of `|b + σ v|² = 1`; in
    /// halves, for a format may hold no more than 2.
    pub(crate) fn round_corner(&self, chord_per_step: &[R; D], expected: R, greatest: R) -> Option<[R; 2]> {
        let along = |ahead: R| {
            let pairs = self.before.iter().zip(chord_per_step);
            R::sum_of_products(pairs.map(|(before, chord)| (*before, ahead * *chord)))
        };
        let straight = R::one() - self.left;
        if along(expected) >= straight - straight.scale(-3) + straight.scale(-5) {
            return None;
        }
        let speed = R::norm(chord_per_step);
        let ahead = if speed > R::zero() { (R::one() / speed).min(greatest) } else { greatest };
        let half = along(ahead).half();
        let rest = (self.left * (R::one() - self.left.half())).half(); // (1 - |b|²)/4
        let root = half.mul_add(half, rest).sqrt();
        let longest = if half < R::zero() {
            let [numerator, denominator] = LONGEST_ROUND_CORNER;
            (ahead * R::from_ratio(numerator, denominator)).min(greatest)
        } else {
            greatest
        };
        let sigma = ((root - half) * ahead).min(longest.half());
        Some([sigma + sigma, longest])
    }
}

/// What is travelled at the end of a piece, over the length; `None` if that is the whole length or more.
pub(crate) fn past<R: Real, const D: usize>(
    before: &[R; D],
    chord: &Chord<'_, R, D>,
    length: R,
) -> Option<[R; D]> {
    let across = chord.over(chord.whole).map(|x| x / length);
    // In halves, for the sum may not fit the format before it is known to be short.
    let half: [R; D] = core::array::from_fn(|d| before[d].half() + across[d].half());
    let sum = || core::array::from_fn(|d| (before[d] + across[d]).signal("joint_travelled"));
    (R::norm(&half) < R::one().half()).then(sum)
}

#[cfg(test)]
mod tests {
    use super::*;
    use real::{Backend, I2F30, I4F28};

    /// Start value and greatest step per chord behind a turn by this angle, met when this share of the chord is travelled.
    fn round_corner<R: Backend>(before: f64, degrees: f64, speed: f64, greatest: f64) -> Option<[f64; 2]> {
        let number = |x: f64| R::from_f64(x).unwrap();
        let (sine, cosine) = degrees.to_radians().sin_cos();
        let travelled = Travelled::new([number(before), R::zero()], R::zero());
        // What was expected before the corner is a little off.
        let expected = number((1.01 / speed).min(greatest));
        let found =
            travelled.round_corner(&[speed * cosine, speed * sine].map(number), expected, number(greatest));
        found.map(|values| values.map(|value| value.to_f64()))
    }

    /// From the rest of the chord straight on, five evaluations behind a right angle left the chord up to 4e-4 of itself too long
    /// where 1 % of it and less was left.
    fn assert_found<R: Backend>(tolerance: f64) {
        for speed in [0.71, 1.0, 1.2] {
            for degrees in [30.0_f64, 60.0, 89.5, 90.5, 120.0, 150.0, 180.0] {
                for before in [0.01, 0.3, 0.9, 0.98, 0.999, 0.99999] {
                    let [sigma, longest] = round_corner::<R>(before, degrees, speed, 1.7).unwrap();
                    let limit = if degrees > 90.0 { (1.0625 / speed).min(1.7) } else { 1.7 };
                    let name = R::name();
                    assert!((longest - limit).abs() < 1e-8, "{name}, {degrees}°: {longest} for {limit}");
                    let (sine, cosine) = degrees.to_radians().sin_cos();
                    let along = sigma * speed;
                    let chord = (before + along * cosine).hypot(along * sine);
                    let is_limited = (sigma - longest).abs() < 1e-8 && chord < 1.0 + tolerance;
                    assert!(
                        is_limited || (chord - 1.0).abs() < tolerance,
                        "{name}: {degrees}° behind {before} at {speed}: {chord}"
                    );
                }
            }
        }
    }

    #[test]
    fn behind_a_corner_the_start_value_is_the_rest_of_the_chord() {
        assert_found::<f64>(1e-12);
        assert_found::<I4F28>(3e-8);
        assert_found::<I2F30>(1e-8);
    }

    #[test]
    fn a_gentle_turn_is_no_corner() {
        for degrees in [-24.0, -1.0, 0.0, 10.0, 24.0] {
            assert_eq!(round_corner::<f64>(0.5, degrees, 1.0, 1.7), None, "{degrees}");
        }
        assert!(round_corner::<f64>(0.5, 27.0, 1.0, 1.7).is_some());
    }

    #[test]
    fn a_step_per_chord_is_no_greater_than_the_greatest() {
        for speed in [0.3, 0.5, 0.6, 0.7] {
            let [sigma, longest] = round_corner::<f64>(0.5, 120.0, speed, 1.5).unwrap();
            assert!(longest <= 1.5 && sigma <= longest, "{speed}: {sigma} {longest}");
        }
    }
}
