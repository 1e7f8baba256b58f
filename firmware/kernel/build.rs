//! Writes the compiled paths as constants, and hands the linker the memory map of the target.

use std::path::PathBuf;
use std::{env, fs};

fn main() -> Result<(), Box<dyn std::error::Error>> {
    println!("cargo:rerun-if-changed=memory");
    println!("cargo:rerun-if-changed=build.rs");
    fs::write(PathBuf::from(env::var("OUT_DIR")?).join("paths.rs"), tables::source()?)?;
    if env::var("CARGO_CFG_TARGET_OS")? == "none" {
        let map = match env::var("CARGO_CFG_TARGET_ARCH")?.as_str() {
            "arm" => "cortex-m.ld",
            "riscv32" => "riscv.ld",
            other => return Err(format!("no memory map for {other}").into()),
        };
        let path = PathBuf::from(env::var("CARGO_MANIFEST_DIR")?).join("memory").join(map);
        println!("cargo:rustc-link-arg-bins=-T{}", path.display());
    }
    Ok(())
}
