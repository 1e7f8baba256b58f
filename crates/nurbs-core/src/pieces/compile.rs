//! From a curve to compiled pieces, before real time: cutting, normalising, and proving that everything fits.
//!
//! All of it runs in a high precision `H`; each coefficient is rounded once, into the format.

use alloc::vec::Vec;

use real::{Backend, FormatName, Real};

use crate::pieces::local_piece::LocalPiece;
use crate::pieces::local_piece::MAX_STEP_EXPONENT;
use crate::pieces::pieces::{Joint, Piece, Pieces};
use crate::pieces::ranges::{self, Scales, SignalBound, exponent_below, power_of_two};
use crate::polynomials::bezier::{Bezier, computed};
use crate::{MAX_DEGREE, NurbsCurve};

/// How finely to cut.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct PieceLimits {
    /// Longest piece, in mm. A 32-bit format resolves a step best with 32 to 64 mm.
    pub length_mm: f64,
    /// Longest chord that a period may want, in mm.
    pub step_mm: f64,
}

/// A path cannot be compiled for a format.
#[derive(Clone, Copy, Debug, PartialEq)]
#[non_exhaustive]
pub enum CompileError {
    /// The limits are not positive and finite.
    LimitNotPositive {
        /// The limit.
        what: &'static str,
        /// Its value.
        value: f64,
    },
    /// A stop is not a number, or before the one before it.
    StopOutOfOrder {
        /// Its index among the stops.
        index: usize,
    },
    /// All of the path stands still; or C' all but vanishes on the piece that begins at `parameter` and is not short enough to be
    /// left out: no step per chord exists there.
    Cusp {
        /// Index of the curve in the path.
        curve: usize,
        /// Where the piece begins.
        parameter: f64,
    },
    /// The speed |C'|, or a coefficient, is no number where compiling is done, or its inverse is none of the format: on the
    /// piece that begins at `parameter` weights are too far apart or too small, or the curve is too small or too large.
    SpeedOutOfRange {
        /// Index of the curve in the path.
        curve: usize,
        /// Where the piece begins.
        parameter: f64,
    },
    /// A number of the real-time step does not fit the format.
    DoesNotFit {
        /// The signal, by the name that an audit gives it.
        signal: &'static str,
        /// Its proven bound.
        bound: f64,
        /// Integer bits, the sign included, that it needs.
        integer_bits: u32,
        /// The format.
        format: FormatName,
    },
    /// A coordinate lies beyond the ±2²⁴ mm of a piece's origin.
    OriginOutOfRange {
        /// Index of the curve in the path.
        curve: usize,
    },
}

impl CompileError {
    /// Index of the curve that is at fault, if it is one.
    #[must_use]
    pub fn curve(&self) -> Option<usize> {
        match *self {
            Self::Cusp { curve, .. }
            | Self::SpeedOutOfRange { curve, .. }
            | Self::OriginOutOfRange { curve } => Some(curve),
            Self::LimitNotPositive { .. } | Self::StopOutOfOrder { .. } | Self::DoesNotFit { .. } => None,
        }
    }
}

impl core::fmt::Display for CompileError {
    fn fmt(&self, f: &mut core::fmt::Formatter<'_>) -> core::fmt::Result {
        match self {
            Self::LimitNotPositive { what, value } => {
                write!(f, "{what} must be positive and finite, not {value}")
            }
            Self::StopOutOfOrder { index } => {
                write!(f, "stop {index} is not a number, or before the one before it")
            }
            Self::Cusp { curve, parameter } => {
                write!(f, "curve {curve} does not move near u = {parameter}: its derivative vanishes there")
            }
            Self::SpeedOutOfRange { curve, parameter } => {
                write!(
                    f,
                    "curve {curve} has no speed near u = {parameter}, or one whose inverse the format does not hold: weights \
                     too far apart, or a curve too small or too large"
                )
            }
            Self::DoesNotFit { signal, bound, integer_bits, format } => {
                write!(
                    f,
                    "the signal `{signal}` reaches {bound:.4} and needs {integer_bits} integer bits; {format} has fewer"
                )
            }
            Self::OriginOutOfRange { curve } => write!(f, "curve {curve} lies beyond ±2^24 mm"),
        }
    }
}

