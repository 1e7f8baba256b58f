use nurbs_core::{Differentiate, Evaluate, Frenet, NurbsBuf};
use proptest::prelude::*;

use super::*;
use crate::test_paths::{arcs, circle, hashed, in_periods, paper_limits, polyline, seed_000, seed_003};
use crate::{AxisLimits, EndFeeds, Junction, Planned, ProfileKind, plan_with};

/// The interpolation period of [`paper_limits`], s.
const PERIOD: f64 = 3e-3;

/// Axis limits in mm/s, mm/s², mm/s³.
fn axis(velocity: f64, acceleration: f64, jerk: f64) -> AxisLimits<f64> {
    let t = PERIOD;
    AxisLimits {
        velocity: Some(velocity * t),
        acceleration: Some(acceleration * t * t),
        jerk: Some(jerk * t * t * t),
    }
}

fn with_axes(axes: [AxisLimits<f64>; 3]) -> KinematicLimits<f64> {
    KinematicLimits { axes, ..paper_limits() }
}

/// The limit without reserves, the plan of S-curves under the one with them, and the faster plan.
fn plans<C: Differentiate<f64, D> + Sync, const D: usize>(
    curves: &[C],
    limits: &KinematicLimits<f64>,
) -> (FeedLimit<f64>, ScheduleBuf<f64>, ScheduleBuf<f64>) {
    let reserved = FeedLimit::along(curves, limits).unwrap();
    let today = plan_with(&reserved, limits, EndFeeds::default(), ProfileKind::SCurve).unwrap();
    let limit = FeedLimit::without_reserves(curves, limits, &[]).unwrap();
    let faster = plan_within_axes(curves, limits, &limit, &today).unwrap();
    (limit, today, faster)
}

/// How far apart the curvatures are of which [`worst`] takes the slope, as a share of the span. A bend of a curve that
/// nearly stops may be 1e-5 of a span wide: with curvatures as far apart as that, the slope was 1 % off.
const NEAR: f64 = 2e-7;

/// In the ways that `today` has not: the largest share of what is allowed, of feed, acceleration and jerk of the path and
/// of each axis, ten times a period. The slope of the curvature is a difference of fourth order; where a knot lies
/// within it, there is none.
fn worst<C: Differentiate<f64, D> + Sync, const D: usize>(
    curves: &[C],
    limits: &KinematicLimits<f64>,
    limit: &FeedLimit<f64>,
    [today, plan]: [&ScheduleBuf<f64>; 2],
) -> [f64; 3] {
    let mut worst = [0.0_f64; 3];
    for stage in plan.stages().iter().filter(|stage| !today.stages().contains(stage)) {
        let mut time = 0.0;
        while time <= stage.duration {
            let (v, a, j) = (stage.feed_at(time), stage.acceleration_at(time), stage.jerk_at(time));
            let distance = stage.start + stage.distance_at(time);
            time += 0.1;
            let (curve, u) = limit.parameter_at(distance);
            let shape = &curves[curve];
            let span = (0..shape.span_count())
                .find(|i| (shape.span_bounds(*i).0..=shape.span_bounds(*i).1).contains(&u));
            let Some(span) = span else { continue };
            let (low, high) = shape.span_bounds(span);
            let step = NEAR * (high - low);
            let at = |u: f64| Frenet::of(&shape.derivatives_in(span, u));
            let most = limit.at(distance).max(limit.at(distance - 1e-9)).max(limit.at(distance + 1e-9));
            if v > 0.0 {
                worst[0] = worst[0].max(v / most);
            }
            worst[1] = worst[1].max(a.abs() / limits.acceleration);
            worst[2] = worst[2].max(j.abs() / limits.jerk);
            if u - 2.0 * step < low || u + 2.0 * step > high {
                continue;
            }
            let (e, speed) = (at(u).tangent, at(u).speed);
            let Some(k) = at(u).curvature_vector() else { continue };
            let near = [-2.0, -1.0, 1.0, 2.0].map(|far| at(u + far * step).curvature_vector().unwrap());
            for i in 0..D {
                let c = (8.0 * (near[2][i] - near[1][i]) - (near[3][i] - near[0][i])) / (12.0 * step * speed);
                let taken =
                    [e[i] * v, e[i] * a + k[i] * v * v, e[i] * j + 3.0 * k[i] * v * a + c * v * v * v];
                let axis = limits.axes[i];
                for (kind, most) in [axis.velocity, axis.acceleration, axis.jerk].into_iter().enumerate() {
                    worst[kind] = most.map_or(worst[kind], |most| worst[kind].max(taken[kind].abs() / most));
                }
            }
        }
    }
    worst
}

