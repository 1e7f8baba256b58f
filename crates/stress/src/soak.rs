//! A soak: runs path after path from a seed, each in many formats, until each format has made a given number of
//! periods.

use kernel_oracle::{PieceJudge, Violation};
use real::{
    Backend, Counted, I2F30, I3F29, I4F28, I4F60, I8F24, I16F16, I16F48, I32F32, RuntimeFixed, RuntimeFormat,
};
use serde::{Deserialize, Serialize};

use crate::piece_points::{compiled, judge};
use crate::violation::Outcome;
use crate::{OnPieces, PieceFigures, PlannedPath, RandomPath, SplitMix64};

/// Number of bytes from which a path is drawn.
const BYTES: usize = 1500;
/// Longest plan.
const MOST_PERIODS: u32 = 20_000;
/// Factors by which paths are slowed down, in turn. Fast runs cross many bends and joints; slow runs make many periods.
const SLOWER: [u32; 4] = [1, 16, 64, 256];

type Run = Result<Outcome<PieceFigures>, Violation>;

/// The checks in one format for paths of one dimension.
#[derive(Clone, Copy)]
struct InFormat<const D: usize> {
    /// Whether the path's pieces fit the format.
    fits: fn(&RandomPath<D>, Option<RuntimeFormat>) -> bool,
    run: fn(&PlannedPath<'_, D>, &PieceJudge<D>, Option<RuntimeFormat>) -> Run,
}

impl<const D: usize> InFormat<D> {
    const fn of<R: Backend>() -> Self {
        Self { fits: fit::<R, D>, run: run::<R, D> }
    }

    const AT_RUN_TIME: Self = Self { fits: fit_at_run_time, run: run_at_run_time };
}

/// A format that is soaked.
#[derive(Clone, Copy)]
pub struct SoakFormat {
    name: &'static str,
    plane: InFormat<2>,
    space: InFormat<3>,
}

impl SoakFormat {
    /// The format's name.
    #[must_use]
    pub fn name(&self) -> &'static str {
        self.name
    }

    const fn of<R: Backend>(name: &'static str) -> Self {
        Self { name, plane: InFormat::of::<R>(), space: InFormat::of::<R>() }
    }
}

/// The formats that can be soaked: the built-in ones, and one that is chosen at run time. They are a `static`, so that
/// they are compiled here once, and not in every program that soaks.
pub static SOAK_FORMATS: [SoakFormat; 11] = [
    SoakFormat::of::<f64>("f64"),
    SoakFormat::of::<f32>("f32"),
    SoakFormat::of::<I16F16>("I16F16"),
    SoakFormat::of::<I8F24>("I8F24"),
    SoakFormat::of::<I4F28>("I4F28"),
    SoakFormat::of::<I3F29>("I3F29"),
    SoakFormat::of::<I2F30>("I2F30"),
    SoakFormat::of::<I32F32>("I32F32"),
    SoakFormat::of::<I16F48>("I16F48"),
    SoakFormat::of::<I4F60>("I4F60"),
    SoakFormat { name: "I5F21", plane: InFormat::AT_RUN_TIME, space: InFormat::AT_RUN_TIME },
];

fn fit<R: Backend, const D: usize>(path: &RandomPath<D>, _: Option<RuntimeFormat>) -> bool {
    compiled::<R, D>(path, &[]).is_ok()
}

fn fit_at_run_time<const D: usize>(path: &RandomPath<D>, format: Option<RuntimeFormat>) -> bool {
    format.is_some_and(|format| format.run::<0, _>(|| fit::<RuntimeFixed<0>, D>(path, None)))
}

fn run<R: Backend, const D: usize>(
    planned: &PlannedPath<'_, D>,
    judge: &PieceJudge<D>,
    _: Option<RuntimeFormat>,
) -> Run {
    match OnPieces::<R, D>::new(planned) {
        Ok(run) => run.run_judged(judge),
        Err(refusal) => Ok(Outcome::Refused(refusal)),
    }
}

