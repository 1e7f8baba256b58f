//! A path and its plan in one number format: all the data that real time reads.
//!
//! Here a plan becomes stages. Feeds are converted to the chord units of the compiled pieces. The ends of stages are
//! rounded to 2⁻³² periods, the unit in which a controller counts time. The run is cut wherever the plan comes to rest
//! at a joint of pieces.

use alloc::vec::Vec;
use core::fmt;

use feed_plan::Schedule;
use nurbs_core::PiecesBuf;
use real::{Backend, Real};

use crate::pieces::chord_step::ChordTolerance;
use crate::pieces::piece_interpolator::PieceInterpolator;
use crate::pieces::section::{Section, sections};
use crate::step_lengths::{Crossing, LONGEST_STAGE, LengthStage, StepLengths, crossings};

/// Why a number format cannot hold a plan. Values are in mm and periods.
#[derive(Clone, Copy, Debug, PartialEq)]
#[non_exhaustive]
pub enum CompiledPathError {
    /// The plan's interpolation period is not 1: its feeds are no distances per period.
    PeriodNotOne {
        /// The period, in the plan's unit of time.
        period: f64,
    },
    /// A stage begins or ends with a feed beyond the format's range.
    FeedTooHigh {
        /// The stage, from 0.
        stage: usize,
        /// The feed, in mm per period.
        feed: f64,
    },
    /// The greatest feed and the landing step together make a step longer than the pieces were compiled for.
    StepTooLong {
        /// The first stage with that feed, from 0.
        stage: usize,
        /// A period at that feed, and the landing step, in mm.
        step: f64,
        /// The longest step of the pieces, [`PieceLimits::step_mm`](nurbs_core::PieceLimits), in mm.
        longest: f64,
    },
    /// A stage in which the feed changes takes 2²⁹ periods or more.
    StageTooLong {
        /// The stage, from 0.
        stage: usize,
    },
    /// The landing step is zero, negative or NaN: a remainder of the path behind the schedule's end would never be
    /// travelled.
    LandingStepNotPositive {
        /// The step, in mm.
        step: f64,
    },
    /// The landing step is beyond the format's range.
    LandingStepTooLong {
        /// The step, in mm.
        step: f64,
    },
}

impl fmt::Display for CompiledPathError {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        match self {
            Self::PeriodNotOne { period } => write!(
                f,
                "the plan's interpolation period is {period}, not 1: its unit of time must be the period, its feeds mm per \
                 period"
            ),
            Self::FeedTooHigh { stage, feed } => {
                write!(
                    f,
                    "the feed of stage {stage}, {feed:.3e} mm per period, does not fit the number format"
                )
            }
            Self::StepTooLong { stage, step, longest } => write!(
                f,
                "a period at the feed of stage {stage} and the landing step make {step:.6e} mm; the pieces were compiled for \
                 steps of {longest:.6e} mm"
            ),
            Self::StageTooLong { stage } => {
                write!(f, "the feed changes in stage {stage} for 2^29 periods or more")
            }
            Self::LandingStepNotPositive { step } => {
                write!(f, "the landing step, {step} mm, is not a positive number")
            }
            Self::LandingStepTooLong { step } => {
                write!(f, "the landing step, {step:.3e} mm, does not fit the number format")
            }
        }
    }
}

impl core::error::Error for CompiledPathError {}

