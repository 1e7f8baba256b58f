//! Comparisons beside earlier ones.

use kernel_size::{Baseline, Comparison, Output, compare, named};

use crate::kernels::{Biquad, Sum, one};

fn compared(steps: usize, formats: &[&str]) -> Comparison {
    let formats: Vec<_> = formats.iter().map(|name| named(name).unwrap()).collect();
    compare(&one(Biquad, steps, (-1.0, 1.0), Output::named("y").within(1e-4)), &formats).unwrap()
}

#[test]
fn a_comparison_is_no_worse_than_itself() {
    let now = compared(200, &["I8F24", "I4F8", "f32"]);
    let since = Baseline::read(&now.json()).unwrap().since(&now, 0.0).unwrap();
    assert!(!since.is_worse() && since.new.is_empty(), "{since}");
    assert_eq!(since.to_string(), "no format is worse than in the baseline\n");
}

#[test]
fn formats_that_are_new_gone_or_worse_are_named() {
    let before = Baseline::read(&compared(200, &["I8F24", "f32"]).json()).unwrap();
    let since = before.since(&compared(200, &["I8F24", "I4F28"]), 0.0).unwrap();
    assert_eq!((since.new.clone(), since.gone.clone()), (vec!["I4F28".to_string()], vec!["f32".to_string()]));
    assert!(since.is_worse() && since.worse.is_empty());
    // A format as it was, and a coarser one in its place.
    let coarse = compared(200, &["I8F8"]).json().replace("I8F8", "I8F24");
    let fine = compared(200, &["I8F24"]);
    assert!(!Baseline::read(&coarse).unwrap().since(&fine, 0.0).unwrap().is_worse());
    let fine_before = Baseline::read(&fine.json().replace("I8F24", "I8F8")).unwrap();
    let worse = fine_before.since(&compared(200, &["I8F8"]), 0.01).unwrap().worse;
    assert_eq!(worse.len(), 2, "{worse:?}");
    assert!(worse[0].starts_with("I8F8: absolute error of y was "), "{worse:?}");
    assert_eq!(worse[1], "I8F8: verdict was good, and is bad");
}

#[test]
fn a_baseline_of_something_else_is_refused() {
    let now = compared(200, &["I8F24"]);
    let refused = |text: &str| {
        Baseline::read(text).and_then(|baseline| baseline.since(&now, 0.0)).unwrap_err().to_string()
    };
    assert!(refused("{").starts_with("the baseline: "), "{}", refused("{"));
    assert_eq!(refused("{}"), "the baseline: expected what Comparison::json writes");
    assert_eq!(refused("[1]"), "the baseline: expected what Comparison::json writes");
    assert_eq!(
        refused(&compared(100, &["I8F24"]).json()),
        "the baseline: it is of \"one\" over 100 steps: expected one of \"one\" over 200 steps"
    );
    let other = compare(&one(Sum, 200, (0.0, 1.0), Output::named("y").within(1.0)), &[named("f32").unwrap()]);
    // The kernels of these tests share a name, and their formats are told apart.
    let since = Baseline::read(&other.unwrap().json()).unwrap().since(&now, 0.0).unwrap();
    assert_eq!((since.new, since.gone), (vec!["I8F24".to_string()], vec!["f32".to_string()]));
}
