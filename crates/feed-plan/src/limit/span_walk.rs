//! The walk over one span of a curve: the feed limit at samples, and how far it dips between them.
//!
//! The walk takes steps of the parameter that are short enough. Then the local minima and cusps among the samples are
//! located; those that are as good as corners become stops. Last, the limits of the axes' jerk lower the samples.

use alloc::vec::Vec;

use nurbs_core::{Differentiate, Frenet, GaussLegendre, arc_length, golden_section};
use real::Real;

use crate::KinematicLimits;
use crate::limit::axis_budget::{Allowance, AxisBudget, Turning, components};
use crate::limit::vector::difference;

/// A span has at least 2⁴ stretches.
const COARSEST: i32 = -4;
/// No stretch is shorter than 2⁻²⁰ of a span, nor than eight units of the format's resolution. Once a span has taken
/// `FINE_TRIALS` trials, none is shorter than 2⁻¹⁴ of the span, so that the trials last to its end.
const FINEST: [i32; 2] = [-20, -14];
/// Trials after which the second number of [`FINEST`] holds; a cusp takes some hundred.
const FINE_TRIALS: usize = 1 << 12;
/// Stretches tried in a span, including those refused. After so many, the rest of the span becomes one stretch.
const TRIALS: usize = 1 << 16;
/// A stretch over which `V²` leaves the straight line by more than 2⁻⁸ of itself is halved.
const STRAIGHTNESS: i32 = -8;
/// Steps of a golden-section search: 0.618²⁴ = 10⁻⁵ of two stretches. A limit is flat at its minimum, so that
/// the error of its value is of second order.
const GOLDEN_STEPS: usize = 24;
/// The least limit of a bend is a stop if it is below 2⁻¹² F.
const STOP: i32 = -12;
/// C' vanishes where it is below 2⁻⁶ of its value at the ends of the finest stretch.
const CUSP: i32 = -6;
/// A length is corrected if it is wrong by more than 2⁻³ of the chord error.
const UNSEEN: i32 = -3;
/// Unit tangents that differ by less than 2⁴ units of the format's resolution may differ by rounding only.
const ROUNDING: i32 = 4;

/// The largest difference of unit tangents that rounding may make.
pub(crate) fn tangent_rounding<R: Real>() -> R {
    R::resolution().ldexp(ROUNDING)
}

/// The curve at one parameter.
#[derive(Clone, Copy)]
pub(crate) struct Sample<R, const D: usize> {
    pub(crate) u: R,
    /// `|C'|`.
    pub(crate) speed: R,
    pub(crate) tangent: [R; D],
    pub(crate) radius: R,
    /// Curvature vector; 0 unless an axis is limited.
    pub(crate) bend: [R; D],
    pub(crate) feedrate: R,
    /// The feed limit without the chord error.
    pub(crate) beside_stop: R,
}

/// A sample that is kept.
#[derive(Clone, Copy)]
pub(crate) struct Station<R, const D: usize> {
    pub(crate) at: Sample<R, D>,
    /// The stretch from the previous station, once it has been measured.
    pub(crate) stretch: Option<Stretch<R>>,
}

/// The path between two samples.
#[derive(Clone, Copy)]
pub(crate) struct Stretch<R> {
    pub(crate) length: R,
    /// Whether the direction changes over it.
    pub(crate) bends: bool,
    /// Whether it is straight, short and even enough not to be halved.
    is_fine: bool,
    /// The sharpest turning seen inside and at both ends.
    turning: Turning<R>,
    pub(crate) course: Course<R>,
    /// The limit without the chord error.
    pub(crate) beside_stop: Course<R>,
    /// The acceleration and jerk that the axes leave for the path, and the least that they always leave.
    pub(crate) allowance: Allowance<R>,
    pub(crate) reserve: Allowance<R>,
}

/// The limit between the two ends of a stretch.
#[derive(Clone, Copy)]
pub(crate) struct Course<R> {
    /// By how much `V²` dips below the straight line.
    pub(crate) margin: R,
    /// The largest limit found inside.
    highest: R,
}

