//! The registers of `size` as types of the language in which the datapath is written.

use std::fmt::Write as _;

use clap::ValueEnum;
use foreign_text::in_a_comment;
use format_compare::{Mixed, Register};
use real::{Datapath, FormatName, Overflow, Rounding};

/// Languages, by their names on the command line.
#[derive(Clone, Copy, Debug, PartialEq, Eq, ValueEnum)]
pub(crate) enum Language {
    /// A VHDL-2008 package of `sfixed` subtypes.
    Vhdl,
    /// A C++ header for high-level synthesis: `ap_fixed`, or `ac_fixed` with `FEED_AC` defined.
    Hls,
    /// A MATLAB function that returns `fi` prototypes with `numerictype` and `fimath`.
    Matlab,
    /// A Rust module of types of the crate `fixed`.
    Rust,
    /// A C99 header of integer types with their fraction bits.
    C,
}

/// The registers, with what a reader of the file is told about them.
pub(crate) struct Types<'a> {
    /// The registers.
    pub(crate) mixed: &'a Mixed,
    /// How all of them round and overflow.
    pub(crate) datapath: Datapath,
    /// The part's name.
    pub(crate) part: &'a str,
    /// The largest fluctuation that is allowed.
    pub(crate) fluctuation_limit: f64,
}

/// A register and its widths.
struct Row<'a> {
    signal: &'a str,
    meaning: &'a str,
    integer_bits: u32,
    fraction_bits: u32,
    /// The proven bound in decimals, rounded up.
    bound: String,
}

impl<'a> Row<'a> {
    fn of(register: &'a Register) -> Option<Self> {
        let FormatName::Fixed { integer_bits, fraction_bits, .. } = FormatName::named(&register.format)?
        else {
            return None;
        };
        let bound = format!("{:.4}", (register.bound * 1e4).ceil() / 1e4);
        Some(Self { signal: register.signal, meaning: register.meaning, integer_bits, fraction_bits, bound })
    }

    fn bits(&self) -> u32 {
        self.integer_bits + self.fraction_bits
    }

    /// The width of the machine word that holds it: 8, 16, 32, 64 or 128 bits.
    fn word_bits(&self) -> u32 {
        self.bits().next_power_of_two().max(8)
    }

    /// The signal's name in capitals at the beginning of each word and without underscores.
    fn in_camel_case(&self) -> String {
        let capital = |word: &str| word[..1].to_uppercase() + &word[1..];
        self.signal.split('_').filter(|word| !word.is_empty()).map(capital).collect()
    }
}

