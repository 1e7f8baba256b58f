//! A finished picture: in the page, and as a file of its own.

use foreign_text::{in_a_file_name, in_lines};
use svg::Document;
use svg::node::element::{Group, Path, Rectangle, Style, Text, Title};

use crate::palette;

/// A finished picture.
#[derive(Clone, Debug)]
pub struct Figure {
    /// The name of its file, without ending.
    pub name: String,
    /// The title.
    pub title: String,
    /// How a reader is to read it.
    pub caption: String,
    /// The number of the run that the picture shows, if there is one picture for each run; `None` if there is only one
    /// picture.
    pub of_run: Option<usize>,
    size: (u32, u32),
    content: Group,
    axes: (String, String),
    follows_pointer: bool,
    legend: Vec<Entry>,
    legend_only_in_file: bool,
}

/// An entry of a legend: a sample and its meaning.
#[derive(Clone, Debug)]
pub(crate) struct Entry {
    class: String,
    is_line: bool,
    /// The meaning of the sample.
    pub(crate) name: String,
}

impl Entry {
    /// A line of this class.
    pub(crate) fn line(class: &str, name: &str) -> Self {
        Self { class: class.to_string(), is_line: true, name: name.to_string() }
    }

    /// An area of this class.
    pub(crate) fn area(class: &str, name: &str) -> Self {
        Self { class: class.to_string(), is_line: false, name: name.to_string() }
    }

    fn drawn(&self, (x, y): (u32, u32)) -> Group {
        let sample = if self.is_line {
            let data = format!("M{x} {y}h26");
            Group::new()
                .set("class", self.class.as_str())
                .add(Path::new().set("class", "line").set("d", data))
        } else {
            let data = format!("M{x} {}h26v8h-26z", y - 4);
            Group::new().add(Path::new().set("class", self.class.as_str()).set("d", data))
        };
        let text = Text::new(self.name.as_str())
            .set("class", "tick")
            .set("x", x + 32)
            .set("y", y)
            .set("dy", "0.35em");
        sample.add(text)
    }
}

/// Entries of a legend in a line.
const ENTRIES_A_LINE: usize = 4;
/// Height of such a line, in pixels.
const ENTRY_HEIGHT: u32 = 20;

impl Figure {
    pub(crate) fn new(width: u32, height: u32, content: Group, axes: (String, String)) -> Self {
        Self {
            name: String::new(),
            title: String::new(),
            caption: String::new(),
            of_run: None,
            size: (width, height),
            content,
            axes,
            follows_pointer: false,
            legend: Vec::new(),
            legend_only_in_file: false,
        }
    }

    pub(crate) fn empty(width: u32, height: u32) -> Self {
        Self::new(width, height, Group::new(), (String::new(), String::new()))
    }

    /// Gives the picture its file's name, of which [`in_a_file_name`] keeps what may stand in one, its title and its caption.
    #[must_use]
    pub fn named(mut self, name: &str, title: &str, caption: &str) -> Self {
        self.name = in_a_file_name(name);
        self.title = title.to_string();
        self.caption = caption.to_string();
        self
    }

    /// Makes the page show the values of all lines at the place of the pointer.
    pub(crate) fn following_the_pointer(mut self) -> Self {
        self.follows_pointer = true;
        self
    }

    /// Adds a legend below the picture, for its colours and dashes.
    pub(crate) fn with_legend(mut self, legend: Vec<Entry>) -> Self {
        self.legend = legend;
        self
    }

    /// Adds a legend of the runs to the picture's own file. The page lists the runs beside their switches and needs no
    /// legend.
    pub(crate) fn with_runs(mut self, runs: Vec<Entry>) -> Self {
        self.legend = runs;
        self.legend_only_in_file = true;
        self
    }

    pub(crate) fn of_run(mut self, run: usize) -> Self {
        self.of_run = Some(run);
        self
    }

    /// The element for the page, which has the styles.
    #[must_use]
    pub fn inline(&self) -> String {
        let mut document = self.document(!self.legend_only_in_file);
        if self.follows_pointer {
            document = document.set("data-x", self.axes.0.as_str()).set("data-y", self.axes.1.as_str());
        }
        in_lines(&document.to_string())
    }

    /// The picture as a file of its own, with its styles, on white.
    #[must_use]
    pub fn file(&self) -> String {
        let paper = Rectangle::new().set("width", "100%").set("height", "100%").set("fill", "#ffffff");
        let (width, height) = (self.size.0, self.size.1 + self.legend_height());
        let mut document = self.document(true).set("width", width).set("height", height);
        let children = document.get_children_mut();
        children.insert(1, Box::new(Style::new(palette::styles_of_a_file())));
        children.insert(2, Box::new(paper));
        in_lines(&document.to_string())
    }

    fn legend_height(&self) -> u32 {
        u32::try_from(self.legend.len().div_ceil(ENTRIES_A_LINE)).unwrap_or(0) * ENTRY_HEIGHT
    }

    fn document(&self, with_legend: bool) -> Document {
        let (width, height) = self.size;
        let legend = if with_legend { self.legend.as_slice() } else { &[] };
        let below = if with_legend { self.legend_height() } else { 0 };
        let mut document = Document::new()
            .set("viewBox", (0, 0, width, height + below))
            .set("role", "img")
            .add(Title::new(self.title.as_str()))
            .add(self.content.clone());
        let column = (width - 40) / u32::try_from(ENTRIES_A_LINE).unwrap_or(1);
        let mut place = (20, height + ENTRY_HEIGHT / 2);
        for (index, entry) in legend.iter().enumerate() {
            document = document.add(entry.drawn(place));
            place.0 += column;
            if (index + 1) % ENTRIES_A_LINE == 0 {
                place = (20, place.1 + ENTRY_HEIGHT);
            }
        }
        document
    }
}
