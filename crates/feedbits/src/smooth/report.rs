//! What smoothing did: each corner, and the totals.

use std::collections::BTreeMap;

use part_program::Machine;
use serde::Serialize;

use super::smooth_stretch::LEAST_LOOPED_DEG;
use crate::output::counted;
use crate::screen::{self, duration, labelled, short};

/// What became of a corner.
#[derive(Clone, Copy, Debug, PartialEq, Eq, Serialize)]
#[serde(rename_all = "snake_case")]
pub(crate) enum Kind {
    Cut,
    Loop,
    Left,
}

/// One corner.
#[derive(Clone, Debug, Serialize)]
pub(crate) struct CornerRow {
    /// Line of the block that ends in it.
    pub(crate) line: usize,
    pub(crate) point_mm: [f64; 3],
    /// Angle by which the direction turns.
    pub(crate) angle_deg: f64,
    pub(crate) kind: Kind,
    /// Why it is left, or cut where loops were wanted.
    #[serde(skip_serializing_if = "Option::is_none")]
    pub(crate) reason: Option<String>,
    /// Distance from the moves, both ways, as the smoothing found it; 0 of one that is left.
    pub(crate) error_mm: f64,
    /// The same, as measured: on the curves, or on the straight moves of a program as they read back.
    pub(crate) measured_error_mm: f64,
    /// Feed in the corner when every corner is a stop.
    pub(crate) feed_before_mm_per_s: f64,
    /// Lowest feed in the corner of the smoothed path.
    pub(crate) feed_after_mm_per_s: f64,
}

/// The setpoints of the smoothed path, interpolated in f64.
#[derive(Clone, Copy, Debug, Default, Serialize)]
pub(crate) struct SetpointCheck {
    pub(crate) count: usize,
    /// Largest distance from the smoothed path, its corners by sine and cosine.
    pub(crate) off_path_mm_max: f64,
    /// Largest distance from the program's moves.
    pub(crate) off_moves_mm_max: f64,
    /// Largest distance of the chord between two setpoints from the smoothed path.
    pub(crate) chord_error_mm_max: f64,
    /// Largest acceleration in any direction, in mm/s²: the second difference of setpoints over T².
    pub(crate) total_acceleration_max_mm_per_s2: f64,
    /// Whether every stretch was followed to its end.
    pub(crate) finished: bool,
}

/// The corners' two forms: by sine and cosine, and as the polynomials that real time evaluates.
#[derive(Clone, Copy, Debug, Default, Serialize)]
pub(crate) struct Forms {
    pub(crate) polynomial_degree: usize,
    /// Polynomials of all corners.
    pub(crate) polynomials: usize,
    /// Largest distance of the two forms at the same parameter, both evaluated in f64.
    pub(crate) distance_mm_max: f64,
    /// Proven bound of it, but for rounding.
    pub(crate) distance_bound_mm: f64,
    /// Operations for a point by sine and cosine.
    pub(crate) trigonometric_operations: u64,
    /// Operations for a point of a compiled piece.
    pub(crate) polynomial_operations: u64,
}

/// The whole result.
#[derive(Clone, Debug, Serialize)]
pub(crate) struct Report {
    pub(crate) part: String,
    pub(crate) tolerance_mm: f64,
    pub(crate) machine: Machine,
    pub(crate) moves: usize,
    /// Runs of moves from rest to rest.
    pub(crate) stretches: usize,
    pub(crate) cuts: usize,
    pub(crate) loops: usize,
    /// Outer corners among the cuts that are too shallow for a loop.
    pub(crate) shallow: usize,
    /// Corners that are left, by reason.
    pub(crate) left: BTreeMap<String, usize>,
    /// Whose distance from the program is measured.
    pub(crate) measured: Measured,
    /// Largest distance between the two paths, both ways.
    pub(crate) error_mm_max: f64,
    pub(crate) exact_stop: Path,
    pub(crate) smoothed: Path,
    /// How many times as fast the smoothed path is: below 1 if it is slower.
    pub(crate) speedup: f64,
    pub(crate) forms: Forms,
    pub(crate) setpoints: SetpointCheck,
    pub(crate) corners: Vec<CornerRow>,
}

/// Of what a report states the distance.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq, Serialize)]
#[serde(rename_all = "snake_case")]
pub(crate) enum Measured {
    /// The smoothed curves.
    #[default]
    Curves,
    /// The straight moves of the program that was written, as they read back.
    StraightMoves,
}

impl std::fmt::Display for Measured {
    fn fmt(&self, f: &mut std::fmt::Formatter<'_>) -> std::fmt::Result {
        f.write_str(match self {
            Self::Curves => "the curves",
            Self::StraightMoves => "the straight moves, as they read back",
        })
    }
}

/// One of the two paths, planned from rest to rest stretch by stretch.
#[derive(Clone, Copy, Debug, Default, Serialize)]
pub(crate) struct Path {
    pub(crate) curves: usize,
    pub(crate) length_mm: f64,
    pub(crate) time_s: f64,
}

