#![no_main]

use std::convert::Infallible;

use arbitrary::Unstructured;
use feed_plan::{EndFeeds, FeedLimit, Junction, KinematicLimits, ProfileKind, plan_with};
use feedbits_fuzz::{MOST_PERIODS, expect};
use libfuzzer_sys::fuzz_target;
use nurbs_core::NurbsBuf;
use real::{Backend, I16F16, I32F32};
use stress::{PlannedPath, RandomPath, any_number};

fuzz_target!(|bytes: &[u8]| {
    let mut bytes = Unstructured::new(bytes);
    let Some(path) = RandomPath::<2>::draw(&mut bytes) else { return };
    if let Some(planned) = PlannedPath::new(&path, MOST_PERIODS) {
        expect(planned.check());
    }
    // Any limits, near usual ones and far from them: a plan or a refusal.
    let mut near = |usual: f64| match any_number(&mut bytes) {
        factor if factor.abs() <= 16.0 => usual * factor,
        other => other,
    };
    let usual = path.limits;
    let limits = KinematicLimits {
        interpolation_period: near(1.0),
        feedrate: near(usual.feedrate),
        acceleration: near(usual.acceleration),
        jerk: near(usual.jerk),
        chord_error: near(usual.chord_error),
        ..usual
    };
    let ends = [near(0.0), near(0.0)];
    in_format::<f64>(&path, &limits, ends);
    in_format::<I16F16>(&path, &limits, ends);
    in_format::<I32F32>(&path, &limits, ends);
});

fn in_format<R: Backend>(path: &RandomPath<2>, limits: &KinematicLimits<f64>, ends: [f64; 2]) {
    let number = |x: f64| R::from_f64(x).unwrap_or_else(R::max_value);
    let path_alone = KinematicLimits { axes: Default::default(), junction: Junction::Stop, ..*limits };
    let Ok(limits) = path_alone.try_map(|_, limit| Ok::<_, Infallible>(number(limit)));
    // A step much shorter than the curve makes more limit points than a fuzzer has time for.
    let polygon = path.limits.feedrate * 2000.0;
    let step = limits.feedrate.to_f64() * limits.interpolation_period.to_f64();
    let is_long_enough = step > polygon / 20_000.0;
    if !is_long_enough {
        return assert!(limits.feedrate > R::zero() || limits.validate().is_err());
    }
    let Ok(curves) = path.curves.iter().map(NurbsBuf::convert::<R>).collect::<Result<Vec<_>, _>>() else {
        return;
    };
    let curves: Vec<_> = curves.iter().map(NurbsBuf::as_curve).collect();
    let Ok(limit) = FeedLimit::along(&curves, &limits) else { return };
    let ends = EndFeeds { start: number(ends[0]), end: number(ends[1]) };
    for profile in [path.profile, ProfileKind::Fastest] {
        if let Ok(plan) = plan_with(&limit, &limits, ends, profile) {
            assert!(plan.as_schedule().periods() > 0);
        }
    }
}
