//! The float backends: `f64` and `f32`, with IEEE 754 semantics.

use crate::{Backend, FormatName, Real};

#[cfg(not(any(feature = "std", feature = "libm")))]
compile_error!("enable the feature `std` or `libm`: core has no square root of floats");

macro_rules! float_backend {
    ($float:ident, $digits:literal, $half_range:literal) => {
        impl Real for $float {
            const IS_FOR_SPEED: bool = true;
            const IS_FLOATING: bool = true;
            const ADDS_PLACES: bool = $digits > 32;

            #[inline]
            fn resolution() -> Self {
                $float::EPSILON
            }

            #[inline]
            fn from_ratio(numerator: i32, denominator: i32) -> Self {
                ratio::$float(numerator, denominator)
            }

            #[inline]
            fn mul_add(self, factor: Self, addend: Self) -> Self {
                self * factor + addend
            }

            #[inline(always)] // Called, it would take the pairs through memory.
            fn sum_of_products(pairs: impl IntoIterator<Item = (Self, Self)>) -> Self {
                let mut pairs = pairs.into_iter();
                let Some((a, b)) = pairs.next() else { return 0.0 };
                pairs.fold(a * b, |sum, (a, b)| sum + a * b)
            }

            /// The plain sum of squares serves unless it has left the range in which squares keep their
            /// precision; only then are the components first scaled by a power of two.
            #[inline]
            fn norm<const N: usize>(vector: &[Self; N]) -> Self {
                let squared = |exponent: i32| {
                    vector.iter().map(|v| v.ldexp(exponent)).fold(0.0, |sum: $float, v| sum + v * v)
                };
                let sum = squared(0);
                if sum < $float::MIN_POSITIVE / $float::EPSILON {
                    Real::sqrt(squared($half_range)).ldexp(-$half_range)
                } else if sum > $float::MAX {
                    Real::sqrt(squared(-$half_range)).ldexp($half_range)
                } else {
                    Real::sqrt(sum)
                }
            }

            #[inline]
            fn sqrt(self) -> Self {
                if self < 0.0 { 0.0 } else { square_root::$float(self) }
            }

            #[inline]
            fn ldexp(self, exponent: i32) -> Self {
                self * power_of_two::$float(exponent)
            }

            /// Works on the bits, because a conversion would round to nearest. The leading one and the bits after it
            /// are the significand; the place of the leading one gives the exponent.
            #[inline]
            fn from_phase(phase: u64, exponent: i32) -> Self {
                let zeros = phase.leading_zeros();
                let biased = exponent.wrapping_add(phase::$float::BIAS - 1).wrapping_sub(zeros.cast_signed());
                if phase == 0 || !(1..=2 * phase::$float::BIAS).contains(&biased) {
                    return phase::$float::from_beyond(phase, exponent);
                }
                phase::$float::normal(phase, biased)
            }

            /// The significand, shifted.
            #[inline]
            fn to_phase(self, exponent: i32) -> u64 {
                let (distance, significand) = phase::$float::parts(self);
                let distance = distance.wrapping_sub(exponent).cast_unsigned();
                if distance >= phase::$float::FARTHEST {
                    return phase::$float::to_beyond(self, exponent);
                }
                significand >> (distance & 63)
            }

            #[inline]
            fn fraction(phase: u64) -> Self {
                phase::$float::leading(phase)
            }

            #[inline]
            fn fraction_of(product: u128, shift: u32) -> Self {
                phase::$float::leading_of(product, shift)
            }

            /// The digits of `1 + self` behind the point.
            #[inline]
            fn place_to_phase(self) -> Option<u64> {
                let raised = 1.0 + self;
                if raised >= 2.0 { None } else { Some(u64::from(raised.to_bits()) << (65 - $digits)) }
            }

            /// By the bits, which are in the order of positive floats; a sign makes them greater.
            #[inline]
            fn is_part(self) -> bool {
                self.to_bits() <= const { $float::to_bits(1.0) }
            }

            #[inline]
            fn is_finite(self) -> bool {
                $float::is_finite(self)
            }
        }
    };
}

