//! Whether setpoints keep the limits that a machine states, as far as they can be seen.
//!
//! The k-th derivative of a motion is at most M. Then the k-th difference of its places, seen h apart, is at most M hᵏ: it is hᵏ times a
//! mean of that derivative, weighted by a B-spline. If what is seen lies within r of such a motion, the difference may exceed that by
//! 2ᵏ r and no more. So, over windows of w = 1, 2, 4, … periods,
//!
//! `excess = max (|Δ| - 2ᵏ r) / (M (wT)ᵏ)`,
//!
//! with r and the deviation together where a window holds a corner that may be rounded. Above 1, no motion within r of the setpoints keeps
//! the limit. A limit that is exceeded by little for long shows at a wide window, by much for a moment at a narrow one. Where no
//! difference over single periods exceeds the limit, none over a wider window does, for it is a sum of these; so wider windows are looked
//! at around such differences alone.
//!
//! The places are those of each axis; along the path, the arc length at each setpoint; and for the total acceleration, the differences of
//! all axes make a vector. The feed is that of the chords, as an interpolator makes steps of a commanded feed, or that of the straight way
//! over a window, which no path is shorter than; where its limit changes within a window, the largest counts.
//!
//! What exceeds a limit by `|Δ| - M (wT)ᵏ` shows as broken wherever r is less than 2⁻ᵏ times that: this is the resolution that would decide.
//!
//! A window lies within one section. Where a section begins at rest, the tool stands before it, and where it ends at rest, behind it.

use std::collections::VecDeque;

use crate::stated_limit::{Of, StatedLimit};
use crate::worst::{StepPlace, Worst, is_less};

/// The number of windows, which are 1, 2, 4, … periods wide.
pub const WINDOWS: usize = 9;
/// Periods of the widest one.
const WIDEST: usize = 1 << (WINDOWS - 1);
/// Setpoints that the widest third difference spans.
pub const SPAN: usize = 3 * WIDEST + 1;

/// A way along the path, in mm.
#[derive(Clone, Copy, Debug, Default)]
pub struct Way {
    /// Its arc length.
    pub arc_mm: f64,
    /// The sum of its chords.
    pub chords_mm: f64,
}

impl Way {
    fn plus(self, step: Self) -> Self {
        Self { arc_mm: self.arc_mm + step.arc_mm, chords_mm: self.chords_mm + step.chords_mm }
    }
}

/// The places at a setpoint whose differences are judged: those of the axes, the arc length, and the sum of the chords.
type Places = [f64; 5];

fn places([x, y, z]: [f64; 3], way: Way) -> Places {
    [x, y, z, way.arc_mm, way.chords_mm]
}

/// What windows look at of a setpoint.
#[derive(Clone, Copy, Debug)]
struct Seen {
    places: Places,
    /// For each window the longest step that is commanded in the periods of it that end here, in mm.
    feed_mm: [f64; WINDOWS],
}

/// A setpoint, and what the step to it may do.
#[derive(Clone, Copy, Debug)]
pub struct Setpoint {
    /// Where it is.
    pub at: StepPlace,
    /// The way from the begin of the section, or of the part if that came later, in mm.
    pub way: Way,
    /// The longest step that the blocks passed in it command, in mm.
    pub feed_mm: f64,
    /// Whether the step passes a corner of the path, or begins at one.
    pub passes_corner: bool,
    /// That corner, once it is known.
    pub corner: Option<Corner>,
    /// Whether the axes stand there.
    pub ends_at_rest: bool,
}

/// A corner that a step passes or begins at.
#[derive(Clone, Copy, Debug)]
pub struct Corner {
    /// By how much each component of the unit tangent changes.
    pub turn: [f64; 3],
    /// The arc length of the step, in mm.
    pub step_mm: f64,
}

/// A difference, and the largest that its limit allows.
#[derive(Clone, Copy, Debug, Default)]
struct Taken {
    /// By how much the limit is exceeded, in mm; below 0 by how much it is not used.
    over: Worst,
    found_mm: f64,
    most_mm: f64,
}

impl Taken {
    /// The share of the limit that is taken by every motion within `hidden_mm`, and the place.
    fn share(&self, hidden_mm: f64) -> Worst {
        Worst { figure: (self.found_mm - hidden_mm) / self.most_mm, at: self.over.at }
    }
}

/// The differences that exceed their limit most: for each window, over ways without a corner and with one.
type OfLimit = [[Taken; 2]; WINDOWS];

