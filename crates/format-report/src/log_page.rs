//! A log of setpoints: what it takes of limits as a table, over time, and along its path.

use askama::Template;

use crate::figure::Figure;
use crate::frame::Frame;
use crate::log_path;
use crate::log_path_point::LogPathPoint;
use crate::report::{Report, files};
use crate::table::{Cell, Column, Table};

/// What is taken of a limit.
#[derive(Clone, Debug, Default)]
pub struct LogLimitRow {
    /// Of what it is a limit.
    pub what: String,
    /// The limit.
    pub limit: f64,
    /// The unit of the limit.
    pub unit: String,
    /// The share that setpoints take as they are.
    pub raw: Option<f64>,
    /// The share that every motion within the resolution takes.
    pub taken: Option<f64>,
    /// The verdict, in a word or two.
    pub verdict: String,
    /// The row of the log where the most is taken.
    pub row: Option<f64>,
    /// The line of the program there.
    pub line: Option<f64>,
}

/// A log that was judged.
#[derive(Clone, Debug, Default)]
pub struct LogPage {
    /// The log's name.
    pub about: String,
    /// Whether it has no fault.
    pub is_good: bool,
    /// The answer, in lines.
    pub answer: Vec<String>,
    /// What is known of the log and of how it follows its part: names and values.
    pub facts: Vec<(String, String)>,
    /// The limits.
    pub limits: Vec<LogLimitRow>,
    /// The path, place by place.
    pub path: Vec<LogPathPoint>,
    /// Quantities over time.
    pub charts: Vec<Figure>,
}

#[derive(Template)]
#[template(path = "log.html")]
struct Page<'a> {
    frame: Frame<'a>,
    is_good: bool,
    answer: &'a [String],
    facts: &'a [(String, String)],
    table: &'a Table,
    figures: Vec<(&'a Figure, String)>,
}

impl LogPage {
    /// Draws the path, and makes a page of it with the charts and the table.
    ///
    /// # Errors
    /// As [`Report::of`].
    pub fn report(&self, command: &str) -> Result<Report, askama::Error> {
        let table = self.table();
        let mut figures = log_path::figures(&self.path);
        figures.extend(self.charts.iter().cloned());
        let files = files(figures.iter(), std::iter::once(&table));
        let title = format!("feedbits: {}", self.about);
        let page = Page {
            frame: Frame::new((title, "What did the controller really do?"), &self.about, &files, command),
            is_good: self.is_good,
            answer: &self.answer,
            facts: &self.facts,
            table: &table,
            figures: figures.iter().map(|figure| (figure, figure.inline())).collect(),
        };
        Ok(Report::new(&page.render()?, files))
    }

    fn table(&self) -> Table {
        let columns = [
            ("what", "limit of"),
            ("limit", "limit"),
            ("unit", "unit"),
            ("as_it_is", "as it is"),
            ("at_least", "at least"),
            ("verdict", "verdict"),
            ("row", "row"),
            ("line", "line"),
        ];
        let row = |one: &LogLimitRow| {
            vec![
                Cell::text(&one.what),
                Cell::Number(one.limit),
                Cell::text(&one.unit),
                Cell::maybe(one.raw),
                Cell::maybe(one.taken),
                Cell::text(&one.verdict),
                Cell::maybe(one.row),
                Cell::maybe(one.line),
            ]
        };
        Table {
            name: "limits".into(),
            title: "What is taken of each limit".into(),
            columns: columns.map(|(key, heading)| Column { key, heading }).to_vec(),
            rows: self.limits.iter().map(row).collect(),
        }
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::line_chart::LineChart;

    fn page() -> LogPage {
        let path = (0..100).map(|index| LogPathPoint {
            point_mm: [f64::from(index), f64::from(index % 7), 0.0],
            time_s: 0.001 * f64::from(index),
            follows: index > 0 && index != 50,
            share: if index == 70 { 4.4 } else { 0.5 },
        });
        let chart =
            LineChart::new(["time [s]", "feed [mm/s]"]).line("feed", vec![(0.0, 1.0), (1.0, 2.0)]).drawn();
        LogPage {
            about: "a<b>.csv".into(),
            answer: vec!["acceleration of X is broken".into()],
            facts: vec![("rows".into(), "100".into())],
            limits: vec![LogLimitRow {
                what: "acceleration of X".into(),
                limit: 640.0,
                raw: Some(4.4),
                ..LogLimitRow::default()
            }],
            path: path.collect(),
            charts: vec![chart.named("feed", "The speed", "")],
            ..LogPage::default()
        }
    }

    #[test]
    fn a_page_has_table_charts_and_path_and_escapes_names() {
        let report = page().report("feedbits judge").expect("a report");
        let names: Vec<&str> = report.files.iter().map(|(name, _)| name.as_str()).collect();
        assert_eq!(names, ["index.html", "log-path.svg", "feed.svg", "limits.csv", "limits.json"]);
        let html = &report.files[0].1;
        assert!(
            html.contains("acceleration of X is broken")
                && html.contains("class=\"bad\"")
                && !html.contains("a<b>")
        );
        let empty = LogPage::default().report("").expect("a report");
        assert!(empty.files.iter().all(|(name, _)| name != "log-path.svg"));
    }

    /// The part with the excess has a colour of its own, and nothing is drawn over a gap.
    #[test]
    fn the_path_has_the_colour_of_what_it_takes() {
        let report = page().report("").expect("a report");
        let svg = &report.files.iter().find(|(name, _)| name == "log-path.svg").expect("a picture").1;
        assert!(svg.contains("trail v4") && svg.contains("trail v3"), "{svg}");
        assert!(svg.contains("0.07 to 0.071 s"), "{svg}");
    }
}
