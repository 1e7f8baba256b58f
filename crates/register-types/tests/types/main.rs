//! The types hold what the formats of the search hold: VHDL in a simulation, C++ and C by a compiler, Rust in this test.

use std::fmt::Write as _;
use std::path::{Path, PathBuf};
use std::process::Command;

use expect_test::expect_file;
use real::{Datapath, Overflow, Rounding};
use register_types::{Language, Register, Types};

#[expect(unreachable_pub, reason = "the types are for everybody in the crate that they are generated for")]
mod feed_signals;

/// Three registers: a wide one, one without a bit for the integers, and the narrowest.
fn registers() -> [Register<'static>; 3] {
    let register = |signal, integer_bits, fraction_bits, bound| Register {
        signal,
        meaning: "what it is",
        integer_bits,
        fraction_bits,
        bound,
    };
    [
        register("parameter", 3, 23, 3.4567),
        register("chord_turn", 1, 4, 0.0335),
        register("joint_travelled", 2, 1, 1.00001),
    ]
}

fn of_part(part: &str, language: Language, datapath: Datapath) -> String {
    let about =
        [format!("Part {part}: 3 registers of 34 bits in all."), String::new(), "Its signals.".to_string()];
    let example = ["step_per_chord", "chord_length", "step"];
    Types { registers: &registers(), datapath, prefix: "feed", about: &about, example }.in_language(language)
}

fn in_language(language: Language, datapath: Datapath) -> String {
    of_part("a \"part\" -- */ of\nmine", language, datapath)
}

fn datapaths() -> impl Iterator<Item = Datapath> {
    let roundings = [Rounding::Nearest, Rounding::NearestEven, Rounding::Floor, Rounding::TowardZero];
    let both =
        |rounding| [Overflow::Wrap, Overflow::Saturate].map(|overflow| Datapath { rounding, overflow });
    roundings.into_iter().flat_map(both)
}

const NEAREST: Datapath = Datapath { rounding: Rounding::Nearest, overflow: Overflow::Wrap };

/// Bits of a value below those of the register that it is put into.
const FINER: u32 = 3;

/// For each register values in units of 2^-(F + 3), and the word that each must become.
fn expected(datapath: Datapath) -> Vec<(Register<'static>, Vec<(i64, i64)>)> {
    let of = |register: Register<'static>| {
        let reach = 3_i64 << (register.bits() + FINER - 1);
        let stride = (2 * reach / 50).max(1) | 1;
        let units = (-reach..=reach).step_by(usize::try_from(stride).unwrap());
        // Ties, of even and of odd words, and the extremes.
        let half = 1 << (FINER - 1);
        let ends = [-1, 1].map(|sign| sign << (register.bits() + FINER - 1));
        let more =
            [-3 * half, -half, half, 3 * half].into_iter().chain(ends.into_iter().flat_map(|e| e - 9..e + 9));
        let words = units.chain(more).map(|units| (units, word(units, register.bits(), datapath))).collect();
        (register, words)
    };
    registers().map(of).into()
}

/// The closed form of rounding and overflow, in integers.
fn word(units: i64, bits: u32, datapath: Datapath) -> i64 {
    let (one, half) = (1_i64 << FINER, 1_i64 << (FINER - 1));
    let down = units.div_euclid(one);
    let rest = units.rem_euclid(one);
    let up = match datapath.rounding {
        Rounding::Nearest => rest >= half,
        Rounding::NearestEven => rest > half || (rest == half && down % 2 != 0),
        Rounding::Floor => false,
        Rounding::TowardZero => rest > 0 && down < 0,
    };
    let (rounded, extreme) = (down + i64::from(up), 1_i64 << (bits - 1));
    match datapath.overflow {
        Overflow::Wrap => (rounded + extreme).rem_euclid(2 * extreme) - extreme,
        Overflow::Saturate => rounded.clamp(-extreme, extreme - 1),
    }
}

/// Whether a tool is there. Without it the test is skipped, unless FEEDBITS_REGISTER_TYPES is set.
fn is_there(tool: &str) -> bool {
    let found = Command::new(tool).arg("--version").output().is_ok_and(|output| output.status.success());
    assert!(
        found || std::env::var_os("FEEDBITS_REGISTER_TYPES").is_none(),
        "{tool} is not found, and FEEDBITS_REGISTER_TYPES asks for it"
    );
    found
}

fn run(command: &mut Command) {
    let output = command.output().unwrap();
    let text = [output.stdout, output.stderr].concat();
    assert!(output.status.success(), "{command:?}: {}", String::from_utf8_lossy(&text));
}

/// The lowest `bits` bits of a number, highest first.
fn binary(number: i64, bits: u32) -> String {
    (0..bits).rev().map(|bit| if number >> bit & 1 == 1 { '1' } else { '0' }).collect()
}

