//! How a log follows a part.

use serde::Serialize;

use crate::cruise::Fluctuation;
use crate::judged_tolerance::JudgedTolerance;
use crate::log_place::LogPlace;
use crate::off::Off;

/// How a log follows a part.
#[derive(Clone, Debug, Serialize)]
pub struct PartFindings {
    /// Moves of the part.
    pub moves: usize,
    /// The length of its path, rapid moves and all, in mm.
    pub length_mm: f64,
    /// The largest distance of setpoints of moves at feed from the path, wherever on it.
    pub nearest: Off,
    /// The same of rapid moves.
    pub nearest_rapid: Off,
    /// The largest distance between log and path in the order of both, all moves and what is skipped, in mm: the Fréchet distance is at most
    /// that.
    pub order_mm: f64,
    /// The largest distance of the path of moves at feed from the log, in mm.
    pub path_to_log_mm: f64,
    /// The largest distance that was asked for, in mm.
    #[serde(skip_serializing_if = "Option::is_none")]
    pub tolerance_mm: Option<f64>,
    /// How the tolerances that the part states are kept, the one that is used most first; none where one was asked for.
    #[serde(skip_serializing_if = "Vec::is_empty")]
    pub tolerances: Vec<JudgedTolerance>,
    /// The largest distance of a curve from the straight line between two places on it that the log has behind each
    /// other: what straight steps alone leave off the path, wherever the setpoints are. 0 where the part has no curves.
    pub chord_error: Off,
    /// The largest fluctuation of the feed at cruise, if the log has any.
    #[serde(skip_serializing_if = "Option::is_none")]
    pub fluctuation: Option<Fluctuation>,
    /// Parts of the path that the log skips.
    pub skipped: Vec<SkippedMoves>,
    /// How much of the path is left behind the end of the log, in mm.
    pub left_mm: f64,
    /// Where on the path the log ends, in mm from its begin.
    pub ends_at_mm: f64,
    /// How much of the path the log never visits, in mm: what it skips, and what is left.
    pub never_visited_mm: f64,
    /// The length of the log, in mm.
    pub log_mm: f64,
    /// The line in which the log ends.
    pub ends_in_line: usize,
    /// Lines whose commanded feed is exceeded, the worst first.
    pub over_feed: Vec<LineFeed>,
    /// The share of setpoints that are farther from the path than a hundredth of the part.
    pub far_share: f64,
    /// What the log would have to be scaled by to be as large as the part, where that is the ratio of two units.
    #[serde(skip_serializing_if = "Option::is_none")]
    pub unit_ratio: Option<f64>,
    #[serde(skip)]
    pub(crate) hidden_mm: f64,
}

/// Moves that a log skips.
#[derive(Clone, Copy, Debug, Serialize)]
pub struct SkippedMoves {
    /// The first and the last line of them.
    pub lines: [usize; 2],
    /// The length of the path that is skipped, in mm.
    pub length_mm: f64,
    /// The largest distance of what is skipped from where the log left the path, in mm.
    pub off_mm: f64,
}

/// The feed in a line.
#[derive(Clone, Copy, Debug, Serialize)]
pub struct LineFeed {
    /// The line of the part.
    pub line: usize,
    /// The commanded feed, in mm/s.
    pub commanded_mm_per_s: f64,
    /// The largest feed of a step, in mm/s.
    pub largest_mm_per_s: f64,
    /// Where.
    pub at: LogPlace,
}

/// The share of setpoints that are far from the path from which on the log is of another part.
const ANOTHER: f64 = 0.1;
/// A log that is longer than what it visits of the path by this did not just end early.
const LONGER: f64 = 1.5;
/// What is left of a path at its end, in mm, where no tolerance is given.
const LEFT_MM: f64 = 0.01;

impl PartFindings {
    /// Whether the log is of another part.
    #[must_use]
    pub fn is_another(&self) -> bool {
        self.far_share > ANOTHER || self.goes_elsewhere()
    }

    /// Whether the log visits less than half of the path, and goes farther than that.
    fn goes_elsewhere(&self) -> bool {
        let visited_mm = self.length_mm - self.never_visited_mm;
        visited_mm < 0.5 * self.length_mm && self.log_mm > LONGER * visited_mm + 2.0 * self.left_most_mm()
    }

    /// What may be left of the path.
    fn left_most_mm(&self) -> f64 {
        self.tolerance_mm.unwrap_or(LEFT_MM)
    }

    /// Whether some of the path is never visited.
    #[must_use]
    pub fn leaves_some(&self) -> bool {
        self.never_visited_mm > self.left_most_mm()
    }

    /// What is not as the part says, in short.
    pub(crate) fn faults(&self) -> Vec<String> {
        if self.is_another() {
            let unit = self.unit_ratio.map_or(String::new(), |ratio| {
                format!("; its size is that of the part times {ratio}, as of another unit: --units says that of the log, --part-units that of the part")
            });
            return vec![format!(
                "the log is of another part: {:.0} % of its setpoints are far from the path, up to {:.3} mm; of {:.3} mm of path it never visits {:.3} mm, and it ends in line {}{unit}",
                100.0 * self.far_share,
                self.nearest.mm.max(self.nearest_rapid.mm),
                self.length_mm,
                self.never_visited_mm,
                self.ends_in_line
            )];
        }
        let mut faults = Vec::new();
        for skip in &self.skipped {
            let [first, last] = skip.lines;
            faults.push(format!("lines {first} to {last} are skipped: {:.3} mm of the path", skip.length_mm));
        }
        if self.left_mm > self.left_most_mm() {
            faults.push(format!(
                "the log ends in line {}, {:.3} mm before the end",
                self.ends_in_line, self.left_mm
            ));
        }
        faults.extend(self.tolerances.iter().filter_map(JudgedTolerance::fault));
        if let Some(tolerance) = self.tolerance_mm {
            let most = tolerance * (1.0 + 1e-9) + self.hidden_mm;
            if self.nearest.mm > most {
                faults.push(format!(
                    "the log leaves the path by {:.6} mm in line {}",
                    self.nearest.mm, self.nearest.line
                ));
            } else if self.skipped.is_empty() && self.path_to_log_mm > most {
                faults.push(format!("the log cuts the path by {:.6} mm", self.path_to_log_mm));
            }
        }
        faults
    }
}
