//! Steps from random places of random pieces, and over their joints, against the exact chord.
//!
//! A case is one to three Bézier curves, cut into pieces, and a few steps of random lengths along them. Each step
//! begins where the one before ended, with whatever history that left. Its chord is measured in double-double, on
//! pieces that are rounded to no format.

use arbitrary::{Arbitrary, Unstructured};
use nurbs_core::{CutPath, Joint, NurbsBuf, ORIGIN_EXPONENT, PieceLimits, Pieces, PiecesBuf};
use real::{Backend, Datapath, DoubleDouble, I4F28, Real, RuntimeFixed, RuntimeFormat};
use secant_interp::{
    BEHIND_JOINT, ChordTolerance, PieceInterpolator, PieceSetpoint, PieceState, StepLengths,
};

use crate::chord_bound::ChordBound;
use crate::fault::KernelFault;
use crate::piece_judge::PieceJudge;

/// Curves, and steps along them.
#[derive(Clone, Debug)]
pub struct ChordCase {
    curves: Vec<NurbsBuf<f64, 2>>,
    limits: PieceLimits,
    max_evaluations: u32,
    /// Each step over the longest one.
    shares: Vec<f64>,
    /// The run-time format: width and fraction bits.
    format: (u32, u32),
}

/// What a case came to.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq)]
pub struct ChordTally {
    /// Formats that the pieces fit.
    pub formats: u32,
    /// Steps that were made.
    pub steps: u32,
    /// Those of them whose chord was measured: not one that lands on the end, that lacked evaluations, or over which the path turns
    /// out of the solver's reach.
    pub measured: u32,
    /// Those of the measured ones that crossed a joint.
    pub crossed: u32,
}

impl ChordTally {
    /// Both together.
    #[must_use]
    pub fn with(self, other: Self) -> Self {
        Self {
            formats: self.formats + other.formats,
            steps: self.steps + other.steps,
            measured: self.measured + other.measured,
            crossed: self.crossed + other.crossed,
        }
    }
}

fn between(bytes: &mut Unstructured<'_>, low: f64, high: f64) -> arbitrary::Result<f64> {
    Ok(low + (high - low) * f64::from(bytes.arbitrary::<u16>()?) / f64::from(u16::MAX))
}

impl<'a> Arbitrary<'a> for ChordCase {
    fn arbitrary(bytes: &mut Unstructured<'a>) -> arbitrary::Result<Self> {
        let size_mm = 10.0_f64.powf(between(bytes, -1.0, 2.0)?);
        let (mut at, mut heading) = ([0.0; 2], 0.0);
        let mut curves = Vec::new();
        for _ in 0..bytes.int_in_range(1..=3)? {
            // From curve to curve the heading goes on, but for a corner now and then.
            if bytes.ratio(1, 4)? {
                heading += between(bytes, -1.5, 1.5)?;
            }
            curves.push(bezier(bytes, (&mut at, &mut heading), size_mm)?);
        }
        let step_mm = size_mm * 10.0_f64.powf(between(bytes, -2.5, 0.0)?);
        let share = |bytes: &mut Unstructured<'a>| {
            let decades = if bytes.arbitrary()? { 4.0 } else { 0.3 };
            Ok(10.0_f64.powf(between(bytes, -decades, 0.0)?).min(0.999))
        };
        let count = bytes.int_in_range(1..=8)?;
        let shares = (0..count).map(|_| share(bytes)).collect::<arbitrary::Result<_>>()?;
        let width = bytes.int_in_range(16..=64)?;
        Ok(Self {
            curves,
            limits: PieceLimits { length_mm: *bytes.choose(&[32.0, size_mm, size_mm / 4.0])?, step_mm },
            max_evaluations: bytes.int_in_range(2..=8)?,
            shares,
            format: (width, bytes.int_in_range(width / 2..=width - 2)?),
        })
    }
}

/// A curve from `at` on, whose polygon turns by at most 80° at a time.
fn bezier(
    bytes: &mut Unstructured<'_>,
    (at, heading): (&mut [f64; 2], &mut f64),
    size_mm: f64,
) -> arbitrary::Result<NurbsBuf<f64, 2>> {
    let degree = if bytes.ratio(1, 8)? { bytes.int_in_range(5..=7)? } else { bytes.int_in_range(1..=4)? };
    let mut points = vec![*at];
    for leg in 0..degree {
        if leg > 0 {
            *heading += between(bytes, -1.4, 1.4)?;
        }
        let length = size_mm * between(bytes, 0.1, 1.0)?;
        *at = [at[0] + length * heading.cos(), at[1] + length * heading.sin()];
        points.push(*at);
    }
    let knots = [0.0, 1.0].into_iter().flat_map(|end| core::iter::repeat_n(end, degree + 1)).collect();
    let weights = if bytes.ratio(1, 3)? {
        (0..=degree).map(|_| between(bytes, 0.5, 2.0)).collect::<arbitrary::Result<_>>()?
    } else {
        vec![1.0; degree + 1]
    };
    NurbsBuf::try_new(degree, points, weights, knots).map_err(|_| arbitrary::Error::IncorrectFormat)
}

