//! Paper D (Liu Ping et al.; see `docs/papers.md`): knots, following error, table 2, and fine moves against the NURBS.

use format_report::{Figure, LineChart};
use nurbs_core::chord_length_parameters;
use servo_sim::{PaperRow, Servo, ServoParameters, paper_table};

use crate::contour_table::contour_table;
use crate::error::PaperError;
use crate::figures::PaperFigures;
use crate::judged::part;
use crate::papers_data::{PAPER_D, SERVO};
use crate::row::{Printed, Row};

const CIRCLE: &str =
    "circle R10 F4000, 24 ms before interpolation, position gain 50.7 1/s, lag 0.39 ms, data/servo.toml";

pub(crate) fn figures() -> Result<PaperFigures, PaperError> {
    let drive = ServoParameters::from_toml(SERVO).map_err(PaperError::of("the drive"))?;
    let table = paper_table(&drive).map_err(PaperError::of("table 2 of paper D"))?;
    let mut rows = knot_rows()?;
    rows.push(following_row()?);
    rows.extend(table_rows(&table));
    rows.extend(contour_rows()?);
    Ok(PaperFigures { rows, pictures: vec![picture(&table)] })
}

fn row(place: &'static str, quantity: &str, unit: &'static str, printed: Printed, measured: f64) -> Row {
    Row {
        paper: 'D',
        place,
        quantity: quantity.to_string(),
        unit,
        printed,
        measured,
        setting: "",
        reason: "",
    }
}

/// The knots of (6) for the printed points, beside those of the program.
fn knot_rows() -> Result<Vec<Row>, PaperError> {
    let part = part("paper D", PAPER_D)?;
    let curve = part.curves.first().ok_or("no curve").map_err(PaperError::of("paper D's knots"))?;
    let parameters = chord_length_parameters(curve.control_points_mm());
    // The formula's inner knots are the parameters of the inner points.
    let inner = &parameters[1..parameters.len() - 1];
    let setting = "(5) and (6) with the ten points of the program";
    let reason = "a cubic through ten points has 12 control points and 16 knots; the program's ten are control points, and its 14 \
                  knots follow from no rule that was tried";
    let count = (inner.len() + 8) as f64;
    let mut rows = vec![Row {
        setting,
        reason,
        ..row("(6)", "knots", "", Printed::Number(curve.knots().len() as f64), count)
    }];
    for (index, (printed, ours)) in curve.knots()[4..10].iter().zip(inner).enumerate() {
        let quantity = format!("inner knot {}", index + 1);
        rows.push(Row { setting, reason, ..row("(6)", &quantity, "", Printed::Number(*printed), *ours) });
    }
    Ok(rows)
}

/// 3.1: 160 mm/s at a gain of 30 1/s.
fn following_row() -> Result<Row, PaperError> {
    let axis = ServoParameters::new(30.0, 0.39);
    let of = || PaperError::of("the following error");
    let servo = Servo::<f64, 1>::try_new(&[axis], 1e-3, [0.0]).map_err(of())?;
    let trace = servo.run((1..=1000).map(|period| [0.16 * f64::from(period)])).map_err(of())?;
    let [error] = trace.following_error();
    let setting = "one axis at 160 mm/s, simulated without feed-forward, gain 30 1/s";
    Ok(Row { setting, ..row("3.1", "following error", "mm", Printed::Number(5.33), error.max) })
}

fn table_rows(table: &[PaperRow]) -> Vec<Row> {
    let mut rows = Vec::new();
    for one in table {
        let setting = &one.setting;
        let printed = match setting.printed_radial_error_mm {
            Some(mm) if mm != 0.0 => Printed::Number(mm * 1000.0),
            _ => Printed::Words(setting.printed),
        };
        let quantity = format!(
            "{}: {} %, feed-forward {} %: mean radial error",
            setting.part,
            setting.velocity_gain_percent,
            setting.feed_forward * 100.0
        );
        let reason = match setting.part {
            "a" => {
                "\"about 5\"; gain and lag are fitted to a and b, so these two show nothing. With 30 1/s it is -13.7"
            }
            _ => "",
        };
        let ours = one.fitted.radial_error_mean_mm * 1000.0;
        rows.push(Row { setting: CIRCLE, reason, ..row("table 2", &quantity, "µm", printed, ours) });
        let quantity = format!("{}: roundness", setting.part);
        let ours = one.fitted.roundness_mm * 1000.0;
        rows.push(Row {
            setting: CIRCLE,
            ..row("table 2", &quantity, "µm", Printed::Words(setting.printed), ours)
        });
    }
    rows
}

fn contour_rows() -> Result<Vec<Row>, PaperError> {
    let table = contour_table()?;
    let rows = table.iter().map(|one| Row {
        setting: "the curve of the program, F4000, T 1 ms, A 1000 mm/s² along and across, corners of moves passed within 0.01 mm; drive of \
                  table 2, part d",
        reason: if one.printed_mm.is_some() { "another part: the paper does not name its own" } else { "" },
        ..row(
            "section 3, end",
            &format!("{}: contour error", one.path),
            "mm",
            one.printed_mm.map_or(Printed::Words(""), Printed::Number),
            one.contour_error_mm,
        )
    });
    Ok(rows.collect())
}

/// Table 2 as a picture: mean radial error and roundness, part by part.
fn picture(table: &[PaperRow]) -> Figure {
    let line = |of: fn(&PaperRow) -> f64| {
        (1_u32..).zip(table).map(|(index, one)| (f64::from(index), of(one) * 1000.0)).collect::<Vec<_>>()
    };
    let printed = table
        .iter()
        .zip(1_u32..)
        .filter_map(|(one, index)| Some((f64::from(index), one.setting.printed_radial_error_mm? * 1000.0)));
    LineChart::new(["part of table 2: a = 1 to d = 4 [count]", "radial error, roundness [µm]"])
        .line("error, 50.7 1/s", line(|one| one.fitted.radial_error_mean_mm))
        .line("error, 30 1/s", line(|one| one.printed_gain.radial_error_mean_mm))
        .line("roundness, 50.7 1/s", line(|one| one.fitted.roundness_mm))
        .line("printed error", printed.collect())
        .drawn()
        .named(
            "d-table-2",
            "Paper D, table 2: circle test",
            "Mean radial error and roundness of the circle R10 at F4000 in the four settings of the table.",
        )
}
