//! Random parts: any degree, weights, knots, cusps, corners, profiles.

use real::{I2F30, I4F28, I4F60, I8F24, I12F20, I16F16, I32F32};
use stress::{RandomPath, SplitMix64};

use crate::compiler::Parts;

/// Periods of a run, at most.
const MOST_PERIODS: u32 = 4000;

/// Adds the path in one format.
fn add<const D: usize>(parts: &mut Parts, path: &RandomPath<D>, format: usize, has_override: bool) -> bool {
    match format % 9 {
        0 => parts.add::<I4F28, D>(path, MOST_PERIODS, has_override),
        1 => parts.add::<f32, D>(path, MOST_PERIODS, has_override),
        2 => parts.add::<I8F24, D>(path, MOST_PERIODS, has_override),
        3 => parts.add::<f64, D>(path, MOST_PERIODS, has_override),
        4 => parts.add::<I4F60, D>(path, MOST_PERIODS, has_override),
        5 => parts.add::<I16F16, D>(path, MOST_PERIODS, has_override),
        6 => parts.add::<I32F32, D>(path, MOST_PERIODS, has_override),
        7 => parts.add::<I2F30, D>(path, MOST_PERIODS, has_override),
        _ => parts.add::<I12F20, D>(path, MOST_PERIODS, has_override),
    }
}

/// Random paths from a seed, each in the next format, until so many are found.
fn random_parts<const D: usize>(seed: u64, count: usize, has_override: bool) {
    let mut parts = Parts::default();
    let mut numbers = SplitMix64::new(seed);
    let (mut added, mut drawn) = (0, 0);
    while added < count {
        let bytes: Vec<u8> = numbers.by_ref().take(64).flat_map(u64::to_le_bytes).collect();
        let Some(path) = RandomPath::<D>::from_bytes(&bytes) else { continue };
        drawn += 1;
        let path = match drawn % 3 {
            0 => path.passing_corners(),
            1 => path.fastest(),
            _ => path,
        };
        added += usize::from(add(&mut parts, &path, added, has_override));
        assert!(drawn < 200 * count, "{added} paths of {drawn} fit");
    }
    parts.demand_the_same_runs();
}

/// Parts of each test; more of them with `FEEDBITS_C_PARTS`.
fn count() -> usize {
    std::env::var("FEEDBITS_C_PARTS").ok().and_then(|text| text.parse().ok()).unwrap_or(9)
}

/// The seed; another one with `FEEDBITS_C_SEED`.
fn seed() -> u64 {
    std::env::var("FEEDBITS_C_SEED").ok().and_then(|text| text.parse().ok()).unwrap_or(1)
}

#[test]
fn random_parts_in_the_plane_run_as_in_rust() {
    random_parts::<2>(seed(), count(), false);
}

#[test]
fn random_parts_in_space_run_as_in_rust() {
    random_parts::<3>(seed() ^ 0x5eed, count(), false);
}

#[test]
fn random_parts_with_feed_override_run_as_in_rust() {
    random_parts::<2>(seed() ^ 0xfeed, count(), true);
}
