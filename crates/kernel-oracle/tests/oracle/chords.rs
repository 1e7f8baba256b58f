//! Steps along drawn pieces travel the chord that is wanted.

use arbitrary::{Arbitrary, Unstructured};
use kernel_oracle::{ChordCase, ChordTally};

use crate::seeded_bytes::seeded_bytes;

#[test]
fn a_step_from_any_place_travels_the_wanted_chord() {
    let mut tally = ChordTally::default();
    for seed in 0..1_500 {
        let case = ChordCase::arbitrary(&mut Unstructured::new(&seeded_bytes(seed))).unwrap();
        tally = tally.with(case.check().unwrap_or_else(|fault| panic!("seed {seed}: {fault}\n{case:?}")));
    }
    // Most cases fit most of the four formats, and most steps are measured.
    let floor = ChordTally { formats: 4_000, steps: 10_000, measured: 6_000, crossed: 500 };
    let ran = [tally.formats, tally.steps, tally.measured, tally.crossed];
    let least = [floor.formats, floor.steps, floor.measured, floor.crossed];
    assert!(ran.iter().zip(least).all(|(ran, least)| *ran >= least), "{tally:?}");
}
