//! The places of axes other than X, Y and Z.

use crate::side_axes::{SIDE_AXES, SideMove};
use crate::source::Span;

/// A block's move of side axes, from and to places in degrees and mm, as the program counts them.
#[derive(Clone, Copy)]
pub(crate) struct SideWords {
    pub(crate) from: [f64; 6],
    pub(crate) to: [f64; 6],
    /// The first word of an axis that moves.
    pub(crate) span: Span,
}

/// The places of the side axes.
#[derive(Default)]
pub(crate) struct SidePlaces {
    /// Where each is, in degrees and mm, as the program counts; `None` until a word names it, or where it was lost.
    pub(crate) at: [Option<f64>; SIDE_AXES.len()],
    /// Whether words that are not followed, as G28's, moved it or its zero.
    pub(crate) is_lost: [bool; SIDE_AXES.len()],
    /// By how much G92 has moved the zero of the program's count.
    pub(crate) shift: [f64; SIDE_AXES.len()],
    /// The move of the block that is read, until its curve is made.
    pub(crate) words: Option<SideWords>,
}

impl SidePlaces {
    /// The places as they were counted at the begin of the program: G92 changes no such place.
    fn counted_as_at_first(&self, places: [f64; 6]) -> [f64; 6] {
        std::array::from_fn(|axis| places[axis] + self.shift[axis])
    }

    /// How the axes move along the next curve; `None` if they stand where the moves so far have left them.
    pub(crate) fn along(&mut self, curve: usize, moves: &[SideMove]) -> Option<SideMove> {
        if let Some(SideWords { from, to, .. }) = self.words.take() {
            return Some(SideMove {
                curve,
                from: self.counted_as_at_first(from),
                to: self.counted_as_at_first(to),
            });
        }
        let at = self.counted_as_at_first(self.at.map(|at| at.unwrap_or(0.0)));
        let before = moves.last().map_or([0.0; 6], |last| last.to);
        (at != before).then(|| SideMove::standing(curve, at))
    }
}

/// The feed of a printer, which M220 scales.
pub(crate) struct ScaledFeed {
    /// The last F of G94.
    pub(crate) commanded_mm_per_s: Option<f64>,
    /// What moves take of it.
    pub(crate) scale: f64,
    /// The scale that `M220 R` brings back.
    pub(crate) kept_scale: f64,
}

impl Default for ScaledFeed {
    fn default() -> Self {
        Self { commanded_mm_per_s: None, scale: 1.0, kept_scale: 1.0 }
    }
}

/// The places of the other axes.
#[derive(Default)]
pub(crate) struct OtherAxes {
    pub(crate) feed: ScaledFeed,
    pub(crate) side: SidePlaces,
    /// The filament that has been pushed, in mm.
    pub(crate) extruder_mm: f64,
    /// M83: E counts from its present place.
    pub(crate) is_relative: bool,
    /// Words of a printer have been met.
    pub(crate) is_printer: bool,
}
