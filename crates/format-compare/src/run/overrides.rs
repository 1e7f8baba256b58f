//! Feed overrides that are commanded while a plan runs.
//!
//! The plan is made for the highest override, with a reserve: it uses less acceleration and jerk than the machine has.
//! Changes of the rate may use the reserve ([`FeedOverride`]). Rates are integers, so that every format runs the same
//! plan at the same rates, and the wanted distance of each period is known exactly.

use std::fmt;

use domains::options::{OVERRIDE, OVERRIDE_TIME, RESERVE};
use domains::shown;
use feed_plan::{AxisLimits, FeedPiece, KinematicLimits, Stage, sections};
use real::DoubleDouble;
use secant_interp::{
    FeedOverride, LengthCursor, LengthStage, OverrideLimits, OverrideState, Rate, StepLengths,
};

use crate::plan::exact_plan::ExactPlan;
use crate::problem::least_periods::MOST_PERIODS;
use crate::problem::problem::Problem;

/// An axis without a limit gets this many times the path's limit: it never limits.
const AMPLE: f64 = 1e6;

/// A new override from some time on.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct OverrideTarget {
    /// Time from the start of the run, in s.
    pub time_s: f64,
    /// Share of the commanded feed: 0 is feed hold, 1 is 100 %, at most 2.
    pub share: f64,
}

/// The overrides of a run, and the share of the machine's limits that is kept for them.
#[derive(Clone, Debug, PartialEq)]
pub struct Overrides {
    targets: Vec<OverrideTarget>,
    reserve: f64,
}

/// Why overrides cannot be run.
#[derive(Clone, Copy, Debug, PartialEq)]
#[non_exhaustive]
pub enum OverrideError {
    /// A share is not in the domain of `--override`.
    Share(f64),
    /// A time is not in the domain of `--override`, or less than the one before it.
    Time(f64),
    /// The last override is 0: the run would stand still for ever.
    EndsInHold,
    /// The reserve of acceleration and jerk is not in the domain of `--reserve`.
    Reserve(f64),
    /// The acceleration and jerk that the plan leaves change the rate by less than its unit.
    NothingLeft,
    /// The run takes more than [`MOST_PERIODS`] periods.
    TooLong {
        /// About how many.
        periods: f64,
        /// The plan's own.
        planned: u64,
    },
}

impl fmt::Display for OverrideError {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        match self {
            Self::Share(share) => {
                write!(f, "override {} %: expected {}", shown(share * 100.0), OVERRIDE.expected())
            }
            Self::Time(time) => {
                write!(f, "override at {} s: expected {}, in order", shown(*time), OVERRIDE_TIME.expected())
            }
            Self::EndsInHold => {
                f.write_str("the last override is 0 %: expected one above it, or the run never ends")
            }
            Self::Reserve(reserve) => {
                write!(f, "reserve {} %: expected {}", shown(reserve * 100.0), RESERVE.expected())
            }
            Self::NothingLeft => f.write_str("the reserve is too small to change the rate in steps of 2^-32"),
            Self::TooLong { periods, planned } => write!(
                f,
                "with these overrides the {planned} periods of the plan take about {periods:.3e}: expected at most {MOST_PERIODS}, by \
                 a greater override, or by a shorter hold"
            ),
        }
    }
}

impl std::error::Error for OverrideError {}

impl Overrides {
    /// Overrides in order of time; before the first it is 100 %. `reserve` is the share of acceleration and jerk that
    /// the plan leaves unused.
    ///
    /// # Errors
    /// [`OverrideError`] naming the number that is out of range.
    pub fn try_new(targets: Vec<OverrideTarget>, reserve: f64) -> Result<Self, OverrideError> {
        let mut before = 0.0;
        for target in &targets {
            if !OVERRIDE.holds(target.share * 100.0) {
                return Err(OverrideError::Share(target.share));
            }
            if !(target.time_s >= before && OVERRIDE_TIME.holds(target.time_s)) {
                return Err(OverrideError::Time(target.time_s));
            }
            before = target.time_s;
        }
        if targets.last().is_some_and(|last| last.share <= 0.0) {
            return Err(OverrideError::EndsInHold);
        }
        if !RESERVE.holds(reserve * 100.0) {
            return Err(OverrideError::Reserve(reserve));
        }
        Ok(Self { targets, reserve })
    }

