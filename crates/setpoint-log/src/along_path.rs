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
//! and the chord may fall short by `L/cos(θ/2) - L` if that is more. Positions within ρ of the motion change a sum of
//! chords by 2ρ at its ends, and in between by ρ times what the direction turns and 2ρ²/L for each chord.
//!
//! Short moves may turn to and fro within a chord, which no setpoint shows. Where a part is followed, or the log has the
//! length of each step, the chord may fall short by as much as it does of the path between its ends. Where neither says
//! how the path runs, σ is what the log makes likely and not what it proves. Then a limit is broken for certain only
//! where the axes cannot turn so fast: a velocity that changes by B = |A| T² a period at most, of the accelerations A
//! of all axes, varies within a period by B²/12 in the mean of squares, so that no arc is longer than its chord by more
//! than `√(L² + B²/12) - L`. Where an axis has no such limit, or the path has corners at which its velocity jumps, nothing
//! is certain.
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
    pub(crate) excess: Excess,
    /// The same of chords of which it is known for certain by how much they fall short.
    pub(crate) certain: Excess,
}

/// The largest share of a limit that is taken beyond what is hidden, and the periods of its window.
#[derive(Clone, Copy, Debug)]
pub(crate) struct Excess {
    pub(crate) worst: Worst,
    pub(crate) periods: usize,
}

impl Excess {
    const NONE: Self = Self { worst: Worst { figure: 0.0, at: None }, periods: 1 };

    fn add(&mut self, figure: f64, at: StepPlace, periods: usize) {
        if self.worst.at.is_none() || is_less(self.worst.figure, figure) {
            *self = Self { worst: Worst { figure, at: Some(at) }, periods };
        }
    }
}

/// The chords up to a setpoint.
#[derive(Clone, Copy, Debug, Default)]
struct Sum {
    chords_mm: f64,
    /// By how much they may fall short, by how the points bend, and for certain.
    hidden_mm: f64,
    certain_mm: f64,
    /// Chords of which nothing is certain.
    unknown: u64,
}

impl Sum {
    fn since(self, from: Self) -> Self {
        Self {
            chords_mm: self.chords_mm - from.chords_mm,
            hidden_mm: self.hidden_mm - from.hidden_mm,
            certain_mm: self.certain_mm - from.certain_mm,
            unknown: self.unknown - from.unknown,
        }
    }
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
    /// By how much it is shorter than the path between its ends, in mm, where that is known.
    detour_mm: Option<f64>,
}

/// Acceleration and jerk along the path so far.
pub(crate) struct AlongPath {
    pub(crate) limits: Vec<OfPath>,
    sums: VecDeque<Sum>,
    /// Whether the tool stands before the first of the sums.
    stands_before: bool,
    /// The last setpoint, and the step to it if it is not the first of a section.
    last: Option<(StepPlace, Option<Step>)>,
    /// Setpoints still to come whose windows hold a difference that exceeds a limit.
    open: usize,
    /// By how much each axis can change its step within a period, in mm, where something bounds that.
    turns_mm: [Option<f64>; 3],
    /// Which of them have moved.
    has_moved: [bool; 3],
}

impl AlongPath {
    /// Under limits of acceleration and jerk, in mm and periods. An axis changes its step by no more than `turns_mm` in a
    /// period, where that is known.
    pub(crate) fn new(acceleration: Option<f64>, jerk: Option<f64>, turns_mm: [Option<f64>; 3]) -> Self {
        let limit = |(order, most): (usize, Option<f64>)| {
            Some(OfPath {
                order,
                most: most?,
                raw: Worst::default(),
                excess: Excess::NONE,
                certain: Excess::NONE,
            })
        };
        Self {
            limits: [(1, acceleration), (2, jerk)].into_iter().filter_map(limit).collect(),
            sums: VecDeque::new(),
            stands_before: false,
            last: None,
            open: 0,
            turns_mm,
            has_moved: [false; 3],
        }
    }

