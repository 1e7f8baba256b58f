//! The parameter increment of a chord on one compiled piece, without loss of digits.
//!
//! The step η is to make the chord L long. The chord from the present point is `η q(η)/w(η)`, known without
//! cancellation (see [`Pieces`](nurbs_core::Pieces)). The unknown is not η but the step per chord, `σ = η/L`, which is
//! of order one whatever the feed, and hardly changes from step to step. Its residual
//!
//! `f(σ) = |σ q|² - w²`, `q = q̃_1 + x(q̃_2 + x q̃_3 + …)`, `w = 1 + x(ω̃_1 + …)`, `x = 2^-r σL`
//!
//! is of order one too and takes neither a root nor a division. Its precision relative to the chord does not shrink
//! with the step. Its slope is `df/dσ = (2/σ)(1 + f + g)` with `g = σ² q·(x q') - w (x w') + w² - 1`, the growth of the
//! speed over the step. To second order in f and g the correction is
//!
//! `σ ← σ - σ f/2 (1 - g + g² - ¾f)`,
//!
//! again without a division. The chord that it leaves is off by
//!
//! `½ f (g³ + f (2g + h/8)) + O(f³)`
//!
//! of its length, where h is the second growth of the speed over the step, at most 1 on a piece. So a second evaluation
//! is needed only if |f| or |g| is above a threshold; [`ChordTolerance::for_fluctuation`] derives both from the
//! fluctuation that is allowed. Measured in f64 over ten curves of the tests, whose |g| is below a tenth:
//!
//! | fluctuation allowed | 1e-5 | 1e-6 | 1e-7 | 1e-8 | 1e-9 | 1e-11 |
//! |---|---|---|---|---|---|---|
//! | found, at most | 2.5e-7 | 3.2e-8 | 2.5e-9 | 6.6e-10 | 3.0e-10 | 7.6e-13 |
//! | evaluations | 1.00–1.03 | 1.00–1.06 | 1.00–1.12 | 1.01–1.36 | 1.17–1.62 | 1.55–2.13 |
//!
//! If a part b of the chord, in units of L, lies on pieces before this one, the rest of the chord is found in the same way.
//! Its length is that of the chord less that of b, `l L` with `l = 1 - |b|`, so the unknown is `τ = η/(l L)`, which is of order
//! one too: with `a = τ q/w` the whole chord is `e = b + l a`. Since `|b|² = (1 - l)²`, `|e|² - 1` is l times
//!
//! `f(τ) = b·a + e·a - 1 - |b|`,
//!
//! which again takes neither a root nor a division, and is not magnified where l is small. With the slope
//! `df/dτ = (2/τ)(1 + f/2 + g)`, `g = e·(x da/dx) + ½ l (|a|² - 1)`, the correction is
//!
//! `τ ← τ - τ f/2 (1 - g + g² - (½ - ¼l) f)`.
//!
//! Without b it is the correction above: l is 1 then, and this g is that one and ½f.

use nurbs_core::{MAX_DEGREE, Shifted};
use real::{Backend, Real};

use crate::pieces::terms::{Terms, vector};

/// The evaluations that each piece behind a joint may take whatever was used before: a step that looked for its end on the piece
/// before the joint has used all, and the first correction behind it may leave 1e-5 of a chord.
pub const BEHIND_JOINT: u32 = 2;

/// When the correction is repeated, and how often.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct ChordTolerance<R> {
    /// The largest |f|, at most ½, after which one correction is enough, provided that |g| is at most
    /// [`growth`](Self::growth).
    pub residual: R,
    /// The largest |g|, at most ⅜, at which one correction is enough.
    pub growth: R,
    /// The largest |f| after which one correction is enough whatever the growth.
    pub fluctuation: R,
    /// K: evaluations of f in a period, at most. All pieces that the period touches share them. Once they are used up, each
    /// piece behind a joint still takes up to [`BEHIND_JOINT`], so that a period takes at most K and so many for each joint that
    /// it crosses. The chord is then as long as the last correction leaves it.
    pub max_evaluations: u32,
}

