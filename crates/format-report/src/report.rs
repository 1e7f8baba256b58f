//! A report: a page, and a file for each picture and table.

use foreign_text::in_lines;

use crate::figure::Figure;
use crate::table::Table;

/// A report, ready to be written.
#[derive(Clone, Debug)]
pub struct Report {
    /// The files by name, `index.html` first.
    pub files: Vec<(String, String)>,
}

impl Report {
    /// The name of the page.
    pub const PAGE: &str = "index.html";

    /// The page and the files beside it. The template has escaped the names in the page; what they hold that cannot be seen
    /// becomes a `?` here.
    pub(crate) fn new(page: &str, beside: Vec<(String, String)>) -> Self {
        let index = (Self::PAGE.to_string(), in_lines(page));
        Self { files: std::iter::once(index).chain(beside).collect() }
    }
}

/// A file for each picture, and two for each table.
pub(crate) fn files<'a>(
    figures: impl Iterator<Item = &'a Figure>,
    tables: impl Iterator<Item = &'a Table>,
) -> Vec<(String, String)> {
    let pictures = figures.map(|figure| (format!("{}.svg", figure.name), figure.file()));
    let tables = tables.flat_map(|table| {
        let name = &table.name;
        [(format!("{name}.csv"), table.csv()), (format!("{name}.json"), table.json())]
    });
    pictures.chain(tables).collect()
}

/// The files that a report's page lists as beside it; none if the page is not a report's. Names that could not be those
/// of a picture or a table in the page's own folder are left out.
#[must_use]
pub fn listed(page: &str) -> Vec<String> {
    let is_ours = page.contains("<p>Made by <code>feedbits");
    let list = page.split("<summary>All files beside this page</summary><p>").nth(1).filter(|_| is_ours);
    let list = list.and_then(|rest| rest.split("</p>").next()).unwrap_or_default();
    let names = list.split("<a href=\"").skip(1).filter_map(|rest| rest.split('"').next());
    let is_plain = |name: &&str| {
        let has_ending = [".svg", ".csv", ".json"].iter().any(|ending| name.ends_with(ending));
        let is_plain = |c: char| c.is_ascii_alphanumeric() || "._-".contains(c);
        has_ending && !name.starts_with('.') && name.chars().all(is_plain)
    };
    names.filter(is_plain).map(String::from).collect()
}
