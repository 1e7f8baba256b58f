//! The operations one by one: operands are loaded through a pointer, one operation is done, its result stored.

use core::hint::black_box;

use real::Real;

use crate::checksum::Checksum;
use crate::{Bits, Board, Record};

/// What an operation may take.
#[derive(Clone, Copy, Debug)]
pub struct Operands<R> {
    /// In (-1, 1).
    pub a: R,
    /// In ±[½, 1): a divisor.
    pub b: R,
    /// In (-1, 1).
    pub c: R,
    /// In (-1, 1).
    pub d: R,
    /// A power of two, from -8 to -1.
    pub exponent: i32,
    /// A fraction in units of 2⁻⁶⁴.
    pub phase: u64,
}

/// Sets of operands.
const SETS: usize = 16;

/// SplitMix64.
fn random(seed: &mut u64) -> u64 {
    *seed = seed.wrapping_add(0x9e37_79b9_7f4a_7c15);
    let mut z = *seed;
    z = (z ^ (z >> 30)).wrapping_mul(0xbf58_476d_1ce4_e5b9);
    z = (z ^ (z >> 27)).wrapping_mul(0x94d0_49bb_1331_11eb);
    z ^ (z >> 31)
}

impl<R: Real> Operands<R> {
    fn next(seed: &mut u64) -> Self {
        let mut number = |least: R| {
            let bits = random(seed);
            let magnitude = least + R::from_phase(bits << 1, 0) * (R::one() - least);
            if bits >> 63 == 0 { magnitude } else { -magnitude }
        };
        let (a, b, c, d) = (number(R::zero()), number(R::one().half()), number(R::zero()), number(R::zero()));
        let phase = random(seed);
        let exponent = -1 - i32::from((phase & 7) as u8);
        Self { a, b, c, d, exponent, phase }
    }
}

/// A kernel of one operation.
type Operation<R> = fn(&Operands<R>, &mut R);

fn run<R: Bits>(
    board: &mut impl Board,
    format: &'static str,
    kernels: &[(&'static str, &'static str, Operation<R>)],
) {
    for &(item, symbol, kernel) in kernels {
        let kernel = black_box(kernel);
        let mut seed = 1;
        let mut checksum = Checksum::new();
        for _ in 0..SETS {
            let operands = Operands::next(&mut seed);
            let mut result = R::zero();
            kernel(black_box(&operands), &mut result);
            checksum.add(black_box(result).bits());
        }
        board.record(Record {
            format,
            item,
            symbol,
            calls: SETS as u32,
            checksum: checksum.value(),
            stack_bytes: 0,
        });
    }
}

macro_rules! kernels {
    ($board:ident, $format:ty, $name:literal: $($operation:ident($x:ident) = $result:expr;)*) => {{
        $(
            #[unsafe(export_name = concat!("k_", stringify!($operation), "_", $name))]
            #[inline(never)]
            fn $operation($x: &Operands<$format>, result: &mut $format) {
                *result = $result;
            }
        )*
        run::<$format>($board, $name, &[
            $((stringify!($operation), concat!("k_", stringify!($operation), "_", $name), $operation)),*
        ]);
    }};
}

macro_rules! formats {
    ($board:ident: $($format:ty = $name:literal),*) => {$(
        kernels!($board, $format, $name:
            copy(x) = x.a;
            add(x) = x.a + x.b;
            max(x) = Real::max(x.a, x.b);
            mul(x) = x.a * x.b;
            mul_add(x) = Real::mul_add(x.a, x.b, x.c);
            sum_of_products(x) = Real::sum_of_products([(x.a, x.b), (x.c, x.d)]);
            scale(x) = Real::ldexp(x.a, x.exponent);
            half(x) = Real::half(x.a);
            div(x) = x.a / x.b;
            sqrt(x) = Real::sqrt(Real::abs(x.a));
            norm(x) = Real::norm(&[x.a, x.b]);
            fraction(x) = Real::fraction(x.phase);
            to_phase(x) = Real::fraction(Real::to_phase(Real::abs(x.a), x.exponent));
        );
    )*};
}

/// `⌊a·b/2⁶⁴⌋`, the product that a time takes to become a fraction of its stage.
#[cfg(feature = "fixed-32")]
#[unsafe(export_name = "k_high_product_u64")]
#[inline(never)]
fn high_product(factors: &[u64; 2], result: &mut u64) {
    *result = ((u128::from(factors[0]) * u128::from(factors[1])) >> 64) as u64;
}

#[cfg(feature = "fixed-32")]
fn run_high_product(board: &mut impl Board) {
    let mut seed = 2;
    let mut checksum = Checksum::new();
    for _ in 0..SETS {
        let factors = [random(&mut seed), random(&mut seed)];
        let mut result = 0;
        black_box(high_product as fn(&[u64; 2], &mut u64))(black_box(&factors), &mut result);
        checksum.add(black_box(result));
    }
    board.record(Record {
        format: "u64",
        item: "high_product",
        symbol: "k_high_product_u64",
        calls: SETS as u32,
        checksum: checksum.value(),
        stack_bytes: 0,
    });
}

/// Every operation of every format.
pub(crate) fn run_all(board: &mut impl Board) {
    #[cfg(feature = "floats")]
    formats!(board: f64 = "f64", f32 = "f32");
    #[cfg(feature = "fixed-32")]
    formats!(board:
        real::I16F16 = "I16F16", real::I8F24 = "I8F24", real::I4F28 = "I4F28", real::I3F29 = "I3F29",
        real::I2F30 = "I2F30"
    );
    #[cfg(feature = "fixed-64")]
    formats!(board: real::I32F32 = "I32F32", real::I16F48 = "I16F48", real::I4F60 = "I4F60");
    #[cfg(feature = "fixed-32")]
    run_high_product(board);
}
