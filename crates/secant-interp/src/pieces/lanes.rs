//! Many runs at once on one core, one in each lane.
//!
//! A step is a chain of some fifty operations, each of which waits for the one before. In the same time a processor
//! with wide registers takes the steps of eight or sixteen runs, which suits a search over feeds or a simulation of
//! many parts. A [`LaneInterpolator`] keeps the numbers of all runs for a common step side by side, and takes the step
//! for all of them in loops that the compiler turns into vector instructions. The instructions are those of the machine
//! that it runs on, chosen at run time. A loop with words of 64 bits has as many lanes at a time as a register has such
//! words; work without such words has loops of its own, with more lanes at a time.
//!
//! A common step is a step that needs one evaluation and stays on its piece, or passes to a piece of the same polynomial. All lanes
//! have as many coefficients as the loops take: those for cubics, for quintics or for every degree, whatever the highest degree
//! needs. While no lane has weights, the loops leave them out; else all lanes have some, which are 1 where the path has none.
//!
//! A common step has two parts: the departure, up to the place where the step ends, and the arrival, which computes the point
//! there. Between them, lanes get the numbers of another piece or of another stage where they need them. In all other cases a lane
//! steps alone, as [`PieceInterpolator::step`] does. So the setpoints are those of [`PieceInterpolator`] bit for bit: a common step
//! is the same operations in the same order, and counts only if no other case occurs.

use feed_plan::StageShape;
use nurbs_core::{Joint, MAX_DEGREE, divide_by_weight, shift};
use real::Lane;

use crate::pieces::chord_step::{
    Evaluation, correction, is_within, lightening, value_and_slope, weight_and_slope,
};
use crate::pieces::joint::Reached;
use crate::pieces::lane_numbers::{NONE, Numbers, Words, first_of_lane, nowhere, of_lane, put};
use crate::pieces::piece_interpolator::PieceInterpolator;
use crate::pieces::place::{after, onward, place_of};
use crate::pieces::state::{CUBIC, PieceSetpoint, PieceState};
use crate::step_lengths::PERIOD;

/// A bit for each lane.
type Mask = u64;

/// The degree above that of a cubic that has loops of its own; still higher ones take the loops for every degree.
const QUINTIC: usize = 5;

/// How many coefficients the loops take that are for pieces of this degree.
fn coefficients_for(degree: usize) -> usize {
    match degree {
        0..=CUBIC => CUBIC,
        4..=QUINTIC => QUINTIC,
        _ => MAX_DEGREE,
    }
}

/// W interpolators side by side, 64 at most, in a format that has vector registers. W is best four times the lanes of a
/// register, 32 or 64: each loop then has other work while results are awaited. The highest degree that has been in a lane decides how
/// many coefficients all lanes take from then on, so runs of high degree are best kept among themselves.
#[derive(Clone, Debug)]
pub struct LaneInterpolator<'a, R, const D: usize, const W: usize> {
    runs: [PieceInterpolator<'a, R, D>; W],
    states: [PieceState<R, D>; W],
    words: Words<W>,
    numbers: Numbers<R, D, W>,
    /// The lanes in which the places of their runs are; other places are in the states. While it is in the lane, the
    /// state's cursor stands behind the periods that are left.
    loaded: Mask,
    /// The lanes whose runs have weights and are, or have been, in their lanes.
    weighted: Mask,
    /// How many coefficients the loops take: enough for the highest degree that is, or has been, in the lanes.
    coefficients: usize,
    /// The lanes whose runs have ended.
    ended: Mask,
    /// The setpoints of steps that were not common.
    alone: [Option<PieceSetpoint<R, D>>; W],
    arch: pulp::Arch,
}

impl<'a, R: Lane, const D: usize, const W: usize> LaneInterpolator<'a, R, D, W> {
    /// A bit for each lane that there is.
    const ALL: Mask = if W < Mask::BITS as usize { (1 << W) - 1 } else { Mask::MAX };

