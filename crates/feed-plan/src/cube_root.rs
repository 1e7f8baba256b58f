//! Cube roots without std.

use real::Real;

/// ∛x of a positive number: `y ← (x y)^(1/4)` ends there, a quarter of the error left each time.
pub(crate) fn cube_root<R: Real>(x: R) -> R {
    if !(x > R::zero() && x < R::max_value()) {
        return x.max(R::zero());
    }
    (0..60).fold(x, |y, _| (x.sqrt() * y.sqrt()).sqrt())
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn cube_roots() {
        for x in [1e-12, 0.3, 1.0, 7.0, 1e9_f64] {
            assert!((cube_root(x) / x.cbrt() - 1.0).abs() < 1e-15 * 4.0, "{x}: {}", cube_root(x));
        }
        assert_eq!(cube_root(0.0), 0.0);
    }
}
