//! Follows the path of a part by the setpoints of a log: where each is, how far off, and at which feed.

use limit_judge::Corner;
use part_program::StatedLimits;

use crate::cruise::{Cruise, CruiseStep};
use crate::in_order::{Cut, InOrder, Way};
use crate::judged_tolerance::{Hidden, JudgedTolerance};
use crate::log_place::LogPlace;
use crate::nearest::Nearest;
use crate::off::Off;
use crate::part_findings::{LineFeed, PartFindings, SkippedMoves};
use crate::part_path::{FLAT_MM, PartPath, distance};

/// The least share of its acceleration at which a machine slows down to the feed of a slower move.
const SLOWING: f64 = 0.1;
/// A setpoint is far from the path from this share of the part's extent on.
const FAR: f64 = 0.01;
/// By how much a step exceeds its feed before its line is named, as a share.
const OVER_FEED: f64 = 1e-6;
/// So near to a corner a step begins at it, in mm, beside what is hidden: as far as segments are from their curves.
const AT_CORNER_MM: f64 = FLAT_MM;
/// Lines and tolerances that are named.
const MOST_LINES: usize = 20;

/// What the path says of a step of the log.
#[derive(Clone, Copy, Debug)]
pub(crate) struct OnPath {
    /// The longest step that is allowed, in mm.
    pub(crate) feed_mm: f64,
    /// The sharpest corner that the step passes or begins at.
    pub(crate) corner: Option<Corner>,
    /// By how much the step is shorter than the path between its ends, in mm; 0 where an end is off the path.
    pub(crate) detour_mm: f64,
}

/// The part's path being followed.
pub(crate) struct PartFollower<'p> {
    path: &'p PartPath,
    /// Whether the log leaves rapid moves out.
    leaves_rapids_out: bool,
    nearest: Nearest<'p>,
    order: InOrder<'p>,
    period_s: f64,
    /// The acceleration of the machine, in mm per period²; 0 if it states none.
    acceleration_mm: f64,
    tolerance_mm: Option<f64>,
    /// The setpoint before, and where it was on the path.
    before: ([f64; 3], Way),
    /// The longest step that was allowed before, and the step that was made.
    allowed_mm: f64,
    step_mm: f64,
    /// The length of the log so far.
    log_mm: f64,
    /// The largest distances from the path, of rapid moves, and of moves at feed under each tolerance by its number.
    rapid_off: Off,
    feed_off: Vec<Off>,
    /// How far a motion that keeps the accelerations of the axes may be from the straight line between two setpoints: A T²/8, in mm.
    between_mm: f64,
    chord_error: Off,
    cruise: Cruise,
    setpoints: u64,
    far: u64,
    box_mm: [[f64; 3]; 2],
    /// The largest step of each move that exceeds its feed, as a share.
    over: Vec<LineFeed>,
}

impl<'p> PartFollower<'p> {
    pub(crate) fn new(
        path: &'p PartPath,
        machine: &StatedLimits,
        (first, leaves_rapids_out): (&[f64; 3], bool),
        (period_s, tolerance_mm): (f64, Option<f64>),
    ) -> Self {
        let axes = [machine.axes.x, machine.axes.y, machine.axes.z];
        let accelerations = axes.iter().filter_map(|axis| axis.acceleration_mm_per_s2);
        let of_axes = accelerations.clone().reduce(f64::min);
        let acceleration = machine.acceleration_mm_per_s2.or(of_axes).unwrap_or(0.0);
        let mut order = InOrder::new(path, first, leaves_rapids_out);
        let way = order.step(first, first, 0.0);
        Self {
            path,
            leaves_rapids_out,
            nearest: Nearest::new(path),
            order,
            period_s,
            acceleration_mm: acceleration * period_s.powi(2),
            tolerance_mm,
            before: (*first, way),
            allowed_mm: 0.0,
            step_mm: 0.0,
            log_mm: 0.0,
            rapid_off: Off::default(),
            feed_off: vec![Off::default(); path.tolerances.count()],
            between_mm: accelerations.map(|most| most * most).sum::<f64>().sqrt() * period_s.powi(2) / 8.0,
            chord_error: Off::default(),
            cruise: Cruise::default(),
            setpoints: 0,
            far: 0,
            box_mm: [*first; 2],
            over: Vec::new(),
        }
    }

