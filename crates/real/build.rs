//! Says to the compiler which products the core that it compiles for has.

fn main() {
    println!("cargo:rerun-if-changed=build.rs");
    println!("cargo:rustc-check-cfg=cfg(short_products)");
    // Cortex-M0, M0+, M1 and M23: a product of two words of 32 bits is known to 32 bits only.
    let target = std::env::var("TARGET").unwrap_or_default();
    if target.starts_with("thumbv6m") || target.starts_with("thumbv8m.base") {
        println!("cargo:rustc-cfg=short_products");
    }
}
