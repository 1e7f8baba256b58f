//! A register for each signal that is wide enough for all parts of a set: the union of what the parts need.

use std::collections::BTreeMap;

use real::FormatName;
use serde::Serialize;
use serde_json::Value;

/// The registers of a set.
#[derive(Clone, Debug, Serialize)]
pub(crate) struct RegistersOfSet {
    /// One for each signal, in the order of the first part that has it.
    pub(crate) signals: Vec<RegisterOfSet>,
    /// The widths of all registers together, in bits.
    pub(crate) bits: u32,
    /// Number of parts of which each has a register for each signal.
    pub(crate) parts: usize,
    /// Fraction bits that all registers have beside those that a part needs, so that the runs of all parts are good.
    pub(crate) added_bits: u32,
    /// Whether a run of each of these parts with these registers is good.
    pub(crate) is_confirmed: bool,
    /// The parts that have none, since no format is enough for them, or registers are not.
    pub(crate) without: Vec<String>,
}

/// A register, with the parts that need it as it is.
#[derive(Clone, Debug, Serialize)]
pub(crate) struct RegisterOfSet {
    pub(crate) signal: String,
    pub(crate) group: String,
    pub(crate) meaning: String,
    pub(crate) format: String,
    pub(crate) bits: u32,
    /// The largest proven bound of a part.
    pub(crate) bound: f64,
    /// The part that needs the integer bits, and the one that needs the fraction bits: the first of those that need most.
    pub(crate) integer_bits_for: String,
    pub(crate) fraction_bits_for: String,
}

impl RegistersOfSet {
    /// The union over the results of `size`; `None` if none of them has registers.
    pub(crate) fn of(results: &[(&str, &Value)]) -> Option<Self> {
        let mut signals: Vec<RegisterOfSet> = Vec::new();
        let mut places: BTreeMap<String, usize> = BTreeMap::new();
        let mut without = Vec::new();
        for (part, result) in results {
            let Some(registers) = result["mixed"]["signals"].as_array() else {
                without.push((*part).to_string());
                continue;
            };
            for register in registers.iter().filter_map(|register| RegisterOfSet::of(register, part)) {
                match places.get(&register.signal) {
                    Some(place) => signals[*place].widen(&register),
                    None => {
                        places.insert(register.signal.clone(), signals.len());
                        signals.push(register);
                    }
                }
            }
        }
        let parts = results.len() - without.len();
        let bits = signals.iter().map(|signal| signal.bits).sum();
        (parts > 0).then_some(Self { signals, bits, parts, added_bits: 0, is_confirmed: false, without })
    }
}

impl RegistersOfSet {
    /// The fraction bits of each signal.
    pub(crate) fn fraction_bits(&self) -> BTreeMap<String, u32> {
        let bits = |signal: &RegisterOfSet| match FormatName::named(&signal.format)? {
            FormatName::Fixed { fraction_bits, .. } => Some((signal.signal.clone(), fraction_bits)),
            _ => None,
        };
        self.signals.iter().filter_map(bits).collect()
    }

    /// The same registers with a fraction bit more in each.
    pub(crate) fn with_a_bit_more(mut self) -> Self {
        for signal in &mut self.signals {
            if let Some(FormatName::Fixed { integer_bits, fraction_bits, datapath }) =
                FormatName::named(&signal.format)
            {
                let wider = FormatName::Fixed { integer_bits, fraction_bits: fraction_bits + 1, datapath };
                (signal.format, signal.bits) = (wider.to_string(), wider.bits());
            }
        }
        self.bits = self.signals.iter().map(|signal| signal.bits).sum();
        self.added_bits += 1;
        self
    }
}

impl RegisterOfSet {
    /// The register of a part, as JSON has it.
    fn of(register: &Value, part: &str) -> Option<Self> {
        let text = |key: &str| register[key].as_str().map(str::to_string);
        let format = text("format")?;
        Some(Self {
            signal: text("signal")?,
            group: text("group")?,
            meaning: text("meaning")?,
            bits: FormatName::named(&format)?.bits(),
            format,
            bound: register["bound"].as_f64()?,
            integer_bits_for: part.to_string(),
            fraction_bits_for: part.to_string(),
        })
    }

    /// Takes in the register of another part for the same signal.
    fn widen(&mut self, other: &Self) {
        let (Some(own), Some(of_other)) = (FormatName::named(&self.format), FormatName::named(&other.format))
        else {
            return;
        };
        let (
            FormatName::Fixed { integer_bits, fraction_bits, datapath },
            FormatName::Fixed { integer_bits: other_integer, fraction_bits: other_fraction, .. },
        ) = (own, of_other)
        else {
            return;
        };
        if other_integer > integer_bits {
            self.integer_bits_for.clone_from(&other.integer_bits_for);
        }
        if other_fraction > fraction_bits {
            self.fraction_bits_for.clone_from(&other.fraction_bits_for);
        }
        let widest = FormatName::Fixed {
            integer_bits: integer_bits.max(other_integer),
            fraction_bits: fraction_bits.max(other_fraction),
            datapath,
        };
        (self.format, self.bits) = (widest.to_string(), widest.bits());
        self.bound = self.bound.max(other.bound);
    }
}

#[cfg(test)]
mod tests {
    use serde_json::json;

    use super::*;

    fn result(registers: &[(&str, &str, f64)]) -> Value {
        let signal = |(signal, format, bound): &(&str, &str, f64)| json!({"signal": signal, "group": "step", "meaning": "a step", "format": format, "bound": bound});
        json!({"mixed": {"signals": registers.iter().map(signal).collect::<Vec<_>>()}})
    }

    #[test]
    fn a_register_holds_what_every_part_needs() {
        let (a, b) =
            (result(&[("x", "I3F20", 3.9)]), result(&[("x", "I5F18", 9.0), ("y", "I2F9-floor", 1.0)]));
        let none = json!({"mixed": null});
        let of_set = RegistersOfSet::of(&[("a.nc", &a), ("b.nc", &b), ("c.nc", &none)]).expect("registers");
        assert_eq!((of_set.bits, of_set.parts, &of_set.without[..]), (25 + 11, 2, &["c.nc".to_string()][..]));
        let [x, y] = &of_set.signals[..] else { panic!("{:?}", of_set.signals) };
        assert_eq!((x.format.as_str(), x.bits, x.bound), ("I5F20", 25, 9.0));
        assert_eq!((x.integer_bits_for.as_str(), x.fraction_bits_for.as_str()), ("b.nc", "a.nc"));
        assert_eq!((y.format.as_str(), y.integer_bits_for.as_str()), ("I2F9-floor", "b.nc"));
        let wider = of_set.clone().with_a_bit_more();
        assert_eq!((wider.bits, wider.added_bits, wider.fraction_bits()["x"]), (38, 1, 21));
        assert!(RegistersOfSet::of(&[("c.nc", &none)]).is_none());
    }
}
