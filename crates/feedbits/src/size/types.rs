//! The registers of `size` as types of the language in which the datapath is written.

use clap::ValueEnum;
use format_compare::Mixed;
use real::Datapath;
use register_types::{Register, Types};

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

/// A file of the registers in a language. Of the part it has the name, and the largest fluctuation that is allowed.
pub(crate) fn in_language(
    mixed: &Mixed,
    datapath: Datapath,
    (part, fluctuation_limit): (&str, f64),
    language: Language,
) -> String {
    let Mixed { bits, fluctuation, signals, .. } = mixed;
    let about = [
        format!("Part {part}: {} registers of {bits} bits in all.", signals.len()),
        format!("Written by `feedbits size --types`, version {}.", env!("CARGO_PKG_VERSION")),
        String::new(),
        format!(
            "The feed fluctuates by {fluctuation:.1e}, and {fluctuation_limit:.1e} are allowed, if each signal"
        ),
        "is rounded to its type wherever it is computed, and the operators between two".to_string(),
        "signals are exact to 53 bits. A type is as wide as the bound of its signal, which".to_string(),
        "is proved for this part, demands: only what is rounded up to the bound overflows.".to_string(),
    ];
    let register = |one: &format_compare::Register| {
        let register = Register::named(one.signal, &one.format, one.bound)?;
        Some(Register { signal: one.signal, meaning: one.meaning, ..register })
    };
    let registers: Vec<Register<'_>> = signals.iter().filter_map(register).collect();
    let example = ["step_per_chord", "chord_length", "step"];
    let types = Types { registers: &registers, datapath, prefix: "feed", about: &about, example };
    types.in_language(match language {
        Language::Vhdl => register_types::Language::Vhdl,
        Language::Hls => register_types::Language::Hls,
        Language::Matlab => register_types::Language::Matlab,
        Language::Rust => register_types::Language::Rust,
        Language::C => register_types::Language::C,
    })
}
