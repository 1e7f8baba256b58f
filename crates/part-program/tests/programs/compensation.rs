//! Cutter compensation: the way of the tool's centre, its length by closed forms, and what it refuses.

use std::f64::consts::{PI, TAU};
use std::fmt::Write;

use part_program::{
    Dialect, MoveKind, Part, ReadOptions, Shape, ToolTable, Unit, inspect, read_part_bytes_with,
    read_part_with,
};

const LINUXCNC: ReadOptions =
    ReadOptions { dialect: Some(Dialect::LinuxCnc), lenient: false, start_mm: None, unit: None };

fn read(text: &str) -> Part {
    read_part_with("p.ngc", text, LINUXCNC).unwrap_or_else(|errors| panic!("{text}\n{errors}"))
}

fn errors(text: &str) -> String {
    read_part_with("p.ngc", text, LINUXCNC).expect_err(text).to_string()
}

/// The ends of the moves that are not before line `from`, in X, Y and Z.
fn ends(part: &Part, from: usize) -> Vec<[f64; 3]> {
    let moves = part.moves.iter().zip(&part.curves).filter(|(one, _)| one.line >= from);
    moves.map(|(_, curve)| *curve.control_points_mm().last().unwrap()).collect()
}

fn near(found: &[[f64; 3]], expected: &[[f64; 3]], of: &str) {
    assert_eq!(found.len(), expected.len(), "{of}\n{found:?}");
    for (found, expected) in found.iter().zip(expected) {
        let off = (0..3).map(|axis| (found[axis] - expected[axis]).abs()).fold(0.0, f64::max);
        assert!(off < 1e-9, "{of}\n{found:?}, not {expected:?}");
    }
}

