//! `servo-sim`: how far is the machine's path from the curve?
//!
//! An interpolator commands one point per period; the axes follow with errors. This crate runs setpoints through the
//! axis servo loops of a machine tool and says how far the resulting path is off the curve.
//!
//! ```text
//!             per period            per sub-step, in the drive's format                      the machine, f64
//!  setpoint ─> CommandFilter ─┬─> velocity, acceleration feed-forward ──┐
//!                             └─> position error × gain ──> ControlLaw ─┴─> VibrationFilter ─> Drive (lags, limit, friction) ─> Play ─> table
//!                                          └───────────── encoder <──────────────────┘
//! ```
//!
//! ```
//! use servo_sim::{CircleTest, Servo, ServoParameters};
//!
//! // 160 mm/s at a gain of 30 1/s, without feed-forward: the table is 160/30 = 5.33 mm behind.
//! let axis = ServoParameters::new(30.0, 0.39);
//! let servo = Servo::<f64, 1>::try_new(&[axis], 1e-3, [0.0])?;
//! let trace = servo.run((1..=1000).map(|period| [0.16 * f64::from(period)]))?;
//! let [error] = trace.following_error();
//! assert!((error.max - 5.333).abs() < 1e-3);
//!
//! // A circle of R10 at F4000 with 95 % feed-forward comes out about 5 µm too small.
//! let axis = ServoParameters { feed_forward: 0.95, ..ServoParameters::new(50.7, 0.39) };
//! let circle = CircleTest::PAPER.run::<f64>(&[axis; 2])?;
//! assert!((circle.radial_error_mean_mm + 0.005).abs() < 0.0002);
//! # Ok::<(), servo_sim::ServoError>(())
//! ```
//!
//! | question | where |
//! |---|---|
//! | which parameters does an axis have? | [`ServoParameters`] |
//! | which parts run on the controller, in any number format? | [`CommandFilter`], [`ControlLaw`], [`ReversalCompensation`], [`VibrationFilter`] |
//! | how is the feed ramped before interpolation? | [`ramp_feed`] |
//! | how does the machine follow a velocity command? | [`Drive`], [`Play`] |
//! | one axis, several axes | [`Axis`], [`Servo`] |
//! | how far is the path off the curve? | [`contour_error()`], [`ContourTracker`] |
//! | does the table follow at all? | [`Arrival`] |
//! | how round is a circle? how does tuning change it? | [`CircleTest`], [`tuning_table`], [`roundness_plot()`] |
//! | what does paper D print, and what comes out here? | [`paper_table`] |
//! | which result follows in closed form? | [`continuous_gain`], [`sampled_gain`], [`radius_change`] |
//! | is the loop stable? | [`SampledLoop`] |
//!
//! **Units**: mm and s; keys of the servo file carry their unit in the name.
//!
//! **Step size**: the drive is solved exactly, so the number of sub-steps only sets how often the position loop is
//! closed. This number changes the result for a steady sinusoid by less than `(ωh)²/2` of the amplitude. Where the
//! drive is at its acceleration limit A, it changes the position by less than `32 A h²`.
//!
//! **Not modelled**: resonances of the mechanics, cross-talk of axes, cutting forces, an integral part of the velocity
//! loop, and the oscillation of a velocity loop with too much gain. Without the integral part friction leaves a lasting
//! error, which real loops remove within some ten ms. The gain at which the loop oscillates is an input.
//!
//! # Source
//! Paper D of `docs/papers.md`: Liu P., Wang M., Fan J., Zhao X., "Realizing real-time look-ahead NURBS interpolation in FANUC system",
//! *Mechanical Science and Technology for Aerospace Engineering* 31 (2012) 791–795, section 3. Its test prints no loop
//! parameters. `data/servo.toml` has parameters that reproduce its figures, and says how they were found.

mod arrival;
mod axis;
mod backlash;
mod circle_test;
mod command_filter;
mod config;
mod contour_error;
mod control_law;
mod current_loop;
mod drive;
mod error;
mod error_size;
mod feed_ramp;
mod load_inertia;
mod motor;
mod paper_table;
mod response;
mod roundness_plot;
mod servo;
mod stability;
mod tuning;
mod vibration_filter;

pub use arrival::Arrival;
pub use axis::{Axis, AxisSample, AxisState};
pub use backlash::{Compensation, Play, ReversalCompensation, ReversalState};
pub use circle_test::{CircleTest, Roundness};
pub use command_filter::CommandFilter;
pub use config::{ReadError, ServoParameters};
pub use contour_error::{ContourTracker, Foot, contour_error};
pub use control_law::{CommandedMotion, ControlLaw};
pub use drive::Drive;
pub use error::ServoError;
pub use error_size::ErrorSize;
pub use feed_ramp::{RunPlace, Travelled, ramp_feed};
pub use load_inertia::velocity_gain_of_load_inertia;
pub use motor::MotorState;
pub use paper_table::{
    PAPER_SETTINGS, PRINTED_POSITION_GAIN_PER_S, PaperCircle, PaperRow, PaperSetting, lag_of_right_radius_ms,
    paper_table,
};
pub use response::{continuous_gain, moving_average_gain, radius_change, sampled_gain};
pub use roundness_plot::roundness_plot;
pub use servo::{Followed, Sample, Servo, Trace};
pub use stability::SampledLoop;
pub use tuning::{FEED_FORWARDS, LeftOut, Tuning, TuningRow, VELOCITY_GAINS_PERCENT, tuning_table};
pub use vibration_filter::{FilterState, Notch, VibrationFilter};
