//! Numbers from a seed are those of the reference.

use stress::SplitMix64;

/// The numbers that Vigna's reference program prints for the seed 1234567.
#[test]
fn the_numbers_are_those_of_the_reference() {
    let found: Vec<u64> = SplitMix64::new(1_234_567).take(3).collect();
    assert_eq!(found, [6_457_827_717_110_365_317, 3_203_168_211_198_807_973, 9_817_491_932_198_370_423]);
}
