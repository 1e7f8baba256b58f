//! The targets: instruction set, emulated machine, cycle table.

use crate::Failure;
use crate::instruction::Set;

/// What is measured.
#[derive(Clone, Copy, Debug)]
pub(crate) struct Target {
    /// The name, as in the data file.
    pub(crate) name: &'static str,
    /// Rust's name of the target.
    pub(crate) triple: &'static str,
    /// What a reader should know of it.
    pub(crate) title: &'static str,
    /// Options of the emulator.
    pub(crate) machine: &'static str,
    pub(crate) set: Set,
    /// The cycle table, a TOML text; none for a core whose timing is not published.
    pub(crate) cycles: Option<&'static str>,
}

const TARGETS: [Target; 6] = [
    Target {
        name: "cortex-m0plus",
        triple: "thumbv6m-none-eabi",
        title: "Cortex-M0+",
        machine: "microbit",
        set: Set::Thumb,
        cycles: Some(include_str!("../cycles/cortex-m0plus.toml")),
    },
    Target {
        name: "cortex-m3",
        triple: "thumbv7m-none-eabi",
        title: "Cortex-M3",
        machine: "mps2-an385",
        set: Set::Thumb,
        cycles: Some(include_str!("../cycles/cortex-m3.toml")),
    },
    Target {
        name: "cortex-m4",
        triple: "thumbv7em-none-eabi",
        title: "Cortex-M4, no FPU",
        machine: "mps2-an386",
        set: Set::Thumb,
        cycles: Some(include_str!("../cycles/cortex-m4.toml")),
    },
    Target {
        name: "cortex-m4f",
        triple: "thumbv7em-none-eabihf",
        title: "Cortex-M4F, f32 FPU",
        machine: "mps2-an386",
        set: Set::Thumb,
        cycles: Some(include_str!("../cycles/cortex-m4.toml")),
    },
    Target {
        name: "cortex-m7",
        triple: "thumbv7em-none-eabihf",
        title: "Cortex-M7, f64 FPU",
        machine: "mps2-an500",
        set: Set::Thumb,
        cycles: None,
    },
    Target {
        name: "riscv32imac",
        triple: "riscv32imac-unknown-none-elf",
        title: "RV32IMAC",
        machine: "virt",
        set: Set::RiscV,
        cycles: Some(include_str!("../cycles/ibex.toml")),
    },
];

/// The target of this name.
pub(crate) fn find(name: &str) -> Result<Target, Failure> {
    TARGETS.into_iter().find(|t| t.name == name).ok_or_else(|| {
        let known: Vec<_> = TARGETS.iter().map(|t| t.name).collect();
        format!("no target `{name}`; known are {}", known.join(", ")).into()
    })
}
