//! Formats by name.

use format_compare::{formats, select};

#[test]
fn formats_come_in_order_of_width_and_are_found_by_name() {
    let widths: Vec<u32> = formats::<2>().iter().map(|f| f.name().bits()).collect();
    assert!(widths.is_sorted(), "{widths:?}");
    let found = select::<2>(&["f64", "I16F16"]).expect("both exist");
    assert_eq!(found[0].name().to_string(), "I16F16");
    assert_eq!(select::<3>(&["I5F7"]).map(|f| f[0].name().bits()).ok(), Some(12));
    let twice = ["f64", "I5F13", "I05F13", "f64"];
    assert_eq!(select::<3>(&twice).map(|found| found.len()).ok(), Some(2));
    assert_eq!(select::<3>(&["F5I7"]).err().as_deref(), Some("F5I7"));
}
