//! One curve of a path, of any kind: planner and interpolator run on it when a path mixes kinds.

use real::{Backend, Real};

use crate::{Arc, Derivatives, Differentiate, Evaluate, Line, NurbsBuf, ShapeError, TrigSplineBuf};

/// A curve of any kind that owns its numbers.
///
/// ```
/// use nurbs_core::{Arc, Evaluate, Line, PathCurve, Sense};
///
/// // 10 mm along x, then a quarter circle of 5 mm to the left.
/// let line = Line::try_new([0.0, 0.0], [10.0, 0.0])?;
/// let arc = Arc::in_plane([[10.0, 0.0], [15.0, 5.0], [10.0, 5.0]], [0, 1], Sense::Counterclockwise, 1e-3)?;
/// let path: Vec<PathCurve<f64, 2>> = vec![line.into(), arc.into()];
///
/// let [x, y] = path[1].point(0.5);
/// assert!(((x - 10.0).hypot(y - 5.0) - 5.0).abs() < 1e-14);
/// // For real time each becomes a NURBS curve: line and arc exactly, a trigonometric spline within a tolerance.
/// assert_eq!(path[1].to_nurbs(1e-6)?.degree(), 2);
/// # Ok::<(), nurbs_core::ShapeError>(())
/// ```
#[derive(Clone, Debug, PartialEq)]
pub enum PathCurve<R, const D: usize> {
    /// A NURBS curve.
    Nurbs(NurbsBuf<R, D>),
    /// A straight move.
    Line(Line<R, D>),
    /// A circular arc.
    Arc(Arc<R, D>),
    /// A trigonometric spline.
    TrigSpline(TrigSplineBuf<R, D>),
}

/// Runs the same expression on a curve of any kind.
macro_rules! on_curve {
    ($self:expr, $curve:ident => $answer:expr) => {
        match $self {
            PathCurve::Nurbs(nurbs) => {
                let $curve = nurbs.as_curve();
                $answer
            }
            PathCurve::Line($curve) => $answer,
            PathCurve::Arc($curve) => $answer,
            PathCurve::TrigSpline(spline) => {
                let $curve = spline.as_spline();
                $answer
            }
        }
    };
}

impl<R: Real, const D: usize> Evaluate<R, D> for PathCurve<R, D> {
    fn domain(&self) -> (R, R) {
        on_curve!(self, curve => curve.domain())
    }

    fn point(&self, u: R) -> [R; D] {
        on_curve!(self, curve => curve.point(u))
    }

    fn span_count(&self) -> usize {
        on_curve!(self, curve => curve.span_count())
    }

    fn span_bounds(&self, span: usize) -> (R, R) {
        on_curve!(self, curve => curve.span_bounds(span))
    }
}

impl<R: Real, const D: usize> Differentiate<R, D> for PathCurve<R, D> {
    fn derivatives(&self, u: R) -> Derivatives<R, D> {
        on_curve!(self, curve => curve.derivatives(u))
    }

    fn derivatives_in(&self, span: usize, u: R) -> Derivatives<R, D> {
        on_curve!(self, curve => curve.derivatives_in(span, u))
    }

    fn is_line(&self, span: usize) -> bool {
        on_curve!(self, curve => curve.is_line(span))
    }
}

impl<R, const D: usize> From<NurbsBuf<R, D>> for PathCurve<R, D> {
    fn from(curve: NurbsBuf<R, D>) -> Self {
        Self::Nurbs(curve)
    }
}

impl<R, const D: usize> From<Line<R, D>> for PathCurve<R, D> {
    fn from(line: Line<R, D>) -> Self {
        Self::Line(line)
    }
}

impl<R, const D: usize> From<Arc<R, D>> for PathCurve<R, D> {
    fn from(arc: Arc<R, D>) -> Self {
        Self::Arc(arc)
    }
}

impl<R, const D: usize> From<TrigSplineBuf<R, D>> for PathCurve<R, D> {
    fn from(spline: TrigSplineBuf<R, D>) -> Self {
        Self::TrigSpline(spline)
    }
}

/// Degree of the polynomials that replace a trigonometric spline. With degree 5 the second derivatives at the joints
/// are the spline's own, and a corner takes a handful of pieces.
const POLYNOMIAL_DEGREE: usize = 5;

