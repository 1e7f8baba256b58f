//! Drawings and JSON.

use part_program::{Curve, Part, Shape, inspect, read_part};
use proptest::prelude::*;

fn part(text: &str) -> Part {
    read_part("p", text).unwrap_or_else(|errors| panic!("{errors}"))
}

fn drawing(units: u8, entities: &str) -> String {
    let head =
        format!("0\nSECTION\n2\nHEADER\n9\n$ACADVER\n1\nAC1015\n9\n$INSUNITS\n70\n{units}\n0\nENDSEC\n");
    let pairs: String = entities.split_whitespace().map(|word| format!("{word}\n")).collect();
    format!("{head}0\nSECTION\n2\nENTITIES\n{pairs}0\nENDSEC\n0\nEOF\n")
}

const SPLINE: &str = "0 SPLINE 8 0 70 12 71 2 72 7 73 4
    40 0 40 0 40 0 40 0.25 40 1 40 1 40 1 41 1 41 2 41 0.5 41 1
    10 0 20 0 30 0 10 1.5 20 2 30 0 10 3 20 1 30 0 10 4 20 0 30 0";

#[test]
fn a_spline_keeps_its_numbers() {
    let part = part(&drawing(4, SPLINE));
    let curve = Curve {
        degree: 2,
        control_points_mm: vec![[0.0; 3], [1.5, 2.0, 0.0], [3.0, 1.0, 0.0], [4.0, 0.0, 0.0]],
        dimension: 2,
        weights: vec![1.0, 2.0, 0.5, 1.0],
        knots: vec![0.0, 0.0, 0.0, 0.25, 1.0, 1.0, 1.0],
    };
    assert_eq!(part.curves, [curve]);
}

#[test]
fn lines_arcs_circles_and_polylines() {
    let text = drawing(
        1,
        "0 LINE 8 0 10 0 20 0 30 0 11 1 21 0 31 0 0 ARC 8 0 10 0 20 0 30 0 40 1 50 0 51 90
         0 CIRCLE 8 0 10 5 20 5 30 0 40 2 0 LWPOLYLINE 8 0 90 3 70 1 10 0 20 0 42 1 10 2 20 0 10 2 20 2
         0 POINT 8 0 10 0 20 0 30 0",
    );
    let part = part(&text);
    let shapes: Vec<_> = part.moves.iter().map(|one| one.shape).collect();
    assert_eq!(shapes, [Shape::Line, Shape::Arc, Shape::Arc, Shape::Arc, Shape::Line, Shape::Line]);
    assert_eq!(part.curves[0].control_points_mm[1], [25.4, 0.0, 0.0]);
    let top = part.curves[1].control_points_mm[2];
    assert!((top[0]).abs() < 1e-14 && (top[1] - 25.4).abs() < 1e-14, "{top:?}");
    assert_eq!(part.curves[2].control_points_mm.len(), 9);
    // A bulge of 1 is a half circle, counterclockwise: from (0, 0) to (2, 0) through (1, -1).
    let half = &part.curves[3];
    assert_eq!(half.weights.len(), 5);
    assert!((half.control_points_mm[2][1] + 25.4).abs() < 1e-13, "{half:?}");
    assert_eq!(part.warnings.len(), 1);
    assert_eq!(
        (part.warnings[0].message.as_str(), part.warnings[0].line),
        ("1 × POINT left out: not read as a path", 86)
    );
    // A circle of radius 2 inches, a quarter of 1, half of 1, a square corner of 2 + 2, and a leg of 1.
    let quarters = 4.0 * 2.0 + 1.0 + 2.0;
    let expected = 25.4 * (quarters * std::f64::consts::FRAC_PI_2 + 2.0 + 8.0_f64.sqrt() + 1.0);
    assert!((inspect(&part).length_mm - expected).abs() < 1e-6, "{}", inspect(&part).length_mm);
}

/// A bulge is the tangent of a quarter of the turn: three quarters of a circle of radius 1 from (1, 0) to (0, -1).
#[test]
fn a_bulge_above_1_is_the_longer_arc() {
    let bulge = (0.75 * std::f64::consts::FRAC_PI_2).tan();
    let text = format!("0 LWPOLYLINE 90 2 70 0 38 7 10 1 20 0 42 {bulge} 10 0 20 -1");
    let part = part(&drawing(4, &text));
    let seen = inspect(&part);
    assert!((seen.length_mm - 1.5 * std::f64::consts::PI).abs() < 1e-9, "{}", seen.length_mm);
    let bend = seen.sharpest().unwrap();
    assert!(
        (bend.radius_mm - 1.0).abs() < 1e-12
            && (bend.point_mm[0].hypot(bend.point_mm[1]) - 1.0).abs() < 1e-12
    );
    assert_eq!(bend.point_mm[2], 7.0);
}

