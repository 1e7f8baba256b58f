//! A path that is planned once, and its C files in any format.

use c_code::{CFiles, CName, COverride, CPart, ExpectedRun};
use feed_plan::Schedule;
use nurbs_core::{PieceLimits, compile_with_stops};
use real::{Backend, DoubleDouble, RuntimeFixed, RuntimeFormat};
use secant_interp::{ChordTolerance, CompiledPath, FeedOverride, OverrideLimits, PositionChecksum};
use stress::RandomPath;

/// A path and its plan.
pub(crate) struct PlannedPath<'a, const D: usize> {
    plan: stress::PlannedPath<'a, D>,
    most_periods: u32,
}

impl<'a, const D: usize> PlannedPath<'a, D> {
    /// Plans a path; `None` if it lasts more than `most_periods` periods.
    pub(crate) fn new(path: &'a RandomPath<D>, most_periods: u32) -> Option<Self> {
        Some(Self { plan: stress::PlannedPath::new(path, most_periods)?, most_periods })
    }

    /// The files in the format of this name; `None` if it cannot hold the path. Fixed point is the run-time format's: each of its
    /// operations gives the bits of the format that it stands for.
    pub(crate) fn files(&self, name: CName, format: &str, has_override: bool) -> Option<CFiles> {
        match format {
            "f32" => self.files_in::<f32>(name, has_override),
            "f64" => self.files_in::<f64>(name, has_override),
            _ => {
                let format = RuntimeFormat::named(format).expect("a fixed-point format");
                format.run::<0, _>(|| self.files_in::<RuntimeFixed<0>>(name, has_override))
            }
        }
    }

    /// The files in `R`, which say that they are of the part and the format.
    pub(crate) fn files_in<R: Backend>(&self, name: CName, has_override: bool) -> Option<CFiles> {
        let about = format!("{} in {}", name.as_str(), R::name());
        self.files_about::<R>(name, has_override, about, None)
    }

    /// The files in `R`, with these words of what they are of and of their fault.
    pub(crate) fn files_about<R: Backend>(
        &self,
        name: CName,
        has_override: bool,
        about: String,
        fault: Option<String>,
    ) -> Option<CFiles> {
        let (path, plan) = (self.plan.path, &self.plan);
        let curves: Vec<_> = path.curves.iter().map(nurbs_core::NurbsBuf::as_curve).collect();
        let step_mm = path.limits.feedrate + plan.landing_step();
        let limits = PieceLimits { length_mm: path.piece_mm, step_mm };
        let table = compile_with_stops::<DoubleDouble, R, D>(&curves, &limits, &plan.stops()).ok()?;
        let fluctuation = path.max_evaluations.is_multiple_of(2).then_some(1e-4);
        let tolerance = ChordTolerance::for_fluctuation(fluctuation, path.max_evaluations);
        let stages = plan.stages();
        let schedule = Schedule::new(&stages, 1.0, plan.periods());
        let path = CompiledPath::new(table, &schedule, tolerance, plan.landing_step()).ok()?;
        let run = expected(&path, 4 * self.most_periods as usize)?;
        let feed_override = has_override.then(|| self.feed_override());
        let part = CPart { name, about, fault, path: &path, period_s: 0.001, run, feed_override };
        Some(part.files().expect("C has the format"))
    }

    /// Feed override with a reserve of a fifth of the plan's own acceleration and jerk; 100 % is four fifths of its speed.
    fn feed_override(&self) -> COverride {
        let limits = &self.plan.path.limits;
        let feeds = FeedOverride::new(&OverrideLimits {
            acceleration: 1.25 * limits.acceleration,
            jerk: 1.25 * limits.jerk,
            planned_acceleration: limits.acceleration,
            planned_jerk: limits.jerk,
            planned_feed: limits.feedrate,
        });
        COverride { feeds: feeds.expect("a reserve"), commanded: 0.8 }
    }
}

/// The run in Rust; `None` if it is not over after so many periods.
fn expected<R: Backend, const D: usize>(path: &CompiledPath<R, D>, most: usize) -> Option<ExpectedRun> {
    let (mut periods, mut checksum) = (0, PositionChecksum::default());
    for run in path.runs() {
        let mut state = run.start();
        while let Some(setpoint) = run.step(&mut state) {
            checksum.add(run.pieces.position(setpoint.piece, &setpoint.offset));
            periods += 1;
            if periods > most {
                return None;
            }
        }
    }
    Some(ExpectedRun { periods, checksum: checksum.value() })
}
