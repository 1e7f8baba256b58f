//! The code of the book, docs/kernels.md, that no example of a library has. `scripts/docs` holds the book to it.

use secant_interp::{LaneInterpolator, PieceInterpolator};

#[allow(unreachable_pub, reason = "it is written for any program")]
mod holes {
    include!("constants/holes_f64.rs");
}

#[test]
fn lanes_end_when_the_longest_run_does() {
    let interpolators: [PieceInterpolator<'_, f64, 3>; 32] =
        std::array::from_fn(|lane| holes::PATH.on(&holes::SECTIONS[lane % holes::SECTIONS.len()]));
    let mut made = [0; 32];
    let mut lanes = LaneInterpolator::<f64, 3, 32>::new(interpolators);
    while lanes.step() > 0 {
        for (lane, periods) in made.iter_mut().enumerate() {
            *periods += usize::from(lanes.setpoint(lane).is_some()); // lanes.restart(lane, next) where a run has ended.
        }
    }
    assert_eq!(made.iter().take(holes::SECTIONS.len()).sum::<usize>(), holes::PERIODS);
}
