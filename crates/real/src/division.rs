//! Integer division of a double word by a word, by Newton's reciprocal: fixed-point `/` calls it.
//!
//! A processor of W bits multiplies two words into a double word in a few cycles, but divides a double word by
//! a word, if at all, by a library routine that yields a bit or two per turn. The reciprocal costs
//! 2·log₂W − 3 multiplications instead, and the quotient four more; the remainder then makes it exact.
//!
//! # Derivation
//! Let `β = 2^W` and let the divisor be shifted left until its top bit is set, the numerator with it, so that
//! the quotient stays. Then `D = d/β ∈ [½, 1)` and `X = 1/D ∈ (1, 2]`, held in units of `2^(1-W)`.
//!
//! 1. *Start.* The line `X₀ = 48/17 − 32/17·D` has the least possible relative error on [½, 1]: `1/17`.
//! 2. *Newton's step* `X ← X·(2 − D·X)` squares that error `e = 1 − D·X`: as `17² > 2⁸`, log₂W − 2 steps bring
//!    it below `2^-W`. The bracket is rounded down by at most two units and the product by one, so X stays below
//!    1/D, never reaches β, and ends at most 4 units below 1/D, the last square included.
//! 3. *Quotient.* Of the numerator `n = n₁β + n₀ < dβ` the high word gives `q = ⌊n₁·X⌋`, too small by less than
//!    11: less than 8 by X, 1 by the rounding, 2 by n₀.
//! 4. *The rest.* The remainder `r = n − q·d < 11d` is divided in the same way. Its four low bits are left out, so that
//!    it fits a word. The second quotient is too small by less than `15/d + 11·4·2/β + 1 < 2` for W ≥ 8, so by one at
//!    most.
//! 5. *The last unit.* If the remainder is still at least d, the quotient grows by one. Quotient and remainder are now
//!    exact.
//!
//! There is no loop whose length depends on the operands, no table, and one condition.
//!
//! Some machines make a product of 64-bit words from four products of 32 bits; early steps in full width would waste
//! them. So for W = 64 the reciprocal of the divisor's upper half is the start. It is off by at most 4 units of `2^-31`
//! to either side, half a unit of the divisor included. One Newton step leaves 64 units of `2^-63`, and rounding adds
//! 3. The quotient is then too small by less than 2·67 + 3 < 2⁸, so step 4 leaves out eight bits instead of four.

#![allow(
    clippy::cast_possible_truncation,
    clippy::cast_lossless,
    reason = "words are split into halves and joined again; each cast takes the half it names"
)]

macro_rules! division {
    ($word:ident, $double:ident, start: $start:expr, steps: $steps:expr, slack: $slack:literal) => {
        pub(crate) mod $word {
            const WIDTH: u32 = $word::BITS;
            /// Bits by which the remainder of the first quotient is longer than a word.
            const SLACK: u32 = $slack;

            #[inline]
            const fn high(a: $word, b: $word) -> $word {
                ((a as $double * b as $double) >> WIDTH) as $word
            }

            /// `48/17 − 32/17·D` in units of `2^(1-W)`. The first term is taken modulo β: the difference fits again.
            #[allow(dead_code, reason = "64 bits start from the reciprocal of 32")]
            #[inline]
            pub(super) const fn line(divisor: $word) -> $word {
                const INTERCEPT: $word = (48 * (1_u128 << (WIDTH - 1)) / 17) as $word;
                const SLOPE: $word = (32 * (1_u128 << (WIDTH - 1)) / 17) as $word;
                INTERCEPT.wrapping_sub(high(SLOPE, divisor))
            }

            /// `1/D` in units of `2^(1-W)` for `D = divisor/2^W`, never too large; too small by at most 4 units, or
            /// 67 for 64 bits.
            ///
            /// Domain: the top bit of `divisor` is set.
            #[inline]
            pub(crate) const fn reciprocal(divisor: $word) -> $word {
                debug_assert!(divisor >> (WIDTH - 1) == 1, "the divisor is normalised");
                let mut x = $start(divisor);
                let mut step = 0;
                while step < $steps {
                    let bracket = !high(divisor, x);
                    x = ((x as $double * bracket as $double) >> (WIDTH - 1)) as $word;
                    step += 1;
                }
                x
            }

            /// Quotient and remainder.
            ///
            /// Domain: `numerator < divisor · 2^W`, so that the quotient fits a word; hence `divisor ≠ 0`.
            #[inline]
            pub(crate) const fn divide(numerator: $double, divisor: $word) -> ($word, $word) {
                debug_assert!(numerator >> WIDTH < divisor as $double, "the quotient fits a word");
                let shift = divisor.leading_zeros();
                let (n, d) = (numerator << shift, divisor << shift);
                let x = reciprocal(d);
                let first = (((n >> WIDTH) as $word as $double * x as $double) >> (WIDTH - 1)) as $word;
                let rest = n - first as $double * d as $double;
                let second = (rest >> SLACK) as $word as $double * x as $double;
                let second = (second >> (2 * WIDTH - 1 - SLACK)) as $word;
                let rest = rest - second as $double * d as $double;
                let more = rest >= d as $double;
                let rest = if more { rest - d as $double } else { rest };
                (first + second + more as $word, (rest >> shift) as $word)
            }
        }
    };
}

