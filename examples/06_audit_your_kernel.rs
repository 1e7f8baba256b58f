//! An algorithm of your own, watched in a number format: what overflows, how many bits each signal needs, what it costs.
//!
//!     cargo run -p feedbits-examples --example 06_audit_your_kernel

use std::error::Error;

use real::{Audit, Audited, Backend, Counted, I8F24, I16F16, OperationCounts, Real};

/// The radius of the circle through three points, `abc/(4 S)`, S the area of the triangle.
fn radius<R: Real>(p: [R; 2], q: [R; 2], r: [R; 2]) -> R {
    let side = |a: [R; 2], b: [R; 2]| R::norm(&[b[0] - a[0], b[1] - a[1]]);
    let (a, b, c) = (side(p, q), side(q, r), side(r, p));
    let twice_the_area = ((q[0] - p[0]) * (r[1] - p[1]) - (q[1] - p[1]) * (r[0] - p[0])).abs().signal("area");
    ((a * b).signal("product") * c).signal("product") / (twice_the_area + twice_the_area)
}

/// The radius of 40 mm from three points of the circle, in the format `R`.
fn of_a_circle<R: Backend>() -> Result<f64, Box<dyn Error>> {
    let at = |angle: f64| {
        let point = [40.0 * angle.cos(), 40.0 * angle.sin()].map(R::from_f64);
        Some([point[0]?, point[1]?])
    };
    let points = [0.2, 0.5, 0.9].map(at);
    let [Some(p), Some(q), Some(r)] = points else { return Err("40 mm do not fit the format".into()) };
    Ok(radius(p, q, r).to_f64())
}

fn main() -> Result<(), Box<dyn Error>> {
    for (name, (found, audit)) in [
        ("I16F16", Audit::of(of_a_circle::<Audited<I16F16>>)),
        ("I8F24", Audit::of(of_a_circle::<Audited<I8F24>>)),
    ] {
        println!("{name}: a radius of {:.5} mm, {} overflows", found?, audit.overflows);
        println!("    {} integer bits are needed, the sign among them", audit.integer_bits_needed());
    }
    let (_, counts) = OperationCounts::of(of_a_circle::<Counted<f64>>);
    println!("{counts:?}");
    let (right, audit) = Audit::of(of_a_circle::<Audited<I16F16>>);
    assert!((right? - 40.0).abs() < 0.01 && audit.overflows == 0);
    assert!(Audit::of(of_a_circle::<Audited<I8F24>>).1.overflows > 0);
    Ok(())
}

#[test]
fn it_runs() -> Result<(), Box<dyn Error>> {
    main()
}