float_backend!(f64, 53, 600);
float_backend!(f32, 24, 75);

/// Square roots: the machine's instruction through std, or libm's.
mod square_root {
    #[cfg(feature = "std")]
    pub(super) use self::with_std::{f32, f64};
    #[cfg(not(feature = "std"))]
    pub(super) use libm::{sqrt as f64, sqrtf as f32};

    #[cfg(feature = "std")]
    mod with_std {
        pub(in super::super) fn f64(x: f64) -> f64 {
            x.sqrt()
        }
        pub(in super::super) fn f32(x: f32) -> f32 {
            x.sqrt()
        }
    }
}

/// Quotients of integers, rounded once, ties to even.
mod ratio {
    /// Both integers are exact.
    #[inline]
    pub(super) fn f64(numerator: i32, denominator: i32) -> f64 {
        f64::from(numerator) / f64::from(denominator)
    }

    /// Integers of more than 24 bits are not exact in f32, and a quotient in f64 would be rounded twice. Their
    /// integer quotient has 32 bits or more; any remainder sets its last bit, which keeps it from looking like a tie.
    #[inline]
    #[allow(clippy::cast_precision_loss, reason = "exact in the first case, the one rounding in the second")]
    pub(super) fn f32(numerator: i32, denominator: i32) -> f32 {
        let (n, d) = (numerator.unsigned_abs(), denominator.unsigned_abs());
        if n.max(d) <= 1 << 24 || n == 0 || d == 0 {
            return numerator as f32 / denominator as f32;
        }
        let shift = u64::from(n).leading_zeros();
        let (n, d) = (u64::from(n) << shift, u64::from(d));
        let magnitude =
            ((n / d) | u64::from(n % d != 0)) as f32 * super::power_of_two::f32(-shift.cast_signed());
        if (numerator < 0) == (denominator < 0) { magnitude } else { -magnitude }
    }
}

/// `2^exponent`, exact. In `f64` for exponents of normal numbers, which is far beyond the domain of a shift; in `f32`, where
/// it is not, an exponent outside goes to the nearest inside.
mod power_of_two {
    #[inline]
    pub(super) fn f64(exponent: i32) -> f64 {
        f64::from_bits(u64::from(exponent.wrapping_add(1023).cast_unsigned()) << 52)
    }
    #[inline]
    pub(super) fn f32(exponent: i32) -> f32 {
        f32::from_bits((exponent.clamp(-126, 127) + 127).unsigned_abs() << 23)
    }
}

