//! Formats chosen at run time: small ones on every operand in every mode, against exact rationals, and wide ones
//! against the `fixed` crate's own operations.

#![cfg(feature = "std")]

use num_rational::Ratio;
use num_traits::{Bounded, One, Zero};
use proptest::prelude::*;
use real::{Backend, Overflow, Real, Rounding, RuntimeFixed, RuntimeFormat};

type Exact = Ratio<i128>;
type Number = RuntimeFixed<0>;

const OVERFLOWS: [Overflow; 2] = [Overflow::Wrap, Overflow::Saturate];

/// Where a tie goes with [`Rounding::Nearest`].
#[derive(Clone, Copy)]
enum Ties {
    Up,
    Away,
}

fn rounded(x: Exact, rounding: Rounding, ties: Ties) -> i128 {
    let up = (x + Exact::new(1, 2)).floor().to_integer();
    let tie = x + Exact::new(1, 2) == Exact::from_integer(up);
    match (rounding, ties) {
        (Rounding::Floor, _) => x.floor().to_integer(),
        (Rounding::TowardZero, _) => x.trunc().to_integer(),
        (Rounding::NearestEven, _) => up - i128::from(tie && up % 2 != 0),
        (Rounding::Nearest, Ties::Away) => up - i128::from(tie && x < Exact::zero()),
        (Rounding::Nearest, Ties::Up) => up,
    }
}

/// A format and what its results should be.
#[derive(Clone, Copy)]
struct Expect {
    width: u32,
    fraction_bits: u32,
    rounding: Rounding,
    overflow: Overflow,
}

impl Expect {
    fn format(self) -> RuntimeFormat {
        RuntimeFormat::with_any_point(self.width, self.fraction_bits, self.rounding, self.overflow)
            .expect("in the domain")
    }

    fn half_range(self) -> i128 {
        1 << (self.width - 1)
    }

    fn words(self) -> impl Iterator<Item = i64> + Clone {
        let half = i64::try_from(self.half_range()).expect("small");
        -half..half
    }

    fn saturated(self, units: i128) -> i128 {
        units.clamp(-self.half_range(), self.half_range() - 1)
    }

    /// Rounds a number of units, and fits it as sums and products are.
    fn fitted(self, units: Exact) -> i128 {
        let rounded = rounded(units, self.rounding, Ties::Up);
        match self.overflow {
            Overflow::Wrap => {
                (rounded + self.half_range()).rem_euclid(2 * self.half_range()) - self.half_range()
            }
            Overflow::Saturate => self.saturated(rounded),
        }
    }

    /// Rounds a number of units, and fits it as quotients are.
    fn quotient(self, units: Exact) -> i128 {
        self.saturated(rounded(units, self.rounding, Ties::Away))
    }

    /// `√square`: floor or, as there are no ties, the one integer within a half.
    fn root(self, square: i128) -> i128 {
        let floor = (0..).find(|k: &i128| (k + 1) * (k + 1) > square).expect("small");
        let nearest = matches!(self.rounding, Rounding::Nearest | Rounding::NearestEven);
        self.saturated(floor + i128::from(nearest && square > floor * floor + floor))
    }
}

fn units(word: i64) -> Exact {
    Exact::from_integer(word.into())
}

fn same(found: Number, expected: i128, what: impl std::fmt::Debug, format: RuntimeFormat) {
    assert_eq!(i128::from(found.to_bits()), expected, "{what:?} in {format:?}");
}

fn for_each_small_format(check: impl Fn(Expect, RuntimeFormat)) {
    for (width, fraction_bits) in [(2, 0), (3, 1), (4, 2), (5, 0), (5, 3), (5, 5), (5, 7), (4, 9), (3, 62)] {
        for (rounding, overflow) in Rounding::ALL.iter().flat_map(|r| OVERFLOWS.iter().map(move |o| (*r, *o)))
        {
            let expect = Expect { width, fraction_bits, rounding, overflow };
            expect.format().run::<0, _>(|| check(expect, expect.format()));
        }
    }
}