impl core::error::Error for CompileError {}

/// Compiled pieces with their storage, and what a tool needs to read their results.
#[derive(Clone, Debug)]
pub struct PiecesBuf<R, const D: usize> {
    pieces: Vec<Piece<R, D>>,
    numerators: Vec<[R; D]>,
    weights: Vec<R>,
    degree: usize,
    coordinate_exponent: i32,
    chord_exponent: i32,
    places: Vec<Place>,
    still: Vec<Place>,
    bounds: Vec<SignalBound>,
    step_mm: f64,
}

/// Where a piece lies on the path it was cut from.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Place {
    /// Index of the curve.
    pub curve: usize,
    /// The parameter at which the piece begins, as a sum of two floats.
    pub begin: (f64, f64),
    /// The parameter at which it ends.
    pub end: (f64, f64),
}

impl<R: Real, const D: usize> PiecesBuf<R, D> {
    /// The table that real time reads.
    #[must_use]
    pub fn as_pieces(&self) -> Pieces<'_, R, D> {
        Pieces {
            pieces: &self.pieces,
            numerators: &self.numerators,
            weights: &self.weights,
            degree: self.degree,
            coordinate_exponent: self.coordinate_exponent,
            chord_exponent: self.chord_exponent,
        }
    }

    /// Where each piece lies on the path.
    #[must_use]
    pub fn places(&self) -> &[Place] {
        &self.places
    }

    /// The parts of the path that are on no piece, in order: each stands still, at a cusp, where control points coincide or on a
    /// curve that is a point, and moves by no more than 1e-9 mm, or than rounding. The piece behind begins where it ends.
    #[must_use]
    pub fn still_places(&self) -> &[Place] {
        &self.still
    }

    /// The number of the piece that begins at the parameter `u` of curve number `curve`, or that follows the one that
    /// ends there, or the place that stands still there; `None` where no joint is. `u` may be off by rounding, 2⁻²⁴ of a piece.
    #[must_use]
    pub fn joint(&self, curve: usize, u: f64) -> Option<usize> {
        let rounding = |place: &Place| (place.end.0 - place.begin.0).scale(SLIVER + MAX_HALVINGS);
        let is_near = |place: &Place, end: f64| place.curve == curve && (end - u).abs() <= rounding(place);
        let next = self.places.partition_point(|place| (place.curve, place.end.0) < (curve, u));
        let around = next.saturating_sub(1)..self.places.len().min(next + 2);
        let ends = |piece: &usize| is_near(&self.places[*piece], self.places[*piece].end.0);
        let begins = |piece: &usize| is_near(&self.places[*piece], self.places[*piece].begin.0);
        let after = around.clone().find(ends).map(|piece| piece + 1);
        after.or_else(|| around.clone().find(begins)).or_else(|| self.is_still(curve, u).then_some(next))
    }

    /// Whether the path stands still there.
    fn is_still(&self, curve: usize, u: f64) -> bool {
        let next = self.still.partition_point(|place| (place.curve, place.end.0) < (curve, u));
        self.still.get(next).is_some_and(|place| place.curve == curve && place.begin.0 <= u)
    }

    /// The longest chord of a period that the bounds are proven for, in mm: [`PieceLimits::step_mm`].
    #[must_use]
    pub fn step_mm(&self) -> f64 {
        self.step_mm
    }

    /// The proven bounds, a signal each.
    #[must_use]
    pub fn bounds(&self) -> &[SignalBound] {
        &self.bounds
    }
}