/// What is taken of a limit.
#[derive(Clone, Debug)]
struct Judged {
    limit: StatedLimit,
    /// The largest difference that it allows over each window, in mm; of the feed, the share of what is commanded in a window.
    most_mm: [f64; WINDOWS],
    /// The largest shares over single periods, without a corner and with one.
    raw: [Worst; 2],
    windows: OfLimit,
}

impl Judged {
    /// Keeps a difference over 2ʷ periods.
    fn add(&mut self, window: usize, has_corner: bool, taken: Taken) {
        let corner = usize::from(has_corner);
        if let Some(at) = taken.over.at.filter(|_| window == 0) {
            self.raw[corner].add(taken.share(0.0).figure, at);
        }
        keep_worse(&mut self.windows[window][corner], taken);
    }
}

/// The differences of the setpoints of a run, of which steps are added, or parts are joined. A part holds whole sections.
#[derive(Clone, Debug)]
pub struct Differences {
    limits: Vec<Judged>,
    /// Where the axes stand before the section, and the way there; `None` where that is not known, or they move.
    standing: Option<Places>,
    /// The last setpoints of the section, as far as a window reaches.
    section: VecDeque<Setpoint>,
    /// What windows look at of them.
    seen: VecDeque<Seen>,
    /// How many of them pass a corner.
    corners: usize,
    /// The last setpoint, until it is known that another follows: one that ends a run in motion takes the rest of the path, and does
    /// not count.
    waiting: Option<Setpoint>,
    /// Setpoints still to come whose windows hold a difference that exceeds a limit.
    open: usize,
    /// The setpoints behind the first of a part, as far as windows from before the part reach. They end with the first section.
    head: Vec<Setpoint>,
    is_head: bool,
}

impl Differences {
    /// Of a run under these limits that begins at rest at a place, or in motion.
    #[must_use]
    pub fn new(limits: &[StatedLimit]) -> Self {
        Self {
            limits: limits
                .iter()
                .map(|limit| Judged {
                    limit: *limit,
                    most_mm: std::array::from_fn(|window| limit.most * power(1 << window, limit.order)),
                    raw: Default::default(),
                    windows: OfLimit::default(),
                })
                .collect(),
            standing: None,
            section: VecDeque::new(),
            seen: VecDeque::new(),
            corners: 0,
            waiting: None,
            open: 0,
            head: Vec::new(),
            is_head: false,
        }
    }

    /// Looks at a corner that a step passes or begins at. The velocity jumps there by at least what it would at the mean speed of the
    /// step, less what the path's acceleration changes in half a period.
    fn look_at_corner(&mut self, Corner { turn, step_mm }: Corner, place: StepPlace) {
        let is_acceleration = |one: &&Judged| one.limit.of == Of::Path && one.limit.order == 1;
        let most = self.limits.iter().find(is_acceleration).map_or(0.0, |one| one.limit.most);
        let found_mm = (step_mm - 0.5 * most).max(0.0);
        for judged in &mut self.limits {
            let Of::Jump(axis) = judged.limit.of else { continue };
            let most_mm = judged.limit.most / turn[axis];
            let over = Worst { figure: found_mm - most_mm, at: Some(place) };
            judged.add(0, true, Taken { over, found_mm, most_mm });
        }
    }

    /// Begins a part with its first setpoint. Where its step begins is told when the part is [joined](Self::join) to the parts before.
    pub fn begin_part(&mut self, first: Setpoint) {
        self.is_head = !first.ends_at_rest;
        if self.is_head {
            self.keep(first);
        }
    }

    /// Keeps a setpoint for as long as windows reach back to it.
    fn keep(&mut self, setpoint: Setpoint) {
        let mut feed_mm = [setpoint.feed_mm.max(0.0); WINDOWS];
        for window in 1..WINDOWS {
            // The longest of both halves of a window; nothing is before the begin of a section.
            let half = 1_usize << (window - 1);
            let before = self.seen.len().checked_sub(half).and_then(|index| self.seen.get(index));
            let own = feed_mm[window - 1];
            feed_mm[window] = before.map_or(own, |before| own.max(before.feed_mm[window - 1]));
        }
        self.seen.push_back(Seen { places: places(setpoint.at.point_mm, setpoint.way), feed_mm });
        self.section.push_back(setpoint);
        self.corners += usize::from(setpoint.passes_corner);
        if self.section.len() > SPAN {
            let gone = self.section.pop_front();
            self.corners -= usize::from(gone.is_some_and(|gone| gone.passes_corner));
            self.seen.pop_front();
        }
    }

    fn forget(&mut self) {
        self.section.clear();
        self.seen.clear();
        self.corners = 0;
    }

    /// Whether the next setpoint begins a section, so that the place is wanted at which its step begins.
    #[must_use]
    pub fn begins_section(&self) -> bool {
        self.section.is_empty() && self.waiting.is_none()
    }

