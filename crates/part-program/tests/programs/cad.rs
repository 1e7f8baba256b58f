//! Drawings and JSON.

use part_program::{Nurbs, Part, ReadOptions, Shape, Unit, inspect, read_part, read_part_with};
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
    let curve = Nurbs {
        degree: 2,
        control_points_mm: vec![[0.0; 3], [1.5, 2.0, 0.0], [3.0, 1.0, 0.0], [4.0, 0.0, 0.0]],
        dimension: 2,
        weights: vec![1.0, 2.0, 0.5, 1.0],
        knots: vec![0.0, 0.0, 0.0, 0.25, 1.0, 1.0, 1.0],
    };
    assert_eq!(part.curves, [curve.into()]);
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
    assert_eq!(part.curves[0].control_points_mm()[1], [25.4, 0.0, 0.0]);
    let top = part.curves[1].control_points_mm()[2];
    assert!((top[0]).abs() < 1e-14 && (top[1] - 25.4).abs() < 1e-14, "{top:?}");
    assert_eq!(part.curves[2].control_points_mm().len(), 9);
    // A bulge of 1 is a half circle, counterclockwise: from (0, 0) to (2, 0) through (1, -1).
    let half = &part.curves[3];
    assert_eq!(half.weights().len(), 5);
    assert!((half.control_points_mm()[2][1] + 25.4).abs() < 1e-13, "{half:?}");
    assert_eq!(part.warnings.len(), 1);
    assert_eq!((part.warnings[0].message.as_str(), part.warnings[0].line), ("left out: 1 POINT", 86));
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
    assert!((bend.point_mm[2] - 7.0).abs() < 1e-14, "{bend:?}");
}

/// By the drawing's reference, a normal of (0, 0, -1) has its x axis along -x and its y axis along y.
#[test]
fn a_plane_that_is_turned_over_is_turned_back() {
    let arc = |normal: &str| {
        let text = format!("0 ARC 10 3 20 5 30 0 40 1 50 0 51 90 {normal}");
        part(&drawing(4, &text)).curves.remove(0).control_points_mm().to_vec()
    };
    let (up, down) = (arc(""), arc("210 0 220 0 230 -1"));
    assert_eq!((up[0], down[0]), ([4.0, 5.0, 0.0], [-4.0, 5.0, 0.0]));
    assert!(up.iter().zip(&down).all(|(up, down)| up[0] == -down[0] && up[1] == down[1]));
}

#[test]
fn what_is_left_out_of_a_drawing_is_counted() {
    let text = "0 TEXT 1 hello 0 LINE 10 0 20 0 11 1 21 1 0 LINE 67 1 10 0 20 0 11 5 21 5
        0 POLYLINE 70 16 0 VERTEX 10 0 20 0 0 SEQEND 0 TEXT 1 bye 0 VIEWPORT 67 1 0 LINE 10 1 20 1 11 1 21 1";
    let part = part(&drawing(0, text));
    let said: Vec<_> = part.warnings.iter().map(|warning| (warning.line, warning.message.as_str())).collect();
    let expected = [
        (12, "the drawing names no unit: its numbers are taken as millimetres"),
        (20, "left out: 2 TEXT, 1 LINE on paper, 1 POLYLINE of a mesh"),
    ];
    assert_eq!((said, part.curves.len(), part.standstills), (expected.to_vec(), 1, vec![66]));
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
    let expected = ["left out: 3 hidden LINE, 1 LINE on paper"];
    assert_eq!((part.curves.len(), said), (3, expected.to_vec()));
}

