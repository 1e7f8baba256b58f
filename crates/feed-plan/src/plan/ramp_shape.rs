//! The ramps from one feed to another, divided into parts of equal time that are compared with the limit one by one.

use real::Real;

use crate::limit::axis_budget::Allowance;
use crate::{FeedLimit, KinematicLimits, ProfileKind, StageShape, Transition};

/// Parts into which a ramp is divided to compare it with the limit, a power of two. In each part the largest feed
/// counts, so a ramp starts later than it must by at most the last part's length. With 16 parts a plan with long ramps
/// takes up to 2 % longer.
pub(crate) const PARTS: usize = 32;

/// All ramps of one kind of transition, divided into parts of equal time.
#[derive(Clone, Copy, Debug)]
pub(crate) struct RampShape<R> {
    kind: ProfileKind,
    acceleration: R,
    jerk: R,
    pub(crate) parts: [Part<R>; PARTS],
}

/// One part of a ramp: the time from `x` to `x + 1/PARTS` of the whole time.
#[derive(Clone, Copy, Debug, Default)]
pub(crate) struct Part<R> {
    x: R,
    end: R,
    /// G at the part's start: the coefficient of the change of feed in the distance.
    bow: R,
    /// g at the part's end: the share of the change of feed that has been reached.
    rise: R,
}

impl<R: Real> Part<R> {
    /// For a ramp from `low` to `high`: the distance to the part's start, and the largest feed in the part.
    #[inline]
    pub(crate) fn step(&self, low: R, high: R, ramp: &Transition<R>) -> (R, R) {
        let change = high - low;
        let of_s_curve = ramp.s_curve_shares(self.x).zip(ramp.s_curve_shares(self.end));
        let (bow, rise) = of_s_curve.map_or((self.bow, self.rise), |(begin, end)| (begin.1, end.0));
        (ramp.duration() * (low * self.x + change * bow), (low + change * rise).min(high))
    }
}

impl<R: Real> RampShape<R> {
    pub(crate) fn new(kind: ProfileKind, limits: &KinematicLimits<R>) -> Self {
        // An S-curve has another shape for each pair of feeds, so its shares are computed each time.
        let shape = if kind == ProfileKind::Cubic { StageShape::Cubic } else { StageShape::Cosine };
        let mut parts = [Part::default(); PARTS];
        let width = R::one().ldexp(-PARTS.ilog2().cast_signed());
        let mut x = R::zero();
        for part in &mut parts {
            let end = x + width;
            *part = Part { x, end, bow: shape.travelled(x), rise: shape.reached(end) };
            x = end;
        }
        Self { kind, acceleration: limits.acceleration, jerk: limits.jerk, parts }
    }

    /// The ramps of a stretch on which the axes leave no more than this acceleration and jerk.
    pub(crate) fn within(&self, allowance: Allowance<R>) -> Self {
        let least = allowance.min(Allowance { acceleration: self.acceleration, jerk: self.jerk });
        Self { acceleration: least.acceleration, jerk: least.jerk, ..*self }
    }

    pub(crate) fn ramp(&self, from: R, to: R) -> Transition<R> {
        Transition::fastest(self.kind, [from, to], self.acceleration, self.jerk)
    }

    /// For each part of a ramp from `low` to `high`: the distance to its start, and the largest feed in it.
    pub(crate) fn staircase(&self, low: R, high: R, ramp: Transition<R>) -> impl Iterator<Item = (R, R)> {
        self.parts.iter().map(move |part| part.step(low, high, &ramp))
    }

    /// Whether a ramp between a slow point and a fast one fits. Its fast end is at the fast point; its slow end must
    /// not lie beyond the slow point, and all of it must be under the limit.
    pub(crate) fn fits(&self, limit: &FeedLimit<R>, slow: (R, R), fast: (R, R)) -> bool {
        let ramp = self.ramp(slow.1, fast.1);
        let room = (fast.0 - slow.0).abs();
        if !(ramp.length() <= room) {
            return false;
        }
        let wait = room - ramp.length();
        let place = |along: R| if fast.0 < slow.0 { slow.0 - wait - along } else { slow.0 + wait + along };
        let ends = self.staircase(slow.1, fast.1, ramp).skip(1).map(|(start, _)| start);
        let ends = ends.chain([ramp.length()]);
        self.staircase(slow.1, fast.1, ramp).zip(ends).all(|((start, feed), end)| {
            let (a, b) = (place(start), place(end));
            let (least, greatest) = (slow.0.min(fast.0), slow.0.max(fast.0));
            limit.minimum_over(a.min(b).max(least), a.max(b).min(greatest)) >= feed
        })
    }
}