    /// The way to the last setpoint from the begin of its section or part.
    fn way(&self) -> Way {
        self.waiting.or(self.section.back().copied()).map_or_else(Way::default, |last| last.way)
    }

    /// Adds a setpoint behind the first of a part, one step further; `standing_mm` is the place at which its step begins, if it
    /// [begins a section](Self::begins_section).
    pub fn add(&mut self, standing_mm: Option<[f64; 3]>, step: Way, next: Setpoint) {
        let next = Setpoint { way: self.way().plus(step), ..next };
        if self.is_head && self.head.len() < SPAN {
            self.head.push(next);
        }
        self.is_head &= !next.ends_at_rest;
        self.standing = standing_mm.map(|at| places(at, Way::default())).or(self.standing);
        self.pass(next);
    }

    /// Adds the part of the run that follows. Its first setpoint is one step behind the place at which the axes stand, `None` if that is not
    /// known.
    pub fn join(
        &mut self,
        standing_mm: Option<[f64; 3]>,
        step: Way,
        first: Setpoint,
        other: Self,
        place: impl Fn(StepPlace) -> StepPlace,
    ) {
        self.forget();
        (self.waiting, self.open) = (None, 0);
        let before = Way { arc_mm: -step.arc_mm, chords_mm: -step.chords_mm };
        self.standing = standing_mm.map(|at| places(at, before));
        let head = other.head.iter().map(|setpoint| Setpoint { at: place(setpoint.at), ..*setpoint });
        core::iter::once(first).chain(head).for_each(|setpoint| self.pass(setpoint));
        self.forget();
        self.waiting = None;
        for (own, other) in self.limits.iter_mut().zip(&other.limits) {
            for (own, other) in own.raw.iter_mut().zip(other.raw) {
                if let Some(at) = other.at {
                    own.add(other.figure, place(at));
                }
            }
            for (own, other) in own.windows.iter_mut().flatten().zip(other.windows.iter().flatten()) {
                if let Some(at) = other.over.at {
                    let at = Some(place(at));
                    keep_worse(own, Taken { over: Worst { at, ..other.over }, ..*other });
                }
            }
        }
    }

    /// Ends a section in motion, with the last setpoint: what follows was not seen, and another section begins behind it.
    pub fn break_off(&mut self) {
        if let Some(last) = self.waiting.take() {
            self.look(last);
        }
        self.forget();
        (self.standing, self.open) = (None, 0);
    }

    /// Looks at a setpoint as soon as another follows or it ends at rest.
    fn pass(&mut self, next: Setpoint) {
        if let Some(waited) = self.waiting.replace(next) {
            self.look(waited);
        }
        if next.ends_at_rest {
            self.waiting = None;
            self.look(next);
            self.come_to_rest(next);
        }
    }

    /// The axes stand behind a section, for as long as a window sees what came before.
    fn come_to_rest(&mut self, last: Setpoint) {
        let standing = Setpoint { passes_corner: false, corner: None, ..last };
        (0..3).for_each(|_| self.look(standing));
        // Of a way that is no number all differences count as too large, at rest too.
        for _ in 0..SPAN {
            if self.open == 0 {
                break;
            }
            self.look(standing);
        }
        self.forget();
    }

    /// Looks at the windows that end with a setpoint, and at the corner that its step passes.
    fn look(&mut self, setpoint: Setpoint) {
        if let Some(corner) = setpoint.corner {
            self.look_at_corner(corner, setpoint.at);
        }
        self.keep(setpoint);
        self.open = self.open.saturating_sub(1);
        if self.look_through(0) {
            self.open = SPAN;
        }
        if self.open > 0 {
            for window in 1..WINDOWS {
                self.look_through(window);
            }
        }
    }

