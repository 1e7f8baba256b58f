//! Memory grows with the text and no faster, whatever the text. One test, because the count is of the whole process.

use std::fmt::Write;

use part_program::{MAX_DIAGNOSTICS, ReadOptions, read_part_bytes};
use peak_alloc::PeakAlloc;
use proptest::prelude::*;
use proptest::test_runner::TestRunner;

#[global_allocator]
static MEMORY: PeakAlloc = PeakAlloc;

/// Most bytes that reading a text takes beside the text itself.
fn peak(text: &[u8]) -> usize {
    let before = MEMORY.current_usage();
    MEMORY.reset_peak_usage();
    drop(read_part_bytes("p", text, ReadOptions::default()));
    MEMORY.peak_usage().saturating_sub(before)
}

fn repeated(head: &str, tail: &str, count: u32, line: impl Fn(u32) -> String) -> String {
    let mut text = String::from(head);
    for n in 0..count {
        let _ = writeln!(text, "{}", line(n));
    }
    text + tail
}

fn moves(count: u32) -> String {
    repeated("G90 G21 F6000\nG0 X0 Y0 Z0\n", "M30\n", count, |n| match n % 3 {
        0 => format!("N{n} G1 X{n}.125 Y{}", n % 7),
        1 => format!("G3 X{n}.5 R5 (an arc)"),
        _ => "Z-0.5 M8".to_owned(),
    })
}

/// Moves that take no heap of their own.
fn straight(count: u32) -> String {
    repeated("G90 G21 F6000\nG0 X0 Y0 Z0\n", "M30\n", count, |n| format!("G1 X{n}.1234 Y{}.5678", n % 1000))
}

fn spline(count: u32) -> String {
    repeated("G06.2 P4 K0 X0 Y0\n", "K1\nK1\nK1\nK1\n", count, |n| {
        format!("K{} X{n} Y{}", if n < 3 { 0.0 } else { f64::from(n) / f64::from(count + 1) }, n % 7)
    })
}

fn curve_file(count: u32) -> String {
    repeated("", "", count, |n| {
        format!("[[curve]]\ndegree = 1\ncontrol_points_mm = [[{n}, 0], [{n}, 1]]\nknots = [0, 0, 1, 1]")
    })
}

fn drawing(count: u32) -> String {
    let head = "0\nSECTION\n2\nHEADER\n9\n$INSUNITS\n70\n4\n0\nENDSEC\n0\nSECTION\n2\nENTITIES\n";
    repeated(head, "0\nENDSEC\n0\nEOF\n", count, |n| format!("0\nLINE\n10\n{n}\n20\n0\n11\n{n}\n21\n1"))
}

fn json(count: u32) -> String {
    let head = "{\"shape\": {\"type\": \"curve\", \"data\": [{\"degree\": 1, \"knotvector\": [0, 0, 1, 1],
        \"control_points\": {\"points\": [[0, 0], [1, 1]]}}";
    repeated(head, "]}}", count, |n| {
        format!(
            ",{{\"degree\":1,\"knotvector\":[0,0,1,1],\"control_points\":{{\"points\":[[{n},0],[{n},1]]}}}}"
        )
    })
}

fn faults(count: u32) -> String {
    repeated("", "", count, |n| format!("G1 X{n} Q7 XX"))
}

