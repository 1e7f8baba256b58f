//! Random programs of straight moves, up to a hundred thousand of them, with exact stops now and then. A run takes the periods of
//! its plan from stop to stop, lands on each stop within a landing step, cuts no corner by more than is allowed, and no period
//! depends on what lies before its section. Formats of 16 bits are held to less.

use crate::steps::step;
use feed_plan::{EndFeeds, FeedLimit, Junction, KinematicLimits, ProfileKind, ScheduleBuf, plan_with};
use nurbs_core::{Joint, NurbsBuf, distance_to_segment};
use proptest::prelude::*;
use real::{Audited, Backend, FixedPoint, I4F28, I8F24, Real, RuntimeFixed, RuntimeFormat};

/// What a corner may be cut by, over the larger of chord error and deviation.
const CUT: f64 = 1.05;

/// By so many units of a format's resolution, for each period, a section may end late: none in formats of 24 fraction bits.
const LATE: f64 = 32.0;

struct Program {
    curves: Vec<NurbsBuf<f64, 2>>,
    /// Curves that begin at rest.
    stops: Vec<usize>,
}

/// So many moves of 0.02 to 20 mm, every fiftieth or so behind an exact stop.
fn program(seed: u64, moves: usize) -> Program {
    let mut state = seed;
    let mut number = || {
        state = state.wrapping_mul(6_364_136_223_846_793_005).wrapping_add(1_442_695_040_888_963_407);
        (state >> 11) as f64 * 0.5_f64.powi(53)
    };
    let (mut from, mut angle) = ([0.0, 0.0], 0.0_f64);
    let (mut curves, mut stops) = (Vec::new(), Vec::new());
    for index in 0..moves {
        // Fine moves along a bend, right angles, and any.
        let turn = match number() {
            kind if kind < 0.25 => 0.02,
            kind if kind < 0.5 => 1e-4,
            kind if kind < 0.75 => std::f64::consts::FRAC_PI_2,
            _ => 3.1 * number(),
        };
        angle += if number() < 0.5 { turn } else { -turn };
        let length = 0.02 * 1000.0_f64.powf(number());
        let to = [from[0] + length * angle.cos(), from[1] + length * angle.sin()];
        curves.push(NurbsBuf::try_new_nonrational(1, vec![from, to], vec![0.0, 0.0, 1.0, 1.0]).unwrap());
        if index > 0 && number() < 0.02 {
            stops.push(index);
        }
        from = to;
    }
    Program { curves, stops }
}

fn limits(deviation: f64) -> KinematicLimits<f64> {
    let period = 1e-3_f64;
    KinematicLimits {
        interpolation_period: 1.0,
        feedrate: 50.0 * period,
        acceleration: 1000.0 * period.powi(2),
        jerk: 4e4 * period.powi(3),
        chord_error: 1e-3,
        centripetal_acceleration: None,
        axes: Default::default(),
        junction: Junction::Deviation(deviation),
    }
}

fn planned(program: &Program, limits: &KinematicLimits<f64>) -> ScheduleBuf<f64> {
    let curves: Vec<_> = program.curves.iter().map(NurbsBuf::as_curve).collect();
    let limit = FeedLimit::along_with_stops(&curves, limits, &program.stops).unwrap();
    let arcs = plan_with(&limit, limits, EndFeeds::default(), ProfileKind::Cubic).unwrap();
    limit.in_chords(&curves, &arcs)
}

