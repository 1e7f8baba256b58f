//! Judges a log from the command line, and says how long that took: `judge_log MACHINE.toml LOG [COLUMNS [PERIOD_MS]]`.

use std::error::Error;
use std::fs::{File, read_to_string};
use std::time::Instant;

use setpoint_log::{LogOptions, judge};

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
    let found = judge(File::open(log)?, &machine, &options)?;
    for limit in &found.limits {
        println!(
            "{:?} {} {:?} raw {:.4} taken {:.4} {:?}",
            limit.axis, limit.what, limit.verdict, limit.raw, limit.taken, limit.at
        );
    }
    println!("missing {:?} twice {:?} rest {:?}", found.missing, found.doubled, found.at_rest);
    println!("{:?} in {:?} for {} rows", found.faults(), begin.elapsed(), found.rows);
    Ok(())
}