/// What [`plan_within_axes`] promises.
fn assert_kept<C: Differentiate<f64, D> + Sync, const D: usize>(
    curves: &[C],
    limits: &KinematicLimits<f64>,
) -> f64 {
    let (limit, today, faster) = plans(curves, limits);
    let worst = worst(curves, limits, &limit, [&today, &faster]);
    assert!(worst.iter().all(|worst| *worst <= 1.0 + 1e-6), "{worst:?} {limits:?}");
    let (schedule, before) = (faster.as_schedule(), today.as_schedule());
    assert!(schedule.periods() <= before.periods(), "{} {}", schedule.periods(), before.periods());
    let length = limit.length();
    assert!((schedule.length() - length).abs() <= 1e-9 * length, "{} {length}", schedule.length());
    assert!((schedule.duration() - schedule.periods() as f64).abs() <= 1e-9 * schedule.duration());
    for pair in faster.stages().windows(2) {
        let jump = (pair[0].start + pair[0].length - pair[1].start).abs();
        assert!(jump <= 1e-9 * length, "{jump}");
        assert!((pair[0].end_feed - pair[1].start_feed).abs() <= 1e-9, "{pair:?}");
    }
    for stage in faster.stages() {
        assert!(stage.duration > 0.0 && stage.length > 0.0, "{stage:?}");
        let travelled = stage.distance_at(stage.duration);
        assert!((travelled - stage.length).abs() <= 1e-9 * (1.0 + stage.length), "{stage:?} {travelled}");
    }
    let mut cursor = schedule.start();
    let mut travelled = 0.0;
    while let Some(step) = schedule.advance(&mut cursor) {
        travelled += step;
    }
    assert!((travelled - length).abs() <= 1e-9 * length, "{travelled} {length}");
    schedule.duration() / before.duration()
}

/// The cases of the papers' curves: name, curve, limits.
fn cases() -> Vec<(&'static str, NurbsBuf<f64, 2>, KinematicLimits<f64>)> {
    let none = AxisLimits::default();
    let (generous, weak) = (axis(200.0, 5000.0, 4e5), axis(100.0, 1000.0, 4e4));
    let (x, y) = (axis(150.0, 3000.0, 2e5), axis(200.0, 4000.0, 3e5));
    let (slow, soft) = (axis(200.0, 1500.0, 4e5), axis(200.0, 5000.0, 6e4));
    let idle = axis(10.0, 50.0, 500.0);
    [
        ("seed-000 with axes", seed_000(), [axis(120.0, 2000.0, 1e5), axis(150.0, 3000.0, 2e5), none]),
        ("seed-000, equal generous axes", seed_000(), [generous, generous, none]),
        ("seed-000, one weak axis", seed_000(), [generous, weak, none]),
        ("seed-003 with axes", seed_003(), [x, y, none]),
        ("seed-003, acceleration binds", seed_003(), [slow, slow, none]),
        ("seed-003, jerk binds", seed_003(), [soft, soft, none]),
        ("seed-003, an idle weak Z", seed_003(), [x, y, idle]),
        ("circle R10", circle(10.0), [generous, generous, none]),
        ("circle R10, unequal", circle(10.0), [generous, axis(200.0, 3000.0, 1e5), none]),
    ]
    .map(|(name, curve, axes)| (name, curve, with_axes(axes)))
    .into()
}

