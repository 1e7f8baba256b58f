//! Setpoints of a run whose feed is ramped before interpolation.

use format_compare::RunStep;
use nurbs_core::{Evaluate, NurbsBuf};
use servo_sim::{RunPlace, ServoError, Travelled, ramp_feed};

/// A part of one curve: its number, and the parameters of both ends.
type Part = (usize, f64, f64);

/// The setpoints of `steps` on `curves`, the first of which has the number `first`, with their feed averaged over
/// `width_periods`.
///
/// A setpoint between two of the run's own is on the curve, moved by the deviation from it that the run has there. The
/// parameter is taken to run evenly within a step, which moves setpoints along the curve only. Where the run rests, the
/// ramp ends and begins again.
pub(super) fn ramped_setpoints<const D: usize>(
    curves: &[NurbsBuf<f64, D>],
    first: usize,
    steps: &[RunStep],
    width_periods: f64,
) -> Result<Vec<[f64; D]>, ServoError> {
    if width_periods <= 1.0 {
        return Ok(steps.iter().map(point).collect());
    }
    let travelled: Vec<Travelled> = steps
        .iter()
        .map(|step| Travelled { length: step.wanted_mm.0.max(0.0), rests: step.feed_mm_per_s == 0.0 })
        .collect();
    let places = ramp_feed(&travelled, width_periods)?;
    Ok(places.into_iter().map(|place| setpoint(curves, first, steps, place)).collect())
}

fn point<const D: usize>(step: &RunStep) -> [f64; D] {
    core::array::from_fn(|d| step.point_mm[d])
}

/// Curve and parameter of a step, which lies within the curve's domain.
fn on_curve(step: &RunStep) -> (usize, f64) {
    (step.curve, step.u.0 + step.u.1)
}

fn setpoint<const D: usize>(
    curves: &[NurbsBuf<f64, D>],
    first: usize,
    steps: &[RunStep],
    RunPlace { passed, fraction }: RunPlace,
) -> [f64; D] {
    let at = |curve: usize, u: f64| curves[curve].as_curve().point(u);
    let begin = (first, curves[first].as_curve().domain().0);
    let before = passed.checked_sub(1).map(|index| &steps[index]);
    let (from, from_point) =
        before.map_or((begin, at(begin.0, begin.1)), |step| (on_curve(step), point(step)));
    let Some(next) = steps.get(passed).filter(|_| fraction > 0.0) else { return from_point };
    let to = on_curve(next);
    let (curve, u) = between(curves, from, to, fraction);
    let exact = [at(from.0, from.1), at(curve, u), at(to.0, to.1)];
    let to_point = point::<D>(next);
    core::array::from_fn(|d| {
        let (off_from, off_to) = (from_point[d] - exact[0][d], to_point[d] - exact[2][d]);
        exact[1][d] + off_from + fraction * (off_to - off_from)
    })
}

/// The place at `fraction` of the way between two places of a path. Over joints the way is measured by the chords of its
/// parts.
fn between<const D: usize>(
    curves: &[NurbsBuf<f64, D>],
    from: (usize, f64),
    to: (usize, f64),
    fraction: f64,
) -> (usize, f64) {
    if from.0 >= to.0 {
        return (to.0, from.1 + fraction * (to.1 - from.1));
    }
    let parts: Vec<Part> = (from.0..=to.0)
        .map(|curve| {
            let (low, high) = curves[curve].as_curve().domain();
            (curve, if curve == from.0 { from.1 } else { low }, if curve == to.0 { to.1 } else { high })
        })
        .collect();
    let chord = |&(curve, low, high): &Part| {
        let [a, b] = [low, high].map(|u| curves[curve].as_curve().point(u));
        (0..D).map(|d| (b[d] - a[d]).powi(2)).sum::<f64>().sqrt()
    };
    let mut left = fraction * parts.iter().map(chord).sum::<f64>();
    for part in &parts {
        let (curve, low, high) = *part;
        let length = chord(part);
        if left <= length && length > 0.0 {
            return (curve, low + left / length * (high - low));
        }
        left -= length;
    }
    to
}

#[cfg(test)]
mod tests {
    use super::*;

    fn line(from: [f64; 2], to: [f64; 2]) -> NurbsBuf<f64, 2> {
        NurbsBuf::try_new_nonrational(1, vec![from, to], vec![0.0, 0.0, 1.0, 1.0]).unwrap()
    }

    fn step(curve: usize, u: f64, point_mm: [f64; 3], feed_mm_per_s: f64) -> RunStep {
        RunStep { curve, u: (u, 0.0), point_mm, wanted_mm: (1.0, 0.0), feed_mm_per_s, evaluations: 1 }
    }

    /// Two sides of a corner of 1.5 mm each, with a setpoint every 1 mm: the second step goes round the corner.
    #[test]
    fn a_ramped_run_goes_round_a_corner_on_the_path() {
        let curves = [line([0.0, 0.0], [1.5, 0.0]), line([1.5, 0.0], [1.5, 1.5])];
        let steps = [
            step(0, 2.0 / 3.0, [1.0, 0.0, 0.0], 1.0),
            step(1, 1.0 / 3.0, [1.5, 0.5, 0.0], 1.0),
            step(1, 1.0, [1.5, 1.5, 0.0], 0.0),
        ];
        let found = ramped_setpoints(&curves, 0, &steps, 4.0).unwrap();
        // The mean of the last four of the distances 0, 0, 0, 1, 2, 3, 3, 3.
        let expected = [[0.25, 0.0], [0.75, 0.0], [1.5, 0.0], [1.5, 0.75], [1.5, 1.25], [1.5, 1.5]];
        assert_eq!(found.len(), expected.len());
        for (found, expected) in found.iter().zip(expected) {
            assert!((0..2).all(|d| (found[d] - expected[d]).abs() < 1e-12), "{found:?} {expected:?}");
        }
        assert_eq!(ramped_setpoints(&curves, 0, &steps, 1.0).unwrap().len(), 3);
    }
}
