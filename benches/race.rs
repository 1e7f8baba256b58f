//! Contestants timed side by side: each round runs all of them, one after the other, so that a disturbance of the machine
//! meets all alike; the figure is the fastest of the rounds, for whatever disturbs one only adds to it.

use std::hint::black_box;
use std::time::Instant;

use serde::Serialize;
use serde_json::{Value, json};

/// Rounds of a race.
const ROUNDS: usize = 25;
/// A run is repeated until a round has lasted at least so long.
const SHORTEST_ROUND_S: f64 = 0.008;

/// What one contestant took.
#[derive(Clone, Debug, Serialize)]
pub(crate) struct Time {
    /// The contestant.
    pub(crate) name: String,
    /// The fastest round, for one unit of work.
    pub(crate) ns: f64,
    /// The median round over the fastest.
    pub(crate) spread: f64,
}

/// A contestant: its name, how many units one run has, and the run.
pub(crate) struct Runner<'a> {
    /// Its name.
    pub(crate) name: String,
    /// Units of work in a run.
    pub(crate) units: u64,
    /// The work; what it returns only keeps it from being optimised away.
    pub(crate) run: Box<dyn FnMut() -> f64 + 'a>,
}

/// Times them all.
pub(crate) fn race(runners: &mut [Runner<'_>]) -> Vec<Time> {
    let mut repeats = Vec::new();
    for runner in runners.iter_mut() {
        black_box((runner.run)());
        let started = Instant::now();
        black_box((runner.run)());
        let once = started.elapsed().as_secs_f64().max(1e-9);
        let enough = (SHORTEST_ROUND_S / once).ceil().clamp(1.0, 1e6);
        repeats.push((1_u32..1_000_000).find(|n| f64::from(*n) >= enough).unwrap_or(1));
    }
    let mut rounds = vec![Vec::new(); runners.len()];
    for _ in 0..ROUNDS {
        for ((runner, repeats), times) in runners.iter_mut().zip(&repeats).zip(&mut rounds) {
            let started = Instant::now();
            for _ in 0..*repeats {
                black_box((runner.run)());
            }
            let units = f64::from(*repeats) * runner.units as f64;
            times.push(started.elapsed().as_secs_f64() * 1e9 / units);
        }
    }
    let finished = runners.iter().zip(&mut rounds).map(|(runner, times)| {
        times.sort_by(f64::total_cmp);
        Time { name: runner.name.clone(), ns: times[0], spread: times[ROUNDS / 2] / times[0] }
    });
    finished.collect()
}

/// Prints the rows of one table.
pub(crate) fn report(table: &str, about: &Value, times: &[Time]) {
    for time in times {
        println!("{}", json!({ "table": table, "about": about, "time": time }));
    }
}