#[cfg(test)]
division!(u8, u16, start: line, steps: 1, slack: 4);
#[cfg(test)]
division!(u16, u32, start: line, steps: 2, slack: 4);
division!(u32, u64, start: line, steps: 3, slack: 4);
division!(u64, u128, start: super::upper_half, steps: 1, slack: 8);

/// The reciprocal of the upper half of a divisor, in units of `2^-63`.
#[inline]
const fn upper_half(divisor: u64) -> u64 {
    (u32::reciprocal((divisor >> 32) as _) as u64) << 32
}

/// Quotient and remainder of a double word over a word of 32 bits, the quotient known to fit a word: by the machine
/// where it divides 64 bits, by Newton's reciprocal where that is a library routine.
#[inline]
pub(crate) fn divide_u64(numerator: u64, divisor: u64) -> (u64, u64) {
    if cfg!(target_pointer_width = "64") {
        (numerator / divisor, numerator % divisor)
    } else {
        let (quotient, remainder) = u32::divide(numerator, divisor as _);
        (quotient.into(), remainder.into())
    }
}

/// Quotient and remainder of a double word over a word of 64 bits, the quotient known to fit a word. Only x86-64
/// divides 128 bits by an instruction.
#[inline]
pub(crate) fn divide_u128(numerator: u128, divisor: u128) -> (u128, u128) {
    if cfg!(target_arch = "x86_64") {
        let quotient = numerator / divisor;
        (quotient, numerator - quotient * divisor)
    } else {
        let (quotient, remainder) = u64::divide(numerator, divisor as _);
        (quotient.into(), remainder.into())
    }
}

#[cfg(test)]
mod tests {
    use proptest::prelude::*;

    /// Every divisor of 8 bits with every numerator whose quotient fits: the steps' bounds are tightest here.
    #[test]
    fn eight_bits_are_divided_exactly() {
        for d in 1..=u8::MAX {
            for n in 0..u16::from(d) << 8 {
                let (q, r) = (n / u16::from(d), n % u16::from(d));
                assert_eq!(super::u8::divide(n, d), (q as u8, r as u8), "{n} / {d}");
            }
        }
    }

    /// Every divisor of 16 bits, with numerators on both sides of multiples of it and spread between.
    #[test]
    fn sixteen_bits_are_divided_exactly() {
        for d in 1..=u16::MAX {
            let end = u32::from(d) << 16;
            let multiples = [0, 1, 2, 0x7fff, 0x8000, 0xfffe, 0xffff].map(|q: u32| q * u32::from(d));
            let near = multiples.iter().flat_map(|&m| [m.wrapping_sub(1), m, m.wrapping_add(1)]);
            let spread = (0..8).map(|i: u32| (u64::from(end) * u64::from(i * 977 % 7919) / 7919) as u32);
            for n in near.chain(spread).chain([end - 1]).filter(|&n| n < end) {
                let (q, r) = (n / u32::from(d), n % u32::from(d));
                assert_eq!(super::u16::divide(n, d), (q as u16, r as u16), "{n} / {d}");
            }
        }
    }

    /// 1/D is approached from below and to 4 units: all divisors of 8 and 16 bits.
    #[test]
    fn the_reciprocal_is_four_units_low_at_most() {
        for d in 1 << 7..=u8::MAX {
            let (x, exact) = (u32::from(super::u8::reciprocal(d)), f64::from(1_u32 << 15) / f64::from(d));
            assert!(f64::from(x) < exact && exact <= f64::from(x + 4), "1/{d}: {x}, not {exact}");
        }
        for d in 1 << 15..=u16::MAX {
            let (x, exact) = (u32::from(super::u16::reciprocal(d)), f64::from(1_u32 << 31) / f64::from(d));
            assert!(f64::from(x) < exact && exact <= f64::from(x + 4), "1/{d}: {x}, not {exact}");
        }
    }

    proptest! {
        #![proptest_config(ProptestConfig::with_cases(20_000))]

        #[test]
        fn the_wide_reciprocals_are_low_by_what_is_promised(d: u64) {
            let d64 = d | 1 << 63;
            let x = u128::from(super::u64::reciprocal(d64));
            // x < 2¹²⁷/d ≤ x + 67, without division.
            prop_assert!(x * u128::from(d64) < 1 << 127 && (x + 67) * u128::from(d64) >= 1 << 127, "1/{d64}: {x}");
            let d32 = (d64 >> 32) as u32;
            let x = u64::from(super::u32::reciprocal(d32));
            prop_assert!(x * u64::from(d32) < 1 << 63 && (x + 4) * u64::from(d32) >= 1 << 63, "1/{d32}: {x}");
        }

        #[test]
        fn thirty_two_bits_are_divided_exactly(d: u32, size in 0_u32..32, q: u32, r: u32) {
            let d = (d >> size).max(1);
            let r = r % d;
            for r in [0, r, d - 1] {
                let n = u64::from(q) * u64::from(d) + u64::from(r);
                prop_assert_eq!(super::u32::divide(n, d), (q, r));
            }
        }

        #[test]
        fn sixty_four_bits_are_divided_exactly(d: u64, size in 0_u32..64, q: u64, r: u64) {
            let d = (d >> size).max(1);
            let r = r % d;
            for r in [0, r, d - 1] {
                let n = u128::from(q) * u128::from(d) + u128::from(r);
                prop_assert_eq!(super::u64::divide(n, d), (q, r));
            }
        }
    }
}