/// The layout of a float, as conversions from and to phases use it.
mod phase {
    macro_rules! layout {
        ($float:ident, $digits:literal, $spared:literal, $integer:ident) => {
            pub(super) mod $float {
                use crate::Real;

                /// The exponent's bias.
                pub(in super::super) const BIAS: i32 = $float::MAX_EXP - 1;
                /// Significands are shifted by less than this. A subnormal number and zero lie farther than this at
                /// every exponent of the domain.
                pub(in super::super) const FARTHEST: u32 =
                    if BIAS - 65 < 64 { (BIAS - 65).unsigned_abs() } else { 64 };

                /// The normal number of a phase that is not 0 and this biased exponent, cut to the format's digits.
                #[inline]
                #[allow(clippy::cast_possible_truncation, reason = "the format has no more bits")]
                pub(in super::super) fn normal(phase: u64, biased: i32) -> $float {
                    let significand = (phase << (phase.leading_zeros() & 63)) >> (64 - $digits);
                    // The leading one adds itself to the exponent.
                    let bits = u64::from((biased - 1).cast_unsigned()) << ($digits - 1);
                    $float::from_bits((bits + significand) as _)
                }

                /// How far the exponent lies below that of ½, and the significand of a normal number in [1, 2) · 2⁶³.
                /// The sign bit counts as the exponent's top bit, so that the distance of a negative number is below 0.
                #[inline]
                #[allow(
                    clippy::cast_possible_truncation,
                    clippy::cast_possible_wrap,
                    reason = "sign and exponent are twelve bits at most"
                )]
                pub(in super::super) fn parts(x: $float) -> (i32, u64) {
                    let bits = x.to_bits();
                    let significand = u64::from(bits) << (64 - $digits) | 1 << 63;
                    ((BIAS - 1).wrapping_sub((bits >> ($digits - 1)) as i32), significand)
                }

                /// `phase · 2⁻⁶⁴` without the last bits of the phase: the others fit an integer that machines convert
                /// in one instruction.
                #[inline]
                #[allow(
                    clippy::cast_precision_loss,
                    clippy::cast_possible_truncation,
                    clippy::cast_possible_wrap,
                    reason = "the spared bits leave room, and the conversion rounds as it should"
                )]
                pub(in super::super) fn leading(phase: u64) -> $float {
                    converted((phase >> $spared) as $integer)
                }

                /// [`leading`] of `product / 2^shift`, for a quotient below 2⁶⁴: if the first bits of it are in the first
                /// half of the product, no more of it is read.
                #[inline]
                #[allow(
                    clippy::cast_possible_truncation,
                    clippy::cast_possible_wrap,
                    reason = "as many leading bits as are kept, and the spared bits leave room"
                )]
                pub(in super::super) fn leading_of(product: u128, shift: u32) -> $float {
                    if shift + $spared >= 64 {
                        return converted(
                            crate::real::leading_bits(product, shift + $spared - 64) as $integer
                        );
                    }
                    leading(crate::real::phase_of(product, shift))
                }

                #[inline]
                #[allow(clippy::cast_precision_loss, reason = "the conversion rounds as it should")]
                fn converted(leading: $integer) -> $float {
                    leading as $float * super::super::power_of_two::$float($spared - 64)
                }

                /// `phase · 2^(exponent - 64)` where the phase is 0 or the result is not a normal number.
                #[cold]
                #[allow(
                    clippy::cast_precision_loss,
                    reason = "as many leading bits are kept as the format has"
                )]
                pub(in super::super) fn from_beyond(phase: u64, exponent: i32) -> $float {
                    let surplus = 64 - $digits;
                    let dropped = surplus - phase.leading_zeros().min(surplus);
                    let kept = (phase >> dropped).cast_signed() as $float;
                    kept.ldexp(dropped.cast_signed() - 64).ldexp(exponent.clamp(-64, 64))
                }

                /// `⌊x · 2^(64 + exponent)⌋` where the result is 0 or saturates, and where x is negative or NaN.
                #[cold]
                #[allow(
                    clippy::cast_possible_truncation,
                    clippy::cast_sign_loss,
                    reason = "the cast rounds toward 0 and saturates, as the contract says"
                )]
                pub(in super::super) fn to_beyond(x: $float, exponent: i32) -> u64 {
                    x.ldexp(64).ldexp(exponent.clamp(-64, 64)) as u64
                }
            }
        };
    }
    layout!(f64, 53, 1, i64);
    layout!(f32, 24, 32, u32);
}

impl Backend for f64 {
    fn name() -> FormatName {
        FormatName::Float { bits: 64 }
    }
    fn from_f64_pair(high: f64, low: f64) -> Option<Self> {
        Some(high + low).filter(|x| x.is_finite())
    }
    fn to_f64_pair(self) -> (f64, f64) {
        (self, 0.0)
    }
}

