//! Paper A's figures beside ours.

use feedbits_tests::{PAPER_A, problem};
use format_compare::{
    Engine, ExactPlan, Fluctuation, JudgedRun, JudgedStep, Options, ProfileKind, Reference, Verdict, compare,
    formats, select,
};

/// F·T.
const FULL_STEP_MM: f64 = 0.6;

fn options(engine: Engine) -> Options {
    Options { engine, profile: ProfileKind::Cubic, ..Options::default() }
}

/// As Table 1 wants it: at F but for what the plan is stretched by, to a whole number of periods.
fn started_at_the_feed(engine: Engine) -> Options {
    Options { end_feeds_mm_per_s: [199.9, 0.0], ..options(engine) }
}

/// The steps of a run in f64 without the landing, as the reference judges them, and the mean evaluations of a step.
fn steps(options: &Options) -> (Vec<JudgedStep>, f64) {
    let problem = problem::<2>("paper A", PAPER_A);
    let f64_format = &select::<2>(&["f64".to_string()]).expect("f64 is built in")[0];
    let plan = ExactPlan::in_format_with::<f64, 2>(&problem, options.end_feeds_mm_per_s, options.profile)
        .expect("the paper's curve can be planned");
    let run = f64_format.run(&problem, &plan, options).expect("f64 runs it");
    assert!(run.about.finished);
    let mut steps = Reference::new(&problem).expect("the curve is valid").judge(&run.steps);
    let evaluations =
        run.steps.iter().map(|s| f64::from(s.evaluations)).sum::<f64>() / run.steps.len() as f64;
    // Table 1 leaves out the landing: its last step is whatever the curve has left.
    steps.pop();
    (steps, evaluations)
}

fn fluctuation(options: &Options) -> (Fluctuation, f64) {
    let (steps, evaluations) = steps(options);
    (Fluctuation::of(&steps, FULL_STEP_MM), evaluations)
}

/// Table 1, secant, as ratios: max 3.83e-7, min -2.11e-6, mean |δ| 8.79e-9. Ours, started at F, is of that order: the same
/// max, by chance, a third of the min, and a quarter of the mean. Each figure is held within a factor of 2 of what it is.
///
/// The paper's first steps are those of the second-order expansion, which are 3.4e-6 off (the next test): three of them
/// alone are most of the printed mean. Here the expansions are only the start values of the iteration, and the
/// first steps are as good as any. Our extremes are steps of the ramp to rest, which the paper's run does not have.
#[test]
fn the_secant_row_of_table_1_is_of_the_printed_order() {
    let (steps, evaluations) = steps(&started_at_the_feed(Engine::DeBoorSecant));
    let ours = Fluctuation::of(&steps, FULL_STEP_MM);
    println!("secant: {ours:?}, {evaluations:.2} evaluations a step");
    for (what, figure, expected) in
        [("max", ours.max, 3.84e-7), ("min", -ours.min, 7.36e-7), ("mean", ours.mean_abs, 2.21e-9)]
    {
        let band = expected / 2.0..=expected * 2.0;
        assert!(band.contains(&figure), "{what}: {figure:e} is not about {expected:e}");
    }
    assert!((2.0..4.3).contains(&evaluations), "{evaluations}");

    assert!(steps[..3].iter().all(|step| step.fluctuation().abs() < 1e-9), "{:?}", &steps[..3]);
    let worst = (0..steps.len()).max_by(|&i, &j| {
        let size = |index: usize| steps[index].fluctuation().abs();
        size(i).total_cmp(&size(j))
    });
    let last_at_the_feed = steps.iter().rposition(|step| step.wanted_mm > 0.99 * FULL_STEP_MM);
    assert!(worst > last_at_the_feed, "{worst:?} is before the ramp to rest, from {last_at_the_feed:?}");
}

/// What the paper takes for its first steps.
#[test]
fn first_steps_by_expansion_are_off_by_most_of_the_printed_mean() {
    let (steps, _) = steps(&started_at_the_feed(Engine::DeBoorTaylor2));
    let first: Vec<f64> = steps[..3].iter().map(|step| step.fluctuation()).collect();
    assert!(first.iter().all(|delta| (3.0e-6..4.0e-6).contains(delta)), "{first:?}");
    let share = first.iter().sum::<f64>() / steps.len() as f64;
    assert!((0.5..1.0).contains(&(share / 8.79e-9)), "{share:e}");
}

/// The Taylor rows (1.12 / -1.35 / 0.11 % and 0.95 / -0.93 / 2.08e-4 %) contradict T = 3 ms and come out of no setting;
/// what the corrected formulas give stands here, as it does in docs/papers.md.
#[test]
fn the_taylor_rows_of_table_1_are_not_reproduced() {
    let (first, _) = fluctuation(&options(Engine::DeBoorTaylor1));
    let (second, _) = fluctuation(&options(Engine::DeBoorTaylor2));
    println!("taylor 1: {first:?}\ntaylor 2: {second:?}");
    assert!((4e-3..7e-3).contains(&first.cruise_max_abs), "{first:?}");
    assert!((1e-5..1e-4).contains(&second.cruise_max_abs), "{second:?}");
}