/// Each corner by hand, for a tool of radius 1 that begins at 0.
#[test]
fn each_kind_of_corner_is_passed_as_drawn() {
    let sqrt = f64::sqrt;
    let cases: &[(&str, &[[f64; 3]])] = &[
        // An inner corner, an outer one and the way back.
        (
            "G41.1 D2\nG1 X10 Y0\nX10 Y10\nX20\nY20\nG40\nX30\n",
            &[
                [9.0, 1.0, 0.0],
                [9.0, 10.0, 0.0],
                [10.0, 11.0, 0.0],
                [19.0, 11.0, 0.0],
                [19.0, 20.0, 0.0],
                [30.0, 20.0, 0.0],
            ],
        ),
        // A rapid move cuts the outer corner off.
        (
            "G42.1 D2\nG0 X10\nY10\nG40\nG0 Y30\n",
            &[[10.0, -1.0, 0.0], [11.0, 0.0, 0.0], [11.0, 10.0, 0.0], [10.0, 30.0, 0.0]],
        ),
        // Across the plane the tool stays where the next move of the plane has it.
        (
            "G41.1 D2\nG1 X10\nZ4\nZ3\nY10 Z1\nG40\nG0 Z9\n",
            &[[9.0, 1.0, 0.0], [9.0, 1.0, 4.0], [9.0, 1.0, 3.0], [9.0, 10.0, 1.0], [10.0, 10.0, 9.0]],
        ),
        // Into an arc: its centre is on the line through its end and the contour's centre, as far from the start as from the end.
        (
            "G42.1 D2\nG2 X10 Y10 I10 J0\nG1 X30\nG40\nX40\n",
            &[[10.0, 9.0, 0.0], [30.0, 9.0, 0.0], [40.0, 10.0, 0.0]],
        ),
        // A line that meets a circle: radius 9 about (10, 10), 1 below the line Y 10.
        (
            "G41.1 D2\nG1 X10\nG3 X20 Y10 J10\nG1 X0\nG40\nX-9\n",
            &[[10.0, 1.0, 0.0], [10.0 + sqrt(80.0), 9.0, 0.0], [0.0, 9.0, 0.0], [-9.0, 10.0, 0.0]],
        ),
        // Two circles that meet: radius 6 about (15, 0) and (25, 0), on the line between.
        (
            "G41.1 D2\nG1 X10\nG2 X20 I5\nG2 X30 I5\nG40 G1 X50\n",
            &[[15.0 - sqrt(35.0), 1.0, 0.0], [20.0, sqrt(11.0), 0.0], [31.0, 0.0, 0.0], [50.0, 0.0, 0.0]],
        ),
        // Full turns keep their turns, and a helix its height.
        (
            "G41.1 D2\nG1 X10\nG3 J5 P2 Z-3\nG1 X20\nG40 X30\n",
            &[[10.0, 1.0, 0.0], [10.0, 1.0, -3.0], [20.0, 1.0, -3.0], [30.0, 0.0, -3.0]],
        ),
        // Back the way it came, around the end.
        (
            "G41.1 D2\nG1 X10\nX0\nG40 X-9\n",
            &[[10.0, 1.0, 0.0], [10.0, -1.0, 0.0], [0.0, -1.0, 0.0], [-9.0, 0.0, 0.0]],
        ),
        // G18: Z is to X what X is to Y.
        (
            "G18 G42.1 D2\nG1 Z10\nX10\nG40 X30\n",
            &[[-1.0, 0.0, 10.0], [0.0, 0.0, 11.0], [10.0, 0.0, 11.0], [30.0, 0.0, 10.0]],
        ),
        // A negative diameter is the other side.
        ("G41.1 D-2\nG1 X10\nX20\nG40 X30\n", &[[10.0, -1.0, 0.0], [20.0, -1.0, 0.0], [30.0, 0.0, 0.0]]),
        // Increments count from the contour, and inches are of D too.
        (
            "G91 G20 G42.1 D[2/25.4]\nG21 G1 X10\nX10\nG40 X10\n",
            &[[10.0, -1.0, 0.0], [20.0, -1.0, 0.0], [30.0, 0.0, 0.0]],
        ),
        // It ends with the program.
        ("G41.1 D2\nG1 X10\nY10\nM2\n", &[[9.0, 1.0, 0.0], [9.0, 10.0, 0.0]]),
        // One turn below 0.05 rad is none, and one above it is.
        (
            "G41.1 D2\nG1 X10\nX20 Y-0.4\nG40 X40\n",
            &[
                [10.0, 1.0, 0.0],
                [20.0 + 0.4 / sqrt(100.16), -0.4 + 10.0 / sqrt(100.16), 0.0],
                [40.0, -0.4, 0.0],
            ],
        ),
    ];
    for (text, expected) in cases {
        let text = format!("G21 G17 G90 F300\nG0 X0 Y0 Z0\n{text}");
        near(&ends(&read(&text), 3), expected, &text);
    }
}

/// An arc beside an arc has its centre and a radius that is less or greater by that of the tool.
#[test]
fn arcs_keep_their_centre() {
    for (side, word, radius) in
        [("41.1", "G3", 3.5), ("42.1", "G3", 6.5), ("41.1", "G2", 6.5), ("42.1", "G2", 3.5)]
    {
        let j = if word == "G3" { 5 } else { -5 };
        let text = format!("G21 G17 F60\nG0 X-20 Y0 Z0\nG{side} D3\nG1 X0\n{word} J{j}\nG1 X20\nG40 X40\n");
        let part = read(&text);
        let arcs: Vec<_> =
            (0..part.moves.len()).filter(|index| part.moves[*index].shape == Shape::Arc).collect();
        assert_eq!(arcs.len(), 1, "{text}");
        let curve = &part.curves[arcs[0]];
        let points = curve.control_points_mm().iter().step_by(2);
        points.for_each(|[x, y, _]| assert!((x.hypot(y - f64::from(j)) - radius).abs() < 1e-9, "{text}"));
        let expected = 20.0_f64.hypot(1.5) + TAU * radius + 20.0 + 20.0_f64.hypot(1.5);
        assert!((inspect(&part).length_mm - expected).abs() < 1e-9, "{text}");
    }
}

/// Numbers that look drawn at random, the same in every run: Lehmer's generator with Park and Miller's factor.
struct Draw(u64);

