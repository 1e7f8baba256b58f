//! A faster plan by an interior point, under limits of single axes or without.
//!
//! A plan under a [`FeedLimit`] shares out what the axes can do before it is made: so much for turning the path, so much for changing
//! the feed. Here each way from rest to rest is one program, in which every axis has all of its limits, wherever it moves. Without limits of
//! axes it is the program of the path's own limits, in which accelerations at near minima of the limit depend on each other:
//!
//! 1. *Geometry*: tangent, curvature and its change, axis by axis, with both values at knots and joints.
//! 2. *Grid*: nodes even in planned time where something changes, first of a rough profile, then of a solution on a third of the cells.
//! 3. *Program*: the least time, by an interior point.
//! 4. *Arcs*: the longest of constant jerk that follow the solution.
//! 5. *Check* at ten places a period at least, or 1/128 of A/J if that is longer, where something changes. Where it finds more than is
//!    allowed, that cell's limits are lowered and the program is solved again, three times at most; the rest is stretched in time evenly.
//! 6. *Whole periods*, as for every plan.
//!
//! A way for which any of that fails keeps the plan that it had, and so does one that would not be faster. One that a bound says no motion
//! passes in a thousandth less time is not tried, and the program is given up where its gap says so.

use alloc::vec::Vec;

use nurbs_core::Differentiate;
use real::Real;

use crate::axes::arcs;
use crate::axes::check::{duration, strains, stretch};
use crate::axes::geometry::Geometry;
use crate::axes::grid::Grid;
use crate::axes::profile::Profile;
use crate::axes::program::Stop;
use crate::axes::rows::{WayCell, all_of, places, program};
use crate::axes::spline::{Spline, near};
use crate::axes::way::{Strain, Way};
use crate::parallel::in_parallel;
use crate::plan::least_duration::BoundedWay;
use crate::plan::stages::Stages;
use crate::plan::whole_periods::{SLOWER, periods_taken, stretch_section, whole_periods};
use crate::schedule::section::Section;
use crate::schedule::stage::duration as duration_of;
use crate::{FeedLimit, FeedPiece, KinematicLimits, PlanError, ScheduleBuf, Stage};

/// Iterations of the program, at most.
const ITERATIONS: u32 = 60;
/// Share of a [moment](Way::moment) that a cell takes, at most, where something changes.
const CELL: f64 = 1.0;
/// Cells of a way, at least.
const FEWEST: f64 = 400.0;
/// By how much the first grid is coarser.
const COARSER: f64 = 3.0;
/// The gap of the solution on it, and of the last one.
const GAPS: [f64; 2] = [1e-2, 1e-4];
/// Strains are lowered to 1 less this.
const BELOW: f64 = 1e-5;
/// Solutions with lowered limits, at most.
const ROUNDS: usize = 3;
/// A stretch by more than this, beyond 1, is worth the first of them, or another.
const WORTH: [f64; 2] = [3e-4, 1e-3];

/// What a way took.
#[derive(Clone, Copy, Debug, Default)]
#[cfg_attr(not(test), allow(dead_code, reason = "tests read it"))]
struct Effort {
    nodes: usize,
    /// Of the rough solution, the one on the whole grid, the one with lowered limits.
    iterations: [u32; 3],
    /// Time of the last solution, before arcs and stretch.
    time: f64,
    /// By what the arcs were stretched.
    stretch: f64,
}

/// The plan with each way from rest to rest replaced by a faster one, where it bends and there is one.
///
/// `limit` is the feed limit [without reserves](FeedLimit::without_reserves) of these curves, which is that
/// [along](FeedLimit::along) them where no axis is limited, and `today` a plan under the latter. From a replaced way on, the plan keeps the feed limit, acceleration and jerk of the path, and of each
/// axis velocity `e v`, acceleration `e a + k v²` and jerk `e j + 3 k v a + c v³`, seen at ten places a period,
/// but for rounding; where a period is shorter than 1/128 of the time A/J, at ten places in that share.
/// Not the least time: the program is not convex, and the arcs lose a little. Takes no more than 60 iterations for each of five
/// solutions; time and memory grow with the periods in which the feed, its limit or the direction changes, and with the moves. With `std` all cores plan, each a section at a time.
///
/// # Errors
/// [`PlanError::DurationOverflows`] when the periods cannot be counted.
pub fn plan_within_axes<const D: usize, C: Differentiate<f64, D> + Sync>(
    curves: &[C],
    limits: &KinematicLimits<f64>,
    limit: &FeedLimit<f64>,
    today: &ScheduleBuf<f64>,
) -> Result<ScheduleBuf<f64>, PlanError> {
    plan_some_within_axes((curves, limits, limit), today, today, |_| true)
}

