//! How the feed goes from one value to the next: a curve from (0, 0) to (1, 1).
//!
//! Over a piece of duration t₂ the feed is `V(t) = V_s + (V_e - V_s) g(x)`, `x = t/t₂`. The acceleration is then
//! `(V_e - V_s)/t₂ · g'(x)`, the jerk `(V_e - V_s)/t₂² · g''(x)`, the distance `t₂ (V_s x + (V_e - V_s) G(x))`, G the integral
//! of g from 0. Everything is computed from x in [0, 1]: coefficients of powers of t span many orders of magnitude.
//!
//! | shape | g | g' | g'' | G | peak g' | peak g'' |
//! |---|---|---|---|---|---|---|
//! | cubic | 3x² - 2x³ | 6x(1 - x) | 6(1 - 2x) | x³ - x⁴/2 | 3/2 | 6 |
//! | onset | x² | 2x | 2 | x³/3 | 2 | 2 |
//! | steady | x | 1 | 0 | x²/2 | 1 | 0 |
//! | easing | 2x - x² | 2(1 - x) | -2 | x² - x³/3 | 2 | 2 |
//! | bent by b | x + b x(1 - x) | 1 + b (1 - 2x) | -2b | x²/2 + b (x²/2 - x³/3) | 1 + \|b\| | 2\|b\| |
//! | cosine | (1 - cos πx)/2 | π/2 sin πx | π²/2 cos πx | x/2 - sin(πx)/(2π) | π/2 | π²/2 |
//!
//! The shape bent by b, with b from -1 to 1, has constant jerk between any two accelerations of one sign, `1 + b` and `1 - b` times
//! the mean one: onset at -1, steady at 0, easing at 1. Since b is a ratio, a plan that is stretched in time keeps it.
//!
//! What real time needs is the mean of g over an interval of width w about m, which must not be a difference of two
//! nearly equal values of G. For a polynomial of degree 3 it is `g(m) + g''(m) w²/24`, exactly: for the bent
//! shape `m + b (m(1 - m) - w²/12)`. For the cosine it is
//!
//! `(1 - cos(πm) sinc(πw/2))/2 = S² + (C² - S²) (1 - sinc(πw/2))/2`, with `S = sin(πm/2)`, `C = cos(πm/2)`, `sinc z = sin z / z`,
//!
//! and `1 - sinc z = z²/6 (1 - z²/20 (1 - z²/42 …))` has no cancellation either.

use real::{Real, Trigonometric};

/// The shape g of a change of feed.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq)]
pub enum StageShape<R> {
    /// `3x² - 2x³`: no acceleration at both ends.
    #[default]
    Cubic,
    /// `x²`: constant jerk, from no acceleration.
    Onset,
    /// `x`: constant acceleration; with no change of feed, constant feed.
    Steady,
    /// `2x - x²`: constant jerk, to no acceleration.
    Easing,
    /// `(1 - cos πx)/2`: no acceleration at both ends.
    Cosine,
    /// `x + b x(1 - x)`: constant jerk from `1 + b` times the mean acceleration to `1 - b` times that, b from -1 to 1.
    Bent(R),
}

impl<R: Real> StageShape<R> {
    /// Every shape.
    #[cfg(test)]
    pub(crate) fn all() -> [Self; 8] {
        let [third, most] = [R::from_ratio(1, 3), R::from_ratio(15, 16)];
        let bent = [Self::Bent(third), Self::Bent(R::zero() - most), Self::Bent(R::one())];
        let [a, b, c] = bent;
        [Self::Cubic, Self::Onset, Self::Steady, Self::Easing, Self::Cosine, a, b, c]
    }

    /// The same shape, its number converted if it has one.
    ///
    /// # Errors
    /// That of `convert`.
    pub fn try_map<Q, E>(self, convert: impl FnOnce(R) -> Result<Q, E>) -> Result<StageShape<Q>, E> {
        Ok(match self {
            Self::Cubic => StageShape::Cubic,
            Self::Onset => StageShape::Onset,
            Self::Steady => StageShape::Steady,
            Self::Easing => StageShape::Easing,
            Self::Cosine => StageShape::Cosine,
            Self::Bent(by) => StageShape::Bent(convert(by)?),
        })
    }

