//! Programs with faults, each with its place and the words of its message.

use expect_test::expect_file;
use part_program::{Dialect, ReadOptions, read_part, read_part_with};

/// Program, where the fault is, what is said.
const MALFORMED: &[(&str, &str, &str)] = &[
    // Words.
    ("G0 X", "1:4", "`X` has no number"),
    ("G0 XY5", "1:4", "`X` has no number"),
    ("G0 X Y5", "1:4", "`X` has no number"),
    ("G0 X1.2.3", "1:5", "`1.2.3` is no number"),
    ("G0 X--5", "1:5", "`--5` is no number"),
    ("G0 X5 12", "1:7", "the number `12` has no letter"),
    ("G0 X5 *", "1:7", "`*` is no part of a word"),
    ("G0 X5 é", "1:7", "`é` is no part of a word"),
    ("G0 X5 \0", "1:7", "`\\0` is no part of a word"),
    ("G0 (open", "1:4", "this comment has no end"),
    ("G0 X1 X2", "1:7", "`X2`: this address is there twice"),
    ("G0 X1 \nG1 F1 F2", "2:7", "`F2`: this address is there twice"),
    ("BSPLIN SD=3", "1:1", "did you mean `BSPLINE`"),
    ("COMPRESSOR", "1:1", "unknown word `COMPRESSOR`"),
    ("G0 X0 Y0\nG2 X10 I5 J0 AR=90", "2:14", "an arc by its angle has its end, or its centre"),
    ("G0 X0 Y0\nG1 ANG=45 X5", "2:4", "unknown word `ANG=`"),
    ("G0 X0 Y0\nG1 X5 RNDM = 2", "2:7", "unknown word `RNDM=`"),
    ("G0 X0 Y0\nG1 X5 ,R0\nG1 Y5", "2:7", "`,R0`: a corner of no size"),
    ("G0 X0 Y0\nG1 X5 ,R9\nG1 Y5", "2:7", "this corner takes 9.0000 mm of moves of 5.0000 and 5.0000 mm"),
    ("G0 X0 Y0\nG1 X5 ,C1\nG2 X9 I2", "2:7", "a corner between moves that are not both straight"),
    ("G0 X0 Y0\nG1 X5 ,R1\nM30", "2:7", "no move follows this corner"),
    ("G0 X0 Y0\nG1 X5 ,Q1", "2:7", "`,` is no part of a word"),
    (
        "G0 X0 Y0 Z9\no1 while [1]\nG83 X1 Z-9999 R1 Q1 L99\no1 endwhile",
        "3:1",
        "the program makes more curves than are taken",
    ),
    ("G0 X0 Y0\nG1 X5 CHF=1", "2:7", "no move follows this corner"),
    ("G0 X0 Y0\nG1 X5 POLF=R1", "2:7", "unknown word `POLF=`"),
    // What is computed.
    ("G0 X[1+2", "1:9", "the bracket of this expression is not closed here"),
    ("G0 X[1+]", "1:8", "a value is missing here"),
    ("G0 X[1/0]", "1:7", "a division by 0"),
    ("G0 X[0-1]**2", "1:10", "`*` is no part of a word"),
    ("G0 XSQRT[0-1]", "1:5", "SQRT of -1 is no number"),
    ("G0 X[LOG[5]]", "1:6", "`LOG` is no function"),
    ("G0 X#<depth>", "1:5", "`#<depth>` has no value"),
    ("G0 X#<depth", "1:5", "the name of this variable has no end"),
    ("#5", "1:1", "a variable without a letter before it or a value behind it"),
    ("#0=5", "1:1", "variable 0 cannot be given a value"),
    ("#[0-1]=5", "1:1", "there is no variable -1"),
    ("#1=[[[1]", "1:9", "the bracket of this expression is not closed here"),
    ("IF [1 EQ 1] GOTO 5", "1:1", "there is no block N5"),
    ("IF [1 EQ 1] G0 X5", "1:1", "IF without GOTO or THEN"),
    ("WHILE [1 LT 2] G0", "1:1", "WHILE without DO"),
    ("WHILE [1 GT 2] DO1", "1:1", "DO1 has no END1"),
    ("END1", "1:1", "END1 without DO1"),
    ("o1 if [1 GT 2]\nG0 X5", "1:1", "`O1` has no endif behind it"),
    ("o1 while [0]\nG0 X5", "1:1", "`O1` has no endwhile behind it"),
    ("o1 endwhile", "1:1", "the end of a loop that has not begun"),
    ("o1 endrepeat", "1:1", "endrepeat without repeat"),
    ("o1 break", "1:1", "break outside of loop `O1`"),
    ("o1 sub\nG0 X5", "1:1", "`O1` has no endsub behind it"),
    ("o1 return", "1:1", "`O1` was not called"),
    ("o<drill> call [1]", "1:1", "subroutine `O<drill>` is not in this file"),
    ("o<drill call", "1:2", "the name of this O-word has no end"),
    ("o1 sub\no1 call\no1 endsub\no1 call", "2:1", "more than 100 calls within one another"),
    ("M98", "1:1", "a call without the number of a program"),
    ("M98 P7", "1:1", "subprogram O7 is not in this file"),
    ("M98 P7\nM30\nO7\nG1 X5", "4:6", "the program ends within a subprogram"),
    ("DEF REAL DEPTH", "1:1", "`DEF` is not executed"),
    // Blocks.
    ("X5 Y5", "1:1", "coordinates without a motion"),
    ("G0 G1 X5", "1:4", "two motions in one block"),
    ("G21 G20 G0 X5\nX6", "1:5", "`G21` and `G20`: two units in one block"),
    ("G20 G71 G0 X5\nX6", "1:5", "`G20` and `G71`: two units in one block"),
    ("G90 G0 G91 X5\nX6", "1:8", "`G90` and `G91`: two kinds of coordinates in one block"),
    ("G17 G18 G0 X5\nX6", "1:5", "`G17` and `G18`: two planes in one block"),
    ("G93 G94 G0 X5\nX6", "1:5", "`G93` and `G94`: two kinds of feed in one block"),
    ("G90.1 G91.1 G0 X5\nX6", "1:7", "`G90.1` and `G91.1`: two kinds of arc centres in one block"),
    ("G61 G64 G0 X5\nX6", "1:5", "`G61` and `G64`: two path modes in one block"),
    ("G41 D1 X5", "1:1", "the radius of tool 1 is not known"),
    ("G0 X0\nG81 X5 Z-3", "2:1", "a cycle without R"),
    ("G0 X0\nG81 X5 R1", "2:1", "a cycle without Z"),
    ("G0 X0\nG81 X5 R1 Z2", "2:1", "the hole ends at 2.0000 mm, and begins at 1.0000 mm"),
    ("G0 X0\nG83 X5 R1 Z-2", "2:1", "a cycle in steps without their depth"),
    ("G0 X0\nG81 X5 R1 Z-2 L-1", "2:15", "a cycle that is repeated -1 times"),
    ("G10 L2 P12 X5", "1:1", "there is no work offset P12"),
    ("G96 S100", "1:1", "this is a program for a lathe"),
    ("G71 P10 Q20 U0.4", "1:1", "this is a program for a lathe"),
    ("G50 X100 Z50", "1:1", "`G50` is not read"),
    ("G1.23 X5", "1:1", "`G1.23` is not read"),
    ("G0 X0\nG1 X5 Q3", "2:7", "`Q3` is no word of G1"),
    ("G0 X0\nG1 X5 F0", "2:7", "the feed is 0"),
    ("G0 X0\nG1 X5 F-100", "2:7", "the feed is -100"),
    ("G93 G0 X0\nG1 X5", "2:1", "a move in inverse time feed without F"),
    (
        "G0 X0 Y0 Z5 A0\nG81 X1 Z-1 R1 F60 A9",
        "2:19",
        "`A9` moves an axis that is not followed while the tool cuts in this motion",
    ),
    ("G0 X0 Y0\nG2 X2 I1 P0", "2:10", "an arc of 0 turns"),
    ("G0 X0\nG1 X99999999", "2:1", "a coordinate is out of range"),
    ("", "1:1", "the program holds no curve"),
    ("(nothing)\nM30", "1:1", "the program holds no curve"),
    // Arcs.
    ("G0 X0 Y0\nG2 X5 Y5", "2:1", "an arc without centre or radius"),
    ("G0 X0 Y0\nG2 X5 Y5 I5 R5", "2:13", "an arc with both centre and radius"),
    ("G0 X0 Y0\nG2 X5 Y5 I5 K1", "2:13", "this centre word is not in the plane"),
    ("G0 X0 Y0\nG18 G2 X5 J1", "2:11", "this centre word is not in the plane"),
    ("G0 X0 Y0\nG2 X0 Y0 R5", "2:1", "an arc by radius ends where it starts"),
    ("G0 X0 Y0\nG2 X20 R5", "2:1", "radius 5 does not reach: start and end are 20.0000 mm apart"),
    (
        "G0 X0 Y0\nG2 X10 I3",
        "2:1",
        "the end is off the circle: radius 3.0000 at the start, 7.0000 at the end",
    ),
    ("G0 X0 Y0\nG2 X10 I0 J0", "2:1", "the centre of the arc is its start"),
    ("G2 X10 Y0 I5 J0", "1:1", "where this curve starts on X is not known"),
    ("G18 G0 X0 Y0\nG2 X10 I5", "2:1", "where this curve starts on Z is not known"),
    // FANUC.
    ("G06.2 P4 X0 Y0\n", "2:1", "PS1005"),
    ("G06.2 P1 K0 X0 Y0\n", "1:7", "order 1 is not supported"),
    ("G06.2 P2.5 K0 X0 Y0\n", "1:7", "order 2.5 is not supported"),
    ("G06.2 P2 K0 X0\nK0 X1\nK1\nG0 X5", "4:1", "PS1004: the curve ends after 1 closing knots"),
    ("G06.2 P2 K0 X0\nK0 X1\nG0 X5", "3:1", "PS1005: the curve ends without closing knots"),
    ("G06.2 P2 K0 X0\nK0 X1\nK1\nK1 X5", "4:1", "PS1004: a control point after closing knots"),
    ("G06.2 P2 K0 X0\nK0.5 X1\nK1\nK1", "2:1", "PS1007"),
    ("G06.2 P2 K0 X0\nK0 X1\nK0 X2\nK1\nK1", "3:1", "PS1008"),
    ("G0 X1\nG06.2 P2 K0 X0\nK0 X2\nK1\nK1", "2:1", "PS1009: the first control point is off"),
    ("G93 G06.2 P2 K0 X0", "1:1", "PS1006: a spline in inverse time feed"),
    ("G06.2 P2 K0 X0\nK0 X1\nK1\nK1\nK1", "5:1", "a knot after the closing knots"),
    ("G06.2 P2 K2 X0\nK2 X1\nK1\nK1", "3:1", "knots decrease"),
    ("G06.2 P2 K0 X0 R0\nK0 X1\nK1\nK1", "1:1", "weight 0 is 0"),
    ("G05 P5000", "1:5", "high-precision contouring P5000"),
    ("G05", "1:1", "G5 without its words"),
    // LinuxCNC.
    ("G0 X0 Y0\nG5.2 X1 Y1\nX2 Y2 P1\nG5.3", "2:1", "a control point of G5.2 without a weight"),
    ("G0 X0 Y0\nG5.2 X1 P1\nG5.3", "2:1", "a control point of G5.2 with one coordinate"),
    ("G0 X0 Y0\nG5.2 X1 Y1 P1\nG5.3", "2:1", "too few control points: 2"),
    ("G5.3", "1:1", "G5.3 without G5.2"),
    ("G0 X0 Y0\nG5.2 X1 Y1 P1\nX2 Y2 P1\nG0 X5", "4:1", "the curve of G5.2 is not ended"),
    ("G0 X0 Y0\nG5 X1 Y1 I1 P1 Q1", "2:1", "I without J"),
    ("G5.2 X1 Y1 P1\nX2 Y2 P1\nG5.3", "1:1", "where this curve starts on X is not known"),
    ("G0 X0\nG5.1 X1 Y1 I1 J2", "2:1", "where this curve starts on Y is not known"),
    ("G0 X0 Y0\nG5 X1 Y1 Z1 I1 J1 P1 Q1", "2:1", "G5 with Z"),
    ("G18 G0 X0 Z0\nG5.1 X1 Y1 I1 K1", "2:1", "G5.1 with Y"),
    ("G0 X0 Y0\nG5.2 X1 Y1 P1\nX2 Y2 Z1 P1\nX3 Y3 P1\nG5.3", "3:1", "G5.2 with Z"),
    ("G19 G0 X0 Y0\nG5.2 X1 Y1 P1\nX2 Y2 P1\nG5.3", "2:1", "where this curve starts on Z is not known"),
    // Siemens.
    ("G0 X0 Y0\nBSPLINE SD=3 X1 PL=1\nX2\nX3 Y1\nX4\n", "3:1", "a block of BSPLINE without a knot interval"),
    ("G0 X0 Y0\nBSPLINE SD=2 X1 PL=1\nX2 PL=2", "3:4", "a knot interval of 2 too many"),
    ("G0 X0 Y0\nBSPLINE SD=2 X1 PL=-1\nX2", "2:17", "the knot interval is -1"),
    ("G0 X0 Y0\nBSPLINE SD=12 X1 PL=1\nX2", "2:9", "degree 12 is not supported"),
    ("G0 X0 Y0\nBSPLINE SD=3 X1 PL=1\nX2 PL=1\n", "2:1", "too few control points: 3"),
];

