//! The stages of a plan while it is put together from its start.

use alloc::vec::Vec;

use real::Real;

use crate::plan::flexible::merge;
use crate::{FeedLimit, FeedPiece, KinematicLimits, Stage, StageShape, Transition};

/// Stages, each beginning where the one before ends.
pub(crate) struct Stages<'l, R> {
    limit: &'l FeedLimit<R>,
    stages: Vec<Stage<R>>,
}

impl<'l, R: Real> Stages<'l, R> {
    pub(crate) fn new(limit: &'l FeedLimit<R>) -> Self {
        Self { limit, stages: Vec::new() }
    }

    /// How many there are.
    pub(crate) fn count(&self) -> usize {
        self.stages.len()
    }

    /// Adds a stretch of constant feed. It lengthens the last stage if that has the same feed; a stretch of no length
    /// adds nothing.
    pub(crate) fn constant(&mut self, start: R, length: R, feed: R) {
        if !(length > R::zero() && feed > R::zero()) {
            return;
        }
        let duration = length / feed;
        match self.stages.last_mut() {
            Some(last) if last.start_feed == feed && last.end_feed == feed => {
                last.length = last.length + length;
                last.duration = last.duration + duration;
            }
            _ => {
                let shape = StageShape::Steady;
                self.push(start, length, &FeedPiece { shape, start_feed: feed, end_feed: feed, duration });
            }
        }
    }

    /// Adds the pieces of a transition.
    pub(crate) fn transition(&mut self, start: R, transition: &Transition<R>) {
        let mut at = start;
        for piece in transition.pieces().iter().filter(|piece| piece.duration > R::zero()) {
            let length = piece.length();
            self.push(at, length, piece);
            at = at + length;
        }
    }

    /// Replaces several transitions by one wherever all limits stay kept: [`merge`].
    pub(crate) fn merge(&mut self, limits: &KinematicLimits<R>) {
        self.stages = merge(self.limit, limits, &self.stages, |_| ());
    }

    /// Adds finished stages.
    pub(crate) fn extend(&mut self, stages: &[Stage<R>]) {
        self.stages.extend_from_slice(stages);
    }

    /// The stages so far, which have no parameters yet.
    pub(crate) fn all(&self) -> &[Stage<R>] {
        &self.stages
    }

    /// The stages, which have no parameters yet.
    pub(crate) fn bare(self) -> Vec<Stage<R>> {
        self.stages
    }

    /// One piece.
    pub(crate) fn push(&mut self, start: R, length: R, piece: &FeedPiece<R>) {
        let &FeedPiece { shape, start_feed, end_feed, duration } = piece;
        let (curve, u) = (0, R::zero());
        self.stages.push(Stage {
            start,
            length,
            start_feed,
            end_feed,
            duration,
            shape,
            curve_start: curve,
            u_start: u,
            curve_end: curve,
            u_end: u,
        });
    }

    /// The finished stages, with the parameters at which they start and end.
    pub(crate) fn with_parameters(mut self) -> Vec<Stage<R>> {
        for stage in &mut self.stages {
            (stage.curve_start, stage.u_start) = self.limit.parameter_at(stage.start);
            let end = stage.start + stage.length;
            let rests = stage.end_feed.is_zero();
            (stage.curve_end, stage.u_end) =
                if rests { self.limit.rest_at(end) } else { self.limit.parameter_at(end) };
        }
        self.stages
    }
}
