//! The least value of a function on an interval, without derivatives.

use real::Real;

/// The result of a search.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Least<R, T> {
    /// The place of the least value found.
    pub at: R,
    /// The result of `of` there.
    pub found: T,
    /// Where the interval of the minimum begins, if the function has only one minimum.
    pub from: R,
    /// Where that interval ends.
    pub to: R,
}

/// Finds where `value(of(x))` is least on [from, to], by golden sections. Each of the `sections` makes the interval
/// 0.618 times as wide and evaluates `of` once; two evaluations come before the first.
///
/// If the function has several minima, one of them is found. The ends themselves are not tried.
///
/// # Source
/// Kiefer, "Sequential minimax search for a maximum", Proceedings of the American Mathematical Society 4, 1953.
pub fn golden_section<R: Real, T>(
    (mut from, mut to): (R, R),
    sections: usize,
    mut of: impl FnMut(R) -> T,
    value: impl Fn(&T) -> R,
) -> Least<R, T> {
    let golden = (R::from_ratio(5, 4).sqrt() - R::one().half()).min(R::one()); // (√5 - 1)/2
    let mut try_at = |x: R| (x, of(x));
    let mut low = try_at(to - (to - from) * golden);
    let mut high = try_at(from + (to - from) * golden);
    for _ in 0..sections {
        if value(&low.1) < value(&high.1) {
            to = high.0;
            high = low;
            low = try_at(to - (to - from) * golden);
        } else {
            from = low.0;
            low = high;
            high = try_at(from + (to - from) * golden);
        }
    }
    let (at, found) = if value(&low.1) < value(&high.1) { low } else { high };
    Least { at, found, from, to }
}

#[cfg(test)]
mod tests {
    use super::*;
    use proptest::prelude::*;
    use real::{Backend, I4F28};

    proptest! {
        #[test]
        fn the_least_place_is_in_an_interval_of_the_width_said(place in -1.0..2.0_f64, sections in 0_usize..40) {
            let mut asked = 0;
            let least = golden_section((-1.0, 2.0), sections, |x: f64| { asked += 1; (x - place).abs() }, |y| *y);
            prop_assert_eq!(asked, sections + 2);
            prop_assert!(least.from <= place && place <= least.to, "{:?}", least);
            let width = 3.0 * 0.618_033_988_749_895_f64.powi(i32::try_from(sections).unwrap());
            prop_assert!((least.to - least.from - width).abs() <= 1e-9, "{:?}", least);
            prop_assert!(least.from <= least.at && least.at <= least.to);
            prop_assert_eq!(least.found, (least.at - place).abs());
        }
    }

    #[test]
    fn a_format_without_room_above_one_finds_it_too() {
        let number = |x: f64| I4F28::from_f64(x).unwrap();
        let least = golden_section((number(0.0), number(1.0)), 30, |x| (x - number(0.3)).abs(), |y| *y);
        assert!((least.at - number(0.3)).abs() < number(1e-6), "{least:?}");
    }
}
