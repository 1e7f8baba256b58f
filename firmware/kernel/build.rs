//! Writes the compiled paths as constants, and hands the linker the memory map of the target.

use std::fmt::Write;
use std::path::PathBuf;
use std::{env, fs};

fn main() -> Result<(), Box<dyn std::error::Error>> {
    println!("cargo:rerun-if-changed=memory");
    println!("cargo:rerun-if-changed=build.rs");
    fs::write(PathBuf::from(env::var("OUT_DIR")?).join("paths.rs"), tables::source()?)?;
    if env::var_os("CARGO_FEATURE_PART").is_some() {
        write_part()?;
    }
    if env::var("CARGO_CFG_TARGET_OS")? == "none" {
        let map = match env::var("CARGO_CFG_TARGET_ARCH")?.as_str() {
            "arm" => "cortex-m.ld",
            "riscv32" => "riscv.ld",
            other => return Err(format!("no memory map for {other}").into()),
        };
        let path = PathBuf::from(env::var("CARGO_MANIFEST_DIR")?).join("memory").join(map);
        println!("cargo:rustc-link-arg-bins=-T{}", path.display());
        // The emulated board of the smallest Cortex-M has as much flash as its controller, those of the others 4 MiB.
        let flash = if env::var("TARGET")?.starts_with("thumbv6m") { "256K" } else { "4M" };
        println!("cargo:rustc-link-arg-bins=--defsym=flash_size={flash}");
    }
    Ok(())
}

/// Copies the module that `feedbits compile` has written, and says how many coordinates its points have.
fn write_part() -> Result<(), Box<dyn std::error::Error>> {
    println!("cargo:rerun-if-env-changed=FEEDBITS_PART");
    let path = env::var("FEEDBITS_PART").map_err(|_| "FEEDBITS_PART is to name the file of a part")?;
    println!("cargo:rerun-if-changed={path}");
    let mut text = fs::read_to_string(&path).map_err(|error| format!("{path}: {error}"))?;
    let declared = text.split_once("pub static PATH: PieceInterpolator<'static, Number, ");
    let dimension =
        declared.and_then(|(_, rest)| rest.split_once('>')).map(|(dimension, _)| dimension.to_owned());
    let dimension =
        dimension.ok_or_else(|| format!("{path}: expected a module that `feedbits compile` has written"))?;
    write!(text, "\n/// The number of coordinates.\npub const DIMENSION: usize = {dimension};\n")?;
    fs::write(PathBuf::from(env::var("OUT_DIR")?).join("part.rs"), text)?;
    Ok(())
}
