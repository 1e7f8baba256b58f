//! The feed plan: feed, acceleration and jerk over time, and feed under its limit along the path.

use format_compare::FeedSample;

use crate::chart::{Axis, Layout, draw};
use crate::comparison::material::Material;
use crate::figure::{Entry, Figure};

/// Four pictures, or none if each format plans for itself.
pub(crate) fn figures(material: &Material<'_>) -> Vec<Figure> {
    let (plan, machine) = (material.plan, &material.comparison.machine);
    let Some(last) = plan.last() else { return Vec::new() };
    let time = || Axis::linear("time [s]", 0.0..last.time_s);
    let over_time = |figure: &Over<'_>| {
        let points: Vec<_> = plan.iter().map(|sample| (sample.time_s, (figure.of)(sample))).collect();
        let values = points.iter().map(|(_, value)| *value);
        let limits: Vec<f64> =
            if figure.both_signs { vec![figure.limit, -figure.limit] } else { vec![figure.limit] };
        let y = Axis::over(figure.label, values.chain(limits.iter().copied()));
        let drawn = draw((time(), y), &Layout { height: 230, left: 86, ..Layout::default() }, |plot| {
            limits.iter().enumerate().for_each(|(place, limit)| {
                plot.limit(*limit, if place == 0 { figure.limit_name } else { "" });
            });
            plot.group("c0 d0", figure.name, |plot| plot.line(&points));
        });
        drawn.named(figure.name, figure.title, figure.caption).following_the_pointer()
    };
    let feed = Over {
        name: "feed",
        title: "Feed over time",
        caption: "The planned feedrate along the path.",
        label: "feed [mm/s]",
        limit: machine.feedrate_mm_per_s,
        limit_name: "commanded",
        both_signs: false,
        of: |sample| sample.feed_mm_per_s,
    };
    let acceleration = Over {
        name: "acceleration",
        title: "Acceleration over time",
        caption: "Along the path; what the curvature adds across it is bounded by the chord error's limit.",
        label: "acceleration [mm/s²]",
        limit: machine.acceleration_mm_per_s2,
        limit_name: "limit",
        both_signs: true,
        of: |sample| sample.acceleration_mm_per_s2,
    };
    let jerk = Over {
        name: "jerk",
        title: "Jerk over time",
        caption: "Along the path. It steps where a stage begins and ends.",
        label: "jerk [mm/s³]",
        limit: machine.jerk_mm_per_s3,
        limit_name: "limit",
        both_signs: true,
        of: |sample| sample.jerk_mm_per_s3,
    };
    vec![over_time(&feed), over_time(&acceleration), over_time(&jerk), along_the_path(plan)]
}

/// A quantity over time.
struct Over<'a> {
    name: &'a str,
    title: &'a str,
    caption: &'a str,
    label: &'a str,
    limit: f64,
    limit_name: &'a str,
    both_signs: bool,
    of: fn(&FeedSample) -> f64,
}

fn along_the_path(plan: &[FeedSample]) -> Figure {
    let end = plan.last().map_or(0.0, |sample| sample.distance_mm);
    let y = Axis::over(
        "feed [mm/s]",
        plan.iter().flat_map(|sample| [sample.feed_mm_per_s, sample.limit_mm_per_s]),
    );
    let along = |of: fn(&FeedSample) -> f64| -> Vec<(f64, f64)> {
        plan.iter().map(|sample| (sample.distance_mm, of(sample))).collect()
    };
    let figure = draw((Axis::linear("arc length [mm]", 0.0..end), y), &Layout::default(), |plot| {
        plot.group("c1 d1", "limit", |plot| plot.line(&along(|sample| sample.limit_mm_per_s)));
        plot.group("c0 d0", "plan", |plot| plot.line(&along(|sample| sample.feed_mm_per_s)));
    });
    let caption = "Dashed: the feed that curvature, chord error and the commanded feedrate allow. Whole: the plan, which \
                   stays below it within acceleration and jerk.";
    figure
        .named("feed-limit", "Feed limit and plan along the path", caption)
        .following_the_pointer()
        .with_legend(vec![Entry::line("c0 d0", "plan"), Entry::line("c1 d1", "limit")])
}
