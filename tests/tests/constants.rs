//! What `feedbits compile` writes is Rust, and a controller that includes it makes the run that was judged.
//! `UPDATE_EXPECT=1 cargo test -p feedbits-tests --test across_crates constants` writes what is written now, without the checksum: a file then changes
//! with the tables, and not with a rounding of a step.

use expect_test::expect_file;
use feedbits_tests::problem;
use format_compare::{Constants, Dimension, Options, Problem, ProfileKind, Refusal, Space, plan_for, select};
use nurbs_core::ORIGIN_EXPONENT;
use real::Real;
use secant_interp::{PieceInterpolator, PositionChecksum, Section};

#[allow(unreachable_pub, reason = "it is written for any program")]
mod stairs_i4f28 {
    include!("constants/stairs_i4f28.rs");
}
#[allow(unreachable_pub, reason = "it is written for any program")]
mod arcs_f32 {
    include!("constants/arcs_f32.rs");
}
#[allow(unreachable_pub, reason = "it is written for any program")]
mod arcs_i16f48 {
    include!("constants/arcs_i16f48.rs");
}
#[allow(unreachable_pub, reason = "it is written for any program")]
mod arcs_i5f27 {
    include!("constants/arcs_i5f27.rs");
}

#[allow(unreachable_pub, reason = "it is written for any program")]
mod holes_f64 {
    include!("constants/holes_f64.rs");
}
#[allow(unreachable_pub, reason = "it is written for any program")]
mod tiny_i28f36 {
    include!("constants/tiny_i28f36.rs");
}

/// Two corners that are stopped at, and a slant.
const STAIRS: &str = "G0 X0 Y0 Z0\nG1 X6 F6000\nY6\nX12 Y10\n";
/// Rational curves in space, with a corner between them.
const ARCS: &str = "G0 X0 Y0 Z0\nG1 Z1 F3000\nG3 X4 Y4 I0 J4\nG19 G2 Y8 Z5 J4 K0\n";

/// Two holes and a line straight on from them but for the rapid moves between.
const HOLES: &str = "G0 X1 Y2 Z3\nG1 Z-1 F3000\nG0 Z3\nX5\nG1 Z-1\nG0 Z3\nY-4\nG1 X9\n";
/// So short that coordinates are in units below those of positions.
const TINY: &str = "G0 X0 Y0 Z0\nG1 X0.000005 F3000\nY0.000003\n";

fn constants<const D: usize>(problem: &Problem<D>, format: &str) -> Result<Constants, Refusal>
where
    Space: Dimension<D>,
{
    let format = select::<D>(&[format.to_string()]).expect("a format").remove(0);
    // The plan of one of them has another shape of stages.
    let is_other = format.name().to_string() == "I5F27";
    let profile = if is_other { ProfileKind::Trigonometric } else { ProfileKind::default() };
    let options = Options { profile, ..Options::default() };
    let plan = plan_for(problem, format.as_ref(), &options).expect("a plan");
    format.constants(problem, &plan, &options)
}

/// The setpoints that a controller makes of the runs, their checksum, and where the last one is, in mm.
fn made<R: Real, const D: usize>(
    path: &PieceInterpolator<'_, R, D>,
    sections: &[Section],
) -> (usize, u64, [f64; D]) {
    let (mut periods, mut checksum, mut last) = (0, PositionChecksum::default(), [0; D]);
    for run in sections.iter().map(|section| path.on(section)) {
        let mut state = run.start();
        while let Some(setpoint) = run.step(&mut state) {
            last = run.pieces.position(setpoint.piece, &setpoint.offset);
            checksum.add(last);
            periods += 1;
        }
    }
    (periods, checksum.value(), in_mm(last))
}

fn in_mm<const D: usize>(position: [i64; D]) -> [f64; D] {
    position.map(|units| units as f64 * 2.0_f64.powi(ORIGIN_EXPONENT))
}

/// The modules as they are written now, in the order of the files.
fn written() -> [Constants; 6] {
    let (stairs, arcs) = (problem::<2>("stairs.nc", STAIRS), problem::<3>("arcs.nc", ARCS));
    [
        constants(&stairs, "I4F28"),
        constants(&arcs, "f32"),
        constants(&arcs, "I16F48"),
        constants(&arcs, "I5F27"),
        constants(&problem::<3>("holes.nc", HOLES), "f64"),
        constants(&problem::<2>("tiny.nc", TINY), "I28F36"),
    ]
    .map(|written| written.expect("the part fits the format"))
}

