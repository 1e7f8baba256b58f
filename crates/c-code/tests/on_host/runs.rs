//! The papers' curves run in every format as in Rust, and the self-test finds a run that does not.

use feed_plan::ProfileKind;
use real::I4F28;
use secant_interp::TABLE_LAYOUT;
use stress::{RandomPath, curves_at};

use crate::paths::{lines, paper_a, ten_points};
use crate::planned_path::PlannedPath;
use crate::program::Parts;

/// Periods of a run, at most.
const MOST_PERIODS: u32 = 9000;

const FORMATS: [&str; 9] = ["I4F12", "I16F16", "I8F24", "I4F28", "I3F29", "I16F48", "I4F60", "f32", "f64"];

macro_rules! in_every_format {
    ($($test:ident: $path:expr, $first:expr;)*) => {$(
        #[test]
        fn $test() {
            let path = $path;
            let planned = PlannedPath::new(&path, MOST_PERIODS).expect("a plan");
            let mut parts = Parts::from($first);
            for format in FORMATS {
                assert!(parts.add(&planned, format, false), "{format} holds the path");
            }
            parts.demand_the_same_runs();
        }
    )*};
}

in_every_format! {
    the_plane_cubic_runs_as_in_rust: paper_a(), 0;
    the_rational_cubic_in_space_runs_as_in_rust: ten_points(), 1;
    lines_from_stop_to_stop_run_as_in_rust: lines(), 2;
    half_cosines_run_as_in_rust: RandomPath { profile: ProfileKind::Trigonometric, ..paper_a() }, 2;
    constant_jerk_runs_as_in_rust: paper_a().fastest(), 1;
    // In I4F28, x is above 2 here: no factor for the products of halves.
    long_chords_run_as_in_rust: curves_at(0.72, paper_a().curves), 0;
}

/// What the other tests find of the run-time format holds for the format that is compiled.
#[test]
fn the_run_time_format_has_the_files_of_the_compiled_one() {
    let path = paper_a();
    let planned = PlannedPath::new(&path, MOST_PERIODS).expect("a plan");
    let name = || c_code::CName::try_new("part").expect("a name");
    let at_run_time = planned.files(name(), "I4F28", true).expect("files");
    assert_eq!(planned.files_in::<I4F28>(name(), true), Some(at_run_time));
}

/// The last place of one coefficient, one stage and one operation: each is enough.
#[test]
fn a_self_test_finds_the_slightest_change() {
    let path = paper_a();
    let planned = PlannedPath::new(&path, MOST_PERIODS).expect("a plan");
    let mut parts = Parts::from(0);
    for _ in 0..3 {
        assert!(parts.add(&planned, "I4F28", false));
    }
    assert!(parts.add(&planned, "f32", true));
    // The first coefficient of the table, which is the first word of its first row.
    parts.change(0, |source| {
        let (before, table) =
            source.split_once("numerators[][AXES][DEGREE] = {\n    { { ").expect("the table");
        let (first, after) = table.split_once(',').expect("a number");
        let word: i32 = first.parse().expect("a word");
        format!("{before}numerators[][AXES][DEGREE] = {{\n    {{ {{ {},{after}", word + 1)
    });
    // Products are cut instead of rounded.
    parts.change(1, |source| source.replace(" + ((low >> (FRACTION_BITS - 1u)) & 1u)", ""));
    // The rate may change faster: the run without override is the same.
    parts.change(3, |source| source.replace("#define MAX_BEND INT64_C(", "#define MAX_BEND INT64_C(1"));
    parts.demand_verdicts(&[2, 2, 0, 3]);
}

/// The two files are of one run, or the compiler says which layout each has.
#[test]
fn a_header_of_another_layout_is_refused_by_name() {
    let path = paper_a();
    let planned = PlannedPath::new(&path, MOST_PERIODS).expect("a plan");
    let mut parts = Parts::from(0);
    assert!(parts.add(&planned, "I4F28", false));
    let own = format!("#define PART0_LAYOUT {TABLE_LAYOUT}\n");
    parts.change_header(0, |header| header.replace(&own, "#define PART0_LAYOUT 99\n"));
    let tables = format!("the tables of part0.c are of layout {TABLE_LAYOUT}");
    parts.demand_refusal(&["part0.h is of layout 99", &tables, "take both files"]);
}