#[test]
fn each_malformed_program_is_explained_at_its_place() {
    for &(text, place, said) in MALFORMED {
        let errors = match read_part("p", text) {
            Ok(part) => panic!("{text:?} was read: {part:?}"),
            Err(errors) => errors.to_string(),
        };
        assert!(errors.contains(said), "{text:?}: {said:?} is not in\n{errors}");
        assert!(errors.contains(&format!("p:{place}\n")), "{text:?}: not at {place}\n{errors}");
    }
}

/// Every message as it is printed. `UPDATE_EXPECT=1 cargo test -p part-program --test programs malformed` writes what is said now.
#[test]
fn what_is_said_of_malformed_programs() {
    let said = |text: &str| {
        read_part("p", text).map_or_else(|errors| errors.to_string(), |part| format!("{part:?}"))
    };
    let all: String = MALFORMED.iter().map(|(text, _, _)| format!("{text:?}\n{}\n\n", said(text))).collect();
    expect_file!["malformed.txt"].assert_eq(&all);
}

#[test]
fn every_error_of_a_program_is_said() {
    let text = "G0 X0 Y0\nG1 X5 Q1\nG1 X#<a>\nG2 X20 R1\nG77\nG1 Y\n";
    let errors = read_part("p", text).unwrap_err();
    assert_eq!(errors.iter().map(|error| error.line).collect::<Vec<_>>(), [2, 3, 4, 5, 6]);
}

