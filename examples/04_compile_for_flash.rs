//! A part program as constants for a controller's flash, judged before: what `feedbits compile` does.
//!
//!     cargo run -p feedbits-examples --example 04_compile_for_flash > part.rs

use std::error::Error;

use format_compare::{Engine, Options, Problem, compare, plan_for, select};
use part_program::{read_machine, read_part};

const MACHINE: &str = "[machine]
interpolation_period_ms = 1.0
feedrate_mm_per_s = 50.0
acceleration_mm_per_s2 = 1000.0
jerk_mm_per_s3 = 40000.0
";

const PART: &str = "G0 X0 Y0\nG1 X10 F3000\nG2 X20 Y10 R10\n";

fn main() -> Result<(), Box<dyn Error>> {
    let problem = Problem::<2>::new(&read_part("part.nc", PART)?, &read_machine("mill.toml", MACHINE)?)?;
    let (formats, options) = (select(&["I4F28"])?, Options::default());
    let judged = compare(&problem, &formats, &[Engine::Pieces], &options)?;
    eprintln!("{}: {}", judged.formats[0].format, judged.formats[0].verdict);

    let plan = plan_for(&problem, formats[0].as_ref(), &options)?;
    let constants = formats[0].constants(&problem, &plan, &options)?;
    eprintln!("{} periods in {} bytes", constants.periods, constants.bytes);
    println!("{}", constants.source);
    assert!(judged.formats[0].verdict.is_good() && constants.source.contains("pub static PATH"));
    Ok(())
}

#[test]
fn it_runs() -> Result<(), Box<dyn Error>> {
    main()
}