    /// Looks through the windows of 2ʷ periods that end with the last setpoint; whether a difference is above its limit.
    fn look_through(&mut self, window: usize) -> bool {
        let width = 1_usize << window;
        let count = self.section.len();
        let place = |back: usize| match (count - 1).checked_sub(back * width) {
            Some(index) => self.seen.get(index).map(|seen| seen.places),
            None => self.standing,
        };
        let [Some(here), before, far, farthest] = [0, 1, 2, 3].map(place) else { return false };
        let at = self.section.back().map(|setpoint| setpoint.at);
        let differences = differences(&here, [before, far, farthest]);
        let mut exceeds = false;
        for judged in &mut self.limits {
            let limit = judged.limit;
            let found = match limit.of {
                Of::Axis(axis) => differences[limit.order].map(|places| places[axis].abs()),
                Of::Path => {
                    differences[limit.order].map(|places| places[if limit.order == 0 { 4 } else { 3 }].abs())
                }
                Of::Vector => differences[limit.order].map(|[x, y, z, ..]| x.hypot(y).hypot(z)),
                Of::Jump(_) => None,
            };
            let Some(found_mm) = found else { continue };
            let begin = count.saturating_sub((limit.order + 1) * width);
            let passed = || self.section.range(begin..);
            let most_mm = match (limit.of, limit.order) {
                (Of::Path | Of::Vector, 0) => {
                    let feed = self.seen.back().map_or(0.0, |seen| seen.feed_mm[window]);
                    limit.most * feed * width as f64
                }
                _ => judged.most_mm[window],
            };
            let over = found_mm - most_mm;
            exceeds |= is_less(0.0, over);
            let taken = Taken { over: Worst { figure: over, at }, found_mm, most_mm };
            let is_more = |raw: &Worst| raw.at.is_none() || is_less(raw.figure, found_mm / most_mm);
            if judged.windows[window].iter().any(|worst| is_worse(worst, over))
                || window == 0 && judged.raw.iter().any(is_more)
            {
                let has_corner = self.corners > 0 && passed().any(|setpoint| setpoint.passes_corner);
                judged.add(window, has_corner, taken);
            }
        }
        exceeds
    }

    /// What is taken of the limits, seen within `r_mm`, and across the path within `r_mm + corner_mm` where a window holds a corner.
    /// Such windows are left out where `corner_mm` is `None`.
    #[must_use]
    pub fn findings(&self, r_mm: f64, corner_mm: Option<f64>) -> Vec<LimitFinding> {
        let across = [Some(r_mm), corner_mm.map(|corner| r_mm + corner)];
        let along = [Some(r_mm); 2];
        let of = |judged: &Judged| {
            let limit = judged.limit;
            // The commanded feed holds at corners too, however they are rounded.
            let is_along =
                matches!(limit.of, Of::Path | Of::Jump(_)) || limit.order == 0 && limit.of == Of::Vector;
            let within = if is_along { along } else { across };
            let counted = judged.raw.iter().zip(within).filter(|(_, within)| within.is_some());
            let raw = counted.map(|(raw, _)| *raw).fold(Worst::default(), greater);
            let (mut excess, mut periods, mut seen_within_mm) = (Worst::default(), 1, r_mm);
            let mut decided_below_mm = 0.0_f64;
            for (window, both) in judged.windows.iter().enumerate() {
                for (taken, within) in both.iter().zip(within) {
                    let (Some(_), Some(within)) = (taken.over.at, within) else { continue };
                    let seen = taken.share(power(2, limit.order) * within);
                    decided_below_mm = decided_below_mm.max(taken.over.figure / power(2, limit.order));
                    if is_less(excess.figure, seen.figure) {
                        (excess, periods, seen_within_mm) = (seen, 1_usize << window, within);
                    }
                }
            }
            let is_kept = raw.figure <= 1.0;
            let (taken, periods) = if is_kept { (raw, 1) } else { (excess, periods) };
            let is_hidden = !is_kept && taken.figure <= 1.0;
            let seen_within_mm = is_hidden.then_some(seen_within_mm);
            LimitFinding { limit, raw, taken, periods, seen_within_mm, decided_below_mm }
        };
        self.limits.iter().map(of).collect()
    }
}

/// The first, second and third differences of places that lie behind `here`, in order.
fn differences(here: &Places, behind: [Option<Places>; 3]) -> [Option<Places>; 3] {
    let [b, c, d] = behind;
    fn of(difference: impl Fn(usize) -> f64) -> Places {
        std::array::from_fn(difference)
    }
    [
        b.map(|b| of(|i| here[i] - b[i])),
        b.zip(c).map(|(b, c)| of(|i| (here[i] - b[i]) - (b[i] - c[i]))),
        b.zip(c).zip(d).map(|((b, c), d)| of(|i| (here[i] - d[i]) - 3.0 * (b[i] - c[i]))),
    ]
}

/// The one with the greater figure, of equal ones the first.
fn greater(one: Worst, other: Worst) -> Worst {
    if is_less(one.figure, other.figure) || one.at.is_none() { other } else { one }
}

fn is_worse(worst: &Taken, over: f64) -> bool {
    worst.over.at.is_none() || is_less(worst.over.figure, over)
}

/// Keeps the difference that exceeds its limit more, of equal ones the first.
fn keep_worse(worst: &mut Taken, other: Taken) {
    if is_worse(worst, other.over.figure) {
        *worst = other;
    }
}

