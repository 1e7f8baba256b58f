//! What the profile `flexible` decides, for people to read.

use feed_plan::{EndFeeds, KeptApart, MergeVerdict, merge_verdicts};
use serde::Serialize;

use crate::problem::problem::Problem;
use crate::refusal::Refusal;

/// A stretch on which acceleration and deceleration follow each other, and whether one half-cosine replaces them.
#[derive(Clone, Debug, Serialize)]
pub struct MergeRow {
    /// Number of the curve on which it begins, from 0.
    pub curve: usize,
    /// Parameter on that curve.
    pub u: f64,
    /// Distance from the start of the path, in mm.
    pub start_mm: f64,
    /// Length, in mm. If nothing is merged, it is that of the shortest stretch that was tried.
    pub length_mm: f64,
    /// Feed at its start, in mm/s.
    pub start_feed_mm_per_s: f64,
    /// Feed at its end, in mm/s.
    pub end_feed_mm_per_s: f64,
    /// How many accelerations and decelerations it holds.
    pub transitions: usize,
    /// What they would become: `acceleration`, `deceleration` or `constant`.
    pub becomes: &'static str,
    /// Whether one half-cosine, or a constant feed, replaces them.
    pub merged: bool,
    /// Its time, in s, if so.
    pub time_s: Option<f64>,
    /// Why not, if not: what the half-cosine would break.
    pub why_not: Option<String>,
}

impl MergeRow {
    /// The decisions along a path, in order. Places and times are those before the plan is stretched to whole periods.
    ///
    /// # Errors
    /// [`Refusal::Plan`] where the path cannot be planned.
    pub fn all<const D: usize>(
        problem: &Problem<D>,
        end_feeds_mm_per_s: [f64; 2],
    ) -> Result<Vec<Self>, Refusal> {
        let (limit, limits, t) = (problem.feed_limit()?, problem.limits_per_period()?, problem.period_s());
        let [start, end] = end_feeds_mm_per_s.map(|feed| feed * t);
        let verdicts = merge_verdicts(&limit, &limits, EndFeeds { start, end })?;
        Ok(verdicts
            .iter()
            .map(|verdict| Self::of(verdict, t, limit.parameter_at(verdict.stretch.start)))
            .collect())
    }

    fn of(verdict: &MergeVerdict<f64>, t: f64, (curve, u): (usize, f64)) -> Self {
        let stretch = &verdict.stretch;
        let (from, to) = (stretch.start_feed, stretch.end_feed);
        Self {
            curve,
            u,
            start_mm: stretch.start,
            length_mm: stretch.length,
            start_feed_mm_per_s: from / t,
            end_feed_mm_per_s: to / t,
            transitions: verdict.transitions,
            becomes: match from.total_cmp(&to) {
                std::cmp::Ordering::Less => "acceleration",
                std::cmp::Ordering::Equal => "constant",
                std::cmp::Ordering::Greater => "deceleration",
            },
            merged: verdict.outcome.is_ok(),
            time_s: verdict.outcome.ok().map(|time| time * t),
            why_not: verdict.outcome.err().map(|why| why_not(why, t)),
        }
    }
}

fn why_not(why: KeptApart<f64>, t: f64) -> String {
    match why {
        KeptApart::Rest => "the stretch begins and ends at rest".to_string(),
        KeptApart::Acceleration(times) => format!("{times:.2} times the acceleration"),
        KeptApart::Jerk(times) => format!("{times:.2} times the jerk"),
        KeptApart::Time(times) => format!("{times:.2} times the time"),
        KeptApart::Limit { distance, feed, limit } => {
            format!("{:.1} mm/s at {distance:.2} mm, where {:.1} are allowed", feed / t, limit / t)
        }
    }
}
