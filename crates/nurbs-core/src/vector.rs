//! Vectors in any number of dimensions, component by component.
//!
//! Only [`dot`] and [`weighted_sum`] are sums of products, which fixed point rounds once. Every other function rounds
//! as it is written, from left to right.

use core::array::from_fn;

use real::Real;

/// `a + b`.
#[inline]
pub(crate) fn add<R: Real, const D: usize>(a: &[R; D], b: &[R; D]) -> [R; D] {
    from_fn(|d| a[d] + b[d])
}

/// `a - b`.
#[inline]
pub(crate) fn sub<R: Real, const D: usize>(a: &[R; D], b: &[R; D]) -> [R; D] {
    from_fn(|d| a[d] - b[d])
}

/// `v · factor`.
#[inline]
pub(crate) fn scaled<R: Real, const D: usize>(v: &[R; D], factor: R) -> [R; D] {
    v.map(|x| x * factor)
}

/// `v / divisor`.
#[inline]
pub(crate) fn over<R: Real, const D: usize>(v: &[R; D], divisor: R) -> [R; D] {
    v.map(|x| x / divisor)
}

/// `a + t (b - a)`, the product and the sum rounded as [`Real::mul_add`] does.
#[inline]
#[cfg(feature = "alloc")]
pub(crate) fn lerp<R: Real, const D: usize>(a: &[R; D], b: &[R; D], t: R) -> [R; D] {
    from_fn(|d| t.mul_add(b[d] - a[d], a[d]))
}

/// `a · b`.
#[inline]
pub(crate) fn dot<R: Real, const D: usize>(a: &[R; D], b: &[R; D]) -> R {
    R::sum_of_products(a.iter().copied().zip(b.iter().copied()))
}

/// `|a - b|`.
#[inline]
#[cfg(feature = "alloc")]
pub(crate) fn distance<R: Real, const D: usize>(a: &[R; D], b: &[R; D]) -> R {
    R::norm(&sub(a, b))
}

/// `Σ factors_r · points_r`.
#[inline]
pub(crate) fn weighted_sum<R: Real, const D: usize>(factors: &[R], points: &[[R; D]]) -> [R; D] {
    from_fn(|d| R::sum_of_products(factors.iter().zip(points).map(|(factor, point)| (*factor, point[d]))))
}
