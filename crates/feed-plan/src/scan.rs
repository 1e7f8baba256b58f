//! One pass along the path: samples of the feed limit over the arc length.
//!
//! Each span is walked in steps of the parameter that are short enough, then the local minima and cusps among
//! its samples are located, then the samples are appended to the path, with a stop in between where the
//! tangent breaks.

use alloc::vec::Vec;

use nurbs_core::{Differentiate, Frenet, GaussLegendre, golden_section, tangent_breaks};
use real::Real;

use crate::axis_budget::{Allowance, AxisBudget, Turning, components};
use crate::fine_moves::FineMoves;
use crate::limits::Junction;
use crate::sample::{LimitSample, lowered};
use crate::{KinematicLimits, LimitPoint, PlanError};

/// At least 2⁴ stretches a span.
const COARSEST: i32 = -4;
/// No stretch shorter than 2⁻²⁰ of a span, or than eight units of the format's resolution; once a span has taken
/// `FINE_TRIALS`, none shorter than 2⁻¹⁴, so that the trials last to its end.
const FINEST: [i32; 2] = [-20, -14];
/// See [`FINEST`]: a cusp takes some hundred.
const FINE_TRIALS: usize = 1 << 12;
/// Stretches tried in a span, those refused among them; what is left of the span is then one stretch.
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

/// The tangents' own rounding error is a few units: less than 2⁴.
const ROUNDING: i32 = 4;

/// The samples of the path so far.
pub(crate) struct Scan<'l, R, const D: usize> {
    limits: &'l KinematicLimits<R>,
    budget: Option<AxisBudget<R>>,
    rule: GaussLegendre<R>,
    /// Longest stretch: the distance of one period at full feed.
    longest: R,
    /// The radius below which the chord error limits the feed.
    chord_bound_radius: R,
    /// Largest difference of unit tangents that is no corner.
    break_tolerance: R,
    /// Largest difference of unit tangents that rounding may make.
    rounding: R,
    distance: R,
    /// Tangent and curvature vector at the end so far.
    end: Option<([R; D], [R; D])>,
    samples: Vec<LimitSample<R>>,
    /// What breaks of the tangent within one step do together.
    fine_moves: FineMoves<R, D>,
    /// Distances at which the tangent breaks.
    corners: Vec<R>,
}

impl<'l, R: Real, const D: usize> Scan<'l, R, D> {
    pub(crate) fn new(limits: &'l KinematicLimits<R>) -> Self {
        let longest = limits.feedrate * limits.interpolation_period;
        let by_chord_error = limits.chord_error.scale(2) / longest;
        let by_acceleration = limits.acceleration * limits.interpolation_period / limits.feedrate;
        let rounding = R::resolution().scale(ROUNDING);
        let break_tolerance = by_chord_error.min(by_acceleration).max(rounding);
        let rule = GaussLegendre::new();
        let budget = AxisBudget::new(limits);
        let (distance, end, samples) = (R::zero(), None, Vec::new());
        let chord_bound_radius = limits.chord_bound_radius();
        let fine_moves = FineMoves::new(limits, budget, rounding);
        Self {
            limits,
            budget,
            rule,
            longest,
            chord_bound_radius,
            break_tolerance,
            rounding,
            distance,
            end,
            samples,
            fine_moves,
            corners: Vec::new(),
        }
    }

    /// Samples one curve, which begins at rest if `from_rest`, whatever the directions.
    pub(crate) fn pass<C: Differentiate<R, D>>(
        &mut self,
        curve: usize,
        shape: &C,
        from_rest: bool,
    ) -> Result<(), PlanError> {
        (0..shape.span_count())
            .try_for_each(|index| self.pass_span(curve, shape, index, from_rest && index == 0))
    }

