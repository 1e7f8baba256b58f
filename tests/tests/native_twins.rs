//! The fixed-point formats that `compare` lists, as it runs most of them, chosen at run time, against the types of their own that
//! a controller has: raw word by raw word.

use feedbits_tests::{
    PAPER_A, PAPER_D, circle, closed, corner, cusp, degree_5, double_knot, line, on_paper_as_machine, problem,
};
use format_compare::{ExactPlan, Options, Problem, formats};
use nurbs_core::{CompileError, NurbsBuf, PieceLimits, compile};
use real::{
    Backend, DoubleDouble, FormatName, I2F30, I3F29, I4F28, I4F60, I8F24, I16F16, I16F48, I32F32,
    RuntimeFixed, RuntimeFormat, word_of,
};
use secant_interp::{ChordTolerance, CompiledPath};

/// A setpoint: piece and phase, evaluations, and the words of its numbers.
#[derive(Debug, PartialEq)]
struct Words<const D: usize> {
    place: (usize, u64),
    evaluations: u32,
    length: u64,
    offset: [u64; D],
}

/// The setpoints of a path in `R`, by its plan in f64.
fn words<R: Backend, const D: usize>(
    problem: &Problem<D>,
    plan: &ExactPlan,
) -> Result<Vec<Words<D>>, CompileError> {
    let limits = problem.limits_per_period().expect("the machine's are valid");
    let curves: Vec<_> = problem.curves.iter().map(NurbsBuf::as_curve).collect();
    let step_mm = limits.feedrate + limits.acceleration;
    let table = compile::<DoubleDouble, R, D>(&curves, &PieceLimits { length_mm: 32.0, step_mm })?;
    let tolerance = ChordTolerance::for_fluctuation(Options::default().fluctuation, 8);
    let path = CompiledPath::new(table, &plan.schedule(), tolerance, limits.acceleration)
        .expect("the plan keeps the machine's limits");
    let mut setpoints = Vec::new();
    for run in path.runs() {
        let mut state = run.start();
        while let Some(setpoint) = run.step(&mut state) {
            setpoints.push(Words {
                place: (setpoint.piece, setpoint.phase),
                evaluations: setpoint.evaluations,
                length: word_of(setpoint.length),
                offset: setpoint.offset.map(word_of),
            });
            assert!(setpoints.len() < 100_000, "{} does not end", R::name());
        }
    }
    Ok(setpoints)
}

/// Compares the setpoints of one format; returns how many there are, 0 where the path does not fit the format.
fn compared<R: Backend, const D: usize>(problem: &Problem<D>, plan: &ExactPlan) -> usize {
    let format = RuntimeFormat::of(R::name()).expect("a fixed-point format");
    let at_run_time = format.run::<0, _>(|| words::<RuntimeFixed<0>, D>(problem, plan));
    match (words::<R, D>(problem, plan), at_run_time) {
        (Ok(native), Ok(at_run_time)) => {
            for (period, (own, other)) in native.iter().zip(&at_run_time).enumerate() {
                assert_eq!(own, other, "{} of {}, period {period}", R::name(), problem.name);
            }
            assert_eq!(native.len(), at_run_time.len(), "{} of {}", R::name(), problem.name);
            native.len()
        }
        (Err(native), Err(at_run_time)) => {
            assert_eq!(native.to_string(), at_run_time.to_string(), "{} of {}", R::name(), problem.name);
            0
        }
        (native, at_run_time) => panic!("{} of {}: {native:?}, {at_run_time:?}", R::name(), problem.name),
    }
}

/// The setpoints that were compared in each format, by its name.
fn in_every_format<const D: usize>(problem: &Problem<D>) -> [(FormatName, usize); 8] {
    let plan = ExactPlan::in_format::<f64, D>(problem, [0.0; 2]).expect("it can be planned");
    macro_rules! each {
        ($($format:ty),*) => { [$((<$format>::name(), compared::<$format, D>(problem, &plan))),*] };
    }
    each![I16F16, I8F24, I4F28, I3F29, I2F30, I32F32, I16F48, I4F60]
}

#[test]
fn formats_at_run_time_give_the_words_of_their_own_types() {
    let plane = [circle(), double_knot(), closed(), cusp(), corner(), line()]
        .map(|curve| on_paper_as_machine("a plane curve", curve));
    let mut runs: Vec<_> = plane.iter().map(in_every_format).collect();
    runs.push(in_every_format(&problem::<2>("paper A", PAPER_A)));
    runs.push(in_every_format(&problem::<3>("paper D", PAPER_D)));
    runs.push(in_every_format(&on_paper_as_machine("a space curve", degree_5())));
    let fixed = formats::<3>().into_iter().map(|format| format.name());
    let fixed: Vec<_> = fixed.filter(|name| matches!(name, FormatName::Fixed { .. })).collect();
    for (at, name) in fixed.iter().enumerate() {
        let setpoints: usize = runs.iter().map(|run| run[at].1).sum();
        assert_eq!(runs[0][at].0, *name, "every fixed-point format that is compared is one of these");
        assert!(setpoints > 1000, "{name}: {setpoints} setpoints were compared");
    }
}
