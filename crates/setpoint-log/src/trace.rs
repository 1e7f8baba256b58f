//! What a picture shows of a log, in memory that does not grow with it.
//!
//! The log is cut into columns of equal numbers of periods. Each keeps the least and the greatest of every quantity,
//! where its first setpoint is, and the largest share of a limit that is taken in it beyond what the resolution hides:
//! of a k-th difference Δ that is `(|Δ| - 2ᵏ r) / M`, where r is greater for accelerations and jerks at a corner of which the
//! machine may cut some. Once there are too many columns, each two become one.

use limit_judge::{Of, StatedLimit};

/// Columns at most: some for each pixel of a picture.
const MOST_COLUMNS: usize = 1 << 13;

/// How many quantities a column has. Their order: the speed along the path in mm/s; the acceleration in mm/s² of X, Y
/// and Z; the jerk in mm/s³ of X, Y and Z.
pub const QUANTITIES: usize = 7;

/// The periods that a picture shows in one place.
#[derive(Clone, Debug, PartialEq)]
pub struct TraceColumn {
    /// The time of the first setpoint, in s.
    pub time_s: f64,
    /// Where it is, in mm.
    pub point_mm: [f64; 3],
    /// Whether the motion is seen from the column before to this one.
    pub follows: bool,
    /// The least and the greatest of each quantity; `None` where none was seen.
    pub extremes: [Option<[f64; 2]>; QUANTITIES],
    /// The largest share of a limit.
    pub share: f64,
    /// Its number: that of its first period over the present width of a column.
    index: u64,
}

/// The columns of a log so far.
#[derive(Clone, Debug)]
pub(crate) struct Trace {
    limits: Vec<StatedLimit>,
    period_s: f64,
    /// Periods of a column.
    width: u64,
    pub(crate) columns: Vec<TraceColumn>,
    /// The last points of the section, the latest first.
    behind: [Option<[f64; 3]>; 3],
    /// What corners hide of the steps to the last two of them, in mm.
    hidden_behind: [f64; 2],
}

/// A setpoint of a trace.
#[derive(Clone, Copy, Debug)]
pub(crate) struct TracePoint {
    pub(crate) period: u64,
    pub(crate) time_s: f64,
    pub(crate) point_mm: [f64; 3],
    /// The longest step that is commanded, in mm.
    pub(crate) feed_mm: f64,
    /// Whether the tool stands before it, at the begin of a section.
    pub(crate) stands_before: bool,
    pub(crate) r_mm: f64,
    /// What a corner hides that the step to it passes, in mm: 0 without one, and infinite where the velocity may jump there.
    pub(crate) at_corner_mm: f64,
}

impl Trace {
    pub(crate) fn new(limits: &[StatedLimit], period_s: f64) -> Self {
        Self {
            limits: limits.to_vec(),
            period_s,
            width: 1,
            columns: Vec::new(),
            behind: [None; 3],
            hidden_behind: [0.0; 2],
        }
    }

    /// Ends a section: no difference reaches over its end.
    pub(crate) fn end_section(&mut self) {
        (self.behind, self.hidden_behind) = ([None; 3], [0.0; 2]);
    }

    /// Takes the next setpoint.
    pub(crate) fn add(&mut self, next: TracePoint) {
        let follows = self.behind[0].is_some();
        if next.stands_before && !follows {
            self.behind = [Some(next.point_mm); 3];
        }
        let differences = differences(&next.point_mm, &self.behind);
        let quantities = self.quantities(&differences);
        let share = self.share(&differences, &next);
        self.behind = [Some(next.point_mm), self.behind[0], self.behind[1]];
        self.hidden_behind = [next.at_corner_mm, self.hidden_behind[0]];
        self.make_room(next.period);
        let index = next.period / self.width;
        let column = match self.columns.last_mut() {
            Some(last) if last.index == index => last,
            _ => {
                self.columns.push(TraceColumn {
                    time_s: next.time_s,
                    point_mm: next.point_mm,
                    follows,
                    extremes: [None; QUANTITIES],
                    share: 0.0,
                    index,
                });
                let last = self.columns.len() - 1;
                &mut self.columns[last]
            }
        };
        column.share = column.share.max(share);
        for (known, quantity) in column.extremes.iter_mut().zip(quantities) {
            *known = joined(*known, quantity.map(|value| [value; 2]));
        }
    }