impl<R: Backend, const D: usize> PiecesBuf<R, D> {
    /// What a resolution of a piece's coordinates is one of, in mm: the piece's unit, in which they are of order one; in a
    /// float, whose unit says nothing of its digits, `Σ |n_k|` of them. 0 for a piece that does not exist.
    #[must_use]
    pub fn coordinate_size_mm(&self, piece: usize) -> f64 {
        let Some(row) = self.pieces.get(piece) else { return 0.0 };
        let numerator = self.numerators.iter().skip(piece * self.degree).take(self.degree);
        let sum = |d: usize| numerator.clone().map(|n| n[d].to_f64().abs()).sum::<f64>();
        let units = if R::IS_FLOATING { (0..D).map(sum).fold(0.0, f64::max) } else { 1.0 };
        units.scale(row.coordinate_exponent.into())
    }
}

/// Longest chain of halvings of a span that make its pieces shorter, and their weights more even.
const MAX_HALVINGS: i32 = 16;

/// The same where only the speed is uneven. Towards a place where it vanishes |C'| falls by a power of two with each halving, down
/// to [`STILL_MM`]: some pieces a halving are all that this takes.
const MOST_HALVINGS: i32 = 40;

/// Halvings beyond [`MAX_HALVINGS`] in a part of a span, at most: a place where |C'| vanishes takes a hundred.
const MOST_FINER_HALVINGS: usize = 4096;

/// What is uneven and no longer than this, in mm, stands still: far below what a drive resolves, 2⁻²⁵ of a usual step.
const STILL_MM: f64 = 1e-9;

/// What is no longer than 2⁷ units in the last place of a curve's coordinates is rounding.
const ROUNDING: i32 = 7;

/// Less than 2⁻⁴⁰ of a span is rounding.
const SLIVER: i32 = -40;

/// Largest ratio of the greatest to the least |C'| on a piece, and of weights: it keeps the solver's unknown within
/// a factor √1.5 of 1, which even two integer bits hold. A smaller ratio means more pieces.
const MAX_RATIO: f64 = 1.5;

/// Largest chord in its own scale. A step of a quarter of the longest then has the resolution that the step per chord,
/// which is about 1, has in any case; more would gain nothing.
const MAX_CHORD_RANGE: f64 = 4.0;

/// |C'| below this part of the piece's mean speed counts as a cusp.
const CUSP_RATIO: f64 = 1e-4;

