//! The result of smoothing: each corner, and the totals.

use std::collections::BTreeMap;

use nurbs_core::CornerLambda;
use part_program::Machine;
use serde::Serialize;

/// How a corner was treated.
#[derive(Clone, Copy, Debug, PartialEq, Eq, Serialize)]
#[serde(rename_all = "snake_case")]
pub enum CornerKind {
    /// Cut off on the inside.
    Cut,
    /// Passed by a loop: the path leaves the corner along the first move and comes back along the second.
    Loop,
    /// Left sharp.
    Left,
}

/// One corner.
#[derive(Clone, Debug, Serialize)]
pub struct CornerRow {
    /// Line of the block that ends in it.
    pub line: usize,
    /// Its place, in mm.
    pub point_mm: [f64; 3],
    /// Angle by which the direction turns, in degrees.
    pub angle_deg: f64,
    /// How it was treated.
    pub kind: CornerKind,
    /// The reason why it is left sharp, or why it is cut where loops were wanted.
    #[serde(skip_serializing_if = "Option::is_none")]
    pub reason: Option<String>,
    /// Distance from the moves, both ways, in mm, as computed by the smoothing; 0 for a corner that is left sharp.
    pub error_mm: f64,
    /// Distance from the moves, both ways, in mm, as measured: on the curves, or on the straight moves of a program as
    /// they read back.
    pub measured_error_mm: f64,
    /// Feed in the corner when every corner is a stop, in mm/s.
    pub feed_before_mm_per_s: f64,
    /// Lowest feed in the corner of the smoothed path, in mm/s.
    pub feed_after_mm_per_s: f64,
    /// The shape factor λ of its spline; `None` for a corner that is left sharp.
    #[serde(skip_serializing_if = "Option::is_none")]
    pub lambda: Option<f64>,
    /// Least radius of its spline, in mm, at 256 places; `None` for a corner that is left sharp.
    #[serde(skip_serializing_if = "Option::is_none")]
    pub least_radius_mm: Option<f64>,
    /// The same corner with λ = 1, if another λ was asked for.
    #[serde(skip_serializing_if = "Option::is_none")]
    pub with_lambda_1: Option<WithLambda1>,
}

/// A corner as it would be with λ = 1.
#[derive(Clone, Copy, Debug, PartialEq, Serialize)]
pub struct WithLambda1 {
    /// Least radius of its spline, in mm, at 256 places.
    pub least_radius_mm: f64,
    /// Lowest feed in the corner, in mm/s.
    pub feed_after_mm_per_s: f64,
}

/// The shape factor λ that was asked for: in JSON a number, or `auto`.
#[derive(Clone, Copy, Debug, PartialEq, Serialize)]
#[serde(untagged)]
pub enum Lambda {
    /// One λ for all corners.
    Given(f64),
    /// Each corner has its own: the word `auto`.
    Auto(&'static str),
}

impl From<CornerLambda> for Lambda {
    fn from(lambda: CornerLambda) -> Self {
        match lambda {
            CornerLambda::Given(lambda) => Self::Given(lambda),
            CornerLambda::Auto => Self::Auto("auto"),
        }
    }
}

/// The setpoints of the smoothed path, interpolated in f64.
#[derive(Clone, Copy, Debug, Default, Serialize)]
pub struct SetpointCheck {
    /// Their number.
    pub count: usize,
    /// Largest distance from the smoothed path, in mm. The corners of that path are evaluated by sine and cosine.
    pub off_path_mm_max: f64,
    /// Largest distance from the program's moves, in mm.
    pub off_moves_mm_max: f64,
    /// Largest distance of the chord between two setpoints from the smoothed path, in mm.
    pub chord_error_mm_max: f64,
    /// Largest acceleration in any direction, in mm/s²: the second difference of setpoints over T².
    pub total_acceleration_max_mm_per_s2: f64,
    /// Whether every stretch was followed to its end.
    pub finished: bool,
}

/// The two forms of the corners: by sine and cosine, and as the polynomials that real time evaluates.
#[derive(Clone, Copy, Debug, Default, Serialize)]
pub struct Forms {
    /// Degree of the polynomials; 0 if no corner is smoothed.
    pub polynomial_degree: usize,
    /// Number of polynomials of all corners.
    pub polynomials: usize,
    /// Largest distance between the two forms at the same parameter, in mm, both evaluated in f64.
    pub distance_mm_max: f64,
    /// Proven bound of that distance, in mm, without rounding.
    pub distance_bound_mm: f64,
    /// Operations for a point by sine and cosine.
    pub trigonometric_operations: u64,
    /// Operations for a point of a compiled piece.
    pub polynomial_operations: u64,
}

/// The whole result.
#[derive(Clone, Debug, Serialize)]
pub struct Report {
    /// Name of the part.
    pub part: String,
    /// Largest distance allowed between the two paths, in mm.
    pub tolerance_mm: f64,
    /// The machine that both paths are planned for.
    pub machine: Machine,
    /// Moves of the part; each side of a polygon is one.
    pub moves: usize,
    /// Number of stretches, each from rest to rest.
    pub stretches: usize,
    /// Corners that are cut.
    pub cuts: usize,
    /// Corners that are looped.
    pub loops: usize,
    /// Outer corners that are cut because they are too shallow for a loop.
    pub shallow: usize,
    /// Number of corners that are left sharp, by reason.
    pub left: BTreeMap<String, usize>,
    /// The form of the path whose distance from the program is measured.
    pub measured: Measured,
    /// Largest distance between the two paths, both ways, in mm.
    pub error_mm_max: f64,
    /// The path with a stop at every corner.
    pub exact_stop: PathSummary,
    /// The smoothed path.
    pub smoothed: PathSummary,
    /// The shape factor λ that was asked for.
    pub lambda: Lambda,
    /// The path smoothed with λ = 1, if another λ was asked for.
    #[serde(skip_serializing_if = "Option::is_none")]
    pub with_lambda_1: Option<PathSummary>,
    /// The time of the path with stops over that of the smoothed path: below 1 if smoothing makes it slower.
    pub speedup: f64,
    /// The corners' two forms.
    pub forms: Forms,
    /// The setpoints of the smoothed path.
    pub setpoints: SetpointCheck,
    /// Every corner, in the order of the path.
    pub corners: Vec<CornerRow>,
}

/// The form of the path whose distance a report states.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq, Serialize)]
#[serde(rename_all = "snake_case")]
pub enum Measured {
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
pub struct PathSummary {
    /// The number of its curves.
    pub curves: usize,
    /// Its length, in mm.
    pub length_mm: f64,
    /// The time that it takes, in s.
    pub time_s: f64,
}

/// Largest distance of a setpoint from its path, in mm: twice the largest error of the polynomials, and rounding.
const ON_PATH_MM: f64 = 1e-8;

impl Report {
    /// The promises of smoothing that are broken; empty if all are kept.
    #[must_use]
    pub fn faults(&self) -> Vec<String> {
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
}
