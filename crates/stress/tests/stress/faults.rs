//! Paths on which a fault was once found, as they were drawn. Beside what a path is drawn from stands its checksum: were it
//! drawn differently, the test would run, and pass on, a path that never had the fault.

use feed_plan::ProfileKind;
use real::{I8F24, I16F48, I32F32, Overflow, Rounding, RuntimeFixed, RuntimeFormat};
use stress::{
    OnCurve, OnPieces, Outcome, PlannedPath, RandomPath, SOAK_FORMATS, SoakFormat, SoakPaths, SoakedRun,
    SplitMix64, check_against_float, soak_path,
};

fn bytes(seed: u64) -> Vec<u8> {
    let words = SplitMix64::new(seed.wrapping_mul(0xd134_2543_de82_ef95));
    words.take(1500).map(|word| word.to_le_bytes()[0]).collect()
}

/// FNV-1a of a path's numbers, to the digits of an f32: in those behind, machines differ in sines and powers.
fn checksum<const D: usize>(path: &RandomPath<D>) -> u32 {
    let RandomPath { curves, limits, profile, max_evaluations, piece_mm } = path;
    let mut numbers: Vec<f64> = Vec::new();
    for curve in curves {
        numbers.extend(curve.control_points().iter().flatten());
        numbers.extend(curve.as_curve().weights().into_iter().flatten());
        numbers.extend(curve.knots());
    }
    numbers.extend([limits.feedrate, limits.acceleration, limits.jerk, limits.chord_error]);
    numbers.extend(limits.centripetal_acceleration);
    numbers.extend([f64::from(*max_evaluations), *piece_mm]);
    let profile = ProfileKind::ALL.iter().position(|kind| kind == profile);
    let text = format!("{profile:?}") + &numbers.iter().map(|x| format!(" {x:.6e}")).collect::<String>();
    text.bytes().fold(0x811c_9dc5, |hash, byte| (hash ^ u32::from(byte)).wrapping_mul(0x0100_0193))
}

fn assert_drawn<const D: usize>(what: &str, path: &RandomPath<D>, expected: u32) {
    let found = checksum(path);
    assert!(
        found == expected,
        "{what} is drawn as another path than the one with the fault: checksum {found:#010x}, not {expected:#010x}. Let the \
         generator draw it as before (new draws last), or run the old path here, written out as numbers"
    );
}

fn drawn(bytes: &[u8], expected: u32) -> RandomPath<2> {
    let path = RandomPath::from_bytes(bytes).unwrap();
    assert_drawn("the path of these bytes", &path, expected);
    path
}

/// Runs these paths of a soak in f64; a path is its number and its checksum.
fn run_soaked(seed: u64, paths: &[(u64, u32)]) {
    run_soaked_in(&SOAK_FORMATS[..1], seed, paths);
}

fn run_soaked_in(formats: &[SoakFormat], seed: u64, paths: &[(u64, u32)]) {
    run_soaked_at(SoakPaths { seed, full_speed: true }, formats, paths);
}

fn run_soaked_at(of: SoakPaths, formats: &[SoakFormat], paths: &[(u64, u32)]) {
    for (path, expected) in paths {
        let what = format!("path {path} of seed {}", of.seed);
        if path % 5 == 4 {
            assert_drawn(&what, &of.draw::<3>(*path).unwrap(), *expected);
        } else {
            assert_drawn(&what, &of.draw::<2>(*path).unwrap(), *expected);
        }
        let soaked = soak_path(of, *path, formats, |_| false);
        assert!(soaked.violations.is_empty(), "{path}: {:?}", soaked.violations);
        assert!(soaked.runs.iter().any(|run| matches!(run, SoakedRun::Ran(_))), "{path} is refused");
    }
}

/// A root beyond the range of the piece on which the step began was taken for the end of that range.
#[test]
fn a_smooth_joint_is_passed_at_the_right_length() {
    for (seed, expected) in [(15, 0x5912_38c2), (22, 0xf1bc_d5ba), (42, 0xd805_c15a)] {
        let path = drawn(&bytes(seed), expected);
        let planned = PlannedPath::new(&path, 5000).unwrap();
        OnPieces::<f64, 2>::new(&planned).unwrap().run().unwrap();
    }
}

/// The landing's evaluation was missing in the documented bound, in the first steps of a run: K + 4.
#[test]
fn a_short_run_takes_no_more_evaluations_than_documented() {
    let path = drawn(&bytes(264), 0x3242_6389);
    let planned = PlannedPath::new(&path, 5000).unwrap();
    OnCurve::<f64, 2>::new(&planned).unwrap().run(secant_interp::Method::Secant).unwrap();
}

