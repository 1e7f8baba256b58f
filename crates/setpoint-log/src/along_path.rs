//! Acceleration and jerk along the path, from setpoints alone.
//!
//! The speed along a path is the derivative of its arc length, and a chord is shorter than its arc. Let Lᵢ be the chord of period i, bᵢ the
//! length of the second difference of the points around it, and κ ≈ b/L² the curvature there: the arc is longer by κ² L³/24 = b²/(24 L).
//! Where L is not much longer than b the tool turns within the period: no arc of a motion whose acceleration is b per period² is longer
//! than its chord by more than b/√12. So each chord may fall short by
//!
//! `σ = min(c² b²/(24 (L - b/2)), c b/√12)`
//!
//! where c = 1.5 covers that b is a mean over two periods. The path may have a corner in a chord as well: if the
//! direction turns by θ from the chord before it to the one behind it, two legs are as long as `L/cos(θ/2)` at most,
//! and the chord may fall short by `L/cos(θ/2) - L` if that is more. Short moves may turn to and fro within a chord,
//! which no setpoint shows: where a part is followed, the chord may fall short by as much as it does of the path
//! between its ends. Positions within ρ of the motion change a sum of chords by 2ρ at its ends, and in between by ρ
//! times what the direction turns and 2ρ²/L for each chord.
//!
//! With S the sum of w chords and H the sum of what each may hide, the excess over a window is
//! `(|S₂ - S₁| - 4ρ - H₁ - H₂) / (A w²)` and `(|S₃ - 2 S₂ + S₁| - 8ρ - H₁ - 2 H₂ - H₃) / (J w³)`, as in [`limit_judge`].

use std::collections::VecDeque;

use limit_judge::{SPAN, StepPlace, WINDOWS, Worst, is_less};

use crate::period::length;

/// By how much the second difference at a place may be above its mean over two periods.
const ABOVE_MEAN: f64 = 1.5;
/// The most by which a corner is taken to turn, in radians: beyond, legs are longer than a log lets anybody say.
const SHARPEST: f64 = 3.0;

/// What is taken of one of both limits.
#[derive(Clone, Copy, Debug)]
pub(crate) struct OfPath {
    /// 1 for the acceleration, 2 for the jerk.
    pub(crate) order: usize,
    /// The limit, in mm and periods.
    pub(crate) most: f64,
    /// The largest share over single periods, as the chords are.
    pub(crate) raw: Worst,
    /// The largest that every motion takes, and the periods of its window.
    pub(crate) excess: Worst,
    pub(crate) periods: usize,
}

/// The chords up to a setpoint.
#[derive(Clone, Copy, Debug)]
struct Sum {
    at: StepPlace,
    chords_mm: f64,
    hidden_mm: f64,
}

/// How the way is bent at a setpoint.
#[derive(Clone, Copy, Debug, Default)]
struct Bend {
    /// The length of the second difference, in mm.
    mm: f64,
    /// The angle by which the direction turns.
    turn: f64,
}

impl Bend {
    /// From one step to the next; a tool that stands turns by nothing.
    fn between(before: &[f64; 3], step: &[f64; 3]) -> Self {
        let turned = std::array::from_fn(|axis| step[axis] - before[axis]);
        let lengths = length(before) * length(step);
        let dot: f64 = before.iter().zip(step).map(|(a, b)| a * b).sum();
        let turn = if lengths > 0.0 { (dot / lengths).clamp(-1.0, 1.0).acos() } else { 0.0 };
        Self { mm: length(&turned), turn }
    }
}

/// A step of the log.
#[derive(Clone, Copy, Debug, Default)]
struct Step {
    way_mm: [f64; 3],
    /// How it is bent at its begin.
    begin: Bend,
    /// By how much it is shorter than the path between its ends, in mm, as far as that is known.
    detour_mm: f64,
}

/// Acceleration and jerk along the path so far.
pub(crate) struct AlongPath {
    pub(crate) limits: Vec<OfPath>,
    sums: VecDeque<Sum>,
    /// Whether the tool stands before the first of the sums.
    stands_before: bool,
    /// The last setpoint, and the step to it.
    last: Option<(StepPlace, Step)>,
    /// Setpoints still to come whose windows hold a difference that exceeds a limit.
    open: usize,
}

