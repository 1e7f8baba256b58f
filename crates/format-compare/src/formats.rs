//! The formats that can be compared, by name.

use std::marker::PhantomData;

use real::{Audited, Backend, FormatName, RuntimeFixed, RuntimeFormat};

use crate::constants::Constants;
use crate::exact_plan::ExactPlan;
use crate::problem::Problem;
use crate::recorded::{self, RecordedRun};
use crate::run::{self, Options, PlanIn, Refusal, Run};

/// A number format that a part of dimension `D` can be run in.
pub trait Format<const D: usize>: Send + Sync {
    /// The format's name.
    fn name(&self) -> FormatName;

    /// The largest number.
    fn largest(&self) -> f64;

    /// The step from 1 to the next larger number.
    fn resolution(&self) -> f64;

    /// Plans in this format.
    ///
    /// # Errors
    /// [`Refusal`] when the part or a limit does not fit the format, or no plan exists.
    fn plan(&self, problem: &Problem<D>, options: &Options) -> Result<ExactPlan, Refusal>;

    /// Interpolates in this format, by a plan made in any.
    ///
    /// # Errors
    /// [`Refusal`] when the part, the plan or a limit does not fit the format.
    fn run(&self, problem: &Problem<D>, plan: &ExactPlan, options: &Options) -> Result<Run, Refusal>;

    /// Writes path and plan, compiled for this format, as constants for a controller.
    ///
    /// # Errors
    /// [`Refusal`] as of [`run`](Self::run), and where a controller has no such type.
    fn constants(
        &self,
        problem: &Problem<D>,
        plan: &ExactPlan,
        options: &Options,
    ) -> Result<Constants, Refusal>;
}

struct Of<R>(PhantomData<fn() -> R>);

impl<R: Backend, const D: usize> Format<D> for Of<R> {
    fn name(&self) -> FormatName {
        R::name()
    }

    fn largest(&self) -> f64 {
        largest::<R>()
    }

    fn resolution(&self) -> f64 {
        resolution::<R>()
    }

    fn plan(&self, problem: &Problem<D>, options: &Options) -> Result<ExactPlan, Refusal> {
        ExactPlan::in_format_with::<R, D>(problem, options.end_feeds_mm_per_s, options.profile)
    }

    fn run(&self, problem: &Problem<D>, plan: &ExactPlan, options: &Options) -> Result<Run, Refusal> {
        run::audited::<R, Audited<R>, D>(problem, plan, options)
    }

    fn constants(
        &self,
        problem: &Problem<D>,
        plan: &ExactPlan,
        options: &Options,
    ) -> Result<Constants, Refusal> {
        Constants::of::<R, D>(problem, plan, options)
    }
}

fn largest<R: Backend>() -> f64 {
    R::max_value().to_f64()
}

fn resolution<R: Backend>() -> f64 {
    R::resolution().to_f64()
}

/// A fixed-point format chosen at run time.
struct AtRunTime(RuntimeFormat);

impl<const D: usize> Format<D> for AtRunTime {
    fn name(&self) -> FormatName {
        self.0.name()
    }

    fn largest(&self) -> f64 {
        self.0.run::<0, _>(largest::<RuntimeFixed<0>>)
    }

    fn resolution(&self) -> f64 {
        self.0.run::<0, _>(resolution::<RuntimeFixed<0>>)
    }

    fn plan(&self, problem: &Problem<D>, options: &Options) -> Result<ExactPlan, Refusal> {
        let ends = options.end_feeds_mm_per_s;
        self.0.run::<0, _>(|| ExactPlan::in_format_with::<RuntimeFixed<0>, D>(problem, ends, options.profile))
    }

    fn run(&self, problem: &Problem<D>, plan: &ExactPlan, options: &Options) -> Result<Run, Refusal> {
        self.0.run::<0, _>(|| {
            run::audited::<RuntimeFixed<0>, Audited<RuntimeFixed<0>>, D>(problem, plan, options)
        })
    }

    fn constants(
        &self,
        problem: &Problem<D>,
        plan: &ExactPlan,
        options: &Options,
    ) -> Result<Constants, Refusal> {
        self.0.run::<0, _>(|| Constants::of::<RuntimeFixed<0>, D>(problem, plan, options))
    }
}

/// The spaces that formats are built for: the plane, `D = 2`, and space, `D = 3`.
///
/// Both are instantiated here, once, and not again in every crate that compares: a format is the planner and two
/// interpolators, plain and audited.
pub trait Dimension<const D: usize> {
    /// Every built-in format, narrow before wide, fixed point before float: the order of rising cost where nothing is
    /// known of the target.
    fn formats() -> Vec<Box<dyn Format<D>>>;

    /// A format chosen at run time, to be compared like any other.
    fn at_run_time(format: RuntimeFormat) -> Box<dyn Format<D>>;

