//! The real-time loop on a curve with one global parameter, as in paper A.

use feed_plan::{Cursor, Schedule};
use nurbs_core::{Derivatives, Differentiate};
use real::Real;

use crate::global_parameter::predictor::History;
use crate::global_parameter::secant::{self, Outcome, Tolerance};
use crate::global_parameter::taylor::{self, Order};

/// Evaluations in the search for a start value where C' almost vanishes. After so many, the fourth root of a ratio as
/// large as 2²⁰ is within a fifth of its limit, where the chord grows as the square or cube of the increment.
const TRIALS: u32 = 8;

/// How the next parameter is found.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum Method {
    /// The secant iteration on the chord, from the start values (7) and (6).
    Secant,
    /// `u + L/|C'|`: a baseline.
    Taylor1,
    /// The second-order expansion: a baseline.
    Taylor2,
}

/// One setpoint, of one period.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Setpoint<R, const D: usize> {
    /// The parameter u_{i+1}.
    pub u: R,
    /// The point C(u_{i+1}), which goes to the axes.
    pub point: [R; D],
    /// The chord that was wanted, L_i.
    pub length: R,
    /// Evaluations of the curve in this period.
    pub evaluations: u32,
    /// How the solver ended.
    pub outcome: Outcome,
}

/// Curve, schedule and tolerances: all values that stay the same during a run.
#[derive(Clone, Copy, Debug)]
pub struct Interpolator<'a, R, C> {
    /// The curve to follow.
    pub curve: C,
    /// The distances to travel, one for each period.
    pub schedule: Schedule<'a, R>,
    /// How the next parameter is found.
    pub method: Method,
    /// When the solver stops.
    pub tolerance: Tolerance<R>,
    /// The longest step from which the axes can come to rest within one period, A·T². If the remaining length exceeds
    /// the planned step by at most this, one step goes to the end of the curve.
    pub landing_step: R,
}

/// The values that change from period to period: small, `Copy`, and the only ones that an interrupt routine writes.
#[derive(Clone, Copy, Debug)]
pub struct State<R, const D: usize> {
    cursor: Cursor<R>,
    history: History<R>,
    point: [R; D],
    last_length: R,
    landed: bool,
    finished: bool,
}

impl<R: Real, const D: usize> State<R, D> {
    /// Whether the run is over: at the end of the curve and of the schedule, or where the schedule gave a distance that
    /// is infinite or NaN.
    #[must_use]
    pub fn is_finished(&self) -> bool {
        self.finished
    }

    /// Whether the end of the curve has been commanded; its schedule may go on.
    #[must_use]
    pub fn is_landed(&self) -> bool {
        self.landed
    }

    /// The cursor of the schedule.
    #[must_use]
    pub fn cursor(&self) -> &Cursor<R> {
        &self.cursor
    }
}