/// The settings with which every span of a path is sampled.
pub(crate) struct Sampling<'l, R> {
    limits: &'l KinematicLimits<R>,
    budget: Option<AxisBudget<R>>,
    rule: GaussLegendre<R>,
    /// Longest stretch: the distance of one period at full feed.
    longest: R,
    /// The radius below which the chord error limits the feed.
    chord_bound_radius: R,
    /// Whether a straight line is one stretch.
    leaps_along_lines: bool,
}

impl<'l, R: Real> Sampling<'l, R> {
    pub(crate) fn new(limits: &'l KinematicLimits<R>) -> Self {
        Self {
            limits,
            budget: AxisBudget::new(limits),
            rule: GaussLegendre::new(),
            longest: limits.feedrate * limits.interpolation_period,
            chord_bound_radius: limits.chord_bound_radius(),
            leaps_along_lines: false,
        }
    }

    /// With each straight line as one stretch, for who sees the whole path at once.
    pub(crate) fn leaping_along_lines(self) -> Self {
        Self { leaps_along_lines: true, ..self }
    }

    /// Without what the accelerations and jerks of the axes ask for.
    pub(crate) fn without_reserves(self) -> Self {
        Self { budget: self.budget.map(AxisBudget::of_velocities), ..self }
    }
}

/// One span of a curve.
pub(crate) struct Span<'a, R, C, const D: usize> {
    pub(crate) shape: &'a C,
    pub(crate) index: usize,
    pub(crate) sampling: &'a Sampling<'a, R>,
}

