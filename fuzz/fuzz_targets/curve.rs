#![no_main]

use arbitrary::Unstructured;
use libfuzzer_sys::fuzz_target;
use nurbs_core::{Differentiate, Evaluate, NurbsBuf, arc_length, curvature};
use real::{Backend, I4F28, I16F16, I32F32};
use stress::{any_curve, any_number};

fuzz_target!(|bytes: &[u8]| {
    let mut bytes = Unstructured::new(bytes);
    let Ok(curve) = any_curve::<2>(&mut bytes) else { return };
    let parameters = [any_number(&mut bytes), any_number(&mut bytes), any_number(&mut bytes)];
    evaluate::<f64>(&curve, &parameters);
    evaluate::<f32>(&curve, &parameters);
    evaluate::<I16F16>(&curve, &parameters);
    evaluate::<I32F32>(&curve, &parameters);
    evaluate::<I4F28>(&curve, &parameters);
    stays_in_the_hull(&curve);
});

/// Any parameter, inside or out, gives a point.
fn evaluate<R: Backend>(curve: &NurbsBuf<f64, 2>, parameters: &[f64]) {
    let Ok(curve) = curve.convert::<R>() else { return };
    let curve = curve.as_curve();
    let (begin, end) = curve.domain();
    let at =
        parameters.iter().filter_map(|u| R::from_f64(*u)).chain(curve.knots().as_slice().iter().copied());
    for u in at {
        let _ = curvature(&curve.derivatives(u));
        let _ = curve.derivatives_in(usize::MAX, u);
    }
    for span in 0..curve.span_count() {
        let (first, last) = curve.span_bounds(span);
        assert!(first < last && first >= begin && last <= end);
    }
    let measured = arc_length(&curve, begin, end, R::one());
    let _ = measured.length;
}

/// A point of the curve is a mean of control points: no coordinate is beyond theirs, but for rounding.
fn stays_in_the_hull(curve: &NurbsBuf<f64, 2>) {
    let borrowed = curve.as_curve();
    let (begin, end) = borrowed.domain();
    let largest = curve.control_points().iter().flatten().fold(0.0_f64, |m, x| m.max(x.abs()));
    let heaviest = curve.weights().iter().fold(1.0_f64, |m, w| m.max(*w));
    let lightest = curve.weights().iter().fold(1.0_f64, |m, w| m.min(*w));
    let tame = |x: f64| (1e-100..1e100).contains(&x);
    if !tame(largest) || !tame(heaviest) || !tame(lightest) || !tame(end - begin) {
        return;
    }
    for part in 0..=8 {
        let u = begin + (end - begin) * f64::from(part) / 8.0;
        for x in borrowed.point(u.min(end)) {
            assert!(x.abs() <= largest * (1.0 + 1e-12), "{x} of {largest} at {u}");
        }
    }
}
