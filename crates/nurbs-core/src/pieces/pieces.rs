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

/// How the path goes on at the end of a piece.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum Joint {
    /// The next piece is the same polynomial further on: a step passes the joint as if it were not there.
    Continues,
    /// Another polynomial follows in the same direction, or none: a step over the joint is one straight chord.
    Smooth,
    /// The tangent breaks ([`tangent_breaks`](crate::tangent_breaks)): a step goes on behind the corner by what is left of its
    /// length, as a chord of its own.
    Breaks,
}

/// One row of the table: 32 bytes in a 32-bit format in the plane, 48 in a 64-bit one in space.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Piece<R, const D: usize> {
    /// O in units of 2^[`ORIGIN_EXPONENT`] mm: what the local offset is added to.
    pub origin: [i64; D],
    /// e: this piece's coefficients are in units of 2^e mm. A short piece has as many significant bits as a long one. A
    /// float has those in any unit; its tables have those in which nothing needs scaling, e = -λ and s = r = 0, and a step
    /// relies on it.
    pub coordinate_exponent: i8,
    /// s: the solver's step is `η = h·2^s`, of the order of the chord in its own scale. At most 60 in magnitude.
    pub step_exponent: i8,
    /// r: the polynomials go by `x = η·2^-r`, which is of order one, so that the roundings of their coefficients are
    /// not magnified. Chords and steps reach up to 2^r, to use the format's integer bits, but where the piece is
    /// shorter than that, x = 1 is its whole length.
    pub range_exponent: i8,
    /// |C'| at the end of this piece over |C'| at the start of the next, in the solver's scales: by this a step
    /// per chord of this piece becomes one of the next. In units of 2⁻¹⁶ from ½ on, `· 2^joint_exponent`: it only starts
    /// the search for a chord, and where the next piece continues this one it is ½ exactly.
    pub joint_ratio: u16,
    /// Power of two that belongs to `joint_ratio`.
    pub joint_exponent: i8,
    /// How the path goes on at the piece's end.
    pub joint: Joint,
    /// Least and greatest step per chord, in the solver's scale: what a trial is clamped to, and what the proof of
    /// the ranges rests on.
    pub step_per_chord: [R; 2],
}

impl<R: Real, const D: usize> Piece<R, D> {
    /// 2^s, the step over the whole piece; the format's greatest number where that does not fit, for no step comes
    /// near it then.
    #[inline]
    #[must_use]
    pub fn whole(&self) -> R {
        if R::IS_FLOATING { R::one() } else { R::power_of_two(self.step_exponent.into()) }
    }

    /// [`joint_ratio`](Self::joint_ratio) as a number, below 1.
    #[inline]
    #[must_use]
    pub fn ratio_at_joint(&self) -> R {
        R::from_phase(u64::from(self.joint_ratio) << 48, 0)
    }

    /// r - s: how much larger the exponent of a power of h is than that of the one before.
    fn per_power(&self) -> i32 {
        i32::from(self.range_exponent) - i32::from(self.step_exponent)
    }

    /// A step as a part of the piece, in units of 2⁻⁶⁴; saturates.
    #[inline]
    #[must_use]
    pub fn part(&self, step: R) -> u64 {
        step.to_phase(if R::IS_FLOATING { 0 } else { -i32::from(self.step_exponent) })
    }
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

/// n_1 to n_p of one piece; w_0, and w_1 to w_p, if it is rational.
type Coefficients<'a, R, const D: usize> = (&'a [[R; D]], Option<(R, &'a [R])>);

/// The coefficients of one piece, shifted to a parameter t.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Shifted<R, const D: usize> {
    /// The chord polynomial in the solver's scale, q̃_k for k = 1..=degree: the chord to t + h is
    /// `η Σ q̃_k x^{k-1}`, over `1 + Σ weight_k x^k` if rational.
    pub chord: [[R; D]; MAX_DEGREE],
    /// ω̃_k for k = 1..=degree; zeros if not rational.
    pub weight: [R; MAX_DEGREE],
    /// P: the point at t, as an offset from the piece's origin, in the piece's own units.
    pub offset: [R; D],
}

impl<R: Real, const D: usize> Default for Shifted<R, D> {
    /// Of a piece that is a point.
    fn default() -> Self {
        let zero = R::zero();
        Self { offset: [zero; D], chord: [[zero; D]; MAX_DEGREE], weight: [zero; MAX_DEGREE] }
    }
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

