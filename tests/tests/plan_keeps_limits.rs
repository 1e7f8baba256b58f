//! Every point of a plan sampled at ten times the period keeps feed, acceleration, jerk, chord error and the limits of
//! each axis, to 1e-9, whatever the transitions it is made of.

use feed_plan::{
    AxisLimits, EndFeeds, FeedLimit, Junction, KinematicLimits, ProfileKind, ScheduleBuf, plan_with,
};
use feedbits_tests::{
    PAPER_A, PAPER_D, circle, corner, cusp, degree_5, double_knot, on_paper_as_machine, problem,
};
use format_compare::{ExactPlan, Options, PlanSummary, Problem, Reference};
use nurbs_core::{Derivatives, Differentiate, Evaluate, NurbsBuf, arc_length, radius};

/// Relative slack: rounding only.
const SLACK: f64 = 1e-9;

/// A path of one or more curves by its arc length, found independently of the planner's own scan.
struct Path<'a, const D: usize> {
    curves: &'a [NurbsBuf<f64, D>],
    /// Distance, curve and parameter on a fine grid.
    grid: Vec<(f64, usize, f64)>,
}

impl<'a, const D: usize> Path<'a, D> {
    fn new(curves: &'a [NurbsBuf<f64, D>]) -> Self {
        let mut grid = Vec::new();
        let mut distance = 0.0;
        for (index, curve) in curves.iter().enumerate() {
            let curve = curve.as_curve();
            for span in 0..curve.span_count() {
                let (begin, end) = curve.span_bounds(span);
                grid.push((distance, index, begin));
                for i in 0..200 {
                    let at = |i: i32| begin + (end - begin) * f64::from(i) / 200.0;
                    distance += arc_length(&curve, at(i), at(i + 1), 1e-14).length;
                    grid.push((distance, index, at(i + 1)));
                }
            }
        }
        Self { curves, grid }
    }

    fn length(&self) -> f64 {
        self.grid.last().map_or(0.0, |last| last.0)
    }

    /// Curve and parameter at a distance, by Newton's method from the grid.
    fn at(&self, distance: f64) -> (usize, f64) {
        let next = self.grid.partition_point(|place| place.0 < distance).clamp(1, self.grid.len() - 1);
        let (from, to) = (self.grid[next - 1], self.grid[next]);
        if to.0 <= from.0 {
            return (to.1, to.2);
        }
        let curve = self.curves[to.1].as_curve();
        let mut u = from.2 + (to.2 - from.2) * (distance - from.0) / (to.0 - from.0);
        for _ in 0..3 {
            let error = from.0 + arc_length(&curve, from.2, u, 1e-12).length - distance;
            u -= error / norm(&curve.derivatives(u).first);
            u = u.clamp(from.2, to.2);
        }
        (to.1, u)
    }
}

fn norm<const D: usize>(vector: &[f64; D]) -> f64 {
    vector.iter().map(|x| x * x).sum::<f64>().sqrt()
}

/// Unit tangent and curvature vector.
fn turning<const D: usize>(at: &Derivatives<f64, D>) -> ([f64; D], [f64; D]) {
    let speed = norm(&at.first);
    let tangent = at.first.map(|x| x / speed);
    let along: f64 = tangent.iter().zip(at.second).map(|(t, x)| t * x).sum();
    (tangent, core::array::from_fn(|d| (at.second[d] - along * tangent[d]) / (speed * speed)))
}

/// Change of the curvature vector with the arc length, from second-order differences within the span.
fn change<const D: usize>(curve: &NurbsBuf<f64, D>, u: f64) -> [f64; D] {
    let curve = curve.as_curve();
    let span = (0..curve.span_count()).find(|&i| u <= curve.span_bounds(i).1).unwrap_or(0);
    let (begin, end) = curve.span_bounds(span);
    let h = (end - begin) * 1e-5;
    let middle = u.clamp(begin + h, end - h);
    let bend = |u: f64| turning(&curve.derivatives_in(span, u)).1;
    let (before, after) = (bend(middle - h), bend(middle + h));
    let speed = norm(&curve.derivatives(middle).first);
    core::array::from_fn(|d| (after[d] - before[d]) / (2.0 * h * speed))
}

