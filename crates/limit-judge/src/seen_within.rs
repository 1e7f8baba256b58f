//! How far a motion may be from the setpoints of a run.

/// The distance r within which a run of ours is judged, in mm: `r = max(q/2 + δ/2, i/2)`.
///
/// Symbols: `half_place_mm` is q/2, half of a setpoint's last place; `fluctuation_mm` is δ, by how much a full step may be too long or too
/// short; `increment_mm` is i, what the drives resolve, where a machine states more than is taken otherwise.
#[must_use]
pub fn seen_within_mm(half_place_mm: f64, fluctuation_mm: f64, increment_mm: Option<f64>) -> f64 {
    let own = half_place_mm + 0.5 * fluctuation_mm;
    increment_mm.map_or(own, |increment| own.max(0.5 * increment))
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn a_coarse_drive_hides_more_than_a_fluctuation() {
        assert_eq!(seen_within_mm(1.0, 4.0, None), 3.0);
        assert_eq!(seen_within_mm(1.0, 4.0, Some(5.0)), 3.0);
        assert_eq!(seen_within_mm(1.0, 4.0, Some(8.0)), 4.0);
    }
}
