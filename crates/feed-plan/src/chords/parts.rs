//! The parts of a path between two stops, changes of feed and constant feeds, and how their feeds are lowered.

use alloc::vec::Vec;

use real::Real;

use crate::chords::stretch::goes_on;
use crate::schedule::stage::duration;
use crate::{FeedLimit, FeedPiece, Stage, StageShape};

/// Acceleration and jerk of a change of feed may rise by 2⁻¹² of themselves: the least that the stretch to whole
/// periods leaves ([`SLOWER`](crate::plan::whole_periods::SLOWER)). With no room at all, the shortfall of a tight bend
/// was spread so far that a run reached the bend 11 steps late, at 2.1 E. With a hundred times as much room, the chord
/// errors of 240 random splines were the same.
const ROOM: i32 = -12;
/// Number of periods at each end of a constant feed over which the correction may change. If a feed is constant for
/// more than three times as long, it stays constant in between.
const BEND: i32 = 32;

/// A change of feed, a constant feed, or one end or the middle of a constant feed.
#[derive(Clone, Copy)]
pub(super) struct Part<R> {
    /// Indices of its stages: the first, and the one behind the last.
    pub(super) first: usize,
    pub(super) behind: usize,
    /// Time from the begin of the first stage to the begin of the part.
    begin: R,
    pub(super) duration: R,
    pub(super) feeds: [R; 2],
    /// The share of the time with which the correction at its end counts for its length: a half where it is symmetric in time.
    pub(super) late: R,
    pub(super) shortfall: R,
    /// By how much the correction may rise, and by how much it may fall, over the part.
    pub(super) rise: R,
    pub(super) fall: R,
}

impl<R: Real> Part<R> {
    pub(super) fn is_constant(&self) -> bool {
        self.feeds[0] == self.feeds[1]
    }

    /// Whether stages up to `count` end within it.
    pub(super) fn is_cut_at(&self, count: usize) -> bool {
        self.first < count && count < self.behind
    }

    fn rises_from_motion(&self) -> bool {
        R::zero() < self.feeds[0] && self.feeds[0] < self.feeds[1]
    }

    /// Corrections that do for a change of feed of which later stages may make a longer one. If the feed falls it may
    /// fall to rest, so the correction is in proportion to it.
    pub(super) fn wherever_it_ends(&self, [begin, end]: [R; 2]) -> [R; 2] {
        let [from, to] = self.feeds;
        [begin, if to < from { begin * (to / from) } else { end }]
    }

    /// One stage of a change of feed, with its feeds lowered by corrections that go from `begin` to `end` over the
    /// change.
    pub(super) fn lowered(&self, stage: &Stage<R>, [begin, end]: [R; 2]) -> Stage<R> {
        let [from, to] = self.feeds;
        let change = to - from;
        let k = if change.is_zero() { R::zero() } else { (end - begin) / change };
        let lowered = |feed: R| if feed == to { feed - end } else { feed - begin - (feed - from) * k };
        let off = begin * stage.duration + (stage.length - from * stage.duration) * k;
        Stage {
            length: stage.length - off,
            start_feed: lowered(stage.start_feed),
            end_feed: lowered(stage.end_feed),
            ..*stage
        }
    }

    /// Appends this part of a stage of constant feed, or lengthens the last of the shortened stages by it.
    pub(super) fn lower_constant(
        &self,
        stage: &Stage<R>,
        [begin, end]: [R; 2],
        limit: &FeedLimit<R>,
        short: &mut Vec<Stage<R>>,
    ) {
        let feed = self.feeds[0];
        let (start_feed, end_feed) = (feed - begin, feed - end);
        let length = (start_feed + end_feed).half() * self.duration;
        let here = (stage.curve_end, stage.u_end);
        let is_rest = self.begin > R::zero();
        if let Some(last) = short.last_mut().filter(|_| is_rest) {
            if start_feed == end_feed && last.start_feed == end_feed && last.end_feed == end_feed {
                last.length = last.length + length;
                last.duration = last.duration + self.duration;
                (last.curve_end, last.u_end) = here;
                return;
            }
            (last.curve_end, last.u_end) = limit.parameter_at(stage.start + feed * self.begin);
        }
        let begins = short.last().filter(|_| is_rest).map(|last| (last.curve_end, last.u_end));
        let (curve_start, u_start) = begins.unwrap_or((stage.curve_start, stage.u_start));
        let shape = if start_feed == end_feed { stage.shape } else { StageShape::Cubic };
        let duration = self.duration;
        short.push(Stage { length, start_feed, end_feed, duration, shape, curve_start, u_start, ..*stage });
    }
}