/// What each limit is used to, at most, as a ratio.
#[derive(Debug, Default)]
struct Used {
    feed: f64,
    acceleration: f64,
    jerk: f64,
    chord_error: f64,
    axis_velocity: f64,
    axis_acceleration: f64,
    axis_jerk: f64,
}

fn used<const D: usize>(path: &Path<'_, D>, limits: &KinematicLimits<f64>, plan: &ScheduleBuf<f64>) -> Used {
    let mut used = Used::default();
    let most = |slot: &mut f64, value: f64| *slot = slot.max(value);
    let rests = plan.stages().iter().filter(|stage| stage.start_feed == 0.0).map(|stage| stage.start);
    let rests: Vec<f64> = rests.collect();
    // No chord between two such places leaves the curve by more.
    let beside_rest = |distance: f64| {
        rests.iter().any(|rest| (rest - distance).abs() <= limits.chord_error * (1.0 + SLACK))
    };
    for stage in plan.stages() {
        let count = (10.0 * stage.duration).ceil().max(2.0);
        for i in (0_u32..).take_while(|i| f64::from(*i) <= count) {
            let time = stage.duration * f64::from(i) / count;
            let (v, a, j) = (stage.feed_at(time), stage.acceleration_at(time), stage.jerk_at(time));
            let distance = stage.start + stage.distance_at(time);
            let (index, u) = path.at(distance);
            let curve = &path.curves[index];
            let at = curve.as_curve().derivatives(u);
            most(&mut used.feed, v / limits.feedrate);
            most(&mut used.acceleration, a.abs() / limits.acceleration);
            most(&mut used.jerk, j.abs() / limits.jerk);
            let rho = radius(&at);
            let half_step = v * limits.interpolation_period / 2.0;
            let chord_error = if half_step < rho {
                // ρ - √(ρ² - (L/2)²), without the difference of two large numbers.
                half_step * half_step / (rho + (rho * rho - half_step * half_step).sqrt())
            } else {
                rho
            };
            if !beside_rest(distance) {
                most(&mut used.chord_error, chord_error / limits.chord_error);
            }
            let ((e, k), c) = (turning(&at), change(curve, u));
            for (d, axis) in limits.axes.iter().enumerate().take(D) {
                let ratio = |value: f64, limit: Option<f64>| limit.map_or(0.0, |limit| value.abs() / limit);
                most(&mut used.axis_velocity, ratio(e[d] * v, axis.velocity));
                most(&mut used.axis_acceleration, ratio(e[d] * a + k[d] * v * v, axis.acceleration));
                let jerk = e[d] * j + 3.0 * k[d] * v * a + c[d] * v * v * v;
                most(&mut used.axis_jerk, ratio(jerk, axis.jerk));
            }
        }
    }
    used
}

fn keeps<const D: usize>(name: &str, curves: &[NurbsBuf<f64, D>], limits: &KinematicLimits<f64>) -> Vec<f64> {
    let path = Path::new(curves);
    let views: Vec<_> = curves.iter().map(NurbsBuf::as_curve).collect();
    let limit = FeedLimit::along(&views, limits).unwrap_or_else(|error| panic!("{name}: {error}"));
    assert!((limit.length() - path.length()).abs() < 1e-9 * path.length(), "{name}");
    let bound = feed_plan::jerk_free_duration(&limit, limits, feed_plan::EndFeeds::default());
    ProfileKind::ALL
        .iter()
        .map(|&kind| {
            let plan = plan_with(&limit, limits, EndFeeds::default(), kind)
                .unwrap_or_else(|e| panic!("{name}: {e}"));
            let used = used(&path, limits, &plan);
            let all = [
                used.feed,
                used.acceleration,
                used.jerk,
                used.chord_error,
                used.axis_velocity,
                used.axis_acceleration,
                used.axis_jerk,
            ];
            assert!(all.iter().all(|ratio| *ratio <= 1.0 + SLACK), "{name}, {kind:?}: {used:?}");
            let schedule = plan.as_schedule();
            assert!((schedule.length() - path.length()).abs() < 1e-9 * path.length(), "{name}, {kind:?}");
            let periods = schedule.periods() as f64;
            assert!((schedule.duration() / limits.interpolation_period - periods).abs() < 1e-9 * periods);
            assert!(schedule.duration() >= bound * (1.0 - 1e-4), "{name}, {kind:?}: faster than the bound");
            schedule.duration() / bound
        })
        .collect()
}