impl<const D: usize> PathCurve<f64, D> {
    /// The curve with every number rounded to the nearest of another format.
    ///
    /// # Errors
    /// [`ShapeError::OutOfRange`] names the number that does not fit; [`ShapeError::Curve`] for a NURBS curve.
    pub fn convert<Q: Backend>(&self) -> Result<PathCurve<Q, D>, ShapeError> {
        Ok(match self {
            Self::Nurbs(curve) => curve.convert()?.into(),
            Self::Line(line) => line.convert()?.into(),
            Self::Arc(arc) => arc.convert()?.into(),
            Self::TrigSpline(spline) => spline.convert()?.into(),
        })
    }

    /// The curve as NURBS, which real time evaluates without sine and cosine. A line becomes degree 1 and an arc degree
    /// 2, both exactly. A trigonometric spline becomes polynomials of degree 5 that are nowhere farther than
    /// `tolerance_mm` from it.
    ///
    /// # Errors
    /// Those of [`TrigSplineBuf::to_polynomials`]; [`ShapeError::Curve`] when both ends of a line are one point.
    pub fn to_nurbs(&self, tolerance_mm: f64) -> Result<NurbsBuf<f64, D>, ShapeError> {
        match self {
            Self::Nurbs(curve) => Ok(curve.clone()),
            Self::Line(line) => line.to_nurbs(),
            Self::Arc(arc) => arc.to_nurbs(),
            Self::TrigSpline(spline) => Ok(spline.to_polynomials(tolerance_mm, POLYNOMIAL_DEGREE)?.curve),
        }
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::vector::distance;
    use crate::{Ends, Sense, ShapeFactors, arc_length, golden};
    use real::{I8F24, I16F16};

    /// One curve of each kind.
    fn all_kinds() -> [PathCurve<f64, 2>; 4] {
        let shape = ShapeFactors::symmetric();
        [
            golden::circle(5.0).into(),
            Line::try_new([1.0, 2.0], [11.0, -3.0]).unwrap().into(),
            Arc::in_plane([[5.0, 0.0], [0.0, 5.0], [0.0, 0.0]], [0, 1], Sense::Clockwise, 1e-6)
                .unwrap()
                .into(),
            TrigSplineBuf::through(&[[0.0, 0.0], [3.0, 4.0], [8.0, 0.0]], shape, Ends::Continued)
                .unwrap()
                .into(),
        ]
    }

    #[test]
    fn every_kind_answers_as_itself_and_as_nurbs() {
        for curve in all_kinds() {
            let nurbs = curve.to_nurbs(1e-9).unwrap();
            let (begin, end) = curve.domain();
            assert_eq!((begin, end), nurbs.as_curve().domain());
            for span in 0..curve.span_count() {
                let (from, to) = curve.span_bounds(span);
                let middle = (from + to) / 2.0;
                let mine = curve.derivatives_in(span, middle);
                assert_eq!(mine, curve.derivatives(middle));
                assert_eq!(mine.point, curve.point(middle));
                // At the middle of a span even the rational arc has the same parameter.
                let its = nurbs.as_curve().point(middle);
                for d in 0..2 {
                    assert!((mine.point[d] - its[d]).abs() <= 1e-9, "{curve:?}: {mine:?} {its:?}");
                }
            }
            let length = arc_length(&nurbs.as_curve(), begin, end, 1e-10).length;
            let steps = 20_000;
            let at = |step: i32| curve.point(begin + (end - begin) * f64::from(step) / f64::from(steps));
            let chords = (0..steps).map(|i| distance(&at(i + 1), &at(i)));
            assert!((chords.sum::<f64>() - length).abs() < 1e-6);
        }
    }

    #[test]
    fn every_kind_converts() {
        for curve in all_kinds() {
            assert_eq!(curve.convert::<f64>().unwrap(), curve);
            let coarse = curve.convert::<I16F16>().unwrap();
            let (begin, end) = curve.domain();
            let (middle, coarse_middle) =
                ((begin + end) / 2.0, (coarse.domain().0 + coarse.domain().1).half());
            for (exact, found) in curve.point(middle).into_iter().zip(coarse.point(coarse_middle)) {
                assert!((exact - found.to_f64()).abs() < 2e-3, "{curve:?}: {exact} {found:?}");
            }
        }
        let far: PathCurve<f64, 2> = Line::try_new([0.0, 0.0], [1e6, 0.0]).unwrap().into();
        assert!(far.convert::<I8F24>().is_err());
        assert!(matches!(
            PathCurve::from(Line::try_new([1.0], [f64::MAX]).unwrap()).convert::<f32>(),
            Err(ShapeError::OutOfRange { .. })
        ));
    }
}
