//! How long planning takes, by the number of spans: it grows with the path, and stays far below the path's own time.

use criterion::{BenchmarkId, Criterion, Throughput, criterion_group, criterion_main};
use feed_plan::{EndFeeds, FeedLimit, ProfileKind, jerk_free_duration, plan_with};
use feedbits_benches::{PERIOD_S, paper_a, winding};
use nurbs_core::FastCurve;

fn planning(criterion: &mut Criterion) {
    let mut group = criterion.benchmark_group("feed-plan");
    group.sample_size(10);
    let windings = [10, 100, 1000, 10_000].map(|spans| (format!("{spans} spans"), winding(spans)));
    for (what, path) in [("A".to_string(), paper_a())].into_iter().chain(windings) {
        let limits = path.limits();
        let curves = [FastCurve::of(path.curve.as_curve())];
        let limit = FeedLimit::along(&curves, &limits).expect("a limit");
        let own_time = jerk_free_duration(&limit, &limits, EndFeeds::default()) * PERIOD_S;
        println!("{what}: {} limit points, at least {own_time:.2} s of motion", limit.points().len());
        group.throughput(Throughput::Elements(limit.points().len() as u64));
        let limit_of = || FeedLimit::along(&curves, &limits);
        group.bench_function(BenchmarkId::new("limit", &what), |b| b.iter(limit_of));
        for (name, kind) in [
            ("cubic", ProfileKind::Cubic),
            ("s-curve", ProfileKind::SCurve),
            ("trigonometric", ProfileKind::Trigonometric),
            ("flexible", ProfileKind::Flexible),
            ("fastest", ProfileKind::Fastest),
        ] {
            let plan = || plan_with(&limit, &limits, EndFeeds::default(), kind);
            group.bench_function(BenchmarkId::new(name, &what), |b| b.iter(plan));
        }
        let arcs = plan_with(&limit, &limits, EndFeeds::default(), ProfileKind::Fastest).expect("a plan");
        group.bench_function(BenchmarkId::new("in chords", &what), |b| {
            b.iter(|| limit.in_chords(&curves, &arcs))
        });
    }
    group.finish();
}

criterion_group!(benches, planning);
criterion_main!(benches);
