//! Random paths from random bytes keep every promise.

use proptest::collection::vec;
use proptest::prelude::*;
use real::{Backend, Counted, I4F28, I8F24, I16F16, I16F48, I32F32};
use secant_interp::Method;
use stress::{
    OnCurve, OnPieces, Outcome, PlannedPath, RandomPath, Violation, check_against_float, check_pieces,
};

/// `cases` unless the environment asks for a long run.
fn config(cases: u32) -> ProptestConfig {
    let cases = std::env::var("PROPTEST_CASES").ok().and_then(|n| n.parse().ok()).unwrap_or(cases);
    ProptestConfig { cases, failure_persistence: None, ..ProptestConfig::default() }
}

const MOST_PERIODS: u32 = 2_000;

fn on_pieces<R: Backend, const D: usize>(planned: &PlannedPath<'_, D>) -> Result<(), Violation> {
    if let Ok(run) = OnPieces::<R, D>::new(planned) {
        run.run()?;
    }
    Ok(())
}

fn on_curve<R: Backend, const D: usize>(planned: &PlannedPath<'_, D>) -> Result<(), Violation> {
    if let Ok(run) = OnCurve::<R, D>::new(planned) {
        for method in [Method::Secant, Method::Taylor1, Method::Taylor2] {
            run.run(method)?;
        }
    }
    Ok(())
}

fn keeps_every_promise<const D: usize>(bytes: &[u8]) -> Result<(), Violation> {
    let Some(path) = RandomPath::<D>::from_bytes(bytes) else { return Ok(()) };
    let path = if bytes.len() % 2 == 1 { path.passing_corners() } else { path };
    let path = if bytes.len() % 4 >= 2 { path.fastest() } else { path };
    check_pieces::<f64, D>(&path, 5)?;
    check_pieces::<I4F28, D>(&path, 5)?;
    let Some(planned) = PlannedPath::new(&path, MOST_PERIODS) else { return Ok(()) };
    planned.check()?;
    on_pieces::<f64, D>(&planned)?;
    on_pieces::<f32, D>(&planned)?;
    on_pieces::<I4F28, D>(&planned)?;
    on_pieces::<I16F48, D>(&planned)?;
    on_curve::<f64, D>(&planned)?;
    on_curve::<I16F16, D>(&planned)?;
    on_curve::<I32F32, D>(&planned)?;
    check_against_float::<I8F24, D>(&planned)?;
    check_against_float::<f32, D>(&planned)?;
    check_against_float::<I16F48, D>(&planned)?;
    if let Ok(counted) = OnPieces::<Counted<f64>, D>::new(&planned) {
        let counted: Outcome<_> = counted.count()?;
        assert!(matches!(counted, Outcome::Ran(_)));
    }
    Ok(())
}

proptest! {
    #![proptest_config(config(6))]

    #[test]
    fn plane_paths_keep_every_promise(bytes in vec(any::<u8>(), 200..1500)) {
        if let Err(violation) = keeps_every_promise::<2>(&bytes) {
            return Err(TestCaseError::fail(violation.to_string()));
        }
    }

    #[test]
    fn space_paths_keep_every_promise(bytes in vec(any::<u8>(), 200..1500)) {
        if let Err(violation) = keeps_every_promise::<3>(&bytes) {
            return Err(TestCaseError::fail(violation.to_string()));
        }
    }
}
