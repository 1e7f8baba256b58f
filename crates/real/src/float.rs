//! The float backends: `f64` and `f32`, with IEEE 754 semantics.

use crate::{Backend, FormatName, Real};

#[cfg(not(any(feature = "std", feature = "libm")))]
compile_error!("enable the feature `std` or `libm`: core has no square root of floats");

macro_rules! float_backend {
    ($float:ident, $digits:literal, $half_range:literal) => {
        impl Real for $float {
            #[inline]
            fn resolution() -> Self {
                $float::EPSILON
            }

            #[inline]
            fn from_ratio(numerator: i32, denominator: i32) -> Self {
                #[allow(
                    clippy::cast_possible_truncation,
                    reason = "both integers are exact in f64; the quotient is rounded to the format"
                )]
                {
                    (f64::from(numerator) / f64::from(denominator)) as $float
                }
            }

            #[inline]
            fn mul_add(self, factor: Self, addend: Self) -> Self {
                self * factor + addend
            }

            #[inline]
            fn sum_of_products(pairs: impl IntoIterator<Item = (Self, Self)>) -> Self {
                pairs.into_iter().fold(0.0, |sum, (a, b)| sum + a * b)
            }

            /// The plain sum of squares serves unless it has left the range in which squares keep their
            /// precision; only then are the components first scaled by a power of two.
            #[inline]
            fn norm<const N: usize>(vector: &[Self; N]) -> Self {
                let squared = |exponent: i32| {
                    vector.iter().map(|v| v.scale(exponent)).fold(0.0, |sum: $float, v| sum + v * v)
                };
                let sum = squared(0);
                if sum < $float::MIN_POSITIVE / $float::EPSILON {
                    Real::sqrt(squared($half_range)).scale(-$half_range)
                } else if sum > $float::MAX {
                    Real::sqrt(squared(-$half_range)).scale($half_range)
                } else {
                    Real::sqrt(sum)
                }
            }

            #[inline]
            fn sqrt(self) -> Self {
                if self > 0.0 { square_root::$float(self) } else { 0.0 }
            }

            #[inline]
            fn scale(self, exponent: i32) -> Self {
                self * power_of_two::$float(exponent)
            }

            #[inline]
            #[allow(clippy::cast_precision_loss, reason = "as many leading bits are kept as the format has")]
            fn from_phase(phase: u64, exponent: i32) -> Self {
                let surplus = 64 - $digits;
                let dropped = surplus - phase.leading_zeros().min(surplus);
                ((phase >> dropped << dropped) as $float).scale(exponent.clamp(-64, 64) - 64)
            }

            #[inline]
            #[allow(
                clippy::cast_possible_truncation,
                clippy::cast_sign_loss,
                reason = "the cast rounds toward 0 and saturates, as the contract says"
            )]
            fn to_phase(self, exponent: i32) -> u64 {
                self.scale(64 + exponent.clamp(-64, 58)) as u64
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

/// `2^exponent`, exact; an exponent outside the format's normal range goes to its nearest normal power.
mod power_of_two {
    pub(super) fn f64(exponent: i32) -> f64 {
        f64::from_bits(u64::from((exponent.clamp(-1022, 1023) + 1023).unsigned_abs()) << 52)
    }
    pub(super) fn f32(exponent: i32) -> f32 {
        f32::from_bits((exponent.clamp(-126, 127) + 127).unsigned_abs() << 23)
    }
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
        // `high + low` is already rounded to 53 bits; a second rounding to 24 goes wrong only when those 53 bits
        // are a tie that `low` would have broken, so the tie is broken here.
        let rounded = high as f32;
        let tie_broken = if low != 0.0 { (high + low * 2.0) as f32 } else { rounded };
        let nearer = (f64::from(tie_broken) - high - low).abs() < (f64::from(rounded) - high - low).abs();
        Some(if nearer { tie_broken } else { rounded }).filter(|x| x.is_finite())
    }
    fn to_f64_pair(self) -> (f64, f64) {
        (f64::from(self), 0.0)
    }
}

#[cfg(test)]
mod tests {
    use super::*;

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
    }

    #[test]
    fn scale_is_exact() {
        assert_eq!(3.0_f64.scale(-70), 3.0 / 2.0_f64.powi(70));
        assert_eq!(3.0_f32.scale(20), 3.0 * 1_048_576.0);
    }

    #[test]
    fn roots_of_negative_numbers_are_zero() {
        assert_eq!(Real::sqrt(-1.0_f64), 0.0);
        assert_eq!(Real::sqrt(-1.0_f32), 0.0);
        assert_eq!(Real::sqrt(2.0_f64), 2.0_f64.sqrt());
    }

    #[test]
    fn a_value_out_of_range_is_not_converted() {
        assert_eq!(f32::from_f64(1e300), None);
        assert_eq!(f64::from_f64(f64::NAN), None);
        assert_eq!(f32::from_f64(0.1), Some(0.1_f32));
    }
}