/// Off its plan by what the fold of a hairpin is long, or by what a step is off that turns by more than a right angle, a
/// run passed the bends after it at the feed of another place.
#[test]
fn what_follows_a_hairpin_is_passed_in_time() {
    run_soaked(20_261_121, &[(2120, 0xe244_bc99)]);
    run_soaked(20_261_122, &[(472, 0x6768_b704)]);
}

/// The first of two arcs with the same chord, before and behind a hairpin, had not been found to the last digit, and the
/// second was taken: its stage was shortened to a half, and the run was half a step behind its plan in the next bend.
#[test]
fn a_chord_in_front_of_a_hairpin_does_not_end_behind_it() {
    run_soaked(20_261_123, &[(132, 0x9a36_6d4f)]);
    run_soaked(555, &[(31_940, 0x4883_4e71)]);
}

/// A period that ended at a stop but for rounding was not taken to land on it: the run was shortened by what its chord led
/// beyond.
#[test]
fn a_stop_at_the_end_of_a_period_is_landed_on() {
    run_soaked(4242, &[(14_824, 0x635f_5c18), (66_060, 0xc34b_aec7)]);
}

/// In a long bend whose limit is below F/4096 throughout, one stop was left, and no limit beside it.
#[test]
fn a_slow_bend_is_slow_beside_its_stop() {
    run_soaked(
        4242,
        &[(2804, 0x1f6c_9f2a), (3844, 0x4187_895e), (53_260, 0xf900_cb72), (63_864, 0xed99_5396)],
    );
}

/// Beside a stop the limit of the next limit point held, however far that was.
#[test]
fn a_stop_releases_no_more_of_the_limit_than_lies_within_reach() {
    run_soaked(99, &[(93_264, 0x97f2_60dd)]);
}

/// A stage's end between two limit points is interpolated, and what that was off was taken for a shortfall. The run fell
/// behind its plan by it for good.
#[test]
fn a_stage_that_ends_between_limit_points_is_not_shortened_by_their_distance() {
    run_soaked(4242, &[(49_140, 0xd67c_6e1d), (50_984, 0x6906_bacd), (56_372, 0x4091_e32a)]);
}

/// The speed on a piece halved between two of nine samples: steps per chord were held to the range of the samples.
#[test]
fn a_chord_is_found_where_the_speed_dips_between_samples() {
    run_soaked(4242, &[(44_332, 0xd20a_27fd)]);
}

/// A step from a joint over a whole piece or more was cut off at that piece's last phase, up to 6 % short.
#[test]
fn a_step_from_a_joint_passes_the_next_one() {
    run_soaked_in(
        &SOAK_FORMATS,
        20_261_125,
        &[(38, 0x1963_5758), (225, 0x2752_cd76), (242, 0x4b17_00c3), (380, 0x9a3f_7e0a)],
    );
}

/// A step that led to a piece's last phase, and not beyond, was taken to have gone on over the whole next piece.
#[test]
fn a_step_to_the_last_phase_of_a_piece_ends_at_the_joint() {
    run_soaked_at(
        SoakPaths { seed: 20_261_128, full_speed: false },
        &SOAK_FORMATS[2..3],
        &[(1650, 0xb09b_7c23)],
    );
}

/// With 4 evaluations a step over a piece whose speed changes a thousandfold is not found, and the run is ahead of its plan:
/// that is no promise broken.
#[test]
fn a_run_that_lacks_evaluations_is_not_judged_by_its_place() {
    run_soaked(4242, &[(7316, 0x94af_54a7), (47_992, 0x2b61_22aa), (118_576, 0xe7f4_f0ef)]);
}

/// With 1 evaluation a run was 6e-4 mm ahead of its plan, which ends a chord 34 nm behind the begin of a bend of 3e-4 mm radius.
/// The run ended that chord behind the bend, and was judged as if in place, for the chord is twenty times as long as it was ahead.
#[test]
fn a_run_that_lacks_evaluations_is_not_judged_by_a_bend_that_its_plan_does_not_pass() {
    let paths = SoakPaths { seed: 20_261_123, full_speed: true };
    run_soaked_at(paths, &SOAK_FORMATS, &[(6842, 0xbf87_1bbf)]);
}

