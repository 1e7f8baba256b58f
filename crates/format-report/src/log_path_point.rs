//! A place on the path of a log.

/// A place on the path of a log.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct LogPathPoint {
    /// Where, in mm.
    pub point_mm: [f64; 3],
    /// The time, in s.
    pub time_s: f64,
    /// Whether the motion is seen from the place before to this one.
    pub follows: bool,
    /// The largest share of a limit that is taken from here to the next place.
    pub share: f64,
}
