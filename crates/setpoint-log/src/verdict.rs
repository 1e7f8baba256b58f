//! The verdict on each limit, from what setpoints take of it.
//!
//! Twice a limit M of order k shows over windows of w periods from `M (wT)ᵏ > 2ᵏ r` on, if it lasts as long.

use limit_judge::{LimitFinding, Of, StatedLimit, WINDOWS};

use crate::along_path::{Excess, OfPath};
use crate::findings::{JudgedLimit, LimitVerdict};
use crate::log_place::LogPlace;
use crate::machine_limits::LogLimit;

/// Motions keep the limits that a machine states up to their last digits.
const SLACK: f64 = 1e-6;

/// What is common to the verdicts on a log.
#[derive(Clone, Copy, Debug)]
pub(crate) struct Verdicts {
    pub(crate) begin_s: f64,
    pub(crate) period_s: f64,
    pub(crate) r_mm: f64,
}

impl Verdicts {
    /// On a limit by what was found; `at_corners` is what is found if every turn of the log may be a corner of the
    /// path, where that is not known.
    pub(crate) fn of(
        &self,
        limit: &LogLimit,
        found: &LimitFinding,
        at_corners: Option<&LimitFinding>,
    ) -> JudgedLimit {
        let is_kept = |found: &LimitFinding| found.taken.figure <= 1.0 + SLACK;
        let verdict = match is_kept(found) {
            _ if found.raw.at.is_none() => LimitVerdict::NotJudged,
            true if found.raw.figure <= 1.0 + SLACK => LimitVerdict::Kept,
            true => LimitVerdict::KeptWithin,
            false if at_corners.is_some_and(is_kept) => LimitVerdict::BrokenUnlessCorner,
            false => LimitVerdict::Broken,
        };
        let is_broken = matches!(verdict, LimitVerdict::Broken | LimitVerdict::BrokenUnlessCorner);
        let place = if is_broken { found.taken.at } else { found.raw.at };
        // A point that is off by r in each axis is off by √3 r.
        let spread = if limit.stated.of == Of::Vector { 3.0_f64.sqrt() } else { 1.0 };
        let is_open = verdict == LimitVerdict::KeptWithin;
        let seen_within_mm = found.seen_within_mm.filter(|_| is_open).unwrap_or(self.r_mm * spread) / spread;
        // No finer log shows what the deviation at corners hides.
        let decided_below_mm = found.decided_below_mm / spread - (seen_within_mm - self.r_mm).max(0.0);
        JudgedLimit {
            what: limit.stated.what(),
            axis: limit.axis(),
            limit: limit.value,
            unit: limit.unit(),
            verdict,
            raw: found.raw.figure,
            // Below 0 the resolution hides more than there is.
            taken: if found.taken.figure < 0.0 { 0.0 } else { found.taken.figure },
            periods: found.periods,
            at: place.map(|at| LogPlace::of(&at, self.begin_s, self.period_s)),
            seen_within_mm: is_open.then_some(seen_within_mm),
            decided_below_mm: (is_open && decided_below_mm > 0.0).then_some(decided_below_mm),
            twice_shows_over_periods: self
                .twice_shows_over(limit, spread * seen_within_mm)
                .filter(|_| is_open && found.decided_below_mm > 0.0),
            rows_of_a_period: limit.stated.order + 2,
        }
    }

    /// The least window over which twice the limit shows through `hidden_mm`, in periods, of those that are looked at.
    fn twice_shows_over(&self, limit: &LogLimit, hidden_mm: f64) -> Option<usize> {
        let order = i32::try_from(limit.stated.order + 1).ok()?;
        let most_mm = match (limit.stated.of, limit.stated.order) {
            // The limit of the feed is a share of the commanded one: here its value is needed.
            (Of::Vector, 0) => limit.value * self.period_s,
            _ => limit.stated.most,
        };
        let least = (2.0_f64.powi(order) * hidden_mm / most_mm).powf(1.0 / f64::from(order));
        (0..WINDOWS).map(|window| 1_usize << window).find(|periods| *periods as f64 > least)
    }

    /// On a limit along the path.
    pub(crate) fn along(&self, found: &OfPath) -> JudgedLimit {
        let power = i32::try_from(found.order + 1).unwrap_or(0);
        let value = found.most * self.period_s.powi(-power);
        let stated = StatedLimit { of: Of::Path, order: found.order, most: found.most };
        let (raw, is_kept) = (found.raw, found.raw.figure <= 1.0);
        let of = |taken: &Excess| LimitFinding {
            limit: stated,
            raw,
            taken: if is_kept { raw } else { taken.worst },
            periods: if is_kept { 1 } else { taken.periods },
            seen_within_mm: None,
            decided_below_mm: 0.0,
        };
        let limit = LogLimit { stated, value };
        let judged = self.of(&limit, &of(&found.excess), None);
        if judged.verdict != LimitVerdict::Broken {
            return judged;
        }
        // What is not certain is broken unless the path turns to and fro between two setpoints.
        match self.of(&limit, &of(&found.certain), None) {
            certain if certain.verdict == LimitVerdict::Broken => certain,
            _ => JudgedLimit { verdict: LimitVerdict::BrokenUnlessCorner, ..judged },
        }
    }
}