#[test]
fn every_pair_in_every_mode() {
    for_each_small_format(|expect, format| {
        let unit = Exact::from_integer(1 << expect.fraction_bits);
        for (a, b) in expect.words().flat_map(|a| expect.words().map(move |b| (a, b))) {
            let (x, y) = (Number::from_bits(a), Number::from_bits(b));
            same(x + y, expect.fitted(units(a) + units(b)), ("+", a, b), format);
            same(x - y, expect.fitted(units(a) - units(b)), ("-", a, b), format);
            same(x * y, expect.fitted(units(a) * units(b) / unit), ("*", a, b), format);
            let quotient = match b {
                0 => expect.saturated(i128::from(a) * 1000),
                _ => expect.quotient(units(a) / units(b) * unit),
            };
            same(x / y, quotient, ("/", a, b), format);
            let squares = i128::from(a * a + b * b);
            same(Real::norm(&[x, y]), expect.root(squares), ("norm", a, b), format);
            assert_eq!(x.partial_cmp(&y), Some(a.cmp(&b)));
            for c in expect.words() {
                let z = Number::from_bits(c);
                let sum = (units(a) * units(b)) / unit;
                same(x.mul_add(y, z), expect.fitted(sum + units(c)), ("mul_add", a, b, c), format);
                let sum = sum + units(c) * units(a) / unit;
                same(Real::sum_of_products([(x, y), (z, x)]), expect.fitted(sum), ("sum", a, b, c), format);
            }
        }
    });
}

#[test]
fn every_number_in_every_mode() {
    for_each_small_format(|expect, format| {
        for a in expect.words() {
            let x = Number::from_bits(a);
            same(-x, expect.fitted(-units(a)), ("-", a), format);
            if expect.fraction_bits < 20 {
                same(
                    x.sqrt(),
                    expect.root(i128::from(a.max(0)) << expect.fraction_bits),
                    ("sqrt", a),
                    format,
                );
            }
            for exponent in -126..=126_i32 {
                // Beyond 2^±40 only the sign and whether there is anything left count.
                let power = Exact::from_integer(1 << exponent.unsigned_abs().min(40));
                let scaled = if exponent < 0 { units(a) / power } else { units(a) * power };
                same(x.ldexp(exponent), expect.fitted(scaled), ("scale", a, exponent), format);
            }
            let value = a as f64 / (1_u64 << expect.fraction_bits) as f64;
            assert_eq!(x.to_f64(), value);
            assert_eq!(Number::from_f64(value), Some(x));
        }
        for (n, d) in (-40..40).flat_map(|n| (-9..9).map(move |d| (n, d))) {
            // A constant goes to nearest in every mode.
            let nearest = Expect { rounding: Rounding::Nearest, ..expect };
            let expected = match d {
                0 => expect.saturated(i128::from(n) * 1000),
                _ => nearest.quotient(Exact::new(i128::from(n) << expect.fraction_bits, d.into())),
            };
            same(Number::from_ratio(n, d), expected, ("ratio", n, d), format);
        }
        same(Number::one(), expect.saturated(1 << expect.fraction_bits), "one", format);
        same(Number::resolution(), 1, "resolution", format);
        same(Number::min_value(), -expect.half_range(), "least", format);
        same(Number::max_value(), expect.half_range() - 1, "greatest", format);
        assert_eq!(Number::name().bits(), expect.width);
    });
}

/// The exact sum counts, also where partial sums leave 128 bits.
#[test]
fn a_saturating_sum_of_products_may_come_back() {
    let format = RuntimeFormat::new(64, 32, Rounding::Nearest, Overflow::Saturate).unwrap();
    format.run::<0, _>(|| {
        let (least, greatest) = (Number::min_value(), Number::max_value());
        let up = (least, least);
        let down = (least, greatest);
        // 2·2^126 - 2·(2^126 - 2^63) = 2^64 square units: 2^32 units.
        assert_eq!(Number::sum_of_products([up, up, down, down]).to_bits(), 1 << 32);
        assert_eq!(Number::sum_of_products([down, down, down, up, up, up]).to_bits(), 3 << 31);
        assert_eq!(Number::sum_of_products([up, up, up]), greatest);
        assert_eq!(Number::sum_of_products([down, down, down]), least);
    });
}