    /// All runs at their start.
    #[must_use]
    pub fn new(runs: [PieceInterpolator<'a, R, D>; W]) -> Self {
        const { assert!(W <= Mask::BITS as usize, "at most 64 lanes") };
        let states = runs.each_ref().map(PieceInterpolator::start);
        let (words, numbers) = (Words::new(), Numbers::new());
        let arch = pulp::Arch::new();
        let (loaded, weighted, ended, coefficients) = (0, 0, 0, CUBIC);
        Self { runs, states, words, numbers, loaded, weighted, coefficients, ended, alone: [None; W], arch }
    }

    /// Puts another run into a lane, at its start, for example when the lane's own run has ended. A lane that does not
    /// exist is ignored.
    pub fn restart(&mut self, lane: usize, run: PieceInterpolator<'a, R, D>) {
        let Some(place) = self.runs.get_mut(lane) else { return };
        (*place, self.states[lane], self.alone[lane]) = (run, run.start(), None);
        self.words.is_common[lane] = false;
        self.numbers.end[lane] = nowhere();
        self.numbers.leave_weights(lane);
        for lanes in [&mut self.loaded, &mut self.weighted, &mut self.ended] {
            *lanes &= !(1 << lane);
        }
    }

    /// Makes one period of every run. Returns how many runs have a setpoint: 0 once all ends have been commanded.
    ///
    /// Each run's period has the properties of [`PieceInterpolator::step`].
    pub fn step(&mut self) -> usize {
        let mut due = if self.loaded == 0 { Self::ALL } else { self.depart() };
        due &= !self.ended;
        while due > 0 {
            self.attend(due.trailing_zeros() as usize);
            due &= due - 1;
        }
        if self.loaded > 0 {
            self.arrive();
        }
        W - self.ended.count_ones() as usize
    }

    /// The first part of a common step in all lanes; the lanes that need more.
    #[inline]
    fn depart(&mut self) -> Mask {
        match self.coefficients {
            CUBIC => self.depart_on::<CUBIC>(),
            QUINTIC => self.depart_on::<QUINTIC>(),
            _ => self.depart_on::<MAX_DEGREE>(),
        }
    }

    /// [`depart`](Self::depart) by the loops for degree N.
    #[inline]
    fn depart_on<const N: usize>(&mut self) -> Mask {
        let (words, numbers) = (&mut self.words, &mut self.numbers);
        if self.weighted == 0 {
            self.arch.dispatch(Departure::<R, D, W, N, false>(words, numbers))
        } else {
            self.arch.dispatch(Departure::<R, D, W, N, true>(words, numbers))
        }
    }

    /// The second part of a common step in all lanes. The loops may be others than those of the departure: between them a lane may
    /// take up a run of a higher degree, or one with weights.
    #[inline]
    fn arrive(&mut self) {
        match self.coefficients {
            CUBIC => self.arrive_on::<CUBIC>(),
            QUINTIC => self.arrive_on::<QUINTIC>(),
            _ => self.arrive_on::<MAX_DEGREE>(),
        }
    }

    /// [`arrive`](Self::arrive) by the loops for degree N.
    #[inline]
    fn arrive_on<const N: usize>(&mut self) {
        let (words, numbers) = (&self.words, &mut self.numbers);
        if self.weighted == 0 {
            self.arch.dispatch(Arrival::<R, D, W, N, false>(words, numbers));
        } else {
            self.arch.dispatch(Arrival::<R, D, W, N, true>(words, numbers));
        }
    }

    /// The setpoint of a run in the last period. `None` before the first period, behind the run's end, and for a lane
    /// that does not exist.
    #[inline]
    #[must_use]
    pub fn setpoint(&self, lane: usize) -> Option<PieceSetpoint<R, D>> {
        if !*self.words.is_common.get(lane)? {
            return *self.alone.get(lane)?;
        }
        Some(PieceSetpoint {
            piece: self.states[lane].piece,
            phase: self.words.phase[lane],
            offset: of_lane(&self.numbers.offset, lane),
            length: self.numbers.length[lane],
            evaluations: 1,
        })
    }

    #[inline]
    fn is_loaded(&self, lane: usize) -> bool {
        self.loaded >> lane & 1 == 1
    }

    /// Gives a lane the numbers that it needs between departure and arrival.
    #[inline]
    fn attend(&mut self, lane: usize) {
        if !self.words.is_common[lane] && !self.pass_joint(lane) {
            self.step_alone(lane);
        }
        if self.is_loaded(lane) && self.words.left[lane] == 0 {
            self.load_lengths(lane);
        }
    }

    /// Takes a common step on to the next piece; false if it is not a common step there, or the lane has none.
    fn pass_joint(&mut self, lane: usize) -> bool {
        if !self.is_loaded(lane) {
            return false;
        }
        let (run, state, numbers) = (&self.runs[lane], &mut self.states[lane], &mut self.numbers);
        let (step, phase) = (numbers.step[lane], self.words.phase[lane]);
        let Some(row) = run.pieces.pieces.get(state.piece) else { return false };
        if step < R::zero() || onward(row, (phase, numbers.t[lane]), step).is_some() {
            return false;
        }
        let (sigma, part) = (numbers.found[lane], row.part(step));
        let step = Reached { piece: state.piece, phase: part, sigma, evaluations: 1 };
        let mut trend = numbers.trend(lane);
        let Some(reached) = run.pass_joint(phase, &mut trend, row, &step) else { return false };
        state.piece = reached.piece;
        (state.phase, state.t) = place_of(reached.phase);
        numbers.put_trend(lane, &trend);
        numbers.found[lane] = reached.sigma;
        self.words.is_common[lane] = true;
        self.load_piece(lane)
    }

    /// Makes a lane's step alone, because it is not a common one.
    #[cold]
    fn step_alone(&mut self, lane: usize) {
        let is_loaded = self.is_loaded(lane);
        if is_loaded {
            self.unload(lane);
        }
        let (run, state) = (&self.runs[lane], &mut self.states[lane]);
        let Some(row) = run.pieces.pieces.get(state.piece) else {
            let length = run.lengths.advance(&mut state.cursor);
            self.alone[lane] = length.map(|length| PieceSetpoint { length, ..run.hold(state) });
            self.ended |= Mask::from(self.alone[lane].is_none()) << lane;
            return;
        };
        let left = Some(self.words.left[lane]).filter(|left| is_loaded && *left != NONE);
        let planned = match left {
            Some(_) => Some(self.numbers.length[lane]),
            None => run.lengths.advance(&mut state.cursor),
        };
        let is_last = run.lengths.is_over(&state.cursor);
        let wanted = planned.map_or_else(|| run.landing(state, row), |length| run.planned(length, is_last));
        self.alone[lane] = Some(run.follow_aside(state, row, wanted));
        if state.piece >= run.pieces.pieces.len() {
            // The end: the state's cursor takes back the periods that are left.
            state.cursor.time -= left.unwrap_or(0) * PERIOD;
            self.numbers.end[lane] = nowhere();
            return;
        }
        self.words.left[lane] = left.unwrap_or(0);
        self.load(lane);
    }

    /// Moves a run's place from its lane to its state.
    fn unload(&mut self, lane: usize) {
        let state = &mut self.states[lane];
        self.loaded &= !(1 << lane);
        (state.phase, state.t) = (self.words.phase[lane], self.numbers.t[lane]);
        state.trend = self.numbers.trend(lane);
        for (slot, rows) in state.at.chord.iter_mut().zip(&self.numbers.chord).take(self.coefficients) {
            *slot = of_lane(rows, lane);
        }
        for (slot, [row]) in state.at.weight.iter_mut().zip(&self.numbers.weight).take(self.coefficients) {
            *slot = row[lane];
        }
    }

    /// Moves a run's place from its state to its lane, if its steps can be common ones.
    fn load(&mut self, lane: usize) {
        let (run, state, numbers) = (&self.runs[lane], &self.states[lane], &mut self.numbers);
        numbers.put_trend(lane, &state.trend);
        (numbers.residual[lane], numbers.growth[lane]) = (run.tolerance.residual, run.tolerance.growth);
        if self.load_piece(lane) {
            self.loaded |= 1 << lane;
        } else {
            self.numbers.end[lane] = nowhere();
        }
    }

    /// Puts a run's piece and its place there into its lane; false behind the last one.
    fn load_piece(&mut self, lane: usize) -> bool {
        let (run, state, numbers) = (&self.runs[lane], &self.states[lane], &mut self.numbers);
        let Some(row) = run.pieces.pieces.get(state.piece) else { return false };
        self.coefficients = self.coefficients.max(coefficients_for(run.pieces.degree));
        numbers.put_coefficients(lane, &run.pieces, state.piece, self.coefficients);
        self.weighted |= Mask::from(run.pieces.is_rational()) << lane;
        put(&mut numbers.range, lane, row.step_per_chord);
        self.words.phase[lane] = state.phase;
        numbers.t[lane] = state.t;
        // Where another polynomial follows, a guess that may lead past the end is not tried in the common step.
        let end = R::one() - R::one().ldexp(-20);
        numbers.end[lane] = if row.joint == Joint::Continues { R::max_value() } else { end };
        true
    }

    /// Puts the numbers for the distances of the next periods into a lane: for whole periods in a cubic stage or at
    /// constant feed; in other stages for one period, as one at constant feed. Where the schedule ends, the lane goes
    /// on alone.
    fn load_lengths(&mut self, lane: usize) {
        let (run, cursor) = (&self.runs[lane], &mut self.states[lane].cursor);
        let (words, numbers) = (&mut self.words, &mut self.numbers);
        if let Some(stage) = run.lengths.stages.get(cursor.stage)
            && let whole = (stage.duration - cursor.time).saturating_sub(1) / PERIOD
            && whole > 0
            && (stage.shape == StageShape::Cubic || stage.change.is_zero())
        {
            words.left[lane] = whole;
            let fraction = |half_units| in_words(stage.product(half_units) << (64 - stage.shift()));
            let (middle, period) = (fraction(2 * cursor.time + PERIOD), fraction(2 * PERIOD));
            numbers.time[lane] = R::fraction(middle[0]);
            put(&mut words.middle, lane, sum(middle, period));
            put(&mut words.period, lane, period);
            (numbers.share[lane], numbers.feed[lane]) = (stage.period_share, stage.feed);
            numbers.change[lane] = stage.change;
            cursor.time += whole * PERIOD;
            return;
        }
        let mut next = *cursor;
        if let Some((length, false)) = run.lengths.advance_or_end(&mut next) {
            (words.left[lane], *cursor) = (1, next);
            (numbers.feed[lane], numbers.change[lane]) = (length, R::zero());
        } else {
            numbers.end[lane] = nowhere();
        }
    }
}

/// The high and the low word.
#[allow(clippy::cast_possible_truncation, reason = "the low word is asked for")]
fn in_words(product: u128) -> [u64; 2] {
    [(product >> 64) as u64, product as u64]
}

/// The sum of two numbers in words.
#[inline(always)]
fn sum([high, low]: [u64; 2], [more, rest]: [u64; 2]) -> [u64; 2] {
    let sum = low.wrapping_add(rest);
    [high.wrapping_add(more).wrapping_add(u64::from(sum < low)), sum]
}

/// The first part of a common step, up to the place where it ends. It is [`PieceInterpolator::step`] without its
/// branches, compiled for each kind of vector registers. N is the number of coefficients; RATIONAL says that lanes have weights.
struct Departure<'a, R, const D: usize, const W: usize, const N: usize, const RATIONAL: bool>(
    &'a mut Words<W>,
    &'a mut Numbers<R, D, W>,
);

