//! Inputs, and what is wrong with them.

use kernel_size::Input;

#[test]
fn drawn_numbers_fill_their_range_and_stay_the_same() {
    let drawn = Input::drawn("x", 1, (-2.0, 6.0), 10_000).unwrap();
    assert_eq!(drawn, Input::drawn("x", 1, (-2.0, 6.0), 10_000).unwrap());
    assert_ne!(drawn, Input::drawn("x", 2, (-2.0, 6.0), 10_000).unwrap());
    let mean = drawn.values().iter().sum::<f64>() / 1e4;
    let square = drawn.values().iter().map(|x| (x - 2.0).powi(2)).sum::<f64>() / 1e4;
    // A mean of 2 and a variance of 8²/12, to four standard errors.
    assert!((mean - 2.0).abs() < 4.0 * 0.0231, "{mean}");
    assert!((square - 64.0 / 12.0).abs() < 4.0 * 0.0477, "{square}");
}

/// The first numbers of the published generator from the seed 1234567.
#[test]
fn the_generator_is_the_published_one() {
    let drawn = Input::drawn("x", 1_234_567, (0.0, 1.0), 3).unwrap();
    let published = [6_457_827_717_110_365_317_u64, 3_203_168_211_198_807_973, 9_817_491_932_198_370_423];
    for (found, published) in drawn.values().iter().zip(published) {
        assert_eq!(*found, (published >> 11) as f64 / 2.0_f64.powi(53));
    }
}

#[test]
fn a_recording_is_read_by_its_column() {
    let text = "t, current\n0, 1.5\n1,-0.25\n";
    let read = Input::in_csv("current", (-2.0, 2.0), text).unwrap();
    assert_eq!(read.values(), [1.5, -0.25]);
    let wrong = |name, text: &str| Input::in_csv(name, (-2.0, 2.0), text).unwrap_err().to_string();
    assert_eq!(wrong("voltage", text), "line 1: columns t, current: expected voltage among them");
    assert_eq!(wrong("t", "t\n1\nx\n"), "line 3: t = \"x\": expected a number");
    assert_eq!(wrong("t", "t\n1\n3\n"), "input t, step 1: 3: expected a number from -2e0 to 2e0");
    assert_eq!(wrong("t", "t\nNaN\n"), "input t, step 0: NaN: expected a number from -2e0 to 2e0");
    assert!(wrong("t", "t\n1,2\n").starts_with("line 2: "));
    let range = Input::drawn("x", 1, (1.0, -1.0), 3).unwrap_err().to_string();
    assert_eq!(range, "input x: range 1e0 to -1e0: expected the least number first, and finite ones");
    assert!(Input::drawn("x", 1, (f64::NAN, 1.0), 3).is_err());
}
