//! Good texts are read to the last number, and bad ones are explained at the right place.

use part_program::{read_machine, read_part};
use proptest::prelude::*;

const PAPER_A: &str = include_str!("../../../../data/seed-000.toml");
const PAPER_D: &str = include_str!("../../../../data/seed-003.nc");

#[test]
fn paper_as_curve_and_machine() {
    let part = read_part("seed-000.toml", PAPER_A).unwrap();
    let curve = &part.curves[0];
    assert_eq!((curve.degree(), curve.dimension(), curve.control_points_mm().len()), (3, 2, 7));
    assert_eq!(curve.control_points_mm()[4], [300.0, 0.0, 0.0]);
    assert_eq!(curve.knots()[4..7], [0.25, 0.5, 0.75]);
    let machine = part.machine.unwrap();
    assert_eq!(
        (machine.interpolation_period_ms, machine.jerk_mm_per_s3, machine.max_iterations),
        (3.0, 400_000.0, 5)
    );
    assert_eq!(read_machine("seed-000.toml", PAPER_A).unwrap(), machine);
}

#[test]
fn paper_ds_program() {
    let part = read_part("seed-003.nc", PAPER_D).unwrap();
    let curve = &part.curves[0];
    assert_eq!((curve.degree(), curve.dimension(), curve.control_points_mm().len()), (3, 2, 10));
    assert_eq!(curve.weights(), [1.0, 2.0, 1.5, 1.0, 1.0, 2.0, 1.0, 1.0, 2.0, 1.0]);
    assert_eq!(curve.knots()[3..8], [0.0, 0.1836, 0.2781, 0.3837, 0.5474]);
    assert_eq!((part.feedrate_mm_per_s, part.machine), (None, None));
}

/// A change of a good text, the place of the fault, and a word of the message.
#[test]
fn faults_are_named_by_place() {
    let toml = |from: &str, to: &str| (PAPER_A.replacen(from, to, 1), "p.toml");
    let nc = |from: &str, to: &str| (PAPER_D.replacen(from, to, 1), "p.nc");
    for ((text, name), place, said) in [
        (toml("degree = 3", "degree = 0"), "p.toml:5:10", "degree 0 is not supported"),
        (toml("degree = 3", "degree = 3.5"), "p.toml:5:10", "whole number"),
        (toml("degree = 3", "degre = 3"), "p.toml:5:1", "did you mean `degree`"),
        (toml("[150, 150]]", "[150, inf]]"), "p.toml:6:86", "control point 6 has the coordinate inf"),
        (toml("[0, 0],", "[0, 0, 0],"), "p.toml:6:", "3 coordinates"),
        (toml("weights = [1, 1,", "weights = [1, -1,"), "p.toml:7:15", "weight 1 is -1"),
        (toml("weights = [1, 1,", "weights = [1,"), "p.toml:7:", "wrong number of weights: 6"),
        (toml("0.25, 0.5,", "0.5, 0.25,"), "p.toml:8:27", "knots decrease"),
        (toml("knots = [0, 0,", "knots = [0,"), "p.toml:8:", "wrong number of knots"),
        (toml("knots = [0,", "knots = [-1,"), "p.toml:8:", "not clamped"),
        (toml("knots =", "# knots ="), "p.toml:4:", "`knots` is missing"),
        (toml("period_ms = 3.0", "period_ms = 0.0"), "p.toml:11:", "`interpolation_period_ms` is 0"),
        (
            toml("feedrate_mm_per_s = 200.0", "feedrate_mm_per_s = -200.0"),
            "p.toml:12:",
            "a number of 1e-6 to 1e5 mm/s",
        ),
        (toml("jerk_mm_per_s3 = 400000.0", "jerk_mm_per_s3 = nan"), "p.toml:14:", "`jerk_mm_per_s3` is NaN"),
        (toml("fluctuation_limit = 1e-6", "fluctuation_limit = 2.0"), "p.toml:16:", "to below 1"),
        (toml("max_iterations = 5", "max_iterations = 0"), "p.toml:18:", "of 1 to 1000"),
        (toml("[machine]", "[machin]"), "p.toml:10:", "did you mean `machine`"),
        (toml("[curve]", "[curve"), "p.toml:4:", "unclosed table"),
        (nc("K0X10.0", "X10.0"), "p.nc:4:1", "without a knot"),
        (nc("R2.0", "R-2.0"), "p.nc:4:", "weight 1 is -2"),
        (nc("K0.2781", "K0.1"), "p.nc:8:1", "knots decrease"),
        (nc("K1.0;\n", ""), "p.nc:16:1", "PS1004: the curve ends after 3 closing knots"),
        (nc("P4", "P1"), "p.nc:3:", "order 1 is not supported"),
        (nc("X10.0", "XY"), "p.nc:4:", "`X` has no number"),
        (nc("Y34.1", "Q34.1"), "p.nc:4:", "no word of G06.2"),
        (nc("G90;", "G47;"), "p.nc:2:1", "`G47` is not read"),
        (nc("G90;", "(open;"), "p.nc:2:1", "no end"),
        (nc("G90;", "#100=;"), "p.nc:2:6", "a value is missing"),
        (("".into(), "p.nc"), "p.nc:1:1", "holds no curve"),
        (("\u{1F600}".into(), "p.nc"), "p.nc:1:1", "no part of a word"),
    ] {
        let said_of_it = read_part(name, &text).map(|_| ()).expect_err(said).to_string();
        assert!(said_of_it.contains(said), "{said} in\n{said_of_it}");
        assert!(said_of_it.contains(place), "{place} in\n{said_of_it}");
    }
}

#[test]
fn all_faults_of_a_file_are_said() {
    let text = PAPER_A.replace("3.0", "0.0").replace("200.0", "-1.0").replace("[1, 1, 1", "[1, 0, 1");
    assert_eq!(read_part("p.toml", &text).unwrap_err().count(), 3);
}

#[test]
fn words_without_effect_are_listed() {
    let part = read_part("p.nc", &PAPER_D.replace("G90;", "G90;\nM3 S1200;")).unwrap();
    let listed: Vec<_> = part.auxiliary.iter().map(|word| (word.letter, word.value, word.line)).collect();
    assert_eq!(listed, [('M', 3.0, 3), ('S', 1200.0, 3)]);
}

proptest! {
    /// Whatever the bytes, the readers return.
    #[test]
    fn any_text_is_read_or_refused(text in "\\PC{0,200}", at in 0..2000_usize, insert in "[A-Z0-9.\\-\\[\\]=(){};#\n ]{0,6}") {
        let _ = read_part("any", &text);
        for good in [PAPER_A, PAPER_D] {
            let cut = good.char_indices().map(|(i, _)| i).nth(at % good.chars().count()).unwrap_or(0);
            let _ = read_part("mutated", &format!("{}{insert}{}", &good[..cut], &good[cut..]));
        }
    }
}
