//! Compiled pieces: a path as a table of short polynomials, which real time evaluates.
//!
//! A raw curve drowns a 32-bit format: the parameter increment is about 1e-4, second derivatives are about 3e4 and
//! their squares overflow. So the path is cut, before real time, into pieces short enough that every number a
//! step works with is of order one. On a piece, with the local parameter t in [0, 1),
//!
//! `C(t) = O + 2^e N(t)/W(t)`, `N(t) = Σ_{k≥1} n_k t^k`, `W(t) = Σ_{k≥0} w_k t^k`
//!
//! where O is the piece's first point, e its coordinate exponent (n_k are in units of 2^e mm) and W stays near 1. A
//! non-rational piece has W = 1 and stores no weights. N has no constant term, so a chord from t is formed without
//! subtracting two nearly equal points:
//!
//! `C(t+h) - C(t) = 2^e h Q(h)/W(t+h)`, `Q(h) = Σ_{k≥1} (c_k - P ω_k) h^{k-1}`
//!
//! with `c_k = N^{(k)}(t)/k!` and `ω_k = W^{(k)}(t)/k!`, the coefficients shifted to t, and `P = N(t)/W(t)`.
//!
//! The table is plain data in borrowed slices: on a controller it lies in flash.

use core::ops::Range;

use real::Real;

use crate::pieces::right_shifts::{RightShifts, lowered_or_kept};
use crate::pieces::shift::{divide_by_weight, fill, horner};
use crate::{MAX_DEGREE, ORIGIN_EXPONENT, Piece, Shifted, shift};

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

/// The coefficients of one piece.
#[derive(Clone, Copy, Debug)]
pub struct Coefficients<'a, R, const D: usize> {
    /// n_1 to n_p.
    numerator: &'a [[R; D]],
    /// If it is rational, w_0, and w_1 to w_p.
    weights: Option<(R, &'a [R])>,
}

impl<'a, R: Real, const D: usize> Pieces<'a, R, D> {
    /// Whether a point takes a division by a weight.
    #[must_use]
    pub fn is_rational(&self) -> bool {
        !self.weights.is_empty()
    }

    /// The path that consists of these pieces; it is empty if one of them does not exist.
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

    /// Whether a piece is straight and passed at constant speed: `n_k = 0` from k = 2 on, and `W = 1`. False for a piece that does not
    /// exist.
    #[must_use]
    pub fn is_straight(&self, piece: usize) -> bool {
        let Some(Coefficients { numerator, weights }) = self.coefficients::<MAX_DEGREE, false>(piece) else {
            return false;
        };
        let are_zero = |numbers: &[R]| numbers.iter().all(|x| x.is_zero());
        numerator.get(1..).is_some_and(|rows| are_zero(rows.as_flattened()))
            && weights.is_none_or(|(constant, rest)| constant == R::one() && are_zero(rest))
    }

    /// p. If N is p, the compiler knows the length of loops; if N is [`MAX_DEGREE`], p may be any degree.
    #[inline]
    fn count<const N: usize>(&self) -> usize {
        if N == MAX_DEGREE { self.degree.min(N) } else { N }
    }

