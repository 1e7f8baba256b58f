//! The target files that come with the program.

use crate::{Target, TargetError};

macro_rules! files {
    ($($name:literal),* $(,)?) => {
        [$(($name, include_str!(concat!("../targets/", $name, ".toml")))),*]
    };
}

/// Name and text of each target.
const FILES: [(&str, &str); 12] = files![
    "cortex-m0plus",
    "cortex-m3",
    "cortex-m4",
    "cortex-m4f",
    "cortex-m7",
    "riscv32imac",
    "c28x",
    "c28x-tmu",
    "c674x",
    "dsp48",
    "ecp5",
    "ice40up",
];

/// Every built-in target.
///
/// # Errors
/// [`TargetError`] if one of the files has been damaged.
pub fn built_in() -> Result<Vec<Target>, TargetError> {
    FILES.iter().map(|(name, text)| Target::read(&format!("targets/{name}.toml"), text)).collect()
}

#[cfg(test)]
mod tests {
    use std::collections::BTreeMap;

    use super::*;
    use crate::{Cycles, Kind, Priced};
    use real::FormatName;

    /// Dropping bits takes no more than rounding; what rounds ties to even or saturates has no published price.
    #[test]
    fn a_format_is_priced_by_what_its_datapath_does() {
        let named = |name: &str| FormatName::named(name).expect("a format");
        for target in built_in().expect("they are valid") {
            for operation in [Priced::Mul, Priced::Add] {
                for format in ["I4F28", "I5F13", "I16F48"] {
                    let price = |suffix: &str| target.price(operation, named(&format!("{format}{suffix}")));
                    assert_eq!(price("-floor"), price(""), "{}", target.name);
                    for other in ["-even", "-zero", "-sat", "-floor-sat"] {
                        assert_eq!(price(other), None, "{} {format}{other}", target.name);
                    }
                }
            }
        }
    }

    /// What `scripts/synthesis` makes of an operator in a format.
    struct Synthesised {
        family: String,
        operation: Priced,
        format: FormatName,
        cycles: f64,
        dsp_blocks: u32,
        luts: u32,
        /// Slowest, middle and fastest.
        mhz: Option<Cycles>,
    }

    fn synthesised() -> Vec<Synthesised> {
        let of = |line: &str| {
            let cells: Vec<&str> = line.split(',').collect();
            let number = |at: usize| cells[at].parse::<f64>().ok();
            let count = |at: usize| cells[at].parse::<u32>().expect("a count");
            Synthesised {
                family: cells[0].to_owned(),
                operation: match cells[1] {
                    "sum" => Priced::Add,
                    "product" => Priced::Mul,
                    "quotient" => Priced::Div,
                    "root" => Priced::Sqrt,
                    other => panic!("{other}"),
                },
                format: FormatName::named(cells[2]).unwrap_or_else(|| FormatName::fixed(2, count(3) - 2)),
                cycles: number(4).expect("cycles"),
                dsp_blocks: count(5),
                luts: count(6),
                mhz: number(7).map(|low| Cycles {
                    low,
                    typical: number(8).expect("a clock"),
                    high: number(9).expect("a clock"),
                }),
            }
        };
        include_str!("../targets/synthesis.csv").lines().skip(1).map(of).collect()
    }

    /// Blocks are exact for every width; a row has the LUTs of the width that takes most.
    #[test]
    fn blocks_and_luts_are_those_of_the_synthesis() {
        let targets = built_in().unwrap();
        let mut most: BTreeMap<String, (u32, u32)> = BTreeMap::new();
        for made in synthesised() {
            let target = targets.iter().find(|target| target.name == made.family).expect("a target");
            let Some(price) = target.price(made.operation, made.format) else { continue };
            let row = target.row(made.operation, made.format).expect("a row");
            let name = format!("{} {:?} {} {:?}", target.name, made.operation, row.numbers, row.max_bits);
            assert_eq!(price.dsp_blocks, made.dsp_blocks, "{name} in {}", made.format);
            let (_, found) = most.entry(name).or_insert((price.luts, 0));
            *found = made.luts.max(*found);
        }
        assert!(most.len() > 40, "{}", most.len());
        for (name, (said, found)) in most {
            assert_eq!(said, found, "{name}");
        }
    }

