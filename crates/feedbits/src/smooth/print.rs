//! A report on smoothing for the terminal.

use path_smooth::{CornerKind, CornerRow, LEAST_LOOPED_DEG, Report};

use crate::output::counted;
use crate::plan::in_all_directions;
use crate::screen::{self, duration, labelled, short};

/// The report for the terminal: the gain in time, the distance from the moves, the totals, and every corner if they are
/// few, otherwise the slowest.
pub(super) fn text(report: &Report, wide: bool) -> String {
    const MOST_ROWS: usize = 30;
    const SLOWEST: usize = 10;
    let mut text = answer(report) + "\n" + &totals(report);
    let mut rows: Vec<&CornerRow> = report.corners.iter().collect();
    if !rows.is_empty() {
        text += "\n";
    }
    if rows.len() > MOST_ROWS && !wide {
        rows.retain(|row| row.kind != CornerKind::Left);
        rows.sort_by(|a, b| a.feed_after_mm_per_s.total_cmp(&b.feed_after_mm_per_s));
        rows.truncate(SLOWEST);
        text += &format!("The {} slowest of the smoothed corners (--wide lists all):\n", rows.len());
    }
    text + &table(&rows, wide)
}

/// The time saved, the cost of it, and any promise that is broken.
fn answer(report: &Report) -> String {
    let faults = report.faults();
    let what = format!(
        "{} smoothed, {} with a stop at every corner: {:.2} times as fast.",
        duration(report.smoothed.time_s),
        duration(report.exact_stop.time_s),
        report.speedup
    );
    let of = format!(
        "{}: {} in {} from rest to rest, {}; tolerance {} mm",
        screen::file_name(&report.part),
        counted(report.moves, "move", "moves"),
        counted(report.stretches, "stretch", "stretches"),
        counted(report.corners.len(), "corner", "corners"),
        short(report.tolerance_mm)
    );
    let broken = faults.iter().map(|fault| screen::paragraph(&format!("not met: {fault}")));
    screen::answer(&what) + &broken.collect::<String>() + &screen::paragraph(&of)
}

/// The totals, and the figures of the setpoints.
fn totals(report: &Report) -> String {
    let left: usize = report.left.values().sum();
    let reasons: Vec<_> = report.left.iter().map(|(reason, count)| format!("{count} {reason}")).collect();
    let reasons = if reasons.is_empty() { String::new() } else { format!(" ({})", reasons.join(", ")) };
    let shallow = match report.shallow {
        0 => String::new(),
        count => format!(" ({count} outer, but of less than {LEAST_LOOPED_DEG}°)"),
    };
    let mut text = labelled(
        "corners     ",
        &format!("{} cut{shallow}, {} looped, {left} left{reasons}", report.cuts, report.loops),
    );
    text += &labelled(
        "distance    ",
        &format!(
            "{} mm at most of {} mm, measured both ways on {}",
            small(report.error_mm_max),
            small(report.tolerance_mm),
            report.measured
        ),
    );
    if report.cuts + report.loops > 0 {
        let forms = &report.forms;
        text += &labelled(
            "real time   ",
            &format!(
                "{} polynomials of degree {}, {:.1e} mm from sine and cosine (proven: {:.1e}); {} operations a point in place of {}",
                forms.polynomials,
                forms.polynomial_degree,
                forms.distance_mm_max,
                forms.distance_bound_mm,
                forms.polynomial_operations,
                forms.trigonometric_operations
            ),
        );
    }
    text += &labelled(
        "setpoints   ",
        &format!(
            "{} in f64, at most {:.1e} mm off the smoothed path and {} mm off the program; chord error {:.1e} mm",
            report.setpoints.count,
            report.setpoints.off_path_mm_max,
            small(report.setpoints.off_moves_mm_max),
            report.setpoints.chord_error_mm_max
        ),
    );
    text + &in_all_directions(
        report.setpoints.total_acceleration_max_mm_per_s2,
        report.machine.acceleration_mm_per_s2,
        report.machine.centripetal_acceleration_mm_per_s2.is_none(),
    )
}

/// A length that may be far below a micrometre.
fn small(mm: f64) -> String {
    if mm > 0.0 && mm < 1e-4 { format!("{mm:.1e}") } else { format!("{mm:.6}") }
}

/// The table of corners. It has z only if the corners differ in z. It fits 80 columns unless it may be wide.
fn table(rows: &[&CornerRow], wide: bool) -> String {
    let header = [
        "line",
        "x\nmm",
        "y\nmm",
        "z\nmm",
        "angle\n°",
        "corner",
        "error\nmm",
        "feed before\nmm/s",
        "after\nmm/s",
    ];
    let cells = |row: &&CornerRow| {
        let [x, y, z] = row.point_mm.map(|x| format!("{x:.3}"));
        let kind = match (row.kind, &row.reason) {
            (CornerKind::Cut, None) => "cut".to_string(),
            (CornerKind::Cut, Some(reason)) => format!("cut: {reason}"),
            (CornerKind::Loop, _) => "loop".to_string(),
            (CornerKind::Left, reason) => format!("left: {}", reason.as_deref().unwrap_or_default()),
        };
        vec![
            row.line.to_string(),
            x,
            y,
            z,
            format!("{:.2}", row.angle_deg),
            kind,
            format!("{:.5}", row.measured_error_mm),
            format!("{:.2}", row.feed_before_mm_per_s),
            format!("{:.2}", row.feed_after_mm_per_s),
        ]
    };
    let mut cells: Vec<Vec<String>> = rows.iter().map(cells).collect();
    if wide {
        return screen::wide_table(&header, cells, &[5]);
    }
    let mut header = header.to_vec();
    header[7] = "before\nmm/s";
    let first = rows.first().map_or(0.0, |row| row.point_mm[2]);
    if rows.iter().all(|row| row.point_mm[2] == first) {
        header.remove(3);
        cells.iter_mut().for_each(|row| drop(row.remove(3)));
    }
    screen::table(&header, cells)
}