impl<R: Real, C: Differentiate<R, D>, const D: usize> Span<'_, R, C, D> {
    /// Samples from one end of the span to the other, with the limit at each and on the stretch that leads to it.
    pub(crate) fn stations(&self) -> Vec<Station<R, D>> {
        let mut stations = match self.line() {
            Some(line) => self.along_line(&line),
            None => self.along_curve(),
        };
        self.keep_moving(&mut stations);
        stations
    }

    /// Gives stretches that are as short as the walk takes them, and still not fine, the length that is found by halving them as often
    /// as it takes. They may hold a part of the path that no sample lies on. Whether that is less than the distance of a period at full
    /// feed: if not, the walk has not seen how the path runs.
    pub(crate) fn correct_lengths(&self, stations: &mut [Station<R, D>]) -> bool {
        if self.shape.is_line(self.index) {
            return true;
        }
        let most = self.sampling.limits.chord_error.ldexp(UNSEEN);
        let (mut from, mut is_seen) = (R::zero(), true);
        for station in stations {
            let to = station.at.u;
            if let Some(stretch) = station.stretch.as_mut().filter(|stretch| !stretch.is_fine) {
                let halved = arc_length(self.shape, from, to, most.ldexp(-3)).length;
                let off = (stretch.length - halved).abs();
                let rounding = (halved * R::resolution()).ldexp(ROUNDING);
                if off > most.max(rounding) {
                    stretch.length = halved;
                    is_seen &= off <= self.sampling.longest;
                }
            }
            from = to;
        }
        is_seen
    }

    fn along_curve(&self) -> Vec<Station<R, D>> {
        let mut stations = self.walk();
        self.locate_extremes(&mut stations);
        self.rest_in_bends(&mut stations);
        // The geometry alone decides where a stop is. Where only an axis's jerk asks for a very low feed, the plan does
        // not stop.
        self.limit_by_jerk(&mut stations);
        stations
    }

    /// The ends of a span that is a straight line. All samples and stretches of the line are as these, but for their parameters and
    /// lengths.
    fn line(&self) -> Option<[Station<R, D>; 2]> {
        if !self.shape.is_line(self.index) {
            return None;
        }
        let (begin, end) = self.shape.span_bounds(self.index);
        let first = self.sample(begin);
        // A line without a length has no direction.
        if !(first.speed > R::zero() && cosine(&first, &first) >= R::one().half()) {
            return None;
        }
        let last = Sample { u: end, ..first };
        let stretch = Some(self.measured(&first, &[first; 5], &last));
        let mut ends = [Station { at: first, stretch: None }, Station { at: last, stretch }];
        self.limit_by_jerk(&mut ends);
        Some(ends)
    }

    /// Samples of a straight line: both ends alone, if it may be one stretch.
    fn along_line(&self, [first, last]: &[Station<R, D>; 2]) -> Vec<Station<R, D>> {
        let (begin, end, speed) = (first.at.u, last.at.u, first.at.speed);
        let places = if self.sampling.leaps_along_lines {
            Vec::from([end])
        } else {
            evenly((begin, end), self.sampling.longest / speed)
        };
        let mean = self.sampling.rule.mean(&[speed; 5]);
        let mut stations = Vec::with_capacity(places.len() + 1);
        stations.push(*first);
        let mut before = begin;
        for u in places {
            let stretch = last.stretch.map(|whole| Stretch { length: (u - before) * mean, ..whole });
            stations.push(Station { at: Sample { u, ..first.at }, stretch });
            before = u;
        }
        stations
    }

    /// Samples from one end of the span to the other, close enough to each other.
    fn walk(&self) -> Vec<Station<R, D>> {
        let (begin, end) = self.shape.span_bounds(self.index);
        let coarsest = (end - begin).ldexp(COARSEST);
        let least = |finest| (end - begin).ldexp(finest).max(R::resolution().ldexp(3)).min(coarsest);
        let finest = FINEST.map(least);
        let mut here = self.sample(begin);
        let mut stations = Vec::from([Station { at: here, stretch: None }]);
        let mut step = coarsest;
        for trial in 0..=TRIALS {
            let finest = finest[usize::from(trial >= FINE_TRIALS)];
            let wanted = here.u + step.min(self.sampling.longest / here.speed).max(finest);
            let is_inside = wanted > here.u && wanted < end - finest && trial < TRIALS;
            let next = self.sample(if is_inside { wanted } else { end });
            let stretch = self.measure(&here, &next);
            let width = next.u - here.u;
            // A step of `finest` is never refused, even if rounding makes it a little wider.
            if !stretch.is_fine && width > finest + finest.half() && trial < TRIALS {
                step = width.half();
                continue;
            }
            stations.push(Station { at: next, stretch: Some(stretch) });
            if !is_inside {
                break;
            }
            here = next;
            step = (width + width).min(coarsest);
        }
        stations
    }

    /// Adds a sample at each local minimum of the limit and at each cusp that lies between two samples.
    fn locate_extremes(&self, stations: &mut Vec<Station<R, D>>) {
        let cusps = stations.windows(2).filter_map(|pair| self.cusp(&pair[0].at, &pair[1].at));
        let minima = stations.windows(3).filter_map(|three| self.minimum(samples_of(three)?));
        let located: Vec<_> = cusps.chain(minima).map(|at| Station { at, stretch: None }).collect();
        if located.is_empty() {
            return;
        }
        stations.extend(located);
        stations.sort_by(|a, b| a.at.u.partial_cmp(&b.at.u).unwrap_or(core::cmp::Ordering::Equal));
        for i in (1..stations.len()).rev() {
            // A sample that was added has no stretch yet, and the stretch of the sample after it is too long.
            if stations[i].stretch.is_none() || (i > 1 && stations[i - 1].stretch.is_none()) {
                stations[i].stretch = Some(self.measure(&stations[i - 1].at, &stations[i].at));
            }
        }
    }

    /// Makes a stop of the point with the least limit of a bend, if that limit is below [`STOP`], or if the radius
    /// there is less than half of the chord error E. Such a bend is as good as a corner: a step there turns by half a
    /// circle, so that a run slightly off its plan would skip the bend, or wait before it.
    ///
    /// On both sides of the stop the limit stays the same: a bend may be longer than the stretch that a stop releases.
    fn rest_in_bends(&self, stations: &mut [Station<R, D>]) {
        let narrow = self.sampling.limits.chord_error.half();
        let slow = self.sampling.limits.feedrate.ldexp(STOP);
        let is_bend = |at: &Sample<R, D>| at.radius < narrow || at.feedrate < slow;
        let inner = stations.windows(3).enumerate().filter_map(|(i, three)| {
            (is_bend(&three[1].at) && samples_of(three).is_some_and(is_least)).then_some(i + 1)
        });
        // The least limit of a bend may also be at a knot.
        let falls_to = |end: usize, beside: usize| {
            let (end_at, beside_at) = (&stations.get(end)?.at, &stations.get(beside)?.at);
            (end_at.feedrate < slow && end_at.feedrate < beside_at.feedrate).then_some(end)
        };
        let last = stations.len().saturating_sub(1);
        let ends = [falls_to(0, 1), falls_to(last, last.saturating_sub(1))];
        let bends: Vec<usize> = inner.chain(ends.into_iter().flatten()).collect();
        for bend in bends {
            stations[bend].at.feedrate = R::zero();
        }
    }

    /// Lowers the feeds of the samples to what the jerk of the axes allows on the stretches on both sides. Finds the
    /// acceleration and jerk that these feeds leave for the path.
    fn limit_by_jerk(&self, stations: &mut [Station<R, D>]) {
        let Some(budget) = &self.sampling.budget else { return };
        for i in 1..stations.len() {
            let Some(stretch) = stations[i].stretch else { continue };
            let (from, to) = (stations[i - 1].at, stations[i].at);
            let Stretch { turning, course, beside_stop, .. } = stretch;
            let feed = budget.feed_on(&turning, from.feedrate.max(to.feedrate).max(course.highest));
            let most = from.beside_stop.max(to.beside_stop).max(beside_stop.highest);
            let feed_beside_stop = budget.feed_beside_stop(&turning, most);
            for k in [i - 1, i] {
                let at = &mut stations[k].at;
                at.feedrate = at.feedrate.min(feed);
                at.beside_stop = at.beside_stop.min(feed_beside_stop);
            }
            let (allowance, reserve) = (budget.allowance(&turning, feed), budget.reserve(&turning.share));
            stations[i].stretch = Some(Stretch { allowance, reserve, ..stretch });
        }
    }

    /// Raises the limit beside a stop until no stretch takes more than a period, but at most to the feed that is safe
    /// in any direction. Without this, a plan would creep at a cusp, where the curvature is unbounded or undefined.
    fn keep_moving(&self, stations: &mut [Station<R, D>]) {
        let stretches = stations.iter().filter_map(|station| station.stretch.as_ref());
        let widest = stretches.fold(Turning::none(), |most, stretch| most.max(&stretch.turning));
        let most = self.sampling.limits.feed_in_any_direction(&widest.tangent);
        for i in 1..stations.len() {
            let Some(stretch) = &stations[i].stretch else { continue };
            let least = (stretch.length / self.sampling.limits.interpolation_period).min(most);
            for k in [i - 1, i] {
                let at = &mut stations[k].at;
                at.beside_stop = at.beside_stop.max(least);
            }
        }
    }

    /// The place between two samples where C' vanishes, if there is one: the direction is then reversed.
    fn cusp(&self, from: &Sample<R, D>, to: &Sample<R, D>) -> Option<Sample<R, D>> {
        if !(cosine(from, to) < R::zero()) {
            return None;
        }
        let slowest = self.least(from.u, to.u, |sample| sample.speed)?;
        let vanishes = slowest.speed <= from.speed.max(to.speed).ldexp(CUSP);
        vanishes.then_some(Sample { feedrate: R::zero(), ..slowest })
    }

    /// The least limit around the middle one of three samples, if that is below the others by more than
    /// rounding.
    fn minimum(&self, [from, middle, to]: [&Sample<R, D>; 3]) -> Option<Sample<R, D>> {
        if !is_least([from, middle, to]) {
            return None;
        }
        let least = self.least(from.u, to.u, |sample| sample.feedrate)?;
        (least.feedrate < middle.feedrate && least.u != middle.u).then_some(least)
    }

    /// The sample with the least `value` between two parameters, by golden-section search.
    fn least(&self, from: R, to: R, value: impl Fn(&Sample<R, D>) -> R) -> Option<Sample<R, D>> {
        let least = golden_section((from, to), GOLDEN_STEPS, |u| self.sample(u), value);
        (least.at > least.from && least.at < least.to).then_some(least.found)
    }

    /// The curve and its limit at one parameter.
    pub(crate) fn sample(&self, u: R) -> Sample<R, D> {
        let frenet = Frenet::of(&self.shape.derivatives_in(self.index, u));
        let Frenet { speed, tangent, .. } = frenet;
        let radius = frenet.radius();
        let chord = self.sampling.limits.feedrate_by_chord(radius, self.sampling.chord_bound_radius);
        let across = self.sampling.limits.feedrate_across(radius);
        let limited =
            self.sampling.budget.as_ref().and_then(|budget| Some((budget, frenet.curvature_vector()?)));
        let Some((budget, bend)) = limited else {
            let feedrate = chord.min(across);
            return Sample { u, speed, tangent, radius, bend: [R::zero(); D], feedrate, beside_stop: across };
        };
        let beside_stop = budget.feed_at(&Turning::at(&tangent, &bend), across);
        Sample { u, speed, tangent, radius, bend, feedrate: chord.min(beside_stop), beside_stop }
    }

    /// Length of the path between two samples, and how far the limit dips in between.
    fn measure(&self, from: &Sample<R, D>, to: &Sample<R, D>) -> Stretch<R> {
        let width = to.u - from.u;
        let inner = core::array::from_fn(|i| self.sample(from.u + width * self.sampling.rule.points[i]));
        self.measured(from, &inner, to)
    }

    /// The same by the samples at the places of the rule between them.
    fn measured(&self, from: &Sample<R, D>, inner: &[Sample<R, D>; 5], to: &Sample<R, D>) -> Stretch<R> {
        let length = (to.u - from.u) * self.sampling.rule.mean(&inner.map(|sample| sample.speed));

        let speeds = [from.speed, inner[2].speed, to.speed];
        let shares = core::array::from_fn(|i| arc_share(speeds, self.sampling.rule.points[i + 1]));
        let course_of = |feed: fn(&Sample<R, D>) -> R| {
            let [_, within @ .., _] = inner.each_ref().map(feed);
            let highest = inner.iter().fold(R::zero(), |most, sample| most.max(feed(sample)));
            let (margin, is_straight) = dip([feed(from), feed(to)], within, shares);
            (Course { margin, highest }, is_straight)
        };
        let (course, is_straight) = course_of(|sample| sample.feedrate);
        let (beside_stop, _) = course_of(|sample| sample.beside_stop);
        let is_short = length <= self.sampling.longest + self.sampling.longest;
        let is_turning_little = cosine(from, to) >= R::one().half();
        // Otherwise a distance would not determine the parameter.
        let (slowest, fastest) = speeds
            .iter()
            .fold((speeds[0], speeds[0]), |(least, most), speed| (least.min(*speed), most.max(*speed)));
        let is_even = fastest <= slowest + slowest;
        let is_fine = is_straight && is_short && is_turning_little && is_even;
        let turning = self.turning(from, inner, to);
        let mut tangents = from.tangent.iter().zip(to.tangent);
        let bends = tangents.any(|(a, b)| (*a - b).abs() > tangent_rounding());
        let unlimited = Allowance::unlimited();
        Stretch {
            length,
            bends,
            is_fine,
            turning,
            course,
            beside_stop,
            allowance: unlimited,
            reserve: unlimited,
        }
    }

    /// The largest components of tangent, curvature and change of curvature on a stretch. The change is found from
    /// differences between neighbours; an eighth is added for values in between.
    fn turning(&self, from: &Sample<R, D>, inner: &[Sample<R, D>; 5], to: &Sample<R, D>) -> Turning<R> {
        let mut turning = Turning::none();
        if self.sampling.budget.is_none() {
            return turning;
        }
        let mut previous = from;
        for sample in core::iter::once(from).chain(inner).chain(core::iter::once(to)) {
            let length = (sample.u - previous.u) * (sample.speed + previous.speed).half();
            let difference = components(&difference(&sample.bend, &previous.bend));
            let mut here = Turning::at(&sample.tangent, &sample.bend);
            if length > R::zero() {
                here.change = difference.map(|x| x / length + (x / length).ldexp(-3));
            }
            turning = turning.max(&here);
            previous = sample;
        }
        turning
    }
}

