//! Says in which formats the filter is good, with how few bits, and what a step costs; with a folder, writes all of it there.

mod biquad;

use std::error::Error;
use std::fs;
use std::path::Path;
use std::process::ExitCode;

use biquad::Biquad;
use format_report::KernelPage;
use kernel_size::{
    Baseline, Comparison, Language, Sizing, StepPrice, built_in, compare, named, price, size, vectors,
};
use real::{Datapath, FormatName};
use target_cost::Cost;

/// The status if a format is gone, or worse than in the baseline.
const WORSE: u8 = 3;

/// The share by which an error may grow over that of the baseline.
const WORSE_BY: f64 = 0.01;

fn main() -> Result<ExitCode, Box<dyn Error>> {
    let arguments: Vec<String> = std::env::args().skip(1).collect();
    let [folder, baseline] = [0, 1].map(|place| arguments.get(place));
    // Nothing that is there is overwritten, and what cannot be is said before the work.
    if let Some(folder) = folder.filter(|folder| Path::new(folder).exists()) {
        return Err(format!("{folder} is there: expected the name of a new folder").into());
    }
    let earlier = match baseline {
        Some(path) => {
            Some(Baseline::read(&fs::read_to_string(path).map_err(|error| format!("{path}: {error}"))?)?)
        }
        None => None,
    };
    let comparison = compare(&Biquad, &built_in())?;
    println!("{comparison}");
    let sizing = size(&Biquad)?;
    println!("{sizing}");
    let Some(format) = sizing.uniform.as_ref().and_then(|run| named(&run.format)) else {
        return Err("no format of 48 bits is good enough".into());
    };
    if let Some(types) = sizing.types(Language::C, Datapath::default()) {
        println!("{types}");
    }
    let prices = [price(&Biquad, format, &target_cost::built_in()?, Some(1e-4))?];
    print_price(&prices[0]);
    if let Some(folder) = folder {
        write(Path::new(folder), &comparison, &sizing, &prices, format)?;
        println!(
            "{folder}: index.html, comparison.json, and vectors.csv with the bits of each step in {format}"
        );
    }
    let Some((baseline, earlier)) = baseline.zip(earlier) else { return Ok(ExitCode::SUCCESS) };
    let since = earlier.since(&comparison, WORSE_BY)?;
    print!("Since {baseline}: {since}");
    Ok(if since.is_worse() { WORSE.into() } else { ExitCode::SUCCESS })
}

fn print_price(price: &StepPrice) {
    println!("A step in {}, of a period of 100 µs:", price.format);
    for (target, cost) in &price.targets {
        match cost {
            Cost::Known(cost) => println!("{target:14} {:5.0} {:?}", cost.max, cost.measure),
            Cost::Unknown { unknown } => {
                println!("{target:14} unknown: nobody has published what {unknown} costs")
            }
        }
    }
}

fn write(
    folder: &Path,
    comparison: &Comparison,
    sizing: &Sizing,
    prices: &[StepPrice],
    format: FormatName,
) -> Result<(), Box<dyn Error>> {
    let files = KernelPage { comparison, sizing: Some(sizing), prices, command: "cargo run" }.report()?.files;
    fs::create_dir(folder)?;
    for (name, text) in files {
        fs::write(folder.join(name), text)?;
    }
    fs::write(folder.join("comparison.json"), comparison.json())?;
    fs::write(folder.join("vectors.csv"), vectors(&Biquad, format)?)?;
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
