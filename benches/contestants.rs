//! Who evaluates the same curve: this project in three forms, and crates that a user would pick instead.

use bspline::BSpline;
use curvo::prelude::NurbsCurve;
use feedbits_benches::Path;
use nalgebra::allocator::Allocator;
use nalgebra::{DefaultAllocator, DimName, DimNameDiff, DimNameSub, OVector, U1, U4, Vector4};
use nurbs_core::{Derivatives, Differentiate, Evaluate, NurbsBuf, PowerCurve};
use truck_geometry::prelude::{
    BSplineCurve, KnotVec, NurbsCurve as TruckNurbs, ParametricCurve, Point3, Vector4 as TruckVector,
};

/// What is asked of the curve at each parameter.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub(crate) enum Asked {
    /// C(u).
    Point,
    /// C(u), C'(u) and C''(u).
    Derivatives,
}

/// Evaluates at each parameter, in order, and returns the sum of all coordinates.
type Pass = Box<dyn Fn(&[f64]) -> f64>;

/// One way of evaluating one curve.
pub(crate) struct Contestant {
    /// Its name in the tables.
    pub(crate) name: &'static str,
    /// What is timed.
    pub(crate) run: Pass,
}

fn contestant(name: &'static str, run: impl Fn(&[f64]) -> f64 + 'static) -> Contestant {
    Contestant { name, run: Box::new(run) }
}

fn sum<const D: usize>(point: [f64; D]) -> f64 {
    point.iter().sum()
}

fn sum_of<const D: usize>(at: &Derivatives<f64, D>) -> f64 {
    sum(at.point) + sum(at.first) + sum(at.second)
}

/// This project: polynomials with the span remembered, with the span looked up, and the basis functions of the textbook.
pub(crate) const REMEMBERED: &str = "feedbits, span remembered";
/// See [`REMEMBERED`].
pub(crate) const LOOKED_UP: &str = "feedbits, span looked up";
/// This project's polynomials evaluated at many parameters in one call.
pub(crate) const MANY: &str = "feedbits, many at once";
/// See [`REMEMBERED`].
pub(crate) const BASIS: &str = "feedbits, basis functions";
/// The peer that the goals name.
pub(crate) const CURVO: &str = "curvo, evaluator";
/// Point by point.
pub(crate) const CURVO_PLAIN: &str = "curvo, point by point";
/// The crate `bspline`; on a rational curve in homogeneous coordinates.
pub(crate) const BSPLINE: &str = "bspline";
/// The geometry of truck.
pub(crate) const TRUCK: &str = "truck-geometry";

/// All that can do what is asked.
pub(crate) fn contestants(path: &Path<3>, asked: Asked) -> Vec<Contestant> {
    let mut all = ours(path.curve.clone(), asked);
    all.extend(curvo::<3, U4>(&path.curve, asked));
    all.extend((asked == Asked::Point).then(|| bspline(&path.curve)));
    all.push(truck(&path.curve, asked));
    all
}

/// As many as the processor's first cache holds beside what it reads.
pub(crate) fn many_at_once(curve: &NurbsBuf<f64, 3>) -> Contestant {
    let fast = PowerCurve::new::<f64>(&curve.as_curve());
    contestant(MANY, move |parameters| {
        let mut points = [[0.0; 3]; 256];
        let mut total = 0.0;
        for parameters in parameters.chunks(points.len()) {
            fast.points(parameters, &mut points);
            total += points.iter().take(parameters.len()).copied().map(sum).sum::<f64>();
        }
        total
    })
}

/// This project's forms.
pub(crate) fn ours<const D: usize>(curve: NurbsBuf<f64, D>, asked: Asked) -> Vec<Contestant> {
    let fast = PowerCurve::new::<f64>(&curve.as_curve());
    let again = fast.clone();
    match asked {
        Asked::Point => vec![
            contestant(REMEMBERED, move |parameters| {
                let mut cursor = fast.cursor();
                parameters.iter().map(|u| sum(cursor.point(*u))).sum()
            }),
            contestant(LOOKED_UP, move |parameters| parameters.iter().map(|u| sum(again.point(*u))).sum()),
            contestant(BASIS, move |parameters| {
                let curve = curve.as_curve();
                parameters.iter().map(|u| sum(curve.point(*u))).sum()
            }),
        ],
        Asked::Derivatives => vec![
            contestant(REMEMBERED, move |parameters| {
                let mut cursor = fast.cursor();
                parameters.iter().map(|u| sum_of(&cursor.derivatives(*u))).sum()
            }),
            contestant(LOOKED_UP, move |parameters| {
                parameters.iter().map(|u| sum_of(&again.derivatives(*u))).sum()
            }),
            contestant(BASIS, move |parameters| {
                let curve = curve.as_curve();
                parameters.iter().map(|u| sum_of(&curve.derivatives(*u))).sum()
            }),
        ],
    }
}

