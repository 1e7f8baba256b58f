//! What a log does not show is told as such.

use setpoint_log::LimitVerdict;

use crate::motion::{MACHINE, Motion, Pace, SOUND, corner, judged};

/// A gap behind every other row leaves steps alone, and a gap behind each row not even these.
#[test]
fn a_limit_without_a_window_is_not_judged() {
    let text = corner(SOUND, SOUND).log(6);
    let rows =
        text.lines().enumerate().filter(|(line, _)| *line == 0 || (100..500).contains(line) && line % 3 != 0);
    let log = rows.fold(String::new(), |text, (_, row)| text + row + "\n");
    let stands = judged(&("x,y\n".to_string() + &"1.000,2.000\n".repeat(100)), MACHINE, None).unwrap();
    assert!(stands.limits.iter().all(|limit| limit.verdict == LimitVerdict::Kept), "{stands:?}");
    let found = judged(&log, MACHINE, None).unwrap();
    for limit in &found.limits {
        let is_seen = limit.what.starts_with("velocity");
        let expected = if is_seen { LimitVerdict::Kept } else { LimitVerdict::NotJudged };
        assert_eq!(limit.verdict, expected, "{limit:?}");
    }
}

/// What a machine's file assumes is told, and no log is judged by it.
#[test]
fn what_is_assumed_is_told_and_not_judged() {
    let fast = corner(Pace { jerk: 60_000.0, ..SOUND }, SOUND);
    let assumed = MACHINE
        .replace("jerk_mm_per_s3 = 20000\n", "jerk_mm_per_s3 = 20000\nassumed = [\"jerk_mm_per_s3\"]\n");
    let found = judged(&fast.log(6), &assumed, None).unwrap();
    assert_eq!(found.faults(), [""; 0]);
    assert!(found.limits.iter().all(|limit| !limit.what.starts_with("jerk")), "{:?}", found.limits);
    let said = "jerk of X, Y: the machine's file assumes one";
    assert!(found.not_judged.iter().any(|one| one == said), "{:?}", found.not_judged);
    assert_eq!(judged(&fast.log(6), MACHINE, None).unwrap().faults(), ["jerk of X is broken"]);
    // An assumed period tells nothing of a log that has no times.
    let assumed = MACHINE.replace("_ms = 1\n", "_ms = 1\nassumed = [\"interpolation_period_ms\"]\n");
    let said = judged(&fast.log_without_times(6), &assumed, None).map(|_| ()).unwrap_err().to_string();
    assert!(said.contains("how long a period is; 1 ms is assumed: expected --period"), "{said}");
    assert!(judged(&corner(SOUND, SOUND).log(6), &assumed, None).unwrap().faults().is_empty());
}

/// Where a log does not decide, it says over which window it would show twice the limit, and whether it has rows enough
/// without a gap.
#[test]
fn the_window_that_would_show_an_excess_is_told() {
    let limit = |log: &str, what: &str| {
        let found = judged(log, MACHINE, None).unwrap();
        let limit = found.limits.iter().find(|limit| limit.what == what).unwrap().clone();
        (limit.verdict, limit.twice_shows_over_periods, found.longest_rows)
    };
    let text = corner(SOUND, SOUND).log(2);
    // 8 r = 0.04 mm are 20,000 mm/s³ over (12.6 ms)³; 4 r are 640 mm/s² over (5.6 ms)².
    let whole = (text.lines().count() - 1) as u64;
    assert_eq!(limit(&text, "jerk of X"), (LimitVerdict::KeptWithin, Some(16), whole));
    assert_eq!(limit(&text, "acceleration of X"), (LimitVerdict::KeptWithin, Some(8), whole));
    let rows = text.lines().enumerate().filter(|(line, _)| *line == 0 || line % 10 != 0);
    let gaps = rows.fold(String::new(), |text, (_, row)| text + row + "\n");
    assert_eq!(limit(&gaps, "jerk of X"), (LimitVerdict::KeptWithin, Some(16), 9));
    // What the message says is true: twice the jerk for that long is seen, and for less it is not.
    let twice = corner(Pace { jerk: 40_000.0, ..SOUND }, SOUND).log(2);
    assert_eq!(
        limit(&twice, "jerk of X").0,
        LimitVerdict::KeptWithin,
        "it lasts for 15 periods, and a window takes 48"
    );
}

/// What is hidden by more than there is takes nothing of a limit at least, and not less than that.
#[test]
fn no_motion_takes_less_than_nothing() {
    let machine =
        MACHINE.replacen("[machine]", "[machine]\nacceleration_mm_per_s2 = 300\njerk_mm_per_s3 = 9000", 1);
    for decimals in [1, 2, 3] {
        let found = judged(&corner(SOUND, SOUND).log(decimals), &machine, None).unwrap();
        assert!(found.limits.iter().all(|limit| limit.taken >= 0.0), "{:?}", found.limits);
    }
    let noise = [0.0, 0.01, 0.0, 0.0].map(|x| ([x, 0.0, 0.0], 0));
    let found = judged(&Motion(noise.repeat(4)).log(2), &machine, None).unwrap();
    assert!(found.limits.iter().any(|limit| limit.verdict == LimitVerdict::KeptWithin && limit.taken == 0.0));
}

#[test]
fn limits_that_the_machine_does_not_state_are_named() {
    let found = judged(&corner(SOUND, SOUND).log(6), MACHINE, None).unwrap();
    for what in ["feed", "acceleration along the path", "jerk along the path", "velocity of Z"] {
        assert!(found.not_judged.iter().any(|one| one.starts_with(what)), "{what}: {:?}", found.not_judged);
    }
    let nothing =
        judged(&corner(SOUND, SOUND).log(6), "[machine]\n", None).map(|_| ()).unwrap_err().to_string();
    assert!(nothing.starts_with("nothing can be judged: feed: "), "{nothing}");
    assert!(nothing.contains("jerk of X, Y, Z"), "{nothing}");
}

/// An axis that is in no column stood still by what was said of it: its limits were kept.
#[test]
fn an_axis_that_the_log_does_not_have_is_not_judged() {
    let rows = (0..50).map(|row| format!("{:.3},{:.6}\n", 1e-3 * f64::from(row), 0.01 * f64::from(row)));
    let found = judged(&(String::from("time,y\n") + &rows.collect::<String>()), MACHINE, None).unwrap();
    assert!(found.limits.iter().all(|limit| limit.axis == Some("Y")) && found.limits.len() == 3, "{found:?}");
    let said: Vec<_> = found.not_judged.iter().filter(|one| one.contains("no column")).collect();
    assert_eq!(said, ["limits of X: the log has no column of it"], "{:?}", found.not_judged);
}
