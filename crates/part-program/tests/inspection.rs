//! What a part holds, and what is odd about it.

use std::f64::consts::{FRAC_PI_2, PI};

use part_program::{Oddity, inspect, read_part};

#[test]
fn counts_extent_and_joints() {
    let text = "G0 X0 Y0 F600\nG1 X10\nG3 X20 Y10 I0 J10\nG1 Y20\nX0 F1200\nG0 X-5\n";
    let seen = inspect(&read_part("p.nc", text).unwrap());
    assert_eq!((seen.rapids, seen.lines, seen.arcs, seen.splines), (1, 3, 1, 0));
    assert_eq!(seen.degrees, Some((1, 2)));
    assert_eq!(seen.control_points, 11);
    assert_eq!(seen.bounding_box_mm, Some(([-5.0, 0.0, 0.0], [20.0, 20.0, 0.0])));
    assert_eq!(seen.feedrates_mm_per_s, Some((10.0, 20.0)));
    // Line to arc to line are tangent; the corner at (20, 20) is not.
    assert_eq!(seen.joints.len(), 1, "{:?}", seen.joints);
    let corner = seen.joints[0];
    assert_eq!((corner.curve, corner.line, corner.gap_mm), (3, 5, 0.0));
    assert!((corner.tangent_break_rad - FRAC_PI_2).abs() < 1e-15);
    assert_eq!(seen.remarks, []);
}

#[test]
fn what_is_odd_is_said_with_its_line() {
    let text = "G0 X0 Y0\nG1 X0.0001\nG06.2 P3 K0 X0.0001 R1\nK0 X5 R500\nK0 X5\nK0.0000001 X9\nK1\nK1\nK1\n";
    let seen = inspect(&read_part("p.nc", text).unwrap());
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
    let seen = inspect(&read_part("p.nc", "G0 X0 Y0 F60\nG1 X10\nX10 Y5\nG3 Y13 J4\nG0 Y19\n").unwrap());
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
