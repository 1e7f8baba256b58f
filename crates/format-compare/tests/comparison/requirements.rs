//! Requirements of a run.

use crate::examples::{judged, mill};

/// A print of 42 m of filament: at an absolute E of that size, f32 has steps of 4 µm, and 32 bits of fixed point
/// steps of 31 nm.
#[test]
fn the_filament_of_a_long_print_is_judged_like_a_position() {
    let step = |format: &str| {
        let print = "G21 M82\nG0 X0 Y0 Z0\nG92 E41990\nG1 X10 E42000 F3000\n";
        let run = judged(&mill::<2>(print, "position_increment_mm = 0.001\n"), &[format]).remove(0);
        let own = run.requirements.iter().find(|one| one.what == "step of the filament's position");
        own.map(|own| (own.found, own.holds())).unwrap()
    };
    assert_eq!(step("f32"), (2.0_f64.powi(-8), false));
    assert_eq!(step("I4F28"), (2.0_f64.powi(13 - 28), true));
    assert!(step("f64").1);
}
