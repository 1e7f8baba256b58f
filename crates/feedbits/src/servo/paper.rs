//! Table 2 of paper D, printed and simulated.

use anyhow::{Context, Result};
use servo_sim::{CircleTest, PaperCircle, PaperRow, ServoParameters, paper_table};

use super::bounds::expect_end_of_circles;
use super::print::micrometres;
use crate::ending::Ending;
use crate::output;
use crate::places::Place;
use crate::screen::{self, short};

/// Runs the circle at the settings of the table and prints it.
pub(super) fn print(servo: &ServoParameters, as_json: bool, out: &Place) -> Result<Ending> {
    // Four settings, each with two position gains.
    expect_end_of_circles("table 2 of paper D", servo, &CircleTest::PAPER, 8)?;
    let rows = paper_table(servo).context("table 2 of paper D")?;
    let text = if as_json { serde_json::to_string_pretty(&rows)? + "\n" } else { shown(&rows) };
    output::write(out, &text)?;
    Ok(Ending::Good)
}

fn shown(rows: &[PaperRow]) -> String {
    let lines: Vec<Vec<String>> = rows.iter().flat_map(lines).collect();
    let table = screen::table(
        &[
            "table 2",
            "velocity\ngain %",
            "feed-\nforward %",
            "gain\n1/s",
            "lag\nms",
            "printed\nµm",
            "mean\nµm",
            "linear\nµm",
            "roundness\nµm",
        ],
        lines,
    );
    let said: String = rows
        .iter()
        .map(|row| {
            screen::labelled(&format!("{}  ", row.setting.part), &format!("printed: {}", row.setting.printed))
        })
        .collect();
    let about = screen::paragraph(
        "Circle R10 F4000, 24 ms of acceleration before interpolation: mean radial error, that of the linear loop in \
         closed form, and roundness. The lag at 30 1/s is the one with which 98 % is right. Part d pushes at reversals.",
    );
    [about, table, said].join("\n")
}

/// A setting on both loops.
fn lines(row: &PaperRow) -> [Vec<String>; 2] {
    let setting = &row.setting;
    let line = |circle: &PaperCircle| {
        vec![
            setting.part.to_string(),
            short(setting.velocity_gain_percent),
            short(setting.feed_forward * 100.0),
            short(circle.position_gain_per_s),
            short(circle.velocity_lag_ms),
            setting.printed_radial_error_mm.map_or_else(String::new, |mm| short(mm * 1000.0)),
            micrometres(circle.radial_error_mean_mm),
            micrometres(circle.closed_form_mm),
            micrometres(circle.roundness_mm),
        ]
    };
    [line(&row.fitted), line(&row.printed_gain)]
}
