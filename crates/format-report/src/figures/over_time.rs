//! Values of periods as points of a figure.

/// A value a period against time in s; the first is that of the first period's end.
pub(super) fn over_time(values: &[f64], period_s: f64) -> Vec<(f64, f64)> {
    values.iter().enumerate().map(|(index, value)| ((index + 1) as f64 * period_s, *value)).collect()
}
