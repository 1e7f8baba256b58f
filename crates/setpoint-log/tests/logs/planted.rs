//! Faults of known size in sound motions.

use setpoint_log::{LimitVerdict, LogOptions, judge};

use crate::motion::{
    CIRCLE, CIRCLE_MM, CORNER, MACHINE, Motion, PERIOD_S, Pace, SOUND, circle, corner, judged, machine,
    without_jerk,
};

/// The faults of a log without a part.
fn faults(log: &str) -> Vec<String> {
    judged(log, MACHINE, None).unwrap().faults()
}

/// The faults of a log of a part, and of how it follows that.
fn faults_of(log: &str, machine: &str, part: &str, tolerance_mm: Option<f64>) -> Vec<String> {
    judged(log, machine, Some((part, tolerance_mm))).unwrap().faults()
}

/// A part of the motion on which X is at cruise: a place in the middle of the first move.
const CRUISE: usize = 600;

#[test]
fn sound_motions_have_no_fault_at_any_resolution() {
    for decimals in [2, 3, 4, 6, 9, 12] {
        let motion = corner(SOUND, SOUND);
        let timed = motion.log(decimals);
        assert_eq!(faults(&timed), [""; 0], "{decimals}");
        assert_eq!(faults(&motion.log_without_times(decimals)), [""; 0], "{decimals}");
        assert_eq!(faults_of(&timed, MACHINE, CORNER, Some(1e-9)), [""; 0], "{decimals}");
        // A chord of 0.05 mm is off the circle by 0.05² / 80 mm.
        let around = circle(true).log(decimals);
        assert_eq!(faults_of(&around, &without_jerk(), CIRCLE, Some(3.13e-5)), [""; 0], "{decimals}");
        if decimals >= 6 {
            assert_eq!(faults_of(&around, &without_jerk(), CIRCLE, Some(2.8e-5)).len(), 1, "{decimals}");
        }
    }
}

/// What setpoints take of the limits is what the motion is made of.
#[test]
fn shares_of_limits_are_those_of_the_motion() {
    let found = judged(&corner(SOUND, SOUND).log(12), MACHINE, None).unwrap();
    for (what, share) in [
        ("velocity of X", 50.0 / 60.0),
        ("acceleration of X", 600.0 / 640.0),
        ("jerk of X", 19.0 / 20.0),
        ("velocity of Y", 50.0 / 60.0),
        ("acceleration of Y", 600.0 / 640.0),
        ("jerk of Y", 19.0 / 20.0),
    ] {
        let one = found.limits.iter().find(|limit| limit.what == what).unwrap();
        assert_eq!(one.verdict, LimitVerdict::Kept, "{one:?}");
        assert!((one.raw / share - 1.0).abs() < 2e-4, "{what}: {} {share}", one.raw);
    }
    assert_eq!((found.at_rest, found.standstills.count), ([true; 2], 1));
    assert!((found.standstills.longest_s - 0.02).abs() < 0.003, "{:?}", found.standstills);
}

#[test]
fn a_row_that_is_there_twice_is_found() {
    let motion = corner(SOUND, SOUND);
    let text = motion.log(6);
    let mut lines: Vec<&str> = text.lines().collect();
    lines.insert(CRUISE, lines[CRUISE]);
    assert_eq!(faults(&(lines.join("\n") + "\n")), ["1 row is twice"]);
    for (at, count) in [(CRUISE, 1), (CRUISE, 7), (120, 1), (1200, 2)] {
        let mut held = motion.clone();
        held.0.splice(at..at, vec![motion.0[at - 1]; count]);
        let expected =
            if count == 1 { "1 row is twice".to_string() } else { format!("{count} rows are twice") };
        assert_eq!(faults(&held.log(6)), [expected.as_str()], "{at}");
        assert_eq!(faults(&held.log_without_times(6)), [expected.as_str()], "{at}");
    }
}

#[test]
fn rows_that_are_missing_are_found() {
    let motion = corner(SOUND, SOUND);
    for (at, count) in [(CRUISE, 1), (CRUISE, 5), (CRUISE, 100), (100, 1)] {
        let expected =
            if count == 1 { "1 row is missing".to_string() } else { format!("{count} rows are missing") };
        let text = motion.log(6);
        let kept = text.lines().enumerate().filter(|(line, _)| !(at..at + count).contains(line));
        let log = kept.fold(String::new(), |text, (_, line)| text + line + "\n");
        assert_eq!(faults(&log), [expected.as_str()], "{at}");
        assert_eq!(faults_of(&log, MACHINE, CORNER, Some(1e-3)), [expected.as_str()], "{at}");
        let mut lost = motion.clone();
        lost.0.drain(at..at + count);
        assert_eq!(faults(&lost.log_without_times(6)), [expected.as_str()], "{at}");
    }
}

