//! One stage of a plan: a row of the acceleration table.

use real::Real;

use crate::{FeedPiece, StageShape};

/// What the feed does in a stage.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum StageKind {
    /// The feed rises.
    Accelerate,
    /// The feed falls.
    Decelerate,
    /// The feed stays.
    Constant,
}

/// One row of the acceleration table: a stretch of the path on which the feed goes from one value to another along one
/// shape, or is constant.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Stage<R> {
    /// Distance from the path's start to the stage's start, mm.
    pub start: R,
    /// Distance over the stage, mm.
    pub length: R,
    /// Feed at the start.
    pub start_feed: R,
    /// Feed at the end; equal to `start_feed` on a constant stage.
    pub end_feed: R,
    /// Time over the stage.
    pub duration: R,
    /// How the feed changes over that time.
    pub shape: StageShape<R>,
    /// Index of the curve that the stage starts on.
    pub curve_start: usize,
    /// Parameter where the stage starts, interpolated between limit points: for the table, not for motion.
    pub u_start: R,
    /// Index of the curve that the stage ends on.
    pub curve_end: usize,
    /// Parameter where the stage ends.
    pub u_end: R,
}

impl<R: Real> Stage<R> {
    /// Whether the feed rises, falls or stays.
    #[must_use]
    pub fn kind(&self) -> StageKind {
        if self.end_feed > self.start_feed {
            StageKind::Accelerate
        } else if self.end_feed < self.start_feed {
            StageKind::Decelerate
        } else {
            StageKind::Constant
        }
    }

    /// The same stage with each number converted.
    pub fn map<Q>(&self, mut convert: impl FnMut(R) -> Q) -> Stage<Q> {
        Stage {
            start: convert(self.start),
            length: convert(self.length),
            start_feed: convert(self.start_feed),
            end_feed: convert(self.end_feed),
            duration: convert(self.duration),
            shape: self.shape.map(&mut convert),
            curve_start: self.curve_start,
            u_start: convert(self.u_start),
            curve_end: self.curve_end,
            u_end: convert(self.u_end),
        }
    }

    /// The same way in a time that is longer by this factor.
    #[cfg(feature = "alloc")]
    pub(crate) fn slowed(&self, factor: R) -> Self {
        let duration = self.duration * factor;
        let (start_feed, end_feed) = (self.start_feed / factor, self.end_feed / factor);
        Self { duration, start_feed, end_feed, ..*self }
    }

    /// Whether nothing moves in it.
    #[must_use]
    pub fn is_pause(&self) -> bool {
        self.start_feed.is_zero() && self.end_feed.is_zero()
    }

    /// Curve and parameter at which the stage comes to rest, if it does.
    #[must_use]
    pub fn rest(&self) -> Option<(usize, R)> {
        (self.end_feed <= R::zero()).then_some((self.curve_end, self.u_end))
    }

    /// Feed at `time` after the stage's start.
    #[must_use]
    pub fn feed_at(&self, time: R) -> R {
        self.piece().feed(time)
    }

    /// Acceleration at `time` after the stage's start.
    #[must_use]
    pub fn acceleration_at(&self, time: R) -> R {
        self.piece().acceleration(time)
    }

    /// Jerk at `time` after the stage's start.
    #[must_use]
    pub fn jerk_at(&self, time: R) -> R {
        self.piece().jerk(time)
    }

    /// Distance from the stage's start at `time` after it.
    #[must_use]
    pub fn distance_at(&self, time: R) -> R {
        self.piece().distance(time)
    }

    /// Feed, shape and duration alone, which say everything else.
    #[must_use]
    pub fn piece(&self) -> FeedPiece<R> {
        let &Self { shape, start_feed, end_feed, duration, .. } = self;
        FeedPiece { shape, start_feed, end_feed, duration }
    }
}

/// The time that stages take together.
pub(crate) fn duration<R: Real>(stages: &[Stage<R>]) -> R {
    stages.iter().fold(R::zero(), |sum, stage| sum + stage.duration)
}

#[cfg(test)]
pub(crate) mod examples {
    use super::*;

    /// 0 to 1 in 2.5, at 1 for 0.4, down to 0.5 in 1.1: four periods of 1 with three joints.
    pub(crate) fn stages() -> [Stage<f64>; 3] {
        let mut start = 0.0;
        [(0.0, 1.0, 2.5), (1.0, 1.0, 0.4), (1.0, 0.5, 1.1)].map(|(start_feed, end_feed, duration)| {
            let length = (start_feed + end_feed) / 2.0 * duration;
            let here = start;
            start += length;
            Stage {
                start: here,
                length,
                start_feed,
                end_feed,
                duration,
                shape: StageShape::Cubic,
                curve_start: 0,
                u_start: 0.0,
                curve_end: 0,
                u_end: 0.0,
            }
        })
    }
}

#[cfg(test)]
mod tests {
    use super::examples::stages;
    use super::*;

    #[test]
    fn a_stage_rests_where_its_feed_ends_at_zero() {
        let [_, _, last] = stages();
        assert_eq!(last.rest(), None);
        let stop = Stage { end_feed: 0.0, curve_end: 2, u_end: 0.25, ..last };
        assert_eq!(stop.rest(), Some((2, 0.25)));
    }
}