/// A module without its constant `CHECKSUM`.
fn without_checksum(source: &str) -> String {
    let (before, rest) =
        source.split_once("/// `secant_interp::PositionChecksum` of all").expect("a checksum");
    let (item, after) = rest.split_once("\n\n").expect("an item and others below it");
    assert!(item.contains("pub const CHECKSUM: u64 = 0x"), "{item}");
    before.to_owned() + after
}

#[test]
fn what_is_written_is_what_was_compiled_into_this_test() {
    let files = [
        expect_file!["constants/stairs_i4f28.rs"],
        expect_file!["constants/arcs_f32.rs"],
        expect_file!["constants/arcs_i16f48.rs"],
        expect_file!["constants/arcs_i5f27.rs"],
        expect_file!["constants/holes_f64.rs"],
        expect_file!["constants/tiny_i28f36.rs"],
    ];
    for (written, file) in written().iter().zip(files) {
        file.assert_eq(&without_checksum(&written.source));
    }
}

/// The run of a module is the one that was judged, and ends where the part does.
macro_rules! holds {
    ($module:ident, $written:expr, $end:expr) => {
        let (periods, checksum, last) = made(&$module::PATH, &$module::SECTIONS);
        assert_eq!((periods, checksum), ($written.periods, $written.checksum));
        assert!($written.source.contains(&format!("CHECKSUM: u64 = {checksum:#018x};")));
        assert!(last.iter().zip($end).all(|(found, expected)| (found - expected).abs() < 1e-5), "{last:?}");
        assert_eq!(($module::PERIODS, $module::PERIOD_S), (periods, 0.003));
    };
}

#[test]
fn a_controller_makes_the_run_that_was_judged() {
    let [stairs, arcs, arcs_wide, arcs_other, holes, tiny] = written();
    assert_eq!(stairs_i4f28::SECTIONS.len(), 3);
    holds!(stairs_i4f28, stairs, [12.0, 10.0]);
    holds!(arcs_f32, arcs, [4.0, 8.0, 5.0]);
    holds!(arcs_i16f48, arcs_wide, [4.0, 8.0, 5.0]);
    holds!(arcs_i5f27, arcs_other, [4.0, 8.0, 5.0]);
    holds!(holes_f64, holes, [9.0, -4.0, 3.0]);
    holds!(tiny_i28f36, tiny, [5e-6, 3e-6]);
}

/// The path is closed over rapid moves to be planned; a controller has the holes where the part has them.
#[test]
fn stretches_begin_and_end_where_the_part_does() {
    let ends: Vec<_> = holes_f64::SECTIONS
        .iter()
        .map(|section| {
            let run = holes_f64::PATH.on(section);
            let begin = in_mm(run.pieces.position(0, &[0.0; 3]));
            (begin, made(&holes_f64::PATH, std::slice::from_ref(section)).2)
        })
        .collect();
    let expected = [
        ([1.0, 2.0, 3.0], [1.0, 2.0, -1.0]),
        ([5.0, 2.0, 3.0], [5.0, 2.0, -1.0]),
        ([5.0, -4.0, 3.0], [9.0, -4.0, 3.0]),
    ];
    assert_eq!(ends.len(), expected.len());
    for ((begin, end), (from, to)) in ends.iter().zip(&expected) {
        let far = |a: &[f64; 3], b: &[f64; 3]| a.iter().zip(b).any(|(a, b)| (a - b).abs() > 1e-9);
        assert!(!far(begin, from) && !far(end, to), "{begin:?} to {end:?}, not {from:?} to {to:?}");
    }
}

#[test]
fn tables_take_the_bytes_that_are_said() {
    let stairs = problem::<2>("stairs.nc", STAIRS);
    let PieceInterpolator { pieces, lengths, .. } = stairs_i4f28::PATH;
    let plan = size_of_val(lengths.stages) + size_of_val(lengths.crossings);
    let tables = size_of_val(pieces.pieces) + size_of_val(pieces.numerators) + plan;
    let sections = stairs_i4f28::SECTIONS.len() * 4 * size_of::<u32>();
    let said = constants(&stairs, "I4F28").expect("it fits").bytes;
    assert_eq!(said, tables + sections);
    // The same word by another name, and one of half the width.
    assert_eq!(constants(&stairs, "I3F29").expect("it fits").bytes, said);
    assert!(constants(&stairs, "I5F11").expect("it fits").bytes < said);
}

#[test]
fn formats_without_a_type_are_refused() {
    let problem = problem::<2>("paper A", feedbits_tests::PAPER_A);
    let refusal = constants(&problem, "I5F13").expect_err("18 bits");
    assert_eq!(
        refusal.to_string(),
        "I5F13 is no type of a controller: expected a float, or 8, 16, 32 or 64 bits"
    );
}