/// By the drawing's reference, a normal of (0, 0, -1) has its x axis along -x and its y axis along y.
#[test]
fn a_plane_that_is_turned_over_is_turned_back() {
    let arc = |normal: &str| {
        let text = format!("0 ARC 10 3 20 5 30 0 40 1 50 0 51 90 {normal}");
        part(&drawing(4, &text)).curves.remove(0).control_points_mm
    };
    let (up, down) = (arc(""), arc("210 0 220 0 230 -1"));
    assert_eq!((up[0], down[0]), ([4.0, 5.0, 0.0], [-4.0, 5.0, 0.0]));
    assert!(up.iter().zip(&down).all(|(up, down)| up[0] == -down[0] && up[1] == down[1]));
}

#[test]
fn what_is_left_out_of_a_drawing_is_counted() {
    let text = "0 TEXT 1 hello 0 LINE 10 0 20 0 11 1 21 1 0 LINE 67 1 10 0 20 0 11 5 21 5
        0 POLYLINE 70 0 0 VERTEX 10 0 20 0 0 SEQEND 0 TEXT 1 bye 0 LINE 10 1 20 1 11 1 21 1";
    let part = part(&drawing(0, text));
    let said: Vec<_> = part.warnings.iter().map(|warning| (warning.line, warning.message.as_str())).collect();
    let expected = [
        (12, "the drawing names no unit: its numbers are taken as millimetres"),
        (20, "2 × TEXT left out: not read as a path"),
        (34, "1 × LINE on paper left out: not read as a path"),
        (46, "1 × POLYLINE left out: not read as a path"),
    ];
    assert_eq!((said, part.curves.len(), part.standstills), (expected.to_vec(), 1, vec![62]));
}

/// A layer that is frozen or off, and an entity that is invisible, are not seen where they were drawn.
#[test]
fn what_is_hidden_is_left_out_and_counted() {
    let layers = "0\nSECTION\n2\nTABLES\n0\nTABLE\n2\nLAYER\n70\n3\n0\nLAYER\n2\nCut\n70\n4\n62\n7\n0\nLAYER\n2\nFrozen\n70\n1\n62\n7\n\
                  0\nLAYER\n2\nOff\n70\n0\n62\n-7\n0\nENDTAB\n0\nENDSEC\n";
    let line = |more: &str| format!("0 LINE {more} 10 0 20 0 11 1 21 1 ");
    let entities: String =
        ["8 Cut", "8 FROZEN", "8 Off", "8 Cut 60 1", "8 Cut 60 0", "8 Other", "67 1"].map(line).concat();
    let text = drawing(4, &entities)
        .replace("0\nSECTION\n2\nENTITIES\n", &format!("{layers}0\nSECTION\n2\nENTITIES\n"));
    let part = part(&text);
    let said: Vec<_> = part.warnings.iter().map(|warning| warning.message.as_str()).collect();
    let expected =
        ["3 × hidden LINE left out: not read as a path", "1 × LINE on paper left out: not read as a path"];
    assert_eq!((part.curves.len(), said), (3, expected.to_vec()));
}

#[test]
fn faults_of_drawings_are_said_at_their_places() {
    for (text, place, said) in [
        (drawing(2, "0 LINE 10 0 20 0 11 1 21 1"), "", ""),
        (drawing(3, "0 LINE 10 0 20 0 11 1 21 1"), "p:12:1", "the drawing is in the unit 3"),
        (drawing(4, ""), "p:1:1", "the drawing holds no curve"),
        (drawing(4, &SPLINE.replace("40 0.25", "40 2")), "p:40:1", "knots decrease: knot 4 is 1, after 2"),
        (drawing(4, &SPLINE.replace("41 2", "41 -2")), "p:48:1", "weight 1 is -2"),
        (drawing(4, &SPLINE.replace("72 7", "72 8")), "p:20:1", "has 7 knots and says that it has 8"),
        (drawing(4, &SPLINE.replace("40 0.25", "40 O.25")), "p:38:1", "`O.25` is no number"),
        (drawing(4, &SPLINE.replace("10 1.5 20 2", "10 1.5")), "p:60:1", "a point of this SPLINE has no y"),
        (drawing(4, &SPLINE.replace("71 2", "")), "p:20:1", "this SPLINE has no degree"),
        (drawing(4, "0 SPLINE 70 0 71 3 11 0 21 0 31 0"), "p:20:1", "this SPLINE has no control points"),
        (drawing(4, "0 LINE 10 x 20 0 11 1 21 1"), "p:22:1", "`x` is no number"),
        (drawing(4, "0 LINE 10 0 20 0"), "p:20:1", "a LINE has two ends"),
        (drawing(4, "0 LINE 20 0 10 0 20 0 11 1 21 1"), "p:22:1", "a group 20 before the group 10"),
        (drawing(4, "0 ARC 10 0 20 0 40 1 50 0"), "p:20:1", "this ARC has no last angle"),
        (drawing(4, "0 CIRCLE 10 0 20 0 40 0"), "p:20:1", "the radius is 0"),
        (
            drawing(4, "0 CIRCLE 10 0 20 0 40 1 210 1 220 0 230 0"),
            "p:20:1",
            "the plane of this CIRCLE is inclined",
        ),
        (drawing(4, "0 CIRCLE 10 99999999 20 0 40 1"), "p:20:1", "control point 0 has the coordinate"),
        (drawing(4, "0 LWPOLYLINE 90 1 10 0 20 0"), "p:20:1", "this LWPOLYLINE has no length"),
        (drawing(4, "0 LWPOLYLINE 42 1 10 0 20 0 10 1 20 1"), "p:22:1", "this bulge is none"),
        (drawing(4, "0 LINE 10 0 20 0 eleven 1 21 1"), "p:25:1", "this line ought to be a group code"),
        (drawing(4, SPLINE).replace("0\nEOF\n", ""), "p:79:1", "the drawing is cut off"),
    ] {
        match read_part("p", &text) {
            Ok(_) => assert_eq!(said, ""),
            Err(errors) => {
                let errors = errors.to_string();
                assert!(
                    !said.is_empty() && errors.contains(said) && errors.contains(place),
                    "{place} {said}: {errors}"
                );
            }
        }
    }
}

