//! A picture with two axes, and the elements that can be drawn between them.

use std::ops::Range;

use plotters::chart::{ChartBuilder, ChartContext};
use plotters::coord::Shift;
use plotters::coord::cartesian::Cartesian2d;
use plotters::coord::ranged1d::{BoldPoints, DefaultFormatting, KeyPointHint, Ranged};
use plotters::coord::types::RangedCoordf64;
use plotters::drawing::{DrawingArea, IntoDrawingArea};
use plotters::element::{PathElement, Text};
use plotters::style::text_anchor::{HPos, Pos, VPos};
use plotters::style::{IntoFont, TextStyle};
use svg::node::element::{Group, Path, Title};

use crate::canvas::{Canvas, Pen, UNITS, path_data, pixels};
use crate::envelope::envelope;
use crate::figure::Figure;
use crate::number;

/// Width of every picture, in pixels.
pub(crate) const WIDTH: u32 = 760;

/// One axis.
#[derive(Clone, Debug)]
pub(crate) struct Axis {
    /// The quantity, with its unit.
    pub(crate) label: String,
    /// The least and the greatest value.
    pub(crate) range: Range<f64>,
    /// Whether the axis is logarithmic: equal ratios are equally long.
    pub(crate) logarithmic: bool,
    /// Names in place of numbers, at 0, 1, 2, …
    pub(crate) names: Vec<String>,
}

impl Axis {
    /// A linear axis.
    pub(crate) fn linear(label: &str, range: Range<f64>) -> Self {
        let wide = if range.end > range.start { range } else { range.start - 0.5..range.start + 0.5 };
        Self { label: label.to_string(), range: wide, logarithmic: false, names: Vec::new() }
    }

    /// A linear axis over all of `values` and over zero.
    pub(crate) fn over(label: &str, values: impl IntoIterator<Item = f64>) -> Self {
        let finite = values.into_iter().filter(|x| x.is_finite());
        let (low, high) = finite.fold((0.0_f64, 0.0_f64), |(low, high), x| (low.min(x), high.max(x)));
        let air = 0.04 * (high - low);
        Self::linear(label, if low < 0.0 { low - air } else { 0.0 }..high + air)
    }

    /// A logarithmic axis of whole decades over the positive ones of `values`. Of more than `decades` decades, the
    /// greatest are kept.
    pub(crate) fn decades(label: &str, values: impl IntoIterator<Item = f64>, decades: i32) -> Self {
        let finite = values.into_iter().filter(|x| *x > 0.0 && x.is_finite()).map(f64::log10);
        let (low, high) = finite.fold((f64::INFINITY, f64::NEG_INFINITY), |(l, h), x| (l.min(x), h.max(x)));
        let (low, high) = if low <= high { (low.floor(), high.ceil()) } else { (-1.0, 0.0) };
        let low = low.max(high - f64::from(decades));
        let high = if high > low { high } else { low + 1.0 };
        let range = 10.0_f64.powf(low)..10.0_f64.powf(high);
        Self { label: label.to_string(), range, logarithmic: true, names: Vec::new() }
    }

    /// An axis of names. Each takes half a unit on both sides of its number; the first is on top or at the left.
    pub(crate) fn of_names(label: &str, names: Vec<String>) -> Self {
        let range = -0.5..names.len() as f64 - 0.5;
        Self { label: label.to_string(), range, logarithmic: false, names }
    }

    /// The place of a value for plotters: its logarithm on a logarithmic axis. A value beyond the range is put on the
    /// edge.
    fn place(&self, value: f64) -> f64 {
        let value = if self.range.start < self.range.end {
            value.max(self.range.start).min(self.range.end)
        } else {
            value
        };
        if self.logarithmic { value.log10() } else { value }
    }

    fn coordinate(&self, most: usize) -> Scale {
        let (start, end) = (self.place(self.range.start), self.place(self.range.end));
        let plain: RangedCoordf64 = (start..end).into();
        let ticks: Vec<f64> = if !self.names.is_empty() {
            (0..self.names.len()).map(|place| place as f64).collect()
        } else if self.logarithmic {
            let every = ((end - start) / most as f64).ceil().max(1.0);
            let count = ((end - start) / every).floor();
            (0..=most).map(|i| i as f64).filter(|i| *i <= count).map(|i| start + i * every).collect()
        } else {
            plain.key_points(BoldPoints(most))
        };
        Scale { linear: plain, range: start..end, ticks }
    }

    fn tick(&self, place: f64, step: f64) -> String {
        if self.names.is_empty() {
            if self.logarithmic { number::power_of_ten(place) } else { number::tick(place, step) }
        } else {
            self.names
                .iter()
                .enumerate()
                .find(|(at, _)| (*at as f64 - place).abs() < 0.25)
                .map_or_else(String::new, |(_, name)| name.clone())
        }
    }