    /// n_1 to n_p.
    #[inline]
    fn numerator<const N: usize>(&self, piece: usize) -> Option<&'a [[R; D]]> {
        if N < MAX_DEGREE {
            // Not a chunk by its number: how many there are would take a division.
            let begin = piece.wrapping_mul(N);
            return Some(self.numerators.get(begin..begin.checked_add(N)?)?.first_chunk::<N>()?);
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

    /// Converts an offset in the units of `piece` to the units of the path, `2^coordinate_exponent` mm.
    #[inline]
    #[must_use]
    pub fn in_common_units(&self, piece: usize, offset: &[R; D]) -> [R; D] {
        self.pieces.get(piece).map_or(*offset, |row| self.in_units_of_path(row, offset))
    }

    /// [`in_common_units`](Self::in_common_units) for a caller that has the piece's row.
    #[inline]
    #[must_use]
    pub fn in_units_of_path(&self, row: &Piece<R, D>, offset: &[R; D]) -> [R; D] {
        let units = self.exponent_to_path(row);
        // Not by `map`: it reads two numbers of 32 bits as one word, right after they were written one by one.
        let mut scaled = [R::zero(); D];
        fill(&mut scaled, offset.iter().map(|x| x.rescaled(units).signal("offset")));
        scaled
    }

    /// The exponent that converts an offset in the units of a piece to those of the path.
    #[inline]
    fn exponent_to_path(&self, row: &Piece<R, D>) -> i32 {
        i32::from(row.coordinate_exponent).wrapping_sub(self.coordinate_exponent)
    }

    /// The scalings of a step on the piece of this row, if all of them go to the right.
    #[must_use]
    #[inline]
    pub fn right_shifts(&self, row: &Piece<R, D>) -> Option<RightShifts> {
        let [variable, per_power] = [-i32::from(row.range_exponent), row.per_power()];
        let first = self.chord_exponents(row).next()?;
        RightShifts::of::<R>([variable, first, per_power, self.exponent_to_path(row)], self.degree)
    }

    /// A point in units of 2^[`ORIGIN_EXPONENT`] mm: the piece's origin plus an offset from it. The offset is in units
    /// of the path's `2^coordinate_exponent` mm, and is cut towards the origin to whole units. The sum is in integers
    /// of 64 bits, so that nothing is lost where the format itself cannot hold the path's extent.
    ///
    /// The end of the path has the number of pieces as its piece; the offset is then from the last piece's origin.
    /// Without pieces the point is 0. Domain: offsets of setpoints, which are above the format's least number. Offsets
    /// beyond 2²⁴ mm count as 2²⁴ mm, and sums beyond 2²⁴ mm wrap.
    #[must_use]
    pub fn position(&self, piece: usize, offset: &[R; D]) -> [i64; D] {
        let Some(row) = self.pieces.get(piece).or(self.pieces.last()) else { return [0; D] };
        let exponent = self.coordinate_exponent.wrapping_sub(ORIGIN_EXPONENT + 64);
        // In two parts where the exponent is outside to_phase's domain.
        let beyond = (-64_i32).wrapping_sub(exponent).max(0).unsigned_abs();
        let phase = |x: R| x.to_phase(exponent.clamp(-64, 64)).checked_shr(beyond).unwrap_or(0);
        let units = |x: R| i64::try_from(phase(x)).unwrap_or(i64::MAX);
        let signed = |x: R| if x < R::zero() { -units(-x) } else { units(x) };
        core::array::from_fn(|d| row.origin[d].wrapping_add(signed(offset[d])))
    }

    /// The piece's polynomials about `t`, which are all that a step from there needs.
    #[must_use]
    pub fn shifted(&self, piece: usize, t: R) -> Shifted<R, D> {
        let mut at = Shifted::default();
        self.shift_to::<MAX_DEGREE, false>(piece, t, &mut at);
        at
    }

    /// [`shift_to`](Self::shift_to) the piece's begin: its polynomials there are those of the table, and no product is needed.
    #[inline(never)] // Once for each form of a step, for whatever crosses joints.
    pub fn shift_to_begin<const N: usize, const PLAIN: bool>(&self, piece: usize, at: &mut Shifted<R, D>) {
        self.shift_anew::<N, PLAIN>(piece, None, at);
    }

    /// Writes the piece's polynomials about `t` into `at`, over those of another point or piece of the same path.
    ///
    /// N is the pieces' degree, which is fastest, or [`MAX_DEGREE`], which serves every degree. PLAIN promises that the
    /// path has no weights, which saves a test.
    pub fn shift_to<const N: usize, const PLAIN: bool>(&self, piece: usize, t: R, at: &mut Shifted<R, D>) {
        self.shift_anew::<N, PLAIN>(piece, Some(t), at);
    }

    /// The coefficients of a piece. N and PLAIN are those of [`shift_to`](Self::shift_to).
    #[inline(always)]
    #[must_use]
    pub fn coefficients<const N: usize, const PLAIN: bool>(
        &self,
        piece: usize,
    ) -> Option<Coefficients<'a, R, D>> {
        let numerator = self.numerator::<N>(piece)?;
        Some(Coefficients { numerator, weights: if PLAIN { None } else { self.weight::<N>(piece) } })
    }

    /// [`shift_to`](Self::shift_to) for a caller that has the piece's row, its coefficients and, unless N is [`MAX_DEGREE`], its
    /// scalings. Returns the point at t in the units of the path. KEEPS_TOP promises that `at` holds the polynomials about another
    /// point of this piece, and that it has no weights: its top coefficient stays.
    ///
    /// The coefficients are looked up before `t` is known: a question between `t` and its products would keep compilers from
    /// forming these as products of words.
    #[inline(always)] // Called, it would write its rows to memory in parts other than those in which they are read.
    pub fn shift_along<const N: usize, const KEEPS_TOP: bool>(
        &self,
        (row, shifts): (&Piece<R, D>, Option<RightShifts>),
        coefficients: &Coefficients<'_, R, D>,
        t: R,
        at: &mut Shifted<R, D>,
    ) -> [R; D] {
        self.shift_by::<N>((row, shifts), coefficients, Some(t), KEEPS_TOP, at);
        match shifts {
            Some(shifts) if N < MAX_DEGREE => shifts.in_units_of_path(&at.offset),
            _ => self.in_units_of_path(row, &at.offset),
        }
    }

