//! The options of a run.

use std::fmt;
use std::sync::atomic::{AtomicBool, Ordering};

use feed_plan::ProfileKind;
use real::{Backend, FormatName};
use secant_interp::Method;
use serde::Serialize;

use crate::run::overrides::OverrideCommands;

/// The form of the path in real time, and the solver for it.
#[derive(Clone, Copy, Debug, PartialEq, Eq, Serialize)]
#[serde(rename_all = "kebab-case")]
pub enum Engine {
    /// The textbook's form: one global parameter, de Boor's scheme in each evaluation, paper A's secant iteration.
    DeBoorSecant,
    /// One global parameter and de Boor's scheme, with a first-order Taylor step.
    DeBoorTaylor1,
    /// One global parameter and de Boor's scheme, with a second-order Taylor step.
    DeBoorTaylor2,
    /// Compiled pieces, the chord without cancellation, Newton's correction without division.
    Pieces,
}

impl Engine {
    /// The method on the global parameter; `None` on pieces.
    pub(crate) fn method(self) -> Option<Method> {
        match self {
            Self::DeBoorSecant => Some(Method::Secant),
            Self::DeBoorTaylor1 => Some(Method::Taylor1),
            Self::DeBoorTaylor2 => Some(Method::Taylor2),
            Self::Pieces => None,
        }
    }
}

impl fmt::Display for Engine {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        f.pad(match self {
            Self::DeBoorSecant => "raw",
            Self::DeBoorTaylor1 => "raw, taylor 1",
            Self::DeBoorTaylor2 => "raw, taylor 2",
            Self::Pieces => "pieces",
        })
    }
}

/// The options of a run.
#[derive(Clone, Debug)]
pub struct Options {
    /// The form of the path and the solver.
    pub engine: Engine,
    /// Longest compiled piece, in mm.
    pub piece_length_mm: f64,
    /// The format to plan in.
    pub plan_in: PlanIn,
    /// The kind of transitions in the plan.
    pub profile: ProfileKind,
    /// Feeds at the two ends of the path, in mm/s.
    pub end_feeds_mm_per_s: [f64; 2],
    /// How much of the path the planner has in view at a time, in mm; the whole path if `None`. A plan through a window
    /// goes from rest to rest, whatever the feeds at the ends.
    pub window_mm: Option<f64>,
    /// The fluctuation at which the solver stops. By default it is the machine file's Δ on the global parameter, and
    /// the format's resolution on pieces.
    pub fluctuation: Option<f64>,
    /// Changes of the feed while the plan runs; on pieces only.
    pub overrides: Option<OverrideCommands>,
    /// Set from outside, it ends each run at its next period. A comparison leaves these runs out.
    pub interrupt: Option<&'static AtomicBool>,
}

impl Options {
    /// Whether a run begins at rest; a plan through a window always does.
    pub(crate) fn starts_at_rest(&self) -> bool {
        self.window_mm.is_some() || self.end_feeds_mm_per_s[0] == 0.0
    }

    /// Whether runs are to end.
    pub(crate) fn is_interrupted(&self) -> bool {
        self.interrupt.is_some_and(|interrupt| interrupt.load(Ordering::Relaxed))
    }
}

impl Default for Options {
    fn default() -> Self {
        Self {
            engine: Engine::Pieces,
            piece_length_mm: 32.0,
            plan_in: PlanIn::default(),
            profile: ProfileKind::default(),
            end_feeds_mm_per_s: [0.0; 2],
            window_mm: None,
            fluctuation: None,
            overrides: None,
            interrupt: None,
        }
    }
}

/// The format that a plan is made in.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum PlanIn {
    /// All formats follow a plan made in this format.
    Format(FormatName),
    /// Each format follows a plan made in itself.
    Same,
}

impl Default for PlanIn {
    fn default() -> Self {
        Self::Format(f64::name())
    }
}