impl AlongPath {
    /// Under limits of acceleration and jerk, in mm and periods.
    pub(crate) fn new(acceleration: Option<f64>, jerk: Option<f64>) -> Self {
        let limit = |(order, most): (usize, Option<f64>)| {
            let (raw, excess) = (Worst::default(), Worst::default());
            Some(OfPath { order, most: most?, raw, excess, periods: 1 })
        };
        Self {
            limits: [(1, acceleration), (2, jerk)].into_iter().filter_map(limit).collect(),
            sums: VecDeque::new(),
            stands_before: false,
            last: None,
            open: 0,
        }
    }

    /// Adds a setpoint that is known within `rho_mm`; `stands` says whether the tool stands before it, at the begin of a section. The step to it is
    /// shorter than the path by `detour_mm`, as far as the path is known.
    pub(crate) fn add(&mut self, at: StepPlace, stands: bool, rho_mm: f64, detour_mm: f64) {
        if self.limits.is_empty() {
            return;
        }
        let Some((before, step_before)) = self.last else {
            self.stands_before = stands;
            self.sums.push_back(Sum { at, chords_mm: 0.0, hidden_mm: 0.0 });
            self.last = Some((at, Step::default()));
            return;
        };
        let way_mm: [f64; 3] = std::array::from_fn(|axis| at.point_mm[axis] - before.point_mm[axis]);
        let is_first = self.sums.len() == 1 && self.sums[0].at == before;
        let next_bend = if is_first && !self.stands_before {
            Bend::default()
        } else {
            Bend::between(&step_before.way_mm, &way_mm)
        };
        if !is_first {
            self.add_chord(before, step_before, next_bend, rho_mm);
        }
        self.last = Some((at, Step { way_mm, begin: next_bend, detour_mm }));
    }

    /// Ends a section; `stands` says whether the tool stands behind it.
    pub(crate) fn end_section(&mut self, stands: bool, rho_mm: f64) {
        if let Some((at, step)) = self.last.take()
            && self.sums.back().is_some_and(|sum| sum.at != at)
        {
            let behind = Bend { mm: if stands { length(&step.way_mm) } else { 0.0 }, turn: 0.0 };
            self.add_chord(at, step, behind, rho_mm);
            // Behind a rest the windows see what came before.
            let more = if stands && self.open > 0 {
                SPAN
            } else if stands {
                3
            } else {
                0
            };
            (0..more).for_each(|_| self.add_chord(at, Step::default(), Bend::default(), rho_mm));
        }
        self.sums.clear();
        (self.last, self.open) = (None, 0);
    }

    /// Adds the chord of a step that is bent so at its end.
    fn add_chord(&mut self, at: StepPlace, step: Step, end: Bend, rho_mm: f64) {
        let Some(last) = self.sums.back().copied() else { return };
        let (begin, chord_mm) = (step.begin, length(&step.way_mm));
        let bend_mm = begin.mm.max(end.mm);
        let bend = ABOVE_MEAN * bend_mm;
        let whole = bend / 12.0_f64.sqrt();
        let straight = chord_mm - 0.5 * bend_mm;
        let in_bend_mm = if straight > 0.0 { whole.min(bend * bend / (24.0 * straight)) } else { whole };
        let turn = begin.turn + end.turn;
        let at_corner_mm = chord_mm * ((turn.min(SHARPEST) / 2.0).cos().recip() - 1.0);
        let short_mm = in_bend_mm.max(at_corner_mm).max(step.detour_mm);
        let turned_mm = if chord_mm > 0.0 { (rho_mm * bend + 2.0 * rho_mm * rho_mm) / chord_mm } else { 0.0 };
        self.sums.push_back(Sum {
            at,
            chords_mm: last.chords_mm + chord_mm,
            hidden_mm: last.hidden_mm + short_mm + turned_mm.min(2.0 * rho_mm),
        });
        if self.sums.len() > SPAN {
            self.sums.pop_front();
        }
        self.open = self.open.saturating_sub(1);
        if self.look_through(0, rho_mm) {
            self.open = SPAN;
        }
        if self.open > 0 {
            for window in 1..WINDOWS {
                self.look_through(window, rho_mm);
            }
        }
    }