/// With 2 evaluations a run was 1e-3 mm ahead of its plan, reached two hairpins at the feed in front of them, and stepped over
/// each: it was ahead by 3e-2 mm then, but judged as if in place where the chords over the hairpins were found to within the
/// rounding of the format.
#[test]
fn a_run_off_its_plan_is_not_judged_by_its_place_behind_a_hairpin() {
    run_soaked_at(SoakPaths { seed: 20_261_128, full_speed: false }, &SOAK_FORMATS, &[(1296, 0x3b30_0a75)]);
}

/// After 282,477 periods, each off by its rounding, a run is several landing steps before its end, in a bend of 2.4e-3 mm radius. Of
/// their chords the plan says nothing.
#[test]
fn a_rest_of_several_landing_steps_is_not_judged_by_the_plan() {
    run_soaked_at(
        SoakPaths { seed: 20_261_129, full_speed: false },
        &SOAK_FORMATS[3..4],
        &[(1101, 0x5e06_1359)],
    );
}

/// A rational quintic's chord was off by 112 units of I4F28 relative to itself, which is the rounding of twice the sums of a
/// quintic without weights.
#[test]
fn weights_have_roundings_of_their_own() {
    run_soaked_at(
        SoakPaths { seed: 20_261_132, full_speed: true },
        &SOAK_FORMATS[4..5],
        &[(427, 0x9693_f409)],
    );
}

/// A chord of a curve of degree 7 whose weights fall from 800 to 0.02 was off by 305 units of I32F32 relative to itself, 264 being
/// granted; this one by 21, and 19. What is rounded where a step begins is divided by the weight where it ends.
#[test]
fn falling_weights_have_larger_roundings() {
    let bytes = [
        0x07, 0x00, 0x26, 0x82, 0x00, 0x92, 0xd5, 0xf8, 0x00, 0x00, 0x2e, 0x00, 0x00, 0x00, 0x00, 0x00, 0x00,
        0x00, 0x00, 0x00, 0x00, 0x00, 0x68, 0x00, 0x00, 0x00, 0x00, 0x00, 0x00, 0x00, 0x00, 0x00, 0x00, 0x65,
        0x00, 0x00, 0x00, 0x69, 0x00, 0x00, 0x00, 0x00, 0x21, 0x00, 0x00, 0x00, 0x21, 0x00, 0x00, 0x00, 0xf9,
        0xa7, 0x4f, 0x50, 0x00, 0x00, 0xa5, 0x00, 0x1e, 0x00, 0x54, 0x00, 0x00, 0x00, 0x00, 0xb3, 0x00, 0x72,
        0x00, 0x00, 0x00, 0xa2, 0x77, 0x00, 0x00, 0x00, 0x00, 0x00, 0x00, 0x00, 0x13, 0x4f, 0x14, 0x00, 0x06,
        0x00, 0xbb, 0x79, 0x32, 0x16, 0x93, 0x00, 0x00, 0xa6, 0x00, 0x00, 0x71, 0x00, 0x00, 0x00, 0x00, 0x00,
        0x00, 0xd1, 0x32, 0x00, 0xa9, 0x00, 0x00, 0x00, 0x00, 0x01, 0x00, 0x00, 0x00, 0x00, 0x42, 0x00, 0x26,
        0x00, 0xb6, 0x00, 0xe7, 0x00, 0x72, 0x6c, 0x57, 0x00, 0x11, 0x72, 0x24, 0x00, 0x00, 0x00, 0x00, 0x67,
        0x00, 0x29, 0x00, 0x00, 0x00, 0x36, 0x00, 0xb3, 0x00, 0x00, 0x00, 0x00, 0x00, 0x00, 0x00, 0x00, 0x00,
        0x00, 0x00, 0x00, 0x00, 0x00, 0x00, 0x00, 0x00, 0x00, 0x00, 0x00, 0x00, 0x00, 0x00, 0x00, 0x00, 0x00,
        0x00, 0x00, 0x00, 0x00, 0x00, 0x00, 0x00, 0x00, 0x00, 0x00, 0x00, 0x00, 0x00, 0x00, 0x00, 0x00, 0x00,
        0x00, 0x00, 0x00, 0x00, 0x00, 0x00, 0xd1, 0x00, 0x00, 0x00, 0xfc, 0x00, 0x00, 0x16, 0xee, 0x00, 0xfd,
        0xbc, 0x4c, 0x00, 0x00, 0x8c, 0x00, 0x00, 0x85, 0x90, 0xc9, 0x00, 0x6f, 0xee, 0xfb, 0x00, 0x00, 0x04,
        0x1a, 0x00, 0x31, 0x00, 0x23, 0xac, 0xc0, 0xd1, 0x00, 0xed, 0xfc, 0xbb, 0x00, 0x00, 0x00, 0x00, 0x40,
        0x00, 0x00, 0x6f,
    ];
    let path = drawn(&bytes, 0x21cb_ab84);
    let planned = PlannedPath::new(&path, 2000).unwrap();
    OnPieces::<I32F32, 2>::new(&planned).unwrap().run().unwrap();
}