impl Draw {
    fn between(&mut self, least: f64, most: f64) -> f64 {
        self.0 = self.0 * 48_271 % 2_147_483_647;
        #[allow(clippy::cast_precision_loss, reason = "below 2^31")]
        let share = self.0 as f64 / 2_147_483_647.0;
        least + (most - least) * share
    }
}

/// A convex polygon whose corners turn by φ, and its perimeter P: around it the tool's way is P + 2πr long, for the outer corners turn once
/// in all; within it, P - 2r Σ tan φ/2, for each inner corner takes r tan φ/2 of both its sides. The tool begins and ends on the middle of
/// the first side, 20 mm along it before and behind.
#[test]
fn the_way_around_and_within_convex_polygons_is_as_long_as_it_must_be() {
    let mut draw = Draw(20_261_130);
    for number in 0..40 {
        let corners = 3 + number % 5;
        let step = TAU / f64::from(corners);
        let angles: Vec<_> =
            (0..corners).map(|corner| (f64::from(corner) + draw.between(-0.3, 0.3)) * step).collect();
        let size = draw.between(30.0, 90.0);
        let vertices: Vec<_> = angles.iter().map(|angle| [size * angle.cos(), size * angle.sin()]).collect();
        let side = |index: usize| {
            let (a, b) = (vertices[index % vertices.len()], vertices[(index + 1) % vertices.len()]);
            [b[0] - a[0], b[1] - a[1]]
        };
        let perimeter: f64 = (0..vertices.len()).map(|index| side(index)[0].hypot(side(index)[1])).sum();
        let turn = |index: usize| {
            let (a, b) = (side(index), side(index + 1));
            (a[0] * b[1] - a[1] * b[0]).atan2(a[0] * b[0] + a[1] * b[1])
        };
        let tangents: f64 = (0..vertices.len()).map(|index| (turn(index) / 2.0).tan()).sum();
        let radius = draw.between(0.1, 3.0);
        let first = side(0);
        let along = first.map(|x| 20.0 * x / first[0].hypot(first[1]));
        let middle = [vertices[0][0] + first[0] / 2.0, vertices[0][1] + first[1] / 2.0];
        for (word, is_outside) in [("G42.1", true), ("G41.1", false)] {
            let mut text = format!(
                "G21 G90 F60\nG0 X{} Y{} Z0\n{word} D{}\n",
                middle[0] - along[0],
                middle[1] - along[1],
                2.0 * radius
            );
            let _ = writeln!(text, "G1 X{} Y{}", middle[0], middle[1]);
            for [x, y] in vertices[1..].iter().chain(&vertices[..1]).chain([&middle]) {
                let _ = writeln!(text, "X{x} Y{y}");
            }
            let _ = writeln!(text, "G40\nX{} Y{}", middle[0] + along[0], middle[1] + along[1]);
            let beside = if is_outside { TAU * radius } else { -2.0 * radius * tangents };
            let expected = perimeter + beside + 2.0 * 20.0_f64.hypot(radius);
            let found = inspect(&read(&text)).length_mm;
            assert!((found - expected).abs() < 1e-8, "{text}\n{found}, not {expected}");
        }
    }
}

/// A slot whose ends are half circles of radius R: the tool's way is as long as the contour, ±2πr.
#[test]
fn the_way_along_a_slot_is_as_long_as_it_must_be() {
    let mut draw = Draw(7);
    for _ in 0..12 {
        let (half, length, radius) =
            (draw.between(4.0, 20.0), draw.between(5.0, 60.0), draw.between(0.05, 3.9));
        for (word, sign) in [("G42.1", 1.0), ("G41.1", -1.0)] {
            let text = format!(
                "G21 G90 F60\nG0 X-30 Y{0} Z0\n{word} D{1}\nG1 X0\nX{2}\nG3 Y{half} J{half}\nG1 X0\nG3 Y{0} J{0}\nG1 X1\nG40 X31\n",
                -half,
                2.0 * radius,
                length,
            );
            let expected = 2.0 * length + TAU * (half + sign * radius) + 30.0_f64.hypot(radius) * 2.0 + 1.0;
            let found = inspect(&read(&text)).length_mm;
            assert!((found - expected).abs() < 1e-8, "{text}\n{found}, not {expected}");
        }
    }
}

