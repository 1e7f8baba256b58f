//! `limit-judge`: does this motion keep the limits that its machine states, as far as its setpoints show?
//!
//! | file | answers | public names |
//! |---|---|---|
//! | `stated_limit` | which derivative of what is limited? | [`StatedLimit`], [`Of`] |
//! | `differences` | what is taken of each limit, over one period and over many? | [`Differences`] → [`LimitFinding`] |
//! | `worst` | where is the greatest figure? | [`Worst`], [`StepPlace`] |
//!
//! Numbers are in mm and periods. The memory does not grow with the motion.
//!
//! ```
//! use limit_judge::{Differences, Of, Setpoint, StatedLimit, StepPlace, Way};
//!
//! // X may take 0.01 mm a period, squared. It goes from rest to a velocity of 0.02 mm a period in one.
//! let limit = StatedLimit { of: Of::Axis(0), order: 1, most: 0.01 };
//! let mut differences = Differences::new(&[limit]);
//! for (index, x) in [0.0, 0.0, 0.02, 0.04, 0.06, 0.06].into_iter().enumerate() {
//!     let at = StepPlace { index: index as u64, row: 0, curve: 0, point_mm: [x, 0.0, 0.0] };
//!     let next = Setpoint {
//!         at,
//!         way: Way::default(),
//!         feed_mm: f64::INFINITY,
//!         passes_corner: false,
//!         corner: None,
//!         ends_at_rest: index == 5,
//!     };
//!     differences.add(None, Way::default(), next);
//! }
//! let found = &differences.findings(1e-6, None)[0];
//! assert_eq!(found.limit.what(), "acceleration of X");
//! assert!(found.taken.figure > 1.99, "twice what it may");
//! ```

mod differences;
mod seen_within;
mod stated_limit;
mod worst;

pub use differences::{Corner, Differences, LimitFinding, SPAN, Setpoint, WINDOWS, Way};
pub use seen_within::seen_within_mm;
pub use stated_limit::{Of, StatedLimit};
pub use worst::{StepPlace, Worst, is_less};