/// What AutoCAD's help says of layers, and what ezdxf's drawing frontend does: a block on a layer that is off shows its entities of
/// other layers, and on one that is frozen nothing. Layer 0 in a block is the layer of the insert, through blocks within blocks.
#[test]
fn a_block_on_a_layer_that_is_off_shows_its_other_layers() {
    const LAYERS: &str =
        "0 SECTION 2 TABLES 0 TABLE 2 LAYER 70 4 0 LAYER 2 A 70 0 62 7 0 LAYER 2 Off 70 0 62 -7
        0 LAYER 2 Frz 70 1 62 7 0 LAYER 2 0 70 0 62 7 0 ENDTAB 0 ENDSEC ";
    const BLOCKS: &str = "0 BLOCK 2 OnA 10 0 20 0 0 LINE 8 A 10 0 20 0 11 100 21 0 0 ENDBLK
        0 BLOCK 2 On0 10 0 20 0 0 LINE 8 0 10 0 20 0 11 100 21 0 0 LINE 8 Off 10 0 20 0 11 7 21 0 0 ENDBLK
        0 BLOCK 2 Outer 10 0 20 0 0 INSERT 8 0 2 OnA 10 0 20 0 0 INSERT 8 0 2 On0 10 0 20 0 0 INSERT 8 Off 2 On0 10 0 20 0
        0 INSERT 8 A 2 On0 10 0 20 0 0 INSERT 8 Frz 2 OnA 10 0 20 0 0 ENDBLK ";
    let drawn = |insert: &str, layers: &str| {
        let pairs: String = layers.split_whitespace().map(|word| format!("{word}\n")).collect();
        let text =
            with_blocks(BLOCKS, &format!("0 LINE 8 A 10 0 20 0 11 10 21 0 0 INSERT {insert} 10 0 20 0"));
        let begin = "0\nSECTION\n2\nBLOCKS\n";
        length(&text.replace(begin, &format!("{pairs}{begin}"))) - 10.0
    };
    let layer_0_off = LAYERS.replace("2 0 70 0 62 7", "2 0 70 0 62 -7");
    for (insert, layers, expected) in [
        ("8 A 2 OnA", LAYERS, 100.0),
        ("8 Off 2 OnA", LAYERS, 100.0),
        ("8 Frz 2 OnA", LAYERS, 0.0),
        ("8 A 2 On0", LAYERS, 100.0),
        ("8 Off 2 On0", LAYERS, 0.0),
        ("8 Frz 2 On0", LAYERS, 0.0),
        ("8 0 2 OnA", &layer_0_off, 100.0),
        ("8 0 2 On0", &layer_0_off, 0.0),
        ("8 A 2 On0", &layer_0_off, 100.0),
        ("8 A 2 Outer", LAYERS, 300.0),
        ("8 Off 2 Outer", LAYERS, 200.0),
        ("8 Frz 2 Outer", LAYERS, 0.0),
        ("8 0 2 Outer", &layer_0_off, 200.0),
    ] {
        near(drawn(insert, layers), expected);
    }
}

/// $INSUNITS by the reference; factors by definition: an inch is 25.4 mm, a surveyor's foot 1200/3937 m.
#[test]
fn every_unit_of_lengths_has_its_factor() {
    let line = "0 LINE 8 0 10 0 20 0 11 1000 21 0";
    for (units, mm) in [
        (1, 25.4),
        (2, 304.8),
        (4, 1.0),
        (5, 10.0),
        (6, 1000.0),
        (8, 2.54e-5),
        (9, 0.0254),
        (10, 914.4),
        (12, 1e-6),
        (13, 1e-3),
        (14, 100.0),
        (15, 1e4),
        (21, 304.800_609_601_219_2),
        (22, 25.400_050_800_101_6),
    ] {
        near(length(&drawing(units, line)) / 1000.0, mm);
    }
    for units in [17, 20, 25] {
        assert!(refusal(&drawing(units, line)).contains(&format!("in the unit {units}")));
    }
}

#[test]
fn a_given_unit_holds_for_drawings_without_one() {
    for (units, given, expected) in [
        (0, Some(Unit::Inch), 254.0),
        (0, Some(Unit::Millimetre), 10.0),
        (0, None, 10.0),
        (4, Some(Unit::Inch), 10.0),
    ] {
        let options = ReadOptions { unit: given, ..ReadOptions::default() };
        let text = drawing(units, "0 LINE 8 0 10 0 20 0 11 10 21 0");
        for text in [text.clone(), text.replace(&format!("9\n$INSUNITS\n70\n{units}\n"), "")] {
            if units == 4 && !text.contains("INSUNITS") {
                continue;
            }
            let part = read_part_with("p", &text, options).unwrap();
            near(inspect(&part).length_mm, expected);
            assert_eq!(part.warnings.is_empty(), given.is_some());
        }
    }
}

#[test]
fn faults_of_drawings_are_said_at_their_places() {
    for (text, place, said) in [
        (drawing(2, "0 LINE 10 0 20 0 11 1 21 1"), "", ""),
        (drawing(17, "0 LINE 10 0 20 0 11 1 21 1"), "p:12:1", "the drawing is in the unit 17"),
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
            drawing(4, "0 CIRCLE 10 0 20 0 40 1 210 0 220 0 230 0"),
            "p:20:1",
            "the plane of this CIRCLE has no normal",
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
        ("AutoCAD Binary DXF\n\u{1a}\0", "this is a binary DXF file whose first bytes were changed"),
        ("AC1027\0\0", "this is a DWG file"),
    ] {
        let errors = read_part("p", text).unwrap_err().to_string();
        assert!(errors.contains(said) && errors.contains("export the curves as DXF"), "{errors}");
    }
}