impl<R: Backend> ChordTolerance<R> {
    /// The tolerance at which the last correction leaves at most this fluctuation ε, |1 - chord/L|, before roundings.
    /// `None`, or a fluctuation below the format's resolution, gives the resolution: roundings leave more.
    ///
    /// A correction leaves `½ |f| (|g|³ + |f| (2|g| + h/8))`. With |f| ≤ √ε and |g|³ ≤ √ε, that is at most
    /// `½ε (1 + 2|g| + h/8)`, below ε while |g| ≤ ⅜ and the second growth h is at most 1. A larger g asks for |f| ≤ ε, or
    /// two units of the resolution, which roundings alone may keep f at.
    /// The greatest g is the greatest power of two among those allowed, which every format holds exactly.
    #[must_use]
    pub fn for_fluctuation(fluctuation: Option<f64>, max_evaluations: u32) -> Self {
        let unit = R::resolution().to_f64();
        let wanted = fluctuation.map_or(unit, |wanted| wanted.max(unit));
        let of = |value: f64| R::from_f64(value).unwrap_or_else(R::one);
        let (largest, largest_growth) = Evaluation::<R>::limits();
        let root = Real::sqrt(wanted);
        // |g|³ falls by 8 with each halving of g.
        let halvings = (0..64).find(|k| root.ldexp(3 * k) >= 1.0).unwrap_or(64);
        Self {
            residual: of(root).min(largest),
            growth: R::one().ldexp(-halvings).min(largest_growth),
            fluctuation: of(wanted.max(2.0 * unit)).min(largest),
            max_evaluations,
        }
    }
}

/// A chord that is to end on a piece. N is the pieces' degree, so that loops have a known length, or [`MAX_DEGREE`] for
/// any degree. PLAIN says that W is 1, whatever `rational` says.
#[derive(Clone, Copy, Debug)]
pub struct Chord<'a, R, const D: usize, const N: usize = MAX_DEGREE, const PLAIN: bool = false> {
    /// The piece's polynomials about the point where the step on it begins.
    pub at: &'a Shifted<R, D>,
    /// p; read only if N is [`MAX_DEGREE`].
    pub degree: usize,
    /// Whether W is not 1.
    pub rational: bool,
    /// r: the polynomials take the step over 2^r.
    pub range_exponent: i32,
    /// The step over the whole piece. Beyond it the chord is assumed to grow in proportion to the step: the solver only
    /// has to learn that the root is beyond the piece, not where.
    pub whole: R,
    /// L, in chord units.
    pub length: R,
    /// The part of the chord on pieces before; `None` on the common path.
    pub before: Option<ChordBefore<R, D>>,
    /// Least and greatest σ.
    pub range: [R; 2],
}

/// The part of a chord that lies on pieces before the present one.
#[derive(Clone, Copy, Debug)]
pub struct ChordBefore<R, const D: usize> {
    /// b: that part over L, no longer than 1.
    pub part: [R; D],
    /// l = 1 - |b|, the length that is left, over L.
    pub left: R,
}

impl<R: Real, const D: usize> ChordBefore<R, D> {
    #[inline]
    pub(crate) fn new(part: [R; D]) -> Self {
        Self { part, left: R::one() - R::norm(&part) }
    }

    /// That of a chord which begins on the present piece.
    #[inline]
    pub(crate) fn nothing() -> Self {
        Self { part: [R::zero(); D], left: R::one() }
    }
}

/// The values of one evaluation: f and g.
#[derive(Clone, Copy)]
pub(crate) struct Evaluation<R> {
    pub(crate) residual: R,
    pub(crate) slope: R,
}