    /// The same shape, its number converted if it has one.
    pub fn map<Q>(self, convert: impl FnOnce(R) -> Q) -> StageShape<Q> {
        match self.try_map(|by| Ok::<_, core::convert::Infallible>(convert(by))) {
            Ok(shape) => shape,
            Err(never) => match never {},
        }
    }

    /// g(x), the share of the change of feed that is reached.
    #[must_use]
    pub fn reached(self, x: R) -> R {
        match self {
            Self::Cubic => x * x * (R::from_ratio(3, 1) - x - x),
            Self::Onset => x * x,
            Self::Steady => x,
            Self::Easing => x * (R::one() + (R::one() - x)),
            Self::Bent(by) => x + by * (x * (R::one() - x)),
            Self::Cosine => {
                let (sine, _) = R::sin_cos_quarter(x);
                sine * sine
            }
        }
    }

    /// g'(x), the acceleration against the mean acceleration.
    #[must_use]
    pub fn slope(self, x: R) -> R {
        match self {
            Self::Cubic => R::from_ratio(6, 1) * x * (R::one() - x),
            Self::Onset => x + x,
            Self::Steady => R::one(),
            Self::Easing => (R::one() - x) + (R::one() - x),
            Self::Bent(by) => R::one() + by * (R::one() - x - x),
            Self::Cosine => {
                let (sine, cosine) = R::sin_cos_quarter(x);
                let half = sine * cosine;
                R::half_pi() * (half + half)
            }
        }
    }

    /// g''(x), the jerk against mean acceleration over duration.
    #[must_use]
    pub fn bend(self, x: R) -> R {
        match self {
            Self::Cubic => R::from_ratio(6, 1) * (R::one() - x - x),
            Self::Onset => R::from_ratio(2, 1),
            Self::Steady => R::zero(),
            Self::Easing => R::from_ratio(-2, 1),
            Self::Bent(by) => R::zero() - by - by,
            Self::Cosine => {
                let (sine, cosine) = R::sin_cos_quarter(x);
                let square = R::half_pi() * R::half_pi();
                (square + square) * (cosine * cosine - sine * sine)
            }
        }
    }

    /// G(x), the share of the change of feed in the distance.
    #[must_use]
    pub fn travelled(self, x: R) -> R {
        let third = R::from_ratio(1, 3);
        match self {
            Self::Cubic => {
                let cubed = x * x * x;
                cubed - (cubed * x).half()
            }
            Self::Onset => x * x * x * third,
            Self::Steady => (x * x).half(),
            Self::Easing => x * x * (R::one() - x * third),
            Self::Bent(by) => x * x * (R::one().half() + by * (R::one().half() - x * third)),
            Self::Cosine => {
                let (sine, cosine) = R::sin_cos_quarter(x);
                (x - sine * cosine * R::two_over_pi()).half()
            }
        }
    }

    /// The mean of g over an interval of width `width` about `middle`, both shares of the duration, without cancellation.
    ///
    /// Range: with the interval in [0, 1] no intermediate exceeds 2 in magnitude, so two integer bits are enough.
    #[inline(always)] // A call, with the shape's number, would cost a step of 64 bits 16 instructions.
    #[must_use]
    pub fn mean(self, middle: R, width: R) -> R {
        let (square, rest) = (middle * middle, R::one() - middle);
        let square_width = width * width;
        match self {
            Self::Cubic => {
                let bend = rest - middle;
                if !R::IS_FLOATING {
                    // Rounded once.
                    return R::sum_of_products([
                        (square, R::one()),
                        (square, rest),
                        (square, rest),
                        (square_width.ldexp(-2), bend),
                    ]);
                }
                let twice = square * rest;
                square + twice + twice + (square_width * bend).ldexp(-2)
            }
            Self::Onset => square + twelfth(square_width),
            Self::Steady => middle,
            Self::Easing => middle + middle * rest - twelfth(square_width),
            Self::Cosine => mean_of_cosine(middle, width),
            Self::Bent(by) => mean_of_bent(by, middle, width),
        }
    }

