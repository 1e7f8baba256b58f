//! `foreign-text`: names and other text from outside in files that are written.
//!
//! The names of parts, machines and targets come from whoever made their files. In a comment of C a name with `*/` ends the comment, and
//! what follows is compiled. In a spreadsheet a cell that begins with `=` is computed. So each language has one function here, and the
//! function lets a short list of characters through. Everything else becomes a `?`, and several in a row become one.
//!
//! | the text goes into | function | lets through |
//! |---|---|---|
//! | a comment of C, C++, VHDL, MATLAB or Rust | [`in_a_comment`] | letters and digits of ASCII, spaces and a few marks |
//! | a page, a picture, a terminal | [`in_lines`], [`in_a_line`] | letters, digits and marks that can be seen |
//! | a cell of a table in CSV | [`in_a_cell`] | as in a line, with a `'` where a formula would begin |
//! | the name of a file | [`in_a_file_name`] | letters and digits of ASCII, `-`, `_` and `.` |
//!
//! The marks of HTML, SVG, CSV and JSON themselves are escaped by the libraries that write these languages: `askama`, `svg`, `csv` and
//! `serde_json`. JSON holds any text, so a name in it is as it was given.
//!
//! ```
//! assert_eq!(foreign_text::in_a_comment("x*\\ int y; \\*.nc"), "x? int y; ?.nc");
//! assert_eq!(foreign_text::in_a_cell("=1+1.nc"), "'=1+1.nc");
//! ```

mod cell;
mod comment;
mod file_name;
pub mod hostile;
mod line;

pub use cell::in_a_cell;
pub use comment::in_a_comment;
pub use file_name::in_a_file_name;
pub use line::{in_a_line, in_lines, is_printable};

/// The text, with `instead` for each run of characters that are not allowed.
fn kept(text: &str, is_allowed: impl Fn(char) -> bool, instead: char) -> String {
    let mut kept = String::with_capacity(text.len());
    for c in text.chars() {
        if is_allowed(c) {
            kept.push(c);
        } else if !kept.ends_with(instead) {
            kept.push(instead);
        }
    }
    kept
}
