//! The formats that can be compared, by name.

use std::borrow::Cow;
use std::marker::PhantomData;

use c_code::CFiles;
use real::{Backend, FormatName, I4F28, I4F60, RuntimeFixed, RuntimeFormat, Work, in_few_backends};
use secant_interp::StreamHeader;
use target_cost::RecordedRun;

use crate::plan::exact_plan::ExactPlan;
use crate::problem::problem::Problem;
use crate::refusal::Refusal;
use crate::run::by_engine::{self, Recording};
use crate::run::c_files::{self, CRequest};
use crate::run::constants::Constants;
use crate::run::job::{FEW, Job};
use crate::run::observer::{Observer, with_steps};
use crate::run::options::{Options, PlanIn};
use crate::run::run::{AboutRun, Run};
use crate::run::stream::{StreamFailure, StreamRequest, stream};
use crate::run::vectors::{Vectors, Words, vectors};

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

    /// Interpolates in this format, following a plan made in any format. `observer` looks at the steps while they are
    /// made, on all cores; no step is kept. Where several formats run the same job, its path is cut into pieces once.
    ///
    /// # Errors
    /// [`Refusal`] when the part, the plan or a limit does not fit the format.
    fn run_job(&self, job: &Job<'_, D>, observer: &dyn Observer) -> Result<AboutRun, Refusal>;

    /// [`run_job`](Self::run_job) of a problem by a plan of it.
    ///
    /// # Errors
    /// As [`run_job`](Self::run_job).
    fn run_before(
        &self,
        problem: &Problem<D>,
        plan: &ExactPlan,
        options: &Options,
        observer: &dyn Observer,
    ) -> Result<AboutRun, Refusal> {
        self.run_job(&Job::new(problem, plan, options), observer)
    }

    /// The same run with all its steps, about a hundred bytes a period.
    ///
    /// # Errors
    /// As [`run_before`](Self::run_before).
    fn run(&self, problem: &Problem<D>, plan: &ExactPlan, options: &Options) -> Result<Run, Refusal> {
        with_steps(|observer| self.run_before(problem, plan, options, observer))
    }

    /// The operations of each of the first `most` steps of that run.
    ///
    /// # Errors
    /// As [`run`](Self::run).
    fn record(
        &self,
        problem: &Problem<D>,
        plan: &ExactPlan,
        options: &Options,
        most: usize,
    ) -> Result<RecordedRun, Refusal>;

    /// Writes path and plan, compiled for this format, as constants for a controller.
    ///
    /// # Errors
    /// [`Refusal`] as from [`run`](Self::run), and if a controller has no such type.
    fn constants(
        &self,
        problem: &Problem<D>,
        plan: &ExactPlan,
        options: &Options,
    ) -> Result<Constants, Refusal>;

    /// Writes path and plan, compiled for this format, as C for a controller.
    ///
    /// # Errors
    /// [`Refusal`] as from [`run`](Self::run), and if C has no such type.
    fn c_files(
        &self,
        problem: &Problem<D>,
        plan: &ExactPlan,
        options: &Options,
        request: &CRequest,
    ) -> Result<CFiles, Refusal>;

    /// Writes path and plan, compiled for this format, as a file of sections for a controller. Returns its header.
    ///
    /// # Errors
    /// [`StreamFailure::Refused`] as from [`run`](Self::run), and if a controller has no such type or too small a buffer:
    /// then nothing is written.
    fn stream(
        &self,
        problem: &Problem<D>,
        plan: &ExactPlan,
        options: &Options,
        request: &mut StreamRequest<'_>,
    ) -> Result<StreamHeader, StreamFailure>;

    /// What the step on pieces holds in each period of that run, bit by bit.
    ///
    /// # Errors
    /// [`Refusal`] as from [`run`](Self::run), and if the run does not end.
    fn vectors(&self, problem: &Problem<D>, plan: &ExactPlan, options: &Options) -> Result<Vectors, Refusal>;
}

/// The format of the numbers `R`. If `R` is the run-time format, the first field says which format that is.
struct Of<R>(Option<RuntimeFormat>, PhantomData<fn() -> R>);

impl<R> Of<R> {
    fn within<T>(&self, work: impl FnOnce() -> T) -> T {
        match self.0 {
            Some(format) => format.run::<0, _>(work),
            None => work(),
        }
    }
}

impl<R: Backend, const D: usize> Format<D> for Of<R> {
    fn name(&self) -> FormatName {
        self.within(R::name)
    }

    fn largest(&self) -> f64 {
        self.within(|| R::max_value().to_f64())
    }

    fn resolution(&self) -> f64 {
        self.within(|| R::resolution().to_f64())
    }

    fn plan(&self, problem: &Problem<D>, options: &Options) -> Result<ExactPlan, Refusal> {
        in_few_backends::<FEW, _>(self.within(R::name), Planning { problem, options })
    }

