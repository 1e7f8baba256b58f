//! The paths and their feeds.

use nurbs_core::NurbsBuf;
use real::Backend;
use secant_interp::LengthStage;

/// Curves, one after the other, and the distance of a period at full feed.
#[derive(Clone, Debug)]
pub struct Path {
    /// Its name, as part of an identifier.
    pub name: &'static str,
    /// The curves, in mm.
    pub curves: Vec<NurbsBuf<f64, 2>>,
    /// The feed, in mm per period.
    pub feed_mm: f64,
    /// Stages of the schedule: enough to come to the end.
    stages: usize,
}

impl Path {
    /// A feed that rises from rest, then swings between full and half in ramps of twenty periods: half of the
    /// periods are on ramps, half of them cruise. `unit` is the chord units in a mm.
    pub(crate) fn stages<R: Backend>(&self, unit: f64) -> Vec<LengthStage<R>> {
        let feed = |part: f64| R::from_f64(part * self.feed_mm * unit).unwrap_or_default();
        let turns = [(1.0, 1.0), (1.0, 0.5), (0.5, 0.5), (0.5, 1.0)];
        [(0.0, 1.0)]
            .into_iter()
            .chain(turns.into_iter().cycle())
            .take(self.stages)
            .filter_map(|(v, w)| LengthStage::new(20 << 32, feed(v), feed(w) - feed(v)))
            .collect()
    }
}

/// The paths that the firmware runs.
#[must_use]
pub fn paths() -> Vec<Path> {
    vec![paper_a(), ten_points()]
}

fn clamped(inner: &[f64]) -> Vec<f64> {
    [&[0.0; 4], inner, &[1.0; 4]].concat()
}

/// Seven points, 300 mm wide, non-rational, at 200 mm/s and 3 ms.
fn paper_a() -> Path {
    let points = [[150, 150], [0, 0], [0, 300], [150, 150], [300, 0], [300, 300], [150, 150]];
    let points = points.map(|p| p.map(f64::from)).to_vec();
    let curve = NurbsBuf::try_new_nonrational(3, points, clamped(&[0.25, 0.5, 0.75]));
    Path { name: "paper_a", curves: curve.into_iter().collect(), feed_mm: 0.6, stages: 140 }
}

/// The rational curve of ten points, 80 mm wide, at 50 mm/s and 3 ms.
fn ten_points() -> Path {
    let x = [0.0, 10.0, 20.0, 30.0, 40.0, 50.0, 60.0, 65.0, 70.0, 80.0];
    let y = [15.0, 34.1, 10.1, 16.1, 0.9, 38.0, 2.9, 8.9, 26.1, 5.9];
    let points = x.into_iter().zip(y).map(|(x, y)| [x, y]).collect();
    let weights = vec![1.0, 2.0, 1.5, 1.0, 1.0, 2.0, 1.0, 1.0, 2.0, 1.0];
    let knots = clamped(&[0.1836, 0.2781, 0.3837, 0.5474, 0.7104, 0.8049]);
    let curve = NurbsBuf::try_new(3, points, weights, knots);
    Path { name: "ten_points", curves: curve.into_iter().collect(), feed_mm: 0.15, stages: 80 }
}
