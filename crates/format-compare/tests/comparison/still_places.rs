//! Paths that stand still at a place, C' = 0. Each must run as well as the same path without that place, on pieces and
//! on the global parameter. `check` and a plan knew such places; but a run on pieces was once refused, and a run on the
//! global parameter cut them.

use format_compare::{Comparison, Engine, Options, Problem, compare, select};
use nurbs_core::generate;
use part_program::{Machine, read_machine, read_part};
use proptest::prelude::*;

const MACHINE: &str = "[machine]
interpolation_period_ms = 1.0
feedrate_mm_per_s = 50.0
acceleration_mm_per_s2 = 1000.0
jerk_mm_per_s3 = 40000.0
chord_error_mm = 0.001
fluctuation_limit = 1e-4
parameter_tolerance = 1e-10
max_iterations = 8
junction = \"stop\"
";

fn machine() -> Machine {
    read_machine("mill.toml", MACHINE).unwrap()
}

fn compared(name: &str, text: &str, formats: &[&str], engine: Engine) -> Comparison {
    let problem = Problem::<3>::new(&read_part(name, text).unwrap(), &machine()).unwrap();
    let formats = select::<3>(&formats.iter().map(ToString::to_string).collect::<Vec<_>>()).unwrap();
    compare(&problem, &formats, &[engine], &Options::default()).unwrap()
}

fn spline(degree: usize, points: &[[f64; 2]], inner: &[f64]) -> String {
    let ends = |u: f64| std::iter::repeat_n(u, degree + 1);
    let knots: Vec<f64> = ends(0.0).chain(inner.iter().copied()).chain(ends(1.0)).collect();
    format!("[curve]\ndegree = {degree}\nknots = {knots:?}\ncontrol_points_mm = {points:?}\n")
}

/// Each case, with the same path in lines if it consists of lines.
fn cases() -> Vec<(&'static str, String, Option<&'static str>)> {
    let [b, c] = [[10.0, 30.0], [40.0, 35.0]];
    let [p, q, r] = [[10.0, 15.0], [20.0, -5.0], [30.0, 20.0]];
    let cusp = [[10.0, 10.0], [-10.0 / 3.0, -10.0], [-10.0 / 3.0, 10.0], [10.0, -10.0]];
    let straight = [0.0, 10.0, 20.0, 20.0, 20.0, 30.0, 40.0].map(|x| [x, 0.5 * x]);
    let corner = "[curve]\nshape = \"trigonometric\"\ncontrol_points_mm = [[10, 30], [40, 35], [10, 30], [40, 35]]\nlambda = 0.0\nk \
                  = -1.0\nends = \"as-given\"\n";
    let line = "G0 X40 Y35\nG1 X10 Y30\n";
    vec![
        ("a cusp", spline(3, &cusp, &[]), None),
        ("doubled ends", spline(3, &[b, b, p, c, c], &[0.5]), None),
        ("tripled ends", spline(3, &[b, b, b, p, c, c, c], &[0.2, 0.5, 0.8]), None),
        ("doubled inside", spline(3, &[b, p, q, q, r, c], &[0.3, 0.7]), None),
        ("tripled inside", spline(3, &[b, p, q, q, q, r, c], &[0.25, 0.5, 0.75]), None),
        ("tripled on a line", spline(3, &straight, &[0.25, 0.5, 0.75]), None),
        ("a span without length", spline(3, &[b, p, q, q, q, q, r, c], &[0.2, 0.4, 0.6, 0.8]), None),
        ("a line with doubled ends", spline(3, &[c, c, b, b], &[]), Some(line)),
        ("there and back", spline(2, &[b, c, b], &[]), Some("G0 X10 Y30\nG1 X25 Y32.5\nG1 X10 Y30\n")),
        ("there, back and there", spline(3, &[b, c, b, c], &[]), None),
        ("paper B's corner spline that is a line", corner.into(), Some(line)),
    ]
}

