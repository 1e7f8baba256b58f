//! Every operation of a fixed-point format on given operands, against exact integers.

use arbitrary::{Arbitrary, Unstructured};
use num_bigint::BigInt;
use num_traits::{One, Signed, ToPrimitive, Zero};
use real::{
    Backend, Datapath, FixedPoint, I2F30, I3F29, I4F4, I4F28, I4F60, I8F24, I12F20, I16F16, I16F48, I32F32,
    Overflow, Real, Rounding, RuntimeFixed, RuntimeFormat, Word, fixed,
};

use crate::exact_format::{ExactFormat, Quotient, parts_of_float};
use crate::fault::KernelFault;

/// The operands of one turn of all operations.
#[derive(Clone, Copy, Debug)]
pub struct Operands {
    /// Integers that stand for numbers: their last W bits.
    pub words: [i64; 4],
    /// A power of two, from −126 to 126.
    pub exponent: i32,
    /// A constant.
    pub ratio: (i32, i32),
    /// A fraction in units of 2⁻⁶⁴.
    pub phase: u64,
    /// Any floats.
    pub floats: (f64, f64),
}

/// The run-time formats that a turn is made in, and the operands. The types of the `fixed` crate take the same operands.
#[derive(Clone, Copy, Debug)]
pub struct OperationCase {
    /// A run-time format.
    pub format: ExactFormat,
    /// The operands.
    pub operands: Operands,
}

/// A word of any size: the numbers at which something overflows or ties are more frequent than others.
fn word(bytes: &mut Unstructured<'_>) -> arbitrary::Result<i64> {
    let (kind, size): (u8, u8) = bytes.arbitrary()?;
    let size = u32::from(size) % 64;
    Ok(match kind % 8 {
        0 => [0, 1, -1, 2, i64::MAX, i64::MIN, i64::MAX - 1, i64::MIN + 1][(size % 8) as usize],
        1 => 1 << size,
        2 => (1_i64 << size).wrapping_sub(1),
        3 => -1 << size,
        // The extremes of a format of another width, and their neighbours.
        4 => (i64::MAX >> size) ^ i64::from(kind >> 7),
        _ => bytes.arbitrary::<i64>()? >> size,
    })
}

impl<'a> Arbitrary<'a> for Operands {
    fn arbitrary(bytes: &mut Unstructured<'a>) -> arbitrary::Result<Self> {
        Ok(Self {
            words: [word(bytes)?, word(bytes)?, word(bytes)?, word(bytes)?],
            exponent: bytes.int_in_range(-126..=126)?,
            ratio: (low_half(word(bytes)?), low_half(word(bytes)?)),
            phase: word(bytes)?.cast_unsigned(),
            floats: (float(bytes)?, float(bytes)?),
        })
    }
}

/// A float of any bits, or one of the size of a format's numbers.
fn float(bytes: &mut Unstructured<'_>) -> arbitrary::Result<f64> {
    Ok(match bytes.int_in_range(0..=3)? {
        0 => f64::from_bits(bytes.arbitrary()?),
        1 => f64::from(bytes.arbitrary::<i32>()?).ldexp(bytes.int_in_range(-80..=40)?),
        _ => (word(bytes)? as f64).ldexp(bytes.int_in_range(-70..=0)?),
    })
}

#[allow(clippy::cast_possible_truncation, reason = "any 32 bits will do")]
fn low_half(word: i64) -> i32 {
    word as i32
}

impl<'a> Arbitrary<'a> for OperationCase {
    fn arbitrary(bytes: &mut Unstructured<'a>) -> arbitrary::Result<Self> {
        let width = bytes.int_in_range(3..=64)?;
        let fraction_bits = bytes.int_in_range(0..=width - 2)?;
        let rounding = *bytes.choose(&Rounding::ALL)?;
        let overflow = *bytes.choose(&Overflow::ALL)?;
        let format = ExactFormat { width, fraction_bits, datapath: Datapath { rounding, overflow } };
        Ok(Self { format, operands: Operands::arbitrary(bytes)? })
    }
}

