//! Each kernel fails as its report says, and its cure does not. Steps are numbered from 0.

use kernel_size::{Comparison, Ended, FormatRun, OutputFound, SignalFound, built_in};
use kernel_zoo::{ALL, Found, named};

/// The kernel's runs: it fails in the format of its report, and its cure is good there.
fn judged(name: &str) -> Found {
    let found = named(name).expect("a kernel of the zoo").judge(&built_in()).expect("a run");
    assert!(found.is_as_reported(), "{}{}", found.as_reported.comparison, found.cured.comparison);
    found
}

/// These formats, and no others, are good with the fault in the kernel.
fn assert_cured_by(found: &Found, formats: &[&str]) {
    assert_eq!(found.as_reported.good_formats, formats, "{}", found.as_reported.comparison);
}

fn run<'a>(comparison: &'a Comparison, format: &str) -> &'a FormatRun {
    comparison.run(format).expect("a format that was run")
}

fn as_reported(found: &Found) -> &FormatRun {
    run(&found.as_reported.comparison, found.report.reported_in)
}

fn output<'a>(run: &'a FormatRun, name: &str) -> &'a OutputFound {
    run.outputs.iter().find(|output| output.output == name).expect("an output")
}

fn signal<'a>(run: &'a FormatRun, name: &str) -> &'a SignalFound {
    run.signals.iter().find(|signal| signal.signal == name).expect("a signal")
}

/// Up to 5e-7 rad, in every format: double-double does no better.
#[test]
fn grbl_1739_a_short_arc_becomes_a_full_circle() {
    let found = judged("arc-epsilon");
    assert_cured_by(&found, &[]);
    assert!(found.as_reported.comparison.not_a_question_of_format);
    assert_eq!(found.as_reported.first_bad_step, Some(0));
    let travel = output(as_reported(&found), "travel");
    assert!((travel.worst_error - std::f64::consts::TAU).abs() < 1e-6, "{}", travel.worst_error);
}

/// 2²⁴ over 1970000 is cut to 8, as the thread computes it, and 2²⁴/8 are 2097152 ticks.
#[test]
fn marlin_12491_a_ramp_ends_in_a_jump() {
    let found = judged("bezier-ramp");
    assert_cured_by(&found, &[]);
    let reciprocal = signal(as_reported(&found), "reciprocal");
    assert_eq!((reciprocal.min, reciprocal.max, 2_f64.powi(24) / reciprocal.max), (8.0, 8.0, 2_097_152.0));
    let x = signal(as_reported(&found), "x");
    assert!((x.max - 1_970_000.0 / 2_097_152.0).abs() < 1e-6, "{}", x.max);
}

/// 128 · 8000²/2 is 4.096e9 at 2400 rpm, which wraps to -198967296 and gives the thread's -1989672 for 100 steps/s². It
/// wraps first at 1738 rpm, so in step 289, of 1740 rpm. At 6 rpm the thread's sharp ramp up has 0 microsteps, where
/// the ramp down takes 256.
#[test]
fn stepper_driver_138_a_motor_never_brakes() {
    let found = judged("brake-steps");
    assert_cured_by(&found, &["f32", "f64"]);
    let run = as_reported(&found);
    assert_eq!(
        run.overflows.as_ref().map(|lost| (lost.first_step, lost.first_signal)),
        Some((289, Some("product")))
    );
    let right = 128.0 * 8000.0_f64.powi(2) / 200.0;
    let last = output(run, "after_1000").course.last().copied();
    let (step, error) = last.expect("the error of the last step, which is at 2400 rpm");
    assert_eq!(step, 399);
    assert!((error - (right + 1_989_672.0)).abs() <= 1.0, "{error}");
    assert_eq!(output(run, "after_32000").first_broken(), Some(0));
}

/// The number to which the thread says that the clock is rounded.
#[test]
fn airsim_929_time_stands_still() {
    let found = judged("clock-in-ms");
    assert_cured_by(&found, &["f64"]);
    assert_eq!(signal(as_reported(&found), "clock").min, 1_522_772_344_832.0);
    assert_eq!((signal(as_reported(&found), "dt").min, found.as_reported.first_bad_step), (0.0, Some(1)));
}

