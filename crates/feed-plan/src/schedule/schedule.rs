//! The plan over borrowed stages, and the cursor that walks them one period at a time.

use real::Real;

use crate::schedule::section::AT_REST;
use crate::schedule::stage::duration;
use crate::{Section, Stage, sections};

/// A plan over borrowed stages. It is `Copy`, needs no heap, and is all that the real-time loop needs.
///
/// A controller without an allocator can keep the stages of a plan made elsewhere in flash.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Schedule<'a, R> {
    stages: &'a [Stage<R>],
    interpolation_period: R,
    periods: u64,
}

/// The state of a run: a few words that change from period to period. All else is constant.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Cursor<R> {
    stage: usize,
    /// Time from the start of the stage to the first setpoint in it.
    offset: R,
    /// Periods since then, a whole number. The time is `offset + count T`: summed period by period, it would
    /// lose a unit of its last place each.
    count: R,
    period: u64,
}

impl<R: Real> Cursor<R> {
    /// Index of the stage.
    #[must_use]
    pub fn stage(&self) -> usize {
        self.stage
    }

    /// The same cursor where the stages before its own are left out.
    #[cfg(feature = "alloc")]
    pub(crate) fn in_first_stage(self) -> Self {
        Self { stage: 0, period: 0, ..self }
    }

    /// Number of periods that have been given out.
    #[must_use]
    pub fn period(&self) -> u64 {
        self.period
    }
}

impl<'a, R: Real> Schedule<'a, R> {
    /// A schedule over stages made elsewhere, which together take `periods` interpolation periods.
    #[must_use]
    pub const fn new(stages: &'a [Stage<R>], interpolation_period: R, periods: u64) -> Self {
        Self { stages, interpolation_period, periods }
    }