impl<R: Real> Evaluation<R> {
    /// f and g on one piece, from q, x q' and w; `lightening` are the products of g that a weight adds.
    #[inline(always)] // As the evaluation that it ends.
    pub(crate) fn new<const D: usize>(
        sigma: R,
        chord: &[R; D],
        turn: &[R; D],
        weight: R,
        lightening: Option<[(R, R); 3]>,
    ) -> Self {
        let mut along = *chord;
        for q in &mut along {
            *q = (sigma * *q).signal("chord_direction");
        }
        // The weight comes first. At the end, compilers would pair it with the last coordinate, and read that
        // coordinate's coefficient together with the next one before both are written.
        let square = |d: usize| along.get(d).map_or((R::zero(), R::zero()), |v| (*v, *v));
        let residual =
            R::sum_of_products(Terms::of(D, square).behind((-weight, weight))).signal("chord_residual");
        let growth = |d: usize| match (along.get(d), turn.get(d)) {
            (Some(along), Some(turn)) => (*along, (sigma * *turn).signal("chord_turn")),
            _ => (R::zero(), R::zero()),
        };
        let slope = match lightening {
            // By number: compilers leave a chain of iterators as a loop.
            Some(products) => R::sum_of_products(Terms::of(products.len() + D, |i| {
                products.get(i).copied().unwrap_or_else(|| growth(i - products.len()))
            })),
            None => R::sum_of_products(Terms::of(D, growth)),
        };
        Self { residual, slope: slope.signal("chord_growth") }
    }

    /// The largest |f| and |g| for which the series of the correction holds: ½ and ⅜.
    #[inline]
    fn limits() -> (R, R) {
        (R::from_ratio(1, 2), R::from_ratio(3, 8))
    }

    /// Whether |f| and |g| are at most these.
    #[inline]
    pub(crate) fn is_within(&self, residual: R, growth: R) -> bool {
        (self.residual.abs() <= residual) & (self.slope.abs() <= growth)
    }

    /// f and g limited to the range of the series, which keeps the factor below 2 and the correction below σ/2.
    #[inline]
    fn limited(&self) -> Self {
        let (largest, largest_growth) = Self::limits();
        Self {
            residual: self.residual.max(-largest).min(largest),
            slope: self.slope.max(-largest_growth).min(largest_growth),
        }
    }
}

