//! Test vectors of runs.

use format_compare::{Options, Sizing, Vectors, format_named, formats, plan_for, register_vectors, size};
use nurbs_core::ORIGIN_EXPONENT;
use real::{Datapath, FormatName, Real};

use crate::examples::{EXAMPLE, mill, on_example_machine};

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

/// The registers of a part with weights, and the vectors of the run with them.
fn with_registers() -> (Sizing, Vectors) {
    let problem = mill::<2>("G1 X0 Y0 F3000\nG2 X20 Y10 I7 J11\n", "");
    let options = Options::default();
    let plan = plan_for(&problem, format_named::<2>("f64").unwrap().as_ref(), &options).unwrap();
    let datapath = Datapath::default();
    let sizing = size(&problem, &plan, &options, datapath).unwrap();
    let vectors = register_vectors(&sizing, &problem, &plan, &options, datapath.rounding).unwrap();
    (sizing, vectors.unwrap())
}

/// A word of so many bits in two's complement.
fn signed(word: u64, bits: u32) -> i64 {
    word.cast_signed() << (64 - bits) >> (64 - bits)
}

/// Whoever reads the registers' words as numbers of their formats has the run: each is within its proven bound and as wide as its
/// register, t is the phase to the bits of its register, and the chords between setpoints are as long as the planned lengths say.
#[test]
fn the_words_of_registers_are_those_of_their_types() {
    let (sizing, Vectors { about, periods, signals }) = with_registers();
    let mixed = sizing.mixed.unwrap();
    let widths: std::collections::BTreeSet<u32> = about.registers.iter().map(|one| one.bits).collect();
    assert!(widths.len() > 2, "registers differ: {widths:?}");
    let register = |name: &str| mixed.signals.iter().find(|one| one.signal == name).unwrap();
    let fraction = |name: &str| match FormatName::named(&register(name).format) {
        Some(FormatName::Fixed { fraction_bits, .. }) => fraction_bits,
        _ => panic!("{name} has no register"),
    };
    let mut parameters = vec![None; about.periods];
    let mut seen = std::collections::BTreeSet::new();
    for row in rows(&signals.csv) {
        let [period, signal] = ["period", "signal"].map(|column| row(column).parse::<usize>().unwrap());
        let (name, digits) = (about.signals[signal], row("word"));
        let found = register(name);
        assert_eq!(digits.len(), found.bits.div_ceil(4) as usize, "{name}");
        let word = u64::from_str_radix(&digits, 16).unwrap();
        let value = (signed(word, found.bits) as f64).ldexp(-fraction(name).cast_signed());
        assert!(value.abs() <= found.bound * (1.0 + 1e-9), "{name}: {value} of {}", found.bound);
        if name == "parameter" {
            parameters[period] = Some(word);
        }
        seen.insert(name);
    }
    assert!(seen.contains("weight") && seen.contains("step_per_chord"), "{seen:?}");
    for (parameter, row) in parameters.into_iter().zip(rows(&periods.csv)).take(about.periods - 1) {
        let phase = u64::from_str_radix(&row("phase"), 16).unwrap();
        // At the end of a piece t is 1, and the phase that of the next piece's begin.
        let one = 1 << fraction("parameter");
        let (found, expected) = (parameter.unwrap() % one, phase >> (64 - fraction("parameter")));
        let off = found.abs_diff(expected);
        assert!(off.min(one - off) <= 1, "period {}: {found} for {expected}", row("period"));
    }
    let fractions = [fraction("chord_length"), fraction("offset")];
    chords_are_as_long_as_planned(&about, &periods.csv, fractions, mixed.fluctuation);
}

/// The distance between neighbouring setpoints of a section is the length of the period, but for a fluctuation, where steps are long.
fn chords_are_as_long_as_planned(
    about: &format_compare::VectorsAbout,
    csv: &str,
    [of_length, of_offset]: [u32; 2],
    fluctuation: f64,
) {
    let unit = 1.0.ldexp(about.position_exponent);
    let mut before: Option<([f64; 2], String)> = None;
    let mut judged = 0;
    for row in rows(csv) {
        let point = ["position_x", "position_y"]
            .map(|axis| u64::from_str_radix(&row(axis), 16).unwrap().cast_signed() as f64 * unit);
        let word = u64::from_str_radix(&row("length"), 16).unwrap();
        let length = (word as f64).ldexp(-of_length.cast_signed() - about.chord_exponent);
        if let Some(([x, y], section)) = &before
            && *section == row("section")
            && length > 0.04
        {
            let chord = (point[0] - x).hypot(point[1] - y);
            // The planned length and both setpoints were rounded to their registers.
            let of_setpoints = 1.0.ldexp(about.coordinate_exponent - of_offset.cast_signed());
            let rounding = 1.0.ldexp(-of_length.cast_signed() - about.chord_exponent) + 2.0 * of_setpoints;
            let (off, allowed) = ((chord - length).abs(), fluctuation * length + rounding);
            assert!(off < allowed, "{}: {chord} for {length}, {allowed} allowed", row("period"));
            judged += 1;
        }
        before = Some((point, row("section")));
    }
    assert!(judged > 300, "{judged}");
}
