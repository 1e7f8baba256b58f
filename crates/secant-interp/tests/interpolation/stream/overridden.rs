//! Feed override on a stream is that on the whole path, and goes on from section to section.

use proptest::prelude::*;
use real::{FromWord, I4F28, I8F24, I16F48};
use secant_interp::{FeedOverride, OverrideState, PieceInterpolator, Rate};

use super::streamed::{compiled, file_of, read};

/// An operator: each target holds for some periods, and the last rate to the end.
struct Operator {
    feeds: FeedOverride,
    rates: OverrideState,
    targets: Vec<(u32, f64)>,
    period: u32,
}

impl Operator {
    fn new(feeds: FeedOverride, targets: &[(u32, f64)]) -> Self {
        Self { feeds, rates: OverrideState::at(Rate::FULL), targets: targets.to_vec(), period: 0 }
    }

    /// The positions of a run, and the rate of each period.
    fn run<R: FromWord, const D: usize>(
        &mut self,
        run: &PieceInterpolator<'_, R, D>,
    ) -> Vec<([i64; D], Rate)> {
        let (mut state, mut found) = (run.start(), Vec::new());
        loop {
            if let Some((_, rate)) = self.targets.iter().find(|(from, _)| *from == self.period) {
                self.rates.set(Rate::of(*rate));
            }
            self.period += 1;
            let Some(setpoint) = run.step_overridden(&mut state, &self.feeds, &mut self.rates) else {
                return found;
            };
            found.push((run.pieces.position(setpoint.piece, &setpoint.offset), self.rates.rate()));
            assert!(found.len() < 100_000, "the run does not end");
        }
    }
}

fn is_the_same<R: FromWord, const D: usize>(targets: &[(u32, f64)]) {
    let (path, feeds) = compiled::<R, D>(true);
    let mut operator = Operator::new(feeds, targets);
    let expected: Vec<_> = path.runs().map(|run| operator.run(&run)).collect();
    let (mut operator, mut found) = (Operator::new(feeds, targets), Vec::new());
    let (_, end) = read::<R, D>(&file_of(&path, 0), |run| found.push(operator.run(run)));
    assert!(end == Ok(()) && expected == found, "{} in {D}: {targets:?}", R::name());
}

proptest! {
    #![proptest_config(ProptestConfig::with_cases(16))]
    #[test]
    fn whatever_is_asked_for_the_run_is_the_same(
        targets in prop::collection::vec((0..400_u32, prop_oneof![Just(0.0), Just(1.0), 0.05..1.0_f64]), 0..5), last in 0.1..1.0_f64,
    ) {
        let targets = [&targets[..], &[(500, last)]].concat();
        is_the_same::<f64, 2>(&targets);
        is_the_same::<f32, 3>(&targets);
        is_the_same::<I4F28, 3>(&targets);
        is_the_same::<I8F24, 2>(&targets);
        is_the_same::<I16F48, 2>(&targets);
    }
}