impl<R: Real, const D: usize, const N: usize, const PLAIN: bool> Chord<'_, R, D, N, PLAIN> {
    /// The number of coefficients: a constant unless N is [`MAX_DEGREE`].
    #[inline]
    fn count(&self) -> usize {
        if N < MAX_DEGREE { N } else { self.degree.min(N) }
    }

    #[inline]
    fn is_rational(&self) -> bool {
        !PLAIN && self.rational
    }

    /// σ, if one evaluation at a start value, whose step is x and no longer than the whole piece, and one correction are enough;
    /// otherwise the evaluation. In fixed point the start value lies in the range, and so does σ. f and g are so small in the first
    /// case that they need no limits. The result is the same as that of [`refine`](Self::refine), and is found sooner.
    #[inline(always)]
    pub(crate) fn correct(&self, sigma: R, x: R, tolerance: &ChordTolerance<R>) -> Result<R, Evaluation<R>> {
        let value = self.evaluate(sigma, x);
        if value.is_within(tolerance.residual, tolerance.growth) {
            let part = correction(sigma, &value, R::from_ratio(3, 4));
            if let Some(found) = difference_within(sigma, part, &self.range) {
                return Ok(found.signal("step_per_chord"));
            }
        }
        Err(value)
    }

    /// Solves for σ from the start value `sigma`, which lies in the range; returns it with the evaluations made.
    #[must_use]
    pub fn solve(&self, sigma: R, tolerance: &ChordTolerance<R>) -> (R, u32) {
        self.solve_within((sigma, self.step(sigma)), tolerance, tolerance.max_evaluations)
    }

    /// [`solve`](Self::solve) from a start value and its step, by at most so many evaluations, and at least one.
    pub(crate) fn solve_within(
        &self,
        (sigma, step): (R, R),
        tolerance: &ChordTolerance<R>,
        most: u32,
    ) -> (R, u32) {
        self.refine(sigma, self.evaluate_aside(sigma, step), tolerance, most)
    }

    /// [`solve_within`](Self::solve_within) with a given evaluation of the chord at `sigma`.
    pub(crate) fn refine(
        &self,
        mut sigma: R,
        mut value: Evaluation<R>,
        tolerance: &ChordTolerance<R>,
        most: u32,
    ) -> (R, u32) {
        let mut evaluations = 1;
        loop {
            // The tolerance allows no more than the range of the series: see its fields.
            let is_small = value.is_within(tolerance.residual, tolerance.growth);
            let limited = if is_small { value } else { value.limited() };
            let trial = sigma;
            sigma = self.next(trial, correction(trial, &limited, self.curvature()));
            let is_enough = is_small || value.residual.abs() <= tolerance.fluctuation;
            if is_enough || sigma == trial || evaluations >= most {
                return (sigma, evaluations);
            }
            evaluations += 1;
            value = self.evaluate_aside(sigma, self.step(sigma));
        }
    }

    /// The factor of f in the series of the correction: ¾ where the chord begins on this piece, else ½ - ¼l.
    #[inline]
    fn curvature(&self) -> R {
        match &self.before {
            None => R::from_ratio(3, 4),
            Some(before) => R::one().half() - before.left.half().half(),
        }
    }

    /// The step of a trial: of the whole chord, or of what is left of it.
    #[inline]
    pub(crate) fn step(&self, sigma: R) -> R {
        self.of_whole(sigma) * self.length
    }

    /// σ of a trial: the step over the length of the whole chord.
    #[inline]
    pub(crate) fn of_whole(&self, trial: R) -> R {
        match &self.before {
            None => trial,
            Some(before) => (trial * before.left).min(self.range[1]),
        }
    }

    /// Least and greatest trial. Where the chord turns at the joint, its rest is longer than what b leaves of its length: by half
    /// of that at most where it turns by up to 48°.
    #[inline]
    fn trials(&self) -> [R; 2] {
        let [least, greatest] = self.range;
        match &self.before {
            None => [least, greatest],
            Some(_) => [least, sum_within(greatest, greatest.half(), R::max_value())],
        }
    }

    /// The next trial, in the range.
    #[inline]
    fn next(&self, sigma: R, correction: R) -> R {
        let name = if self.before.is_some() { "joint_step_per_chord" } else { "step_per_chord" };
        (sigma - within(correction, sigma, &self.trials())).signal(name)
    }

    /// The evaluation in the rare case that a second one is needed; compiled once.
    #[inline(never)]
    fn evaluate_aside(&self, sigma: R, step: R) -> Evaluation<R> {
        self.evaluate(sigma, self.variable(step.signal("step").min(self.whole)))
    }

    /// x, the step over 2^r.
    #[inline]
    pub(crate) fn variable(&self, step: R) -> R {
        step.rescaled(-self.range_exponent).signal("chord_variable")
    }

    #[inline(always)] // Called by the common step, it would take what it needs through memory.
    fn evaluate(&self, sigma: R, x: R) -> Evaluation<R> {
        let (chord, turn) = self.chord_per_step(x);
        let (weight, weight_slope) = if self.is_rational() { self.weight(x) } else { (R::one(), R::zero()) };
        if let Some(before) = &self.before {
            return self.evaluate_past_joint(sigma, before, (&chord, &turn), (weight, weight_slope * x));
        }
        let products = self.is_rational().then(|| lightening(weight, weight_slope * x));
        Evaluation::new(sigma, &chord, &turn, weight, products)
    }

    /// f and g where a part of the chord lies on pieces before, from q, x q', w and x w'. It takes a division if rational.
    fn evaluate_past_joint(
        &self,
        sigma: R,
        before: &ChordBefore<R, D>,
        (chord, turn): (&[R; D], &[R; D]),
        (weight, weight_turn): (R, R),
    ) -> Evaluation<R> {
        let (mut chord, mut turn) = (*chord, *turn);
        if self.is_rational() {
            let reciprocal = R::one() / weight;
            chord = vector(|d| chord[d] * reciprocal);
            turn = vector(|d| (turn[d] - chord[d] * weight_turn) * reciprocal);
        }
        let chord: [R; D] = vector(|d| chord[d].signal("joint_pull"));
        // In fixed point, half of a and of e, a quarter of f and of g: so that no trial needs more integer bits than the chord does.
        let unit = halved_for_room(R::one());
        let (trial, of_chord) = (halved_for_room(sigma), halved_for_room(self.of_whole(sigma)));
        let pull = |d: usize| {
            let pull = (trial * turn[d]).signal("joint_pull");
            // Weights that fall can make any of it, and more is beyond the range of the series.
            if self.is_rational() { pull.max(-unit).min(unit) } else { pull }
        };
        let along: [R; D] = vector(|d| (trial * chord[d]).signal("joint_direction"));
        let whole: [R; D] = vector(|d| {
            R::sum_of_products([(of_chord, chord[d]), (unit, before.part[d])]).signal("joint_direction")
        });
        // Where a points back against b, the chord is too short without b too.
        let on_before =
            halved_for_room(R::sum_of_products(Terms::of(D, |d| (before.part[d], along[d]))).max(R::zero()));
        let on_whole = R::sum_of_products(Terms::of(D, |d| (whole[d], along[d])));
        let growth = R::sum_of_products(Terms::of(D, |d| (whole[d], pull(d))));
        let left = halved_for_room(halved_for_room(before.left));
        let two = halved_for_room(unit + unit);
        let residual = on_before - two + left + on_whole;
        let lengthening = (on_whole - on_before - left).signal("joint_growth");
        let slope = growth + lengthening.half();
        Evaluation {
            residual: from_quarters(residual.signal("joint_residual")),
            slope: from_quarters(slope.signal("joint_growth")),
        }
    }

    /// q and x q' at the trial step.
    #[inline(always)] // As the evaluation that it is a part of.
    fn chord_per_step(&self, x: R) -> ([R; D], [R; D]) {
        let (chord, mut turn) =
            value_and_slope(self.at.chord.iter().take(self.count()), x, ["chord_per_step", "chord_turn"]);
        for t in &mut turn {
            *t = *t * x;
        }
        (chord, turn)
    }

    /// W and dW/dx at the trial step, over W at the present point.
    #[inline]
    fn weight(&self, x: R) -> (R, R) {
        weight_and_slope(self.at.weight.as_chunks::<1>().0.iter().take(self.count()), x)
    }

    /// The chord over the step η, in chord units.
    #[must_use]
    pub fn over(&self, step: R) -> [R; D] {
        self.over_length(step, step)
    }

    /// The chord over the step η, over a length. `part` is η over that length.
    #[inline]
    pub(crate) fn over_length(&self, step: R, part: R) -> [R; D] {
        let x = self.variable(step);
        let mut rows = self.at.chord.iter().take(self.count()).rev();
        let mut chord = *rows.next().unwrap_or(&[R::zero(); D]);
        for row in rows {
            chord = vector(|d| chord[d].mul_add(x, row[d]).signal("chord_per_step"));
        }
        let chord = vector(|d| (chord[d] * part).signal("chord_travelled"));
        if !self.is_rational() {
            return chord;
        }
        let (weight, _) = self.weight(x);
        vector(|d| chord[d] / weight)
    }
}