/// Parameters of a straight line behind its begin, a step from each other, up to its end.
fn evenly<R: Real>((begin, end): (R, R), step: R) -> Vec<R> {
    let mut places = Vec::new();
    let mut next = begin + step;
    while next + step.ldexp(-3) < end && places.len() < TRIALS && next > begin {
        places.push(next);
        next = next + step;
    }
    places.push(end);
    places
}

/// By how much `V²` may dip below the straight line between the feeds at both ends of a stretch, and whether it keeps
/// to that line at the three places where it is known. These lie at the `shares` of the length.
fn dip<R: Real>([from, to]: [R; 2], within: [R; 3], shares: [R; 3]) -> (R, bool) {
    let (begin, rise) = (from * from, (to - from) * (to + from));
    let (mut margin, mut is_straight) = (R::zero(), true);
    for (share, feed) in shares.into_iter().zip(within) {
        let line = begin + rise * share;
        let dip = line - feed * feed;
        margin = margin.max(dip);
        is_straight &= dip.abs() <= line.ldexp(STRAIGHTNESS);
    }
    // The dip between the three places is at most a little deeper than at the deepest of them.
    (margin + margin.ldexp(-2), is_straight)
}

/// The share of a stretch's arc length that lies before the share `x` of its parameters. `|C'|` is taken as the
/// parabola through its values at 0, ½ and 1.
fn arc_share<R: Real>([begin, middle, end]: [R; 3], x: R) -> R {
    // |C'| = b + (e - b - q) x + q x², q = 2(b - 2m + e)
    let q = (begin + end - middle - middle).ldexp(1);
    let third = R::from_ratio(1, 3);
    let integral = |x: R| x * (begin + x * ((end - begin - q).half() + x * q * third));
    integral(x) / integral(R::one())
}