fn limits_of<const D: usize>(problem: &Problem<D>) -> KinematicLimits<f64> {
    problem.limits_per_period().unwrap_or_else(|error| panic!("{error}"))
}

fn keeps_every_limit<const D: usize>(problem: &Problem<D>) -> Vec<f64> {
    keeps(&problem.name, &problem.curves, &limits_of(problem))
}

/// Limits of the axes that bind on the curve, in mm/s, mm/s² and mm/s³.
fn with_axes(limits: &KinematicLimits<f64>, period_s: f64, [v, a, j]: [f64; 3]) -> KinematicLimits<f64> {
    let axis = AxisLimits {
        velocity: Some(v * period_s),
        acceleration: Some(a * period_s.powi(2)),
        jerk: Some(j * period_s.powi(3)),
    };
    let slower = AxisLimits { velocity: Some(0.8 * v * period_s), ..axis };
    KinematicLimits { axes: [axis, slower, axis], ..*limits }
}

#[test]
fn paper_a() {
    let over = keeps_every_limit(&problem::<2>("paper A", PAPER_A));
    // Within 2 % of the bound that ignores jerk, 4.848 s.
    assert!(over.iter().all(|over| *over < 1.02), "{over:?}");
}

#[test]
fn the_bound_of_paper_a_is_what_was_found_independently() {
    let problem = problem::<2>("paper A", PAPER_A);
    let plan = ExactPlan::in_format::<f64, 2>(&problem, [0.0; 2]).expect("it can be planned");
    let summary = PlanSummary::of(&plan, &problem).expect("it was planned");
    assert!((summary.jerk_free_time_s - 4.848).abs() < 2e-3, "{}", summary.jerk_free_time_s);
}

#[test]
fn paper_d() {
    keeps_every_limit(&problem::<2>("paper D", PAPER_D));
}

#[test]
fn a_circle() {
    let over = keeps_every_limit(&on_paper_as_machine("circle", circle()));
    assert!(over.iter().all(|over| *over < 1.1), "{over:?}");
}

#[test]
fn other_curves() {
    keeps_every_limit(&on_paper_as_machine("degree 5", degree_5()));
    keeps_every_limit(&on_paper_as_machine("double knot", double_knot()));
}

/// Points from a fixed sequence, so that a failure can be looked at again.
fn random_curve(seed: u64) -> NurbsBuf<f64, 2> {
    let mut state = seed.wrapping_mul(0x9e37_79b9_7f4a_7c15) | 1;
    let mut next = || {
        state ^= state << 13;
        state ^= state >> 7;
        state ^= state << 17;
        (state >> 11) as f64 / (1_u64 << 53) as f64
    };
    let points: Vec<_> = (0..9).map(|_| [100.0 * next(), 100.0 * next()]).collect();
    let weights = (0..9).map(|_| 0.5 + next()).collect();
    let inner = (1..=5).map(|i| f64::from(i) / 6.0);
    let knots = [0.0; 4].into_iter().chain(inner).chain([1.0; 4]).collect();
    NurbsBuf::try_new(3, points, weights, knots).expect("a valid curve")
}

#[test]
fn random_curves() {
    for seed in 1..=8 {
        keeps_every_limit(&on_paper_as_machine(&format!("random {seed}"), random_curve(seed)));
    }
}

