//! Curves to part programs. Numbers are written as the shortest decimals that read back as the same f64, and with a
//! decimal point, since a control may take a number without one as micrometres.

use std::fmt::{self, Write};

use nurbs_core::{CurveError, NurbsBuf};

use crate::curve::Curve;
use crate::linuxcnc::LEAST_ORDER;
use crate::spline_blocks::uniform_knots;

/// Why curves cannot be written.
#[derive(Clone, Copy, Debug, PartialEq)]
#[non_exhaustive]
pub enum WriteError {
    /// G5.2 is planar, and the curve leaves its plane.
    NotPlanar {
        /// Index of the curve.
        curve: usize,
    },
    /// The curve breaks a rule.
    Invalid {
        /// Index of the curve.
        curve: usize,
        /// The rule.
        error: CurveError,
    },
}

impl fmt::Display for WriteError {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        match self {
            Self::NotPlanar { curve } => write!(f, "curve {curve} is not planar: G5.2 takes X and Y only"),
            Self::Invalid { curve, error } => write!(f, "curve {curve}: {error}"),
        }
    }
}

impl std::error::Error for WriteError {}

/// Writes points, such as the setpoints of an interpolator, as fine G1 moves in millimetres.
#[must_use]
pub fn write_g1(points_mm: &[[f64; 3]], feedrate_mm_per_s: Option<f64>) -> String {
    let mut program = Program::new(points_mm.iter().all(|point| point[2] == 0.0), feedrate_mm_per_s);
    if let Some((first, rest)) = points_mm.split_first() {
        program.rapid_to(*first);
        program.line_through(rest);
    }
    program.end()
}

/// Writes curves as FANUC's G06.2. Reading it back gives every control point, weight and knot bit by bit.
///
/// Between curves that do not join stands a G0, which is read back as a rapid move.
#[must_use]
pub fn write_g06_2(curves: &[Curve], feedrate_mm_per_s: Option<f64>) -> String {
    let mut program = Program::new(is_planar(curves), feedrate_mm_per_s);
    program.line("G05 P10000");
    for curve in curves {
        program.rapid_to(curve.control_points_mm.first().copied().unwrap_or_default());
        for (i, ((point, weight), knot)) in
            curve.control_points_mm.iter().zip(&curve.weights).zip(&curve.knots).enumerate()
        {
            if i == 0 {
                program.word("G06.2 P", curve.degree + 1);
            }
            program.number("K", *knot);
            program.point(*point);
            program.number("R", *weight);
            program.end_block();
        }
        for knot in curve.knots.iter().skip(curve.control_points_mm.len()) {
            program.number("K", *knot);
            program.end_block();
        }
        program.position = curve.control_points_mm.last().copied();
    }
    program.line("G05 P0");
    program.end()
}

/// Writes planar curves as LinuxCNC's G5.2, which has no word for knots.
///
/// A curve of knots 0 …, 1, 2, … is read back bit by bit; one of other uniform knots is the same curve with those
/// knots. Any other is cut at its knots into Bézier curves, which are the same points to rounding. Degree 1, which
/// G5.2 does not have, becomes G1 moves.
///
/// # Errors
/// [`WriteError::NotPlanar`] when z changes along a curve.
pub fn write_g5_2(curves: &[Curve], feedrate_mm_per_s: Option<f64>) -> Result<String, WriteError> {
    let mut program = Program::new(is_planar(curves), feedrate_mm_per_s);
    for (index, curve) in curves.iter().enumerate() {
        let height = curve.control_points_mm.first().map_or(0.0, |point| point[2]);
        if curve.control_points_mm.iter().any(|point| point[2] != height) {
            return Err(WriteError::NotPlanar { curve: index });
        }
        program.rapid_to(curve.control_points_mm.first().copied().unwrap_or_default());
        if curve.degree + 1 < LEAST_ORDER {
            program.line_through(curve.control_points_mm.get(1..).unwrap_or_default());
        } else if has_uniform_knots(curve) {
            program.g5_2(curve.degree, &curve.control_points_mm, &curve.weights);
        } else {
            let error = |error| WriteError::Invalid { curve: index, error };
            let cut = cut_at_knots(curve).map_err(error)?;
            for start in (0..cut.control_points().len() - 1).step_by(curve.degree) {
                let piece = start..=start + curve.degree;
                let points: Vec<_> =
                    cut.control_points()[piece.clone()].iter().map(|p| [p[0], p[1], height]).collect();
                program.g5_2(curve.degree, &points, &cut.weights()[piece]);
            }
        }
        program.position = curve.control_points_mm.last().copied();
    }
    Ok(program.end())
}