    /// The clock of an ECP5 is that of the slowest operator, and its cycles are those that run at this clock.
    #[test]
    fn the_clock_of_an_ecp5_is_that_of_place_and_route() {
        let ecp5 = built_in().unwrap().into_iter().find(|target| target.name == "ecp5").unwrap();
        let mut slowest: BTreeMap<String, Cycles> = BTreeMap::new();
        for made in synthesised().into_iter().filter(|made| made.family == "ecp5") {
            let Some(price) = ecp5.price(made.operation, made.format) else {
                assert_eq!(made.mhz, None, "{}", made.format);
                continue;
            };
            assert!(
                (price.latency.typical - made.cycles).abs() < 1e-9,
                "{:?} {}",
                made.operation,
                made.format
            );
            let Some(mhz) = made.mhz else { continue };
            let slow = slowest.entry(made.format.to_string()).or_insert(mhz);
            *slow = Cycles::each(|level| slow.at(level).min(mhz.at(level)));
        }
        assert!(slowest.len() >= 8, "{}", slowest.len());
        for (format, mhz) in slowest {
            let said = ecp5.clock_mhz(FormatName::named(&format).unwrap());
            assert_eq!(said, Some(Cycles::each(|level| mhz.at(level).floor())), "{format}");
        }
    }

    /// A product of 25 signed bits no longer fits one operand of 25 and one of 18.
    #[test]
    fn a_product_of_25_bits_takes_two_blocks_of_dsp48_and_one_of_20_four_of_an_ecp5() {
        let blocks = |target: &str, bits: u32| {
            let targets = built_in().unwrap();
            let target = targets.iter().find(|one| one.name == target).unwrap();
            target.price(Priced::Mul, FormatName::fixed(2, bits - 2)).unwrap().dsp_blocks
        };
        assert_eq!([18, 24, 25].map(|bits| blocks("dsp48", bits)), [1, 2, 2]);
        assert_eq!([18, 20, 24, 36].map(|bits| blocks("ecp5", bits)), [1, 4, 4, 4]);
    }

    /// A float's adder is a unit, as its multiplier is: without one there were as many as a schedule could use, at no cost.
    #[test]
    fn sums_take_an_adder_on_every_fpga() {
        let formats =
            [FormatName::Float { bits: 32 }, FormatName::Float { bits: 64 }, FormatName::fixed(2, 23)];
        for target in built_in().unwrap().into_iter().filter(|target| target.kind == Kind::Fpga) {
            for price in formats.iter().filter_map(|format| target.price(Priced::Add, *format)) {
                let unit = price.unit.map(|unit| target.unit[unit].name.as_str());
                assert!(unit == Some("adder") && price.luts > 0, "{}: {price:?}", target.name);
            }
        }
    }

    #[test]
    fn every_file_is_read_and_named_as_its_target() {
        let targets = built_in().unwrap();
        for ((file, _), target) in FILES.iter().zip(&targets) {
            assert_eq!(*file, target.name);
            assert!(!target.operation.is_empty(), "{file}");
        }
    }

    /// Products and sums have a price everywhere in at least one format of 32 bits.
    #[test]
    fn every_target_can_do_a_product_in_some_32_bit_format() {
        let formats = [FormatName::Float { bits: 32 }, FormatName::fixed(4, 28)];
        for target in built_in().unwrap() {
            assert!(
                formats
                    .iter()
                    .any(|f| [Priced::Mul, Priced::Add].iter().all(|p| target.price(*p, *f).is_some())),
                "{}",
                target.name
            );
        }
    }

    #[test]
    fn a_wrong_file_is_refused_by_file_key_and_value() {
        let good = FILES.iter().find(|(name, _)| *name == "dsp48").unwrap().1;
        for (from, to, expected) in [
            ("kind = \"fpga\"", "kind = \"gpu\"", "gpu"),
            ("numbers = \"fixed\"", "numbers = \"Q15\"", "Q15"),
            ("unit = \"divider\"", "unit = \"devider\"", "devider"),
            ("title =", "titel =", "titel"),
            (
                "low = 1,",
                "low = 100,",
                "my.toml:24: operation 1: cycles = { low = 100, typical = 1, high = 2 }: expected low <= typical",
            ),
            (
                "low = 1,",
                "low = -1,",
                "my.toml:24: operation 1: cycles = -1: expected a number of 0 to 1e9 cycles",
            ),
            (
                "mhz = 200",
                "mhz = 1e300",
                "my.toml:6: clock 1: mhz = 1e300: expected a number of 0.001 to 1e6 MHz",
            ),
            (
                "count = 1",
                "count = 65537",
                "my.toml:10: unit 1: count = 65537: expected a whole number of 1 to 65536",
            ),
            (
                "dsp_blocks = 1",
                "dsp_blocks = 4000000000",
                "dsp_blocks = 4000000000: expected a whole number of 0 to 1024",
            ),
        ] {
            let bad = good.replacen(from, to, 1);
            assert_ne!(bad, good, "{from}");
            let message = Target::read("my.toml", &bad).unwrap_err().to_string();
            assert!(message.contains("my.toml") && message.contains(expected), "{message}");
        }
    }
}