impl OperationCase {
    /// Makes every operation in the run-time format, and in the formats that are types.
    ///
    /// # Errors
    /// The first result that is not the exact one, rounded and fitted.
    pub fn check(&self) -> Result<(), KernelFault> {
        self.format.check_operations(&self.operands)?;
        let operands = &self.operands;
        check_type(I4F4::from_bits, operands)?;
        check_type(I16F16::from_bits, operands)?;
        check_type(I12F20::from_bits, operands)?;
        check_type(I8F24::from_bits, operands)?;
        check_type(I4F28::from_bits, operands)?;
        check_type(I3F29::from_bits, operands)?;
        check_type(I2F30::from_bits, operands)?;
        check_type(I32F32::from_bits, operands)?;
        check_type(I16F48::from_bits, operands)?;
        check_type(I4F60::from_bits, operands)?;
        check_type(FixedPoint::<fixed::types::I5F11>::from_bits, operands)?;
        check_type(FixedPoint::<fixed::types::I2F6>::from_bits, operands)
    }
}

impl ExactFormat {
    /// Makes every operation in the run-time format of this width, and compares each result with the exact one.
    ///
    /// # Errors
    /// The first result that is not.
    pub fn check_operations(&self, operands: &Operands) -> Result<(), KernelFault> {
        let Datapath { rounding, overflow } = self.datapath;
        let Some(format) = RuntimeFormat::with_any_point(self.width, self.fraction_bits, rounding, overflow)
        else {
            return Ok(()); // the case is made of formats that there are
        };
        format.run::<0, _>(|| Turn { format: *self, number: RuntimeFixed::<0>::from_bits }.check(operands))
    }
}

/// The same in a type of the `fixed` crate, which rounds to nearest and wraps.
fn check_type<R: Backend, W: Word>(of_bits: impl Fn(W) -> R, operands: &Operands) -> Result<(), KernelFault> {
    let width = 8 * u32::try_from(size_of::<W>()).unwrap_or(8);
    let format = ExactFormat {
        width,
        fraction_bits: R::fraction_bits().unwrap_or(0),
        datapath: Datapath { rounding: Rounding::Nearest, overflow: Overflow::Wrap },
    };
    Turn { format, number: |word: i64| of_bits(W::of_last_bits(word.cast_unsigned())) }.check(operands)
}

/// One turn of all operations in one format.
struct Turn<N> {
    format: ExactFormat,
    number: N,
}

impl<R: Backend, N: Fn(i64) -> R> Turn<N> {
    fn check(&self, operands: &Operands) -> Result<(), KernelFault> {
        let words = operands.words.map(|word| self.format.word(word));
        self.sums_and_products(words)?;
        self.quotients_and_roots(words, operands.ratio)?;
        self.order([words[0], words[1]])?;
        self.shifts(words[0], operands.exponent)?;
        self.phases(words[0], operands.phase, operands.exponent.clamp(-64, 64))?;
        self.floats(words[0], operands.floats)?;
        self.constants()
    }

    /// Compares a number with the integer that it must be.
    fn same(&self, what: &str, operands: &[i64], found: R, expected: i64) -> Result<(), KernelFault> {
        self.equal(what, operands, found.word(), Some(expected))
    }

    fn equal<T: PartialEq + std::fmt::Debug>(
        &self,
        what: &str,
        operands: &[i64],
        found: T,
        expected: T,
    ) -> Result<(), KernelFault> {
        KernelFault::unless_equal::<R, _>(|| format!("{what} of {operands:?}"), found, expected)
    }

    /// An integer in units of the square of the resolution, as a product is one.
    fn of_squares(&self, value: BigInt) -> Quotient {
        Quotient { numerator: value, denominator: BigInt::one() << self.format.fraction_bits }
    }

