//! `domains`: which numbers may a person write, in files and on the command line?
//!
//! | file | answers |
//! |---|---|
//! | `domain.rs` | which numbers are within a [`Domain`], and how is it said? |
//! | `key.rs` | what is a [`Key`]: its name, its domain, its default, what it means? |
//! | `machine.rs` | the tables `[machine]` and `[machine.axes.x]` of a machine file |
//! | `curve.rs` | the table `[curve]` of a curve file |
//! | `servo.rs` | the table `[servo]` of a servo file |
//! | `target.rs` | the keys of a target file |
//! | `words.rs` | the words of a part program |
//! | `options.rs` | the options of the command line |
//! | `table.rs` | how do these tables look in Markdown? [`TABLES`] |
//!
//! Every reader takes its domains from here, and the tables of the book are made from here. Ends are so wide that no machine is
//! refused. They find a unit that is wrong by a factor of a thousand, and they bound what a number can cost. Where the product of two
//! numbers sets the cost, as that of a feed and a period does, whoever does the work bounds the product before it begins.
//!
//! ```
//! use domains::machine::FEEDRATE;
//!
//! assert!(FEEDRATE.domain().unwrap().holds(50.0));
//! assert_eq!(FEEDRATE.refusal(1e300).unwrap(), "`feedrate_mm_per_s` is 1e300: expected a number of 1e-6 to 1e5 mm/s");
//! ```

pub mod curve;
mod domain;
mod key;
pub mod machine;
pub mod options;
pub mod servo;
mod table;
pub mod target;
pub mod words;

pub use domain::{Domain, shown};
pub use key::{Key, LeftOut, Value};
pub use table::{TABLES, Table, markdown};