impl<R: Lane, const D: usize, const W: usize, const N: usize, const RATIONAL: bool> pulp::WithSimd
    for Departure<'_, R, D, W, N, RATIONAL>
{
    /// The lanes that need more than the common step.
    type Output = Mask;

    #[inline(always)] // A function that is called is not compiled for these registers.
    fn with_simd<S: pulp::Simd>(self, _: S) -> Mask {
        solve::<_, D, W, N, RATIONAL>(self.1);
        advance(self.0, self.1); // It waits for nothing: there is time for it while steps are solved.
        travel(self.0, self.1)
    }
}

/// The second part of a common step: the point at its end, and the values with which the next step begins.
struct Arrival<'a, R, const D: usize, const W: usize, const N: usize, const RATIONAL: bool>(
    &'a Words<W>,
    &'a mut Numbers<R, D, W>,
);

impl<R: Lane, const D: usize, const W: usize, const N: usize, const RATIONAL: bool> pulp::WithSimd
    for Arrival<'_, R, D, W, N, RATIONAL>
{
    type Output = ();

    #[inline(always)]
    fn with_simd<S: pulp::Simd>(self, _: S) {
        arrive::<_, D, W, N, RATIONAL>(self.0, self.1);
    }
}

/// The place in the stage of the next period. It is the place of [`StepLengths::advance`](crate::StepLengths::advance),
/// with the product of 128 bits carried on from period to period.
#[inline(always)]
fn advance<R: Lane, const D: usize, const W: usize>(words: &mut Words<W>, numbers: &mut Numbers<R, D, W>) {
    for lane in 0..W {
        let middle = of_lane(&words.middle, lane);
        numbers.time[lane] = R::fraction(middle[0]);
        put(&mut words.middle, lane, sum(middle, of_lane(&words.period, lane)));
        words.left[lane] = words.left[lane].wrapping_sub(1);
    }
}