/// A drawing in millimetres with blocks.
fn with_blocks(blocks: &str, entities: &str) -> String {
    let pairs: String = blocks.split_whitespace().map(|word| format!("{word}\n")).collect();
    drawing(4, entities).replace(
        "0\nSECTION\n2\nENTITIES\n",
        &format!("0\nSECTION\n2\nBLOCKS\n{pairs}0\nENDSEC\n0\nSECTION\n2\nENTITIES\n"),
    )
}

fn length(text: &str) -> f64 {
    inspect(&part(text)).length_mm
}

fn refusal(text: &str) -> String {
    read_part("p", text).unwrap_err().to_string()
}

fn near(found: f64, expected: f64) {
    assert!((found - expected).abs() <= 1e-9 * expected.abs().max(1.0), "{found}, not {expected}");
}

fn all_near(found: [f64; 3], expected: [f64; 3]) {
    assert!(found.iter().zip(expected).all(|(f, e)| (f - e).abs() < 1e-12), "{found:?}, not {expected:?}");
}

/// The periodic quadratic of a square of side 2 is four parabolas from middle to middle of its sides: with legs of length 1 at a
/// right angle, each is `∫ 2 √((1-t)² + t²) dt = 1 + asinh(1)/√2` long. It was refused as not clamped.
#[test]
fn a_periodic_spline_is_what_is_drawn_between_its_inner_knots() {
    let parabola = 1.0 + 1.0_f64.asinh() / 2.0_f64.sqrt();
    for (x, y) in [(0.0, 0.0), (4e6, -9e6)] {
        let corners = [(0, 0), (2, 0), (2, 2), (0, 2), (0, 0), (2, 0)];
        let points = corners.map(|(dx, dy)| format!("10 {} 20 {} ", x + f64::from(dx), y + f64::from(dy)));
        let knots: String = (-2..=6).map(|knot| format!("40 {knot} ")).collect();
        let text = drawing(4, &format!("0 SPLINE 70 11 71 2 72 9 73 6 {knots} {}", points.concat()));
        let part = part(&text);
        near(inspect(&part).length_mm, 4.0 * parabola);
        let curve = &part.curves[0];
        assert_eq!(curve.control_points_mm()[0], [x + 1.0, y, 0.0]);
        assert_eq!(curve.control_points_mm()[5], [x + 1.0, y, 0.0]);
        assert_eq!(curve.knots(), [0.0, 0.0, 0.0, 1.0, 2.0, 3.0, 4.0, 4.0, 4.0]);
        assert_eq!((curve.weights(), part.warnings.len()), ([1.0; 6].as_slice(), 0));
    }
}

/// Knots that differ by rounding alone once made a curve that is not clamped.
#[test]
fn knots_that_differ_by_rounding_are_equal() {
    let clean = part(&drawing(4, SPLINE)).curves;
    for (first, last, tolerance) in
        [("40 1e-17", "40 0.99999999999999", ""), ("40 2e-8", "40 0.99999997", "42 1e-7")]
    {
        let noisy = SPLINE
            .replace("40 0 40 0 40 0", &format!("{tolerance} 40 0 40 0 {first}"))
            .replace("40 1 40 1 40 1", &format!("40 1 40 1 {last}"));
        assert_eq!(part(&drawing(4, &noisy)).curves, clean);
    }
}

/// Bézier pieces of degree 3 with every knot four times, as some exporters write them.
fn pieces(points: &[[f64; 2]], more: &str) -> String {
    let ends = 0..=points.len() / 4;
    let knots: String = ends.map(|knot| format!("40 {knot} 40 {knot} 40 {knot} 40 {knot} ")).collect();
    let points: String = points.iter().map(|[x, y]| format!("10 {x} 20 {y} ")).collect();
    drawing(4, &format!("0 SPLINE 70 8 71 3 {knots} {more} {points}"))
}

