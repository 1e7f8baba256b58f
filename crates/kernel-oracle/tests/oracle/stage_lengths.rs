//! Drawn stages are passed as far as their feed goes.

use arbitrary::{Arbitrary, Unstructured};
use kernel_oracle::StageCase;

use crate::seeded_bytes::seeded_bytes;

#[test]
fn each_period_travels_the_integral_of_its_feed() {
    let mut periods = 0;
    for seed in 0..500 {
        let case = StageCase::arbitrary(&mut Unstructured::new(&seeded_bytes(seed))).unwrap();
        periods += case.check().unwrap_or_else(|fault| panic!("seed {seed}: {fault}\n{case:?}"));
    }
    assert!(periods > 5_000, "{periods}");
}
