//! Runs a path of compiled pieces at a swinging feed and measures every chord in double-double.

use nurbs_core::{CompileError, Evaluate, Joint, NurbsBuf, PieceLimits, PiecesBuf, SignalBound, compile};
use real::{Backend, DoubleDouble, Real};
use secant_interp::{ChordTolerance, LengthStage, PieceInterpolator, StepLengths};

/// Curves, one after the other, and the distance of a period at full feed.
#[derive(Clone, Debug)]
pub(crate) struct Path<const D: usize> {
    pub(crate) curves: Vec<NurbsBuf<f64, D>>,
    pub(crate) feed_mm: f64,
}

/// How a path is cut, and when the solver stops.
#[derive(Clone, Copy, Debug)]
pub(crate) struct Settings {
    pub(crate) piece_mm: f64,
    /// The largest fluctuation that the solver may leave, but never less than the format's resolution.
    pub(crate) fluctuation: f64,
    pub(crate) max_evaluations: u32,
}

/// K is that of a machine file which does not say it.
impl Default for Settings {
    fn default() -> Self {
        Self { piece_mm: 32.0, fluctuation: 0.0, max_evaluations: 8 }
    }
}

/// What a run was like.
#[derive(Clone, Debug, Default)]
pub(crate) struct Figures {
    /// Largest |1 - chord/L| over the steps of at least a quarter of the feed.
    pub(crate) cruise: f64,
    /// Evaluations per step.
    pub(crate) evaluations: f64,
    pub(crate) steps: usize,
    /// Joints passed.
    pub(crate) joints: usize,
    /// Steps that passed a joint, or several.
    pub(crate) crossings: usize,
    /// What was proven of the table.
    pub(crate) bounds: Vec<SignalBound>,
    /// FNV-1a of all pieces, phases and evaluations.
    pub(crate) checksum: u64,
}

/// The table of a path in the format `R`.
pub(crate) fn compiled<R: Backend, const D: usize>(
    path: &Path<D>,
    settings: &Settings,
) -> Result<PiecesBuf<R, D>, CompileError> {
    let curves: Vec<_> = path.curves.iter().map(NurbsBuf::as_curve).collect();
    let limits = PieceLimits { length_mm: settings.piece_mm, step_mm: path.feed_mm * 1.05 };
    compile::<DoubleDouble, R, D>(&curves, &limits)
}

/// A feed that rises from rest, then swings between half and full in ramps of twenty periods, as limits make it.
pub(crate) fn swing<R: Backend>(full: f64) -> Vec<LengthStage<R>> {
    let feed = |part: f64| R::from_f64(part * full).unwrap();
    let turns = [(1.0, 1.0), (1.0, 0.5), (0.5, 0.5), (0.5, 1.0)];
    [(0.0, 1.0)]
        .into_iter()
        .chain(turns.into_iter().cycle().take(4000))
        .filter_map(|(v, w)| LengthStage::new(20 << 32, feed(v), feed(w) - feed(v)))
        .collect()
}

/// Follows a compiled path at these stages.
pub(crate) fn interpolator<'a, R: Backend, const D: usize>(
    path: &Path<D>,
    settings: &Settings,
    table: &'a PiecesBuf<R, D>,
    stages: &'a [LengthStage<R>],
) -> PieceInterpolator<'a, R, D> {
    let pieces = table.as_pieces();
    let landing_step = (0.05 * path.feed_mm).ldexp(pieces.chord_exponent);
    PieceInterpolator {
        pieces,
        lengths: StepLengths { stages, crossings: &[] },
        tolerance: ChordTolerance::for_fluctuation(Some(settings.fluctuation), settings.max_evaluations),
        landing_step: R::from_f64(landing_step).unwrap(),
    }
}

/// Runs to the end; every step is checked to go forward and to keep its number of evaluations.
pub(crate) fn run<R: Backend, const D: usize>(
    path: &Path<D>,
    settings: &Settings,
) -> Result<Figures, CompileError> {
    let table: PiecesBuf<R, D> = compiled(path, settings)?;
    let stages = swing::<R>(path.feed_mm.ldexp(table.as_pieces().chord_exponent));
    let interpolator = interpolator(path, settings, &table, &stages);

    let exact: Vec<_> = path.curves.iter().map(|curve| curve.convert::<DoubleDouble>().unwrap()).collect();
    let place = |piece: usize, phase: u64| {
        let last = table.places().len() - 1;
        let at = &table.places()[piece.min(last)];
        let (begin, end) = (DoubleDouble::new(at.begin.0, at.begin.1), DoubleDouble::new(at.end.0, at.end.1));
        let t = if piece > last { DoubleDouble::from(1.0) } else { DoubleDouble::from_phase(phase, 0) };
        exact[at.curve].as_curve().point(begin + (end - begin) * t)
    };
    let mut state = interpolator.start();
    let mut from = place(0, 0);
    let mut before = (0, 0);
    let mut figures = Figures { checksum: 0xcbf2_9ce4_8422_2325, ..Figures::default() };
    let mut evaluations = 0;
    while !interpolator.is_at_end(&state)
        && let Some(setpoint) = interpolator.step(&mut state)
    {
        let at = (setpoint.piece, setpoint.phase);
        let to = place(at.0, at.1);
        assert!(at >= before, "{} goes back: {before:?} {at:?}", R::name());
        let touched = u32::try_from(at.0 - before.0 + 1).unwrap();
        assert!(
            setpoint.evaluations <= settings.max_evaluations + secant_interp::BEHIND_JOINT * (touched - 1),
            "{}: {} evaluations on {touched} pieces",
            R::name(),
            setpoint.evaluations
        );
        let leg = |from: &[DoubleDouble; D], to: &[DoubleDouble; D]| {
            DoubleDouble::norm(&core::array::from_fn::<_, D, _>(|d| to[d] - from[d]))
        };
        // From corner to corner.
        let mut chord = DoubleDouble::from(0.0);
        for piece in before.0..at.0 {
            if table.as_pieces().pieces[piece].joint == Joint::Breaks {
                let corner = place(piece + 1, 0);
                (chord, from) = (chord + leg(&from, &corner), corner);
            }
        }
        chord = chord + leg(&from, &to);
        let (high, low) = setpoint.length.to_f64_pair();
        let wanted = DoubleDouble::new(high, low).ldexp(-table.as_pieces().chord_exponent);
        if at.0 < table.places().len() && wanted.value() >= 0.25 * path.feed_mm {
            let delta = (DoubleDouble::from(1.0) - chord / wanted).value().abs();
            figures.cruise = figures.cruise.max(delta);
        }
        evaluations += u64::from(setpoint.evaluations);
        figures.steps += 1;
        figures.joints += at.0 - before.0;
        figures.crossings += usize::from(at.0 > before.0);
        for word in [at.0 as u64, at.1, u64::from(setpoint.evaluations)] {
            figures.checksum = (figures.checksum ^ word).wrapping_mul(0x0100_0000_01b3);
        }
        assert!(figures.steps < 100_000, "{} does not end", R::name());
        from = to;
        before = at;
    }
    figures.bounds = table.bounds().to_vec();
    figures.evaluations = evaluations as f64 / figures.steps as f64;
    assert_eq!(before, (table.places().len(), 0), "{} ends at the end", R::name());
    Ok(figures)
}
