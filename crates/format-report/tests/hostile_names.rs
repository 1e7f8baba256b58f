//! Names from outside change the words of a report, and nothing else: not its elements, its cells or the names of its files.

use std::collections::{BTreeMap, HashSet};

use foreign_text::hostile::NAMES;
use foreign_text::{in_a_cell, is_printable};
use format_compare::{
    Compared, Comparison, Engine, FeedSample, Options, Problem, Trace, Verdict, Watch, compare_with,
    plan_for, price, select,
};
use part_program::{read_machine, read_part};
use target_cost::{StepCost, Target, built_in};

use format_report::{Material, Report, Schedule, Solver, Sweep, SweepCell, SweepResult};

const MACHINE: &str = "[machine]\ninterpolation_period_ms = 2\nfeedrate_mm_per_s = 100\nacceleration_mm_per_s2 = 5000\n\
                       jerk_mm_per_s3 = 400000\n";
const PART: &str =
    "[curve]\ndegree = 2\ncontrol_points_mm = [[0, 0], [10, 0], [10, 10]]\nknots = [0, 0, 0, 1, 1, 1]\n";

/// A comparison that has everything of which a report draws a picture.
struct Example {
    comparison: Comparison,
    traces: Vec<Option<Trace>>,
    plan: Vec<FeedSample>,
    target: Target,
    cost: StepCost,
}

impl Example {
    fn new() -> Self {
        let machine = read_machine("m", MACHINE).expect("a machine");
        let problem = Problem::<2>::new(&read_part("p", PART).expect("a part"), &machine).expect("a problem");
        let formats = select::<2>(&["I4F28", "f32"].map(String::from)).expect("formats");
        let options = Options::default();
        let watch = Watch { traces: true, ..Watch::default() };
        let mut compared =
            compare_with(&problem, &formats, &[Engine::Pieces], &options, &watch).expect("a comparison");
        let target =
            built_in().expect("targets").into_iter().find(|one| one.name == "dsp48").expect("a target");
        price(&mut compared, &problem, std::slice::from_ref(&target), &options, || ()).expect("prices");
        let plan = plan_for(&problem, formats[0].as_ref(), &options).expect("a plan");
        let priced = formats.iter().find(|one| one.name().to_string() == "I4F28").expect("a format");
        let recorded = priced.record(&problem, &plan, &options, 20).expect("a recorded run");
        let cost = StepCost::of(&recorded.steps[0].0, &target, priced.name()).expect("a price");
        let Compared { comparison, traces, .. } = compared;
        Self { comparison, traces, plan: plan.sampled(&problem, 1).expect("samples"), target, cost }
    }

    /// The report in which everything from outside has this name, but for the target, whose name is in names of files.
    fn report(&self, name: &str, target_name: &str) -> Report {
        let mut comparison = self.comparison.clone();
        comparison.part.name = name.to_string();
        comparison.formats[1].verdict = Verdict::Refused(format!("{name}:1: no curve"));
        let renamed = |key: String| if key == self.target.name { target_name.to_string() } else { key };
        for row in &mut comparison.formats {
            row.cycles =
                std::mem::take(&mut row.cycles).into_iter().map(|(key, cost)| (renamed(key), cost)).collect();
        }
        let recommended = std::mem::take(&mut comparison.recommended_on);
        comparison.recommended_on = recommended.into_iter().map(|(key, run)| (renamed(key), run)).collect();
        let mut target = self.target.clone();
        (target.name, target.title) = (target_name.to_string(), name.to_string());
        target.unit.iter_mut().for_each(|unit| unit.name = name.to_string());
        let trace = self.traces[0].clone().expect("a run");
        Report::of(&Material {
            comparison: &comparison,
            traces: &self.traces,
            plan: &self.plan,
            solvers: &[Solver { name: name.to_string(), trace }],
            targets: std::slice::from_ref(&target),
            schedules: &[Schedule { target: &target, run: name.to_string(), cost: self.cost.clone() }],
            command: &format!("feedbits compare {name}"),
        })
        .expect("a report")
    }
}

/// The elements of a page or picture with their attributes, in order, without the words between them.
fn elements(text: &str) -> Vec<&str> {
    text.split('<').skip(1).map(|rest| rest.split_once('>').map_or(rest, |(element, _)| element)).collect()
}

/// The element without the attribute in which a picture names its lines.
fn unnamed(element: &str) -> String {
    let named = element
        .split_once(" data-name=\"")
        .and_then(|(before, rest)| Some((before, rest.split_once('"')?.1)));
    named.map_or(element.to_string(), |(before, after)| format!("{before}{after}"))
}

fn demand_the_same_elements(found: &str, expected: &str, which: &str) {
    let (found, expected) = (elements(found), elements(expected));
    assert_eq!(found.len(), expected.len(), "{which}");
    for (found, expected) in found.into_iter().zip(expected) {
        assert_eq!(unnamed(found), unnamed(expected), "{which}");
    }
}

fn demand_plain_files(report: &Report, which: &str) {
    let mut names = HashSet::new();
    for (name, text) in &report.files {
        let is_plain = |c: char| c.is_ascii_alphanumeric() || "-_.".contains(c);
        assert!(
            name.chars().all(is_plain) && name.len() < 120 && !name.starts_with(['.', '-']),
            "{which}: {name:?}"
        );
        assert!(names.insert(name.to_ascii_lowercase()), "{which}: {name:?} twice");
        let odd = text.chars().find(|c| *c != '\n' && !is_printable(*c));
        assert!(name.ends_with(".json") || odd.is_none(), "{which}: {odd:?} in {name}");
    }
}