fn run_at_run_time<const D: usize>(
    planned: &PlannedPath<'_, D>,
    judge: &PieceJudge<D>,
    format: Option<RuntimeFormat>,
) -> Run {
    let Some(format) = format else { return Ok(Outcome::Refused("no such format".to_string())) };
    format.run::<0, _>(|| run::<RuntimeFixed<0>, D>(planned, judge, None))
}

/// The record of one format.
#[derive(Clone, Debug, Default, Serialize, Deserialize)]
pub struct Soaked {
    /// The format's name.
    pub format: String,
    /// Paths that were run to their end.
    pub paths: u64,
    /// Paths that are refused: degenerate, too long, or with pieces that do not fit the format.
    pub refused: u64,
    /// The worst of all runs, and their periods.
    pub worst: PieceFigures,
}

/// A violation and the path on which it came up.
#[derive(Clone, Debug, PartialEq, Eq, Serialize, Deserialize)]
pub struct SoakViolation {
    /// Number of the path. Seed and number determine the path.
    pub path: u64,
    /// The promise that was broken.
    pub what: String,
}

/// The paths of a soak, by number. A number always gives the same path.
#[derive(Clone, Copy, Debug, PartialEq, Eq, Serialize, Deserialize)]
pub struct SoakPaths {
    /// The seed of the generator.
    pub seed: u64,
    /// Whether no path is slowed down: faults in bends then appear in fewer periods.
    #[serde(default)]
    pub full_speed: bool,
}

impl SoakPaths {
    /// The path of this number, before it is slowed down. Every fifth path is in space, the others are in the plane.
    #[must_use]
    pub fn draw<const D: usize>(self, path: u64) -> Option<RandomPath<D>> {
        RandomPath::from_bytes(&bytes(self.seed, path))
    }
}

/// The state of a soak, which can be saved and continued.
#[derive(Clone, Debug, Serialize, Deserialize)]
pub struct Soak {
    /// The paths to run.
    #[serde(flatten)]
    pub paths: SoakPaths,
    /// Number of the next path.
    pub next_path: u64,
    /// The record of each format, in the order of [`SOAK_FORMATS`].
    pub formats: Vec<Soaked>,
    /// One path in sixteen is run again with the operations of each step counted.
    pub counted: PieceFigures,
    /// Number of broken promises.
    pub violations: u64,
    /// The first broken promises.
    pub first_violations: Vec<SoakViolation>,
}

/// Violations that are kept in full.
const MOST_KEPT: usize = 100;

impl Soak {
    /// The state before the first path.
    #[must_use]
    pub fn new(paths: SoakPaths, formats: &[SoakFormat]) -> Self {
        let soaked = |format: &SoakFormat| Soaked { format: format.name.to_string(), ..Soaked::default() };
        Self {
            paths,
            next_path: 0,
            formats: formats.iter().map(soaked).collect(),
            counted: PieceFigures::default(),
            violations: 0,
            first_violations: Vec::new(),
        }
    }

    /// Adds the results of the next path.
    pub fn add(&mut self, path: SoakedPath) {
        for (soaked, figures) in self.formats.iter_mut().zip(path.runs) {
            match figures {
                SoakedRun::Ran(figures) => {
                    soaked.paths += 1;
                    soaked.worst = soaked.worst.with(&figures);
                }
                SoakedRun::Refused => soaked.refused += 1,
                SoakedRun::Spared => {}
            }
        }
        if let Some(counted) = path.counted {
            self.counted = self.counted.with(&counted);
        }
        self.violations += path.violations.len() as u64;
        let room = MOST_KEPT.saturating_sub(self.first_violations.len());
        self.first_violations.extend(path.violations.into_iter().take(room));
        self.next_path += 1;
    }

    /// Whether format number `format` has made at least `periods` periods.
    #[must_use]
    pub fn has(&self, format: usize, periods: u64) -> bool {
        self.formats.get(format).is_some_and(|soaked| soaked.worst.periods >= periods)
    }

    /// Number of periods of the format that has made the fewest.
    #[must_use]
    pub fn least_periods(&self) -> u64 {
        self.formats.iter().map(|soaked| soaked.worst.periods).min().unwrap_or(0)
    }
}

