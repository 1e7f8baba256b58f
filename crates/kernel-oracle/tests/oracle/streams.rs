//! Streams of wrong content with right checksums.

use arbitrary::{Arbitrary, Unstructured};
use kernel_oracle::StreamCase;

use crate::seeded_bytes::seeded_bytes;

#[test]
fn a_changed_stream_is_refused_or_runs_forward() {
    let (mut whole, mut refused) = (0, 0);
    for seed in 0..2_000 {
        let case = StreamCase::arbitrary(&mut Unstructured::new(&seeded_bytes(seed))).unwrap();
        let (run, sections) = case.check().unwrap_or_else(|fault| panic!("seed {seed}: {fault}\n{case:?}"));
        whole += u32::from(run == sections);
        refused += u32::from(run < sections);
    }
    // Both ends are met often: many a change of a number is a path like any other.
    assert!(whole > 300 && refused > 300, "{whole} run whole, {refused} refused");
}
