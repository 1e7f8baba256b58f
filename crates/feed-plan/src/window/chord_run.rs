//! The stages of windows, one window after the other, in chords.
//!
//! The plan of a window leads to rest at the window's end, and only its first stages are final. All of them say by how
//! much the final ones are lowered: the correction is a continuous function of time, and the stages behind show where it
//! goes. What is final stays as it is. So the next window begins with the correction that the last final stage ends
//! with. Where the feed is changing there, the correction stays in proportion to the feed up to the end of the change.
//!
//! The chords of the final stages are followed from period to period. By what the run is then ahead of its plan, the
//! stages of the next window are shortened more than by their own shortfalls. The last stages before a stop are lowered
//! so that the run lands on it.

use alloc::vec;
use alloc::vec::Vec;

use nurbs_core::Differentiate;
use real::Real;

use crate::chords::feeds;
use crate::chords::landing::Before;
use crate::chords::shortfall::Path;
use crate::chords::stretch::{Lowered, Stretch};
use crate::plan::whole_periods::round_up;
use crate::{Cursor, PlanError, Schedule, Stage, StageShape, sections};

/// The run is kept ahead of its plan by 2⁻¹² of a step: a length that is missing at a stop could not be added.
const LEAD: i32 = -12;
/// A run that is off its stop by less than 2⁻²⁰ of a step lands on it.
const ON_STOP: i32 = -20;

/// Stages of a plan that are final: the same plan in arcs and in chords.
#[derive(Clone, Debug, PartialEq)]
pub struct FinalStages<R> {
    /// The stages along the path: distances are arc lengths.
    pub arcs: Vec<Stage<R>>,
    /// The stages that an interpolator runs: distances are summed lengths of the chords between setpoints. Together they
    /// take the same time. A constant feed may be divided.
    pub chords: Vec<Stage<R>>,
}

/// A run by chords along the stages that are final.
pub(crate) struct ChordRun<R> {
    period: R,
    /// The stages in which the last whole period ends, and those behind it, in arcs and in chords.
    last: FinalStages<R>,
    /// The end of that period in these.
    cursors: [Cursor<R>; 2],
    /// The distance that the chords have come to then.
    reached: R,
    /// How the last stage ends, if in motion.
    begin: Option<Lowered<R>>,
    /// Time since the last stop.
    time: R,
    /// Sum of the lengths of all stages in chords.
    length: R,
    /// Periods up to the last stop.
    pub(crate) periods: u64,
}

impl<R: Real> ChordRun<R> {
    pub(crate) fn new(period: R) -> Self {
        let start = Schedule::new(&[], period, u64::MAX).start();
        Self {
            period,
            last: FinalStages { arcs: Vec::new(), chords: Vec::new() },
            cursors: [start; 2],
            reached: R::zero(),
            begin: None,
            time: R::zero(),
            length: R::zero(),
            periods: 0,
        }
    }

    /// Takes the plan of a window, of which the first `count` stages are final, and returns these. At each stop a pause
    /// lasts until the period is over.
    pub(crate) fn take<C: Differentiate<R, D>, const D: usize>(
        &mut self,
        path: &Path<'_, R, C, D>,
        plan: &[Stage<R>],
        count: usize,
    ) -> Result<FinalStages<R>, PlanError> {
        let mut taken = FinalStages { arcs: Vec::new(), chords: Vec::new() };
        for section in sections(plan).take_while(|section| section.first() < count) {
            let stages = section.stages();
            let own = stages.len().min(count - section.first());
            let (short, due) = self.shortfalls(path, stages);
            let begin = self.begin.map(|begin| begin.ahead_by(due));
            let stretch = Stretch { stages, shortfalls: &short, begin, count: own };
            let chords = self.in_chords(path, &stretch);
            self.append(path, &stages[..own], chords, &mut taken)?;
        }
        Ok(taken)
    }

    /// By how much the chords of each stage are shorter than its arcs if each period begins on the plan, and the same for
    /// the part of the first period that lies before these stages.
    fn shortfalls<C: Differentiate<R, D>, const D: usize>(
        &self,
        path: &Path<'_, R, C, D>,
        stages: &[Stage<R>],
    ) -> (Vec<R>, R) {
        let before = self.last.arcs.len();
        let all = [&self.last.arcs, stages].concat();
        let schedule = Schedule::new(&all, self.period, u64::MAX);
        let mut shortfalls = vec![R::zero(); all.len()];
        let mut cursor = self.cursors[0];
        let mut from = schedule.distance(&cursor);
        while cursor.stage() < all.len() {
            let (begins_in, mut left) = (cursor.stage(), self.period);
            let mut since = schedule.time(&cursor);
            if schedule.advance(&mut cursor).is_none() {
                break;
            }
            let to = schedule.distance(&cursor);
            let share = (to - from - path.step_between(from, to)) / self.period;
            for (stage, shortfall) in all.iter().zip(&mut shortfalls).skip(begins_in) {
                let part = (stage.duration - since).min(left).max(R::zero());
                *shortfall = *shortfall + share * part;
                left = left - part;
                since = R::zero();
                if !(left > R::zero()) {
                    break;
                }
            }
            from = to;
        }
        let own = shortfalls.split_off(before);
        (own, shortfalls.into_iter().fold(R::zero(), |sum, part| sum + part))
    }

