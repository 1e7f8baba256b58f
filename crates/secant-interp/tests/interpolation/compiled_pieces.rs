//! What runs on compiled pieces reach, in every kind of format.

use crate::path_run::{Figures, Path, Settings, compiled, interpolator, run, run_in, run_watched, swing};
use crate::steps::{step, step_by, step_by_into};
use expect_test::expect_file;
use nurbs_core::{CompileError, NurbsBuf, PiecesBuf, golden};
use real::{Backend, I3F29, I4F28, I4F60, I8F24, I16F48, Real};
use secant_interp::{FeedOverride, OverrideLimits, OverrideState, PieceInterpolator, PieceSetpoint, Rate};

fn clamped(degree: usize, inner: impl IntoIterator<Item = f64>) -> Vec<f64> {
    let ends = |u: f64| std::iter::repeat_n(u, degree + 1);
    ends(0.0).chain(inner).chain(ends(1.0)).collect()
}

/// A generator of test numbers, so that curves are the same everywhere: SplitMix64.
struct Random(u64);

impl Random {
    /// A number in [low, high).
    fn within(&mut self, low: f64, high: f64) -> f64 {
        self.0 = self.0.wrapping_add(0x9e37_79b9_7f4a_7c15);
        let mut z = self.0;
        z = (z ^ (z >> 30)).wrapping_mul(0xbf58_476d_1ce4_e5b9);
        z = (z ^ (z >> 27)).wrapping_mul(0x94d0_49bb_1331_11eb);
        low + (high - low) * f64::from_phase(z ^ (z >> 31), 0)
    }
}

/// Seven points, 300 mm wide, at 200 mm/s and 3 ms.
fn paper_a() -> Path<2> {
    Path { curves: vec![golden::seed_000()], feed_mm: 0.6 }
}

/// The 10-point rational curve at 50 mm/s and 3 ms.
fn ten_points() -> Path<2> {
    Path { curves: vec![golden::seed_003()], feed_mm: 0.15 }
}

/// A full circle of 20 mm radius: nine points of degree 2.
fn circle() -> Path<2> {
    Path { curves: vec![golden::circle(20.0)], feed_mm: 0.3 }
}

/// Degree 5 in space.
fn quintic() -> Path<3> {
    let mut random = Random(5);
    let points = (0..14).map(|i| {
        let angle = 0.7 * f64::from(i);
        [60.0 * angle.cos(), 60.0 * angle.sin() + random.within(-8.0, 8.0), 6.0 * f64::from(i)]
    });
    let knots = clamped(5, (1..9).map(|i| f64::from(i) / 9.0));
    Path { curves: vec![NurbsBuf::try_new_nonrational(5, points.collect(), knots).unwrap()], feed_mm: 0.4 }
}

/// A rational cubic of twelve points: a wandering line, weights from a half to two.
fn rational(seed: u64) -> Path<2> {
    let mut random = Random(seed);
    let points = (0..12)
        .map(|i| [12.0 * f64::from(i) + random.within(-4.0, 4.0), random.within(-20.0, 20.0)])
        .collect();
    let weights = (0..12).map(|_| random.within(-1.0, 1.0).exp2()).collect();
    let knots =
        clamped(3, (1..9).map(|i| (f64::from(i) + random.within(-0.3, 0.3)) / 9.0).collect::<Vec<_>>());
    Path { curves: vec![NurbsBuf::try_new(3, points, weights, knots).unwrap()], feed_mm: 0.15 }
}

/// A thousand points, 3.5 mm apart, of a wandering space curve, mildly non-uniform, at 200 mm/s and 1 ms.
fn thousand_points() -> Path<3> {
    let mut random = Random(1000);
    let (mut at, mut heading, mut climb) = ([0.0; 3], 0.0_f64, 0.0_f64);
    let (mut turn, mut tilt) = (0.0, 0.0);
    let mut points = Vec::new();
    let mut knots = vec![0.0];
    for _ in 0..1000 {
        points.push(at);
        turn = 0.8 * turn + random.within(-0.15, 0.15);
        tilt = 0.8 * tilt + random.within(-0.05, 0.05) - 0.05 * climb;
        (heading, climb) = (heading + turn, climb + tilt);
        let step = 3.5 * random.within(0.9, 1.1);
        at[0] += step * heading.cos() * climb.cos();
        at[1] += step * heading.sin() * climb.cos();
        at[2] += step * climb.sin();
        knots.push(knots[knots.len() - 1] + random.within(0.9, 1.1));
    }
    let last = knots[997];
    let knots = clamped(3, knots[1..997].iter().map(|u| u / last).collect::<Vec<_>>());
    Path { curves: vec![NurbsBuf::try_new_nonrational(3, points, knots).unwrap()], feed_mm: 0.2 }
}