#[test]
fn each_is_good_in_32_bits_on_pieces_in_the_same_time() {
    for (name, text, lines) in cases() {
        let formats = ["f64", "f32", "I4F28", "I8F24"];
        let found = compared("part.toml", &text, &formats, Engine::Pieces);
        let lines = lines.map(|lines| compared("lines.nc", lines, &formats, Engine::Pieces));
        let planned = found.part.planned_time_s.unwrap();
        for (i, row) in found.formats.iter().enumerate() {
            assert!(row.verdict.is_good(), "{name}, {}: {}", row.format, row.verdict);
            let periods = row.periods.unwrap();
            assert!((periods as f64 - planned * 1e3).abs() < 1.5, "{name}: {periods} for {planned} s");
            // The run rests and goes on as planned: the limit is 40,000 mm/s³.
            let jerk = row.jerk_max_mm_per_s3.unwrap();
            assert!(jerk < 4.4e4, "{name}, {}: {jerk} mm/s³", row.format);
            if let Some(lines) = &lines {
                assert_eq!(lines.formats[i].periods, row.periods, "{name}, {}", row.format);
            }
        }
        assert_eq!(found.recommended.as_deref(), Some("I4F28"), "{name}");
    }
}

#[test]
fn each_is_good_on_the_global_parameter() {
    for (name, text, _) in cases() {
        let found = compared("part.toml", &text, &["f64", "I32F32", "I16F48"], Engine::DeBoorSecant);
        let planned = found.part.planned_time_s.unwrap();
        for row in &found.formats {
            assert!(row.verdict.is_good(), "{name}, {}: {}", row.format, row.verdict);
            let periods = row.periods.unwrap();
            assert!((periods as f64 - planned * 1e3).abs() < 1.5, "{name}: {periods} for {planned} s");
            let jerk = row.jerk_max_mm_per_s3.unwrap();
            assert!(jerk < 4.4e4, "{name}, {}: {jerk} mm/s³", row.format);
            // A chord over a cusp was once short by up to a step; a step of 0.1 mm may fluctuate by 1e-4 of it.
            let off = row.fluctuation.unwrap().length_error_mm_max;
            assert!(off < 1e-5, "{name}, {}: {off} mm", row.format);
        }
    }
}

/// The number of cases is `cases` unless the environment asks for a long run.
fn config(cases: u32) -> ProptestConfig {
    let cases = std::env::var("PROPTEST_CASES").ok().and_then(|n| n.parse().ok()).unwrap_or(cases);
    ProptestConfig { cases, ..ProptestConfig::default() }
}

proptest! {
    #![proptest_config(config(8))]

    /// At each such place the chord error holds, the run ends at the end of the path, and nothing overflows.
    #[test]
    fn random_curves_with_coincident_points_are_run_to_their_end(
        curve in generate::curve_with_coincident_points::<2>(),
    ) {
        let scaled = curve.control_points().iter().map(|p| p.map(|x| 0.1 * x)).collect::<Vec<_>>();
        let text = format!(
            "[curve]\ndegree = {}\nknots = {:?}\ncontrol_points_mm = {scaled:?}\nweights = {:?}\n",
            curve.degree(), curve.knots(), curve.weights(),
        );
        let found = compared("random.toml", &text, &["f64", "I4F28"], Engine::Pieces);
        for row in &found.formats {
            let Some(chord_error) = row.chord_error_mm_max else {
                // For random weights, a short span may need more than four integer bits.
                prop_assert!(row.format == "I4F28" && row.verdict.to_string().contains("integer bits"), "{}", row.verdict);
                continue;
            };
            prop_assert!(chord_error <= 1.005e-3, "{}: {chord_error} mm", row.format);
            prop_assert!(row.end_error_mm.unwrap() < 1e-6, "{}: {:?}", row.format, row.end_error_mm);
            prop_assert_eq!(row.saturations, Some(0));
            let is_over = (row.periods.unwrap() as f64 - found.part.planned_time_s.unwrap() * 1e3).abs() < 16.0;
            prop_assert!(is_over, "{}: {:?} periods for {:?} s", row.format, row.periods, found.part.planned_time_s);
        }
    }
}