/// The power of a base by which a difference of an order, from 0, counts.
fn power(base: usize, order: usize) -> f64 {
    let base = base as f64;
    [base, base * base, base * base * base][order]
}

/// What is taken of a limit.
#[derive(Clone, Copy, Debug)]
pub struct LimitFinding {
    /// The limit.
    pub limit: StatedLimit,
    /// The largest difference over a period, as a share.
    pub raw: Worst,
    /// The largest difference over a period, as a share, where that is at most 1; else the largest excess.
    pub taken: Worst,
    /// How far a motion may be from setpoints that take more than the limit, where it keeps that, in mm.
    pub seen_within_mm: Option<f64>,
    /// The periods of the window in which it shows.
    pub periods: usize,
    /// Seen within less than this, in mm, some difference shows that the limit is broken; 0 if none exceeds it.
    pub decided_below_mm: f64,
}

#[cfg(test)]
mod tests {
    use proptest::prelude::*;

    use super::*;

    /// Of X alone, with a period of 1.
    fn of_x(bounds: [Option<f64>; 3]) -> Differences {
        let limits = (0..).zip(bounds);
        let limits =
            limits.filter_map(|(order, most)| Some(StatedLimit { of: Of::Axis(0), order, most: most? }));
        Differences::new(&limits.collect::<Vec<_>>())
    }

    /// A straight way.
    fn of_length(length: f64) -> Way {
        Way { arc_mm: length, chords_mm: length }
    }

    fn setpoint(index: u64, x: f64, passes_corner: bool, ends_at_rest: bool) -> Setpoint {
        let at = StepPlace { index, row: 0, curve: 0, point_mm: [x, 0.0, 0.0] };
        Setpoint {
            at,
            way: Way::default(),
            feed_mm: f64::INFINITY,
            passes_corner,
            corner: None,
            ends_at_rest,
        }
    }

    /// The run through these places, from rest at 0 and to rest.
    fn judged(bounds: [Option<f64>; 3], places: &[f64], corner: Option<usize>) -> Differences {
        judged_with(bounds, places, corner, true)
    }

    /// The same, which ends at rest or in motion.
    fn judged_with(
        bounds: [Option<f64>; 3],
        places: &[f64],
        corner: Option<usize>,
        ends_at_rest: bool,
    ) -> Differences {
        let mut all = of_x(bounds);
        let last = places.len() - 1;
        let point = |i: usize| setpoint(i as u64, places[i], corner == Some(i), i == last && ends_at_rest);
        let mut part = of_x(bounds);
        part.begin_part(point(0));
        (1..=last).for_each(|i| {
            part.add(part.begins_section().then_some([places[i - 1], 0.0, 0.0]), Way::default(), point(i))
        });
        all.join(Some([0.0; 3]), Way::default(), point(0), part, |at| at);
        all
    }

    /// Places of a motion of bounded jerk: full jerk up, down, down, up, so many periods each, then back the same way, again and again.
    fn motion(jerk: f64, periods: usize, times: usize) -> Vec<f64> {
        let (mut x, mut v, mut a) = (0.0_f64, 0.0_f64, 0.0_f64);
        let mut places = Vec::new();
        for turn in 0..times {
            let way = if turn % 2 == 0 { 1.0 } else { -1.0 };
            for sign in [1.0, -1.0, -1.0, 1.0] {
                let j = way * sign * jerk;
                for _ in 0..periods {
                    x += v + a / 2.0 + j / 6.0;
                    v += a + j / 2.0;
                    a += j;
                    places.push(x);
                }
            }
        }
        places
    }

    fn jerk_of(found: &Differences, r_mm: f64) -> LimitFinding {
        found.findings(r_mm, Some(0.0)).into_iter().find(|one| one.limit.order == 2).unwrap()
    }

    #[test]
    fn limits_that_are_just_kept_are_kept() {
        let (jerk, periods) = (1e-3, 40);
        let a = jerk * 40.0;
        // v = j n² at the end of the second quarter.
        let bounds = [Some(jerk * 1600.0), Some(a), Some(jerk)];
        for found in judged(bounds, &motion(jerk, periods, 3), None).findings(0.0, Some(0.0)) {
            let taken = found.taken.figure;
            assert!(taken <= 1.0 + 1e-9 && taken > 0.9, "{found:?}");
        }
        // A step from rest and to rest takes what it takes, seen from where the axis stands.
        let step = judged([Some(1.0), Some(1.0), Some(1.0)], &[2.0], None).findings(0.0, Some(0.0));
        let figures: Vec<_> = step.iter().map(|one| (one.taken.figure, one.periods)).collect();
        assert_eq!(figures, [(2.0, 1), (2.0, 1), (4.0, 1)]);
    }

