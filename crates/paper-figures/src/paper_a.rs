//! Paper A (Wang Yunsen et al.; see `docs/papers.md`): section 3, its table and its pictures.

use format_compare::{Engine, FeedSample, Fluctuation, JudgedStep, Options, Problem, ProfileKind};
use format_report::{Figure, LineChart};
use nurbs_core::Evaluate;

use crate::error::PaperError;
use crate::figures::PaperFigures;
use crate::judged::{Judged, largest, machine, part, problem};
use crate::papers_data::PAPER_A;
use crate::row::{Printed, Row};

const SETTING: &str = "F 200 mm/s, T 3 ms, E 0.5 µm, A 5000 mm/s², J 4e5 mm/s³, Δ = ε = 1e-6, K = 5; f64, cubic transitions, \
                       started at 199.9 mm/s, without the landing";
const OF_LONG_STEPS: &str = "as for the secant; steps of at least a quarter of F T";
const OF_SECANT: &str = "the same order; the paper's first steps are expansions, which are 3.4e-6 off, ours iterations from them; our \
                         extremes are steps of the ramp to rest";
const OF_TAYLOR: &str =
    "no setting gives the printed figure; the printed extremes and mean contradict T = 3 ms";

pub(crate) fn figures() -> Result<PaperFigures, PaperError> {
    let problem = problem(&part("paper A", PAPER_A)?, &machine("paper A", PAPER_A)?)?;
    let run = |engine| {
        let options = Options {
            engine,
            profile: ProfileKind::Cubic,
            end_feeds_mm_per_s: [199.9, 0.0],
            ..Options::default()
        };
        Judged::new(&problem, &options)
    };
    let secant = run(Engine::DeBoorSecant)?;
    let taylors = [run(Engine::DeBoorTaylor1)?, run(Engine::DeBoorTaylor2)?];
    let samples = secant.sampled(&problem)?;
    let solvers = [&secant, &taylors[0], &taylors[1]];

    let mut rows = vec![predictor_row()];
    rows.extend(plan_rows(&samples, &secant.steps));
    rows.extend(table_1(&problem, solvers));
    let mut pictures = vec![curve(&problem)];
    pictures.extend(plan_pictures(&problem, &samples, &secant.steps));
    pictures.extend(fluctuation_pictures(&problem, solvers));
    Ok(PaperFigures { rows, pictures })
}

fn row(place: &'static str, quantity: &str, unit: &'static str, printed: Printed, measured: f64) -> Row {
    Row {
        paper: 'A',
        place,
        quantity: quantity.to_string(),
        unit,
        printed,
        measured,
        setting: SETTING,
        reason: "",
    }
}

/// The coefficient of u_i in (7): (12) to (15) put into (11), in 48ths.
fn predictor_row() -> Row {
    // The share of u_i in T u' at i, i-1, i-2, i-3, twice, and Adams' weights, in 24ths.
    let (twice_of_u_i, weights) = ([2.0, 1.0, 0.0, 0.0], [55.0, -59.0, 37.0, -9.0]);
    let sum: f64 = twice_of_u_i.iter().zip(weights).map(|(share, weight)| share * weight).sum();
    Row {
        setting: "(12) to (15) put into (11), in 48ths",
        reason: "a slip: only with 99 do the coefficients sum to 48",
        ..row("equation (7)", "coefficient of u_i", "", Printed::Number(95.0), 48.0 + sum)
    }
}

/// What figures 6 to 12 show.
fn plan_rows(samples: &[FeedSample], steps: &[JudgedStep]) -> Vec<Row> {
    let most = |of: fn(&FeedSample) -> f64| largest(samples.iter().map(of));
    let local = within(samples, local_times(samples));
    let peak = largest(local.iter().map(|sample| sample.acceleration_mm_per_s2));
    let chord = largest(steps.iter().map(|step| step.chord_error_mm)) * 1000.0;
    let at_most = Printed::AtMost;
    vec![
        row("figure 6", "largest feed", "mm/s", at_most(200.0), most(|one| one.feed_mm_per_s)),
        row(
            "figure 7",
            "largest acceleration",
            "mm/s²",
            at_most(5000.0),
            most(|one| one.acceleration_mm_per_s2),
        ),
        row("figure 8", "largest jerk", "mm/s³", at_most(4e5), most(|one| one.jerk_mm_per_s3)),
        row("figure 9", "largest chord error", "µm", at_most(0.5), chord),
        row(
            "figures 10 to 12",
            "peak acceleration around one bend: A is not reached",
            "mm/s²",
            at_most(5000.0),
            peak,
        ),
    ]
}

