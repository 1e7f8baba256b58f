//! Flexible acceleration: one half-cosine in place of several S-curves.
//!
//! Where the limit changes again before a transition has ended, an S-curve plan accelerates, brakes and accelerates
//! once more, and each time its jerk steps. Let L be the length of such a stretch, V_i the feed at its start and V_k
//! the feed at its end. One trigonometric transition in the time `t_a = 2L/(V_i + V_k)` covers the same length with two
//! steps of the jerk.
//!
//! From each point without acceleration the merge reads ahead at least the distance in which the commanded feed can be
//! braked to rest. If a bend starts within that distance, it reads on to the next curvature maximum (the next point
//! where the feed is least). Of the stretches that start there and hold at least two transitions, it takes the longest
//! one that may be merged. A merge must
//!
//! 1. keep A: `|V_k - V_i| π/(2t_a) ≤ A`, and J: `|V_k - V_i| π²/(2t_a²) ≤ J`;
//! 2. stay below the limit everywhere, inner minima of the limit and stops among them;
//! 3. take not much longer than what it replaces: it gives up small peaks of the feed, not large ones.
//!
//! Otherwise the S-curves stay. (A half-cosine in place of a single S-curve of the same length always breaks A or J.)
//!
//! Source: paper C (Wang Haitao et al.), section 2.1, which does not state any of the three conditions.

use alloc::vec::Vec;

use real::Real;

use crate::{FeedLimit, FeedPiece, KinematicLimits, ProfileKind, Stage, StageShape, Transition};

/// Parts into which a transition is divided to compare it with the limit; the largest feed of each part counts.
const PARTS: i32 = 32;
/// Most segments in one merge, so that the cost of planning is proportional to the path.
const MOST_SEGMENTS: usize = 16;
/// A merge may take 2⁻⁶ longer than the stages that it replaces: it gives up the small peaks between them. Paper A's
/// curve then takes 0.2 % longer than with S-curves alone, with 93 stages in place of 425.
const TIME_ALLOWANCE: i32 = -6;

/// Why a stretch keeps its S-curves.
#[derive(Clone, Copy, Debug, PartialEq)]
pub enum KeptApart<R> {
    /// The stretch begins and ends at rest, or has no length.
    Rest,
    /// The half-cosine would take this many times the acceleration.
    Acceleration(R),
    /// The half-cosine would take this many times the jerk.
    Jerk(R),
    /// The half-cosine would pass a place above its limit.
    Limit {
        /// Distance from the path's start to that place, mm.
        distance: R,
        /// Feed of the half-cosine there.
        feed: R,
        /// The limit there.
        limit: R,
    },
    /// The half-cosine would take this many times the time; 1 + 2⁻⁶ are allowed.
    Time(R),
}

/// What the profile `Flexible` decides at a place where a transition begins and another follows.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct MergeVerdict<R> {
    /// The stretch, its two feeds and its time with S-curves. The stage's shape has no meaning. If nothing is merged, it is the
    /// shortest stretch that was tried.
    pub stretch: Stage<R>,
    /// How many transitions it holds, each an acceleration or a deceleration.
    pub transitions: usize,
    /// The time of the half-cosine that replaces them, or why there is none.
    pub outcome: Result<R, KeptApart<R>>,
}

/// Stages from one point without acceleration to the next: a transition or a constant feed.
#[derive(Clone, Copy, Debug)]
struct Segment<R> {
    /// Indices of its stages.
    first: usize,
    end: usize,
    /// All of them as one stage. The stage's shape has no meaning.
    whole: Stage<R>,
}

/// The stages of an S-curve plan, merged wherever a merge is allowed.
pub(crate) fn merge<R: Real>(
    limit: &FeedLimit<R>,
    limits: &KinematicLimits<R>,
    stages: &[Stage<R>],
    mut tell: impl FnMut(MergeVerdict<R>),
) -> Vec<Stage<R>> {
    let segments = segments(stages);
    let to_rest = [limits.feedrate, R::zero()];
    let stopping =
        Transition::fastest(ProfileKind::SCurve, to_rest, limits.acceleration, limits.jerk).length();
    let mut merged = Vec::with_capacity(stages.len());
    let mut index = 0;
    while let Some(segment) = segments.get(index) {
        let ahead = read_ahead(segments.get(index..).unwrap_or_default(), stopping);
        let mut shortest = None;
        let longest = (2..=ahead.len()).rev().find_map(|count| {
            let taken = ahead.get(..count)?;
            let transitions = taken.iter().filter(|segment| segment.is_transition()).count();
            let stretch = joined(taken).filter(|_| transitions > 1)?;
            let piece = merged_piece(limit, limits, &stretch);
            let outcome = piece.map(|piece| piece.duration);
            shortest = Some(MergeVerdict { stretch, transitions, outcome });
            Some((count, stretch, piece.ok()?))
        });
        if let Some(verdict) = shortest.filter(|_| segment.is_transition() || longest.is_some()) {
            tell(verdict);
        }
        if let Some((count, stretch, FeedPiece { shape, duration, .. })) = longest {
            merged.push(Stage { shape, duration, ..stretch });
            index += count;
        } else {
            merged.extend_from_slice(stages.get(segment.first..segment.end).unwrap_or_default());
            index += 1;
        }
    }
    merged
}

