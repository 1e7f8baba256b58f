//! `kernel-size`: your own kernel, with state, in every number format.
//!
//! A [`Kernel`] is written once over [`real::Real`]: its inputs, a loop over steps, its outputs and what is required of
//! them. Everything else follows from it. The reference is the same kernel in double-double, or a column of values that you
//! know to be right.
//!
//! ```
//! use kernel_size::{Input, InputError, Kernel, Output, Steps, compare, size};
//! use real::Real;
//!
//! /// A low-pass filter of first order, yₖ = yₖ₋₁ + (xₖ - yₖ₋₁)/8.
//! struct LowPass;
//!
//! impl Kernel for LowPass {
//!     fn name(&self) -> &'static str {
//!         "low pass"
//!     }
//!     fn steps(&self) -> usize {
//!         1000
//!     }
//!     fn inputs(&self) -> Result<Vec<Input>, InputError> {
//!         Ok(vec![Input::drawn("x", 7, (-1.0, 1.0), self.steps())?])
//!     }
//!     fn outputs(&self) -> Vec<Output> {
//!         vec![Output::named("y").within(1e-3)]
//!     }
//!     fn run<R: Real>(&self, steps: &mut Steps<'_, R>) {
//!         let mut y = R::zero();
//!         while let Some([x]) = steps.begin() {
//!             y = (y + ((x - y).signal("error")).ldexp(-3)).signal("y");
//!             steps.end([y]);
//!         }
//!     }
//! }
//!
//! let found = size(&LowPass)?;
//! assert_eq!(found.uniform.map(|run| run.format), Some("I2F11".to_string()));
//! let compared = compare(&LowPass, &kernel_size::built_in())?;
//! assert_eq!(compared.recommended.as_deref(), Some("I2F30"));
//! # Ok::<(), kernel_size::Refusal>(())
//! ```
//!
//! | question | where |
//! |---|---|
//! | what is a kernel? | [`Kernel`], [`Steps`], [`Input`], [`Output`] |
//! | how good is each format, where is it worst, where does it first go another way? | [`compare`] |
//! | how few bits are enough, for all signals alike and for each of its own? | [`size`] |
//! | which types have the registers in VHDL, C++, MATLAB, Rust or C? | [`Sizing::types`] |
//! | what does a step cost on a processor or an FPGA? | [`price`] |
//! | is a format worse than it was? | [`Baseline`] |
//! | which bits must another implementation make? | [`vectors`] |

mod baseline;
mod bench;
mod case;
mod compare;
mod ended;
mod formats;
mod input;
mod judge;
mod kernel;
mod output;
mod price;
mod reference;
mod refusal;
mod registers;
mod run;
mod size;
mod steps;
mod table;
mod types;
mod until_bad;
mod vectors;

pub use baseline::{Baseline, Since};
pub use compare::{Comparison, compare};
pub use ended::Ended;
pub use formats::{built_in, named};
pub use input::{Input, InputError};
pub use judge::{OutputFound, Required};
pub use kernel::Kernel;
pub use output::{Output, Requirement};
pub use price::{StepPrice, price};
pub use reference::ReferenceFound;
pub use refusal::Refusal;
/// The languages of [`Sizing::types`].
pub use register_types::Language;
pub use registers::{Register, Registers};
pub use run::{Divergence, FormatRun, Overflows, SignalFound};
pub use size::{Sizing, size, size_in};
pub use steps::Steps;
pub use vectors::vectors;
