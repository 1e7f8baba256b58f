//! Every operation of the toy format I4F4 on every operand, against exact rationals.
//!
//! The expected value is the exact one, rounded by the tie rule and fitted by the overflow rule of the table at
//! [`Real`]; nothing here shares code with the crate.

use num_rational::Ratio;
use num_traits::{Bounded, One, Zero};
use real::{Backend, I4F4, Real};

type Exact = Ratio<i64>;

fn number(bits: i8) -> I4F4 {
    I4F4::from_bits(bits)
}

/// The value in units of the resolution, 2⁻⁴.
fn units(bits: i8) -> Exact {
    Exact::from_integer(bits.into())
}

fn all() -> impl Iterator<Item = i8> + Clone {
    i8::MIN..=i8::MAX
}

fn pairs() -> impl Iterator<Item = (i8, i8)> {
    all().flat_map(|a| all().map(move |b| (a, b)))
}

fn half() -> Exact {
    Exact::new(1, 2)
}

fn nearest_ties_up(x: Exact) -> i64 {
    (x + half()).floor().to_integer()
}

fn nearest_ties_away(x: Exact) -> i64 {
    let magnitude = (if x < Exact::zero() { -x } else { x } + half()).floor().to_integer();
    if x < Exact::zero() { -magnitude } else { magnitude }
}

fn nearest_ties_to_even(x: Exact) -> i64 {
    let up = nearest_ties_up(x);
    if x + half() == Exact::from_integer(up) && up % 2 != 0 { up - 1 } else { up }
}

fn wrapped(units: i64) -> i8 {
    i8::try_from((units + 128).rem_euclid(256) - 128).expect("reduced")
}

fn saturated(units: i64) -> i8 {
    i8::try_from(units.clamp(-128, 127)).expect("clamped")
}

/// The integer k nearest to √x, x in square units: `(k - ½)² < x < (k + ½)²`.
fn is_nearest_root(k: i64, x: i64) -> bool {
    k >= 0 && x <= k * k + k && (k == 0 || x > k * k - k)
}

#[test]
fn sums_and_differences_wrap() {
    for (a, b) in pairs() {
        let (x, y) = (i64::from(a), i64::from(b));
        assert_eq!((number(a) + number(b)).to_bits(), wrapped(x + y), "{a} + {b}");
        assert_eq!((number(a) - number(b)).to_bits(), wrapped(x - y), "{a} - {b}");
    }
    for a in all() {
        assert_eq!((-number(a)).to_bits(), wrapped(-i64::from(a)), "-{a}");
    }
}

#[test]
fn products_go_to_nearest_ties_up_and_wrap() {
    for (a, b) in pairs() {
        let exact = units(a) * units(b) / 16;
        assert_eq!((number(a) * number(b)).to_bits(), wrapped(nearest_ties_up(exact)), "{a} * {b}");
    }
}

#[test]
fn quotients_go_to_nearest_ties_away_and_saturate() {
    for (a, b) in pairs() {
        let quotient = (number(a) / number(b)).to_bits();
        let expected = if b == 0 {
            saturated(1000 * i64::from(a))
        } else {
            saturated(nearest_ties_away(units(a) * 16 / units(b)))
        };
        assert_eq!(quotient, expected, "{a} / {b}");
    }
}

/// All 16 777 216 triples: in integers, as the exact value is a multiple of 1/16 unit.
#[test]
fn mul_add_rounds_once_ties_up_and_wraps() {
    for (a, b) in pairs() {
        for c in all() {
            let sixteenths = i64::from(a) * i64::from(b) + 16 * i64::from(c);
            let expected = wrapped((sixteenths + 8).div_euclid(16));
            assert_eq!(number(a).mul_add(number(b), number(c)).to_bits(), expected, "{a} * {b} + {c}");
        }
    }
}

/// All first pairs with every 37th of the second pairs, and sums so long that the accumulator wraps.
#[test]
fn sums_of_products_round_once_ties_up_and_wrap() {
    let second: Vec<(i8, i8)> = pairs().step_by(37).collect();
    for (i, (a, b)) in pairs().enumerate() {
        for (c, d) in second.iter().copied().skip(i % 61).step_by(61) {
            let exact = (units(a) * units(b) + units(c) * units(d)) / 16;
            let sum = I4F4::sum_of_products([(number(a), number(b)), (number(c), number(d))]);
            assert_eq!(sum.to_bits(), wrapped(nearest_ties_up(exact)), "{a}*{b} + {c}*{d}");
        }
        let long = I4F4::sum_of_products([(number(a), number(b)); 9]);
        assert_eq!(long.to_bits(), wrapped(nearest_ties_up(units(a) * units(b) * 9 / 16)), "9 * {a} * {b}");
    }
    assert!(I4F4::sum_of_products([]).is_zero());
}

#[test]
fn roots_go_to_nearest_and_are_zero_below_zero() {
    for a in all() {
        let root = i64::from(number(a).sqrt().to_bits());
        assert!(is_nearest_root(root, 16 * i64::from(a).max(0)), "√{a}: {root}");
    }
}

