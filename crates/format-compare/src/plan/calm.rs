//! The times of a plan in which nothing changes: the feed is constant and the path is straight. No figure of a whole period there
//! differs from its neighbours'.

use std::ops::Range;

use feed_plan::{FeedLimit, Stage};
use nurbs_core::{Differentiate, Evaluate, FastCurve};
use real::{DoubleDouble, Real};

/// What rounding of distances may move such a time by at most, in periods.
pub(crate) const SURE: f64 = 1.0 / 64.0;
/// Periods at the begin and at the end of such a time that are left out of it: the jerk of a period depends on the two before it, and
/// behind what is left out the second difference of setpoints begins anew.
const MARGINS: [f64; 2] = [2.0 + SURE, 1.0 + SURE];

/// The distances at which the straight curves of a path begin and end, in order.
pub(crate) fn straight_ways<const D: usize>(
    curves: &[FastCurve<'_, D>],
    limit: &FeedLimit<f64>,
) -> Vec<Range<f64>> {
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

/// The times of constant feed along each of these ways, in periods and in order.
pub(crate) fn on_ways<'a>(
    stages: &'a [Stage<DoubleDouble>],
    ways: &'a [Range<f64>],
) -> impl Iterator<Item = Range<f64>> + 'a {
    let mut next = 0;
    let starts = stages.iter().scan(0.0, |time, stage| {
        let start = *time;
        *time += stage.duration.value();
        Some(start)
    });
    starts.zip(stages).flat_map(move |(time, stage)| {
        let (start, feed, duration) = (stage.start.value(), stage.start_feed.value(), stage.duration.value());
        let end = start + stage.length.value();
        let behind = next + ways.iter().skip(next).take_while(|way| way.start < end).count();
        let here = ways.get(next..behind).unwrap_or_default();
        next = behind - here.last().map_or(0, |way| usize::from(way.end > end));
        let when = move |place: f64| time + ((place - start) / feed).clamp(0.0, duration);
        let here = if is_constant(stage) { here } else { &[] };
        here.iter().map(move |way| when(way.start)..when(way.end))
    })
}

fn is_constant(stage: &Stage<DoubleDouble>) -> bool {
    let feed = stage.start_feed.value();
    feed > 0.0 && stage.start_feed == stage.end_feed
}

/// The whole periods of such a time, without the margins.
pub(crate) fn calm(time: &Range<f64>) -> Option<Range<u64>> {
    let periods = [(time.start + MARGINS[0]).ceil(), (time.end - MARGINS[1]).floor().max(0.0)];
    let [first, behind] = periods.map(|period| period.to_phase(-64));
    (first < behind).then_some(first..behind)
}

/// The numbers below `count` that are in none of these ranges, each with whether those before it were left out.
pub(crate) fn others(
    calm: impl Iterator<Item = Range<u64>>,
    count: u64,
) -> impl Iterator<Item = (u64, bool)> {
    let mut next = 0;
    let mut ranges = calm.peekable();
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
        let found: Vec<_> = others([2..4, 5..6, 9..12].into_iter(), 11).collect();
        assert_eq!(found, [(0, false), (1, false), (4, true), (6, true), (7, false), (8, false)]);
    }

    #[test]
    fn periods_keep_their_distance_from_both_ends() {
        assert_eq!(calm(&(0.5..20.5)), Some(3..19));
        assert_eq!([calm(&(0.0..4.0)), calm(&(3.0..2.0))], [None, None]);
    }
}
