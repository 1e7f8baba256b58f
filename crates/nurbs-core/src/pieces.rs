//! Compiled pieces: a path as a table of short polynomials, the form that real time evaluates.
//!
//! A raw curve drowns a 32-bit format: the parameter increment is about 1e-4, second derivatives are about 3e4 and
//! their squares overflow. So the path is cut, before real time, into pieces short enough that every number a
//! step works with is of order one. On a piece, with the local parameter t in [0, 1),
//!
//! `C(t) = O + 2^e N(t)/W(t)`, `N(t) = Σ_{k≥1} n_k t^k`, `W(t) = Σ_{k≥0} w_k t^k`
//!
//! where O is the piece's first point, e its coordinate exponent (n_k are in units of 2^e mm) and W stays near 1. A non-rational piece has W = 1 and stores no weights. N has no constant term, so a chord from t is formed
//! without subtracting two nearly equal points:
//!
//! `C(t+h) - C(t) = 2^e h Q(h)/W(t+h)`, `Q(h) = Σ_{k≥1} (c_k - P ω_k) h^{k-1}`
//!
//! with `c_k = N^{(k)}(t)/k!` and `ω_k = W^{(k)}(t)/k!`, the coefficients shifted to t, and `P = N(t)/W(t)`.
//!
//! The table is plain data in borrowed slices: on a controller it lies in flash.

use core::ops::Range;

use real::Real;

use crate::MAX_DEGREE;

/// Origins are in units of 2⁻³⁹ mm, which is 1.8e-12 mm: far below what a drive resolves, and with 64 bits a range of
/// ±2²⁴ mm, which is 16 km.
pub const ORIGIN_EXPONENT: i32 = -39;

/// One row of the table.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Piece<R, const D: usize> {
    /// O in units of 2^[`ORIGIN_EXPONENT`] mm: what the local offset is added to.
    pub origin: [i64; D],
    /// e: this piece's coefficients are in units of 2^e mm. A short piece has as many significant bits as a long one.
    pub coordinate_exponent: i32,
    /// s: the solver's step is `η = h·2^s`, of the order of the chord in its own scale.
    pub step_exponent: i32,
    /// 2^s, the step over the whole piece; the format's greatest number where that does not fit, for no step comes
    /// near it then.
    pub whole: R,
    /// r: the polynomials go by `x = η·2^-r`, which is of order one, so that the roundings of their coefficients are
    /// not magnified. Chords and steps reach up to 2^r, to use the format's integer bits, but where the piece is
    /// shorter than that, x = 1 is its whole length.
    pub range_exponent: i32,
    /// |C'| at the end of this piece over |C'| at the start of the next, in the solver's scales: by this a step
    /// per chord of this piece becomes one of the next. At most 1 in magnitude; `· 2^joint_exponent`.
    pub joint_ratio: R,
    /// Power of two that belongs to `joint_ratio`.
    pub joint_exponent: i32,
    /// Whether the next piece is the same polynomial further on, so that a step may pass the joint on this one.
    pub continues: bool,
    /// Least and greatest step per chord, in the solver's scale: what a trial is clamped to, and what the proof of
    /// the ranges rests on.
    pub step_per_chord: [R; 2],
}

/// A path of compiled pieces in the format `R`.
#[derive(Clone, Copy, Debug)]
pub struct Pieces<'a, R, const D: usize> {
    /// The rows.
    pub pieces: &'a [Piece<R, D>],
    /// n_1 to n_p of each piece, one after the other, in units of the piece's `2^coordinate_exponent` mm.
    pub numerators: &'a [[R; D]],
    /// w_0 to w_p of each piece, one after the other; empty for a path without rational pieces.
    pub weights: &'a [R],
    /// p, the same for all pieces: lower degrees are padded with zeros.
    pub degree: usize,
    /// The points given out are in units of 2^this mm: the greatest exponent of all pieces.
    pub coordinate_exponent: i32,
    /// λ: chords are in units of 2^-λ mm.
    pub chord_exponent: i32,
}

/// The coefficients of one piece, shifted to a parameter t.
#[derive(Clone, Copy, Debug)]
pub struct Shifted<R, const D: usize> {
    /// P: the point at t, as an offset from the piece's origin, in the piece's own units.
    pub offset: [R; D],
    /// The chord polynomial in the solver's scale, q̃_k for k = 1..=degree: the chord to t + h is
    /// `η Σ q̃_k x^{k-1}`, over `1 + Σ weight_k x^k` if rational.
    pub chord: [[R; D]; MAX_DEGREE],
    /// ω̃_k for k = 1..=degree; zeros if not rational.
    pub weight: [R; MAX_DEGREE],
}

impl<'a, R: Real, const D: usize> Pieces<'a, R, D> {
    /// Whether points take a division by a weight.
    #[must_use]
    pub fn is_rational(&self) -> bool {
        !self.weights.is_empty()
    }

    /// Some pieces of the path, as a path of their own; without those that do not exist.
    #[must_use]
    pub fn part(&self, pieces: Range<usize>) -> Self {
        let rows = |width: usize| pieces.start.saturating_mul(width)..pieces.end.saturating_mul(width);
        let coefficients = if self.is_rational() { self.degree.saturating_add(1) } else { 0 };
        Self {
            pieces: self.pieces.get(pieces.clone()).unwrap_or_default(),
            numerators: self.numerators.get(rows(self.degree)).unwrap_or_default(),
            weights: self.weights.get(rows(coefficients)).unwrap_or_default(),
            ..*self
        }
    }