/// What the tool does not fit into names both moves; what cannot be compensated is refused by its name.
#[test]
fn what_cannot_be_compensated_is_refused() {
    let head = "G21 G90 F60\nG0 X0 Y0 Z0\nG41.1 D2\nG1 X10\n";
    for (text, place, said) in [
        ("X20\nY0.5\nX0\n", "p.ngc:6", "does not reach the inner corner between lines 5 and 6"),
        ("X20\nY1.5\nX10\n", "p.ngc:7", "does not reach the inner corner between lines 6 and 7"),
        ("G3 X12 I1\n", "p.ngc:5", "a tool of radius 1 mm does not fit into this arc"),
        (
            "o1 while [1]\nZ1\nZ2\no1 endwhile\n",
            "p.ngc:7",
            "too many moves across the plane of the compensation",
        ),
        ("G41.1 D2\n", "p.ngc:5", "the cutter is compensated already"),
        ("X20\nG40\nG2 X30 R9\n", "p.ngc:7", "the move behind a compensation is not straight"),
        ("G28\n", "p.ngc:5", "`G28` while the cutter is compensated"),
        ("G53 G0 X3\n", "p.ngc:5", "`G53` while the cutter is compensated"),
        ("G92 X0\n", "p.ngc:5", "`G92` while the cutter is compensated"),
        ("G92.1\n", "p.ngc:5", "another shift of the coordinates while"),
        ("G52 X3\n", "p.ngc:5", "`G52` while the cutter is compensated"),
        ("G10 L2 P1 X3\n", "p.ngc:5", "`G10` while the cutter is compensated"),
        ("G55\n", "p.ngc:5", "another work offset while the cutter is compensated"),
        ("G18\n", "p.ngc:5", "another plane while the cutter is compensated"),
        ("G81 X20 Z-3 R1\n", "p.ngc:5", "a drilling cycle while the cutter is compensated"),
        ("G5 X20 Y3 I1 J1 P1 Q1\n", "p.ngc:5", "G5 while the cutter is compensated"),
        ("G5.2 X20 Y3 P1\nX30 Y0 P1\nG5.3\n", "p.ngc:5", "G5.2 while the cutter is compensated"),
        ("S9 G33 X20 K1\n", "p.ngc:5", "G33 while the cutter is compensated"),
    ] {
        let said_of = errors(&format!("{head}{text}"));
        assert!(said_of.contains(place) && said_of.contains(said), "{text}: {said_of}");
    }
    for (text, said) in [
        (
            "G41.1 D2\nG1 X1\n",
            "the first move of the compensation is 1 mm long, and the radius of the tool 1 mm",
        ),
        ("G41.1 D2\nG1 Z5\n", "the first move of the compensation is 0 mm long"),
        ("G41.1 D4\nG3 X2 Y2 J2\n", "a tool of radius 2 mm does not fit into this arc"),
        ("G42.1 D4\nG3 X2 Y2 J2\n", "a tool of radius 2 mm does not fit into this arc"),
        ("G19 G41.1 D2\n", "not compensated in the plane of Y and Z"),
        ("G41.1\nG1 X9\n", "`G41.1` without the diameter of the tool"),
        ("G41 D3\nG1 X9\n", "the radius of tool 3 is not known"),
        ("G41 D1.5\nG1 X9\n", "the radius of tool 1.5 is not known"),
    ] {
        let said_of = errors(&format!("G21 G90 F60\nG0 X0 Y0 Z0\n{text}"));
        assert!(said_of.contains(said), "{text}: {said_of}");
    }
    // Other controls begin it, end it and pass corners otherwise.
    for dialect in [Dialect::Fanuc, Dialect::Siemens] {
        let options = ReadOptions { dialect: Some(dialect), ..LINUXCNC };
        let text = "G21 G90 F60\nG0 X0 Y0 Z0\nG41 D1\nG1 X10\nX20\nG40 X30\nX40\n";
        let said = read_part_with("p.nc", text, options).unwrap_err().to_string();
        assert!(said.contains("cutter compensation, `G41`, is not read"), "{said}");
        let kept = read_part_with(
            "p.nc",
            &text.replace("X40\n", "X40 Y0 Z0\nX50\n"),
            ReadOptions { lenient: true, ..options },
        );
        let lines: Vec<_> = kept.unwrap().moves.iter().map(|one| one.line).collect();
        assert_eq!(lines, [8], "the moves from G41 to G40 are left out");
    }
}