/// A circle of radius 12 as four cubics. Its length is that of chord sums by another evaluator (ezdxf 1.4).
#[test]
fn a_knot_more_than_degree_times_is_no_break_where_points_coincide() {
    let k = 6.627_416_997_969_522;
    let circle = [
        [12.0, 0.0],
        [12.0, k],
        [k, 12.0],
        [0.0, 12.0],
        [0.0, 12.0],
        [-k, 12.0],
        [-12.0, k],
        [-12.0, 0.0],
        [-12.0, 0.0],
        [-12.0, -k],
        [-k, -12.0],
        [0.0, -12.0],
        [0.0, -12.0],
        [k, -12.0],
        [12.0, -k],
        [12.0, 0.0],
    ];
    let one = part(&pieces(&circle, ""));
    assert_eq!((one.curves.len(), one.curves[0].control_points_mm().len()), (1, 13));
    assert_eq!(one.curves[0].knots()[4..13], [1.0, 1.0, 1.0, 2.0, 2.0, 2.0, 3.0, 3.0, 3.0]);
    assert!((inspect(&one).length_mm - 75.408_802).abs() < 1e-6, "{}", inspect(&one).length_mm);
    // The second half written with twice the weights is the same curve.
    let weights = "41 1 ".repeat(8) + &"41 2 ".repeat(8);
    assert_eq!(part(&pieces(&circle, &weights)).curves, one.curves);
}

#[test]
fn a_spline_that_breaks_is_two_curves() {
    let apart =
        [[0.0, 0.0], [1.0, 1.0], [2.0, 1.0], [3.0, 0.0], [3.0, 2.0], [4.0, 3.0], [5.0, 3.0], [6.0, 2.0]];
    let two = part(&pieces(&apart, ""));
    assert_eq!((two.curves.len(), two.moves.len()), (2, 2));
    assert_eq!(
        (two.curves[0].control_points_mm()[3], two.curves[1].control_points_mm()[0]),
        ([3.0, 0.0, 0.0], [3.0, 2.0, 0.0])
    );
    near(inspect(&two).joints.iter().next().unwrap().gap_mm, 2.0);
}

const FIT: &str = "11 0 21 24 31 0 11 1.25 21 25.25 31 0 11 3 21 26 31 0 11 5 21 26.5 31 0 11 8 21 29 31 0";

/// The length with tangents is that of a drawing whose curve is known; without, that of an independent solver and of ezdxf 1.4.
#[test]
fn a_spline_by_points_passes_through_them() {
    let tangents = "12 0.6 22 0.8 32 0 13 0.8 23 0.6 33 0";
    let with = part(&drawing(4, &format!("0 SPLINE 70 8 71 3 72 0 73 0 74 5 {tangents} {FIT}")));
    assert!((inspect(&with).length_mm - 9.678_862).abs() < 1e-6, "{}", inspect(&with).length_mm);
    assert_eq!(
        (with.curves[0].degree(), with.curves[0].control_points_mm().len(), with.warnings.len()),
        (3, 7, 0)
    );
    let longer =
        part(&drawing(4, &format!("0 SPLINE 70 8 71 3 {} {FIT}", "12 6 22 8 32 0 13 1.6 23 1.2 33 0")));
    near(inspect(&longer).length_mm, inspect(&with).length_mm);

    let free = part(&drawing(4, &format!("0 SPLINE 70 8 71 3 {FIT}")));
    assert!((inspect(&free).length_mm - 9.694_068_539).abs() < 1e-8, "{}", inspect(&free).length_mm);
    assert!(free.warnings[0].message.contains("1 SPLINE by points alone"), "{:?}", free.warnings);

    // Control points hold where both are given.
    assert_eq!(part(&drawing(4, &format!("{SPLINE} {FIT}"))).curves, part(&drawing(4, SPLINE)).curves);
}

/// Of the corners of a square with half diagonal 1, the slopes are 3/4 of the sum of the two chords' unit vectors.
#[test]
fn a_closed_spline_by_points_goes_on_from_its_end() {
    let square = "11 1 21 0 11 0 21 1 11 -1 21 0 11 0 21 -1";
    let closed = part(&drawing(4, &format!("0 SPLINE 70 11 71 3 {square}")));
    let curve = &closed.curves[0];
    let third = 2.0_f64.sqrt() / 3.0;
    all_near(curve.control_points_mm()[1], [1.0, third * 0.75 * 2.0_f64.sqrt(), 0.0]);
    all_near(curve.control_points_mm()[5], [1.0, -third * 0.75 * 2.0_f64.sqrt(), 0.0]);
    assert_eq!(
        (curve.control_points_mm()[0], curve.control_points_mm()[6]),
        ([1.0, 0.0, 0.0], [1.0, 0.0, 0.0])
    );
    assert_eq!(closed.warnings, []);
}