    /// The quantities of differences, in the machine's units.
    fn quantities(&self, [step, second, third]: &[Option<[f64; 3]>; 3]) -> [Option<f64>; QUANTITIES] {
        let of = |axis: usize, order: i32| {
            let difference = if order == 2 { second } else { third };
            difference.map(|all| all[axis] / self.period_s.powi(order))
        };
        let speed = step.map(|[x, y, z]| x.hypot(y).hypot(z) / self.period_s);
        [speed, of(0, 2), of(1, 2), of(2, 2), of(0, 3), of(1, 3), of(2, 3)]
    }

    /// The largest share of a limit that differences take for certain.
    fn share(&self, differences: &[Option<[f64; 3]>; 3], next: &TracePoint) -> f64 {
        let [last, before] = self.hidden_behind;
        // A difference of velocities has two steps, one of accelerations three.
        let corner_mm = [0.0, next.at_corner_mm.max(last), next.at_corner_mm.max(last).max(before)];
        let of = |limit: &StatedLimit| {
            let all = differences[limit.order]?;
            let hidden_mm = (next.r_mm + corner_mm[limit.order]) * [2.0, 4.0, 8.0][limit.order];
            match (limit.of, limit.order) {
                (Of::Axis(axis), _) => Some((all[axis].abs() - hidden_mm) / limit.most),
                (Of::Vector, order) => {
                    let most = if order == 0 { limit.most * next.feed_mm } else { limit.most };
                    Some((all[0].hypot(all[1]).hypot(all[2]) - 3.0_f64.sqrt() * hidden_mm) / most)
                }
                (Of::Path | Of::Jump(_), _) => None,
            }
        };
        self.limits.iter().filter_map(of).fold(0.0, f64::max)
    }

    /// Widens the columns until a period is among those that there is room for.
    fn make_room(&mut self, period: u64) {
        while self.columns.len() >= MOST_COLUMNS
            && self.columns.last().is_some_and(|last| last.index != period / self.width)
        {
            self.width *= 2;
            let halved = std::mem::take(&mut self.columns).into_iter();
            for column in halved.map(|column| TraceColumn { index: column.index / 2, ..column }) {
                match self.columns.last_mut() {
                    Some(last) if last.index == column.index => last.join(&column),
                    _ => self.columns.push(column),
                }
            }
        }
    }
}

impl TraceColumn {
    /// Takes in the next column.
    fn join(&mut self, next: &Self) {
        self.share = self.share.max(next.share);
        for (own, other) in self.extremes.iter_mut().zip(next.extremes) {
            *own = joined(*own, other);
        }
    }
}

/// The first, second and third differences of a point and those behind it.
fn differences(here: &[f64; 3], behind: &[Option<[f64; 3]>; 3]) -> [Option<[f64; 3]>; 3] {
    let [b, c, d] = behind;
    let of = |difference: &dyn Fn(usize) -> f64| std::array::from_fn(difference);
    [
        b.map(|b| of(&|i| here[i] - b[i])),
        b.zip(*c).map(|(b, c)| of(&|i| (here[i] - b[i]) - (b[i] - c[i]))),
        b.zip(*c).zip(*d).map(|((b, c), d)| of(&|i| (here[i] - d[i]) - 3.0 * (b[i] - c[i]))),
    ]
}

/// The extremes of two.
fn joined(one: Option<[f64; 2]>, other: Option<[f64; 2]>) -> Option<[f64; 2]> {
    let (Some(a), Some(b)) = (one, other) else { return one.or(other) };
    Some([a[0].min(b[0]), a[1].max(b[1])])
}

