//! Values of a trace as points of a figure.

use format_compare::Trace;

/// A point for each entry of a trace: its value against the time at its end, in s.
pub(super) fn over_time(trace: &Trace, values: &[f64], period_s: f64) -> Vec<(f64, f64)> {
    trace.end.iter().zip(values).map(|(end, value)| (*end as f64 * period_s, *value)).collect()
}
