//! Random paths on compiled pieces, in every kind of format and under audit.

use crate::path_run::{Path, Settings, run};
use nurbs_core::{CompileError, NurbsBuf, generate};
use proptest::prelude::*;
use real::{Audit, Audited, Backend, FormatName, I3F29, I4F28, I4F60, I8F24, I16F48, Real};

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

/// Runs once plainly and once under audit: to the end, forward, the same, and in fixed point within the proven bounds. A format
/// that does not fit is refused before.
fn keeps_its_promises<R: Backend, const D: usize>(
    path: &Path<D>,
    settings: &Settings,
) -> Result<(), TestCaseError> {
    let (outcome, audit) = Audit::of(|| run::<Audited<R>, D>(path, settings));
    let watched = match outcome {
        Ok(figures) => figures,
        Err(CompileError::DoesNotFit { .. }) if matches!(R::name(), FormatName::Fixed { .. }) => {
            return Ok(());
        }
        Err(error) => return Err(TestCaseError::fail(error.to_string())),
    };
    let plain = run::<R, D>(path, settings).unwrap();
    prop_assert_eq!(plain.checksum, watched.checksum);
    prop_assert_eq!((audit.overflows, audit.divisions_by_zero), (0, 0), "{}", R::name());
    // A float holds whatever a wrong guess comes to, and does not ask whether it is in range.
    for (name, range) in audit.signals.iter().filter(|_| !R::IS_FLOATING) {
        let Some(proven) = watched.bounds.iter().find(|bound| bound.signal == *name) else {
            return Err(TestCaseError::fail(format!("{}: no bound for {name}", R::name())));
        };
        // The bounds are computed in f64, and each signal is rounded once more in its format.
        let slack = 64.0 * f64::EPSILON.max(R::resolution().to_f64());
        let largest = range.max.max(-range.min);
        let bound = proven.bound * (1.0 + slack);
        prop_assert!(largest <= bound, "{} {name}: {largest} > {bound}", R::name());
    }
    Ok(())
}

fn in_every_format<const D: usize>(
    path: &Path<D>,
    fluctuation: f64,
    max_evaluations: u32,
) -> Result<(), TestCaseError> {
    let settings = Settings { fluctuation, max_evaluations, ..Settings::default() };
    keeps_its_promises::<f64, D>(path, &settings)?;
    keeps_its_promises::<f32, D>(path, &settings)?;
    keeps_its_promises::<I3F29, D>(path, &settings)?;
    keeps_its_promises::<I4F28, D>(path, &settings)?;
    keeps_its_promises::<I8F24, D>(path, &settings)?;
    keeps_its_promises::<I16F48, D>(path, &settings)?;
    keeps_its_promises::<I4F60, D>(path, &settings)?;
    Ok(())
}

proptest! {
    #![proptest_config(config(4))]

    #[test]
    fn runs_over_coincident_points_keep_their_promises(
        path in along(generate::curve_with_coincident_points::<2>()), fluctuation in 0.0..1e-6_f64, most in 1_u32..8,
    ) {
        in_every_format(&path, fluctuation, most)?;
    }

    #[test]
    fn plane_runs_keep_their_promises(path in path::<2>(), fluctuation in 0.0..1e-6_f64, most in 1_u32..8) {
        in_every_format(&path, fluctuation, most)?;
    }

    #[test]
    fn space_runs_keep_their_promises(path in path::<3>(), fluctuation in 0.0..1e-6_f64, most in 1_u32..8) {
        in_every_format(&path, fluctuation, most)?;
    }
}
