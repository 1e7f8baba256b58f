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
    use super::*;
    use crate::Priced;
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
                "my.toml:21: operation 1: cycles = { low = 100, typical = 1, high = 2 }: expected low <= typical",
            ),
            (
                "low = 1,",
                "low = -1,",
                "my.toml:21: operation 1: cycles = -1: expected a number of 0 to 1e9 cycles",
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
