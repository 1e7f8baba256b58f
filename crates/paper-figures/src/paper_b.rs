//! Paper B (Tao Jianming et al.; see `docs/papers.md`): what its formulas promise, measured. It prints no numbers of a run.

use nurbs_core::{Differentiate, Ends, Evaluate, ShapeError, ShapeFactors, TrigSegment, TrigSplineBuf};

use crate::error::PaperError;
use crate::figures::PaperFigures;
use crate::judged::largest;
use crate::row::{Printed, Row};

/// Rounding of f64 for coordinates of some 10 mm, in mm.
const ROUNDING_MM: f64 = 1e-13;
const RADIUS_MM: f64 = 10.0;

pub(crate) fn figures() -> Result<PaperFigures, PaperError> {
    let rows = rows().map_err(PaperError::of("a trigonometric spline"))?;
    Ok(PaperFigures { rows, pictures: Vec::new() })
}

fn row(place: &'static str, quantity: &str, unit: &'static str, printed: Printed, measured: f64) -> Row {
    Row {
        paper: 'B',
        place,
        quantity: quantity.to_string(),
        unit,
        printed,
        measured,
        setting: "",
        reason: "",
    }
}

/// 0 … 1 in hundredths.
fn parameters() -> impl Iterator<Item = f64> {
    (0..=100_u32).map(|k| f64::from(k) / 100.0)
}

fn rows() -> Result<Vec<Row>, ShapeError> {
    let exact = Printed::AtMost(ROUNDING_MM);
    let mut rows = vec![
        Row {
            setting: "40 segments: k from -1.5 to 0.5, λ from -1 to 2",
            ..row("(3)", "end points and tangents, off by", "mm", exact, ends_off()?)
        },
        Row {
            setting: "ten points, k = -1, λ = 0.5",
            ..row("(5)", "jump of P' at joints", "mm", exact, joints_off()?)
        },
        Row {
            setting: "ten points",
            ..row("figure 5", "segments of ten points", "", Printed::Number(7.0), segments()?)
        },
        Row {
            setting: "(3, -2) to (7, 5), λ = 0, k = -1; the Chinese text prints k = 1, with which (8) does not follow",
            ..row("(8)", "distance from (B - C) C³ + C", "mm", exact, line_off()?)
        },
    ];
    for lambda in [1.0, 0.0, 2.0] {
        rows.push(Row {
            setting: "R 10, k = -1; the paper asks for λ = 1, every λ gives the same arc",
            ..row(
                "(9)",
                &format!("radial error of the quarter circle, λ = {lambda}"),
                "mm",
                exact,
                circle_off(lambda)?,
            )
        });
    }
    rows.push(Row {
        setting: "90° corner cut with tangents of π/2 r, λ from 0 to 2",
        reason: "with these tangents λ's term is 0; the paper's claim needs others",
        ..row(
            "figure 9",
            "λ changes the inner corner's size: by",
            "mm",
            Printed::Words("size changes"),
            corner_change()?,
        )
    });
    rows.push(Row {
        setting: "90° corner, loop of d = 1 mm, the λ of 0, 0.5, 1, 1.5, 2 with the smallest loop",
        ..row(
            "figure 8",
            "λ changes the loop's size: the smallest has λ =",
            "",
            Printed::Words("size changes"),
            smallest_loop()?,
        )
    });
    Ok(rows)
}

fn ends_off() -> Result<f64, ShapeError> {
    let q = [[0.0, 1.0], [4.0, 3.0], [5.0, -2.0], [9.0, 0.5]];
    let chord = |i: usize, axis: usize| q[i + 1][axis] - q[i][axis];
    let mut off = Vec::new();
    for k in [-1.5, -1.0, -0.5, 0.0, 0.5] {
        for lambda in [-1.0, -0.5, 0.0, 0.5, 0.75, 1.0, 1.5, 2.0] {
            let segment = TrigSegment::try_new(q, ShapeFactors { lambda, k })?;
            for (u, end) in [(0.0, 0), (1.0, 1)] {
                let found = segment.derivatives(u);
                let tangent = [0, 1].map(|axis| chord(end, axis) - k * chord(end + 1, axis));
                off.extend(found.point.iter().zip(&q[end]).map(|(ours, given)| ours - given));
                off.extend(found.first.iter().zip(&tangent).map(|(ours, given)| ours - given));
            }
        }
    }
    Ok(largest(off))
}