/// Which tool is meant: by D, by the tool in the spindle, or by G10.
#[test]
fn the_radius_is_that_of_the_tool() {
    let tools = "T1 P1 Z10 D2.0 ;end mill\n;T9 D9\nt4 p7 d4\n";
    let csv = "tool,name,diameter_mm\n1,end mill,2\n4,,4\n";
    let table = ToolTable::read("tool.tbl", tools, Unit::Millimetre).unwrap();
    assert_eq!(ToolTable::read("tools.csv", csv, Unit::Inch).unwrap(), table);
    let offset = |text: &str| {
        let text = format!("G21 G90 F60\nG0 X0 Y0 Z0\n{text}\nG1 X20\nX30\n");
        let part = read_part_bytes_with("p.ngc", text.as_bytes(), LINUXCNC, &table)
            .unwrap_or_else(|errors| panic!("{text}{errors}"));
        part.curves.last().unwrap().control_points_mm()[1][1]
    };
    for (text, expected) in [
        ("G41 D1", 1.0),
        ("G42 D4", -2.0),
        ("T4 M6\nG41", 2.0),
        ("M6 T4\nG41 D0", 2.0),
        ("T4\nG41", 0.0),
        ("T1 M6\nT4\nG41", 1.0),
        ("M61 Q4\nG41", 2.0),
        ("G10 L1 P4 R3\nG41 D4", 3.0),
        ("G10 L1 P8 R0.5\nG41 D8", 0.5),
        ("G41", 0.0),
    ] {
        assert_eq!(offset(text), expected, "{text}");
    }
    let inches = ToolTable::read("t", tools, Unit::Inch).unwrap();
    assert_eq!(inches.diameter_mm(4), Some(4.0 * 25.4));
    let radii = ToolTable::read("t", "tool, radius_inch\n3, 0.5\n", Unit::Millimetre).unwrap();
    assert_eq!(radii.tools().collect::<Vec<_>>(), [(3, 25.4)]);
    for (text, said) in [
        ("", "the tool table has no tool"),
        ("; T1\n", "the tool table has no tool"),
        ("T1 D2\nD3\n", "t:2:1"),
        ("T1 D2\nT2 K3\n", "t:2:4"),
        ("T1 D2\nT1 D3\n", "tool 1 is there twice"),
        ("T1.5 D2\n", "1.5 is no number of a tool"),
        ("T1 D20000\n", "the diameter is 20000 mm"),
        ("T1 Dx\n", "`Dx` is no word of a tool table"),
        ("tool,size\n1,2\n", "this is no tool table"),
        ("tool,diameter_mm\n1,2\n2,x\n", "t:3:1"),
        ("tool,diameter_mm\n1\n", "t:2:1"),
        ("\u{1F600}", "this is no tool table"),
    ] {
        let errors = ToolTable::read("t", text, Unit::Millimetre).unwrap_err().to_string();
        assert!(errors.contains(said), "{text:?}: {errors}");
    }
}