impl<R: Real, C> Interpolator<'_, R, C> {
    /// The state at the start of the curve.
    pub fn start<const D: usize>(&self) -> State<R, D>
    where
        C: Differentiate<R, D>,
    {
        let (first, _) = self.curve.domain();
        State {
            cursor: self.schedule.start(),
            history: History::new(first),
            point: self.curve.point(first),
            last_length: R::zero(),
            landed: false,
            finished: false,
        }
    }

    /// The next setpoint. `None` once the end of the curve has been commanded and the schedule is over. Also `None`
    /// where the schedule or a landing step holds a number that is infinite or NaN: the run then ends where it stands.
    ///
    /// The parameter never decreases and never passes the end. The run ends by landing: a step that would reach or pass
    /// the end commands exactly the end. A run that arrives early stands there until its schedule is over. In a coarse
    /// format the schedule may be over before the curve is. The remaining length is then travelled in steps of
    /// `landing_step`, or of the parameter's resolution where that is longer, so that every run ends. In a period of no
    /// length the setpoint is that of the period before.
    ///
    /// A step takes no heap, and has no loop without a bound. It evaluates the curve at most `max_iterations + 4`
    /// times: for two start values, for each iteration, and once each for the expansion in the first steps and for the
    /// landing. If the run begins with C' = 0, the first steps take up to eight evaluations more.
    pub fn step<const D: usize>(&self, state: &mut State<R, D>) -> Option<Setpoint<R, D>>
    where
        C: Differentiate<R, D>,
    {
        if state.finished {
            return None;
        }
        let planned = self.schedule.advance(&mut state.cursor);
        let is_last = planned.is_some() && self.schedule.is_over(&state.cursor);
        let length = planned.unwrap_or(self.landing_step).signal("step_length");
        let reach = if is_last { length + self.landing_step } else { length };
        if !reach.is_finite() {
            state.finished = true;
            return None;
        }
        let u = state.history.newest();
        if state.landed || (planned.is_some() && !is_last && length <= R::zero()) {
            state.finished = is_last;
            let (point, outcome) = (state.point, Outcome::Converged);
            return Some(Setpoint { u, point, length, evaluations: 0, outcome });
        }

        let landing = if is_last { self.landing(state, reach) } else { None };
        let mut found = landing.unwrap_or_else(|| self.next_parameter(state, reach));
        if planned.is_none() && found.u <= u {
            // The landing step is below the parameter's resolution here.
            found.u = u + R::resolution().max(u.abs() * R::resolution().ldexp(1));
            found.point = self.curve.point(found.u);
            found.evaluations += 1;
        }
        let (_, end) = self.curve.domain();
        if found.u >= end {
            found.u = end;
            found.point = self.curve.point(end);
            found.evaluations += 1;
            state.landed = true;
            state.finished = is_last || planned.is_none();
        }
        if !found.u.is_finite() {
            state.finished = true;
            return None;
        }
        state.history.push(found.u);
        state.last_length = reach;
        state.point = found.point;
        Some(Setpoint { length, ..found })
    }

    /// The step to the end, if the end is within reach. No root needs to be found, and behind an end with C' = 0 there
    /// may be none.
    fn landing<const D: usize>(&self, state: &State<R, D>, reach: R) -> Option<Setpoint<R, D>>
    where
        C: Differentiate<R, D>,
    {
        let (_, u) = self.curve.domain();
        let point = self.curve.point(u);
        let rest = R::norm::<D>(&core::array::from_fn(|d| point[d] - state.point[d]));
        let setpoint = Setpoint { u, point, length: reach, evaluations: 1, outcome: Outcome::Converged };
        (rest <= reach).then_some(setpoint)
    }

    fn next_parameter<const D: usize>(&self, state: &State<R, D>, length: R) -> Setpoint<R, D>
    where
        C: Differentiate<R, D>,
    {
        let u = state.history.newest();
        let (begin, end) = self.curve.domain();
        // Trials may pass the end, where the last span is extrapolated, by no more than a 64th of the curve.
        let ceiling = end + (end - begin).ldexp(-6);
        let order = match self.method {
            Method::Secant => return self.next_by_secant(state, length, ceiling),
            Method::Taylor1 => Order::First,
            Method::Taylor2 => Order::Second,
        };
        let step = taylor::increment(&self.curve.derivatives(u), length, order);
        let next = u + step.min(ceiling - u);
        Setpoint {
            u: next,
            point: self.curve.point(next),
            length,
            evaluations: 2,
            outcome: Outcome::Converged,
        }
    }

    fn next_by_secant<const D: usize>(&self, state: &State<R, D>, length: R, ceiling: R) -> Setpoint<R, D>
    where
        C: Differentiate<R, D>,
    {
        let u = state.history.newest();
        let ((older, newer), evaluations) = self.start_values(state, length, ceiling);
        let chord_residual = |trial: R| {
            let point = self.curve.point(trial);
            let chord: [R; D] = core::array::from_fn(|d| point[d] - state.point[d]);
            (R::norm(&chord) - length, point)
        };
        let root = secant::solve((u, ceiling), (older, newer), length, &self.tolerance, chord_residual);
        Setpoint {
            u: root.u,
            point: root.point,
            length,
            evaluations: root.evaluations + evaluations,
            outcome: root.outcome,
        }
    }

    /// The two start values, and the evaluations that they took.
    ///
    /// The first steps have no history and start from the two Taylor expansions. Later steps extrapolate. An
    /// extrapolation that does not point forwards, as (6) does in the last steps before a rest, is replaced by the last
    /// increment in proportion to the step lengths.
    fn start_values<const D: usize>(&self, state: &State<R, D>, length: R, ceiling: R) -> ((R, R), u32)
    where
        C: Differentiate<R, D>,
    {
        let history = &state.history;
        let u = history.newest();
        let ahead = |increment: R| u + increment.max(R::resolution()).min(ceiling - u);
        if !history.is_full() {
            let at = self.curve.derivatives(u);
            if !is_expandable(&at, length) {
                let (older, newer) = self.search(state, length, ceiling);
                return ((ahead(older), ahead(newer)), TRIALS + 1);
            }
            let first = taylor::increment(&at, length, Order::First);
            let second = taylor::increment(&at, length, Order::Second);
            return ((ahead(first), ahead(second)), 1);
        }
        // After a landing step of length zero there is no proportion.
        let share = if state.last_length > R::zero() { length / state.last_length } else { R::one() };
        let in_proportion = history.last_difference() * share;
        let forwards = |value: R| if value > u { value - u } else { in_proportion };
        ((ahead(forwards(history.adams())), ahead(forwards(history.taylor()))), 0)
    }

    /// Start values where C' almost vanishes, as at a cusp or where control points coincide. There a chord c grows as
    /// the n-th power of the increment h, n > 1 unknown. The iteration
    ///
    /// `h ← h (L/c)^¼`
    ///
    /// multiplies the error of log h by |1 - n/4|, which is below 1 for n up to 7. The last two increments are
    /// returned.
    fn search<const D: usize>(&self, state: &State<R, D>, length: R, ceiling: R) -> (R, R)
    where
        C: Differentiate<R, D>,
    {
        let u = state.history.newest();
        let most = ceiling - u;
        let (mut older, mut newer) = (most, most);
        for _ in 0..TRIALS {
            let point = self.curve.point(u + newer);
            let chord = R::norm::<D>(&core::array::from_fn(|d| point[d] - state.point[d]));
            older = newer;
            newer = if chord <= length.ldexp(-4) {
                newer.ldexp(1) // No quotient is greater.
            } else {
                newer * (length / chord).sqrt().sqrt()
            };
            newer = newer.min(most);
        }
        (older, newer)
    }
}

/// Whether the speed of the parameter changes little over a step of this length: |C''| L ≤ |C'|². It is computed
/// without squares and quotients, which may not fit the format.
fn is_expandable<R: Real, const D: usize>(at: &Derivatives<R, D>, length: R) -> bool {
    R::norm(&at.first) > (R::norm(&at.second) * length).sqrt()
}