    /// The axis for the page's script: the range, and whether it is logarithmic.
    fn described(&self) -> String {
        format!(
            "{} {} {}",
            self.place(self.range.start),
            self.place(self.range.end),
            u8::from(self.logarithmic)
        )
    }
}

/// The layout of a picture.
#[derive(Clone, Debug)]
pub(crate) struct Layout {
    /// Height in pixels.
    pub(crate) height: u32,
    /// Space for the vertical axis, in pixels.
    pub(crate) left: u32,
    /// Whether y grows downwards, as in a list of names.
    pub(crate) from_top: bool,
}

impl Default for Layout {
    fn default() -> Self {
        Self { height: 330, left: 66, from_top: false }
    }
}

/// An axis in the form that plotters needs. Its ticks are where the axis has them, not where plotters would put them.
#[derive(Clone)]
struct Scale {
    linear: RangedCoordf64,
    range: Range<f64>,
    ticks: Vec<f64>,
}

impl Ranged for Scale {
    type FormatOption = DefaultFormatting;
    type ValueType = f64;

    fn map(&self, value: &f64, limit: (i32, i32)) -> i32 {
        self.linear.map(value, limit)
    }

    fn key_points<Hint: KeyPointHint>(&self, _hint: Hint) -> Vec<f64> {
        self.ticks.clone()
    }

    fn range(&self) -> Range<f64> {
        self.range.clone()
    }
}

type Coordinates = Cartesian2d<Scale, Scale>;

/// The picture that a figure draws on.
pub(crate) struct Plot<'a> {
    canvas: Canvas,
    chart: ChartContext<'a, Canvas, Coordinates>,
    x: Axis,
    y: Axis,
}

/// Draws a figure: the axes, and between them what `content` draws.
pub(crate) fn draw((x, y): (Axis, Axis), layout: &Layout, content: impl FnOnce(&mut Plot<'_>)) -> Figure {
    let canvas = Canvas::new(WIDTH, layout.height);
    let area = canvas.clone().into_drawing_area();
    let Some((chart, frame)) = axes(&area, &x, &y, layout) else {
        return Figure::empty(WIDTH, layout.height);
    };
    let described = (format!("{frame} {}", x.described()), y.described());
    let mut plot = Plot { canvas: canvas.clone(), chart, x, y };
    content(&mut plot);
    Figure::new(WIDTH, layout.height, canvas.finish(), described)
}

/// Draws the axes with their grid. Returns the frame's left, right, top and bottom in pixels. A canvas accepts
/// everything, so plotters fails only on a frame without area.
fn axes<'a>(
    area: &'a DrawingArea<Canvas, Shift>,
    x: &Axis,
    y: &Axis,
    layout: &Layout,
) -> Option<(ChartContext<'a, Canvas, Coordinates>, String)> {
    let units = |px: u32| i32::try_from(px).unwrap_or(i32::MAX / UNITS) * UNITS;
    let rows = if y.names.is_empty() { (layout.height / 42) as usize } else { y.names.len() };
    let mut builder = ChartBuilder::on(area);
    builder
        .margin_top(units(12))
        .margin_right(units(18))
        .margin_bottom(units(4))
        .margin_left(units(4))
        .x_label_area_size(units(44))
        .y_label_area_size(units(layout.left));
    let (across, mut up) = (x.coordinate(9), y.coordinate(rows.max(3)));
    if layout.from_top {
        up.range = up.range.end..up.range.start;
        up.linear = up.range.clone().into();
    }
    let step = |ticks: &[f64]| if let [a, b, ..] = ticks { (b - a).abs() } else { 1.0 };
    let (x_step, y_step) = (step(&across.ticks), step(&up.ticks));
    let labels = (across.ticks.len().max(1), up.ticks.len().max(1));
    let mut chart = builder.build_cartesian_2d(across, up).ok()?;
    let (tick, label) = (Pen::Tick.color(), Pen::Label.color());
    let text = || TextStyle::from(("sans-serif", 12 * UNITS).into_font());
    chart
        .configure_mesh()
        .x_labels(labels.0)
        .y_labels(labels.1)
        .max_light_lines(0)
        .light_line_style(plotters::style::TRANSPARENT)
        .bold_line_style(Pen::Grid.color())
        .axis_style(Pen::Axis.color())
        .label_style(text().color(&tick))
        .axis_desc_style(text().color(&label))
        .set_all_tick_mark_size(4 * UNITS)
        .x_label_formatter(&|place| x.tick(*place, x_step))
        .y_label_formatter(&|place| y.tick(*place, y_step))
        .x_desc(x.label.as_str())
        .y_desc(y.label.as_str())
        .draw()
        .ok()?;
    let (horizontal, vertical) = chart.plotting_area().get_pixel_range();
    let frame = [horizontal.start, horizontal.end, vertical.start, vertical.end].map(pixels).join(" ");
    Some((chart, frame))
}

