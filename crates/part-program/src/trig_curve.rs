//! A curve of a curve file with `shape = "trigonometric"`: a cubic trigonometric interpolation spline, read as the polynomials
//! that replace it.
//!
//! ```toml
//! [curve]
//! shape = "trigonometric"
//! control_points_mm = [[0, 0], [10, 30], [40, 35], [50, 5]]
//! lambda = 1.0         # shape factor λ
//! k = -1.0             # shape factor k
//! ends = "continued"   # or "repeated", "closed", "as-given": what follows the last point
//! tolerance_mm = 1e-6  # how far the polynomials may be from the spline
//! ```
//!
//! Segment i goes from control point i to control point i + 1. Real time has neither sine nor cosine: each segment becomes
//! polynomials of degree 5, with a proven bound of their distance (`nurbs_core::TrigSplineBuf::to_polynomials`).
//!
//! **Source**: paper B (Tao Jianming et al.; see `docs/papers.md`), with its shape factors.

use domains::curve::{ENDS, K, LAMBDA, POINTS, TOLERANCE};
use nurbs_core::{Ends, ShapeError, ShapeFactors, TrigSplineBuf};

use crate::curve::{Curve, Nurbs, coordinate_faults};
use crate::curve_numbers::{Places, control_points, say};
use crate::source::Span;
use crate::toml_table::TableReader;

/// With degree 5 the polynomials have the spline's own second derivatives at their joints.
const DEGREE: usize = 5;

/// The way to continue after the last point, by its word.
fn ends_of(word: &str) -> Option<Ends> {
    Some(match word {
        "continued" => Ends::Continued,
        "repeated" => Ends::Repeated,
        "closed" => Ends::Closed,
        "as-given" => Ends::AsGiven,
        _ => return None,
    })
}

/// Reads the keys that only these curves have; the table's header is at `header`.
pub(crate) fn from_keys(mut keys: TableReader<'_, '_, '_>, header: Span) -> Option<Curve> {
    let points = keys.array(POINTS.name);
    let lambda = keys.number(&LAMBDA);
    let k = keys.number(&K);
    let word = keys.word(&ENDS);
    let tolerance_at = keys.optional(TOLERANCE.name).map_or(header, |value| value.span().into());
    let tolerance_mm = keys.number(&TOLERANCE);
    let report = keys.finish();

    let points_at = points?;
    let mut places = Places::all_at(points_at);
    let (points, dimension) = control_points(report, points_at, &mut places.point)?;
    let faults = coordinate_faults(&points);
    say(report, &places, &faults);
    let ends = word.and_then(ends_of)?;
    let shape = ShapeFactors { lambda: lambda?, k: k? };
    if !faults.is_empty() {
        return None;
    }
    let tolerance_mm = tolerance_mm?;
    let spline = TrigSplineBuf::through(&points, shape, ends);
    match spline.and_then(|spline| spline.to_polynomials(tolerance_mm, DEGREE)) {
        Ok(polynomials) => {
            let curve = Nurbs::of(&polynomials.curve, dimension);
            // The polynomials have points of their own.
            say(report, &Places::all_at(points_at), &curve.faults());
            Some(curve.into())
        }
        Err(error) => {
            let (place, expected) = match error {
                ShapeError::TooFewPoints { least, .. } => {
                    (points_at, format!("at least {least} control points with these ends"))
                }
                ShapeError::TooManyPieces { .. } => (tolerance_at, "a greater tolerance".into()),
                _ => (points_at, "control points of a curve".into()),
            };
            report.error(place, error.to_string()).expected(expected);
            None
        }
    }
}

#[cfg(test)]
mod tests {
    use crate::read_part;

    const KEYS: &str = "shape = \"trigonometric\"\nlambda = 1\nk = -1\n";

    fn read(points: &str, more: &str) -> Result<crate::Part, String> {
        let text = format!("[curve]\n{KEYS}control_points_mm = {points}\n{more}");
        read_part("t.toml", &text).map_err(|faults| faults.to_string())
    }

    /// Paper B's quarter circle of radius 20: (a C, a S).
    #[test]
    fn a_quarter_circle_is_one() {
        let a = 20.0_f64;
        let beyond = a * std::f64::consts::FRAC_PI_2;
        let points = format!("[[{a}, 0], [0, {a}], [{a}, {beyond}], [{}, {a}]]", -beyond);
        let part = read(&points, "ends = \"as-given\"\ntolerance_mm = 1e-9\n").unwrap();
        let curve = &part.curves[0];
        assert_eq!((curve.degree(), curve.dimension()), (5, 2));
        // Ends of the polynomials lie on the circle, and so do, within the tolerance, their middles.
        for polynomial in curve.control_points_mm().windows(6).step_by(5) {
            let blend = [1.0, 5.0, 10.0, 10.0, 5.0, 1.0].map(|weight| weight / 32.0);
            let middle = |d: usize| polynomial.iter().zip(blend).map(|(p, w)| p[d] * w).sum::<f64>();
            for [x, y] in [[polynomial[0][0], polynomial[0][1]], [middle(0), middle(1)]] {
                assert!((x.hypot(y) - a).abs() < 1.1e-9, "({x}, {y})");
            }
        }
    }

    #[test]
    fn the_ends_say_what_is_passed() {
        let points = "[[0, 0, 0], [10, 30, 1], [40, 35, 2], [50, 5, 4]]";
        let passed = |ends: &str| {
            let part = read(points, ends).unwrap();
            let curve = &part.curves[0];
            assert_eq!(curve.dimension(), 3);
            let knots = &curve.knots();
            (knots[knots.len() - 1], *curve.control_points_mm().last().unwrap())
        };
        assert_eq!(passed(""), (3.0, [50.0, 5.0, 4.0]));
        assert_eq!(passed("ends = \"continued\""), (3.0, [50.0, 5.0, 4.0]));
        assert_eq!(passed("ends = \"repeated\""), (3.0, [50.0, 5.0, 4.0]));
        assert_eq!(passed("ends = \"closed\""), (4.0, [0.0, 0.0, 0.0]));
        assert_eq!(passed("ends = \"as-given\""), (1.0, [10.0, 30.0, 1.0]));
    }

    #[test]
    fn faults_are_said_at_their_place() {
        let points = "[[0, 0], [10, 30], [40, 35], [50, 5]]";
        let cases = [
            (points, "ends = \"open\"", "t.toml:6:8", "`ends` is \"open\""),
            (points, "tolerance_mm = 0", "t.toml:6:16", "`tolerance_mm` is 0"),
            (points, "tolerance_mm = 1e-30", "t.toml:6:16", "`tolerance_mm` is 1e-30"),
            (points, "degree = 3", "t.toml:6:1", "unknown key `degree`"),
            ("[[0, 0], [9, 3], [4, 5]]", "ends = \"as-given\"", "t.toml:5:21", "3 points are fewer than 4"),
            ("[[0, 0], [10, 3e8]]", "", "t.toml:5:30", "control point 1 has the coordinate 300000000"),
            ("[[1, 1], [1, 1]]", "", "t.toml:5:21", "all control points are the same"),
            ("[[0, 0], [1, 1, 1]]", "", "t.toml:5:30", "a control point has 3 coordinates, the first has 2"),
        ];
        for (points, more, place, expected) in cases {
            let said = read(points, more).unwrap_err();
            assert!(said.contains(place) && said.contains(expected), "{more}: {said}");
        }
        let said = read_part("t.toml", "[curve]\nshape = \"bezier\"\n").unwrap_err().to_string();
        assert!(said.contains("t.toml:2:9") && said.contains("`shape` is \"bezier\""), "{said}");
    }
}
