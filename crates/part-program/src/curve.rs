//! A NURBS curve as plain numbers, and the rules that such numbers must obey.

use domains::curve::{COORDINATE, KNOT, KNOT_RANGE, LEAST_KNOT_SPAN, MOST_JUMP, WEIGHT};
use nurbs_core::{CurveError, NurbsBuf};
pub use nurbs_core::{End, MAX_DEGREE};

use crate::curve_fault::CurveFault;
use crate::vector::{difference, length};

/// The largest coordinate, in mm.
pub const MAX_COORDINATE_MM: f64 = COORDINATE.most();
/// The largest weight; the smallest is its inverse.
pub const MAX_WEIGHT: f64 = WEIGHT.most();
/// The largest knot, by magnitude.
pub const MAX_KNOT: f64 = KNOT.most();

/// A clamped NURBS curve in f64. One that a reader of this crate returns obeys every rule of [`CurveFault`].
#[derive(Clone, Debug, PartialEq)]
pub struct Curve(Form);

#[derive(Clone, Debug, PartialEq)]
enum Form {
    /// A straight move as the reader of G1 makes it, of which a program has millions: it takes no heap.
    Line { ends: [[f64; 3]; 2], is_planar: bool },
    /// Any other curve.
    Any(Box<Nurbs>),
}

/// Weights and knots of a straight move.
const LINE_WEIGHTS: [f64; 2] = [1.0; 2];
const LINE_KNOTS: [f64; 4] = [0.0, 0.0, 1.0, 1.0];

/// The numbers of a NURBS curve in lists, of which a [`Curve`] is made.
#[derive(Clone, Debug, PartialEq)]
pub struct Nurbs {
    /// Degree p; the order is p + 1.
    pub degree: usize,
    /// Control points P_0 … P_n, in mm. A planar curve has z = 0.
    pub control_points_mm: Vec<[f64; 3]>,
    /// 2 for a curve in the plane z = 0, otherwise 3. It is also 3 if the file gives points of that plane a third
    /// coordinate.
    pub dimension: usize,
    /// Weights w_0 … w_n, positive.
    pub weights: Vec<f64>,
    /// Knots u_0 … u_{n+p+1}, non-decreasing, clamped.
    pub knots: Vec<f64>,
}

impl From<Nurbs> for Curve {
    fn from(nurbs: Nurbs) -> Self {
        let is_straight_move =
            nurbs.degree == 1 && nurbs.weights == LINE_WEIGHTS && nurbs.knots == LINE_KNOTS;
        Self(match (nurbs.control_points_mm.as_slice(), nurbs.dimension) {
            (&[from, to], 2 | 3) if is_straight_move => {
                Form::Line { ends: [from, to], is_planar: nurbs.dimension == 2 }
            }
            _ => Form::Any(Box::new(nurbs)),
        })
    }
}

impl Curve {
    /// A straight line, of degree 1.
    pub(crate) fn line(from: [f64; 3], to: [f64; 3]) -> Self {
        let ends = [from, to];
        Self(Form::Line { ends, is_planar: Nurbs::dimension_of(&ends) == 2 })
    }

    /// The memory that it takes, in bytes.
    pub(crate) fn bytes(&self) -> usize {
        let numbers = |nurbs: &Nurbs| {
            size_of::<[f64; 3]>() * nurbs.control_points_mm.len()
                + size_of::<f64>() * (nurbs.weights.len() + nurbs.knots.len())
        };
        size_of::<Self>()
            + match &self.0 {
                Form::Line { .. } => 0,
                Form::Any(nurbs) => size_of::<Nurbs>() + numbers(nurbs),
            }
    }

    /// Degree p; the order is p + 1.
    #[must_use]
    pub fn degree(&self) -> usize {
        match &self.0 {
            Form::Line { .. } => 1,
            Form::Any(nurbs) => nurbs.degree,
        }
    }

    /// Control points P_0 … P_n, in mm. A planar curve has z = 0.
    #[must_use]
    pub fn control_points_mm(&self) -> &[[f64; 3]] {
        match &self.0 {
            Form::Line { ends, .. } => ends,
            Form::Any(nurbs) => &nurbs.control_points_mm,
        }
    }

