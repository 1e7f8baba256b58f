//! How planning grows with the path, to a million limit points: stages, time a point, peak memory. Prints a table.
//!
//! `cargo bench -p feedbits-benches --bench planning_growth`

use std::fs;
use std::time::Instant;

use feed_plan::{EndFeeds, FeedLimit, ProfileKind, plan_with};
use feedbits_benches::winding;
use nurbs_core::FastCurve;

/// Spans of the winding that have some 10⁴, 10⁵ and 10⁶ limit points.
const SPANS: [u32; 3] = [2650, 26_500, 265_000];

/// The most memory that the process has had since the last call, in MB, where the system says so.
fn peak_memory() -> Option<f64> {
    let status = fs::read_to_string("/proc/self/status").ok()?;
    let line = status.lines().find(|line| line.starts_with("VmHWM:"))?;
    let kilobytes: f64 = line.split_whitespace().nth(1)?.parse().ok()?;
    fs::write("/proc/self/clear_refs", "5").ok()?;
    Some(kilobytes / 1024.0)
}

fn main() {
    println!("| limit points | profile | stages | ns a point | peak memory of the process, MB |");
    println!("|---|---|---|---|---|");
    for spans in SPANS {
        let path = winding(spans);
        let limits = path.limits();
        let curves = [FastCurve::of(path.curve.as_curve())];
        let limit = FeedLimit::along(&curves, &limits).expect("a limit");
        let points = limit.points().len();
        for (name, kind) in [
            ("fastest", ProfileKind::Fastest),
            ("s-curve", ProfileKind::SCurve),
            ("cubic", ProfileKind::Cubic),
        ] {
            let _ = peak_memory();
            let (mut stages, mut least) = (0, f64::MAX);
            for _ in 0..3 {
                let begin = Instant::now();
                let plan = plan_with(&limit, &limits, EndFeeds::default(), kind).expect("a plan");
                least = least.min(begin.elapsed().as_secs_f64());
                stages = plan.stages().len();
            }
            let memory = peak_memory().map_or_else(|| "unknown".into(), |memory| format!("{memory:.0}"));
            let nanoseconds = least * 1e9 / points as f64;
            println!("| {points} | {name} | {stages} | {nanoseconds:.0} | {memory} |");
        }
    }
}