impl Types<'_> {
    /// The text of a file in this language.
    pub(crate) fn in_language(&self, language: Language) -> String {
        let rows: Vec<Row<'_>> = self.mixed.signals.iter().filter_map(Row::of).collect();
        match language {
            Language::Vhdl => self.vhdl(&rows),
            Language::Hls => self.hls(&rows),
            Language::Matlab => self.matlab(&rows),
            Language::Rust => self.rust(&rows),
            Language::C => self.c(&rows),
        }
    }

    /// The comment at the top, each line behind `mark`.
    fn about(&self, mark: &str, more: &[&str]) -> String {
        let Mixed { bits, fluctuation, signals, .. } = self.mixed;
        let lines = [
            format!("Part {}: {} registers of {bits} bits in all.", in_a_comment(self.part), signals.len()),
            format!("Written by `feedbits size --types`, version {}.", env!("CARGO_PKG_VERSION")),
            String::new(),
            format!(
                "The feed fluctuates by {fluctuation:.1e}, and {:.1e} are allowed, if each signal",
                self.fluctuation_limit
            ),
            "is rounded to its type wherever it is computed, and the operators between two".to_string(),
            "signals are exact to 53 bits. A type is as wide as the bound of its signal, which".to_string(),
            "is proved for this part, demands: only what is rounded up to the bound overflows.".to_string(),
            format!("Rounding: {}. Overflow: {}.", self.rounding(), self.overflow()),
        ];
        let more = more.iter().map(ToString::to_string);
        let all = lines.into_iter().chain(more);
        all.fold(String::new(), |text, line| text + format!("{mark} {line}").trim_end() + "\n")
    }

    fn rounding(&self) -> &'static str {
        match self.datapath.rounding {
            Rounding::Nearest => "to nearest, ties up",
            Rounding::NearestEven => "to nearest, ties to even",
            Rounding::Floor => "down",
            Rounding::TowardZero => "toward zero",
        }
    }

    fn overflow(&self) -> &'static str {
        match self.datapath.overflow {
            Overflow::Wrap => "the high bits are lost",
            Overflow::Saturate => "the nearest extreme is taken",
        }
    }

    /// The one of two words that names this datapath's way of overflowing.
    fn wrap_or(&self, wrap: &'static str, saturate: &'static str) -> &'static str {
        match self.datapath.overflow {
            Overflow::Wrap => wrap,
            Overflow::Saturate => saturate,
        }
    }

    fn vhdl(&self, rows: &[Row<'_>]) -> String {
        let mut text = self.about(
            "--",
            &[
                "",
                "    signal step : step_t;",
                "    step <= to_register(step_per_chord * chord_length, step);",
            ],
        );
        text += "\nlibrary ieee;\nuse ieee.std_logic_1164.all;\nuse ieee.fixed_float_types.all;\nuse ieee.fixed_pkg.all;\n\npackage feed_signals is\n";
        for row in rows {
            let Row { signal, meaning, bound, integer_bits, fraction_bits } = row;
            let _ = writeln!(
                text,
                "    -- {meaning}; at most {bound}\n    subtype {signal}_t is sfixed({} downto -{fraction_bits});",
                integer_bits - 1,
            );
        }
        let style = self.wrap_or("fixed_wrap", "fixed_saturate");
        let resized = |value: &str, round: &str| {
            format!("        return resize({value}, size_res'high, size_res'low, {style}, {round});\n")
        };
        let (declared, returned) = match self.datapath.rounding {
            Rounding::Nearest => (
                "        constant half : sfixed(size_res'low downto size_res'low - 1) := \"01\";\n",
                resized("value + half", "fixed_truncate"),
            ),
            Rounding::NearestEven => ("", resized("value", "fixed_round")),
            Rounding::Floor => ("", resized("value", "fixed_truncate")),
            Rounding::TowardZero => (
                "        constant high : integer := maximum(value'high, size_res'high) + 1;\n",
                "        if value(value'high) = '1' then\n    ".to_string()
                    + &resized(
                        "-resize(-value, high, size_res'low, fixed_wrap, fixed_truncate)",
                        "fixed_truncate",
                    )
                    + "        end if;\n"
                    + &resized("value", "fixed_truncate"),
            ),
        };
        let declaration = "    function to_register(value : sfixed; size_res : sfixed) return sfixed";
        let _ = write!(
            text,
            "\n    -- The number that a register with the range of size_res holds for a value.\n{declaration};\nend package;\n\n\
             package body feed_signals is\n{declaration} is\n{declared}    begin\n{returned}    end function;\nend package body;\n"
        );
        text
    }

    fn hls(&self, rows: &[Row<'_>]) -> String {
        let rounding = match self.datapath.rounding {
            Rounding::Nearest => "RND",
            Rounding::NearestEven => "RND_CONV",
            Rounding::Floor => "TRN",
            Rounding::TowardZero => "TRN_ZERO",
        };
        let overflow = self.wrap_or("WRAP", "SAT");
        let mut text =
            self.about("//", &["", "With FEED_AC defined the types are ac_fixed, otherwise ap_fixed."]);
        let _ = write!(
            text,
            "\n#ifndef FEED_SIGNALS_H\n#define FEED_SIGNALS_H\n\n#ifdef FEED_AC\n#include <ac_fixed.h>\n\
             #define FEED_FIXED(W, I) ac_fixed<W, I, true, AC_{rounding}, AC_{overflow}>\n\
             #else\n#include <ap_fixed.h>\n#define FEED_FIXED(W, I) ap_fixed<W, I, AP_{rounding}, AP_{overflow}>\n#endif\n\n\
             namespace feed_signals {{\n\n"
        );
        for row in rows {
            let Row { signal, meaning, bound, integer_bits, .. } = row;
            let _ = writeln!(
                text,
                "// {meaning}; at most {bound}\ntypedef FEED_FIXED({}, {integer_bits}) {signal}_t;",
                row.bits()
            );
        }
        text + "\n}\n\n#undef FEED_FIXED\n#endif\n"
    }

    fn matlab(&self, rows: &[Row<'_>]) -> String {
        let rounding = match self.datapath.rounding {
            Rounding::Nearest => "Nearest",
            Rounding::NearestEven => "Convergent",
            Rounding::Floor => "Floor",
            Rounding::TowardZero => "Zero",
        };
        let overflow = self.wrap_or("Wrap", "Saturate");
        let mut text = "function types = feed_signals()\n".to_string();
        text += &self.about(
            "%",
            &["", "    step = cast(double(step_per_chord) * double(chord_length), 'like', types.step);"],
        );
        let _ = write!(
            text,
            "\nmath = fimath('RoundingMethod', '{rounding}', 'OverflowAction', '{overflow}', ...\n    \
             'ProductMode', 'FullPrecision', 'SumMode', 'FullPrecision');\n"
        );
        for row in rows {
            let Row { signal, meaning, bound, fraction_bits, .. } = row;
            let _ = writeln!(
                text,
                "% {meaning}; at most {bound}\ntypes.{signal} = fi([], numerictype(1, {}, {fraction_bits}), math);",
                row.bits()
            );
        }
        text + "end\n"
    }

    fn rust(&self, rows: &[Row<'_>]) -> String {
        let mut text = self.about(
            "//",
            &["", "For the crate `fixed`. Its operators round down: round their results as above."],
        );
        text.push('\n');
        for row in rows {
            let Row { meaning, bound, integer_bits, fraction_bits, .. } = row;
            let (bits, word) = (row.bits(), row.word_bits());
            let _ = writeln!(
                text,
                "/// {meaning}; at most {bound}: I{integer_bits}F{fraction_bits}, {bits} of {word} bits.\n\
                 pub type {} = fixed::FixedI{word}<fixed::types::extra::U{fraction_bits}>;",
                row.in_camel_case()
            );
        }
        text
    }

    fn c(&self, rows: &[Row<'_>]) -> String {
        let lines =
            self.about(" *", &["", "Q numbers count the sign among the bits before the point, as Arm does."]);
        let mut text = format!(
            "/*\n{lines} */\n#ifndef FEED_SIGNALS_H\n#define FEED_SIGNALS_H\n\n#include <stdint.h>\n\n"
        );
        for row in rows {
            let Row { signal, meaning, bound, integer_bits, fraction_bits } = row;
            let (bits, word, name) = (row.bits(), row.word_bits(), signal.to_uppercase());
            let _ = writeln!(
                text,
                "/* {meaning}; at most {bound}: Q{integer_bits}.{fraction_bits} */\ntypedef int{word}_t feed_{signal};\n\
                 #define FEED_{name}_BITS {bits}\n#define FEED_{name}_FRACTION_BITS {fraction_bits}",
            );
        }
        text + "\n#endif\n"
    }
}

#[cfg(test)]
mod tests;