#[test]
fn axes_keep_their_own_limits() {
    let limits = limits_of(&problem::<2>("paper A", PAPER_A));
    let of = |name: &str, curve: NurbsBuf<f64, 2>, axes: [f64; 3]| {
        keeps(name, &[curve], &with_axes(&limits, 3e-3, axes));
    };
    let curve = |problem: Problem<2>| problem.curves.into_iter().next().expect("one curve");
    let all = [120.0, 3000.0, 1e5];
    of("paper A", curve(problem::<2>("paper A", PAPER_A)), all);
    of("paper D", curve(problem::<2>("paper D", PAPER_D)), all);
    of("circle", circle(), all);
    for seed in 1..=5 {
        of(&format!("random {seed}"), random_curve(seed), all);
    }
    // Each alone.
    for (seed, name, axes) in [
        (6, "velocity", [100.0, 1e5, 1e9]),
        (7, "acceleration", [1e4, 2000.0, 1e9]),
        (8, "jerk", [1e4, 1e5, 3e4]),
    ] {
        of(&format!("paper D, {name}"), curve(problem::<2>("paper D", PAPER_D)), axes);
        of(&format!("random {seed}, {name}"), random_curve(seed), axes);
    }
    keeps("degree 5", &[degree_5()], &with_axes(&limits, 3e-3, [120.0, 3000.0, 1e5]));
}

const MILLING: &str = "[machine]\ninterpolation_period_ms = 1.0\nfeedrate_mm_per_s = 100.0\nacceleration_mm_per_s2 = 5000.0\n\
    jerk_mm_per_s3 = 200000.0\nchord_error_mm = 0.01\nfluctuation_limit = 1e-4\nparameter_tolerance = 1e-10\nmax_iterations = 8\n";

/// A plan of a full turn of radius 20 with this rise, on a machine with these limits of its axes.
fn full_turn(rise: f64, axes: &str, kind: ProfileKind) -> (Problem<3>, ExactPlan, PlanSummary) {
    let part = format!("G0 X20 Y0 Z0\nG3 X20 Y0 Z{rise} I-20 J0 F6000\n");
    let part = part_program::read_part("turn.nc", &part).expect("a part");
    let machine = part_program::read_machine("machine.toml", &format!("{MILLING}{axes}")).expect("a machine");
    let problem = Problem::<3>::new(&part, &machine).expect("a problem");
    let plan = ExactPlan::in_format_with::<f64, 3>(&problem, [0.0; 2], kind).expect("a plan");
    let summary = PlanSummary::of(&plan, &problem).expect("it was planned");
    (problem, plan, summary)
}

/// A weak Z that stands still made 10.4 s of it.
#[test]
fn an_axis_that_stands_still_limits_nothing() {
    let x = "[machine.axes.x]\nacceleration_mm_per_s2 = 500.0\n";
    let weak = format!("{x}[machine.axes.z]\nacceleration_mm_per_s2 = 10.0\njerk_mm_per_s3 = 10.0\n");
    for kind in ProfileKind::ALL {
        let time = |axes: &str| full_turn(0.0, axes, kind).2.time_s;
        assert_eq!(time(&weak), time(x), "{kind:?}");
    }
}

/// The slope of a helix is everywhere the same, `dz/ds` = 0.06353: with 78.70 mm/s, 157.4 mm/s² and 7870 mm/s³ along the path Z
/// keeps its limits, which takes 2.120 s. It took 4.357 s, for z″ stepped where the spans that represent it met.
#[test]
fn an_axis_that_moves_evenly_limits_the_path_evenly() {
    let z = "[machine.axes.z]\nvelocity_mm_per_s = 5\nacceleration_mm_per_s2 = 10\njerk_mm_per_s3 = 500\n";
    let time = full_turn(-8.0, z, ProfileKind::SCurve).2.time_s;
    assert!((2.120..2.126).contains(&time), "{time}");
}

