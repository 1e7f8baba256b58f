//! From a plan in arcs to one in chords: what the setpoints of each stage fall short by.
//!
//! An interpolator that makes each chord as long as the plan's arc gains a little in every bend, since the arc over
//! a chord is longer. After a thousand bends it is ahead of the plan by more than a bend is long, and passes the
//! next one at the feed of the straight. So each stage is shortened by what its own chords fall short.
//!
//! The first guess takes the setpoints where the plan has them. Then the run is followed, chord by chord, and each
//! stage takes back what its end is still ahead.

use alloc::vec::Vec;

use nurbs_core::Evaluate;
use real::Real;

use crate::schedule::shorten;
use crate::{FeedLimit, Schedule};

/// How often the run is followed; what is left falls by a factor of twenty each time.
const REFINEMENTS: usize = 3;
/// Corrections of an arc until its chord is as long as wanted; each leaves an eighth of the squared angle of the
/// chord.
const CORRECTIONS: usize = 8;
/// Halvings of its range where that does not end.
const HALVINGS: usize = 48;

impl<R: Real> FeedLimit<R> {
    /// By how much the setpoints of each stage would fall short if each chord, not each arc, had the planned
    /// length, mm.
    ///
    /// `curves` are those that this limit was made of; where they are missing, nothing falls short. Parameters
    /// are interpolated between limit points, and what one is off does not add up: it is gone in the next
    /// period. At the ends of its stages a run by these chords is within 1e-5 mm of the plan, in f64. A stop on the
    /// way is taken to be landed on, as the end is: nothing that a run is off there goes beyond it.
    ///
    /// See [`ScheduleBuf::shortened`](crate::ScheduleBuf::shortened) for what to do about it.
    #[must_use]
    pub fn shortfalls<const D: usize, C: Evaluate<R, D>>(
        &self,
        curves: &[C],
        schedule: &Schedule<'_, R>,
    ) -> Vec<R> {
        let path = Path { limit: self, curves };
        let mut shortfalls = path.of_arcs(schedule);
        for _ in 0..REFINEMENTS {
            let mut stages = schedule.stages().to_vec();
            shorten(&mut stages, &shortfalls);
            let short = Schedule::new(&stages, schedule.interpolation_period, schedule.periods());
            path.correct(schedule, &short, &mut shortfalls);
        }
        shortfalls
    }
}

/// A path by its arc length.
struct Path<'a, R, C> {
    limit: &'a FeedLimit<R>,
    curves: &'a [C],
}

impl<R: Real, C> Path<'_, R, C> {
    fn point<const D: usize>(&self, distance: R) -> [R; D]
    where
        C: Evaluate<R, D>,
    {
        let (curve, u) = self.limit.parameter_at(distance);
        self.curves.get(curve).map_or([R::zero(); D], |curve| curve.point(u))
    }

    /// What each stage falls short by if its setpoints are where the arcs end.
    fn of_arcs<const D: usize>(&self, schedule: &Schedule<'_, R>) -> Vec<R>
    where
        C: Evaluate<R, D>,
    {
        let mut shortfalls: Vec<R> = schedule.stages().iter().map(|_| R::zero()).collect();
        let last = shortfalls.len().saturating_sub(1);
        let mut cursor = schedule.start();
        let (mut travelled, mut from) = (R::zero(), self.point(R::zero()));
        while let Some(step) = schedule.advance(&mut cursor) {
            travelled = travelled + step;
            let to = self.point(travelled);
            if let Some(sum) = shortfalls.get_mut(cursor.stage().min(last)) {
                *sum = *sum + (step - chord(&from, &to));
            }
            from = to;
        }
        shortfalls
    }

    /// Follows the shortened plan by chords, and adds to each stage what it ends ahead of the arcs, beyond what the
    /// stage before did. Each stop is landed on.
    fn correct<const D: usize>(&self, arcs: &Schedule<'_, R>, short: &Schedule<'_, R>, shortfalls: &mut [R])
    where
        C: Evaluate<R, D>,
    {
        let (mut along, mut by_chord) = (arcs.start(), short.start());
        let (mut planned, mut reached, mut known) = (R::zero(), R::zero(), R::zero());
        let mut begun_in = along.stage();
        while let (Some(arc), Some(wanted)) = (arcs.advance(&mut along), short.advance(&mut by_chord)) {
            planned = planned + arc;
            reached = (reached + self.arc_over(reached, wanted)).min(self.limit.length());
            if along.stage() != begun_in {
                let ahead = reached - planned;
                if let Some(shortfall) = shortfalls.get_mut(begun_in) {
                    *shortfall = *shortfall + (ahead - known);
                }
                let passed = arcs.stages().get(begun_in..along.stage()).unwrap_or_default();
                (known, begun_in) = (ahead, along.stage());
                if passed.iter().any(|stage| stage.end_feed.is_zero()) {
                    (known, reached) = (R::zero(), planned);
                }
            }
        }
    }

    /// The arc from `begin` on whose chord is as long as wanted.
    fn arc_over<const D: usize>(&self, begin: R, wanted: R) -> R
    where
        C: Evaluate<R, D>,
    {
        let from = self.point(begin);
        let missing = |arc: R| wanted - chord(&from, &self.point(begin + arc));
        let rounding = R::resolution() * self.limit.length().max(R::one());
        let mut arc = wanted;
        for _ in 0..CORRECTIONS {
            let rest = missing(arc);
            arc = (arc + rest).max(wanted.half()).min(wanted + wanted);
            if !(rest.abs() > rounding) {
                return arc;
            }
        }
        // Across a corner, back along it: never more than three times the chord.
        let (mut low, mut high) = (wanted.half(), wanted.scale(2));
        for _ in 0..HALVINGS {
            arc = low + (high - low).half();
            if missing(arc) > R::zero() { low = arc } else { high = arc }
        }
        arc
    }
}

fn chord<R: Real, const D: usize>(from: &[R; D], to: &[R; D]) -> R {
    R::norm(&core::array::from_fn::<_, D, _>(|d| to[d] - from[d]))
}
