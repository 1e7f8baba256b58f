//! Outputs judged by what is required of them.

use serde::Serialize;

use crate::output::{Output, Requirement};

/// An output's exact value, as a sum of two floats.
pub(crate) type Pair = (f64, f64);

/// A requirement, and what came of it.
#[derive(Clone, Debug, PartialEq, Serialize)]
pub struct Required {
    /// `absolute`, `relative`, `drift` or `exact`.
    pub kind: &'static str,
    /// The largest error in the requirement's measure; for `exact` the number of wrong values.
    pub found: f64,
    /// The largest that is allowed.
    pub limit: f64,
    /// The first step in which more was found; for `drift` the first step of the last tenth.
    pub first_broken: Option<usize>,
}

impl Required {
    /// Whether it is met.
    #[must_use]
    pub fn holds(&self) -> bool {
        self.first_broken.is_none()
    }

    /// What was found, over what is allowed.
    #[must_use]
    pub fn used(&self) -> f64 {
        if self.found == 0.0 { 0.0 } else { self.found / self.limit }
    }
}

/// How good an output is.
#[derive(Clone, Debug, PartialEq, Serialize)]
pub struct OutputFound {
    /// The output.
    pub output: &'static str,
    /// The largest distance from the right value.
    pub worst_error: f64,
    /// The step of it, from 0.
    pub worst_step: usize,
    /// The requirements, in their order.
    pub requirements: Vec<Required>,
    /// The course of the error, for a picture: the step and the size of the largest in each of at most a thousand stretches of
    /// steps. It is no part of JSON.
    #[serde(skip)]
    pub course: Vec<(usize, f64)>,
}

impl OutputFound {
    /// The first step in which a requirement is broken.
    #[must_use]
    pub fn first_broken(&self) -> Option<usize> {
        self.requirements.iter().filter_map(|one| one.first_broken).min()
    }
}

/// Stretches of steps in the course of an error, at most.
const MOST_STRETCHES: usize = 1000;

/// Judges the outputs of a run.
pub(crate) struct Judge<'a> {
    outputs: &'a [Output],
    /// The reference's outputs, one step after the other.
    reference: &'a [Pair],
    steps: usize,
    found: Vec<OutputFound>,
    /// Of each output the sum of errors over the first and over the last tenth.
    sums: Vec<[f64; 2]>,
}

impl<'a> Judge<'a> {
    pub(crate) fn new(outputs: &'a [Output], reference: &'a [Pair], steps: usize) -> Self {
        let found = |output: &Output| OutputFound {
            output: output.name,
            worst_error: 0.0,
            worst_step: 0,
            requirements: output.requirements.iter().map(nothing_found).collect(),
            course: Vec::new(),
        };
        let found = outputs.iter().map(found).collect();
        Self { outputs, reference, steps, found, sums: vec![[0.0; 2]; outputs.len()] }
    }

    /// Notes the outputs of a step. Returns whether it breaks a requirement.
    pub(crate) fn note(&mut self, step: usize, values: impl Iterator<Item = Pair>) -> bool {
        let mut is_broken = false;
        let tenth = self.steps.div_ceil(10);
        let (count, stretch) = (self.outputs.len(), step / self.steps.div_ceil(MOST_STRETCHES));
        for (place, (value, output)) in values.zip(self.outputs).enumerate() {
            let right = match &output.truth {
                Some(truth) => (truth[step], 0.0),
                None => self.reference.get(step * count + place).copied().unwrap_or((f64::NAN, 0.0)),
            };
            let error = (value.0 - right.0) + (value.1 - right.1);
            let (found, sums) = (&mut self.found[place], &mut self.sums[place]);
            if error.abs() > found.worst_error {
                (found.worst_error, found.worst_step) = (error.abs(), step);
            }
            match found.course.get_mut(stretch) {
                None => found.course.push((step, error.abs())),
                Some(largest) if error.abs() > largest.1 => *largest = (step, error.abs()),
                Some(_) => {}
            }
            sums[0] += if step < tenth { error } else { 0.0 };
            sums[1] += if step + tenth >= self.steps { error } else { 0.0 };
            for (requirement, required) in output.requirements.iter().zip(&mut found.requirements) {
                is_broken |= required.note(*requirement, step, error, right.0);
            }
        }
        is_broken
    }

    /// What was found of a run that is finished.
    #[allow(clippy::cast_precision_loss, reason = "at most 2²⁴ steps")]
    pub(crate) fn finished(mut self) -> Vec<OutputFound> {
        let tenth = self.steps.div_ceil(10);
        for ((output, found), sums) in self.outputs.iter().zip(&mut self.found).zip(&self.sums) {
            for (requirement, required) in output.requirements.iter().zip(&mut found.requirements) {
                if let Requirement::Drift(limit) = requirement {
                    required.found = ((sums[1] - sums[0]) / tenth as f64).abs();
                    let holds = required.found <= *limit;
                    required.first_broken = (!holds).then(|| self.steps - tenth);
                }
            }
        }
        self.found
    }

    /// What was found of a run that ended before.
    pub(crate) fn so_far(self) -> Vec<OutputFound> {
        self.found
    }
}

fn nothing_found(requirement: &Requirement) -> Required {
    let (kind, limit) = match *requirement {
        Requirement::Absolute(limit) => ("absolute", limit),
        Requirement::Relative(limit) => ("relative", limit),
        Requirement::Drift(limit) => ("drift", limit),
        Requirement::Exact => ("exact", 0.0),
    };
    Required { kind, found: 0.0, limit, first_broken: None }
}

impl Required {
    /// Notes an error. Returns whether the requirement is broken by it.
    fn note(&mut self, requirement: Requirement, step: usize, error: f64, right: f64) -> bool {
        let measure = match requirement {
            Requirement::Absolute(_) => error.abs(),
            Requirement::Relative(_) if error == 0.0 => 0.0,
            Requirement::Relative(_) => (error / right).abs(),
            Requirement::Exact if error == 0.0 => 0.0,
            Requirement::Exact => self.found + 1.0,
            Requirement::Drift(_) => return false,
        };
        if measure > self.found || measure.is_nan() {
            self.found = measure;
        }
        let holds = measure <= self.limit;
        if !holds {
            self.first_broken.get_or_insert(step);
        }
        !holds
    }
}
