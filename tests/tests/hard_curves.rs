//! Curves that are hard in some way run to their end in every format, or are refused with a clear reason.

use feedbits_tests::{
    PAPER_D, circle, closed, corner, cusp, degree_5, double_knot, line, on_paper_as_machine, problem,
};
use format_compare::{Dimension, Engine, Options, Problem, Space, Verdict, compare, formats};
use nurbs_core::NurbsBuf;

fn runs_or_is_refused<const D: usize>(problem: &Problem<D>) -> (usize, usize)
where
    Space: Dimension<D>,
{
    let engines = [Engine::DeBoorSecant, Engine::Pieces];
    let comparison = compare(problem, &formats(), &engines, &Options::default())
        .unwrap_or_else(|refusal| panic!("{}: {refusal}", problem.name));
    let (mut finished, mut refused) = (0, 0);
    for row in &comparison.formats {
        let name = format!("{} in {} by {:?}", problem.name, row.format, row.engine);
        match &row.verdict {
            Verdict::Refused(why) => {
                assert!(why.len() > 20, "{name}: {why}");
                refused += 1;
            }
            _ => {
                let end = row.end_error_mm.unwrap_or(f64::NAN);
                assert!(end < 0.02, "{name}: ends {end} mm from the end: {:?}", row.verdict);
                finished += 1;
            }
        }
        if row.format == "f64" {
            println!("{name}: {:?} {:?}", row.fluctuation, row.verdict);
        }
    }
    (finished, refused)
}

#[test]
fn full_circle() {
    let (finished, _) = runs_or_is_refused(&on_paper_as_machine("circle", circle()));
    assert!(finished >= 12, "{finished}");
}

#[test]
fn degree_5_in_space() {
    let (finished, _) = runs_or_is_refused(&on_paper_as_machine("degree 5", degree_5()));
    assert!(finished >= 14, "{finished}");
}

#[test]
fn double_interior_knot() {
    let (finished, _) = runs_or_is_refused(&on_paper_as_machine("double knot", double_knot()));
    assert!(finished >= 14, "{finished}");
}

#[test]
fn closed_curve() {
    let (finished, _) = runs_or_is_refused(&on_paper_as_machine("closed", closed()));
    assert!(finished >= 14, "{finished}");
}

#[test]
fn curve_with_a_cusp() {
    let (finished, _) = runs_or_is_refused(&on_paper_as_machine("cusp", cusp()));
    assert!(finished >= 3, "{finished}");
}

#[test]
fn right_angle() {
    let (finished, _) = runs_or_is_refused(&on_paper_as_machine("corner", corner()));
    assert!(finished >= 14, "{finished}");
}

#[test]
fn straight_line() {
    let (finished, _) = runs_or_is_refused(&on_paper_as_machine("line", line()));
    assert!(finished >= 14, "{finished}");
}

#[test]
fn the_ten_point_program() {
    let (finished, _) = runs_or_is_refused(&problem::<2>("paper D", PAPER_D));
    assert!(finished >= 12, "{finished}");
}

/// 0.004 mm/s are 1.2e-5 mm a period, and one step of I16F16 is 1.5e-5 mm.
#[test]
fn a_feed_below_one_step_a_period_is_said_to_be_impossible() {
    let short = NurbsBuf::try_new_nonrational(1, vec![[0.0, 0.0], [0.012, 0.005]], vec![0.0, 0.0, 1.0, 1.0]);
    let mut slow = on_paper_as_machine("slow", short.unwrap_or_else(|error| panic!("{error}")));
    slow.machine.feedrate_mm_per_s = 0.004;
    let comparison = compare(&slow, &formats(), &[Engine::DeBoorSecant], &Options::default())
        .unwrap_or_else(|refusal| panic!("{refusal}"));
    let said = |format: &str| {
        let row = comparison.formats.iter().find(|row| row.format == format);
        row.map(|row| format!("{:?}", row.verdict)).unwrap_or_default()
    };
    let refusal = "cannot run this feed: 1.2e-5 mm a period is less than one step of 1.5e-5 mm";
    assert!(said("I16F16").contains(refusal), "{}", said("I16F16"));
    for format in ["f64", "I32F32"] {
        assert!(!said(format).contains("cannot run"), "{}", said(format));
    }
}