/// Numbers of samples that are missing while the axes stand are told: what the axes did meanwhile is not in the log.
#[test]
fn samples_that_are_missing_at_rest_are_told() {
    let motion = corner(SOUND, SOUND);
    let middle = motion.0.iter().position(|(point, _)| point[0] >= 60.0).unwrap() + 4;
    let mut text = String::from("sample,x,y\n");
    for (index, ([x, y, _], _)) in motion.0.iter().enumerate() {
        let number = if index > middle { index + 7 } else { index };
        text += &format!("{number},{x:.6},{y:.6}\n");
    }
    let found = judged(&text, MACHINE, None).unwrap();
    assert_eq!(found.faults(), [""; 0]);
    let [(at, count)] = found.missing_at_rest.first[..] else { panic!("{found:?}") };
    assert_eq!((at.row, count, found.missing_at_rest.places), (middle as u64 + 2, 7, 1));
}

/// LinuxCNC's sampler says that it was overrun, and not for how long.
#[test]
fn a_mark_of_an_overrun_is_found() {
    let text = corner(SOUND, SOUND).log_without_times(6);
    let mut lines: Vec<&str> = text.lines().collect();
    lines.splice(CRUISE..CRUISE + 40, ["overrun"]);
    assert_eq!(faults(&(lines.join("\n") + "\n")), ["rows are missing"]);
}

#[test]
fn limits_that_are_broken_by_little_are_found() {
    let over = |change: fn(Pace) -> Pace| [corner(change(SOUND), SOUND), corner(SOUND, change(SOUND))];
    for (what, change) in [
        ("jerk", (|pace| Pace { jerk: 20_400.0, ..pace }) as fn(Pace) -> Pace),
        ("acceleration", |pace| Pace { acceleration: 643.2, ..pace }),
        ("velocity", |pace| Pace { velocity: 60.006, ..pace }),
    ] {
        for (motion, axis) in over(change).into_iter().zip(["X", "Y"]) {
            assert_eq!(faults(&motion.log(6)), [format!("{what} of {axis} is broken")]);
        }
    }
    // Of 0.01 mm a log does not tell 1.02 times the jerk from the jerk, and says from which resolution on it would.
    let coarse = judged(&corner(Pace { jerk: 20_400.0, ..SOUND }, SOUND).log(2), MACHINE, None).unwrap();
    let jerk = coarse.limits.iter().find(|limit| limit.what == "jerk of X").unwrap();
    assert_eq!(jerk.verdict, LimitVerdict::KeptWithin);
    assert!(jerk.decided_below_mm.unwrap() > 0.0, "{jerk:?}");
}

/// A setpoint that is off by 20 nm at cruise takes 3 times that of the jerk, which is three times the limit, and an acceleration within it.
#[test]
fn a_single_setpoint_that_is_off_is_found() {
    let mut motion = corner(SOUND, SOUND);
    motion.0[CRUISE].0[0] += 2e-5;
    let found = judged(&motion.log(9), MACHINE, None).unwrap();
    assert_eq!(found.faults(), ["jerk of X is broken"]);
    let jerk = found.limits.iter().find(|limit| limit.what == "jerk of X").unwrap();
    assert!((jerk.taken - 3.0 * 2e-5 / (20_000.0 * PERIOD_S.powi(3))).abs() < 1e-3, "{jerk:?}");
    let at = jerk.at.unwrap();
    assert!((CRUISE as u64..=CRUISE as u64 + 4).contains(&at.row) && at.line == Some(2), "{at:?}");
}

/// 1e-4 too fast for 10 ms is half of a tenth of a micrometre of way.
#[test]
fn a_feed_that_is_too_high_for_a_moment_is_found() {
    let mut motion = corner(SOUND, SOUND);
    let mut ahead = 0.0;
    for (index, (point, line)) in motion.0.iter_mut().enumerate() {
        if *line != 2 {
            continue;
        }
        // Into it and out of it in 2 ms, so that no other limit is broken.
        let share =
            ((index as f64 - 600.0) / 2.0).clamp(0.0, 1.0) - ((index as f64 - 612.0) / 2.0).clamp(0.0, 1.0);
        ahead += 1e-4 * share * 50.0 * PERIOD_S;
        let left = 60.0 - point[0];
        point[0] += ahead * (left / 20.0).clamp(0.0, 1.0);
    }
    assert_eq!(faults_of(&motion.log(6), MACHINE, CORNER, Some(1e-3)), ["feed is broken"]);
    assert_eq!(faults(&motion.log(6)), [""; 0], "without a part no feed is commanded");
}