    /// Follows the log to a setpoint, over so much of the path that was not seen. A step is known within `hidden_mm`.
    pub(crate) fn follow(&mut self, at: &LogPlace, unseen_mm: f64, hidden_mm: f64) -> OnPath {
        let (from, way_before) = self.before;
        let way = self.order.step(&from, &at.point_mm, unseen_mm);
        self.before = (at.point_mm, way);
        self.setpoints += 1;
        for axis in 0..3 {
            let [least, most] = &mut self.box_mm;
            least[axis] = least[axis].min(at.point_mm[axis]);
            most[axis] = most[axis].max(at.point_mm[axis]);
        }
        self.log_mm += distance(&from, &at.point_mm);
        self.measure(at, &way);
        let allowed_mm = self.allowed(&way_before, &way);
        let step_mm = if unseen_mm > 0.0 { 0.0 } else { distance(&from, &at.point_mm) };
        self.note_feed(at, &way, (step_mm - hidden_mm, allowed_mm));
        let straight_mm = self.step_mm.max(step_mm);
        (self.allowed_mm, self.step_mm) = (allowed_mm, step_mm);
        let ends_mm = [way_before, way].map(|way| self.path.length_to(way.segment, way.share));
        let near_mm = AT_CORNER_MM + hidden_mm;
        // At a sharp corner the place that is found on the path may pass the corner a step later than the tool.
        let turn = self.path.corner_between([ends_mm[0], ends_mm[1] + step_mm], near_mm);
        let corner = turn.filter(|_| unseen_mm <= 0.0).map(|turn| {
            // By so much the acceleration along the path may change the step within half a period.
            let changed_mm = 0.5 * self.acceleration_mm;
            // If the place passes the corner late, the length along the path is too long. The step before, or this one,
            // is straight then, and its length is the right one.
            let legs_mm = (ends_mm[1] - ends_mm[0]).abs().min(straight_mm);
            Corner { turn, step_mm: (legs_mm - changed_mm).max(0.0) }
        });
        let passes_corner = self.path.corner_between(ends_mm, near_mm).is_some();
        let is_late = [way_before, way].iter().any(|way| way.off_2.sqrt() > near_mm);
        // While the place is late, the length along the path of a step over a corner is not known.
        if !(passes_corner && is_late) {
            let legs_mm = if passes_corner { ends_mm[1] - ends_mm[0] } else { step_mm };
            let has_seen = unseen_mm <= 0.0 && self.path.is_feed(way.segment);
            self.note_evenness(at, [way_before, way], has_seen.then_some(legs_mm), hidden_mm);
        }
        let detour_mm = ends_mm[1] - ends_mm[0] - distance(&from, &at.point_mm);
        // Twice the step: no detour of short moves is longer, and a part that was left out is.
        let is_known = unseen_mm <= 0.0 && !is_late && detour_mm <= step_mm;
        OnPath { feed_mm: allowed_mm, corner, detour_mm: if is_known { detour_mm.max(0.0) } else { 0.0 } }
    }

    /// Notes the chord error of a step between two places, and its length for the fluctuation at cruise. `step_mm` is
    /// `None` where the length is not known: then neither is noted.
    fn note_evenness(&mut self, at: &LogPlace, [from, to]: [Way; 2], step_mm: Option<f64>, hidden_mm: f64) {
        let [first, last] = [from, to].map(|way| self.path.segments[way.segment].of_move);
        let line = self.path.moves[last].line;
        let [one, other] = [from, to].map(|way| (way.segment, way.share));
        let chord_mm = step_mm.and_then(|_| self.path.chord_error_mm(one, other));
        if let Some(mm) = chord_mm.filter(|mm| *mm > self.chord_error.mm) {
            self.chord_error = Off { mm, at: Some(*at), line };
        }
        let feed_mm = |of: usize| Some(self.path.moves[of].feed_mm_per_s? * self.period_s);
        let both = feed_mm(first).zip(feed_mm(last)).filter(|(one, other)| one.total_cmp(other).is_eq());
        let step = step_mm.zip(both).map(|(step_mm, (feed_mm, _))| CruiseStep {
            step_mm,
            feed_mm,
            hidden_mm,
            at: *at,
            line,
        });
        self.cruise.take(step);
    }

