//! What is to be lowered for chords, and how what is final before it ends.

use real::Real;

use crate::{Stage, StageShape};

/// The stages to the next stop, from a stop or from where the stages before them, which are final, end in motion.
#[derive(Clone, Copy)]
pub(crate) struct Stretch<'a, R> {
    pub(crate) stages: &'a [Stage<R>],
    /// By how much each stage falls short.
    pub(crate) shortfalls: &'a [R],
    /// How the stages before these end, if they end in motion.
    pub(crate) begin: Option<Lowered<R>>,
    /// How many stages are wanted. The others only show how the path goes on.
    pub(crate) count: usize,
}

/// The end of lowered stages that other stages follow.
#[derive(Clone, Copy)]
pub(crate) struct Lowered<R> {
    /// By how much the feed is lowered there.
    pub(crate) correction: R,
    /// By how much the run is ahead of its plan.
    pub(crate) ahead: R,
    /// The change of the correction for a change of the feed up to the end of the change that goes on there, if one does.
    pub(crate) slope: Option<R>,
}

impl<R: Real> Lowered<R> {
    /// The end of these stages, the same ones in arcs and in chords, which follow those that end `before`; `None` at a
    /// stop.
    pub(crate) fn behind(before: Option<Self>, arcs: &[Stage<R>], chords: &[Stage<R>]) -> Option<Self> {
        let (last, short) = (arcs.last()?, chords.last()?);
        if !(last.end_feed > R::zero()) {
            return None;
        }
        let correction = last.end_feed - short.end_feed;
        let goes_on = |stage: &&Stage<R>| is_under_way(stage) && stage.kind() == last.kind();
        let count = arcs.iter().rev().take_while(goes_on).count();
        let before = before.and_then(|before| before.slope).filter(|_| count == arcs.len());
        let begins = [arcs, chords].map(|stages| stages.iter().rev().nth(count.saturating_sub(1)));
        let slope = before.or_else(|| {
            let [whole, short] = [begins[0]?.start_feed, begins[1]?.start_feed];
            let change = last.end_feed - whole;
            Some(if change.is_zero() { change } else { (correction - (whole - short)) / change })
        });
        Some(Self { correction, ahead: R::zero(), slope: slope.filter(|_| count > 0) })
    }

    /// The same end where the run is ahead of its plan by so much more.
    pub(crate) fn ahead_by(self, more: R) -> Self {
        Self { ahead: self.ahead + more, ..self }
    }
}

impl<'a, R> Stretch<'a, R> {
    /// All stages from a stop to the next.
    pub(crate) fn of(stages: &'a [Stage<R>], shortfalls: &'a [R]) -> Self {
        Self { stages, shortfalls, begin: None, count: stages.len() }
    }
}

/// Whether a stage continues the change of feed of the one before it. What rises and then falls is no one change, also where a
/// rounding is left of the acceleration in between.
pub(crate) fn goes_on<R: Real>(before: &Stage<R>, stage: &Stage<R>) -> bool {
    is_under_way(before) && before.kind() == stage.kind()
}

/// Whether a stage ends with acceleration, so that the next stage continues its change of feed.
pub(crate) fn is_under_way<R: Real>(stage: &Stage<R>) -> bool {
    matches!(stage.shape, StageShape::Onset | StageShape::Steady | StageShape::Bent(_))
        && stage.start_feed != stage.end_feed
}
