//! Paths of fine moves for tests, and how far the chords of a plan leave them.

use crate::test_paths::{self, place_at, polyline};
use crate::{EndFeeds, FeedLimit, KinematicLimits, ProfileKind, plan_with};

/// Points of a path by their distance.
pub(super) struct Track {
    points: Vec<[f64; 2]>,
    distances: Vec<f64>,
}

impl Track {
    pub(super) fn of(points: &[[f64; 2]]) -> Self {
        let mut distances = vec![0.0];
        for pair in points.windows(2) {
            let step = (pair[1][0] - pair[0][0]).hypot(pair[1][1] - pair[0][1]);
            distances.push(distances.last().unwrap() + step);
        }
        Self { points: points.to_vec(), distances }
    }

    pub(super) fn at(&self, distance: f64) -> [f64; 2] {
        let next = self.distances.partition_point(|d| *d < distance).clamp(1, self.points.len() - 1);
        let (a, b) = (self.points[next - 1], self.points[next]);
        let (from, to) = (self.distances[next - 1], self.distances[next]);
        let x = if to > from { ((distance - from) / (to - from)).clamp(0.0, 1.0) } else { 0.0 };
        [a[0] + x * (b[0] - a[0]), a[1] + x * (b[1] - a[1])]
    }

    /// The largest distance of a point of the path from the chord between two distances.
    fn chord_error(&self, from: f64, to: f64) -> f64 {
        let (a, b) = (self.at(from), self.at(to));
        let along = [b[0] - a[0], b[1] - a[1]];
        let length = along[0].hypot(along[1]);
        let first = self.distances.partition_point(|d| *d <= from);
        let end = self.distances.partition_point(|d| *d < to).max(first);
        let off = |p: &[f64; 2]| ((p[0] - a[0]) * along[1] - (p[1] - a[1]) * along[0]).abs() / length;
        self.points[first..end].iter().map(off).fold(0.0, f64::max)
    }
}

/// The distances along the plan, at eight times in each period.
pub(super) fn places(limit: &FeedLimit<f64>, limits: &KinematicLimits<f64>, kind: ProfileKind) -> Vec<f64> {
    let plan = plan_with(limit, limits, EndFeeds::default(), kind).unwrap();
    let (place, schedule) = (place_at(plan.stages()), plan.as_schedule());
    let times = (0..).map(|i| f64::from(i) / 8.0).take_while(|time| *time <= schedule.duration());
    times.map(place).collect()
}

/// The largest error of a one-period chord along the plan that passes no stop, at eight phases.
pub(super) fn worst_chord(
    track: &Track,
    limit: &FeedLimit<f64>,
    limits: &KinematicLimits<f64>,
    kind: ProfileKind,
) -> f64 {
    let places = places(limit, limits, kind);
    let stops: Vec<_> = limit.points().filter(|p| p.feedrate == 0.0).map(|p| p.distance).collect();
    let passes_stop = |from: f64, to: f64| stops.iter().any(|stop| from < *stop && *stop < to);
    let chords = places.iter().zip(&places[8.min(places.len())..]);
    let chords = chords.filter(|(from, to)| !passes_stop(**from, **to));
    chords.map(|(from, to)| track.chord_error(*from, *to)).fold(0.0, f64::max)
}

pub(super) fn limit_along(points: &[[f64; 2]], limits: &KinematicLimits<f64>) -> FeedLimit<f64> {
    test_paths::limit_along(&polyline(points), limits)
}

/// Moves along an arc that begins at the origin in the direction of x.
pub(crate) fn arc(radius: f64, step: f64, angle: f64) -> Vec<[f64; 2]> {
    let count = (0..).take_while(|i| f64::from(*i) * step < radius * angle).count();
    let at = |i: usize| angle * i as f64 / count as f64;
    (0..=count).map(|i| [radius * at(i).sin(), radius * (1.0 - at(i).cos())]).collect()
}

/// The least and the greatest limit, without a tenth of the path at each end.
pub(super) fn range(limit: &FeedLimit<f64>) -> (f64, f64) {
    (100..=900)
        .map(|i| limit.at(limit.length() * f64::from(i) / 1000.0))
        .fold((f64::MAX, 0.0), |range, at| (range.0.min(at), range.1.max(at)))
}
