//! Many independent runs on one core: one by one, and side by side in lanes.

use std::hint::black_box;

use feedbits_benches::Path;
use real::{Backend, Lane};
use secant_interp::LaneInterpolator;
use serde_json::json;

use crate::compiled::Compiled;
use crate::race::{Runner, race, report};

/// At how many feeds a path is followed.
const FEEDS: u32 = 16;

/// The same path at several feeds, from four fifths of the full one up: their runs reach joints in other periods.
fn fleet<R: Backend, const D: usize>(path: &Path<D>) -> Vec<Compiled<R, D>> {
    let share = |i: u32| 0.8 + 0.2 * f64::from(i) / f64::from(FEEDS);
    (0..FEEDS).map(|i| Compiled::new(&Path { feed_mm: path.feed_mm * share(i), ..path.clone() })).collect()
}

/// How many runs a lane takes, one after the other.
const LAPS: usize = 4;

/// Helices that are followed beside the curves of every race: names, degrees, and whether they have weights.
pub(crate) const HELICES: [(&str, u32, bool); 4] = [
    ("degree 5", 5, false),
    ("degree 5, rational", 5, true),
    ("degree 7", 7, false),
    ("degree 7, rational", 7, true),
];

/// All runs in lanes, of which each takes the next run where one has ended; the steps of all.
fn side_by_side<R: Lane + Backend, const D: usize, const W: usize>(fleet: &[Compiled<R, D>]) -> f64 {
    let mut waiting = fleet.iter().cycle().take(LAPS * W).map(Compiled::interpolator).skip(W);
    let first = |lane: usize| fleet[lane % fleet.len()].interpolator();
    let mut lanes = LaneInterpolator::<R, D, W>::new(std::array::from_fn(first));
    let mut steps = 0;
    loop {
        let running = lanes.step();
        steps += running;
        black_box(&lanes);
        let mut restarted = 0;
        for lane in (0..W).filter(|_| running < W) {
            if lanes.setpoint(lane).is_none()
                && let Some(run) = waiting.next()
            {
                lanes.restart(lane, run);
                restarted += 1;
            }
        }
        if running + restarted == 0 {
            return steps as f64;
        }
    }
}

/// Runs in W lanes in the format `R`, each to its end.
///
/// # Panics
/// If runs in lanes do not take the steps that they take alone: then they do other work, and their time means nothing.
pub(crate) fn lanes<R: Lane + Backend, const D: usize, const W: usize>(path: &Path<D>) {
    let fleet = fleet::<R, D>(path);
    let runs = || fleet.iter().cycle().take(LAPS * W);
    let one_by_one = || runs().map(Compiled::run).sum::<f64>();
    let units = runs().map(|run| run.follow().0).sum::<u64>();
    // A run whose last stage is cut may stand on its end for a period.
    let held = side_by_side::<R, D, W>(&fleet) - units as f64;
    assert!((0.0..=runs().count() as f64).contains(&held), "{}: {held} more steps in lanes", path.name);
    let mut runners = [
        Runner { name: "one by one".into(), units, run: Box::new(one_by_one) },
        Runner { name: "lanes".into(), units, run: Box::new(|| side_by_side::<R, D, W>(&fleet)) },
    ];
    let about = json!({ "curve": path.name, "format": R::name().to_string(), "lanes": W });
    report("lanes", &about, &race(&mut runners));
}
