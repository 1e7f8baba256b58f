//! Whether setpoints keep the limits of single axes, as far as they can be seen.
//!
//! The k-th derivative of a motion is at most M. Then the k-th difference of its places, seen h apart, is at most M hᵏ: it is hᵏ times a
//! mean of that derivative, weighted by a B-spline. If what is seen lies within r of such a motion, the difference may exceed that by
//! 2ᵏ r and no more. So, over windows of w = 1, 2, 4, … periods,
//!
//! `excess = max (|Δ| - 2ᵏ r) / (M (wT)ᵏ)`:
//!
//! above 1, no motion within r of the setpoints keeps the limit. A limit that is exceeded by little for long shows at a wide window, by
//! much for a moment at a narrow one. Where no difference over single periods exceeds the limit, none over a wider window does, for it is
//! a sum of these; so wider windows are looked at around such differences alone.
//!
//! A window lies within one section. Where that begins or ends at rest, the axes stand before and behind it.

use std::collections::VecDeque;

use part_program::{Junction, Machine};

use crate::judge::worst::{StepPlace, Worst};
use crate::problem::problem::Problem;
use crate::run::at_cruise::is_less;
use crate::run::run::AboutRun;

/// The number of windows, which are 1, 2, 4, … periods wide.
const WINDOWS: usize = 9;
/// Periods of the widest one.
const WIDEST: usize = 1 << (WINDOWS - 1);
/// Setpoints that the widest third difference spans.
const SPAN: usize = 3 * WIDEST + 1;

/// Velocity, acceleration and jerk that an axis may take, in mm and periods.
pub(crate) type AxisBounds = [Option<f64>; 3];

/// What the axes of a problem's machine may take.
pub(crate) fn bounds_of<const D: usize>(problem: &Problem<D>) -> [AxisBounds; 3] {
    problem.axes_per_period().map(|axis| [axis.velocity, axis.acceleration, axis.jerk])
}

/// How far a motion may be from its setpoints in windows that hold a corner, beside what is hidden everywhere, in mm: where corners are
/// passed as if rounded, the rounding may be that far away. `None` where the velocity may jump there: then no window with a corner is
/// judged.
pub(crate) fn hidden_at_corners_mm(machine: &Machine) -> Option<f64> {
    match machine.junction {
        Junction::Stop => Some(0.0),
        Junction::DeviationMm(deviation) => Some(deviation),
        Junction::VelocityJump => None,
    }
}

/// How far a motion may be from the setpoints of a run, in mm: half of their last place, and half of the fluctuation that is allowed in a
/// full step; or half of what the drives resolve where a machine states more than is taken otherwise.
pub(crate) fn seen_within_mm<const D: usize>(run: &AboutRun, problem: &Problem<D>) -> f64 {
    let machine = &problem.machine;
    let own = 0.5 * (run.resolution_mm + machine.fluctuation_limit * problem.full_step_mm());
    let stated = machine.position_increment_mm > domains::machine::INCREMENT.default_number().unwrap_or(0.0);
    if stated { own.max(0.5 * machine.position_increment_mm) } else { own }
}

/// A setpoint, and whether the step to it passes a corner of the path and ends at rest.
#[derive(Clone, Copy, Debug)]
pub(crate) struct Setpoint {
    pub(crate) at: StepPlace,
    pub(crate) passes_corner: bool,
    pub(crate) ends_at_rest: bool,
}

/// The largest differences of an axis and an order, as shares of `M (wT)ᵏ`: for each window, over ways without a corner and with one.
type Shares = [[Worst; 2]; WINDOWS];

/// The differences of the setpoints of a run, of which steps are added, or parts are joined. A part holds whole sections.
#[derive(Clone, Debug)]
pub(crate) struct AxisLimits {
    bounds: [AxisBounds; 3],
    /// By axis and order.
    shares: [[Shares; 3]; 3],
    /// Where the axes stand before the section; `None` where that is not known, or they move.
    standing_mm: Option<[f64; 3]>,
    /// The last setpoints of the section, as far as a window reaches.
    section: VecDeque<Setpoint>,
    /// The last setpoint, until it is known that another follows: one that ends a run in motion takes the rest of the path, and does
    /// not count.
    waiting: Option<Setpoint>,
    /// Setpoints still to come whose windows hold a difference that exceeds a limit.
    open: usize,
    /// The setpoints behind the first of a part, as far as windows from before the part reach. They end with the first section.
    head: Vec<Setpoint>,
    is_head: bool,
}

