//! Every build and every machine computes equal values: a checksum of a long sequence of operations for each format.
//!
//! A debug build panics on an overflow that a release build lets pass, a 32-bit machine divides by Newton's reciprocal,
//! a compiler may fuse or reorder what floats compute; none of that may change a bit. Whichever build runs is
//! compared with the same numbers. They change only when a rounding rule does.

#![allow(
    clippy::cast_possible_truncation,
    clippy::cast_possible_wrap,
    clippy::cast_sign_loss,
    reason = "random bits are cut to what is needed"
)]

use real::{Backend, I2F30, I4F4, I4F28, I4F60, I8F24, I12F20, I16F16, I16F48, I32F32, Real};

/// Marsaglia's xorshift with 64 bits of state.
struct Random(u64);

impl Random {
    fn next(&mut self) -> u64 {
        self.0 ^= self.0 << 13;
        self.0 ^= self.0 >> 7;
        self.0 ^= self.0 << 17;
        self.0
    }

    fn below(&mut self, n: usize) -> usize {
        (self.next() >> 33) as usize % n
    }
}

/// FNV-1a over the exact values of all results.
fn checksum<R: Backend>() -> u64 {
    let mut random = Random(0x9e37_79b9_7f4a_7c15);
    let mut registers = [R::one(); 8];
    let mut hash = 0xcbf2_9ce4_8422_2325_u64;
    for _ in 0..50_000 {
        let [a, b, c, d] = [0; 4].map(|_| registers[random.below(8)]);
        let exponent = i32::try_from(random.below(9)).unwrap() - 4;
        let result = match random.below(16) {
            0 => a + b,
            1 => a - b,
            2 => -a,
            3 | 4 => a * b,
            5 | 6 => a / b,
            7 => a.mul_add(b, c),
            8 => R::sum_of_products([(a, b), (c, d)]),
            9 => R::norm(&[a, b, c]),
            10 => a.sqrt(),
            11 => a.ldexp(exponent),
            12 => R::from_ratio(random.next() as i32, random.next() as i32 >> random.below(31)),
            13 => R::from_phase(a.to_phase(exponent), exponent),
            14 => Real::min(Real::max(a, b), c.abs()),
            _ => R::fraction(random.next()) - R::from_phase(random.next(), exponent),
        };
        let result = if result.is_finite() { result } else { R::resolution() };
        registers[random.below(8)] = result;
        let (high, low) = result.to_f64_pair();
        for byte in [high, low].iter().flat_map(|part| part.to_bits().to_le_bytes()) {
            hash = (hash ^ u64::from(byte)).wrapping_mul(0x100_0000_01b3);
        }
    }
    hash
}

macro_rules! checksums {
    ($($format:ty = $expected:literal)*) => {
        [$((stringify!($format), checksum::<$format>(), $expected)),*]
    };
}

#[test]
fn every_build_computes_the_same_values() {
    let checksums = checksums! {
        f64 = 0x2033_3825_a7d1_bbad
        f32 = 0x3854_ce3d_9939_a4cb
        I4F4 = 0x7e26_dbee_4774_3dee
        I16F16 = 0x9159_c828_486d_d8f3
        I12F20 = 0x18d7_b975_7927_5fd4
        I8F24 = 0x9c87_6e77_962d_d12e
        I4F28 = 0xf0e2_a19f_8a0b_a478
        I2F30 = 0xf9f7_55cd_2d83_2492
        I32F32 = 0x5d29_d252_62cc_8b34
        I16F48 = 0xcf16_ac5d_c559_ba3f
        I4F60 = 0xa951_adb5_3755_3767
    };
    let changed: Vec<String> = checksums
        .iter()
        .filter(|(_, found, expected)| found != expected)
        .map(|(format, found, _)| format!("{format} = 0x{found:016x}"))
        .collect();
    assert!(changed.is_empty(), "other values than those committed:\n{}", changed.join("\n"));
}