    /// Adds a setpoint that is known within `rho_mm`; `stands` says whether the tool stands before it, at the begin of a section. The step to it is
    /// shorter than the path by `detour_mm`, where that is known.
    pub(crate) fn add(&mut self, at: StepPlace, stands: bool, rho_mm: f64, detour_mm: Option<f64>) {
        if self.limits.is_empty() {
            return;
        }
        let Some((before, step_before)) = self.last else {
            self.stands_before = stands;
            self.sums.push_back(Sum::default());
            self.last = Some((at, None));
            return;
        };
        let way_mm: [f64; 3] = std::array::from_fn(|axis| at.point_mm[axis] - before.point_mm[axis]);
        (0..3).for_each(|axis| self.has_moved[axis] |= way_mm[axis] != 0.0);
        let begin = if step_before.is_none() && !self.stands_before {
            Bend::default()
        } else {
            Bend::between(&step_before.unwrap_or_default().way_mm, &way_mm)
        };
        if let Some(step) = step_before {
            self.add_chord(before, step, begin, rho_mm);
        }
        self.last = Some((at, Some(Step { way_mm, begin, detour_mm })));
    }

    /// Ends a section; `stands` says whether the tool stands behind it.
    pub(crate) fn end_section(&mut self, stands: bool, rho_mm: f64) {
        if let Some((at, Some(step))) = self.last.take() {
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
            let rest = Step { detour_mm: Some(0.0), ..Step::default() };
            (0..more).for_each(|_| self.add_chord(at, rest, Bend::default(), rho_mm));
        }
        self.sums.clear();
        (self.last, self.open) = (None, 0);
    }

    /// Adds the chord of a step that is bent so at its end.
    fn add_chord(&mut self, at: StepPlace, step: Step, end: Bend, rho_mm: f64) {
        let Some(last) = self.sums.back().copied() else { return };
        let chord_mm = length(&step.way_mm);
        let bend = ABOVE_MEAN * step.begin.mm.max(end.mm);
        let short_mm = short_mm(chord_mm, [step.begin, end]).max(step.detour_mm.unwrap_or(0.0));
        let turned_mm = if chord_mm > 0.0 { (rho_mm * bend + 2.0 * rho_mm * rho_mm) / chord_mm } else { 0.0 };
        let turned_mm = turned_mm.min(2.0 * rho_mm);
        let certain_mm = match step.detour_mm {
            Some(_) => Some(short_mm),
            None => self.most_short_mm(chord_mm, rho_mm).map(|most| most.max(short_mm)),
        };
        self.sums.push_back(Sum {
            chords_mm: last.chords_mm + chord_mm,
            hidden_mm: last.hidden_mm + short_mm + turned_mm,
            certain_mm: last.certain_mm + certain_mm.unwrap_or(0.0) + turned_mm,
            unknown: last.unknown + u64::from(certain_mm.is_none()),
        });
        if self.sums.len() > SPAN {
            self.sums.pop_front();
        }
        self.open = self.open.saturating_sub(1);
        if self.look_through(0, at, rho_mm) {
            self.open = SPAN;
        }
        if self.open > 0 {
            for window in 1..WINDOWS {
                self.look_through(window, at, rho_mm);
            }
        }
    }

    /// By how much a step is shorter at most than the way of a tool whose axes turn as fast as they can; `None` where an axis that
    /// has moved has no bound.
    fn most_short_mm(&self, chord_mm: f64, rho_mm: f64) -> Option<f64> {
        let is_bounded = |axis: usize| self.turns_mm[axis].is_some() || !self.has_moved[axis];
        let squares: f64 = self.turns_mm.iter().flatten().map(|most| most * most).sum();
        let least_mm = (chord_mm - 2.0 * rho_mm).max(0.0);
        let has_bound = squares > 0.0 && (0..3).all(is_bounded);
        has_bound.then(|| (least_mm * least_mm + squares / 12.0).sqrt() - least_mm)
    }