    /// The final stages of a stretch in chords.
    fn in_chords<C: Differentiate<R, D>, const D: usize>(
        &self,
        path: &Path<'_, R, C, D>,
        stretch: &Stretch<'_, R>,
    ) -> Vec<Stage<R>> {
        if stretch.count < stretch.stages.len() {
            return feeds::shortened(path.limit, stretch, R::zero(), self.period);
        }
        let fastest = stretch.stages.iter().fold(R::zero(), |most, stage| most.max(stage.start_feed));
        let rounding = if R::IS_FLOATING { R::resolution() * path.limit.length() } else { R::resolution() };
        let enough = (fastest * self.period.ldexp(ON_STOP)).max(rounding);
        let before = Before { stages: &self.last.chords, cursor: self.cursors[1], reached: self.reached };
        path.landed(&before, stretch, self.period, enough)
    }

    /// Appends final stages, and a pause behind a stop; follows the run along them.
    fn append<C: Differentiate<R, D>, const D: usize>(
        &mut self,
        path: &Path<'_, R, C, D>,
        arcs: &[Stage<R>],
        chords: Vec<Stage<R>>,
        taken: &mut FinalStages<R>,
    ) -> Result<(), PlanError> {
        let from_chords = taken.chords.len();
        taken.arcs.extend_from_slice(arcs);
        for stage in chords {
            taken.chords.push(Stage { start: self.length, ..stage });
            self.length = self.length + stage.length;
        }
        self.time = arcs.iter().fold(self.time, |sum, stage| sum + stage.duration);
        let (Some(last), Some(short)) = (arcs.last(), taken.chords.last().copied()) else { return Ok(()) };
        self.begin = Lowered::behind(self.begin, arcs, &taken.chords[from_chords..]);
        if self.begin.is_some() {
            self.last.arcs.extend_from_slice(arcs);
            self.last.chords.extend_from_slice(&taken.chords[from_chords..]);
            self.follow(path, last.end_feed);
            return Ok(());
        }
        let (periods, whole) = round_up(self.time / self.period).ok_or(PlanError::DurationOverflows)?;
        self.periods = self.periods.checked_add(u64::from(periods)).ok_or(PlanError::DurationOverflows)?;
        let wait = whole * self.period - self.time;
        if wait > R::zero() {
            taken.arcs.push(pause(last, wait));
            taken.chords.push(pause(&short, wait));
        }
        *self = Self { length: self.length, periods: self.periods, ..Self::new(self.period) };
        self.reached = last.start + last.length;
        Ok(())
    }

    /// Follows the run to the end of the last whole period. What lies before that is forgotten.
    fn follow<C: Differentiate<R, D>, const D: usize>(&mut self, path: &Path<'_, R, C, D>, feed: R) {
        let FinalStages { arcs, chords } = &mut self.last;
        let [planned, run] = [&*arcs, &*chords].map(|stages| Schedule::new(stages, self.period, u64::MAX));
        let [mut by_arcs, mut by_chords] = self.cursors;
        while by_arcs.stage() < arcs.len() && by_chords.stage() < chords.len() {
            self.cursors = [by_arcs, by_chords];
            let wanted = planned.advance(&mut by_arcs).and_then(|_| run.advance(&mut by_chords));
            let is_whole = by_arcs.stage() < arcs.len() && by_chords.stage() < chords.len();
            let Some(wanted) = wanted.filter(|_| is_whole) else { break };
            self.reached = self.reached + path.arc_of_step(self.reached, wanted);
        }
        let lead = feed * self.period.ldexp(LEAD);
        let ahead = self.reached - planned.distance(&self.cursors[0]) - lead;
        self.begin = self.begin.map(|begin| begin.ahead_by(ahead));
        arcs.drain(..self.cursors[0].stage());
        chords.drain(..self.cursors[1].stage());
        self.cursors = self.cursors.map(|cursor| cursor.in_first_stage());
    }
}

