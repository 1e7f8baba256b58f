//! The feed at which the chord of one period leaves the curve by no more than allowed.

use real::Real;

/// Largest feedrate whose chord error stays within `max_chord_error`.
///
/// A chord of length `L = V T` on a circle of radius ρ leaves the arc by `E = ρ - √(ρ² - (L/2)²)`; solved for
/// V: `V = (2/T) √(E (2ρ - E))`. For `ρ ≤ E` no chord leaves the circle by more than E, and the formula,
/// which falls again, has no meaning: the limit is then `2ρ/T`, a step no longer than the diameter. The two
/// branches meet at `ρ = E` with equal slopes.
///
/// Units: `radius` ρ and `max_chord_error` E in mm, `interpolation_period` T in the caller's unit of time.
/// Domain: all three positive; `V` must fit the format. Anything else gives a value without meaning, never a
/// panic.
///
/// # Source
/// Paper A (Wang Yunsen et al.), section 2.1.2, which prints T/2 for 2/T.
pub fn chord_feedrate<R: Real>(radius: R, max_chord_error: R, interpolation_period: R) -> R {
    let half_chord = if radius <= max_chord_error {
        radius
    } else {
        // E (2ρ - E) as 2E (ρ - E/2): no intermediate exceeds the larger of ρ and the result's square.
        ((max_chord_error + max_chord_error) * (radius - max_chord_error.half())).sqrt()
    };
    (half_chord + half_chord) / interpolation_period
}

#[cfg(test)]
mod tests {
    use super::*;
    use proptest::prelude::*;

    proptest! {
        #[test]
        fn the_step_has_the_chord_error_asked_for(radius in 0.01..1e4_f64, share in 1e-6..0.9_f64, period in 1e-4..1e-1_f64) {
            let error = share * radius;
            let half_chord = chord_feedrate(radius, error, period) * period / 2.0;
            let angle = (half_chord / radius).asin();
            let measured = 2.0 * radius * (angle / 2.0).sin().powi(2); // ρ (1 - cos) without cancellation
            prop_assert!((measured / error - 1.0).abs() < 1e-9, "{measured} against {error}");
        }
    }

    #[test]
    fn below_the_chord_error_the_step_is_the_diameter() {
        assert_eq!(chord_feedrate(0.25, 0.5, 2.0), 0.25);
        let (below, above) = (chord_feedrate(0.5, 0.5, 1.0), chord_feedrate(0.5 + 1e-9, 0.5, 1.0));
        assert!((above - below - 2e-9).abs() < 1e-12, "{below} {above}");
    }
}
