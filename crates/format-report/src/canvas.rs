//! The canvas of plotters: SVG elements with classes in place of colours, so that a page can theme them and a script
//! can find them.
//!
//! Plotters counts in whole pixels. Here its pixel is a tenth of a pixel, so that curves do not turn into stairs.

use std::cell::RefCell;
use std::convert::Infallible;
use std::fmt::Write;
use std::rc::Rc;

use plotters::style::RGBColor;
use plotters_backend::text_anchor::{HPos, VPos};
use plotters_backend::{
    BackendColor, BackendCoord, BackendStyle, BackendTextStyle, DrawingBackend, DrawingErrorKind,
    FontTransform,
};
use svg::Node;
use svg::node::element::{Circle, Group, Path, Rectangle, Text};

/// The number of plotters' pixels in a pixel.
pub(crate) const UNITS: i32 = 10;

/// A kind of line, area or text. Each is a class of the elements; plotters is given it as a colour, which it hands on.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub(crate) enum Pen {
    /// Axes and their ticks.
    Axis,
    /// Grid lines.
    Grid,
    /// The numbers of an axis.
    Tick,
    /// The label of an axis.
    Label,
    /// The line of a series, in the series' colour and dashes.
    Line,
    /// An area of a series.
    Fill,
    /// A limit.
    Limit,
    /// Words in a picture beside those of its axes.
    Note,
}

impl Pen {
    const ALL: [Self; 8] =
        [Self::Axis, Self::Grid, Self::Tick, Self::Label, Self::Line, Self::Fill, Self::Limit, Self::Note];

    fn class(self) -> &'static str {
        match self {
            Self::Axis => "axis",
            Self::Grid => "grid",
            Self::Tick => "tick",
            Self::Label => "label",
            Self::Line => "line",
            Self::Fill => "fill",
            Self::Limit => "limit",
            Self::Note => "note",
        }
    }

    /// The colour that stands for the pen in plotters.
    pub(crate) fn color(self) -> RGBColor {
        let place = Self::ALL.iter().position(|pen| *pen == self).unwrap_or(0);
        RGBColor(u8::try_from(place).unwrap_or(0), 0, 0)
    }

    fn of(color: BackendColor) -> Self {
        Self::ALL.get(usize::from(color.rgb.0)).copied().unwrap_or(Self::Axis)
    }
}

/// A picture in the making. Clones draw on the same one.
#[derive(Clone)]
pub(crate) struct Canvas {
    size: (u32, u32),
    groups: Rc<RefCell<Vec<Group>>>,
}

impl Canvas {
    /// An empty canvas of this size, in pixels.
    pub(crate) fn new(width: u32, height: u32) -> Self {
        let units = UNITS.unsigned_abs();
        Self { size: (width * units, height * units), groups: Rc::new(RefCell::new(vec![Group::new()])) }
    }

    /// Begins a group, which holds what is drawn until it ends.
    pub(crate) fn open(&self, group: Group) {
        self.groups.borrow_mut().push(group);
    }

    /// Ends the group that began last.
    pub(crate) fn close(&self) {
        let mut groups = self.groups.borrow_mut();
        if groups.len() > 1
            && let Some(inner) = groups.pop()
            && let Some(outer) = groups.last_mut()
        {
            outer.append(inner);
        }
    }

    /// Adds an element.
    pub(crate) fn add(&self, node: impl Into<Box<dyn Node>>) {
        if let Some(group) = self.groups.borrow_mut().last_mut() {
            group.append(node);
        }
    }

    /// All elements drawn.
    pub(crate) fn finish(self) -> Group {
        while self.groups.borrow().len() > 1 {
            self.close();
        }
        self.groups.borrow_mut().pop().unwrap_or_default()
    }
}

/// A length in pixels, written as briefly as possible.
pub(crate) fn pixels(units: i32) -> String {
    let (whole, tenths) = (units / UNITS, (units % UNITS).abs());
    let sign = if units < 0 && whole == 0 { "-" } else { "" };
    if tenths == 0 { format!("{sign}{whole}") } else { format!("{sign}{whole}.{tenths}") }
}

/// The data of a path through these points.
pub(crate) fn path_data(points: impl IntoIterator<Item = BackendCoord>) -> String {
    let mut data = String::new();
    for (index, (x, y)) in points.into_iter().enumerate() {
        let letter = if index == 0 { 'M' } else { 'L' };
        // Writing to a string cannot fail.
        let _ = write!(data, "{letter}{} {}", pixels(x), pixels(y));
    }
    data
}