/// Time of the pieces, stretched so that all limits hold, above the time of the program on a grid four times as fine; its time
/// against that of today's plan. `None` if that rests on the way.
fn above_the_least(curve: &NurbsBuf<f64, 2>, limits: &KinematicLimits<f64>) -> Option<(f64, f64, Effort)> {
    let curves = [curve.as_curve()];
    let (limit, today, _) = plans(&curves, limits);
    if today.as_schedule().sections().count() > 1 {
        return None;
    }
    let geometry = Geometry::new(&curves, &limit).unwrap();
    let way = Way::new(&geometry, limits, (0.0, limit.length())).unwrap();
    let before = today.as_schedule().duration();
    let (pieces, effort) = solve(&way, (before, f64::MAX), CELL).unwrap();
    let (_, fine) = solve(&way, (before, f64::MAX), CELL / 4.0).unwrap();
    Some((duration(&pieces) / fine.time - 1.0, before / fine.time - 1.0, effort))
}

/// Far from the path's start a look beside a rest was rounded onto it, where the limit is 0: the way kept its slower plan.
#[test]
fn a_way_takes_as_long_wherever_it_begins() {
    let y = AxisLimits { velocity: None, ..axis(0.0, 1500.0, 6e4) };
    let limits = with_axes([axis(200.0, 2000.0, 8e4), y, AxisLimits::default()]);
    let periods = |before: f64| {
        let points = vec![[before, 0.0], [before, 9.0], [before + 7.0, 11.0], [before + 20.0, 4.0]];
        let bend = NurbsBuf::try_new_nonrational(3, points, vec![0., 0., 0., 0., 1., 1., 1., 1.]).unwrap();
        let line = polyline(&[[0.0, 0.0], [before, 0.0]]).remove(0);
        let (_, today, faster) = plans(&[line.as_curve(), bend.as_curve()], &limits);
        let of = |plan: &ScheduleBuf<f64>| plan.as_schedule().sections().last().unwrap().duration();
        (of(&today), of(&faster))
    };
    let (slow, fast) = periods(1.0);
    assert!(fast < slow - 1.0, "{fast} {slow}");
    for number in 1..=12 {
        let before = 137.311 * f64::from(number);
        let (_, found) = periods(before);
        assert!((found - fast).abs() < 1.01, "{before}: {found} for {fast}, {slow} today");
    }
}

#[test]
fn the_papers_curves_take_hardly_longer_than_the_least_time() {
    let mut sum = 0.0;
    for (name, curve, limits) in cases() {
        let (above, before, effort) = above_the_least(&curve, &limits).unwrap();
        println!("{name}: {:.2} %, before {:.1} %, {effort:?}", 100.0 * above, 100.0 * before);
        assert!((-1e-3..5e-3).contains(&above), "{name}: {above} {effort:?}");
        assert!(effort.iterations.iter().all(|count| *count <= 3 * ITERATIONS), "{name}: {effort:?}");
        assert!(effort.nodes < 3000 && effort.stretch < 1.002, "{name}: {effort:?}");
        sum += above;
    }
    assert!(sum / 9.0 < 2e-3, "{}", sum / 9.0);
}

#[test]
fn the_papers_curves_keep_every_limit() {
    for (name, curve, limits) in cases() {
        let curves = [curve.as_curve()];
        let ratio = assert_kept(&curves, &limits);
        println!("{name}: {ratio}");
        let (limit, _, plan) = plans(&curves, &limits);
        let chords = limit.in_chords(&curves, &plan);
        let [arcs, chords] = [&plan, &chords].map(ScheduleBuf::as_schedule);
        assert_eq!(chords.periods(), arcs.periods(), "{name}");
        assert!(chords.length() <= arcs.length() && chords.length() > 0.999 * arcs.length(), "{name}");
    }
}

/// An idle axis took 76 % of the time more: half of its jerk was kept.
#[test]
fn an_axis_that_stands_still_costs_nothing() {
    let idle = axis(10.0, 50.0, 500.0);
    let moving = [axis(150.0, 3000.0, 2e5), axis(200.0, 4000.0, 3e5)];
    let periods = |z: AxisLimits<f64>| {
        let curve = seed_003();
        let (_, _, plan) = plans(&[curve.as_curve()], &with_axes([moving[0], moving[1], z]));
        plan.as_schedule().periods()
    };
    assert_eq!(periods(idle), periods(AxisLimits::default()));
}