/// Largest distance of a setpoint from the path that it is on, in mm: twice what the polynomials may be off, and rounding.
const ON_PATH_MM: f64 = 1e-8;

impl Report {
    /// What is broken; nothing if all is well.
    pub(crate) fn faults(&self) -> Vec<String> {
        let mut faults = Vec::new();
        let mut demand = |holds: bool, fault: String| {
            if !holds {
                faults.push(fault);
            }
        };
        let (error, tolerance) = (self.error_mm_max, self.tolerance_mm);
        demand(error <= tolerance, format!("the path is {error:.3e} mm off, more than {tolerance} mm"));
        let setpoints = &self.setpoints;
        let off = setpoints.off_path_mm_max;
        demand(
            off <= self.forms.distance_bound_mm + ON_PATH_MM,
            format!("a setpoint is {off:.3e} mm off the path"),
        );
        let off = setpoints.off_moves_mm_max;
        demand(off <= tolerance, format!("a setpoint is {off:.3e} mm off the program's moves"));
        demand(setpoints.finished, "interpolation stops before the end".into());
        faults
    }

    /// The report for the terminal: how much faster and how far off, the totals, and every corner if they are few, else the slowest.
    pub(crate) fn text(&self, wide: bool) -> String {
        const MOST_ROWS: usize = 30;
        const SLOWEST: usize = 10;
        let mut text = self.answer() + "\n" + &self.totals();
        let mut rows: Vec<&CornerRow> = self.corners.iter().collect();
        if !rows.is_empty() {
            text += "\n";
        }
        if rows.len() > MOST_ROWS && !wide {
            rows.retain(|row| row.kind != Kind::Left);
            rows.sort_by(|a, b| a.feed_after_mm_per_s.total_cmp(&b.feed_after_mm_per_s));
            rows.truncate(SLOWEST);
            text += &format!("The {} slowest of the smoothed corners (--wide lists all):\n", rows.len());
        }
        text + &table(&rows, wide)
    }

    /// What is won, what it takes, and what is broken.
    fn answer(&self) -> String {
        let faults = self.faults();
        let what = format!(
            "{} smoothed, {} with a stop at every corner: {:.2} times as fast.",
            duration(self.smoothed.time_s),
            duration(self.exact_stop.time_s),
            self.speedup
        );
        let of = format!(
            "{}: {} in {} from rest to rest, {}; tolerance {} mm",
            screen::file_name(&self.part),
            counted(self.moves, "move", "moves"),
            counted(self.stretches, "stretch", "stretches"),
            counted(self.corners.len(), "corner", "corners"),
            short(self.tolerance_mm)
        );
        let broken = faults.iter().map(|fault| screen::paragraph(&format!("not met: {fault}")));
        screen::answer(&what) + &broken.collect::<String>() + &screen::paragraph(&of)
    }

    fn totals(&self) -> String {
        let left: usize = self.left.values().sum();
        let reasons: Vec<_> = self.left.iter().map(|(reason, count)| format!("{count} {reason}")).collect();
        let reasons = if reasons.is_empty() { String::new() } else { format!(" ({})", reasons.join(", ")) };
        let shallow = match self.shallow {
            0 => String::new(),
            count => format!(" ({count} outer, but of less than {LEAST_LOOPED_DEG}°)"),
        };
        let mut text = labelled(
            "corners     ",
            &format!("{} cut{shallow}, {} looped, {left} left{reasons}", self.cuts, self.loops),
        );
        text += &labelled(
            "distance    ",
            &format!(
                "{} mm at most of {} mm, measured both ways on {}",
                small(self.error_mm_max),
                small(self.tolerance_mm),
                self.measured
            ),
        );
        if self.cuts + self.loops > 0 {
            let forms = &self.forms;
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
                self.setpoints.count,
                self.setpoints.off_path_mm_max,
                small(self.setpoints.off_moves_mm_max),
                self.setpoints.chord_error_mm_max
            ),
        );
        text + &crate::plan::in_all_directions(
            self.setpoints.total_acceleration_max_mm_per_s2,
            self.machine.acceleration_mm_per_s2,
            self.machine.centripetal_acceleration_mm_per_s2.is_none(),
        )
    }
}

/// A length that may be far below a micrometre.
fn small(mm: f64) -> String {
    if mm > 0.0 && mm < 1e-4 { format!("{mm:.1e}") } else { format!("{mm:.6}") }
}

/// The corners; z only where it is not the same in all of them, and in 80 columns if they need not be wide.
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
            (Kind::Cut, None) => "cut".to_string(),
            (Kind::Cut, Some(reason)) => format!("cut: {reason}"),
            (Kind::Loop, _) => "loop".to_string(),
            (Kind::Left, reason) => format!("left: {}", reason.as_deref().unwrap_or_default()),
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