/// Differences of the setpoints keep the limits of each axis, and what a plan says of its peaks is what they take. Z took 1.6 times
/// its jerk, and the plan said less.
#[test]
fn the_peaks_of_axes_are_those_of_the_setpoints() {
    let axes = "[machine.axes.x]\nvelocity_mm_per_s = 83\nacceleration_mm_per_s2 = 500\njerk_mm_per_s3 = 20000\n\
        [machine.axes.y]\nvelocity_mm_per_s = 66\nacceleration_mm_per_s2 = 300\njerk_mm_per_s3 = 20000\n\
        [machine.axes.z]\nvelocity_mm_per_s = 5\nacceleration_mm_per_s2 = 10\njerk_mm_per_s3 = 500\n";
    let formats = format_compare::select::<3>(&["f64".to_string()]).expect("f64");
    for kind in ProfileKind::ALL {
        let (problem, plan, summary) = full_turn(-8.0, axes, kind);
        let run = formats[0].run(&problem, &plan, &Options { profile: kind, ..Options::default() });
        let start = [20.0, 0.0, 0.0];
        let mut points = vec![start; 3];
        points.extend(run.expect("a run").steps.iter().map(|step| step.point_mm));
        let t = problem.period_s();
        for (d, peak) in summary.axes.iter().enumerate() {
            let along: Vec<f64> = points.iter().map(|point| point[d]).collect();
            let difference =
                |values: &[f64]| values.windows(2).map(|w| (w[1] - w[0]) / t).collect::<Vec<_>>();
            let most = |values: &[f64]| values.iter().fold(0.0_f64, |most, value| most.max(value.abs()));
            let (velocity, limits) = (difference(&along), peak.limits);
            let (acceleration, jerk) = (difference(&velocity), difference(&difference(&velocity)));
            for (values, said, limit, tolerance) in [
                (velocity, peak.velocity_max_mm_per_s, limits.velocity_mm_per_s, 1e-4),
                (acceleration, peak.acceleration_max_mm_per_s2, limits.acceleration_mm_per_s2, 1e-3),
                (jerk, peak.jerk_max_mm_per_s3, limits.jerk_mm_per_s3, 0.02),
            ] {
                let taken = most(&values);
                assert!((taken / said - 1.0).abs() < tolerance, "{kind:?}, {peak:?}: {taken}, not {said}");
                let limit = limit.expect("a limit");
                assert!(taken <= limit * (1.0 + tolerance), "{kind:?}, {peak:?}: {taken}");
            }
        }
    }
}

fn line(from: [f64; 2], to: [f64; 2]) -> NurbsBuf<f64, 2> {
    NurbsBuf::try_new(1, vec![from, to], vec![1.0; 2], vec![0.0, 0.0, 1.0, 1.0]).expect("a line")
}

#[test]
fn joints_are_passed_as_the_junction_says() {
    let limits = limits_of(&problem::<2>("paper A", PAPER_A));
    let path =
        [line([0.0, 0.0], [40.0, 0.0]), line([40.0, 0.0], [80.0, 20.0]), line([80.0, 20.0], [80.0, 60.0])];
    let feeds = |junction| {
        let limits = KinematicLimits { junction, ..limits };
        keeps("joints", &path, &limits);
        let views: Vec<_> = path.iter().map(NurbsBuf::as_curve).collect();
        let limit = FeedLimit::along(&views, &limits).expect("a path");
        let plan = plan_with(&limit, &limits, EndFeeds::default(), ProfileKind::SCurve).expect("a plan");
        [40.0, 40.0 + 2000.0_f64.sqrt()].map(|joint| {
            let stage = plan.stages().iter().find(|s| s.start + s.length >= joint - 1e-9).expect("the joint");
            stage.end_feed
        })
    };
    assert_eq!(feeds(Junction::Stop), [0.0, 0.0]);

    // Turns by φ = 26.57° and 63.43°: A δ cos(φ/2)/(1 - cos(φ/2)), a step of the plan's stretch below.
    let deviation = 0.01;
    let turns = [(20.0_f64 / 40.0).atan(), (40.0_f64 / 20.0).atan()];
    for (found, turn) in feeds(Junction::Deviation(deviation)).into_iter().zip(turns) {
        let cosine = (turn / 2.0).cos();
        let by_acceleration = (limits.acceleration * deviation * cosine / (1.0 - cosine)).sqrt();
        let expected = by_acceleration.min(2.0 * deviation / (turn / 2.0).tan());
        assert!(found <= expected && found > 0.98 * expected, "{found} for {expected}");
    }

    // The x axis jumps by V (1 - cos 26.57°) = 0.106 V at the first joint, the y axis by 0.447 V.
    let [first, second] = feeds(Junction::VelocityJump([0.01, 0.02, 1.0]));
    let expected = 0.02 / turns[0].sin();
    assert!(first <= expected && first > 0.98 * expected, "{first} for {expected}");
    let expected = 0.01 / turns[0].cos();
    assert!(second <= expected && second > 0.98 * expected, "{second} for {expected}");
}