    /// Looks through the windows of 2ʷ periods that end with a setpoint; whether a difference is above its limit.
    fn look_through(&mut self, window: usize, at: StepPlace, rho_mm: f64) -> bool {
        let width = 1_usize << window;
        let last = self.sums.len() - 1;
        let before = self.sums.front().filter(|_| self.stands_before && self.sums.len() < SPAN).copied();
        let sum = |back: usize| {
            last.checked_sub(back * width).and_then(|index| self.sums.get(index).copied()).or(before)
        };
        let [Some(here), Some(near), Some(far), farther] = [0, 1, 2, 3].map(sum) else { return false };
        let (last, middle) = (here.since(near), near.since(far));
        let of_acceleration = Some(Difference {
            mm: last.chords_mm - middle.chords_mm,
            hidden_mm: 4.0 * rho_mm + last.hidden_mm + middle.hidden_mm,
            certain_mm: 4.0 * rho_mm + last.certain_mm + middle.certain_mm,
            is_known: here.unknown == far.unknown,
        });
        let of_jerk = farther.map(|farther| {
            let first = far.since(farther);
            Difference {
                mm: last.chords_mm - 2.0 * middle.chords_mm + first.chords_mm,
                hidden_mm: 8.0 * rho_mm + last.hidden_mm + 2.0 * middle.hidden_mm + first.hidden_mm,
                certain_mm: 8.0 * rho_mm + last.certain_mm + 2.0 * middle.certain_mm + first.certain_mm,
                is_known: here.unknown == farther.unknown,
            }
        });
        let scale = width as f64;
        let mut exceeds = false;
        for limit in &mut self.limits {
            let found = if limit.order == 1 { of_acceleration } else { of_jerk };
            let Some(found) = found else { continue };
            let most_mm = limit.most * if limit.order == 1 { scale * scale } else { scale * scale * scale };
            let share = found.mm.abs() / most_mm;
            exceeds |= share > 1.0;
            if window == 0 {
                limit.raw.add(share, at);
            }
            limit.excess.add((found.mm.abs() - found.hidden_mm) / most_mm, at, width);
            if found.is_known {
                limit.certain.add((found.mm.abs() - found.certain_mm) / most_mm, at, width);
            }
        }
        exceeds
    }
}

/// A difference of sums of chords, and by how much the true difference may be smaller or larger.
#[derive(Clone, Copy, Debug)]
struct Difference {
    mm: f64,
    /// By how the points bend, and for certain, where that is known.
    hidden_mm: f64,
    certain_mm: f64,
    is_known: bool,
}

/// By how much a chord is shorter than its arc, by how the way bends at both ends.
fn short_mm(chord_mm: f64, [begin, end]: [Bend; 2]) -> f64 {
    let bend_mm = begin.mm.max(end.mm);
    let bend = ABOVE_MEAN * bend_mm;
    let whole = bend / 12.0_f64.sqrt();
    let straight = chord_mm - 0.5 * bend_mm;
    let in_bend_mm = if straight > 0.0 { whole.min(bend * bend / (24.0 * straight)) } else { whole };
    let turn = begin.turn + end.turn;
    let at_corner_mm = chord_mm * ((turn.min(SHARPEST) / 2.0).cos().recip() - 1.0);
    in_bend_mm.max(at_corner_mm)
}

#[cfg(test)]
mod tests {
    use super::*;

    /// Along a circle of a radius, by this arc length at each period, from rest to rest.
    fn judged(radius: f64, arcs: &[f64], rho_mm: f64, [acceleration, jerk]: [f64; 2]) -> Vec<OfPath> {
        let mut along = AlongPath::new(Some(acceleration), Some(jerk), [None; 3]);
        for (index, arc) in (0..).zip(arcs) {
            let (sin, cos) = (arc / radius).sin_cos();
            let point_mm = [radius * sin, radius - radius * cos, 0.0];
            along.add(StepPlace { index, row: index + 1, curve: 0, point_mm }, true, rho_mm, Some(0.0));
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
                assert!(found.excess.worst.figure <= 1.0 + 1e-6, "{radius}: {found:?}");
            }
            for found in judged(radius, &arcs(1.1 * jerk, periods), 1e-12, [jerk * 50.0, jerk]) {
                assert!(found.excess.worst.figure > 1.02, "{radius}: {found:?}");
            }
        }
    }
}