/// As precise as the format can be.
const FINEST: f64 = 0.0;

fn figures<R: Backend, const D: usize>(path: &Path<D>, piece_mm: f64, fluctuation: f64) -> Figures {
    let settings = Settings { piece_mm, fluctuation, ..Settings::default() };
    run::<R, D>(path, &settings).unwrap_or_else(|refusal| panic!("{}: {refusal}", R::name()))
}

/// The largest fluctuation that each format may leave. A chord L is resolved to half a unit, over which σ and f are
/// two more; at a quarter of the feed that is about twelve units of a format whose chords reach its half range.
fn check_every_format<const D: usize>(name: &str, path: &Path<D>, bounds: &Bounds) {
    for piece_mm in [32.0, 64.0] {
        for (format, bound) in [
            ("f64", bounds.f64),
            ("f32", bounds.f32),
            ("I4F28", bounds.fixed_32),
            ("I3F29", if piece_mm <= 32.0 { bounds.i3f29 } else { bounds.fixed_32 }),
            ("I4F60", bounds.fixed_64),
            // Coarser on purpose: 2⁻²⁴ and 2⁻⁴⁸ where chords reach 4.
            ("I8F24", 16.0 * bounds.fixed_32),
            ("I16F48", 4096.0 * bounds.fixed_64),
        ] {
            let settings = Settings { piece_mm, fluctuation: FINEST, ..Settings::default() };
            let figures =
                run_in(format, path, &settings).unwrap_or_else(|refusal| panic!("{format}: {refusal}"));
            let (cruise, evaluations) = (figures.cruise, figures.evaluations);
            println!("{name:8} {format:7} {piece_mm} mm: {cruise:.1e}, {evaluations:.3} evaluations");
            assert!(cruise <= bound, "{name} {format} {piece_mm} mm: {cruise} > {bound}");
        }
    }
}

/// Bounds of the fluctuation at cruise.
struct Bounds {
    f64: f64,
    f32: f64,
    fixed_32: f64,
    i3f29: f64,
    fixed_64: f64,
}

/// What a curve without weights must reach.
const PLAIN: Bounds = Bounds { f64: 1e-12, f32: 3e-7, fixed_32: 5e-8, i3f29: 1e-8, fixed_64: 1e-15 };
/// Ten times as much with weights.
const RATIONAL: Bounds = Bounds { f64: 1e-11, f32: 3e-6, fixed_32: 5e-7, i3f29: 1e-7, fixed_64: 1e-14 };

#[test]
fn fluctuation_on_paper_a() {
    check_every_format("A", &paper_a(), &PLAIN);
}

#[test]
fn fluctuation_in_space() {
    // Measured: 2.1e-8 and 5.0e-8 with five sweeps of the shift where a cubic has three, 1.2e-8 and 2.3e-8 with a third axis.
    check_every_format("quintic", &quintic(), &Bounds { i3f29: 3e-8, fixed_32: 7e-8, ..PLAIN });
    check_every_format("1000", &thousand_points(), &Bounds { i3f29: 2e-8, ..PLAIN });
}

#[test]
fn fluctuation_on_rational_curves() {
    check_every_format("B", &ten_points(), &RATIONAL);
    check_every_format("circle", &circle(), &RATIONAL);
    for seed in 1..=5 {
        check_every_format("rational", &rational(seed), &RATIONAL);
    }
}

fn check_evaluations<const D: usize>(name: &str, path: &Path<D>, at_1e_6: f64) {
    for (fluctuation, bound) in [(1e-6, at_1e_6), (1e-9, 2.1)] {
        let figures = figures::<f64, D>(path, 32.0, fluctuation);
        println!(
            "{name:8} {fluctuation:.0e}: {:.1e}, {:.3} evaluations",
            figures.cruise, figures.evaluations
        );
        assert!(figures.cruise <= fluctuation, "{name}: {} > {fluctuation}", figures.cruise);
        assert!(figures.evaluations <= bound, "{name} {fluctuation}: {} > {bound}", figures.evaluations);
    }
}

#[test]
fn evaluations_for_a_wanted_fluctuation() {
    check_evaluations("A", &paper_a(), 1.01);
    check_evaluations("B", &ten_points(), 1.25);
    check_evaluations("circle", &circle(), 1.25);
    check_evaluations("quintic", &quintic(), 1.25);
    // Across a knot, every twenty steps, a chord takes two evaluations.
    check_evaluations("1000", &thousand_points(), 1.06);
    for seed in 1..=5 {
        check_evaluations("rational", &rational(seed), 1.25);
    }
}