#[test]
fn norms_go_to_nearest_and_saturate() {
    for (a, b) in pairs() {
        let squares = i64::from(a).pow(2) + i64::from(b).pow(2);
        let norm = i64::from(I4F4::norm(&[number(a), number(b)]).to_bits());
        let right = if norm == 127 { squares > 127 * 127 - 127 } else { is_nearest_root(norm, squares) };
        assert!(right, "‖{a}, {b}‖: {norm}");
        // Five components: the sum of squares leaves sixteen bits.
        let five = [a, b, a, b, a].map(number);
        let squares = 2 * squares + i64::from(a).pow(2);
        let norm = i64::from(I4F4::norm(&five).to_bits());
        let right = if norm == 127 { squares > 127 * 127 - 127 } else { is_nearest_root(norm, squares) };
        assert!(right, "‖{five:?}‖: {norm}");
    }
    assert!(I4F4::norm::<0>(&[]).is_zero());
}

#[test]
fn scaling_goes_to_nearest_ties_up_and_wraps() {
    for a in all() {
        for exponent in -126..=126_i32 {
            let expected = if exponent >= 0 {
                wrapped(if exponent < 8 { i64::from(a) << exponent } else { 0 })
            } else if exponent >= -40 {
                wrapped(nearest_ties_up(units(a) / (1 << -exponent)))
            } else {
                0
            };
            assert_eq!(number(a).ldexp(exponent).to_bits(), expected, "{a} * 2^{exponent}");
        }
        assert_eq!(number(a).half(), number(a).ldexp(-1));
    }
}

#[test]
fn ratios_go_to_nearest_ties_away_and_saturate() {
    let numbers = || (-300..=300).chain([i32::MIN, i32::MIN + 1, -65_537, 65_537, i32::MAX - 1, i32::MAX]);
    for n in numbers() {
        for d in numbers() {
            let expected = if d == 0 {
                saturated(1000 * i64::from(n))
            } else {
                saturated(nearest_ties_away(Exact::new(16 * i64::from(n), d.into())))
            };
            assert_eq!(I4F4::from_ratio(n, d).to_bits(), expected, "{n} / {d}");
        }
    }
}

/// Every multiple of an eighth of a unit across the range and beyond, alone and moved by the least `low`.
#[test]
fn floats_go_to_nearest_ties_to_even_or_are_refused() {
    for eighths in -1100..=1100_i64 {
        let float = eighths as f64 / 128.0;
        let expect = |exact: i64| i8::try_from(exact).ok();
        let exact = Exact::new(eighths, 8);
        assert_eq!(I4F4::from_f64(float).map(I4F4::to_bits), expect(nearest_ties_to_even(exact)), "{float}");
        for (low, moved) in [(1e-300, Exact::new(1, 1000)), (-1e-300, Exact::new(-1, 1000))] {
            let found = I4F4::from_f64_pair(float, low).map(I4F4::to_bits);
            assert_eq!(found, expect(nearest_ties_to_even(exact + moved)), "{float} + {low}");
        }
    }
    for none in [f64::NAN, f64::INFINITY, f64::NEG_INFINITY, 1e300, -1e300] {
        assert_eq!(I4F4::from_f64(none), None);
    }
    for a in all() {
        assert_eq!(number(a).to_f64(), f64::from(a) / 16.0);
        assert_eq!(number(a).to_f64_pair(), (f64::from(a) / 16.0, 0.0));
        assert_eq!(I4F4::from_f64(number(a).to_f64()), Some(number(a)));
    }
}

/// `⌊phase · 2^(exponent - 64) / 2⁻⁴⌋` and back, saturated.
#[test]
fn phases_are_cut_and_saturate() {
    let phases = [0, 1, 3, 1 << 31, 0xdead_beef_1234_5678, 1 << 60, (1 << 63) - 1, 1 << 63, u64::MAX];
    for exponent in -64..=64_i32 {
        let shift =
            |x: u128, by: i32| if by >= 0 { x << by } else { x.checked_shr(by.unsigned_abs()).unwrap_or(0) };
        for phase in phases {
            let exact = shift(phase.into(), exponent - 60);
            let expected = i8::try_from(exact).unwrap_or(i8::MAX);
            assert_eq!(
                I4F4::from_phase(phase, exponent).to_bits(),
                expected,
                "{phase} * 2^({exponent} - 64)"
            );
        }
        for a in all() {
            let exact = shift(u128::from(a.max(0).unsigned_abs()), (60 + exponent).min(120));
            assert_eq!(
                number(a).to_phase(exponent),
                u64::try_from(exact).unwrap_or(u64::MAX),
                "{a} * 2^{exponent}"
            );
        }
    }
}

#[test]
fn order_is_that_of_the_values() {
    for (a, b) in pairs() {
        let (x, y) = (number(a), number(b));
        assert_eq!(x.partial_cmp(&y), Some(a.cmp(&b)), "{a} ? {b}");
        assert_eq!(x == y, a == b, "{a} ? {b}");
        assert_eq!((Real::max(x, y), Real::min(x, y)), (number(a.max(b)), number(a.min(b))), "{a} ? {b}");
    }
    for a in all() {
        assert_eq!(number(a).abs().to_bits(), a.wrapping_abs(), "|{a}|");
        assert_eq!(number(a).is_zero(), a == 0);
        assert!(number(a).is_finite());
        assert_eq!(number(a).signal("a"), number(a));
    }
}

#[test]
fn constants() {
    assert_eq!(I4F4::zero().to_bits(), 0);
    assert_eq!(I4F4::one().to_bits(), 16);
    assert_eq!(I4F4::resolution().to_bits(), 1);
    assert_eq!((I4F4::min_value().to_bits(), I4F4::max_value().to_bits()), (-128, 127));
    assert_eq!(I4F4::name().to_string(), "I4F4");
}
