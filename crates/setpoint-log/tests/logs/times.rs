//! The times of a log: they win over the machine's period, and what is uneven in them is no missing row.

use std::fmt::Write;

use setpoint_log::{Judgement, LogError, LogOptions, judge};

use crate::motion::{MACHINE, SOUND, corner, machine};

/// The log of a sound motion whose rows have these times, in s.
fn log(decimals: usize, time_s: impl Fn(usize) -> f64) -> String {
    let mut text = String::from("time,x,y\n");
    for (index, ([x, y, _], _)) in corner(SOUND, SOUND).0.iter().enumerate() {
        let _ = writeln!(text, "{:.decimals$},{x:.6},{y:.6}", time_s(index));
    }
    text
}

fn judged(log: &str, period_s: Option<f64>) -> Result<Judgement, LogError> {
    judge(log.as_bytes(), &machine(MACHINE), &LogOptions { period_s, ..LogOptions::default() })
}

/// A log every 2 ms, of a machine whose period is 1 ms, has all of its rows.
#[test]
fn times_of_a_log_win_over_the_period_of_the_machine() {
    for decimals in [3, 4, 6] {
        let found = judged(&log(decimals, |index| 2e-3 * index as f64), None).unwrap();
        assert_eq!(found.faults(), [""; 0], "{decimals}");
        assert!((found.period_s - 2e-3).abs() < 1e-12, "{decimals}: {}", found.period_s);
    }
    // What the last decimal rounds is no other period.
    let found = judged(&log(4, |index| 1.00002e-3 * index as f64), None).unwrap();
    assert!((found.period_s - 1e-3).abs() < 1e-12, "{}", found.period_s);
    assert_eq!(found.faults(), [""; 0]);
}

#[test]
fn times_that_tell_no_period_are_refused_with_their_place() {
    let said = |log: String| judged(&log, None).map(|_| ()).unwrap_err().to_string();
    let stays = said(log(3, |_| 0.5));
    assert!(stays.starts_with("line 7, column 1: the time stays at 0.5 s while the axes move"), "{stays}");
    for step_s in [1e-7, 2.0] {
        let outside = said(log(9, |index| step_s * index as f64));
        assert!(outside.contains("column 1: by its times") && outside.contains("--period"), "{outside}");
    }
}

/// A log every 1000 ms of a machine whose period is 1 ms was judged, and kept every limit.
#[test]
fn times_in_another_unit_are_told_by_the_period_of_the_machine() {
    for (name, per_period, seems, other) in
        [("time", 1.0, "ms", "time_ms"), ("time", 0.5, "ms", "time_ms"), ("time_ms", 1e-3, "s", "time")]
    {
        let text = log(6, |index| per_period * index as f64).replacen("time", name, 1);
        let said = judged(&text, None).map(|_| ()).unwrap_err().to_string();
        let expected = format!("the times seem to be in {seems}: expected the name `{other}`");
        assert!(said.contains(&expected) && said.starts_with("line 3, column 1: "), "{said}");
        let told = judged(&text.replacen(name, other, 1), None).unwrap();
        assert_eq!(
            (1e6 * told.period_s).round(),
            if per_period < 1.0 && seems == "ms" { 500.0 } else { 1000.0 }
        );
    }
}

/// Steps of 1.5 and 0.5 ms, and times that are off by up to 0.3 ms: refused, and no row is missing where the period is given.
#[test]
fn uneven_times_are_no_missing_rows() {
    let alternating = |index: usize| 1e-3 * index as f64 + if index % 2 == 1 { 5e-4 } else { 0.0 };
    let off = |index: usize| 1e-3 * index as f64 + 3e-4 * (2.4 * index as f64).sin();
    let late = |index: usize| 1e-3 * index as f64 + if index == 700 { 4e-4 } else { 0.0 };
    for text in [log(6, alternating), log(6, off), log(6, late)] {
        let said = judged(&text, None).map(|_| ()).unwrap_err().to_string();
        assert!(said.starts_with("line ") && said.contains("--period"), "{said}");
        let found = judged(&text, Some(1e-3)).unwrap();
        assert_eq!(found.faults(), [""; 0]);
        assert!(found.uneven_s > 3e-4, "{}", found.uneven_s);
    }
    let little = |index: usize| 1e-3 * index as f64 + 2e-5 * (2.4 * index as f64).sin();
    let found = judged(&log(6, little), None).unwrap();
    assert!(found.faults().is_empty() && found.uneven_s > 1e-5, "{:?} {}", found.faults(), found.uneven_s);
}