#[test]
fn every_fault_of_a_drawing_is_said() {
    let text = drawing(4, "0 LINE 10 x 20 0 11 1 21 y 0 CIRCLE 10 0 20 0 0 SPLINE 71 2");
    assert_eq!(read_part("p", &text).unwrap_err().count(), 4);
}

#[test]
fn formats_that_are_not_read_are_named() {
    for (text, said) in [
        ("ISO-10303-21;\nHEADER;\n", "this is a STEP file, which is not read"),
        ("AutoCAD Binary DXF\r\n\u{1a}\0", "this is a binary DXF file"),
        ("AC1027\0\0", "this is a DWG file"),
    ] {
        let errors = read_part("p", text).unwrap_err().to_string();
        assert!(errors.contains(said) && errors.contains("export the curves as DXF"), "{errors}");
    }
}

const JSON: &str = r#"{"shape": {"type": "curve", "count": 1, "data": [{"type": "spline", "rational": true, "dimension": 2,
 "degree": 2, "knotvector": [0, 0, 0, 0.5, 1, 1, 1], "delta": 0.01,
 "control_points": {"points": [[0, 0], [1, 2.5], [3, 1], [4, 0]], "weights": [1, 2, 0.5, 1]}}]}}"#;

#[test]
fn json_as_geomdl_exports_it() {
    let curve = part(JSON).curves.remove(0);
    assert_eq!((curve.degree, curve.dimension), (2, 2));
    assert_eq!(curve.control_points_mm[1], [1.0, 2.5, 0.0]);
    assert_eq!(curve.weights, [1.0, 2.0, 0.5, 1.0]);
    assert_eq!(curve.knots[3], 0.5);
    assert_eq!(part(JSON).warnings, []);
    let strange = part(&JSON.replace("\"delta\"", "\"trims\""));
    assert_eq!((strange.warnings[0].line, strange.warnings[0].column), (2, 15));
    for (from, to, said) in [
        ("\"degree\": 2,", "", "missing field `degree`"),
        ("\"curve\"", "\"surface\"", "`shape.type` is `surface`"),
        ("[1, 2.5]", "[1]", "control point 1 has 1 coordinates"),
        ("\"count\": 1", "\"count\": 2", "`shape.count` is not the number of curves, 1"),
        ("\"dimension\": 2", "\"dimension\": 3", "`dimension` is not that of its points, 2"),
        (", \"weights\": [1, 2, 0.5, 1]", "", "`rational` without weights"),
        ("\"delta\": 0.01", "\"knotvector\": 3", "duplicate field `knotvector`"),
        ("[1, 2, 0.5", "[1, 0, 0.5", "curve 0: weight 1 is 0"),
        ("0.5, 1, 1, 1]", "0.5, 1, 1]", "wrong number of knots: 6"),
        ("\"degree\"", "degree", "p:2:2"),
    ] {
        let errors = read_part("p", &JSON.replacen(from, to, 1)).unwrap_err().to_string();
        assert!(errors.contains(said), "{said}: {errors}");
    }
}

proptest! {
    #![proptest_config(ProptestConfig::with_cases(500))]

    /// A good file with a few bytes changed is read or refused.
    #[test]
    fn mutated_files_return(changes in prop::collection::vec((any::<prop::sample::Index>(), any::<u8>()), 1..6)) {
        for good in [drawing(4, SPLINE), JSON.to_owned()] {
            let mut bytes = good.into_bytes();
            for (at, byte) in &changes {
                let at = at.index(bytes.len());
                bytes[at] = *byte;
            }
            if let Ok(part) = part_program::read_part_bytes("p", &bytes, part_program::ReadOptions::default()) {
                for curve in &part.curves {
                    prop_assert_eq!(curve.faults(), []);
                }
            }
        }
    }
}
