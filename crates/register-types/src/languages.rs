//! A file of types in each language.

use std::fmt::Write as _;

use foreign_text::in_a_comment;
use real::{Datapath, Overflow, Rounding};

use crate::register::Register;

/// Languages.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum Language {
    /// A VHDL-2008 package of `sfixed` subtypes.
    Vhdl,
    /// A C++ header for high-level synthesis: `ap_fixed`, or `ac_fixed` with `…_AC` defined.
    Hls,
    /// A MATLAB function that returns `fi` prototypes with `numerictype` and `fimath`.
    Matlab,
    /// A Rust module of types of the crate `fixed`.
    Rust,
    /// A C99 header of integer types with their fraction bits.
    C,
}

impl Language {
    /// All languages.
    pub const ALL: [Self; 5] = [Self::Vhdl, Self::Hls, Self::Matlab, Self::Rust, Self::C];
}

/// Registers, with what a reader of the file is told about them.
#[derive(Clone, Debug)]
pub struct Types<'a> {
    /// The registers.
    pub registers: &'a [Register<'a>],
    /// How all of them round and overflow.
    pub datapath: Datapath,
    /// The word with which names in the file begin: `feed` for the package `feed_signals`. Letters of ASCII and digits, a letter first.
    pub prefix: &'a str,
    /// The lines at the top of the file. What in them could end a comment is replaced.
    pub about: &'a [String],
    /// An example, in the form `to_register(PRODUCT, NAME)`: the names of a product's two factors and of its register.
    pub example: [&'a str; 3],
}

impl Types<'_> {
    /// The text of a file in this language.
    #[must_use]
    pub fn in_language(&self, language: Language) -> String {
        match language {
            Language::Vhdl => self.vhdl(),
            Language::Hls => self.hls(),
            Language::Matlab => self.matlab(),
            Language::Rust => self.rust(),
            Language::C => self.c(),
        }
    }

    /// The comment at the top, each line behind `mark`.
    fn about(&self, mark: &str, more: &[&str]) -> String {
        let about = self.about.iter().map(|line| in_a_comment(line).to_string());
        let datapath = format!("Rounding: {}. Overflow: {}.", self.rounding(), self.overflow());
        let all = about.chain([datapath]).chain(more.iter().map(ToString::to_string));
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

    fn vhdl(&self) -> String {
        let (prefix, [one, other, product]) = (self.prefix, self.example);
        let mut text = self.about(
            "--",
            &[
                "",
                &format!("    signal {product} : {product}_t;"),
                &format!("    {product} <= to_register({one} * {other}, {product});"),
            ],
        );
        text += "\nlibrary ieee;\nuse ieee.std_logic_1164.all;\nuse ieee.fixed_float_types.all;\nuse ieee.fixed_pkg.all;\n\n";
        let _ = writeln!(text, "package {prefix}_signals is");
        for row in self.registers {
            let (remark, Register { signal, integer_bits, fraction_bits, .. }) = (row.remark(), row);
            let _ = writeln!(
                text,
                "    -- {remark}\n    subtype {signal}_t is sfixed({} downto -{fraction_bits});",
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
             package body {prefix}_signals is\n{declaration} is\n{declared}    begin\n{returned}    end function;\nend package body;\n"
        );
        text
    }

    fn hls(&self) -> String {
        let rounding = match self.datapath.rounding {
            Rounding::Nearest => "RND",
            Rounding::NearestEven => "RND_CONV",
            Rounding::Floor => "TRN",
            Rounding::TowardZero => "TRN_ZERO",
        };
        let overflow = self.wrap_or("WRAP", "SAT");
        let (prefix, capital) = (self.prefix, self.prefix.to_uppercase());
        let mut text = self.about(
            "//",
            &["", &format!("With {capital}_AC defined the types are ac_fixed, otherwise ap_fixed.")],
        );
        let _ = write!(
            text,
            "\n#ifndef {capital}_SIGNALS_H\n#define {capital}_SIGNALS_H\n\n#ifdef {capital}_AC\n#include <ac_fixed.h>\n\
             #define {capital}_FIXED(W, I) ac_fixed<W, I, true, AC_{rounding}, AC_{overflow}>\n\
             #else\n#include <ap_fixed.h>\n#define {capital}_FIXED(W, I) ap_fixed<W, I, AP_{rounding}, AP_{overflow}>\n#endif\n\n\
             namespace {prefix}_signals {{\n\n"
        );
        for row in self.registers {
            let (remark, Register { signal, integer_bits, .. }) = (row.remark(), row);
            let _ = writeln!(
                text,
                "// {remark}\ntypedef {capital}_FIXED({}, {integer_bits}) {signal}_t;",
                row.bits()
            );
        }
        text + &format!("\n}}\n\n#undef {capital}_FIXED\n#endif\n")
    }

    fn matlab(&self) -> String {
        let rounding = match self.datapath.rounding {
            Rounding::Nearest => "Nearest",
            Rounding::NearestEven => "Convergent",
            Rounding::Floor => "Floor",
            Rounding::TowardZero => "Zero",
        };
        let overflow = self.wrap_or("Wrap", "Saturate");
        let [one, other, product] = self.example;
        let mut text = format!("function types = {}_signals()\n", self.prefix);
        text += &self.about(
            "%",
            &[
                "",
                &format!("    {product} = cast(double({one}) * double({other}), 'like', types.{product});"),
            ],
        );
        let _ = write!(
            text,
            "\nmath = fimath('RoundingMethod', '{rounding}', 'OverflowAction', '{overflow}', ...\n    \
             'ProductMode', 'FullPrecision', 'SumMode', 'FullPrecision');\n"
        );
        for row in self.registers {
            let (remark, Register { signal, fraction_bits, .. }) = (row.remark(), row);
            let _ = writeln!(
                text,
                "% {remark}\ntypes.{signal} = fi([], numerictype(1, {}, {fraction_bits}), math);",
                row.bits()
            );
        }
        text + "end\n"
    }

    fn rust(&self) -> String {
        let mut text = self.about(
            "//",
            &["", "For the crate `fixed`. Its operators round down: round their results as above."],
        );
        text.push('\n');
        for row in self.registers {
            let (remark, Register { integer_bits, fraction_bits, .. }) = (row.remark(), row);
            let (bits, word) = (row.bits(), row.word_bits());
            let _ = writeln!(
                text,
                "/// {remark}: I{integer_bits}F{fraction_bits}, {bits} of {word} bits.\n\
                 pub type {} = fixed::FixedI{word}<fixed::types::extra::U{fraction_bits}>;",
                row.in_camel_case()
            );
        }
        text
    }

    fn c(&self) -> String {
        let lines =
            self.about(" *", &["", "Q numbers count the sign among the bits before the point, as Arm does."]);
        let (prefix, capital) = (self.prefix, self.prefix.to_uppercase());
        let mut text = format!(
            "/*\n{lines} */\n#ifndef {capital}_SIGNALS_H\n#define {capital}_SIGNALS_H\n\n#include <stdint.h>\n\n"
        );
        for row in self.registers {
            let (remark, Register { signal, integer_bits, fraction_bits, .. }) = (row.remark(), row);
            let (bits, word, name) = (row.bits(), row.word_bits(), signal.to_uppercase());
            let _ = writeln!(
                text,
                "/* {remark}: Q{integer_bits}.{fraction_bits} */\ntypedef int{word}_t {prefix}_{signal};\n\
                 #define {capital}_{name}_BITS {bits}\n#define {capital}_{name}_FRACTION_BITS {fraction_bits}",
            );
        }
        text + "\n#endif\n"
    }
}