/// Where the program rests, it rests at the end of the way, wherever the next move makes that be; feeds are the program's.
#[test]
fn rests_and_feeds_stay_with_their_moves() {
    let text = "G21 G90 F60\nG0 X0 Y0 Z0\nG41.1 D2\nG1 X10\nX20\nG4 P1\nY20 F120\nM8\nX40\nG40 X60\n";
    let part = read(text);
    let found: Vec<_> =
        part.moves.iter().map(|one| (one.line, one.shape, one.exact_stop, one.feedrate_mm_per_s)).collect();
    assert_eq!(
        found,
        [
            (4, Shape::Line, false, Some(1.0)),
            (5, Shape::Line, true, Some(1.0)),
            (7, Shape::Line, false, Some(2.0)),
            (9, Shape::Arc, false, Some(2.0)),
            (9, Shape::Line, false, Some(2.0)),
            (10, Shape::Line, false, Some(2.0)),
        ]
    );
    assert!(part.rest_before(2).is_some() && part.rest_before(3).is_some() && part.rest_before(4).is_none());
    // In G93 a move takes the time of its contour: 10 mm at 6 a minute are 1 mm/s.
    let part = read("G21 G90 F60\nG0 X0 Y0 Z0\nG41.1 D2\nG1 X10\nG93 Y10 F6\nG94 F60\nG40 X30\n");
    assert_eq!(part.moves[1].feedrate_mm_per_s, Some(1.0));
}

/// A control that is not named is read as LinuxCNC, with a warning; what is lost within a compensation is lost to its end.
#[test]
fn lenient_reading_leaves_out_what_it_cannot_compensate() {
    let lenient = ReadOptions { lenient: true, ..ReadOptions::default() };
    let head = "G21 G90 F60\nG0 X0 Y0 Z0\n";
    let part =
        read_part_with("p.nc", &format!("{head}G41.1 D2\nG1 X10\nX20\n"), ReadOptions::default()).unwrap();
    assert!(part.warnings.iter().any(|said| said.message.contains("is read as LinuxCNC compensates")));
    let cuts = |text: &str| {
        let part = read_part_with("p.nc", &format!("{head}{text}"), lenient).unwrap();
        let lines = part.moves.iter().filter(|one| one.kind == MoveKind::Feed).map(|one| one.line);
        lines.collect::<Vec<_>>()
    };
    assert_eq!(cuts("G41 D1\nG1 X10 Y3 Z2\nX20\nG40\nX0 Y0 Z0\nX5\n"), [8]);
    assert_eq!(cuts("G41.1 D2\nG1 X10\nX20\nX30 FOO=1\nX40 Y0 Z0\nX50\nG40\nX0 Y0 Z0\nX5\n"), [4, 11]);
    assert_eq!(cuts("G68 X0 Y0 R45\nG41.1 D2\nG1 X10\nG69\nX10 Y0 Z0\nX20\nG40\nX0 Y0 Z0\nX5\n"), [11]);
}

/// The arc into an arc begins where the tool is and ends in the contour's direction, whatever both are.
#[test]
fn an_arc_leads_into_an_arc() {
    let mut draw = Draw(99);
    for _ in 0..30 {
        let (radius, turn, tool) = (draw.between(3.0, 20.0), draw.between(0.5, 5.5), draw.between(0.05, 1.0));
        let (sin, cos) = turn.sin_cos();
        // Counterclockwise about (0, radius), from 0.
        let (x, y) = (radius * sin, radius - radius * cos);
        for (word, side) in [("G41.1", 1.0), ("G42.1", -1.0)] {
            let text = format!("G21 G90 F60\nG0 X0 Y0 Z0\n{word} D{}\nG3 X{x} Y{y} J{radius}\n", 2.0 * tool);
            let part = read(&text);
            let points = part.curves[0].control_points_mm();
            let [.., before, last] = points else { panic!("{text}") };
            assert_eq!(points[0], [0.0; 3]);
            let expected = [x - side * tool * sin, y + side * tool * cos];
            assert!((last[0] - expected[0]).abs() < 1e-9 && (last[1] - expected[1]).abs() < 1e-9, "{text}");
            let across = (last[0] - before[0]) * sin - (last[1] - before[1]) * cos;
            assert!(across.abs() < 1e-8 * radius, "the end's direction is the contour's: {text}");
            assert!((PI - turn).abs() > 4.0 || points.len() >= 3);
        }
    }
}