/// Every cell of words is harmless, and every cell of a number is one.
fn demand_plain_cells(report: &Report, expected: &Report, which: &str) {
    for ((name, text), (_, expected)) in report.files.iter().zip(&expected.files) {
        if !name.ends_with(".csv") {
            continue;
        }
        let rows = |text: &str| {
            let mut reader = csv::ReaderBuilder::new().has_headers(false).from_reader(text.as_bytes());
            reader.records().map(|row| row.expect("a row of as many cells")).collect::<Vec<_>>()
        };
        let (found, expected) = (rows(text), rows(expected));
        assert_eq!(found.len(), expected.len(), "{which}: {name}");
        for (found, expected) in found.iter().flatten().zip(expected.iter().flatten()) {
            let is_number = expected.parse::<f64>().is_ok();
            assert!(
                if is_number { found == expected } else { in_a_cell(found) == found },
                "{which}: {name}: {found:?}"
            );
        }
    }
}

#[test]
fn a_name_changes_the_words_of_a_report_alone() {
    let example = Example::new();
    let plain = example.report("plain", "t");
    let files = |report: &Report| report.files.iter().map(|file| file.0.clone()).collect::<Vec<_>>();
    for kind in ["schedule-t.svg", "cycles-t.svg", "costs.csv", "solvers.svg", "path-I4F28_pieces.svg"] {
        assert!(files(&plain).iter().any(|name| name == kind), "{kind} in {:?}", files(&plain));
    }
    for name in NAMES {
        let report = example.report(name, "t");
        assert_eq!(files(&report), files(&plain), "{name:?}");
        for ((file, found), (_, expected)) in report.files.iter().zip(&plain.files) {
            if file.ends_with(".html") || file.ends_with(".svg") {
                demand_the_same_elements(found, expected, &format!("{name:?}: {file}"));
            }
        }
        demand_plain_files(&report, name);
        demand_plain_cells(&report, &plain, name);
        let verdicts: serde_json::Value = serde_json::from_str(
            &report.files.iter().find(|file| file.0 == "formats.json").expect("a table").1,
        )
        .expect("JSON");
        assert_eq!(verdicts[1]["verdict"], format!("refused: {name}:1: no curve"), "JSON holds any name");
    }
}

#[test]
fn a_target_s_name_is_no_path() {
    let example = Example::new();
    let count = example.report("plain", "t").files.len();
    for name in NAMES.into_iter().chain(["a/b", "..", "../../a", "/etc/a", "C:\\a", ""]) {
        let report = example.report("plain", name);
        assert_eq!(report.files.len(), count, "{name:?}");
        demand_plain_files(&report, name);
    }
}

#[test]
fn a_name_changes_the_words_of_a_sweep_s_report_alone() {
    let report = |name: &str, run: &str| {
        let sweep = Sweep {
            part: name.into(),
            fingerprint: name.into(),
            fluctuation_limit: 1e-6,
            periods_ms: vec![1.0],
            feeds_mm_per_s: vec![10.0, 20.0],
            sizes_mm: vec![100.0, 1000.0],
            runs: vec![run.into()],
        };
        let result =
            SweepResult { good: false, fluctuation: None, reason: name.into(), cycles: BTreeMap::new() };
        let cell = |cell: usize| {
            let (period_ms, feed_mm_per_s, size_mm) = sweep.place(cell).expect("a place");
            let has_run = cell < 3;
            let skipped = (!has_run).then(|| name.to_string());
            let results = if has_run { vec![result.clone()] } else { Vec::new() };
            SweepCell { cell, period_ms, feed_mm_per_s, size_mm, skipped, results, ..SweepCell::default() }
        };
        let cells: Vec<_> = (0..4).map(cell).collect();
        sweep.report(&cells, name).expect("a report")
    };
    let plain = report("plain", "I4F28 pieces");
    for name in NAMES {
        let hostile = report(name, "I4F28 pieces");
        for ((file, found), (_, expected)) in hostile.files.iter().zip(&plain.files) {
            if file.ends_with(".html") || file.ends_with(".svg") {
                demand_the_same_elements(found, expected, &format!("{name:?}: {file}"));
            }
        }
        demand_plain_cells(&hostile, &plain, name);
        demand_plain_files(&hostile, name);
        demand_plain_files(&report("plain", &name.chars().take(64).collect::<String>()), name);
    }
}

/// What the report's own words hold is let through: each `?` of the page ends a question.
#[test]
fn the_report_s_own_marks_stay() {
    let report = Example::new().report("plain", "t");
    for (file, text) in
        report.files.iter().filter(|file| file.0.ends_with(".html") || file.0.ends_with(".svg"))
    {
        let text = text.split_once("<script>").map_or(text.as_str(), |(text, _)| text);
        assert!(text.match_indices('?').all(|(at, _)| text[at..].starts_with("?<")), "{file}");
    }
    let text = [include_str!("../templates/page.js"), include_str!("../templates/page.css")].concat();
    assert!(text.chars().all(|c| c == '\n' || is_printable(c)));
}
