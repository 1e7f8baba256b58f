//! A faster plan under limits of single axes.
//!
//! A plan under a [`FeedLimit`] shares out what the axes can do before it is made: so much for turning the path, so much for changing
//! the feed. Here each way from rest to rest is one program, in which every axis has all of its limits, wherever it moves:
//!
//! 1. *Geometry*: tangent, curvature and its change, axis by axis, with both values at knots and joints.
//! 2. *Grid*: nodes even in planned time, first of a rough profile, then of a solution on a third of the cells.
//! 3. *Program*: the least time, by an interior point.
//! 4. *Arcs*: the longest of constant jerk that follow the solution.
//! 5. *Check* at ten places a period at least. Where it finds more than is allowed, that cell's limits are lowered and the program is solved
//!    again, once; the rest is stretched in time evenly.
//! 6. *Whole periods*, as for every plan.
//!
//! A way for which any of that fails keeps the plan that it had, and so does one that would not be faster.

use alloc::vec::Vec;

use nurbs_core::Differentiate;
use real::Real;

use crate::axes::arcs;
use crate::axes::check::{duration, strains, stretch};
use crate::axes::geometry::Geometry;
use crate::axes::grid::{Grid, Profile};
use crate::axes::program::Stop;
use crate::axes::rows::{Place, all_of, places, program};
use crate::axes::spline::{Spline, near};
use crate::axes::way::{Strain, Way};
use crate::plan::stages::Stages;
use crate::plan::whole_periods::{SLOWER, stretch_section};
use crate::schedule::section::Section;
use crate::{FeedLimit, FeedPiece, KinematicLimits, PlanError, ScheduleBuf, Stage};

/// Iterations of the program, at most.
const ITERATIONS: u32 = 60;
/// Share of a period that a cell takes, at most.
const CELL: f64 = 1.0;
/// Cells of a way, at least.
const FEWEST: f64 = 400.0;
/// By how much the first grid is coarser.
const COARSER: f64 = 3.0;
/// The gap of the solution on it, and of the last one.
const GAPS: [f64; 2] = [1e-2, 1e-4];
/// Strains are lowered to 1 less this.
const BELOW: f64 = 1e-5;
/// Strains this far above 1 are worth another solution.
const WORTH: f64 = 3e-4;

/// What a way took.
#[derive(Clone, Copy, Debug, Default)]
pub(crate) struct Effort {
    pub(crate) nodes: usize,
    /// Of the rough solution, the one on the whole grid, the one with lowered limits.
    pub(crate) iterations: [u32; 3],
    /// Time of the last solution, before arcs and stretch.
    pub(crate) time: f64,
    /// By what the arcs were stretched.
    pub(crate) stretch: f64,
}

/// The plan with each way from rest to rest replaced by a faster one, where it bends and there is one.
///
/// `limit` is the feed limit [without reserves](FeedLimit::without_reserves) of these curves, `today` a plan under
/// [`FeedLimit::along`] them. From a replaced way on, the plan keeps the feed limit, acceleration and jerk of the path, and of each
/// axis velocity `e v`, acceleration `e a + k v²` and jerk `e j + 3 k v a + c v³`, seen at ten places a period, but for rounding.
/// Not the least time: the program is not convex, and the arcs lose a little. Takes no more than 60 iterations for each of three
/// solutions; time and memory are linear in the duration.
///
/// # Errors
/// [`PlanError::DurationOverflows`] when the periods cannot be counted.
pub fn plan_within_axes<const D: usize, C: Differentiate<f64, D>>(
    curves: &[C],
    limits: &KinematicLimits<f64>,
    limit: &FeedLimit<f64>,
    today: &ScheduleBuf<f64>,
) -> Result<ScheduleBuf<f64>, PlanError> {
    let is_limited = limits.axes.iter().any(|axis| axis.acceleration.or(axis.jerk).is_some());
    let Some(geometry) = is_limited.then(|| Geometry::new(curves, limit)).flatten() else {
        return Ok(today.clone());
    };
    let mut stages = Vec::with_capacity(today.stages.len());
    let mut saved = 0_u32;
    for section in today.as_schedule().sections() {
        match faster(&geometry, limits, limit, &section) {
            Some((other, periods)) => {
                stages.extend(other);
                saved = saved.saturating_add(periods);
            }
            None => stages.extend_from_slice(section.stages()),
        }
    }
    let periods = today.periods.checked_sub(saved).ok_or(PlanError::DurationOverflows)?;
    Ok(ScheduleBuf { stages, periods, ..*today })
}

