//! By how much a chord may differ from the wanted one.

use nurbs_core::Pieces;
use real::{Backend, FormatName, Real};

/// The largest difference between the chord of a step and the wanted one that the roundings of a format explain.
///
/// A chord of L units (of 2⁻λ mm) is the root of a residual of order one. Each term of the residual is rounded to the
/// format's resolution r. So the chord has a relative error of a few r. L itself is a multiple of r in fixed point, and
/// has a relative error of r in a float. Together `|chord - L| ≤ (ABSOLUTE + relative(p) L) r` in fixed point,
/// `relative(p) L r` in a float. The terms for degree p take p(p + 1)/2 sums, each rounded in units up to four times
/// those of the chord. With weights they take as many sums again, whose roundings are multiplied by offsets of the
/// order of the chord's units. With weights all of that is divided by W, which on a piece falls to no less than two
/// thirds.
pub struct ChordBound {
    resolution: f64,
    is_fixed: bool,
    /// 2⁻λ mm.
    chord: f64,
    relative: f64,
    falling: f64,
}

/// The part of the bound in fixed point that does not grow with the chord, in units of the resolution.
const ABSOLUTE: f64 = 8.0;
/// One over the least weight W on a piece.
const FALLING_WEIGHT: f64 = 1.5;

/// The part of the bound that grows with the chord, in units of the resolution, for degree p.
fn relative(degree: usize, is_rational: bool) -> f64 {
    let sums = degree * (degree + 1) / 2 * (1 + usize::from(is_rational));
    (40 + 4 * sums).max(64) as f64
}

impl ChordBound {
    /// The bound for steps on these pieces.
    #[must_use]
    pub fn of<R: Backend, const D: usize>(pieces: &Pieces<'_, R, D>) -> Self {
        Self {
            resolution: R::resolution().to_f64(),
            is_fixed: matches!(R::name(), FormatName::Fixed { .. }),
            chord: 1.0_f64.ldexp(-pieces.chord_exponent),
            relative: relative(pieces.degree, pieces.is_rational()),
            falling: if pieces.is_rational() { FALLING_WEIGHT } else { 1.0 },
        }
    }

    /// A length in chord units, in mm.
    #[must_use]
    pub fn in_mm<R: Backend>(&self, length: R) -> f64 {
        length.to_f64() * self.chord
    }

    /// The format's last place in a chord of this length, in mm.
    #[must_use]
    pub fn resolution_mm(&self, wanted: f64) -> f64 {
        self.resolution * if self.is_fixed { self.chord } else { wanted }
    }

    /// The most by which a chord over so many joints may differ from the wanted one, in mm, by the format's roundings alone.
    #[must_use]
    pub fn chord_mm(&self, wanted: f64, joints: usize) -> f64 {
        let absolute = if self.is_fixed { ABSOLUTE * self.chord } else { 0.0 };
        (absolute + self.relative * wanted) * self.falling * self.resolution * (1.0 + joints as f64)
    }

    /// The part of a landing step that a period may lose.
    #[must_use]
    pub fn lost_in_a_period<R: Backend>(&self, landing_step: R) -> f64 {
        let landing = landing_step.to_f64().max(self.resolution);
        if self.is_fixed { ABSOLUTE * self.resolution / landing } else { 0.0 }
    }
}