#[test]
fn a_degree_that_is_too_high_names_its_entity() {
    let numbers = "40 0 ".repeat(11) + &"40 1 ".repeat(11) + &"10 0 20 0 ".repeat(10) + "10 1 20 0";
    let errors = refusal(&drawing(4, &format!("0 SPLINE 71 10 {numbers}")));
    assert!(errors.contains("SPLINE: degree 10 is not supported") && errors.contains("p:20:1"), "{errors}");
}

/// The perimeter is `4 a E(e)`, here by 20 digits of the complete elliptic integral: 9.68844822054767619842.
#[test]
fn an_ellipse_is_exact() {
    let ellipse =
        |more: &str| part(&drawing(4, &format!("0 ELLIPSE 10 1 20 2 30 0 11 0 21 2 31 0 40 0.5 {more}")));
    near(inspect(&ellipse("")).length_mm, 9.688_448_220_547_676);
    near(inspect(&ellipse("41 0 42 6.283186")).length_mm, 9.688_448_220_547_676);
    assert_eq!(ellipse("").moves[0].shape, Shape::Nurbs);
    // Counterclockwise from the major axis, which points up: through the left. Turned over, through the right.
    let half = format!("41 0 42 {}", std::f64::consts::PI);
    for (normal, middle) in [("", [0.0, 2.0, 0.0]), ("210 0 220 0 230 -1", [2.0, 2.0, 0.0])] {
        let points = ellipse(&format!("{half} {normal}")).curves.remove(0).control_points_mm().to_vec();
        all_near(points[0], [1.0, 4.0, 0.0]);
        all_near(points[2], middle);
        all_near(points[4], [1.0, 0.0, 0.0]);
    }
    let errors = refusal(&drawing(4, "0 ELLIPSE 10 1 20 2 11 0 21 0 40 0.5"));
    assert!(errors.contains("the axes of this ELLIPSE are 0 long and 0.5 of it"), "{errors}");
}

/// By the reference's algorithm a normal along x has its x axis along y and its y axis along z.
#[test]
fn an_inclined_plane_is_turned_into_space() {
    let text = drawing(
        4,
        "0 CIRCLE 10 1 20 2 30 3 40 4 210 2 220 0 230 0 0 LWPOLYLINE 38 3 210 1 220 0 230 0 10 1 20 2 10 5 20 2",
    );
    let part = part(&text);
    all_near(part.curves[0].control_points_mm()[0], [3.0, 5.0, 2.0]);
    all_near(part.curves[0].control_points_mm()[2], [3.0, 1.0, 6.0]);
    all_near(part.curves[1].control_points_mm()[1], [3.0, 5.0, 2.0]);
    assert_eq!((part.moves[0].shape, part.curves[0].dimension()), (Shape::Arc, 3));
}

/// Angles that rounding takes beyond a full turn made arcs of nearly none.
#[test]
fn an_arc_of_360_degrees_but_for_rounding_is_a_circle() {
    for (last, degrees) in
        [("360", 360.0), ("360.0001", 360.0), ("0.0001", 1e-4), ("0", 360.0), ("-90", 270.0)]
    {
        let text = drawing(4, &format!("0 ARC 10 0 20 0 40 1 50 0 51 {last}"));
        near(length(&text), f64::to_radians(degrees));
    }
}

/// A bulge of a tenth of a micrometre has its centre 10,000 km away.
#[test]
fn a_flat_bulge_is_an_arc_all_the_same() {
    let text = drawing(4, "0 LWPOLYLINE 10 1000 20 1000 42 1e-9 10 1001 20 1000 42 -0.3 10 1002 20 1000");
    let angle = 4.0 * 0.3_f64.atan();
    near(length(&text), 1.0 + angle * 0.5 / (angle / 2.0).sin());
}

#[test]
fn a_polyline_with_its_vertices() {
    let vertices = "0 VERTEX 10 0 20 0 30 9 42 1 0 VERTEX 10 2 20 0 30 9 0 VERTEX 70 16 10 50 20 50 0 VERTEX 10 2 20 2 30 9 0 SEQEND";
    let polyline = |head: &str| {
        part(&drawing(4, &format!("0 POLYLINE 66 1 {head} {vertices} 0 LINE 10 0 20 0 11 1 21 0")))
    };
    let closed = polyline("10 0 20 0 30 5 70 1");
    let shapes: Vec<_> = closed.moves.iter().map(|one| one.shape).collect();
    assert_eq!(shapes, [Shape::Arc, Shape::Line, Shape::Line, Shape::Line]);
    assert_eq!(closed.curves[1].control_points_mm(), [[2.0, 0.0, 5.0], [2.0, 2.0, 5.0]]);
    near(inspect(&closed).length_mm, std::f64::consts::PI + 2.0 + 8.0_f64.sqrt() + 1.0);
    // In space there are no bulges, and heights are the vertices'.
    let in_space = polyline("10 0 20 0 30 0 70 8");
    assert_eq!((in_space.curves.len(), in_space.curves[0].control_points_mm()[1]), (3, [2.0, 0.0, 9.0]));
    let turned_over = polyline("10 0 20 0 30 5 70 0 210 0 220 0 230 -1");
    assert_eq!(turned_over.curves[1].control_points_mm(), [[-2.0, 0.0, -5.0], [-2.0, 2.0, -5.0]]);
    assert_eq!(polyline("70 64").warnings[0].message, "left out: 1 POLYLINE of a mesh");
}

