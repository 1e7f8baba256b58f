//! The tables of the report.

use format_compare::{Cost, Fluctuation, JudgedRun, Requirement, Verdict};

use crate::material::Material;
use crate::runs::RunView;
use crate::table::{Cell, Column, Table};

/// The formats with their figures and verdicts.
pub(crate) fn formats<'a>(rows: impl Iterator<Item = &'a JudgedRun>) -> Table {
    let columns = [
        ("format", "format"),
        ("bits", "bits"),
        ("path", "path"),
        ("verdict", "verdict"),
        ("fluctuation_at_cruise", "|δ| at cruise"),
        ("fluctuation_commanded", "|δ| as commanded"),
        ("fluctuation_resolution", "|δ| of rounding"),
        ("fluctuation_mean", "|δ| mean"),
        ("fluctuation_max", "δ max"),
        ("fluctuation_min", "δ min"),
        ("length_error_mm", "length error [mm]"),
        ("evaluations_mean", "evaluations, mean"),
        ("evaluations_max", "evaluations, max"),
        ("overflows", "overflows"),
        ("integer_bits_needed", "integer bits needed"),
        ("chord_error_mm", "chord error [mm]"),
        ("corner_error_mm", "corner error [mm]"),
        ("position_error_mm", "position error [mm]"),
        ("end_error_mm", "end error [mm]"),
    ];
    Table {
        name: "formats".into(),
        title: "All formats".into(),
        columns: columns.map(|(key, heading)| Column { key, heading }).to_vec(),
        rows: rows.map(format_row).collect(),
    }
}

fn format_row(row: &JudgedRun) -> Vec<Cell> {
    let fluctuation = |of: fn(&Fluctuation) -> f64| Cell::maybe(row.fluctuation.as_ref().map(of));
    vec![
        Cell::text(&row.format),
        Cell::Number(row.bits.into()),
        Cell::text(row.engine.to_string()),
        Cell::text(verdict(&row.verdict)),
        fluctuation(|f| f.cruise_max_abs),
        fluctuation(|f| f.commanded_cruise_max_abs),
        Cell::maybe(row.fluctuation_resolution),
        fluctuation(|f| f.mean_abs),
        fluctuation(|f| f.max),
        fluctuation(|f| f.min),
        fluctuation(|f| f.length_error_mm_max),
        Cell::maybe(row.evaluations.map(|e| e.mean)),
        Cell::maybe(row.evaluations.map(|e| e.max.into())),
        Cell::maybe(row.saturations.map(|count| count as f64)),
        Cell::maybe(row.integer_bits_needed.map(Into::into)),
        Cell::maybe(row.chord_error_mm_max),
        Cell::maybe(row.corner_error_mm_max),
        Cell::maybe(row.position_error_mm_max),
        Cell::maybe(row.end_error_mm),
    ]
}

/// A verdict in words.
pub(crate) fn verdict(verdict: &Verdict) -> String {
    match verdict {
        Verdict::Good => "good".to_string(),
        Verdict::Bad(reasons) => reasons.join("; "),
        Verdict::Refused(reason) => format!("refused: {reason}"),
    }
}

/// The recommended run against each requirement.
pub(crate) fn margins(requirements: &[Requirement]) -> Table {
    let columns = [
        ("requirement", "requirement"),
        ("found", "found"),
        ("limit", "limit"),
        ("unit", "unit"),
        ("used_percent", "used [%]"),
    ];
    let row = |one: &Requirement| {
        vec![
            Cell::text(one.what),
            Cell::Number(one.found),
            Cell::Number(one.limit),
            Cell::text(one.unit),
            Cell::maybe(one.used().map(|used| used * 100.0)),
        ]
    };
    Table {
        name: "margins".into(),
        title: "The recommended format against each requirement".into(),
        columns: columns.map(|(key, heading)| Column { key, heading }).to_vec(),
        rows: requirements.iter().map(row).collect(),
    }
}

/// The columns of a cost, after those that say whose it is.
const COST_COLUMNS: [(&str, &str); 9] = [
    ("mean", "mean"),
    ("worst", "worst"),
    ("worst_low", "worst, low"),
    ("worst_high", "worst, high"),
    ("unit", "counted"),
    ("worst_us", "worst [µs]"),
    ("share_of_period", "share of the period"),
    ("dsp_blocks", "DSP blocks"),
    ("most_work_in", "most work in"),
];

/// A table of costs: `whose` are the columns before those of a cost, and `rows` their cells with the cost. `None` without a row.
pub(crate) fn cost_table(
    title: &str,
    whose: &[(&'static str, &'static str)],
    rows: Vec<(Vec<Cell>, &Cost)>,
) -> Option<Table> {
    let row = |(whose, cost): (Vec<Cell>, &Cost)| whose.into_iter().chain(cost_cells(cost)).collect();
    let columns = whose.iter().chain(&COST_COLUMNS);
    (!rows.is_empty()).then(|| Table {
        name: "costs".into(),
        title: title.into(),
        columns: columns.map(|(key, heading)| Column { key, heading }).collect(),
        rows: rows.into_iter().map(row).collect(),
    })
}

fn cost_cells(cost: &Cost) -> Vec<Cell> {
    match cost {
        Cost::Known(cost) => vec![
            Cell::Number(cost.mean),
            Cell::Number(cost.max),
            Cell::Number(cost.max_range[0]),
            Cell::Number(cost.max_range[1]),
            Cell::text(match cost.measure {
                target_cost::Measure::Cycles => "cycles",
                target_cost::Measure::Instructions => "instructions",
            }),
            Cell::maybe(cost.microseconds_max),
            Cell::maybe(cost.share_of_period),
            Cell::maybe(cost.dsp_blocks.map(Into::into)),
            Cell::text(cost.dominating),
        ],
        Cost::Unknown { unknown } => {
            let mut cells = vec![Cell::Nothing; COST_COLUMNS.len() - 1];
            cells.push(Cell::text(format!("unknown: nobody publishes its {unknown}")));
            cells
        }
    }
}

/// The cost of a period, with a row for each run and target; `None` if the comparison was not priced.
pub(crate) fn costs(material: &Material<'_>, runs: &[RunView<'_>]) -> Option<Table> {
    let mut rows = Vec::new();
    for target in material.targets {
        for run in runs {
            let Some(cost) = run.row.cycles.get(&target.name) else { continue };
            let whose = [&target.name, &run.row.format, &run.row.engine.to_string()].map(Cell::text);
            rows.push((whose.to_vec(), cost));
        }
    }
    let whose = [("target", "target"), ("format", "format"), ("path", "path")];
    cost_table("What a period costs", &whose, rows)
}
