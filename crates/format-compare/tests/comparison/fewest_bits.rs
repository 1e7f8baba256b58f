//! The fewest bits that are enough.

use format_compare::{
    Engine, ExactPlan, FewestBits, JudgedRun, Options, Problem, compare, fewest_bits, select, size,
};
use real::Datapath;

use crate::examples::{judged, mill};

const ARCS: &str = "G0 X0 Y0\nG1 X10 F3000\nG2 X20 Y10 R10\nG1 X40 Y12\nG3 X30 Y30 R12\n";

fn plan(problem: &Problem<3>) -> ExactPlan {
    ExactPlan::in_format::<f64, 3>(problem, [0.0; 2]).unwrap()
}

fn found(problem: &Problem<3>, runs: &[JudgedRun], options: &Options) -> FewestBits {
    fewest_bits(problem, &plan(problem), runs, options).unwrap()
}

/// The first format of these widths that is good, of each width the one with the most fraction bits first.
fn first_good(problem: &Problem<3>, widths: std::ops::RangeInclusive<u32>) -> Option<JudgedRun> {
    widths.into_iter().find_map(|width| {
        let names: Vec<_> = (2..=width).map(|integer| format!("I{integer}F{}", width - integer)).collect();
        let names: Vec<_> = names.iter().map(String::as_str).collect();
        let formats = select(&names).unwrap();
        let runs = compare(problem, &formats, &[Engine::Pieces], &Options::default()).unwrap().formats;
        let integer_bits =
            |run: &&JudgedRun| run.format[1..run.format.find('F').unwrap()].parse::<u32>().unwrap();
        runs.iter().filter(|run| run.verdict.is_good()).min_by_key(integer_bits).cloned()
    })
}

fn answer_of(problem: &Problem<3>, run: JudgedRun) -> FewestBits {
    let fluctuation = run.fluctuation.unwrap().cruise_max_abs;
    let margin = problem.machine.fluctuation_limit / fluctuation;
    FewestBits::Found { fluctuation, margin, bits: run.bits, format: run.format }
}

/// Each format of 12 bits and more is a row of a comparison, with every division into integer and fraction bits. Whatever rows are known
/// before the search, it finds the first good one.
#[test]
fn it_is_what_a_row_for_each_format_says() {
    let wave = (1..90).fold("G0 X0 Y0\nF3000\n".to_string(), |all, i| {
        let angle = 0.35 * f64::from(i);
        all + &format!("G1 X{:.4} Y{:.4}\n", 0.6 * f64::from(i), angle.sin())
    });
    let rounded = "junction = \"deviation\"\njunction_deviation_mm = 0.01\n";
    for (program, more) in [(ARCS, ""), ("G0 X0 Y0\nG1 X10 Y7.3 F3000\nG1 X3\n", ""), (&wave, rounded)] {
        let problem: Problem<3> = mill(program, more);
        let expected = answer_of(&problem, first_good(&problem, 12..=32).unwrap());
        for rows in [&["I8F24"][..], &["I16F16"], &["I16F16", "f64"]] {
            assert_eq!(found(&problem, &judged(&problem, rows), &Options::default()), expected, "{rows:?}");
        }
        assert_eq!(found(&problem, &[], &Options::default()), expected, "no rows");
    }
}

#[test]
fn the_registers_start_from_the_same_format() {
    let problem: Problem<3> = mill(ARCS, "");
    let sizing = size(&problem, &plan(&problem), &Options::default(), Datapath::default()).unwrap();
    let uniform = sizing.uniform.unwrap();
    assert_eq!(found(&problem, &sizing.tried, &Options::default()), answer_of(&problem, uniform));
    let fluctuation = sizing.mixed.unwrap().fluctuation;
    assert!(fluctuation <= problem.machine.fluctuation_limit, "{fluctuation}");
}

/// With an allowed fluctuation that 48 bits cannot keep, and 64 can, it is a question of the format. Where the path is left at corners
/// that the machine file lets pass too fast, it is none.
#[test]
fn too_few_bits_and_a_plan_that_breaks_its_limits_are_told_apart() {
    let options = Options::default();
    let mut fine: Problem<3> = mill("G0 X0 Y0\nG1 X10 Y7.3 F3000\n", "");
    fine.machine.fluctuation_limit = 1e-16;
    let runs = judged(&fine, &["I16F16", "I4F60"]);
    assert!(runs.iter().any(|run| run.verdict.is_good()), "64 bits are enough");
    assert_eq!(found(&fine, &runs, &options), FewestBits::None { up_to_bits: 48 });
    let jumps = "junction = \"velocity-jump\"\n[machine.axes.x]\nvelocity_jump_mm_per_s = 16\n\
                 [machine.axes.y]\nvelocity_jump_mm_per_s = 16\n";
    let corners: Problem<3> = mill("G0 X0 Y0\nG1 X10 F3000\nG1 X20\nG1 Y10\nG1 X30\n", jumps);
    for rows in [&["I8F24"][..], &["I8F24", "f64"]] {
        let FewestBits::BrokenByPlan { broken, .. } = found(&corners, &judged(&corners, rows), &options)
        else {
            panic!("the plan is at fault")
        };
        assert!(broken.iter().any(|why| why.starts_with("corner error")), "{broken:?}");
    }
    assert!(first_good(&corners, 24..=25).is_none());
}

/// A program of several minutes, and one move of several minutes without a rest, which cannot be tried in parts.
#[test]
fn no_program_is_too_long() {
    let mut program = String::from("G0 X0 Y0\nF600\n");
    for i in 0..400 {
        program += &format!("G1 X{} Y{}\n", (i % 7) * 5, i);
    }
    program += "G2 X40 Y399 R20\n";
    for program in [&program, "G0 X0 Y0\nG1 X3000 F600\n"] {
        let problem: Problem<3> = mill(program, "");
        assert!(plan(&problem).periods() > 290_000, "{}", plan(&problem).periods());
        let runs = judged(&problem, &["I16F16", "I8F24"]);
        let FewestBits::Found { bits, margin, .. } = found(&problem, &runs, &Options::default()) else {
            panic!("found")
        };
        assert!((16..32).contains(&bits) && margin >= 1.0, "{bits} bits, {margin}");
        let narrower = judged(&problem, &[&format!("I2F{}", bits - 3)]);
        assert!(!narrower[0].verdict.is_good(), "{bits} bits, and one less");
    }
}