    /// The control points, to be moved. The [`dimension`](Self::dimension) stays.
    pub fn control_points_mm_mut(&mut self) -> &mut [[f64; 3]] {
        match &mut self.0 {
            Form::Line { ends, .. } => ends,
            Form::Any(nurbs) => &mut nurbs.control_points_mm,
        }
    }

    /// 2 for a curve in the plane z = 0, otherwise 3. It is also 3 if the file gives points of that plane a third
    /// coordinate.
    #[must_use]
    pub fn dimension(&self) -> usize {
        match &self.0 {
            Form::Line { is_planar, .. } => 3 - usize::from(*is_planar),
            Form::Any(nurbs) => nurbs.dimension,
        }
    }

    /// Weights w_0 … w_n, positive.
    #[must_use]
    pub fn weights(&self) -> &[f64] {
        match &self.0 {
            Form::Line { .. } => &LINE_WEIGHTS,
            Form::Any(nurbs) => &nurbs.weights,
        }
    }

    /// Knots u_0 … u_{n+p+1}, non-decreasing, clamped.
    #[must_use]
    pub fn knots(&self) -> &[f64] {
        match &self.0 {
            Form::Line { .. } => &LINE_KNOTS,
            Form::Any(nurbs) => &nurbs.knots,
        }
    }

    /// The numbers in lists of their own.
    #[must_use]
    pub fn to_nurbs(&self) -> Nurbs {
        Nurbs {
            degree: self.degree(),
            control_points_mm: self.control_points_mm().to_vec(),
            dimension: self.dimension(),
            weights: self.weights().to_vec(),
            knots: self.knots().to_vec(),
        }
    }

    /// The curve for evaluation.
    ///
    /// # Errors
    /// Those of [`NurbsBuf::try_new`].
    pub fn for_evaluation(&self) -> Result<NurbsBuf<f64, 3>, CurveError> {
        let Nurbs { degree, control_points_mm, weights, knots, .. } = self.to_nurbs();
        NurbsBuf::try_new(degree, control_points_mm, weights, knots)
    }

    /// Every rule that the curve breaks.
    #[must_use]
    pub fn faults(&self) -> Vec<CurveFault> {
        let ends = match &self.0 {
            Form::Any(nurbs) => return nurbs.faults(),
            Form::Line { ends, .. } => ends,
        };
        let mut faults = coordinate_faults(ends);
        if faults.is_empty() && ends[0] == ends[1] {
            faults.push(CurveFault::NoLength);
        }
        faults
    }

    /// Whether it is a straight move as the reader of G1 makes it: degree 1, two points, weights 1, and the knots 0, 0, 1, 1.
    pub(crate) fn is_straight_move(&self) -> bool {
        matches!(self.0, Form::Line { .. })
    }

    /// Moves each control point, and sets the dimension that the points then need.
    pub(crate) fn move_points(&mut self, to: impl FnMut(&mut [f64; 3])) {
        self.control_points_mm_mut().iter_mut().for_each(to);
        let needed = Nurbs::dimension_of(self.control_points_mm());
        match &mut self.0 {
            Form::Line { is_planar, .. } => *is_planar = needed == 2,
            Form::Any(nurbs) => nurbs.dimension = needed,
        }
    }

    /// The length of the control polygon, in mm; no curve is longer.
    #[must_use]
    pub fn polygon_length_mm(&self) -> f64 {
        let legs = self.control_points_mm().windows(2);
        legs.map(|leg| length(difference(&leg[1], &leg[0]))).sum()
    }

    /// Whether degree, points, weights and knots are equal. The dimension may differ: a point of the plane z = 0 may be
    /// given with or without a third coordinate.
    #[must_use]
    pub fn has_same_numbers(&self, other: &Self) -> bool {
        self.degree() == other.degree()
            && self.control_points_mm() == other.control_points_mm()
            && self.weights() == other.weights()
            && self.knots() == other.knots()
    }