/// The setpoints of each section, in mm, held to what they promise.
fn sections<R: Backend>(
    program: &Program,
    plan: &ScheduleBuf<f64>,
    limits: &KinematicLimits<f64>,
) -> Vec<Vec<[f64; 2]>> {
    let curves: Vec<_> = program.curves.iter().map(NurbsBuf::as_curve).collect();
    let path = crate::landing_run::compiled::<R>(&curves, plan, limits);
    let unit = 1.0_f64.ldexp(path.table().as_pieces().chord_exponent);
    let Junction::Deviation(deviation) = limits.junction else { unreachable!() };
    let cut_most = CUT * limits.chord_error.max(deviation);
    let (name, resolution) = (R::name(), R::resolution().to_f64());
    let is_coarse = resolution > 1e-6;
    let mut found = Vec::new();
    for (number, (section, run)) in path.sections().iter().zip(path.runs()).enumerate() {
        let places = &path.table().places()[section.pieces.clone()];
        let point = |at: (usize, u64)| crate::landing_run::point(&curves, places, at);
        let (mut state, mut piece, mut from, mut points) = (run.start(), 0, point((0, 0)), Vec::new());
        let mut off = 0.0;
        while let Some(setpoint) = step(&run, &mut state) {
            let to = point((setpoint.piece, setpoint.phase));
            let (mut begin, mut length) = (from, 0.0);
            for passed in piece..setpoint.piece {
                if run.pieces.pieces[passed].joint == Joint::Breaks {
                    let corner = point((passed + 1, 0));
                    let cut = distance_to_segment(&corner, &[from, to]);
                    assert!(
                        cut <= cut_most || is_coarse,
                        "{name}: a corner of section {number} is cut by {cut} mm"
                    );
                    (begin, length) = (corner, length + (corner[0] - begin[0]).hypot(corner[1] - begin[1]));
                }
            }
            length += (to[0] - begin[0]).hypot(to[1] - begin[1]);
            off = (length - setpoint.length.to_f64() / unit).abs();
            (piece, from) = (setpoint.piece, to);
            points.push(to);
        }
        let planned = run.lengths.periods();
        let late = points.len().checked_sub(planned).map(|late| late as f64);
        assert!(
            late.is_some_and(|late| late <= (LATE * resolution * planned as f64).floor()),
            "{name}: section {number} of {planned} periods takes {}",
            points.len()
        );
        assert_eq!(piece, places.len(), "{name}: the end of section {number}");
        // A chord is a whole number of the format's units.
        let most = limits.acceleration + resolution / unit;
        assert!(off <= most, "{name}: section {number} ends {off} mm from where it should, at most {most}");
        found.push(points);
    }
    let periods: usize = found.iter().map(Vec::len).sum();
    assert!(is_coarse || periods as u64 == plan.as_schedule().periods(), "{name}");
    found
}

/// The program from one of its stops on.
fn from_stop(program: &Program, stop: usize) -> Program {
    let first = program.stops[stop];
    let stops = program.stops[stop + 1..].iter().map(|stop| stop - first).collect();
    Program { curves: program.curves[first..].to_vec(), stops }
}

proptest! {
    #![proptest_config(ProptestConfig::with_cases(24))]
    #[test]
    fn a_run_takes_the_periods_of_its_plan_and_keeps_to_corners(
        seed in any::<u64>(), moves in prop_oneof![10_usize..100, 100..1600_usize], deviation in 0.1_f64..10.0,
    ) {
        let program = program(seed, moves);
        let limits = limits(deviation * 1e-3);
        let plan = planned(&program, &limits);
        sections::<f64>(&program, &plan, &limits);
        sections::<I4F28>(&program, &plan, &limits);
        sections::<I8F24>(&program, &plan, &limits);
        sections::<f32>(&program, &plan, &limits);
    }

    #[test]
    fn no_period_depends_on_what_lies_before_its_section(seed in any::<u64>(), moves in 100_usize..400) {
        let whole = program(seed, moves);
        prop_assume!(!whole.stops.is_empty());
        let limits = limits(2e-3);
        let behind = from_stop(&whole, whole.stops.len() / 2);
        let [alone, all] =
            [&behind, &whole].map(|program| sections::<f64>(program, &planned(program, &limits), &limits));
        for (one, other) in alone.iter().rev().zip(all.iter().rev()) {
            prop_assert_eq!(one.len(), other.len());
            for (p, q) in one.iter().zip(other) {
                prop_assert!((p[0] - q[0]).hypot(p[1] - q[1]) < 1e-8, "{:?} {:?}", p, q);
            }
        }
    }
}

/// The run was 82 mm ahead of its plan at the end, and cut corners by 47 µm.
#[test]
fn a_hundred_thousand_moves_are_run_as_planned() {
    let (program, limits) = (program(7, 100_000), limits(1e-3));
    let plan = planned(&program, &limits);
    sections::<f64>(&program, &plan, &limits);
    sections::<I4F28>(&program, &plan, &limits);
    sections::<I8F24>(&program, &plan, &limits);
    sections::<f32>(&program, &plan, &limits);
}

/// Formats of 16 bits lose some units of each period's way, and lag behind their plan by what they lose: they cut corners at other
/// feeds than planned, but end no section early, and none later than that.
#[test]
fn sixteen_bits_end_as_late_as_they_are_coarse() {
    let (program, limits) = (program(7, 20_000), limits(1e-3));
    let plan = planned(&program, &limits);
    sections::<FixedPoint<fixed::types::I8F8>>(&program, &plan, &limits);
    // The type whose runs are compiled for other tests.
    let format = RuntimeFormat::named("I4F12").unwrap();
    format.run::<0, _>(|| sections::<Audited<RuntimeFixed<0>>>(&program, &plan, &limits));
}
