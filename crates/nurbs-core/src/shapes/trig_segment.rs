//! Segments of cubic trigonometric interpolation splines: exactly a line, exactly a circular arc, or free.
//!
//! A segment is `P(u) = Σ q_j B_j(u)` over the [basis](crate::trig_basis()) with shape factors λ and k:
//!
//! - `P(0) = q_0`, `P(1) = q_1`;
//! - `P'(0) = (q_1 - q_0) - k (q_2 - q_1)`, `P'(1) = (q_2 - q_1) - k (q_3 - q_2)`.
//!
//! | shape | control points | factors |
//! |---|---|---|
//! | line from B to C | B, C, B, C | λ = 0, k = -1: `P = (B - C) C³ + C` |
//! | quarter circle about O from a to b | O + a, O + b, O + a + π/2 b, O + b - π/2 a | k = -1, any λ: `P = O + C a + S b` |
//! | free curve | each four consecutive ones of a sequence | any, k the same for all |
//!
//! The line stands still at both ends (`P' = 0`); for a planner that shall pass there, take [`Line`](crate::Line). On
//! the circle λ drops
//! out, because its bump is multiplied by `(q_0 - q_1) + (2/π)(D_0 + D_1)`, which is 0 there; paper B asks for λ = 1.

use real::Real;
#[cfg(feature = "alloc")]
use real::{Backend, Trigonometric};

use crate::nurbs::curve::axis_too_wide;
#[cfg(feature = "alloc")]
use crate::shapes::rounded::round_all;
#[cfg(feature = "alloc")]
use crate::vector::sub;
use crate::vector::{add, weighted_sum};
use crate::{
    Derivatives, Differentiate, Evaluate, ShapeError, ShapeFactors, trig_basis, trig_basis_derivatives,
};

/// One segment, or a part of one, as a curve over u in [begin, end].
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct TrigSegment<R, const D: usize> {
    control_points: [[R; D]; 4],
    shape: ShapeFactors<R>,
    begin: R,
    end: R,
}

impl<R: Real, const D: usize> TrigSegment<R, D> {
    /// The whole segment of four control points `q_0 … q_3`.
    ///
    /// # Errors
    /// [`ShapeError::NotFinite`]; [`ShapeError::ExtentTooWide`] when a difference of control points does not fit the format.
    pub fn try_new(control_points: [[R; D]; 4], shape: ShapeFactors<R>) -> Result<Self, ShapeError> {
        if !control_points.iter().flatten().all(|x| x.is_finite()) {
            return Err(ShapeError::NotFinite { what: "a control point" });
        }
        if !(shape.lambda.is_finite() && shape.k.is_finite()) {
            return Err(ShapeError::NotFinite { what: "a shape factor" });
        }
        match axis_too_wide(&control_points, R::max_value()) {
            Some(axis) => Err(ShapeError::ExtentTooWide { axis }),
            None => Ok(Self { control_points, shape, begin: R::zero(), end: R::one() }),
        }
    }

    /// The segment from `q_0` to `q_1` with the derivatives `D_0` and `D_1` at its ends, as in Hermite's form. The
    /// other two control points follow with k = -1.
    ///
    /// # Errors
    /// Those of [`try_new`](Self::try_new).
    pub fn between(ends: [[R; D]; 2], derivatives: [[R; D]; 2], lambda: R) -> Result<Self, ShapeError> {
        let beyond = |i: usize| add(&ends[i], &derivatives[i]);
        let shape = ShapeFactors { lambda, k: -R::one() };
        Self::try_new([ends[0], ends[1], beyond(0), beyond(1)], shape)
    }

    /// The line from B to C. It stands still at both ends.
    ///
    /// # Errors
    /// Those of [`try_new`](Self::try_new).
    pub fn line(b: [R; D], c: [R; D]) -> Result<Self, ShapeError> {
        Self::try_new([b, c, b, c], ShapeFactors { lambda: R::zero(), k: -R::one() })
    }

    /// The part of the segment over u in [begin, end]; the parameter stays as it is.
    ///
    /// # Errors
    /// [`ShapeError::PartOutsideSegment`] unless `0 ≤ begin < end ≤ 1`.
    pub fn part(self, begin: R, end: R) -> Result<Self, ShapeError> {
        if begin >= R::zero() && begin < end && end <= R::one() {
            Ok(Self { begin, end, ..self })
        } else {
            Err(ShapeError::PartOutsideSegment)
        }
    }

    /// The control points `q_0 … q_3` of the whole segment.
    #[must_use]
    pub fn control_points(&self) -> &[[R; D]; 4] {
        &self.control_points
    }

    /// The shape factors.
    #[must_use]
    pub fn shape(&self) -> &ShapeFactors<R> {
        &self.shape
    }
}

impl<R: Real, const D: usize> Evaluate<R, D> for TrigSegment<R, D> {
    fn domain(&self) -> (R, R) {
        (self.begin, self.end)
    }

    /// The point `P(u)`. At u = 0 and 1 it is exactly the first and the second control point, in every format. Beyond
    /// [-1/2, 3/2] it stays where it is at the nearer end.
    ///
    /// Accuracy: the basis functions are within 12 units, and in fixed point their sum is exactly 1. So each axis is
    /// within half a unit plus 12 units for every unit of length by which q_0, q_2 and q_3 differ from q_1.
    fn point(&self, u: R) -> [R; D] {
        weighted_sum(&trig_basis(u, &self.shape), &self.control_points)
    }

    fn span_count(&self) -> usize {
        1
    }

    fn span_bounds(&self, _: usize) -> (R, R) {
        self.domain()
    }
}

impl<R: Real, const D: usize> Differentiate<R, D> for TrigSegment<R, D> {
    fn derivatives(&self, u: R) -> Derivatives<R, D> {
        let [point, first, second] = trig_basis_derivatives(u, &self.shape)
            .map(|functions| weighted_sum(&functions, &self.control_points));
        Derivatives { point, first, second }
    }

    fn derivatives_in(&self, _: usize, u: R) -> Derivatives<R, D> {
        self.derivatives(u)
    }
}

#[cfg(feature = "alloc")]
impl<const D: usize> TrigSegment<f64, D> {
    /// The segment with every number rounded to the nearest of another format.
    ///
    /// # Errors
    /// [`ShapeError::OutOfRange`]; [`ShapeError::ExtentTooWide`]; [`ShapeError::PartOutsideSegment`] when the part vanishes.
    pub fn convert<Q: Backend>(&self) -> Result<TrigSegment<Q, D>, ShapeError> {
        let mut control_points = [[Q::zero(); D]; 4];
        for (to, from) in control_points.iter_mut().zip(&self.control_points) {
            *to = round_all(from, "a control point")?;
        }
        let [lambda, k] = round_all(&[self.shape.lambda, self.shape.k], "a shape factor")?;
        let [begin, end] = round_all(&[self.begin, self.end], "a part of a segment")?;
        TrigSegment::try_new(control_points, ShapeFactors { lambda, k })?.part(begin, end)
    }
}

/// The quarter circle `O + C a + S b`, of which an arc is made.
#[cfg(feature = "alloc")]
pub(crate) fn quarter_circle<R: Real, const D: usize>(
    centre: &[R; D],
    a: &[R; D],
    b: &[R; D],
) -> Result<TrigSegment<R, D>, ShapeError> {
    let half_pi = R::half_pi();
    let along = |v: &[R; D]| v.map(|x| half_pi * x);
    let offsets = [*a, *b, add(a, &along(b)), sub(b, &along(a))];
    TrigSegment::try_new(offsets.map(|offset| add(centre, &offset)), ShapeFactors::symmetric())
}