#[cfg(test)]
mod tests {
    use super::*;

    fn traced(periods: u64, x: impl Fn(u64) -> f64) -> Trace {
        let limit = StatedLimit { of: Of::Axis(0), order: 1, most: 0.01 };
        let mut trace = Trace::new(&[limit], 1.0);
        for period in 0..periods {
            let (time_s, point_mm) = (period as f64, [x(period), 0.0, 0.0]);
            let (feed_mm, stands_before, r_mm) = (1.0, true, 0.0);
            trace.add(TracePoint {
                period,
                time_s,
                point_mm,
                feed_mm,
                stands_before,
                r_mm,
                at_corner_mm: 0.0,
            });
        }
        trace
    }

    /// At a corner of which the machine may cut 0.01 mm a motion that turns is not seen to break what the judge calls kept.
    #[test]
    fn a_corner_hides_what_may_be_cut_of_it() {
        let shares = |at_corner_mm: f64| {
            let mut trace = Trace::new(&[StatedLimit { of: Of::Axis(1), order: 1, most: 0.01 }], 1.0);
            for period in 0..20_u32 {
                let (x, y) = (f64::from(period.min(10)), f64::from(period.max(10) - 10));
                let (time_s, point_mm) = (f64::from(period), [0.02 * x, 0.02 * y, 0.0]);
                let at_corner_mm = if period == 11 { at_corner_mm } else { 0.0 };
                let (period, feed_mm, stands_before, r_mm) = (period.into(), 1.0, period == 0, 0.0);
                trace.add(TracePoint {
                    period,
                    time_s,
                    point_mm,
                    feed_mm,
                    stands_before,
                    r_mm,
                    at_corner_mm,
                });
            }
            trace.columns.iter().map(|column| column.share).fold(0.0, f64::max)
        };
        assert!((shares(0.0) - 2.0).abs() < 1e-9, "{}", shares(0.0));
        assert!(shares(0.01) < 1e-9 && shares(f64::INFINITY) < 1e-9, "{}", shares(0.01));
    }

    /// However long a log is, its trace has no more columns, and no extreme is lost.
    #[test]
    fn a_trace_has_every_extreme_and_a_bounded_number_of_columns() {
        for periods in [100, 20_000, 1_000_000] {
            let spike = periods / 2 + 1;
            let trace = traced(periods, |period| if period == spike { 0.5 } else { 0.0 });
            assert!(trace.columns.len() <= MOST_COLUMNS, "{}", trace.columns.len());
            let of = |quantity: usize| {
                let all = trace.columns.iter().filter_map(|column| column.extremes[quantity]);
                all.fold([0.0_f64; 2], |[low, high], [a, b]| [low.min(a), high.max(b)])
            };
            assert_eq!([of(0), of(1), of(4)], [[0.0, 0.5], [-1.0, 0.5], [-1.5, 1.5]], "{periods}");
            let worst: Vec<&TraceColumn> = trace.columns.iter().filter(|column| column.share > 1.0).collect();
            assert!(
                (1..=3).contains(&worst.len()) && worst.iter().any(|column| column.share == 100.0),
                "{worst:?}"
            );
            assert!(trace.columns.is_sorted_by_key(|column| column.time_s));
        }
    }

    /// A pause of a year makes no columns of its own.
    #[test]
    fn a_pause_takes_no_room() {
        let mut trace = traced(10, |_| 0.0);
        trace.end_section();
        let last = TracePoint {
            period: 30_000_000_000,
            time_s: 3e10,
            point_mm: [1.0; 3],
            feed_mm: 1.0,
            stands_before: true,
            r_mm: 0.0,
            at_corner_mm: 0.0,
        };
        trace.add(last);
        assert_eq!(
            (trace.columns.len(), trace.columns[10].follows, trace.columns[10].share),
            (11, false, 0.0)
        );
    }
}