/// A corner that is cut by a short move across it: its distance from that is 3 µm.
#[test]
fn a_corner_that_is_cut_is_found() {
    let cut = 0.003 * 2.0_f64.sqrt();
    let [begin, end] = [[0.0; 3], [60.0, 30.0, 0.0]];
    let [from, to] = [[60.0 - cut, 0.0, 0.0], [60.0, cut, 0.0]];
    let slow = Pace { velocity: 0.1, acceleration: 20.0, jerk: 19_000.0 };
    let motion = Motion::default()
        .stand(begin, 5)
        .line(begin, from, 2, SOUND)
        .stand(from, 5)
        .line(from, to, 2, slow)
        .stand(to, 5)
        .line(to, end, 3, SOUND)
        .stand(end, 5);
    let found = judged(&motion.log(6), MACHINE, Some((CORNER, Some(0.0029)))).unwrap();
    let part = found.part.as_ref().unwrap();
    assert!((part.path_to_log_mm - 0.003).abs() < 2e-6, "{part:?}");
    assert!((part.nearest.mm - cut / 2.0).abs() < 1e-4, "{part:?}");
    assert_eq!(found.faults(), ["the log cuts the path by 0.003000 mm"]);
    assert_eq!(faults_of(&motion.log(6), MACHINE, CORNER, Some(0.0031)), [""; 0]);
    assert_eq!(faults_of(&motion.log(6), MACHINE, CORNER, None), [""; 0], "it is told, and not judged");
}

/// An arc that is made 3 µm too small: chords and all, the setpoints are off by that.
#[test]
fn a_circle_that_is_too_small_is_found() {
    let mut motion = circle(true);
    for (point, _) in &mut motion.0 {
        let (x, y) = (point[0] - 40.0, point[1] - 10.0);
        if point[1] > 1e-9 {
            // None at the bottom, where the lines are.
            let share = 1.0 - 0.003 / 10.0 * (1.0 + y / 10.0) / 2.0;
            (point[0], point[1]) = (40.0 + share * x, 10.0 + share * y);
        }
    }
    let found = judged(&motion.log(9), &without_jerk(), Some((CIRCLE, Some(0.002)))).unwrap();
    let part = found.part.as_ref().unwrap();
    assert!((part.nearest.mm - 0.003).abs() < 1e-5, "{part:?}");
    assert_eq!(found.faults(), ["the log leaves the path by 0.003000 mm in line 3"]);
}

/// Setpoints on the lines are all on the path; in order, the circle is 20 mm off.
#[test]
fn a_circle_that_is_left_out_is_found() {
    let found = judged(&circle(false).log(6), &without_jerk(), Some((CIRCLE, Some(0.01)))).unwrap();
    let part = found.part.as_ref().unwrap();
    assert!(part.nearest.mm < 1e-5 && (part.order_mm - 20.0).abs() < 0.1, "{part:?}");
    let [skip] = part.skipped[..] else { panic!("{part:?}") };
    assert_eq!(skip.lines, [3, 3]);
    assert!((skip.length_mm - CIRCLE_MM).abs() < 1.0, "{skip:?}");
    assert_eq!(found.faults().len(), 1, "{:?}", found.faults());
}

/// The path crosses itself and repeats itself; nothing is skipped, and each pass is made.
#[test]
fn passes_over_the_same_place_are_told_apart() {
    let part = "G21 G90\nG1 X60 F3000\nG1 X0\nG1 X60\nG1 X30 Y30\nG1 X30 Y-30\n";
    let points = [[0.0, 0.0], [60.0, 0.0], [0.0, 0.0], [60.0, 0.0], [30.0, 30.0], [30.0, -30.0]];
    let of = |passes: &[usize]| {
        let mut motion = Motion::default().stand([0.0; 3], 5);
        for pair in passes.windows(2) {
            let [from, to] = [pair[0], pair[1]].map(|index| [points[index][0], points[index][1], 0.0]);
            motion = motion.line(from, to, 0, SOUND).stand(to, 5);
        }
        motion.log(6)
    };
    assert_eq!(faults_of(&of(&[0, 1, 2, 3, 4, 5]), MACHINE, part, Some(1e-3)), [""; 0]);
    // Two of three passes are left out.
    let found = judged(&of(&[0, 1, 4, 5]), MACHINE, Some((part, None))).unwrap();
    let followed = found.part.as_ref().unwrap();
    assert!(followed.nearest.mm < 1e-5 && followed.order_mm > 29.0, "{followed:?}");
}

#[test]
fn a_log_that_ends_early_is_found() {
    let mut motion = corner(SOUND, SOUND);
    motion.0.truncate(1600);
    let faults = faults_of(&motion.log(6), MACHINE, CORNER, Some(1e-3));
    assert!(faults.len() == 1 && faults[0].starts_with("the log ends in line 3, "), "{faults:?}");
}