#[test]
fn a_format_lasts_as_long_as_its_run() {
    let format = |width| RuntimeFormat::new(width, 4, Rounding::Nearest, Overflow::Wrap).unwrap();
    let names = || [RuntimeFixed::<0>::name().to_string(), RuntimeFixed::<7>::name().to_string()];
    assert_eq!(names(), ["I16F16", "I16F16"]);
    let inner = format(8).run::<0, _>(|| {
        let unwound = std::panic::catch_unwind(|| format(20).run::<0, ()>(|| panic!("{:?}", names())));
        assert_eq!(*unwound.unwrap_err().downcast::<String>().unwrap(), r#"["I16F4", "I16F16"]"#);
        let both = format(10).run::<7, _>(names);
        (both, names(), std::thread::spawn(names).join().unwrap())
    });
    let strings = |a: &str, b: &str| [a.to_string(), b.to_string()];
    assert_eq!(inner, (strings("I4F4", "I6F4"), strings("I4F4", "I16F16"), strings("I16F16", "I16F16")));
    assert_eq!(names(), ["I16F16", "I16F16"]);
}

#[test]
fn a_name_may_have_no_integer_bits() {
    let name = |width, fraction_bits| {
        let format = RuntimeFormat::with_any_point(width, fraction_bits, Rounding::Nearest, Overflow::Wrap);
        format.map(|format| format.name().to_string())
    };
    assert_eq!(name(8, 8).as_deref(), Some("I0F8"));
    assert_eq!(name(8, 12).as_deref(), Some("I-4F12"));
    assert_eq!((name(1, 0), name(65, 0), name(64, 63)), (None, None, None));
}

macro_rules! agrees_with_fixed {
    ($test:ident, $fixed:ty, $word:ty, $width:literal, $fraction_bits:literal) => {
        proptest! {
            /// Where `fixed` has an operation of the same rounding: products and roots toward -∞, quotients toward 0.
            #[test]
            fn $test(a: $word, b: $word, size in 0..$width) {
                let b = b >> size;
                let (x, y) = (<$fixed>::from_bits(a), <$fixed>::from_bits(b));
                let run = |rounding, overflow, operation: fn(Number, Number) -> Number| {
                    let format = RuntimeFormat::with_any_point($width, $fraction_bits, rounding, overflow).unwrap();
                    format.run::<0, _>(|| operation(Number::from_bits(a.into()), Number::from_bits(b.into())).to_bits())
                };
                let bits = |x: $fixed| i64::from(x.to_bits());
                use {Overflow::{Saturate, Wrap}, Rounding::{Floor, TowardZero}};
                prop_assert_eq!(run(Floor, Wrap, |a, b| a * b), bits(x.wrapping_mul(y)));
                prop_assert_eq!(run(Floor, Saturate, |a, b| a * b), bits(x.saturating_mul(y)));
                prop_assert_eq!(run(Floor, Wrap, |a, b| a + b), bits(x.wrapping_add(y)));
                prop_assert_eq!(run(Floor, Saturate, |a, b| a + b), bits(x.saturating_add(y)));
                prop_assert_eq!(run(Floor, Saturate, |a, b| a - b), bits(x.saturating_sub(y)));
                prop_assert_eq!(run(Floor, Saturate, |a, _| -a), bits(x.saturating_neg()));
                prop_assert_eq!(run(Floor, Saturate, |_, b| b.abs()), bits(y.saturating_abs()));
                if b != 0 {
                    prop_assert_eq!(run(TowardZero, Wrap, |a, b| a / b), bits(x.saturating_div(y)));
                }
                if a >= 0 {
                    prop_assert_eq!(run(Floor, Wrap, |a, _| a.sqrt()), bits(x.sqrt()));
                }
            }
        }
    };
}

agrees_with_fixed!(i4f4_is_that_of_fixed, fixed::types::I4F4, i8, 8, 4);
agrees_with_fixed!(i8f8_is_that_of_fixed, fixed::types::I8F8, i16, 16, 8);
agrees_with_fixed!(i16f16_is_that_of_fixed, fixed::types::I16F16, i32, 32, 16);
agrees_with_fixed!(i4f28_is_that_of_fixed, fixed::types::I4F28, i32, 32, 28);
agrees_with_fixed!(i32f32_is_that_of_fixed, fixed::types::I32F32, i64, 64, 32);
agrees_with_fixed!(i4f60_is_that_of_fixed, fixed::types::I4F60, i64, 64, 60);