    /// The operations of each of the first `most` steps of a run in the format of this name.
    ///
    /// # Errors
    /// As [`Format::run`].
    fn record(
        format: FormatName,
        problem: &Problem<D>,
        plan: &ExactPlan,
        options: &Options,
        most: usize,
    ) -> Result<RecordedRun, Refusal>;
}

/// The implementor of [`Dimension<2>`] and [`Dimension<3>`].
#[derive(Clone, Copy, Debug)]
pub struct Space;

impl Dimension<2> for Space {
    fn formats() -> Vec<Box<dyn Format<2>>> {
        built_in()
    }

    fn at_run_time(format: RuntimeFormat) -> Box<dyn Format<2>> {
        Box::new(AtRunTime(format))
    }

    fn record(
        format: FormatName,
        problem: &Problem<2>,
        plan: &ExactPlan,
        options: &Options,
        most: usize,
    ) -> Result<RecordedRun, Refusal> {
        recorded::record(format, problem, plan, options, most)
    }
}

impl Dimension<3> for Space {
    fn formats() -> Vec<Box<dyn Format<3>>> {
        built_in()
    }

    fn at_run_time(format: RuntimeFormat) -> Box<dyn Format<3>> {
        Box::new(AtRunTime(format))
    }

    fn record(
        format: FormatName,
        problem: &Problem<3>,
        plan: &ExactPlan,
        options: &Options,
        most: usize,
    ) -> Result<RecordedRun, Refusal> {
        recorded::record(format, problem, plan, options, most)
    }
}

fn built_in<const D: usize>() -> Vec<Box<dyn Format<D>>> {
    fn of<R: Backend + 'static, const D: usize>() -> Box<dyn Format<D>> {
        Box::new(Of::<R>(PhantomData))
    }
    vec![
        of::<real::I16F16, D>(),
        of::<real::I8F24, D>(),
        of::<real::I4F28, D>(),
        of::<real::I3F29, D>(),
        of::<real::I2F30, D>(),
        of::<f32, D>(),
        of::<real::I32F32, D>(),
        of::<real::I16F48, D>(),
        of::<real::I4F60, D>(),
        of::<f64, D>(),
    ]
}

/// [`Dimension::formats`] of the space of `D` dimensions.
#[must_use]
pub fn formats<const D: usize>() -> Vec<Box<dyn Format<D>>>
where
    Space: Dimension<D>,
{
    Space::formats()
}

/// The formats with these names, each once, narrow before wide. A name like `I5F13` that no built-in format has is made at run
/// time.
///
/// # Errors
/// The first name that is none of a format.
pub fn select<const D: usize>(names: &[String]) -> Result<Vec<Box<dyn Format<D>>>, String>
where
    Space: Dimension<D>,
{
    let rank =
        |format: &dyn Format<D>| (format.name().bits(), matches!(format.name(), FormatName::Float { .. }));
    let mut selected: Vec<Box<dyn Format<D>>> = Vec::with_capacity(names.len());
    for name in names {
        let built_in = formats::<D>().into_iter().find(|format| format.name().to_string() == *name);
        let format = built_in.or_else(|| RuntimeFormat::named(name).map(Space::at_run_time));
        let format = format.ok_or_else(|| name.clone())?;
        if selected.iter().all(|one| one.name() != format.name()) {
            selected.push(format);
        }
    }
    selected.sort_by_key(|format| rank(format.as_ref()));
    Ok(selected)
}

/// The plan that `format` follows under these options.
///
/// # Errors
/// As [`Format::plan`].
pub fn plan_for<const D: usize>(
    problem: &Problem<D>,
    format: &dyn Format<D>,
    options: &Options,
) -> Result<ExactPlan, Refusal>
where
    Space: Dimension<D>,
{
    match options.plan_in {
        PlanIn::Same => format.plan(problem, options),
        PlanIn::Format(name) => {
            let planner = select::<D>(&[name.to_string()]).ok().and_then(|mut found| found.pop());
            let planned = planner.as_deref().unwrap_or(format).plan(problem, options);
            let is_asked_for = options.plan_in != PlanIn::default();
            planned.map_err(|why| if is_asked_for { Refusal::PlanIn(name, Box::new(why)) } else { why })
        }
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn formats_come_in_order_of_width_and_are_found_by_name() {
        let widths: Vec<u32> = formats::<2>().iter().map(|f| f.name().bits()).collect();
        assert!(widths.is_sorted(), "{widths:?}");
        let found = select::<2>(&["f64".into(), "I16F16".into()]).expect("both exist");
        assert_eq!(found[0].name().to_string(), "I16F16");
        assert_eq!(select::<3>(&["I5F7".into()]).map(|f| f[0].name().bits()).ok(), Some(12));
        let twice = ["f64", "I5F13", "I05F13", "f64"].map(String::from);
        assert_eq!(select::<3>(&twice).map(|found| found.len()).ok(), Some(2));
        assert_eq!(select::<3>(&["F5I7".into()]).err().as_deref(), Some("F5I7"));
    }
}