    fn numerator(&self, piece: usize) -> &'a [[R; D]] {
        let first = piece.saturating_mul(self.degree);
        self.numerators.get(first..).and_then(|rest| rest.get(..self.degree)).unwrap_or(&[])
    }

    fn weight(&self, piece: usize) -> &'a [R] {
        let count = self.degree.saturating_add(1);
        let first = piece.saturating_mul(count);
        self.weights.get(first..).and_then(|rest| rest.get(..count)).unwrap_or(&[])
    }

    /// The point at the local parameter `t` of `piece`, as an offset from the piece's origin, in units of
    /// `2^coordinate_exponent` mm: a Horner chain a coordinate, and one reciprocal if rational. A piece that does
    /// not exist has the offset 0.
    #[must_use]
    pub fn offset(&self, piece: usize, t: R) -> [R; D] {
        let numerator = self.numerator(piece);
        let point = core::array::from_fn(|d| {
            numerator.iter().rev().fold(R::zero(), |sum, n| sum.mul_add(t, n[d].signal("coefficient"))) * t
        });
        let units =
            self.pieces.get(piece).map_or(0, |row| row.coordinate_exponent - self.coordinate_exponent);
        if !self.is_rational() {
            return point.map(|x: R| x.scale(units).signal("offset"));
        }
        let weight = self.weight(piece).iter().rev().fold(R::zero(), |sum, w| sum.mul_add(t, *w));
        let reciprocal = R::one() / weight.signal("weight");
        point.map(|x| (x * reciprocal).scale(units).signal("offset"))
    }

    /// The piece's polynomials about `t`: all that a step from there needs.
    #[must_use]
    pub fn shifted(&self, piece: usize, t: R) -> Shifted<R, D> {
        let mut chord = [[R::zero(); D]; MAX_DEGREE];
        let mut offset = [R::zero(); D];
        for (slot, n) in chord.iter_mut().zip(self.numerator(piece)) {
            *slot = n.map(|x| x.signal("coefficient"));
        }
        for d in 0..D {
            offset[d] = shift(first(&mut chord, self.degree), t, |row| &mut row[d]).signal("offset");
        }
        let mut weight = [R::zero(); MAX_DEGREE];
        if self.is_rational() {
            self.divide_by_weight(piece, t, &mut offset, &mut chord, &mut weight);
        }
        if let Some(row) = self.pieces.get(piece) {
            self.rescale(row, &mut chord, &mut weight);
        }
        Shifted { offset, chord, weight }
    }

    /// Turns N and its derivatives into P and the chord's numerator: `c_k - P ω_k`, all over W(t).
    fn divide_by_weight(
        &self,
        piece: usize,
        t: R,
        offset: &mut [R; D],
        chord: &mut [[R; D]; MAX_DEGREE],
        weight: &mut [R; MAX_DEGREE],
    ) {
        let [constant, rest @ ..] = self.weight(piece) else { return };
        for (slot, w) in weight.iter_mut().zip(rest) {
            *slot = *w;
        }
        let weight_at_t = (*constant + shift(first(weight, self.degree), t, |w| w)).signal("weight");
        let reciprocal = (R::one() / weight_at_t).signal("weight_reciprocal");
        *offset = offset.map(|x| (x * reciprocal).signal("offset"));
        for (c, w) in chord.iter_mut().zip(weight).take(self.degree) {
            *w = (*w * reciprocal).signal("weight_coefficient");
            for d in 0..D {
                c[d] = R::sum_of_products([(c[d], reciprocal), (-offset[d], *w)]);
            }
        }
    }

    /// Coefficients of powers of h in coordinate units → of `η x^{k-1}` in chord units, and of `x^k`.
    fn rescale(&self, row: &Piece<R, D>, chord: &mut [[R; D]; MAX_DEGREE], weight: &mut [R; MAX_DEGREE]) {
        let units = row.coordinate_exponent + self.chord_exponent - row.range_exponent;
        let mut power = 0;
        for (c, w) in chord.iter_mut().zip(weight).take(self.degree) {
            power += row.range_exponent - row.step_exponent; // h^k = x^k 2^(k (r - s))
            *c = c.map(|x| x.scale(units + power).signal("chord_coefficient"));
            if self.is_rational() {
                *w = w.scale(power).signal("chord_weight");
            }
        }
    }
}

/// The first `count` of the coefficients, or all.
fn first<T>(rows: &mut [T; MAX_DEGREE], count: usize) -> &mut [T] {
    &mut rows[..count.min(MAX_DEGREE)]
}

/// Shifts the polynomial `Σ_{k≥1} row_{k-1} x^k` to `t` in place, by repeated synthetic division; returns its value
/// at t. Afterwards `row_{k-1}` is the k-th derivative at t over k!. For degree p it takes p(p+1)/2 multiplications.
#[inline]
fn shift<R: Real, Row>(rows: &mut [Row], t: R, field: impl Fn(&mut Row) -> &mut R) -> R {
    let mut value = R::zero();
    for lowest in 0..=rows.len() {
        // Horner's scheme from the top coefficient down. The first sweep divides the polynomial with its constant
        // term 0, whose entry is `value`; each later one the quotient before it, and leaves one derivative.
        let mut quotient: Option<R> = None;
        for row in rows.iter_mut().skip(lowest.saturating_sub(1)).rev() {
            let entry = field(row);
            if let Some(above) = quotient {
                *entry = above.mul_add(t, *entry).signal("shifted_coefficient");
            }
            quotient = Some(*entry);
        }
        if let (0, Some(first)) = (lowest, quotient) {
            value = first * t;
        }
    }
    value
}