/// A path compiled together with its plan. Only its construction takes heap.
///
/// ```
/// use feed_plan::{EndFeeds, KinematicLimits, Planned, ProfileKind};
/// use nurbs_core::{NurbsCurve, PieceLimits, compile_with_stops};
/// use real::{DoubleDouble, I4F28};
/// use secant_interp::{ChordTolerance, CompiledPath};
///
/// // A quarter circle of 50 mm, in mm and periods of 1 ms: 200 mm/s, 5 m/s², 400 m/s³, 0.5 µm.
/// let points = [[50.0, 0.0], [50.0, 50.0], [0.0, 50.0]];
/// let weights = [1.0, 0.5_f64.sqrt(), 1.0];
/// let curves = [NurbsCurve::try_new(2, &points, &weights, &[0.0, 0.0, 0.0, 1.0, 1.0, 1.0])?];
/// let limits = KinematicLimits {
///     interpolation_period: 1.0,
///     feedrate: 0.2,
///     acceleration: 0.005,
///     jerk: 0.0004,
///     chord_error: 0.0005,
///     centripetal_acceleration: None,
///     axes: Default::default(),
///     junction: Default::default(),
/// };
///
/// // Before real time: the plan, and the path in pieces that end where it rests.
/// let planned = Planned::along(&curves, &limits, EndFeeds::default(), ProfileKind::default())?;
/// let landing_step = limits.acceleration; // A T²: from so long a step the axes stop within a period.
/// let cut = PieceLimits { length_mm: 32.0, step_mm: limits.feedrate + landing_step };
/// let pieces = compile_with_stops::<DoubleDouble, I4F28, 2>(&curves, &cut, &planned.rests())?;
/// let tolerance = ChordTolerance::for_fluctuation(Some(1e-6), 5);
/// let path = CompiledPath::new(pieces, &planned.chords.as_schedule(), tolerance, landing_step)?;
///
/// // In real time: a setpoint a period, from stop to stop.
/// let mut periods = 0;
/// for run in path.runs() {
///     let mut state = run.start();
///     while let Some(setpoint) = run.step(&mut state) {
///         periods += 1; // setpoint.offset goes to the axes, added to the piece's origin.
///     }
/// }
/// assert_eq!(periods, planned.chords.as_schedule().periods());
/// # Ok::<(), Box<dyn std::error::Error>>(())
/// ```
#[derive(Clone, Debug)]
pub struct CompiledPath<R, const D: usize> {
    table: PiecesBuf<R, D>,
    stages: Vec<LengthStage<R>>,
    crossings: Vec<Crossing<R>>,
    sections: Vec<Section>,
    tolerance: ChordTolerance<R>,
    landing_step: R,
}

impl<R: Backend, const D: usize> CompiledPath<R, D> {
    /// Joins the pieces of a path with its plan in mm and periods. The plan's interpolation period is 1, so that its
    /// feeds are distances per period. Its format Q may be any that holds the plan's duration.
    ///
    /// The plan's distances are lengths of chords ([`ScheduleBuf::shortened`](feed_plan::ScheduleBuf::shortened)),
    /// because a step makes a chord. The pieces are compiled with a joint at each of the plan's rests
    /// ([`compile_with_stops`](nurbs_core::compile_with_stops)). Where a rest has no joint, the run passes it at a feed
    /// of zero instead of landing on it. The end of each stage moves to the nearest multiple of 2⁻³² periods.
    /// `landing_step_mm` is the longest step from which the axes come to rest within one period, A T². It must be above
    /// 0, though it may round to zero in a coarse `R`.
    ///
    /// # Errors
    /// [`CompiledPathError::PeriodNotOne`] for a plan in another unit of time.
    /// [`CompiledPathError::LandingStepNotPositive`]. [`CompiledPathError::StepTooLong`] if the greatest feed and the
    /// landing step together exceed the step that the pieces were compiled for by more than rounding. The others if a
    /// feed or the landing step does not fit `R`.
    pub fn new<Q: Backend>(
        table: PiecesBuf<R, D>,
        plan: &Schedule<'_, Q>,
        tolerance: ChordTolerance<R>,
        landing_step_mm: f64,
    ) -> Result<Self, CompiledPathError> {
        let period = plan.interpolation_period();
        if period != Q::one() {
            return Err(CompiledPathError::PeriodNotOne { period: period.to_f64() });
        }
        let step = landing_step_mm;
        if step.is_nan() || step <= 0.0 {
            return Err(CompiledPathError::LandingStepNotPositive { step });
        }
        let exponent = table.as_pieces().chord_exponent;
        let landing_step =
            R::from_f64(step.ldexp(exponent)).ok_or(CompiledPathError::LandingStepTooLong { step })?;
        refuse_long_steps(plan, step, table.step_mm())?;
        let (mut stages, mut ends) = (Vec::new(), Vec::new());
        for section in plan.sections() {
            let numbered = (section.first()..).zip(section.stages());
            for ((index, stage), duration) in numbered.zip(section.durations()) {
                let feed = |feed: Q| {
                    nearest::<Q, R>(feed, exponent)
                        .ok_or(CompiledPathError::FeedTooHigh { stage: index, feed: feed.to_f64() })
                };
                let (from, to) = (feed(stage.start_feed)?, feed(stage.end_feed)?);
                let shape = stage.shape.try_map(|by| {
                    nearest::<Q, R>(by, 0)
                        .ok_or(CompiledPathError::FeedTooHigh { stage: index, feed: stage.end_feed.to_f64() })
                })?;
                for part in LengthStage::<R>::parts(duration, stage.start_feed == stage.end_feed) {
                    if part > LONGEST_STAGE {
                        return Err(CompiledPathError::StageTooLong { stage: index });
                    }
                    let compiled = LengthStage::new(part, from, to - from);
                    stages.extend(compiled.map(|compiled| compiled.shaped(shape)));
                }
            }
            ends.push((stages.len(), section.rest().and_then(|(curve, u)| table.joint(curve, u.to_f64()))));
        }
        let sections = sections(&ends, table.places().len());
        let of_section = |section: &Section| stages.get(section.stages.clone()).map(crossings);
        let crossings = sections.iter().filter_map(of_section).flatten().collect();
        Ok(Self { table, stages, crossings, sections, tolerance, landing_step })
    }

