//! A run over corners that are passed at a feed comes to rest at every stop by its plan: no step, and none of the seams at stops,
//! takes more than the jerk limit.

use crate::steps::step;
use feed_plan::{EndFeeds, FeedLimit, Junction, KinematicLimits, ProfileKind, ScheduleBuf, plan_with};
use nurbs_core::{Joint, NurbsBuf};
use real::Real;

/// How many curves there are from one stop to the next.
const TO_THE_NEXT_STOP: usize = 12;

/// Numbers from 0 to 1, one after the other, the same each time.
struct Numbers(u64);

impl Numbers {
    fn next(&mut self) -> f64 {
        self.0 = self.0.wrapping_mul(6_364_136_223_846_793_005).wrapping_add(1_442_695_040_888_963_407);
        (self.0 >> 11) as f64 * 0.5_f64.powi(53)
    }
}

/// Lines of 0.1 to 6 mm, each fifth curve a parabola, with turns of up to 160° between them. To a stop it is a millimetre from the
/// corner before: within a few steps, a plan has no room to come to rest as it should.
fn path(count: usize) -> Vec<NurbsBuf<f64, 2>> {
    let (mut numbers, mut from, mut angle) = (Numbers(1), [0.0, 0.0], 0.0_f64);
    let mut curves = Vec::new();
    for index in 0..count {
        // Small ones, right angles, and any.
        let turn = [0.2 * numbers.next(), 90.0_f64.to_radians(), 2.8 * numbers.next()][index % 3];
        angle += if numbers.next() < 0.5 { turn } else { -turn };
        let least = if (index + 1) % TO_THE_NEXT_STOP == 0 { 1.0 } else { 0.1 };
        let length = least + 5.9 * numbers.next().powi(2);
        let onward =
            |from: [f64; 2], angle: f64| [from[0] + length * angle.cos(), from[1] + length * angle.sin()];
        let to = onward(from, angle);
        let (degree, points) =
            if index % 5 == 4 { (2, vec![from, to, onward(to, angle + 0.7)]) } else { (1, vec![from, to]) };
        from = points[degree];
        angle += if degree == 2 { 0.7 } else { 0.0 };
        let knots = [vec![0.0; degree + 1], vec![1.0; degree + 1]].concat();
        curves.push(NurbsBuf::try_new_nonrational(degree, points, knots).unwrap());
    }
    curves
}

/// The largest third difference of the distance over J T³, from rest to rest of each section, with where that is. Steps go from
/// corner to corner.
fn jerk(
    curves: &[NurbsBuf<f64, 2>],
    plan: &ScheduleBuf<f64>,
    limits: &KinematicLimits<f64>,
) -> (f64, String) {
    let curves: Vec<_> = curves.iter().map(NurbsBuf::as_curve).collect();
    let path = crate::landing_run::compiled::<f64>(&curves, plan, limits);
    let unit = 1.0_f64.ldexp(path.table().as_pieces().chord_exponent);
    let mut worst = (0.0_f64, String::new());
    for (number, (section, run)) in path.sections().iter().zip(path.runs()).enumerate() {
        let places = &path.table().places()[section.pieces.clone()];
        let point = |at: (usize, u64)| crate::landing_run::point(&curves, places, at);
        let (mut state, mut piece, mut from, mut steps) = (run.start(), 0, point((0, 0)), vec![0.0, 0.0]);
        while let Some(setpoint) = step(&run, &mut state) {
            let to = point((setpoint.piece, setpoint.phase));
            let leg = |from: [f64; 2], to: [f64; 2]| (to[0] - from[0]).hypot(to[1] - from[1]);
            let mut chord = 0.0;
            for passed in piece..setpoint.piece {
                if run.pieces.pieces[passed].joint == Joint::Breaks {
                    let corner = point((passed + 1, 0));
                    (chord, from) = (chord + leg(from, corner), corner);
                }
            }
            chord += leg(from, to);
            let planned = setpoint.length / unit;
            steps.push(chord);
            let is_last = setpoint.piece == places.len();
            assert!(is_last || (chord / planned - 1.0).abs() < 1e-6, "{chord} for {planned}");
            (piece, from) = (setpoint.piece, to);
        }
        steps.extend([0.0, 0.0]);
        for (index, three) in steps.windows(3).enumerate() {
            let found = (three[2] - 2.0 * three[1] + three[0]).abs() / limits.jerk;
            if found > worst.0 {
                let at = format!("{found} J in step {index} of {} of section {number}", steps.len() - 4);
                worst = (found, at);
            }
        }
    }
    worst
}

fn limits(period: f64, junction: Junction<f64>) -> KinematicLimits<f64> {
    KinematicLimits {
        interpolation_period: 1.0,
        feedrate: 150.0 * period,
        acceleration: 1500.0 * period.powi(2),
        jerk: 3e4 * period.powi(3),
        chord_error: 0.002,
        centripetal_acceleration: None,
        axes: Default::default(),
        junction,
    }
}

/// The last step of every third section took up to 28 times J: a step over a corner took its length as a straight chord, which covers
/// more of the path, and the plan did not know by how much.
#[test]
fn no_step_on_a_path_of_passed_corners_takes_more_than_the_jerk() {
    let curves = path(300);
    let whole: Vec<_> = curves.iter().map(NurbsBuf::as_curve).collect();
    let stops: Vec<_> =
        (1..).map(|stop| stop * TO_THE_NEXT_STOP).take_while(|stop| *stop < whole.len()).collect();
    let deviation = |mm: f64, period: f64| limits(period, Junction::Deviation(mm));
    let jump = |mm_per_s: f64, period: f64| limits(period, Junction::VelocityJump([mm_per_s * period; 3]));
    for limits in [
        deviation(0.02, 0.5e-3),
        deviation(0.05, 1e-3),
        jump(2.0, 1e-3),
        deviation(0.02, 2e-3),
        jump(20.0, 2e-3),
        deviation(0.005, 4e-3),
    ] {
        let limit = FeedLimit::along_with_stops(&whole, &limits, &stops).unwrap();
        // Some of it at a feed at which most corners are passed without slowing down.
        let feeds = [1.0, 0.25, 0.02];
        let feed_of = |curve: usize| limits.feedrate * feeds[curve / TO_THE_NEXT_STOP % feeds.len()];
        let limit = limit.capped(feed_of).unwrap();
        for kind in ProfileKind::ALL {
            let arcs = plan_with(&limit, &limits, EndFeeds::default(), kind).unwrap();
            let (found, at) = jerk(&curves, &limit.in_chords(&whole, &arcs), &limits);
            assert!(found <= 1.05, "{limits:?}, {kind:?}: {at}");
        }
    }
}