impl<R: Real> Segment<R> {
    fn is_transition(&self) -> bool {
        self.whole.start_feed != self.whole.end_feed
    }
}

fn segments<R: Real>(stages: &[Stage<R>]) -> Vec<Segment<R>> {
    let mut segments: Vec<Segment<R>> = Vec::new();
    for (index, stage) in stages.iter().enumerate() {
        let is_constant = stage.start_feed == stage.end_feed && stage.shape == StageShape::Steady;
        let continues = matches!(stage.shape, StageShape::Steady | StageShape::Easing) && !is_constant;
        match segments.last_mut().filter(|_| continues) {
            Some(segment) => {
                segment.end = index + 1;
                let whole = &mut segment.whole;
                (whole.length, whole.duration) =
                    (whole.length + stage.length, whole.duration + stage.duration);
                whole.end_feed = stage.end_feed;
            }
            None => segments.push(Segment { first: index, end: index + 1, whole: *stage }),
        }
    }
    segments
}

/// The segments that begin within `stopping`, and those up to the next point where the feed is least.
fn read_ahead<R: Real>(segments: &[Segment<R>], stopping: R) -> &[Segment<R>] {
    let mut distance = R::zero();
    let mut count = 0;
    for segment in segments.iter().take(MOST_SEGMENTS) {
        if distance > stopping && segment.whole.end_feed > segment.whole.start_feed {
            break; // The bend that started within the distance is behind its curvature maximum.
        }
        distance = distance + segment.whole.length;
        count += 1;
    }
    segments.get(..count).unwrap_or_default()
}

/// Segments in a row as one stage. The stage's shape has no meaning.
fn joined<R: Real>(segments: &[Segment<R>]) -> Option<Stage<R>> {
    let sum = |of: fn(&Stage<R>) -> R| segments.iter().fold(R::zero(), |sum, s| sum + of(&s.whole));
    let (length, duration) = (sum(|whole| whole.length), sum(|whole| whole.duration));
    Some(Stage { length, duration, end_feed: segments.last()?.whole.end_feed, ..segments.first()?.whole })
}

/// The half-cosine between two feeds that covers `length`; `None` if both feeds are 0, since it would cover no length.
fn half_cosine_over<R: Real>([start_feed, end_feed]: [R; 2], length: R) -> Option<FeedPiece<R>> {
    let (shape, sum) = (StageShape::Cosine, start_feed + end_feed);
    (sum > R::zero()).then(|| FeedPiece { shape, start_feed, end_feed, duration: (length + length) / sum })
}