    /// The highest override, at least 1: the plan is made for that multiple of the commanded feed.
    #[must_use]
    pub fn highest(&self) -> f64 {
        self.targets.iter().fold(1.0, |most, target| most.max(target.share))
    }

    /// The problem for the planner: its feed is that of the highest override, and its accelerations and jerks are
    /// without the reserve.
    #[must_use]
    pub fn to_plan<const D: usize>(&self, problem: &Problem<D>) -> Problem<D> {
        let mut problem = problem.at_feedrate(problem.feedrate_mm_per_s() * self.highest());
        let (machine, kept) = (&mut problem.machine, 1.0 - self.reserve);
        machine.acceleration_mm_per_s2 *= kept;
        machine.jerk_mm_per_s3 *= kept;
        for axis in [&mut machine.axes.x, &mut machine.axes.y, &mut machine.axes.z] {
            axis.acceleration_mm_per_s2 = axis.acceleration_mm_per_s2.map(|a| a * kept);
            axis.jerk_mm_per_s3 = axis.jerk_mm_per_s3.map(|j| j * kept);
        }
        problem
    }

    /// The limits of an axis, and the part of them that the plan may use: all but the reserve. If the acceleration has
    /// no limit, the plan uses at most the path's acceleration and the acceleration across the path, which the chord
    /// error limits: `V² |k| ≤ 8 E/T²`.
    fn of_axis(
        &self,
        path: &OverrideLimits<f64>,
        axis: &AxisLimits<f64>,
        machine: &KinematicLimits<f64>,
    ) -> OverrideLimits<f64> {
        let kept = 1.0 - self.reserve;
        let turning = 8.0 * machine.chord_error;
        let turning = machine.centripetal_acceleration.map_or(turning, |most| most.min(turning));
        let (acceleration, planned_acceleration) = match axis.acceleration {
            Some(most) => (most, most * kept),
            None => (AMPLE * machine.acceleration, path.planned_acceleration + turning),
        };
        let (jerk, planned_jerk) = match axis.jerk {
            Some(most) => (most, most * kept),
            None => (AMPLE * machine.jerk, path.planned_jerk),
        };
        let planned_feed = axis.velocity.map_or(path.planned_feed, |most| most.min(path.planned_feed));
        OverrideLimits { acceleration, jerk, planned_acceleration, planned_jerk, planned_feed }
    }

    /// The rate of each period, for a plan of [`to_plan`](Self::to_plan)'s problem on the machine of `problem`.
    ///
    /// # Errors
    /// [`OverrideError::NothingLeft`] and [`OverrideError::TooLong`].
    pub fn commands<const D: usize>(
        &self,
        problem: &Problem<D>,
        plan: &ExactPlan,
    ) -> Result<OverrideCommands, OverrideError> {
        let limits = problem.limits_per_period().map_err(|_| OverrideError::NothingLeft)?;
        let stages = plan.schedule().stages();
        let most = |of: fn(&FeedPiece<DoubleDouble>) -> DoubleDouble| {
            stages.iter().map(|stage| of(&stage.piece()).value()).fold(f64::MIN_POSITIVE, f64::max)
        };
        // The limit for changes of the rate follows from the plan's own peaks, rounded up.
        let up = 1.0 + 1e-12;
        let path = OverrideLimits {
            acceleration: limits.acceleration,
            jerk: limits.jerk,
            planned_acceleration: most(FeedPiece::peak_acceleration) * up,
            planned_jerk: most(FeedPiece::peak_jerk) * up,
            planned_feed: plan.greatest_feed().max(f64::MIN_POSITIVE) * up,
        };
        let points = || problem.curves.iter().flat_map(|curve| curve.control_points());
        let moves = |d: usize| {
            let along = || points().filter_map(|point| point.get(d));
            along().zip(along().skip(1)).any(|(a, b)| (a - b).abs() > 0.0)
        };
        let has_limits = |axis: &AxisLimits<f64>| axis.acceleration.is_some() || axis.jerk.is_some();
        let axes = limits.axes.iter().enumerate().filter(|(d, axis)| has_limits(axis) && moves(*d));
        let axes = axes.map(|(_, axis)| self.of_axis(&path, axis, &limits));
        let bounds = std::iter::once(path).chain(axes).map(|limits| FeedOverride::new(&limits));
        let feeds =
            bounds.reduce(|all, one| Some(all?.and(one?))).flatten().ok_or(OverrideError::NothingLeft)?;
        let rate = |share: f64| Rate::of(share / self.highest());
        let period_of = |target: &OverrideTarget| (target.time_s / problem.period_s()).round();
        let targets = self.targets.iter().map(|target| (period_of(target), rate(target.share))).collect();
        let (start, stages) = (rate(1.0), compiled(stages));
        let mut commands = OverrideCommands { feeds, full: start, start, targets, stages, periods: 0 };
        // A rate that is commanded from the first period on holds before that period too.
        commands.start = commands.commanded(0).unwrap_or(start);
        let (planned, periods) = (plan.periods(), commands.about(plan.periods()));
        let too_long = OverrideError::TooLong { periods, planned };
        if periods > MOST_PERIODS as f64 {
            return Err(too_long);
        }
        commands.periods = commands.count().ok_or(too_long)?;
        Ok(commands)
    }
}