/// Where arcs meet, the curvature steps, and each axis's acceleration by no more than its jerk times the period.
#[test]
fn steps_of_curvature_are_passed_within_the_jerk_of_the_axes() {
    let curves = arcs([(10.0, 1.5), (4.0, 1.0), (25.0, 0.5), (6.0, 2.0)]);
    let jerk = 1e5;
    let limits = with_axes([axis(200.0, 3000.0, jerk), axis(150.0, 2000.0, jerk), AxisLimits::default()]);
    assert_kept(&curves, &limits);
    let (limit, _, plan) = plans(&curves, &limits);
    for (i, pair) in curves.windows(2).enumerate() {
        let end = limit.points().filter(|point| point.curve == i).last().unwrap().distance;
        let stage = plan.stages().iter().find(|stage| stage.start + stage.length > end - 1e-6).unwrap();
        let feed = if stage.start > end - 1e-6 { stage.start_feed } else { stage.end_feed };
        let bend = |u: f64, at: usize| Frenet::of(&pair[at].derivatives(u)).curvature_vector().unwrap();
        let (before, after) = (bend(pair[0].domain().1, 0), bend(pair[1].domain().0, 1));
        let most = jerk * PERIOD * PERIOD * PERIOD;
        for i in 0..2 {
            let step = (after[i] - before[i]).abs() * feed * feed;
            assert!(step <= most * (1.0 + 1e-6), "{end} of {}: {step} {most}", limit.length());
        }
    }
}

/// Straight lines keep the plan that they have.
#[test]
fn what_does_not_bend_keeps_its_plan() {
    let lines = polyline(&[[0.0, 0.0], [10.0, 3.0], [14.0, 30.0]]);
    let lines: Vec<_> = lines.iter().map(NurbsBuf::as_curve).collect();
    for axes in [with_axes([axis(100.0, 1000.0, 1e5); 3]), paper_limits()] {
        let (_, today, faster) = plans(&lines, &axes);
        assert!(today == faster);
    }
}

/// Near minima of the limit, at which the accelerations depend on each other, made a plan of S-curves alone. `Planned::fastest` keeps the
/// limits of the path and takes less time.
#[test]
fn without_limits_of_axes_a_curve_of_near_minima_is_planned_faster() {
    let mut points = vec![[0.0, 0.0]];
    for i in 0..40_u64 {
        let share = |bits: u32| f64::from(hashed(i) >> bits & 0xff) / 256.0;
        let [x, y] = points[points.len() - 1];
        points.push([x + 2.0 + 6.0 * share(0), y + 10.0 * (share(8) - 0.5)]);
    }
    let count = points.len();
    let inner = (1..count - 3).map(|knot| knot as f64);
    let knots = [0.0; 4].into_iter().chain(inner).chain([(count - 3) as f64; 4]).collect();
    let curve = NurbsBuf::try_new_nonrational(3, points, knots).unwrap();
    let curves = [curve.as_curve()];
    let mut saved = 0;
    for jerk in [5e3, 1e4, 2e4] {
        let limits = in_periods(1e-3, 300.0, 3000.0, jerk, 1e-3);
        let limit = FeedLimit::along(&curves, &limits).unwrap();
        let planned =
            |kind| Planned::under(limit.clone(), &curves, &limits, EndFeeds::default(), kind).unwrap();
        let [quick, slow] = [ProfileKind::Fastest, ProfileKind::SCurve].map(planned);
        let fastest = Planned::fastest(limit.clone(), &curves, &limits, EndFeeds::default()).unwrap();
        let periods = |planned: &Planned<f64>| planned.arcs.as_schedule().periods();
        assert!(periods(&quick) <= periods(&slow), "{} {}", periods(&quick), periods(&slow));
        // A run that keeps the path's jerk goes before one that takes a few periods less.
        assert!(periods(&fastest) <= periods(&quick) + 8, "{} {}", periods(&fastest), periods(&quick));
        saved += periods(&quick).saturating_sub(periods(&fastest));
        for stage in fastest.arcs.stages() {
            let piece = stage.piece();
            assert!(piece.peak_acceleration().abs() <= limits.acceleration * (1.0 + 1e-9));
            assert!(piece.peak_jerk().abs() <= limits.jerk * (1.0 + 1e-9));
            for k in 0..=20 {
                let time = stage.duration * f64::from(k) / 20.0;
                let most = limit.at(stage.start + stage.distance_at(time));
                assert!(stage.feed_at(time) <= most * (1.0 + 1e-6) + 1e-9, "{stage:?}");
            }
        }
    }
    assert!(saved > 10, "{saved} periods");
}

