//! A path as a core in any format, and the run of the kernels.

use c_code::{CName, CPart, ExpectedRun};
use feed_plan::Schedule;
use hardware::{CoreError, CoreFiles, CoreRequest};
use nurbs_core::{PieceLimits, compile_with_stops};
use real::{Backend, DoubleDouble, FormatName, RuntimeFixed, RuntimeFormat, word_of};
use secant_interp::{ChordTolerance, CompiledPath, PositionChecksum};
use stress::{PlannedPath, RandomPath};

/// Periods of a run, at most.
const MOST_PERIODS: u32 = 9000;

/// A core and its run in Rust: for each setpoint the words by the names of the core's outputs.
pub(crate) struct Judged {
    pub(crate) core: Result<CoreFiles, CoreError>,
    pub(crate) expected: Vec<Vec<(String, u64)>>,
}

/// The path in the format of this name; `None` if it cannot hold the path.
pub(crate) fn core_of<const D: usize>(path: &RandomPath<D>, format: &str) -> Option<Judged> {
    let plan = PlannedPath::new(path, MOST_PERIODS)?;
    let named = RuntimeFormat::named(format).expect("a fixed-point format");
    named.run::<0, _>(|| judged::<D>(&plan))
}

fn judged<const D: usize>(plan: &PlannedPath<'_, D>) -> Option<Judged> {
    type R = RuntimeFixed<0>;
    let path = plan.path;
    let curves: Vec<_> = path.curves.iter().map(nurbs_core::NurbsBuf::as_curve).collect();
    let step_mm = path.limits.feedrate + plan.landing_step();
    let limits = PieceLimits { length_mm: path.piece_mm, step_mm };
    let table = compile_with_stops::<DoubleDouble, R, D>(&curves, &limits, &plan.stops()).ok()?;
    let tolerance = ChordTolerance::for_fluctuation(None, path.max_evaluations);
    let stages = plan.stages();
    let schedule = Schedule::new(&stages, 1.0, plan.periods());
    let compiled = CompiledPath::new(table, &schedule, tolerance, plan.landing_step()).ok()?;
    let (mut expected, mut checksum) = (Vec::new(), PositionChecksum::default());
    for (run, section) in compiled.runs().zip(compiled.sections()) {
        let mut state = run.start();
        while let Some(setpoint) = run.step(&mut state) {
            checksum.add(run.pieces.position(setpoint.piece, &setpoint.offset));
            // At the end of a section the kernel names the piece behind it, the core the last one.
            let piece = (section.pieces.start + setpoint.piece).min(section.pieces.end - 1);
            let offsets = ["offset_x", "offset_y", "offset_z"].into_iter().zip(setpoint.offset);
            let mut words = vec![
                ("piece", piece as u64),
                ("phase", setpoint.phase),
                ("length", word_of(setpoint.length)),
                ("evaluations", setpoint.evaluations.into()),
            ];
            words.extend(offsets.map(|(name, offset)| (name, word_of(offset))));
            expected.push(words.into_iter().map(|(name, word)| (name.to_owned(), word)).collect());
            assert!(expected.len() <= 4 * MOST_PERIODS as usize, "the run ends");
        }
    }
    let run = ExpectedRun { periods: expected.len(), checksum: checksum.value() };
    let name = CName::try_new("part").expect("a name");
    let part = CPart {
        name,
        about: String::new(),
        fault: None,
        path: &compiled,
        period_s: 0.001,
        run,
        feed_override: None,
    };
    let files = part.description().expect("a description");
    let FormatName::Fixed { fraction_bits, .. } = R::name() else { return None };
    let request = CoreRequest {
        header: &files.header,
        source: &files.source,
        name: "part",
        about: "a test",
        bits: R::name().bits(),
        fraction_bits,
        periods: run.periods,
        checksum: run.checksum,
    };
    Some(Judged { core: hardware::compile(&request), expected })
}
