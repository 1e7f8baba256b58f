//! `c-code`: a compiled path and its plan as C99 for a controller.
//!
//! [`CPart`] takes a compiled path; [`CPart::files`] gives a header and a source. The source has the step and the tables, and
//! its run is bit for bit the run of [`PieceInterpolator`](secant_interp::PieceInterpolator). Only what the path needs is
//! written: a path without weights has no code for weights, and a plan without corners none for corners.
//!
//! | file | has |
//! |---|---|
//! | `templates/part.h` | what a caller sees: units, formats, functions, the self-test |
//! | `templates/products.c` | products of words, on cores with and without long ones |
//! | `templates/numbers_*.c` | the format's sums, products, quotients and roots |
//! | `templates/tables.c` | pieces, coefficients, stages and sections |
//! | `templates/lengths.c`, `mean.c`, `cosine.c` | the distance of each period |
//! | `templates/pieces.c`, `chord.c`, `joints.c`, `step.c` | the step |
//! | `templates/override.c` | feed override and hold |
//! | `templates/self_test.c` | the checksum, and the run that is compared |

mod c_part;
mod exponents;
mod factors;
mod files;
mod literal;
mod name;
mod overridden_run;
mod shapes;
mod values;

pub use c_part::{COverride, CPart, ExpectedRun};
pub use files::CFiles;
pub use literal::{expect_described, expect_type};
pub use name::{CError, CName};
pub use overridden_run::{OverriddenRun, RateCommand};
