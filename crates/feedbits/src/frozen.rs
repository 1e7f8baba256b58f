//! Whole screens of results that are written down here, not computed: no snapshot of them changes with a kernel, or with what a
//! target is counted to take. `UPDATE_EXPECT=1 cargo test -p feedbits --bin feedbits frozen` writes the present screens.

use std::collections::BTreeMap;

use expect_test::{ExpectFile, expect_file};
use format_compare::{
    Comparison, Cost, CostSource, Engine, FewestBits, Fluctuation, FrontPoint, JudgedRun, Mixed, NotOfFormat,
    PartSummary, PeriodCost, PeriodEnd, Register, Remedy, Requirement, Sizing, Verdict,
};
use part_program::read_machine;
use real::FormatName;
use target_cost::{Measure, Target};

use crate::{compare, period_costs, size};

const MACHINE: &str = "[machine]\ninterpolation_period_ms = 1\nfeedrate_mm_per_s = 100\nacceleration_mm_per_s2 = 1000\n\
    jerk_mm_per_s3 = 50000\nchord_error_mm = 0.002\nfluctuation_limit = 1e-5\n";

/// A processor and an FPGA that nobody makes.
const TARGETS: [&str; 2] = [
    "name = \"core\"\ntitle = \"A core with an FPU\"\nkind = \"processor\"\n\
     [[clock]]\nmhz = 100\nsource = \"made up\"\n",
    "name = \"array\"\ntitle = \"An array of blocks\"\nkind = \"fpga\"\n[[clock]]\nmhz = 200\nsource = \"made up\"\n\
     [[unit]]\nname = \"multiplier\"\ncount = 2\n[[unit]]\nname = \"root\"\ncount = 1\n",
];

fn targets() -> [Target; 2] {
    let [core, array] = TARGETS.map(|text| Target::read("made up", text).expect("a target"));
    // Said of a target in a file, it would be looked for among those that are counted.
    [Target { calibrated: true, ..core }, array]
}

const LIMIT: f64 = 1e-5;

fn requirement(what: &'static str, [found, limit]: [f64; 2], broken: &str) -> Requirement {
    let point_mm = [25.0, 5.0, 0.0];
    let at = PeriodEnd { line: Some(4), period: 640, time_s: 0.64, point_mm };
    Requirement {
        what,
        found,
        limit,
        unit: "ratio",
        at: Some(at),
        seen_within_mm: None,
        is_of_motion: false,
        broken: broken.to_owned(),
    }
}

/// A run on pieces with this largest fluctuation at cruise, and what a verdict says against it.
fn run(format: &str, found: f64, reasons: &[&str]) -> JudgedRun {
    let fluctuation = Fluctuation { cruise_max_abs: found, ..Fluctuation::default() };
    let reasons: Vec<_> = reasons.iter().map(|reason| (*reason).to_owned()).collect();
    JudgedRun {
        format: format.to_owned(),
        bits: FormatName::named(format).map_or(0, FormatName::bits),
        engine: Engine::Pieces,
        fluctuation: Some(fluctuation),
        evaluations: None,
        saturations: Some(0),
        integer_bits_needed: Some(2),
        chord_error_mm_max: Some(1e-3),
        corner_error_mm_max: Some(0.0),
        position_error_mm_max: Some(1e-6),
        position_resolution_mm: Some(1e-6),
        fluctuation_resolution: Some(1e-9),
        end_error_mm: Some(0.0),
        jerk_max_mm_per_s3: Some(5e4),
        periods: Some(1185),
        operations: None,
        cycles: BTreeMap::new(),
        requirements: vec![requirement("feedrate fluctuation at cruise", [found, LIMIT], "")],
        verdict: if reasons.is_empty() { Verdict::Good } else { Verdict::Bad(reasons) },
    }
}

fn refused(format: &str, why: &str) -> JudgedRun {
    JudgedRun { fluctuation: None, verdict: Verdict::Refused(why.to_owned()), ..run(format, 0.0, &[]) }
}

