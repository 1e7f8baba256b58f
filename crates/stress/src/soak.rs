//! A soak: path after path from a seed, each run in many formats, until each has made so many periods.

use real::{
    Backend, Counted, I2F30, I3F29, I4F28, I4F60, I8F24, I16F16, I16F48, I32F32, RuntimeFixed, RuntimeFormat,
};
use serde::{Deserialize, Serialize};

use crate::piece_points::Judge;
use crate::violation::{Outcome, Violation};
use crate::{OnPieces, PieceFigures, Planned, RandomPath};

/// Bytes a path is drawn from.
const BYTES: usize = 1500;
/// Longest plan.
const MOST_PERIODS: u32 = 100_000;
/// By how much three of four paths are slowed down, for a run of many periods; the fourth crosses many joints.
const SLOWER: f64 = 24.0;

type Run = fn(&Planned<'_, 2>, &Judge<2>, Option<RuntimeFormat>) -> Result<Outcome<PieceFigures>, Violation>;

/// A format that is soaked.
#[derive(Clone, Copy)]
pub struct SoakFormat {
    name: &'static str,
    run: Run,
}

impl SoakFormat {
    /// The format's name.
    #[must_use]
    pub fn name(&self) -> &'static str {
        self.name
    }
}

/// The formats that can be soaked: the built-in ones, and one that is chosen at run time.
pub const SOAK_FORMATS: [SoakFormat; 11] = [
    SoakFormat { name: "f64", run: in_format::<f64> },
    SoakFormat { name: "f32", run: in_format::<f32> },
    SoakFormat { name: "I16F16", run: in_format::<I16F16> },
    SoakFormat { name: "I8F24", run: in_format::<I8F24> },
    SoakFormat { name: "I4F28", run: in_format::<I4F28> },
    SoakFormat { name: "I3F29", run: in_format::<I3F29> },
    SoakFormat { name: "I2F30", run: in_format::<I2F30> },
    SoakFormat { name: "I32F32", run: in_format::<I32F32> },
    SoakFormat { name: "I16F48", run: in_format::<I16F48> },
    SoakFormat { name: "I4F60", run: in_format::<I4F60> },
    SoakFormat { name: "I5F21", run: at_run_time },
];

fn in_format<R: Backend>(
    planned: &Planned<'_, 2>,
    judge: &Judge<2>,
    _: Option<RuntimeFormat>,
) -> Result<Outcome<PieceFigures>, Violation> {
    match OnPieces::<R, 2>::new(planned) {
        Ok(run) => run.run_judged(judge),
        Err(refusal) => Ok(Outcome::Refused(refusal)),
    }
}

fn at_run_time(
    planned: &Planned<'_, 2>,
    judge: &Judge<2>,
    format: Option<RuntimeFormat>,
) -> Result<Outcome<PieceFigures>, Violation> {
    let Some(format) = format else { return Ok(Outcome::Refused("no such format".to_string())) };
    format.run::<0, _>(|| in_format::<RuntimeFixed<0>>(planned, judge, None))
}

/// What a format has gone through.
#[derive(Clone, Debug, Default, Serialize, Deserialize)]
pub struct Soaked {
    /// Paths that were run to their end.
    pub paths: u64,
    /// Paths whose pieces do not fit the format.
    pub refused: u64,
    /// The worst of all runs, and their periods.
    pub worst: PieceFigures,
}

/// A violation and the path on which it came up.
#[derive(Clone, Debug, Serialize, Deserialize)]
pub struct SoakViolation {
    /// Number of the path; with the seed it says everything.
    pub path: u64,
    /// What was broken.
    pub what: String,
}

/// What came of one path.
#[derive(Clone, Debug, Default)]
pub struct SoakedPath {
    /// A row a format, in the order given; `None` where it was refused.
    pub runs: Vec<Option<PieceFigures>>,
    /// The same path in f64 with its operations counted.
    pub counted: Option<PieceFigures>,
    /// What was broken.
    pub violations: Vec<SoakViolation>,
}

/// Runs path number `path` of `seed` in each of `formats`, by a plan whose own promises are checked too.
#[must_use]
pub fn soak_path(seed: u64, path: u64, formats: &[SoakFormat]) -> SoakedPath {
    let mut soaked = SoakedPath { runs: vec![None; formats.len()], ..SoakedPath::default() };
    let Some(mut drawn) = RandomPath::<2>::from_bytes(&bytes(seed, path)) else { return soaked };
    if !path.is_multiple_of(4) {
        drawn.slow_down(SLOWER);
    }
    let Some(planned) = Planned::new(&drawn, MOST_PERIODS) else { return soaked };
    let mut broken = |violation: &Violation| {
        soaked.violations.push(SoakViolation { path, what: violation.to_string() });
    };
    if let Err(violation) = planned.check() {
        broken(&violation);
    }
    let Ok(judge) = Judge::new(&planned) else { return soaked };
    for (format, slot) in formats.iter().zip(&mut soaked.runs) {
        match (format.run)(&planned, &judge, RuntimeFormat::named(format.name)) {
            Ok(Outcome::Ran(figures)) => *slot = Some(figures),
            Ok(Outcome::Refused(_)) => {}
            Err(violation) => broken(&violation),
        }
    }
    if path.is_multiple_of(16)
        && let Ok(run) = OnPieces::<Counted<f64>, 2>::new(&planned)
    {
        match run.count() {
            Ok(Outcome::Ran(figures)) => soaked.counted = Some(figures),
            Ok(Outcome::Refused(_)) => {}
            Err(violation) => broken(&violation),
        }
    }
    soaked
}

/// The bytes of a path: SplitMix64 (Steele, Lea, Flood, 2014), seeded with both numbers.
fn bytes(seed: u64, path: u64) -> Vec<u8> {
    let mut state = seed ^ path.wrapping_mul(0xd134_2543_de82_ef95);
    let words = (0..BYTES.div_ceil(8)).flat_map(|_| {
        state = state.wrapping_add(0x9e37_79b9_7f4a_7c15);
        let mixed = (state ^ (state >> 30)).wrapping_mul(0xbf58_476d_1ce4_e5b9);
        let mixed = (mixed ^ (mixed >> 27)).wrapping_mul(0x94d0_49bb_1331_11eb);
        (mixed ^ (mixed >> 31)).to_le_bytes()
    });
    words.collect()
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn a_path_is_the_same_each_time_and_runs_in_several_formats() {
        let formats = [SOAK_FORMATS[0], SOAK_FORMATS[3], SOAK_FORMATS[10]];
        let (one, again) = (soak_path(7, 4, &formats), soak_path(7, 4, &formats));
        assert_eq!(one.runs, again.runs);
        let periods: Vec<_> =
            (0..6).filter_map(|path| soak_path(7, path, &formats).runs[0]).map(|f| f.periods).collect();
        assert!(periods.iter().sum::<u64>() > 1000, "{periods:?}");
    }
}