/// Knots that change nothing of the curve cut it into pieces far shorter than a step, several of which a step crosses.
#[test]
fn inserted_knots_change_nothing() {
    let mut path = paper_a();
    for u in [0.3, 0.300_01, 0.300_011, 0.300_02, 0.500_1, 0.500_2, 0.6, 0.6 + 1e-9, 0.9] {
        path.curves[0] = path.curves[0].insert_knot(u).unwrap();
    }
    let figures = figures::<f64, 2>(&path, 32.0, FINEST);
    assert!(figures.joints > figures.crossings, "{} joints in {} steps", figures.joints, figures.crossings);
    // The control points of insertion are rounded to f64, 300 mm to 3e-14 mm, which a step of 0.15 mm feels as 2e-13;
    // between knots 1e-9 apart it bends the curve.
    check_every_format("knots", &path, &Bounds { fixed_64: 1e-12, ..PLAIN });
}

/// What is left of the fluctuation asked for, at how many evaluations: `cargo test -- --ignored --nocapture`.
#[test]
#[ignore = "prints a table"]
fn table_of_fluctuations() {
    fn rows<const D: usize>(name: &str, path: &Path<D>) {
        for fluctuation in [1e-5, 1e-6, 1e-7, 1e-8, 1e-9, 1e-10, 1e-11, 1e-12, FINEST] {
            let figures = figures::<f64, D>(path, 32.0, fluctuation);
            println!("{name:8} {fluctuation:6.0e} {:8.1e} {:6.3}", figures.cruise, figures.evaluations);
        }
    }
    rows("A", &paper_a());
    rows("B", &ten_points());
    rows("circle", &circle());
    rows("quintic", &quintic());
    rows("1000", &thousand_points());
    (1..=5).for_each(|seed| rows("rational", &rational(seed)));
}

/// Every build and every machine takes equal steps: pieces, phases and evaluations of whole runs.
/// `UPDATE_EXPECT=1` writes the checksums of the present steps.
#[test]
fn runs_have_the_expected_checksums() {
    type Run<const D: usize> = fn(&Path<D>, &Settings) -> Result<Figures, CompileError>;
    fn checksums<const D: usize>(name: &str, path: &Path<D>, runs: [(&str, Run<D>); 7]) -> String {
        let settings = Settings { fluctuation: 1e-9, ..Settings::default() };
        let line = |(format, run): (&str, Run<D>)| {
            format!("{name} {format} {:016x}\n", run(path, &settings).unwrap().checksum)
        };
        runs.map(line).concat()
    }
    let plane: [(_, Run<2>); 7] = [
        ("f64", run::<f64, 2>),
        ("f32", run::<f32, 2>),
        ("I3F29", run::<I3F29, 2>),
        ("I4F28", run::<I4F28, 2>),
        ("I8F24", run::<I8F24, 2>),
        ("I16F48", run::<I16F48, 2>),
        ("I4F60", run::<I4F60, 2>),
    ];
    let space: [(_, Run<3>); 7] = [
        ("f64", run::<f64, 3>),
        ("f32", run::<f32, 3>),
        ("I3F29", |path, settings| run_in("I3F29", path, settings)),
        ("I4F28", run::<I4F28, 3>),
        ("I8F24", |path, settings| run_in("I8F24", path, settings)),
        ("I16F48", |path, settings| run_in("I16F48", path, settings)),
        ("I4F60", run::<I4F60, 3>),
    ];
    let found = [
        checksums("paper-a", &paper_a(), plane),
        checksums("ten-points", &ten_points(), plane),
        checksums("quintic", &quintic(), space),
    ];
    expect_file!["checksums.txt"].assert_eq(&found.concat());
}

/// A period by the plan and one by override at full rate have the same distance, and leave the schedule at the same place.
#[test]
fn periods_by_the_plan_and_by_override_take_turns() {
    fn same<R: Backend>() {
        let path = paper_a();
        let table: PiecesBuf<R, 2> = compiled(&path, &Settings::default()).unwrap();
        let stages = swing::<R>(path.feed_mm.ldexp(table.as_pieces().chord_exponent));
        let interpolator =
            interpolator(&path, &Settings { fluctuation: 1e-6, ..Settings::default() }, &table, &stages);
        let number = |x: f64| R::from_f64(x).unwrap();
        let limits = OverrideLimits {
            acceleration: number(0.5),
            jerk: number(0.5),
            planned_acceleration: number(0.125),
            planned_jerk: number(0.125),
            planned_feed: number(0.5),
        };
        let feeds = FeedOverride::new(&limits).unwrap();
        let (mut plain, mut mixed) = (interpolator.start(), interpolator.start());
        let mut rates = OverrideState::at(Rate::FULL);
        let mut periods = 0;
        while !interpolator.is_at_end(&plain)
            && let Some(setpoint) = step(&interpolator, &mut plain)
        {
            let same = if periods % 3 == 1 {
                interpolator.step_overridden(&mut mixed, &feeds, &mut rates)
            } else {
                step(&interpolator, &mut mixed)
            };
            assert_eq!(Some(setpoint), same, "{} in period {periods}", R::name());
            assert_eq!(plain.cursor(), mixed.cursor(), "{} in period {periods}", R::name());
            periods += 1;
        }
        assert!(periods > 1000, "{periods} periods");
    }
    same::<f64>();
    same::<I8F24>();
}

