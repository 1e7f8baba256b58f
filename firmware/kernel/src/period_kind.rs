//! What a period passes, and so what it costs.

/// The kinds of periods. A period that is of several counts as the last of them.
#[derive(Clone, Copy, Debug, PartialEq, Eq, PartialOrd, Ord)]
pub enum PeriodKind {
    /// Within one piece and one stage of the plan, found by one evaluation.
    Common,
    /// The same by more evaluations.
    Repeated,
    /// A stage of the plan ends.
    StageEnd,
    /// Onto a further piece of the same polynomial.
    Joint,
    /// Over a smooth joint onto another polynomial.
    Knot,
    /// Over a corner.
    Corner,
    /// The first after a rest.
    Start,
    /// Onto the end of the path, or after the plan by a landing step.
    Landing,
}

impl PeriodKind {
    /// All of them, in order.
    pub const ALL: [Self; 8] = [
        Self::Common,
        Self::Repeated,
        Self::StageEnd,
        Self::Joint,
        Self::Knot,
        Self::Corner,
        Self::Start,
        Self::Landing,
    ];

    /// Its name for readers.
    #[must_use]
    pub fn name(self) -> &'static str {
        match self {
            Self::Common => "common",
            Self::Repeated => "more evaluations",
            Self::StageEnd => "end of a stage",
            Self::Joint => "joint of a polynomial",
            Self::Knot => "knot",
            Self::Corner => "corner",
            Self::Start => "start",
            Self::Landing => "landing",
        }
    }
}
