//! `feedbits papers`: every figure of papers A to D, printed and as it comes out here.

use std::path::PathBuf;

use anyhow::{Context, Result};
use clap::Args;
use format_report::Figure;
use paper_figures::{ContourRow, PaperFigures, Printed, Row, contour_table, paper_figures};

use crate::ending::Ending;
use crate::output;
use crate::places::Folder;
use crate::progress::Progress;
use crate::screen::{self, short};

/// Options of `papers`.
#[derive(Args)]
pub(crate) struct Arguments {
    /// Write each plot of the papers as an SVG picture into this folder: figures 5 to 15 of A, 8 to 11 of C, table 2 of D.
    #[arg(long, value_name = "DIR")]
    report: Option<PathBuf>,
    /// Print one comparison instead: paper D's curve as fine straight moves, fitted, and as the NURBS, on one servo.
    #[arg(long, conflicts_with = "report")]
    contour: bool,
    #[command(flatten)]
    output: output::Output,
}

/// Computes and prints.
pub(crate) fn run(arguments: &Arguments) -> Result<Ending> {
    let folder = arguments.report.as_deref().map(|path| Folder::named("--report", path)).transpose()?;
    let place = arguments.output.place()?;
    let progress = Progress::spinning("computing the papers' figures");
    let text = if arguments.contour {
        let rows = contour_table()?;
        progress.finish();
        if arguments.output.json { serde_json::to_string_pretty(&rows)? + "\n" } else { contour(&rows) }
    } else {
        let figures = paper_figures()?;
        progress.finish();
        folder.as_ref().map_or(Ok(()), |folder| write_pictures(&figures, folder))?;
        if arguments.output.json {
            serde_json::to_string_pretty(&figures.rows)? + "\n"
        } else {
            shown(&figures.rows)
        }
    };
    output::write(&place, &text)?;
    Ok(Ending::Good)
}

/// Each picture as a file of its own.
fn write_pictures(figures: &PaperFigures, folder: &Folder) -> Result<()> {
    let file = |picture: &Figure| (format!("{}.svg", picture.name), picture.file() + "\n");
    let files: Vec<(String, String)> = figures.pictures.iter().map(file).collect();
    let files: Vec<(&str, &str)> = files.iter().map(|(name, text)| (name.as_str(), text.as_str())).collect();
    folder.write(&files).context("the pictures")?;
    output::note(&format!("{} pictures are in {}", files.len(), folder.path().display()));
    Ok(())
}

/// A table for each paper, and below it the settings and reasons, each said once.
fn shown(rows: &[Row]) -> String {
    let papers = rows.chunk_by(|a, b| a.paper == b.paper);
    papers.map(paper).collect::<Vec<_>>().join("\n")
}

fn paper(rows: &[Row]) -> String {
    let mut notes: Vec<&str> = Vec::new();
    let mut note = |text: &'static str| -> String {
        if text.is_empty() {
            return String::new();
        }
        let at = notes.iter().position(|known| *known == text).unwrap_or_else(|| {
            notes.push(text);
            notes.len() - 1
        });
        (at + 1).to_string()
    };
    let lines = rows.iter().map(|row| {
        let [setting, reason] = [note(row.setting), note(row.reason)];
        let is_off = !row.agrees() && !reason.is_empty();
        vec![
            row.place.to_string(),
            labelled_quantity(row),
            printed(row),
            figure(row.measured),
            setting,
            if is_off { reason } else { String::new() },
        ]
    });
    let lines: Vec<_> = lines.collect();
    let title = screen::answer(&format!("Paper {}", rows.first().map_or('A', |row| row.paper)));
    let table = screen::table(&["place", "quantity", "printed", "here", "set-\nting", "why"], lines);
    let notes: String =
        notes.iter().enumerate().map(|(at, text)| screen::labelled(&format!("{}  ", at + 1), text)).collect();
    [title, table, notes].concat()
}

/// A number with five digits; a small or large one with three and a power of ten.
fn figure(number: f64) -> String {
    let size = number.abs();
    if size != 0.0 && !(1e-3..1e6).contains(&size) { format!("{number:.2e}") } else { short(number) }
}

fn labelled_quantity(row: &Row) -> String {
    if row.unit.is_empty() { row.quantity.clone() } else { format!("{} [{}]", row.quantity, row.unit) }
}

fn printed(row: &Row) -> String {
    match row.printed {
        Printed::Number(number) => figure(number),
        Printed::AtMost(most) => format!("≤ {}", figure(most)),
        Printed::Words(words) => words.to_string(),
    }
}

fn contour(rows: &[ContourRow]) -> String {
    let lines = rows.iter().map(|row| {
        vec![
            row.path.to_string(),
            row.curves.to_string(),
            short(row.time_s),
            short(row.setpoint_error_mm * 1000.0),
            short(row.contour_error_mm * 1000.0),
            short(row.contour_error_rms_mm * 1000.0),
            row.printed_mm.map_or_else(String::new, |mm| short(mm * 1000.0)),
        ]
    });
    let header =
        ["paper D's curve as", "curves", "time\ns", "setpoints\nµm", "table\nµm", "rms\nµm", "printed\nµm"];
    let about = screen::paragraph(
        "Largest distance from the NURBS, of the setpoints and of the table, and its root mean square. All are planned alike, \
         F4000, T 1 ms, A 1000 mm/s² along and across, corners of moves passed within 0.01 mm, and run through the drive of \
         table 2, part d. The paper prints 10 and 1 µm for a part that it does not name.",
    );
    [about, screen::table(&header, lines.collect())].join("\n")
}
