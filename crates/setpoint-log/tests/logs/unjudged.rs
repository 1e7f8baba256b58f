//! What a log does not show is told as such.

use setpoint_log::LimitVerdict;

use crate::motion::{MACHINE, Motion, SOUND, corner, judged};

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
