//! What is asked of curves in place of moves.

/// What is asked of the curves.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct FitOptions {
    /// Largest distance of the curves from the moves, both ways, in mm.
    pub tolerance_mm: f64,
    /// A change of direction above this, in degrees, is a corner, and stays.
    pub corner_deg: f64,
    /// Whether a curve passes every point between its moves, or only as many as keep it within the tolerance.
    pub every_point: bool,
}

impl FitOptions {
    /// Within a tolerance in mm, through no more points than that takes; corners are changes of direction above 30°. Chords of a small circle turn by 15°, say,
    /// those of outlines at their corners by 45° and more.
    #[must_use]
    pub fn within(tolerance_mm: f64) -> Self {
        Self { tolerance_mm, corner_deg: 30.0, every_point: false }
    }
}
