//! The feed limit as a function of the distance along the path.
//!
//! What a planner needs from the limit is a promise: *this feed is allowed from here to there*. Samples alone
//! do not give it, since between two samples the limit may dip. So each sample carries a second value, a little
//! lower, chosen so that the curve through these lower values stays below the limit in between as well.
//! Between samples `V²` is taken as linear in the distance: near a sharp bend the chord limit is `√(8Eρ)/T`, so
//! its square is as smooth as the radius, and a constant acceleration is a straight line.
//!
//! At a corner or a cusp, the limit is 0 at one point only: a *stop*. The feed there must be 0, and up to the
//! neighbouring samples the neighbour's limit holds.

use alloc::vec::Vec;

use nurbs_core::Differentiate;
use real::Real;

use crate::scan::Scan;
use crate::{KinematicLimits, PlanError, Schedule};

/// The feed limit at one point of the path.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct LimitPoint<R> {
    /// Arc length from the path's start, mm.
    pub distance: R,
    /// Index of the curve.
    pub curve: usize,
    /// Parameter on that curve.
    pub u: R,
    /// Largest feed there; 0 at a stop.
    pub feedrate: R,
}

/// What belongs to a limit point beside what callers see.
#[derive(Clone, Copy, Debug, PartialEq)]
pub(crate) struct Node<R> {
    /// Lower value of the limit at the point: 0 at a stop, never more than its `feedrate` elsewhere, except next
    /// to a stop.
    pub(crate) lower: R,
    /// The lower value that the stretch before the point ends with; differs from `lower` at a stop only.
    pub(crate) before: R,
    /// The lower value that the stretch after the point begins with.
    pub(crate) after: R,
    /// `|C'|`, mm; 0 if unknown.
    pub(crate) speed: R,
    /// Curvature, 1/mm.
    pub(crate) curvature: R,
}

/// The largest feed that a path allows, as a function of the distance along it.
#[derive(Clone, Debug, PartialEq)]
pub struct FeedLimit<R> {
    points: Vec<LimitPoint<R>>,
    nodes: Vec<Node<R>>,
}

/// One sample of the limit, with the margin for the stretch that ends with it.
#[derive(Clone, Copy, Debug)]
pub(crate) struct Measured<R> {
    pub(crate) point: LimitPoint<R>,
    pub(crate) speed: R,
    pub(crate) curvature: R,
    /// By how much `V²` may dip below the straight line over the stretch from the previous sample.
    pub(crate) margin: R,
}

impl<R: Real> FeedLimit<R> {
    /// The limit along curves that follow each other, each starting where the one before ends.
    ///
    /// The path is sampled at steps of at most about one period at full feed, finer where the limit bends; each
    /// local minimum of the limit is found and becomes a point. Arc length is integrated along the way.
    /// A break of the tangent becomes a stop when, passed at the feedrate F, it would cut the corner by more
    /// than the chord error or change the velocity by more than A T: `θ > min(4E/(F T), A T/F)`. A point where C'
    /// vanishes, as in a cusp, is a stop too, and so is a point whose limit is below F/4096.
    ///
    /// Between two points the limit is tested at three places. What is narrower than a third of the finest step,
    /// 2⁻¹⁴ of a span, can be missed.
    ///
    /// Within the chord error E of a stop, the limit does not bind: no chord that starts and ends there can leave
    /// the curve by more than E.
    ///
    /// # Errors
    /// [`PlanError::NotPositive`] for limits that [`validate`](KinematicLimits::validate) refuses,
    /// [`PlanError::PathEmpty`] without curves or length, [`PlanError::LengthOverflows`] when the format cannot
    /// hold lengths or derivatives.
    pub fn along<const D: usize, C: Differentiate<R, D>>(
        curves: &[C],
        limits: &KinematicLimits<R>,
    ) -> Result<Self, PlanError> {
        limits.validate()?;
        let mut scan = Scan::new(limits);
        for (index, curve) in curves.iter().enumerate() {
            scan.pass(index, curve)?;
        }
        let samples = scan.finish();
        Self::assemble(&samples, limits.chord_error)
    }

