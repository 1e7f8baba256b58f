//! What a stop leaves of the limit beside it.
//!
//! No chord that starts and ends within the chord error of a stop can leave the curve by more, however sharp the corner or tight
//! the bend: up to there, the limit at that distance holds.

use core::ops::Range;

use real::Real;

use crate::LimitPoint;
use crate::feed_limit::{Node, interpolate};

/// Lets the limit jump at stops: within `reach` of one, the limit at `reach` from it holds. On the stretch that leads on from
/// there, at a distance x of the stop, V² is above the limit's by no more than `reach`/x of it.
///
/// The time is linear in the points as long as few stops have a higher limit behind them than the stop before: what
/// lies within reach of a stop is looked for from where it was found last, and what has been lifted is not lifted
/// again.
pub(crate) fn release_stops<R: Real>(points: &[LimitPoint<R>], nodes: &mut [Node<R>], reach: R) {
    let (mut behind, mut next) = (0, 0); // Points before `behind` are beyond reach, and so are those from `next` on.
    let (mut lifted, mut lifted_to) = (0, R::zero());
    for i in 0..nodes.len() {
        if nodes[i].lower > R::zero() {
            continue;
        }
        let here = points[i].distance;
        let is_beyond = |point: &LimitPoint<R>| (point.distance - here).abs() > reach;
        next = next.max(i);
        while points.get(next).is_some_and(|point| !is_beyond(point)) {
            next += 1;
        }
        let release = limit_between(points, nodes, next, here + reach);
        lift(nodes, i + 1..next, release);
        while behind < i && is_beyond(&points[behind]) {
            behind += 1;
        }
        let release = limit_between(points, nodes, behind, here - reach);
        let from = if release <= lifted_to { behind.max(lifted) } else { behind };
        lift(nodes, from..i, release);
        (lifted, lifted_to) = (i, release);
    }
    for i in 0..nodes.len() {
        if nodes[i].is_single {
            nodes[i].before = i.checked_sub(1).map_or_else(R::zero, |k| nodes[k].lower);
            nodes[i].after = nodes.get(i + 1).map_or_else(R::zero, |node| node.lower);
        }
    }
}

/// The limit at a distance between point `next` and the one before it; 0 beyond the ends.
fn limit_between<R: Real>(points: &[LimitPoint<R>], nodes: &[Node<R>], next: usize, distance: R) -> R {
    let at = |k: usize| Some((points.get(k)?.distance, nodes.get(k)?.lower));
    match (next.checked_sub(1).and_then(at), at(next)) {
        (Some(before), Some(after)) => interpolate(before, after, distance),
        _ => R::zero(),
    }
}

fn lift<R: Real>(nodes: &mut [Node<R>], range: Range<usize>, at_least: R) {
    if !(at_least > R::zero()) {
        return;
    }
    let nodes = nodes.get_mut(range).unwrap_or_default();
    for node in nodes.iter_mut().filter(|node| !(node.is_single && node.lower > R::zero())) {
        let lower = node.lower.max(at_least);
        (node.lower, node.before, node.after) = (lower, lower, lower);
        node.is_single &= !(lower > R::zero());
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::FeedLimit;
    use crate::axis_budget::Allowance;
    use crate::feed_limit::Measured;
    use proptest::prelude::*;

    fn measured(steps: &[(f64, f64)]) -> Vec<Measured<f64>> {
        let mut distance = 0.0;
        let sample = |&(step, feedrate): &(f64, f64)| {
            distance += step;
            Measured {
                point: LimitPoint { distance, curve: 0, u: distance, feedrate },
                speed: 0.0,
                margin: 0.0,
                allowance: Allowance::unlimited(),
                is_single: feedrate == 0.0,
            }
        };
        steps.iter().map(sample).collect()
    }

    /// A bend so tight that the limit is zero at each of its points, within reach of each other: every one looked for
    /// all others, which a fuzzer timed at minutes.
    #[test]
    fn a_hundred_thousand_stops_within_reach_are_released_at_once() {
        let mut steps: Vec<_> = (0..200_000).map(|i| (1e-9, if i < 100_000 { 1.0 } else { 0.0 })).collect();
        steps[0].0 = 1.0;
        let limit = FeedLimit::assemble(&measured(&steps), 0.5).unwrap();
        assert_eq!(limit.nodes().len(), 200_000);
    }

    /// What the pointers of `release_stops` find, looked for anew at every stop.
    fn released_one_by_one(mut lowers: Vec<f64>, distances: &[f64], reach: f64) -> Vec<f64> {
        for i in 0..lowers.len() {
            if lowers[i] > 0.0 {
                continue;
            }
            let is_beyond = |k: &usize| (distances[*k] - distances[i]).abs() > reach;
            let at = |lowers: &[f64], k: usize, distance| {
                interpolate((distances[k], lowers[k]), (distances[k + 1], lowers[k + 1]), distance)
            };
            let next = (i..lowers.len()).find(is_beyond);
            let release = next.map_or(0.0, |next| at(&lowers, next - 1, distances[i] + reach));
            let end = next.unwrap_or(lowers.len());
            lowers[i..end].iter_mut().skip(1).for_each(|lower| *lower = lower.max(release));
            let previous = (0..i).rev().find(is_beyond);
            let release = previous.map_or(0.0, |k| at(&lowers, k, distances[i] - reach));
            let from = previous.map_or(0, |k| k + 1);
            lowers[from..i].iter_mut().for_each(|lower| *lower = lower.max(release));
        }
        lowers
    }

    proptest! {
        #![proptest_config(ProptestConfig::with_cases(64))]

        #[test]
        fn stops_are_released_as_one_by_one(
            steps in proptest::collection::vec((0.0..1.0_f64, prop_oneof![Just(0.0), 0.1..3.0_f64]), 2..60),
            reach in 0.0..3.0_f64,
        ) {
            let samples = measured(&steps);
            let limit = FeedLimit::assemble(&samples, reach).unwrap();
            let distances: Vec<_> = samples.iter().map(|sample| sample.point.distance).collect();
            let lowers = samples.iter().map(|sample| sample.point.feedrate).collect();
            let found: Vec<_> = limit.nodes().iter().map(|node| node.lower).collect();
            prop_assert_eq!(found, released_one_by_one(lowers, &distances, reach));
        }
    }
}