impl ChordCase {
    /// Makes the steps in f64, f32, I4F28 and the run-time format.
    ///
    /// # Errors
    /// The first step whose chord is off the wanted one by more than the format's roundings.
    pub fn check(&self) -> Result<ChordTally, KernelFault> {
        let curves: Vec<_> = self.curves.iter().map(NurbsBuf::as_curve).collect();
        let Ok(cut) = CutPath::<DoubleDouble, 2>::new(&curves, &self.limits, &[]) else {
            return Ok(ChordTally::default());
        };
        let (Ok(exact), Ok(rounded)) = (cut.rounded::<DoubleDouble>(), cut.rounded::<f64>()) else {
            return Ok(ChordTally::default());
        };
        let judges = Judges { exact: ExactPieces(exact), turns: PieceJudge::of(rounded) };
        let in_types = self.steps(cut.rounded::<f64>().ok(), &judges)?;
        let in_types = in_types.with(self.steps(cut.rounded::<f32>().ok(), &judges)?);
        let in_types = in_types.with(self.steps(cut.rounded::<I4F28>().ok(), &judges)?);
        let Datapath { rounding, overflow } = Datapath::default();
        let Some(format) = RuntimeFormat::new(self.format.0, self.format.1, rounding, overflow) else {
            return Ok(in_types);
        };
        let at_run_time =
            format.run::<0, _>(|| self.steps(cut.rounded::<RuntimeFixed<0>>().ok(), &judges))?;
        Ok(in_types.with(at_run_time))
    }

    /// The steps on the pieces of one format; none where they do not fit.
    fn steps<R: Backend>(
        &self,
        table: Option<PiecesBuf<R, 2>>,
        judges: &Judges,
    ) -> Result<ChordTally, KernelFault> {
        let Some(table) = table else { return Ok(ChordTally::default()) };
        let pieces = table.as_pieces();
        let run = PieceInterpolator {
            pieces,
            lengths: StepLengths { stages: &[], crossings: &[] },
            tolerance: ChordTolerance::for_fluctuation(None, self.max_evaluations),
            landing_step: R::resolution(),
        };
        let mut tally = ChordTally { formats: 1, ..ChordTally::default() };
        let mut state = run.start();
        let mut from = (0, 0);
        for share in &self.shares {
            let length = (share * self.limits.step_mm).ldexp(pieces.chord_exponent);
            let Some(length) = R::from_f64(length).filter(|length| *length > R::zero()) else { continue };
            let Some(setpoint) = step_by(&run, &mut state, length) else { break };
            let step = Step { from, setpoint, wanted: ChordBound::of(&pieces).in_mm(length) };
            let is_measured = step.check(&run, judges, self)?;
            tally.steps += 1;
            tally.measured += u32::from(is_measured);
            tally.crossed += u32::from(is_measured && setpoint.piece > from.0);
            from = (setpoint.piece, setpoint.phase);
        }
        Ok(tally)
    }
}

/// The step of a run on pieces, compiled once for a format.
#[inline(never)]
fn step_by<R: Real>(
    run: &PieceInterpolator<'_, R, 2>,
    state: &mut PieceState<R, 2>,
    length: R,
) -> Option<PieceSetpoint<R, 2>> {
    run.step_by(state, length)
}

/// The exact pieces, and those by which turns are told.
struct Judges {
    exact: ExactPieces,
    turns: PieceJudge<2>,
}

/// A step, from a place to its setpoint.
struct Step<R> {
    from: (usize, u64),
    setpoint: PieceSetpoint<R, 2>,
    wanted: f64,
}

