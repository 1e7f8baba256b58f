//! The conversion that a run of many numbers side by side needs of a float.

use crate::Real;

/// A float that converts to phases without a branch, so that a loop over many numbers becomes vector instructions.
pub trait Lane: Real {
    /// `⌊self · 2⁶⁴⌋`, and whether that is right. It is right for numbers from 2⁻⁶² on and below 1, and for no others.
    fn part_of_one(self) -> (u64, bool);
}

#[cfg(test)]
mod tests {
    use super::*;
    use proptest::prelude::*;

    proptest! {
        #[test]
        fn numbers_convert_as_with_branches(x in any::<f64>(), y in any::<f32>()) {
            for x in [x, x.abs().fract(), 2.0_f64.powi(-61), 2.0_f64.powi(-62), 1.0 - f64::EPSILON / 2.0, 1.0, 0.0] {
                let (part, is_right) = x.part_of_one();
                prop_assert_eq!(is_right, (2.0_f64.powi(-62)..1.0).contains(&x), "{}", x);
                prop_assert!(!is_right || part == x.to_phase(0));
            }
            for y in [y, y.abs().fract(), 2.0_f32.powi(-62), 2.0_f32.powi(-63), 1.0 - f32::EPSILON / 2.0, 1.0, 0.0] {
                let (part, is_right) = y.part_of_one();
                prop_assert_eq!(is_right, (2.0_f32.powi(-62)..1.0).contains(&y), "{}", y);
                prop_assert!(!is_right || part == y.to_phase(0));
            }
        }
    }
}
