//! The side axes of a problem, A, B, C, U, V and W: where they are along the curves, and what their limits leave for the path.
//!
//! Along a curve of length L an axis that moves by Δq has `q' = Δq/L`, and takes q' times the feed, the acceleration
//! and the jerk of the path. Its limits are those of the path over |q'|. Between two curves q' jumps by Δq', and the
//! axis' velocity by Δq' v: such a joint is passed at `v = p/|Δq'|` for a jump p that is allowed, and where that is too
//! slow the machine rests there.

use nurbs_core::{Evaluate, NurbsBuf, arc_length};
use part_program::{Machine, Part, SIDE_AXES, SideLimits, SideMove};

/// The share of an axis' limits that the jump at a joint may take where no jump is allowed: the velocity may jump by this
/// share of `min(A T, J T²)`, which within a period is an acceleration of this share of A and a jerk of this share of J.
const JUMP_SHARE: f64 = 1.0 / 32.0;
/// The share that curves leave unused beside such a joint: a difference over a period shows the jump twice at most.
const RESERVE: f64 = 2.0 * JUMP_SHARE;
/// Slopes that differ by less than this share are alike: rounding makes more of the lengths.
const ALIKE: f64 = 1e-9;
/// Places that differ by no more are one place, in degrees and mm: G92 rounds what it counts.
const SAME_PLACE: f64 = 1e-9;
/// How exactly lengths of curves are known, in mm.
const LENGTH_TOLERANCE_MM: f64 = 1e-9;
/// Joints that would be passed at less than this share of the commanded feed are rests.
const LEAST_FEED: f64 = 1.0 / 256.0;

/// The columns of the axes in a table of setpoints.
const COLUMNS: [&str; 6] = ["a_deg", "b_deg", "c_deg", "u_mm", "v_mm", "w_mm"];

/// What the side axes do along the curves of a problem. Empty unless one moves while the tool cuts.
#[derive(Clone, Debug, Default)]
pub struct SideAxes {
    /// Numbers of the axes that move.
    axes: Vec<usize>,
    /// How the axes move, in the order of the problem's curves, by whose numbers they are known.
    moves: Vec<SideMove>,
    /// q' of all axes along the curve of each move, in degrees and mm a mm.
    slopes: Vec<[f64; 6]>,
    /// For the curve of each move the ends of its spans in u, with its arc length up to there in mm; empty for a straight line and where
    /// no axis moves.
    lengths: Vec<Vec<(f64, f64)>>,
    /// The number of curves.
    curves: usize,
}

/// The most that side axes leave for the path along a curve, in mm and seconds; infinite where they limit nothing.
#[derive(Clone, Copy, Debug, PartialEq)]
pub(crate) struct SideMost {
    pub(crate) feed: f64,
    pub(crate) acceleration: f64,
    pub(crate) jerk: f64,
}

impl SideAxes {
    /// The side axes of a part, along those of its curves whose numbers are in `taken`. Empty if no axis moves along these.
    pub(crate) fn of<const D: usize>(part: &Part, taken: &[usize], curves: &[NurbsBuf<f64, D>]) -> Self {
        let mut moves: Vec<SideMove> = Vec::new();
        for one in &part.side_moves {
            let curve = taken.partition_point(|index| *index < one.curve);
            // A rapid move is left out: behind it the axes stand where they are then.
            let is_taken = taken.get(curve) == Some(&one.curve);
            let one = if is_taken { *one } else { SideMove { from: one.to, ..*one } };
            if moves.last().is_some_and(|last| last.curve == curve) {
                moves.pop();
            }
            moves.push(SideMove { curve, ..one });
        }
        moves.retain(|one| one.curve < curves.len());
        let axes: Vec<usize> =
            (0..6).filter(|axis| moves.iter().any(|one| one.from[*axis] != one.to[*axis])).collect();
        if axes.is_empty() {
            return Self::default();
        }
        let lengths: Vec<Vec<(f64, f64)>> = moves
            .iter()
            .map(|one| curves.get(one.curve).filter(|_| one.moves()).map_or_else(Vec::new, lengths))
            .collect();
        let slopes = moves.iter().zip(&lengths).map(|(one, lengths)| {
            let of_line = || curves.get(one.curve).filter(|_| one.moves()).map_or(0.0, length);
            let length = lengths.last().map_or_else(of_line, |(_, length)| *length);
            std::array::from_fn(|axis| {
                let way = one.to[axis] - one.from[axis];
                if way == 0.0 { 0.0 } else { way / length }
            })
        });
        let slopes = slopes.collect();
        Self { axes, moves, slopes, lengths, curves: curves.len() }
    }