impl<R: Backend> Step<R> {
    /// Checks the step; whether its chord was measured.
    fn check(
        &self,
        run: &PieceInterpolator<'_, R, 2>,
        judges: &Judges,
        case: &ChordCase,
    ) -> Result<bool, KernelFault> {
        let Self { from, setpoint, wanted } = self;
        let to = (setpoint.piece, setpoint.phase);
        let last = run.pieces.pieces.len();
        self.demand("a step goes back", f64::from(u8::from(to < *from || to.0 > last)), 0.0)?;
        let joints = to.0 - from.0;
        let most =
            run.tolerance.max_evaluations + BEHIND_JOINT * u32::try_from(joints).unwrap_or(u32::MAX / 4);
        self.demand("the evaluations of a step", setpoint.evaluations.into(), most.into())?;
        let is_finite = setpoint.offset.iter().all(|x| x.is_finite());
        self.demand("a setpoint that is no number", f64::from(u8::from(!is_finite)), 0.0)?;

        let place = |(piece, phase): (usize, u64)| (piece, f64::from_phase(phase, 0));
        let turns = judges.turns.turns(place(*from), place(to));
        let is_found = setpoint.evaluations < run.tolerance.max_evaluations;
        if !is_found || !turns.leave_in_reach(run.pieces.pieces.get(to.0)) {
            return Ok(false);
        }
        let chord = judges.exact.chord(*from, to);
        let bound = ChordBound::of(&run.pieces).chord_mm(*wanted, joints)
            // Origins are rounded; on one piece the place is, to a unit of its phase.
            + if joints > 0 { 4.0_f64.ldexp(ORIGIN_EXPONENT) } else { chord / (to.1 - from.1).max(1) as f64 }
            // A place that is added up has the last digit of 1, at the speed of its piece.
            + if R::ADDS_PLACES { 4.0 * f64::EPSILON * case.limits.length_mm.max(chord) } else { 0.0 };
        if to.0 == last {
            self.demand("the way to an end that was landed on, mm", chord, wanted + bound)?;
            return Ok(false);
        }
        self.demand("the chord's error, mm", (chord - wanted).abs(), bound)?;
        Ok(true)
    }

    fn demand(&self, what: &str, value: f64, bound: f64) -> Result<(), KernelFault> {
        if value <= bound {
            return Ok(());
        }
        let Self { from, setpoint, wanted } = self;
        Err(KernelFault {
            what: format!(
                "{what}, for a step of {wanted:e} mm from {from:?} to {:?}",
                (setpoint.piece, setpoint.phase)
            ),
            format: R::name().to_string(),
            found: format!("{value:e}"),
            expected: format!("at most {bound:e}"),
        })
    }
}

/// Pieces in double-double.
struct ExactPieces(PiecesBuf<DoubleDouble, 2>);

impl ExactPieces {
    /// The length of a step between two places: the sum of the chords from corner to corner.
    fn chord(&self, from: (usize, u64), to: (usize, u64)) -> f64 {
        let pieces = self.0.as_pieces();
        let mut begin = (from.0, fraction(from.1));
        let mut length = 0.0;
        for piece in from.0..to.0 {
            if pieces.pieces.get(piece).is_some_and(|row| row.joint == Joint::Breaks) {
                length += distance(&pieces, begin, (piece, DoubleDouble::from(1.0)));
                begin = (piece + 1, DoubleDouble::from(0.0));
            }
        }
        let last = pieces.pieces.len() - 1;
        let end = if to.0 > last { (last, DoubleDouble::from(1.0)) } else { (to.0, fraction(to.1)) };
        if begin.0 > last { length } else { length + distance(&pieces, begin, end) }
    }
}

/// `phase · 2⁻⁶⁴`, exactly.
fn fraction(phase: u64) -> DoubleDouble {
    let halves = [phase >> 32, phase & 0xffff_ffff].map(|half| half as f64);
    DoubleDouble::new(halves[0].ldexp(-32), halves[1].ldexp(-64))
}

/// The distance of two places, in mm.
fn distance(
    pieces: &Pieces<'_, DoubleDouble, 2>,
    from: (usize, DoubleDouble),
    to: (usize, DoubleDouble),
) -> f64 {
    let offsets = [from, to].map(|(piece, t)| pieces.offset(piece, t));
    let way: [DoubleDouble; 2] = core::array::from_fn(|d| {
        let apart = pieces.pieces[to.0].origin[d] - pieces.pieces[from.0].origin[d];
        let (high, low) = ((apart >> 32) as f64, (apart & 0xffff_ffff) as f64);
        let apart = DoubleDouble::new(high.ldexp(32 + ORIGIN_EXPONENT), low.ldexp(ORIGIN_EXPONENT));
        apart + (offsets[1][d] - offsets[0][d]).ldexp(pieces.coordinate_exponent)
    });
    DoubleDouble::norm(&way).value()
}