    /// Largest |g'|, by which a piece's peak acceleration is its mean acceleration.
    #[must_use]
    pub fn peak_slope(self) -> R {
        match self {
            Self::Cubic => R::from_ratio(3, 2),
            Self::Onset | Self::Easing => R::from_ratio(2, 1),
            Self::Steady => R::one(),
            Self::Cosine => R::half_pi(),
            Self::Bent(by) => R::one() + by.abs(),
        }
    }

    /// Largest |g''|.
    #[must_use]
    pub fn peak_bend(self) -> R {
        match self {
            Self::Cubic => R::from_ratio(6, 1),
            Self::Onset | Self::Easing => R::from_ratio(2, 1),
            Self::Steady => R::zero(),
            Self::Cosine => R::half_pi() * (R::half_pi() + R::half_pi()),
            Self::Bent(by) => by.abs() + by.abs(),
        }
    }

    /// `c₀..c₃` of g as a polynomial of x; `None` for the cosine.
    #[must_use]
    pub fn coefficients(self) -> Option<[R; 4]> {
        let whole = |coefficients: [i32; 4]| Some(coefficients.map(|c| R::from_ratio(c, 1)));
        match self {
            Self::Cubic => whole([0, 0, 3, -2]),
            Self::Onset => whole([0, 0, 1, 0]),
            Self::Steady => whole([0, 1, 0, 0]),
            Self::Easing => whole([0, 2, -1, 0]),
            Self::Bent(by) => Some([R::zero(), R::one() + by, R::zero() - by, R::zero()]),
            Self::Cosine => None,
        }
    }
}

/// The mean of `x + b x(1 - x)`.
#[inline]
fn mean_of_bent<R: Real>(by: R, middle: R, width: R) -> R {
    by.mul_add(middle * (R::one() - middle) - twelfth(width * width), middle)
}

/// x/12. In a float a quarter is exact, and goes into the constant.
#[inline]
fn twelfth<R: Real>(x: R) -> R {
    let third = R::from_ratio(1, 3);
    if R::IS_FLOATING { x * third.ldexp(-2) } else { x.ldexp(-2) * third }
}

/// The mean of `(1 - cos πx)/2`: sines are long, and would keep the polynomial shapes from being inlined.
#[inline(never)]
fn mean_of_cosine<R: Real>(middle: R, width: R) -> R {
    let (sine, cosine) = R::sin_cos_quarter(middle);
    let square = sine * sine;
    (cosine * cosine - square).mul_add(sinc_lacks(width).half(), square)
}

/// `1 - sinc(πw/2)` for w in [0, 1]: with `q = (πw/4)²`, at most 0.62, `4q/6 (1 - 4q/20 (1 - 4q/42 …))`.
fn sinc_lacks<R: Real>(width: R) -> R {
    let quarter = R::half_pi().half() * width;
    let square = quarter * quarter;
    let mut lacks = R::zero();
    for k in (1..=sinc_terms::<R>()).rev() {
        lacks = square * ((R::one() - lacks) * R::from_ratio(4, 2 * k * (2 * k + 1)));
    }
    lacks
}

/// How many terms leave less than a third of a unit of the last place: after n, at most `(π/2)^(2n + 2)/(2n + 3)!` is left.
#[must_use]
pub fn sinc_terms<R: Real>() -> i32 {
    // (resolution, terms): what is left is 2⁻¹⁸, 2⁻³¹, 2⁻³⁷, 2⁻⁶⁰, 2⁻⁶⁸, 2⁻¹¹⁹.
    const TABLE: [(i32, i32); 5] = [(-16, 4), (-25, 6), (-36, 7), (-54, 10), (-64, 11)];
    let enough = |(exponent, _): &&(i32, i32)| R::resolution() >= R::one().ldexp(*exponent);
    TABLE.iter().find(enough).map_or(17, |(_, terms)| *terms)
}

#[cfg(test)]
mod tests {
    use super::*;
    use real::{Backend, DoubleDouble, I2F30, I8F24, I16F48};

    /// Integral of g over [a, b] by Simpson's rule with 2000 panels.
    fn integral(g: impl Fn(f64) -> f64, a: f64, b: f64) -> f64 {
        let h = (b - a) / 2000.0;
        let panel = |i: i32| {
            let x = a + h * f64::from(i);
            h / 6.0 * (g(x) + 4.0 * g(x + h / 2.0) + g(x + h))
        };
        (0..2000).map(panel).sum()
    }