    fn sums_and_products(&self, words: [i64; 4]) -> Result<(), KernelFault> {
        let [a, b, c, d] = words.map(&self.number);
        let [x, y, z, w] = words.map(BigInt::from);
        let fitted = |units: BigInt| self.format.fitted(&Quotient::whole(units));
        self.same("a + b", &words, a + b, fitted(&x + &y))?;
        self.same("a - b", &words, a - b, fitted(&x - &y))?;
        self.same("-a", &words, -a, fitted(-&x))?;
        self.same("|a|", &words, a.abs(), fitted(x.abs()))?;
        let rounded = |squares: BigInt| self.format.fitted(&self.of_squares(squares));
        self.same("a * b", &words, a * b, rounded(&x * &y))?;
        let addend = &z << self.format.fraction_bits;
        self.same("a * b + c", &words, a.mul_add(b, c), rounded(&x * &y + addend))?;
        let two = R::sum_of_products([(a, b), (c, d)]);
        self.same("ab + cd", &words, two, rounded(&x * &y + &z * &w))?;
        self.same("no products", &words, R::sum_of_products([]), 0)?;
        // Three products of 64 bits may leave the accumulator of 128, which loses the sign that rounding toward zero asks for.
        let keeps_sign = self.format.width < 64 || self.format.datapath.rounding != Rounding::TowardZero;
        if keeps_sign || self.format.datapath.overflow == Overflow::Saturate {
            let three = R::sum_of_products([(a, b), (c, d), (a, c)]);
            self.same("ab + cd + ac", &words, three, rounded(&x * &y + &z * &w + &x * &z))?;
        }
        Ok(())
    }

    fn quotients_and_roots(&self, words: [i64; 4], (n, d): (i32, i32)) -> Result<(), KernelFault> {
        let [a, b, c, _] = words.map(&self.number);
        let [x, y, z, _] = words.map(BigInt::from);
        let fraction_bits = self.format.fraction_bits;
        self.same("a / b", &words, a / b, self.format.quotient(&x << fraction_bits, y.clone()))?;
        let constant = [i64::from(n), i64::from(d)];
        let ratio = self.format.ratio(BigInt::from(n) << fraction_bits, d.into());
        self.same("n / d", &constant, R::from_ratio(n, d), ratio)?;
        let positive = if x.is_negative() { BigInt::zero() } else { &x << fraction_bits };
        self.same("√a", &words, a.sqrt(), self.format.root(&positive))?;
        let squares = &x * &x + &y * &y;
        self.same("‖a, b‖", &words, R::norm(&[a, b]), self.format.root(&squares))?;
        self.same("‖a, b, c‖", &words, R::norm(&[a, b, c]), self.format.root(&(squares + &z * &z)))?;
        self.same("the norm of nothing", &[], R::norm(&[]), 0)
    }

    fn order(&self, words: [i64; 2]) -> Result<(), KernelFault> {
        let [a, b] = words.map(&self.number);
        self.equal("a ? b", &words, a.partial_cmp(&b), Some(words[0].cmp(&words[1])))?;
        self.same("the larger", &words, Real::max(a, b), words[0].max(words[1]))?;
        self.same("the smaller", &words, Real::min(a, b), words[0].min(words[1]))?;
        let is_part = (0..=R::one().word().unwrap_or(0)).contains(&words[0]);
        self.equal("is a part of one", &words, (a.is_part(), a.is_zero()), (is_part, words[0] == 0))
    }

    fn shifts(&self, word: i64, exponent: i32) -> Result<(), KernelFault> {
        let a = (self.number)(word);
        let scaled = |exponent: i32| self.format.fitted(&Quotient::shifted(word.into(), -exponent));
        let operands = [word, exponent.into()];
        self.same("a * 2^e", &operands, a.ldexp(exponent), scaled(exponent))?;
        self.same("a * 2^e, rescaled", &operands, a.rescaled(exponent), scaled(exponent))?;
        self.same("a / 2", &operands, a.half(), scaled(-1))?;
        let places = exponent.unsigned_abs();
        match u8::try_from(places) {
            Ok(few) if (1..=R::MOST_LOWERED).contains(&places) => {
                self.same("a lowered", &operands, a.lowered(few), scaled(-exponent.abs()))
            }
            _ => Ok(()),
        }
    }