/// The distance of the period, and the step that makes its chord.
#[inline(always)]
fn solve<R: Lane, const D: usize, const W: usize, const N: usize, const RATIONAL: bool>(
    numbers: &mut Numbers<R, D, W>,
) {
    for lane in 0..W {
        let time = numbers.time[lane];
        let mean = StageShape::Cubic.mean(time, numbers.share[lane]);
        let length = numbers.change[lane].mul_add(mean, numbers.feed[lane]);
        numbers.length[lane] = length;

        let range = of_lane(&numbers.range, lane);
        let guess = numbers.newest[lane] - numbers.fall[lane];
        let x = guess * length;
        let chord: [[R; D]; N] = first_of_lane(&numbers.chord, lane);
        let (pull, slope) = value_and_slope(chord.iter(), x, ["chord_per_step", "chord_turn"]);
        let turn = slope.map(|t| t * x);
        let value = if RATIONAL {
            let weight: [[R; 1]; N] = first_of_lane(&numbers.weight, lane);
            let (weight, slope) = weight_and_slope(weight.iter(), x);
            Evaluation::new(guess, &pull, &turn, weight, Some(lightening(weight, slope * x)))
        } else {
            Evaluation::new(guess, &pull, &turn, R::one(), None)
        };
        let sigma = guess - correction(guess, &value, R::from_ratio(3, 4));

        let is_found = (x + numbers.t[lane] < numbers.end[lane])
            & (x <= R::one())
            & is_within(guess, &range)
            & value.is_within(numbers.residual[lane], numbers.growth[lane])
            & is_within(sigma, &range);
        numbers.found[lane] = sigma;
        numbers.step[lane] = if is_found { sigma * length } else { -R::one() };
    }
}

