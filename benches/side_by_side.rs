//! The project beside what a user would pick instead: times from one run, as lines of JSON. `scripts/benchmarks` runs it and
//! renders BENCHMARKS.md.
//!
//! Every race begins with a check that all contestants give the same values.

mod chords;
mod compiled;
mod contestants;
mod degrees;
mod evaluation;
mod newton;
mod race;
mod real_time_step;
mod textbook;

use contestants::Asked;
use feed_plan::{EndFeeds, FeedLimit};
use feedbits_benches::{Path, paper_a, ten_points, thousand_points, winding};
use nurbs_core::FastCurve;
use race::{Runner, race, report};
use serde_json::json;

/// Limit, plan, and the plan by chords of the one by arcs, for each point at which the limit is known.
fn planning(name: &str, path: &Path<2>) {
    let limits = path.limits();
    let curves = [FastCurve::of(path.curve.as_curve())];
    let limit = FeedLimit::along(&curves, &limits).expect("a limit");
    let arcs = feed_plan::plan(&limit, &limits, EndFeeds::default()).expect("a plan");
    let points = limit.points().len() as u64;
    let mut runners = [
        Runner {
            name: "limit".into(),
            units: points,
            run: Box::new(|| {
                FeedLimit::along(&curves, &limits).map_or(0.0, |limit| limit.points().len() as f64)
            }),
        },
        Runner {
            name: "plan".into(),
            units: points,
            run: Box::new(|| {
                feed_plan::plan(&limit, &limits, EndFeeds::default())
                    .map_or(0.0, |plan| plan.as_schedule().stages().len() as f64)
            }),
        },
        Runner {
            name: "in chords".into(),
            units: points,
            run: Box::new(|| limit.in_chords(&curves, &arcs).as_schedule().stages().len() as f64),
        },
    ];
    report("planning", &json!({ "curve": name, "points": points }), &race(&mut runners));
}

/// Runs the tables that the command line names, or all of them.
fn main() {
    let named: Vec<String> = std::env::args().skip(1).filter(|argument| !argument.starts_with('-')).collect();
    let wanted = |table: &str| named.is_empty() || named.iter().any(|name| name == table);
    let (a, b, c) = (paper_a(), ten_points(), thousand_points());
    if wanted("evaluation") {
        for path in [&a.in_space(), &b.in_space(), &c] {
            evaluation::beside_peers(path, Asked::Point);
            evaluation::beside_peers(path, Asked::Derivatives);
        }
    }
    if wanted("evaluation-formats") {
        for path in [&a.in_space(), &b.in_space()] {
            evaluation::in_formats(path, Asked::Point);
            evaluation::in_formats(path, Asked::Derivatives);
        }
    }
    if wanted("degrees") {
        degrees::degrees();
    }
    if wanted("growth") {
        for count in [10, 100, 1000, 10_000, 100_000] {
            evaluation::growth(count);
        }
    }
    if wanted("step") {
        real_time_step::beside_textbook(&a);
        real_time_step::beside_textbook(&b);
        real_time_step::beside_textbook(&c);
    }
    if wanted("newton") {
        real_time_step::beside_newton(&a);
        real_time_step::beside_newton(&b);
        real_time_step::beside_newton(&c);
    }
    if wanted("formats") {
        real_time_step::formats(&a, false);
        real_time_step::formats(&b, true);
        real_time_step::formats(&c, false);
    }
    if wanted("step-growth") {
        real_time_step::growth(&[100, 1000, 10_000, 100_000]);
    }
    if wanted("planning") {
        planning("A", &a);
        for spans in [100, 1000, 10_000] {
            planning(&format!("{spans} spans"), &winding(spans));
        }
    }
}
