//! Paper C (Wang Haitao et al.; see `docs/papers.md`): its formulas, and its pictures of a run without and with look-ahead.
//!
//! The page of our text with the curve and the setting of section 3 is missing. What the text says of figure 10a tells the limit
//! of acceleration, 1 m/s²; the curve here is paper D's, whose bends are sharp.

use feed_plan::Transition;
use format_compare::{FeedSample, Options, Problem, ProfileKind};
use format_report::{Figure, LineChart};
use nurbs_core::{Differentiate, Evaluate};

use crate::adaptive_feed::{AdaptiveStep, adaptive_feed, taylor_step};
use crate::error::PaperError;
use crate::figures::PaperFigures;
use crate::judged::{Judged, largest, machine, part, problem};
use crate::papers_data::{PAPER_A, PAPER_D};
use crate::row::{Printed, Row};

/// Limits of the runs: acceleration in mm/s², jerk in mm/s³, chord error in µm.
const ACCELERATION: f64 = 1000.0;
const JERK: f64 = 50_000.0;
const CHORD_ERROR_UM: f64 = 1.0;
/// Feed, in mm/s, and period, in ms.
const FEEDRATE: f64 = 100.0;
const PERIOD_MS: f64 = 1.0;

const SETTING: &str = "paper D's curve, F 100 mm/s, T 1 ms, δ 1 µm, A 1000 mm/s², J 5e4 mm/s³";
const OTHER_CURVE: &str =
    "another curve: that of the paper is not in our text; nothing limits this acceleration but the curve";

pub(crate) fn figures() -> Result<PaperFigures, PaperError> {
    let mut limits = machine("paper A", PAPER_A)?;
    limits.acceleration_mm_per_s2 = ACCELERATION;
    limits.jerk_mm_per_s3 = JERK;
    limits.feedrate_mm_per_s = FEEDRATE;
    limits.interpolation_period_ms = PERIOD_MS;
    limits.chord_error_mm = CHORD_ERROR_UM / 1000.0;
    let problem = problem(&part("paper D", PAPER_D)?, &limits)?;
    let curve = problem.curves.first().ok_or("no curve").map_err(PaperError::of("paper C's figures"))?;
    let before = adaptive_feed(curve, FEEDRATE, CHORD_ERROR_UM / 1000.0, problem.period_s());
    let options = Options { profile: ProfileKind::Flexible, ..Options::default() };
    let after = Judged::new(&problem, &options)?;
    let samples = after.sampled(&problem)?;

    let mut rows = formula_rows()?;
    rows.extend(run_rows(&problem, &before, &after, &samples));
    let pictures = pictures(&problem, &before, &after, &samples);
    Ok(PaperFigures { rows, pictures })
}

fn row(place: &'static str, quantity: &str, unit: &'static str, printed: Printed, measured: f64) -> Row {
    Row {
        paper: 'C',
        place,
        quantity: quantity.to_string(),
        unit,
        printed,
        measured,
        setting: SETTING,
        reason: "",
    }
}

/// Equation (2) with both signs, and the half-cosine's (9), (10) and (12) by differences and sums of (6).
fn formula_rows() -> Result<Vec<Row>, PaperError> {
    let of_paper_a = problem(&part("paper A", PAPER_A)?, &machine("paper A", PAPER_A)?)?;
    let curve = of_paper_a.curves.first().ok_or("no curve").map_err(PaperError::of("paper C's (2)"))?;
    let (u, wanted) = (0.26, 0.6);
    let here = curve.as_curve().derivatives(u);
    let off = |sign: f64| {
        let next = curve.as_curve().point(u + taylor_step(here.first, here.second, wanted, sign));
        (1.0 - (next[0] - here.point[0]).hypot(next[1] - here.point[1]) / wanted).abs()
    };
    let setting = "one step of 0.6 mm at u = 0.26 of paper A's curve";
    let mut rows = vec![
        Row {
            setting,
            reason: "the printed sign is wrong",
            ..row(
                "(2), plus as printed",
                "fluctuation of a step",
                "",
                Printed::Words("second order"),
                off(1.0),
            )
        },
        Row {
            setting,
            ..row("(2), minus", "fluctuation of a step", "", Printed::Words("second order"), off(-1.0))
        },
    ];
    // From 20 to 60 mm/s over 10 mm: t = 2 L/(v_i + v_{i+1}) = 0.25 s.
    let (from, to, duration): (f64, f64, f64) = (20.0, 60.0, 0.25);
    let pi = std::f64::consts::PI;
    let feed = |t: f64| from + 0.5 * (to - from) * (1.0 - (pi * t / duration).cos());
    let h = 1e-4;
    let times = || (0..=2500_u32).map(|k| f64::from(k) * h).filter(|t| *t >= h && *t <= duration - h);
    let acceleration = largest(times().map(|t| (feed(t + h) - feed(t - h)) / (2.0 * h)));
    let jerk = largest(times().map(|t| (feed(t + h) - 2.0 * feed(t) + feed(t - h)) / (h * h)));
    let length: f64 = (0..2500_u32).map(|k| feed((f64::from(k) + 0.5) * h) * h).sum();
    let setting = "20 to 60 mm/s in 0.25 s, by differences and sums of (6)";
    let peak = (to - from) * pi / (2.0 * duration);
    rows.push(Row {
        setting,
        ..row("(10)", "peak acceleration", "mm/s²", Printed::Number(peak), acceleration)
    });
    let peak = (to - from) * pi * pi / (2.0 * duration * duration);
    rows.push(Row { setting, ..row("(9)", "peak jerk", "mm/s³", Printed::Number(peak), jerk) });
    rows.push(Row {
        setting,
        ..row(
            "(12)",
            "time over the length of (11)",
            "s",
            Printed::Number(duration),
            2.0 * length / (from + to),
        )
    });
    rows.push(merge_row());
    Ok(rows)
}

