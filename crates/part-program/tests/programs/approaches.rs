//! The way to the first curve is written where the program had it: before the words that stood behind it.

use part_program::{
    Dialect, Part, ReadOptions, read_part, read_part_with, write_curves, write_g1, write_g5_2, write_g06_2,
};
use proptest::prelude::*;

fn part(text: &str) -> Part {
    read_part("p.nc", text).unwrap_or_else(|errors| panic!("{errors}\n{text}"))
}

/// A program in every dialect, without what is the same in all.
fn written(part: &Part) -> [String; 3] {
    let written = [write_g06_2(part), write_g5_2(part), write_g1(part, 0.01, Some(Dialect::Fanuc))];
    written.map(|text| {
        let text = text.unwrap();
        text.strip_prefix("G21 G90 G94\n").and_then(|text| text.strip_suffix("M30\n")).unwrap().to_owned()
    })
}

/// `M3` was once written before the rapid move: the tool was on all the way to the part.
#[test]
fn words_behind_the_first_rapid_move_stay_behind_it() {
    let rest = "G1 X60. Y50. F1000.\nM5\nG0 X80. Y50.\nM3\nG1 X90. Y50.\nM5\n";
    let program = format!("G21 G90\nG0 X50 Y50\nM3 S100\n{}M30\n", rest.replace(" Y50.", ""));
    for text in written(&part(&program)) {
        assert_eq!(text, format!("G0 X50. Y50.\nM3 S100\n{rest}"));
    }
}

/// Each way to the first move with the blocks that are written of it.
#[test]
fn approaches_and_words_keep_their_order() {
    for (program, expected) in [
        ("T1 M6\nM3 S100\nG0 X5 Y5", "M6 T1\nM3 S100\nG0 X5. Y5.\n"),
        ("T1 M6\nG0 X5 Y5\nM3 S100", "M6 T1\nG0 X5. Y5.\nM3 S100\n"),
        ("T1 M6\nG0 X5 Y5 M8\nM3", "M6 T1\nM8\nG0 X5. Y5.\nM3\n"),
        ("M7\nG0 X5 Y5 M9\nM3", "M7\nG0 X5. Y5.\nM9\nM3\n"),
        ("G0 X5\nM7\nG0 Y5\nM3", "G0 X5.\nM7\nG0 Y5.\nM3\n"),
        ("G0 Z9\nM7\nG0 X5 Y5\nM3", "G0 Z9.\nM7\nG0 X5. Y5.\nM3\n"),
        ("G0 X5 Y5 Z9\nM3", "G0 Z9.\nG0 X5. Y5. Z9.\nM3\n"),
        ("G0 X5 Y5 Z-1\nM3", "G0 X5. Y5.\nG1 Z-1. F1000.\nM3\n"),
        ("G0 X5 Y5\nM3\nG0 Z-1", "G0 X5. Y5.\nM3\nG0 Z-1.\n"),
        // At the feed that it had, not at that of the first curve.
        ("G0 X5 Y5\nM3\nG1 Z-1 F80", "G0 X5. Y5.\nM3\nG1 Z-1. F80.\n"),
        ("M3\nG1 X5 Y5 F80", "M3\nG1 X5. Y5. F80.\n"),
        // What no block names is brought with the first block that names another axis.
        ("G0 X5\nM3", "G0 X5. Y0.\nM3\n"),
    ] {
        let before = part(&format!("G21 G90\n{program}\nG1 X60 F1000\nM5\nM30\n"));
        for text in written(&before) {
            assert!(text.starts_with(&format!("{expected}G1 X60. ")), "{program}\n{text}");
            let after = part(&text);
            assert_eq!(after.curves, before.curves, "{text}");
            assert_eq!(after.moves[0].feedrate_mm_per_s, before.moves[0].feedrate_mm_per_s, "{text}");
        }
    }
}

/// The program has no move to where they begin, so that one is written: not with the tool on.
#[test]
fn increments_begin_where_a_rapid_move_leads_before_the_tool_is_on() {
    for text in written(&part("T1 M6\nS100\nM3\nG91 G1 X5 F1000\nX3 Y4\n")) {
        assert!(text.starts_with("M6 T1\nS100\nG0 X0. Y0.\nM3\nG1 X5. Y0. F1000.\n"), "{text}");
    }
    for text in written(&part("G0 X5 Y5\nM3\nG91 G1 Z-1 F100\nX3\n")) {
        assert!(text.starts_with("G0 X5. Y5.\nM3\nG1 Z0. F100.\nG1 X5. Y5. Z-1.\n"), "{text}");
    }
}

