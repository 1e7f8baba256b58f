//! The curve of the examples, and limits for it.

use feed_plan::KinematicLimits;
use nurbs_core::{CurveError, NurbsBuf};

/// A path with an inflection: a cubic of five control points, 100 mm wide.
///
/// # Errors
/// None: the curve is valid.
pub fn curve() -> Result<NurbsBuf<f64, 2>, CurveError> {
    let points = vec![[0.0, 0.0], [25.0, 60.0], [50.0, 0.0], [75.0, -60.0], [100.0, 0.0]];
    let (weights, knots) = (vec![1.0; 5], vec![0.0, 0.0, 0.0, 0.0, 0.5, 1.0, 1.0, 1.0, 1.0]);
    NurbsBuf::try_new(3, points, weights, knots)
}

/// 100 mm/s, 1 m/s², 50 m/s³ and a chord error of 1 µm, in mm and periods of 1 ms: feeds are multiplied by T, accelerations
/// by T² and jerks by T³.
#[must_use]
pub fn limits() -> KinematicLimits<f64> {
    let t = 1e-3;
    KinematicLimits {
        interpolation_period: 1.0,
        feedrate: 100.0 * t,
        acceleration: 1000.0 * t * t,
        jerk: 50_000.0 * t * t * t,
        chord_error: 0.001,
        centripetal_acceleration: None,
        axes: Default::default(),
        junction: Default::default(),
    }
}
