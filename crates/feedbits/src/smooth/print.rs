//! A report on smoothing for the terminal.

use path_smooth::{CornerKind, CornerRow, LEAST_LOOPED_DEG, Lambda, Report};

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
    text += &shape_factor(report);
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

/// The time and the radii beside those of λ = 1; nothing if λ is 1.
fn shape_factor(report: &Report) -> String {
    let Some(plain) = &report.with_lambda_1 else { return String::new() };
    let asked = match report.lambda {
        Lambda::Given(lambda) => short(lambda),
        Lambda::Auto(word) => word.to_string(),
    };
    let gained = plain.time_s - report.smoothed.time_s;
    let gain = match gained {
        0.0 => "the same time as with 1".to_string(),
        gained => {
            let word = if gained > 0.0 { "less" } else { "more" };
            format!(
                "{:.3} s {word} than with 1, {:.2} % of {}",
                gained.abs(),
                100.0 * gained.abs() / plain.time_s,
                duration(plain.time_s)
            )
        }
    };
    let ratios: Vec<f64> = report
        .corners
        .iter()
        .filter_map(|row| Some(row.least_radius_mm? / row.with_lambda_1?.least_radius_mm))
        .collect();
    let another = report.corners.iter().filter(|row| row.lambda.is_some_and(|lambda| lambda != 1.0)).count();
    // The geometric mean: a ratio and its inverse cancel.
    let mean = (ratios.iter().map(|ratio| ratio.ln()).sum::<f64>() / ratios.len().max(1) as f64).exp();
    let best = ratios.iter().copied().fold(0.0, f64::max);
    labelled(
        "λ           ",
        &format!(
            "{asked}: {gain}; {} with another λ than 1, least radii {:+.1} % in the mean, {:+.1} % at most",
            counted(another, "corner", "corners"),
            100.0 * (mean - 1.0),
            100.0 * (best - 1.0)
        ),
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
    let mut header = header.to_vec();
    let mut cells: Vec<Vec<String>> = rows.iter().map(cells).collect();
    if wide && rows.iter().any(|row| row.with_lambda_1.is_some()) {
        header.extend(["λ", "radius\nmm", "with λ = 1\nmm", "feed with λ = 1\nmm/s"]);
        for (row, cells) in rows.iter().zip(&mut cells) {
            cells.extend(shape_cells(row));
        }
    }
    if wide {
        return screen::wide_table(&header, cells, &[5]);
    }
    header[7] = "before\nmm/s";
    let first = rows.first().map_or(0.0, |row| row.point_mm[2]);
    if rows.iter().all(|row| row.point_mm[2] == first) {
        header.remove(3);
        cells.iter_mut().for_each(|row| drop(row.remove(3)));
    }
    screen::table(&header, cells)
}

/// λ, the least radius, and radius and feed with λ = 1.
fn shape_cells(row: &CornerRow) -> [String; 4] {
    let of = |value: Option<f64>, digits: usize| {
        value.map_or_else(String::new, |value| format!("{value:.digits$}"))
    };
    let plain = row.with_lambda_1;
    [
        of(row.lambda, 3),
        of(row.least_radius_mm, 5),
        of(plain.map(|plain| plain.least_radius_mm), 5),
        of(plain.map(|plain| plain.feed_after_mm_per_s), 2),
    ]
}
