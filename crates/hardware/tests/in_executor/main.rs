//! Parts become cores, whose microcode gives in the executor what the Rust kernels give: the raw words of each setpoint, in formats of
//! every width from 16 to 32 bits. No tool is needed. Where Icarus Verilog is found, the core itself runs too.

mod in_icarus;
mod paths;
mod planned_path;
mod runs;