/// `Σ row_k x^k` and its derivative by x, by one chain without products for the top coefficient. The signals' names
/// stand for both results and for all intermediates.
#[inline(always)] // Called, it would return its rows through memory: a tenth of the step in fixed point.
pub(crate) fn value_and_slope<'a, R: Real + 'a, const M: usize>(
    rows: impl DoubleEndedIterator<Item = &'a [R; M]>,
    x: R,
    [name, slope_name]: [&'static str; 2],
) -> ([R; M], [R; M]) {
    let mut rows = rows.rev();
    let (mut values, mut slopes) = ([R::zero(); M], [R::zero(); M]);
    let Some(top) = rows.next() else { return (values, slopes) };
    let Some(next) = rows.next() else {
        for (d, value) in values.iter_mut().enumerate() {
            *value = top[d].signal(name);
        }
        return (values, slopes);
    };
    // By number: a `zip` is a function to call where a crate is compiled in several units.
    for d in 0..M {
        slopes[d] = top[d].signal(slope_name);
        values[d] = top[d].mul_add(x, next[d]).signal(name);
    }
    for row in rows {
        for d in 0..M {
            slopes[d] = slopes[d].mul_add(x, values[d]).signal(slope_name);
            values[d] = values[d].mul_add(x, row[d]).signal(name);
        }
    }
    (values, slopes)
}

/// W and dW/dx over W at the present point, from rows of one number each: ω̃_1, ω̃_2, ….
#[inline(always)] // As the evaluation that it is a part of.
pub(crate) fn weight_and_slope<'a, R: Real + 'a>(
    rows: impl DoubleEndedIterator<Item = &'a [R; 1]>,
    x: R,
) -> (R, R) {
    let ([value], [turn]) = value_and_slope(rows, x, ["chord_weight"; 2]);
    // value = ω̃_1 + ω̃_2 x + …, so W = 1 + x value and W' = value + x·(its derivative).
    (value.mul_add(x, R::one()), turn.mul_add(x, value).signal("chord_weight"))
}

/// The products of g that a weight w adds, from w and x w'.
#[inline(always)] // As the evaluation that it is a part of.
pub(crate) fn lightening<R: Real>(weight: R, weight_turn: R) -> [(R, R); 3] {
    [(-weight, weight_turn), (weight, weight), (-R::one(), R::one())]
}

/// `σ f/2 (1 - g + g² - c f)`, c being the curvature; f and g are limited already.
#[inline(always)]
pub(crate) fn correction<R: Real>(sigma: R, value: &Evaluation<R>, curvature: R) -> R {
    let (f, g) = (value.residual, value.slope);
    let one = R::one();
    let series = if R::IS_FLOATING {
        one - g + g * g - curvature * f
    } else {
        // Both products are rounded once.
        one - g + R::sum_of_products([(g, g), (-f, curvature)])
    };
    sigma.half() * f * series
}

/// `sigma - part` if that lies in the range. In a float, which holds σ beyond the range too, it always counts as found.
///
/// In fixed point σ is positive. A difference that does not fit wraps to a negative number, which is in no range.
/// Wrappers that watch for overflow compare before they subtract, so that they do not report this wrap as a fault.
#[inline]
pub(crate) fn difference_within<R: Real>(sigma: R, part: R, range: &[R; 2]) -> Option<R> {
    if R::IS_FLOATING {
        return Some(sigma - part);
    }
    if R::IS_FOR_SPEED {
        return Some(sigma - part).filter(|rest| is_within(*rest, range));
    }
    (sigma - range[1] <= part && part <= sigma - range[0]).then(|| sigma - part)
}

/// Whether a step per chord is in a piece's range.
#[inline]
pub(crate) fn is_within<R: Real>(sigma: R, range: &[R; 2]) -> bool {
    (range[0] <= sigma) & (sigma <= range[1])
}

/// `correction`, cut so that σ stays in its range: the uncut trial might not fit the format. A NaN leads to the lower
/// end of the range.
#[inline]
pub(crate) fn within<R: Real>(correction: R, sigma: R, range: &[R; 2]) -> R {
    (sigma - range[0]).min(correction).max(sigma - range[1])
}

/// Half of a number of fixed point, for room. A float has the room: its half would have the same digits.
#[inline]
fn halved_for_room<R: Real>(value: R) -> R {
    if R::IS_FLOATING { value } else { value.half() }
}

/// Four times a value that was [halved](halved_for_room) twice, limited to 1; a float was not halved.
#[inline]
fn from_quarters<R: Real>(value: R) -> R {
    if R::IS_FLOATING {
        return value;
    }
    let most = R::from_ratio(1, 4);
    value.max(-most).min(most).ldexp(2)
}

/// `part + more`, limited to `greatest`; `part` is not above that.
#[inline]
pub(crate) fn sum_within<R: Real>(part: R, more: R, greatest: R) -> R {
    part + more.min(greatest - part)
}

#[cfg(test)]
mod tests {
    use super::*;

    /// On `q = 1 + cσ`, whose root is known in closed form, with trials off by up to a tenth.
    #[test]
    fn one_correction_leaves_what_the_series_says() {
        // Half of (9/4 |f| |g| + 5/8 f² + |g|³) |f| and terms of higher order, for |g| up to an eighth.
        for growth in [-0.1, -0.05, 0.0, 0.02, 0.1] {
            let root = 2.0 / (1.0 + f64::sqrt(1.0 + 4.0 * growth));
            for off in [-0.1, -0.02, -1e-3, 1e-3, 0.01, 0.1] {
                let sigma = root * (1.0 + off);
                let value = Evaluation::new(sigma, &[1.0 + growth * sigma], &[growth * sigma], 1.0, None);
                let (f, g) = (value.residual.abs(), value.slope.abs());
                let left = ((sigma - correction(sigma, &value, 0.75)) / root - 1.0).abs();
                let bound = f * (f * (f + g) + g.powi(3));
                assert!(left <= 1.25 * bound + 1e-15, "{growth} {off}: {left} of {bound}");
            }
        }
    }

    /// Chords that turn by up to half a radian and grow by up to a half over the step, from guesses off by up to a
    /// third; most of them begin on a piece before, at an angle. The range is as that of a piece: at its greatest σ a chord is at
    /// least half as long as anywhere on it.
    #[test]
    fn the_chord_found_is_off_by_at_most_the_fluctuation_asked_for() {
        let parts = [-0.15, -0.05, 0.0, 0.01, 0.1, 0.3];
        let bends = parts.iter().flat_map(|along| parts.map(|across| (*along, across)));
        let paths =
            bends.flat_map(|bend| [None, Some([0.4, 0.1]), Some([0.7, -0.5])].map(|before| (bend, before)));
        for ((along, across), before) in paths {
            let mut at = Shifted::<f64, 2>::default();
            at.chord[..3].copy_from_slice(&[[1.0, 0.0], [along, across], [0.1 * across, -0.2 * along]]);
            let chord: Chord<'_, f64, 2> = Chord {
                at: &at,
                degree: 3,
                rational: false,
                range_exponent: 0,
                whole: 4.0,
                length: 1.0,
                before: before.map(|part: [f64; 2]| ChordBefore { part, left: 1.0 - part[0].hypot(part[1]) }),
                range: [0.1, 2.0],
            };
            for (allowed, guess) in
                [1e-3, 1e-6, 1e-8, 1e-10].iter().flat_map(|a| [0.7, 0.95, 1.3].map(|g| (*a, g)))
            {
                let (sigma, _) = chord.solve(guess, &ChordTolerance::for_fluctuation(Some(allowed), 20));
                let ([x, y], [bx, by]) = (chord.over(chord.step(sigma)), before.unwrap_or_default());
                let off = ((x + bx).hypot(y + by) - 1.0).abs();
                assert!(off <= allowed, "{along} {across} {before:?} {guess}: {off:e} of {allowed:e}");
            }
        }
    }
}
