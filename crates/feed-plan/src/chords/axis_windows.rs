//! Where the setpoints of a run show that an axis takes more acceleration or jerk than it may.
//!
//! The k-th derivative of a motion is at most M. Then the k-th difference of its places, seen h apart, is at most `M hᵏ`, and that of
//! setpoints within r of the motion is at most `M hᵏ + 2ᵏ r`. This is looked at over windows of 1, 2, 4, … periods; where no difference
//! over single periods exceeds `M hᵏ`, none over wider windows does, for it is a sum of these.

use alloc::vec::Vec;
use core::ops::Range;

use real::Real;

use crate::cube_root::cube_root;
use crate::limit::axis_budget::Allowance;
use crate::limit::too_fast::{Slower, TooFast};
use crate::{Junction, KinematicLimits};

/// Windows are up to 2⁸ periods wide.
const WINDOWS: i32 = 9;
/// Setpoints that the widest third difference spans.
pub(super) const SPAN: usize = 3 * (1 << (WINDOWS - 1)) + 1;
/// An excess of less than 2⁻¹⁷ is ignored, and feeds are lowered to 2⁻⁸ below what is allowed.
const SEEN: i32 = -17;
const BELOW: i32 = -8;

/// A setpoint of a run.
pub(super) struct Setpoint<R, const D: usize> {
    pub(super) point: [R; D],
    /// Its distance from the path's start.
    pub(super) distance: R,
    /// How many steps of the section up to it pass a corner, or begin or end at one.
    pub(super) corners: usize,
}

/// The setpoints of a section.
pub(super) struct AxisWindows<'a, R, const D: usize> {
    pub(super) setpoints: &'a [Setpoint<R, D>],
    /// Whether the section begins and ends at rest: then the tool stands before it and after it.
    pub(super) rests: [bool; 2],
    /// By how much rounding may move a setpoint.
    pub(super) rounding: R,
    pub(super) limits: &'a KinematicLimits<R>,
}

/// The places of one difference.
#[derive(Clone, Copy)]
struct Window {
    /// The order of the difference.
    order: usize,
    /// The periods from one place to the next.
    width: usize,
    /// The number of the last place; beyond the last setpoint the tool stands.
    end: usize,
}

/// The order of a difference as a power of two.
fn exponent(order: usize) -> i32 {
    if order == 2 { 2 } else { 3 }
}

impl Window {
    /// The number of the place that is `back` widths before the end, in a section whose last setpoint is `last`.
    fn setpoint(&self, back: usize, last: usize) -> usize {
        self.end.saturating_sub(back * self.width).min(last)
    }
}