    /// p, a constant where it is N: loops have a known length then. Where N is [`MAX_DEGREE`] p is any.
    #[inline]
    fn count<const N: usize>(&self) -> usize {
        if N == MAX_DEGREE { self.degree.min(N) } else { N }
    }

    /// n_1 to n_p.
    #[inline]
    fn numerator<const N: usize>(&self, piece: usize) -> Option<&'a [[R; D]]> {
        if N < MAX_DEGREE {
            return Some(self.numerators.as_chunks::<N>().0.get(piece)?);
        }
        let count = self.count::<N>();
        let begin = piece.wrapping_mul(count);
        self.numerators.get(begin..begin.checked_add(count)?)
    }

    /// w_0, and w_1 to w_p.
    #[inline]
    fn weight<const N: usize>(&self, piece: usize) -> Option<(R, &'a [R])> {
        let count = self.count::<N>();
        let begin = piece.wrapping_mul(count + 1);
        let (constant, rest) = self.weights.get(begin..begin.checked_add(count + 1)?)?.split_first()?;
        Some((*constant, rest))
    }

    /// The point at the local parameter `t` of `piece`, as an offset from the piece's origin, in units of
    /// `2^coordinate_exponent` mm: a Horner chain a coordinate, and one reciprocal if rational. A piece that does
    /// not exist has the offset 0.
    #[must_use]
    pub fn offset(&self, piece: usize, t: R) -> [R; D] {
        let rows = self.numerator::<MAX_DEGREE>(piece).unwrap_or_default().iter();
        let point = horner(rows.map(|n| n.map(|x| x.signal("coefficient"))), t).map(|x| x * t);
        let Some((constant, weights)) = self.weight::<MAX_DEGREE>(piece) else {
            return self.in_common_units(piece, &point);
        };
        let [weight] = horner(weights.iter().map(|w| [*w]), t);
        let reciprocal = R::one() / weight.mul_add(t, constant).signal("weight");
        self.in_common_units(piece, &point.map(|x| x * reciprocal))
    }

    /// An offset in the units of `piece` → in those of the path, `2^coordinate_exponent` mm.
    #[inline]
    #[must_use]
    pub fn in_common_units(&self, piece: usize, offset: &[R; D]) -> [R; D] {
        self.pieces.get(piece).map_or(*offset, |row| self.in_units_of_path(row, offset))
    }

    /// The same where the piece's row is known.
    #[inline]
    #[must_use]
    pub fn in_units_of_path(&self, row: &Piece<R, D>, offset: &[R; D]) -> [R; D] {
        let units = i32::from(row.coordinate_exponent).wrapping_sub(self.coordinate_exponent);
        // Not by `map`, which reads two numbers of 32 bits as one word, right after they were written one by one.
        core::array::from_fn(|d| offset[d].rescaled(units).signal("offset"))
    }

    /// A point in units of 2^[`ORIGIN_EXPONENT`] mm: the piece's origin, and an offset from it in units of the path's
    /// `2^coordinate_exponent` mm, cut towards the origin to whole units. Integers of 64 bits, so that nothing is lost where the
    /// format itself does not hold the path's extent.
    ///
    /// At the end of the path, where the piece's number is that of pieces, it is an offset from the last one; without pieces
    /// the point is 0. Domain: offsets of setpoints, which are above the format's least number; those beyond 2²⁴ mm count as
    /// that, and sums beyond it wrap.
    #[must_use]
    pub fn position(&self, piece: usize, offset: &[R; D]) -> [i64; D] {
        let Some(row) = self.pieces.get(piece).or(self.pieces.last()) else { return [0; D] };
        let exponent = self.coordinate_exponent.wrapping_sub(ORIGIN_EXPONENT + 64);
        // In two parts where it is out of to_phase's domain.
        let beyond = (-64_i32).wrapping_sub(exponent).max(0).unsigned_abs();
        let phase = |x: R| x.to_phase(exponent.clamp(-64, 64)).checked_shr(beyond).unwrap_or(0);
        let units = |x: R| i64::try_from(phase(x)).unwrap_or(i64::MAX);
        let signed = |x: R| if x < R::zero() { -units(-x) } else { units(x) };
        core::array::from_fn(|d| row.origin[d].wrapping_add(signed(offset[d])))
    }