/// Names with a number were taken letter by letter: a missing number each, and a value without a letter.
#[test]
fn an_unknown_name_with_its_number_is_one_error() {
    for word in ["AR=90", "ANG=45", "RNDM=2", "CHF=1", "ANG = -45.5"] {
        let errors = read_part("p", &format!("G0 X0 Y0\nG1 X5 {word} Y3\n")).unwrap_err();
        assert_eq!(errors.count(), 1, "{errors}");
    }
}

#[test]
fn a_text_beyond_the_limit_is_refused() {
    let text = format!("{{{}", " ".repeat(part_program::MAX_TEXT));
    let errors = read_part("p", &text).unwrap_err().to_string();
    assert!(errors.contains("the text has 67108865 bytes") && errors.contains("at most 64 MiB"), "{errors}");
}

/// The last word once won, without a message.
#[test]
fn a_contradiction_within_a_group_is_one_error_and_a_repetition_is_none() {
    for (program, faults) in [
        ("G90 G91 G17 G19 G1 X5 F60\nX6\n", 2),
        ("G90 G90 G21 G71 G17 G17 G0 X5 Y0\nG1 X6 F60\n", 0),
        ("G90 G91.1 G61 G0 X5 Y0\nG91 G64 G1 X6 F60\n", 0),
    ] {
        let said = read_part("p.nc", program).map_or_else(|errors| errors.count(), |_| 0);
        assert_eq!(said, faults, "{program}");
    }
}