/// A slow path is at its feed nearly everywhere: its plan cannot be beaten, and no program is solved for it. Where acceleration
/// binds in the bends a plan can be, and is. The way between two rests is bounded as if it were alone.
#[test]
fn a_way_is_tried_only_where_fewer_periods_may_do() {
    let strong = [axis(200.0, 5000.0, 4e5), axis(200.0, 5000.0, 4e5), AxisLimits::default()];
    let slow = KinematicLimits { feedrate: 0.001, ..with_axes(strong) };
    let bound = [axis(200.0, 1500.0, 4e5), axis(200.0, 1500.0, 4e5), AxisLimits::default()];
    for (limits, expected) in [(slow, false), (with_axes(bound), true)] {
        let curve = seed_003();
        let (limit, today, faster) = plans(&[curve.as_curve()], &limits);
        let periods = today.as_schedule().periods();
        let way = (0.0, limit.length());
        let found = may_take_less(&limit, &limits, way, u32::try_from(periods).unwrap());
        assert_eq!(found, expected, "{periods}");
        assert_eq!(faster.as_schedule().periods() < periods, expected);
    }
    let lines = polyline(&[[0.0, 0.0], [30.0, 0.0], [30.0, 20.0]]);
    let lines: Vec<_> = lines.iter().map(NurbsBuf::as_curve).collect();
    let limits = paper_limits();
    let limit = FeedLimit::along(&lines, &limits).unwrap();
    let plan = plan_with(&limit, &limits, EndFeeds::default(), ProfileKind::Fastest).unwrap();
    let schedule = plan.as_schedule();
    let ends = [(0.0, 30.0), (30.0, 50.0)];
    assert_eq!(schedule.sections().count(), ends.len());
    for (section, ends) in schedule.sections().zip(ends) {
        let (least, taken) =
            (BoundedWay::between(&limit, &limits, ends).rough_duration(), section.duration());
        assert!(least <= taken && least > 0.97 * taken, "{least} {taken}");
    }
}

/// Two lines of this length and a quarter of a circle between them.
fn slot(length: f64) -> [NurbsBuf<f64, 2>; 3] {
    let line =
        |from, to| NurbsBuf::try_new(1, vec![from, to], vec![1.0; 2], vec![0.0, 0.0, 1.0, 1.0]).unwrap();
    let radius = 5.0;
    let (end, corner, begin) = ([length, 0.0], [length + radius, 0.0], [length + radius, radius]);
    let weights = vec![1.0, 0.5_f64.sqrt(), 1.0];
    let turn = NurbsBuf::try_new(2, vec![end, corner, begin], weights, vec![0.0, 0.0, 0.0, 1.0, 1.0, 1.0]);
    [line([0.0, 0.0], end), turn.unwrap(), line(begin, [begin[0], radius + length])]
}