    /// Looks through the windows of 2ʷ periods that end with the last setpoint; whether a difference is above its limit.
    fn look_through(&mut self, window: usize, rho_mm: f64) -> bool {
        let width = 1_usize << window;
        let last = self.sums.len() - 1;
        let before = self.sums.front().filter(|_| self.stands_before && self.sums.len() < SPAN).copied();
        let sum = |back: usize| {
            last.checked_sub(back * width).and_then(|index| self.sums.get(index).copied()).or(before)
        };
        let [Some(here), Some(near), Some(far), farther] = [0, 1, 2, 3].map(sum) else { return false };
        let between = |to: Sum, from: Sum| [to.chords_mm - from.chords_mm, to.hidden_mm - from.hidden_mm];
        let [last_mm, last_hidden] = between(here, near);
        let [middle_mm, middle_hidden] = between(near, far);
        let of_jerk = farther.map(|farther| {
            let [first_mm, first_hidden] = between(far, farther);
            (
                last_mm - 2.0 * middle_mm + first_mm,
                8.0 * rho_mm + last_hidden + 2.0 * middle_hidden + first_hidden,
            )
        });
        let of_acceleration = Some((last_mm - middle_mm, 4.0 * rho_mm + last_hidden + middle_hidden));
        let scale = width as f64;
        let mut exceeds = false;
        for limit in &mut self.limits {
            let found = if limit.order == 1 { of_acceleration } else { of_jerk };
            let Some((difference_mm, hidden_mm)) = found else { continue };
            let most_mm = limit.most * if limit.order == 1 { scale * scale } else { scale * scale * scale };
            let share = difference_mm.abs() / most_mm;
            exceeds |= share > 1.0;
            if window == 0 {
                limit.raw.add(share, here.at);
            }
            let excess = (difference_mm.abs() - hidden_mm) / most_mm;
            if limit.excess.at.is_none() || is_less(limit.excess.figure, excess) {
                limit.excess = Worst { figure: excess, at: Some(here.at) };
                limit.periods = width;
            }
        }
        exceeds
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    /// Along a circle of a radius, by this arc length at each period, from rest to rest.
    fn judged(radius: f64, arcs: &[f64], rho_mm: f64, [acceleration, jerk]: [f64; 2]) -> Vec<OfPath> {
        let mut along = AlongPath::new(Some(acceleration), Some(jerk));
        for (index, arc) in (0..).zip(arcs) {
            let (sin, cos) = (arc / radius).sin_cos();
            let point_mm = [radius * sin, radius - radius * cos, 0.0];
            along.add(StepPlace { index, row: index + 1, curve: 0, point_mm }, true, rho_mm, 0.0);
        }
        along.end_section(true, rho_mm);
        along.limits
    }

    /// Full jerk up, down, down, up, so many periods each.
    fn arcs(jerk: f64, periods: usize) -> Vec<f64> {
        let (mut s, mut v, mut a) = (0.0_f64, 0.0_f64, 0.0_f64);
        let mut arcs = vec![0.0; 2];
        for sign in [1.0, -1.0, -1.0, 1.0] {
            for _ in 0..periods {
                let j = sign * jerk;
                s += v + a / 2.0 + j / 6.0;
                v += a + j / 2.0;
                a += j;
                arcs.push(s);
            }
        }
        arcs.extend([s; 2]);
        arcs
    }

    /// Bends from nearly straight to one that turns by a tenth of a radian each period, at limits that are just kept, and at ones that are
    /// exceeded by a tenth.
    #[test]
    fn limits_along_a_bend_are_judged_by_its_arc() {
        let (jerk, periods) = (2e-5, 50);
        for radius in [1e6, 100.0, 10.0, 1.0] {
            for found in judged(radius, &arcs(jerk, periods), 1e-12, [jerk * 50.0, jerk]) {
                assert!(found.excess.figure <= 1.0 + 1e-6, "{radius}: {found:?}");
            }
            for found in judged(radius, &arcs(1.1 * jerk, periods), 1e-12, [jerk * 50.0, jerk]) {
                assert!(found.excess.figure > 1.02, "{radius}: {found:?}");
            }
        }
    }
}
