//! `servo-sim`: what does the machine make of the setpoints?
//!
//! An interpolator commands a point a period; the part sees where the axes go. This crate runs setpoints through the
//! axis servo loops of a machine tool and says how far the path is off the curve.
//!
//! ```text
//!             per period            per sub-step, in the drive's format                      the machine, f64
//!  setpoint ─> CommandFilter ─┬─> velocity, acceleration feed-forward ──┐
//!                             └─> position error × gain ──> ControlLaw ─┴─> Drive (lag, limit, friction) ─> Play ─> table
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
//! | what runs on the controller, in any number format? | [`CommandFilter`], [`ControlLaw`], [`ReversalCompensation`] |
//! | what does the machine do with a velocity command? | [`Drive`], [`Play`] |
//! | one axis, several axes | [`Axis`], [`Servo`] |
//! | how far is the path off the curve? | [`contour_error()`], [`ContourTracker`] |
//! | does the table follow at all? | [`Arrival`] |
//! | how round is a circle? what does tuning do to it? | [`CircleTest`], [`tuning_table`], [`roundness_plot()`] |
//! | what must come out, in closed form? | [`continuous_gain`], [`sampled_gain`], [`radius_change`] |
//! | is the loop stable? | [`SampledLoop`] |
//!
//! **Units**: mm and s; keys of the servo file carry their unit in the name.
//!
//! **Step size**: the drive is solved exactly, so the number of sub-steps only sets how often the position loop is closed.
//! Its effect on a steady sinusoid is below `(ωh)²/2` of the amplitude; where the drive is at its acceleration limit A, it
//! is below `32 A h²`.
//!
//! **What is not modelled**: resonances of the mechanics, cross-talk of axes, cutting forces, an integral part of the
//! velocity loop (friction then leaves a lasting error, which real loops remove within some ten ms), and the
//! oscillation of a velocity loop with too much gain, whose limit is an input.
//!
//! # Source
//! Paper D of `docs/papers.md`: Liu P., Wang M., Fan J., Zhao X., "Realizing real-time look-ahead NURBS interpolation in FANUC system",
//! *Mechanical Science and Technology for Aerospace Engineering* 31 (2012) 791–795, section 3. Its test prints no
//! loop parameters; `data/servo.toml` has those that fit its figures, and says how.

mod arrival;
mod axis;
mod backlash;
mod circle_test;
mod command_filter;
mod config;
mod contour_error;
mod control_law;
mod drive;
mod error;
mod error_size;
mod response;
mod roundness_plot;
mod servo;
mod stability;
mod tuning;

pub use arrival::Arrival;
pub use axis::{Axis, AxisSample, AxisState};
pub use backlash::{Compensation, Play, ReversalCompensation, ReversalState};
pub use circle_test::{CircleTest, Roundness};
pub use command_filter::CommandFilter;
pub use config::{ReadError, ServoParameters};
pub use contour_error::{ContourTracker, Foot, contour_error};
pub use control_law::{CommandedMotion, ControlLaw};
pub use drive::{Drive, MotorState};
pub use error::ServoError;
pub use error_size::ErrorSize;
pub use response::{continuous_gain, moving_average_gain, radius_change, sampled_gain};
pub use roundness_plot::roundness_plot;
pub use servo::{Sample, Servo, Trace};
pub use stability::SampledLoop;
pub use tuning::{FEED_FORWARDS, LeftOut, Tuning, TuningRow, VELOCITY_GAINS_PERCENT, tuning_table};