/// Where the speed on a piece is 15 m per unit of its parameter, the judge's own rounding of phases is 3e-12 mm.
#[test]
fn rounding_in_the_judge_is_no_fault_of_the_run() {
    run_soaked(20_261_130, &[(39_688, 0x056f_643f)]);
}

/// A landing step's product with a step per chord was rounded to nothing, and the run stood still before its end. In the
/// coarsest of these formats all feeds of the plan are 0, so that the whole path is landed on.
#[test]
fn a_run_ends_in_a_format_too_coarse_for_its_landing_step() {
    let bytes = [
        0xc8, 0x15, 0x21, 0x0b, 0xc5, 0x1d, 0x18, 0x41, 0x8e, 0xff, 0x8b, 0x18, 0x6e, 0x66, 0x00, 0x87, 0x00,
    ];
    let path = drawn(&bytes, 0x670f_5ce9);
    let planned = PlannedPath::new(&path, 2000).unwrap();
    let mut runs = 0;
    for (fraction, rounding) in (0..8).flat_map(|f| Rounding::ALL.map(|r| (f, r))) {
        let format = RuntimeFormat::new(26, fraction, rounding, Overflow::Saturate).unwrap();
        runs += format.run::<0, usize>(|| match OnPieces::<RuntimeFixed<0>, 2>::new(&planned) {
            Ok(run) => run.run().map(|_| 1).unwrap(),
            Err(_) => 0,
        });
    }
    assert!(runs > 16, "{runs} of 32");
}

/// A step of three fraction bits lost up to two units of its way, and what a run had lost was travelled a unit a period: by more
/// periods than the plan has, which the judge did not grant.
#[test]
fn what_a_coarse_format_loses_takes_as_many_landing_steps() {
    let format = RuntimeFormat::new(27, 3, Rounding::ALL[0], Overflow::Wrap).unwrap();
    for (seed, expected) in [(56, 0x76ed_b1b4), (132, 0x701c_4d36)] {
        let path = drawn(&bytes(seed), expected);
        let planned = PlannedPath::new(&path, 1000).unwrap();
        let ran =
            format.run::<0, _>(|| OnPieces::<RuntimeFixed<0>, 2>::new(&planned).unwrap().run().unwrap());
        assert!(matches!(ran, Outcome::Ran(figures) if 2 * figures.periods > 3 * planned.periods()));
    }
}

/// A guess of a float was not held to its piece's range: from a history that was none, at a run's start and behind a joint, it was
/// off by up to all of the speed, and with 1 or 2 evaluations the chord was as wrong.
#[test]
fn few_evaluations_find_a_chord_in_floats_as_in_fixed_point() {
    for (seed, expected) in [(5, 0x7490_8388), (14, 0xa4ba_ac79), (29, 0x827b_af42)] {
        let path = drawn(&bytes(seed), expected);
        let planned = PlannedPath::new(&path, 2000).unwrap();
        let Outcome::Ran(ran) = check_against_float::<I8F24, 2>(&planned).unwrap() else { panic!("{seed}") };
        let [fixed, float] = ran.missed_part;
        assert!(fixed > 0.0 && float <= 1.01 * fixed, "{seed}: {ran:?}");
    }
}

/// A chord whose evaluations were used up was held to the bound of one that was found, and only a fuzzer compared I16F48 with f64.
#[test]
fn formats_may_differ_by_what_chords_are_off_whose_evaluations_were_used_up() {
    for (seed, expected) in [(7, 0x9829_1bcf), (94, 0xc745_413d), (148, 0xb6b2_e296)] {
        let path = drawn(&bytes(seed), expected);
        let planned = PlannedPath::new(&path, 3000).unwrap();
        check_against_float::<I16F48, 2>(&planned).unwrap();
    }
}

/// A bend within a step over a smooth joint was taken for a corner: where the path is slower behind it by more than a sixteenth,
/// the chord came out short.
#[test]
fn a_bend_over_a_smooth_joint_is_no_corner() {
    for (seed, expected) in [(272, 0xd124_1178), (590, 0x6aeb_0275)] {
        let path = drawn(&bytes(seed), expected);
        let planned = PlannedPath::new(&path, 2000).unwrap();
        OnPieces::<f64, 2>::new(&planned).unwrap().run().unwrap();
    }
}