    /// Measures how far a setpoint is from its place, and from the path.
    fn measure(&mut self, at: &LogPlace, way: &Way) {
        let known = if self.path.is_feed(way.segment) {
            &mut self.feed_off[self.path.tolerance(way.segment)]
        } else {
            &mut self.rapid_off
        };
        let off_mm = way.off_2.sqrt();
        let far_mm = (FAR * self.path.extents_mm[0]).max(10.0 * FLAT_MM);
        let is_worse = |known: &Off, mm: f64| mm > known.mm || known.at.is_none();
        if off_mm <= far_mm && !is_worse(&*known, off_mm + FLAT_MM) {
            return;
        }
        // The exact curve at the place decides whether it is worth to look at every other.
        let own_mm = self.path.exact_distance(&at.point_mm, (way.segment, way.share), off_mm);
        if own_mm <= far_mm && !is_worse(&*known, own_mm) {
            return;
        }
        let mm = self.nearest.distance(&at.point_mm, off_mm);
        self.far += u64::from(mm > far_mm);
        if is_worse(&*known, mm) {
            *known = Off { mm, at: Some(*at), line: self.path.line(way.segment) };
        }
    }

    /// The longest step that is allowed between two places, in mm.
    ///
    /// It is that of the fastest move between them; that of a faster move further on at feed V, from 2 δ + V²/A before its begin on, for a
    /// control that rounds corners within δ speeds up in the rounding; or what a machine still makes that slows down to a slower move, by a
    /// tenth of A at least.
    fn allowed(&self, from: &Way, to: &Way) -> f64 {
        let path = self.path;
        let feed_mm = |index: usize| {
            let one = &path.moves[index];
            let is_free = one.is_rapid || !path.is_feed(to.segment);
            if is_free { f64::INFINITY } else { one.feed_mm_per_s.unwrap_or(f64::INFINITY) * self.period_s }
        };
        let [first, last] = [from, to].map(|way| path.segments[way.segment].of_move);
        let mut allowed_mm = (first.min(last)..=last).map(feed_mm).fold(0.0, f64::max);
        let place_mm = path.length_to(to.segment, to.share);
        let rounding_mm = self.tolerance_mm.unwrap_or(0.0).max(to.off_2.sqrt());
        let way_to_mm = |index: usize| {
            index.checked_sub(1).map_or(0.0, |before| path.so_far_mm[path.moves[before].end] - place_mm)
        };
        // Moves of one feed are looked at together: by the way to the first, and then to the last of them.
        let mut index = last;
        while index < path.moves.len() {
            let feed_mm = feed_mm(index);
            let speeding_mm =
                if self.acceleration_mm > 0.0 { feed_mm * feed_mm / self.acceleration_mm } else { 0.0 };
            // Before a rapid move too a control speeds up at the end of its rounding alone.
            let within_mm = 2.0 * self.step_mm
                + 2.0 * rounding_mm
                + if speeding_mm.is_finite() { speeding_mm } else { 0.0 };
            if index > last && way_to_mm(index) > within_mm {
                break;
            }
            allowed_mm = allowed_mm.max(feed_mm);
            let until = path.moves[index].alike_until;
            if until > index + 1 && way_to_mm(until - 1) > within_mm {
                break;
            }
            index = until;
        }
        if self.acceleration_mm > 0.0 {
            allowed_mm.max(self.allowed_mm.min(self.step_mm) - SLOWING * self.acceleration_mm)
        } else {
            allowed_mm
        }
    }

    /// Notes the line of a step that is longer than allowed.
    fn note_feed(&mut self, at: &LogPlace, way: &Way, (step_mm, allowed_mm): (f64, f64)) {
        if step_mm <= allowed_mm * (1.0 + OVER_FEED) || allowed_mm <= 0.0 {
            return;
        }
        let one = LineFeed {
            line: self.path.line(way.segment),
            commanded_mm_per_s: allowed_mm / self.period_s,
            largest_mm_per_s: step_mm / self.period_s,
            at: *at,
        };
        let share = |one: &LineFeed| one.largest_mm_per_s / one.commanded_mm_per_s;
        match self.over.iter_mut().find(|known| known.line == one.line) {
            Some(known) if share(known) < share(&one) => *known = one,
            Some(_) => {}
            None => self.over.push(one),
        }
        self.over.sort_by(|one, other| share(other).total_cmp(&share(one)));
        self.over.truncate(MOST_LINES);
    }