    /// Whether a point lies beside the plane z = 0.
    pub(crate) fn leaves_z_0(&self) -> bool {
        Nurbs::dimension_of(self.control_points_mm()) == 3
    }
}

impl Nurbs {
    /// The numbers of a curve in the plane or in space; what it lacks of three coordinates is 0.
    #[must_use]
    pub fn of<const D: usize>(curve: &NurbsBuf<f64, D>, dimension: usize) -> Self {
        let point = |point: &[f64; D]| std::array::from_fn(|axis| point.get(axis).copied().unwrap_or(0.0));
        Self {
            degree: curve.degree(),
            control_points_mm: curve.control_points().iter().map(point).collect(),
            dimension,
            weights: curve.weights().to_vec(),
            knots: curve.knots().to_vec(),
        }
    }

    /// Every rule that the curve breaks. Rules that only make sense once the counts fit are tried only then.
    #[must_use]
    pub fn faults(&self) -> Vec<CurveFault> {
        let mut faults = self.value_faults();
        let counts = self.count_faults();
        let sound = counts.is_empty() && faults.is_empty();
        faults.splice(0..0, counts);
        if sound {
            faults.extend(self.multiplicity_faults());
            if faults.is_empty() {
                faults.extend(self.jump_fault());
            }
            if self.control_points_mm.windows(2).all(|pair| pair[0] == pair[1]) {
                faults.push(CurveFault::NoLength);
            }
        }
        faults
    }

    fn count_faults(&self) -> Vec<CurveFault> {
        let (degree, points) = (self.degree, self.control_points_mm.len());
        let mut faults = Vec::new();
        if !(1..=MAX_DEGREE).contains(&degree) {
            return vec![CurveFault::DegreeOutOfRange { degree }];
        }
        if points <= degree {
            faults.push(CurveFault::TooFewControlPoints { least: degree + 1, found: points });
        }
        if self.weights.len() != points {
            faults.push(CurveFault::WrongWeightCount { expected: points, found: self.weights.len() });
        }
        let knots = points + degree + 1;
        if self.knots.len() != knots {
            faults.push(CurveFault::WrongKnotCount { expected: knots, found: self.knots.len() });
        }
        faults
    }

    fn value_faults(&self) -> Vec<CurveFault> {
        let mut faults = coordinate_faults(&self.control_points_mm);
        for (index, &value) in self.weights.iter().enumerate() {
            if !WEIGHT.holds(value) {
                faults.push(CurveFault::WeightOutOfRange { index, value });
            }
        }
        for (index, &value) in self.knots.iter().enumerate() {
            if !KNOT.holds(value) {
                faults.push(CurveFault::KnotOutOfRange { index, value });
            }
        }
        for (index, pair) in self.knots.windows(2).enumerate() {
            if pair[1] < pair[0] {
                faults.push(CurveFault::KnotsDecrease { index: index + 1, knot: pair[1], previous: pair[0] });
            }
        }
        faults
    }

    /// The rules of a clamped knot vector whose counts fit and whose knots do not decrease.
    fn multiplicity_faults(&self) -> Vec<CurveFault> {
        let order = self.degree + 1;
        let last = self.knots.len() - 1;
        if self.knots[0] == self.knots[last] {
            return vec![CurveFault::EmptyDomain { knot: self.knots[0] }];
        }
        let range = self.knots[last] - self.knots[0];
        if !KNOT_RANGE.holds(range) {
            return vec![CurveFault::RangeTooSmall { range }];
        }
        let mut faults = Vec::new();
        let least = LEAST_KNOT_SPAN * range;
        for (index, pair) in self.knots.windows(2).enumerate() {
            let (previous, knot) = (pair[0], pair[1]);
            if knot > previous && knot - previous < least {
                faults.push(CurveFault::KnotsTooClose { index: index + 1, knot, previous, least });
            }
        }
        let mut index = 0;
        for equal in self.knots.chunk_by(|a, b| a == b) {
            let multiplicity = equal.len();
            let end = match index {
                0 => Some(End::First),
                _ if index + multiplicity == last + 1 => Some(End::Last),
                _ => None,
            };
            match end {
                Some(end) if multiplicity != order => {
                    let odd = multiplicity.min(order);
                    let index = if end == End::First { odd } else { last - odd };
                    faults.push(CurveFault::NotClamped { end, expected: order, multiplicity, index });
                }
                None if multiplicity > self.degree => faults.push(CurveFault::KnotRepeatsTooOften {
                    index: index + self.degree,
                    multiplicity,
                    degree: self.degree,
                }),
                _ => {}
            }
            index += multiplicity;
        }
        faults
    }

