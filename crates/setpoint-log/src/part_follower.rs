//! Follows the path of a part by the setpoints of a log: where each is, how far off, and at which feed.

use part_program::StatedLimits;

use crate::in_order::{InOrder, Way};
use crate::log_place::LogPlace;
use crate::nearest::Nearest;
use crate::part_findings::{LineFeed, Off, PartFindings, SkippedMoves};
use crate::part_path::{FLAT_MM, PartPath, distance};

/// The least share of its acceleration at which a machine slows down to the feed of a slower move.
const SLOWING: f64 = 0.1;
/// A setpoint is far from the path from this share of the part's extent on.
const FAR: f64 = 0.01;
/// By how much a step exceeds its feed before its line is named, as a share.
const OVER_FEED: f64 = 1e-6;
/// Lines that are named.
const MOST_LINES: usize = 20;

/// The part's path being followed.
pub(crate) struct PartFollower<'p> {
    path: &'p PartPath,
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
    nearest_off: [Off; 2],
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
        first: &[f64; 3],
        (period_s, tolerance_mm): (f64, Option<f64>),
    ) -> Self {
        let axes = [machine.axes.x, machine.axes.y, machine.axes.z];
        let of_axes = axes.iter().filter_map(|axis| axis.acceleration_mm_per_s2).reduce(f64::min);
        let acceleration = machine.acceleration_mm_per_s2.or(of_axes).unwrap_or(0.0);
        let mut order = InOrder::new(path, first);
        let way = order.step(first, first, 0.0);
        Self {
            path,
            nearest: Nearest::new(path),
            order,
            period_s,
            acceleration_mm: acceleration * period_s.powi(2),
            tolerance_mm,
            before: (*first, way),
            allowed_mm: 0.0,
            step_mm: 0.0,
            log_mm: 0.0,
            nearest_off: [Off::default(); 2],
            setpoints: 0,
            far: 0,
            box_mm: [*first; 2],
            over: Vec::new(),
        }
    }

    /// Follows the log to a setpoint, over so much of the path that was not seen; returns the longest step that is allowed there, in mm.
    /// A step is known within `hidden_mm`.
    pub(crate) fn follow(&mut self, at: &LogPlace, unseen_mm: f64, hidden_mm: f64) -> f64 {
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
        (self.allowed_mm, self.step_mm) = (allowed_mm, step_mm);
        allowed_mm
    }

    /// Measures how far a setpoint is from its place, and from the path.
    fn measure(&mut self, at: &LogPlace, way: &Way) {
        let kind = usize::from(!self.path.is_feed(way.segment));
        let line = self.path.moves[self.path.segments[way.segment].of_move].line;
        let off_mm = way.off_2.sqrt();
        let far_mm = (FAR * self.path.extent_mm).max(10.0 * FLAT_MM);
        let is_worse = |known: &Off, mm: f64| mm > known.mm || known.at.is_none();
        if off_mm <= far_mm && !is_worse(&self.nearest_off[kind], off_mm + FLAT_MM) {
            return;
        }
        // The exact curve at the place decides whether it is worth to look at every other.
        let own_mm = self.path.exact_distance(&at.point_mm, (way.segment, way.share), off_mm);
        if own_mm <= far_mm && !is_worse(&self.nearest_off[kind], own_mm) {
            return;
        }
        let mm = self.nearest.distance(&at.point_mm, off_mm);
        self.far += u64::from(mm > far_mm);
        if is_worse(&self.nearest_off[kind], mm) {
            self.nearest_off[kind] = Off { mm, at: Some(*at), line };
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
        for index in last + 1..path.moves.len() {
            let feed_mm = feed_mm(index);
            let way_mm = path.so_far_mm[path.moves[index - 1].end] - place_mm;
            let speeding_mm =
                if self.acceleration_mm > 0.0 { feed_mm * feed_mm / self.acceleration_mm } else { 0.0 };
            // Before a rapid move too a control speeds up at the end of its rounding alone.
            let within_mm = 2.0 * self.step_mm
                + 2.0 * rounding_mm
                + if speeding_mm.is_finite() { speeding_mm } else { 0.0 };
            if way_mm > within_mm {
                break;
            }
            allowed_mm = allowed_mm.max(feed_mm);
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
            line: self.path.moves[self.path.segments[way.segment].of_move].line,
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
        let line = |segment: usize| self.path.moves[self.path.segments[segment].of_move].line;
        let skipped = followed.skips.iter().map(|skip| SkippedMoves {
            lines: [line((skip.from + 1).min(skip.to)), line(skip.to.saturating_sub(1).max(skip.from))],
            length_mm: self.path.so_far_mm[skip.to] - self.path.so_far_mm[skip.from + 1],
            off_mm: skip.off_mm,
        });
        let skipped: Vec<SkippedMoves> = skipped.collect();
        let ends_at_mm = self.path.length_to(way.segment, way.share);
        let visited_mm = (ends_at_mm - skipped.iter().map(|skip| skip.length_mm).sum::<f64>()).max(0.0);
        let order_mm = way.largest_2.sqrt();
        PartFindings {
            moves: self.path.moves.len(),
            length_mm: self.path.length_mm(),
            nearest: self.nearest_off[0],
            nearest_rapid: self.nearest_off[1],
            order_mm,
            path_to_log_mm: followed.from_path_mm,
            tolerance_mm: self.tolerance_mm,
            skipped,
            left_mm: self.path.length_mm() - ends_at_mm,
            ends_at_mm,
            never_visited_mm: self.path.length_mm() - visited_mm,
            log_mm: self.log_mm,
            ends_in_line: line(way.segment),
            over_feed: self.over.clone(),
            far_share: self.far as f64 / self.setpoints.max(1) as f64,
            unit_ratio: self.unit_ratio(),
            hidden_mm,
        }
    }

    /// The ratio of two units, if that is what log and part differ by in size.
    fn unit_ratio(&self) -> Option<f64> {
        let [least, most] = &self.box_mm;
        let ratio = distance(least, most) / self.path.extent_mm;
        [25.4, 1.0 / 25.4, 1000.0, 1e-3].into_iter().find(|unit| (ratio / unit - 1.0).abs() < 0.02)
    }
}
