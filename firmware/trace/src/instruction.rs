//! What kind of instruction it is, as far as time depends on it.

use std::fmt;

/// An instruction set, as the emulator prints it.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub(crate) enum Set {
    Thumb,
    RiscV,
}

macro_rules! classes {
    ($($class:ident = $name:literal),* $(,)?) => {
        /// Instructions that take the same time.
        #[derive(Clone, Copy, Debug, PartialEq, Eq, PartialOrd, Ord)]
        pub(crate) enum Class { $($class),* }

        #[cfg(test)]
        impl Class {
            pub(crate) const ALL: &[Class] = &[$(Class::$class),*];
        }

        impl fmt::Display for Class {
            fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
                f.write_str(match self { $(Class::$class => $name),* })
            }
        }
    };
}

classes! {
    Alu = "alu",
    Multiply = "multiply",
    MultiplyAdd = "multiply_add",
    MultiplyLong = "multiply_long",
    MultiplyLongAdd = "multiply_long_add",
    Divide = "divide",
    Load = "load",
    Store = "store",
    LoadMultiple = "load_multiple",
    StoreMultiple = "store_multiple",
    LoadReturn = "load_return",
    Branch = "branch",
    BranchConditional = "branch_conditional",
    Call = "call",
    Jump = "jump_register",
    IfThen = "if_then",
    StatusRegister = "status_register",
    FloatArithmetic = "float_arithmetic",
    FloatMultiplyAdd = "float_multiply_add",
    FloatDivide = "float_divide",
    FloatRoot = "float_root",
    FloatMove = "float_move",
    FloatLoad = "float_load",
    FloatStore = "float_store",
    FloatLoadMultiple = "float_load_multiple",
    FloatStoreMultiple = "float_store_multiple",
    Other = "other",
}

/// An instruction in the image.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub(crate) struct Instruction {
    pub(crate) class: Class,
    /// Words moved by a load or store of several.
    pub(crate) words: u32,
    /// Its length.
    pub(crate) bytes: u32,
}

impl Instruction {
    pub(crate) fn parse(set: Set, mnemonic: &str, operands: &str, bytes: u32) -> Self {
        let class = match set {
            Set::Thumb => thumb(mnemonic, operands),
            Set::RiscV => riscv(mnemonic, operands),
        };
        Self { class, words: words(mnemonic, operands), bytes }
    }
}

/// Registers in the braces; two for the double-word forms.
fn words(mnemonic: &str, operands: &str) -> u32 {
    let Some(list) = operands.split('{').nth(1).and_then(|rest| rest.split('}').next()) else {
        let double =
            mnemonic.starts_with("ldrd") || mnemonic.starts_with("strd") || operands.starts_with('d');
        return 1 + u32::from(double);
    };
    let number = |register: &str| register.trim().get(1..).and_then(|n| n.parse::<u32>().ok());
    list.split(',')
        .map(|item| {
            let width = 1 + u32::from(item.trim().starts_with('d'));
            let count = match item.split_once('-').map(|(from, to)| (number(from), number(to))) {
                Some((Some(from), Some(to))) => to.saturating_sub(from) + 1,
                _ => 1,
            };
            width * count
        })
        .sum()
}

/// Without width and condition, where they are separate from the name.
fn thumb(mnemonic: &str, operands: &str) -> Class {
    let name = mnemonic.split('.').next().unwrap_or(mnemonic);
    let is = |prefixes: &[&str]| prefixes.iter().any(|p| name.starts_with(p));
    if name.starts_with('v') {
        return thumb_float(name, operands);
    }
    if is(&["ldm", "pop"]) {
        return if operands.contains("pc") { Class::LoadReturn } else { Class::LoadMultiple };
    }
    if is(&["stm", "push"]) {
        return Class::StoreMultiple;
    }
    if is(&["ldrd"]) {
        return Class::LoadMultiple;
    }
    if is(&["strd"]) {
        return Class::StoreMultiple;
    }
    if is(&["ldr"]) {
        return if operands.starts_with("pc,") { Class::LoadReturn } else { Class::Load };
    }
    if is(&["str"]) {
        return Class::Store;
    }
    if is(&["udiv", "sdiv"]) {
        return Class::Divide;
    }
    if is(&["umlal", "smlal", "umaal"]) {
        return Class::MultiplyLongAdd;
    }
    if is(&["umull", "smull"]) {
        return Class::MultiplyLong;
    }
    if is(&["mla", "mls", "smla", "smmla", "smmls"]) {
        return Class::MultiplyAdd;
    }
    if is(&["mul", "smul", "smmul"]) {
        return Class::Multiply;
    }
    if is(&["bkpt", "svc", "dsb", "isb", "dmb", "udf", "cps"]) {
        return Class::Other;
    }
    if is(&["mrs", "msr"]) {
        return Class::StatusRegister;
    }
    if is(&["bfi", "bfc", "bic"]) {
        return Class::Alu;
    }
    match name {
        "b" => Class::Branch,
        "bl" => Class::Call,
        "cbz" | "cbnz" => Class::BranchConditional,
        _ if is(&["blx"]) => Class::Call,
        _ if is(&["bx", "tbb", "tbh"]) => Class::Jump,
        // Conditions have two letters: beq, bne, bhs, … and inside an if-then block.
        _ if name.len() == 3 && name.starts_with('b') => Class::BranchConditional,
        _ if name.starts_with("it") && name.bytes().skip(1).all(|b| b == b't' || b == b'e') => Class::IfThen,
        _ if operands.starts_with("pc,") => Class::Jump,
        _ => Class::Alu,
    }
}