/// The place where the step ends, in the lanes that stay on their piece.
#[inline(always)]
fn travel<R: Lane, const D: usize, const W: usize>(
    words: &mut Words<W>,
    numbers: &mut Numbers<R, D, W>,
) -> Mask {
    let mut due = 0;
    for lane in 0..W {
        let (old, old_t, step) = (words.phase[lane], numbers.t[lane], numbers.step[lane]);
        let (is_common, phase, t) = if R::ADDS_PLACES {
            let t = old_t + step;
            let phase = t.place_to_phase();
            ((step >= R::zero()) & phase.is_some(), phase.unwrap_or_default(), t)
        } else {
            let (part, is_part) = step.part_of_one();
            let phase = old.wrapping_add(part);
            (is_part & after(old, part).is_some(), phase, R::fraction(phase))
        };
        words.is_common[lane] = is_common;
        due |= if is_common & (words.left[lane] > 0) { 0 } else { 1 << lane };
        words.phase[lane] = if is_common { phase } else { old };
        numbers.t[lane] = if is_common { t } else { old_t };
    }
    due
}

/// The point where the step ends, and the values with which the next step begins.
#[inline(always)]
fn arrive<R: Lane, const D: usize, const W: usize, const N: usize, const RATIONAL: bool>(
    words: &Words<W>,
    numbers: &mut Numbers<R, D, W>,
) {
    for lane in 0..W {
        // A lane that stepped alone has its trend from that step.
        let (old, is_common) = (numbers.trend(lane), words.is_common[lane]);
        let new = old.and(numbers.found[lane]);
        numbers.newest[lane] = if is_common { new.newest } else { old.newest };
        numbers.rise[lane] = if is_common { new.rise } else { old.rise };
        numbers.fall[lane] = if is_common { new.fall } else { old.fall };
        let mut shifted: [[R; D]; N] = first_of_lane(&numbers.numerator, lane);
        let t = numbers.t[lane];
        let mut offset = shift(&mut shifted, t);
        if RATIONAL {
            let weights = first_of_lane::<_, N, 1, W>(&numbers.weights, lane).map(|[w]| w);
            let constant = numbers.constant[lane];
            let turns = divide_by_weight::<_, D, N>(constant, &weights, Some(t), &mut offset, &mut shifted);
            for (rows, turn) in numbers.weight.iter_mut().zip(turns) {
                put(rows, lane, turn);
            }
        }
        put(&mut numbers.offset, lane, offset);
        for (rows, chord) in numbers.chord.iter_mut().zip(shifted) {
            put(rows, lane, chord);
        }
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use real::Real;

    use crate::{ChordTolerance, LengthStage, StepLengths};
    use nurbs_core::{NurbsBuf, PieceLimits, PiecesBuf, compile};
    use real::{Backend, DoubleDouble};

    const POINTS: usize = 12;

    /// Bends at a feed that swings, so that setpoints that are right have mostly come from the common step.
    fn share_of_common_steps<R: Lane + Backend>(degree: usize, has_weights: bool) -> f64 {
        // A meander: two points up, two points down.
        let points: Vec<_> = (0..POINTS)
            .map(|i| [40.0 * (i / 2) as f64, if matches!(i % 4, 1 | 2) { 40.0 } else { 0.0 }])
            .collect();
        let spans = POINTS - degree;
        let inner = (1..spans).map(|i| (i as f64 + 0.2 * (i as f64).sin()) / spans as f64);
        let ends = |u: f64| core::iter::repeat_n(u, degree + 1);
        let knots = ends(0.0).chain(inner).chain(ends(1.0)).collect();
        let weight = |i: usize| 1.0 + f64::from(has_weights) * 0.3 * (1.3 * i as f64).sin();
        let curve = NurbsBuf::try_new(degree, points, (0..POINTS).map(weight).collect(), knots).unwrap();
        let limits = PieceLimits { length_mm: 32.0, step_mm: 0.2 };
        let table: PiecesBuf<R, 2> = compile::<DoubleDouble, R, 2>(&[curve.as_curve()], &limits).unwrap();
        let unit = 1.0_f64.ldexp(table.as_pieces().chord_exponent);
        let feed = |mm: f64| R::from_f64(mm * unit).unwrap();
        let stage = |i: i32| {
            let (from, to) = if i % 2 == 0 { (0.1, 0.2) } else { (0.2, 0.1) };
            LengthStage::new(100 << 32, feed(from), feed(to) - feed(from)).unwrap()
        };
        let stages: Vec<_> = (0..40).map(stage).collect();
        let run = PieceInterpolator {
            pieces: table.as_pieces(),
            lengths: StepLengths { stages: &stages, crossings: &[] },
            tolerance: ChordTolerance::for_fluctuation(Some(1e-6), 5),
            landing_step: feed(0.01),
        };
        let mut lanes = LaneInterpolator::new([run; 4]);
        let (mut steps, mut common) = (0, 0);
        // Behind the end runs stand until their schedule is over.
        while lanes.step() > 0 && lanes.setpoint(0).is_some_and(|one| one.piece < table.places().len()) {
            steps += lanes.words.is_common.len();
            common += lanes.words.is_common.iter().filter(|is_common| **is_common).count();
        }
        assert!(steps > 3000, "{steps} steps");
        common as f64 / steps as f64
    }

    #[test]
    fn most_steps_are_common_ones() {
        for (degree, has_weights) in (2..=MAX_DEGREE).flat_map(|degree| [(degree, false), (degree, true)]) {
            let share_in_f32 = share_of_common_steps::<f32>(degree, has_weights);
            for share in [share_of_common_steps::<f64>(degree, has_weights), share_in_f32] {
                assert!((0.98..1.0).contains(&share), "degree {degree}, {has_weights}: {share}");
            }
        }
    }
}