    /// The piece's polynomials about `t`: all that a step from there needs.
    #[must_use]
    pub fn shifted(&self, piece: usize, t: R) -> Shifted<R, D> {
        let mut at = Shifted::default();
        self.shift_to::<MAX_DEGREE, false>(piece, t, &mut at);
        at
    }

    /// Those about the piece's begin, in place: there a polynomial is what it is, and no product is needed.
    #[inline(never)] // Once in a program, for whatever crosses joints.
    pub fn shift_to_begin(&self, piece: usize, at: &mut Shifted<R, D>) {
        self.shift_anew::<MAX_DEGREE, false>(piece, None, at);
    }

    /// Those about `t`, in place: what is known of another point or piece of the same path is overwritten.
    ///
    /// N is the pieces' degree, which is fastest, or [`MAX_DEGREE`], which serves all. PLAIN says that the path has no
    /// weights, which spares the question.
    pub fn shift_to<const N: usize, const PLAIN: bool>(&self, piece: usize, t: R, at: &mut Shifted<R, D>) {
        self.shift_anew::<N, PLAIN>(piece, Some(t), at);
    }

    /// The same where `at` holds those about another point of this piece, and the piece's row is known.
    #[inline(always)] // Called, it would leave its rows in memory, in other parts than they are read in.
    pub fn shift_along<const N: usize, const PLAIN: bool>(
        &self,
        (piece, row): (usize, &Piece<R, D>),
        t: R,
        at: &mut Shifted<R, D>,
    ) {
        self.shift_by::<N, PLAIN>((piece, row), Some(t), true, at);
    }

    /// To t, or with no t to the begin, whatever `at` holds.
    #[inline(always)]
    fn shift_anew<const N: usize, const PLAIN: bool>(
        &self,
        piece: usize,
        t: Option<R>,
        at: &mut Shifted<R, D>,
    ) {
        match self.pieces.get(piece) {
            Some(row) => self.shift_by::<N, PLAIN>((piece, row), t, false, at),
            None => *at = Shifted::default(),
        }
    }

    /// The same, or with no t to the begin; `is_along` says that `at` is of this piece. Which they are, the compiler knows.
    #[inline(always)]
    fn shift_by<const N: usize, const PLAIN: bool>(
        &self,
        (piece, row): (usize, &Piece<R, D>),
        t: Option<R>,
        is_along: bool,
        at: &mut Shifted<R, D>,
    ) {
        let Some(numerator) = self.numerator::<N>(piece) else {
            *at = Shifted::default();
            return;
        };
        let weights = if PLAIN { None } else { self.weight::<N>(piece) };
        if N == MAX_DEGREE {
            // In place: a controller would pay for rows that its degree does not have.
            let chord = at.chord.get_mut(..numerator.len()).unwrap_or_default();
            self.form::<N>(row, (numerator, weights), t, &mut at.offset, chord, &mut at.weight);
            for (c, power) in chord.iter_mut().zip(self.chord_exponents(row)) {
                for x in c {
                    *x = x.rescaled(power).signal("chord_coefficient");
                }
            }
            return;
        }
        // Few rows are formed in registers.
        let mut rows = [[R::zero(); D]; N];
        self.form::<N>(row, (numerator, weights), t, &mut at.offset, &mut rows, &mut at.weight);
        // Without weights the top coefficient is the same at all points.
        let changed =
            if PLAIN && is_along { rows.split_last().map_or(&rows[..], |(_, rest)| rest) } else { &rows };
        for ((slots, c), power) in at.chord.iter_mut().zip(changed).zip(self.chord_exponents(row)) {
            for (slot, x) in slots.iter_mut().zip(c) {
                *slot = x.rescaled(power).signal("chord_coefficient");
            }
        }
    }

    /// Forms the polynomials about `t`, and the offset there, in the slots for them: those of the chord in coordinate units.
    #[inline(always)] // Called, it would return its rows through memory: 13 % more instructions a step.
    fn form<const N: usize>(
        &self,
        row: &Piece<R, D>,
        (numerator, weights): Coefficients<'_, R, D>,
        t: Option<R>,
        offset: &mut [R; D],
        chord: &mut [[R; D]],
        weight: &mut [R; MAX_DEGREE],
    ) {
        for (slot, x) in chord.as_flattened_mut().iter_mut().zip(numerator.as_flattened()) {
            *slot = x.signal("coefficient");
        }
        let value = t.map_or([R::zero(); D], |t| shift(chord, t));
        for (slot, x) in offset.iter_mut().zip(value) {
            *slot = x.signal("offset");
        }
        if let Some((constant, weights)) = weights {
            let turns = divide_by_weight::<_, D, N>(constant, weights, t, offset, chord);
            let per_power = row.per_power();
            let mut power = 0;
            for (slot, w) in weight.iter_mut().zip(turns).take(chord.len()) {
                power += per_power;
                *slot = w.rescaled(power).signal("chord_weight");
            }
        }
    }