const BLOCK: &str =
    "0 BLOCK 8 0 2 Hole 70 0 10 1 20 0 0 CIRCLE 8 0 10 3 20 0 40 1 0 LINE 8 0 10 1 20 0 11 2 21 0 0 ENDBLK ";

#[test]
fn a_block_is_drawn_where_it_is_inserted() {
    let insert = |more: &str| part(&with_blocks(BLOCK, &format!("0 INSERT 2 HOLE 10 10 20 20 {more}")));
    // Scaled by 2, mirrored and turned by 90°: (p - base) (−2, 2) turned is (−2 y, −2 x).
    let turned = insert("41 -2 42 2 50 90");
    all_near(turned.curves[0].control_points_mm()[0], [10.0, 20.0 - 2.0 * 3.0, 0.0]);
    assert_eq!(turned.curves[1].control_points_mm(), [[10.0, 20.0, 0.0], [10.0, 18.0, 0.0]]);
    assert_eq!((turned.moves[0].shape, turned.moves[1].line), (Shape::Arc, 42));
    near(inspect(&turned).length_mm, 4.0 * std::f64::consts::PI + 2.0);
    // An uneven scale makes an ellipse, with the half axes 2 and 1.
    let uneven = insert("41 2");
    near(inspect(&uneven).length_mm, 9.688_448_220_547_676 + 2.0);
    assert_eq!(uneven.moves[0].shape, Shape::Nurbs);
    // Turned over, x runs the other way.
    let over = insert("210 0 220 0 230 -1");
    assert_eq!(over.curves[1].control_points_mm(), [[-10.0, 20.0, 0.0], [-11.0, 20.0, 0.0]]);
    // Rows and columns turn with the block and are not scaled.
    let many = insert("41 2 42 2 50 90 70 3 71 2 44 10 45 100");
    assert_eq!(many.curves.len(), 12);
    all_near(many.curves[11].control_points_mm()[0], [10.0 - 100.0, 20.0 + 20.0, 0.0]);
}

#[test]
fn blocks_within_blocks() {
    let blocks = format!(
        "{BLOCK} 0 BLOCK 2 Outer 10 0 20 0 0 INSERT 2 Hole 10 5 20 0 0 INSERT 2 Hole 10 0 20 7 50 180 0 ENDBLK"
    );
    let part = part(&with_blocks(&blocks, "0 INSERT 2 Outer 10 100 20 0 41 2 42 2 43 2"));
    let lines: Vec<_> = part
        .curves
        .iter()
        .filter(|curve| curve.degree() == 1)
        .map(|curve| curve.control_points_mm()[1])
        .collect();
    assert_eq!(lines, [[112.0, 0.0, 0.0], [98.0, 14.0, 0.0]]);
}

/// Entities that are left out are counted where they are drawn: not in blocks that are never inserted, and not by the
/// insert.
#[test]
fn what_is_left_out_of_blocks_is_counted() {
    let blocks = format!(
        "{BLOCK} 0 BLOCK 2 Text 0 TEXT 1 a 0 ATTDEF 1 b 0 ENDBLK 0 BLOCK 2 Unused 0 HATCH 1 a 0 LINE 10 x 0 ENDBLK
         0 BLOCK 2 Xref 70 4 1 other.dxf 0 ENDBLK"
    );
    let entities = "0 INSERT 2 Hole 10 0 20 0 0 INSERT 2 Text 66 1 10 0 20 0 0 ATTRIB 1 c 0 SEQEND 0 INSERT 2 Text 10 0 20 0
                    0 INSERT 2 Xref 10 0 20 0 0 INSERT 2 Gone 10 0 20 0";
    let part = part(&with_blocks(&blocks, entities));
    let said: Vec<_> = part.warnings.iter().map(|warning| warning.message.as_str()).collect();
    let expected =
        "left out: 1 TEXT, 1 ATTRIB, 1 INSERT of another drawing, 1 INSERT of a block that is not there";
    assert_eq!((part.curves.len(), said), (2, vec![expected]));
    // A drawing that is refused says it too.
    for entities in ["0 HATCH 1 a 0 HATCH 1 b", "0 HATCH 1 a 0 HATCH 1 b 0 LINE 10 x 20 0 11 1 21 1"] {
        let errors = refusal(&drawing(4, entities));
        assert!(errors.contains("warning: left out: 2 HATCH"), "{errors}");
    }
}

