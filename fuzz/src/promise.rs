//! What is promised of any bytes. A reader returns; what it returns is valid, and reads back when it is written. A run
//! along the path that the bytes stand for keeps the promises of `stress`.

#![forbid(unsafe_code)]

use kernel_oracle::KernelFault;
use part_program::{
    Curve, Dialect, MoveKind, Part, ReadOptions, inspect, read_part, read_part_bytes, write_curves,
    write_g5_2, write_g06_2,
};
use real::Backend;
use secant_interp::Method;
use stress::{OnCurve, OnPieces, PlannedPath, RandomPath, Violation};

/// The longest plan that a fuzzer has time for.
pub const MOST_PERIODS: u32 = 2_000;

/// The value of a check.
///
/// # Panics
/// When a promise is broken.
pub fn expect<T>(checked: Result<T, Violation>) -> T {
    checked.unwrap_or_else(|violation| panic!("{violation}"))
}

/// The value of a check of a kernel.
///
/// # Panics
/// When a result is not the right one.
pub fn right<T>(checked: Result<T, KernelFault>) -> T {
    checked.unwrap_or_else(|fault| panic!("{fault}"))
}

/// Plans and runs the path that `bytes` stand for in the format `R`, on pieces and on the global parameter.
///
/// # Panics
/// When a step breaks a promise.
pub fn runs<R: Backend>(bytes: &[u8]) {
    let Some(path) = RandomPath::<2>::from_bytes(bytes) else { return };
    let path = if bytes.len() % 2 == 1 { path.passing_corners() } else { path };
    let path = if bytes.len() % 4 >= 2 { path.fastest() } else { path };
    let Some(planned) = PlannedPath::new(&path, MOST_PERIODS) else { return };
    if let Ok(run) = OnPieces::<R, 2>::new(&planned) {
        expect(run.run());
    }
    if let Ok(run) = OnCurve::<R, 2>::new(&planned) {
        for method in [Method::Secant, Method::Taylor1, Method::Taylor2] {
            expect(run.run(method));
        }
    }
}

/// Reads `bytes` and holds the reader to its word.
///
/// # Panics
/// When it breaks it.
pub fn holds(bytes: &[u8], dialect: Option<Dialect>, lenient: bool) {
    let part = match read_part_bytes("any", bytes, ReadOptions { dialect, lenient, ..ReadOptions::default() })
    {
        Ok(part) => part,
        Err(errors) => {
            assert!(errors.count() > 0, "refused without a word");
            assert!(!errors.to_string().is_empty());
            return;
        }
    };
    assert_eq!(part.curves.len(), part.moves.len());
    for curve in &part.curves {
        assert_eq!(curve.faults(), []);
    }
    // Loops and cycles may make more curves than there is time to write and read.
    if part.curves.len() > 10_000 {
        return;
    }
    let seen = inspect(&part);
    assert!(seen.length_mm.is_finite() && seen.rapid_length_mm.is_finite());
    if let Ok(text) = write_g5_2(&part) {
        reads_back(&text, None);
    }
    let curves = at_feed(&part);
    if let Ok(text) = write_g06_2(&part) {
        reads_back(&text, Some(&curves));
    }
    reads_back(&write_curves(&part), None);
}

fn reads_back(text: &str, curves: Option<&[&Curve]>) {
    match (read_part("again", text), curves) {
        (Ok(again), Some(curves)) => assert_eq!(at_feed(&again), curves, "{text}"),
        (Ok(_), None) => {}
        (Err(errors), _) => panic!("{errors}\n{text}"),
    }
}

fn at_feed(part: &Part) -> Vec<&Curve> {
    let feed = part.curves.iter().zip(&part.moves).filter(|(_, one)| one.kind == MoveKind::Feed);
    feed.map(|(curve, _)| curve).collect()
}
