//! A plan that takes a whole number of interpolation periods.
//!
//! Each section of such a plan, from rest to rest, takes whole periods, so that every stop on the way is a setpoint. If
//! a period passed a corner in its middle, its chord would cut the corner.

use real::Real;

use crate::schedule::section;
use crate::schedule::stage::duration;
use crate::{FeedLimit, PlanError, Stage};

/// A section that bends is slowed down by at least 2⁻¹³. That leaves 2⁻¹² of the acceleration, and more of the jerk, to
/// a plan whose chords have the planned lengths ([`ScheduleBuf::shortened`](crate::ScheduleBuf::shortened)). Straight
/// lines and their corners need no such room, since their chords are as long as the path.
pub(crate) const SLOWER: i32 = -13;

/// Periods of a plan, at most: twelve days of them at a millisecond. A plan [in chords](FeedLimit::in_chords) is followed
/// period by period, up to twenty times.
pub const MOST_PERIODS: u64 = 1 << 30;

/// Slows each section between two stops down evenly to a whole number of periods, and returns the sum of these numbers.
pub(crate) fn stretch<R: Real>(
    stages: &mut [Stage<R>],
    limit: &FeedLimit<R>,
    period: R,
) -> Result<u64, PlanError> {
    let mut periods = 0_u64;
    let mut rest = stages;
    while !rest.is_empty() {
        let (section, behind) = rest.split_at_mut(section::count(rest));
        let ends = section.first().zip(section.last());
        let bends = ends.is_some_and(|(first, last)| limit.bends_over(first.start, last.start + last.length));
        let slower = if bends { R::one().ldexp(SLOWER) } else { R::zero() };
        let taken = stretch_section(section, slower, period)?;
        periods = periods.saturating_add(u64::from(taken));
        rest = behind;
    }
    match periods {
        0 => Err(PlanError::DurationOverflows),
        1..=MOST_PERIODS => Ok(periods),
        _ => Err(PlanError::TooManyPeriods { most: MOST_PERIODS }),
    }
}

/// Slows one section down evenly to a whole number of periods, and by this share at least.
pub(crate) fn stretch_section<R: Real>(
    stages: &mut [Stage<R>],
    slower: R,
    period: R,
) -> Result<u32, PlanError> {
    let duration = duration(stages);
    let in_order = stages.iter().all(|stage| stage.duration > R::zero() && stage.duration <= duration);
    let (periods, rounded) =
        whole_periods(duration, slower, period).filter(|_| in_order).ok_or(PlanError::DurationOverflows)?;
    let factor = rounded * period / duration;
    for stage in stages {
        *stage = stage.slowed(factor);
    }
    Ok(periods)
}

/// The periods that a time takes which is slowed down by this share at least, as an integer and in the format.
pub(crate) fn whole_periods<R: Real>(duration: R, slower: R, period: R) -> Option<(u32, R)> {
    round_up((duration + duration * slower) / period)
}

/// The whole periods that a time takes which has been slowed down to them, but for rounding.
pub(crate) fn periods_taken<R: Real>(duration: R, period: R) -> Option<u32> {
    round_up(duration / period - R::one().half()).map(|(periods, _)| periods)
}

/// The least whole number not below `value`, as an integer and in the format; `None` if either cannot hold it.
pub(crate) fn round_up<R: Real>(value: R) -> Option<(u32, R)> {
    if !(value > R::zero() && value < R::max_value().half()) {
        return None;
    }
    let mut power = R::one();
    let mut bit = 1_u64;
    while power <= value {
        power = power + power;
        bit = bit.checked_mul(2)?;
    }
    let (mut count, mut whole) = (0, R::zero());
    while bit > 0 {
        if whole + power <= value {
            whole = whole + power;
            count += bit;
        }
        power = power.half();
        bit /= 2;
    }
    if whole < value {
        whole = whole + R::one();
        count += 1;
    }
    Some((u32::try_from(count).ok()?, whole))
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::plan::look_ahead::stages;
    use crate::test_paths::{circle, limit_along, paper_limits, polyline};
    use crate::{EndFeeds, Junction, KinematicLimits, ProfileKind, plan_with};
    use real::I16F16;

    #[test]
    fn numbers_are_rounded_up_in_any_format() {
        for (value, whole) in
            [(0.25, 1), (1.0, 1), (1.0001, 2), (1629.9, 1630), (4096.0, 4096), (16_000.5, 16_001)]
        {
            assert_eq!(round_up(value), Some((whole, f64::from(whole))));
            let coarse = <I16F16 as real::Backend>::from_f64(value).unwrap();
            assert_eq!(round_up(coarse).map(|(count, _)| count), Some(whole), "{value}");
        }
        assert_eq!(round_up(4_294_967_295.0_f64).map(|(count, _)| count), Some(u32::MAX));
        for none in [0.0, -1.0, f64::NAN, f64::INFINITY, 4_294_967_296.0, 1e300] {
            assert_eq!(round_up(none), None, "{none}");
        }
        assert_eq!(round_up(I16F16::from_ratio(20_000, 1)), None); // above half the format's range
    }

    /// Every plan was slowed down by 2⁻¹³, even along a line: 6 s in 51,004. Whole periods from stop to stop are all that is due there, and
    /// passed corners, whose steps go along the path, take no more.
    #[test]
    fn straight_lines_are_slowed_down_to_whole_periods_alone() {
        let limits = paper_limits();
        let passed = KinematicLimits { junction: Junction::Deviation(0.01), ..limits };
        let straight = polyline(&[[0.0, 0.0], [16_000.0, 0.0]]);
        let stairs = polyline(&[[0.0, 0.0], [9000.0, 0.0], [9000.0, 9000.0], [0.0, 9000.0]]);
        for (lines, limits) in [(straight, limits), (stairs.clone(), limits), (stairs, passed)] {
            let limit = limit_along(&lines, &limits);
            for kind in ProfileKind::ALL {
                let fastest = stages(&limit, &limits, EndFeeds::default(), None, kind).unwrap();
                let plan = plan_with(&limit, &limits, EndFeeds::default(), kind).unwrap();
                let durations = crate::sections(&fastest).map(|section| section.duration().ceil());
                assert_eq!(plan.as_schedule().periods() as f64, durations.sum::<f64>(), "{kind:?}");
            }
        }
    }

    /// What bends keeps something back for chords, which fall short: an arc between two lines, and breaks too small for a corner.
    #[test]
    fn what_bends_is_slowed_down_further() {
        let breaks = polyline(&[[0.0, 0.0], [8000.0, 0.0], [16_000.0, 1.0]]);
        let limits = paper_limits();
        for limit in [breaks, vec![circle(3000.0)]].map(|curves| limit_along(&curves, &limits)) {
            let fastest = stages(&limit, &limits, EndFeeds::default(), None, ProfileKind::Cubic).unwrap();
            let plan = plan_with(&limit, &limits, EndFeeds::default(), ProfileKind::Cubic).unwrap();
            let plan = plan.as_schedule().duration();
            let fastest: f64 = fastest.iter().map(|stage| stage.duration).sum();
            assert!(plan >= fastest * (1.0 + 1.0 / 8192.0), "{plan} {fastest}");
        }
    }
}
