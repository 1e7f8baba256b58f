//! The shapes of stages that a plan has, by their names in C.

use real::Real;
use secant_interp::{LengthStage, StageShape};

/// A shape's name and formula in C, and the number by which stages refer to it.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub(crate) struct Shape {
    pub(crate) name: &'static str,
    pub(crate) formula: &'static str,
    pub(crate) index: u8,
}

impl Shape {
    /// The shape of a stage.
    pub(crate) fn of<R>(shape: &StageShape<R>) -> Self {
        let (name, formula, index) = match shape {
            StageShape::Cubic => ("CUBIC", "3x^2 - 2x^3", 0),
            StageShape::Onset => ("ONSET", "x^2", 1),
            StageShape::Steady => ("STEADY", "x", 2),
            StageShape::Easing => ("EASING", "2x - x^2", 3),
            StageShape::Bent(_) => ("BENT", "x + b x (1 - x)", 4),
            StageShape::Cosine => ("COSINE", "(1 - cos(pi x))/2", 5),
        };
        Self { name, formula, index }
    }

    /// Every shape in which the feed of a stage changes, each once.
    pub(crate) fn all_of<R: Real>(stages: &[LengthStage<R>]) -> Vec<Self> {
        let mut found: Vec<Self> = stages
            .iter()
            .filter(|stage| !stage.change.is_zero())
            .map(|stage| Self::of(&stage.shape))
            .collect();
        found.sort_by_key(|shape| shape.index);
        found.dedup();
        found
    }
}