    /// 1.15 times a limit for 20 ms shows at a narrow window, 1.02 times for 200 ms at a wide one, each beyond what r hides.
    #[test]
    fn a_limit_that_is_broken_is_seen_through_what_is_hidden() {
        // J = 20,000 mm/s³ at 1 ms is 2e-5.
        for (ratio, periods) in [(1.15, 20), (1.02, 200)] {
            let places = motion(2e-5 * ratio, periods, 2);
            for r_mm in [0.0, 1e-9, 1e-7, 1e-6, 3e-6, 1e-5] {
                let grid = 2.0 * r_mm;
                let seen = |x: &f64| if r_mm > 0.0 { (x / grid).round() * grid } else { *x };
                let rounded: Vec<f64> = places.iter().map(seen).collect();
                let found = judged([None, None, Some(2e-5)], &rounded, None);
                let jerk = jerk_of(&found, r_mm);
                assert!(jerk.taken.figure > 1.0, "{ratio} {r_mm}: {jerk:?}");
                assert!(jerk.taken.figure <= ratio + 1e-6, "{jerk:?}");
            }
        }
    }

    /// Random numbers of Marsaglia's xorshift.
    struct Noise(u64);

    impl Noise {
        fn next(&mut self) -> u64 {
            self.0 ^= self.0 << 13;
            self.0 ^= self.0 >> 7;
            self.0 ^= self.0 << 17;
            self.0
        }

        fn share(&mut self) -> f64 {
            (self.next() >> 11) as f64 / (1_u64 << 53) as f64
        }
    }

    /// Motions from rest to rest at J 20,000 mm/s³ and up to the limits of velocity and acceleration, in periods of 1 ms, seen within
    /// r with the worst noise: it is as large as it may be, and turns as the signs of a difference do at one of the windows.
    fn expect_no_alarm(periods: u64, seed: u64) {
        let (jerk, longest, r_mm) = (2e-5, 200_u64, 1e-6);
        let (n, mut noise) = (longest as f64, Noise(seed));
        let mut all = of_x([Some(jerk * n * n), Some(jerk * n), Some(jerk)]);
        let (mut index, mut x) = (0_u64, 0.0_f64);
        all.begin_part(setpoint(0, 0.0, false, true));
        while index < periods {
            let stage = 1 + noise.next() % longest;
            let way = if noise.next() % 2 == 0 { jerk } else { -jerk };
            let (turn, shift) = (1 << (noise.next() % WINDOWS as u64), noise.next() % 512);
            let (begin, mut v, mut a) = (x, 0.0, 0.0);
            for tick in 0..4 * stage {
                let j = if (tick / stage) % 3 == 0 { way } else { -way };
                x += v + a / 2.0 + j / 6.0;
                v += a + j / 2.0;
                a += j;
                let is_above = match index % 3 {
                    0 => noise.share() < 0.5,
                    _ => ((index + shift) / turn) % 2 == 0,
                };
                let is_last = tick + 1 == 4 * stage;
                // At rest it is seen where it stands: the tool is there for any time.
                let off = if is_last { 0.0 } else { r_mm * if is_above { 1.0 } else { -1.0 } };
                index += 1;
                let standing = all.begins_section().then_some([begin, 0.0, 0.0]);
                all.add(standing, Way::default(), setpoint(index, x + off, false, is_last));
            }
        }
        for found in all.findings(r_mm * (1.0 + 1e-6), Some(0.0)) {
            assert!(found.taken.figure <= 1.0 + 1e-6, "{found:?}");
        }
    }

    #[test]
    fn a_motion_that_keeps_its_limits_raises_no_alarm() {
        expect_no_alarm(300_000, 0x9e37_79b9_7f4a_7c15);
    }

    #[test]
    #[ignore = "nightly: a hundred million periods"]
    fn a_hundred_million_periods_raise_no_alarm() {
        for seed in 1..=10 {
            expect_no_alarm(10_000_000, seed);
        }
    }

