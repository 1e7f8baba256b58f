//! Cutting a path: every span is halved until each part is short, and its speed and its weights are even enough.

use alloc::vec::Vec;

use real::{Backend, Real};

use crate::pieces::hodograph;
use crate::pieces::local_piece::LocalPiece;
use crate::polynomials::bezier::{Bezier, computed};
use crate::{CompileError, NurbsCurve, Place};

/// How finely to cut.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct PieceLimits {
    /// Longest piece, in mm. A 32-bit format resolves a step best with 32 to 64 mm.
    pub length_mm: f64,
    /// Longest chord that a period may want, in mm.
    pub step_mm: f64,
}

/// Longest chain of halvings that make the pieces of a span shorter, and their weights more even.
pub(crate) const MAX_HALVINGS: i32 = 16;

/// Longest chain of halvings where only the speed is uneven. Towards a place where |C'| vanishes, each halving of a
/// span divides |C'| by a power of two, until the part that holds the place is shorter than [`STILL_MM`]. Each halving
/// makes a few pieces.
const MOST_HALVINGS: i32 = 40;

/// Most halvings beyond [`MAX_HALVINGS`] in a part of a span: a place where |C'| vanishes takes a hundred.
const MOST_FINER_HALVINGS: usize = 4096;

/// An uneven part of the path that is no longer than this, in mm, counts as standing still. The length is far below the
/// resolution of a drive, and 2⁻²⁵ of a usual step.
const STILL_MM: f64 = 1e-9;

/// A part of the path no longer than 2⁷ units in the last place of the curve's coordinates counts as rounding.
const ROUNDING: i32 = 7;

/// A part of a span that is less than 2⁻⁴⁰ of it counts as rounding.
pub(crate) const SLIVER: i32 = -40;

/// Largest ratio of the greatest to the least |C'| on a piece, and of its weights. It keeps the solver's unknown within
/// a factor √1.5 of 1, which even two integer bits hold. A smaller ratio means more pieces.
const MAX_RATIO: f64 = 1.5;

/// |C'| below this part of the piece's mean speed counts as a cusp.
const CUSP_RATIO: f64 = 1e-4;

/// A path in pieces, and the parts of it that stand still, in order.
pub(crate) struct Cut<H, const D: usize> {
    pub(crate) pieces: Vec<LocalPiece<H, D>>,
    pub(crate) still: Vec<Place>,
}

/// Cuts one curve, span by span and stop by stop, halving until a piece is short and even enough.
pub(crate) fn cut<H: Backend, const D: usize>(
    (index, curve): (usize, &NurbsCurve<'_, f64, D>),
    limits: &PieceLimits,
    stops: impl Iterator<Item = f64>,
    out: &mut Cut<H, D>,
) -> Result<(), CompileError> {
    let knots = curve.knots().as_slice();
    let spans = curve.degree()..curve.control_points().len();
    let ends = spans.map(|span| (span, knots[span], knots[span + 1])).filter(|(_, begin, end)| begin < end);
    let mut stops = stops.peekable();
    let mut parts = Vec::new();
    for (span, mut begin, end) in ends {
        // A stop that is nearer to a joint than rounding is that joint.
        let sliver = (end - begin).ldexp(SLIVER);
        while let Some(stop) = stops.next_if(|stop| *stop < end) {
            if stop - begin > sliver && end - stop > sliver {
                parts.push((span, begin, stop));
                begin = stop;
            }
        }
        parts.push((span, begin, end));
    }
    let still = StillParts::of::<H, D>(curve);
    let mut part = 0;
    for (span, first, end) in parts {
        part += 1;
        let mut finer = 0;
        let mut rest = Vec::from([(computed::<H>(first), computed(end), 0)]);
        while let Some((begin, end, halvings)) = rest.pop() {
            let bezier = Bezier::of_span(curve, span, begin, end);
            let place = Place { curve: index, begin: begin.to_f64_pair(), end: end.to_f64_pair() };
            let (length, speed) = (bezier.polygon_mm(), hodograph::speed(&bezier.relative()));
            let is_even = speed.is_even(MAX_RATIO);
            if still.contain(length, is_even) {
                out.still.push(place);
                // The curve after a part that stands still does not continue the curve before it.
                part += 1;
                continue;
            }
            let is_small = length <= limits.length_mm && bezier.has_even_weights(MAX_RATIO);
            let is_finer = halvings >= MAX_HALVINGS;
            let may_be_halved =
                !is_finer || (is_small && halvings < MOST_HALVINGS && finer < MOST_FINER_HALVINGS);
            if !(is_small && is_even) && may_be_halved {
                finer += usize::from(is_finer);
                let middle = begin + (end - begin).half();
                rest.push((middle, end, halvings + 1));
                rest.push((begin, middle, halvings + 1));
                continue;
            }
            // If `H` cannot hold a number of the curve, that number may be this parameter.
            let parameter = if place.begin.0.is_finite() { place.begin.0 } else { first };
            let out_of_range = CompileError::SpeedOutOfRange { curve: index, parameter };
            if !bezier.is_finite() {
                return Err(out_of_range);
            }
            let piece = LocalPiece::new(&bezier, place, (index, part), halvings, speed)
                .ok_or(CompileError::OriginOutOfRange { curve: index })?;
            if !piece.is_finite() {
                return Err(out_of_range);
            }
            if piece.speed.least <= CUSP_RATIO * piece.speed.greatest {
                return Err(CompileError::Cusp { curve: index, parameter: place.begin.0 });
            }
            out.pieces.push(piece);
        }
    }
    Ok(())
}

/// The lengths up to which parts of a curve stand still. Where C' vanishes no step per chord exists, so such a part
/// becomes no piece: the next piece begins where the part ends.
#[derive(Clone, Copy)]
struct StillParts {
    /// An uneven part stands still if it is no longer than this, in mm.
    uneven_mm: f64,
    /// Any part stands still if it is no longer than this, in mm: it is due to rounding.
    rounding_mm: f64,
}

impl StillParts {
    /// Blossoming in p rounds is off by about p² units in the last place of the coordinates.
    fn of<H: Backend, const D: usize>(curve: &NurbsCurve<'_, f64, D>) -> Self {
        let farthest = curve.control_points().iter().flatten().fold(0.0_f64, |most, x| most.max(x.abs()));
        let rounding_mm = (farthest * H::resolution().to_f64()).ldexp(ROUNDING);
        Self { uneven_mm: rounding_mm.max(STILL_MM), rounding_mm }
    }

    /// Whether a part of the curve that is no longer than this stands still.
    fn contain(&self, length_mm: f64, is_even: bool) -> bool {
        length_mm <= if is_even { self.rounding_mm } else { self.uneven_mm }
    }
}