/// What is asked of a run over `path`: with it, and with all of its setpoints by a plan that swings.
fn by_plan<R: Backend>(path: &Path<2>, ask: impl Fn(&PieceInterpolator<'_, R, 2>, &[PieceSetpoint<R, 2>])) {
    let table: PiecesBuf<R, 2> = compiled(path, &Settings::default()).unwrap();
    let stages = swing::<R>(path.feed_mm.ldexp(table.as_pieces().chord_exponent));
    let interpolator = interpolator(path, &Settings::default(), &table, &stages);
    let mut state = interpolator.start();
    let mut setpoints = Vec::new();
    while !interpolator.is_at_end(&state) {
        setpoints.extend(step(&interpolator, &mut state));
    }
    assert!(setpoints.len() > 1000, "{} periods", setpoints.len());
    ask(&interpolator, &setpoints);
}

#[test]
fn the_chords_of_a_plan_lead_where_the_plan_does() {
    fn same<R: Backend>(path: &Path<2>) {
        by_plan::<R>(path, |interpolator, planned| {
            let mut state = interpolator.start();
            let (mut other, mut written) = (state, PieceSetpoint::default());
            for (period, setpoint) in planned.iter().enumerate() {
                let given = step_by(interpolator, &mut state, setpoint.length);
                assert_eq!(given, Some(*setpoint), "{} in period {period}", R::name());
                assert!(step_by_into(interpolator, &mut other, setpoint.length, &mut written));
                assert_eq!(written, *setpoint, "{} in period {period}", R::name());
            }
            assert_eq!(step_by(interpolator, &mut state, planned[0].length), None, "{}", R::name());
            assert!(!step_by_into(interpolator, &mut other, planned[0].length, &mut written));
            assert_eq!(
                Some(written),
                planned.last().copied(),
                "{}: behind the end nothing is written",
                R::name()
            );
            assert_eq!(*state.cursor(), Default::default(), "the schedule stays where it is");
        });
    }
    same::<f64>(&paper_a());
    same::<I4F28>(&paper_a());
    same::<I16F48>(&paper_a());
    same::<f64>(&ten_points());
    same::<I16F48>(&ten_points());
}

/// A handwheel stands still, and may be turned back: the run waits, and goes on as if it had not.
#[test]
fn what_is_no_length_holds_the_setpoint() {
    fn holds<R: Backend>(nothing: &[R]) {
        by_plan::<R>(&paper_a(), |interpolator, planned| {
            let mut state = interpolator.start();
            for pair in planned.windows(2) {
                step_by(interpolator, &mut state, pair[0].length);
                for length in nothing {
                    let held = step_by(interpolator, &mut state, *length).unwrap();
                    let expected = PieceSetpoint { length: R::zero(), evaluations: 0, ..pair[0] };
                    assert_eq!(held, expected, "{}", R::name());
                    let mut written = PieceSetpoint::default();
                    assert!(step_by_into(interpolator, &mut state, *length, &mut written));
                    assert_eq!(written, expected, "{}", R::name());
                }
            }
        });
    }
    holds(&[0.0, -0.1, f64::NAN]);
    holds(&[I4F28::from_f64(0.0).unwrap(), I4F28::from_f64(-0.1).unwrap()]);
}

/// Cubics have forms of the step of their own in formats that are run for speed; wrappers have the general one.
#[test]
fn every_form_of_the_step_makes_the_same_steps() {
    fn same<R: Backend, const D: usize>(path: &Path<D>) {
        let own = figures::<R, D>(path, 32.0, 1e-9).checksum;
        let settings = Settings { fluctuation: 1e-9, ..Settings::default() };
        let general = run_watched(&R::name().to_string(), path, &settings).0.unwrap().checksum;
        assert_eq!(own, general, "{}", R::name());
    }
    same::<f64, 2>(&paper_a());
    same::<f64, 2>(&ten_points());
    same::<f64, 3>(&thousand_points());
    same::<I4F28, 2>(&paper_a());
    same::<I16F48, 2>(&ten_points());
}
