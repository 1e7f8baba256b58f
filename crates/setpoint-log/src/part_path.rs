//! The path of a part as straight segments, none farther from the exact curve than a tolerance.

use nurbs_core::{
    CurveError, Derivatives, Differentiate, Evaluate, NurbsBuf, distance_to_segment, tangent_breaks,
};
use part_program::{MoveKind, Part, is_joined};

use crate::tolerances::Tolerances;

/// How far a segment may be from its curve, in mm. Figures of curves are taken from the curves themselves.
pub(crate) const FLAT_MM: f64 = 1e-4;
/// C' is 0 if it is no more than this share of what C'' adds to it over the span: the rest is rounding.
const STANDSTILL: f64 = 1e-12;
/// Halvings of a knot span, at most.
const DEEPEST: u32 = 16;

/// A straight segment of the path, from its vertex to the next.
#[derive(Clone, Copy, Debug)]
pub(crate) struct Segment {
    /// The move in which it lies; the one behind it if it bridges a gap between two.
    pub(crate) of_move: usize,
    /// The parameters of the curve at its ends.
    u: [f64; 2],
    pub(crate) is_gap: bool,
}

/// A move of the part.
#[derive(Debug)]
pub(crate) struct PathMove {
    pub(crate) line: usize,
    pub(crate) is_rapid: bool,
    /// The feed that it commands, in mm/s.
    pub(crate) feed_mm_per_s: Option<f64>,
    pub(crate) length_mm: f64,
    /// The vertex at its end.
    pub(crate) end: usize,
    /// The first move behind it that is rapid where it is not, or has another feed.
    pub(crate) alike_until: usize,
    /// The curve, if it is no straight line.
    curve: Option<NurbsBuf<f64, 3>>,
}

/// The path of a part.
#[derive(Debug)]
pub(crate) struct PartPath {
    /// One more than segments.
    pub(crate) vertices: Vec<[f64; 3]>,
    pub(crate) segments: Vec<Segment>,
    pub(crate) moves: Vec<PathMove>,
    /// The length of the path up to each vertex, in mm.
    pub(crate) so_far_mm: Vec<f64>,
    /// The diagonals of the boxes around it and around what lies behind its begin, which a log in another unit has elsewhere, in mm.
    pub(crate) extents_mm: [f64; 2],
    /// How far the part lets a control go from its path.
    pub(crate) tolerances: Tolerances,
    /// The corners: their vertices, and by how much each component of the unit tangent changes there.
    corners: Vec<(usize, [f64; 3])>,
    /// The tangent at the last vertex so far, of any length.
    arriving: [f64; 3],
}

impl PartPath {
    /// The path of a part whose moves without a feed have `feed_mm_per_s`.
    ///
    /// # Errors
    /// [`CurveError`] if a curve is not valid.
    pub(crate) fn new(part: &Part, feed_mm_per_s: Option<f64>) -> Result<Self, CurveError> {
        let mut path = Self {
            vertices: Vec::new(),
            segments: Vec::new(),
            moves: Vec::new(),
            so_far_mm: Vec::new(),
            extents_mm: [0.0; 2],
            tolerances: Tolerances::new(&part.tolerances),
            corners: Vec::new(),
            arriving: [0.0; 3],
        };
        for (curve, one) in part.curves.iter().zip(&part.moves) {
            let points = curve.control_points_mm();
            let is_straight = curve.degree() == 1 && points.len() == 2;
            let exact = curve.for_evaluation()?;
            path.moves.push(PathMove {
                line: one.line,
                is_rapid: one.kind == MoveKind::Rapid,
                feed_mm_per_s: one.feedrate_mm_per_s.or(feed_mm_per_s),
                length_mm: 0.0,
                end: 0,
                alike_until: 0,
                curve: (!is_straight).then_some(exact),
            });
            path.add_vertices(points);
            let end = path.vertices.len() - 1;
            if let Some(last) = path.moves.last_mut() {
                last.end = end;
            }
        }
        path.find_alike();
        let ends = |axis: usize, from: usize| {
            let all = || path.vertices.iter().skip(from).map(|vertex| vertex[axis]);
            all().fold(f64::NEG_INFINITY, f64::max) - all().fold(f64::INFINITY, f64::min)
        };
        let mut so_far = 0.0;
        let steps = path.vertices.windows(2).map(|pair| distance(&pair[0], &pair[1]));
        path.so_far_mm = std::iter::once(0.0)
            .chain(steps)
            .map(|step| {
                so_far += step;
                so_far
            })
            .collect();
        path.extents_mm = [0, 1].map(|from| (0..3).map(|axis| ends(axis, from).powi(2)).sum::<f64>().sqrt());
        Ok(path)
    }

