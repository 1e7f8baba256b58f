//! Runs a path of compiled pieces at a swinging feed and measures every chord in double-double.

use nurbs_core::{
    CompileError, Evaluate, Joint, NurbsBuf, PieceLimits, PiecesBuf, Place, SignalBound, compile,
};
use real::{
    Audit, Audited, Backend, DoubleDouble, FormatName, I4F28, I4F60, Real, RuntimeFixed, RuntimeFormat,
};
use secant_interp::{ChordTolerance, LengthStage, PieceInterpolator, StepLengths};

use crate::steps::step;

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

/// A step as it is judged: without its format.
struct Step {
    at: (usize, u64),
    evaluations: u32,
    /// The chord, in chord units: the number and what is left of it.
    length: (f64, f64),
}

/// The steps to the end.
fn steps<R: Backend, const D: usize>(run: &PieceInterpolator<'_, R, D>) -> Vec<Step> {
    let (mut state, mut steps) = (run.start(), Vec::new());
    while !run.is_at_end(&state)
        && let Some(setpoint) = step(run, &mut state)
    {
        let at = (setpoint.piece, setpoint.phase);
        steps.push(Step { at, evaluations: setpoint.evaluations, length: setpoint.length.to_f64_pair() });
        assert!(steps.len() < 100_000, "{} does not end", R::name());
    }
    steps
}

/// Runs to the end; every step is checked to go forward and to keep its number of evaluations.
pub(crate) fn run<R: Backend, const D: usize>(
    path: &Path<D>,
    settings: &Settings,
) -> Result<Figures, CompileError> {
    let table: PiecesBuf<R, D> = compiled(path, settings)?;
    let pieces = table.as_pieces();
    let stages = swing::<R>(path.feed_mm.ldexp(pieces.chord_exponent));
    let steps = steps(&interpolator(path, settings, &table, &stages));
    let run = Run {
        steps,
        places: table.places().to_vec(),
        breaks: pieces.pieces.iter().map(|piece| piece.joint == Joint::Breaks).collect(),
        chord_exponent: pieces.chord_exponent,
        name: R::name(),
    };
    Ok(Figures { bounds: table.bounds().to_vec(), ..judged(path, settings, &run) })
}

/// The same run under audit, in the format of this name. Fixed point is audited in the format that is chosen at run time: its steps are
/// those of the format's own type, which tests compare, and it is compiled once for all of them.
pub(crate) fn run_watched<const D: usize>(
    format: &str,
    path: &Path<D>,
    settings: &Settings,
) -> (Result<Figures, CompileError>, Audit) {
    Audit::of(|| match format {
        "f64" => run::<Audited<f64>, D>(path, settings),
        "f32" => run::<Audited<f32>, D>(path, settings),
        _ => RuntimeFormat::named(format)
            .unwrap()
            .run::<0, _>(|| run::<Audited<RuntimeFixed<0>>, D>(path, settings)),
    })
}

/// The run in the format of this name: in one type of each kind, and in the format that is chosen at run time for the others.
pub(crate) fn run_in<const D: usize>(
    format: &str,
    path: &Path<D>,
    settings: &Settings,
) -> Result<Figures, CompileError> {
    match format {
        "f64" => run::<f64, D>(path, settings),
        "f32" => run::<f32, D>(path, settings),
        "I4F28" => run::<I4F28, D>(path, settings),
        "I4F60" => run::<I4F60, D>(path, settings),
        _ => run_watched(format, path, settings).0,
    }
}

/// A run in a format that is forgotten but for its name.
struct Run {
    steps: Vec<Step>,
    places: Vec<Place>,
    /// Of each piece, whether a corner is at its end.
    breaks: Vec<bool>,
    chord_exponent: i32,
    name: FormatName,
}

/// The figures of a run, without the bounds of its table.
fn judged<const D: usize>(path: &Path<D>, settings: &Settings, run: &Run) -> Figures {
    let name = run.name;
    let exact: Vec<_> = path.curves.iter().map(|curve| curve.convert::<DoubleDouble>().unwrap()).collect();
    let place = |piece: usize, phase: u64| {
        let last = run.places.len() - 1;
        let at = &run.places[piece.min(last)];
        let (begin, end) = (DoubleDouble::new(at.begin.0, at.begin.1), DoubleDouble::new(at.end.0, at.end.1));
        let t = if piece > last { DoubleDouble::from(1.0) } else { DoubleDouble::from_phase(phase, 0) };
        exact[at.curve].as_curve().point(begin + (end - begin) * t)
    };
    let leg = |from: &[DoubleDouble; D], to: &[DoubleDouble; D]| {
        DoubleDouble::norm(&core::array::from_fn::<_, D, _>(|d| to[d] - from[d]))
    };
    let mut from = place(0, 0);
    let mut before = (0, 0);
    let mut figures =
        Figures { checksum: 0xcbf2_9ce4_8422_2325, steps: run.steps.len(), ..Figures::default() };
    let mut evaluations = 0;
    for step in &run.steps {
        let at = step.at;
        let to = place(at.0, at.1);
        assert!(at >= before, "{name} goes back: {before:?} {at:?}");
        let touched = u32::try_from(at.0 - before.0 + 1).unwrap();
        assert!(
            step.evaluations <= settings.max_evaluations + secant_interp::BEHIND_JOINT * (touched - 1),
            "{name}: {} evaluations on {touched} pieces",
            step.evaluations
        );
        // From corner to corner.
        let mut chord = DoubleDouble::from(0.0);
        for piece in before.0..at.0 {
            if run.breaks[piece] {
                let corner = place(piece + 1, 0);
                (chord, from) = (chord + leg(&from, &corner), corner);
            }
        }
        chord = chord + leg(&from, &to);
        let (high, low) = step.length;
        let wanted = DoubleDouble::new(high, low).ldexp(-run.chord_exponent);
        if at.0 < run.places.len() && wanted.value() >= 0.25 * path.feed_mm {
            let delta = (DoubleDouble::from(1.0) - chord / wanted).value().abs();
            figures.cruise = figures.cruise.max(delta);
        }
        evaluations += u64::from(step.evaluations);
        figures.joints += at.0 - before.0;
        figures.crossings += usize::from(at.0 > before.0);
        for word in [at.0 as u64, at.1, u64::from(step.evaluations)] {
            figures.checksum = (figures.checksum ^ word).wrapping_mul(0x0100_0000_01b3);
        }
        from = to;
        before = at;
    }
    figures.evaluations = evaluations as f64 / figures.steps as f64;
    assert_eq!(before, (run.places.len(), 0), "{name} ends at the end");
    figures
}