    /// Samples one span of a curve; it begins at rest if `from_rest`.
    pub(crate) fn pass_span<C: Differentiate<R, D>>(
        &mut self,
        curve: usize,
        shape: &C,
        index: usize,
        from_rest: bool,
    ) -> Result<(), PlanError> {
        let (limits, budget, rule) = (self.limits, self.budget.as_ref(), &self.rule);
        let (longest, chord_bound_radius) = (self.longest, self.chord_bound_radius);
        let span = Span { shape, index, limits, budget, rule, longest, chord_bound_radius };
        let mut stations = span.walk();
        span.locate_extremes(&mut stations);
        span.rest_in_bends(&mut stations);
        // A stop is one by its geometry; where only an axis's jerk asks for a creep, the path is crept along.
        self.limit_by_jerk(&mut stations);
        self.keep_moving(&mut stations);
        self.append(curve, shape, index, &stations, from_rest).ok_or(PlanError::LengthOverflows { curve })
    }

    /// Ends the path.
    pub(crate) fn finish(&mut self) {
        self.fine_moves.end(&mut self.samples);
    }

    /// The samples so far, but for those forgotten.
    pub(crate) fn samples(&self) -> &[LimitSample<R>] {
        &self.samples
    }

    /// Those of them that stay as they are, whatever comes: what a chord reaches from a break still to come may be lowered, and the
    /// sample before it.
    pub(crate) fn settled(&self) -> &[LimitSample<R>] {
        let begin = self.fine_moves.open_from(self.distance);
        let count = self.samples.partition_point(|sample| sample.point.distance <= begin);
        self.samples.get(..count.saturating_sub(1)).unwrap_or_default()
    }

    /// Distances at which the tangent breaks, but for those forgotten.
    pub(crate) fn corners(&self) -> &[R] {
        &self.corners
    }

    /// Arc length of what was sampled.
    pub(crate) fn length(&self) -> R {
        self.distance
    }

    /// Drops the samples before the last one that is no farther than `distance`.
    pub(crate) fn forget_before(&mut self, distance: R) {
        let kept = self.samples.partition_point(|sample| sample.point.distance <= distance);
        self.samples.drain(..kept.saturating_sub(1));
        self.corners.retain(|corner| *corner > distance);
    }

    /// Appends a span, with a stop before it if `from_rest`; `None` when a distance does not increase as numbers of the format
    /// should.
    fn append<C: Differentiate<R, D>>(
        &mut self,
        curve: usize,
        shape: &C,
        index: usize,
        stations: &[Station<R, D>],
        from_rest: bool,
    ) -> Option<()> {
        let (first, last) = (&stations.first()?.at, &stations.last()?.at);
        let is_corner = self.end.is_some_and(|(tangent, _)| tangent_breaks(&tangent, &first.tangent));
        if is_corner {
            self.corners.push(self.distance);
        }
        let is_lowest = |feedrate: &R| *feedrate < self.lower_beside(stations);
        let stop = (from_rest && self.end.is_some()).then(R::zero);
        let turn = self.end.map(|end| Turn::between(end, first));
        let junction = stop.or_else(|| self.junction_feed(turn.as_ref()?).filter(is_lowest));
        if let Some(feedrate) = junction {
            self.push(curve, &Sample { feedrate, ..*first }, None);
            if let Some(junction) = self.samples.last_mut() {
                junction.is_single = true;
            }
        }
        if index > 0 && turn.as_ref().is_some_and(|turn| self.fine_moves.is_break(turn.size)) {
            self.recall(shape, index - 1);
        }
        let point_at = |u| shape.derivatives(u).point;
        self.turn(turn.as_ref(), first, junction, point_at);
        let is_continuation =
            |end: &LimitSample<R>| end.point.curve == curve && end.point.feedrate == first.feedrate;
        if !self.samples.last().is_some_and(is_continuation) {
            self.push(curve, first, None);
        }
        if let Some(begin) = self.samples.last_mut() {
            begin.bends |= !is_corner && turn.as_ref().is_some_and(|turn| turn.size > self.rounding);
        }
        for (before, station) in (0..).zip(&stations[1..]) {
            let stretch = station.stretch.as_ref()?;
            let length = stretch.length;
            let next = self.distance + length;
            if !(length >= R::zero() && next >= self.distance && next.is_finite()) {
                return None;
            }
            self.distance = next;
            self.push(curve, &station.at, Some(stretch));
            if self.fine_moves.is_waiting() && self.bends_at(&stations[before..]) {
                self.fine_moves.pass(next, point_at(station.at.u), station.at.tangent);
            }
            if station.at.feedrate.is_zero() {
                self.fine_moves.end(&mut self.samples);
                self.fine_moves.pass(next, point_at(station.at.u), station.at.tangent);
            }
        }
        self.fine_moves.settle(&mut self.samples);
        if index + 1 >= shape.span_count() {
            self.recall(shape, index);
        }
        self.end = Some((last.tangent, last.bend));
        Some(())
    }

