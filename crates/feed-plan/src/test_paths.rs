//! Limits and curves for tests.

use crate::KinematicLimits;

/// Wang Y. et al.: T = 3 ms, F = 200 mm/s, A = 5000 mm/s², J = 4e5 mm/s³, E = 0.5 µm, with T as the unit of time.
pub(crate) fn paper_limits() -> KinematicLimits<f64> {
    in_periods(3e-3, 200.0, 5000.0, 4e5, 5e-4)
}

/// Limits given in seconds, with the period as the unit of time.
pub(crate) fn in_periods(
    t: f64,
    feedrate: f64,
    acceleration: f64,
    jerk: f64,
    chord_error: f64,
) -> KinematicLimits<f64> {
    KinematicLimits {
        interpolation_period: 1.0,
        feedrate: feedrate * t,
        acceleration: acceleration * t * t,
        jerk: jerk * t * t * t,
        chord_error,
        centripetal_acceleration: None,
    }
}
