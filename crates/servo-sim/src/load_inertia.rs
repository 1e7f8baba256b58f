//! The velocity gain that a load needs: a heavier load takes more torque for the same acceleration.

/// The velocity gain in per cent for a load of this inertia, in 256ths of the motor's: `(1 + inertia/256) · 100`.
///
/// # Source
/// FANUC's parameter 2021. Paper D, section 3.2, has one pair of it: 512 and 300 %.
#[must_use]
pub fn velocity_gain_of_load_inertia(load_inertia_256ths: f64) -> f64 {
    (1.0 + load_inertia_256ths / 256.0) * 100.0
}
