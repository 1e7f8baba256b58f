//! Points and derivatives are those of independent crates, place by place. `cargo test --workspace` compiles none of these crates: there
//! points are compared with the definition in double-double, and derivatives with a finer format's.

use curvo::prelude::NurbsCurve2D;
use nurbs_core::{Differentiate, Evaluate, NurbsBuf, golden};
use real::Real;

/// Parameters from 0 to 1.
fn parameters() -> impl Iterator<Item = f64> {
    (0..1000).map(|k| f64::from(k) / 1000.0)
}

fn in_curvo(curve: &NurbsBuf<f64, 2>) -> NurbsCurve2D<f64> {
    let weighted = curve.control_points().iter().zip(curve.weights());
    let homogeneous = weighted.map(|(p, w)| nalgebra::Point3::new(p[0] * w, p[1] * w, *w));
    NurbsCurve2D::try_new(3, homogeneous.collect(), curve.knots().to_vec()).expect("a curve")
}

#[test]
fn two_independent_crates_give_the_same_points() {
    let (rational, plain) = (golden::seed_003(), golden::seed_000());
    let peer = in_curvo(&rational);
    let axis = |axis: usize| {
        let coordinates = plain.control_points().iter().map(|p| p[axis]).collect();
        bspline::BSpline::new(3, coordinates, plain.knots().to_vec())
    };
    let axes = [axis(0), axis(1)];
    for u in parameters() {
        let (ours, theirs) = (rational.as_curve().point(u), peer.point_at(u));
        let error = f64::norm(&[ours[0] - theirs.x, ours[1] - theirs.y]);
        assert!(error < 1e-12, "curvo, u={u}: {error}");
        let (ours, theirs) = (plain.as_curve().point(u), [axes[0].point(u), axes[1].point(u)]);
        let error = f64::norm(&[ours[0] - theirs[0], ours[1] - theirs[1]]);
        assert!(error < 1e-12, "bspline, u={u}: {error}");
    }
}

#[test]
fn an_independent_crate_gives_the_same_derivatives() {
    let curve = golden::seed_003();
    let peer = in_curvo(&curve);
    for u in parameters() {
        let ours = curve.as_curve().derivatives(u);
        let theirs = peer.rational_derivatives(u, 2);
        for (ours, theirs) in [(ours.first, &theirs[1]), (ours.second, &theirs[2])] {
            let error = f64::norm(&[ours[0] - theirs[0], ours[1] - theirs[1]]);
            let bound = 1e-11 * (1.0 + f64::norm(&ours));
            assert!(error <= bound, "u={u}: {error} > {bound}");
        }
    }
}