/// A pause after `stage`.
fn pause<R: Real>(stage: &Stage<R>, duration: R) -> Stage<R> {
    Stage {
        start: stage.start + stage.length,
        length: R::zero(),
        start_feed: R::zero(),
        end_feed: R::zero(),
        duration,
        shape: StageShape::Steady,
        curve_start: stage.curve_end,
        u_start: stage.u_end,
        ..*stage
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::test_paths::{
        in_periods, jerk_over_periods, limit_along, paper_limits, polyline, seed_000, seed_003,
    };
    use crate::{
        CommandedCurve, EndFeeds, Junction, KinematicLimits, ProfileKind, plan_through_window, plan_with,
    };
    use nurbs_core::NurbsBuf;

    fn through(
        curves: &[NurbsBuf<f64, 2>],
        limits: &KinematicLimits<f64>,
        window: f64,
        kind: ProfileKind,
    ) -> (FinalStages<f64>, u64) {
        let curves = curves.iter().map(|curve| CommandedCurve {
            curve: curve.as_curve(),
            feed: f64::MAX,
            from_rest: false,
        });
        let mut all = FinalStages { arcs: Vec::new(), chords: Vec::new() };
        let done = plan_through_window(curves, limits, window, kind, |some| {
            all.arcs.extend_from_slice(&some.arcs);
            all.chords.extend_from_slice(&some.chords);
        });
        (all, done.unwrap().periods)
    }

    /// The most by which a run by chords is off its plan at the end of a period, and by which it would pass a stop.
    fn off(curves: &[NurbsBuf<f64, 2>], limits: &KinematicLimits<f64>, plan: &FinalStages<f64>) -> [f64; 2] {
        let limit = limit_along(curves, limits);
        let views: Vec<_> = curves.iter().map(NurbsBuf::as_curve).collect();
        let path = Path::new(&limit, &views);
        let mut worst = [0.0_f64; 2];
        for (arcs, chords) in sections(&plan.arcs).zip(sections(&plan.chords)) {
            let begin = arcs.stages()[0].start;
            let [arcs, chords] = [arcs, chords].map(|one| Schedule::new(one.stages(), 1.0, u64::MAX));
            let last = arcs.stages().iter().rev().find(|stage| !stage.is_pause()).unwrap();
            let stop = last.start + last.length;
            let before = Before { stages: &[], cursor: chords.start(), reached: begin };
            let [mut by_arcs, mut by_chords] = [arcs.start(), chords.start()];
            let mut reached = begin;
            while arcs.advance(&mut by_arcs).is_some() && by_arcs.stage() < arcs.stages().len() {
                let wanted = chords.advance(&mut by_chords).unwrap();
                reached = (reached + path.arc_of_step(reached, wanted)).min(stop);
                worst[0] = worst[0].max((reached - arcs.distance(&by_arcs)).abs());
            }
            worst[1] = worst[1].max(path.off_stop(&chords, &before, stop).abs());
        }
        worst
    }

    /// Checks final stages: neighbours meet in feed and acceleration, both plans take the same time, which is whole
    /// periods from stop to stop, and nothing is above the limits, also over periods.
    fn assert_kept(limits: &KinematicLimits<f64>, plan: &FinalStages<f64>, periods: u64, name: &str) {
        let (mut feed, mut acceleration, mut start, mut before) = (0.0, 0.0, 0.0, 0.0_f64);
        for stage in &plan.chords {
            let piece = stage.piece();
            // A feed is rounded, and over a stage of a millionth of a period that rounding is a jerk.
            let rounding = 8.0 * f64::EPSILON * stage.start_feed.max(stage.end_feed) / stage.duration;
            assert!((stage.start_feed - feed).abs() < 1e-14, "{name}: {stage:?} behind {feed}");
            let begins = (stage.acceleration_at(0.0) - acceleration).abs();
            let allowed = 1e-9 * limits.acceleration + rounding.max(before);
            assert!(begins <= allowed, "{name}: {stage:?} behind {acceleration}");
            assert!(
                (stage.start - start).abs() < 1e-9 && stage.start_feed.min(stage.end_feed) >= 0.0,
                "{name}: {stage:?}"
            );
            assert!(
                (stage.length - piece.length()).abs() < 1e-10 * (1.0 + piece.length()),
                "{name}: {stage:?}"
            );
            assert!(
                piece.peak_acceleration().abs() <= limits.acceleration * (1.0 + 1e-9) + rounding,
                "{name}: {stage:?}"
            );
            assert!(
                piece.peak_jerk().abs() <= limits.jerk * (1.0 + 1e-9) + rounding / stage.duration,
                "{name}: {stage:?}"
            );
            (feed, acceleration) = (stage.end_feed, stage.acceleration_at(stage.duration));
            (start, before) = (stage.start + stage.length, rounding);
        }
        assert_eq!(feed, 0.0, "{name}");
        let duration = |stages: &[Stage<f64>]| stages.iter().map(|stage| stage.duration).sum::<f64>();
        for (arcs, chords) in sections(&plan.arcs).zip(sections(&plan.chords)) {
            let (time, other) = (duration(arcs.stages()), duration(chords.stages()));
            assert!(
                (time - time.round()).abs() < 1e-9 * time && (time - other).abs() < 1e-9 * time,
                "{name}"
            );
        }
        let counted = duration(&plan.chords).round();
        assert!(counted == periods as f64, "{name}: {counted} of {periods} periods");
        let found = jerk_over_periods(&Schedule::new(&plan.chords, 1.0, periods));
        assert!(found <= limits.jerk * (1.0 + 1e-9), "{name}: {found} of {}", limits.jerk);
    }

    fn zigzag(corners: i32) -> Vec<NurbsBuf<f64, 2>> {
        let point = |i: i32| [2.0 * f64::from(i), if i % 2 == 0 { 0.0 } else { 1.0 }];
        polyline(&(0..corners).map(point).collect::<Vec<_>>())
    }

    /// A run by arcs taken for chords comes ahead of its plan by the sum of all shortfalls.
    #[test]
    fn a_run_keeps_to_its_plan_and_lands_on_every_stop() {
        let slow = in_periods(3e-3, 200.0, 1000.0, 2e4, 5e-4);
        let mill = in_periods(2e-3, 150.0, 1500.0, 3e4, 2e-3);
        for (name, curves, limits, stopping) in [
            ("a", vec![seed_000()], paper_limits(), 6.0),
            ("d", vec![seed_003()], paper_limits(), 6.0),
            ("d slow", vec![seed_003()], slow, 25.0),
            ("zigzag", zigzag(40), mill, 11.0),
        ] {
            for chord_error in [limits.chord_error, 5e-3, 5e-2] {
                let limits = KinematicLimits { chord_error, junction: Junction::Deviation(0.02), ..limits };
                for kind in ProfileKind::ALL {
                    for window in [5.0, 20.0, 60.0, 1e4] {
                        let name = format!("{name} {chord_error} {kind:?} {window}");
                        let (plan, periods) = through(&curves, &limits, window, kind);
                        assert_kept(&limits, &plan, periods, &name);
                        let [on_the_way, at_stops] = off(&curves, &limits, &plan);
                        // A window that is shorter than two stopping distances often ends in a stop that is none.
                        let at_most = if window < 2.0 * stopping { 1.0 } else { 0.3 };
                        assert!(
                            on_the_way <= chord_error && at_stops <= at_most * chord_error,
                            "{name}: {on_the_way} on the way, {at_stops} at a stop"
                        );
                    }
                }
            }
        }
    }

    #[test]
    fn with_the_whole_path_in_view_it_is_nearly_the_plan_of_the_whole_path() {
        for curves in [vec![seed_000()], vec![seed_003()], zigzag(20)] {
            let limits = paper_limits();
            let limit = limit_along(&curves, &limits);
            for kind in ProfileKind::ALL {
                let whole = plan_with(&limit, &limits, EndFeeds::default(), kind).unwrap();
                let (_, periods) = through(&curves, &limits, 1e4, kind);
                let stops = whole.as_schedule().sections().count();
                let whole = whole.as_schedule().periods() as f64;
                let most = 1.001 * whole + stops as f64;
                assert!(
                    (0.999 * whole - 1.0..=most).contains(&(periods as f64)),
                    "{kind:?}: {periods} for {whole}"
                );
            }
        }
    }

    /// Paths that are the same up to some place, whatever they do behind it.
    #[test]
    fn what_lies_behind_a_window_changes_no_stage_before_it() {
        let (window, same) = (40.0, 120.0);
        let stretch = |behind: &[NurbsBuf<f64, 2>]| [&zigzag(90)[..], behind].concat();
        let end = 178.0;
        let straight = polyline(&[[end, 1.0], [end + 300.0, 1.0]]);
        let bent = polyline(&[[end, 1.0], [end + 1.0, 1.5], [end, 90.0]]);
        for kind in ProfileKind::ALL {
            let [a, b, c] = [&[][..], &straight, &bent]
                .map(|behind| through(&stretch(behind), &paper_limits(), window, kind).0);
            for (stages, others) in
                [(&a.arcs, &b.arcs), (&a.arcs, &c.arcs), (&a.chords, &b.chords), (&a.chords, &c.chords)]
            {
                let count = stages.partition_point(|stage| stage.start + stage.length < same);
                assert!(count > 100 && stages[..count] == others[..count], "{kind:?}: {count}");
                assert_ne!(stages, others);
            }
        }
    }
}