    /// Finds for each move how far those behind it have its feed.
    fn find_alike(&mut self) {
        let mut until = self.moves.len();
        for index in (0..self.moves.len()).rev() {
            let of = |one: &PathMove| (one.is_rapid, one.feed_mm_per_s);
            if self.moves.get(index + 1).is_some_and(|next| of(next) != of(&self.moves[index])) {
                until = index + 1;
            }
            self.moves[index].alike_until = until;
        }
    }

    /// Adds the vertices of the last move.
    fn add_vertices(&mut self, points: &[[f64; 3]]) {
        let of_move = self.moves.len() - 1;
        let (first, last) = (points[0], points[points.len() - 1]);
        match self.vertices.last() {
            None => self.vertices.push(first),
            Some(before) if *before != first => {
                // A path turns over no gap that is a rounding of its numbers.
                if !is_joined(before, &first) {
                    let way = difference(&first, before);
                    self.pass_joint(&way, way);
                }
                self.vertices.push(first);
                self.segments.push(Segment { of_move, u: [0.0; 2], is_gap: true });
            }
            Some(_) => {}
        }
        let from = self.vertices.len() - 1;
        let Some(exact) = self.moves[of_move].curve.take() else {
            let way = difference(&last, &first);
            self.pass_joint(&way, way);
            self.add(last, of_move, [0.0, 1.0]);
            self.moves[of_move].length_mm = distance(&first, &last);
            return;
        };
        let curve = exact.as_curve();
        for span in 0..curve.span_count() {
            let (begin, end) = curve.span_bounds(span);
            let [leaving, arriving] = [(begin, end - begin), (end, begin - end)]
                .map(|(u, inwards)| tangent(&curve.derivatives_in(span, u), inwards));
            self.pass_joint(&leaving, arriving);
            let ends = [begin, end].map(|u| (u, curve.point(u)));
            self.flatten(&|u| curve.point(u), ends, of_move, 0);
        }
        self.moves[of_move].length_mm =
            self.vertices[from..].windows(2).map(|pair| distance(&pair[0], &pair[1])).sum();
        self.moves[of_move].curve = Some(exact);
    }

    /// Notes whether the path has a corner at its last vertex, from which it goes on with a tangent; it ends with another.
    fn pass_joint(&mut self, leaving: &[f64; 3], arriving: [f64; 3]) {
        let before = std::mem::replace(&mut self.arriving, arriving);
        if tangent_breaks(&before, leaving) {
            let [from, to] = [before, *leaving].map(|tangent| norm(&tangent));
            let turn = std::array::from_fn(|axis| (leaving[axis] / to - before[axis] / from).abs());
            self.corners.push((self.vertices.len() - 1, turn));
        }
    }

    /// By how much each component of the unit tangent changes at the sharpest corner between two places of the path, in
    /// mm from its begin, or within `near_mm` of them.
    pub(crate) fn corner_between(&self, [from_mm, to_mm]: [f64; 2], near_mm: f64) -> Option<[f64; 3]> {
        let begin = from_mm.min(to_mm) - near_mm;
        let first = self.corners.partition_point(|(vertex, _)| self.so_far_mm[*vertex] < begin);
        let end = from_mm.max(to_mm) + near_mm;
        let met = self.corners[first..].iter().take_while(|(vertex, _)| self.so_far_mm[*vertex] <= end);
        met.map(|(_, turn)| *turn).max_by(|one, other| norm(one).total_cmp(&norm(other)))
    }

