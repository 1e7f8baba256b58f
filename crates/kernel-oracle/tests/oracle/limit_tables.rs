//! Plans under drawn tables of limits keep their promises, and a damaged plan is seen.

use arbitrary::{Arbitrary, Unstructured};
use kernel_oracle::LimitTable;

use crate::seeded_bytes::seeded_bytes;

#[test]
fn a_plan_under_any_table_keeps_its_promises() {
    let (mut planned, mut stages) = (0, 0);
    for seed in 0..1_000 {
        let table = LimitTable::arbitrary(&mut Unstructured::new(&seeded_bytes(seed))).unwrap();
        let found = table.check().unwrap_or_else(|fault| panic!("seed {seed}: {fault}\n{table:?}"));
        planned += u32::from(found > 0);
        stages += found;
    }
    assert!(planned >= 900 && stages > 5_000, "{planned} planned, {stages} stages");
}