#[test]
fn the_log_of_another_part_is_told_with_how_far_off_it_is() {
    let faults = faults_of(&circle(true).log(6), &without_jerk(), "G21 G90\nG1 X80 Y80 F3000\nG1 X0\n", None);
    assert!(faults.iter().any(|fault| fault.starts_with("the log is of another part: ")), "{faults:?}");
    assert!(faults.iter().all(|fault| !fault.contains("skipped")), "{faults:?}");
}

/// A log that goes to and fro within a hundredth of a part is near its path everywhere, and follows none of it.
#[test]
fn a_log_that_stays_near_a_path_it_does_not_follow_is_of_another_part() {
    let [begin, end] = [[0.0; 3], [8.0, 0.0, 0.0]];
    let mut motion = Motion::default().stand(begin, 5);
    for _ in 0..5 {
        motion = motion.line(begin, end, 2, SOUND).stand(end, 15).line(end, begin, 2, SOUND).stand(begin, 15);
    }
    let part = "G21 G90\nG1 X8 F3000\nG1 Y900\n";
    let found = judged(&motion.log(6), MACHINE, Some((part, None))).unwrap();
    let followed = found.part.as_ref().unwrap();
    assert!(followed.never_visited_mm > 890.0 && followed.ends_at_mm < 18.0, "{followed:?}");
    let faults = found.faults();
    assert!(
        faults[0].starts_with("the log is of another part: ") && faults[0].contains("never visits"),
        "{faults:?}"
    );
    // One that ends early follows the path up to there.
    let mut early = corner(SOUND, SOUND);
    early.0.truncate(400);
    let faults = faults_of(&early.log(6), MACHINE, CORNER, None);
    assert!(faults.len() == 1 && faults[0].starts_with("the log ends in line 2, "), "{faults:?}");
}

#[test]
fn a_log_in_another_unit_is_told() {
    let mut motion = corner(SOUND, SOUND);
    motion.0.iter_mut().for_each(|(point, _)| *point = point.map(|x| x / 25.4));
    let faults = faults_of(&motion.log(7), MACHINE, CORNER, None);
    assert!(faults.iter().any(|fault| fault.contains("as of another unit")), "{faults:?}");
    let options = LogOptions { unit: Some("inch".parse().unwrap()), ..LogOptions::default() };
    let found = judge(motion.log(9).as_bytes(), &machine(MACHINE), &options).unwrap();
    assert_eq!(found.faults(), [""; 0]);
}

/// A machine may deviate at corners, and nobody knows where these are: at 4.4 times the acceleration that is no excuse.
#[test]
fn a_junction_deviation_hides_no_limit() {
    let pace = Pace { acceleration: 2816.0, jerk: 1e6, ..SOUND };
    let motion = corner(pace, SOUND);
    let machine = without_jerk().replacen(
        "[machine]",
        "[machine]\njunction = \"deviation\"\njunction_deviation_mm = 0.01",
        1,
    );
    let of_part = Some((CORNER, Some(0.1)));
    for part in [None, of_part] {
        let found = judged(&motion.log(6), &machine, part).unwrap();
        assert_eq!(found.faults()[0], "acceleration of X is broken", "{part:?}");
        let limit = found.limits.iter().find(|limit| limit.what == "acceleration of X").unwrap();
        assert!((limit.taken / limit.raw - 1.0).abs() < 0.05 && limit.taken > 2.0, "{limit:?}");
    }
}

/// A corner that is passed within a period at an even feed shortens one chord: that is no jerk of the path. Runs of a real program over
/// corners of some degrees were said to break it.
#[test]
fn a_corner_within_a_period_is_no_jerk_along_the_path() {
    let machine =
        "[machine]\ninterpolation_period_ms = 1\nacceleration_mm_per_s2 = 100\njerk_mm_per_s3 = 1000\n";
    for degrees in [1.0_f64, 6.0, 13.0, 40.0, 90.0] {
        for phase in [0.1, 0.5, 0.8] {
            let (sin, cos) = degrees.to_radians().sin_cos();
            let point = |row: usize| {
                let way = 0.05 * (row as f64 + phase) - 5.0;
                if way < 0.0 { [way, 0.0] } else { [way * cos, way * sin] }
            };
            let row = |row: usize| point(row).map(|x| format!("{x:.9}")).join(",");
            let log: String = (0..200).map(|number| row(number) + "\n").collect();
            let found = judged(&format!("x,y\n{log}"), machine, None).unwrap();
            assert_eq!(found.faults(), [""; 0], "{degrees} {phase}");
        }
    }
}