/// Table 1, the text on it, and what figures 13 to 15 show.
fn table_1(problem: &Problem<2>, [secant, taylor_1, taylor_2]: [&Judged; 3]) -> Vec<Row> {
    let of_long = |run: &Judged| Fluctuation::of(&run.long_steps(problem), problem.full_step_mm());
    let figures = [secant.fluctuation(problem), of_long(taylor_1), of_long(taylor_2)];
    let printed = [
        ("secant", [3.83e-5, -2.11e-4, 8.79e-7], SETTING, OF_SECANT),
        ("Taylor 1", [1.12, -1.35, 0.11], OF_LONG_STEPS, OF_TAYLOR),
        ("Taylor 2", [0.95, -0.93, 2.08e-4], OF_LONG_STEPS, OF_TAYLOR),
    ];
    let mut rows = Vec::new();
    for ((name, [max, min, mean], setting, reason), ours) in printed.into_iter().zip(figures) {
        for (what, printed, ours) in
            [("max", max, ours.max), ("min", min, ours.min), ("mean |δ|", mean, ours.mean_abs)]
        {
            let quantity = format!("{name}, {what}");
            let plain = row("table 1", &quantity, "%", Printed::Number(printed), ours * 100.0);
            rows.push(Row { setting, reason, ..plain });
        }
    }
    for (of, name, printed, reason) in [
        (1, "mean of Taylor 1 over the secant's", 1e6, "from the table it is 1.3e5"),
        (2, "mean of Taylor 2 over the secant's", 1e3, "from the table it is 237"),
    ] {
        let times = figures[of].mean_abs / figures[0].mean_abs;
        rows.push(Row { reason, ..row("text on table 1", name, "", Printed::Number(printed), times) });
    }
    let above = |steps: &[JudgedStep], least: f64| {
        steps.iter().filter(|step| step.fluctuation().abs() > least).count() as f64
    };
    rows.push(Row {
        reason: "the printed one is a start step of the expansion; ours are iterated",
        ..row(
            "figure 13",
            "steps of the secant above 1e-6",
            "",
            Printed::Number(1.0),
            above(secant.without_landing(), 1e-6),
        )
    });
    let most = 100.0 * figures[1].max.max(-figures[1].min);
    let (setting, reason) = (OF_LONG_STEPS, OF_TAYLOR);
    rows.push(Row {
        setting,
        reason,
        ..row("figure 14", "largest |δ| of Taylor 1", "%", Printed::Number(1.0), most)
    });
    let few = above(&taylor_2.long_steps(problem), 5e-3);
    rows.push(Row {
        setting,
        reason,
        ..row("figure 15", "steps of Taylor 2 above 0.5 %", "", Printed::Words("few"), few)
    });
    rows
}

/// Figure 5.
fn curve(problem: &Problem<2>) -> Figure {
    let curve = problem.curves.first();
    let at = |curve: &nurbs_core::NurbsBuf<f64, 2>, k: u32| curve.as_curve().point(f64::from(k) / 600.0);
    let points = curve.map(|curve| (0..=600).map(|k| at(curve, k).into()).collect()).unwrap_or_default();
    let control = curve.map(|curve| curve.control_points().iter().map(|point| (*point).into()).collect());
    LineChart::new(["x [mm]", "y [mm]"])
        .of_plane()
        .line("curve", points)
        .line("control polygon", control.unwrap_or_default())
        .drawn()
        .named(
            "a-05-curve",
            "Paper A, figure 5: the curve",
            "The NURBS curve of section 3 with its control polygon.",
        )
}

