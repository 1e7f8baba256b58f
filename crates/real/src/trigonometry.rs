//! Sine and cosine of a quarter turn, for curves made of them: one polynomial for every backend.
//!
//! The argument counts quarter turns, so that it needs no reduction by an irrational number and no format of wide
//! range: `S = sin(πu/2)`, `C = cos(πu/2)`, u in [0, 1]. The upper half mirrors the lower, `S(u) = C(1 - u)`, and the
//! subtraction is exact in every format. What is left is an angle `z = πu/2` of at most π/4, and with `w = z²`
//!
//! `cos z = 1 - w/2 (1 - w/12 (1 - w/30 (1 - …)))`, `sin z = z (1 - w/6 (1 - w/20 (1 - w/42 …)))`,
//!
//! the Taylor series, nested so that each rounding is divided by 2, 12, 30, … before it reaches the result. The number
//! of terms is fixed by the format, so that every evaluation takes the same time.

use crate::Real;

/// Sine and cosine, for every [`Real`].
///
/// All backends compute them by the same operations, as a controller without a sine unit has to. A wrapper sees each
/// operation.
pub trait Trigonometric: Real {
    /// π/2, rounded to nearest.
    #[must_use]
    fn half_pi() -> Self {
        // The leading 24 bits are exact in every float; the digits after them are added last and decide the rounding.
        // The 1 is added separately, so that 1.57 needs only the two integer bits that it has.
        let leading = Self::one() + from_digits([0x92_1fb4, 0, 0, 0, 0]);
        leading + from_digits([1, 0x44_42d1, 0x84_6989, 0x8c_c517, 0x01_b839])
    }

    /// 2/π, rounded to nearest.
    #[must_use]
    fn two_over_pi() -> Self {
        from_digits([0xa2_f983, 0x6e_4e44, 0x15_29fc, 0x27_57d1, 0xf5_34dd])
    }

    /// `(sin(πu/2), cos(πu/2))`: the point at the part `u` of a quarter of the unit circle.
    ///
    /// Exact at both ends: (0, 1) and (1, 0). For n terms it takes 4n + 2 multiplications and one fused with an addition.
    ///
    /// Domain: u in [-1/2, 3/2], which leaves half a quarter turn at both ends for extrapolation. Outside, the result
    /// is that at the nearer end of the domain. Range: intermediates stay below 2 in magnitude, so two integer bits are
    /// enough.
    ///
    /// Accuracy: within 2 units of the last place in fixed point of any width, in `f32` and in `f64`; 4e-32 relative in
    /// the double-double. In fixed point a unit is the resolution, in floats it is that of the result.
    #[must_use]
    fn sin_cos_quarter(u: Self) -> (Self, Self) {
        let half = Self::one().half();
        if u > half {
            let (sine, cosine) = small_angle((Self::one() - u).max(-half));
            (cosine, sine)
        } else {
            small_angle(u.max(-half))
        }
    }
}

impl<R: Real> Trigonometric for R {}

/// Sine and cosine of `u` quarter turns, `|u| ≤ 1/2`.
fn small_angle<R: Real>(u: R) -> (R, R) {
    let angle = R::half_pi() * u; // |z| ≤ π/4
    let square = angle * angle;
    // `1 - sin z / z` and `1 - cos z`.
    let (mut sine_lacks, mut cosine_lacks) = (R::zero(), R::zero());
    for k in (1..=sine_terms::<R>()).rev() {
        let even = 2 * k;
        cosine_lacks = square * ((R::one() - cosine_lacks) * R::from_ratio(1, even * (even - 1)));
        sine_lacks = square * ((R::one() - sine_lacks) * R::from_ratio(1, even * (even + 1)));
    }
    ((-angle).mul_add(sine_lacks, angle), R::one() - cosine_lacks)
}

/// The number of terms whose error is less than a third of a unit of the last place. The cosine's error after n terms
/// is `z^(2n+2)/(2n+2)!`, and the sine's is less.
#[must_use]
pub fn sine_terms<R: Real>() -> i32 {
    // (resolution, terms): the error is 2⁻¹⁸, 2⁻³³, 2⁻⁴¹, 2⁻⁵⁸, 2⁻⁶⁸, 2⁻¹¹⁸.
    const TABLE: [(i32, i32); 5] = [(-16, 3), (-25, 5), (-36, 6), (-54, 8), (-64, 9)];
    let enough = |(exponent, _): &&(i32, i32)| R::resolution() >= R::one().ldexp(*exponent);
    TABLE.iter().find(enough).map_or(14, |(_, terms)| *terms)
}

/// A number in [0, 1) in digits of 24 bits, the first one right after the binary point.
type Digits = [u32; 5];

