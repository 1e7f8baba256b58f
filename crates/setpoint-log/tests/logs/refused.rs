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
        ("0.498,1.0,0.0,0.0,-3", "line 500, column 19: the program's line is `-3`"),
        ("0.498,1.0,0.0,0.0,2.5", "line 500, column 19: the program's line is `2.5`"),
        ("0.498,1.0,0.0,0.0,1e20", "line 500, column 19: the program's line is `1e20`"),
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

/// Nobody knows which of two columns of one name is meant.
#[test]
fn two_columns_of_one_name_are_refused() {
    for (head, expected) in [
        ("time,x,y,X,line", "line 1, column 10: two columns are named `X`, 2 and 4"),
        ("time,time,x,y,z", "line 1, column 6: two columns are named `time`, 1 and 2"),
        ("t,positions[1],positions_1,a,b", "line 1, column 16: two columns are named `positions_1`, 2 and 3"),
    ] {
        let said = said(1, head);
        assert!(said.starts_with(expected), "{head}: {said}");
    }
    // Of columns that are not taken there may be any number.
    let text = corner(SOUND, SOUND).log(6).replacen("time,x,y,z,line", "time,x,a,a,a", 1);
    assert!(judged(&text, MACHINE, None).is_ok());
}

#[test]
fn a_number_of_a_setpoint_or_a_length_that_is_none_is_refused() {
    let said = |text: &str| judged(text, MACHINE, None).map(|_| ()).unwrap_err().to_string();
    let odd = said("sample,x\n1,0\n2.5,0\n");
    assert!(odd.starts_with("line 3, column 1: the number of the setpoint is `2.5`"), "{odd}");
    let negative = said("time,x,chord_mm\n0,0,0\n0.001,0,-1\n");
    assert!(negative.starts_with("line 3, column 9: the step's length is -1 mm"), "{negative}");
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