/// 2.1: a half-cosine over the length of one S-curve.
fn merge_row() -> Row {
    let feeds = [20.0, 100.0];
    let s_curve = Transition::fastest(ProfileKind::SCurve, feeds, ACCELERATION, JERK);
    let duration = 2.0 * s_curve.length() / (feeds[0] + feeds[1]);
    let (rise, pi) = (feeds[1] - feeds[0], std::f64::consts::PI);
    let over = (rise * pi / (2.0 * duration) / ACCELERATION)
        .max(rise * pi * pi / (2.0 * duration * duration) / JERK);
    Row {
        setting: "20 to 100 mm/s, A 1000 mm/s², J 5e4 mm/s³",
        reason: "over the length of one S-curve a half-cosine always breaks A or J: the plan merges only where both are kept",
        ..row(
            "2.1",
            "half-cosine in place of one S-curve: greatest share of A and J",
            "",
            Printed::AtMost(1.0),
            over,
        )
    }
}

fn run_rows(
    problem: &Problem<2>,
    before: &[AdaptiveStep],
    after: &Judged,
    samples: &[FeedSample],
) -> Vec<Row> {
    let error = |numbers: Vec<f64>| largest(numbers) * 1000.0;
    let adaptive = largest(differences(before, 1, problem.period_s()));
    let most = |of: fn(&FeedSample) -> f64| largest(samples.iter().map(of));
    let at_most = Printed::AtMost;
    vec![
        row(
            "figure 8a",
            "chord error without look-ahead",
            "µm",
            at_most(CHORD_ERROR_UM),
            error(before.iter().map(|step| step.chord_error_mm).collect()),
        ),
        row(
            "figure 8b",
            "chord error with look-ahead",
            "µm",
            at_most(CHORD_ERROR_UM),
            error(after.steps.iter().map(|step| step.chord_error_mm).collect()),
        ),
        Row {
            reason: OTHER_CURVE,
            ..row(
                "figure 10a",
                "acceleration without look-ahead, over A: \"over nine times\"",
                "",
                Printed::Number(10.0),
                adaptive / ACCELERATION,
            )
        },
        row(
            "figure 9b",
            "largest feed with look-ahead",
            "mm/s",
            at_most(FEEDRATE),
            most(|one| one.feed_mm_per_s),
        ),
        row(
            "figure 10b",
            "acceleration with look-ahead",
            "mm/s²",
            at_most(ACCELERATION),
            most(|one| one.acceleration_mm_per_s2),
        ),
        row("figure 11", "jerk with look-ahead", "mm/s³", at_most(JERK), most(|one| one.jerk_mm_per_s3)),
    ]
}

/// The first or second differences of the feed over the period.
fn differences(steps: &[AdaptiveStep], order: usize, period: f64) -> Vec<f64> {
    let mut values: Vec<f64> = steps.iter().map(|step| step.feed_mm_per_s).collect();
    for _ in 0..order {
        values = values.windows(2).map(|pair| (pair[1] - pair[0]) / period).collect();
    }
    values
}

/// Figures 8 to 11; 11 is drawn without look-ahead too.
fn pictures(
    problem: &Problem<2>,
    before: &[AdaptiveStep],
    after: &Judged,
    samples: &[FeedSample],
) -> Vec<Figure> {
    let period = problem.period_s();
    let timed = |values: Vec<f64>| -> Vec<(f64, f64)> {
        values.into_iter().enumerate().map(|(index, value)| ((index + 1) as f64 * period, value)).collect()
    };
    let planned =
        |of: fn(&FeedSample) -> f64| samples.iter().map(|one| (one.time_s, of(one))).collect::<Vec<_>>();
    let chart = |label: &str, before: Vec<f64>, after: Vec<(f64, f64)>| {
        let without = timed(before);
        LineChart::new(["time [s]", label])
            .line("without look-ahead (a)", without)
            .line("with look-ahead (b)", after)
    };
    let told = "Paper D's curve with limits of 1 m/s² and 50 m/s³: the paper's own curve is not in our text.";
    let chords = |steps: Vec<f64>| steps.into_iter().map(|mm| mm * 1000.0).collect::<Vec<_>>();
    let with = chords(after.steps.iter().map(|step| step.chord_error_mm).collect());
    let without = chords(before.iter().map(|step| step.chord_error_mm).collect());
    vec![
        chart("chord error [µm]", without, timed(with)).limit(CHORD_ERROR_UM, "δ").drawn().named(
            "c-08-chord-error",
            "Paper C, figure 8: chord error",
            told,
        ),
        chart("feed [mm/s]", differences(before, 0, period), planned(|one| one.feed_mm_per_s)).drawn().named(
            "c-09-feed",
            "Paper C, figure 9: feed",
            told,
        ),
        chart(
            "acceleration [mm/s²]",
            differences(before, 1, period),
            planned(|one| one.acceleration_mm_per_s2),
        )
        .limit(ACCELERATION, "A")
        .limit(-ACCELERATION, "-A")
        .drawn()
        .named("c-10-acceleration", "Paper C, figure 10: acceleration", told),
        LineChart::new(["time [s]", "jerk [mm/s³]"])
            .line("with look-ahead", planned(|one| one.jerk_mm_per_s3))
            .limit(JERK, "J")
            .limit(-JERK, "-J")
            .drawn()
            .named("c-11-jerk", "Paper C, figure 11: jerk", told),
    ]
}