    /// A limit given by points, `V²` linear in the distance between them; a single point of feedrate 0 is a stop.
    ///
    /// Two points of the same distance make a jump. The first distance is 0.
    ///
    /// # Errors
    /// [`PlanError::PointsOutOfOrder`] when a distance is less than the one before, or a number is none;
    /// [`PlanError::PathEmpty`] when the last distance is 0.
    pub fn from_points(points: &[LimitPoint<R>]) -> Result<Self, PlanError> {
        let mut previous = R::zero();
        for (index, point) in points.iter().enumerate() {
            let in_order = if index == 0 { point.distance == previous } else { point.distance >= previous };
            if !(in_order
                && point.distance.is_finite()
                && point.feedrate >= R::zero()
                && point.feedrate.is_finite())
            {
                return Err(PlanError::PointsOutOfOrder { index });
            }
            previous = point.distance;
        }
        let measured = |point: &LimitPoint<R>| Measured {
            point: *point,
            speed: R::zero(),
            curvature: R::zero(),
            margin: R::zero(),
        };
        let samples: Vec<_> = points.iter().map(measured).collect();
        Self::assemble(&samples, R::zero())
    }

    fn assemble(samples: &[Measured<R>], chord_error: R) -> Result<Self, PlanError> {
        if !samples.last().is_some_and(|last| last.point.distance > R::zero()) {
            return Err(PlanError::PathEmpty);
        }
        let margin_after = |i: usize| samples.get(i + 1).map_or_else(R::zero, |next| next.margin);
        let node = |(i, sample): (usize, &Measured<R>)| {
            let lower = lowered(sample.point.feedrate, sample.margin.max(margin_after(i)));
            Node { lower, before: lower, after: lower, speed: sample.speed, curvature: sample.curvature }
        };
        let nodes = samples.iter().enumerate().map(node).collect();
        let points = samples.iter().map(|sample| sample.point).collect();
        let mut limit = Self { points, nodes };
        limit.release_stops(chord_error);
        Ok(limit)
    }

    /// Lets the limit jump at stops: within `reach` of one, the first limit beyond holds.
    fn release_stops(&mut self, reach: R) {
        for i in 0..self.nodes.len() {
            if self.nodes[i].lower > R::zero() {
                continue;
            }
            let here = self.points[i].distance;
            let is_beyond = |point: &LimitPoint<R>| (point.distance - here).abs() > reach;
            let next = self.points[i..].iter().position(is_beyond).map_or(self.nodes.len(), |k| i + k);
            let release = self.nodes.get(next).map_or_else(R::zero, |node| node.lower);
            self.lift(i + 1..next, release);
            let previous = self.points[..i].iter().rposition(is_beyond);
            let release = previous.map_or_else(R::zero, |k| self.nodes[k].lower);
            self.lift(previous.map_or(0, |k| k + 1)..i, release);
        }
        for i in 0..self.nodes.len() {
            if !(self.nodes[i].lower > R::zero()) {
                self.nodes[i].before = i.checked_sub(1).map_or_else(R::zero, |k| self.nodes[k].lower);
                self.nodes[i].after = self.nodes.get(i + 1).map_or_else(R::zero, |node| node.lower);
            }
        }
    }

    fn lift(&mut self, range: core::ops::Range<usize>, at_least: R) {
        for node in self.nodes.get_mut(range).unwrap_or_default() {
            let lower = node.lower.max(at_least);
            (node.lower, node.before, node.after) = (lower, lower, lower);
        }
    }

    /// The points, in order of distance. Points of the same distance are one-sided limits at a joint, with a
    /// stop between them at a corner.
    #[must_use]
    pub fn points(&self) -> &[LimitPoint<R>] {
        &self.points
    }

    pub(crate) fn nodes(&self) -> &[Node<R>] {
        &self.nodes
    }

    /// Arc length of the path, mm.
    #[must_use]
    pub fn length(&self) -> R {
        self.points.last().map_or_else(R::zero, |point| point.distance)
    }

    /// A lower bound of the limit at `distance`: what the planner keeps to.
    ///
    /// Beyond the ends, the bound at the end.
    #[must_use]
    pub fn at(&self, distance: R) -> R {
        let distance = distance.max(R::zero()).min(self.length());
        self.minimum_over(distance, distance)
    }

    /// The least lower bound over a stretch within the path.
    pub(crate) fn minimum_over(&self, from: R, to: R) -> R {
        let first = self.points.partition_point(|point| point.distance < from);
        let end = self.points.partition_point(|point| point.distance <= to).max(first);
        let inside = self.nodes[first..end].iter().fold(R::max_value(), |least, node| least.min(node.lower));
        let at_from = first.checked_sub(1).map_or(inside, |cell| self.in_cell(cell, from));
        let at_to = end.checked_sub(1).map_or(inside, |cell| self.in_cell(cell, to));
        inside.min(at_from).min(at_to)
    }