/// The samples of three stations.
fn samples_of<R, const D: usize>(stations: &[Station<R, D>]) -> Option<[&Sample<R, D>; 3]> {
    let three: &[_; 3] = stations.first_chunk()?;
    Some(three.each_ref().map(|station| &station.at))
}

/// Whether the limit at the middle sample is below both others by more than rounding.
fn is_least<R: Real, const D: usize>([from, middle, to]: [&Sample<R, D>; 3]) -> bool {
    let rounding = middle.feedrate * R::resolution().sqrt();
    from.feedrate - middle.feedrate > rounding && to.feedrate - middle.feedrate >= rounding
}

/// Cosine of the angle between the tangents of two samples.
fn cosine<R: Real, const D: usize>(from: &Sample<R, D>, to: &Sample<R, D>) -> R {
    R::sum_of_products(from.tangent.into_iter().zip(to.tangent))
}

#[cfg(test)]
mod tests {
    use nurbs_core::{Differentiate, NurbsBuf, arc_length};
    use proptest::prelude::*;

    use crate::test_paths::{Power, hairpin, paper_limit_along, paper_limits, seed_000};
    use crate::{FeedLimit, LimitPoint, PlanError};

    fn longest_step(limit: &FeedLimit<f64>) -> f64 {
        let steps = limit.points().zip(limit.points().skip(1)).map(|(from, to)| to.distance - from.distance);
        steps.fold(0.0, f64::max)
    }

