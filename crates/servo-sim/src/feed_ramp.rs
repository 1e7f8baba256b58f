//! Linear acceleration before interpolation: the feed along the path is ramped, and the path stays the same.
//!
//! The distance s that a run has travelled at the end of each period goes through the same moving average as setpoints
//! do in the [`CommandFilter`]. A step of the feed then becomes a ramp of the average's length t. The ramped distance
//! σ is a place on the path, so the geometry does not change: a circle keeps its radius, where the same average over
//! the setpoints of each axis takes about `R(ωt)²/24` off it. The run takes t longer.
//!
//! # Source
//! FANUC, connection manual B-63503EN, chapter 7, has both: acceleration before interpolation leaves the contour, linear
//! acceleration after it takes `t² v²/(24 R)` off a radius.

use crate::{CommandFilter, ServoError};

/// One period of a run along a path.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Travelled {
    /// The distance along the path in this period, in mm.
    pub length: f64,
    /// Whether the run rests at the period's end. The ramp then ends there too, as in a control with an exact stop.
    pub rests: bool,
}

/// A place on a run, between two of its setpoints.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct RunPlace {
    /// The number of setpoints behind the place; 0 where the run has not reached its first.
    pub passed: usize,
    /// The part of the distance to the next setpoint, from 0 to 1.
    pub fraction: f64,
}

/// The places of a run at the end of each period, once its feed is averaged over `width_periods` = t/T. From rest to
/// rest there are `⌈t/T⌉ - 1` places more than there are periods in `run`.
///
/// # Errors
/// [`ServoError`] if the width is NaN, or is not from 0 to 10 000.
pub fn ramp_feed(run: &[Travelled], width_periods: f64) -> Result<Vec<RunPlace>, ServoError> {
    let mut places = Vec::with_capacity(run.len());
    let mut begin = 0;
    for stretch in run.split_inclusive(|period| period.rests) {
        ramp_stretch(stretch, begin, width_periods, &mut places)?;
        begin += stretch.len();
    }
    Ok(places)
}

/// Ramps the feed of a stretch that begins and ends at rest, behind `begin` setpoints.
fn ramp_stretch(
    stretch: &[Travelled],
    begin: usize,
    width: f64,
    places: &mut Vec<RunPlace>,
) -> Result<(), ServoError> {
    let mut filter = CommandFilter::try_new(width, 0.0_f64)?;
    let reached: Vec<f64> = stretch
        .iter()
        .scan(0.0, |sum, period| {
            *sum += period.length;
            Some(*sum)
        })
        .collect();
    let Some(&end) = reached.last() else { return Ok(()) };
    let (mut passed, mut behind) = (0, 0.0);
    for distance in reached.iter().copied().chain(std::iter::repeat(end)) {
        let place = filter.step(distance);
        while let Some(&next) = reached.get(passed)
            && next <= place
        {
            (passed, behind) = (passed + 1, next);
        }
        let fraction = reached.get(passed).map_or(0.0, |next| (place - behind) / (next - behind));
        places.push(RunPlace { passed: begin + passed, fraction: fraction.clamp(0.0, 1.0) });
        if passed == reached.len() {
            break;
        }
    }
    Ok(())
}

#[cfg(test)]
mod tests {
    use super::*;
    use proptest::prelude::*;

    /// The distance at a place, in setpoints, of a run of equal steps.
    fn steps(place: RunPlace) -> f64 {
        place.passed as f64 + place.fraction
    }

    fn even(count: usize) -> Vec<Travelled> {
        vec![Travelled { length: 0.1, rests: false }; count]
    }

    #[test]
    fn a_step_of_the_feed_becomes_a_ramp() {
        let places = ramp_feed(&even(100), 24.0).unwrap();
        assert_eq!(places.len(), 100 + 23);
        let mut before = 0.0;
        for (place, k) in places.iter().zip(1_u32..) {
            let expected = f64::from(k.min(24).min(124 - k)) / 24.0;
            let found = steps(*place) - before;
            assert!((found - expected).abs() < 1e-11, "period {k}: {found} {expected}");
            before = steps(*place);
        }
        assert_eq!(places.last(), Some(&RunPlace { passed: 100, fraction: 0.0 }));
    }

    #[test]
    fn a_ramp_of_no_length_changes_nothing() {
        for width in [0.0, 1.0] {
            let places = ramp_feed(&even(5), width).unwrap();
            let expected: Vec<_> = (1..=5).map(|passed| RunPlace { passed, fraction: 0.0 }).collect();
            assert_eq!(places, expected);
        }
    }

    #[test]
    fn a_ramp_ends_at_a_rest_inside_the_run() {
        let mut run = even(20);
        run[9].rests = true;
        let places = ramp_feed(&run, 4.0).unwrap();
        assert_eq!(places.len(), 2 * (10 + 3));
        assert_eq!(places[12], RunPlace { passed: 10, fraction: 0.0 });
        assert!((steps(places[13]) - 10.25).abs() < 1e-12, "{:?}", places[13]);
    }

    #[test]
    fn a_run_without_periods_has_no_place() {
        assert_eq!(ramp_feed(&[], 24.0), Ok(Vec::new()));
        assert!(ramp_feed(&even(1), f64::NAN).is_err());
    }

    proptest! {
        /// The run never goes back, and ends where it ended.
        #[test]
        fn places_never_go_back(
            lengths in prop::collection::vec((0.0..1.0_f64, prop::bool::weighted(0.1)), 1..60),
            width in 0.0..30.0_f64,
        ) {
            let run: Vec<_> = lengths.iter().map(|&(length, rests)| Travelled { length, rests }).collect();
            let places = ramp_feed(&run, width).unwrap();
            prop_assert!(places.windows(2).all(|two| steps(two[0]) <= steps(two[1]) + 1e-9));
            prop_assert_eq!(places.last(), Some(&RunPlace { passed: run.len(), fraction: 0.0 }));
        }
    }
}
