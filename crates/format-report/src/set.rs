//! A set of parts: what each of them needs as a map, and the share of parts that are good against bits.

use std::collections::BTreeSet;

use askama::Template;

use crate::chart::{Axis, Layout, draw};
use crate::figure::{Entry, Figure};
use crate::frame::Frame;
use crate::line_chart::LineChart;
use crate::report::{Report, files};
use crate::table::{Cell, Column, Table};

/// Parts on the map; the table has all.
const MOST_ON_THE_MAP: usize = 200;

/// A part of a set.
#[derive(Clone, Debug, Default)]
pub struct PartOfSet {
    /// Its name.
    pub name: String,
    /// How it ended, in a word.
    pub status: String,
    /// How long its plan takes, in s.
    pub planned_time_s: Option<f64>,
    /// The fewest bits that are enough for it alone; `None` if none are known to be.
    pub bits: Option<u32>,
    /// The format of so many bits.
    pub format: Option<String>,
    /// Its margin in the recommended format.
    pub margin: Option<f64>,
    /// What limits it and where, or why it is not run.
    pub remark: String,
}

/// A set of parts for one controller.
#[derive(Clone, Debug, Default)]
pub struct SetPage {
    /// What is set into the frame as the part: what the set is.
    pub about: String,
    /// The answer, in lines.
    pub answer: Vec<String>,
    /// The fewest bits that are enough for all, if any are.
    pub bits: Option<u32>,
    /// The parts, the worst first.
    pub parts: Vec<PartOfSet>,
}

impl SetPage {
    /// Draws the map and the curve, with a table of all parts.
    ///
    /// # Errors
    /// As [`Report::of`].
    pub fn report(&self, command: &str) -> Result<Report, askama::Error> {
        let table = self.table();
        let figures: Vec<Figure> = [self.map(), self.shares()].into_iter().flatten().collect();
        let files = files(figures.iter(), std::iter::once(&table));
        let title = format!("feedbits: {}", self.about);
        let page = Page {
            frame: Frame::new((title, "Which format is good for every part?"), &self.about, &files, command),
            answer: &self.answer,
            table: &table,
            figures: figures.iter().map(|figure| (figure, figure.inline())).collect(),
        };
        Ok(Report::new(&page.render()?, files))
    }

    /// The widths from the least that a part needs to the greatest, with one on either side.
    fn widths(&self) -> Option<std::ops::RangeInclusive<u32>> {
        let bits = || self.parts.iter().filter_map(|part| part.bits).chain(self.bits);
        Some(bits().min()?.saturating_sub(1)..=bits().max()? + 1)
    }

    /// Parts by widths: which are too narrow for a part, and from which on there is a good format.
    fn map(&self) -> Option<Figure> {
        let widths: Vec<u32> = self.widths()?.collect();
        let parts: Vec<&PartOfSet> =
            self.parts.iter().filter(|part| part.bits.is_some()).take(MOST_ON_THE_MAP).collect();
        let names = parts.iter().map(|part| shortened(&part.name)).collect();
        let x = Axis::of_names("bits of the format", widths.iter().map(ToString::to_string).collect());
        let height = 70 + 22 * u32::try_from(parts.len()).unwrap_or(1);
        let layout = Layout { height, left: 230, from_top: true };
        let figure = draw((x, Axis::of_names("", names)), &layout, |plot| {
            for (row, part) in parts.iter().enumerate() {
                for (column, width) in widths.iter().enumerate() {
                    let (class, said) = kind(part.bits, *width);
                    let (x, y) = (column as f64, row as f64);
                    let tip = format!("{}, {width} bits: {said}", part.name);
                    plot.boxes(class, &[[x - 0.47, x + 0.47, y - 0.45, y + 0.45]], &tip);
                }
            }
        });
        let legend = [("rest-fill", NARROW), ("f0", OWN), ("f3", WIDER)];
        let figure = figure.named(
            "map",
            "What each part needs",
            "Of a width below a part's own every format breaks a requirement of it. A format of more bits is not always good: the answer for \
             all is one that was run along every part.",
        );
        Some(figure.with_legend(legend.map(|(class, name)| Entry::area(class, name)).into()))
    }

