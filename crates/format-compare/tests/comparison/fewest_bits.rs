//! The fewest bits that are enough.

use format_compare::{ExactPlan, FewestBits, Options, Problem, fewest_bits, size};
use real::Datapath;

use crate::examples::{judged, mill};

#[test]
fn it_is_what_every_width_run_one_by_one_says() {
    let problem: Problem<3> =
        mill("G0 X0 Y0\nG1 X10 F3000\nG2 X20 Y10 R10\nG1 X40 Y12\nG3 X30 Y30 R12\n", "");
    let found = fewest_bits(&problem, None, &judged(&problem, &["I8F24"]), &Options::default()).unwrap();
    let plan = ExactPlan::in_format::<f64, 3>(&problem, [0.0; 2]).unwrap();
    let sizing = size(&problem, &plan, &Options::default(), Datapath::default()).unwrap();
    let (row, margin) = sizing.uniform.zip(sizing.uniform_margin).unwrap();
    let expected = FewestBits::Found {
        fluctuation: row.fluctuation.unwrap().cruise_max_abs,
        bits: row.bits,
        format: row.format,
        margin,
    };
    assert_eq!(found, expected);
}

/// In a program of several minutes, the parts in which coarse formats fail are enough for the search.
#[test]
fn a_long_program_is_searched_by_its_hardest_parts() {
    let mut program = String::from("G0 X0 Y0\nF600\n");
    for i in 0..400 {
        program += &format!("G1 X{} Y{}\n", (i % 7) * 5, i);
    }
    program += "G2 X40 Y399 R20\n";
    let problem: Problem<3> = mill(&program, "");
    let runs = judged(&problem, &["I16F16", "I8F24"]);
    let plan = ExactPlan::in_format::<f64, 3>(&problem, [0.0; 2]).unwrap();
    // Half as much again as parts that are searched may have together: were they the whole, the search would be left out.
    assert!(plan.periods() > 300_000, "{}", plan.periods());
    let FewestBits::Found { bits, margin, .. } =
        fewest_bits(&problem, None, &runs, &Options::default()).unwrap()
    else {
        panic!("found")
    };
    assert!((16..32).contains(&bits) && margin >= 1.0, "{bits} bits, {margin}");
}

#[test]
fn one_long_section_is_left_out() {
    let problem: Problem<3> = mill("G0 X0 Y0\nG1 X3000 F600\n", "");
    let found = fewest_bits(&problem, None, &judged(&problem, &["I16F16"]), &Options::default()).unwrap();
    assert!(matches!(found, FewestBits::LeftOut { periods } if periods > 290_000), "{found:?}");
}