/// One error was followed by others that it explains, up to one a block.
#[test]
fn an_error_is_not_followed_by_others_that_come_of_it() {
    let fanuc = "G06.2 P3 K0 X0 Y0\nK0 X10\nK0 X20 Y5 M8\nK1\nK1\nK1\nG1 X30 F60\n";
    for (text, said) in [
        ("G5 X10 F500\nG1 Y5\n".into(), "G5 without I and J"),
        ("G5 X10 I1 J1\nX20 P1 Q1\n".into(), "G5 without P and Q"),
        ("G5 X10 I1 P1 Q1\nG2 X30 R10\n".into(), "I without J"),
        ("G5.1 X10 Y10\nG1 Y5\n".into(), "G5.1 without I and J"),
        ("G93 G5.1 X10 Y10 I1 J1 F2\n".into(), "PS1006"),
        ("G5.2 X10 Y10\nX20 Y5 P1\nG5.3\n".into(), "without a weight"),
        ("G2 X10 Y5 K1\nG2 X20 R5\n".into(), "not in the plane"),
        (fanuc.replace("P3", "P1"), "order 1 is not supported"),
        (fanuc.replace("P3", "P3.5"), "order 3.5 is not supported"),
        (fanuc.replace("G06.2", "G93 G06.2").replace("F60", "F2"), "PS1006"),
        (fanuc.replace("G06.2", "G1 G06.2"), "two motions in one block"),
    ] {
        let errors = read_part("p", &format!("G0 X0 Y0\n{text}")).unwrap_err();
        assert!(errors.count() == 1 && errors.to_string().contains(said), "{text}{errors}");
    }
    let errors = read_part("p", "G5.2 X1 Y1 P1\nX2 Y2 P1\nX3 Y3 P1\nG5.3\nG1 X4\n").unwrap_err();
    assert_eq!(errors.count(), 1, "{errors}");
    let options = ReadOptions { lenient: false, dialect: Some(Dialect::Siemens), ..ReadOptions::default() };
    let errors = read_part_with("p", &format!("G0 X0 Y0\n{fanuc}"), options).unwrap_err();
    assert_eq!(errors.count(), 1, "{errors}");
}

/// A fault behind the curve is reported too.
#[test]
fn errors_behind_a_broken_curve_are_said() {
    let errors = read_part("p", "G0 X0 Y0\nG06.2 P1 K0 X0\nK0 X1\nK1\nG1 X5 Q1\nG2 X9\n").unwrap_err();
    assert_eq!(errors.iter().map(|error| error.line).collect::<Vec<_>>(), [2, 5, 6]);
}
