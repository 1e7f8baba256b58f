//! Integer square roots: fixed-point `sqrt` and `norm` call them.
//!
//! # Derivation
//! *64 bits.* The radicand is shifted left by an even number of bits until `A = a/2⁶⁴ ∈ [¼, 1)`. With Y an
//! estimate of `1/√A` and S one of `√A`, both always too small, of relative errors y and s:
//! 1. *Start.* A table over the leading bits of A gives `|y| < 1/57`.
//! 2. *Newton's step for the reciprocal root*, `Y ← Y·(3 − A·Y²)/2`, leaves `y < 3/2·(1/57)² + … < 1/2100`.
//! 3. *The root* `S = A·Y` has the same error. A Newton step for the root in which Y stands for the division,
//!    `S ← S + Y·(A − S²)/2`, makes it `s·y + s²/2 < 1/2 900 000`.
//! 4. The same step again makes it `s·y + … < 1.7e-10`: 0.7 units of `2^-32`.
//! 5. *The last unit.* Rounding down included, the integer s is at most one too small. The remainder `a − s²`, exact in
//!    64 bits, shows whether it is.
//!
//! *128 bits.* By halves (P. Zimmermann, *Karatsuba Square Root*, INRIA research report 3805, 1999): the root `s₁` of
//! the high half is the high half of the root. With its remainder `r₁` and the next 32 bits `a₁` the low half is
//! `⌊(r₁·2³² + a₁)/(2·s₁)⌋`, a [division](crate::division) of a double word by a word. This low half is at most one too
//! large; the remainder of the whole root shows whether it is.

#![allow(
    clippy::cast_possible_truncation,
    clippy::cast_possible_wrap,
    clippy::cast_sign_loss,
    clippy::cast_lossless,
    reason = "words are split into halves and joined again; each cast takes the half it names"
)]

use crate::division::divide_u64;

/// `⌊2⁸/√A⌋ − 2⁸` in the middle of each 64th of [¼, 1): entry i is for `A ∈ [(16+i)/64, (17+i)/64)`.
///
/// The size is a trade: half the entries would need a third step, twice as many would not save one.
const RECIPROCAL_ROOTS: [u8; 48] = {
    let mut table = [0; 48];
    let mut i = 0;
    while i < 48 {
        // A = (33 + 2i)/128, so 2⁸/√A = √(2²³/(33 + 2i)); from 257 to 504.
        table[i] = (((1_u64 << 23) / (33 + 2 * i as u64)).isqrt() - 256) as u8;
        i += 1;
    }
    table
};

/// `⌊√a⌋` and `a − ⌊√a⌋²`. Domain: one of the two top bits of `a` is set.
#[inline]
fn normalised_u64(a: u64) -> (u32, u64) {
    debug_assert!(a >> 62 != 0, "the radicand is normalised");
    let square = |x: u32| x as u64 * x as u64;
    let product = |x: u32, y: u32, shift: u32| ((x as u64 * y as u64) >> shift) as u32;
    let high = (a >> 32) as u32;
    // Units: y0 2^-8, product and bracket 2^-31, y 2^-30, s 2^-32.
    let y0 = 256 + RECIPROCAL_ROOTS[((high >> 26) as usize).clamp(16, 63) - 16] as u32;
    // Less 2: rounding A and the product down has raised the bracket by at most that.
    let bracket = (3 << 30) - (product(high, y0 * y0, 17) >> 1) - 2;
    let y = product(y0, bracket, 9);
    let s = product(high, y, 30);
    let s = s + product(((a - square(s)) >> 32) as u32, y, 31);
    let s = s + product(((a - square(s)) >> 16) as u32, y, 47);
    let (rest, twice) = (a - square(s), 2 * s as u64);
    if rest > twice { (s + 1, rest - twice - 1) } else { (s, rest) }
}

/// `⌊√a⌋` and `a − ⌊√a⌋²`. Domain: one of the two top bits of `a` is set.
#[inline]
fn normalised_u128(a: u128) -> (u64, u128) {
    let (s1, r1) = normalised_u64((a >> 64) as u64);
    let next = (a >> 32) as u32;
    let half = (r1 << 31) | (next >> 1) as u64; // (r₁·2³² + a₁)/2, over s₁
    // At r₁ = 2·s₁ the quotient is 2³², one more than the low half can be.
    let low = if half >> 32 >= s1 as u64 { u32::MAX } else { divide_u64(half, s1 as u64).0 as u32 };
    let s = (s1 as u64) << 32 | low as u64;
    let square = s as u128 * s as u128;
    if square > a { (s - 1, a - (square - (2 * s as u128 - 1))) } else { (s, a - square) }
}