impl AxisLimits {
    /// Of a run under these bounds of the axes that begins at rest at a place, or in motion.
    pub(crate) fn new(bounds: [AxisBounds; 3]) -> Self {
        Self {
            bounds,
            shares: [[[[Worst::default(); 2]; WINDOWS]; 3]; 3],
            standing_mm: None,
            section: VecDeque::new(),
            waiting: None,
            open: 0,
            head: Vec::new(),
            is_head: false,
        }
    }

    /// Whether an axis is limited.
    fn is_limited(&self) -> bool {
        self.bounds.iter().flatten().any(Option::is_some)
    }

    /// Begins a part with its first setpoint. Where its step begins is told when the part is [joined](Self::join) to the parts before.
    pub(crate) fn begin_part(&mut self, first: Setpoint) {
        self.is_head = !first.ends_at_rest;
        if self.is_head {
            self.section.push_back(first);
        }
    }

    /// Whether the next setpoint begins a section, so that the place is wanted at which its step begins.
    pub(crate) fn begins_section(&self) -> bool {
        self.section.is_empty() && self.waiting.is_none() && self.is_limited()
    }

    /// Adds a setpoint behind the first of a part; `standing_mm` is the place at which its step begins, if it
    /// [begins a section](Self::begins_section).
    pub(crate) fn add(&mut self, standing_mm: Option<[f64; 3]>, next: Setpoint) {
        if !self.is_limited() {
            return;
        }
        if self.is_head && self.head.len() < SPAN {
            self.head.push(next);
        }
        self.is_head &= !next.ends_at_rest;
        self.standing_mm = standing_mm.or(self.standing_mm);
        self.pass(next);
    }

    /// Adds the part of the run that follows, whose first setpoint is `first`; its step begins at rest at `standing_mm`, if that is
    /// known.
    pub(crate) fn join(
        &mut self,
        standing_mm: Option<[f64; 3]>,
        first: Setpoint,
        other: Self,
        place: impl Fn(StepPlace) -> StepPlace,
    ) {
        if !self.is_limited() {
            return;
        }
        self.section.clear();
        (self.standing_mm, self.waiting, self.open) = (standing_mm, None, 0);
        let head = other.head.iter().map(|setpoint| Setpoint { at: place(setpoint.at), ..*setpoint });
        core::iter::once(first).chain(head).for_each(|setpoint| self.pass(setpoint));
        self.section.clear();
        self.waiting = None;
        for (own, other) in self.shares.iter_mut().flatten().zip(other.shares.iter().flatten()) {
            for (own, other) in own.iter_mut().flatten().zip(other.iter().flatten()) {
                if let Some(at) = other.at {
                    own.add(other.figure, place(at));
                }
            }
        }
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
        let standing = Setpoint { passes_corner: false, ..last };
        (0..3).for_each(|_| self.look(standing));
        while self.open > 0 {
            self.look(standing);
        }
        self.section.clear();
    }

