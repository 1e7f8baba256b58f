//! Runs with feed override land on the end of the path, and on every stop where sections are run one by one, within the jerk limit.

use feed_plan::{EndFeeds, FeedLimit, KinematicLimits, ProfileKind, ScheduleBuf, plan_with};
use nurbs_core::NurbsBuf;
use proptest::prelude::*;
use real::{Backend, I8F24, I16F48};
use secant_interp::{FeedOverride, OverrideState, Rate};

/// Lines, and parabolas that turn by a right angle over `size` mm, with a stop behind each thirtieth curve, where the path turns
/// back.
fn path(size: f64) -> (Vec<NurbsBuf<f64, 2>>, Vec<usize>) {
    let (mut from, mut angle, mut curves, mut stops) = ([0.0, 0.0], 0.0_f64, Vec::new(), Vec::new());
    for index in 0..120_u32 {
        let onward = |from: [f64; 2], angle: f64, length: f64| {
            [from[0] + length * angle.cos(), from[1] + length * angle.sin()]
        };
        let turn = if index % 4 == 1 { 1.6 } else { -1.4 };
        let length = size * (1.0 + 0.3 * f64::from(index % 5));
        let to = onward(from, angle, length);
        let points = if index % 2 == 1 {
            angle += turn;
            vec![from, to, onward(to, angle, length)]
        } else {
            vec![from, to]
        };
        let degree = points.len() - 1;
        from = points[degree];
        let knots = [vec![0.0; degree + 1], vec![1.0; degree + 1]].concat();
        curves.push(NurbsBuf::try_new_nonrational(degree, points, knots).unwrap());
        if index % 30 == 29 && index < 119 {
            angle += 2.5;
            stops.push(curves.len());
        }
    }
    (curves, stops)
}

fn limits(period: f64, share: f64) -> KinematicLimits<f64> {
    KinematicLimits {
        interpolation_period: 1.0,
        feedrate: 150.0 * period,
        acceleration: share * 4000.0 * period.powi(2),
        jerk: share * 3e4 * period.powi(3),
        chord_error: 0.002,
        centripetal_acceleration: None,
        axes: Default::default(),
        junction: Default::default(),
    }
}

/// A path with its plan, and what an override may do with it.
struct Job {
    curves: Vec<NurbsBuf<f64, 2>>,
    plan: ScheduleBuf<f64>,
    machine: KinematicLimits<f64>,
    feeds: FeedOverride,
}

impl Job {
    fn new(size: f64, period: f64, kind: ProfileKind) -> Self {
        let (curves, stops) = path(size);
        let (machine, kept) = (limits(period, 1.0), limits(period, 0.8));
        let whole: Vec<_> = curves.iter().map(NurbsBuf::as_curve).collect();
        let limit = FeedLimit::along_with_stops(&whole, &kept, &stops).unwrap();
        let arcs = plan_with(&limit, &kept, EndFeeds::default(), kind).unwrap();
        let plan = limit.in_chords(&whole, &arcs);
        let feeds = crate::landing_run::overrides(&plan, &machine);
        Self { curves, plan, machine, feeds }
    }

    /// The largest third difference of the distance over J T³, over all sections together, with where that is. Targets
    /// are numbers of periods and rates, the last one for as long as it takes.
    fn jerk<R: Backend>(&self, targets: &[(usize, f64)]) -> (f64, String) {
        let curves: Vec<_> = self.curves.iter().map(NurbsBuf::as_curve).collect();
        let path = crate::landing_run::compiled::<R>(&curves, &self.plan, &self.machine);
        let mut rates = OverrideState::at(Rate::of(targets[0].1));
        let changes: Vec<usize> = targets
            .iter()
            .scan(0, |at, (periods, _)| {
                let from = *at;
                *at += periods;
                Some(from)
            })
            .collect();
        let (mut steps, mut period) = (vec![0.0, 0.0], 0);
        for (number, (section, run)) in path.sections().iter().zip(path.runs()).enumerate() {
            let places = &path.table().places()[section.pieces.clone()];
            let (mut state, mut at) = (run.start(), (0_usize, 0_u64));
            loop {
                if let Some(change) = changes.iter().position(|from| *from == period) {
                    rates.set(Rate::of(targets[change].1));
                }
                let Some(setpoint) = run.step_overridden(&mut state, &self.feeds, &mut rates) else { break };
                let to = (setpoint.piece, setpoint.phase);
                assert!(at <= to, "{} goes back from {at:?} to {to:?}", R::name());
                let [a, b] = [at, to].map(|at| crate::landing_run::point(&curves, places, at));
                steps.push((b[0] - a[0]).hypot(b[1] - a[1]));
                (at, period) = (to, period + 1);
                assert!(steps.len() < 200_000, "{} does not end", R::name());
            }
            assert_eq!(at, (places.len(), 0), "{}: section {number} does not end on its stop", R::name());
        }
        steps.extend([0.0, 0.0]);
        let jerks = steps.windows(3).map(|w| (w[2] - 2.0 * w[1] + w[0]).abs() / self.machine.jerk);
        let (step, found) =
            jerks.enumerate().fold((0, 0.0), |most, one| if one.1 > most.1 { one } else { most });
        (found, format!("{}: {found} J in step {step} of {}", R::name(), steps.len() - 4))
    }
}

/// The run was behind its plan at the end, and one period took that back with up to 427 times the jerk limit.
#[test]
fn a_slower_run_comes_to_rest_at_every_end_within_the_jerk() {
    for period in [0.5e-3, 1e-3, 2e-3, 4e-3] {
        for kind in ProfileKind::ALL {
            let job = Job::new(4.0, period, kind);
            for targets in [
                &[(0, 0.3)][..],
                &[(0, 0.5)],
                &[(0, 0.8)],
                &[(0, 1.0)],
                &[(150, 1.0), (150, 0.4), (90, 0.0), (1, 0.7)],
            ] {
                let (found, at) = job.jerk::<f64>(targets);
                assert!(found <= 1.05, "{period}, {kind:?}, {targets:?}: {at}");
            }
        }
    }
}

proptest! {
    #![proptest_config(ProptestConfig::with_cases(24))]

    /// Whatever is asked for, in floats and in the coarser format of each width, whose rounding is the larger. The coarse ones add their rounding: places on a piece of 32 mm, and in
    /// I8F24 chords, are known to 2⁻²⁴ of it.
    #[test]
    fn whatever_is_asked_for_the_run_lands_within_the_jerk(
        targets in prop::collection::vec((1_usize..400, prop_oneof![Just(0.0), Just(1.0), 0.05..1.0_f64]), 1..8),
        last in 0.1_f64..1.0, size in 0.5_f64..5.0, period in prop_oneof![Just(0.5e-3), Just(1e-3), Just(2e-3), Just(4e-3)],
    ) {
        let job = Job::new(size, period, ProfileKind::Cubic);
        let targets = [&targets[..], &[(1, last)]].concat();
        for (found, at) in [
            job.jerk::<f64>(&targets), job.jerk::<I16F48>(&targets), job.jerk::<f32>(&targets), job.jerk::<I8F24>(&targets),
        ] {
            prop_assert!(found <= 1.05, "{}", at);
        }
    }
}
