//! How long a kernel of 50 operations and 10⁵ steps takes to be compared in all formats, and to be sized.
//!
//!     cargo run --release -p kernel-size --example fifty_operations

use std::error::Error;
use std::time::Instant;

use kernel_size::{Input, InputError, Kernel, Output, Steps, built_in, compare, price, size};
use real::{FormatName, Real};

/// Ten low-pass filters in a row, five operations each.
struct Cascade;

impl Kernel for Cascade {
    fn name(&self) -> &'static str {
        "cascade"
    }
    fn steps(&self) -> usize {
        100_000
    }
    fn inputs(&self) -> Result<Vec<Input>, InputError> {
        Ok(vec![Input::drawn("x", 3, (-1.0, 1.0), self.steps())?])
    }
    fn outputs(&self) -> Vec<Output> {
        vec![Output::named("y").within(1e-5).drift(1e-6)]
    }
    fn run<R: Real>(&self, steps: &mut Steps<'_, R>) {
        let mut states = [R::zero(); 10];
        while let Some([x]) = steps.begin() {
            let mut y = x;
            for state in &mut states {
                let slow = ((y - *state) * R::from_ratio(2, 3)).signal("slow");
                *state = *state + slow.half();
                y = y.mul_add(R::from_ratio(1, 10), *state).signal("y");
            }
            steps.end([y]);
        }
    }
}

fn main() -> Result<(), Box<dyn Error>> {
    let operations: f64 = price(&Cascade, FormatName::fixed(8, 24), &[], None)?.operations.values().sum();
    let start = Instant::now();
    let compared = compare(&Cascade, &built_in())?;
    let compared_in = start.elapsed();
    let sizing = size(&Cascade)?;
    println!("{compared}\n{sizing}");
    println!(
        "{operations} operations a step; compared in {compared_in:.2?}, sized in {:.2?}, {} runs",
        start.elapsed() - compared_in,
        sizing.runs
    );
    Ok(())
}