    /// The points at which the limit is 0.
    fn rests(limit: &FeedLimit<f64>) -> Vec<LimitPoint<f64>> {
        limit.samples().iter().filter(|sample| sample.lower == 0.0).map(|sample| sample.point).collect()
    }

    #[test]
    fn local_minima_are_points() {
        let limit = paper_limit_along(&seed_000());
        // V in mm/s found independently; u by solving for the extreme of the curvature with 40 digits.
        for (u, feedrate) in [
            (0.100_366_38, 111.4817),
            (0.302_844_95, 104.8954),
            (0.697_155_05, 104.8954),
            (0.899_633_62, 111.4817),
        ] {
            let near = limit.points().filter(|p| (p.u - u).abs() < 1e-3);
            let least = near.min_by(|a, b| a.feedrate.total_cmp(&b.feedrate)).unwrap();
            assert!((least.feedrate / 3e-3 - feedrate).abs() < 1e-4, "u={u}: {}", least.feedrate / 3e-3);
            assert!((least.u - u).abs() < 2e-8, "u={u}: {}", least.u);
        }
    }

    #[test]
    fn a_span_is_walked_to_its_end_in_small_steps() {
        // In the fourth span the walk once refused a step of the finest width for ever: rounding had made the step
        // slightly wider. The rest of the span became one stretch of 15 mm.
        let points = [
            [0., 0.],
            [0., 0.],
            [0., 0.],
            [37.123, 2.211],
            [2.295, 28.871],
            [27.731, 9.455],
            [33.568, 58.128],
            [0., 0.],
        ];
        let knots = [0., 0., 0., 0., 0.2, 0.4, 0.6, 0.8, 1., 1., 1., 1.];
        let curve = NurbsBuf::try_new(3, points.to_vec(), vec![1.0; 8], knots.to_vec()).unwrap();
        let limit = paper_limit_along(&curve);
        let longest = longest_step(&limit);
        assert!(longest <= 1.2, "{longest}");
        let reference = arc_length(&curve.as_curve(), 0.0, 1.0, 1e-13).length;
        assert!((limit.length() / reference - 1.0).abs() < 1e-12, "{} {reference}", limit.length());
    }