    /// The stages, in order.
    #[must_use]
    pub fn stages(&self) -> &'a [Stage<R>] {
        self.stages
    }

    /// The sections of the plan, each from rest to rest, in order.
    pub fn sections(&self) -> impl Iterator<Item = Section<'a, R>> + use<'a, R> {
        sections(self.stages)
    }

    /// Time of the whole plan: `periods()` times the interpolation period, up to rounding.
    #[must_use]
    pub fn duration(&self) -> R {
        duration(self.stages)
    }

    /// Distance of the whole plan.
    #[must_use]
    pub fn length(&self) -> R {
        self.stages.iter().fold(R::zero(), |sum, stage| sum + stage.length)
    }

    /// The interpolation period T, in the unit of time in which the plan was made; 1 if that unit is the period.
    #[must_use]
    pub fn interpolation_period(&self) -> R {
        self.interpolation_period
    }

    /// Duration in interpolation periods, a whole number.
    #[must_use]
    pub fn periods(&self) -> u64 {
        self.periods
    }

    /// The cursor at the start.
    #[must_use]
    pub fn start(&self) -> Cursor<R> {
        Cursor { stage: 0, offset: R::zero(), count: R::zero(), period: 0 }
    }

    /// Whether the last period has been given out.
    #[must_use]
    pub fn is_over(&self, cursor: &Cursor<R>) -> bool {
        cursor.period >= self.periods
    }

    /// The distance to travel in the next period, the exact integral of the feed; `None` after the last.
    ///
    /// For a period that straddles joints of stages, it is the sum of the parts. The last period takes the whole
    /// distance that is left. A period that ends less than 2⁻¹⁰ of a period before a stop takes the rest of the way to
    /// the stop, so that rounding of times loses no distance; unless a pause there lasts until the period is over. The function takes as many steps as the period has
    /// joints.
    pub fn advance(&self, cursor: &mut Cursor<R>) -> Option<R> {
        if self.is_over(cursor) {
            return None;
        }
        cursor.period += 1;
        let takes_the_rest = self.is_over(cursor);
        let mut distance = R::zero();
        let mut left = self.interpolation_period;
        let (begun_in, mut time) = (cursor.stage, self.time(cursor));
        for stage in self.stages.get(cursor.stage..)? {
            let until_joint = stage.duration - time;
            let pauses = || self.stages.get(cursor.stage + 1).is_some_and(Stage::is_pause);
            let is_near = || until_joint - left < self.interpolation_period.ldexp(AT_REST);
            let is_at_stop = || stage.end_feed.is_zero() && is_near() && !pauses();
            if !takes_the_rest && left < until_joint && !is_at_stop() {
                (cursor.offset, cursor.count) = if cursor.stage == begun_in {
                    (cursor.offset, cursor.count + R::one())
                } else {
                    (left, R::zero())
                };
                return Some(distance + stage.piece().distance_over(time, left));
            }
            distance = distance + stage.piece().distance_over(time, until_joint);
            left = (left - until_joint).max(R::zero());
            cursor.stage += 1;
            time = R::zero();
        }
        (cursor.offset, cursor.count) = (R::zero(), R::zero());
        Some(distance)
    }

    /// Passes over the whole periods that begin and end in the cursor's stage if its feed is constant, up to the last one, and
    /// returns how many: each goes as far as the one before it, if that lies in the stage too.
    pub fn pass_constant(&self, cursor: &mut Cursor<R>) -> u32 {
        let constant = |stage: &&Stage<R>| stage.start_feed == stage.end_feed && stage.start_feed > R::zero();
        let Some(stage) = self.stages.get(cursor.stage).filter(constant) else { return 0 };
        let left = (stage.duration - self.time(cursor)) / self.interpolation_period - R::one();
        let whole = if left > R::one() { (left.to_phase(-32) >> 32) - 1 } else { 0 };
        let most = self.periods.saturating_sub(cursor.period.saturating_add(1));
        let count = i32::try_from(whole.min(most)).unwrap_or(i32::MAX);
        cursor.count = cursor.count + R::from_ratio(count, 1);
        cursor.period += u64::from(count.unsigned_abs());
        count.unsigned_abs()
    }

    /// Time since the start of the cursor's stage.
    #[must_use]
    pub fn time(&self, cursor: &Cursor<R>) -> R {
        cursor.count.mul_add(self.interpolation_period, cursor.offset)
    }

    /// Feed at the cursor. At a joint it is the feed of the stage that begins there; behind the end it is the feed at
    /// the end.
    #[must_use]
    pub fn feed(&self, cursor: &Cursor<R>) -> R {
        self.at(cursor, Stage::feed_at)
    }

    /// Distance from the path's start at the cursor.
    #[must_use]
    pub fn distance(&self, cursor: &Cursor<R>) -> R {
        self.at(cursor, |stage, time| stage.start + stage.distance_at(time))
    }

    fn at(&self, cursor: &Cursor<R>, quantity: impl Fn(&Stage<R>, R) -> R) -> R {
        match (self.stages.get(cursor.stage), self.stages.last()) {
            (Some(stage), _) => quantity(stage, self.time(cursor)),
            (None, Some(last)) => quantity(last, last.duration),
            (None, None) => R::zero(),
        }
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::schedule::stage::examples::stages;
    use crate::{StageKind, StageShape};

    #[test]
    fn periods_that_straddle_joints_lose_nothing() {
        let stages = stages();
        let schedule = Schedule::new(&stages, 1.0, 4);
        let mut cursor = schedule.start();
        let mut travelled = 0.0;
        while let Some(step) = schedule.advance(&mut cursor) {
            travelled += step;
            assert!((schedule.distance(&cursor) - travelled).abs() < 1e-15, "{travelled}");
        }
        assert_eq!((cursor.period(), cursor.stage()), (4, 3));
        assert!((travelled - schedule.length()).abs() < 1e-15);
        assert_eq!(schedule.feed(&cursor), 0.5);
        assert_eq!(schedule.advance(&mut cursor), None);
    }

    /// Up to the end of a constant feed, and no further; the last period of a plan is given out in any case.
    #[test]
    fn passing_over_a_constant_feed_loses_no_period_and_no_way() {
        let constant = |duration: f64| Stage { duration, length: duration, ..stages()[1] };
        let [rise, _, fall] = stages();
        for (middle, periods) in [(100.4, 104), (3.4, 7), (1.9, 6), (0.4, 4)] {
            let plan = [rise, constant(middle), Stage { duration: periods as f64 - 2.5 - middle, ..fall }];
            let schedule = Schedule::new(&plan, 1.0, periods);
            let (mut cursor, mut steps) = (schedule.start(), Vec::new());
            while let Some(step) = schedule.advance(&mut cursor) {
                let passed = schedule.pass_constant(&mut cursor);
                assert!(passed == 0 || cursor.stage() == 1, "{cursor:?}");
                steps.push(step);
                steps.extend((0..passed).map(|_| 1.0));
            }
            let mut cursor = schedule.start();
            let expected: Vec<_> = core::iter::from_fn(|| schedule.advance(&mut cursor)).collect();
            assert_eq!(steps, expected, "{middle}");
        }
        let alone = [constant(50.0)];
        let schedule = Schedule::new(&alone, 1.0, 50);
        let mut cursor = schedule.start();
        assert_eq!((schedule.pass_constant(&mut cursor), cursor.period()), (48, 48));
        assert_eq!(core::iter::from_fn(|| schedule.advance(&mut cursor)).sum::<f64>(), 2.0);
    }

    #[test]
    fn a_period_that_ends_at_a_stop_but_for_rounding_takes_the_rest_of_the_way_to_it() {
        let fall = |duration| Stage { duration, end_feed: 0.0, length: 0.5 * duration, ..stages()[2] };
        let rise = Stage { duration: 2.0, start_feed: 0.0, end_feed: 1.0, length: 1.0, ..stages()[0] };
        for off in [0.0, 1e-12, 1e-4, -1e-12] {
            let stages =
                [Stage { start_feed: 1.0, ..fall(2.0 + off) }, Stage { start: 1.0 + off / 2.0, ..rise }];
            let schedule = Schedule::new(&stages, 1.0, 4);
            let mut cursor = schedule.start();
            let steps: Vec<_> =
                core::iter::from_fn(|| schedule.advance(&mut cursor).map(|step| (step, cursor))).collect();
            assert_eq!(steps[1].1.stage(), 1, "{off}");
            assert!((steps[0].0 + steps[1].0 - stages[0].length).abs() < 1e-12, "{off}");
            assert!((steps[2].0 + steps[3].0 - 1.0).abs() < 1e-12, "{off}");
        }
        // A stop in the middle of a period is passed.
        let stages = [Stage { start_feed: 1.0, ..fall(2.1) }, Stage { start: 1.05, ..rise }];
        let schedule = Schedule::new(&stages, 1.0, 5);
        let mut cursor = schedule.start();
        let _ = (schedule.advance(&mut cursor), schedule.advance(&mut cursor));
        assert_eq!(cursor.stage(), 0);
    }

    /// The way to the stop was taken early, and the section behind the pause began that much too early.
    #[test]
    fn a_stop_just_behind_a_period_does_not_shorten_the_pause_there() {
        let early = 2.0_f64.powi(-11);
        let [rise, ..] = stages();
        let fall = Stage { start_feed: 1.0, end_feed: 0.0, duration: 1.5 + early, ..rise };
        let rest = Stage { end_feed: 0.0, duration: 1.0 - early, shape: StageShape::Steady, ..rise };
        let stages = [rise, fall, rest, rise, Stage { duration: 1.5, ..fall }];
        let schedule = Schedule::new(&stages, 1.0, 9);
        let alone = Schedule::new(&stages[3..], 1.0, 4);
        let (mut whole, mut behind) = (schedule.start(), alone.start());
        for _ in 0..5 {
            let _ = schedule.advance(&mut whole);
        }
        for period in 5..9 {
            assert_eq!(schedule.advance(&mut whole), alone.advance(&mut behind), "period {period}");
        }
    }

    #[test]
    fn a_stage_tells_its_kind() {
        assert_eq!(
            stages().map(|s| s.kind()),
            [StageKind::Accelerate, StageKind::Constant, StageKind::Decelerate]
        );
    }

    #[test]
    fn long_stages_give_equal_steps_in_narrow_formats() {
        // 100 000 periods at constant feed, which begin half a period into the stage: if times were summed, the error
        // would be far larger.
        let first = Stage { duration: 0.5_f32, length: 0.15, ..constant(0.3) };
        let stages = [first, Stage { duration: 100_000.0, length: 30_000.0, ..constant(0.3) }];
        let schedule = Schedule::new(&stages, 1.0, 100_001);
        let mut cursor = schedule.start();
        for _ in 0..100_000 {
            let step = schedule.advance(&mut cursor).unwrap();
            assert!((step - 0.3).abs() <= 3.0 * f32::EPSILON, "{step}");
        }
        assert!((schedule.advance(&mut cursor).unwrap() - 0.15).abs() < 0.01);
        assert!(schedule.is_over(&cursor));
    }

    fn constant(feed: f32) -> Stage<f32> {
        Stage {
            start: 0.0,
            length: 0.0,
            start_feed: feed,
            end_feed: feed,
            duration: 0.0,
            shape: StageShape::Steady,
            curve_start: 0,
            u_start: 0.0,
            curve_end: 0,
            u_end: 0.0,
        }
    }

    #[test]
    fn an_empty_schedule_is_over_at_once() {
        let schedule = Schedule::<f32>::new(&[], 1.0, 0);
        assert_eq!(schedule.advance(&mut schedule.start()), None);
        assert_eq!(schedule.feed(&schedule.start()), 0.0);
        // A wrong count of periods gives steps of no length, not a panic.
        let wrong = Schedule::<f32>::new(&[], 1.0, 2);
        assert_eq!(wrong.advance(&mut wrong.start()), Some(0.0));
    }
}