impl<R: Real, const D: usize> AxisWindows<'_, R, D> {
    /// The ways over which an axis takes too much.
    pub(super) fn too_fast(&self) -> Vec<TooFast<R>> {
        let mut found = Vec::new();
        for (axis, limits) in self.limits.axes.iter().enumerate().take(D) {
            for (order, most) in [(2, limits.acceleration), (3, limits.jerk)] {
                if let Some(most) = most {
                    self.of_limit(axis, order, most, &mut found);
                }
            }
        }
        found
    }

    /// Adds the ways over which the derivative of this order exceeds its limit: windows of one width that follow each other are one.
    fn of_limit(&self, axis: usize, order: usize, most: R, found: &mut Vec<TooFast<R>>) {
        let period = self.limits.interpolation_period;
        let single = (0..order).fold(most, |bound, _| bound * period);
        // How many differences over single periods exceed the limit up to each end.
        let (mut count, singles) = (0_usize, self.ends(order, 1));
        let first = singles.start;
        let counts: Vec<usize> = singles
            .map(|end| {
                count += usize::from(self.difference(axis, Window { order, width: 1, end }) > single);
                count
            })
            .collect();
        let count_to = |end: Option<usize>| {
            let index = end.and_then(|end| end.checked_sub(first)).map(|index| index.min(counts.len() - 1));
            index.and_then(|index| counts.get(index)).copied().unwrap_or(0)
        };
        if count == 0 {
            return;
        }
        for power in 0..WINDOWS {
            let (width, bound) = (1_usize << power, single.ldexp(power * exponent(order)));
            let mut run: Option<(Window, usize, R)> = None;
            for end in self.ends(order, width) {
                let window = Window { order, width, end };
                let has_any = count_to(Some(end)) > count_to(end.checked_sub(order * (width - 1) + 1));
                let hidden = has_any.then(|| self.hidden(window)).flatten();
                let excess = hidden
                    .map(|hidden| (self.difference(axis, window) - hidden.ldexp(exponent(order))) / bound);
                let excess = excess.filter(|excess| *excess > R::one() + R::one().ldexp(SEEN));
                run = match (run, excess) {
                    (Some((first, _, most)), Some(excess)) => Some((first, end, most.max(excess))),
                    (None, Some(excess)) => Some((window, end, excess)),
                    (run, None) => {
                        run.into_iter().for_each(|run| self.slower(run, found));
                        None
                    }
                };
            }
            run.into_iter().for_each(|run| self.slower(run, found));
        }
    }

    /// Adds the way of successive windows, of which the worst takes `excess` times the limit. A motion that is slower by a share takes the
    /// second power of it of each acceleration, the third of each jerk. Where the feed changes much in the windows, it is to change more
    /// slowly, and corners in them are to be passed more slowly too: what a corner takes of a limit is not less for a change of feed that is.
    fn slower(&self, (first, end, excess): (Window, usize, R), found: &mut Vec<TooFast<R>>) {
        let root = if first.order == 2 { excess.sqrt() } else { cube_root(excess) };
        let share = (R::one() - R::one().ldexp(BELOW)) / root;
        let longer = R::one() / share;
        let last = Window { end, ..first };
        let [from, to] = [first.setpoint(first.order, self.last()), last.setpoint(0, self.last())];
        let steps = self.setpoints.get(from..=to).unwrap_or_default().windows(2);
        let way_of = |pair: &[Setpoint<R, D>]| pair[1].distance - pair[0].distance;
        let highest = steps.clone().map(way_of).fold(R::zero(), R::max);
        let slowest = steps.clone().map(way_of).fold(highest, R::min);
        let [from, to] = [self.setpoint(first, first.order).distance, self.setpoint(last, 0).distance];
        let way = self.setpoint(first, 0).distance - from;
        let to_feed = share / self.limits.interpolation_period;
        let (feed, at_corners) = (highest * to_feed, slowest * to_feed);
        if slowest >= highest.half() {
            found.push(TooFast { from, to, way, longer, slower: Slower::Feed { feed, at_corners } });
            return;
        }
        let square = share * share;
        let shares = Allowance { acceleration: square, jerk: square * share };
        let changes = Slower::Changes { most: Allowance::of_path(self.limits), shares };
        let all = Slower::Feed { feed, at_corners: feed };
        found.extend([changes, all].map(|slower| TooFast { from, to, way, longer, slower }));
        found.extend(steps.filter(|pair| pair[1].corners > pair[0].corners).map(|pair| {
            let [from, to] = [pair[0].distance, pair[1].distance];
            TooFast {
                from,
                to,
                way,
                longer,
                slower: Slower::Feed { feed, at_corners: (to - from) * to_feed },
            }
        }));
    }

    /// The last setpoints of windows of this width; beyond the section's ends the tool stands, or nothing is known.
    fn ends(&self, order: usize, width: usize) -> Range<usize> {
        let (count, span) = (self.setpoints.len(), order * width);
        let begin = if self.rests[0] { width } else { span };
        let end = if self.rests[1] { count + span - width } else { count };
        begin..end.max(begin)
    }

    fn last(&self) -> usize {
        self.setpoints.len() - 1
    }

    /// The setpoint that is `back` widths before a window's end.
    fn setpoint(&self, window: Window, back: usize) -> &Setpoint<R, D> {
        &self.setpoints[window.setpoint(back, self.last())]
    }

    /// The magnitude of a difference.
    fn difference(&self, axis: usize, window: Window) -> R {
        let place = |back: usize| self.setpoint(window, back).point[axis];
        let difference = if window.order == 2 {
            (place(0) - place(1)) - (place(1) - place(2))
        } else {
            let middle = place(1) - place(2);
            ((place(0) - place(1)) - middle) - (middle - (place(2) - place(3)))
        };
        difference.abs()
    }

    fn has_corner(&self, window: Window) -> bool {
        self.setpoint(window, 0).corners > self.setpoint(window, window.order).corners
    }

    /// By how much a motion may be away from the setpoints of a window; `None` where the velocity may jump in it.
    fn hidden(&self, window: Window) -> Option<R> {
        let everywhere = self.rounding + self.limits.resolution();
        match self.limits.junction {
            Junction::Deviation(deviation) if self.has_corner(window) => Some(everywhere + deviation),
            Junction::VelocityJump(_) if self.has_corner(window) => None,
            _ => Some(everywhere),
        }
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::AxisLimits;
    use crate::test_paths::paper_limits;

    /// The findings along x(t) = 10 sin(t/40) in 200 periods.
    fn found(junction: Junction<f64>, acceleration: f64, jerk: f64, corner: bool) -> Vec<TooFast<f64>> {
        let axis = AxisLimits { velocity: None, acceleration: Some(acceleration), jerk: Some(jerk) };
        let limits = KinematicLimits {
            axes: [axis, Default::default(), Default::default()],
            junction,
            ..paper_limits()
        };
        let setpoints: Vec<_> = (0..200_u32)
            .map(|i| Setpoint {
                point: [10.0 * (f64::from(i) / 40.0).sin()],
                distance: f64::from(i),
                corners: usize::from(corner && i >= 60),
            })
            .collect();
        AxisWindows { setpoints: &setpoints, rests: [false; 2], rounding: 0.0, limits: &limits }.too_fast()
    }

    /// The acceleration of the sine is at most 10/40², its jerk 10/40³; r = 0.6 · 2⁻¹⁵ hides less than a tenth of an excess of a tenth
    /// from 32 periods on.
    #[test]
    fn an_excess_shows_at_a_window_that_is_wide_enough() {
        let (acceleration, jerk) = (10.0 / 1600.0, 10.0 / 64_000.0);
        for junction in [Junction::Stop, Junction::Deviation(1e-6)] {
            assert!(found(junction, 1.001 * acceleration, 1.001 * jerk, true).is_empty());
            let by_acceleration = found(junction, 0.9 * acceleration, jerk, true);
            let by_jerk = found(junction, acceleration, 0.9 * jerk, true);
            for found in [by_acceleration, by_jerk] {
                assert!(!found.is_empty());
                // The way advances by 1 a period; the feeds are the least that is needed.
                let feeds = found.iter().map(|way| match way.slower {
                    Slower::Feed { feed, .. } => feed,
                    Slower::Changes { .. } => panic!("the feed does not change"),
                });
                assert!(feeds.clone().all(|feed| feed < 1.0 && feed > 0.93), "{found:?}");
            }
        }
    }

    /// A deviation δ hides an excess of a tenth in windows of w periods that hold the corner if 4 δ is more than that of A w², and a jump hides
    /// all.
    #[test]
    fn what_a_rounded_corner_may_hide_is_not_found() {
        let acceleration = 10.0 / 1600.0;
        let at_corner = |junction: Junction<f64>| {
            let ways = found(junction, 0.9 * acceleration, 1.0, true);
            assert!(!ways.is_empty());
            let at_corner = ways.into_iter().filter(|way| way.from < 60.0 && way.to >= 60.0);
            at_corner.map(|way| way.way).reduce(f64::min)
        };
        assert_eq!(at_corner(Junction::Stop), Some(2.0));
        assert_eq!(at_corner(Junction::Deviation(0.01)), Some(32.0));
        assert_eq!(at_corner(Junction::VelocityJump([1.0; 3])), None);
    }
}