    /// Writes the polynomials about `t`, or about the begin if `t` is `None`, into `at`, whatever `at` holds.
    #[inline(always)]
    fn shift_anew<const N: usize, const PLAIN: bool>(
        &self,
        piece: usize,
        t: Option<R>,
        at: &mut Shifted<R, D>,
    ) {
        match (self.pieces.get(piece), self.coefficients::<N, PLAIN>(piece)) {
            (Some(row), Some(coefficients)) => self.shift_by::<N>((row, None), &coefficients, t, false, at),
            _ => *at = Shifted::default(),
        }
    }

    /// `shift_anew` for a caller that has the piece's row and coefficients; `keeps_top` says that `at` has the top coefficient, which
    /// without weights is the same about all points of a piece. The compiler knows `keeps_top`, and whether there is a `t`, as constants.
    #[inline(always)]
    fn shift_by<const N: usize>(
        &self,
        (row, shifts): (&Piece<R, D>, Option<RightShifts>),
        coefficients: &Coefficients<'_, R, D>,
        t: Option<R>,
        keeps_top: bool,
        at: &mut Shifted<R, D>,
    ) {
        if N == MAX_DEGREE {
            // In place: on a controller, an array of its own would cost time for rows that the degree does not have.
            let chord = at.chord.get_mut(..coefficients.numerator.len()).unwrap_or_default();
            self.form::<N>((row, None), coefficients, t, &mut at.offset, chord, &mut at.weight);
            for (c, power) in chord.iter_mut().zip(self.chord_exponents(row)) {
                for x in c {
                    *x = x.rescaled(power).signal("chord_coefficient");
                }
            }
            return;
        }
        // A few rows fit registers, and are formed there.
        let mut rows = [[R::zero(); D]; N];
        self.form::<N>((row, shifts), coefficients, t, &mut at.offset, &mut rows, &mut at.weight);
        let changed = if keeps_top { rows.split_last().map_or(&rows[..], |(_, rest)| rest) } else { &rows };
        let mut slots = at.chord.iter_mut();
        if let Some(shifts) = shifts {
            let mut places = shifts.of_chord();
            for c in changed {
                let (Some(slots), Some(places)) = (slots.next(), places.next()) else { break };
                fill(slots, c.iter().map(|x| x.lowered(places).signal("chord_coefficient")));
            }
        } else {
            let mut powers = self.chord_exponents(row);
            for c in changed {
                let (Some(slots), Some(power)) = (slots.next(), powers.next()) else { break };
                fill(slots, c.iter().map(|x| x.rescaled(power).signal("chord_coefficient")));
            }
        }
    }

    /// Forms the polynomials about `t`, and the offset there, and writes them to the given slots. Those of the chord
    /// are in coordinate units.
    #[inline(always)] // Called, it would return its rows through memory: 13 % more instructions a step.
    fn form<const N: usize>(
        &self,
        (row, shifts): (&Piece<R, D>, Option<RightShifts>),
        coefficients: &Coefficients<'_, R, D>,
        t: Option<R>,
        offset: &mut [R; D],
        chord: &mut [[R; D]],
        weight: &mut [R; MAX_DEGREE],
    ) {
        for (k, slots) in chord.iter_mut().enumerate() {
            let Some(n) = coefficients.numerator.get(k) else { break };
            for d in 0..D {
                slots[d] = n[d].signal("coefficient");
            }
        }
        let value = t.map_or([R::zero(); D], |t| shift(chord, t));
        for d in 0..D {
            offset[d] = value[d].signal("offset");
        }
        if let Some((constant, weights)) = coefficients.weights {
            // On the way here compilers forget that there are N, and would take them one by one.
            let weights =
                if N < MAX_DEGREE { weights.first_chunk::<N>().map_or(weights, |w| w) } else { weights };
            let turns = divide_by_weight::<_, D, N>(constant, weights, t, offset, chord);
            let mut slots = weight.iter_mut().take(chord.len());
            if let Some(shifts) = shifts {
                let mut places = shifts.of_weights();
                for [w] in turns {
                    let (Some(slot), Some(places)) = (slots.next(), places.next()) else { break };
                    *slot = lowered_or_kept(w, places).signal("chord_weight");
                }
                return;
            }
            let per_power = row.per_power();
            let mut power = 0;
            for [w] in turns {
                let Some(slot) = slots.next() else { break };
                power += per_power;
                *slot = w.rescaled(power).signal("chord_weight");
            }
        }
    }

    /// For k from 1 on, the exponent that converts the coefficient of h^k in coordinate units to that of `η x^{k-1}` in
    /// chord units: `h^k = x^k 2^(k (r - s))`.
    #[inline(always)]
    fn chord_exponents(&self, row: &Piece<R, D>) -> impl Iterator<Item = i32> {
        let units = i32::from(row.coordinate_exponent) - i32::from(row.range_exponent);
        let (first, per_power) = (units.wrapping_add(self.chord_exponent), row.per_power());
        core::iter::successors(Some(first.wrapping_add(per_power)), move |power| {
            Some(power.wrapping_add(per_power))
        })
    }
}