#[test]
fn odrive_37_a_tracking_loop_fails_after_a_few_million_counts() {
    let found = judged("encoder-pll");
    assert_cured_by(&found, &["I32F32", "f64"]);
    assert!(output(as_reported(&found), "velocity").worst_error > 100.0);
}

/// One step becomes none or two.
#[test]
fn cura_engine_14_and_marlin_28192_an_extruder_makes_double_steps() {
    let found = judged("extruder-position");
    assert_cured_by(&found, &["I16F16", "I32F32", "I16F48", "f64"]);
    let steps = output(as_reported(&found), "steps");
    assert!((0.5..=1.0).contains(&steps.worst_error), "{}", steps.worst_error);
}

/// At 2⁻¹⁶ steps a frame the interval is 2000 · 2¹⁶ ticks, beyond 2²⁶. At twice that speed it is not.
#[test]
fn marlin_28187_a_first_step_comes_too_late() {
    let found = judged("first-interval");
    assert_eq!(found.as_reported.first_bad_step, Some(6));
    let run = as_reported(&found);
    assert_eq!(run.overflows.as_ref().map(|lost| lost.first_signal), Some(Some("interval")));
    // 131072000 wraps to -3145728, and the missing ticks are what is added.
    let first = output(run, "first");
    assert!((first.worst_error - (3_145_728.0 + 1000.0)).abs() < 1.0, "{first:?}");
    assert!(
        found.as_reported.good_formats.contains(&"f32".to_string()),
        "{:?}",
        found.as_reported.good_formats
    );
}

/// Those two of the four circles are missing that the thread names. An f64 misses circles too; in fixed point a sum is exact.
#[test]
fn grbl_495_full_circles_are_missing() {
    let found = judged("full-circle");
    assert_cured_by(&found, &["I16F16", "I8F24", "I32F32", "I16F48"]);
    let missing = |run: &FormatRun| -> Vec<&str> {
        run.outputs.iter().filter(|one| one.worst_error == 1.0).map(|one| one.output).collect()
    };
    assert_eq!(missing(as_reported(&found)), ["north_east", "south_west"]);
    assert!(!missing(run(&found.as_reported.comparison, "f64")).is_empty());
    let other = as_reported(&found).divergence.as_ref().expect("another way than in double-double");
    assert_eq!((other.step, other.signal, other.in_reference), (0, Some("cross"), Some([0.0, 0.0])));
}

/// The angle at which the thread's motor stops.
#[test]
fn arduino_foc_37_a_motor_stops_at_512_rad() {
    let found = judged("open-loop-angle");
    assert_cured_by(&found, &["I32F32", "I16F48", "f64"]);
    let angle = output(as_reported(&found), "angle");
    assert_eq!(signal(as_reported(&found), "angle").max, 512.0);
    // It stands from step 200 on, where 25 µrad a step are asked for.
    assert!((angle.worst_error - 1800.0 * 25e-6).abs() < 1e-3, "{}", angle.worst_error);
}

#[test]
fn sunray_161_a_filter_never_forgets_a_division_by_zero() {
    let found = judged("pid-zero-time");
    assert_cured_by(&found, &[]);
    assert!(found.as_reported.comparison.not_a_question_of_format);
    assert_eq!(as_reported(&found).ended, Ended::NotFinite { output: "filtered", step: 250 });
    // Fixed point goes on, with a quotient that is 0; the division counts all the same.
    let fixed = run(&found.as_reported.comparison, "I8F24");
    let lost = fixed.overflows.as_ref().expect("a division by zero");
    assert_eq!((lost.divisions_by_zero, lost.first_step, &fixed.ended), (1, 250, &Ended::Finished));
}

/// v² is 2³¹ at 46 341 microsteps/s: 434.4 rpm with 32 microsteps, where 450 rpm are reported, and 868.9 rpm with 16, where 900
/// rpm or so are. Step k is at k + 1 rpm.
#[test]
fn stepper_driver_20_the_square_of_a_velocity_overflows() {
    let found = judged("ramp-steps");
    assert_cured_by(&found, &["f32", "f64"]);
    let run = as_reported(&found);
    assert_eq!(output(run, "of_32").first_broken(), Some(434));
    assert_eq!(output(run, "of_16").first_broken(), Some(868));
    let lost = run.overflows.as_ref().expect("an overflow");
    assert_eq!((lost.first_step, lost.first_signal), (434, Some("square")));
}

