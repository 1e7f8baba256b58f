//! The short row of a straight piece, in which nothing is stored that its direction implies.
//!
//! On a straight piece without weights only n_1 is not 0, and the speed is even. So both ends of the range of steps per chord are
//! `1/|C'|` with the margin 17/16, and the greatest is `(17/16)² = 289/256` of the least. Roundings may put it some words beside
//! that; the row has how many.

#[cfg(feature = "std")]
use real::Backend;
use real::{FromWord, Real, word_of};

/// 289/256 of the least step per chord.
fn greatest_of<R: Real>(least: R) -> R {
    least.mul_add(R::from_ratio(33, 256), least)
}

/// By how many words the greatest step per chord of a straight piece exceeds what the least implies.
#[cfg(feature = "std")]
pub(crate) fn words_beside<R: Backend>([least, greatest]: [R; 2]) -> i64 {
    word_of(greatest).wrapping_sub(word_of(greatest_of(least))).cast_signed()
}

/// The range of steps per chord of a straight piece whose greatest lies so many words beside what the least implies.
pub(crate) fn range<R: FromWord>(least: R, beside: i64) -> [R; 2] {
    [least, R::from_word(word_of(greatest_of(least)).wrapping_add(beside.cast_unsigned()))]
}

/// Whether these are the coefficients of a straight piece: n_1 alone, and the weights 1, 0, 0 ... or none. A coefficient of -0 counts
/// as not 0: a short row would give it back as 0. `Pieces::is_straight`, which asks for values and not for bits, takes it.
#[cfg(feature = "std")]
pub(crate) fn is_straight<R: Backend, const D: usize>(numerators: &[[R; D]], weights: &[R]) -> bool {
    let is_zero = |x: &R| word_of(*x) == 0;
    let constant = weights.first().is_none_or(|weight| *weight == R::one());
    constant && weights.iter().skip(1).all(is_zero) && numerators.iter().skip(1).flatten().all(is_zero)
}

#[cfg(all(test, feature = "std"))]
mod tests {
    use super::*;
    use proptest::prelude::*;
    use real::{I2F30, I4F28, I4F60, I16F48};

    /// The range as a piece of this speed has it, and by how many words its greatest lies beside.
    fn of_speed<R: FromWord>(speed: f64) -> ([R; 2], i64) {
        let range = [1.0 / (speed * 1.0625), 1.0625 / speed].map(|sigma| R::from_f64(sigma).unwrap());
        (range, words_beside(range))
    }

    fn comes_back<R: FromWord>(speed: f64, most: i64) {
        let (whole, beside) = of_speed::<R>(speed);
        assert_eq!(range(whole[0], beside), whole, "{}", R::name());
        assert!(beside.abs() <= most, "{}: {beside} words", R::name());
    }

    proptest! {
        /// Steps per chord are between 1/√2 and √2 in fixed point. The range is computed in f64, so that
        /// in I4F60 its greatest may be up to 2¹⁰ words off.
        #[test]
        fn a_range_comes_back_from_its_least_and_a_few_words(speed in 0.71_f64..1.41, scale in -60..60_i32) {
            comes_back::<I4F28>(speed, 2);
            comes_back::<I2F30>(speed, 2);
            comes_back::<I16F48>(speed, 2);
            comes_back::<I4F60>(speed, 1 << 10);
            comes_back::<f32>(speed.ldexp(scale), 3);
            comes_back::<f64>(speed.ldexp(scale), 6);
        }
    }

    #[test]
    fn straight_is_what_has_one_coefficient_and_no_weight() {
        let n = |second: f64| [[1.0, -2.0], [0.0, second], [0.0, 0.0]];
        assert!(is_straight(&n(0.0), &[]) && is_straight(&n(0.0), &[1.0, 0.0, 0.0, 0.0]));
        assert!(!is_straight(&n(1e-9), &[]) && !is_straight(&n(0.0), &[1.0, 0.0, 1e-9, 0.0]));
        assert!(!is_straight(&n(0.0), &[0.5, 0.0, 0.0, 0.0]) && !is_straight(&n(-0.0), &[]));
    }
}
