//! The polynomials of a piece about another parameter, at which a step begins.

use real::Real;

use crate::MAX_DEGREE;

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
    /// The polynomials of a piece that is a point.
    fn default() -> Self {
        let zero = R::zero();
        Self { offset: [zero; D], chord: [[zero; D]; MAX_DEGREE], weight: [zero; MAX_DEGREE] }
    }
}

/// Turns N and its derivatives into P and the chord's numerator: `c_k - P ω_k`, all over W(t). `weights` are those of
/// the piece without the constant one; returns `ω_k/W(t)`, each as a row of one.
#[inline(always)] // Called, it takes a seventh longer in fixed point.
pub fn divide_by_weight<R: Real, const D: usize, const N: usize>(
    constant: R,
    weights: &[R],
    t: Option<R>,
    offset: &mut [R; D],
    chord: &mut [[R; D]],
) -> [[R; 1]; N] {
    let mut turns = [[R::zero()]; N];
    fill(&mut turns, weights.iter().map(|w| [*w]));
    let rows = turns.get_mut(..weights.len()).unwrap_or_default();
    let [rise] = t.map_or([R::zero()], |t| shift(rows, t));
    let reciprocal = (R::one() / (constant + rise).signal("weight")).signal("weight_reciprocal");
    for x in &mut *offset {
        *x = (*x * reciprocal).signal("offset");
    }
    let mut rows = chord.iter_mut().take(weights.len());
    for [turn] in &mut turns {
        let Some(c) = rows.next() else { break };
        *turn = (*turn * reciprocal).signal("weight_coefficient");
        for (d, x) in c.iter_mut().enumerate() {
            *x = R::sum_of_products([(*x, reciprocal), (-offset[d], *turn)]);
        }
    }
    turns
}

/// Puts values into slots, as many as there are of both.
///
/// For what a step does. `zip`, `array::map` and `array::from_fn` would be shorter, but parts of them are marked as
/// functions to call: where a crate is compiled in several units, without optimisation over units, a step calls them
/// number by number and passes its numbers through memory.
#[inline(always)]
pub(crate) fn fill<T>(slots: &mut [T], mut values: impl Iterator<Item = T>) {
    for slot in slots {
        let Some(value) = values.next() else { break };
        *slot = value;
    }
}

/// `Σ_{k≥0} row_k t^k` by Horner's scheme, without a product for the top row.
#[inline]
pub(crate) fn horner<R: Real, const D: usize>(rows: impl DoubleEndedIterator<Item = [R; D]>, t: R) -> [R; D] {
    let mut rows = rows.rev();
    let top = rows.next().unwrap_or([R::zero(); D]);
    rows.fold(top, |sum, row| core::array::from_fn(|d| sum[d].mul_add(t, row[d])))
}

/// Shifts the polynomial `Σ_{k≥1} row_{k-1} x^k` to `t` in place, by repeated synthetic division; returns its value
/// at t. Afterwards `row_{k-1}` is the k-th derivative at t over k!. For degree p it takes p(p+1)/2 multiplications.
#[inline(always)] // Called, it would take its rows through memory.
pub fn shift<R: Real, const D: usize>(rows: &mut [[R; D]], t: R) -> [R; D] {
    // The first sweep divides the polynomial with the constant term 0, and that entry becomes the value. Each later
    // sweep divides the quotient before it and leaves one derivative.
    let mut value = [R::zero(); D];
    divide(rows, t);
    if let Some(first) = rows.first() {
        for d in 0..D {
            value[d] = first[d] * t;
        }
    }
    let mut rest = rows;
    while !rest.is_empty() {
        divide(rest, t);
        rest = rest.get_mut(1..).unwrap_or_default();
    }
    value
}

/// One sweep of Horner's scheme from the top coefficient down; each entry becomes the sum so far.
#[inline(always)]
fn divide<R: Real, const D: usize>(rows: &mut [[R; D]], t: R) {
    let mut rows = rows.iter_mut().rev();
    let Some(mut above) = rows.next() else { return };
    for row in rows {
        for (d, x) in row.iter_mut().enumerate() {
            *x = above[d].mul_add(t, *x).signal("shifted_coefficient");
        }
        above = row;
    }
}
