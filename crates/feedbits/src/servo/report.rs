//! The results of a simulation: each format, the circle test and the tuning table.

use format_compare::Engine;
use serde::Serialize;
use servo_sim::{Arrival, ErrorSize, Roundness, ServoParameters, TuningRow};

/// The JSON of the results.
#[derive(Serialize)]
pub(super) struct Report {
    pub(super) part: String,
    pub(super) interpolation_period_ms: f64,
    pub(super) servo: ServoParameters,
    pub(super) formats: Vec<FormatRow>,
    pub(super) circle: CircleReport,
    pub(super) tuning: Vec<TuningRow>,
    /// The settings of the table that do not make a circle.
    pub(super) tuning_left_out: Vec<LeftOut>,
}

/// The part in one format, by one engine.
#[derive(Serialize)]
pub(super) struct FormatRow {
    pub(super) format: String,
    pub(super) engine: Engine,
    #[serde(flatten)]
    pub(super) outcome: Outcome,
}

#[derive(Serialize)]
#[serde(rename_all = "snake_case", untagged)]
pub(super) enum Outcome {
    Ran {
        /// Distance of the setpoints from the curve.
        setpoint_error_mm: ErrorSize,
        /// Command minus table, for each axis.
        following_error_mm: Vec<ErrorSize>,
        /// Distance of the table from the curve.
        contour_error_mm: ErrorSize,
        reached_the_end: bool,
        arrival: Arrival,
        /// The reason if the contour error has no meaning.
        #[serde(skip_serializing_if = "Option::is_none")]
        does_not_follow: Option<String>,
    },
    /// The reason why the format was not run.
    Refused { refused: String },
}

#[derive(Serialize)]
pub(super) struct CircleReport {
    pub(super) radius_mm: f64,
    pub(super) feedrate_mm_per_min: f64,
    #[serde(flatten)]
    pub(super) result: CircleResult,
}

#[derive(Serialize)]
#[serde(untagged)]
pub(super) enum CircleResult {
    Round(Roundness),
    /// The reason why there is no circle to judge.
    DoesNotFollow {
        does_not_follow: String,
    },
}

/// Settings of one velocity gain that do not make a circle, all for the same reason.
#[derive(Serialize)]
pub(super) struct LeftOut {
    pub(super) velocity_gain_percent: f64,
    pub(super) feed_forwards: Vec<f64>,
    pub(super) reason: String,
}
