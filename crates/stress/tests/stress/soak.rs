//! A soak: its paths, and what it keeps of them.

use stress::{SOAK_FORMATS, Soak, SoakFormat, SoakPaths, SoakViolation, SoakedPath, SoakedRun, soak_path};

/// Violations that are kept in full.
const MOST_KEPT: usize = 100;

const PATHS: SoakPaths = SoakPaths { seed: 7, full_speed: false };

fn some() -> [SoakFormat; 3] {
    [0, 3, 10].map(|format| SOAK_FORMATS[format])
}

#[test]
fn a_path_is_the_same_each_time_and_runs_in_several_formats() {
    let some = some();
    let (one, again) =
        (soak_path(PATHS, 4, &some, |_| false), soak_path(PATHS, 4, &some, |format| format == 1));
    assert_eq!((one.runs[0], one.runs[2]), (again.runs[0], again.runs[2]));
    assert_eq!(again.runs[1], SoakedRun::Spared);
    let mut soak = Soak::new(PATHS, &some);
    for path in 0..10 {
        soak.add(soak_path(PATHS, path, &some, |_| false));
    }
    assert!(soak.least_periods() > 1000, "{soak:?}");
    assert_eq!((soak.next_path, soak.violations), (10, 0), "{:?}", soak.first_violations);
    assert!(soak.formats.iter().all(|soaked| soaked.paths + soaked.refused == 10));
}

#[test]
fn at_full_speed_a_path_takes_as_many_periods_as_planned() {
    let periods = |full_speed| {
        let soaked = soak_path(SoakPaths { full_speed, ..PATHS }, 2, &some()[..1], |_| false);
        let SoakedRun::Ran(figures) = soaked.runs[0] else { panic!("{:?}", soaked.violations) };
        figures.periods
    };
    let (planned, slowed) = (periods(true), periods(false));
    assert!(planned * 60 < slowed && slowed < planned * 66, "{planned} {slowed}");
}

#[test]
fn what_was_broken_is_counted_and_the_first_of_it_kept() {
    let mut soak = Soak::new(PATHS, &some());
    for path in 0..MOST_KEPT as u64 + 5 {
        let violation = SoakViolation { path, what: "chord error".to_string() };
        let runs = vec![SoakedRun::Refused; some().len()];
        soak.add(SoakedPath { runs, violations: vec![violation], ..SoakedPath::default() });
    }
    assert_eq!(soak.violations, MOST_KEPT as u64 + 5);
    assert_eq!(soak.first_violations.len(), MOST_KEPT);
    assert_eq!(soak.first_violations.last().map(|last| last.path), Some(MOST_KEPT as u64 - 1));
}
