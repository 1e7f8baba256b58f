//! Operations of formats against exact integers: drawn ones in every format, and all of them in a small one.

use arbitrary::{Arbitrary, Unstructured};
use kernel_oracle::{ExactFormat, Operands, OperationCase};
use real::{Datapath, Overflow, Rounding};

use crate::seeded_bytes::seeded_bytes;

/// Each of the widths from 3 to 64 bits often enough.
#[test]
fn operations_are_exact_in_every_format() {
    let mut widths = [0; 65];
    for seed in 0..4_000 {
        let case = OperationCase::arbitrary(&mut Unstructured::new(&seeded_bytes(seed))).unwrap();
        widths[case.format.width as usize] += 1;
        case.check().unwrap_or_else(|fault| panic!("{fault}\n{case:?}"));
    }
    assert!(widths[3..].iter().all(|count| *count >= 20), "{widths:?}");
}

/// The ways in which a format rounds, with what it does on overflow.
fn datapaths() -> impl Iterator<Item = Datapath> {
    Rounding::ALL
        .into_iter()
        .flat_map(|rounding| Overflow::ALL.map(|overflow| Datapath { rounding, overflow }))
}

/// Every pair of operands of every operation in I2F6. An operation of three or four takes them from the pair and from
/// what follows it.
#[test]
fn every_pair_of_operands_of_a_small_format() {
    let mut pairs = 0_u32;
    for datapath in datapaths() {
        let format = ExactFormat { width: 8, fraction_bits: 6, datapath };
        for a in -128..128_i64 {
            for b in -128..128_i64 {
                let (n, d) = (i32::try_from(a).unwrap(), i32::try_from(b).unwrap());
                let operands = Operands {
                    words: [a, b, (a * 31 + b * 17) % 128, (a * 7 - b * 13) % 128],
                    exponent: d.clamp(-126, 126),
                    ratio: (n, d),
                    phase: (u64::from(n.unsigned_abs()) << 56) ^ u64::from(d.unsigned_abs()) << 48,
                    floats: (a as f64 / 128.0, b as f64 / 1e9),
                };
                format.check_operations(&operands).unwrap_or_else(|fault| panic!("{fault}"));
                pairs += 1;
            }
        }
    }
    assert_eq!(pairs, 8 << 16);
}

/// Every number of every format of 16 bits in every operation that takes one, with another number that changes with it.
#[test]
#[ignore = "nightly: eight million turns of all operations"]
fn every_number_of_every_format_of_16_bits() {
    for (fraction_bits, datapath) in
        (0..=14).flat_map(|bits| datapaths().map(move |datapath| (bits, datapath)))
    {
        let format = ExactFormat { width: 16, fraction_bits, datapath };
        for word in i64::from(i16::MIN)..=i64::from(i16::MAX) {
            let exponent = i32::try_from(word.rem_euclid(253)).unwrap() - 126;
            let operands = Operands {
                words: [word, word * 3 + 1, -word, word ^ 0x5555],
                exponent,
                ratio: (i32::try_from(word).unwrap(), exponent),
                phase: word.cast_unsigned() << 48,
                floats: (word as f64 / 3.0, 0.0),
            };
            format.check_operations(&operands).unwrap_or_else(|fault| panic!("{fault}"));
        }
    }
}