/// The result of one path in one format.
#[derive(Clone, Copy, Debug, Default, PartialEq)]
pub enum SoakedRun {
    /// Not run, because the format has made its periods already.
    #[default]
    Spared,
    /// Refused, or a promise was broken.
    Refused,
    /// Run to its end.
    Ran(PieceFigures),
}

/// The results of one path.
#[derive(Clone, Debug, Default)]
pub struct SoakedPath {
    /// One entry per format, in the order given.
    pub runs: Vec<SoakedRun>,
    /// The result of a second run of the path in f64, with its operations counted.
    pub counted: Option<PieceFigures>,
    /// The promises that were broken.
    pub violations: Vec<SoakViolation>,
}

/// Runs path number `path` of `paths` in each of `formats`, except those that are `spared`. The promises of the plan
/// are checked too. Every fifth path is in space, and every other path passes its corners.
#[must_use]
pub fn soak_path(
    paths: SoakPaths,
    path: u64,
    formats: &[SoakFormat],
    spared: impl Fn(usize) -> bool,
) -> SoakedPath {
    let wanted = |format: usize| !spared(format);
    if path % 5 == 4 {
        soaked::<3>((paths, path), formats, wanted, |format| format.space)
    } else {
        soaked::<2>((paths, path), formats, wanted, |format| format.plane)
    }
}

fn soaked<const D: usize>(
    (paths, path): (SoakPaths, u64),
    formats: &[SoakFormat],
    wanted: impl Fn(usize) -> bool,
    in_dimension: impl Fn(&SoakFormat) -> InFormat<D>,
) -> SoakedPath {
    let refused = |format| if wanted(format) { SoakedRun::Refused } else { SoakedRun::Spared };
    let runs = (0..formats.len()).map(refused).collect();
    let mut soaked = SoakedPath { runs, ..SoakedPath::default() };
    let Some(drawn) = paths.draw::<D>(path) else { return soaked };
    let drawn = if path % 2 == 1 { drawn.passing_corners() } else { drawn };
    let drawn = if path % 4 >= 2 { drawn.fastest() } else { drawn };
    let named = formats.iter().map(|format| (in_dimension(format), RuntimeFormat::named(format.name)));
    let fitting: Vec<_> = named
        .enumerate()
        .filter(|(format, (doing, runtime))| wanted(*format) && (doing.fits)(&drawn, *runtime))
        .collect();
    if fitting.is_empty() {
        return soaked;
    }
    let Some(planned) = PlannedPath::new(&drawn, MOST_PERIODS) else { return soaked };
    let kind = usize::try_from(path % SLOWER.len() as u64).unwrap_or(0);
    let planned = if kind > 0 && !paths.full_speed { planned.slower(SLOWER[kind]) } else { planned };
    let mut broken = |violation: &Violation| {
        soaked.violations.push(SoakViolation { path, what: violation.to_string() });
    };
    if let Err(violation) = planned.check() {
        broken(&violation);
    }
    let Ok(judge) = judge(&planned) else { return soaked };
    for (format, (doing, runtime)) in fitting {
        match (doing.run)(&planned, &judge, runtime) {
            Ok(Outcome::Ran(figures)) => soaked.runs[format] = SoakedRun::Ran(figures),
            Ok(Outcome::Refused(_)) => {}
            Err(violation) => broken(&violation),
        }
    }
    if path.is_multiple_of(16)
        && let Ok(run) = OnPieces::<Counted<f64>, D>::new(&planned)
    {
        match run.count() {
            Ok(Outcome::Ran(figures)) => soaked.counted = Some(figures),
            Ok(Outcome::Refused(_)) => {}
            Err(violation) => broken(&violation),
        }
    }
    soaked
}

/// The bytes of a path, seeded with both numbers.
fn bytes(seed: u64, path: u64) -> Vec<u8> {
    let words = SplitMix64::new(seed ^ path.wrapping_mul(0xd134_2543_de82_ef95));
    words.take(BYTES.div_ceil(8)).flat_map(u64::to_le_bytes).collect()
}
