//! The colours of a path: a level for each decade of what is shown.

use crate::figure::Entry;
use crate::number;
use crate::palette::LEVEL_COUNT;

/// The level of a fluctuation's colour: one level for each decade, the limit in the middle.
pub(crate) fn level(fluctuation: f64, limit: f64) -> usize {
    let beyond = (fluctuation / limit).log10().ceil();
    let levels = || (0..LEVEL_COUNT).map(|level| (level, level as f64 - LEVEL_COUNT as f64 / 2.0 + 1.0));
    levels().find(|(_, upper)| beyond <= *upper).map_or(LEVEL_COUNT - 1, |(level, _)| level)
}

/// The meaning of the colours; grey is for parts without a fluctuation.
pub(crate) fn legend(limit: f64, grey: &str) -> Vec<Entry> {
    let middle = LEVEL_COUNT / 2;
    let name = |level: usize| {
        let power = |offset: usize| 10.0_f64.powf(offset as f64 - middle as f64 + 1.0) * limit;
        match level {
            0 => format!("up to {}", number::short(power(0))),
            _ if level + 1 == LEVEL_COUNT => format!("above {}", number::short(power(level - 1))),
            _ if level + 1 == middle => format!("up to {}, the limit", number::short(power(level))),
            _ => format!("up to {}", number::short(power(level))),
        }
    };
    let levels = (0..LEVEL_COUNT).map(|level| Entry::area(&format!("f{level}"), &name(level)));
    levels.chain([Entry::area("rest-fill", grey)]).collect()
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn a_level_is_a_decade_and_the_limit_is_the_middle() {
        let levels = [1e-12, 5e-8, 1e-6, 1.01e-6, 1e-5, 2e-5, 1.0].map(|x| level(x, 1e-6));
        assert_eq!(levels, [0, 2, 3, 4, 4, 5, 7]);
        assert_eq!(legend(1e-6, "")[3].name, "up to 1.0·10⁻⁶, the limit");
        assert_eq!(legend(1e-6, "")[7].name, "above 10.0·10⁻⁴".replace("10.0·10⁻⁴", "0.001"));
    }
}
