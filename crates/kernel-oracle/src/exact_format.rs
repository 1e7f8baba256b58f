//! What a fixed-point format must make of an exact value, in integers of any size.
//!
//! Nothing here is shared with the crate that is judged: values are quotients of integers of `num-bigint`, and the
//! rules of rounding and overflow are those of the table at [`Real`](real::Real), written out once more.

use num_bigint::BigInt;
use num_traits::{Euclid, One, Signed, ToPrimitive, Zero};
use real::{Datapath, Overflow, Rounding};

/// A fixed-point format, as the integers that stand for its numbers.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub struct ExactFormat {
    /// W, in bits, the sign included; from 2 to 64.
    pub width: u32,
    /// f: a number is its integer times 2⁻ᶠ.
    pub fraction_bits: u32,
    /// How it rounds, and what it does on overflow.
    pub datapath: Datapath,
}

/// Where a tie goes with [`Rounding::Nearest`].
#[derive(Clone, Copy, PartialEq, Eq)]
enum Ties {
    Up,
    Away,
    Even,
}

/// `numerator / denominator`; the denominator is above 0.
pub(crate) struct Quotient {
    pub(crate) numerator: BigInt,
    pub(crate) denominator: BigInt,
}

impl Quotient {
    /// An integer.
    pub(crate) fn whole(value: impl Into<BigInt>) -> Self {
        Self { numerator: value.into(), denominator: BigInt::one() }
    }

    /// `value / 2^shift`; a shift below 0 goes to the left.
    pub(crate) fn shifted(value: BigInt, shift: i32) -> Self {
        match shift {
            0.. => Self { numerator: value, denominator: BigInt::one() << shift.unsigned_abs() },
            _ => Self::whole(value << shift.unsigned_abs()),
        }
    }

    /// The greatest integer that is not above this.
    pub(crate) fn floor(&self) -> BigInt {
        self.numerator.div_euclid(&self.denominator)
    }

    fn rounded(&self, rounding: Rounding, ties: Ties) -> BigInt {
        let floor = self.floor();
        let twice = (&self.numerator - &floor * &self.denominator) * 2_u32;
        let (is_exact, is_tie, is_above) =
            (twice.is_zero(), twice == self.denominator, twice > self.denominator);
        let is_odd = floor.bit(0);
        let up = match (rounding, ties) {
            (Rounding::Floor, _) => false,
            (Rounding::TowardZero, _) => !is_exact && self.numerator.is_negative(),
            (Rounding::NearestEven, _) | (_, Ties::Even) => is_above || (is_tie && is_odd),
            (Rounding::Nearest, Ties::Up) => is_above || is_tie,
            (Rounding::Nearest, Ties::Away) => is_above || (is_tie && self.numerator.is_positive()),
        };
        floor + u32::from(up)
    }
}

impl ExactFormat {
    /// The least integer of the format.
    #[must_use]
    pub fn least(&self) -> i64 {
        i64::MIN >> (64 - self.width)
    }

    /// The greatest integer of the format.
    #[must_use]
    pub fn greatest(&self) -> i64 {
        i64::MAX >> (64 - self.width)
    }

    /// The integer that the last W bits of `word` are.
    #[must_use]
    pub fn word(&self, word: i64) -> i64 {
        (word << (64 - self.width)) >> (64 - self.width)
    }

    /// A sum, a product or a shift, rounded to an integer and fitted: a tie goes up, and what does not fit wraps or saturates.
    pub(crate) fn fitted(&self, units: &Quotient) -> i64 {
        let rounded = units.rounded(self.datapath.rounding, Ties::Up);
        match self.datapath.overflow {
            Overflow::Saturate => self.saturated(&rounded),
            Overflow::Wrap => {
                let (range, least) = (BigInt::one() << self.width, BigInt::from(self.least()));
                (((rounded - &least).rem_euclid(&range)) + least).to_i64().unwrap_or(i64::MAX)
            }
        }
    }

    /// A quotient `n/d`: a tie goes away from zero, and what does not fit saturates. Over zero it is the extreme with
    /// the sign of `n`, and 0 where that is 0 too.
    pub(crate) fn quotient(&self, n: BigInt, d: BigInt) -> i64 {
        self.quotient_rounded(n, d, self.datapath.rounding)
    }

    /// The same for a constant, which goes to nearest in every format.
    pub(crate) fn ratio(&self, n: BigInt, d: BigInt) -> i64 {
        self.quotient_rounded(n, d, Rounding::Nearest)
    }

    fn quotient_rounded(&self, n: BigInt, d: BigInt, rounding: Rounding) -> i64 {
        if d.is_zero() {
            return self.saturated(&(n.signum() << 70));
        }
        let sign = d.signum();
        let quotient = Quotient { numerator: n * &sign, denominator: d * sign };
        self.saturated(&quotient.rounded(rounding, Ties::Away))
    }

    /// The root of an integer, which saturates. There are no ties, for `(k + ½)²` is no integer.
    pub(crate) fn root(&self, square: &BigInt) -> i64 {
        let floor = square.sqrt();
        let is_above_half = square > &(&floor * &floor + &floor);
        let nearest = matches!(self.datapath.rounding, Rounding::Nearest | Rounding::NearestEven);
        self.saturated(&(floor + u32::from(nearest && is_above_half)))
    }

    /// A value cut toward −∞, which saturates: what a phase becomes.
    pub(crate) fn cut(&self, units: &Quotient) -> i64 {
        self.saturated(&units.floor())
    }

    /// The integer nearest to a value, ties to even; `None` where it does not fit.
    pub(crate) fn nearest(&self, units: &Quotient) -> Option<i64> {
        let rounded = units.rounded(Rounding::NearestEven, Ties::Even).to_i64()?;
        (self.least()..=self.greatest()).contains(&rounded).then_some(rounded)
    }

    fn saturated(&self, units: &BigInt) -> i64 {
        let extreme = if units.is_negative() { self.least() } else { self.greatest() };
        units.to_i64().map_or(extreme, |units| units.clamp(self.least(), self.greatest()))
    }
}

/// A float as `integer · 2^exponent`; `None` unless it is finite.
pub(crate) fn parts_of_float(x: f64) -> Option<(BigInt, i32)> {
    if !x.is_finite() {
        return None;
    }
    let bits = x.to_bits();
    let biased = i32::try_from((bits >> 52) & 0x7ff).unwrap_or(0);
    let fraction = bits & ((1 << 52) - 1);
    let magnitude = BigInt::from(if biased == 0 { fraction } else { fraction | 1 << 52 });
    Some((if x.is_sign_negative() { -magnitude } else { magnitude }, biased.max(1) - 1075))
}
