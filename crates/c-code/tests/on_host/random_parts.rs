//! Random parts: any degree, weights, knots, cusps, corners, profiles.

use stress::{RandomPath, SplitMix64};

use crate::planned_path::PlannedPath;
use crate::program::Parts;

/// Periods of a run, at most.
const MOST_PERIODS: u32 = 4000;

/// The formats, one after the other.
const FORMATS: [&str; 9] = ["I4F28", "f32", "I8F24", "f64", "I4F60", "I16F16", "I32F32", "I2F30", "I12F20"];

/// Random paths from a seed, each in the next format, until enough are found.
fn random_parts<const D: usize>(seed: u64, first: usize, has_override: bool) {
    let count = count();
    let mut parts = Parts::from(first);
    let (mut added, mut drawn) = (0, 0);
    for path in random_paths::<D>(seed) {
        drawn += 1;
        let format = FORMATS[added % FORMATS.len()];
        let Some(planned) = PlannedPath::new(&path, MOST_PERIODS) else { continue };
        added += usize::from(parts.add(&planned, format, has_override));
        assert!(drawn < 200 * count, "{added} paths of {drawn} fit");
        if added == count {
            break;
        }
    }
    parts.demand_the_same_runs();
}

/// Endless paths from a seed: in turn as they are drawn, passing corners, and on the fastest plan.
pub(crate) fn random_paths<const D: usize>(seed: u64) -> impl Iterator<Item = RandomPath<D>> {
    let mut numbers = SplitMix64::new(seed);
    let drawn = std::iter::repeat_with(move || {
        let bytes: Vec<u8> = numbers.by_ref().take(64).flat_map(u64::to_le_bytes).collect();
        RandomPath::<D>::from_bytes(&bytes)
    });
    drawn.flatten().enumerate().map(|(index, path)| match (index + 1) % 3 {
        0 => path.passing_corners(),
        1 => path.fastest(),
        _ => path,
    })
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
    random_parts::<2>(seed(), 0, false);
}

#[test]
fn random_parts_in_space_run_as_in_rust() {
    random_parts::<3>(seed() ^ 0x5eed, 1, false);
}

#[test]
fn random_parts_with_feed_override_run_as_in_rust() {
    random_parts::<2>(seed() ^ 0xfeed, 2, true);
}
