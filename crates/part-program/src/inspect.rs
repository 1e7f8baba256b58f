//! The contents of a part: counts, extent, lengths, bends, joints, and oddities.

use serde::Serialize;

use crate::bend::{Measure, measure};
use crate::bounds::bounding_box_mm;
use crate::joint::Joints;
use crate::moves::{MoveKind, Shape};
use crate::part::Part;
use crate::remark::{Remark, oddities};

/// The contents of a part.
#[derive(Clone, Debug, PartialEq, Serialize)]
pub struct Inspection<'p> {
    /// Rapid moves.
    pub rapids: usize,
    /// Straight moves at feed.
    pub lines: usize,
    /// Arcs and helices.
    pub arcs: usize,
    /// Splines.
    pub splines: usize,
    /// Control points of all curves.
    pub control_points: usize,
    /// The lowest and the highest degree.
    pub degrees: Option<(usize, usize)>,
    /// Length of the moves at feed, in mm.
    pub length_mm: f64,
    /// Length of the rapid moves, in mm.
    pub rapid_length_mm: f64,
    /// Least and greatest coordinates of the curves, in mm; see [`bounding_box_mm`].
    pub bounding_box_mm: Option<([f64; 3], [f64; 3])>,
    /// The least and the greatest feedrate of a move at feed, in mm/s.
    pub feedrates_mm_per_s: Option<(f64, f64)>,
    /// The sharpest bend of each curve at feed that bends, in the order of the path.
    pub bends: Vec<Bend>,
    /// Joints with a gap or a change of direction.
    pub joints: Joints<'p>,
    /// The oddities of its curves.
    pub remarks: Vec<Remark>,
    /// Lines of moves at feed that end where they start.
    pub standstills: Vec<usize>,
}

/// The sharpest bend of a curve.
#[derive(Clone, Copy, Debug, PartialEq, Serialize)]
pub struct Bend {
    /// Index of the curve.
    pub curve: usize,
    /// Line of its block.
    pub line: usize,
    /// Parameter of the place, in the curve's own knots.
    pub parameter: f64,
    /// The place, in mm.
    pub point_mm: [f64; 3],
    /// Radius of curvature there, in mm.
    pub radius_mm: f64,
}

impl Inspection<'_> {
    /// The sharpest bend of all.
    #[must_use]
    pub fn sharpest(&self) -> Option<&Bend> {
        self.bends.iter().min_by(|a, b| a.radius_mm.total_cmp(&b.radius_mm))
    }
}

/// Inspects a part.
#[must_use]
pub fn inspect(part: &Part) -> Inspection<'_> {
    let count = |wanted: Shape| {
        part.moves.iter().filter(|one| one.kind == MoveKind::Feed && one.shape == wanted).count()
    };
    let feeds = || part.moves.iter().filter_map(|one| one.feedrate_mm_per_s);
    let degrees = part.curves.iter().map(|curve| curve.degree());
    let mut seen = Inspection {
        rapids: part.moves.iter().filter(|one| one.kind == MoveKind::Rapid).count(),
        lines: count(Shape::Line),
        arcs: count(Shape::Arc),
        splines: count(Shape::Nurbs),
        control_points: part.curves.iter().map(|curve| curve.control_points_mm().len()).sum(),
        degrees: degrees.clone().min().zip(degrees.max()),
        length_mm: 0.0,
        rapid_length_mm: 0.0,
        bounding_box_mm: bounding_box_mm(&part.curves),
        feedrates_mm_per_s: feeds().reduce(f64::min).zip(feeds().reduce(f64::max)),
        bends: Vec::new(),
        joints: Joints(part),
        remarks: Vec::new(),
        standstills: part.standstills.clone(),
    };
    for (index, (curve, one)) in part.curves.iter().zip(&part.moves).enumerate() {
        let measure = measure(curve, one.shape);
        let remark = |oddity| Remark { curve: index, line: one.line, oddity };
        seen.remarks.extend(oddities(curve, one, &measure).into_iter().map(remark));
        match one.kind {
            MoveKind::Rapid => seen.rapid_length_mm += measure.length_mm,
            MoveKind::Feed => {
                seen.length_mm += measure.length_mm;
                seen.bends.extend(bend(index, one.line, &measure));
            }
        }
    }
    seen
}

fn bend(curve: usize, line: usize, measure: &Measure) -> Option<Bend> {
    let place = measure.sharpest?;
    let (parameter, point_mm, radius_mm) = (place.parameter, place.point_mm, place.radius_mm);
    Some(Bend { curve, line, parameter, point_mm, radius_mm })
}
