//! Judges a log from the command line, and says how long that took: `judge_log MACHINE.toml LOG [COLUMNS [PERIOD_MS [PART]]]`.

use std::error::Error;
use std::fs::{File, read_to_string};
use std::time::Instant;

use part_program::ReadOptions;
use setpoint_log::{Followed, Log, LogOptions};

fn main() -> Result<(), Box<dyn Error>> {
    let words: Vec<String> = std::env::args().skip(1).collect();
    let [machine, log, rest @ ..] = &words[..] else { return Err("expected MACHINE.toml LOG".into()) };
    let machine = part_program::read_limits(machine, &read_to_string(machine)?)?;
    let options = LogOptions {
        columns: rest.first().map(|columns| columns.parse()).transpose()?,
        period_s: rest.get(1).map(|period| period.parse::<f64>().map(|ms| 1e-3 * ms)).transpose()?,
        ..LogOptions::default()
    };
    let begin = Instant::now();
    let log = Log::begin(File::open(log)?, &machine, &options)?;
    let text = rest.get(2).map(read_to_string).transpose()?;
    let reading = ReadOptions { start_mm: Some(log.first_point_mm()), ..ReadOptions::default() };
    let part = text.map(|text| part_program::read_part_with("part", &text, reading)).transpose()?;
    let found = log.judge(part.as_ref().map(|part| Followed { part, tolerance_mm: None }))?;
    for limit in &found.limits {
        let [axis, what] = [limit.axis.unwrap_or_default(), limit.what];
        println!("{axis} {what} {:?} {:.4} {:.4} {:?}", limit.verdict, limit.raw, limit.taken, limit.at);
    }
    println!(
        "missing {:?} twice {:?} at rest {:?} {:#?}",
        found.missing, found.doubled, found.at_rest, found.part
    );
    println!("{:?} in {:?} for {} rows", found.faults(), begin.elapsed(), found.rows);
    Ok(())
}