    /// The largest distance of a curve from the chord between two places on it, in mm, of those at a quarter, half and
    /// three quarters of the way in u; `None` if the places are on no curve, or on two.
    pub(crate) fn chord_error_mm(&self, from: (usize, f64), to: (usize, f64)) -> Option<f64> {
        let own = |(segment, share): (usize, f64)| {
            let Segment { of_move, u, is_gap } = self.segments[segment];
            (!is_gap).then_some((of_move, u[0] + share * (u[1] - u[0])))
        };
        let ((first, begin), (last, end)) = (own(from)?, own(to)?);
        let curve = self.moves[first].curve.as_ref().filter(|_| first == last)?.as_curve();
        let chord = [begin, end].map(|u| curve.point(u));
        let off = |share: f64| distance_to_segment(&curve.point(begin + share * (end - begin)), &chord);
        [0.25, 0.5, 0.75].into_iter().map(off).reduce(f64::max)
    }

    fn add(&mut self, vertex: [f64; 3], of_move: usize, u: [f64; 2]) {
        self.vertices.push(vertex);
        self.segments.push(Segment { of_move, u, is_gap: false });
    }

    /// Adds the segments from one place of a curve to another, behind the vertex of the first.
    fn flatten(
        &mut self,
        point: &dyn Fn(f64) -> [f64; 3],
        [from, to]: [(f64, [f64; 3]); 2],
        of_move: usize,
        depth: u32,
    ) {
        let at = |share: f64| from.0 + share * (to.0 - from.0);
        let chord = [from.1, to.1];
        let is_flat = |share: &f64| distance_to_segment(&point(at(*share)), &chord) <= 0.5 * FLAT_MM;
        if depth >= DEEPEST || [0.25, 0.5, 0.75].iter().all(is_flat) {
            return self.add(to.1, of_move, [from.0, to.0]);
        }
        let middle = (at(0.5), point(at(0.5)));
        self.flatten(point, [from, middle], of_move, depth + 1);
        self.flatten(point, [middle, to], of_move, depth + 1);
    }

    pub(crate) fn ends(&self, segment: usize) -> [[f64; 3]; 2] {
        [self.vertices[segment], self.vertices[segment + 1]]
    }

    /// The length of the path up to a place, in mm.
    pub(crate) fn length_to(&self, segment: usize, share: f64) -> f64 {
        let [from, to] = [self.so_far_mm[segment], self.so_far_mm[segment + 1]];
        from + share * (to - from)
    }

    /// The length of the whole path, in mm.
    pub(crate) fn length_mm(&self) -> f64 {
        self.so_far_mm.last().copied().unwrap_or(0.0)
    }

    /// The line of the program of a segment.
    pub(crate) fn line(&self, segment: usize) -> usize {
        self.moves[self.segments[segment].of_move].line
    }

    /// The number of the tolerance that holds on a segment.
    pub(crate) fn tolerance(&self, segment: usize) -> usize {
        self.tolerances.at(self.segments[segment].of_move)
    }

    /// Whether a segment is cut at a feed.
    pub(crate) fn is_feed(&self, segment: usize) -> bool {
        self.segments.get(segment).is_none_or(|one| !one.is_gap && !self.moves[one.of_move].is_rapid)
    }

    /// The distance of a point from the exact curve near a place on a segment, in mm; `near_mm` is its distance from the segment.
    ///
    /// Newton's iteration for the foot of the perpendicular, (C - P)·C' = 0, from the place's parameter; what leaves the
    /// curve's domain ends there. The least distance of all iterates counts, so it is never above the true one by more than the segment is
    /// from the curve.
    pub(crate) fn exact_distance(
        &self,
        point: &[f64; 3],
        (segment, share): (usize, f64),
        near_mm: f64,
    ) -> f64 {
        let Segment { of_move, u, .. } = self.segments[segment];
        let Some(curve) = &self.moves[of_move].curve else { return near_mm };
        let curve = curve.as_curve();
        let (begin, end) = curve.domain();
        let (mut u, mut least) = (u[0] + share * (u[1] - u[0]), f64::INFINITY);
        for _ in 0..8 {
            let Derivatives { point: at, first, second, .. } = curve.derivatives(u);
            let off: [f64; 3] = std::array::from_fn(|axis| at[axis] - point[axis]);
            least = least.min(norm(&off));
            let slope = dot(&first, &first) + dot(&off, &second);
            let next = (u - dot(&off, &first) / slope).clamp(begin, end);
            if slope <= 0.0 || !next.is_finite() || (next - u).abs() <= 1e-12 * (end - begin) {
                break;
            }
            u = next;
        }
        least.min(near_mm + FLAT_MM)
    }
}