/// A testbench that compares each word with that of the register.
fn testbench(datapath: Datapath) -> String {
    let mut text =
        "library ieee;\nuse ieee.fixed_pkg.all;\nuse ieee.std_logic_1164.all;\nuse work.feed_signals.all;\n\
                    entity bench is end entity;\narchitecture simulated of bench is\nbegin\n    process\n"
            .to_string();
    let mut checks = String::new();
    for (register, words) in expected(datapath) {
        let (signal, bits) = (register.signal, register.bits());
        let (low, width) = (register.fraction_bits + FINER, bits + FINER + 2);
        let _ = writeln!(
            text,
            "        variable {signal}_register : {signal}_t;\n        variable {signal}_wide : sfixed({} downto -{low});",
            i64::from(width) - i64::from(low) - 1
        );
        for (units, word) in words {
            let _ = writeln!(
                checks,
                "        {signal}_wide := \"{}\";\n        {signal}_register := to_register({signal}_wide, {signal}_register);\n        \
                 assert to_slv({signal}_register) = \"{}\" report \"{signal} of {units}\" severity failure;",
                binary(units, width),
                binary(word, bits)
            );
        }
    }
    text + "    begin\n" + &checks + "        wait;\n    end process;\nend architecture;\n"
}

#[test]
fn test_a_vhdl_register_holds_the_word_of_its_format() {
    if !is_there("ghdl") {
        return;
    }
    for datapath in datapaths() {
        let folder = tempfile::tempdir().unwrap();
        let ghdl = || {
            let mut command = Command::new("ghdl");
            command.current_dir(folder.path());
            command
        };
        std::fs::write(folder.path().join("types.vhd"), in_language(Language::Vhdl, datapath)).unwrap();
        std::fs::write(folder.path().join("bench.vhd"), testbench(datapath)).unwrap();
        run(ghdl().args(["-a", "--std=08", "types.vhd", "bench.vhd"]));
        run(ghdl().args(["-e", "--std=08", "bench"]));
        run(ghdl().args(["-r", "--std=08", "bench", "--assert-level=error"]));
    }
}

/// The folders of `ap_fixed.h` and `ac_fixed.h`, if FEEDBITS_REGISTER_TYPES names one that has them.
fn hls_headers() -> Option<[PathBuf; 2]> {
    let folder = PathBuf::from(std::env::var_os("FEEDBITS_REGISTER_TYPES")?);
    Some(["ap_types", "ac_types"].map(|name| folder.join(name)))
}

fn program_of_hls(datapath: Datapath) -> String {
    let mut text = "#include \"feed_signals.h\"\n#include <cmath>\n#include <cstdio>\nint main() {\n    int wrong = 0;\n".to_string();
    for (register, words) in expected(datapath) {
        let (signal, fraction_bits) = (register.signal, register.fraction_bits);
        for (units, word) in words {
            let _ = writeln!(
                text,
                "    {{ feed_signals::{signal}_t x = std::ldexp({units}.0, -{});\n      \
                 if (std::ldexp(x.to_double(), {fraction_bits}) != {word}.0) {{ std::puts(\"{signal} of {units}\"); wrong++; }} }}",
                fraction_bits + FINER,
            );
        }
    }
    text + "    return wrong != 0;\n}\n"
}

#[test]
fn test_a_register_of_high_level_synthesis_holds_the_word_of_its_format() {
    let Some([ap, ac]) = hls_headers().filter(|_| is_there("g++")) else { return };
    // Each way of rounding once, and half of them with each way of overflowing: the headers take long to compile.
    let saturates = |rounding| matches!(rounding, Rounding::NearestEven | Rounding::TowardZero);
    for datapath in datapaths().filter(|d| (d.overflow == Overflow::Saturate) == saturates(d.rounding)) {
        let folder = tempfile::tempdir().unwrap();
        std::fs::write(folder.path().join("feed_signals.h"), in_language(Language::Hls, datapath)).unwrap();
        std::fs::write(folder.path().join("main.cpp"), program_of_hls(datapath)).unwrap();
        for (headers, define) in [(&ap, "-DFEED_AP"), (&ac, "-DFEED_AC")] {
            let mut compiler = Command::new("g++");
            compiler
                .args(["-std=c++17", "-w", define, "-isystem"])
                .arg(headers)
                .args(["main.cpp", "-o", "main"]);
            run(compiler.current_dir(folder.path()));
            run(&mut Command::new(folder.path().join("main")));
        }
    }
}