    /// Looks at the windows that end with a setpoint.
    fn look(&mut self, setpoint: Setpoint) {
        self.section.push_back(setpoint);
        if self.section.len() > SPAN {
            self.section.pop_front();
        }
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
            Some(index) => self.section.get(index).map(|setpoint| setpoint.at.point_mm),
            None => self.standing_mm,
        };
        let [Some(here), before, far, farthest] = [0, 1, 2, 3].map(place) else { return false };
        let at = self.section.back().map(|setpoint| setpoint.at);
        let mut exceeds = false;
        for axis in 0..3 {
            let x = here[axis];
            let [b, c, d] = [before, far, farthest].map(|point| point.map(|point| point[axis]));
            let differences = [
                b.map(|b| x - b),
                b.zip(c).map(|(b, c)| (x - b) - (b - c)),
                b.zip(c).zip(d).map(|((b, c), d)| (x - d) - 3.0 * (b - c)),
            ];
            for (order, difference) in differences.into_iter().enumerate() {
                let (Some(most), Some(difference)) = (self.bounds[axis][order], difference) else { continue };
                let share = difference.abs() / (most * power(width, order));
                exceeds |= is_less(1.0, share);
                let [without, with] = self.shares[axis][order][window];
                if share <= without.figure && share <= with.figure {
                    continue;
                }
                let begin = count.saturating_sub((order + 1) * width);
                let has_corner = self.section.range(begin..).any(|setpoint| setpoint.passes_corner);
                let worst = &mut self.shares[axis][order][window][usize::from(has_corner)];
                at.into_iter().for_each(|at| worst.add(share, at));
            }
        }
        exceeds
    }

    /// What the axes take of their limits, seen within `r_mm`, and within `r_mm + corner_mm` where a window holds a
    /// corner. Such windows are left out where `corner_mm` is `None`.
    pub(crate) fn findings(&self, r_mm: f64, corner_mm: Option<f64>) -> Vec<AxisFinding> {
        let within = [Some(r_mm), corner_mm.map(|corner| r_mm + corner)];
        let limits = (0..3).flat_map(|axis| (0..3).map(move |order| (axis, order)));
        let of = |(axis, order): (usize, usize)| {
            let most = self.bounds[axis][order]?;
            let shares = &self.shares[axis][order];
            let (mut raw, mut excess, mut periods) = (Worst::default(), Worst::default(), 1);
            for (window, both) in shares.iter().enumerate() {
                for (share, within) in both.iter().zip(within) {
                    let (Some(at), Some(within)) = (share.at, within) else { continue };
                    if window == 0 && is_less(raw.figure, share.figure) {
                        raw = *share;
                    }
                    let width = 1_usize << window;
                    let hidden = power(2, order) * within / (most * power(width, order));
                    let found = share.figure - hidden;
                    if is_less(excess.figure, found) {
                        (excess, periods) = (Worst { figure: found, at: Some(at) }, width);
                    }
                }
            }
            let is_kept = raw.figure <= 1.0;
            let (taken, periods) = if is_kept { (raw, 1) } else { (excess, periods) };
            Some(AxisFinding { axis, order, taken, periods, is_hidden: !is_kept && taken.figure <= 1.0 })
        };
        limits.filter_map(of).collect()
    }
}

/// The power of a base by which a difference of an order, from 0, counts.
fn power(base: usize, order: usize) -> f64 {
    let base = base as f64;
    [base, base * base, base * base * base][order]
}

/// What an axis takes of one of its limits.
#[derive(Clone, Copy, Debug)]
pub(crate) struct AxisFinding {
    /// 0 for X.
    pub(crate) axis: usize,
    /// 0 for the velocity, 1 for the acceleration, 2 for the jerk.
    pub(crate) order: usize,
    /// The largest difference over a period, as a share, where that is at most 1; else the largest excess.
    pub(crate) taken: Worst,
    /// Whether the setpoints take more than the limit, and a motion near them does not.
    pub(crate) is_hidden: bool,
    /// The periods of the window in which it shows.
    pub(crate) periods: usize,
}

impl AxisFinding {
    /// The limit's name.
    pub(crate) fn what(&self) -> &'static str {
        const NAMES: [[&str; 3]; 3] = [
            ["velocity of X", "acceleration of X", "jerk of X"],
            ["velocity of Y", "acceleration of Y", "jerk of Y"],
            ["velocity of Z", "acceleration of Z", "jerk of Z"],
        ];
        NAMES[self.axis][self.order]
    }
}

#[cfg(test)]
mod tests {
    use proptest::prelude::*;

    use super::*;

    /// Of X alone, with a period of 1.
    fn of_x(bounds: AxisBounds) -> AxisLimits {
        AxisLimits::new([bounds, [None; 3], [None; 3]])
    }

    fn setpoint(index: u64, x: f64, passes_corner: bool, ends_at_rest: bool) -> Setpoint {
        Setpoint { at: StepPlace { index, curve: 0, point_mm: [x, 0.0, 0.0] }, passes_corner, ends_at_rest }
    }

    /// The run through these places, from rest at 0 and to rest.
    fn judged(bounds: AxisBounds, places: &[f64], corner: Option<usize>) -> AxisLimits {
        judged_with(bounds, places, corner, true)
    }

