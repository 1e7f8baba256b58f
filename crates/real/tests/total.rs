//! Every operation returns a value for all operands, in every build: also those far outside its domain.

use real::{Backend, I2F30, I4F4, I4F28, I4F60, I8F24, I16F16, I16F48, I32F32};

const EXPONENTS: [i32; 14] =
    [i32::MIN, i32::MIN + 1, -200, -127, -65, -64, -1, 0, 63, 64, 65, 127, i32::MAX - 1, i32::MAX];

/// Runs every operation that takes an exponent, in a build with overflow checks.
fn check<R: Backend>() {
    let least = R::resolution();
    let numbers = [R::min_value(), -R::one(), -least, R::zero(), least, R::one(), R::max_value()];
    for exponent in EXPONENTS {
        let in_domain = exponent.unsigned_abs() <= 64;
        for x in numbers {
            let (_, _, part) = (x.ldexp(exponent), x.rescaled(exponent), x.to_phase(exponent));
            let _ = x.place_to_phase();
            assert!(!in_domain || x > R::zero() || part == 0, "{} {exponent}", R::name());
        }
        for phase in [0, 1, 1 << 63, u64::MAX] {
            assert!(R::from_phase(phase, exponent) >= R::zero(), "{} {exponent}", R::name());
        }
        let (power, fits) = (R::power_of_two(exponent), (-1..=0).contains(&exponent));
        assert!(
            power >= R::zero() && (!fits || power == R::one().ldexp(exponent)),
            "{} {exponent}",
            R::name()
        );
    }
}

#[test]
fn exponents_beyond_every_format() {
    check::<f64>();
    check::<f32>();
    check::<I4F4>();
    check::<I2F30>();
    check::<I4F28>();
    check::<I8F24>();
    check::<I16F16>();
    check::<I32F32>();
    check::<I16F48>();
    check::<I4F60>();
}