/// The number nearest to a fraction given in digits that each format holds exactly, summed from the smallest up.
fn from_digits<R: Real>(digits: Digits) -> R {
    let phase = |digit: u32, exponent| R::from_phase(u64::from(digit) << 40, exponent);
    let [a, b, c, d, e] = digits;
    // Twice the number, cut off one bit below the last place in fixed point; halving then rounds to nearest. The last
    // two digits lie beyond a phase's range, and count in the double-double only.
    let beyond = phase(e, -47).ldexp(-48) + phase(d, -47).ldexp(-24);
    let doubled = beyond + phase(c, -47) + phase(b, -23) + phase(a, 1);
    doubled.half()
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::{Backend, FixedPoint, I2F30, I4F4, I8F24, I12F20, I16F16, I16F48, I32F32};
    use fixed::traits::FixedSigned;
    use fixed::types::{I2F6, I2F14, I2F62, I4F12};
    use proptest::prelude::*;

    /// Sine and cosine of the part of a quarter turn that is nearest to `u` in `R`, and their errors in units of the
    /// last place, of which the unit is given as a function of the exact value.
    fn errors<R: Backend>(u: R, unit: impl Fn(f64) -> f64) -> [f64; 2] {
        // In f64, whose own error is less than a thousandth of a unit of 32 bits; measured from the nearer axis, so
        // that a sine or cosine near 0 keeps its digits.
        let sine_of = |u: f64| {
            let angle = core::f64::consts::FRAC_PI_2 * if u > 0.5 { 1.0 - u } else { u };
            if u > 0.5 { angle.cos() } else { angle.sin() }
        };
        let exact = (sine_of(u.to_f64()), sine_of(1.0 - u.to_f64()));
        let (sine, cosine) = R::sin_cos_quarter(u);
        [(sine, exact.0), (cosine, exact.1)]
            .map(|(found, exact)| (found.to_f64() - exact).abs() / unit(exact))
    }

    fn worst_of_all<F: FixedSigned + Send + Sync>() -> f64
    where
        F::Bits: crate::Word,
    {
        let unit = FixedPoint::<F>::resolution().to_f64();
        let count = 1 << F::FRAC_NBITS;
        let numbers =
            (-count / 2..=count + count / 2).filter_map(|k| FixedPoint::<F>::from_f64(f64::from(k) * unit));
        numbers.flat_map(|u| errors(u, |_| unit)).fold(0.0, f64::max)
    }

    #[test]
    fn every_number_of_narrow_formats_is_within_two_units() {
        for (name, worst) in [
            ("I4F4", worst_of_all::<fixed::types::I4F4>()),
            ("I2F6", worst_of_all::<I2F6>()),
            ("I4F12", worst_of_all::<I4F12>()),
            ("I2F14", worst_of_all::<I2F14>()),
            ("I16F16", worst_of_all::<fixed::types::I16F16>()),
        ] {
            assert!(worst <= 2.0, "{name}: {worst}");
        }
    }

    /// A unit of the last place of a float with these significant bits.
    fn ulp(bits: i32) -> impl Fn(f64) -> f64 {
        move |x| {
            let power_of_two_below = f64::from_bits(x.abs().max(1e-30).to_bits() & (0x7ff << 52));
            power_of_two_below.ldexp(1 - bits)
        }
    }

    /// Against the double-double, for formats as fine as f64 or finer.
    #[cfg(feature = "reference")]
    fn errors_of_fine<R: Backend>(u: R, unit: impl Fn(f64) -> f64) -> [f64; 2] {
        use crate::DoubleDouble;
        let exactly = |x: R| DoubleDouble::new(x.to_f64_pair().0, x.to_f64_pair().1);
        let (sine, cosine) = R::sin_cos_quarter(u);
        let exact = DoubleDouble::sin_cos_quarter(exactly(u));
        [(sine, exact.0), (cosine, exact.1)]
            .map(|(found, exact)| (exactly(found) - exact).value().abs() / unit(exact.value()))
    }

    fn within(errors: [f64; 2], bound: f64) -> Result<(), TestCaseError> {
        prop_assert!(errors.iter().all(|e| *e <= bound), "{errors:?} > {bound}");
        Ok(())
    }

    fn fixed<R: Backend>(u: f64) -> Result<(), TestCaseError> {
        within(errors(R::from_f64(u).unwrap(), |_| R::resolution().to_f64()), 2.0)
    }

    proptest! {
        #![proptest_config(ProptestConfig::with_cases(2000))]

        #[test]
        fn formats_of_32_bits_are_within_two_units(u in -0.5..1.5_f64) {
            fixed::<I2F30>(u)?;
            fixed::<I8F24>(u)?;
            fixed::<I12F20>(u)?;
            fixed::<I32F32>(u)?;
            within(errors(f32::from_f64(u).unwrap(), ulp(24)), 2.0)?;
        }

        #[test]
        #[cfg(feature = "reference")]
        fn formats_of_64_bits_are_within_two_units(u in -0.5..1.5_f64, rest in -0.5..0.5_f64) {
            fn of_64<R: Backend>(u: f64, rest: f64) -> Result<(), TestCaseError> {
                let rest = rest * ulp(53)(u);
                within(errors_of_fine(R::from_f64_pair(u, rest).unwrap(), |_| R::resolution().to_f64()), 2.0)
            }
            of_64::<I16F48>(u, rest)?;
            of_64::<crate::I4F60>(u, rest)?;
            of_64::<FixedPoint<I2F62>>(u, rest)?;
            within(errors_of_fine(u, ulp(53)), 2.0)?;
        }

        #[test]
        #[cfg(feature = "reference")]
        fn the_reference_keeps_the_unit_circle_and_the_double_angle(u in 0.0..0.5_f64) {
            use crate::DoubleDouble;
            let exact = |x: f64| DoubleDouble::sin_cos_quarter(DoubleDouble::from(x));
            let (s, c) = exact(u);
            let (s2, c2) = exact(2.0 * u);
            for (found, expected) in [(s * s + c * c, DoubleDouble::from(1.0)), (s * c + s * c, s2), (c * c - s * s, c2)] {
                let error = (found - expected).value().abs();
                prop_assert!(error <= 8e-32, "u={u}: {error}");
            }
        }
    }

    #[test]
    #[cfg(feature = "reference")]
    fn the_reference_has_the_digits_of_another_implementation() {
        use crate::DoubleDouble;
        // From mpmath with 400 bits: u, sin(πu/2), cos(πu/2), as sums of two floats.
        for (u, sine, cosine) in [
            (
                (0.125, 0.0),
                (0.195_090_322_016_128_28, -7.991_079_068_461_731e-18),
                (0.980_785_280_403_230_4, 1.854_693_999_782_500_6e-17),
            ),
            (
                (0.375, 0.0),
                (0.555_570_233_019_602_2, 4.709_410_940_561_677e-17),
                (0.831_469_612_302_545_2, 1.407_385_698_472_802_4e-18),
            ),
            (
                (0.000_976_562_5, 0.0),
                (0.001_533_980_186_284_765_7, -1.046_771_297_159_695_8e-19),
                (0.999_998_823_451_701_9, 3.067_881_716_126_108e-17),
            ),
        ] {
            let number = |(high, low)| DoubleDouble::new(high, low);
            let found = DoubleDouble::sin_cos_quarter(number(u));
            for (found, expected) in [(found.0, number(sine)), (found.1, number(cosine))] {
                let error = ((found - expected) / expected).value().abs();
                assert!(error <= 4e-32, "u={u:?}: {error}");
            }
        }
    }

    #[test]
    fn constants_are_rounded_to_nearest() {
        use core::f32::consts as short;
        use core::f64::consts::{FRAC_2_PI, FRAC_PI_2};
        assert_eq!((f64::half_pi(), f64::two_over_pi()), (FRAC_PI_2, FRAC_2_PI));
        assert_eq!((f32::half_pi(), f32::two_over_pi()), (short::FRAC_PI_2, short::FRAC_2_PI));
        fn nearest<R: Backend>() {
            let expected = [FRAC_PI_2, FRAC_2_PI].map(|x| R::from_f64(x).unwrap());
            assert!(expected == [R::half_pi(), R::two_over_pi()], "{}", R::name());
        }
        nearest::<I4F4>();
        nearest::<FixedPoint<I2F14>>();
        nearest::<I16F16>();
        nearest::<I2F30>();
        nearest::<I32F32>();
        nearest::<I16F48>();
    }

    #[test]
    fn the_ends_are_exact_and_beyond_the_domain_nothing_moves() {
        fn check<R: Backend>() {
            let (zero, one) = (R::zero(), R::one());
            assert!(
                R::sin_cos_quarter(zero) == (zero, one) && R::sin_cos_quarter(one) == (one, zero),
                "{}",
                R::name()
            );
            let edge = one + one.half();
            for far in [R::max_value(), edge] {
                assert!(R::sin_cos_quarter(far) == R::sin_cos_quarter(edge), "{}: {far:?}", R::name());
            }
            assert!(R::sin_cos_quarter(R::min_value()) == R::sin_cos_quarter(-one.half()), "{}", R::name());
        }
        check::<f64>();
        check::<f32>();
        check::<I4F4>();
        check::<I16F16>();
        check::<I2F30>();
        check::<FixedPoint<I2F62>>();
        #[cfg(feature = "reference")]
        check::<crate::DoubleDouble>();
    }

    #[test]
    #[cfg(feature = "std")]
    fn two_integer_bits_never_overflow() {
        use crate::{Audit, Audited};
        let ((), audit) = Audit::of(|| {
            for k in -500..=1500 {
                let u = Audited(FixedPoint::<I2F14>::from_ratio(k, 1000));
                let _ = Audited::sin_cos_quarter(u);
            }
        });
        assert_eq!(audit.overflows, 0);
    }
}
