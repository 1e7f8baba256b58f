//! Many independent runs: two threads, each with an interpolator of its own, beside one. Lines of JSON for
//! `scripts/benchmarks`, which pins this bench to no core.

mod compiled;
mod race;

use std::thread;

use compiled::Compiled;
use feedbits_benches::thousand_points;
use race::{Runner, race, report};
use real::Backend;
use serde_json::json;

/// How often a thread follows the path: long enough that its start costs nothing.
const LAPS: u32 = 32;

/// Follows each path on a thread of its own; the steps of all.
fn follow_together<R: Backend + Send + Sync>(paths: &[Compiled<R, 3>]) -> f64 {
    let laps = |path: &Compiled<R, 3>| (0..LAPS).map(|_| path.run()).sum::<f64>();
    thread::scope(|scope| {
        let threads: Vec<_> = paths.iter().map(|path| scope.spawn(move || laps(path))).collect();
        threads.into_iter().map(|thread| thread.join().expect("a thread that ends")).sum()
    })
}

/// # Panics
/// If two threads do not take twice the steps of one: then they do other work, and their time means nothing.
fn throughput<R: Backend + Send + Sync>() {
    let path = thousand_points();
    let paths = [Compiled::<R, 3>::new(&path), Compiled::new(&path)];
    let (steps, _) = paths[0].follow();
    let mut runners = [1, 2].map(|threads: usize| {
        let (paths, units) = (&paths[..threads], steps * u64::from(LAPS) * threads as u64);
        assert_eq!(follow_together(paths), units as f64, "steps of {threads} threads");
        Runner { name: threads.to_string(), units, run: Box::new(move || follow_together(paths)) }
    });
    report("throughput", &json!({ "format": R::name().to_string() }), &race(&mut runners));
}

fn main() {
    throughput::<f64>();
    throughput::<f32>();
}