    fn run_job(&self, job: &Job<'_, D>, observer: &dyn Observer) -> Result<AboutRun, Refusal> {
        self.within(|| by_engine::audited::<R, D>(job, observer))
    }

    fn record(
        &self,
        problem: &Problem<D>,
        plan: &ExactPlan,
        options: &Options,
        most: usize,
    ) -> Result<RecordedRun, Refusal> {
        in_few_backends::<FEW, _>(
            self.within(R::name),
            Recording { job: Job::new(problem, plan, options), most },
        )
    }

    fn constants(
        &self,
        problem: &Problem<D>,
        plan: &ExactPlan,
        options: &Options,
    ) -> Result<Constants, Refusal> {
        in_few_backends::<FEW, _>(self.within(R::name), Compiling { job: Job::new(problem, plan, options) })
    }

    fn c_files(
        &self,
        problem: &Problem<D>,
        plan: &ExactPlan,
        options: &Options,
        request: &CRequest,
    ) -> Result<CFiles, Refusal> {
        in_few_backends::<FEW, _>(
            self.within(R::name),
            WritingC { job: Job::new(problem, plan, options), request },
        )
    }

    fn stream(
        &self,
        problem: &Problem<D>,
        plan: &ExactPlan,
        options: &Options,
        request: &mut StreamRequest<'_>,
    ) -> Result<StreamHeader, StreamFailure> {
        in_few_backends::<FEW, _>(
            self.within(R::name),
            Streaming { job: Job::new(problem, plan, options), request },
        )
    }

    fn vectors(&self, problem: &Problem<D>, plan: &ExactPlan, options: &Options) -> Result<Vectors, Refusal> {
        in_few_backends::<FEW, _>(
            self.within(R::name),
            WritingVectors { job: Job::new(problem, plan, options) },
        )
    }
}

/// A plan to be made.
struct Planning<'a, const D: usize> {
    problem: &'a Problem<D>,
    options: &'a Options,
}

impl<const D: usize> Work for Planning<'_, D> {
    type Output = Result<ExactPlan, Refusal>;

    fn in_backend<R: Backend>(self) -> Self::Output {
        planned::<R, D>(self.problem, self.options)
    }
}

/// The plan of `problem` in the format `R` under these options.
pub(crate) fn planned<R: Backend, const D: usize>(
    problem: &Problem<D>,
    options: &Options,
) -> Result<ExactPlan, Refusal> {
    let &Options { end_feeds_mm_per_s, profile, window_mm, .. } = options;
    match window_mm {
        Some(window_mm) => ExactPlan::through_window::<R, D>(problem, window_mm, profile),
        None => ExactPlan::in_format_with::<R, D>(problem, end_feeds_mm_per_s, profile),
    }
}

/// Constants to be written.
struct Compiling<'a, const D: usize> {
    job: Job<'a, D>,
}

impl<const D: usize> Work for Compiling<'_, D> {
    type Output = Result<Constants, Refusal>;

    fn in_backend<R: Backend>(self) -> Self::Output {
        Constants::of::<R, D>(&self.job)
    }
}

/// C files to be written.
struct WritingC<'a, const D: usize> {
    job: Job<'a, D>,
    request: &'a CRequest,
}

impl<const D: usize> Work for WritingC<'_, D> {
    type Output = Result<CFiles, Refusal>;

    fn in_backend<R: Backend>(self) -> Self::Output {
        c_files::c_files::<R, D>(&self.job, self.request)
    }
}

/// A stream to be written.
struct Streaming<'a, 'w, const D: usize> {
    job: Job<'a, D>,
    request: &'a mut StreamRequest<'w>,
}

impl<const D: usize> Work for Streaming<'_, '_, D> {
    type Output = Result<StreamHeader, StreamFailure>;

    fn in_backend<R: Backend>(self) -> Self::Output {
        stream::<R, D>(&self.job, self.request)
    }
}

/// Test vectors to be written.
struct WritingVectors<'a, const D: usize> {
    job: Job<'a, D>,
}

impl<const D: usize> Work for WritingVectors<'_, D> {
    type Output = Result<Vectors, Refusal>;

    fn in_backend<R: Backend>(self) -> Self::Output {
        vectors::<R, D>(&self.job, Words::OfFormat(R::name()))
    }
}

/// The spaces for which formats are compiled: the plane, `D = 2`, and space, `D = 3`.
///
/// Both are compiled here, once, and not again in every crate that compares formats: for each compiled format, that is an
/// interpolator.
pub trait Dimension<const D: usize> {
    /// The format of this name, if a part can be run in it. Floats and one fixed-point format of each word are compiled;
    /// every other is the run-time format, whose every operation gives the same bits.
    fn format(name: FormatName) -> Option<Box<dyn Format<D>>>;

