//! Logs that cannot be judged: the message names line and column.

use crate::motion::{MACHINE, SOUND, corner, judged};

/// The message for a log of a sound motion with one of its lines, from 1, replaced.
fn said(line: usize, by: &str) -> String {
    let text = corner(SOUND, SOUND).log(6);
    let lines = text.lines().enumerate().map(|(index, own)| if index + 1 == line { by } else { own });
    let log = lines.fold(String::new(), |text, line| text + line + "\n");
    judged(&log, MACHINE, None).map(|_| ()).unwrap_err().to_string()
}

#[test]
fn bad_rows_are_refused_with_line_and_column() {
    for (by, expected) in [
        ("0.498,1.0,nan,0.0,2", "line 500, column 11: Y is `nan`"),
        ("0.498,1.0,inf,0.0,2", "line 500, column 11: Y is `inf`"),
        ("0.498,,0.0,0.0,2", "line 500, column 7: X is ``"),
        ("0.498,1.0,0.0", "line 500, column 11: no Z: the row has 3 columns"),
        ("0.3,1.0,0.0,0.0,2", "line 500, column 1: the time goes back from 0.497 s to 0.3 s"),
        ("0.498,1e300,0.0,0.0,2", "line 500, column 7: X is 1e300 mm"),
        ("1e300,1.0,0.0,0.0,2", "line 500, column 1: the time is 1e300 s"),
        ("0.498,1.0,0.0,0.0,two", "line 500, column 19: the program's line is `two`"),
        ("once upon a time", "line 500, column 1: no X"),
    ] {
        let said = said(500, by);
        assert!(said.starts_with(expected), "{by}: {said}");
        assert!(said.contains("expected"), "{said}");
    }
    assert!(
        said(1, "time,speed").starts_with("line 1, column 1: no column is X, Y or Z among `time`, `speed`")
    );
    assert!(said(1, "0,1,2,3,4").contains("no head that names them"));
}

#[test]
fn a_log_that_says_nothing_is_refused() {
    for log in ["", "\n\n", "time,x\n", "time,x\n0,1\n"] {
        assert!(judged(log, MACHINE, None).is_err(), "{log:?}");
    }
    let no_time = judged("x\n0\n0\n0\n", "[machine]\n", None).map(|_| ()).unwrap_err().to_string();
    assert!(no_time.contains("how long a period is"), "{no_time}");
}

/// Bytes of any kind end with findings or a message.
#[test]
fn anything_else_is_refused_and_nothing_panics() {
    let mut state = 0x2545_f491_4f6c_dd1d_u64;
    let mut draw = || {
        state ^= state << 13;
        state ^= state >> 7;
        state ^= state << 17;
        state
    };
    let words = [
        "time,x,y\n",
        "0.001",
        ",",
        "\n",
        "-1e9",
        "nan",
        "{",
        "\u{3}",
        "x",
        "overrun\n",
        "1",
        ".",
        "e5",
        " ",
        "0,0,0\n",
    ];
    for _ in 0..3000 {
        let mut log = if draw() % 2 == 0 { "time,x,y\n0,0,0\n".to_string() } else { String::new() };
        for _ in 0..draw() % 60 {
            log += words[usize::try_from(draw() % words.len() as u64).unwrap()];
        }
        let part = (draw() % 2 == 0).then_some(("G1 X1 F100\nG2 X2 Y1 R1\n", Some(0.01)));
        let _ = judged(&log, MACHINE, part);
    }
}
