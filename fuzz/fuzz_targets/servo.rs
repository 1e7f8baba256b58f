#![no_main]

use arbitrary::Unstructured;
use libfuzzer_sys::fuzz_target;
use real::{Backend, I16F16, I32F32};
use servo_sim::{Servo, ServoParameters};
use stress::any_number;

fuzz_target!(|bytes: &[u8]| {
    let mut bytes = Unstructured::new(bytes);
    let mut near = |usual: f64| match any_number(&mut bytes) {
        factor if factor.abs() <= 16.0 => usual * factor,
        other => other,
    };
    let mut parameters = ServoParameters::new(near(50.0), near(0.4));
    parameters.feed_forward = near(1.0);
    parameters.acceleration_feed_forward = near(1.0);
    parameters.velocity_gain_percent = near(100.0);
    parameters.velocity_gain_limit_percent = near(300.0);
    parameters.backlash_mm = near(0.01);
    parameters.backlash_compensation_mm = near(0.01);
    parameters.backlash_acceleration_ms = near(1.0);
    parameters.encoder_resolution_mm = near(0.0001);
    parameters.command_filter_ms = near(1.0).min(1e4);
    parameters.feed_ramp_ms = near(1.0).min(1e4);
    parameters.current_lag_ms = near(0.1);
    parameters.vibration_filter_hz = near(200.0);
    parameters.vibration_filter_bandwidth_hz = near(60.0);
    parameters.sub_steps = near(8.0).clamp(0.0, 64.0) as u32;
    let period = near(0.001);
    let setpoints: Vec<[f64; 2]> = (0..50).map(|_| [near(1.0), near(1.0)]).collect();
    run::<f64>(&parameters, period, &setpoints);
    run::<f32>(&parameters, period, &setpoints);
    run::<I16F16>(&parameters, period, &setpoints);
    run::<I32F32>(&parameters, period, &setpoints);
});

/// Refused, or as many samples as sub-steps, all of them numbers where the setpoints are of a machine's size.
fn run<R: Backend>(parameters: &ServoParameters, period: f64, setpoints: &[[f64; 2]]) {
    let Ok(mut servo) = Servo::<R, 2>::try_new(&[*parameters; 2], period, [0.0; 2]) else {
        return;
    };
    let mut samples = Vec::new();
    let mut largest = 0.0_f64;
    for (index, setpoint) in setpoints.iter().enumerate() {
        if servo.step(*setpoint, &mut samples).is_err() {
            return;
        }
        assert_eq!(samples.len(), (index + 1) * parameters.sub_steps as usize);
        largest = setpoint.iter().fold(largest, |m, x| m.max(x.abs()));
        if largest < 1e6 {
            assert!(samples.iter().all(|s| s.command.iter().chain(&s.table).all(|x| x.is_finite())));
        }
    }
}
