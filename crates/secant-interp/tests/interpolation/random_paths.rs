//! Random paths on compiled pieces, in every kind of format and under audit.

use crate::path_run::{Figures, Path, Settings, run, run_watched};
use nurbs_core::{CompileError, NurbsBuf, generate};
use proptest::prelude::*;
use real::{I3F29, I4F28, I4F60, I8F24, I16F48, Real, RuntimeFormat};

/// `cases` unless the environment asks for a long run.
fn config(cases: u32) -> ProptestConfig {
    let cases = std::env::var("PROPTEST_CASES").ok().and_then(|n| n.parse().ok()).unwrap_or(cases);
    ProptestConfig { cases, ..ProptestConfig::default() }
}

/// A random curve whose control polygon takes 20 to 1000 steps at full feed: a step spans up to hundreds of pieces.
fn path<const D: usize>() -> impl Strategy<Value = Path<D>> {
    along(generate::curve::<D>())
}

fn along<const D: usize>(curves: impl Strategy<Value = NurbsBuf<f64, D>>) -> impl Strategy<Value = Path<D>> {
    (curves, 20.0..1000.0_f64).prop_map(|(curve, steps)| {
        let legs = curve.control_points().windows(2);
        let leg = |p: &[[f64; D]]| f64::norm(&core::array::from_fn::<_, D, _>(|d| p[1][d] - p[0][d]));
        let polygon: f64 = legs.map(leg).sum();
        Path { curves: vec![curve], feed_mm: polygon / steps }
    })
}

/// The run in a type of its own, whose steps must be those of the audited run.
type Plain<const D: usize> = fn(&Path<D>, &Settings) -> Result<Figures, CompileError>;

/// Runs once under audit and once plainly: to the end, forward, the same, and in fixed point within the proven bounds.
/// False for a format that does not fit, which is refused before.
fn keeps_its_promises<const D: usize>(
    (name, plain): (&str, Option<Plain<D>>),
    path: &Path<D>,
    settings: &Settings,
) -> Result<bool, TestCaseError> {
    let fixed = RuntimeFormat::named(name);
    let (outcome, audit) = run_watched(name, path, settings);
    let watched = match outcome {
        Ok(figures) => figures,
        Err(CompileError::DoesNotFit { .. }) if fixed.is_some() => return Ok(false),
        Err(error) => return Err(TestCaseError::fail(error.to_string())),
    };
    if let Some(plain) = plain {
        prop_assert_eq!(plain(path, settings).unwrap().checksum, watched.checksum, "{}", name);
    }
    prop_assert_eq!((audit.overflows, audit.divisions_by_zero), (0, 0), "{}", name);
    // A float holds whatever a wrong guess comes to, and does not ask whether it is in range.
    let Some(format) = fixed else { return Ok(true) };
    let resolution = 0.5_f64.powi(i32::try_from(format.fraction_bits()).unwrap());
    for (signal, range) in &audit.signals {
        let Some(proven) = watched.bounds.iter().find(|bound| bound.signal == *signal) else {
            return Err(TestCaseError::fail(format!("{name}: no bound for {signal}")));
        };
        // The bounds are computed in f64, and each signal is rounded once more in its format.
        let slack = 64.0 * f64::EPSILON.max(resolution);
        let largest = range.max.max(-range.min);
        let bound = proven.bound * (1.0 + slack);
        prop_assert!(largest <= bound, "{name} {signal}: {largest} > {bound}");
    }
    Ok(true)
}

fn in_formats<const D: usize>(
    path: &Path<D>,
    (fluctuation, max_evaluations): (f64, u32),
    formats: [(&str, Option<Plain<D>>); 7],
) -> Result<(), TestCaseError> {
    let settings = Settings { fluctuation, max_evaluations, ..Settings::default() };
    let mut fixed = 0;
    for format in formats {
        let ran = keeps_its_promises(format, path, &settings)?;
        fixed += u32::from(ran && RuntimeFormat::named(format.0).is_some());
    }
    // Half of the formats in fixed point at least: another path is drawn for one that they refuse.
    prop_assume!(fixed >= 3);
    Ok(())
}

fn in_the_plane(path: &Path<2>, asked: (f64, u32)) -> Result<(), TestCaseError> {
    let formats: [(_, Option<Plain<2>>); 7] = [
        ("f64", Some(run::<f64, 2>)),
        ("f32", Some(run::<f32, 2>)),
        ("I3F29", Some(run::<I3F29, 2>)),
        ("I4F28", Some(run::<I4F28, 2>)),
        ("I8F24", Some(run::<I8F24, 2>)),
        ("I16F48", Some(run::<I16F48, 2>)),
        ("I4F60", Some(run::<I4F60, 2>)),
    ];
    in_formats(path, asked, formats)
}

/// In space one type of each kind is compiled: what another format does differs by constants, as in the plane.
fn in_space(path: &Path<3>, asked: (f64, u32)) -> Result<(), TestCaseError> {
    let formats: [(_, Option<Plain<3>>); 7] = [
        ("f64", Some(run::<f64, 3>)),
        ("f32", Some(run::<f32, 3>)),
        ("I3F29", None),
        ("I4F28", Some(run::<I4F28, 3>)),
        ("I8F24", None),
        ("I16F48", None),
        ("I4F60", Some(run::<I4F60, 3>)),
    ];
    in_formats(path, asked, formats)
}

proptest! {
    #![proptest_config(config(4))]

    #[test]
    fn runs_over_coincident_points_keep_their_promises(
        path in along(generate::curve_with_coincident_points::<2>()), fluctuation in 0.0..1e-6_f64, most in 1_u32..8,
    ) {
        in_the_plane(&path, (fluctuation, most))?;
    }

    #[test]
    fn plane_runs_keep_their_promises(path in path::<2>(), fluctuation in 0.0..1e-6_f64, most in 1_u32..8) {
        in_the_plane(&path, (fluctuation, most))?;
    }

    #[test]
    fn space_runs_keep_their_promises(path in path::<3>(), fluctuation in 0.0..1e-6_f64, most in 1_u32..8) {
        in_space(&path, (fluctuation, most))?;
    }
}
