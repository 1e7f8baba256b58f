//! What a planner that goes window by window has in view: the samples of the limit, and the curves under them.

use alloc::vec::Vec;

use nurbs_core::Differentiate;
use real::Real;

use crate::chords::shortfall::Path;
use crate::limit::sample::ScannedSample;
use crate::limit::scan::Scan;
use crate::{FeedLimit, KinematicLimits, PlanError};

/// Before a window's begin the limit is kept for two periods at full feed. The period in which the window before ended
/// begins there.
const BEHIND: i32 = 1;

/// A curve of a path as a program commands it.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct CommandedCurve<C, R> {
    /// The curve, which starts where the one before ends.
    pub curve: C,
    /// The largest feed on the curve, above 0, as for [`FeedLimit::capped`].
    pub feed: R,
    /// Whether it begins at rest whatever the directions, as for [`FeedLimit::along_with_stops`].
    pub from_rest: bool,
}

/// The curves, which are sampled span by span. Those in view are kept.
struct Source<C, R, I> {
    curves: I,
    /// The curves in view, of which the last is being sampled unless the path is over, and their feeds.
    in_view: Vec<C>,
    feeds: Vec<R>,
    /// Index of the first curve in view.
    first: usize,
    /// The next span of the last curve in view, and whether that curve begins at rest; `None` behind the path's end.
    at: Option<(usize, bool)>,
}

impl<C, R: Real, I: Iterator<Item = CommandedCurve<C, R>>> Source<C, R, I> {
    fn new(curves: impl IntoIterator<Item = CommandedCurve<C, R>, IntoIter = I>) -> Self {
        let curves = curves.into_iter();
        let mut source = Self { curves, in_view: Vec::new(), feeds: Vec::new(), first: 0, at: None };
        source.open();
        source
    }

    /// Takes the next curve.
    fn open(&mut self) {
        self.at = self.curves.next().map(|CommandedCurve { curve, feed, from_rest }| {
            self.in_view.push(curve);
            self.feeds.push(feed);
            (0, from_rest)
        });
    }

    /// The feed of a curve in view.
    fn feed_of(&self, curve: usize) -> R {
        let known = curve.checked_sub(self.first).and_then(|place| self.feeds.get(place));
        known.copied().unwrap_or_else(R::max_value)
    }

    /// Drops the curves before this one.
    fn forget_before(&mut self, curve: usize) {
        let count = curve.saturating_sub(self.first).min(self.in_view.len());
        self.in_view.drain(..count);
        self.feeds.drain(..count);
        self.first += count;
    }

    /// Samples the next span.
    fn pass<const D: usize>(&mut self, scan: &mut Scan<'_, R, D>) -> Result<(), PlanError>
    where
        C: Differentiate<R, D>,
    {
        let (Some((span, from_rest)), Some(curve)) = (&mut self.at, self.in_view.last()) else {
            return Ok(());
        };
        if *span < curve.span_count() {
            let index = self.first + self.in_view.len() - 1;
            scan.pass_span(index, curve, *span, *from_rest && *span == 0)?;
            *span += 1;
        }
        if *span >= curve.span_count() {
            self.open();
        }
        Ok(())
    }
}

/// The samples in view, from a little before the window's begin to its end.
pub(crate) struct View<'l, R, const D: usize, C, I> {
    source: Source<C, R, I>,
    scan: Scan<'l, R, D>,
    limits: &'l KinematicLimits<R>,
    window: R,
}

impl<'l, R: Real, const D: usize, C: Differentiate<R, D>, I: Iterator<Item = CommandedCurve<C, R>>>
    View<'l, R, D, C, I>
{
    pub(crate) fn new(
        curves: impl IntoIterator<Item = CommandedCurve<C, R>, IntoIter = I>,
        limits: &'l KinematicLimits<R>,
        window: R,
    ) -> Self {
        Self { source: Source::new(curves), scan: Scan::new(limits), limits, window }
    }

    /// Moves the window's begin. Returns whether any path is left.
    pub(crate) fn advance(&mut self, begin: R) -> Result<bool, PlanError> {
        let KinematicLimits { chord_error, feedrate, interpolation_period, .. } = *self.limits;
        // A stop lets the limit jump within the chord error of it: samples that far back are still needed.
        let behind = chord_error.ldexp(1).max((feedrate * interpolation_period).ldexp(BEHIND));
        self.scan.forget_before(begin - behind);
        if let Some(first) = self.scan.samples().first() {
            self.source.forget_before(first.point.curve);
        }
        let is_in_view = |sample: &ScannedSample<R>| sample.point.distance - begin >= self.window;
        while self.source.at.is_some() && !self.scan.settled().last().is_some_and(is_in_view) {
            self.source.pass(&mut self.scan)?;
            if self.source.at.is_none() {
                self.scan.finish();
            }
        }
        Ok(self.scan.length() > begin)
    }

    /// The limit to the first sample at or beyond the window's end. It begins a little before the window.
    pub(crate) fn limit(&self, begin: R) -> Result<FeedLimit<R>, PlanError> {
        let samples = if self.source.at.is_none() { self.scan.samples() } else { self.scan.settled() };
        let count = samples.partition_point(|sample| sample.point.distance - begin < self.window);
        let samples = samples.get(..=count).unwrap_or(samples).to_vec();
        let (corners, rests) = (self.scan.corners(), self.scan.curves_from_rest());
        let limit = FeedLimit::assemble(samples, corners.to_vec(), self.limits.chord_error)?;
        limit.resting_before(rests.to_vec()).capped(|curve| self.source.feed_of(curve))
    }

    /// The path under a limit in view.
    pub(crate) fn path<'a>(&'a self, limit: &'a FeedLimit<R>) -> Path<'a, R, C, D> {
        Path::in_view(limit, self.source.first, &self.source.in_view)
    }

    /// Whether a limit in view goes to the path's end.
    pub(crate) fn ends_with(&self, limit: &FeedLimit<R>) -> bool {
        self.source.at.is_none() && limit.length() >= self.scan.length()
    }

    /// Number of samples in view.
    pub(crate) fn points(&self) -> usize {
        self.scan.samples().len()
    }
}