pub(crate) fn dot(a: &[f64; 3], b: &[f64; 3]) -> f64 {
    a[0] * b[0] + a[1] * b[1] + a[2] * b[2]
}

pub(crate) fn norm(a: &[f64; 3]) -> f64 {
    dot(a, a).sqrt()
}

/// From one point to another.
fn difference(to: &[f64; 3], from: &[f64; 3]) -> [f64; 3] {
    std::array::from_fn(|axis| to[axis] - from[axis])
}

pub(crate) fn distance(a: &[f64; 3], b: &[f64; 3]) -> f64 {
    squared_distance(a, b).sqrt()
}

pub(crate) fn squared_distance(a: &[f64; 3], b: &[f64; 3]) -> f64 {
    let off = [a[0] - b[0], a[1] - b[1], a[2] - b[2]];
    dot(&off, &off)
}

/// The share of the way from A to B at which a point is nearest, and the square of its distance there; not before `least`.
#[inline]
pub(crate) fn foot(point: &[f64; 3], [a, b]: &[[f64; 3]; 2], least: f64) -> (f64, f64) {
    let way = [b[0] - a[0], b[1] - a[1], b[2] - a[2]];
    let from = [point[0] - a[0], point[1] - a[1], point[2] - a[2]];
    let length = dot(&way, &way);
    let share = if length > 0.0 { (dot(&from, &way) / length).clamp(least, 1.0) } else { 1.0 };
    let off = [from[0] - share * way[0], from[1] - share * way[1], from[2] - share * way[2]];
    (share, dot(&off, &off))
}

/// The direction of a curve at an end of a span, from which the span goes `inwards` by as much in u. Where C' is 0, as at a doubled
/// control point, that is C'' u for a small u.
fn tangent(end: &Derivatives<f64, 3>, inwards: f64) -> [f64; 3] {
    let is_standstill = norm(&end.first) <= STANDSTILL * norm(&end.second) * inwards.abs();
    if is_standstill { end.second.map(|x| x * inwards) } else { end.first }
}

#[cfg(test)]
mod tests {
    use part_program::read_part;

    use super::*;

    /// The unit tangents' changes at the corners of a part.
    fn turns(name: &str, text: &str) -> Vec<[f64; 3]> {
        let part = read_part(name, text).expect("a part");
        let path = PartPath::new(&part, Some(10.0)).expect("a path");
        path.corners.iter().map(|(_, turn)| *turn).collect()
    }

    /// Two lines that go on in one direction, their ends a rounding apart, had two right angles.
    #[test]
    fn a_gap_that_is_a_rounding_is_no_corner() {
        let lines = |apart: f64| {
            format!(
                "[[curve]]\ndegree = 1\ncontrol_points_mm = [[0, 0], [10, 0]]\nknots = [0, 0, 1, 1]\n\
                 [[curve]]\ndegree = 1\ncontrol_points_mm = [[10, {apart}], [20, {apart}]]\nknots = [0, 0, 1, 1]\n"
            )
        };
        assert!(turns("p.toml", &lines(5e-7)).is_empty());
        assert_eq!(turns("p.toml", &lines(0.01)).len(), 2);
    }

    /// A cubic that ends in a doubled control point has no tangent there, and still a direction: the corner behind it was lost.
    #[test]
    fn a_curve_that_ends_at_a_standstill_turns_into_the_next_one() {
        let found = turns("p.nc", "G21 G90 G17\nG0 X0 Y0\nG1 F3000\nG5 X60 Y0 I20 J0 P0 Q0\nG1 Y5\n");
        assert_eq!(found.len(), 1, "{found:?}");
        assert!(found[0].iter().zip([1.0, 1.0, 0.0]).all(|(x, right)| (x - right).abs() < 1e-9), "{found:?}");
        let begins = turns("p.nc", "G21 G90 G17\nG0 X0 Y0\nG1 X0 Y5 F3000\nG5 X60 Y5 I0 J0 P-20 Q0\n");
        assert_eq!(begins.len(), 1, "{begins:?}");
    }
}
