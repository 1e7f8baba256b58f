//! The frame of a page, around its content.

use crate::palette;

/// The parts that every page has around its content.
pub(crate) struct Frame<'a> {
    pub(crate) title: String,
    pub(crate) question: &'static str,
    pub(crate) part: &'a str,
    pub(crate) files: Vec<String>,
    pub(crate) command: &'a str,
    pub(crate) style: &'static str,
    pub(crate) figure_style: String,
    pub(crate) script: &'static str,
}

impl<'a> Frame<'a> {
    /// The frame of a page about `part`, with links to `files` beside it.
    pub(crate) fn new(
        (title, question): (String, &'static str),
        part: &'a str,
        files: &[(String, String)],
        command: &'a str,
    ) -> Self {
        Self {
            title,
            question,
            part,
            files: files.iter().map(|(name, _)| name.clone()).collect(),
            command,
            style: include_str!("../templates/page.css"),
            figure_style: palette::styles_of_the_page(),
            script: include_str!("../templates/page.js"),
        }
    }
}