/// Z is named when the first curve is over: it is taken to be there from the first.
#[test]
fn an_axis_that_is_named_late_is_brought_before_the_first_curve() {
    for (z, expected) in
        [("4", "G0 Z4.\nG0 X1. Y1. Z4.\nM3\nG1 X5."), ("-4", "G0 X1. Y1.\nM3\nG1 Z-4. F80.\nG1 X5.")]
    {
        for text in written(&part(&format!("G0 X1 Y1\nM3\nG1 X5 F80\nG1 Z{z}\nX9\n"))) {
            assert!(text.starts_with(expected), "{text}");
        }
    }
}

/// After a motion that is not read the place of the tool is unknown, as at the start.
#[test]
fn words_behind_a_later_approach_stay_behind_it() {
    let options = ReadOptions { lenient: true, dialect: None, ..ReadOptions::default() };
    let program = "G0 X0 Y0\nM3\nG1 X9 F60\nM5\nG38.2 X10 Y10\nG80\nG0 X50 Y50\nM3\nG1 X60\n";
    for text in written(&read_part_with("p.nc", program, options).unwrap()) {
        let expected = "G0 X0. Y0.\nM3\nG1 X9. Y0. F60.\nM5\nG0 X50. Y50.\nM3\nG1 X60. Y50.\n";
        assert_eq!(text, expected);
    }
}

/// Behind a block that is left out the axes are found one by one: the tool must not be down before it is there.
#[test]
fn a_place_that_is_found_again_is_approached_from_above() {
    let options = ReadOptions { lenient: true, ..ReadOptions::default() };
    let program = "G0 X0 Y0 Z1\nG1 X5 F300\nG38.2 X10 Y10 Z-2 F100\nG80\nG1 X0 Y0 F100\nX10 Y10 Z-1\nX20\n";
    for text in written(&read_part_with("p.nc", program, options).unwrap()) {
        assert!(text.contains("G0 X10. Y10.\nG0 Z-1.\nG1 X20. Y10. Z-1. F100.\n"), "{text}");
    }
}

/// A part in the plane Z = 0 was once written without a Z, and so cut at any height at which Z stood.
#[test]
fn a_z_of_0_is_written_if_the_program_names_it() {
    let program = "G21 G90\nG0 X0 Y0 Z0\nG1 X10 F1000\nG1 X10 Y10\nM30\n";
    let in_space = write_curves(&part(program));
    assert!(in_space.contains("[[0.0, 0.0, 0.0], [10.0, 0.0, 0.0]]"), "{in_space}");
    for before in [part(program), part(&in_space)] {
        for text in written(&before) {
            assert!(text.starts_with("G0 X0. Y0.\nG1 Z0. F1000.\nG1 X10. Y0.\n"), "{text}");
            assert_eq!(written(&part(&text))[0], text);
        }
    }
    for text in written(&part(&program.replace("G0 X0 Y0 Z0", "G0 Z0\nG0 X0 Y0"))) {
        assert!(text.starts_with("G0 Z0.\nG0 X0. Y0.\nG1 X10. Y0. F1000.\n"), "{text}");
    }
}

#[test]
fn a_part_that_never_names_z_has_none() {
    let drawing =
        "0\nSECTION\n2\nENTITIES\n0\nLINE\n10\n0.0\n20\n0.0\n11\n10.0\n21\n5.0\n0\nENDSEC\n0\nEOF\n";
    let file = "[curve]\ndegree = 1\ncontrol_points_mm = [[0, 0], [10, 5]]\nknots = [0, 0, 1, 1]\n";
    for text in [drawing, file, "G0 X0 Y0\nG1 X10 Y5\n"] {
        let before = part(text);
        for text in written(&before) {
            assert!(!text.contains('Z'), "{text}");
        }
        assert!(!write_curves(&before).contains("0.0, 0.0, 0.0"), "{}", write_curves(&before));
    }
}

proptest! {
    /// Whatever the order of the ways and words ahead of the first curve, they are written in it.
    #[test]
    fn any_order_is_kept(
        blocks in Just(["G0 X5.", "G0 Y-6.", "G0 Z7.", "G1 Z-7. F80.", "M6 T1", "M3 S90", "M7"]).prop_shuffle(),
        is_up in any::<bool>(),
    ) {
        let other = if is_up { "G1 Z-7. F80." } else { "G0 Z7." };
        let blocks: Vec<_> = blocks.into_iter().filter(|block| *block != other).collect();
        let before = part(&format!("{}\nG1 X9 F60\n", blocks.join("\n")));
        for text in written(&before) {
            prop_assert!(text.starts_with(&(blocks.join("\n") + "\nG1 X9. Y-6. ")), "{blocks:?}\n{text}");
            prop_assert_eq!(&part(&text).curves, &before.curves);
        }
    }
}