    /// The feed along a path whose blocks command 0.1 and then 0.2 mm a period: a step over the joint may be as long as the faster block
    /// allows, and one behind it that is too long for its block is seen.
    #[test]
    fn the_feed_is_that_of_the_blocks_passed() {
        let limit = StatedLimit { of: Of::Path, order: 0, most: 1.0 };
        let judged = |steps: &[(f64, f64)]| {
            let mut all = Differences::new(&[limit]);
            all.begin_part(setpoint(0, 0.0, false, true));
            for (index, (step, feed_mm)) in (1..).zip(steps) {
                let next = Setpoint { feed_mm: *feed_mm, ..setpoint(index, 0.0, false, false) };
                all.add(None, of_length(*step), next);
            }
            // The last step of a run that ends in motion does not count.
            all.add(None, Way::default(), setpoint(100, 0.0, false, false));
            let found = all.findings(1e-9, None).remove(0);
            (found.limit.what(), (1e6 * found.taken.figure).round() / 1e6, found.taken.at.map(|at| at.index))
        };
        assert_eq!(judged(&[(0.1, 0.1), (0.2, 0.2), (0.1, 0.1)]).1, 1.0);
        assert_eq!(judged(&[(0.1, 0.1), (0.2, 0.2), (0.11, 0.1)]), ("feed", 1.1, Some(3)));
    }

    /// On a circle at a constant feed the acceleration is v²/R, whatever each axis takes; a corner hides more.
    #[test]
    fn the_total_acceleration_is_that_of_the_vector() {
        let (radius, step) = (10.0_f64, 0.1);
        let expected = step * step / radius;
        let limit = StatedLimit { of: Of::Vector, order: 1, most: 0.5 * expected };
        for (corner, hidden) in [(false, 0.0), (true, 1.0)] {
            let mut all = Differences::new(&[limit]);
            all.begin_part(setpoint(0, 0.0, false, true));
            for index in 1..=50_u32 {
                let (sin, cos) = (f64::from(index) * step / radius).sin_cos();
                let point_mm = [radius * cos, radius * sin, 0.0];
                let at = StepPlace { index: index.into(), row: 0, curve: 0, point_mm };
                let next = Setpoint { at, passes_corner: corner, ..setpoint(0, 0.0, false, false) };
                all.add(None, of_length(step), next);
            }
            let found = all.findings(0.0, Some(hidden)).remove(0);
            let share = found.taken.figure;
            assert_eq!(found.limit.what(), "total acceleration");
            assert!(if corner { share == 0.0 } else { (share - 2.0).abs() < 1e-3 }, "{share}");
        }
    }

    /// Behind a break nothing is judged over it; what ends in motion is judged to its last setpoint.
    #[test]
    fn a_section_that_breaks_off_is_judged_to_its_end() {
        let mut all = of_x([Some(1.0), Some(0.5), None]);
        let add = |all: &mut Differences, index: u64, x: f64| {
            all.add(None, Way::default(), setpoint(index, x, false, false));
        };
        [0.0, 0.2, 0.4].into_iter().zip(0..).for_each(|(x, index)| add(&mut all, index, x));
        all.break_off();
        [9.0, 9.2, 10.1].into_iter().zip(3..).for_each(|(x, index)| add(&mut all, index, x));
        all.break_off();
        let found = all.findings(0.0, Some(0.0));
        let near = |one: &LimitFinding, figure: f64| (one.taken.figure - figure).abs() < 1e-12;
        assert!(near(&found[0], 0.9) && near(&found[1], 1.4), "{found:?}");
        // Within r it may keep 0.7 - 4 r <= 0.5.
        let hidden = &all.findings(0.06, Some(0.0))[1];
        assert!(
            hidden.seen_within_mm.is_some() && (hidden.decided_below_mm - 0.05).abs() < 1e-12,
            "{hidden:?}"
        );
    }

    #[test]
    fn a_corner_hides_more_and_a_jump_of_velocity_all() {
        let places: Vec<f64> = (1..=600).map(|i| f64::from((i - 300_i32).max(0)) * 0.01).collect();
        let found = judged_with([None, Some(1e-3), None], &places, Some(300), false);
        let of = |corner: Option<f64>| found.findings(0.0, corner)[0].taken.figure;
        assert!(of(Some(0.0)) > 5.0 && of(Some(1e-3)) < of(Some(0.0)));
        // The jump of 0.01 a period at a lone corner: Δv² / (16 ρ A).
        for rho in [1e-3, 2e-3, 5e-3] {
            let expected = 0.01_f64.powi(2) / (16.0 * rho * 1e-3);
            assert!((of(Some(rho)) / expected - 1.0).abs() < 0.12, "{rho}: {} {expected}", of(Some(rho)));
        }
        assert!(of(None) < 1e-9, "nothing else happens: {}", of(None));
    }

    #[test]
    fn the_last_step_of_a_run_that_ends_in_motion_does_not_count() {
        let bounds = [Some(1.0), None, None];
        let mut part = of_x(bounds);
        part.begin_part(setpoint(0, 0.5, false, false));
        part.add(None, of_length(0.5), setpoint(1, 1.0, false, false));
        part.add(None, of_length(8.0), setpoint(2, 9.0, false, false));
        let mut all = of_x(bounds);
        all.join(None, of_length(0.5), setpoint(0, 0.5, false, false), part, |at| at);
        assert_eq!(all.findings(0.0, Some(0.0))[0].taken.figure, 0.5);
    }

