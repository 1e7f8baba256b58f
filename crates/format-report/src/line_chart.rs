//! Lines over one axis: a picture for any quantity that changes with another.

use crate::chart::{Axis, Layout, draw};
use crate::figure::{Entry, Figure};
use crate::palette::{DASH_COUNT, HUE_COUNT};

/// Points through which a line goes without a break.
type Stretch = Vec<(f64, f64)>;

/// Lines through points, with limits across them.
///
/// ```
/// use format_report::LineChart;
///
/// let feed = vec![(0.0, 0.0), (0.1, 50.0), (0.2, 50.0), (0.3, 0.0)];
/// let figure = LineChart::new(["time [s]", "feed [mm/s]"]).line("planned", feed).limit(60.0, "F").drawn();
/// let figure = figure.named("feed", "Feed over time", "The feed of a plan.");
/// assert!(figure.file().starts_with("<svg") && figure.file().contains("feed [mm/s]"));
/// ```
#[derive(Clone, Debug)]
pub struct LineChart {
    labels: [String; 2],
    lines: Vec<(String, Vec<Stretch>)>,
    limits: Vec<(f64, String)>,
    is_of_plane: bool,
}

impl LineChart {
    /// A chart whose axes have these labels, each a quantity with its unit.
    #[must_use]
    pub fn new(labels: [&str; 2]) -> Self {
        Self { labels: labels.map(str::to_string), lines: Vec::new(), limits: Vec::new(), is_of_plane: false }
    }

    /// Makes a unit as long up as across, and leaves out zero: for a curve in the plane.
    #[must_use]
    pub fn of_plane(mut self) -> Self {
        self.is_of_plane = true;
        self
    }

    /// Adds a line through points that are sorted by x; of a curve in the plane, in any order.
    #[must_use]
    pub fn line(self, name: &str, points: Vec<(f64, f64)>) -> Self {
        self.stretches(name, vec![points])
    }

    /// Adds a line in stretches, as [`line`](Self::line) does, with nothing drawn between one and the next.
    #[must_use]
    pub fn stretches(mut self, name: &str, stretches: Vec<Vec<(f64, f64)>>) -> Self {
        self.lines.push((name.to_string(), stretches));
        self
    }

    /// Adds a limit across the picture.
    #[must_use]
    pub fn limit(mut self, value: f64, name: &str) -> Self {
        self.limits.push((value, name.to_string()));
        self
    }

    /// The picture. Two lines or more have a legend.
    #[must_use]
    pub fn drawn(&self) -> Figure {
        let points = || self.lines.iter().flat_map(|(_, stretches)| stretches.iter().flatten());
        let (xs, ys) = (|| points().map(|(x, _)| *x), || points().map(|(_, y)| *y));
        let limits = self.limits.iter().map(|(value, _)| *value);
        let layout = Layout { left: 84, ..Layout::default() };
        let axes = if self.is_of_plane {
            self.axes_of_plane(span(xs()), span(ys()))
        } else {
            let (low, high) = span(xs());
            (Axis::linear(&self.labels[0], low..high), Axis::over(&self.labels[1], ys().chain(limits)))
        };
        let figure = draw(axes, &layout, |plot| {
            for (index, (name, stretches)) in self.lines.iter().enumerate() {
                plot.group(&class(index), name, |plot| {
                    if self.is_of_plane {
                        let lines: Vec<_> = stretches.iter().map(Vec::as_slice).collect();
                        plot.trails("line", &lines, name);
                    } else {
                        stretches.iter().for_each(|points| plot.line(points));
                    }
                });
            }
            for (value, name) in &self.limits {
                plot.limit(*value, name);
            }
        });
        let entries =
            self.lines.iter().enumerate().map(|(index, (name, _))| Entry::line(&class(index), name));
        if self.lines.len() > 1 { figure.with_legend(entries.collect()) } else { figure }
    }

    /// Axes on which a unit is as long up as across: the frame is some 2.4 times as wide as it is high.
    fn axes_of_plane(&self, (left, right): (f64, f64), (low, high): (f64, f64)) -> (Axis, Axis) {
        const WIDE: f64 = 2.4;
        let height = 1.1 * (high - low).max((right - left) / WIDE);
        let (middle, centre) = (f64::midpoint(left, right), f64::midpoint(low, high));
        let range = |centre: f64, size: f64| centre - 0.5 * size..centre + 0.5 * size;
        let across = Axis::linear(&self.labels[0], range(middle, WIDE * height));
        (across, Axis::linear(&self.labels[1], range(centre, height)))
    }
}

/// The class of a line: hues first, then dashes.
fn class(index: usize) -> String {
    format!("c{} d{}", index % HUE_COUNT, index / HUE_COUNT % DASH_COUNT)
}

/// The least and the greatest finite number; 0 and 1 of none.
fn span(numbers: impl Iterator<Item = f64>) -> (f64, f64) {
    let ends = numbers.filter(|x| x.is_finite()).fold(None, |ends: Option<(f64, f64)>, x| {
        Some(ends.map_or((x, x), |(low, high)| (low.min(x), high.max(x))))
    });
    ends.unwrap_or((0.0, 1.0))
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn every_line_and_limit_is_drawn_and_two_lines_have_a_legend() {
        let chart =
            LineChart::new(["x [mm]", "y [µm]"]).line("one", vec![(0.0, 1.0), (1.0, 3.0)]).limit(2.0, "most");
        let file = chart.drawn().named("n", "Title", "").file();
        assert!(file.contains("x [mm]") && file.contains("most") && !file.contains(">one<"), "{file}");
        let two = chart.line("two", vec![(0.0, -1.0), (1.0, 2.0)]).drawn().file();
        assert!(
            two.contains("one") && two.contains("two") && two.matches("class=\"line\"").count() >= 2,
            "{two}"
        );
    }

    #[test]
    fn a_unit_of_the_plane_is_as_long_up_as_across() {
        let chart = LineChart::new(["x [mm]", "y [mm]"]).of_plane();
        let (x, y) = chart.axes_of_plane((0.0, 300.0), (0.0, 300.0));
        assert!((x.range.end - x.range.start) / (y.range.end - y.range.start) == 2.4);
        assert!(y.range.start < 0.0 && y.range.end > 300.0);
    }
}