    /// The lower value at `distance`, between points `cell` and `cell + 1`.
    fn in_cell(&self, cell: usize, distance: R) -> R {
        match self.cell(cell) {
            Some((from, to)) => interpolate(from, to, distance),
            None => R::max_value(),
        }
    }

    /// Distance and lower value at both ends of the stretch between points `cell` and `cell + 1`.
    pub(crate) fn cell(&self, cell: usize) -> Option<((R, R), (R, R))> {
        let (a, b) = (self.points.get(cell)?, self.points.get(cell + 1)?);
        let (from, to) = (self.nodes.get(cell)?, self.nodes.get(cell + 1)?);
        Some(((a.distance, from.after), (b.distance, to.before)))
    }

    /// Curve and parameter at `distance`: the inverse of the arc length, between points by the cubic that has
    /// `du/ds = 1/|C'|` at both.
    pub(crate) fn parameter_at(&self, distance: R) -> (usize, R) {
        let next = self.points.partition_point(|point| point.distance < distance);
        let (Some(b), Some(to)) = (self.points.get(next), self.nodes.get(next)) else {
            return self.points.last().map_or((0, R::zero()), |last| (last.curve, last.u));
        };
        let (Some(a), Some(from)) = (
            next.checked_sub(1).and_then(|i| self.points.get(i)),
            next.checked_sub(1).and_then(|i| self.nodes.get(i)),
        ) else {
            return (b.curve, b.u);
        };
        let (length, width) = (b.distance - a.distance, b.u - a.u);
        if a.curve != b.curve || !(length > R::zero()) {
            return (b.curve, b.u);
        }
        let x = (distance - a.distance) / length;
        // u = u_a + x w + x (1 - x) ((1 - x) (m_a - w) - x (m_b - w)), m the slopes over the cell.
        let slope =
            |speed: R| if speed > length / R::from_ratio(3, 1) / width { length / speed } else { width };
        let (rest_a, rest_b) = (slope(from.speed) - width, slope(to.speed) - width);
        let bend = x * (R::one() - x) * ((R::one() - x) * rest_a - x * rest_b);
        (a.curve, a.u + x * width + bend)
    }

    /// By how much a plan's setpoints would fall short if each chord, not each arc, had the planned length, mm.
    ///
    /// An arc over a chord L of curvature κ is longer by `L³κ²/24`; this is the sum over the plan's periods. Where
    /// a step is longer than the radius, the formula ends: `L κ` counts as 1.
    ///
    /// See [`ScheduleBuf::shortened`](crate::ScheduleBuf::shortened) for what to do about it. A limit made from
    /// points knows no curvature, and gives 0.
    #[must_use]
    pub fn shortfall(&self, schedule: &Schedule<'_, R>) -> R {
        let mut cursor = schedule.start();
        let (mut travelled, mut point, mut sum) = (R::zero(), 0, R::zero());
        while let Some(step) = schedule.advance(&mut cursor) {
            let middle = travelled + step.half();
            travelled = travelled + step;
            point += self.points[point..].partition_point(|p| p.distance < middle);
            let curvature = self.nodes.get(point).map_or_else(R::zero, |node| node.curvature);
            let angle = (step * curvature).min(R::one());
            sum = sum + angle * angle * step;
        }
        sum / R::from_ratio(24, 1)
    }
}

/// `√(V² - margin)`, and no less than half of V: a dip that deep is not resolved.
fn lowered<R: Real>(feedrate: R, margin: R) -> R {
    if !(margin > R::zero()) {
        return feedrate;
    }
    (feedrate * feedrate - margin).sqrt().max(feedrate.half())
}

/// The feed at `distance` on the stretch between two points (distance, feed), `V²` linear in the distance.
pub(crate) fn interpolate<R: Real>(from: (R, R), to: (R, R), distance: R) -> R {
    let length = to.0 - from.0;
    if from.1 == to.1 || !(length > R::zero()) {
        return from.1.min(to.1);
    }
    let x = (distance - from.0) / length;
    let square = from.1 * from.1 + x * ((to.1 - from.1) * (to.1 + from.1));
    square.sqrt().max(from.1.min(to.1)).min(from.1.max(to.1))
}

/// Where on the stretch between two points (distance, feed) the feed is `feed`: the inverse of [`interpolate`].
pub(crate) fn crossing<R: Real>(from: (R, R), to: (R, R), feed: R) -> R {
    if from.1 == to.1 {
        return to.0;
    }
    let x = ((feed - from.1) / (to.1 - from.1)) * ((feed + from.1) / (to.1 + from.1));
    from.0 + (to.0 - from.0) * x.max(R::zero()).min(R::one())
}