/// Control points times weights, and weights.
fn homogeneous(curve: &NurbsBuf<f64, 3>) -> impl Iterator<Item = [f64; 4]> {
    curve.control_points().iter().zip(curve.weights()).map(|([x, y, z], w)| [x * w, y * w, z * w, *w])
}

/// Curvo's forms; `N` is one more than `D`.
pub(crate) fn curvo<const D: usize, N>(curve: &NurbsBuf<f64, D>, asked: Asked) -> Vec<Contestant>
where
    N: DimName + DimNameSub<U1>,
    DefaultAllocator: Allocator<N> + Allocator<DimNameDiff<N, U1>>,
{
    let weighted = curve.control_points().iter().zip(curve.weights());
    let points = weighted
        .map(|(point, w)| {
            let numbers = point.iter().map(|x| x * w).chain([*w]);
            OVector::<f64, N>::from_iterator(numbers).into()
        })
        .collect();
    let peer =
        NurbsCurve::<f64, N>::try_new(curve.degree(), points, curve.knots().to_vec()).expect("a curve");
    let again = peer.clone();
    match asked {
        Asked::Point => vec![
            contestant(CURVO, move |parameters| {
                let mut evaluator = peer.evaluator();
                parameters.iter().map(|u| evaluator.point_at(*u).coords.sum()).sum()
            }),
            contestant(CURVO_PLAIN, move |parameters| {
                parameters.iter().map(|u| again.point_at(*u).coords.sum()).sum()
            }),
        ],
        Asked::Derivatives => vec![
            contestant(CURVO, move |parameters| {
                let mut evaluator = peer.evaluator();
                let at = |u: &f64| evaluator.rational_derivatives(*u, 2).iter().map(|v| v.sum()).sum::<f64>();
                parameters.iter().map(at).sum()
            }),
            contestant(CURVO_PLAIN, move |parameters| {
                let at = |u: &f64| again.rational_derivatives(*u, 2).iter().map(|v| v.sum()).sum::<f64>();
                parameters.iter().map(at).sum()
            }),
        ],
    }
}

/// It knows neither weights nor derivatives.
fn bspline(curve: &NurbsBuf<f64, 3>) -> Contestant {
    let knots = curve.knots().to_vec();
    if curve.as_curve().weights().is_some() {
        let points = homogeneous(curve).map(Vector4::from).collect();
        let peer = BSpline::new(curve.degree(), points, knots);
        return contestant(BSPLINE, move |parameters| {
            let at = |u: &f64| {
                let point: Vector4<f64> = peer.point(*u);
                (point.x + point.y + point.z) / point.w
            };
            parameters.iter().map(at).sum()
        });
    }
    let points = curve.control_points().iter().map(|p| nalgebra::Vector3::from(*p)).collect();
    let peer = BSpline::new(curve.degree(), points, knots);
    contestant(BSPLINE, move |parameters| {
        let at = |u: &f64| {
            let point: nalgebra::Vector3<f64> = peer.point(*u);
            point.sum()
        };
        parameters.iter().map(at).sum()
    })
}

fn truck(curve: &NurbsBuf<f64, 3>, asked: Asked) -> Contestant {
    let knots = KnotVec::from(curve.knots().to_vec());
    if curve.as_curve().weights().is_some() {
        let points = homogeneous(curve).map(|[x, y, z, w]| TruckVector::new(x, y, z, w)).collect();
        return followed(TruckNurbs::new(BSplineCurve::new(knots, points)), asked);
    }
    let points = curve.control_points().iter().map(|[x, y, z]| Point3::new(*x, *y, *z)).collect();
    followed(BSplineCurve::new(knots, points), asked)
}

/// Truck has a call for each derivative.
fn followed<C>(peer: C, asked: Asked) -> Contestant
where
    C: ParametricCurve<Point = Point3, Vector = truck_geometry::prelude::Vector3> + 'static,
{
    match asked {
        Asked::Point => contestant(TRUCK, move |parameters| {
            let at = |u: &f64| {
                let p = peer.subs(*u);
                p.x + p.y + p.z
            };
            parameters.iter().map(at).sum()
        }),
        Asked::Derivatives => contestant(TRUCK, move |parameters| {
            let at = |u: &f64| {
                let (p, a, b) = (peer.subs(*u), peer.der(*u), peer.der2(*u));
                p.x + p.y + p.z + a.x + a.y + a.z + b.x + b.y + b.z
            };
            parameters.iter().map(at).sum()
        }),
    }
}
