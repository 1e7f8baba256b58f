//! The costs of a simulation, computed before it.

use anyhow::{Result, bail};
use format_compare::{LeastPeriods, Options, Problem};
use servo_sim::{CircleTest, Servo, ServoParameters};

/// Periods of a part that are simulated, at most: every setpoint is kept.
const MOST_PERIODS: f64 = 4_194_304.0;
/// Sub-steps of each axis in a simulation, at most: a minute or two.
const MOST_SUB_STEPS: f64 = 268_435_456.0;
/// Sub-steps of a circle, at most: each is a place of the roundness plot.
const MOST_PLACES: f64 = 1_048_576.0;

/// Refuses a part that takes more periods than are simulated, or more sub-steps. The loops settle after each stretch of the path.
pub(super) fn expect_end_of_part<const D: usize>(
    problem: &Problem<D>,
    servo: &ServoParameters,
    options: &Options,
) -> Result<()> {
    let least = LeastPeriods::of(problem, options.end_feeds_mm_per_s);
    if least.periods > MOST_PERIODS {
        bail!(
            "{}: {least}: expected at most {MOST_PERIODS} in `servo`, which keeps every setpoint",
            problem.name
        );
    }
    let (settling, stretches) = (settling_periods(servo, problem.period_s())?, problem.breaks.len() + 1);
    let periods = least.periods + settling * stretches as f64;
    expect_few_sub_steps(&problem.name, servo, periods, &format!("{stretches} times {settling} of settling"))
}

/// Refuses circle tests that take more sub-steps than are simulated. Before each measured turn the loops settle.
pub(super) fn expect_end_of_circles(
    said: &str,
    servo: &ServoParameters,
    test: &CircleTest,
    runs: usize,
) -> Result<()> {
    let (turn, sub_steps) = (test.setpoints_per_turn(), f64::from(servo.sub_steps));
    if turn * sub_steps > MOST_PLACES {
        bail!(
            "{said}: a turn takes {turn:.3e} periods of {} ms in {sub_steps} sub-steps (`sub_steps`): expected at most {MOST_PLACES} \
             in all",
            test.period * 1000.0
        );
    }
    let settling = settling_periods(servo, test.period)?;
    let periods = (settling.max(turn) + 2.0 * turn) * runs as f64;
    expect_few_sub_steps(said, servo, periods, &format!("{runs} circles, each after {settling} of settling"))
}

fn expect_few_sub_steps(said: &str, servo: &ServoParameters, periods: f64, of_these: &str) -> Result<()> {
    let sub_steps = periods * f64::from(servo.sub_steps);
    if sub_steps > MOST_SUB_STEPS {
        bail!(
            "{said}: {periods:.3e} periods ({of_these}) in {} sub-steps: expected at most {MOST_SUB_STEPS} in all, by fewer \
             `sub_steps`, or by a loop that settles sooner: `position_gain_per_s`, `velocity_lag_ms`, filters",
            servo.sub_steps
        );
    }
    Ok(())
}

/// Periods until the loops and the filters have settled.
fn settling_periods(servo: &ServoParameters, period_s: f64) -> Result<f64> {
    let machine = Servo::<f64, 1>::try_new(&[*servo], period_s, [0.0])?;
    Ok(machine.settling_periods() as f64 + (servo.feed_ramp_ms / 1000.0 / period_s).ceil())
}
