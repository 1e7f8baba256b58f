//! Test vectors of runs.

use format_compare::{Options, Vectors, format_named, formats, plan_for};
use nurbs_core::ORIGIN_EXPONENT;
use real::Real;

use crate::examples::{EXAMPLE, on_example_machine};

fn of(format: &str) -> Vectors {
    let problem = on_example_machine::<2>(EXAMPLE, "");
    let (format, options) = (format_named::<2>(format).unwrap(), Options::default());
    let plan = plan_for(&problem, format.as_ref(), &options).unwrap();
    let run = format.run(&problem, &plan, &options).unwrap();
    let vectors = format.vectors(&problem, &plan, &options).unwrap();
    assert_eq!(vectors.about.periods, run.steps.len());
    for (row, step) in rows(&vectors.periods.csv).zip(&run.steps) {
        let unit = 1.0.ldexp(ORIGIN_EXPONENT);
        for (axis, column) in ["position_x", "position_y"].into_iter().enumerate() {
            let mm = i64::from_str_radix(&row(column), 16)
                .unwrap_or_else(|_| u64::from_str_radix(&row(column), 16).unwrap().cast_signed());
            assert!((mm as f64 * unit - step.point_mm[axis]).abs() <= unit, "{column}: {mm}");
        }
        assert_eq!(row("evaluations"), step.evaluations.to_string());
    }
    vectors
}

/// The rows of a CSV; each gives the text of a column.
pub(crate) fn rows(csv: &str) -> impl Iterator<Item = impl Fn(&str) -> String + '_> {
    let header: Vec<&str> = csv.lines().next().unwrap().split(',').collect();
    csv.lines().skip(1).map(move |line| {
        let (header, cells): (_, Vec<&str>) = (header.clone(), line.split(',').collect());
        move |column: &str| cells[header.iter().position(|name| *name == column).unwrap()].to_string()
    })
}

/// Vectors are made in few formats' code, whatever the format: see `few_backends`. They are of the run that is judged, which
/// is compiled for each.
#[test]
fn setpoints_are_those_of_the_run_in_every_format() {
    let others = ["I5F21".to_string()].into_iter();
    for format in formats::<2>().iter().map(|format| format.name().to_string()).chain(others) {
        of(&format);
    }
}

/// The memory image has the values of the CSV, and one width.
#[test]
fn the_image_reads_back_as_the_table() {
    let Vectors { about, periods, signals } = of("I4F28");
    for (table, columns) in [(&periods, &about.period_columns), (&signals, &about.signal_columns)] {
        assert_eq!(table.image.lines().count(), table.csv.lines().count() - 1);
        for (line, row) in table.image.lines().zip(rows(&table.csv)) {
            let mut rest = line;
            for column in columns {
                let (digits, behind) = rest.split_at(column.bits.div_ceil(4) as usize);
                let (found, text) = (u64::from_str_radix(digits, 16).unwrap(), row(&column.name));
                let radix = if column.is_count { 10 } else { 16 };
                assert_eq!(found, u64::from_str_radix(&text, radix).unwrap(), "{}", column.name);
                rest = behind;
            }
            assert!(rest.is_empty());
        }
    }
}

/// A reader finds t, the last parameter that a period names, in the phase: 28 of its 64 bits, rounded.
#[test]
fn a_signal_follows_from_another_column() {
    let Vectors { about, periods, signals } = of("I4F28");
    let mut parameters = vec![None; about.periods];
    for row in rows(&signals.csv) {
        let [period, signal] = ["period", "signal"].map(|column| row(column).parse::<usize>().unwrap());
        if about.signals[signal] == "parameter" {
            parameters[period] = Some(u64::from_str_radix(&row("word"), 16).unwrap());
        }
    }
    for (parameter, row) in parameters.into_iter().zip(rows(&periods.csv)).take(about.periods - 1) {
        let phase = u64::from_str_radix(&row("phase"), 16).unwrap();
        assert!(parameter.unwrap().abs_diff(phase >> 36) <= 1, "period {}", row("period"));
    }
}