/// Half a step a tick of 30 MHz over 2⁷ is 7.03 m/min of 1000 steps per mm. Step k is at k/10 m/min, and 10 m/min runs backwards.
#[test]
fn litex_cnc_21_an_axis_runs_backwards() {
    let found = judged("rate-register");
    assert_eq!(found.as_reported.first_bad_step, Some(71));
    let register = signal(as_reported(&found), "register");
    assert!(register.min < -1.9 && register.max < 2.0, "{register:?}");
    assert!(found.as_reported.good_formats.contains(&"I3F29".to_string()), "one integer bit more");
}

#[test]
fn grblhal_1015_relative_moves_do_not_end_where_they_should() {
    let found = judged("relative-moves");
    assert_cured_by(&found, &["I32F32", "I16F48", "f64"]);
    let position = output(as_reported(&found), "position");
    assert!(position.worst_error > 0.1 && position.worst_step == 3599, "{position:?}");
}

/// Double precision does not help, and any fixed point does: its sums are exact.
#[test]
fn allwpilib_469_a_sum_does_not_return_to_zero() {
    let found = judged("running-sum");
    assert_cured_by(&found, &["I16F16", "I32F32", "I16F48"]);
    assert_eq!(found.as_reported.first_bad_step, Some(4007));
}

/// A guess leaves the part 1 - p′/s of the error, p′ = 2√ε the slope at the root and s = 1 that of the chord: for ε =
/// 10⁻⁴ this takes ln(10⁻⁴ 2³⁰)/0.02, some 580 guesses.
#[test]
fn klipper_3142_a_search_for_a_step_time_creeps() {
    let found = judged("step-time");
    assert!(found.as_reported.comparison.not_a_question_of_format);
    let guesses = |format: &str, cured: bool| {
        let variant = if cured { &found.cured } else { &found.as_reported };
        output(run(&variant.comparison, format), "guesses").worst_error
    };
    assert_eq!((guesses("f64", false), found.as_reported.first_bad_step), (2000.0, Some(2)));
    assert!(guesses("f64", true) <= 40.0, "{}", guesses("f64", true));
}

/// The rate of which the thread's warning speaks.
#[test]
fn crazyflie_1301_a_task_of_100_hz_runs_at_125_hz() {
    let found = judged("tick-schedule");
    assert_cured_by(&found, &["I32F32", "f64"]);
    let runs = output(as_reported(&found), "runs");
    assert!((runs.worst_error - 25.0).abs() <= 1.0, "{}", runs.worst_error);
}

/// Beyond 2¹⁴ s, 4.55 hours, an f32 has steps of 2⁻⁹ s, so that 4 ms become two or three of them.
#[test]
fn motoman_244_a_robot_exceeds_its_speed() {
    let found = judged("trajectory-time");
    assert_cured_by(&found, &["I16F16", "I32F32", "I16F48", "f64"]);
    let increment = output(as_reported(&found), "increment");
    assert!((increment.worst_error - (3.0 / 512.0 * 250.0 - 1.0)).abs() < 1e-6, "{}", increment.worst_error);
}

/// From 2¹⁴ rad on an f32 has steps of 2⁻⁹ rad: a milliradian is none of them, or one.
#[test]
fn arduino_foc_83_a_velocity_is_zero_or_twice_what_it_is() {
    let found = judged("turns-and-angle");
    assert_cured_by(&found, &["I16F16", "I32F32", "I16F48", "f64"]);
    let velocity = signal(as_reported(&found), "travelled");
    assert_eq!((velocity.min, velocity.max), (0.0, 1.0 / 512.0));
}

#[test]
fn kernels_have_names_and_threads_of_their_own() {
    let mut names: Vec<&str> = ALL.iter().map(|report| report.name).collect();
    assert!(names.is_sorted());
    names.dedup();
    assert_eq!(names.len(), ALL.len());
    let mut threads: Vec<&str> = ALL.iter().map(|report| report.thread).collect();
    threads.sort_unstable();
    threads.dedup();
    assert_eq!(threads.len(), ALL.len());
    assert_eq!(ALL[0].url(), "https://github.com/grbl/grbl/issues/1739");
    assert!(named("none").is_none());
}