    /// Whether no side axis moves while the tool cuts.
    #[must_use]
    pub fn is_empty(&self) -> bool {
        self.axes.is_empty()
    }

    /// The letters of the axes that move, as `A, C`.
    #[must_use]
    pub fn letters(&self) -> String {
        self.axes.iter().map(|axis| SIDE_AXES[*axis].to_string()).collect::<Vec<_>>().join(", ")
    }

    /// The axes that move and whose limits the machine does not state, as the keys of a machine file.
    #[must_use]
    pub fn unlimited(&self, machine: &Machine) -> Vec<char> {
        let limits = machine.axes.of_side_axes();
        let has_none = |axis: &&usize| limits[**axis] == SideLimits::default();
        self.axes.iter().filter(has_none).map(|axis| SIDE_AXES[*axis].to_ascii_lowercase()).collect()
    }

    /// The columns of the axes that move, each with the axis' place, in degrees or mm, at this parameter of a curve.
    pub(crate) fn columns<const D: usize>(
        &self,
        curves: &[NurbsBuf<f64, D>],
        curve: usize,
        u: f64,
    ) -> Vec<(&'static str, f64)> {
        if self.is_empty() {
            return Vec::new();
        }
        let places = self.places(curves, curve, u);
        self.axes.iter().map(|axis| (COLUMNS[*axis], places[*axis])).collect()
    }

    /// The places of all axes at this parameter of a curve.
    pub(crate) fn places<const D: usize>(
        &self,
        curves: &[NurbsBuf<f64, D>],
        curve: usize,
        u: f64,
    ) -> [f64; 6] {
        let next = self.moves.partition_point(|one| one.curve <= curve);
        let last = next.checked_sub(1).and_then(|last| self.moves.get(last).zip(self.lengths.get(last)));
        let Some((one, lengths)) = last else {
            return self.moves.first().map_or([0.0; 6], |first| first.from);
        };
        if one.curve < curve || !one.moves() {
            return one.to;
        }
        let share = curves.get(curve).map_or(1.0, |curve| share_of_length(curve, lengths, u));
        std::array::from_fn(|axis| one.from[axis] + share * (one.to[axis] - one.from[axis]))
    }

    /// q' of all axes along a curve.
    pub(crate) fn slopes(&self, curve: usize) -> [f64; 6] {
        let found = self.moves.binary_search_by_key(&curve, |one| one.curve);
        found.ok().and_then(|index| self.slopes.get(index)).copied().unwrap_or_default()
    }

    /// What the axes leave for the path along a curve.
    pub(crate) fn most(&self, curve: usize, machine: &Machine, stops: &[usize]) -> SideMost {
        let mut most = SideMost { feed: f64::INFINITY, acceleration: f64::INFINITY, jerk: f64::INFINITY };
        let slopes = self.slopes(curve);
        let limits = machine.axes.of_side_axes();
        let is_passed =
            |joint: usize| (1..self.curves).contains(&joint) && stops.binary_search(&joint).is_err();
        for axis in self.axes.iter().copied().filter(|axis| slopes[*axis] != 0.0) {
            let slope = slopes[axis].abs();
            let jumps = |joint: usize| {
                is_passed(joint) && differ(self.slopes(joint)[axis], self.slopes(joint - 1)[axis])
            };
            let hides = limits[axis].velocity_jump.is_none() && (jumps(curve) || jumps(curve + 1));
            let left = if hides { 1.0 - RESERVE } else { 1.0 };
            let of = |limit: Option<f64>| limit.map_or(f64::INFINITY, |limit| limit / slope);
            most.feed = most.feed.min(of(limits[axis].velocity));
            most.acceleration = most.acceleration.min(left * of(limits[axis].acceleration));
            most.jerk = most.jerk.min(left * of(limits[axis].jerk));
        }
        most
    }