/// A cost of so many units, known to a quarter, at so many MHz; with as many blocks on an FPGA.
fn cost(max: f64, mhz: f64, blocks: Option<u32>) -> Cost {
    Cost::Known(PeriodCost {
        mean: max / 2.0,
        max,
        mean_range: [max / 2.0 - 5.0, max / 2.0 + 5.0],
        max_range: [0.75 * max, 1.25 * max],
        measure: Measure::Cycles,
        level: CostSource::Scheduled,
        microseconds_max: Some(max / mhz),
        microseconds_range: Some([0.75 * max / mhz, 1.25 * max / mhz]),
        share_of_period: Some(max / mhz / 1000.0),
        dominating: "mul_add",
        dominating_share: 0.25,
        dsp_blocks: blocks,
        luts: blocks.map(|blocks| 300 * blocks),
        initiation_interval_max: blocks.map(|_| 120.0),
    })
}

/// The run with its costs on both targets: cycles of the core, cycles and blocks of the array.
fn priced(run: JudgedRun, cycles: f64, on_array: Option<(f64, u32)>) -> JudgedRun {
    let core = ("core".to_owned(), cost(cycles, 100.0, None));
    let unknown = Cost::Unknown { unknown: "sqrt" };
    let array = on_array.map_or(unknown, |(cycles, blocks)| cost(cycles, 200.0, Some(blocks)));
    JudgedRun { cycles: BTreeMap::from([core, ("array".to_owned(), array)]), ..run }
}

fn comparison(name: &str, formats: Vec<JudgedRun>) -> Comparison {
    let recommended = formats.iter().find(|run| run.verdict.is_good()).map(|run| run.format.clone());
    Comparison {
        part: PartSummary {
            name: name.to_owned(),
            curves: 3,
            rapids_left_out: 0,
            length_mm: 55.708,
            planned_time_s: Some(1.185),
            lowered_for_chords: Some(2.5e-6),
            window_mm: None,
            lowest_feedrate_mm_per_s: None,
            without_look_ahead: None,
        },
        machine: read_machine("made up", MACHINE).expect("a machine"),
        reference: "",
        formats,
        interrupted_runs: 0,
        recommended_engine: recommended.as_ref().map(|_| Engine::Pieces),
        recommended,
        recommended_on: BTreeMap::new(),
        fewest_bits: Some(FewestBits::Found {
            format: "I2F22".to_owned(),
            bits: 24,
            fluctuation: 1.25e-6,
            margin: 8.0,
        }),
        not_a_question_of_format: None,
    }
}

/// What a terminal shows, without its styles.
fn shows(text: &str, expected: &ExpectFile) {
    expected.assert_eq(&anstream::adapter::strip_str(text).to_string());
}

fn compared(comparison: &Comparison, targets: &[Target]) -> String {
    compare::first_screen(comparison, &[Engine::Pieces], targets)
}

#[test]
fn a_comparison() {
    let formats = vec![
        run("I16F16", 5.1e-5, &["fluctuation 5.1e-5 > 1.0e-5", "position error 4.8e-4 > 1.0e-5 mm"]),
        run("I8F24", 2.2e-6, &[]),
        run("I4F28", 9.2e-8, &[]),
        refused("I1F31", "the piece 3 does not fit the format"),
        run("f64", 1e-14, &[]),
    ];
    shows(
        &compared(&comparison("a made-up part", formats), &[]),
        &expect_file!["../tests/command_line/terminal/compare.txt"],
    );
}

