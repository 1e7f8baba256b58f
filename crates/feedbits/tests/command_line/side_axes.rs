//! Axes beside the path, as a person meets them.

use std::fs;

use crate::command::feedbits;
use crate::message::unfolded;

const MACHINE: &str = "[machine]\ninterpolation_period_ms = 1\nfeedrate_mm_per_s = 50\nacceleration_mm_per_s2 = 1000\n\
                       jerk_mm_per_s3 = 1e5\n[machine.axes.a]\nvelocity_deg_per_s = 60\nacceleration_deg_per_s2 = 400\n\
                       jerk_deg_per_s3 = 8000\n";
/// A line, an arc of half a turn, a turn at rest and a line along which A stands still.
const PART: &str = "G21 G90 G94 F3000\nG0 X0 Y0 A0\nG1 X10 A20\nG3 X10 Y10 J5 A60 W3\nG0 A90\nG1 X0\n";

/// A folder with the part and the machine, and their paths.
fn folder() -> (tempfile::TempDir, [String; 3]) {
    let folder = tempfile::tempdir().expect("a temporary folder");
    let paths = ["p.ngc", "m.toml", "out"].map(|name| folder.path().join(name).display().to_string());
    for (path, content) in paths.iter().zip([PART, MACHINE]) {
        fs::write(path, content).expect("the folder is writable");
    }
    (folder, paths)
}

/// The rows of a CSV file as numbers, with its head.
fn rows(text: &str) -> (Vec<&str>, Vec<Vec<f64>>) {
    let mut lines = text.lines();
    let head = lines.next().expect("a head").split(',').collect();
    let numbers = |line: &str| line.split(',').map(|one| one.parse().expect("a number")).collect();
    (head, lines.map(numbers).collect())
}

/// A is at twice X along the line, at 20° and the arc's share of 40° along the arc, and at 90° behind it.
#[test]
fn interpolate_has_a_column_for_each_axis() {
    let (_folder, [part, machine, _]) = folder();
    let output = feedbits(&["interpolate", &part, "--dialect", "linuxcnc", "--machine", &machine]);
    let said = unfolded(&output.stderr);
    assert!(output.status.success(), "{said}");
    assert!(said.contains("beside the path: A, W") && said.contains("no verdict is on them"), "{said}");
    assert!(said.contains("[machine.axes.w] states no limit"), "{said}");
    let text = String::from_utf8(output.stdout).expect("text");
    let (head, rows) = rows(&text);
    let column = |name: &str| head.iter().position(|one| *one == name).expect("the column");
    let [x, y, a, w] = ["x_mm", "y_mm", "a_deg", "w_mm"].map(column);
    let (mut on_line, mut on_arc, mut behind) = (0, 0, 0);
    for row in &rows {
        let (x, y) = (row[x], row[y]);
        let (expected, counted) = if y == 0.0 && x < 10.0 {
            ([2.0 * x, 0.0], &mut on_line)
        } else if x > 10.0 {
            // Half a turn about (10, 5), from below.
            let share = (x - 10.0).atan2(5.0 - y) / std::f64::consts::PI;
            ([20.0 + 40.0 * share, 3.0 * share], &mut on_arc)
        } else if x < 9.0 {
            ([90.0, 3.0], &mut behind)
        } else {
            continue;
        };
        *counted += 1;
        for (found, expected) in [row[a], row[w]].into_iter().zip(expected) {
            assert!((found - expected).abs() < 1e-6, "{found}, not {expected}: {row:?}");
        }
    }
    assert!([on_line, on_arc, behind].iter().all(|count| *count > 100), "{on_line} {on_arc} {behind}");
    // From rest to rest, up to the end of the arc.
    let mut turned = vec![0.0; 4];
    turned.extend(rows.iter().map(|row| row[a]).take_while(|a| *a < 61.0));
    turned.extend([60.0; 3]);
    for (order, most) in [(1, 60.0), (2, 400.0), (3, 8000.0)] {
        turned = turned.windows(2).map(|pair| pair[1] - pair[0]).collect();
        let found = turned.iter().fold(0.0, |most: f64, one| most.max(one.abs())) * 1000.0_f64.powi(order);
        assert!(found <= 1.001 * most && found > 0.8 * most, "{found} of {most}");
    }
    let json = feedbits(&["interpolate", &part, "--machine", &machine, "--dialect", "linuxcnc", "--json"]);
    let json: Vec<serde_json::Value> = serde_json::from_slice(&json.stdout).expect("JSON");
    assert_eq!(json.last().map(|row| row["a_deg"].as_f64()), Some(Some(90.0)));
}

#[test]
fn what_does_not_hold_the_axes_refuses_them_by_name() {
    let (_folder, [part, machine, out]) = folder();
    for command in [
        &["convert", "--to", "g1", "--tolerance", "0.01"][..],
        &["smooth", "--tolerance", "0.01"],
        &["compile", "--format", "f64"],
        &["plan", "--window", "50"],
        &["interpolate", "--override", "0:50"],
        &["interpolate", "--vectors", &out],
    ] {
        let output = feedbits(&[command, &[&part, "--machine", &machine, "--dialect", "linuxcnc"]].concat());
        let said = unfolded(&output.stderr);
        assert!(output.status.code() == Some(2), "{command:?}: {said}");
        assert!(
            said.contains("beside") && said.contains("X, Y and Z alone")
                || said.contains("A, W beside the path"),
            "{command:?}: {said}"
        );
    }
}