/// The half-cosine over a stretch, if it may replace the stages there. `stretch` holds their length, feeds and
/// duration.
pub(crate) fn merged_piece<R: Real>(
    limit: &FeedLimit<R>,
    limits: &KinematicLimits<R>,
    stretch: &Stage<R>,
) -> Result<FeedPiece<R>, KeptApart<R>> {
    let (from, to) = (stretch.start_feed, stretch.end_feed);
    let mut piece = half_cosine_over([from, to], stretch.length).ok_or(KeptApart::Rest)?;
    if from == to {
        piece.shape = StageShape::Steady;
    }
    let end = stretch.start + stretch.length;
    let left = limit.allowance_over(stretch.start, end);
    let (acceleration, jerk) = (limits.acceleration.min(left.acceleration), limits.jerk.min(left.jerk));
    if !(piece.peak_acceleration() <= acceleration) {
        return Err(KeptApart::Acceleration(piece.peak_acceleration() / acceleration));
    }
    if !(piece.peak_jerk() <= jerk) {
        return Err(KeptApart::Jerk(piece.peak_jerk() / jerk));
    }
    if !(piece.duration <= stretch.duration + stretch.duration.ldexp(TIME_ALLOWANCE)) {
        return Err(KeptApart::Time(piece.duration / stretch.duration));
    }
    let mut begin = (stretch.start, from);
    for part in 1..=PARTS {
        let time = piece.duration * R::from_ratio(part, PARTS);
        let is_last = part == PARTS;
        let place = if is_last { end } else { (stretch.start + piece.distance(time)).min(end).max(begin.0) };
        let feed = if is_last { to } else { piece.feed(time) };
        let (passed, allowed) = (feed.max(begin.1), limit.minimum_over(begin.0, place));
        if !(allowed >= passed) {
            return Err(KeptApart::Limit { distance: place, feed: passed, limit: allowed });
        }
        begin = (place, feed);
    }
    Ok(piece)
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::schedule::stage::examples::stages;
    use crate::test_paths::{limit_through, paper_limits};
    use crate::{EndFeeds, jerk_free_duration, plan_with};

    /// A = 1000 mm/s², J = 5e4 mm/s³, in mm and s.
    fn limits() -> KinematicLimits<f64> {
        KinematicLimits {
            interpolation_period: 1e-3,
            feedrate: 200.0,
            acceleration: 1000.0,
            jerk: 5e4,
            ..paper_limits()
        }
    }

    /// A stretch whose fastest S-curves pass these feeds, with a limit that is `inner` at the inner feeds and far above
    /// the feeds elsewhere.
    fn through(feeds: &[f64]) -> (FeedLimit<f64>, Stage<f64>) {
        let (mut distance, mut duration) = (0.0, 0.0);
        let mut points = vec![(0.0, feeds[0])];
        for (i, pair) in feeds.windows(2).enumerate() {
            let ramp = Transition::fastest(ProfileKind::SCurve, [pair[0], pair[1]], 1000.0, 5e4);
            points.push((distance + 1e-6, 200.0));
            distance += ramp.length();
            duration += ramp.duration();
            points.push((distance - 1e-6, 200.0));
            let is_minimum = feeds.get(i + 2).is_none_or(|next| *next > pair[1] && pair[0] > pair[1]);
            points.push((distance, if is_minimum { pair[1] } else { 200.0 }));
        }
        // At the ends the limit is free: only inner minima can refuse a merge.
        points[0].1 = 200.0;
        if let Some(last) = points.last_mut() {
            last.1 = 200.0;
        }
        let limit = limit_through(&points);
        let (length, duration) = (distance, 10.0 * duration);
        let (start_feed, end_feed) = (feeds[0], feeds[feeds.len() - 1]);
        (limit, Stage { start: 0.0, length, start_feed, end_feed, duration, ..stages()[0] })
    }

    fn outcome(feeds: &[f64]) -> Result<FeedPiece<f64>, KeptApart<f64>> {
        let (limit, stretch) = through(feeds);
        merged_piece(&limit, &limits(), &stretch)
    }

    /// Cases computed independently, each with the limit that a merge would break.
    #[test]
    fn a_merge_that_breaks_a_limit_is_refused() {
        // 20-25-24-100 merged over its own length would need 1.139 A.
        let Err(KeptApart::Acceleration(times)) = outcome(&[20.0, 25.0, 24.0, 100.0]) else { panic!() };
        assert!((times - 1.139).abs() < 1e-3, "{times}");
        let (_, stretch) = through(&[20.0, 25.0, 24.0, 100.0]);
        let merged = half_cosine_over([20.0, 100.0], stretch.length).unwrap();
        assert!((merged.peak_acceleration() / 1000.0 - 1.139).abs() < 1e-3);
        // A single S-curve: 50-52 would need 1.234 J.
        let Err(KeptApart::Jerk(times)) = outcome(&[50.0, 52.0]) else { panic!() };
        assert!((times - 1.234).abs() < 1e-3, "{times}");
        // 50-60-58-100 keeps A and J, but passes the inner minimum 58 at 69; 100-60-70 passes 60 at 77.
        for (feeds, least) in [(&[50.0, 60.0, 58.0, 100.0][..], 58.0), (&[100.0, 60.0, 70.0], 60.0)] {
            let Err(KeptApart::Limit { feed, limit, .. }) = outcome(feeds) else { panic!("{feeds:?}") };
            assert!(feed > limit && limit >= least, "{feeds:?}: {feed} {limit}");
        }
        for (feeds, at, passed) in
            [(&[50.0, 60.0, 58.0, 100.0][..], 3, 69.0), (&[100.0, 60.0, 70.0], 2, 77.2)]
        {
            let (_, stretch) = through(feeds);
            let (_, before) = through(&feeds[..at]);
            let merged = half_cosine_over([stretch.start_feed, stretch.end_feed], stretch.length).unwrap();
            let times = (0..=100_000).map(|i| merged.duration * f64::from(i) / 1e5);
            let there = times.min_by(|a, b| {
                (merged.distance(*a) - before.length)
                    .abs()
                    .total_cmp(&(merged.distance(*b) - before.length).abs())
            });
            assert!((merged.feed(there.unwrap()) - passed).abs() < 0.1, "{}", merged.feed(there.unwrap()));
        }
    }

    #[test]
    fn over_a_distance_the_duration_follows() {
        let piece = half_cosine_over([50.0, 100.0], 3.0_f64).unwrap();
        assert!((piece.duration - 0.04).abs() < 1e-16 && (piece.length() - 3.0).abs() < 1e-15);
        assert_eq!(half_cosine_over([0.0, 0.0], 3.0), None);
    }

    /// Paper C does not mention this: a half-cosine that replaces an S-curve of the same length, and so of the same
    /// time, exceeds the jerk limit by the factor π²/8 where only the jerk binds.
    #[test]
    fn in_the_time_of_an_s_curve_it_breaks_the_jerk() {
        let s_curve = Transition::fastest(ProfileKind::SCurve, [50.0, 52.0], 1000.0, 5e4);
        let merged = half_cosine_over([50.0, 52.0], s_curve.length()).unwrap();
        let ratio = merged.peak_jerk() / 5e4;
        assert!((ratio - core::f64::consts::PI.powi(2) / 8.0).abs() < 1e-12, "{ratio}");
    }

    #[test]
    fn a_merge_that_wastes_time_or_stands_still_is_refused() {
        let (limit, stretch) = through(&[50.0, 60.0, 55.0, 60.0]);
        let free = limit_through(&[(0.0, 200.0), (limit.length(), 200.0)]);
        let of = |duration| merged_piece(&free, &limits(), &Stage { duration, ..stretch });
        let duration = 2.0 * stretch.length / 110.0;
        assert!(of(duration).is_ok());
        let Err(KeptApart::Time(times)) = of(duration / 1.02) else { panic!() };
        assert!((times - 1.02).abs() < 1e-9, "{times}");
        let still = Stage { start_feed: 0.0, end_feed: 0.0, ..stretch };
        assert_eq!(merged_piece(&free, &limits(), &still), Err(KeptApart::Rest));
    }

    /// Shallow bends close to each other, then a sharp one.
    #[test]
    fn ripple_is_merged_and_a_sharp_bend_is_not() {
        let mut points = vec![(0.0, 100.0), (20.0, 100.0)];
        for bend in 0..6 {
            let at = 20.0 + 0.7 * f64::from(bend);
            points.extend([(at + 0.2, 50.0 + f64::from(bend)), (at + 0.21, 70.0), (at + 0.49, 70.0)]);
        }
        points.extend([(40.0, 100.0), (41.0, 20.0), (42.0, 100.0), (60.0, 100.0)]);
        let limit = limit_through(&points);
        let limits = limits();
        let planned = |kind| plan_with(&limit, &limits, EndFeeds::default(), kind).unwrap();
        let (plain, flexible) = (planned(ProfileKind::SCurve), planned(ProfileKind::Flexible));
        let cosines = flexible.stages().iter().filter(|s| s.shape == StageShape::Cosine).count();
        assert!(cosines >= 1, "no stretch is merged");
        assert!(
            flexible.stages().len() + 4 < plain.stages().len(),
            "{} {}",
            flexible.stages().len(),
            plain.stages().len()
        );
        // The plan passes the sharp bend at the bend's limit, apart from rounding of the waits around it.
        let passes = |s: &&Stage<f64>| s.start < 41.0 && s.start + s.length > 41.0;
        let there = flexible.stages().iter().find(passes).unwrap();
        assert!(there.start_feed <= 20.0 && there.end_feed <= 20.0, "{there:?}");
        let slower = flexible.as_schedule().duration() / plain.as_schedule().duration();
        assert!(slower <= 1.0 + 1.0 / 64.0, "{slower}");
        assert!(
            flexible.as_schedule().duration() >= jerk_free_duration(&limit, &limits, EndFeeds::default())
        );
    }
}