/// The parts of a path between two stops, and by how much the correction may change over each.
pub(super) fn parts<R: Real>(stages: &[Stage<R>], shortfalls: &[R], period: R) -> Vec<Part<R>> {
    let mut parts: Vec<Part<R>> = Vec::with_capacity(stages.len());
    let bend = period * R::from_ratio(BEND, 1);
    let mut first = 0;
    for change in stages.chunk_by(goes_on) {
        let (Some(begins), Some(ends)) = (change.first(), change.last()) else { continue };
        let behind = first + change.len();
        let duration = duration(change);
        let shortfall = shortfalls.iter().take(behind).skip(first);
        let shortfall = shortfall.fold(R::zero(), |sum, part| sum + part.max(R::zero()));
        let feeds = [begins.start_feed, ends.end_feed];
        let (most, least) = ((feeds[1] - feeds[0]).abs(), (feeds[1] - feeds[0]).abs().ldexp(ROOM));
        let (rise, fall) = if feeds[1] > feeds[0] { (most, least) } else { (least, most) };
        let late = late(change, duration, feeds);
        let part = Part { first, behind, begin: R::zero(), duration, feeds, late, shortfall, rise, fall };
        let middle = duration - bend - bend;
        if part.is_constant() && change.len() == 1 && middle > bend {
            let of = |begin, duration| Part {
                begin,
                duration,
                shortfall: shortfall * (duration / part.duration),
                ..part
            };
            parts.extend([of(R::zero(), bend), of(bend, middle), of(duration - bend, bend)]);
        } else {
            parts.push(part);
        }
        first = behind;
    }
    let changes: Vec<_> =
        parts.iter().map(|part| (!part.is_constant()).then(|| peaks(part, stages))).collect();
    for (index, part) in parts.iter_mut().enumerate().filter(|(_, part)| part.is_constant()) {
        let (before, behind) = changes.split_at(index.min(changes.len()));
        let (before, after) =
            (before.iter().rev().find_map(|peaks| *peaks), behind.iter().find_map(|peaks| *peaks));
        let [a, b] = [before.or(after), after.or(before)].map(|peaks| peaks.unwrap_or([R::zero(); 2]));
        let (acceleration, jerk) = (a[0].min(b[0]), a[1].min(b[1]));
        let by_acceleration = acceleration * part.duration / StageShape::<R>::Cubic.peak_slope();
        let by_jerk = jerk * part.duration * part.duration / StageShape::<R>::Cubic.peak_bend();
        // In less than a period the correction could hardly change.
        let most = if part.duration < period { R::zero() } else { by_acceleration.min(by_jerk) };
        (part.rise, part.fall) = (most, most);
    }
    parts
}

/// Holds the correction back over a rise of feed of which later stages may make a longer one: it rises by no more than the
/// mean share by which chords fall short. With twice that, runs were behind their plan at the stop, which cannot be made
/// up for; with nothing at all, a run through windows of one rise each never corrected itself.
pub(super) fn part_way<R: Real>(parts: &mut [Part<R>], stages: &[Stage<R>], shortfalls: &[R], count: usize) {
    let length = stages.iter().fold(R::zero(), |sum, stage| sum + stage.length);
    let shortfall = shortfalls.iter().fold(R::zero(), |sum, part| sum + part.max(R::zero()));
    for part in parts.iter_mut().filter(|part| part.is_cut_at(count) && part.rises_from_motion()) {
        part.rise = part.rise * (shortfall / length).min(R::one().ldexp(ROOM));
        part.fall = R::zero();
    }
}

/// The mean of g over a change of feed. Over a chain of stages of constant jerk that need not be a half.
fn late<R: Real>(stages: &[Stage<R>], duration: R, [from, to]: [R; 2]) -> R {
    let half = R::one().half();
    let is_symmetric = !stages.iter().any(|stage| matches!(stage.shape, StageShape::Bent(_)))
        && stages.iter().map(|stage| stage.duration).eq(stages.iter().rev().map(|stage| stage.duration));
    let change = (to - from) * duration;
    if is_symmetric || change.is_zero() {
        return half;
    }
    let above = stages.iter().fold(R::zero(), |sum, stage| sum + (stage.length - from * stage.duration));
    (above / change).max(R::zero()).min(R::one())
}

/// The largest acceleration and jerk of a part's stages.
fn peaks<R: Real>(part: &Part<R>, stages: &[Stage<R>]) -> [R; 2] {
    let pieces = stages.get(part.first..part.behind).unwrap_or_default().iter().map(Stage::piece);
    let larger = |[a, j]: [R; 2], piece: FeedPiece<R>| {
        [a.max(piece.peak_acceleration().abs()), j.max(piece.peak_jerk().abs())]
    };
    pieces.fold([R::zero(); 2], larger)
}