impl Plot<'_> {
    /// Groups the elements that `content` draws: one format's series, or one limit. `class` is the class of the group;
    /// `tip` is shown when the pointer is on it.
    pub(crate) fn group(&mut self, class: &str, name: &str, content: impl FnOnce(&mut Self)) {
        let mut group = Group::new().set("class", class);
        if !name.is_empty() {
            group = group.set("data-name", name);
        }
        self.canvas.open(group);
        content(self);
        self.canvas.close();
    }

    /// A line through points that are sorted by x, thinned to what the pixels show.
    pub(crate) fn line(&mut self, points: &[(f64, f64)]) {
        let placed: Vec<_> = points.iter().map(|(x, y)| (self.x.place(*x), self.y.place(*y))).collect();
        let range = (self.x.place(self.x.range.start), self.x.place(self.x.range.end));
        let shown = envelope(&placed, range, WIDTH as usize);
        self.draw(PathElement::new(shown, Pen::Line.color()));
    }

    /// Lines through points in any order, with one tip.
    pub(crate) fn trails(&mut self, class: &str, lines: &[&[(f64, f64)]], tip: &str) {
        let line = |points: &&[(f64, f64)]| path_data(points.iter().map(|(x, y)| self.pixel(*x, *y)));
        let data: String = lines.iter().map(line).collect();
        self.canvas.add(tipped(Path::new().set("class", class).set("d", data), tip));
    }

    /// A mark at a point, with a tip.
    pub(crate) fn mark(&mut self, (x, y): (f64, f64), shape: usize, tip: &str) {
        let (x, y) = self.pixel(x, y);
        let r = 5 * UNITS;
        let corners: &[(i32, i32)] = match shape % 4 {
            0 => &[(-r, -r), (r, -r), (r, r), (-r, r)],
            1 => &[(0, -r - 10), (r + 10, 0), (0, r + 10), (-r - 10, 0)],
            2 => &[(0, -r - 10), (r + 5, r), (-r - 5, r)],
            _ => &[(-r - 5, -r), (r + 5, -r), (0, r + 10)],
        };
        let data = path_data(corners.iter().map(|(dx, dy)| (x + dx, y + dy))) + "z";
        self.canvas.add(tipped(Path::new().set("class", "mark").set("d", data), tip));
    }

    /// Boxes of one area, each `[x from, x to, y from, y to]`, with one tip.
    pub(crate) fn boxes(&mut self, class: &str, boxes: &[[f64; 4]], tip: &str) {
        let corners = boxes.iter().map(|[left, right, from, to]| {
            let ((left, from), (right, to)) = (self.pixel(*left, *from), self.pixel(*right, *to));
            path_data([(left, from), (right, from), (right, to), (left, to)]) + "z"
        });
        let data: String = corners.collect();
        self.canvas.add(tipped(Path::new().set("class", class).set("d", data), tip));
    }

    /// A limit across the picture at `y`, with its name.
    pub(crate) fn limit(&mut self, y: f64, name: &str) {
        if y < self.y.range.start || y > self.y.range.end {
            return;
        }
        let ends = [self.x.range.start, self.x.range.end].map(|x| (self.x.place(x), self.y.place(y)));
        self.draw(PathElement::new(ends.to_vec(), Pen::Limit.color()));
        self.note((self.x.range.end, y), (HPos::Right, VPos::Bottom), name);
    }

    /// A limit from bottom to top at `x`.
    pub(crate) fn upright(&mut self, x: f64) {
        let ends = [self.y.range.start, self.y.range.end].map(|y| (self.x.place(x), self.y.place(y)));
        self.draw(PathElement::new(ends.to_vec(), Pen::Limit.color()));
    }

    /// Words at a point.
    pub(crate) fn note(&mut self, (x, y): (f64, f64), anchor: (HPos, VPos), text: &str) {
        let color = Pen::Note.color();
        let style = TextStyle::from(("sans-serif", 11 * UNITS).into_font())
            .color(&color)
            .pos(Pos::new(anchor.0, anchor.1));
        self.draw(Text::new(text.to_string(), (self.x.place(x), self.y.place(y)), style));
    }

    fn pixel(&self, x: f64, y: f64) -> (i32, i32) {
        self.chart.backend_coord(&(self.x.place(x), self.y.place(y)))
    }

    fn draw<E>(&mut self, element: E)
    where
        for<'b> &'b E: plotters::element::PointCollection<'b, (f64, f64)>,
        E: plotters::element::Drawable<Canvas>,
    {
        // A canvas accepts everything that is drawn.
        let _ = self.chart.draw_series(std::iter::once(element));
    }
}

fn tipped(path: Path, tip: &str) -> Path {
    if tip.is_empty() { path } else { path.add(Title::new(tip)) }
}
