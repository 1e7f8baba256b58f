//! A distance between log and path.

use serde::Serialize;

use crate::log_place::LogPlace;

/// A distance, and where it is.
#[derive(Clone, Copy, Debug, Default, Serialize)]
pub struct Off {
    /// In mm.
    pub mm: f64,
    /// Where.
    #[serde(skip_serializing_if = "Option::is_none")]
    pub at: Option<LogPlace>,
    /// The line of the part.
    pub line: usize,
}