/// A line that meets an arc: the curvature steps, and the axes' jerk limits the feed there.
#[test]
fn a_step_of_the_curvature_limits_the_feed() {
    let limits = limits_of(&problem::<2>("paper A", PAPER_A));
    let limits = with_axes(&limits, 3e-3, [1e4, 1e5, 1e5]);
    let [x, y] = [50.0, 0.0];
    let arc = [[x, y], [x + 100.0, y], [x + 100.0, y + 100.0]].to_vec();
    let knots = vec![0.0, 0.0, 0.0, 1.0, 1.0, 1.0];
    let arc = NurbsBuf::try_new(2, arc, vec![1.0, 0.5_f64.sqrt(), 1.0], knots).expect("a quarter circle");
    let path = [line([0.0, 0.0], [x, y]), arc];
    let views: Vec<_> = path.iter().map(NurbsBuf::as_curve).collect();
    let limit = FeedLimit::along(&views, &limits).expect("a path");
    // V² κ ≤ ⅔ J T, κ = 1/100 mm: setpoints show ¾ of the step as jerk, and the feed may take its own.
    let jerk = 1e5 * 3e-3_f64.powi(3);
    let joint = limit.points().filter(|point| (point.distance - 50.0).abs() < 1e-9);
    let feed = joint.map(|point| point.feedrate).fold(f64::INFINITY, f64::min);
    assert!((feed - (100.0 * jerk * 2.0 / 3.0).sqrt()).abs() < 1e-9, "{feed}");
}

/// Paper A's own procedure: a stage per minimum of the limit, as long as its fastest transition from the commanded
/// feed, ending at the minimum. On short flanks these overlap; ours keep every limit there.
#[test]
fn short_flanks_on_which_paper_a_s_procedure_breaks_a_limit() {
    let mut problem = problem::<2>("paper D, slow", PAPER_D);
    problem.machine.acceleration_mm_per_s2 = 1000.0;
    problem.machine.jerk_mm_per_s3 = 20_000.0;
    let limits = limits_of(&problem);
    let views: Vec<_> = problem.curves.iter().map(NurbsBuf::as_curve).collect();
    let limit = FeedLimit::along(&views, &limits).expect("a path");

    let points: Vec<_> = limit.points().copied().collect();
    let minima = points.windows(3).filter(|w| {
        w[1].feedrate < w[0].feedrate
            && w[1].feedrate <= w[2].feedrate
            && w[1].feedrate < 0.98 * limits.feedrate
    });
    let mut overlaps = 0;
    let mut worst: f64 = 0.0;
    let mut free_from = 0.0;
    for minimum in minima.map(|w| w[1]) {
        // 3D/(2A), √(6D/J): the deceleration distance of the paper's Table, times the mean feed.
        let change = limits.feedrate - minimum.feedrate;
        let duration = (1.5 * change / limits.acceleration).max((6.0 * change / limits.jerk).sqrt());
        let length = duration * (limits.feedrate + minimum.feedrate) / 2.0;
        let start = minimum.distance - length;
        overlaps += usize::from(start < free_from);
        // The feed on that stage, against the limit.
        for i in 0..=1000 {
            let x = f64::from(i) / 1000.0;
            let feed = limits.feedrate - change * x * x * (3.0 - 2.0 * x);
            let travelled = duration * (limits.feedrate * x - change * (x.powi(3) - x.powi(4) / 2.0));
            let distance = start + travelled;
            if distance > 0.0 && limit.at(distance) > 0.0 {
                worst = worst.max(feed / limit.at(distance));
            }
        }
        free_from = minimum.distance + length;
    }
    assert!(overlaps >= 3, "{overlaps} stages overlap");
    assert!(worst > 2.0, "the paper's feed is {worst} of the limit");
    keeps_every_limit(&problem);
}

