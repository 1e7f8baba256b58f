//! The velocity of a Bezier segment, and the range of its magnitude.

use alloc::vec::Vec;

use real::Real;

use crate::pieces::speed::Speed;
use crate::polynomials::polynomial::binomial;
use crate::vector::{add, dot, lerp, over, scaled, sub};

/// The speed is sampled at the ends of this many equal parts.
const SAMPLES: u32 = 8;
/// The proven range of the speed may be wider than the range of its samples by this part. If it is wider, the segment
/// is halved and the speed in the middle is sampled.
const NEAR: f64 = 1.0 / 64.0;
/// Samples lie no closer than 2⁻¹⁰ of the segment: only next to a cusp is more needed.
const DEPTH: u32 = 10;

/// The range of |C'| for homogeneous Bezier points (N, W): the range of nine samples, widened wherever the speed leaves
/// it by more than a 64th. The solver holds its steps per chord within the inverse of this range.
///
/// The greatest speed is infinite where weights are so far apart, or so small, that f64 cannot hold a speed.
pub(crate) fn speed<const D: usize>(points: &[([f64; D], f64)]) -> Speed {
    let mut speed = sampled(points, SAMPLES);
    Hodograph::of(points).extend(&mut speed);
    speed
}

fn sampled<const D: usize>(points: &[([f64; D], f64)], samples: u32) -> Speed {
    let at = |sample: u32| f64::norm(&velocity(points, f64::from(sample) / f64::from(samples)));
    let values: Vec<f64> = (0..=samples).map(at).collect();
    Speed {
        least: values.iter().copied().fold(f64::MAX, f64::min),
        greatest: values.iter().copied().map(infinite_unless_number).fold(0.0, f64::max),
        begin: values[0],
        end: values[values.len() - 1],
    }
}

/// Replaces NaN by infinity, so that the greatest of several values shows it.
fn infinite_unless_number(x: f64) -> f64 {
    if x.is_nan() { f64::INFINITY } else { x }
}

/// C' at t, by de Casteljau; NaN where W is NaN.
fn velocity<const D: usize>(points: &[([f64; D], f64)], t: f64) -> [f64; D] {
    let mut rows = points.to_vec();
    let degree = rows.len() - 1;
    for round in (2..=degree).rev() {
        for k in 0..round {
            let next = rows[k + 1];
            rows[k].0 = lerp(&rows[k].0, &next.0, t);
            rows[k].1 += (next.1 - rows[k].1) * t;
        }
    }
    let ((a, wa), (b, wb)) = (rows[0], rows[1]);
    let weight = wa + (wb - wa) * t;
    let point = over(&lerp(&a, &b, t), weight);
    let rise = (wb - wa) * degree as f64;
    over(&sub(&scaled(&sub(&b, &a), degree as f64), &scaled(&point, rise)), weight)
}

/// On a part of a segment C = N/W, and C' = V/W². This holds `V = N'W - NW'` in Bezier form, of degree 2p - 1, and W.
struct Hodograph<const D: usize> {
    velocity: Vec<[f64; D]>,
    weight: Vec<f64>,
}

impl<const D: usize> Hodograph<D> {
    /// From homogeneous points (N, W), in f64. The points should be relative to one of them, so that few digits are
    /// lost.
    fn of(points: &[([f64; D], f64)]) -> Self {
        let degree = points.len() - 1;
        let rise = |j: usize| {
            let ((a, wa), (b, wb)) = (points[j], points[j + 1]);
            (scaled(&sub(&b, &a), degree as f64), (wb - wa) * degree as f64)
        };
        let mut velocity = alloc::vec![[0.0; D]; 2 * degree];
        // Bezier form of a product: c_k = Σ_{i+j=k} binomial(m, i) binomial(n, j) / binomial(m + n, k) a_i b_j.
        for i in 0..degree {
            let (n_rise, w_rise) = rise(i);
            for (j, (n, w)) in points.iter().enumerate() {
                let share = binomial(degree - 1, i) * binomial(degree, j) / binomial(2 * degree - 1, i + j);
                let turn = sub(&scaled(&n_rise, *w), &scaled(n, w_rise));
                velocity[i + j] = add(&velocity[i + j], &scaled(&turn, share));
            }
        }
        Self { velocity, weight: points.iter().map(|(_, w)| *w).collect() }
    }

    /// Widens the range of a speed that was sampled at both ends to its range in between, to within 1/64.
    fn extend(&self, speed: &mut Speed) {
        self.extend_on(speed, DEPTH);
    }

    fn extend_on(&self, speed: &mut Speed, depth: u32) {
        let (least, greatest) = self.bounds();
        let is_infinite = speed.greatest == f64::INFINITY;
        if depth == 0
            || is_infinite
            || (least >= speed.least * (1.0 - NEAR) && greatest <= speed.greatest * (1.0 + NEAR))
        {
            return;
        }
        let (first, second) = self.halves();
        let middle = infinite_unless_number(second.begin());
        if middle < speed.least * (1.0 - NEAR) {
            speed.least = middle;
        }
        if middle > speed.greatest * (1.0 + NEAR) {
            speed.greatest = middle;
        }
        first.extend_on(speed, depth - 1);
        second.extend_on(speed, depth - 1);
    }

