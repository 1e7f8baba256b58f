//! The contents of a part, and its oddities.

use std::f64::consts::{FRAC_PI_2, PI};

use part_program::{Oddity, inspect, read_part};

#[test]
fn counts_extent_and_joints() {
    let text = "G0 X0 Y0 F600\nG1 X10\nG3 X20 Y10 I0 J10\nG1 Y20\nX0 F1200\nG0 X-5\n";
    let part = read_part("p.nc", text).unwrap();
    let seen = inspect(&part);
    assert_eq!((seen.rapids, seen.lines, seen.arcs, seen.splines), (1, 3, 1, 0));
    assert_eq!(seen.degrees, Some((1, 2)));
    assert_eq!(seen.control_points, 11);
    assert_eq!(seen.bounding_box_mm, Some(([-5.0, 0.0, 0.0], [20.0, 20.0, 0.0])));
    assert_eq!(seen.feedrates_mm_per_s, Some((10.0, 20.0)));
    // Line to arc to line are tangent; the corner at (20, 20) is not.
    let joints: Vec<_> = seen.joints.iter().collect();
    assert_eq!(joints.len(), 1, "{joints:?}");
    let corner = joints[0];
    assert_eq!((corner.curve, corner.line, corner.gap_mm), (3, 5, 0.0));
    assert!((corner.tangent_break_rad - FRAC_PI_2).abs() < 1e-15);
    assert_eq!(seen.remarks, []);
}

#[test]
fn what_is_odd_is_said_with_its_line() {
    let text = "G0 X0 Y0\nG1 X0.0001\nG06.2 P3 K0 X0.0001 R1\nK0 X5 R500\nK0 X5\nK0.0000001 X9\nK1\nK1\nK1\n";
    let part = read_part("p.nc", text).unwrap();
    let seen = inspect(&part);
    let said: Vec<_> = seen.remarks.iter().map(|r| (r.line, r.oddity)).collect();
    let expected = [
        (2, Oddity::NoFeedrate),
        (2, Oddity::Tiny(0.0001)),
        (3, Oddity::NoFeedrate),
        (3, Oddity::Cusp(0.0)),
        (3, Oddity::RepeatedControlPoint(1)),
        (3, Oddity::WeightRatio(500.0)),
        (3, Oddity::ShortKnotSpan(2, 1e-7)),
    ];
    assert_eq!(said, expected);
    assert_eq!(said[4].1.to_string(), "control points 1 and 2 are the same");
}

/// Against closed forms: two straight moves of 10 mm and 5 mm, half a circle of radius 4, and a rapid move of 6 mm.
#[test]
fn lengths_and_bends() {
    let part = read_part("p.nc", "G0 X0 Y0 F60\nG1 X10\nX10 Y5\nG3 Y13 J4\nG0 Y19\n").unwrap();
    let seen = inspect(&part);
    assert!((seen.length_mm - (15.0 + 4.0 * PI)).abs() < 1e-9, "{}", seen.length_mm);
    assert_eq!((seen.rapid_length_mm, seen.bends.len()), (6.0, 1));
    let bend = seen.sharpest().unwrap();
    assert_eq!((bend.curve, bend.line), (2, 4));
    assert!((bend.radius_mm - 4.0).abs() < 1e-14, "{}", bend.radius_mm);
    assert!(((bend.point_mm[0] - 10.0).hypot(bend.point_mm[1] - 9.0) - 4.0).abs() < 1e-13);
}

#[test]
fn moves_that_go_nowhere_are_listed() {
    let part = read_part("p.nc", "G1 X0 Y0 F60\nG1 X10\nX10 Y0\nG0 X10\nG1 F30\nG1 X11 Z0\nG1 Z0\n").unwrap();
    assert_eq!(inspect(&part).standstills, [3, 7]);
}

#[test]
fn a_cusp_is_said() {
    let text = "[curve]\ndegree = 3\ncontrol_points_mm = [[0, 0], [10, 10], [0, 10], [10, 0]]\nknots = [0, 0, 0, 0, 1, 1, 1, 1]\n";
    let said: Vec<_> =
        inspect(&read_part("p.toml", text).unwrap()).remarks.iter().map(|r| r.oddity).collect();
    assert_eq!(said, [Oddity::NoFeedrate, Oddity::Cusp(0.0)]);
}

fn oddities(text: &str) -> Vec<Oddity> {
    inspect(&read_part("p.toml", text).unwrap()).remarks.iter().map(|remark| remark.oddity).collect()
}

/// `interpolate` refused this curve, and `check` found nothing suspicious.
#[test]
fn a_straight_curve_that_turns_back_is_a_cusp() {
    let text = "[curve]\ndegree = 2\ncontrol_points_mm = [[0, 0], [20, 0], [5, 0]]\nknots = [0, 0, 0, 1, 1, 1]\nfeedrate_mm_per_s = 5\n";
    assert_eq!(oddities(text), [Oddity::Cusp(0.0)]);
    assert_eq!(Oddity::Cusp(0.0).to_string(), "the curve comes to a cusp, where it stands still");
}

/// Straight ones, bows, waves, and weights that slow a curve down in its middle.
#[test]
fn a_smooth_curve_is_no_cusp() {
    for points in [
        "[0, 0], [2, 0], [9, 0]",
        "[0, 0], [50, 50], [100, 0]",
        "[0, 0], [1, 5], [7, -5], [9, 0]",
        "[0, 0], [3, 0], [3.001, 0], [9, 0]",
        "[0, 0], [1, 4], [4, 4], [4, 0], [9, 0]",
        "[0, 0], [1, 0], [1.5, 0], [2, 0], [8, 0], [9, 0]",
    ] {
        let degree = points.matches('[').count() - 1;
        for inner in ["1", "0.02", "90"] {
            let repeated = |number: &str, count: usize| vec![number; count].join(", ");
            let text = format!(
                "[curve]\ndegree = {degree}\ncontrol_points_mm = [{points}]\nfeedrate_mm_per_s = 5\n\
                 weights = [1, {}, 1]\nknots = [{}, {}]\n",
                repeated(inner, degree - 1),
                repeated("0", degree + 1),
                repeated("1", degree + 1)
            );
            assert_eq!(oddities(&text), [], "{text}");
        }
    }
}
