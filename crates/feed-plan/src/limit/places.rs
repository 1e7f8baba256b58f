//! What is at a distance along a limit: the points beside it, the corners beyond it, the curve and its parameter.

use core::cell::Cell;

use real::Real;

use crate::limit::sample::LimitSample;
use crate::{FeedLimit, LimitPoint};

/// Between points that are less than 2⁴ roundings apart the parameter does not tell where the path is.
const RESOLVED: i32 = 4;

/// Steps of a walk before a search is shorter.
const STEPS: usize = 8;

impl<R: Real> FeedLimit<R> {
    /// Number of points before `distance`, which is the index of the next one.
    pub(super) fn count_before(&self, distance: R) -> usize {
        self.samples.partition_point(|sample| sample.point.distance < distance)
    }

    /// Number of points up to `distance`.
    pub(super) fn count_up_to(&self, distance: R) -> usize {
        self.samples.partition_point(|sample| sample.point.distance <= distance)
    }

    /// The last point before `distance`.
    #[must_use]
    pub fn point_before(&self, distance: R) -> Option<&LimitPoint<R>> {
        let before = self.count_before(distance).checked_sub(1)?;
        self.samples.get(before).map(|sample| &sample.point)
    }

    /// The distances beyond `distance` at which the tangent breaks, in order, sought from the corner at which the last
    /// search ended.
    pub(crate) fn corners_near(&self, distance: R, last: &Cell<usize>) -> &[R] {
        let passed = walk(&self.corners, last.get(), |corner| *corner <= distance);
        last.set(passed);
        self.corners.get(passed..).unwrap_or_default()
    }

    /// The curve that begins at rest, whatever its direction, at `distance`, give or take rounding.
    pub(crate) fn begins_at_rest(&self, distance: R) -> Option<usize> {
        let rounding = self.rounding();
        let next = self.from_rest.partition_point(|(begin, _)| *begin < distance - rounding);
        self.from_rest.get(next).filter(|(begin, _)| *begin <= distance + rounding).map(|(_, curve)| *curve)
    }

    /// The first curve beyond `distance` that begins at rest whatever its direction, with the distance of its begin.
    pub(crate) fn next_from_rest(&self, distance: R) -> Option<(R, usize)> {
        let beyond = distance + self.rounding();
        let next = self.from_rest.partition_point(|(begin, _)| *begin <= beyond);
        self.from_rest.get(next).copied()
    }

    /// Whether the parameter tells places apart everywhere. Between knots that are a few roundings apart it does not,
    /// though the path between them may be long.
    pub(crate) fn is_resolved(&self) -> bool {
        self.samples.windows(2).all(is_resolved)
    }

    /// Whether the parameter tells places apart near `distance`.
    pub(crate) fn is_resolved_at(&self, distance: R) -> bool {
        let next = self.count_before(distance);
        let pair = next.checked_sub(1).and_then(|before| self.samples.get(before..=next));
        pair.is_none_or(is_resolved)
    }

    /// Curve and parameter at `distance`: the inverse of the arc length. Between two points it is the cubic that has
    /// `du/ds = 1/|C'|` at both.
    #[must_use]
    pub fn parameter_at(&self, distance: R) -> (usize, R) {
        self.parameter_before(self.count_before(distance), distance)
    }

    /// The same, sought from the point at which the last search ended: for walks along the path.
    #[must_use]
    pub fn parameter_near(&self, distance: R, last: &Cell<usize>) -> (usize, R) {
        let next = walk(&self.samples, last.get(), |sample| sample.point.distance < distance);
        last.set(next);
        self.parameter_before(next, distance)
    }

    /// The curve that holds all of the way between two distances, if one does, sought from the point at which the last search ended.
    pub(crate) fn curve_over(&self, from: R, to: R, last: &Cell<usize>) -> Option<usize> {
        let next = walk(&self.samples, last.get(), |sample| sample.point.distance <= from);
        last.set(next);
        let begin = self.samples.get(next.checked_sub(1)?)?.point.curve;
        let mut behind = self.samples.get(next..)?.iter().map(|sample| &sample.point);
        let end = behind.find(|point| point.curve != begin || point.distance > to)?;
        (end.curve == begin).then_some(begin)
    }

    /// Curve and parameter at a distance before point `next` and not before the one before that.
    fn parameter_before(&self, next: usize, distance: R) -> (usize, R) {
        let Some(to) = self.samples.get(next) else {
            return self.samples.last().map_or((0, R::zero()), |last| (last.point.curve, last.point.u));
        };
        let Some(from) = next.checked_sub(1).and_then(|before| self.samples.get(before)) else {
            return (to.point.curve, to.point.u);
        };
        let (a, b) = (from.point, to.point);
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
}

/// The number of items before the first that is not passed, sought from a number that is near it.
fn walk<T>(items: &[T], from: usize, is_passed: impl Fn(&T) -> bool) -> usize {
    let mut count = from.min(items.len());
    for _ in 0..STEPS {
        if count.checked_sub(1).is_some_and(|before| !is_passed(&items[before])) {
            count -= 1;
        } else if items.get(count).is_some_and(&is_passed) {
            count += 1;
        } else {
            return count;
        }
    }
    items.partition_point(is_passed)
}

/// Whether the parameter tells places between two neighbouring points apart, or the path has no length between them.
fn is_resolved<R: Real>(pair: &[LimitSample<R>]) -> bool {
    let [LimitSample { point: a, .. }, LimitSample { point: b, .. }] = pair else { return true };
    let rounding = R::resolution() * a.u.abs().max(b.u.abs());
    a.curve != b.curve || a.distance == b.distance || b.u - a.u > rounding.ldexp(RESOLVED)
}

#[cfg(test)]
mod tests {
    use nurbs_core::{NurbsBuf, arc_length};

    use crate::test_paths::{paper_limit_along, seed_003};

    #[test]
    fn parameters_follow_the_arc_length() {
        let curve = seed_003();
        let limit = paper_limit_along(&curve);
        for i in 0..=500 {
            let u = f64::from(i) / 500.0;
            let distance = arc_length(&curve.as_curve(), 0.0, u, 1e-12).length;
            let (index, found) = limit.parameter_at(distance);
            assert!(index == 0 && (found - u).abs() < 1e-6, "{u}: {found}");
        }
    }

    /// Where the speed along a curve changes a thousandfold within a span, distances were once off by half of a
    /// stretch, and so were the lengths by which stages were shortened.
    #[test]
    fn parameters_follow_the_arc_length_where_the_speed_changes_much() {
        let points = vec![[0.0, 0.0], [40.0, 30.0], [80.0, 0.0]];
        let knots = vec![0.0, 0.0, 0.0, 1.0, 1.0, 1.0];
        let curve = NurbsBuf::try_new(2, points, vec![1e-3, 1.0, 1e3], knots).unwrap();
        let limit = paper_limit_along(&curve);
        for i in 1..=400 {
            let u = (f64::from(i) / 400.0).powi(4);
            let distance = arc_length(&curve.as_curve(), 0.0, u, 1e-12).length;
            let (_, found) = limit.parameter_at(distance);
            let off = arc_length(&curve.as_curve(), u.min(found), u.max(found), 1e-12).length;
            assert!(off < 1e-3, "{u}: {off} mm at {distance} mm");
        }
    }
}