    /// A format chosen at run time; it can be compared like any other.
    fn at_run_time(format: RuntimeFormat) -> Box<dyn Format<D>>;
}

/// The implementor of [`Dimension<2>`] and [`Dimension<3>`].
#[derive(Clone, Copy, Debug)]
pub struct Space;

impl Dimension<2> for Space {
    fn format(name: FormatName) -> Option<Box<dyn Format<2>>> {
        compiled(name).or_else(|| RuntimeFormat::of(name).map(Self::at_run_time))
    }

    fn at_run_time(format: RuntimeFormat) -> Box<dyn Format<2>> {
        of::<RuntimeFixed<0>, 2>(Some(format))
    }
}

impl Dimension<3> for Space {
    fn format(name: FormatName) -> Option<Box<dyn Format<3>>> {
        compiled(name).or_else(|| RuntimeFormat::of(name).map(Self::at_run_time))
    }

    fn at_run_time(format: RuntimeFormat) -> Box<dyn Format<3>> {
        of::<RuntimeFixed<0>, 3>(Some(format))
    }
}

fn of<R: Backend + 'static, const D: usize>(at_run_time: Option<RuntimeFormat>) -> Box<dyn Format<D>> {
    Box::new(Of::<R>(at_run_time, PhantomData))
}

/// The format of this name, if it is compiled.
fn compiled<const D: usize>(name: FormatName) -> Option<Box<dyn Format<D>>> {
    const WORD_OF_32_BITS: FormatName = FormatName::fixed(4, 28);
    const WORD_OF_64_BITS: FormatName = FormatName::fixed(4, 60);
    match name {
        FormatName::Float { bits: 32 } => Some(of::<f32, D>(None)),
        FormatName::Float { bits: 64 } => Some(of::<f64, D>(None)),
        WORD_OF_32_BITS => Some(of::<I4F28, D>(None)),
        WORD_OF_64_BITS => Some(of::<I4F60, D>(None)),
        _ => None,
    }
}

/// The names of the built-in formats, narrow before wide, fixed point before float: the order of rising cost on an
/// unknown target.
const BUILT_IN: [FormatName; 10] = [
    FormatName::fixed(16, 16),
    FormatName::fixed(8, 24),
    FormatName::fixed(4, 28),
    FormatName::fixed(3, 29),
    FormatName::fixed(2, 30),
    FormatName::Float { bits: 32 },
    FormatName::fixed(32, 32),
    FormatName::fixed(16, 48),
    FormatName::fixed(4, 60),
    FormatName::Float { bits: 64 },
];

/// Every built-in format, narrow before wide, fixed point before float: the order of rising cost on an unknown target.
#[must_use]
pub fn formats<const D: usize>() -> Vec<Box<dyn Format<D>>>
where
    Space: Dimension<D>,
{
    BUILT_IN.into_iter().filter_map(Space::format).collect()
}

/// The format with this name. A format such as `I5F13` that is not built in can be run too.
#[must_use]
pub fn format_named<const D: usize>(name: &str) -> Option<Box<dyn Format<D>>>
where
    Space: Dimension<D>,
{
    FormatName::named(name).and_then(Space::format)
}

/// The [formats with these names](format_named), each once, narrow before wide.
///
/// # Errors
/// The first name that no format has.
pub fn select<const D: usize>(names: &[impl AsRef<str>]) -> Result<Vec<Box<dyn Format<D>>>, String>
where
    Space: Dimension<D>,
{
    let mut selected: Vec<Box<dyn Format<D>>> = Vec::with_capacity(names.len());
    for name in names.iter().map(AsRef::as_ref) {
        let format = format_named(name).ok_or_else(|| name.to_owned())?;
        if selected.iter().all(|one| one.name() != format.name()) {
            selected.push(format);
        }
    }
    selected.sort_by_key(|one| (one.name().bits(), matches!(one.name(), FormatName::Float { .. })));
    Ok(selected)
}

/// The plan that all formats have in common; if there is none, the one that `format` follows under these options.
///
/// # Errors
/// As [`Format::plan`].
pub fn common_or_plan_for<'a, const D: usize>(
    common: Option<&'a ExactPlan>,
    problem: &Problem<D>,
    format: &dyn Format<D>,
    options: &Options,
) -> Result<Cow<'a, ExactPlan>, Refusal>
where
    Space: Dimension<D>,
{
    match common {
        Some(plan) => Ok(Cow::Borrowed(plan)),
        None => plan_for(problem, format, options).map(Cow::Owned),
    }
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
    let PlanIn::Format(name) = options.plan_in else { return format.plan(problem, options) };
    let planner = Space::format(name);
    let planned = planner.as_deref().unwrap_or(format).plan(problem, options);
    let is_asked_for = options.plan_in != PlanIn::default();
    planned.map_err(|why| if is_asked_for { Refusal::PlanIn(name, Box::new(why)) } else { why })
}