/// Short texts that ask for far more moves than they have bytes: loops, calls within calls, pecks, and drawings within drawings.
fn that_ask_for_much() -> [(&'static str, String); 5] {
    let head = "G21 G90 F600\nG0 X0 Y0 Z5\n";
    let block = |count| {
        repeated("0\nBLOCK\n2\nA\n10\n0\n20\n0\n", "0\nENDBLK\n", count, |n| {
            format!("0\nCIRCLE\n10\n{n}\n20\n0\n40\n1")
        })
    };
    let insert = |rows: u32| {
        let head = "0\nSECTION\n2\nHEADER\n9\n$INSUNITS\n70\n4\n0\nENDSEC\n0\nSECTION\n2\nBLOCKS\n";
        let entities = "0\nENDSEC\n0\nSECTION\n2\nENTITIES\n0\nINSERT\n2\nA\n10\n0\n20\n0\n70\n100\n71\n";
        format!("{head}{}{entities}{rows}\n44\n1\n45\n1\n0\nENDSEC\n0\nEOF\n", block(20))
    };
    [
        ("a loop", format!("{head}#1=0\nWHILE[#1LT9999999]DO1\nG1 X[#1/1000]\n#1=#1+1\nEND1\nM30\n")),
        (
            "calls within calls",
            format!(
                "{head}M98 P1000 L9999\nM30\nO1000\nM98 P2000 L9999\nM99\nO2000\nG91 G1 X0.01\nG3 X0.01 R1\nM99\n"
            ),
        ),
        ("pecks", format!("{head}G99 G83 X1 Y0 Z-900 R2 Q0.1 K9999\nM30\n")),
        ("turns of an arc", format!("{head}G1 X1 Y0\nG17 G3 X1 Y0 I-1 J0 P9999\nM30\n")),
        ("copies of a drawing", insert(9999)),
    ]
}

/// The most bytes that one of these takes: the moves that are made before there are too many.
const MOST_FOR_MUCH: usize = 64 << 20;

/// Bytes taken for each byte of any text. The worst are the tables of TOML.
const MOST_PER_BYTE: usize = 80;
/// Bytes taken whatever the text: the diagnostics that are kept, and tables.
const MOST_AT_ALL: usize = MAX_DIAGNOSTICS * 2048;

#[test]
fn memory_is_proportional_to_the_text() {
    type Make = fn(u32) -> String;
    let kinds: [(&str, Make, usize); 7] = [
        ("moves", moves, 25),
        ("straight moves", straight, 10),
        ("spline", spline, 10),
        ("curve file", curve_file, 80),
        ("drawing", drawing, 25),
        ("json", json, 25),
        ("faults", faults, 25),
    ];
    for (name, make, most_per_byte) in kinds {
        let (small, large) = (make(10_000), make(100_000));
        let (at_small, at_large) = (peak(small.as_bytes()), peak(large.as_bytes()));
        let lines = large.lines().count();
        eprintln!("{name}: {} bytes of text, {at_large} at most, {} a line", large.len(), at_large / lines);
        assert!(
            at_large <= most_per_byte * large.len() + MOST_AT_ALL,
            "{name}: {at_large} of {}",
            large.len()
        );
        // Vectors double: a tenfold text may take up to twenty times as much.
        assert!(at_large <= 20 * at_small, "{name}: {at_small} and {at_large}");
    }

    for (name, text) in that_ask_for_much() {
        let taken = peak(text.as_bytes());
        // Each is expanded, far beyond what a text of its length takes, and none without end.
        assert!(taken > 1000 * text.len(), "{name}: only {taken} bytes");
        assert!(taken <= MOST_FOR_MUCH, "{name}: {taken} bytes");
    }

    let pieces = [
        "G1",
        "G06.2",
        "G5.2",
        "G3",
        "X1",
        "Y-2",
        "K0",
        "P3",
        "R5",
        "PL=1",
        "(",
        "\n",
        "é",
        "0\nSECTION\n",
        "{",
        "[",
        "=",
    ];
    let any = prop_oneof![
        prop::collection::vec(any::<u8>(), 0..4000),
        prop::collection::vec(prop::sample::select(pieces.to_vec()), 0..2000)
            .prop_map(|p| p.concat().into_bytes()),
    ];
    TestRunner::deterministic()
        .run(&any, |bytes| {
            let taken = peak(&bytes);
            prop_assert!(taken <= MOST_PER_BYTE * bytes.len() + MOST_AT_ALL, "{taken} of {}", bytes.len());
            Ok(())
        })
        .unwrap_or_else(|error| panic!("{error}"));
}