/// Along a line at its feed nothing changes: a way of ten times the duration takes hardly more cells, and its limits are kept.
#[test]
fn cells_follow_changes_and_not_the_time() {
    let limits = with_axes([axis(200.0, 3000.0, 1e6), axis(150.0, 2000.0, 1e6), AxisLimits::default()]);
    let nodes = [100.0, 1000.0].map(|length| {
        let curves = slot(length);
        let curves: Vec<_> = curves.iter().map(NurbsBuf::as_curve).collect();
        let kept = assert_kept(&curves, &limits);
        assert!(kept < 1.0, "{kept}");
        let (limit, today, _) = plans(&curves, &limits);
        let geometry = Geometry::new(&curves, &limit).unwrap();
        let way = Way::new(&geometry, &limits, (0.0, limit.length())).unwrap();
        let today = today.as_schedule().duration();
        let (pieces, effort) = solve(&way, (today, f64::MAX), CELL).unwrap();
        assert!(duration(&pieces) <= today, "{} {today}", duration(&pieces));
        (effort.nodes, today)
    });
    let [(few, short), (more, long)] = nodes;
    assert!(long > 8.0 * short && more < few + few / 2, "{nodes:?}");
}

fn limited() -> impl Strategy<Value = AxisLimits<f64>> {
    (0.0..1.0_f64, 0.0..2.0_f64, 0.0..2.0_f64).prop_map(|(v, a, j)| {
        let ten_to = |exponent: f64| 10.0_f64.powf(-exponent);
        axis(200.0 * ten_to(v), 5000.0 * ten_to(a), 4e5 * ten_to(j))
    })
}

/// Cubics whose points go forth, of 10 to 100 mm.
fn smooth() -> impl Strategy<Value = NurbsBuf<f64, 2>> {
    let points = prop::collection::vec(prop::array::uniform2(0.0..1.0_f64), 5..13);
    (points, 1.0..2.0_f64).prop_map(|(points, size)| {
        let size = 10.0_f64.powf(size);
        let count = points.len();
        let forth = |(i, [x, y]): (usize, &[f64; 2])| [(0.3 * i as f64 + x) * size, y * size];
        let points = points.iter().enumerate().map(forth).collect();
        let inner = (1..count - 3).map(|knot| knot as f64);
        let knots = [0.0; 4].into_iter().chain(inner).chain([(count - 3) as f64; 4]).collect();
        NurbsBuf::try_new_nonrational(3, points, knots).unwrap()
    })
}

proptest! {
    #![proptest_config(ProptestConfig { max_shrink_iters: 4, ..ProptestConfig::with_cases(16) })]

    #[test]
    fn smooth_curves_keep_every_limit(curve in smooth(), x in limited(), y in limited()) {
        assert_kept(&[curve.as_curve()], &with_axes([x, y, AxisLimits::default()]));
    }

    /// Where limits differ by up to a hundred times, as plans that keep reserves take up to twice the time.
    #[test]
    fn smooth_curves_take_hardly_longer_than_the_least_time(curve in smooth(), x in limited(), y in limited()) {
        let limits = with_axes([x, y, AxisLimits::default()]);
        let Some((above, before, effort)) = above_the_least(&curve, &limits) else { return Err(TestCaseError::reject("no least time")) };
        prop_assert!((-5e-3..3e-2).contains(&above), "{above}, before {before}, {effort:?} {limits:?}");
        prop_assert!(above < before, "{above}, before {before}");
    }

    #[test]
    fn any_curve_keeps_every_limit(
        curve in nurbs_core::generate::curve::<2>(), x in limited(), y in limited(), deviation in prop::option::of(0.001..0.1_f64),
    ) {
        let junction = deviation.map_or(Junction::Stop, Junction::Deviation);
        let limits = KinematicLimits { junction, ..with_axes([x, y, AxisLimits::default()]) };
        let curves = [curve.as_curve()];
        if FeedLimit::along(&curves, &limits)
            .and_then(|limit| plan_with(&limit, &limits, EndFeeds::default(), ProfileKind::SCurve))
            .is_ok_and(|plan| plan.as_schedule().periods() < 2000)
        {
            assert_kept(&curves, &limits);
        }
    }

    #[test]
    fn arcs_keep_every_limit(
        shapes in prop::collection::vec((1.0..50.0_f64, 0.2..3.0_f64), 1..6), x in limited(), y in limited(),
    ) {
        assert_kept(&arcs(shapes), &with_axes([x, y, AxisLimits::default()]));
    }
}
