//! The fewest bits are those that are found when every format is tried.

use kernel_size::{Kernel, Output, compare, named, size};

use crate::kernels::{Biquad, Edge, Least, Roots, Sum, one};

/// The narrowest good format of 12 to 32 bits, and of its width the one with the most fraction bits, each tried.
fn every_format<K: Kernel>(kernel: &K) -> Option<String> {
    (12..=32_u32).find_map(|width| {
        let formats: Vec<_> =
            (2..=width).filter_map(|bits| named(&format!("I{bits}F{}", width - bits))).collect();
        let compared = compare(kernel, &formats).unwrap();
        compared.formats.into_iter().find(|run| run.good).map(|run| run.format)
    })
}

fn assert_fewest<K: Kernel>(kernel: &K) {
    let found = size(kernel).unwrap().uniform;
    let expected = every_format(kernel);
    assert!(expected.is_some(), "no format is good: a test without an answer");
    assert_eq!(found.map(|run| run.format), expected);
}

#[test]
fn the_fewest_bits_are_those_of_brute_force() {
    let within = |limit| Output::named("y").within(limit);
    for limit in [0.1, 0.01, 0.002] {
        assert_fewest(&one(Biquad, 200, (-1.0, 1.0), within(limit)));
        assert_fewest(&one(Sum, 200, (0.0, 1.0), within(limit)));
        assert_fewest(&one(Sum, 200, (-9.0, 1.0), within(limit)));
        assert_fewest(&one(Roots, 200, (-5.0, 5.0), within(limit)));
        assert_fewest(&one(Edge, 2, (0.0, 0.0), within(10.0 * limit)));
    }
    assert_fewest(&one(Biquad, 200, (-0.9, 1.0), Output::named("y").within_part(0.9).within(0.2)));
    assert_fewest(&one(Sum, 200, (0.0, 1.0), Output::named("y").drift(0.01)));
}

/// The greatest number depends on the width: one wide run does not stand for all with its fraction bits.
#[test]
fn so_they_are_where_a_kernel_asks_for_the_greatest_number() {
    assert_fewest(&one(Least, 60, (-3.0, 3.0), Output::named("y").within(0.01)));
    assert_fewest(&one(Least, 60, (-3.0, 70.0), Output::named("y").within(0.001)));
}

/// No register can do with a bit less, and each holds all values of its signal.
#[test]
fn registers_are_no_wider_than_they_must_be() {
    use real::{FormatName, Quantized, Rounding};
    let kernel = one(Biquad, 400, (-1.0, 1.0), Output::named("y").within(0.002));
    let found = size(&kernel).unwrap();
    let (uniform, registers) = (found.uniform.unwrap(), found.registers.unwrap());
    assert_eq!(
        registers.signals.iter().map(|one| one.signal).collect::<Vec<_>>(),
        ["a1", "a2", "b", "x", "y"]
    );
    assert_eq!(registers.uniform_bits, 5 * uniform.bits);
    assert!(registers.bits < registers.uniform_bits, "{registers:?}");
    let fraction_bits = |format: &str| match FormatName::named(format) {
        Some(FormatName::Fixed { fraction_bits, .. }) => fraction_bits.cast_signed(),
        _ => panic!("{format}"),
    };
    let inputs = kernel_size::Input::drawn("x", 5, (-1.0, 1.0), 400).unwrap();
    // The filter once more, by hand.
    let filtered = |registers: &[(&'static str, i32)]| {
        use real::{Backend, Real};
        Quantized::run(Rounding::Nearest, registers, || {
            let number = |name, x| Quantized::from_f64(x).unwrap().signal(name);
            let (a1, a2, b) = (number("a1", 1.6), number("a2", -0.81), number("b", 0.07));
            let (mut before, mut last, mut all) = (number("", 0.0), number("", 0.0), Vec::new());
            for x in inputs.values() {
                let now =
                    Quantized::sum_of_products([(b, number("x", *x)), (a1, last), (a2, before)]).signal("y");
                (before, last) = (last, now);
                all.push(now.to_f64());
            }
            all
        })
    };
    let exact = filtered(&[]);
    let worst = |registers: &[(&'static str, i32)]| {
        filtered(registers).iter().zip(&exact).map(|(one, other)| (one - other).abs()).fold(0.0, f64::max)
    };
    let bits: Vec<_> = registers.signals.iter().map(|one| (one.signal, fraction_bits(&one.format))).collect();
    assert!(worst(&bits) <= 0.002);
    for place in 0..bits.len() {
        let mut fewer = bits.clone();
        fewer[place].1 -= 1;
        assert!(fewer[place].1 < 0 || worst(&fewer) > 0.002, "{:?} can do with less", fewer[place]);
    }
}