    /// Learns what [`FineMoves`] needs of the path behind its end. The last span sampled is `index`.
    fn recall<C: Differentiate<R, D>>(&mut self, shape: &C, mut index: usize) {
        let (limits, budget, rule) = (self.limits, self.budget.as_ref(), &self.rule);
        let (longest, chord_bound_radius) = (self.longest, self.chord_bound_radius);
        self.fine_moves.recall(&self.samples, |u| {
            while index > 0 && u < shape.span_bounds(index).0 {
                index -= 1;
            }
            let span = Span { shape, index, limits, budget, rule, longest, chord_bound_radius };
            // `derivatives_in` is compiled into `sample` as long as nobody else asks for it.
            (shape.derivatives(u).point, span.sample(u).tangent)
        });
    }

    /// Whether the second of these stations is the last one, or not on a straight line with its neighbours.
    fn bends_at(&self, stations: &[Station<R, D>]) -> bool {
        let [_, here, behind, ..] = stations else { return true };
        [here, behind].iter().any(|station| station.stretch.is_none_or(|stretch| stretch.bends))
    }

    /// Goes on from where the tangent turns: anew if no chord passes there.
    fn turn(
        &mut self,
        turn: Option<&Turn<R, D>>,
        first: &Sample<R, D>,
        junction: Option<R>,
        point_at: impl Fn(R) -> [R; D],
    ) {
        let is_stop = junction.is_some_and(|feedrate| feedrate.is_zero());
        // What is cut there is what a velocity may jump by.
        let is_jump = matches!(self.limits.junction, Junction::VelocityJump(_))
            && turn.is_some_and(|turn| turn.size > self.break_tolerance);
        if is_stop || is_jump {
            self.fine_moves.end(&mut self.samples);
        }
        match turn {
            Some(turn) if !self.fine_moves.is_empty() => self.fine_moves.turn(turn.size, first.tangent),
            _ => self.fine_moves.pass(self.distance, point_at(first.u), first.tangent),
        }
    }

    fn push(&mut self, curve: usize, sample: &Sample<R, D>, before: Option<&Stretch<R>>) {
        let &Sample { u, speed, feedrate, beside_stop, .. } = sample;
        let point = LimitPoint { distance: self.distance, curve, u, feedrate };
        let at = LimitSample { speed, feedrate_beside_stop: beside_stop, ..LimitSample::new(point) };
        self.samples.push(before.map_or(at, |stretch| LimitSample {
            bends: stretch.bends,
            margin: stretch.course.margin,
            allowance: stretch.allowance,
            margin_beside_stop: stretch.beside_stop.margin,
            allowance_beside_stop: stretch.reserve,
            ..at
        }));
    }

