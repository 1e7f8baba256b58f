//! The part on the machine, in each format.

use std::ops::Range;

use anyhow::{Context, Result, bail};
use format_compare::{Dimension, ExactPlan, Format, Options, Problem, RunStep, Space};
use nurbs_core::{Evaluate, NurbsBuf};
use servo_sim::{Arrival, ErrorSize, Servo, ServoParameters, contour_error};

use super::arguments::Arguments;
use super::bounds::expect_end_of_part;
use super::circle::circle_test;
use super::ramp::ramped_setpoints;
use super::report::{FormatRow, Outcome};
use crate::formats::selected;
use crate::progress::Progress;

/// A row for each format and engine that the options name.
pub(super) fn rows<const D: usize>(
    problem: &Problem<D>,
    servo: &ServoParameters,
    arguments: &Arguments,
) -> Result<Vec<FormatRow>>
where
    Space: Dimension<D>,
{
    servo.validate(problem.period_s())?;
    circle_test(arguments, servo, problem.period_s())?;
    let engines = arguments.run.engines()?;
    let options = arguments.run.options_for(problem)?;
    expect_rest_at_the_ends(&options)?;
    expect_end_of_part(problem, servo, &options)?;
    let formats = selected::<D>(&arguments.formats)?;
    let _progress = Progress::spinning("simulating the axes");
    let mut rows = Vec::new();
    for format in formats {
        let plan = format_compare::plan_for(problem, format.as_ref(), &options);
        for &engine in &engines {
            let outcome = match &plan {
                Ok(plan) => {
                    simulate(problem, format.as_ref(), plan, &Options { engine, ..options.clone() }, servo)?
                }
                Err(reason) => Outcome::Refused { refused: reason.to_string() },
            };
            rows.push(FormatRow { format: format.name().to_string(), engine, outcome });
        }
    }
    Ok(rows)
}

/// Refuses a feed above 0 at either end: the axes are at rest before the first setpoint, and hold the last one.
fn expect_rest_at_the_ends(options: &Options) -> Result<()> {
    for (option, feed) in ["--start-feed", "--end-feed"].into_iter().zip(options.end_feeds_mm_per_s) {
        if feed > 0.0 {
            bail!(
                "{option} {feed}: expected 0, for the axes of `servo` are at rest before and after the path"
            );
        }
    }
    Ok(())
}

/// The part in one format, on a machine whose drives are computed exactly: rows differ by their setpoints only.
fn simulate<const D: usize>(
    problem: &Problem<D>,
    format: &dyn Format<D>,
    plan: &ExactPlan,
    options: &Options,
    servo: &ServoParameters,
) -> Result<Outcome> {
    let run = match format.run(problem, plan, options) {
        Ok(run) => run,
        Err(reason) => return Ok(Outcome::Refused { refused: reason.to_string() }),
    };
    let setpoints = run.steps.iter().map(|step| core::array::from_fn(|d| step.point_mm[d]));
    let curves: Vec<_> = problem.curves.iter().map(NurbsBuf::as_curve).collect();
    let (mut following, mut contour, mut arrival) = (Vec::new(), Vec::new(), Arrival::default());
    let ramp_periods = servo.feed_ramp_ms / 1000.0 / problem.period_s();
    for (stretch, first) in stretches(&problem.breaks, &run.steps) {
        let own = curves.get(first.clone()).context("the path has no curve")?;
        let begin = own.first().context("the path has no curve")?;
        let servo =
            Servo::<f64, D>::try_new(&[*servo; D], problem.period_s(), begin.point(begin.domain().0))?;
        let setpoints = ramped_setpoints(&problem.curves, first.start, &run.steps[stretch], ramp_periods)?;
        let followed = servo.follow(setpoints, own)?;
        following.push((followed.following_error, followed.motion_samples));
        contour.push((followed.contour_error, followed.motion_samples));
        if followed.arrival.reach_mm >= arrival.reach_mm {
            arrival = followed.arrival;
        }
    }
    let of_axis =
        |axis: usize| ErrorSize::joined(following.iter().map(|(sizes, count)| (sizes[axis], *count)));
    Ok(Outcome::Ran {
        setpoint_error_mm: contour_error(&curves, setpoints)?,
        following_error_mm: (0..D).map(of_axis).collect(),
        contour_error_mm: ErrorSize::joined(contour),
        reached_the_end: run.about.finished,
        arrival,
        does_not_follow: arrival.validate().err().map(|reason| reason.to_string()),
    })
}

/// The parts of a run between which the machine makes another move, as ranges of its steps and of the path's curves.
/// The axes come to rest during the other move.
fn stretches(breaks: &[usize], steps: &[RunStep]) -> Vec<(Range<usize>, Range<usize>)> {
    let mut begin = (0, 0);
    let mut found = Vec::new();
    for next in breaks.iter().copied().chain([usize::MAX]) {
        let end = steps.partition_point(|step| step.curve < next);
        let curves = steps.get(begin.0..end).and_then(|own| own.last()).map(|last| begin.1..last.curve + 1);
        found.extend(curves.map(|curves| (begin.0..end, curves)));
        begin = (end, next);
    }
    found
}