/// The rate that is commanded in each period.
#[derive(Clone, Debug)]
pub struct OverrideCommands {
    /// How fast the rate may change.
    pub(crate) feeds: FeedOverride,
    /// The rate of the commanded feed, 100 %.
    full: Rate,
    start: Rate,
    /// The commanded rates, each with the number of periods after which it holds.
    targets: Vec<(f64, Rate)>,
    /// The plan, in mm and 2⁻³² periods.
    pub(crate) stages: Vec<LengthStage<DoubleDouble>>,
    /// The number of periods that the plan takes at these rates, without the periods for landing on its stops.
    pub(crate) periods: u64,
}

/// The stages of a plan in the form of [`CompiledPath`](secant_interp::CompiledPath), exactly.
fn compiled(stages: &[Stage<DoubleDouble>]) -> Vec<LengthStage<DoubleDouble>> {
    let durations = sections(stages).flat_map(|section| section.durations());
    let compiled = stages.iter().zip(durations).flat_map(|(stage, duration)| {
        let change = stage.end_feed - stage.start_feed;
        let parts = LengthStage::<DoubleDouble>::parts(duration, stage.start_feed == stage.end_feed);
        parts
            .filter_map(move |part| LengthStage::new(part, stage.start_feed, change))
            .map(|compiled| compiled.shaped(stage.shape))
    });
    compiled.collect()
}

impl OverrideCommands {
    /// The share of the plan's own speed at which the feed is the commanded one.
    pub(crate) fn commanded_share(&self) -> f64 {
        self.full.share()
    }

    /// The number of periods that the plan takes at these rates, without the periods for landing on its stops.
    #[must_use]
    pub fn periods(&self) -> u64 {
        self.periods
    }

    /// The rate before the first period.
    pub(crate) fn start(&self) -> OverrideState {
        OverrideState::at(self.start)
    }

    /// The rate that is commanded in this period; `None` before the first command.
    fn commanded(&self, period: u64) -> Option<Rate> {
        let in_force = self.targets.partition_point(|(from, _)| *from <= period as f64);
        in_force.checked_sub(1).and_then(|last| self.targets.get(last)).map(|(_, rate)| *rate)
    }

    /// Sets `rates` to the rate that is commanded in this period.
    pub(crate) fn command(&self, period: u64, rates: &mut OverrideState) {
        if let Some(rate) = self.commanded(period) {
            rates.set(rate);
        }
    }

    /// About how many periods the run takes: as many as if each rate held from its period on.
    fn about(&self, planned: u64) -> f64 {
        let (mut left, mut time, mut share) = (planned as f64, 0.0, self.start.share::<f64>());
        for (from, rate) in &self.targets {
            let passed = (from - time) * share;
            if passed >= left {
                break;
            }
            (left, time, share) = (left - passed, *from, rate.share::<f64>());
        }
        time + left / share
    }

    /// The number of periods of the run; `None` if the run is too long.
    fn count(&self) -> Option<u64> {
        let (own, mut cursor) =
            (StepLengths { stages: &self.stages, crossings: &[] }, LengthCursor::default());
        let mut rates = self.start();
        (0..MOST_PERIODS).find(|period| {
            self.command(*period, &mut rates);
            self.feeds.advance(&own, &mut cursor, &mut rates).is_none()
        })
    }
}