    /// The feed at the point where a span begins, if the tangent breaks there, or the curvature steps more than the axes can
    /// follow.
    fn junction_feed(&self, junction: &Turn<R, D>) -> Option<R> {
        let Turn { difference, size: turn, step } = *junction;
        let feedrate = self.limits.feedrate;
        let is_break = turn > self.break_tolerance;
        let by_turn = match self.limits.junction {
            Junction::Stop => {
                if is_break {
                    R::zero()
                } else {
                    feedrate
                }
            }
            // Where the tangents' own rounding error could be all of it, it is no break for anybody.
            _ if !(turn > self.rounding) => feedrate,
            Junction::Deviation(deviation) if is_break || self.deviates(turn, deviation) => {
                self.feed_by_deviation(turn, deviation)
            }
            Junction::Deviation(_) => feedrate,
            Junction::VelocityJump(jumps) => {
                let pairs = difference.iter().zip(jumps);
                pairs.fold(
                    feedrate,
                    |feed, (turn, jump)| {
                        if turn.abs() * feed > jump { jump / turn.abs() } else { feed }
                    },
                )
            }
        };
        let feed = if is_break {
            by_turn
        } else {
            let step = components::<R, D>(&step);
            self.budget.map_or(by_turn, |budget| budget.feed_over(&step, by_turn))
        };
        (feed < feedrate).then_some(feed)
    }

    /// The lower of the bounds that the limit has on both sides of the point where these samples begin. A single point above
    /// either would stand out as a summit that the flank on that side cannot reach.
    fn lower_beside(&self, stations: &[Station<R, D>]) -> R {
        let before = self.samples.last().map(|end| lowered(end.point.feedrate, end.margin));
        let after = stations.windows(2).next().map(|pair| {
            let margin = pair[1].stretch.as_ref().map_or_else(R::zero, |stretch| stretch.course.margin);
            lowered(pair[0].at.feedrate, margin)
        });
        before.into_iter().chain(after).fold(R::max_value(), R::min)
    }

    /// Whether full feed is above [`feed_by_deviation`](Self::feed_by_deviation), without a quotient, which a small turn makes
    /// large.
    fn deviates(&self, turn: R, deviation: R) -> bool {
        let sine = turn.half();
        let cosine = (R::one() - sine * sine).sqrt();
        let across = self.limits.feedrate * sine;
        across * across > self.limits.acceleration_across() * deviation * (cosine * (R::one() + cosine))
    }

    /// [`Junction::Deviation`], `turn` = |e₂ - e₁| = 2 sin(φ/2).
    fn feed_by_deviation(&self, turn: R, deviation: R) -> R {
        let sine = turn.half();
        let cosine = (R::one() - sine * sine).sqrt();
        // cos / (1 - cos) = cos (1 + cos) / sin², without cancellation.
        let ratio = (deviation / sine) * (cosine * (R::one() + cosine) / sine);
        (self.limits.acceleration_across() * ratio).sqrt().min(self.limits.feedrate)
    }