#[test]
fn test_the_c_header_compiles_and_its_words_are_wide_enough() {
    if !is_there("cc") {
        return;
    }
    let folder = tempfile::tempdir().unwrap();
    std::fs::write(folder.path().join("feed_signals.h"), in_language(Language::C, NEAREST)).unwrap();
    let mut text = "#include \"feed_signals.h\"\n#include \"feed_signals.h\"\n".to_string();
    for register in registers() {
        let (signal, name) = (register.signal, register.signal.to_uppercase());
        let _ = writeln!(
            text,
            "typedef char {signal}_fits[8 * sizeof(feed_{signal}) >= FEED_{name}_BITS && FEED_{name}_BITS == {} \
             && FEED_{name}_FRACTION_BITS == {} ? 1 : -1];",
            register.bits(),
            register.fraction_bits
        );
    }
    std::fs::write(folder.path().join("main.c"), text).unwrap();
    let strict = ["-std=c99", "-Wall", "-Wextra", "-pedantic", "-Werror", "-fsyntax-only", "main.c"];
    run(Command::new("cc").args(strict).current_dir(folder.path()));
}

#[test]
fn test_the_rust_module_compiles_and_its_types_are_wide_enough() {
    let text = in_language(Language::Rust, NEAREST);
    expect_file![Path::new(env!("CARGO_MANIFEST_DIR")).join("tests/types/feed_signals.rs")].assert_eq(&text);
    let widths = [
        (feed_signals::Parameter::FRAC_NBITS, feed_signals::Parameter::INT_NBITS),
        (feed_signals::ChordTurn::FRAC_NBITS, feed_signals::ChordTurn::INT_NBITS),
        (feed_signals::JointTravelled::FRAC_NBITS, feed_signals::JointTravelled::INT_NBITS),
    ];
    for (row, (fraction, integer)) in registers().iter().zip(widths) {
        assert!(fraction == row.fraction_bits && integer >= row.integer_bits, "{}", row.signal);
    }
}

#[test]
fn test_matlab_has_a_line_for_each_register() {
    let text =
        in_language(Language::Matlab, Datapath { rounding: Rounding::Floor, overflow: Overflow::Saturate });
    assert!(text.contains("fimath('RoundingMethod', 'Floor', 'OverflowAction', 'Saturate', ..."), "{text}");
    assert!(text.contains("\ntypes.parameter = fi([], numerictype(1, 26, 23), math);\n"), "{text}");
    assert_eq!(text.matches("numerictype").count(), 3);
}

#[test]
fn test_a_bound_is_rounded_up() {
    for language in [Language::Vhdl, Language::Hls, Language::Matlab, Language::Rust, Language::C] {
        assert!(in_language(language, NEAREST).contains("at most 1.0001"), "{language:?}");
    }
}

/// A name changes the line of the comment that has it, and nothing else: neither the lines around it nor what a compiler takes of them.
#[test]
fn test_a_name_changes_the_words_of_a_comment_alone() {
    for language in [Language::Vhdl, Language::Hls, Language::Matlab, Language::Rust, Language::C] {
        let of = |part| of_part(part, language, NEAREST);
        let (mark, plain) = match language {
            Language::Vhdl => ("-- ", of("plain")),
            Language::Matlab => ("% ", of("plain")),
            Language::Hls | Language::Rust => ("// ", of("plain")),
            Language::C => (" * ", of("plain")),
        };
        for name in foreign_text::hostile::NAMES {
            let text = of(name);
            assert_eq!(
                text.split(['\n', '\r', '\u{2028}']).count(),
                plain.lines().count() + 1,
                "{language:?}: {name:?}"
            );
            let changed: Vec<_> =
                text.lines().zip(plain.lines()).filter(|(one, other)| one != other).collect();
            let [(line, _)] = changed[..] else { panic!("{language:?}: {name:?}: {changed:?}") };
            let words = line
                .strip_prefix(mark)
                .and_then(|rest| rest.strip_suffix(": 3 registers of 34 bits in all."));
            assert!(words.is_some_and(|words| words.starts_with("Part ")), "{line}");
            if matches!(language, Language::C | Language::Hls) && is_there("cc") {
                assert_eq!(preprocessed(&text), preprocessed(&plain), "{language:?}: {name:?}");
            }
        }
    }
}

/// The text as a compiler of C takes it: without comments, with trigraphs and joined lines.
fn preprocessed(text: &str) -> String {
    let folder = tempfile::tempdir().unwrap();
    std::fs::write(folder.path().join("feed_signals.h"), text).unwrap();
    std::fs::write(folder.path().join("ap_fixed.h"), "").unwrap();
    let mut command = Command::new("cc");
    command.args(["-std=c99", "-E", "-P", "-I.", "-Werror", "-Wall", "-x", "c", "feed_signals.h"]);
    let output = command.current_dir(folder.path()).output().unwrap();
    assert!(output.status.success(), "{}", String::from_utf8_lossy(&output.stderr));
    String::from_utf8(output.stdout).unwrap()
}