#[test]
fn inserts_are_bounded() {
    let block =
        |n: usize, inner: &str| format!("0 BLOCK 2 B{n} 0 LINE 10 0 20 0 11 1 21 0 {inner} 0 ENDBLK ");
    let insert = |n: usize| format!("0 INSERT 2 B{n} 10 0 20 0 ");
    let chain = |count: usize, width: usize| -> String {
        (0..count)
            .map(|n| block(n, &if n + 1 < count { insert(n + 1).repeat(width) } else { String::new() }))
            .collect()
    };
    assert_eq!(part(&with_blocks(&chain(32, 1), &insert(0))).curves.len(), 32);
    for (blocks, entities, said) in [
        (chain(33, 1), insert(0), "the block B32 is inserted 33 blocks deep"),
        (chain(30, 10), insert(0), "the blocks that are inserted hold too many curves"),
        (
            chain(1, 1),
            format!("{} 70 32767 71 32767", insert(0)),
            "the blocks that are inserted hold too many curves",
        ),
        (
            block(0, &insert(1)) + &block(1, &insert(0).repeat(3)),
            insert(0).repeat(2),
            "the block B0 is inserted into itself",
        ),
    ] {
        let errors = read_part("p", &with_blocks(&blocks, &entities)).unwrap_err();
        assert!(errors.count() == 1 && errors.to_string().contains(said), "{errors}");
    }
}

#[test]
fn lines_may_end_with_carriage_returns_alone() {
    let text = drawing(4, SPLINE);
    for ends in ["\r", "\r\n", "\r\r\n"] {
        let same = part(&text.replace('\n', ends));
        assert_eq!((&same.curves, same.moves[0].line), (&part(&text).curves, 20), "{ends:?}");
    }
    let errors = refusal(&drawing(4, &SPLINE.replace("41 2", "41 -2")).replace('\n', "\r"));
    assert!(errors.contains("p:48:1"), "{errors}");
}

/// A drawing's groups in binary, with codes of two bytes or as release 12 has them.
fn binary(text: &str, is_wide: bool) -> Vec<u8> {
    let mut bytes = b"AutoCAD Binary DXF\r\n\x1a\0".to_vec();
    let lines: Vec<_> = text.lines().collect();
    for group in lines.chunks_exact(2) {
        let code: u16 = group[0].parse().unwrap();
        match code {
            _ if is_wide => bytes.extend(code.to_le_bytes()),
            ..=254 => bytes.push(u8::try_from(code).unwrap()),
            _ => bytes.extend([&[255], code.to_le_bytes().as_slice()].concat()),
        }
        match code {
            10..=59 | 210..=239 => bytes.extend(group[1].parse::<f64>().unwrap().to_le_bytes()),
            60..=79 => bytes.extend(group[1].parse::<i16>().unwrap().to_le_bytes()),
            90..=99 => bytes.extend(group[1].parse::<i32>().unwrap().to_le_bytes()),
            310 => bytes.extend([&[3], [1, 0, 255].as_slice()].concat()),
            _ => bytes.extend([group[1].as_bytes(), &[0]].concat()),
        }
    }
    bytes
}

fn of_bytes(bytes: &[u8]) -> Result<Part, part_program::Diagnostics> {
    part_program::read_part_bytes("p", bytes, part_program::ReadOptions::default())
}