    /// Lowers the samples' feeds to what the jerk of the axes allows on the stretches at both sides, and finds what these
    /// leave for the path.
    fn limit_by_jerk(&self, stations: &mut [Station<R, D>]) {
        let Some(budget) = &self.budget else { return };
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

    /// Raises what holds beside a stop to where no stretch takes more than a period, as far as setpoints then keep the limits
    /// whatever way they go: at a cusp the curvature has no bound, or is none.
    fn keep_moving(&self, stations: &mut [Station<R, D>]) {
        let stretches = stations.iter().filter_map(|station| station.stretch.as_ref());
        let widest = stretches.fold(Turning::none(), |most, stretch| most.max(&stretch.turning));
        let most = self.limits.feed_in_any_direction(&widest.tangent);
        for i in 1..stations.len() {
            let Some(stretch) = &stations[i].stretch else { continue };
            let least = (stretch.length / self.limits.interpolation_period).min(most);
            for k in [i - 1, i] {
                let at = &mut stations[k].at;
                at.beside_stop = at.beside_stop.max(least);
            }
        }
    }
}

/// What changes where a span begins.
struct Turn<R, const D: usize> {
    /// The difference e₂ - e₁ of the unit tangents, and its length.
    difference: [R; D],
    size: R,
    /// The difference of the curvature vectors.
    step: [R; D],
}

impl<R: Real, const D: usize> Turn<R, D> {
    /// From where a span ends, with this tangent and curvature vector, to where the next begins.
    fn between((end_tangent, end_bend): ([R; D], [R; D]), first: &Sample<R, D>) -> Self {
        let difference: [R; D] = core::array::from_fn(|d| first.tangent[d] - end_tangent[d]);
        let step = core::array::from_fn(|d| first.bend[d] - end_bend[d]);
        Self { difference, size: R::norm(&difference), step }
    }
}

/// The curve at one parameter.
#[derive(Clone, Copy)]
struct Sample<R, const D: usize> {
    u: R,
    /// `|C'|`.
    speed: R,
    tangent: [R; D],
    radius: R,
    /// Curvature vector; 0 unless an axis is limited.
    bend: [R; D],
    feedrate: R,
    /// The same without the chord error.
    beside_stop: R,
}

/// A sample that stays.
#[derive(Clone, Copy)]
struct Station<R, const D: usize> {
    at: Sample<R, D>,
    /// The stretch from the previous one, once measured.
    stretch: Option<Stretch<R>>,
}

/// The path between two samples.
#[derive(Clone, Copy)]
struct Stretch<R> {
    length: R,
    /// Whether the direction changes over it.
    bends: bool,
    /// Whether it is straight, short and even enough not to be halved.
    is_fine: bool,
    /// The sharpest turning seen inside and at both ends.
    turning: Turning<R>,
    course: Course<R>,
    /// The same without the chord error.
    beside_stop: Course<R>,
    /// What the axes leave for the path, and the least that they do.
    allowance: Allowance<R>,
    reserve: Allowance<R>,
}

/// The limit on a stretch.
#[derive(Clone, Copy)]
struct Course<R> {
    /// By how much `V²` dips below the straight line.
    margin: R,
    /// The largest limit seen inside.
    highest: R,
}

/// One span of a curve, under given limits.
struct Span<'a, R, C> {
    shape: &'a C,
    index: usize,
    limits: &'a KinematicLimits<R>,
    budget: Option<&'a AxisBudget<R>>,
    rule: &'a GaussLegendre<R>,
    longest: R,
    /// The radius below which the chord error limits the feed.
    chord_bound_radius: R,
}