    /// The share of parts for which a width is at least their own, by their number and by their time.
    fn shares(&self) -> Option<Figure> {
        let widths: Vec<u32> = self.widths()?.collect();
        let weight_of = |weight: fn(&PartOfSet) -> f64| {
            let all: f64 = self.parts.iter().map(weight).sum();
            let steps: BTreeSet<u32> = widths.iter().copied().collect();
            let mut points = Vec::new();
            let mut before = 0.0;
            for width in steps {
                let enough = self.parts.iter().filter(|part| part.bits.is_some_and(|bits| bits <= width));
                let share = if all > 0.0 { 100.0 * enough.map(weight).sum::<f64>() / all } else { 0.0 };
                points.extend([(f64::from(width), before), (f64::from(width), share)]);
                before = share;
            }
            points
        };
        let chart = LineChart::new(["bits of the format", "parts with a good format [%]"])
            .line("by number", weight_of(|_| 1.0))
            .line("by machining time", weight_of(|part| part.planned_time_s.unwrap_or(0.0)));
        let caption = "Each part counts from the fewest bits on that are enough for it alone.";
        Some(chart.drawn().named("shares", "How many parts are good with so many bits", caption))
    }

    fn table(&self) -> Table {
        let columns = [
            ("part", "part"),
            ("status", "status"),
            ("planned_time_s", "time [s]"),
            ("bits", "bits"),
            ("format", "format"),
            ("margin", "margin"),
            ("remark", "limited by, or why"),
        ];
        let row = |part: &PartOfSet| {
            vec![
                Cell::text(&part.name),
                Cell::text(&part.status),
                Cell::maybe(part.planned_time_s),
                Cell::maybe(part.bits.map(f64::from)),
                part.format.as_ref().map_or(Cell::Nothing, Cell::text),
                Cell::maybe(part.margin),
                Cell::text(&part.remark),
            ]
        };
        Table {
            name: "parts".into(),
            title: "All parts, the worst first".into(),
            columns: columns.map(|(key, heading)| Column { key, heading }).to_vec(),
            rows: self.parts.iter().map(row).collect(),
        }
    }
}

const NARROW: &str = "every format is bad";
const OWN: &str = "the fewest bits for the part alone";
const WIDER: &str = "more than it needs";

/// The class and the meaning of a width for a part.
fn kind(own: Option<u32>, width: u32) -> (&'static str, &'static str) {
    match own {
        Some(own) if width == own => ("f0", OWN),
        Some(own) if width > own => ("f3", WIDER),
        _ => ("rest-fill", NARROW),
    }
}

/// The end of a name, which tells parts of a folder apart.
fn shortened(name: &str) -> String {
    const LONGEST: usize = 32;
    let count = name.chars().count();
    if count <= LONGEST {
        return name.to_string();
    }
    format!("…{}", name.chars().skip(count - LONGEST + 1).collect::<String>())
}

#[derive(Template)]
#[template(path = "set.html")]
struct Page<'a> {
    frame: Frame<'a>,
    answer: &'a [String],
    table: &'a Table,
    figures: Vec<(&'a Figure, String)>,
}

#[cfg(test)]
mod tests {
    use super::*;

    fn page() -> SetPage {
        let part = |name: &str, bits, time| PartOfSet {
            name: name.into(),
            status: "good".into(),
            bits,
            planned_time_s: time,
            ..PartOfSet::default()
        };
        let parts = vec![
            part("a<b>.nc", Some(26), Some(30.0)),
            part("c.nc", Some(24), Some(10.0)),
            part("d.nc", None, None),
        ];
        SetPage { about: "3 parts".into(), answer: vec!["26 bits".into()], bits: Some(26), parts }
    }

    /// A part with 26 bits of its own has 23 to 27 on the map, and three of these are too narrow.
    #[test]
    fn a_part_is_bad_below_its_own_bits() {
        assert_eq!(page().widths(), Some(23..=27));
        let svg = page().map().expect("a map").file();
        let count = |text: &str| svg.matches(text).count();
        assert_eq!(
            (count(NARROW) - 1, count(OWN) - 1, count(WIDER) - 1),
            (4, 2, 4),
            "each is in the legend once"
        );
    }

    #[test]
    fn a_page_has_every_part_and_escapes_names() {
        let report = page().report("feedbits compare").expect("a report");
        let (_, html) = report.files.iter().find(|(name, _)| name == Report::PAGE).expect("a page");
        assert!(html.contains("d.nc") && html.contains("map.svg") && html.contains("shares.svg"));
        assert!(!html.contains("a<b>.nc"));
        let none = SetPage { bits: None, parts: Vec::new(), ..page() }.report("").expect("a report");
        assert!(none.files.iter().all(|(name, _)| name != "map.svg"));
    }
}