#[test]
fn a_binary_drawing_is_the_drawing() {
    let entities = format!("{SPLINE} 0 LWPOLYLINE 90 2 310 0 1001 ACAD 1000 x 10 1e300 10 0.1 20 -2.5 62 -3")
        .replace("10 1e300 ", "");
    let text = drawing(1, &format!("{entities} 10 5 20 0"));
    for is_wide in [true, false] {
        let bytes = binary(&text, is_wide);
        assert_eq!(of_bytes(&bytes).unwrap_or_else(|errors| panic!("{errors}")), part(&text));
        for length in 22..bytes.len() - 1 {
            let errors = of_bytes(&bytes[..length]).unwrap_err().to_string();
            assert!(errors.contains("the binary drawing is cut off in the group at byte"), "{errors}");
        }
    }
    for (bytes, said) in [
        (
            [[0, 0].as_slice(), b"SECTION\0\x88\x13x\0"].concat(),
            "byte 32 of the binary drawing begins a group 5000",
        ),
        ([[0, 0].as_slice(), b"EOF\0"].concat(), "this binary drawing does not begin with a section"),
        (Vec::new(), "the binary drawing is cut off in the group at byte 22"),
    ] {
        let errors =
            of_bytes(&[b"AutoCAD Binary DXF\r\n\x1a\0".as_slice(), &bytes].concat()).unwrap_err().to_string();
        assert!(errors.contains(said), "{errors}");
    }
}

const JSON: &str = r#"{"shape": {"type": "curve", "count": 1, "data": [{"type": "spline", "rational": true, "dimension": 2,
 "degree": 2, "knotvector": [0, 0, 0, 0.5, 1, 1, 1], "delta": 0.01,
 "control_points": {"points": [[0, 0], [1, 2.5], [3, 1], [4, 0]], "weights": [1, 2, 0.5, 1]}}]}}"#;

/// geomdl draws a curve from the knot p to the knot n + 1, whatever the others: as a SPLINE of a drawing is drawn.
#[test]
fn knots_of_json_need_not_be_clamped() {
    let json = |knots: &str, points: &str| {
        format!(
            r#"{{"shape": {{"type": "curve", "data": [{{"degree": 2, "knotvector": [{knots}], "control_points": {{"points": [{points}]}}}}]}}}}"#
        )
    };
    let spline = |knots: &str, points: &str| {
        let knots: String = knots.split(", ").map(|knot| format!("40 {knot} ")).collect();
        let points = points.replace("], [", " 10 ").replace(['[', ']'], "").replace(", ", " 20 ");
        drawing(4, &format!("0 SPLINE 8 0 70 0 71 2 {knots} 10 {points}"))
    };
    let square = "[0, 0], [4, 0], [4, 4], [0, 4], [0, 0], [4, 0]";
    for (knots, points) in [
        ("0, 1, 2, 3, 4, 5, 6, 7, 8", square),
        ("0, 0, 0, 1, 2, 3, 4, 5, 6", square),
        ("-2, -1, 0, 1, 2, 3, 3, 3, 3", square),
        ("0, 0, 0, 2, 2, 2, 4, 4, 4", square),
    ] {
        let (read, drawn) = (part(&json(knots, points)), part(&spline(knots, points)));
        assert_eq!(read.curves, drawn.curves, "{knots}");
    }
    let flat = refusal(&json("0, 1, 1, 1, 2", "[0, 0], [1, 1]"));
    assert!(flat.contains("curve 0"), "{flat}");
}

#[test]
fn json_as_geomdl_exports_it() {
    let curve = part(JSON).curves.remove(0);
    assert_eq!((curve.degree(), curve.dimension()), (2, 2));
    assert_eq!(curve.control_points_mm()[1], [1.0, 2.5, 0.0]);
    assert_eq!(curve.weights(), [1.0, 2.0, 0.5, 1.0]);
    assert_eq!(curve.knots()[3], 0.5);
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

    /// A good drawing of many entities, as text or binary, with a few bytes changed is read or refused.
    #[test]
    fn mutated_drawings_return(
        changes in prop::collection::vec((any::<prop::sample::Index>(), any::<u8>()), 1..6),
        form in 0..3,
    ) {
        let entities = format!("0 SPLINE 70 11 71 3 {FIT} 0 INSERT 2 Hole 10 0 20 0 70 2 0 ELLIPSE 10 1 20 2 11 0 21 2 40 0.5
            0 POLYLINE 70 1 0 VERTEX 10 0 20 0 42 1 0 VERTEX 10 1 20 1 0 SEQEND {SPLINE}");
        let text = with_blocks(&BLOCK.replace("0 ENDBLK", "0 INSERT 2 Other 10 0 20 0 0 ENDBLK"), &entities);
        let mut bytes = match form {
            0 => text.into_bytes(),
            form => binary(&text, form == 1),
        };
        for (at, byte) in &changes {
            let at = at.index(bytes.len());
            bytes[at] = *byte;
        }
        if let Ok(part) = of_bytes(&bytes) {
            for curve in &part.curves {
                prop_assert_eq!(curve.faults(), []);
            }
        }
    }

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