    #[test]
    fn each_column_of_the_table_is_the_integral_of_the_one_before() {
        for shape in StageShape::<f64>::all() {
            assert!(shape.reached(0.0_f64).abs() < 1e-15 && (shape.reached(1.0_f64) - 1.0).abs() < 1e-15);
            for i in 1..=20 {
                let x = f64::from(i) / 20.0;
                let start: f64 = shape.slope(0.0);
                assert!(
                    (integral(|x| shape.bend(x), 0.0, x) + start - shape.slope(x)).abs() < 1e-11,
                    "{shape:?} {x}"
                );
                assert!(
                    (integral(|x| shape.slope(x), 0.0, x) - shape.reached(x)).abs() < 1e-12,
                    "{shape:?} {x}"
                );
                assert!(
                    (integral(|x| shape.reached(x), 0.0, x) - shape.travelled(x)).abs() < 1e-12,
                    "{shape:?} {x}"
                );
            }
        }
    }

    #[test]
    fn the_peaks_are_the_largest_values() {
        for shape in StageShape::<f64>::all() {
            let grid = || (0..=1000).map(|i| f64::from(i) / 1000.0);
            let slope = grid().map(|x| shape.slope(x).abs()).fold(0.0, f64::max);
            let bend = grid().map(|x| shape.bend(x).abs()).fold(0.0, f64::max);
            assert!((slope - shape.peak_slope()).abs() < 1e-12, "{shape:?} {slope}");
            assert!((bend - shape.peak_bend()).abs() < 1e-12, "{shape:?} {bend}");
        }
    }

    #[test]
    fn coefficients_are_those_of_g() {
        for shape in StageShape::<f64>::all() {
            let Some([c0, c1, c2, c3]) = shape.coefficients() else {
                assert_eq!(shape, StageShape::Cosine);
                continue;
            };
            for x in [0.0, 0.3, 0.8, 1.0] {
                assert!((c0 + x * (c1 + x * (c2 + x * c3)) - shape.reached(x)).abs() < 1e-15);
            }
        }
    }

    /// Largest error of the mean in `R` against the difference of G in double-double, in units of the resolution.
    fn mean_error<R: Backend>(shape: StageShape<f64>) -> f64 {
        let rounded = shape.map(|by| R::from_f64(by).unwrap());
        let shape = rounded.map(|by| DoubleDouble::from(by.to_f64()));
        let mut worst = 0.0_f64;
        for i in 0..64 {
            for k in 0..=16 {
                let (from, to) = (f64::from(i) / 64.0, f64::from(i + (64 - i) * k / 16) / 64.0);
                let (middle, width) = ((from + to) / 2.0, to - from);
                let exact = |x: f64| DoubleDouble::from(x);
                let expected = if width > 0.0 {
                    ((shape.travelled(exact(to)) - shape.travelled(exact(from))) / exact(width)).value()
                } else {
                    shape.reached(exact(middle)).value()
                };
                let found = rounded.mean(R::from_f64(middle).unwrap(), R::from_f64(width).unwrap());
                worst = worst.max((found.to_f64() - expected).abs() / R::resolution().to_f64());
            }
        }
        worst
    }

    #[test]
    fn the_mean_is_good_to_a_few_units_in_every_format() {
        for shape in StageShape::<f64>::all() {
            for (name, error) in [
                ("f64", mean_error::<f64>(shape)),
                ("f32", mean_error::<f32>(shape)),
                ("I2F30", mean_error::<I2F30>(shape)),
                ("I8F24", mean_error::<I8F24>(shape)),
            ] {
                assert!(error <= 5.0, "{shape:?} in {name}: {error} units");
            }
            // Beyond f64, judged by twice the digits that f64 has: the reference is the same function, so this shows that
            // the series is long enough.
            assert!(mean_error::<I16F48>(shape) <= 5.0, "{shape:?}");
        }
    }

    #[test]
    fn the_series_is_long_enough_for_double_double() {
        // sinc(π/2) = 2/π.
        let lacks = sinc_lacks(DoubleDouble::from(1.0));
        let exact = DoubleDouble::from(1.0) - DoubleDouble::two_over_pi();
        assert!((lacks - exact).value().abs() < 1e-31);
    }
}
