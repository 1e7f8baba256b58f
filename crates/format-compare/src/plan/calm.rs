//! The periods of a plan in which nothing changes, so that no figure of theirs differs from their neighbours': the feed is
//! constant, and where the place counts the path is straight.

use std::ops::Range;

use feed_plan::{FeedLimit, Stage};
use nurbs_core::{Differentiate, Evaluate};
use real::{DoubleDouble, Real};

use crate::problem::problem::Problem;

/// Periods at both ends of such a time that are left out of it: differences of the third order reach so far.
const MARGIN: f64 = 4.0;

/// The distances at which the straight curves of a path begin and end, in order.
pub(crate) fn straight_ways<const D: usize>(problem: &Problem<D>, limit: &FeedLimit<f64>) -> Vec<Range<f64>> {
    let curves = problem.fast_curves();
    let mut ways: Vec<Range<f64>> = Vec::new();
    let mut open: Option<(usize, Range<f64>)> = None;
    for point in limit.points() {
        match &mut open {
            Some((curve, way)) if *curve == point.curve => way.end = point.distance,
            _ => {
                ways.extend(open.take().map(|(_, way)| way));
                let is_line =
                    curves.get(point.curve).is_some_and(|curve| curve.span_count() == 1 && curve.is_line(0));
                open = is_line.then_some((point.curve, point.distance..point.distance));
            }
        }
    }
    ways.extend(open.map(|(_, way)| way));
    ways
}

/// The whole periods of constant feed along one of these ways, in order.
pub(crate) fn on_ways(stages: &[Stage<DoubleDouble>], ways: &[Range<f64>]) -> Vec<Range<u64>> {
    let (mut time, mut next) = (0.0, 0);
    let mut calm = Vec::new();
    for stage in stages {
        let (start, feed, duration) = (stage.start.value(), stage.start_feed.value(), stage.duration.value());
        let end = start + stage.length.value();
        while is_constant(stage) && ways.get(next).is_some_and(|way| way.start < end) {
            let way = &ways[next];
            let times = [way.start, way.end].map(|place| ((place - start) / feed).clamp(0.0, duration));
            calm.extend(within(time + times[0], time + times[1]));
            if way.end > end {
                break;
            }
            next += 1;
        }
        while ways.get(next).is_some_and(|way| way.end <= end) {
            next += 1;
        }
        time += duration;
    }
    calm
}

fn is_constant(stage: &Stage<DoubleDouble>) -> bool {
    let feed = stage.start_feed.value();
    feed > 0.0 && stage.start_feed == stage.end_feed
}

/// The whole periods between two times, in periods, without the margins.
fn within(begin: f64, end: f64) -> Option<Range<u64>> {
    let periods = [(begin + MARGIN).ceil(), (end - MARGIN).floor().max(0.0)];
    let [first, behind] = periods.map(|period| period.to_phase(-64));
    (first < behind).then_some(first..behind)
}

/// The numbers below `count` that are in none of these ranges, each with whether those before it were left out.
pub(crate) fn others(calm: &[Range<u64>], count: u64) -> impl Iterator<Item = (u64, bool)> {
    let mut next = 0;
    let mut ranges = calm.iter().peekable();
    std::iter::from_fn(move || {
        let before = next;
        while let Some(range) = ranges.next_if(|range| range.start <= next) {
            next = next.max(range.end);
        }
        let number = next;
        next += 1;
        (number < count).then_some((number, number > before))
    })
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn numbers_behind_a_range_say_so() {
        let found: Vec<_> = others(&[2..4, 5..6, 9..12], 11).collect();
        assert_eq!(found, [(0, false), (1, false), (4, true), (6, true), (7, false), (8, false)]);
    }

    #[test]
    fn periods_keep_their_distance_from_both_ends() {
        assert_eq!(within(0.5, 20.5), Some(5..16));
        assert_eq!([within(0.0, 8.0), within(3.0, 2.0)], [None, None]);
    }
}
