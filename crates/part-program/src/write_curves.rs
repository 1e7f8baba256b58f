//! A part as a curve file, which reads back as the same curves, moves and machine.

use std::fmt::Write;

use serde::Serialize;

use crate::curve::Curve;
use crate::machine::Machine;
use crate::moves::MoveKind;
use crate::part::Part;
use crate::rest::Rest;

/// Writes the curves of a part, each a table `[[curve]]`, and its machine.
///
/// Numbers are the shortest decimals that read back as the same f64. Words that do not move the tool are not part of a
/// curve file, but their rests are, as exact stops. The lines of the moves are those of the new file.
#[must_use]
pub fn write_curves(part: &Part) -> String {
    let mut text = String::new();
    let planar = !part.names_z();
    for (index, (curve, one)) in part.curves.iter().zip(&part.moves).enumerate() {
        text.push_str("[[curve]]\n");
        if one.kind == MoveKind::Rapid {
            text.push_str("move = \"rapid\"\n");
        }
        if one.exact_stop
            || (one.kind == MoveKind::Feed && part.rest_before(index + 1) == Some(Rest::Auxiliary))
        {
            text.push_str("exact_stop = true\n");
        }
        if let Some(feedrate) = one.feedrate_mm_per_s {
            // Writing to a String cannot fail.
            let _ = writeln!(text, "feedrate_mm_per_s = {feedrate:?}");
        }
        numbers(&mut text, curve, planar);
    }
    text.push_str(&part.machine.as_ref().map(machine).unwrap_or_default());
    text
}

fn numbers(text: &mut String, curve: &Curve, planar: bool) {
    let axes = if planar { 2 } else { 3 };
    let points: Vec<_> = curve.control_points_mm().iter().map(|point| &point[..axes]).collect();
    let _ = writeln!(text, "degree = {}\ncontrol_points_mm = {points:?}", curve.degree());
    if curve.weights().iter().any(|weight| *weight != 1.0) {
        let _ = writeln!(text, "weights = {:?}", curve.weights());
    }
    let _ = writeln!(text, "knots = {:?}\n", curve.knots());
}

fn machine(machine: &Machine) -> String {
    #[derive(Serialize)]
    struct File<'m> {
        machine: &'m Machine,
    }
    // A struct of numbers is always a table.
    toml::to_string(&File { machine }).unwrap_or_default()
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::{Junction, Move, Nurbs, Shape, read_part};

    const PROGRAM: &str = "G0 X1 Y2 Z5\nG0 X0.1\nG1 Z-0.2 F300\nG1 X10 F2400\nG3 X20 Y12 R10\nG06.2 P3 K0 X20 Y12\nK0 X30 R2\nK0 X30 Y0 Z0.0000001\nK1\nK1\nK1\nM30\n";

    #[test]
    fn what_is_written_reads_back() {
        let machine = crate::read_machine("m", include_str!("../../../data/seed-000.toml")).unwrap();
        let axes = crate::Axes {
            y: crate::AxisLimits {
                velocity_mm_per_s: Some(250.0),
                velocity_jump_mm_per_s: Some(2.5),
                ..crate::AxisLimits::default()
            },
            ..crate::Axes::default()
        };
        let stop = Machine { axes: crate::Axes::default(), junction: Junction::Stop, ..machine.clone() };
        let deviation = Machine { junction: Junction::DeviationMm(0.01), ..stop.clone() };
        let jump = Machine { junction: Junction::VelocityJump, axes, ..machine };
        for machine in [None, Some(stop), Some(deviation), Some(jump)] {
            let part = Part { machine, ..read_part("p.nc", PROGRAM).unwrap() };
            let again = read_part("p.toml", &write_curves(&part)).unwrap();
            assert_eq!(
                again.curves,
                part.curves
                    .iter()
                    .map(|c| Nurbs { dimension: 3, ..c.to_nurbs() }.into())
                    .collect::<Vec<Curve>>()
            );
            assert_eq!((&again.machine, again.feedrate_mm_per_s), (&part.machine, part.feedrate_mm_per_s));
            let said = |m: &Move| (m.kind, m.feedrate_mm_per_s);
            assert!(again.moves.iter().map(said).eq(part.moves.iter().map(said)));
            assert_eq!((again.moves[0].shape, again.moves[0].line), (Shape::Line, 1));
        }
    }

    /// The rest was once lost with the word, and the plan of the curves went on at full feed.
    #[test]
    fn a_rest_at_a_word_is_an_exact_stop() {
        let program = "G0 X0 Y0\nM3 S900\nG1 X10 F600\nM8\nX20\nX30\nX40 M9\nX50\nM5\nM30\n";
        let again = read_part("p.toml", &write_curves(&read_part("p.nc", program).unwrap())).unwrap();
        let stops: Vec<_> = again.moves.iter().map(|one| one.exact_stop).collect();
        // Before M8, and on both sides of the block with M9; the path's end is one anyhow.
        assert_eq!(stops, [true, false, true, true, false]);
    }

    #[test]
    fn a_planar_part_stays_planar() {
        let part = read_part("p.nc", "G1 X0 Y0 F60\nG1 X1 Y2\n").unwrap();
        let text = write_curves(&part);
        assert!(text.contains("control_points_mm = [[0.0, 0.0], [1.0, 2.0]]"), "{text}");
        assert_eq!(read_part("p.toml", &text).unwrap().curves, part.curves);
    }

    #[test]
    fn what_is_wrong_with_one_of_several_curves_is_said_at_its_place() {
        let one = "[[curve]]\ndegree = 1\ncontrol_points_mm = [[0, 0], [1, 0]]\nknots = [0, 0, 1, 1]\n";
        let said = |last: &str| read_part("p.toml", &format!("{one}{one}{last}")).unwrap_err().to_string();
        for (last, expected) in [
            ("move = 3\n", "p.toml:9:8"),
            ("move = \"quick\"\n", "\"feed\" or \"rapid\""),
            ("feedrate_mm_per_s = 0\n", "`feedrate_mm_per_s` is 0"),
            ("feed = 3\n", "unknown key `feed` in [curve]"),
            ("[[curve]]\ndegree = 1\n", "p.toml:9:1"),
        ] {
            assert!(said(last).contains(expected), "{last}: {}", said(last));
        }
        assert!(read_part("p.toml", "curve = [1]\n").unwrap_err().to_string().contains("`curve` holds"));
    }
}