type Drawn = Result<(), DrawingErrorKind<Infallible>>;

impl DrawingBackend for Canvas {
    type ErrorType = Infallible;

    fn get_size(&self) -> (u32, u32) {
        self.size
    }

    fn ensure_prepared(&mut self) -> Drawn {
        Ok(())
    }

    fn present(&mut self) -> Drawn {
        Ok(())
    }

    fn draw_pixel(&mut self, (x, y): BackendCoord, color: BackendColor) -> Drawn {
        self.draw_rect((x, y), (x + UNITS, y + UNITS), &color, true)
    }

    fn draw_line<S: BackendStyle>(&mut self, from: BackendCoord, to: BackendCoord, style: &S) -> Drawn {
        self.draw_path([from, to], style)
    }

    fn draw_rect<S: BackendStyle>(
        &mut self,
        (left, top): BackendCoord,
        (right, bottom): BackendCoord,
        style: &S,
        _fill: bool,
    ) -> Drawn {
        self.add(
            Rectangle::new()
                .set("class", Pen::of(style.color()).class())
                .set("x", pixels(left.min(right)))
                .set("y", pixels(top.min(bottom)))
                .set("width", pixels((right - left).abs()))
                .set("height", pixels((bottom - top).abs())),
        );
        Ok(())
    }

    fn draw_path<S: BackendStyle, I: IntoIterator<Item = BackendCoord>>(
        &mut self,
        path: I,
        style: &S,
    ) -> Drawn {
        if style.color().alpha == 0.0 {
            return Ok(());
        }
        self.add(Path::new().set("class", Pen::of(style.color()).class()).set("d", path_data(path)));
        Ok(())
    }

    fn draw_circle<S: BackendStyle>(
        &mut self,
        (x, y): BackendCoord,
        radius: u32,
        style: &S,
        _fill: bool,
    ) -> Drawn {
        self.add(
            Circle::new()
                .set("class", Pen::of(style.color()).class())
                .set("cx", pixels(x))
                .set("cy", pixels(y))
                .set("r", f64::from(radius) / f64::from(UNITS)),
        );
        Ok(())
    }

    fn fill_polygon<S: BackendStyle, I: IntoIterator<Item = BackendCoord>>(
        &mut self,
        corners: I,
        style: &S,
    ) -> Drawn {
        let data = path_data(corners) + "z";
        self.add(Path::new().set("class", Pen::of(style.color()).class()).set("d", data));
        Ok(())
    }

    fn draw_text<T: BackendTextStyle>(&mut self, text: &str, style: &T, (x, y): BackendCoord) -> Drawn {
        if text.is_empty() {
            return Ok(());
        }
        let anchor = style.anchor();
        let along = match anchor.h_pos {
            HPos::Left => "start",
            HPos::Center => "middle",
            HPos::Right => "end",
        };
        // The shift from the given place down to the base line, in heights of a letter.
        let down = match anchor.v_pos {
            VPos::Top => "0.8em",
            VPos::Center => "0.35em",
            VPos::Bottom => "-0.45em",
        };
        let mut element = Text::new(text)
            .set("class", Pen::of(style.color()).class())
            .set("x", pixels(x))
            .set("y", pixels(y))
            .set("dy", down)
            .set("text-anchor", along);
        let turn = match style.transform() {
            FontTransform::None => 0,
            FontTransform::Rotate90 => 90,
            FontTransform::Rotate180 => 180,
            FontTransform::Rotate270 => 270,
        };
        if turn != 0 {
            element = element.set("transform", format!("rotate({turn} {} {})", pixels(x), pixels(y)));
        }
        self.add(element);
        Ok(())
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn lengths_are_written_short_and_right() {
        let written: Vec<_> = [0, 5, 10, 123, -5, -123].map(pixels).into();
        assert_eq!(written, ["0", "0.5", "1", "12.3", "-0.5", "-12.3"]);
    }

    #[test]
    fn a_group_holds_what_is_drawn_in_it() {
        let canvas = Canvas::new(10, 10);
        canvas.open(Group::new().set("class", "series"));
        canvas.clone().draw_path([(0, 0), (15, 20)], &colored(Pen::Line)).expect("a canvas takes all");
        let text = canvas.finish().to_string();
        let flat: String = text.lines().collect();
        assert!(flat.contains(r#"<g class="series"><path class="line" d="M0 0L1.5 2"/></g>"#), "{text}");
    }

    fn colored(pen: Pen) -> BackendColor {
        let color = pen.color();
        BackendColor { alpha: 1.0, rgb: (color.0, color.1, color.2) }
    }
}