/// A right angle at a triple knot, where the curvature is 0 on both sides, and a cusp.
#[test]
fn corners_and_cusps_inside_a_curve_are_stopped_at() {
    for (name, curve, at) in [("corner", corner(), 0.5), ("cusp", cusp(), 0.5)] {
        let problem = on_paper_as_machine(name, curve);
        for kind in ProfileKind::ALL {
            let plan = ExactPlan::in_format_with::<f64, 2>(&problem, [0.0; 2], kind).expect("a plan");
            let stages = plan.schedule().stages();
            let stop = stages.iter().find(|s| s.start.value() > 0.0 && s.start_feed.value() == 0.0);
            let stop = stop.unwrap_or_else(|| panic!("{name}, {kind:?}: no stop"));
            assert!((stop.u_start.value() - at).abs() < 1e-4, "{name}: {stop:?}");
        }
    }
}

/// Stops are setpoints: otherwise the chord of the period that passes one would cut the corner.
#[test]
fn no_chord_cuts_a_corner() {
    let problem = on_paper_as_machine("corner", corner());
    let formats = format_compare::select::<2>(&["f64".to_string()]).expect("f64");
    for kind in ProfileKind::ALL {
        let options = Options { profile: kind, ..Options::default() };
        let plan = format_compare::plan_for(&problem, formats[0].as_ref(), &options).expect("a plan");
        let run = formats[0].run(&problem, &plan, &options).expect("a run");
        let judged = Reference::new(&problem).expect("a curve").judge(&run.steps);
        let worst = judged.iter().map(|step| step.chord_error_mm).fold(0.0, f64::max);
        assert!(worst <= 1.01 * problem.machine.chord_error_mm, "{kind:?}: {worst} mm");
    }
}

/// A run of the whole path once came to its stops early or late, and cut the corners that came after: after a hundred of
/// them by ten times the chord error.
#[test]
fn each_of_many_stops_is_landed_on() {
    let bulge = |i: usize, x: f64| {
        let side = if i.is_multiple_of(2) { 1.5 } else { -1.5 };
        vec![[x, 0.0], [x + 0.7, side], [x + 1.3, side], [x + 2.0, 0.0]]
    };
    let knots = vec![0.0, 0.0, 0.0, 0.0, 1.0, 1.0, 1.0, 1.0];
    let mut curves = vec![corner()];
    let end = curves[0].control_points()[curves[0].control_points().len() - 1];
    for i in 0..100 {
        let points = bulge(i, 2.0 * i as f64).into_iter().map(|p| [end[0] + p[0], end[1] + p[1].abs()]);
        curves.push(NurbsBuf::try_new_nonrational(3, points.collect(), knots.clone()).expect("a curve"));
    }
    let problem = Problem { curves, ..on_paper_as_machine("bulges", corner()) };
    for name in ["f64", "I4F28"] {
        let format = &format_compare::select::<2>(&[name.to_string()]).expect("a format")[0];
        let options = Options::default();
        let plan = format_compare::plan_for(&problem, format.as_ref(), &options).expect("a plan");
        let stages = plan.schedule().stages();
        let stops: Vec<_> = stages.iter().filter(|s| s.end_feed.value() <= 0.0).collect();
        assert!(stops.len() > 100, "{}", stops.len());
        let run = format.run(&problem, &plan, &options).expect("a run");
        for stop in stops {
            let landed = run.steps.iter().any(|step| {
                let same = (step.curve, step.u.0) == (stop.curve_end, stop.u_end.value());
                let ends_before = step.curve + 1 == stop.curve_end && step.u == (1.0, 0.0);
                same || (ends_before && stop.u_end.value() == 0.0)
            });
            assert!(landed, "{name}: {stop:?}");
        }
        let judged = Reference::new(&problem).expect("a path").judge(&run.steps);
        let worst = judged.iter().map(|step| step.chord_error_mm).fold(0.0, f64::max);
        assert!(worst <= 1.01 * problem.machine.chord_error_mm, "{name}: {worst} mm");
        assert_eq!(run.steps.len() as u64, plan.periods(), "{name}");
    }
}