/// Ten points, as the paper's figure 5 has them.
fn ten_points() -> Vec<[f64; 2]> {
    (0..10_u32).map(f64::from).map(|i| [3.0 * i, 4.0 * (1.3 * i).sin()]).collect()
}

fn spline(lambda: f64) -> Result<TrigSplineBuf<f64, 2>, ShapeError> {
    TrigSplineBuf::through(&ten_points(), ShapeFactors { lambda, k: -1.0 }, Ends::AsGiven)
}

fn joints_off() -> Result<f64, ShapeError> {
    let spline = spline(0.5)?;
    let spline = spline.as_spline();
    let jumps = spline.segments().windows(2).flat_map(|pair| {
        let [before, after] = [pair[0].derivatives(1.0).first, pair[1].derivatives(0.0).first];
        [before[0] - after[0], before[1] - after[1]]
    });
    Ok(largest(jumps))
}

fn segments() -> Result<f64, ShapeError> {
    Ok(spline(0.5)?.as_spline().segments().len() as f64)
}

fn line_off() -> Result<f64, ShapeError> {
    let (b, c) = ([3.0, -2.0], [7.0, 5.0]);
    let line = TrigSegment::line(b, c)?;
    let off = parameters().flat_map(|u| {
        let share = (std::f64::consts::FRAC_PI_2 * u).cos().powi(3);
        let point = line.point(u);
        [0, 1].map(|axis| point[axis] - ((b[axis] - c[axis]) * share + c[axis]))
    });
    Ok(largest(off))
}

fn circle_off(lambda: f64) -> Result<f64, ShapeError> {
    let (a, b) = (RADIUS_MM, RADIUS_MM * std::f64::consts::FRAC_PI_2);
    let circle =
        TrigSegment::try_new([[a, 0.0], [0.0, a], [a, b], [-b, a]], ShapeFactors { lambda, k: -1.0 })?;
    Ok(largest(parameters().map(|u| {
        let [x, y] = circle.point(u);
        x.hypot(y) - RADIUS_MM
    })))
}

/// How far the points of a 90° corner with tangents of π/2 r move with λ.
fn corner_change() -> Result<f64, ShapeError> {
    let m = std::f64::consts::FRAC_PI_2;
    let corner = |lambda| TrigSegment::between([[0.0, 0.0], [1.0, 1.0]], [[m, 0.0], [0.0, m]], lambda);
    let (least, most) = (corner(0.0)?, corner(2.0)?);
    Ok(largest(parameters().flat_map(|u| {
        let (a, b) = (least.point(u), most.point(u));
        [a[0] - b[0], a[1] - b[1]]
    })))
}

/// The λ of the loop that leaves a corner by the least distance.
fn smallest_loop() -> Result<f64, ShapeError> {
    let mut smallest = (f64::INFINITY, 0.0);
    for lambda in [0.0, 0.5, 1.0, 1.5, 2.0] {
        let corner = TrigSegment::between([[0.0; 2]; 2], [[1.0, 0.0], [0.0, -1.0]], lambda)?;
        let size = largest(parameters().map(|u| corner.point(u)[0].hypot(corner.point(u)[1])));
        if size < smallest.0 {
            smallest = (size, lambda);
        }
    }
    Ok(smallest.1)
}

#[cfg(test)]
mod tests {
    use super::*;
    use nurbs_core::curvature;

    /// At the joint of a loop with λ = 1 and a line there is no curvature: the sines' second derivatives are 0 there.
    #[test]
    fn a_loop_of_lambda_1_joins_without_curvature() {
        let corner = TrigSegment::between([[0.0; 2]; 2], [[1.0, 0.0], [0.0, -1.0]], 1.0).unwrap();
        for u in [0.0, 1.0] {
            assert!(curvature(&corner.derivatives(u)) < 1e-12);
        }
        assert_eq!(smallest_loop().unwrap(), 1.0);
    }
}