    /// Over 2⁻²⁰ of its first span this curve runs along two sides of its polygon, 208 mm that were lost without a word.
    /// Its length was found with 60 digits.
    #[test]
    fn a_length_that_the_walk_does_not_see_is_refused() {
        let points =
            [[150., 150.], [0., 0.], [0., 300.], [150., 150.], [300., 0.], [300., 300.], [150., 150.]];
        let knots = vec![0., 0., 0., 0., 0.25, 0.5, 0.75, 1., 1., 1., 1.];
        let weighted =
            |weights: Vec<f64>| NurbsBuf::try_new(3, points.to_vec(), weights, knots.clone()).unwrap();
        let uneven = weighted(vec![1., 1e9, 1e-9, 1., 1e6, 1., 1.]);
        assert!((arc_length(&uneven.as_curve(), 0.0, 1.0, 1e-9).length - 724.268).abs() < 1e-3);
        let refused = FeedLimit::along(&[uneven.as_curve()], &paper_limits()).unwrap_err();
        assert_eq!(refused, PlanError::SpanTooUneven { curve: 0, span: 0 });
        for ratio in [1.0, 1e2, 1e3] {
            let curve = weighted(vec![1., ratio, 1. / ratio, 1., ratio, 1., 1.]);
            let limit = paper_limit_along(&curve);
            let reference = arc_length(&curve.as_curve(), 0.0, 1.0, 1e-9).length;
            assert!(
                (limit.length() - reference).abs() < 5e-4 / 8.0,
                "{ratio}: {} {reference}",
                limit.length()
            );
        }
    }