    #[test]
    fn a_setpoint_that_is_no_number_keeps_no_limit() {
        for last in [&[0.1, f64::NAN][..], &[f64::INFINITY, f64::INFINITY][..]] {
            let found = judged([Some(1.0); 3], last, None).findings(1.0, Some(0.0));
            let is_broken = |figure: f64| figure.is_nan() || figure > 1.0;
            assert!(found.iter().all(|one| is_broken(one.taken.figure)), "{found:?}");
        }
        let found = judged([Some(1.0); 3], &[0.1, f64::NAN, 0.2, 0.3], None).findings(1.0, Some(0.0));
        assert!(found.iter().all(|one| one.taken.figure.is_nan()), "{found:?}");
    }

    proptest! {
        #![proptest_config(ProptestConfig::with_cases(48))]
        /// A motion that keeps its limits, seen within r of it, breaks none of them at any window.
        #[test]
        fn no_alarm_within_what_is_hidden(
            jerk in 1e-5..1e-2_f64, periods in 1_usize..300, r_mm in 1e-7..1e-2_f64, seed in any::<u64>(),
        ) {
            let n = periods as f64;
            let bounds = [Some(jerk * n * n), Some(jerk * n), Some(jerk)];
            let mut state = seed | 1;
            let mut noise = || {
                state ^= state << 13;
                state ^= state >> 7;
                state ^= state << 17;
                // The worst noise is at its bounds.
                if state % 2 == 0 { r_mm } else { -r_mm }
            };
            let places: Vec<f64> = motion(jerk, periods, 3).iter().map(|x| x + noise()).collect();
            for found in judged(bounds, &places, None).findings(r_mm * (1.0 + 1e-9), Some(0.0)) {
                prop_assert!(found.taken.figure <= 1.0 + 1e-6, "{found:?}");
            }
        }

        /// A run in parts has the figures of the whole, wherever it rests: those of an axis and those along the path.
        #[test]
        fn figures_do_not_depend_on_where_a_run_is_cut(
            steps in prop::collection::vec(-1.0..1.0_f64, 2..60), rests in prop::collection::vec(any::<bool>(), 60),
            corner in 0_usize..60, cut in 0_usize..60,
        ) {
            let of_x = [0.5, 0.7, 0.9].map(|most| (Of::Axis(0), most));
            let of_path = [0.8, 0.7, 0.9].map(|most| (Of::Path, most));
            let limit = |(index, (of, most)): (usize, _)| StatedLimit { of, order: index % 3, most };
            let limits: Vec<_> = of_x.into_iter().chain(of_path).enumerate().map(limit).collect();
            let last = steps.len() - 1;
            let places: Vec<f64> = steps.iter().scan(0.0, |x, step| { *x += step; Some(*x) }).collect();
            let rests_at = |i: usize| i == last || rests[i];
            let point = |i: usize| {
                let feed_mm = if i % 7 < 3 { 0.6 } else { 1.0 };
                Setpoint { feed_mm, ..setpoint(i as u64, places[i], corner == i, rests_at(i)) }
            };
            let from = |i: usize| [i.checked_sub(1).map_or(0.0, |before| places[before]), 0.0, 0.0];
            let run = |ends: &[usize]| {
                let mut all = Differences::new(&limits);
                let mut begin = 0;
                for end in ends {
                    let mut part = Differences::new(&limits);
                    part.begin_part(Setpoint { passes_corner: true, ..point(begin) });
                    for (i, step) in steps.iter().enumerate().take(*end).skip(begin + 1) {
                        let standing = part.begins_section().then(|| from(i));
                        part.add(standing, of_length(step.abs()), point(i));
                    }
                    all.join(Some(from(begin)), of_length(steps[begin].abs()), point(begin), part, |at| at);
                    begin = *end;
                }
                let figures = all.findings(0.01, Some(0.1)).into_iter();
                figures.map(|one| (one.taken.figure, one.seen_within_mm.is_some())).collect::<Vec<_>>()
            };
            let cut = (0..last).find(|i| *i >= cut && rests_at(*i)).map(|i| i + 1);
            let ends: Vec<usize> = cut.into_iter().chain([steps.len()]).collect();
            for (cut, whole) in run(&ends).into_iter().zip(run(&[steps.len()])) {
                prop_assert!((cut.0 - whole.0).abs() < 1e-12 && cut.1 == whole.1, "{cut:?} {whole:?}");
            }
        }
    }
}
