//! Compiled pieces that own their numbers.

use alloc::vec::Vec;

use real::{Backend, Real};

use crate::pieces::cut::{MAX_HALVINGS, SLIVER};
use crate::{Piece, Pieces, Place, SignalBound};

/// Compiled pieces with their storage, and the data that a tool needs to read their results.
#[derive(Clone, Debug)]
pub struct PiecesBuf<R, const D: usize> {
    pub(crate) pieces: Vec<Piece<R, D>>,
    pub(crate) numerators: Vec<[R; D]>,
    pub(crate) weights: Vec<R>,
    pub(crate) degree: usize,
    pub(crate) coordinate_exponent: i32,
    pub(crate) chord_exponent: i32,
    pub(crate) places: Vec<Place>,
    pub(crate) still: Vec<Place>,
    pub(crate) bounds: Vec<SignalBound>,
    pub(crate) step_mm: f64,
}

impl<R: Real, const D: usize> PiecesBuf<R, D> {
    /// The table that real time reads.
    #[must_use]
    pub fn as_pieces(&self) -> Pieces<'_, R, D> {
        Pieces {
            pieces: &self.pieces,
            numerators: &self.numerators,
            weights: &self.weights,
            degree: self.degree,
            coordinate_exponent: self.coordinate_exponent,
            chord_exponent: self.chord_exponent,
        }
    }

    /// Where each piece lies on the path.
    #[must_use]
    pub fn places(&self) -> &[Place] {
        &self.places
    }

    /// The parts of the path that are on no piece, in order, because the path stands still there: at a cusp, where
    /// control points coincide, or on a curve that is a point. No part is longer than 1e-9 mm, or than rounding. The
    /// next piece begins where the part ends.
    #[must_use]
    pub fn still_places(&self) -> &[Place] {
        &self.still
    }

    /// The number of the piece behind the joint at the parameter `u` of curve number `curve`. A piece, or a part that
    /// stands still, ends there, or a piece begins there. `None` where there is no joint. `u` may be off by rounding,
    /// 2⁻²⁴ of a piece.
    #[must_use]
    pub fn joint(&self, curve: usize, u: f64) -> Option<usize> {
        let is_near = |place: &Place, end: (f64, f64)| {
            place.curve == curve && beyond(end, u).abs() <= place.width().ldexp(SLIVER + MAX_HALVINGS)
        };
        let next = first_to_reach(&self.places, curve, u);
        let around = next.saturating_sub(1)..self.places.len().min(next + 2);
        let ends = |piece: &usize| is_near(&self.places[*piece], self.places[*piece].end);
        let begins = |piece: &usize| is_near(&self.places[*piece], self.places[*piece].begin);
        let after = around.clone().find(ends).map(|piece| piece + 1);
        after.or_else(|| around.clone().find(begins)).or_else(|| self.is_still(curve, u).then_some(next))
    }

    /// Whether the path stands still at the parameter `u` of this curve.
    fn is_still(&self, curve: usize, u: f64) -> bool {
        let part = self.still.get(first_to_reach(&self.still, curve, u));
        part.is_some_and(|place| place.curve == curve && beyond(place.begin, u) <= 0.0)
    }

    /// The longest chord of a period for which the bounds are proven, in mm:
    /// [`PieceLimits::step_mm`](crate::PieceLimits::step_mm).
    #[must_use]
    pub fn step_mm(&self) -> f64 {
        self.step_mm
    }

    /// The proven bounds, one for each signal.
    #[must_use]
    pub fn bounds(&self) -> &[SignalBound] {
        &self.bounds
    }
}

impl<R: Backend, const D: usize> PiecesBuf<R, D> {
    /// The format's resolution times this, in mm, is the resolution of the piece's coordinates. In fixed point it is
    /// the piece's unit, in which coordinates are of order one. In a float, whose digits do not depend on the unit, it
    /// is the largest of the axes' `Σ |n_k|`. 0 for a piece that does not exist.
    #[must_use]
    pub fn coordinate_size_mm(&self, piece: usize) -> f64 {
        let Some(row) = self.pieces.get(piece) else { return 0.0 };
        let numerator = self.numerators.iter().skip(piece * self.degree).take(self.degree);
        let sum = |d: usize| numerator.clone().map(|n| n[d].to_f64().abs()).sum::<f64>();
        let units = if R::IS_FLOATING { (0..D).map(sum).fold(0.0, f64::max) } else { 1.0 };
        units.ldexp(row.coordinate_exponent.into())
    }
}

/// How far a parameter, a sum of two floats, lies beyond another.
fn beyond((high, low): (f64, f64), u: f64) -> f64 {
    (high - u) + low
}

/// The index of the first of these places that reaches `u` of this curve: it ends there or beyond.
fn first_to_reach(places: &[Place], curve: usize, u: f64) -> usize {
    places
        .partition_point(|place| place.curve < curve || (place.curve == curve && beyond(place.end, u) < 0.0))
}