    /// Bounds of |C'|: V lies in the hull of its Bezier points, and W between the least and the greatest of its own.
    fn bounds(&self) -> (f64, f64) {
        let mean = self.velocity.iter().fold([0.0; D], |sum, v| add(&sum, v));
        let length = f64::norm(&mean);
        let along = |v: &[f64; D]| dot(v, &mean) / length;
        // If the mean is 0 there is no direction on which V could be projected.
        let least = if length > 0.0 { self.velocity.iter().map(along).fold(f64::MAX, f64::min) } else { 0.0 };
        let greatest = self.velocity.iter().map(f64::norm).fold(0.0, f64::max);
        let (light, heavy) = self.weight.iter().fold((f64::MAX, 0.0_f64), |(l, h), w| (l.min(*w), h.max(*w)));
        (if least > 0.0 { least / (heavy * heavy) } else { 0.0 }, greatest / (light * light))
    }

    /// |C'| at the begin.
    fn begin(&self) -> f64 {
        f64::norm(&self.velocity[0]) / (self.weight[0] * self.weight[0])
    }

    /// Both halves, by de Casteljau.
    fn halves(&self) -> (Self, Self) {
        let midway = |a: &[f64; D], b: &[f64; D]| core::array::from_fn(|d| f64::midpoint(a[d], b[d]));
        let (velocity, rest) = halves(&self.velocity, midway);
        let (weight, heavier) = halves(&self.weight, |a, b| f64::midpoint(*a, *b));
        (Self { velocity, weight }, Self { velocity: rest, weight: heavier })
    }
}

fn halves<T: Copy>(points: &[T], midway: impl Fn(&T, &T) -> T) -> (Vec<T>, Vec<T>) {
    let mut rest = points.to_vec();
    let mut first = Vec::with_capacity(points.len());
    for round in (0..points.len()).rev() {
        first.push(rest[0]);
        for k in 0..round {
            rest[k] = midway(&rest[k], &rest[k + 1]);
        }
    }
    (first, rest)
}

#[cfg(test)]
mod tests {
    use super::*;
    use proptest::prelude::*;

    proptest! {
        #[test]
        fn no_speed_is_further_out_than_a_64th_where_samples_are_not_too_far_apart(
            points in proptest::collection::vec(([-1.0..1.0_f64, -1.0..1.0_f64], 0.7..1.4_f64), 2..9),
        ) {
            let mut speed = sampled(&points, 8);
            let before = (speed.least, speed.greatest);
            Hodograph::of(&points).extend(&mut speed);
            prop_assert!(speed.least <= before.0 && speed.greatest >= before.1);
            let dense = sampled(&points, 4096);
            prop_assert!(speed.greatest * (1.0 + 1.0 / 60.0) >= dense.greatest, "{} {}", speed.greatest, dense.greatest);
            // Next to a cusp the speed falls within the finest part, by |C''| times its width: |C''| is at most some 2p |C'|.
            let within_part = 2.0 * (points.len() - 1) as f64 * dense.greatest / f64::from(1 << DEPTH);
            prop_assert!(
                speed.least * (1.0 - 1.0 / 60.0) <= dense.least + within_part,
                "{} {}", speed.least, dense.least
            );
            prop_assert!(speed.least >= dense.least * (1.0 - 1e-3) && speed.greatest <= dense.greatest * (1.0 + 1e-3));
        }
    }

    /// Its velocities sum to nothing: no direction proves that it moves.
    #[test]
    fn a_segment_that_ends_where_it_begins_has_no_least_speed() {
        let there_and_back = [([0.0, 0.0], 1.0), ([1.0, 0.0], 1.0), ([0.0, 0.0], 1.0)];
        assert_eq!(Hodograph::of(&there_and_back).bounds().0, 0.0);
        let mut speed = Speed { least: 1.0, greatest: 2.0, begin: 2.0, end: 2.0 };
        Hodograph::of(&there_and_back).extend(&mut speed);
        assert!(speed.least < 1e-2, "{}", speed.least);
    }

    #[test]
    fn a_dip_between_samples_is_seen_and_an_even_speed_left_alone() {
        // The speed falls from 16 to 6.4 within a twentieth, then rises: nine samples see 13 at least.
        let dip = |t: f64| ((t - 0.05) * 40.0).tanh();
        let parameter: Vec<f64> = (0..9).map(|i| f64::from(i) / 8.0).collect();
        let points: Vec<([f64; 2], f64)> = parameter.iter().map(|t| ([*t, 0.02 * dip(*t)], 1.0)).collect();
        let mut speed = sampled(&points, 8);
        Hodograph::of(&points).extend(&mut speed);
        let dense = sampled(&points, 4096);
        assert!(speed.least <= dense.least * (1.0 + 1.0 / 60.0), "{} {}", speed.least, dense.least);
        let line: Vec<([f64; 2], f64)> = (0..4).map(|i| ([f64::from(i), 2.0 * f64::from(i)], 1.0)).collect();
        let mut even = sampled(&line, 8);
        let before = (even.least, even.greatest);
        Hodograph::of(&line).extend(&mut even);
        assert_eq!((even.least, even.greatest), before);
    }
}