/// The plan `latest` with each section anew that `is_again` says of its begin and end: as of `today`, or faster.
pub(crate) fn plan_some_within_axes<const D: usize, C: Differentiate<f64, D> + Sync>(
    (curves, limits, limit): (&[C], &KinematicLimits<f64>, &FeedLimit<f64>),
    today: &ScheduleBuf<f64>,
    latest: &ScheduleBuf<f64>,
    is_again: impl Fn([f64; 2]) -> bool + Sync,
) -> Result<ScheduleBuf<f64>, PlanError> {
    let Some(geometry) = Geometry::new(curves, limit) else { return Ok(latest.clone()) };
    let [count, others] = [today, latest].map(|plan| plan.as_schedule().sections().count());
    if count != others {
        return Ok(latest.clone());
    }
    let both: Vec<_> = today.as_schedule().sections().zip(latest.as_schedule().sections()).collect();
    let again = in_parallel(&both, |(today, _)| {
        let ends = today.stages().first().zip(today.stages().last());
        let is_again = ends.is_some_and(|(first, last)| is_again([first.start, last.start + last.length]));
        is_again.then(|| faster(&geometry, limits, limit, today))
    });
    let (mut stages, mut periods) = (Vec::with_capacity(latest.stages.len()), 0_u64);
    for ((today, latest), again) in both.iter().zip(again) {
        let begin = stages.len();
        match again {
            Some(Some(faster)) => stages.extend(faster),
            Some(None) => stages.extend_from_slice(today.stages()),
            None => stages.extend_from_slice(latest.stages()),
        }
        let taken = duration_of(stages.get(begin..).unwrap_or_default());
        let taken = periods_taken(taken, limits.interpolation_period).ok_or(PlanError::DurationOverflows)?;
        periods = periods.saturating_add(u64::from(taken));
    }
    Ok(ScheduleBuf { stages, periods, ..*today })
}

/// The stages of a section in fewer whole periods, if some are found.
fn faster<const D: usize, C: Differentiate<f64, D>>(
    geometry: &Geometry<'_, C>,
    limits: &KinematicLimits<f64>,
    limit: &FeedLimit<f64>,
    section: &Section<'_, f64>,
) -> Option<Vec<Stage<f64>>> {
    let (first, last) = (section.stages().first()?, section.stages().last()?);
    let (begin, end) = (first.start, last.start + last.length);
    let rests = first.start_feed == 0.0 && last.end_feed == 0.0;
    if !rests || section.stages().iter().any(Stage::is_pause) || !limit.bends_over(begin, end) {
        return None;
    }
    let (slower, period) = (1.0_f64.ldexp(SLOWER), limits.interpolation_period);
    // It takes whole periods already, but for rounding.
    let mut before = section.stages().to_vec();
    let periods = stretch_section(&mut before, -1e-9, period).ok()?;
    if !may_take_less(limit, limits, (begin, end), periods) {
        return None;
    }
    let way = Way::new(geometry, limits, (begin, end))?;
    let duration = section.duration();
    let below = duration * (1.0 - 1.0_f64.ldexp(-WORTH_SAVING));
    let (pieces, _) = solve(&way, (duration, below), CELL)?;
    let mut stages = Stages::new(limit);
    let mut start = begin;
    for piece in &pieces {
        let length = piece.length();
        stages.push(start, length, piece);
        start += length;
    }
    let mut stages = stages.with_parameters();
    let taken = stretch_section(&mut stages, slower, period).ok()?;
    (taken < periods).then_some(stages)
}

/// Share of the periods of a way, as a power of two, that a program is to save at least: solving it for less takes longer
/// than it is worth.
const WORTH_SAVING: i32 = 10;

/// Whether a motion along the way between two rests may take fewer periods than these, by a share that is worth it, as
/// far as the limit and the path's acceleration and jerk say.
fn may_take_less(
    limit: &FeedLimit<f64>,
    limits: &KinematicLimits<f64>,
    ends: (f64, f64),
    periods: u32,
) -> bool {
    let is_less = |least: f64| {
        let least = whole_periods(least, 1.0_f64.ldexp(SLOWER), limits.interpolation_period);
        least.is_some_and(|(least, _)| least < periods - (periods >> WORTH_SAVING.unsigned_abs()))
    };
    // The rough bound tells of most ways that they may not, in a fraction of the time.
    let way = BoundedWay::between(limit, limits, ends);
    is_less(way.rough_duration()) && is_less(way.least_duration())
}