#[test]
fn a_comparison_on_targets() {
    let line = "fluctuation 3.4e-4 > 1.0e-5 in line 4";
    let formats = vec![
        priced(run("I16F16", 3.4e-4, &[line, "position error 4.8e-4 > 1.0e-5 mm"]), 3102.0, Some((386.0, 4))),
        priced(run("I8F24", 1.8e-7, &[]), 3118.0, Some((422.0, 4))),
        priced(run("I4F28", 1.3e-8, &[]), 3070.0, Some((440.0, 4))),
        priced(run("f32", 2.2e-7, &[]), 1565.0, Some((278.0, 3))),
        priced(run("f64", 1e-14, &[]), 147_318.0, None),
    ];
    let comparison = Comparison {
        recommended: Some("f32".to_owned()),
        recommended_on: ["core", "array"]
            .map(|name| (name.to_owned(), ("f32".to_owned(), Engine::Pieces)))
            .into(),
        ..comparison("part.nc", formats)
    };
    shows(
        &compared(&comparison, &targets()),
        &expect_file!["../tests/command_line/terminal/compare-program.txt"],
    );
}

#[test]
fn nothing_that_is_good_enough() {
    let broken = requirement("corner error", [2.6e-3, 2e-3], "corner error 2.60e-3 > 2.00e-3 mm in line 4");
    let comparison = Comparison {
        fewest_bits: Some(FewestBits::BrokenByPlan { up_to_bits: 48, broken: vec![broken.broken.clone()] }),
        not_a_question_of_format: Some(NotOfFormat {
            run: "f64 pieces".to_owned(),
            time_s: 1.185,
            broken: vec![broken.clone()],
            helps: vec![Remedy { change: "half of the feed everywhere".to_owned(), time_s: 2.21 }],
            does_not_help: vec!["another feed".to_owned()],
        }),
        ..comparison("a made-up part", vec![run("I16F16", 5.1e-7, &[&broken.broken])])
    };
    shows(&compared(&comparison, &[]), &expect_file!["../tests/command_line/terminal/none.txt"]);
    // It is said once that more bits would not help.
    let unexplained = Comparison { not_a_question_of_format: None, ..comparison };
    assert!(compared(&unexplained, &[]).contains("More bits would not help: f64 has corner error 2.60e-3"));
    let of_format = Comparison { fewest_bits: Some(FewestBits::None { up_to_bits: 48 }), ..unexplained };
    assert!(compared(&of_format, &[]).contains("Not even 48 bits are enough"));
}

#[test]
fn the_fewest_bits() {
    let tried = ["I2F10", "I2F16", "I2F22", "I2F33"].map(|format| {
        let exponent = format.trim_start_matches("I2F").parse().unwrap_or(0);
        run(format, 4.0 * 0.5_f64.powi(exponent), if exponent < 22 { &["fluctuation"] } else { &[] })
    });
    let front = tried.iter().map(|run| FrontPoint {
        format: run.format.clone(),
        bits: run.bits,
        fluctuation: run.fluctuation.map_or(0.0, |found| found.cruise_max_abs),
        good: run.verdict.is_good(),
    });
    let register = |(signal, group, format, bits, bound): (&'static str, _, &str, _, _)| Register {
        signal,
        group,
        meaning: "",
        format: format.to_owned(),
        bits,
        bound,
    };
    let registers = [
        ("parameter", "parameter", "I2F21", 23, 1.0),
        ("step_per_chord_fall", "step", "I1F1", 2, 0.8796),
        ("weight_reciprocal", "weight", "I2F21", 23, 1.375),
    ];
    let sizing = Sizing {
        uniform: Some(priced(tried[2].clone(), 3070.0, Some((440.0, 4)))),
        uniform_margin: Some(8.3),
        mixed: Some(Mixed {
            signals: registers.map(register).to_vec(),
            bits: 48,
            uniform_bits: 72,
            fluctuation: 9.7e-6,
            margin: 1.03,
            cycles: priced(tried[2].clone(), 2990.0, Some((400.0, 4))).cycles,
        }),
        front: front.collect(),
        tried: tried.to_vec(),
        runs: 194,
        not_a_question_of_format: None,
    };
    let text = size::report(&sizing) + &period_costs::of_sizing(&sizing, &targets());
    shows(&text, &expect_file!["../tests/command_line/terminal/size.txt"]);
}