    fn phases(&self, word: i64, phase: u64, exponent: i32) -> Result<(), KernelFault> {
        let a = (self.number)(word);
        let fraction_bits = self.format.fraction_bits.cast_signed();
        let cut = |value: BigInt, shift: i32| self.format.cut(&Quotient::shifted(value, shift));
        let operands = [word, phase.cast_signed(), exponent.into()];
        let of_phase = |exponent: i32| cut(phase.into(), 64 - exponent - fraction_bits);
        self.same("from a phase", &operands, R::from_phase(phase, exponent), of_phase(exponent))?;
        self.same("a fraction", &operands, R::fraction(phase), of_phase(0))?;
        let power = cut(BigInt::one() << 64, 64 - exponent.min(63) - fraction_bits);
        self.same("2^e", &operands, R::power_of_two(exponent.min(63)), power)?;
        // A quotient below 2⁶⁴, and digits behind its point, which do not count.
        let shift = exponent.unsigned_abs() % 64;
        let product = (u128::from(phase) << shift) | (u128::from(word.unsigned_abs()) & ((1 << shift) - 1));
        self.same("a fraction of a product", &operands, R::fraction_of(product, shift), of_phase(0))?;
        let to_phase = |exponent: i32| {
            let units = Quotient::shifted(word.max(0).into(), fraction_bits - 64 - exponent);
            units.floor().to_u64().unwrap_or(u64::MAX)
        };
        self.equal("to a phase", &operands, a.to_phase(exponent), to_phase(exponent))?;
        let place =
            Some(to_phase(0)).filter(|_| BigInt::from(word) < BigInt::one() << fraction_bits.unsigned_abs());
        if word >= 0 {
            self.equal("a place", &operands, a.place_to_phase(), place)?;
        }
        Ok(())
    }

    fn floats(&self, word: i64, (high, low): (f64, f64)) -> Result<(), KernelFault> {
        let a = (self.number)(word);
        let (first, second) = a.to_f64_pair();
        let fraction_bits = self.format.fraction_bits;
        let back = sum_of_floats(first, second, fraction_bits).map(|units| (units.floor(), units.numerator));
        let exact = sum_of_floats(first, second, fraction_bits).map(|units| units.denominator);
        let expected = exact.map(|denominator| (BigInt::from(word), BigInt::from(word) * denominator));
        self.equal("to floats", &[word], back, expected)?;
        self.same("from floats", &[word], R::from_f64_pair(first, second).unwrap_or_default(), word)?;
        self.equal("to a float", &[word], first, first + second)?;
        // The pair of the contract: the second is at most half a unit of the first's last place.
        let sum = high + low;
        let pair = (sum, if high.abs() > low.abs() { low - (sum - high) } else { high - (sum - low) });
        let pair = if pair.1.is_finite() { pair } else { (high, 0.0) };
        let nearest =
            sum_of_floats(pair.0, pair.1, fraction_bits).and_then(|units| self.format.nearest(&units));
        let found = R::from_f64_pair(pair.0, pair.1).and_then(Backend::word);
        let operands = [pair.0.to_bits().cast_signed(), pair.1.to_bits().cast_signed()];
        self.equal("from any floats", &operands, found, nearest)
    }

    fn constants(&self) -> Result<(), KernelFault> {
        let (least, greatest) = (self.format.least(), self.format.greatest());
        let one = self.format.cut(&Quotient::whole(BigInt::one() << self.format.fraction_bits));
        self.same("one", &[], R::one(), one)?;
        self.same("zero", &[], R::zero(), 0)?;
        self.same("the resolution", &[], R::resolution(), 1)?;
        self.same("the least", &[], R::min_value(), least)?;
        self.same("the greatest", &[], R::max_value(), greatest)
    }
}

/// The sum of two floats in units of 2⁻ᶠ; `None` unless both are finite.
fn sum_of_floats(high: f64, low: f64, fraction_bits: u32) -> Option<Quotient> {
    let ((a, e), (b, g)) = (parts_of_float(high)?, parts_of_float(low)?);
    let common = e.min(g);
    let sum = (a << (e - common).unsigned_abs()) + (b << (g - common).unsigned_abs());
    Some(Quotient::shifted(sum, -common - fraction_bits.cast_signed()))
}
