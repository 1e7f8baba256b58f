//! A table of costs on targets.

use target_cost::{Cost, Measure};

use crate::table::{Cell, Column, Table};

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
                Measure::Cycles => "cycles",
                Measure::Instructions => "instructions",
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
