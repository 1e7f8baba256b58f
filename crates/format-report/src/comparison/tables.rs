//! The tables of a comparison.

use format_compare::{Fluctuation, JudgedRun, Requirement, Verdict};

use crate::comparison::material::Material;
use crate::comparison::runs::RunView;
use crate::cost_table::cost_table;
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
