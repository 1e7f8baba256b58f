//! What each operation gives, bit for bit: the one definition that executors and constants share. `core.v` says the same in Verilog.

use crate::program::{Numbers, Op};

impl Numbers {
    /// Bits of a limb of long products: both limbs of a product fit the multiplier.
    pub(crate) fn limb_bits(self) -> u32 {
        if self.bits > 18 { 32 } else { 16 }
    }

    /// The greatest number.
    pub(crate) fn greatest(self) -> i64 {
        (1 << (self.bits - 1)) - 1
    }

    /// The last W bits as a number.
    fn cut(self, x: i64) -> i64 {
        (x << (64 - self.bits)) >> (64 - self.bits)
    }

    /// A wide sum as a number: to nearest, ties up.
    fn rounded(self, sum: i64) -> i64 {
        let half = (1_i64 << self.fraction_bits) >> 1;
        sum.wrapping_add(half) >> self.fraction_bits
    }

    /// a 2^by in W bits, to nearest, ties up.
    fn scaled(self, a: i64, by: i64) -> i64 {
        if by >= 0 {
            return if by > 63 { 0 } else { self.cut(a << by) };
        }
        // The last bit that is dropped says whether to round up.
        self.cut((((a << 1) >> by.unsigned_abs().min(63)) + 1) >> 1)
    }

    /// a 2^by as a phase.
    fn to_phase(a: i64, by: i64) -> i64 {
        match by {
            _ if a <= 0 => 0,
            ..0 => a.cast_unsigned().checked_shr(by.unsigned_abs().min(64) as u32).unwrap_or(0).cast_signed(),
            0..=63 if (a << by).cast_unsigned() >> by == a.cast_unsigned() => a << by,
            _ => -1,
        }
    }

    fn divided(self, a: i64, b: i64) -> i64 {
        let (n, d) = (u128::from(a.unsigned_abs()) << self.fraction_bits, u128::from(b.unsigned_abs()));
        let size = if n >> self.bits < d {
            let (quotient, rest) = (n / d, n % d);
            quotient + u128::from(rest >= d - rest)
        } else {
            if n == 0 { 0 } else { u128::MAX }
        };
        let size = i64::try_from(size).unwrap_or(i64::MAX);
        if (a < 0) == (b < 0) { size.min(self.greatest()) } else { (-size).max(-self.greatest() - 1) }
    }

    fn root(self, sum: i64) -> i64 {
        let square = sum.cast_unsigned();
        let root = square.isqrt();
        // (k + 1/2)² = k² + k + 1/4: from a rest above k on, k + 1 is nearer.
        let nearest = root + u64::from(square - root * root > root);
        i64::try_from(nearest).unwrap_or(i64::MAX).min(self.greatest())
    }

    /// What an operation that depends on its operands alone gives.
    pub(crate) fn value(self, op: Op, [a, b, c]: [i64; 3]) -> i64 {
        let limb = |x: i64, i: u8| {
            (x.cast_unsigned() >> (u32::from(i) * self.limb_bits())) & ((1 << self.limb_bits()) - 1)
        };
        let shifted = |by: i64, right: bool| {
            let (a, by) = (a.cast_unsigned(), u32::try_from(by).unwrap_or(64));
            (if right { a.checked_shr(by) } else { a.checked_shl(by) }).unwrap_or(0).cast_signed()
        };
        match op {
            Op::Move | Op::Input | Op::Output(_) => a,
            Op::Add => a.wrapping_add(b),
            Op::Sub => a.wrapping_sub(b),
            Op::AddNumbers => self.cut(a.wrapping_add(b)),
            Op::SubNumbers => self.cut(a.wrapping_sub(b)),
            Op::Min => a.min(b),
            Op::Max => a.max(b),
            Op::And => a & b,
            Op::Or => a | b,
            Op::ShiftLeft => shifted(b, false),
            Op::ShiftRight => shifted(b, true),
            Op::Scale => self.scaled(a, b),
            Op::ToPhase => Self::to_phase(a, b),
            Op::PowerOfTwo => {
                let places = a + i64::from(self.fraction_bits);
                match places {
                    ..0 => 0,
                    0..=62 => (1 << places).min(self.greatest()),
                    _ => self.greatest(),
                }
            }
            Op::Product => self.cut(self.rounded(a.wrapping_mul(b)).wrapping_add(c)),
            Op::Sum | Op::Row => a.wrapping_mul(b).wrapping_add(c),
            Op::RoundedSum => self.cut(self.rounded(a.wrapping_mul(b).wrapping_add(c))),
            Op::Limbs(i, j) => {
                limb(a, i).wrapping_mul(limb(b, j)).wrapping_add(c.cast_unsigned()).cast_signed()
            }
            Op::Divide => self.divided(a, b),
            Op::Root => self.root(a),
        }
    }
}