/// Figures 6 to 12.
fn plan_pictures(problem: &Problem<2>, samples: &[FeedSample], steps: &[JudgedStep]) -> Vec<Figure> {
    let local = within(samples, local_times(samples));
    let chord: Vec<(f64, f64)> =
        over_time(problem, steps.iter().map(|step| step.chord_error_mm * 1000.0)).collect();
    let feed = |samples: &[FeedSample]| over(samples, |one| one.feed_mm_per_s);
    let acceleration = |samples: &[FeedSample]| over(samples, |one| one.acceleration_mm_per_s2);
    let jerk = |samples: &[FeedSample]| over(samples, |one| one.jerk_mm_per_s3);
    let chart = |label: &str, points| LineChart::new(["time [s]", label]).line("planned", points);
    let (feed_label, acceleration_label, jerk_label) =
        ("feed [mm/s]", "acceleration [mm/s²]", "jerk [mm/s³]");
    let within_a = |chart: LineChart| chart.limit(5000.0, "A").limit(-5000.0, "-A");
    let within_j = |chart: LineChart| chart.limit(4e5, "J").limit(-4e5, "-J");
    let told = "The paper starts at F, and so does this plan; it ends at rest, which the paper's does not.";
    let bend = "The slowest place of the curve, between two stretches at F. The paper has one transition on each side; here up to \
                sixteen follow the limit. The acceleration is continuous, the jerk goes in \
                straight lines and steps at the ends of a transition.";
    vec![
        chart(feed_label, feed(samples)).limit(200.0, "F").drawn().named(
            "a-06-feed",
            "Paper A, figure 6: feed",
            told,
        ),
        within_a(chart(acceleration_label, acceleration(samples))).drawn().named(
            "a-07-acceleration",
            "Paper A, figure 7: acceleration",
            told,
        ),
        within_j(chart(jerk_label, jerk(samples))).drawn().named(
            "a-08-jerk",
            "Paper A, figure 8: jerk",
            told,
        ),
        LineChart::new(["time [s]", "chord error [µm]"])
            .line("measured", chord)
            .limit(0.5, "E_max")
            .drawn()
            .named(
                "a-09-chord-error",
                "Paper A, figure 9: chord error",
                "Measured between the curve and the chord of each period.",
            ),
        chart(feed_label, feed(local)).limit(200.0, "F").drawn().named(
            "a-10-feed",
            "Paper A, figure 10: feed around one bend",
            bend,
        ),
        within_a(chart(acceleration_label, acceleration(local))).drawn().named(
            "a-11-acceleration",
            "Paper A, figure 11: acceleration around one bend",
            bend,
        ),
        within_j(chart(jerk_label, jerk(local))).drawn().named(
            "a-12-jerk",
            "Paper A, figure 12: jerk around one bend",
            bend,
        ),
    ]
}

/// Figures 13 to 15.
fn fluctuation_pictures(problem: &Problem<2>, solvers: [&Judged; 3]) -> Vec<Figure> {
    let names = [
        ("a-13-secant", "Paper A, figure 13: fluctuation of the secant"),
        ("a-14-taylor-1", "Paper A, figure 14: fluctuation of Taylor 1"),
        ("a-15-taylor-2", "Paper A, figure 15: fluctuation of Taylor 2"),
    ];
    let picture = |((name, title), run): ((&str, &str), &Judged)| {
        let is_long = |step: &&JudgedStep| step.wanted_mm >= 0.25 * problem.full_step_mm();
        let steps = run.without_landing().iter().take_while(is_long).map(|step| step.fluctuation() * 100.0);
        LineChart::new(["time [s]", "fluctuation δ [%]"])
            .line("measured", over_time(problem, steps).collect())
            .drawn()
            .named(
                name,
                title,
                "Each step is judged by exact points at its parameters. The ramp to rest ends at a quarter of F T.",
            )
    };
    names.into_iter().zip(solvers).map(picture).collect()
}

fn over(samples: &[FeedSample], of: fn(&FeedSample) -> f64) -> Vec<(f64, f64)> {
    samples.iter().map(|sample| (sample.time_s, of(sample))).collect()
}

fn over_time(problem: &Problem<2>, values: impl Iterator<Item = f64>) -> impl Iterator<Item = (f64, f64)> {
    let period = problem.period_s();
    values.enumerate().map(move |(index, value)| ((index + 1) as f64 * period, value))
}

/// The times, in s, of one slow place with a little of the stretches at F beside it: from the first quarter of the curve to its
/// middle.
fn local_times(samples: &[FeedSample]) -> (f64, f64) {
    let at = |u: f64| samples.iter().find(|sample| sample.u >= u).map_or(0.0, |sample| sample.time_s);
    (at(0.2), at(0.4))
}

fn within(samples: &[FeedSample], (from, to): (f64, f64)) -> &[FeedSample] {
    let first = samples.partition_point(|sample| sample.time_s < from);
    let end = samples.partition_point(|sample| sample.time_s <= to);
    samples.get(first..end).unwrap_or_default()
}