fn thumb_float(name: &str, operands: &str) -> Class {
    let is = |prefixes: &[&str]| prefixes.iter().any(|p| name.starts_with(p));
    let _ = operands;
    if is(&["vldm", "vpop"]) {
        Class::FloatLoadMultiple
    } else if is(&["vstm", "vpush"]) {
        Class::FloatStoreMultiple
    } else if is(&["vldr"]) {
        Class::FloatLoad
    } else if is(&["vstr"]) {
        Class::FloatStore
    } else if is(&["vdiv"]) {
        Class::FloatDivide
    } else if is(&["vsqrt"]) {
        Class::FloatRoot
    } else if is(&["vmla", "vmls", "vnmla", "vnmls", "vfma", "vfms", "vfnma", "vfnms"]) {
        Class::FloatMultiplyAdd
    } else if is(&["vadd", "vsub", "vmul", "vnmul"]) {
        Class::FloatArithmetic
    } else {
        Class::FloatMove
    }
}

fn riscv(mnemonic: &str, operands: &str) -> Class {
    let name = mnemonic.strip_prefix("c.").unwrap_or(mnemonic);
    match name {
        "mul" => Class::Multiply,
        "mulh" | "mulhu" | "mulhsu" => Class::MultiplyLong,
        "div" | "divu" | "rem" | "remu" => Class::Divide,
        "lw" | "lh" | "lhu" | "lb" | "lbu" | "lwsp" => Class::Load,
        "sw" | "sh" | "sb" | "swsp" => Class::Store,
        "j" => Class::Branch,
        "jal" if operands.starts_with("zero") => Class::Branch,
        "jal" => Class::Call,
        "jalr" if operands.starts_with("ra") => Class::Call,
        "jr" | "jalr" | "ret" => Class::Jump,
        _ if name.starts_with('b') => Class::BranchConditional,
        _ if name.starts_with("csr") || name.starts_with("fence") || name == "ecall" => Class::Other,
        _ => Class::Alu,
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn registers_are_counted() {
        assert_eq!(words("push", "{r4, r5, r6, r7, lr}"), 5);
        assert_eq!(words("vpush", "{d8, d9}"), 4);
        assert_eq!(words("vldmia", "r0, {s0-s3}"), 4);
        assert_eq!(words("ldrd", "r0, r1, [r2]"), 2);
        assert_eq!(words("vldr", "d0, [r1]"), 2);
        assert_eq!(words("ldr", "r0, [r1]"), 1);
    }

    #[test]
    fn thumb_names() {
        for (name, operands, class) in [
            ("beq", "#0x10", Class::BranchConditional),
            ("b.w", "#0x10", Class::Branch),
            ("bl", "#0x10", Class::Call),
            ("blx", "r3", Class::Call),
            ("bls", "#0x10", Class::BranchConditional),
            ("blt", "#0x10", Class::BranchConditional),
            ("bx", "lr", Class::Jump),
            ("bic.w", "r0, r1, r2", Class::Alu),
            ("bhs", "#0x10", Class::BranchConditional),
            ("ittet", "eq", Class::IfThen),
            ("pop", "{r4, pc}", Class::LoadReturn),
            ("pop.w", "{r4, r8}", Class::LoadMultiple),
            ("umaal", "r0, r1, r2, r3", Class::MultiplyLongAdd),
            ("muls", "r0, r1, r0", Class::Multiply),
            ("vmla.f32", "s0, s1, s2", Class::FloatMultiplyAdd),
            ("vcmp.f32", "s0, s1", Class::FloatMove),
            ("mrs", "r4, apsr", Class::StatusRegister),
            ("nop.w", "", Class::Alu),
        ] {
            assert_eq!(thumb(name, operands), class, "{name} {operands}");
        }
    }

    #[test]
    fn riscv_names() {
        for (name, operands, class) in [
            ("mulhu", "a0,a1,a2", Class::MultiplyLong),
            ("beqz", "a0,16", Class::BranchConditional),
            ("jalr", "zero,ra,0", Class::Jump),
            ("jalr", "ra,a5,0", Class::Call),
            ("ret", "", Class::Jump),
            ("addi", "a0,a0,1", Class::Alu),
        ] {
            assert_eq!(riscv(name, operands), class, "{name} {operands}");
        }
    }
}
