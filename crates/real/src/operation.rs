//! The operations of a [`Real`], as values: wrappers count and record them.

use crate::Real;

/// An operation that makes a number.
#[derive(Clone, Copy, Debug, PartialEq, Eq, PartialOrd, Ord, Hash)]
#[non_exhaustive]
pub enum Operation {
    /// `a + b`.
    Add,
    /// `a - b`.
    Sub,
    /// `-a`.
    Neg,
    /// `a * b`.
    Mul,
    /// `a * b + c`.
    MulAdd,
    /// `Σ aᵢ·bᵢ`; operands in the order a₀, b₀, a₁, b₁, ….
    SumOfProducts,
    /// `a / b`.
    Div,
    /// `√a`.
    Sqrt,
    /// `√(Σ vᵢ²)`.
    Norm,
    /// `a · 2^exponent`, [`Real::ldexp`]; files of costs call it `scale`.
    Scale {
        /// The power of two.
        exponent: i32,
    },
}

impl Operation {
    /// The result for these operands, in their order. The method of [`Real`] with the same name gives the same.
    ///
    /// # Panics
    /// If there are fewer operands than the operation takes, or a norm of more than 256 components.
    #[must_use]
    pub fn apply<R: Real>(self, operands: &[R]) -> R {
        match self {
            Self::Add => operands[0] + operands[1],
            Self::Sub => operands[0] - operands[1],
            Self::Neg => -operands[0],
            Self::Mul => operands[0] * operands[1],
            Self::MulAdd => operands[0].mul_add(operands[1], operands[2]),
            Self::SumOfProducts => {
                R::sum_of_products(operands.chunks_exact(2).map(|pair| (pair[0], pair[1])))
            }
            Self::Div => operands[0] / operands[1],
            Self::Sqrt => operands[0].sqrt(),
            Self::Norm => norm(operands),
            Self::Scale { exponent } => operands[0].ldexp(exponent),
        }
    }
}

/// The norm of a slice, filled up with zeros to 4, 16 or 256 components: zeros do not change the norm.
fn norm<R: Real>(vector: &[R]) -> R {
    fn filled<R: Real, const N: usize>(vector: &[R]) -> R {
        R::norm::<N>(&core::array::from_fn(|i| vector.get(i).copied().unwrap_or(R::zero())))
    }
    match vector.len() {
        0..=4 => filled::<R, 4>(vector),
        5..=16 => filled::<R, 16>(vector),
        length => {
            assert!(length <= 256, "a norm of {length} components");
            filled::<R, 256>(vector)
        }
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::{I4F4, I16F16};
    use num_traits::One;

    #[test]
    fn an_operation_is_that_of_the_trait() {
        let [a, b, c, d] = [(7, 4), (-5, 2), (3, 16), (1, 1)].map(|(n, d)| I16F16::from_ratio(n, d));
        assert_eq!(Operation::Add.apply(&[a, b]), a + b);
        assert_eq!(Operation::Sub.apply(&[a, b]), a - b);
        assert_eq!(Operation::Neg.apply(&[a]), -a);
        assert_eq!(Operation::Mul.apply(&[a, b]), a * b);
        assert_eq!(Operation::MulAdd.apply(&[a, b, c]), a.mul_add(b, c));
        assert_eq!(Operation::SumOfProducts.apply(&[a, b, c, d]), I16F16::sum_of_products([(a, b), (c, d)]));
        assert_eq!(Operation::Div.apply(&[a, b]), a / b);
        assert_eq!(Operation::Sqrt.apply(&[a]), a.sqrt());
        assert_eq!(Operation::Scale { exponent: -3 }.apply(&[a]), a.ldexp(-3));
        assert_eq!(Operation::Norm.apply(&[a, b, c]), I16F16::norm(&[a, b, c]));
        assert_eq!(Operation::Norm.apply(&[a, b, c, d, a]), I16F16::norm(&[a, b, c, d, a]));
        assert_eq!(Operation::Norm.apply(&[I4F4::one(); 49]), I4F4::from_ratio(7, 1));
    }
}
