//! Outputs, and what is required of them.

/// What is required of an output. Errors are distances from the reference, or from the values that [`Output::truth`] gives.
#[derive(Clone, Copy, Debug, PartialEq)]
pub enum Requirement {
    /// In every step the error is at most this, in the unit of the output.
    Absolute(f64),
    /// In every step the error is at most this part of the right value. Where that is 0, no error is allowed.
    Relative(f64),
    /// The mean error over the last tenth of the steps is at most this far from that over the first tenth, in the unit of
    /// the output: what noise there is may be larger.
    Drift(f64),
    /// Every value is the right one: for counts, states and decisions.
    Exact,
}

/// An output.
#[derive(Clone, Debug, PartialEq)]
pub struct Output {
    pub(crate) name: &'static str,
    pub(crate) requirements: Vec<Requirement>,
    pub(crate) truth: Option<Vec<f64>>,
}

impl Output {
    /// An output of which nothing is required yet.
    #[must_use]
    pub fn named(name: &'static str) -> Self {
        Self { name, requirements: Vec::new(), truth: None }
    }

    fn with(mut self, requirement: Requirement) -> Self {
        self.requirements.push(requirement);
        self
    }

    /// With [`Requirement::Absolute`].
    #[must_use]
    pub fn within(self, limit: f64) -> Self {
        self.with(Requirement::Absolute(limit))
    }

    /// With [`Requirement::Relative`].
    #[must_use]
    pub fn within_part(self, limit: f64) -> Self {
        self.with(Requirement::Relative(limit))
    }

    /// With [`Requirement::Drift`].
    #[must_use]
    pub fn drift(self, limit: f64) -> Self {
        self.with(Requirement::Drift(limit))
    }

    /// With [`Requirement::Exact`].
    #[must_use]
    pub fn exact(self) -> Self {
        self.with(Requirement::Exact)
    }

    /// The right values, one for each step, where they are known otherwise than by the kernel: from a closed form, or a
    /// recording. The reference is judged by them too, so that a fault of the algorithm is told from one of a format.
    #[must_use]
    pub fn truth(mut self, values: Vec<f64>) -> Self {
        self.truth = Some(values);
        self
    }
}
