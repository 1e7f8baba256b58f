//! The items that an entity draws, in the units of the drawing or of its block.

use super::insert::Insert;
use crate::curve::Curve;
use crate::moves::Shape;
use crate::source::Span;

/// One item that is drawn; `span` is the place of its entity, or of the vertex that draws it.
#[derive(Clone, Debug)]
pub(crate) enum Item<'t> {
    /// A curve.
    Curve { curve: Curve, shape: Shape, span: Span },
    /// A line that ends where it starts.
    Standstill(Span),
    /// A block, once or in rows and columns.
    Insert(Insert<'t>),
}

impl Item<'_> {
    /// A straight line, or a standstill.
    pub(crate) fn straight(from: [f64; 3], to: [f64; 3], span: Span) -> Self {
        if from == to {
            Self::Standstill(span)
        } else {
            Self::Curve { curve: Curve::line(from, to), shape: Shape::Line, span }
        }
    }

    /// The number of its control points.
    pub(crate) fn point_count(&self) -> usize {
        match self {
            Self::Curve { curve, .. } => curve.control_points_mm().len(),
            Self::Standstill(_) | Self::Insert(_) => 0,
        }
    }
}