    /// What was found, at the end of the log; `hidden_mm` is how far the motion may be from a setpoint.
    pub(crate) fn finished(&self, hidden_mm: f64) -> PartFindings {
        let followed = self.order.finished(&self.before.0);
        let way = followed.way;
        let line = |segment: usize| self.path.line(segment);
        let skipped = followed.skips.iter().map(|skip| SkippedMoves {
            lines: [line((skip.from + 1).min(skip.to)), line(skip.to.saturating_sub(1).max(skip.from))],
            length_mm: self.seen_length_mm(skip.from + 1..skip.to),
            off_mm: skip.off_mm,
        });
        let skipped: Vec<SkippedMoves> = skipped.filter(|skip| skip.length_mm > 0.0).collect();
        let ends_at_mm = self.path.length_to(way.segment, way.share);
        let here_mm = self.seen_length_mm(way.segment..way.segment + 1);
        let behind_mm = self.seen_length_mm(way.segment + 1..self.path.segments.len());
        let left_mm = (1.0 - way.share) * here_mm + behind_mm;
        let skipped_mm: f64 = skipped.iter().map(|skip| skip.length_mm).sum();
        let order_mm = way.largest_2.sqrt();
        PartFindings {
            moves: self.path.moves.len(),
            length_mm: self.path.length_mm(),
            nearest: worst_of(&self.feed_off),
            nearest_rapid: self.rapid_off,
            order_mm,
            path_to_log_mm: followed.from_path_mm,
            tolerance_mm: self.tolerance_mm,
            tolerances: self.tolerances(&followed.cuts, hidden_mm),
            chord_error: self.chord_error,
            fluctuation: self.cruise.worst,
            skipped,
            left_mm,
            ends_at_mm,
            never_visited_mm: (left_mm + skipped_mm).min(self.path.length_mm()),
            log_mm: self.log_mm,
            ends_in_line: line(way.segment),
            over_feed: self.over.clone(),
            far_share: self.far as f64 / self.setpoints.max(1) as f64,
            unit_ratio: self.unit_ratio(),
            hidden_mm,
        }
    }

    /// How the tolerances of the part are kept, of those under which the log moved, the one that is used most first.
    fn tolerances(&self, cuts: &[Cut], hidden_mm: f64) -> Vec<JudgedTolerance> {
        let hidden = Hidden { by_resolution_mm: hidden_mm, between_setpoints_mm: self.between_mm };
        let stated = self.path.tolerances.stated.iter().zip(&self.feed_off[1..]).zip(&cuts[1..]);
        let judged = stated.filter(|((_, off), _)| off.at.is_some()).map(|((tolerance, off_path), cut)| {
            let off_log = Off { mm: cut.off_mm, at: None, line: self.path.line(cut.segment) };
            JudgedTolerance::of(tolerance, [*off_path, off_log], hidden)
        });
        let mut judged: Vec<JudgedTolerance> = judged.collect();
        judged.sort_by(|one, other| other.used().total_cmp(&one.used()));
        judged.truncate(MOST_LINES);
        judged
    }

    /// The length of some segments of the path, in mm. Rapid moves do not count where the log leaves them out.
    fn seen_length_mm(&self, segments: std::ops::Range<usize>) -> f64 {
        let shown = segments.filter(|segment| !self.leaves_rapids_out || self.path.is_feed(*segment));
        shown.map(|segment| self.path.so_far_mm[segment + 1] - self.path.so_far_mm[segment]).sum()
    }

    /// The ratio of two units, if that is what log and part differ by in size.
    fn unit_ratio(&self) -> Option<f64> {
        let [least, most] = &self.box_mm;
        let ratios = self.path.extents_mm.map(|extent_mm| distance(least, most) / extent_mm);
        let is_of = |unit: &f64| ratios.iter().any(|ratio| (ratio / unit - 1.0).abs() < 0.02);
        [25.4, 1.0 / 25.4, 1000.0, 1e-3].into_iter().find(is_of)
    }
}

/// The largest of some distances.
fn worst_of(all: &[Off]) -> Off {
    let known = all.iter().copied().filter(|off| off.at.is_some());
    known.reduce(|one, other| if other.mm > one.mm { other } else { one }).unwrap_or_default()
}