/// The stages of a section in whole periods, and how many fewer they are.
fn faster<const D: usize, C: Differentiate<f64, D>>(
    geometry: &Geometry<'_, C>,
    limits: &KinematicLimits<f64>,
    limit: &FeedLimit<f64>,
    section: &Section<'_, f64>,
) -> Option<(Vec<Stage<f64>>, u32)> {
    let (first, last) = (section.stages().first()?, section.stages().last()?);
    let (begin, end) = (first.start, last.start + last.length);
    let rests = first.start_feed == 0.0 && last.end_feed == 0.0;
    if !rests || section.stages().iter().any(Stage::is_pause) || !limit.bends_over(begin, end) {
        return None;
    }
    let way = Way::new(geometry, limits, (begin, end))?;
    let (pieces, _) = solve(&way, section.duration(), CELL)?;
    let mut stages = Stages::new(limit);
    let mut start = begin;
    for piece in &pieces {
        let length = piece.length();
        stages.push(start, length, piece);
        start += length;
    }
    let mut stages = stages.with_parameters();
    let period = limits.interpolation_period;
    let taken = stretch_section(&mut stages, 1.0_f64.scale(SLOWER), period).ok()?;
    let mut before = section.stages().to_vec();
    let periods = stretch_section(&mut before, -1e-9, period).ok()?;
    (taken < periods).then(|| (stages, periods - taken))
}

