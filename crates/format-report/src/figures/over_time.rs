//! Values of periods as points of a figure.

/// A point for each period: its value against time in s. The first is at the end of the first period.
pub(super) fn over_time(values: &[f64], period_s: f64) -> Vec<(f64, f64)> {
    values.iter().enumerate().map(|(index, value)| ((index + 1) as f64 * period_s, *value)).collect()
}