fn is_planar(curves: &[Curve]) -> bool {
    curves.iter().all(|curve| Curve::dimension_of(&curve.control_points_mm) == 2)
}

/// Whether the knots are those of G5.2, up to origin and unit.
fn has_uniform_knots(curve: &Curve) -> bool {
    let uniform = || uniform_knots(curve.control_points_mm.len(), curve.degree);
    let first = curve.knots.first().copied().unwrap_or(0.0);
    let unit = curve.knots.iter().find(|knot| **knot > first).map_or(1.0, |knot| knot - first);
    uniform().zip(&curve.knots).all(|(u, knot)| first + u * unit == *knot)
}

/// The curve with every inner knot inserted until its multiplicity is the degree.
fn cut_at_knots(curve: &Curve) -> Result<NurbsBuf<f64, 2>, CurveError> {
    let points = curve.control_points_mm.iter().map(|point| [point[0], point[1]]).collect();
    let mut cut = NurbsBuf::try_new(curve.degree, points, curve.weights.clone(), curve.knots.clone())?;
    let inner = curve.knots.get(curve.degree + 1..curve.control_points_mm.len()).unwrap_or_default();
    for equal in inner.chunk_by(|a, b| a == b) {
        for _ in equal.len()..curve.degree {
            cut = cut.insert_knot(equal[0])?;
        }
    }
    Ok(cut)
}

/// A program that is being written.
struct Program {
    text: String,
    planar: bool,
    position: Option<[f64; 3]>,
    /// F, in mm/min, until it is written.
    feed: Option<f64>,
    block: String,
}

impl Program {
    fn new(planar: bool, feedrate_mm_per_s: Option<f64>) -> Self {
        let feed = feedrate_mm_per_s.map(|feedrate| feedrate * 60.0);
        Self { text: "G21 G90 G94\n".into(), planar, position: None, feed, block: String::new() }
    }

    fn line(&mut self, line: &str) {
        self.text.push_str(line);
        self.text.push('\n');
    }

    fn word(&mut self, address: &str, number: impl fmt::Display) {
        if !self.block.is_empty() {
            self.block.push(' ');
        }
        // Writing to a String does not fail.
        let _ = write!(self.block, "{address}{number}");
    }

    fn number(&mut self, address: &str, number: f64) {
        self.word(address, number);
        if number.fract() == 0.0 {
            self.block.push('.');
        }
    }

    fn point(&mut self, point: [f64; 3]) {
        let axes = if self.planar { 2 } else { 3 };
        for (address, value) in ["X", "Y", "Z"].into_iter().zip(point).take(axes) {
            self.number(address, value);
        }
    }

    fn end_block(&mut self) {
        if !self.block.starts_with("G0 ")
            && let Some(feed) = self.feed.take()
        {
            self.number("F", feed);
        }
        self.block.push('\n');
        self.text.push_str(&self.block);
        self.block.clear();
    }

    fn rapid_to(&mut self, point: [f64; 3]) {
        if self.position != Some(point) {
            self.block.push_str("G0");
            self.point(point);
            self.end_block();
            self.position = Some(point);
        }
    }

    fn line_through(&mut self, points: &[[f64; 3]]) {
        for point in points {
            self.block.push_str("G1");
            self.point(*point);
            self.end_block();
            self.position = Some(*point);
        }
    }

    fn g5_2(&mut self, degree: usize, points: &[[f64; 3]], weights: &[f64]) {
        for (i, (point, weight)) in points.iter().zip(weights).enumerate() {
            if i == 0 {
                self.block.push_str("G5.2");
            } else {
                self.number("X", point[0]);
                self.number("Y", point[1]);
            }
            self.number("P", *weight);
            if i == 0 {
                self.word("L", degree + 1);
            }
            self.end_block();
        }
        self.line("G5.3");
    }

    fn end(mut self) -> String {
        self.line("M30");
        self.text
    }
}
