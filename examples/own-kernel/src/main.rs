//! Says in which formats the filter is good, with how few bits, and what a step costs.

mod biquad;

use std::error::Error;

use biquad::Biquad;
use kernel_size::{Language, built_in, compare, named, price, size, vectors};
use real::Datapath;
use target_cost::Cost;

fn main() -> Result<(), Box<dyn Error>> {
    println!("{}", compare(&Biquad, &built_in())?);
    let sizing = size(&Biquad)?;
    println!("{sizing}");
    let Some(format) = sizing.uniform.as_ref().and_then(|run| named(&run.format)) else {
        return Err("no format of 48 bits is good enough".into());
    };
    if let Some(types) = sizing.types(Language::C, Datapath::default()) {
        println!("{types}");
    }
    let targets = target_cost::built_in()?;
    let priced = price(&Biquad, format, &targets, Some(1e-4))?;
    println!("A step in {format}, of a period of 100 µs:");
    for target in &targets {
        match &priced.targets[&target.name] {
            Cost::Known(cost) => println!("{:14} {:5.0} {:?}", target.name, cost.max, cost.measure),
            Cost::Unknown { unknown } => {
                println!("{:14} unknown: nobody has published what {unknown} costs", target.name)
            }
        }
    }
    if let Some(file) = std::env::args().nth(1) {
        std::fs::write(&file, vectors(&Biquad, format)?)?;
        println!("{file}: the bits of each step in {format}");
    }
    Ok(())
}

#[cfg(test)]
mod tests {
    use super::*;
    use real::FormatName;

    /// At rest the output is the input: the sum of b's is 1 and that of a's.
    #[test]
    fn the_filter_has_a_gain_of_one() -> Result<(), Box<dyn Error>> {
        let text = vectors(&Biquad, FormatName::Float { bits: 64 })?;
        let value = |cell: &str| u64::from_str_radix(cell, 16).map(f64::from_bits);
        let mut means = [0.0; 2];
        for line in text.lines().skip(1) {
            let cells: Vec<&str> = line.split(',').collect();
            means[0] += value(cells[1])? / 1e4;
            means[1] += value(cells[2])? / 1e4;
        }
        assert!((means[0] - means[1]).abs() < 1e-3, "{means:?}");
        Ok(())
    }

    /// One bit fewer is not enough, wherever the point is.
    #[test]
    fn the_format_found_is_good_and_no_narrower_one() -> Result<(), Box<dyn Error>> {
        let found = size(&Biquad)?.uniform.ok_or("no format is good")?;
        let narrower: Vec<FormatName> =
            (2..found.bits).filter_map(|bits| named(&format!("I{bits}F{}", found.bits - 1 - bits))).collect();
        assert!(compare(&Biquad, &narrower)?.formats.iter().all(|run| !run.good));
        assert!(compare(&Biquad, &[named(&found.format).ok_or("a name")?])?.formats[0].good);
        Ok(())
    }
}
