//! The operations of every step of a run, by which targets price it.

use std::collections::HashMap;
use std::collections::hash_map::Entry;

use real::{Backend, FormatName, Graph, RuntimeFixed, RuntimeFormat};
use secant_interp::Method;
use target_cost::Step;

use crate::exact_plan::ExactPlan;
use crate::problem::Problem;
use crate::run::{Engine, Options, Refusal};
use crate::{on_global_parameter, on_pieces};

/// The steps of a run: how often each sequence of operations occurs. Most steps make the same one.
#[derive(Clone, Debug, Default)]
pub struct RecordedRun {
    /// Each sequence, and how many steps made it.
    pub steps: Vec<(Step, u32)>,
}

impl RecordedRun {
    /// Records `step` until it says that there is no more, at most `most` times.
    pub(crate) fn of(most: usize, mut step: impl FnMut() -> bool) -> Self {
        let mut places = HashMap::new();
        let mut run = Self::default();
        for _ in 0..most {
            let (goes_on, graph) = Graph::of(&mut step);
            if !goes_on {
                break;
            }
            match places.entry(Step::of(&graph)) {
                Entry::Occupied(known) => {
                    let place: usize = *known.get();
                    run.steps[place].1 += 1;
                }
                Entry::Vacant(new) => {
                    run.steps.push((new.key().clone(), 1));
                    new.insert(run.steps.len() - 1);
                }
            }
        }
        run
    }

    /// Mean of a figure over all steps.
    #[must_use]
    pub fn mean(&self, figure: impl Fn(&Step) -> f64) -> f64 {
        let total: f64 = self.steps.iter().map(|(_, count)| f64::from(*count)).sum();
        let sum: f64 = self.steps.iter().map(|(step, count)| figure(step) * f64::from(*count)).sum();
        sum / total.max(1.0)
    }
}

/// Records the first `most` steps of a run in the format of this name, in which it is bit for bit the compared one: fixed-point formats of every
/// kind by the run-time format, so that three instances serve all.
pub(crate) fn record<const D: usize>(
    format: FormatName,
    problem: &Problem<D>,
    plan: &ExactPlan,
    options: &Options,
    most: usize,
) -> Result<RecordedRun, Refusal> {
    match format {
        FormatName::Float { bits: 32 } => in_backend::<f32, D>(problem, plan, options, most),
        FormatName::Fixed { .. } => match RuntimeFormat::named(&format.to_string()) {
            Some(format) => {
                format.run::<1, _>(|| in_backend::<RuntimeFixed<1>, D>(problem, plan, options, most))
            }
            None => in_backend::<f64, D>(problem, plan, options, most),
        },
        _ => in_backend::<f64, D>(problem, plan, options, most),
    }
}

fn in_backend<R: Backend, const D: usize>(
    problem: &Problem<D>,
    plan: &ExactPlan,
    options: &Options,
    most: usize,
) -> Result<RecordedRun, Refusal> {
    let global = |method| on_global_parameter::record::<R, D>(problem, plan, options, method, most);
    match options.engine {
        Engine::DeBoorSecant => global(Method::Secant),
        Engine::DeBoorTaylor1 => global(Method::Taylor1),
        Engine::DeBoorTaylor2 => global(Method::Taylor2),
        Engine::Pieces => on_pieces::record::<R, D>(problem, plan, options, most),
    }
}