impl Backend for f32 {
    fn name() -> FormatName {
        FormatName::Float { bits: 32 }
    }
    #[allow(clippy::cast_possible_truncation, reason = "rounding to the format is what is asked for")]
    fn from_f64_pair(high: f64, low: f64) -> Option<Self> {
        // Rounding a rounded sum goes wrong if the first rounding made it a tie. So the first one goes to the neighbour
        // with an odd last digit, which is never a tie. A sum that needs no rounding stays as it is.
        let sum = high + low;
        let rest = (high - sum) + low; // exact, as |high| >= |low|
        let odd = match (rest == 0.0 || sum.to_bits() & 1 == 1, (rest > 0.0) == (sum > 0.0)) {
            (true, _) => sum,
            (false, true) => f64::from_bits(sum.to_bits() + 1),
            (false, false) => f64::from_bits(sum.to_bits() - 1),
        };
        Some(odd as f32).filter(|x| x.is_finite())
    }
    fn to_f64_pair(self) -> (f64, f64) {
        (f64::from(self), 0.0)
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::I4F60;
    use proptest::prelude::*;

    #[test]
    fn norm_survives_components_whose_squares_do_not() {
        for size in [1e200, 1.0, 1e-200] {
            let norm = f64::norm(&[3.0 * size, 4.0 * size]);
            assert!((norm / (5.0 * size) - 1.0).abs() <= 2.0 * f64::EPSILON, "size={size}: {norm}");
        }
        for size in [1e30, 1.0, 1e-30] {
            let norm = f32::norm(&[3.0 * size, 4.0 * size]);
            assert!((norm / (5.0 * size) - 1.0).abs() <= 2.0 * f32::EPSILON, "size={size}: {norm}");
        }
        assert_eq!(f64::norm(&[0.0, 0.0, 0.0]), 0.0);
    }

    #[test]
    fn phases_are_fractions() {
        assert_eq!(f64::from_phase(1 << 63, 0), 0.5);
        assert_eq!(f64::from_phase(u64::MAX, 0), 1.0 - f64::EPSILON / 2.0);
        assert_eq!(f32::from_phase(u64::MAX, 0), 1.0 - f32::EPSILON / 2.0);
        assert_eq!(f32::from_phase(3, 64), 3.0);
        assert_eq!(f32::from_phase(1 << 62, -3), 0.25 / 8.0);
        assert_eq!(0.75_f64.to_phase(0), 3 << 62);
        assert_eq!(0.75_f32.to_phase(-10), 3 << 52);
        assert_eq!((-0.1_f64).to_phase(0), 0);
        assert_eq!(1.0_f32.to_phase(0), u64::MAX);
        // The ends of the domain, where 2^(exponent ± 64) is no normal f32.
        assert_eq!(f32::from_phase(1 << 63, -64), 2.0_f32.powi(-65));
        assert_eq!(f32::from_phase(3, -64), 3.0 * 2.0_f32.powi(-64).powi(2));
        assert_eq!(2.0_f32.powi(-100).to_phase(64), 1 << 28);
        assert_eq!(2.0_f32.powi(70).to_phase(-64), u64::MAX);
    }

    /// The bits against conversion and products: over the domain, at its ends and a little beyond.
    #[test]
    fn phases_are_the_same_by_bits_and_by_products() {
        let phases = (0..64).flat_map(|i| {
            let bit = 1_u64 << i;
            [bit, bit - 1, bit | 1, u64::MAX << i, 0x9e37_79b9_7f4a_7c15 >> i, 0x9e37_79b9_7f4a_7c15 << i]
        });
        for phase in phases {
            for exponent in -64..=64 {
                let (double, single) = (f64::from_phase(phase, exponent), f32::from_phase(phase, exponent));
                assert_eq!(double, super::phase::f64::from_beyond(phase, exponent), "{phase} 2^{exponent}");
                assert_eq!(single, super::phase::f32::from_beyond(phase, exponent), "{phase} 2^{exponent}");
                for back in [-exponent, exponent, 64, 63, 62, 61, 0, -64] {
                    for x in
                        [double, double.next_up(), -double, double * 1e-300, double * 1e300, 1.0 / double]
                    {
                        assert_eq!(x.to_phase(back), super::phase::f64::to_beyond(x, back), "{x} 2^{back}");
                    }
                    for x in [single, single.next_up(), -single, single * 1e-30, single * 1e-38, 1.0 / single]
                    {
                        assert_eq!(x.to_phase(back), super::phase::f32::to_beyond(x, back), "{x} 2^{back}");
                    }
                }
            }
        }
        for x in [0.0, -0.0, f64::NAN, f64::INFINITY, f64::NEG_INFINITY, f64::MIN_POSITIVE, 5e-324] {
            assert_eq!(x.to_phase(3), super::phase::f64::to_beyond(x, 3), "{x}");
        }
        for x in [0.0, -0.0, f32::NAN, f32::INFINITY, f32::NEG_INFINITY, f32::MIN_POSITIVE, 1e-45] {
            assert_eq!(x.to_phase(64), super::phase::f32::to_beyond(x, 64), "{x}");
        }
    }

    proptest! {
        /// To half a digit and what is spared, and in order. In units of 2⁻⁶⁴, which are exact in both.
        #[test]
        #[allow(
            clippy::cast_possible_truncation,
            clippy::cast_sign_loss,
            reason = "a fraction in units of 2⁻⁶⁴ is a whole number from 0 to 2⁶⁴"
        )]
        fn fractions_are_as_accurate_as_said(phase: u64, shift in 0..64_u32) {
            for phase in [phase, phase >> shift, u64::MAX - (phase >> shift), 0, 1, u64::MAX] {
                let off = |x: f64| (x.ldexp(64) as u128).abs_diff(phase.into()) as f64;
                let (double, single) = (f64::fraction(phase), f32::fraction(phase));
                let half_digit = |resolution: f64| phase as f64 * resolution.half();
                prop_assert!(off(double) <= half_digit(f64::EPSILON) + 1.0, "{}: {}", phase, double);
                let bound = half_digit(f32::EPSILON.into()) + 1.0.ldexp(32);
                prop_assert!(off(single.into()) <= bound, "{}: {}", phase, single);
                let next = phase.saturating_add(1 << shift);
                prop_assert!(double <= f64::fraction(next) && single <= f32::fraction(next));
                prop_assert_eq!(I4F60::fraction(phase), I4F60::from_phase(phase, 0));
                // And back: to the nearest phase of that many digits.
                let off = |back: Option<u64>| back.map_or(u64::MAX - phase, |back| back.abs_diff(phase));
                prop_assert!(off(double.place_to_phase()) <= 1 << 12, "{}: {}", phase, double);
                prop_assert!(off(single.place_to_phase()) <= 1 << 41, "{}: {}", phase, single);
            }
        }
    }

    #[test]
    fn places_beyond_one_have_no_phase() {
        for x in [1.0, 1.0 - f64::EPSILON / 2.0, 2.0, 1e300, f64::INFINITY] {
            assert_eq!(x.place_to_phase(), None, "{x}");
        }
        for x in [1.0, 1.0 - f32::EPSILON / 2.0, 2.0, 1e30, f32::INFINITY] {
            assert_eq!(x.place_to_phase(), None, "{x}");
        }
        assert_eq!((1.0 - f64::EPSILON).place_to_phase(), Some(u64::MAX << 12));
        assert_eq!((1.0 - f32::EPSILON).place_to_phase(), Some(u64::MAX << 41));
        let (below, one) =
            (I4F60::from_f64(1.0).unwrap() - I4F60::resolution(), I4F60::from_f64(1.0).unwrap());
        assert_eq!((below.place_to_phase(), one.place_to_phase()), (Some(below.to_phase(0)), None));
    }

    #[test]
    fn a_part_is_from_0_to_1() {
        for x in [0.0, f64::from_bits(1), 0.5, 1.0] {
            assert!(x.is_part(), "{x}");
        }
        for x in [0.0, f32::from_bits(1), 0.5, 1.0] {
            assert!(x.is_part(), "{x}");
        }
        for x in [-0.0, 1.0 + f64::EPSILON, -f64::from_bits(1), -0.5, 2.0, -1e300, f64::INFINITY, f64::NAN] {
            assert!(!x.is_part(), "{x}");
        }
        for x in [-0.0, 1.0 + f32::EPSILON, -0.5, f32::NEG_INFINITY, f32::NAN] {
            assert!(!x.is_part(), "{x}");
        }
        let fixed = |x: f64| I4F60::from_f64(x).unwrap();
        assert_eq!([-0.5, 0.0, 1.0, 1.5].map(|x| fixed(x).is_part()), [false, true, true, false]);
        assert_eq!(
            [-0.0, 0.0, 1.0, f64::NAN].map(|x| crate::Audited(x).is_part()),
            [false, true, true, false]
        );
    }

    #[test]
    fn scale_is_exact() {
        assert_eq!(3.0_f64.ldexp(-70), 3.0 / 2.0_f64.powi(70));
        assert_eq!(3.0_f32.ldexp(20), 3.0 * 1_048_576.0);
    }

    #[test]
    fn roots_of_negative_numbers_are_zero() {
        assert_eq!(Real::sqrt(-1.0_f64), 0.0);
        assert_eq!(Real::sqrt(-1.0_f32), 0.0);
        assert_eq!(Real::sqrt(2.0_f64), 2.0_f64.sqrt());
        assert!(Real::sqrt(f64::NAN).is_nan() && Real::sqrt(f32::NAN).is_nan());
        assert!(f64::norm(&[f64::NAN, 1.0]).is_nan());
    }

    /// A quotient may lie 2⁻⁵⁶ beside a tie of f32: rounded to f64 first it would become that tie.
    #[test]
    fn ratios_are_rounded_once() {
        // n/d against m = M·2^e, a tie: |n - m·d| must change sign where the result does. Checked in integers.
        let nearest = |n: i32, d: i32| {
            let found = f32::from_ratio(n, d);
            // found = M·2^e with e < 0 for the quotients below: |n·2^-e - M·d| <= d/2.
            let bits = found.abs().to_bits();
            let (mantissa, e) = (i128::from(bits & 0x7f_ffff | 0x80_0000), (bits >> 23).cast_signed() - 150);
            let (n, d) = (i128::from(n.unsigned_abs()), i128::from(d.unsigned_abs()));
            let (n, m) = if e < 0 { (n << -e, mantissa * d) } else { (n, (mantissa << e) * d) };
            let unit = if e < 0 { d } else { d << e };
            assert!(2 * (n - m).abs() <= unit, "{n} / {d}: {found}");
        };
        // Denominators near 2^31 with numerators next to odd multiples of d/2^25.
        for k in 0..20_000_i64 {
            let d = i64::from(i32::MAX) - 2 * k;
            let tie = (1 << 24) + 2 * k + 1; // 25 bits, odd: between two numbers of f32
            for near in [(tie * d) >> 25, ((tie * d) >> 25) + 1] {
                nearest(i32::try_from(near).unwrap(), i32::try_from(d).unwrap());
                nearest(i32::try_from(near).unwrap(), -i32::try_from(d).unwrap());
            }
        }
        assert_eq!(f32::from_ratio(1, 3), 1.0 / 3.0);
        assert_eq!(f32::from_ratio(i32::MIN, i32::MIN), 1.0);
        assert_eq!(f32::from_ratio(-i32::MAX, 1), -2_147_483_648.0);
        assert!(f32::from_ratio(i32::MAX, 0).is_infinite());
    }

    #[test]
    fn pairs_are_rounded_once() {
        let tie = 1.0 + f64::from(f32::EPSILON) / 2.0;
        let (even, odd) = (Some(1.0), Some(1.0 + f32::EPSILON));
        assert_eq!(f32::from_f64_pair(tie, 0.0), even);
        assert_eq!(f32::from_f64_pair(tie, 1e-30), odd);
        assert_eq!(f32::from_f64_pair(-tie, -1e-30), odd.map(|x: f32| -x));
        assert_eq!(f32::from_f64_pair(tie, -1e-30), even);
        // One unit of f64 beside the tie, and the rest of it in `low`.
        assert_eq!(f32::from_f64_pair(tie.next_up(), -1.1e-16), odd);
        assert_eq!(f32::from_f64_pair(tie.next_down(), 1.1e-16), even);
        assert_eq!(f32::from_f64_pair(0.0, 1e-300), Some(0.0));
    }

    #[test]
    fn a_value_out_of_range_is_not_converted() {
        assert_eq!(f32::from_f64(1e300), None);
        assert_eq!(f64::from_f64(f64::NAN), None);
        assert_eq!(f32::from_f64(0.1), Some(0.1_f32));
    }
}