    /// The same, which ends at rest or in motion.
    fn judged_with(
        bounds: AxisBounds,
        places: &[f64],
        corner: Option<usize>,
        ends_at_rest: bool,
    ) -> AxisLimits {
        let mut all = of_x(bounds);
        let last = places.len() - 1;
        let point = |i: usize| setpoint(i as u64, places[i], corner == Some(i), i == last && ends_at_rest);
        let mut part = of_x(bounds);
        part.begin_part(point(0));
        (1..=last)
            .for_each(|i| part.add(part.begins_section().then_some([places[i - 1], 0.0, 0.0]), point(i)));
        all.join(Some([0.0; 3]), point(0), part, |at| at);
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

    fn jerk_of(found: &AxisLimits, r_mm: f64) -> AxisFinding {
        found.findings(r_mm, Some(0.0)).into_iter().find(|one| one.order == 2).unwrap()
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

    /// 1.15 times a limit for a moment shows at a narrow window, 1.02 times for long at a wide one, each beyond what r hides.
    #[test]
    fn a_limit_that_is_broken_is_seen_through_what_is_hidden() {
        // J = 20,000 mm/s³ at 1 ms is 2e-5.
        for (ratio, periods, r_mm) in
            [(1.15, 20, 1e-6), (1.02, 200, 1e-6), (1.15, 20, 1e-5), (1.02, 200, 1e-5)]
        {
            let places = motion(2e-5 * ratio, periods, 2);
            let rounded: Vec<f64> = places.iter().map(|x| (x / (2.0 * r_mm)).round() * 2.0 * r_mm).collect();
            let found = judged([None, None, Some(2e-5)], &rounded, None);
            let jerk = jerk_of(&found, r_mm);
            assert!(jerk.taken.figure > 1.0, "{ratio} {r_mm}: {jerk:?}");
            assert!(jerk.taken.figure <= ratio + 1e-9, "{jerk:?}");
        }
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
        part.add(None, setpoint(1, 1.0, false, false));
        part.add(None, setpoint(2, 9.0, false, false));
        let mut all = of_x(bounds);
        all.join(None, setpoint(0, 0.5, false, false), part, |at| at);
        assert_eq!(all.findings(0.0, Some(0.0))[0].taken.figure, 0.5);
    }

    #[test]
    fn a_setpoint_that_is_no_number_keeps_no_limit() {
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

        /// A run in parts has the figures of the whole, wherever it rests.
        #[test]
        fn figures_do_not_depend_on_where_a_run_is_cut(
            steps in prop::collection::vec(-1.0..1.0_f64, 2..60), rests in prop::collection::vec(any::<bool>(), 60),
            corner in 0_usize..60, cut in 0_usize..60,
        ) {
            let bounds = [Some(0.5), Some(0.7), Some(0.9)];
            let last = steps.len() - 1;
            let places: Vec<f64> = steps.iter().scan(0.0, |x, step| { *x += step; Some(*x) }).collect();
            let rests_at = |i: usize| i == last || rests[i];
            let point = |i: usize| setpoint(i as u64, places[i], corner == i, rests_at(i));
            let from = |i: usize| [i.checked_sub(1).map_or(0.0, |before| places[before]), 0.0, 0.0];
            let run = |ends: &[usize]| {
                let mut all = of_x(bounds);
                let mut begin = 0;
                for end in ends {
                    let mut part = of_x(bounds);
                    part.begin_part(Setpoint { passes_corner: true, ..point(begin) });
                    (begin + 1..*end).for_each(|i| part.add(part.begins_section().then(|| from(i)), point(i)));
                    all.join(Some(from(begin)), point(begin), part, |at| at);
                    begin = *end;
                }
                let figures = all.findings(0.01, Some(0.1)).into_iter();
                figures.map(|one| (one.taken.figure, one.is_hidden)).collect::<Vec<_>>()
            };
            let cut = (0..last).find(|i| *i >= cut && rests_at(*i)).map(|i| i + 1);
            let ends: Vec<usize> = cut.into_iter().chain([steps.len()]).collect();
            prop_assert_eq!(run(&ends), run(&[steps.len()]));
        }
    }
}
