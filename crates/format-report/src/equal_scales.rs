//! A path as a picture: as long a millimetre across as up.

use crate::chart::{Axis, WIDTH};

/// Most points of all pictures of the path together: a page with so many is about a megabyte.
pub(crate) const MOST_POINTS: usize = 60_000;

/// Axes with equal scales, the height that they need, and the size of a pixel in mm.
pub(crate) fn equal_scales(points: &[(f64, f64)], x: &str, y: &str) -> ((Axis, Axis), u32, f64) {
    let bounds = |of: fn(&(f64, f64)) -> f64| {
        let ends =
            points.iter().map(of).fold((f64::INFINITY, f64::NEG_INFINITY), |(l, h), v| (l.min(v), h.max(v)));
        (0.5 * (ends.0 + ends.1), ends.1 - ends.0)
    };
    let ((x_middle, x_size), (y_middle, y_size)) = (bounds(|p| p.0), bounds(|p| p.1));
    // The frame is as wide as the picture less the vertical axis and the margins, and as high as it less the horizontal
    // axis.
    let (frame_width, least, most) = (f64::from(WIDTH) - 92.0, 160.0, 520.0);
    let x_room = (1.1 * x_size).max(1e-6);
    let y_room = (1.1 * y_size).max(1e-6);
    let frame_height = (frame_width * y_room / x_room).clamp(least, most);
    let per_pixel = (x_room / frame_width).max(y_room / frame_height);
    let half = |pixels: f64| 0.5 * per_pixel * pixels;
    let (across, up) = (half(frame_width), half(frame_height));
    let axes = (
        Axis::linear(x, x_middle - across..x_middle + across),
        Axis::linear(y, y_middle - up..y_middle + up),
    );
    #[allow(clippy::cast_possible_truncation, clippy::cast_sign_loss, reason = "between 160 and 520")]
    let height = frame_height as u32 + 60;
    (axes, height, per_pixel)
}
