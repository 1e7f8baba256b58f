//! Vectors in any number of dimensions.

use core::array::from_fn;

use real::Real;

pub(crate) fn sum<R: Real, const D: usize>(a: &[R; D], b: &[R; D]) -> [R; D] {
    from_fn(|d| a[d] + b[d])
}

pub(crate) fn difference<R: Real, const D: usize>(a: &[R; D], b: &[R; D]) -> [R; D] {
    from_fn(|d| a[d] - b[d])
}

/// The direction of a vector; 0 for the vector 0.
pub(crate) fn unit<R: Real, const D: usize>(vector: &[R; D]) -> [R; D] {
    let length = R::norm(vector);
    vector.map(|x| if length > R::zero() { x / length } else { R::zero() })
}

/// The part of a vector that is across another.
pub(crate) fn across<R: Real, const D: usize>(vector: &[R; D], along: &[R; D]) -> [R; D] {
    let square = R::sum_of_products(along.iter().copied().zip(*along));
    if !(square > R::zero()) {
        return *vector;
    }
    let share = R::sum_of_products(vector.iter().copied().zip(*along)) / square;
    from_fn(|d| vector[d] - share * along[d])
}
