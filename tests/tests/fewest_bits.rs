//! The fewest bits that are enough, against a row of a comparison for each format.

use feedbits_tests::{PAPER_A, PAPER_D, circle, degree_5, on_paper_as_machine, problem};
use format_compare::{
    Dimension, Engine, FewestBits, JudgedRun, Options, PlanIn, Problem, Space, compare, compare_with,
    fewest_bits, formats, select,
};
use nurbs_core::{CornerLambda, CornerStyle};
use part_program::{Machine, Part, read_machine, read_part};
use path_smooth::smooth;

const ENGRAVING: &str = include_str!("../../data/engraving.nc");
const ROUTER: &str = include_str!("../../data/machines/router.toml");

/// Widths of which each format is run.
const WIDTHS: std::ops::RangeInclusive<u32> = 16..=32;

/// The good runs of a width, the one with the most fraction bits first.
fn good<const D: usize>(problem: &Problem<D>, width: u32) -> Option<JudgedRun>
where
    Space: Dimension<D>,
{
    let names: Vec<_> = (2..=width).map(|integer| format!("I{integer}F{}", width - integer)).collect();
    let formats = select(&names).unwrap();
    let runs = compare(problem, &formats, &[Engine::Pieces], &Options::default()).unwrap().formats;
    let mut by_name = names.iter().filter_map(|name| runs.iter().find(|run| run.format == *name));
    by_name.find(|run| run.verdict.is_good()).cloned()
}

/// Checks the answer, and returns its width.
fn agrees<const D: usize>(what: &str, problem: &Problem<D>) -> Option<u32>
where
    Space: Dimension<D>,
{
    let options = Options { plan_in: PlanIn::default(), ..Options::default() };
    let compared =
        compare_with(problem, &formats(), &[Engine::Pieces], &options, &Default::default()).unwrap();
    let plan = compared.plan.as_ref().unwrap();
    let answer = fewest_bits(problem, plan, &compared.comparison.formats, &options).unwrap();
    let expected = WIDTHS.into_iter().find_map(|width| good(problem, width));
    let found = match &answer {
        FewestBits::Found { format, bits, .. } => Some((format.clone(), *bits)),
        _ => None,
    };
    let of_row = |run: &JudgedRun| (run.format.clone(), run.bits);
    assert_eq!(found, expected.as_ref().map(of_row), "{what}: {answer:?}");
    found.map(|(_, bits)| bits)
}

fn read(name: &str, text: &str) -> Part {
    read_part(name, text).unwrap()
}

fn router() -> Machine {
    read_machine("router.toml", ROUTER).unwrap()
}

/// The outlines of a few letters.
fn letters() -> Part {
    let lines: Vec<_> = ENGRAVING.lines().take(220).collect();
    read("letters.nc", &(lines.join("\n") + "\n"))
}

#[test]
#[ignore = "nightly: every format of 16 to 32 bits along five parts and three programs"]
fn they_are_what_every_format_says() {
    let options =
        path_smooth::Options { tolerance_mm: 0.01, outer: CornerStyle::Cut, lambda: CornerLambda::Auto };
    let smoothed = smooth(&letters(), &router(), &options).unwrap().path;
    let on_router = |part: &Part| Problem::<3>::new(part, &router()).unwrap();
    let arcs = "G0 X0 Y0\nG1 X10 F3000\nG2 X20 Y10 R10\nG1 X40 Y12\nG3 X30 Y30 R12\nG4 P0.1\nG1 X0 Y0 Z-3\n";
    let zigzag = (0..40).fold("G0 X0 Y0\n".to_string(), |all, i| {
        all + &format!("G1 X{} Y{} F{}\n", i * 3, i % 4, 600 + 40 * i)
    });
    let widths = [
        agrees("paper A", &problem::<2>("a.toml", PAPER_A)),
        agrees("paper D", &problem::<3>("d.nc", PAPER_D)),
        agrees("a circle", &on_paper_as_machine("circle", circle())),
        agrees("a curve of degree 5", &on_paper_as_machine("degree 5", degree_5())),
        agrees("smoothed letters", &on_router(&smoothed)),
        agrees("letters", &on_router(&letters())),
        agrees("arcs", &on_router(&read("arcs.nc", arcs))),
        agrees("a zigzag", &on_router(&read("zigzag.nc", &zigzag))),
    ];
    assert!(widths.iter().filter(|width| width.is_some()).count() >= 7, "{widths:?}");
}