/// Cuts `curves` into pieces and rounds them to the format `R`; everything before the rounding is computed in `H`.
///
/// `H` is a float, which is checked when it is compiled: in fixed point a curve's numbers do not fit.
///
/// ```compile_fail
/// # use nurbs_core::{NurbsCurve, PieceLimits, compile};
/// let line = NurbsCurve::try_new_nonrational(1, &[[0.0], [200.0]], &[0.0, 0.0, 1.0, 1.0]).unwrap();
/// let _ = compile::<real::I4F28, f64, 1>(&[line], &PieceLimits { length_mm: 32.0, step_mm: 0.2 });
/// ```
///
/// # Errors
/// [`CompileError`], naming the curve, or the signal that does not fit. A number of a curve that `H` does not hold, as `f32` does
/// not hold 1e300, is a [`CompileError::SpeedOutOfRange`].
pub fn compile<H: Backend, R: Backend, const D: usize>(
    curves: &[NurbsCurve<'_, f64, D>],
    limits: &PieceLimits,
) -> Result<PiecesBuf<R, D>, CompileError> {
    compile_with_stops::<H, R, D>(curves, limits, &[])
}

/// The same with a joint at each of `stops`, pairs of a curve's number and a parameter in order, so that a run can land
/// there: a plan also rests in bends inside a span that are all but cusps. A stop outside its curve's domain, or on no curve
/// of the path, makes none.
///
/// # Errors
/// As [`compile`]; [`CompileError::StopOutOfOrder`].
pub fn compile_with_stops<H: Backend, R: Backend, const D: usize>(
    curves: &[NurbsCurve<'_, f64, D>],
    limits: &PieceLimits,
    stops: &[(usize, f64)],
) -> Result<PiecesBuf<R, D>, CompileError> {
    for (what, value) in [("the longest piece", limits.length_mm), ("the longest step", limits.step_mm)] {
        if !(value > 0.0 && value.is_finite()) {
            return Err(CompileError::LimitNotPositive { what, value });
        }
    }
    let mut before = (0, f64::NEG_INFINITY);
    for (index, stop) in stops.iter().enumerate() {
        let is_in_order = before <= *stop; // not so for what is no number
        if !is_in_order {
            return Err(CompileError::StopOutOfOrder { index });
        }
        before = *stop;
    }
    let mut local = Cut { pieces: Vec::new(), still: Vec::new() };
    for (index, curve) in curves.iter().enumerate() {
        let first = stops.partition_point(|stop| stop.0 < index);
        let stops = stops.iter().skip(first).take_while(|stop| stop.0 == index).map(|stop| stop.1);
        cut::<H, D>((index, curve), limits, stops, &mut local)?;
    }
    match local.still.first() {
        Some(place) if local.pieces.is_empty() => {
            Err(CompileError::Cusp { curve: place.curve, parameter: place.begin.0 })
        }
        _ => rounded::<H, R, D>(local, limits.step_mm),
    }
}

/// A path in pieces, and what of it stands still, in order.
struct Cut<H, const D: usize> {
    pieces: Vec<LocalPiece<H, D>>,
    still: Vec<Place>,
}

/// Cuts one curve, span by span and stop by stop, halving until a piece is short and even enough.
fn cut<H: Backend, const D: usize>(
    (index, curve): (usize, &NurbsCurve<'_, f64, D>),
    limits: &PieceLimits,
    stops: impl Iterator<Item = f64>,
    out: &mut Cut<H, D>,
) -> Result<(), CompileError> {
    let knots = curve.knots().as_slice();
    let spans = curve.degree()..curve.control_points().len();
    let ends = spans.map(|span| (span, knots[span], knots[span + 1])).filter(|(_, begin, end)| begin < end);
    let mut stops = stops.peekable();
    let mut parts = Vec::new();
    for (span, mut begin, end) in ends {
        // Nearer to a joint than rounding, a stop is that joint.
        let sliver = (end - begin).scale(SLIVER);
        while let Some(stop) = stops.next_if(|stop| *stop < end) {
            if stop - begin > sliver && end - stop > sliver {
                parts.push((span, begin, stop));
                begin = stop;
            }
        }
        parts.push((span, begin, end));
    }
    let still = StillParts::of::<H, D>(curve);
    let mut part = 0;
    for (span, first, end) in parts {
        part += 1;
        let mut finer = 0;
        let mut rest = Vec::from([(computed::<H>(first), computed(end), 0)]);
        while let Some((begin, end, halvings)) = rest.pop() {
            let bezier = Bezier::of_span(curve, span, begin, end);
            let place = Place { curve: index, begin: begin.to_f64_pair(), end: end.to_f64_pair() };
            let (length, speed) = (bezier.polygon_mm(), bezier.speed());
            let is_even = speed.is_even(MAX_RATIO);
            if still.contain(length, is_even) {
                out.still.push(place);
                // What lies beyond does not continue what lies before.
                part += 1;
                continue;
            }
            let is_small = length <= limits.length_mm && bezier.has_even_weights(MAX_RATIO);
            let is_finer = halvings >= MAX_HALVINGS;
            let may_be_halved =
                !is_finer || (is_small && halvings < MOST_HALVINGS && finer < MOST_FINER_HALVINGS);
            if !(is_small && is_even) && may_be_halved {
                finer += usize::from(is_finer);
                let middle = begin + (end - begin).half();
                rest.push((middle, end, halvings + 1));
                rest.push((begin, middle, halvings + 1));
                continue;
            }
            // A number of the curve that `H` does not hold may be this parameter.
            let parameter = if place.begin.0.is_finite() { place.begin.0 } else { first };
            let out_of_range = CompileError::SpeedOutOfRange { curve: index, parameter };
            if !bezier.is_finite() {
                return Err(out_of_range);
            }
            let piece = LocalPiece::new(&bezier, place, (index, part), halvings, speed)
                .ok_or(CompileError::OriginOutOfRange { curve: index })?;
            if !piece.is_finite() {
                return Err(out_of_range);
            }
            if piece.speed.least <= CUSP_RATIO * piece.speed.greatest {
                return Err(CompileError::Cusp { curve: index, parameter: place.begin.0 });
            }
            out.pieces.push(piece);
        }
    }
    Ok(())
}

/// What of a curve stands still: no step per chord exists where C' vanishes, so no piece has such a place, and the path goes on
/// from its other end.
#[derive(Clone, Copy)]
struct StillParts {
    /// What is uneven and no longer than this, in mm.
    uneven_mm: f64,
    /// What is no longer than this, in mm, whatever its speed: it is rounding.
    rounding_mm: f64,
}

impl StillParts {
    /// p rounds of blossoming are off by some p² units in the last place of the coordinates.
    fn of<H: Backend, const D: usize>(curve: &NurbsCurve<'_, f64, D>) -> Self {
        let farthest = curve.control_points().iter().flatten().fold(0.0_f64, |most, x| most.max(x.abs()));
        let rounding_mm = (farthest * H::resolution().to_f64()).scale(ROUNDING);
        Self { uneven_mm: rounding_mm.max(STILL_MM), rounding_mm }
    }

    /// Whether a part of the curve that is no longer than this stands still.
    fn contain(&self, length_mm: f64, is_even: bool) -> bool {
        length_mm <= if is_even { self.rounding_mm } else { self.uneven_mm }
    }
}

/// Chooses the scales for `R`, proves the bounds, and rounds.
fn rounded<H: Backend, R: Backend, const D: usize>(
    Cut { pieces: local, still }: Cut<H, D>,
    step_mm: f64,
) -> Result<PiecesBuf<R, D>, CompileError> {
    let degree = local.iter().map(|piece| piece.numerator.len()).max().unwrap_or(1).min(MAX_DEGREE);
    let rational = local.iter().any(|piece| piece.rational);
    let local = scaled::<H, R, D>(local, step_mm);
    let fixed = matches!(R::name(), FormatName::Fixed { .. });
    let resolution = if fixed { R::resolution().to_f64() } else { 0.0 };
    let bounds = ranges::signal_bounds(&local, rational, step_mm, resolution);
    if fixed {
        ranges::refuse_what_does_not_fit::<R>(&bounds)?;
    }
    let mut table = PiecesBuf {
        pieces: Vec::with_capacity(local.len()),
        numerators: Vec::with_capacity(local.len() * degree),
        weights: Vec::new(),
        degree,
        coordinate_exponent: local.iter().map(|(_, scales)| scales.coordinate).max().unwrap_or(0),
        chord_exponent: local.first().map_or(0, |(_, scales)| scales.chord),
        places: local.iter().map(|(piece, _)| piece.place).collect(),
        still,
        bounds,
        step_mm,
    };
    let round = |x: H| R::from_f64_pair(x.to_f64_pair().0, x.to_f64_pair().1);
    for (index, (piece, scales)) in local.iter().enumerate() {
        let Place { curve, begin, .. } = piece.place;
        let out_of_range = CompileError::SpeedOutOfRange { curve, parameter: begin.0 };
        for k in 0..degree {
            let power = piece.numerator.get(k).copied().unwrap_or([H::zero(); D]);
            let mut rounded = [R::zero(); D];
            for (to, x) in rounded.iter_mut().zip(power) {
                *to = round(x.scale(-scales.coordinate)).ok_or(out_of_range)?;
            }
            table.numerators.push(rounded);
        }
        for k in (0..=degree).filter(|_| rational) {
            let weight = piece.weight.get(k).copied().unwrap_or_else(H::zero);
            table.weights.push(round(weight).ok_or(out_of_range)?);
        }
        let row = row(piece, scales, local.get(index + 1));
        // A step per chord that a float rounds to nothing, or does not hold, would leave a run where it is.
        if !row.step_per_chord.iter().all(|sigma: &R| *sigma > R::zero() && sigma.is_finite()) {
            return Err(out_of_range);
        }
        table.pieces.push(row);
    }
    Ok(table)
}

/// Joins the scales to the pieces.
fn scaled<H: Backend, R: Backend, const D: usize>(
    local: Vec<LocalPiece<H, D>>,
    step_mm: f64,
) -> Vec<(LocalPiece<H, D>, Scales)> {
    // The chords use half of a fixed format's range; a float is content with numbers of order one.
    let fixed = matches!(R::name(), FormatName::Fixed { .. });
    let range = if fixed { R::max_value().to_f64() } else { 2.0 };
    let chord_range = (range / 2.0).min(MAX_CHORD_RANGE);
    let mut chord = exponent_below(chord_range / step_mm);
    if R::IS_FLOATING {
        chord = chord.clamp(-MAX_STEP_EXPONENT, MAX_STEP_EXPONENT); // -λ then has a place in a row.
    }
    let scales = |piece: &LocalPiece<H, D>| {
        if R::IS_FLOATING {
            return Scales { coordinate: -chord, chord, step: 0, range: 0 };
        }
        let step = piece.speed.step_exponent(chord);
        let coordinate = (-exponent_below(range / piece.coordinate_bound_mm())).clamp(-120, 120);
        let mut scales = Scales { coordinate, chord, step, range: exponent_below(chord_range) };
        // x is at most so much; the finer its unit the better, but it must fit.
        let eta = piece.step_per_chord(&scales)[1] * step_mm * power_of_two(chord);
        scales.range += i32::from(eta * power_of_two(-scales.range) >= range);
        Scales { range: scales.range.min(step), ..scales }
    };
    local
        .into_iter()
        .map(|piece| {
            let scales = scales(&piece);
            (piece, scales)
        })
        .collect()
}

/// An exponent as a row has it: what is beyond is beyond every format.
fn small(exponent: i32) -> i8 {
    i8::try_from(exponent.clamp(-126, 126)).unwrap_or(0)
}

/// A fraction in [½, 1) in units of 2⁻¹⁶, rounded to nearest.
#[allow(
    clippy::cast_possible_truncation,
    clippy::cast_sign_loss,
    reason = "the cast saturates, and no fraction is negative"
)]
fn sixteen_bits(fraction: f64) -> u16 {
    (fraction.scale(16) + 0.5) as u16
}

fn row<H: Backend, R: Backend, const D: usize>(
    piece: &LocalPiece<H, D>,
    scales: &Scales,
    next: Option<&(LocalPiece<H, D>, Scales)>,
) -> Piece<R, D> {
    let near = |x: f64| R::from_f64(x).unwrap_or_else(R::zero);
    // What fixed point rounds to nothing would leave a run where it is.
    let least = if R::IS_FLOATING { R::zero() } else { R::resolution() };
    let (joint_ratio, joint_exponent) =
        next.map_or((0.5, 1), |(next, next_scales)| piece.joint(scales, next, next_scales));
    Piece {
        origin: piece.origin,
        coordinate_exponent: small(scales.coordinate),
        step_exponent: small(scales.step),
        range_exponent: small(scales.range),
        joint_ratio: sixteen_bits(joint_ratio),
        joint_exponent: small(joint_exponent),
        joint: next.map_or(Joint::Smooth, |(next, _)| piece.joint_to(next)),
        step_per_chord: piece.step_per_chord(scales).map(|sigma| near(sigma).max(least)),
    }
}