macro_rules! square_root {
    ($double:ident, $word:ident, $normalised:ident) => {
        pub(crate) mod $double {
            /// Half the number of leading zeros, and the root and remainder of the radicand shifted by them.
            #[inline]
            fn parts(a: $double) -> (u32, ($word, $double)) {
                let half_shift = a.leading_zeros() / 2;
                (half_shift, super::$normalised(a << (2 * half_shift)))
            }

            /// `⌊√a⌋`.
            #[cfg(any(test, feature = "std"))]
            #[inline]
            pub(crate) fn floor(a: $double) -> $word {
                if a == 0 {
                    return 0;
                }
                let (half_shift, (root, _)) = parts(a);
                root >> half_shift
            }

            /// The integer nearest to `√a`; there are no ties, as `(k + ½)²` is no integer.
            #[inline]
            pub(crate) fn nearest(a: $double) -> $double {
                if a == 0 {
                    return 0;
                }
                let (half_shift, (root, rest)) = parts(a);
                let root = root as $double;
                if half_shift == 0 {
                    // (k + ½)² = k² + k + ¼: the upper neighbour is nearer from k² + k + 1 on.
                    return root + (rest > root) as $double;
                }
                // ⌊2ᵏ√a⌋ has further bits of √a, and the first of them decides.
                (root + (1 << (half_shift - 1))) >> half_shift
            }
        }
    };
}

square_root!(u64, u32, normalised_u64);
square_root!(u128, u64, normalised_u128);

#[cfg(test)]
mod tests {
    use proptest::prelude::*;

    fn check_u64(a: u64) {
        let root = a.isqrt();
        assert_eq!(u64::from(super::u64::floor(a)), root, "√{a}");
        assert_eq!(super::u64::nearest(a), root + u64::from(a - root * root > root), "√{a}");
    }

    fn check_u128(a: u128) {
        let root = a.isqrt();
        assert_eq!(u128::from(super::u128::floor(a)), root, "√{a}");
        assert_eq!(super::u128::nearest(a), root + u128::from(a - root * root > root), "√{a}");
    }

    #[test]
    fn the_table_starts_within_a_57th() {
        for (i, entry) in super::RECIPROCAL_ROOTS.into_iter().enumerate() {
            let y = 1.0 + f64::from(entry) / 256.0;
            for a in [16 + i, 17 + i] {
                let error = 1.0 - y * (a as f64 / 64.0).sqrt();
                assert!(error.abs() < 1.0 / 57.0, "entry {i} at {a}/64: {error}");
            }
        }
    }

    /// Around squares the floor jumps, around k² + k the nearest integer does.
    #[test]
    fn roots_are_exact_around_every_jump() {
        for k in (0..=u64::from(u16::MAX)).chain((0..1 << 20).map(|i| u64::from(u32::MAX) - i * 4095)) {
            for a in [k * k, k * k + k] {
                for a in [a.saturating_sub(1), a, a + 1] {
                    check_u64(a);
                }
            }
        }
        for k in (0..1 << 16).map(|i| u128::from(u64::MAX) - (i << 47) - i) {
            for a in [k * k, k * k + k] {
                for a in [a - 1, a, a + 1] {
                    check_u128(a);
                }
            }
        }
        check_u64(u64::MAX);
        check_u128(u128::MAX);
    }

    /// Every leading half that the normalised root can meet, in steps, with both extremes of the rest: the errors
    /// of the derivation are largest at the ends of the table's intervals.
    #[test]
    fn roots_are_exact_across_the_table() {
        for i in 0..48_u64 {
            for j in (0..1 << 12).chain((1 << 26) - (1 << 12)..1 << 26) {
                let high = (16 + i) << 26 | j;
                check_u64(high << 32);
                check_u64(high << 32 | 0xffff_ffff);
            }
        }
    }

    proptest! {
        #![proptest_config(ProptestConfig::with_cases(20_000))]

        #[test]
        fn roots_are_exact(a: u128, shift in 0_u32..128) {
            check_u128(a >> shift);
            check_u64((a >> 64) as u64 >> (shift / 2));
        }
    }
}