    /// The greatest jump between doubles, if it is more than [`MOST_JUMP`] of the control polygon.
    ///
    /// The curve C without its weights moves by at most |Q_j| Δu over Δu, where Q_j = p (P_{j+1} − P_j) /
    /// (u_{j+p+1} − u_{j+1}) are the control points of C' (The NURBS Book, eq. 3.8), and Δu is here the distance of doubles
    /// at the knots.
    fn jump_fault(&self) -> Option<CurveFault> {
        let degree = self.degree;
        let sides = || self.control_points_mm.windows(2).map(|pair| length(difference(&pair[1], &pair[0])));
        let most_mm = MOST_JUMP * sides().sum::<f64>();
        let spans = self.knots[1..].windows(degree + 1).map(|knots| (knots[0], knots[degree]));
        let jump_mm = |side: f64, (first, last): (f64, f64)| {
            let apart = distance_of_doubles(first).max(distance_of_doubles(last));
            side * (apart * degree as f64 / (last - first)).min(1.0)
        };
        let jumps = sides().zip(spans).map(|(side, span)| (jump_mm(side, span), span)).enumerate();
        let (j, (jump_mm, (first, last))) = jumps.max_by(|(_, a), (_, b)| a.0.total_cmp(&b.0))?;
        let fault = CurveFault::JumpsBetweenDoubles { index: j + 1 + degree, first, last, jump_mm, most_mm };
        (jump_mm > most_mm).then_some(fault)
    }

    /// The number of coordinates that the points need: 2 if every z is zero.
    pub(crate) fn dimension_of(points: &[[f64; 3]]) -> usize {
        if points.iter().all(|point| point[2] == 0.0) { 2 } else { 3 }
    }
}

/// How much greater the next double is.
fn distance_of_doubles(knot: f64) -> f64 {
    knot.abs().next_up() - knot.abs()
}

