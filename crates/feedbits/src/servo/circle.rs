//! The circle test and the tuning table around it.

use std::path::Path;

use anyhow::{Context, Result};
use servo_sim::{
    CircleTest, FEED_FORWARDS, ServoError, ServoParameters, VELOCITY_GAINS_PERCENT, roundness_plot,
};

use super::arguments::Arguments;
use super::bounds::expect_end_of_circles;
use super::report::{CircleResult, LeftOut};
use crate::output;
use crate::places::Place;

/// Runs the circle test. A table that does not go round is a result; any other fault is an error.
pub(super) fn circle(servo: &ServoParameters, test: &CircleTest) -> Result<CircleResult> {
    match test.run::<f64>(&[*servo; 2]) {
        Ok(circle) => Ok(CircleResult::Round(circle)),
        Err(reason @ ServoError::DoesNotTurn { .. }) => {
            Ok(CircleResult::DoesNotFollow { does_not_follow: reason.to_string() })
        }
        Err(error) => Err(error).context("circle test"),
    }
}

/// Writes the roundness plot, if the table makes a circle.
pub(super) fn plot(
    place: &Place,
    servo: &ServoParameters,
    test: &CircleTest,
    circle: &CircleResult,
) -> Result<()> {
    let circle = match circle {
        CircleResult::Round(circle) => circle,
        CircleResult::DoesNotFollow { does_not_follow } => {
            let path = place.path().unwrap_or(Path::new("the plot")).display();
            output::say(&format!("feedbits: {path} is not written: {does_not_follow}"));
            return Ok(());
        }
    };
    let title = format!(
        "Circle test: feed-forward {} %, velocity gain {} %",
        servo.feed_forward * 100.0,
        servo.velocity_gain_percent
    );
    output::write(place, &(roundness_plot(test, circle, &title) + "\n"))
}

/// The settings that the tuning table leaves out, one entry for each velocity gain and reason.
pub(super) fn by_reason(settings: &[servo_sim::LeftOut]) -> Vec<LeftOut> {
    let mut grouped: Vec<LeftOut> = Vec::new();
    for setting in settings {
        let (gain, reason) = (setting.velocity_gain_percent, setting.reason.to_string());
        match grouped.last_mut() {
            Some(last) if last.velocity_gain_percent == gain && last.reason == reason => {
                last.feed_forwards.push(setting.feed_forward);
            }
            _ => grouped.push(LeftOut {
                velocity_gain_percent: gain,
                feed_forwards: vec![setting.feed_forward],
                reason,
            }),
        }
    }
    grouped
}

/// The circle test that the options name; one that would run for hours is refused.
pub(super) fn circle_test(arguments: &Arguments, servo: &ServoParameters, period: f64) -> Result<CircleTest> {
    let test = CircleTest { radius: arguments.circle, feedrate: arguments.feed / 60.0, period };
    // In the servo's own setting, and in each setting of the tuning table.
    let runs = 1 + FEED_FORWARDS.len() * VELOCITY_GAINS_PERCENT.len();
    let said = format!("--circle {} at --feed {}", arguments.circle, arguments.feed);
    expect_end_of_circles(&said, servo, &test, runs)?;
    Ok(test)
}