/// The pieces of a way, which keep every limit, before they take whole periods.
pub(crate) fn solve<const D: usize, C: Differentiate<f64, D>>(
    way: &Way<'_, C>,
    today: f64,
    cell: f64,
) -> Option<(Vec<FeedPiece<f64>>, Effort)> {
    let cell_time = (cell * way.limits.interpolation_period).min(cell * today / FEWEST);
    let rough = Profile::rough(way, COARSER * cell_time);
    let coarse = Grid::new(way, &rough, COARSER * cell_time, COARSER)?;
    let mut solver = Solver::new(way, coarse);
    let square = solver.square();
    let guess = near(&solver.grid.nodes, |distance| (0.5 * rough.square(distance) / square, 0.0));
    solver.run(guess, 1.0, GAPS[0])?;
    let mut effort = Effort { iterations: [solver.iterations, 0, 0], ..Effort::default() };
    let profile = Profile::of(way, &solver.grid, &solver.x, square);
    let fine = Grid::new(way, &profile, cell_time, 1.0)?;
    let spline = Spline::new(&solver.grid.nodes, &solver.x);
    let guess = near(&fine.nodes, |distance| spline.at(distance));

    let mut solver = Solver::new(way, fine);
    solver.run(guess, 0.1, GAPS[1])?;
    effort = Effort { nodes: solver.grid.nodes.len(), ..effort };
    effort.iterations[1] = solver.iterations;
    let (mut best, strains) = solver.arcs()?;
    effort = Effort { time: solver.time, stretch: best.1, ..effort };
    if best.1 > 1.0 + WORTH {
        solver.lower(&strains);
        let guess = solver.x.clone();
        if solver.run(guess, 0.02, GAPS[1]).is_some() {
            effort.iterations[2] = solver.iterations;
            if let Some((other, _)) = solver.arcs().filter(|(other, _)| other.0 * other.1 < best.0 * best.1) {
                best = other;
                effort = Effort { time: solver.time, stretch: best.1, ..effort };
            }
        }
    }
    let (_, stretch, pieces) = best;
    Some((pieces.into_iter().map(|piece| slower(&piece, stretch)).collect(), effort))
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

/// A grid, what holds on it, and the solution.
struct Solver<'a, 'w, C> {
    way: &'a Way<'w, C>,
    grid: Grid,
    places: Vec<Place>,
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
        let (places, shares) = (places(way, &grid), all_of(&grid));
        Self { way, grid, places, shares, x: Vec::new(), time: 0.0, iterations: 0 }
    }

    /// The unit of b.
    fn square(&self) -> f64 {
        self.way.limits.feedrate * self.way.limits.feedrate
    }

    fn run(&mut self, guess: Vec<f64>, from_gap: f64, gap: f64) -> Option<()> {
        let feed = self.way.limits.feedrate;
        let program = program(self.way, &self.grid, &self.places, &self.shares, feed)?;
        let solution = program.solve(guess, from_gap, Stop { gap, iterations: ITERATIONS })?;
        self.time = program.time(&solution.x) / feed;
        (self.x, self.iterations) = (solution.x, solution.iterations);
        Some(())
    }

    /// Time, stretch and pieces of the solution's arcs, and the strain in each cell.
    fn arcs<const D: usize>(&self) -> Option<((f64, f64, Vec<FeedPiece<f64>>), Vec<Strain>)>
    where
        C: Differentiate<f64, D>,
    {
        let pieces = arcs::pieces(self.way, &self.grid, &self.places, &self.x, self.way.limits.feedrate)?;
        let strains = strains(self.way, &self.grid, &pieces);
        if std::env::var("WORST").is_ok() {
            let mut w: Vec<_> = strains.iter().enumerate().map(|(i, s)| (s.stretch(), i, *s)).collect();
            w.sort_by(|a, b| b.0.total_cmp(&a.0));
            for x in w.iter().take(4) {
                println!("   {x:?} of {} at {} of {}", strains.len(), self.grid.nodes[x.1], self.way.end);
            }
        }
        Some(((duration(&pieces), stretch(&strains), pieces), strains))
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
mod tests {
    use super::*;
    use crate::test_paths::{circle, in_periods, paper_limits, seed_000, seed_003};
    use crate::{AxisLimits, EndFeeds, ProfileKind, plan_with};
    use nurbs_core::NurbsBuf;

    /// Axis limits in mm, s, with periods of 3 ms.
    fn axis(velocity: f64, acceleration: f64, jerk: f64) -> AxisLimits<f64> {
        let t = 3e-3;
        AxisLimits {
            velocity: Some(velocity * t),
            acceleration: Some(acceleration * t * t),
            jerk: Some(jerk * t * t * t),
        }
    }

    struct Case {
        name: &'static str,
        curve: NurbsBuf<f64, 2>,
        limits: KinematicLimits<f64>,
    }

    fn cases() -> Vec<Case> {
        let none = AxisLimits::default();
        let case =
            |name, curve, axes| Case { name, curve, limits: KinematicLimits { axes, ..paper_limits() } };
        let generous = axis(200.0, 5000.0, 4e5);
        let weak = axis(100.0, 1000.0, 4e4);
        vec![
            case(
                "seed-000 with axes",
                seed_000(),
                [axis(120.0, 2000.0, 1e5), axis(150.0, 3000.0, 2e5), none],
            ),
            case("seed-000, equal generous axes", seed_000(), [generous, generous, none]),
            case("seed-000, one weak axis", seed_000(), [generous, weak, none]),
            case(
                "seed-003 with axes",
                seed_003(),
                [axis(150.0, 3000.0, 2e5), axis(200.0, 4000.0, 3e5), none],
            ),
            case(
                "seed-003, acceleration binds",
                seed_003(),
                [axis(200.0, 1500.0, 4e5), axis(200.0, 1500.0, 4e5), none],
            ),
            case(
                "seed-003, jerk binds",
                seed_003(),
                [axis(200.0, 5000.0, 6e4), axis(200.0, 5000.0, 6e4), none],
            ),
            case(
                "seed-003, an idle weak Z",
                seed_003(),
                [axis(150.0, 3000.0, 2e5), axis(200.0, 4000.0, 3e5), axis(10.0, 50.0, 500.0)],
            ),
            case("circle R10", circle(10.0), [generous, generous, none]),
            case("circle R10, unequal", circle(10.0), [generous, axis(200.0, 3000.0, 1e5), none]),
        ]
    }

    #[test]
    fn show() {
        for Case { name, curve, limits } in cases() {
            let curves = [curve.as_curve()];
            let reserved = FeedLimit::along(&curves, &limits).unwrap();
            let today = plan_with(&reserved, &limits, EndFeeds::default(), ProfileKind::SCurve).unwrap();
            let limit = FeedLimit::without_reserves(&curves, &limits, &[]).unwrap();
            let geometry = Geometry::new(&curves, &limit).unwrap();
            let way = Way::new(&geometry, &limits, (0.0, limit.length())).unwrap();
            let before = today.as_schedule().duration();
            let start = std::time::Instant::now();
            let found = solve(&way, before, CELL);
            let taken = start.elapsed().as_secs_f64();
            let fine = solve(&way, before, CELL / 4.0);
            let Some((pieces, effort)) = found else {
                println!("{name}: none ({before})");
                continue;
            };
            let best = fine.map_or(0.0, |(_, effort)| effort.time);
            println!(
                "{name}: {before:.2} -> {:.3} for {best:.3}: {:+.3} %, s-curve {:+.2} %; {} stages for {}; {effort:?} {:.1} us a node",
                duration(&pieces),
                100.0 * (duration(&pieces) / best - 1.0),
                100.0 * (before / best - 1.0),
                pieces.len(),
                today.stages().len(),
                taken / effort.nodes as f64 * 1e6
            );
        }
    }
}
#[cfg(test)]
mod trial {
    use super::*;
    use crate::test_paths::paper_limits;
    use crate::{AxisLimits, EndFeeds, ProfileKind, plan_with};
    use nurbs_core::NurbsBuf;

    struct Rng(u64);
    impl Rng {
        fn next(&mut self) -> f64 {
            self.0 ^= self.0 << 13;
            self.0 ^= self.0 >> 7;
            self.0 ^= self.0 << 17;
            (self.0 >> 11) as f64 / (1u64 << 53) as f64
        }
    }

    #[test]
    fn random() {
        let (mut sum, mut worst, mut n, mut fails, mut sums, mut slower) = (0.0, 0.0_f64, 0, 0, 0.0, 0);
        for seed in std::env::var("FROM").map_or(0, |s| s.parse().unwrap())
            ..std::env::var("SEEDS").map_or(24, |s| s.parse().unwrap())
        {
            let mut rng = Rng(0x9E3779B97F4A7C15 ^ (seed * 7919 + 1) * 0x2545F4914F6CDD1D);
            for _ in 0..10 {
                rng.next();
            }
            let count = 5 + (rng.next() * 8.0) as usize;
            let scale = 10.0_f64.powf(1.0 + rng.next());
            let points: Vec<[f64; 2]> = (0..count)
                .map(|i| [i as f64 * scale * 0.3 + scale * rng.next(), scale * rng.next()])
                .collect();
            let inner = (1..count - 3).map(|k| k as f64);
            let knots: Vec<f64> = [0.0; 4].into_iter().chain(inner).chain([(count - 3) as f64; 4]).collect();
            let curve = NurbsBuf::try_new_nonrational(3, points, knots).unwrap();
            let t: f64 = 3e-3;
            let mut axis = || AxisLimits {
                velocity: Some(t * 200.0 * 10.0_f64.powf(-rng.next())),
                acceleration: Some(t * t * 5000.0 * 10.0_f64.powf(-2.0 * rng.next())),
                jerk: Some(t * t * t * 4e5 * 10.0_f64.powf(-2.0 * rng.next())),
            };
            let limits = KinematicLimits { axes: [axis(), axis(), AxisLimits::default()], ..paper_limits() };
            let curves = [curve.as_curve()];
            let reserved = FeedLimit::along(&curves, &limits).unwrap();
            let today = plan_with(&reserved, &limits, EndFeeds::default(), ProfileKind::SCurve).unwrap();
            let limit = FeedLimit::without_reserves(&curves, &limits, &[]).unwrap();
            let geometry = Geometry::new(&curves, &limit).unwrap();
            let before = today.as_schedule().duration();
            let section = today.as_schedule().sections().count();
            let way = Way::new(&geometry, &limits, (0.0, limit.length())).unwrap();
            let found = solve(&way, before, CELL);
            let fine = solve(&way, before, CELL / 4.0);
            let best = fine.map_or(f64::NAN, |(_, effort)| effort.time);
            let Some((pieces, effort)) = found else {
                println!("{seed}: none ({before}, sections {section}) {best}");
                fails += 1;
                continue;
            };
            let over = 100.0 * (duration(&pieces) / best - 1.0);
            sum += over;
            worst = worst.max(over);
            n += 1;
            sums += before / best - 1.0;
            slower += usize::from(duration(&pieces) > before);
            println!(
                "{seed}: {before:.2} -> {:.3} for {best:.3}: {over:+.3} %, s-curve {:+.2} %; {} stages for {}; {effort:?} sections {section}",
                duration(&pieces),
                100.0 * (before / best - 1.0),
                pieces.len(),
                today.stages().len()
            );
        }
        println!(
            "mean {} worst {worst} fails {fails} s-curve {} slower {slower}",
            sum / n as f64,
            100.0 * sums / n as f64
        );
    }
}