/// The points that are beyond the range of a machine.
pub(crate) fn coordinate_faults(points: &[[f64; 3]]) -> Vec<CurveFault> {
    let wrong = |point: &[f64; 3]| point.iter().copied().find(|x| !COORDINATE.holds(*x));
    let fault = |(index, point)| Some(CurveFault::CoordinateOutOfRange { index, value: wrong(point)? });
    points.iter().enumerate().filter_map(fault).collect()
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::curve_fault::Element;

    fn cubic() -> Nurbs {
        Nurbs {
            degree: 3,
            control_points_mm: (0..5_u8).map(|i| [f64::from(i), f64::from(i * i), 0.0]).collect(),
            dimension: 2,
            weights: vec![1.0; 5],
            knots: vec![0.0, 0.0, 0.0, 0.0, 0.5, 1.0, 1.0, 1.0, 1.0],
        }
    }

    fn faults(change: impl FnOnce(&mut Nurbs)) -> Vec<String> {
        let mut curve = cubic();
        change(&mut curve);
        curve.faults().iter().map(ToString::to_string).collect()
    }

    #[test]
    fn a_valid_curve_has_no_faults() {
        assert_eq!(cubic().faults(), []);
        let with = |knot| Nurbs { knots: vec![0.0, 0.0, 0.0, 0.0, knot, 1.0, 1.0, 1.0, 1.0], ..cubic() };
        assert_eq!(with(1e-18).faults(), []);
        assert_eq!(
            domains::curve::DEGREE.value,
            domains::Value::Whole(1, u32::try_from(MAX_DEGREE).unwrap(), "")
        );
    }

    #[test]
    fn every_rule_is_checked() {
        type Change = fn(&mut Nurbs);
        let cases: [(Change, &str); 17] = [
            (|c| c.degree = 0, "degree 0 is not supported"),
            (|c| c.degree = 10, "degree 10 is not supported"),
            (|c| c.control_points_mm.truncate(3), "too few control points: 3"),
            (|c| c.weights.truncate(2), "wrong number of weights: 2"),
            (|c| c.knots.push(1.0), "wrong number of knots: 10"),
            (|c| c.control_points_mm[2][1] = f64::NAN, "control point 2 has the coordinate NaN"),
            (|c| c.control_points_mm[2][1] = 2e7, "control point 2 has the coordinate 20000000"),
            (|c| c.weights[4] = 0.0, "weight 4 is 0"),
            (|c| c.weights[4] = f64::NAN, "weight 4 is NaN"),
            (|c| c.knots[4] = f64::INFINITY, "knot 4 is inf"),
            (|c| c.knots[4] = -0.5, "knots decrease: knot 4 is -0.5, after 0"),
            (|c| c.knots.fill(3.0), "all knots are 3: the parameter has no range"),
            (|c| c.knots[4] = 5e-324, "knots too close: knot 4 is 5e-324, after 0"),
            (|c| c.knots[4] = 1e-19, "knots too close: knot 4 is 1e-19, after 0"),
            (|c| c.knots.iter_mut().for_each(|knot| *knot *= 1e-13), "the knots have a range of 1e-13"),
            (|c| c.knots[3] = 0.1, "the curve is not clamped: its first knot is there 3 times"),
            (|c| c.knots[4] = 1.0, "the curve is not clamped: its last knot is there 5 times"),
        ];
        for (change, message) in cases {
            let found = faults(change);
            assert!(found.iter().any(|fault| fault == message), "{message}: {found:?}");
        }
        assert_eq!(faults(|c| c.control_points_mm.fill([1.0; 3])).len(), 1);
    }

    /// Over such a span a quadrature has no place but its ends to look at, and loses length.
    #[test]
    fn knots_a_rounding_apart_are_refused_where_the_curve_between_them_is_long() {
        let close = |count: usize| -> Vec<f64> {
            std::iter::successors(Some(0.5_f64), |knot| Some(knot.next_up())).take(count).collect()
        };
        let inner = |degree: usize, inner: &[f64]| {
            let knots = [vec![0.0; degree + 1], inner.to_vec(), vec![1.0; degree + 1]].concat();
            let points = (0..knots.len() - degree - 1).map(|i| [20.0 * i as f64, 30.0 * (i % 2) as f64, 0.0]);
            let points: Vec<_> = points.collect();
            Nurbs { degree, weights: vec![1.0; points.len()], control_points_mm: points, dimension: 2, knots }
        };
        let jumps = |curve: &Nurbs| matches!(curve.faults()[..], [CurveFault::JumpsBetweenDoubles { .. }]);
        for degree in 1..=5 {
            assert!(jumps(&inner(degree, &close(degree + 1))), "degree {degree}: almost one knot too many");
            assert_eq!(inner(degree, &close(degree)).faults(), [], "degree {degree}: almost a corner");
            assert!(jumps(&inner(degree, &[1.0_f64.next_down()])), "degree {degree}: at the end");
            assert_eq!(inner(degree, &[1e-17]).faults(), [], "degree {degree}: doubles are dense near 0");
            assert_eq!(inner(degree, &[0.5, 0.500_001, 0.500_002]).faults(), [], "degree {degree}");
        }
    }

    #[test]
    fn an_inner_knot_breaks_the_curve_when_it_repeats_too_often() {
        let mut curve = cubic();
        curve.degree = 1;
        curve.knots = vec![0.0, 0.0, 0.5, 0.5, 0.6, 1.0, 1.0];
        let fault = CurveFault::KnotRepeatsTooOften { index: 3, multiplicity: 2, degree: 1 };
        assert_eq!(curve.faults(), [fault]);
        assert_eq!(fault.element(), Element::Knot(3));
    }
}
