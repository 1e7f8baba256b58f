//! A kernel with its inputs and outputs, checked once for all its runs.

use real::FormatName;

use crate::formats::named;
use crate::input::Input;
use crate::kernel::Kernel;
use crate::output::{Output, Requirement};
use crate::refusal::{MOST_STEPS, Refusal};

/// A kernel that can be run.
pub(crate) struct Case<'k, K> {
    pub(crate) kernel: &'k K,
    pub(crate) steps: usize,
    pub(crate) inputs: Vec<Input>,
    pub(crate) outputs: Vec<Output>,
}

impl<'k, K: Kernel> Case<'k, K> {
    /// The kernel, to be run in these formats.
    pub(crate) fn of(kernel: &'k K, formats: &[FormatName]) -> Result<Self, Refusal> {
        let unknown = formats.iter().map(ToString::to_string).find(|format| named(format).is_none());
        if let Some(unknown) = unknown {
            return Err(Refusal::Format(unknown));
        }
        let steps = kernel.steps();
        if !(1..=MOST_STEPS).contains(&steps) {
            return Err(Refusal::Steps(steps));
        }
        let (inputs, outputs) = (kernel.inputs()?, kernel.outputs());
        if outputs.is_empty() {
            return Err(Refusal::NoOutput);
        }
        let input = |one: &Input| (format!("input {}", one.name), one.values.len());
        let truth = |one: &Output| {
            Some((format!("the right course of output {}", one.name), one.truth.as_ref()?.len()))
        };
        let columns = inputs.iter().map(input).chain(outputs.iter().filter_map(truth));
        if let Some((what, found)) = columns.into_iter().find(|(_, found)| *found != steps) {
            return Err(Refusal::Length { what, found, steps });
        }
        let is_asked =
            |output: &Output| !output.requirements.is_empty() && output.requirements.iter().all(is_limit);
        if let Some(output) = outputs.iter().find(|output| !is_asked(output)) {
            return Err(Refusal::Requirement(output.name));
        }
        let names = |names: Vec<&'static str>| {
            let again = |(at, name): (usize, &&'static str)| names[..at].contains(name).then_some(*name);
            names.iter().enumerate().find_map(again)
        };
        let twice = names(inputs.iter().map(|one| one.name).collect());
        let twice = twice.or_else(|| names(outputs.iter().map(|one| one.name).collect()));
        twice.map_or(Ok(Self { kernel, steps, inputs, outputs }), |name| Err(Refusal::TwiceNamed(name)))
    }
}

fn is_limit(requirement: &Requirement) -> bool {
    match requirement {
        Requirement::Absolute(limit) | Requirement::Relative(limit) | Requirement::Drift(limit) => {
            *limit >= 0.0 && limit.is_finite()
        }
        Requirement::Exact => true,
    }
}