    proptest! {
        #![proptest_config(ProptestConfig::with_cases(64))]
        /// Weights over any number of decades: the limit is as long as the curve, or refused.
        #[test]
        fn no_length_is_lost_whatever_the_weights(
            decades in prop::array::uniform6(-9.0..9.0_f64), shares in prop::array::uniform3(0.0..1.0_f64),
            points in prop::array::uniform6(prop::array::uniform2(0.0..300.0_f64)),
        ) {
            let weights = decades.map(|decade| 10.0_f64.powf(decade * shares[0])).to_vec();
            let [low, high] = [shares[1].min(shares[2]), shares[1].max(shares[2])];
            let knots = vec![0., 0., 0., 0., low, high, 1., 1., 1., 1.];
            let curve = NurbsBuf::try_new(3, points.to_vec(), weights, knots).map_err(|error| TestCaseError::reject(error.to_string()))?;
            match FeedLimit::along(&[curve.as_curve()], &paper_limits()) {
                Ok(limit) => {
                    let reference = arc_length(&curve.as_curve(), 0.0, 1.0, 1e-9).length;
                    let off = (limit.length() - reference).abs();
                    prop_assert!(off < 5e-4, "{} for {reference}", limit.length());
                }
                Err(error) => prop_assert!(matches!(error, PlanError::SpanTooUneven { curve: 0, .. }), "{error}"),
            }
        }
    }

    #[test]
    fn points_are_about_a_period_apart() {
        let limit = paper_limit_along(&seed_000());
        let longest = longest_step(&limit);
        assert!(longest <= 1.2, "{longest}"); // 2 F T
        assert!(limit.points().len() < 2 * 834 * 10 / 6, "{}", limit.points().len());
    }

    #[test]
    fn a_cusp_is_a_stop_wherever_its_parameter_lies() {
        // Length of (10 t², 10 t³) from 0 to T: 10/27 ((4 + 9T²)^1.5 - 8).
        let length = |t: f64| 10.0 / 27.0 * ((4.0 + 9.0 * t * t).powf(1.5) - 8.0);
        for cusp in [0.5, 0.25, 0.31, 0.777_777, 1.0 / 3.0] {
            let curve = Power { origin: cusp, exponents: [2, 3], scale: 10.0 };
            let limit = FeedLimit::along(&[curve], &paper_limits()).unwrap();
            assert!((limit.length() - length(cusp) - length(1.0 - cusp)).abs() < 1e-6, "{}", limit.length());
            let stops = rests(&limit);
            assert_eq!(stops.len(), 1, "cusp at {cusp}: {stops:?}");
            assert!((stops[0].u - cusp).abs() < 1e-4 && (stops[0].distance - length(cusp)).abs() < 1e-6);
            let plan = crate::plan(&limit, &paper_limits(), crate::EndFeeds::default()).unwrap();
            assert!(
                plan.stages().iter().any(|s| s.start_feed == 0.0 && (s.start - length(cusp)).abs() < 1e-6)
            );
        }
    }

    #[test]
    fn a_bend_narrower_than_the_chord_error_is_a_stop() {
        // E/2 = 2.5e-4 mm.
        for (width, radius, expected) in [(0.04, 1.5e-5, 1), (0.16, 2.4e-4, 1), (0.168, 2.646e-4, 0)] {
            let curve = hairpin(width);
            assert!((nurbs_core::radius(&curve.as_curve().derivatives(0.5)) - radius).abs() < 1e-12);
            let limit = paper_limit_along(&curve);
            let rests: Vec<_> = rests(&limit).iter().map(|point| point.u).collect();
            assert_eq!(rests.len(), expected, "{width}: {rests:?}");
            assert!(rests.iter().all(|u| (u - 0.5).abs() < 1e-3), "{rests:?}");
        }
    }

    #[test]
    fn a_fast_start_of_the_parameter_is_no_cusp() {
        // (t³, t⁶): C' = 0 at the start, then a parabola.
        let curve = Power { origin: 0.0, exponents: [3, 6], scale: 10.0 };
        let limit = FeedLimit::along(&[curve], &paper_limits()).unwrap();
        assert!(crate::plan(&limit, &paper_limits(), crate::EndFeeds::default()).is_ok());
        assert_eq!(rests(&limit).len(), 1);
    }
}