#[test]
fn a_tighter_tolerance_beats_the_printed_secant_row() {
    let tight = Options { fluctuation: Some(1e-13), ..options(Engine::DeBoorSecant) };
    let (ours, _) = fluctuation(&tight);
    assert!(ours.cruise_max_abs < 1e-11 && ours.mean_abs < 8.79e-9, "{ours:?}");
}

fn row<'a>(rows: &'a [JudgedRun], format: &str, engine: Engine) -> &'a JudgedRun {
    rows.iter().find(|row| row.format == format && row.engine == engine).expect("the format was compared")
}

/// What compiling buys, format by format; the raw figures are the ones to beat.
#[test]
fn compiled_pieces_reach_the_formats_resolution() {
    let problem = problem::<2>("paper A", PAPER_A);
    let engines = [Engine::DeBoorSecant, Engine::Pieces];
    let comparison = compare(&problem, &formats(), &engines, &Options::default()).expect("it can be planned");
    let cruise = |format: &str, engine| {
        let row = row(&comparison.formats, format, engine);
        row.fluctuation.map(|f| f.cruise_max_abs).unwrap_or_else(|| panic!("{format}: {:?}", row.verdict))
    };
    for (format, limit) in
        [("f64", 1e-12), ("I4F60", 1e-15), ("I4F28", 5e-8), ("I3F29", 5e-8), ("I2F30", 1.1e-8), ("f32", 3e-7)]
    {
        let figure = cruise(format, Engine::Pieces);
        assert!(figure <= limit, "{format}: {figure:.2e} > {limit:.0e}");
    }
    let mean = row(&comparison.formats, "f64", Engine::Pieces).fluctuation.map(|figures| figures.mean_abs);
    assert!(mean.is_some_and(|mean| mean < 1e-9), "the last chord is as long as planned, too: {mean:?}");
    assert!(cruise("f32", Engine::DeBoorSecant) > 1e-5, "the raw problem drowns in f32");
    assert!(cruise("I16F16", Engine::DeBoorSecant) > 1e-3, "the raw problem drowns in I16F16");
    let refused = row(&comparison.formats, "I8F24", Engine::DeBoorSecant);
    assert!(
        matches!(&refused.verdict, Verdict::Refused(why) if why.contains("control point 0")),
        "{:?}",
        refused.verdict
    );
    assert_eq!(comparison.recommended.as_deref(), Some("I8F24"));
    for row in &comparison.formats {
        let most = row.evaluations.map_or(0, |e| e.max);
        assert!(most <= 5 + 3, "{} evaluates {most} times in a period", row.format);
        if row.engine == Engine::Pieces {
            assert_eq!(row.saturations, Some(0), "{} overflows although its ranges are proven", row.format);
        }
    }
}

/// Evaluations a step at the machine file's fluctuation and at a thousandth of it.
#[test]
fn few_evaluations_are_enough() {
    let mean = |fluctuation| fluctuation_and_evaluations(fluctuation);
    let (figure, evaluations) = mean(1e-6);
    assert!(figure <= 1e-6 && evaluations <= 1.01, "{figure:.1e} {evaluations}");
    let (figure, evaluations) = mean(1e-9);
    assert!(figure <= 1e-9 && evaluations <= 2.1, "{figure:.1e} {evaluations}");
}

fn fluctuation_and_evaluations(asked: f64) -> (f64, f64) {
    let (figures, evaluations) =
        fluctuation(&Options { fluctuation: Some(asked), ..options(Engine::Pieces) });
    (figures.cruise_max_abs, evaluations)
}

/// Each format can plan for itself, or follow the plan of any other.
#[test]
fn planning_runs_in_the_format_under_test() {
    let problem = problem::<2>("paper A", PAPER_A);
    let reference = ExactPlan::in_format::<f64, 2>(&problem, [0.0; 2]).expect("f64 plans").periods();
    for name in ["f32", "I32F32", "I16F48"] {
        let format = select::<2>(&[name.to_string()]).expect("built in").remove(0);
        let plan =
            format.plan(&problem, &Options::default()).unwrap_or_else(|error| panic!("{name}: {error}"));
        assert!(
            plan.periods().abs_diff(reference) <= 1 + reference / 500,
            "{name}: {} {reference}",
            plan.periods()
        );
        let run = format
            .run(&problem, &plan, &Options::default())
            .unwrap_or_else(|error| panic!("{name}: {error}"));
        assert!(run.about.finished, "{name}");
    }
}