/// The pieces of a way that takes so long today, which keep every limit, before they take whole periods. None are made if they would take
/// as long as `below`.
fn solve<const D: usize, C: Differentiate<f64, D>>(
    way: &Way<'_, C>,
    (today, below): (f64, f64),
    cell: f64,
) -> Option<(Vec<FeedPiece<f64>>, Effort)> {
    let cell_time = (cell * way.moment()).min(cell * today / FEWEST);
    let (fine, guess, iterations) = coarsely(way, cell_time)?;
    let mut solver = Solver::new(way, fine);
    solver.run(guess, 0.1, (GAPS[1], below))?;
    let of_fine = solver.iterations;
    let (mut best, mut strains) = solver.arcs()?;
    let (nodes, time, stretch) = (solver.grid.nodes.len(), solver.time, best.stretch);
    let mut effort = Effort { nodes, iterations: [iterations, of_fine, 0], time, stretch };
    for round in 0..ROUNDS {
        if !(best.stretch > 1.0 + WORTH[round.min(1)]) {
            break;
        }
        solver.lower(&strains);
        let guess = solver.x.clone();
        let Some(()) = solver.run(guess, 0.02, (GAPS[1], below)) else { break };
        effort.iterations[2] += solver.iterations;
        let Some((other, others)) = solver.arcs() else { break };
        strains = others;
        if other.time * other.stretch < best.time * best.stretch {
            effort = Effort { time: solver.time, stretch: other.stretch, ..effort };
            best = other;
        }
    }
    let Found { pieces, stretch, .. } = best;
    Some((pieces.into_iter().map(|piece| slower(&piece, stretch)).collect(), effort))
}

/// The grid of the cells that are asked for, a guess of the solution on it, and the iterations that it took to solve on coarser cells.
fn coarsely<const D: usize, C: Differentiate<f64, D>>(
    way: &Way<'_, C>,
    cell_time: f64,
) -> Option<(Grid, Vec<f64>, u32)> {
    let rough = Profile::rough(way, COARSER * cell_time);
    let coarse = Grid::new(way, &rough, COARSER * cell_time, COARSER)?;
    let mut solver = Solver::new(way, coarse);
    let square = solver.square();
    let guess = near(&solver.grid.nodes, |distance| (0.5 * rough.square(distance) / square, 0.0));
    drop(rough);
    solver.run(guess, 1.0, (GAPS[0], f64::INFINITY))?;
    let profile = Profile::of(way, &solver.grid.nodes, &solver.x, square, cell_time);
    let fine = Grid::new(way, &profile, cell_time, 1.0)?;
    let spline = Spline::new(&solver.grid.nodes, &solver.x);
    let guess = near(&fine.nodes, |distance| spline.at(distance));
    Some((fine, guess, solver.iterations))
}

fn slower(piece: &FeedPiece<f64>, factor: f64) -> FeedPiece<f64> {
    let &FeedPiece { shape, start_feed, end_feed, duration } = piece;
    FeedPiece {
        shape,
        start_feed: start_feed / factor,
        end_feed: end_feed / factor,
        duration: duration * factor,
    }
}

/// Pieces that take this time, and by what they are to be stretched.
struct Found {
    time: f64,
    stretch: f64,
    pieces: Vec<FeedPiece<f64>>,
}

/// A grid, what holds on it, and the solution.
struct Solver<'a, 'w, C> {
    way: &'a Way<'w, C>,
    grid: Grid,
    places: Vec<WayCell>,
    shares: Vec<Strain>,
    x: Vec<f64>,
    time: f64,
    iterations: u32,
}

impl<'a, 'w, C> Solver<'a, 'w, C> {
    fn new<const D: usize>(way: &'a Way<'w, C>, grid: Grid) -> Self
    where
        C: Differentiate<f64, D>,
    {
        let (places, shares) = (places(way, &grid), all_of(way, &grid));
        Self { way, grid, places, shares, x: Vec::new(), time: 0.0, iterations: 0 }
    }

    /// The unit of b.
    fn square(&self) -> f64 {
        self.way.limits.feedrate * self.way.limits.feedrate
    }

    fn run(&mut self, guess: Vec<f64>, from_gap: f64, (gap, below): (f64, f64)) -> Option<()> {
        let feed = self.way.limits.feedrate;
        let program = program(self.way, &self.grid, &self.places, &self.shares, feed)?;
        let solution =
            program.solve(guess, from_gap, Stop { gap, iterations: ITERATIONS, below: below * feed })?;
        self.time = program.time(&solution.x) / feed;
        (self.x, self.iterations) = (solution.x, solution.iterations);
        Some(())
    }

    /// Time, stretch and pieces of the solution's arcs, and the strain in each cell.
    fn arcs<const D: usize>(&self) -> Option<(Found, Vec<Strain>)>
    where
        C: Differentiate<f64, D>,
    {
        let pieces = arcs::pieces(self.way, &self.grid, &self.places, &self.x, self.way.limits.feedrate)?;
        let strains = strains(self.way, &self.grid, &pieces);
        Some((Found { time: duration(&pieces), stretch: stretch(&strains), pieces }, strains))
    }

    /// Lowers the limits of cells by what was too much in them.
    fn lower(&mut self, strains: &[Strain]) {
        for (share, strain) in self.shares.iter_mut().zip(strains) {
            let lowered = |share: f64, strain: f64| {
                if strain > 1.0 { share * (1.0 - BELOW) / strain } else { share }
            };
            share.feed = lowered(share.feed, strain.feed * strain.feed);
            share.acceleration = lowered(share.acceleration, strain.acceleration);
            share.jerk = lowered(share.jerk, strain.jerk);
        }
    }
}

#[cfg(test)]
mod tests;
