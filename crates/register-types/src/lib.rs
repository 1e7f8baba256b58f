//! `register-types`: how do the registers of a datapath become types of the language in which it is written?
//!
//! ```
//! use register_types::{Language, Register, Types};
//!
//! let registers = [Register::named("y", "I2F11", 1.25).expect("fixed point")];
//! let about = ["A filter.".to_string()];
//! let types = Types { registers: &registers, datapath: Default::default(), prefix: "filter", about: &about, example: ["a", "b", "y"] };
//! assert!(types.in_language(Language::C).contains("typedef int16_t filter_y;"));
//! ```

mod languages;
mod register;

pub use languages::{Language, Types};
pub use register::{Register, identifier};