impl<R: Real, C> Span<'_, R, C> {
    /// Samples from one end of the span to the other, close enough to each other.
    fn walk<const D: usize>(&self) -> Vec<Station<R, D>>
    where
        C: Differentiate<R, D>,
    {
        let (begin, end) = self.shape.span_bounds(self.index);
        let coarsest = (end - begin).scale(COARSEST);
        let least = |finest| (end - begin).scale(finest).max(R::resolution().scale(3)).min(coarsest);
        let finest = FINEST.map(least);
        let mut here = self.sample(begin);
        let mut stations = Vec::from([Station { at: here, stretch: None }]);
        let mut step = coarsest;
        for trial in 0..=TRIALS {
            let finest = finest[usize::from(trial >= FINE_TRIALS)];
            let wanted = here.u + step.min(self.longest / here.speed).max(finest);
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
    fn locate_extremes<const D: usize>(&self, stations: &mut Vec<Station<R, D>>)
    where
        C: Differentiate<R, D>,
    {
        let cusps = stations.windows(2).filter_map(|pair| self.cusp(&pair[0].at, &pair[1].at));
        let minima = stations.windows(3).filter_map(|three| self.minimum(samples_of(three)?));
        let located: Vec<_> = cusps.chain(minima).map(|at| Station { at, stretch: None }).collect();
        if located.is_empty() {
            return;
        }
        stations.extend(located);
        stations.sort_by(|a, b| a.at.u.partial_cmp(&b.at.u).unwrap_or(core::cmp::Ordering::Equal));
        for i in (1..stations.len()).rev() {
            // A located sample has no stretch yet, and that after it has one that is too long.
            if stations[i].stretch.is_none() || (i > 1 && stations[i - 1].stretch.is_none()) {
                stations[i].stretch = Some(self.measure(&stations[i - 1].at, &stations[i].at));
            }
        }
    }

    /// Makes a stop of a bend at its least limit if that is below [`STOP`], or if the radius there is less than half of the
    /// chord error E: it is as good as a corner. A step there turns by half a circle, so that a run a little off its plan
    /// would skip the bend, or wait before it.
    ///
    /// On both sides the limit stays what it is: a bend may be longer than what a stop releases.
    fn rest_in_bends<const D: usize>(&self, stations: &mut [Station<R, D>]) {
        let narrow = self.limits.chord_error.half();
        let slow = self.limits.feedrate.scale(STOP);
        let is_bend = |at: &Sample<R, D>| at.radius < narrow || at.feedrate < slow;
        let inner = stations.windows(3).enumerate().filter_map(|(i, three)| {
            (is_bend(&three[1].at) && samples_of(three).is_some_and(is_least)).then_some(i + 1)
        });
        // At a knot the bend may have its least limit too.
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

    /// Where C' vanishes between two samples, if it does: the direction is then reversed.
    fn cusp<const D: usize>(&self, from: &Sample<R, D>, to: &Sample<R, D>) -> Option<Sample<R, D>>
    where
        C: Differentiate<R, D>,
    {
        if !(cosine(from, to) < R::zero()) {
            return None;
        }
        let slowest = self.least(from.u, to.u, |sample| sample.speed)?;
        let vanishes = slowest.speed <= from.speed.max(to.speed).scale(CUSP);
        vanishes.then_some(Sample { feedrate: R::zero(), ..slowest })
    }

    /// The least limit around the middle one of three samples, if that is below the others by more than
    /// rounding.
    fn minimum<const D: usize>(&self, [from, middle, to]: [&Sample<R, D>; 3]) -> Option<Sample<R, D>>
    where
        C: Differentiate<R, D>,
    {
        if !is_least([from, middle, to]) {
            return None;
        }
        let least = self.least(from.u, to.u, |sample| sample.feedrate)?;
        (least.feedrate < middle.feedrate && least.u != middle.u).then_some(least)
    }

    /// The sample with the least `value` between two parameters, by golden-section search.
    fn least<const D: usize>(
        &self,
        from: R,
        to: R,
        value: impl Fn(&Sample<R, D>) -> R,
    ) -> Option<Sample<R, D>>
    where
        C: Differentiate<R, D>,
    {
        let least = golden_section((from, to), GOLDEN_STEPS, |u| self.sample(u), value);
        (least.at > least.from && least.at < least.to).then_some(least.found)
    }

    /// The curve and its limit at one parameter.
    fn sample<const D: usize>(&self, u: R) -> Sample<R, D>
    where
        C: Differentiate<R, D>,
    {
        let frenet = Frenet::of(&self.shape.derivatives_in(self.index, u));
        let Frenet { speed, tangent, .. } = frenet;
        let radius = frenet.radius();
        let chord = self.limits.feedrate_by_chord(radius, self.chord_bound_radius);
        let across = self.limits.feedrate_across(radius);
        let limited = self.budget.and_then(|budget| Some((budget, frenet.curvature_vector()?)));
        let Some((budget, bend)) = limited else {
            let feedrate = chord.min(across);
            return Sample { u, speed, tangent, radius, bend: [R::zero(); D], feedrate, beside_stop: across };
        };
        let beside_stop = budget.feed_at(&Turning::at(&tangent, &bend), across);
        Sample { u, speed, tangent, radius, bend, feedrate: chord.min(beside_stop), beside_stop }
    }

    /// Length of the path between two samples, and how far the limit dips in between.
    fn measure<const D: usize>(&self, from: &Sample<R, D>, to: &Sample<R, D>) -> Stretch<R>
    where
        C: Differentiate<R, D>,
    {
        let width = to.u - from.u;
        let inner: [Sample<R, D>; 5] =
            core::array::from_fn(|i| self.sample(from.u + width * self.rule.points[i]));
        let length = width * self.rule.mean(&inner.map(|sample| sample.speed));

        let speeds = [from.speed, inner[2].speed, to.speed];
        let shares = core::array::from_fn(|i| arc_share(speeds, self.rule.points[i + 1]));
        let course_of = |feed: fn(&Sample<R, D>) -> R| {
            let [_, within @ .., _] = inner.each_ref().map(feed);
            let highest = inner.iter().fold(R::zero(), |most, sample| most.max(feed(sample)));
            let (margin, is_straight) = dip([feed(from), feed(to)], within, shares);
            (Course { margin, highest }, is_straight)
        };
        let (course, is_straight) = course_of(|sample| sample.feedrate);
        let (beside_stop, _) = course_of(|sample| sample.beside_stop);
        let is_short = length <= self.longest + self.longest;
        let is_turning_little = cosine(from, to) >= R::one().half();
        // Or else no parameter can be told from a distance.
        let (slowest, fastest) = speeds
            .iter()
            .fold((speeds[0], speeds[0]), |(least, most), speed| (least.min(*speed), most.max(*speed)));
        let is_even = fastest <= slowest + slowest;
        let is_fine = is_straight && is_short && is_turning_little && is_even;
        let turning = self.turning(from, &inner, to);
        let mut tangents = from.tangent.iter().zip(to.tangent);
        let bends = tangents.any(|(a, b)| (*a - b).abs() > R::resolution().scale(ROUNDING));
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
}

impl<R: Real, C> Span<'_, R, C> {
    /// The largest components of tangent, curvature and its change on a stretch; the change from differences between
    /// neighbours, an eighth added for what it may be in between.
    fn turning<const D: usize>(
        &self,
        from: &Sample<R, D>,
        inner: &[Sample<R, D>; 5],
        to: &Sample<R, D>,
    ) -> Turning<R> {
        let mut turning = Turning::none();
        if self.budget.is_none() {
            return turning;
        }
        let mut previous = from;
        for sample in core::iter::once(from).chain(inner).chain(core::iter::once(to)) {
            let length = (sample.u - previous.u) * (sample.speed + previous.speed).half();
            let difference =
                components(&core::array::from_fn::<R, D, _>(|d| sample.bend[d] - previous.bend[d]));
            let mut here = Turning::at(&sample.tangent, &sample.bend);
            if length > R::zero() {
                here.change = difference.map(|x| x / length + (x / length).scale(-3));
            }
            turning = turning.max(&here);
            previous = sample;
        }
        turning
    }
}

/// By how much `V²` may dip below the straight line between the feeds at both ends of a stretch, and whether it keeps to that line
/// at the places where it is known: the three `shares` of the length.
fn dip<R: Real>([from, to]: [R; 2], within: [R; 3], shares: [R; 3]) -> (R, bool) {
    let (begin, rise) = (from * from, (to - from) * (to + from));
    let (mut margin, mut is_straight) = (R::zero(), true);
    for (share, feed) in shares.into_iter().zip(within) {
        let line = begin + rise * share;
        let dip = line - feed * feed;
        margin = margin.max(dip);
        is_straight &= dip.abs() <= line.scale(STRAIGHTNESS);
    }
    // The dip between the three places is at most a little deeper than at the deepest of them.
    (margin + margin.scale(-2), is_straight)
}

/// Share of the arc length of a stretch that lies before the share `x` of its parameters, `|C'|` taken as the
/// parabola through its values at 0, ½ and 1.
fn arc_share<R: Real>([begin, middle, end]: [R; 3], x: R) -> R {
    // |C'| = b + (e - b - q) x + q x², q = 2(b - 2m + e)
    let q = (begin + end - middle - middle).scale(1);
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