    /// The pieces.
    #[must_use]
    pub fn table(&self) -> &PiecesBuf<R, D> {
        &self.table
    }

    /// The stages, in the pieces' chord units and 2⁻³² periods.
    #[must_use]
    pub fn stages(&self) -> &[LengthStage<R>] {
        &self.stages
    }

    /// For each stage the period in which it ends, in a run of its section.
    #[must_use]
    pub fn crossings(&self) -> &[Crossing<R>] {
        &self.crossings
    }

    /// Path and plan between the stops, in order.
    #[must_use]
    pub fn sections(&self) -> &[Section] {
        &self.sections
    }

    /// The interpolator of the whole path, which does not land on stops. It is for a run whose time is stretched: such
    /// a run comes to the stops at other times than planned.
    #[must_use]
    pub fn interpolator(&self) -> PieceInterpolator<'_, R, D> {
        PieceInterpolator {
            pieces: self.table.as_pieces(),
            lengths: StepLengths { stages: &self.stages, crossings: &self.crossings },
            tolerance: self.tolerance,
            landing_step: self.landing_step,
        }
    }

    /// The interpolators from stop to stop, one after the other. Each lands on its stop, and the next begins there on
    /// time. The piece numbers of setpoints count from the section's first piece.
    pub fn runs(&self) -> impl Iterator<Item = PieceInterpolator<'_, R, D>> {
        let path = self.interpolator();
        self.sections.iter().map(move |section| path.on(section))
    }
}

/// The part by which a step may exceed the step that the pieces were compiled for: a plan in a coarse format is off by
/// this much.
const ROUNDING: f64 = 1e-4;

/// Refuses a plan with steps for which no range is proven. A run may land from its greatest feed, so the landing step
/// is added.
fn refuse_long_steps<Q: Backend>(
    plan: &Schedule<'_, Q>,
    landing_step: f64,
    longest: f64,
) -> Result<(), CompiledPathError> {
    let steps =
        plan.stages().iter().map(|stage| stage.start_feed.max(stage.end_feed).to_f64() + landing_step);
    let greatest = steps.enumerate().fold((0, 0.0), |most, one| if one.1 > most.1 { one } else { most });
    let (stage, step) = greatest;
    let is_proven = step <= longest * (1.0 + ROUNDING);
    if is_proven { Ok(()) } else { Err(CompiledPathError::StepTooLong { stage, step, longest }) }
}

/// The number of `R` nearest to `x` times a power of two, `None` where it is out of range.
fn nearest<Q: Backend, R: Backend>(x: Q, exponent: i32) -> Option<R> {
    let (high, low) = x.to_f64_pair();
    R::from_f64_pair(high.ldexp(exponent), low.ldexp(exponent))
}
