//! Inputs of the benches: paper A's curve, the 10-point rational one and a long space curve, with their feeds.

use feed_plan::{Junction, KinematicLimits};
use nurbs_core::{NurbsBuf, PieceLimits, PiecesBuf, compile, golden};
use real::{Backend, DoubleDouble, Real};
use secant_interp::LengthStage;

/// A curve and the feed that it is followed at, in mm per period.
#[derive(Clone, Debug)]
pub struct Path<const D: usize> {
    /// The name in the bench's own name.
    pub name: &'static str,
    /// The curve.
    pub curve: NurbsBuf<f64, D>,
    /// The feed.
    pub feed_mm: f64,
}

fn path<const D: usize>(
    name: &'static str,
    degree: usize,
    points: Vec<[f64; D]>,
    weights: Vec<f64>,
    knots: Vec<f64>,
    feed_mm: f64,
) -> Path<D> {
    let curve =
        NurbsBuf::try_new(degree, points, weights, knots).unwrap_or_else(|error| panic!("{name}: {error}"));
    Path { name, curve, feed_mm }
}

/// Paper A's curve at 200 mm/s and 3 ms: plane, not rational.
#[must_use]
pub fn paper_a() -> Path<2> {
    Path { name: "A", curve: golden::seed_000(), feed_mm: 0.6 }
}

/// Paper D's 10-point curve at 50 mm/s and 3 ms: plane, rational.
#[must_use]
pub fn ten_points() -> Path<2> {
    Path { name: "B", curve: golden::seed_003(), feed_mm: 0.15 }
}

/// A space curve of 1000 points on a wound helix, at 200 mm/s and 1 ms: a knot every few steps.
///
/// # Panics
/// Never: the numbers are a curve.
#[must_use]
pub fn thousand_points() -> Path<3> {
    helix("C", 1000)
}

/// A cubic of so many points on a wound helix, its knots mildly uneven.
///
/// # Panics
/// With fewer than four points.
#[must_use]
pub fn helix(name: &'static str, count: u32) -> Path<3> {
    helix_of_degree(name, 3, count, false)
}

/// A [`helix`] of any degree, with weights from 0.5 to 1.5 if rational.
///
/// # Panics
/// With no more points than the degree.
#[must_use]
pub fn helix_of_degree(name: &'static str, degree: u32, count: u32, rational: bool) -> Path<3> {
    let point = |i: u32| {
        let t = f64::from(i) * 0.05;
        [
            (60.0 + 10.0 * (3.1 * t).cos()) * t.cos(),
            (60.0 + 10.0 * (3.1 * t).cos()) * t.sin(),
            10.0 * (3.1 * t).sin() + t,
        ]
    };
    let weight = |i: u32| if rational { 1.0 + 0.5 * (0.9 * f64::from(i)).sin() } else { 1.0 };
    let spacing = |i: u32| f64::from(i) + 0.2 * (f64::from(i) * 0.7).sin();
    let (p, spans) = (degree as usize, count - degree);
    let mut knots = vec![0.0; p + 1];
    knots.extend((1..spans).map(spacing));
    knots.extend(vec![f64::from(spans); p + 1]);
    path(name, p, (0..count).map(point).collect(), (0..count).map(weight).collect(), knots, 0.2)
}

/// A winding cubic in the plane of so many spans, some 12 mm each, at 200 mm/s and 3 ms.
///
/// # Panics
/// Without a span.
#[must_use]
pub fn winding(spans: u32) -> Path<2> {
    let point = |i: u32| {
        let t = f64::from(i);
        [10.0 * t, 8.0 * (1.7 * t).sin() + 4.0 * (0.37 * t).cos()]
    };
    let knots = [0.0; 4].into_iter().chain((1..spans).map(f64::from)).chain([f64::from(spans); 4]).collect();
    let points: Vec<_> = (0..spans + 3).map(point).collect();
    let weights = vec![1.0; points.len()];
    path("winding", 3, points, weights, knots, 0.6)
}

impl Path<2> {
    /// This path in three dimensions, with z = 0.
    ///
    /// # Panics
    /// Never: what is a curve in the plane is one in space.
    #[must_use]
    pub fn in_space(&self) -> Path<3> {
        let points = self.curve.control_points().iter().map(|[x, y]| [*x, *y, 0.0]).collect();
        let (weights, knots) = (self.curve.weights().to_vec(), self.curve.knots().to_vec());
        path(self.name, self.curve.degree(), points, weights, knots, self.feed_mm)
    }
}

impl Path<3> {
    /// Its projection onto the plane z = 0.
    ///
    /// # Panics
    /// Never: what is a curve in space is one in the plane.
    #[must_use]
    pub fn in_plane(&self) -> Path<2> {
        let points = self.curve.control_points().iter().map(|[x, y, _]| [*x, *y]).collect();
        let (weights, knots) = (self.curve.weights().to_vec(), self.curve.knots().to_vec());
        path(self.name, self.curve.degree(), points, weights, knots, self.feed_mm)
    }
}

/// Paper A's interpolation period.
pub const PERIOD_S: f64 = 3e-3;

impl<const D: usize> Path<D> {
    /// Paper A's limits at this path's feed, per period.
    #[must_use]
    pub fn limits(&self) -> KinematicLimits<f64> {
        KinematicLimits {
            interpolation_period: 1.0,
            feedrate: self.feed_mm,
            acceleration: 5000.0 * PERIOD_S.powi(2),
            jerk: 4e5 * PERIOD_S.powi(3),
            chord_error: 5e-4,
            centripetal_acceleration: None,
            axes: Default::default(),
            junction: Junction::Stop,
        }
    }

    /// The curve compiled for `R`.
    ///
    /// # Panics
    /// If the format cannot hold it.
    #[must_use]
    pub fn pieces<R: Backend>(&self) -> PiecesBuf<R, D> {
        let limits = PieceLimits { length_mm: 32.0, step_mm: 1.05 * self.feed_mm };
        compile::<DoubleDouble, R, D>(&[self.curve.as_curve()], &limits)
            .unwrap_or_else(|error| panic!("{}: {error}", self.name))
    }

    /// A feed that swings between half and full every 256 periods, in the pieces' chord units.
    ///
    /// # Panics
    /// Never: the feed fits every format that the curve was compiled for.
    #[must_use]
    pub fn stages<R: Backend>(&self, chord_exponent: i32) -> Vec<LengthStage<R>> {
        let full = self.feed_mm.ldexp(chord_exponent);
        let feed = |part: f64| R::from_f64(full * part).unwrap_or_else(R::zero);
        let stage = |i: u32| {
            let (from, to) = if i.is_multiple_of(2) { (0.5, 1.0) } else { (1.0, 0.5) };
            LengthStage::new(128 << 32, feed(from), feed(to) - feed(from))
        };
        (0..4000).filter_map(stage).collect()
    }
}
