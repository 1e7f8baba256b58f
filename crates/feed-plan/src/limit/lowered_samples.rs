//! Samples of the limit lowered to a feed, on both sides of a place.

use alloc::vec::Vec;

use real::Real;

use crate::LimitPoint;
use crate::limit::sample::{ScannedSample, lowered};

/// If two samples are farther apart than 2⁻³ of half a chord, a lower limit may not end at either of them: a sample is
/// added.
const FINE: i32 = -3;

/// A sample less than 2⁻¹⁰ of that distance from another one would change nothing.
const NEAR: i32 = -10;

/// Adds samples where a way of half that length on both sides of a place is to be lowered: at its ends, and behind the last sample that
/// is lowered another one so far away. Without them, the limit of a whole line would be lowered, or fall all along it.
fn split_around<R: Real>(samples: &mut Vec<ScannedSample<R>>, at: R, half: R) {
    let (begin, end) = (at - half, at + half);
    split(samples, begin, half.ldexp(FINE));
    let up_to = samples.partition_point(|sample| sample.point.distance <= begin);
    if let Some(lowest) = up_to.checked_sub(1).and_then(|before| samples.get(before)) {
        split(samples, lowest.point.distance - half, half);
    }
    split(samples, end, half.ldexp(FINE));
    if let Some(last) = samples.get(samples.partition_point(|sample| sample.point.distance < end)) {
        split(samples, last.point.distance + half, half);
    }
}

/// Adds a sample at a place on a straight line where the limit is constant and samples are farther than `apart`.
fn split<R: Real>(samples: &mut Vec<ScannedSample<R>>, distance: R, apart: R) {
    let next = samples.partition_point(|sample| sample.point.distance < distance);
    let before = next.checked_sub(1).and_then(|before| samples.get(before));
    let (Some(from), Some(to)) = (before, samples.get(next)) else { return };
    let (a, b) = (from.point, to.point);
    let length = b.distance - a.distance;
    let is_even = a.curve == b.curve && from.speed == to.speed && to.margin.is_zero();
    let near = apart.ldexp(NEAR);
    let is_between = distance - a.distance > near && b.distance - distance > near;
    if !(is_even && length > apart && a.feedrate == b.feedrate && is_between) {
        return;
    }
    let u = a.u + (b.u - a.u) * ((distance - a.distance) / length);
    let sample = ScannedSample { point: LimitPoint { distance, u, ..a }, is_single: false, ..*to };
    samples.insert(next, sample);
}

/// Lowers samples to a feed, up to and including the first place that is beyond reach; a stop ends the walk too. Returns
/// the number of samples lowered.
pub(crate) fn lower<'a, R: Real + 'a>(
    samples: impl Iterator<Item = &'a mut ScannedSample<R>>,
    feed: R,
    is_beyond: impl Fn(R) -> bool,
) -> usize {
    let mut count = 0;
    let mut last = None;
    for sample in samples {
        let is_behind = last.is_some_and(|last| last != sample.point.distance);
        if is_behind || !(sample.point.feedrate > R::zero()) {
            break;
        }
        // The limit beside a stop is lowered too: the accelerations for turning are limited up to the stop.
        for limit in [&mut sample.point.feedrate, &mut sample.feedrate_beside_stop] {
            *limit = limit.min(feed);
        }
        count += 1;
        last = last.or_else(|| is_beyond(sample.point.distance).then_some(sample.point.distance));
    }
    count
}

/// Lowers the samples within `half` of a place to a feed.
pub(crate) fn lower_around<R: Real>(samples: &mut Vec<ScannedSample<R>>, at: R, half: R, feed: R) {
    let (begin, end) = (at - half, at + half);
    split_around(samples, at, half);
    let first = samples.partition_point(|sample| sample.point.distance < at);
    let before = lower(samples.iter_mut().take(first).rev(), feed, |distance| distance <= begin);
    let behind = lower(samples.iter_mut().skip(first), feed, |distance| distance >= end);
    for single in first.saturating_sub(before)..first.saturating_add(behind) {
        lower_single(samples, single);
    }
}

/// Lowers a limit that holds at one point alone to the limit that holds beside the point now. A higher limit would be a
/// summit.
pub(crate) fn lower_single<R: Real>(samples: &mut [ScannedSample<R>], single: usize) {
    let beside = |place: Option<usize>| {
        let sample = place.and_then(|place| samples.get(place))?;
        let margin = place.and_then(|place| samples.get(place + 1)).map_or_else(R::zero, |next| next.margin);
        Some(lowered(sample.point.feedrate, sample.margin.max(margin)))
    };
    let most = [beside(single.checked_sub(1)), beside(single.checked_add(1))].into_iter().flatten();
    let most = most.fold(R::max_value(), R::min);
    if let Some(sample) = samples.get_mut(single).filter(|sample| sample.is_single) {
        sample.point.feedrate = sample.point.feedrate.min(most);
    }
}

/// Leaves at most this acceleration for the path within `reach` of a place.
pub(crate) fn lower_acceleration_around<R: Real>(
    samples: &mut Vec<ScannedSample<R>>,
    at: R,
    reach: R,
    acceleration: R,
) {
    split_around(samples, at, reach);
    let first = samples.partition_point(|sample| sample.point.distance < at - reach);
    let within = samples.iter_mut().skip(first);
    for sample in within.take_while(|sample| sample.point.distance <= at + reach) {
        sample.allowance.acceleration = sample.allowance.acceleration.min(acceleration);
    }
}