    /// The feed, in mm/s, at which the joint before a curve may be passed; infinite where no axis changes its share of the
    /// path, or no limit of such an axis is stated.
    pub(crate) fn feed_before(&self, curve: usize, machine: &Machine) -> f64 {
        let Some(before) = curve.checked_sub(1) else { return f64::INFINITY };
        let (before, after) = (self.slopes(before), self.slopes(curve));
        let (limits, t) = (machine.axes.of_side_axes(), machine.interpolation_period_ms / 1000.0);
        let mut least = f64::INFINITY;
        for axis in self.axes.iter().copied().filter(|axis| differ(before[*axis], after[*axis])) {
            let hidden = [limits[axis].acceleration.map(|a| a * t), limits[axis].jerk.map(|j| j * t * t)];
            let hidden = hidden.into_iter().flatten().reduce(f64::min).map(|jump| JUMP_SHARE * jump);
            let jump = limits[axis].velocity_jump.or(hidden).unwrap_or(f64::INFINITY);
            least = least.min(jump / (after[axis] - before[axis]).abs());
        }
        least
    }

    /// The curves that begin at rest for the axes' sake, if `feed_of` gives the commanded feed of a curve: those before which
    /// an axis is elsewhere than it was, and joints that could be passed at a crawl only.
    pub(crate) fn stops(&self, machine: &Machine, feed_of: impl Fn(usize) -> f64) -> Vec<usize> {
        let mut stops = Vec::new();
        let mut at: Option<[f64; 6]> = None;
        for one in &self.moves {
            let is_elsewhere =
                at.is_some_and(|at| at.iter().zip(one.from).any(|(at, from)| (at - from).abs() > SAME_PLACE));
            for joint in [one.curve, one.curve + 1] {
                let feed =
                    joint.checked_sub(1).map_or(f64::INFINITY, |before| feed_of(before).min(feed_of(joint)));
                let crawls = self.feed_before(joint, machine) < LEAST_FEED * feed;
                if joint > 0 && (crawls || is_elsewhere && joint == one.curve) {
                    stops.push(joint);
                }
            }
            at = Some(one.to);
        }
        stops.sort_unstable();
        stops.dedup();
        stops
    }
}

/// Whether two slopes are not alike.
fn differ(one: f64, other: f64) -> bool {
    (one - other).abs() > ALIKE * one.abs().max(other.abs())
}

/// Arc length of a curve, in mm.
fn length<const D: usize>(curve: &NurbsBuf<f64, D>) -> f64 {
    let (begin, end) = curve.as_curve().domain();
    arc_length(&curve.as_curve(), begin, end, LENGTH_TOLERANCE_MM).length
}

/// The ends of a curve's spans in u, each with the arc length up to it in mm; none for a straight line.
fn lengths<const D: usize>(curve: &NurbsBuf<f64, D>) -> Vec<(f64, f64)> {
    let curve = curve.as_curve();
    if curve.degree() == 1 && curve.span_count() == 1 {
        return Vec::new();
    }
    let mut so_far = 0.0;
    let span = |span: usize| {
        let (begin, end) = curve.span_bounds(span);
        so_far += arc_length(&curve, begin, end, LENGTH_TOLERANCE_MM).length;
        (end, so_far)
    };
    (0..curve.span_count()).map(span).collect()
}

/// The share of a curve's length up to a parameter, from the lengths at the ends of its spans.
fn share_of_length<const D: usize>(curve: &NurbsBuf<f64, D>, lengths: &[(f64, f64)], u: f64) -> f64 {
    let curve = curve.as_curve();
    let (begin, end) = curve.domain();
    let Some((_, whole)) = lengths.last() else { return (u - begin) / (end - begin) };
    let span = lengths.partition_point(|(end, _)| *end <= u);
    let (from, before) = span.checked_sub(1).map_or((begin, 0.0), |last| lengths[last]);
    (before + arc_length(&curve, from, u, LENGTH_TOLERANCE_MM).length) / whole
}
