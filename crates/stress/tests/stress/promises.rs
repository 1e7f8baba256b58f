//! Random paths from random bytes keep every promise.

use std::cell::{Cell, RefCell};
use std::collections::BTreeMap;

use proptest::collection::vec;
use proptest::prelude::*;
use proptest::test_runner::TestRunner;
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

/// The promises that are counted.
const PROMISES: usize = 13;

/// How often each promise was really asked: a format may refuse a path.
#[derive(Default)]
struct Asked(BTreeMap<String, u32>);

impl Asked {
    fn count<F>(&mut self, what: String, outcome: &Outcome<F>) {
        *self.0.entry(what).or_default() += u32::from(matches!(outcome, Outcome::Ran(_)));
    }

    fn on_pieces<R: Backend, const D: usize>(
        &mut self,
        planned: &PlannedPath<'_, D>,
    ) -> Result<(), Violation> {
        let outcome = match OnPieces::<R, D>::new(planned) {
            Ok(run) => run.run()?,
            Err(refusal) => Outcome::Refused(refusal),
        };
        self.count(format!("pieces {}", R::name()), &outcome);
        Ok(())
    }

    fn on_curve<R: Backend, const D: usize>(
        &mut self,
        planned: &PlannedPath<'_, D>,
    ) -> Result<(), Violation> {
        for method in [Method::Secant, Method::Taylor1, Method::Taylor2] {
            let outcome = match OnCurve::<R, D>::new(planned) {
                Ok(run) => run.run(method)?,
                Err(refusal) => Outcome::Refused(refusal.to_string()),
            };
            self.count(format!("curve {}", R::name()), &outcome);
        }
        Ok(())
    }

    /// Whether each promise was asked as often as this.
    fn each_was(&self, asked: u32) -> bool {
        self.0.len() == PROMISES && self.0.values().all(|ran| *ran >= asked)
    }

    /// Every promise along a path that can be planned; `None` for bytes of another one.
    fn everything<const D: usize>(&mut self, bytes: &[u8]) -> Result<Option<()>, Violation> {
        let Some(path) = RandomPath::<D>::from_bytes(bytes) else { return Ok(None) };
        let path = if bytes.len() % 2 == 1 { path.passing_corners() } else { path };
        let path = if bytes.len() % 4 >= 2 { path.fastest() } else { path };
        self.count("points f64".into(), &check_pieces::<f64, D>(&path, 5)?);
        self.count("points I4F28".into(), &check_pieces::<I4F28, D>(&path, 5)?);
        let Some(planned) = PlannedPath::new(&path, MOST_PERIODS) else { return Ok(None) };
        planned.check()?;
        self.on_pieces::<f64, D>(&planned)?;
        self.on_pieces::<f32, D>(&planned)?;
        self.on_pieces::<I4F28, D>(&planned)?;
        self.on_pieces::<I16F48, D>(&planned)?;
        self.on_curve::<f64, D>(&planned)?;
        self.on_curve::<I16F16, D>(&planned)?;
        self.on_curve::<I32F32, D>(&planned)?;
        self.count("beside f64: I8F24".into(), &check_against_float::<I8F24, D>(&planned)?);
        self.count("beside f64: f32".into(), &check_against_float::<f32, D>(&planned)?);
        self.count("beside f64: I16F48".into(), &check_against_float::<I16F48, D>(&planned)?);
        if let Ok(counted) = OnPieces::<Counted<f64>, D>::new(&planned) {
            let counted: Outcome<_> = counted.count()?;
            assert!(matches!(counted, Outcome::Ran(_)));
            self.count("operations".into(), &counted);
        }
        Ok(Some(()))
    }
}

/// Draws until so many paths were planned and each promise was asked twice, up to ten times as many: the narrowest
/// format refuses most paths in space.
fn keeps_every_promise<const D: usize>(cases: u32) {
    let least = config(cases).cases;
    let (asked, planned) = (RefCell::new(Asked::default()), Cell::new(0));
    let is_enough = || planned.get() >= least && asked.borrow().each_was(2);
    let most = ProptestConfig { cases: 10 * least, ..config(cases) };
    let ran = TestRunner::new(most).run(&vec(any::<u8>(), 200..1500), |bytes| {
        if is_enough() {
            return Ok(());
        }
        let outcome = asked.borrow_mut().everything::<D>(&bytes);
        match outcome {
            Ok(Some(())) => planned.set(planned.get() + 1),
            Ok(None) => return Err(TestCaseError::reject("no path, or one that takes too long")),
            Err(violation) => return Err(TestCaseError::fail(violation.to_string())),
        }
        Ok(())
    });
    ran.unwrap_or_else(|failure| panic!("{failure}"));
    assert!(is_enough(), "a promise is hardly ever asked: {:?}", asked.borrow().0);
}

#[test]
fn plane_paths_keep_every_promise() {
    keeps_every_promise::<2>(6);
}

#[test]
fn space_paths_keep_every_promise() {
    keeps_every_promise::<3>(6);
}