    /// Exponents that take coefficients of powers of h in coordinate units to those of `η x^{k-1}` in chord units, k from 1 on:
    /// `h^k = x^k 2^(k (r - s))`.
    #[inline(always)]
    fn chord_exponents(&self, row: &Piece<R, D>) -> impl Iterator<Item = i32> {
        let units = i32::from(row.coordinate_exponent) - i32::from(row.range_exponent);
        let (first, per_power) = (units.wrapping_add(self.chord_exponent), row.per_power());
        core::iter::successors(Some(first.wrapping_add(per_power)), move |power| {
            Some(power.wrapping_add(per_power))
        })
    }
}

/// Turns N and its derivatives into P and the chord's numerator: `c_k - P ω_k`, all over W(t). `weights` are those of
/// the piece without the constant one; returns `ω_k/W(t)`.
#[inline(always)] // Called, it takes a seventh longer in fixed point.
fn divide_by_weight<R: Real, const D: usize, const N: usize>(
    constant: R,
    weights: &[R],
    t: Option<R>,
    offset: &mut [R; D],
    chord: &mut [[R; D]],
) -> [R; N] {
    let mut turns = [[R::zero()]; N];
    for (slot, w) in turns.iter_mut().zip(weights) {
        *slot = [*w];
    }
    let rows = turns.get_mut(..weights.len()).unwrap_or_default();
    let [rise] = t.map_or([R::zero()], |t| shift(rows, t));
    let reciprocal = (R::one() / (constant + rise).signal("weight")).signal("weight_reciprocal");
    *offset = offset.map(|x| (x * reciprocal).signal("offset"));
    for (c, [turn]) in chord.iter_mut().zip(&mut turns).take(weights.len()) {
        *turn = (*turn * reciprocal).signal("weight_coefficient");
        for (x, p) in c.iter_mut().zip(&*offset) {
            *x = R::sum_of_products([(*x, reciprocal), (-*p, *turn)]);
        }
    }
    turns.map(|[turn]| turn)
}

/// `Σ_{k≥0} row_k t^k` by Horner's scheme, without a product for the top one.
#[inline]
fn horner<R: Real, const D: usize>(rows: impl DoubleEndedIterator<Item = [R; D]>, t: R) -> [R; D] {
    let mut rows = rows.rev();
    let top = rows.next().unwrap_or([R::zero(); D]);
    rows.fold(top, |sum, row| core::array::from_fn(|d| sum[d].mul_add(t, row[d])))
}

/// Shifts the polynomial `Σ_{k≥1} row_{k-1} x^k` to `t` in place, by repeated synthetic division; returns its value
/// at t. Afterwards `row_{k-1}` is the k-th derivative at t over k!. For degree p it takes p(p+1)/2 multiplications.
#[inline]
pub fn shift<R: Real, const D: usize>(rows: &mut [[R; D]], t: R) -> [R; D] {
    // The first sweep divides the polynomial with its constant term 0, whose entry is the value; each later one the
    // quotient before it, and leaves one derivative.
    let mut value = [R::zero(); D];
    divide(rows, t);
    for (x, first) in value.iter_mut().zip(rows.first().into_iter().flatten()) {
        *x = *first * t;
    }
    let mut rest = rows;
    while !rest.is_empty() {
        divide(rest, t);
        rest = rest.get_mut(1..).unwrap_or_default();
    }
    value
}

/// One sweep of Horner's scheme from the top coefficient down, which leaves its sums.
#[inline]
fn divide<R: Real, const D: usize>(rows: &mut [[R; D]], t: R) {
    let mut rows = rows.iter_mut().rev();
    let Some(mut above) = rows.next() else { return };
    for row in rows {
        for (x, more) in row.iter_mut().zip(above.iter()) {
            *x = more.mul_add(t, *x).signal("shifted_coefficient");
        }
        above = row;
    }
}
