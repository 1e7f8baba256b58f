//! One pass along the path: samples of the feed limit over the arc length.
//!
//! Each span is walked in steps of the parameter that are short enough, then the local minima and cusps among
//! its samples are located, then the samples are appended to the path, with a stop in between where the
//! tangent breaks.

use alloc::vec::Vec;

use nurbs_core::Differentiate;
use real::Real;

use crate::feed_limit::Measured;
use crate::quadrature::{self, GaussLegendre};
use crate::{KinematicLimits, LimitPoint, PlanError};

/// At least 2⁴ stretches a span.
const COARSEST: i32 = -4;
/// No stretch shorter than 2⁻¹⁴ of a span.
const FINEST: i32 = -14;
/// Stretches tried in a span, those refused among them; what is left of the span is then one stretch.
const TRIALS: usize = 1 << 16;
/// A stretch over which `V²` leaves the straight line by more than 2⁻⁸ of itself is halved.
const STRAIGHTNESS: i32 = -8;
/// Steps of a golden-section search: 0.618²⁴ = 10⁻⁵ of two stretches. A limit is flat at its minimum, so that
/// the error of its value is of second order.
const GOLDEN_STEPS: usize = 24;
/// A limit below 2⁻¹² F is a stop.
const STOP: i32 = -12;
/// C' vanishes where it is below 2⁻⁶ of its value at the ends of the finest stretch.
const CUSP: i32 = -6;

/// The samples of the path so far.
pub(crate) struct Scan<'l, R, const D: usize> {
    limits: &'l KinematicLimits<R>,
    rule: GaussLegendre<R>,
    /// Longest stretch: the distance of one period at full feed.
    longest: R,
    /// Largest difference of unit tangents that is no corner.
    break_tolerance: R,
    distance: R,
    end_tangent: Option<[R; D]>,
    samples: Vec<Measured<R>>,
}

impl<'l, R: Real, const D: usize> Scan<'l, R, D> {
    pub(crate) fn new(limits: &'l KinematicLimits<R>) -> Self {
        let longest = limits.feedrate * limits.interpolation_period;
        let by_chord_error = limits.chord_error.scale(2) / longest;
        let by_acceleration = limits.acceleration * limits.interpolation_period / limits.feedrate;
        // The tangents' own rounding error is a few units.
        let break_tolerance = by_chord_error.min(by_acceleration).max(R::resolution().scale(4));
        let rule = GaussLegendre::new();
        let (distance, end_tangent, samples) = (R::zero(), None, Vec::new());
        Self { limits, rule, longest, break_tolerance, distance, end_tangent, samples }
    }

    /// Samples one curve.
    pub(crate) fn pass<C: Differentiate<R, D>>(&mut self, curve: usize, shape: &C) -> Result<(), PlanError> {
        for index in 0..shape.span_count() {
            let span = Span { shape, index, limits: self.limits, rule: &self.rule, longest: self.longest };
            let mut samples = span.walk();
            span.locate_extremes(&mut samples);
            self.append(curve, &samples).ok_or(PlanError::LengthOverflows { curve })?;
        }
        Ok(())
    }

    pub(crate) fn finish(self) -> Vec<Measured<R>> {
        self.samples
    }

    /// Appends a span; `None` when a distance does not increase as numbers of the format should.
    fn append(&mut self, curve: usize, samples: &[Sample<R, D>]) -> Option<()> {
        let (first, last) = (samples.first()?, samples.last()?);
        if self.breaks_at(first) {
            self.push(curve, &Sample { feedrate: R::zero(), ..*first });
        }
        let is_continuation =
            |end: &Measured<R>| end.point.curve == curve && end.point.feedrate == first.feedrate;
        if !self.samples.last().is_some_and(is_continuation) {
            self.push(curve, first);
        }
        for sample in &samples[1..] {
            let length = sample.stretch?.length;
            let next = self.distance + length;
            if !(length >= R::zero() && next >= self.distance && next.is_finite()) {
                return None;
            }
            self.distance = next;
            self.push(curve, sample);
        }
        self.end_tangent = Some(last.tangent);
        Some(())
    }

    fn push(&mut self, curve: usize, sample: &Sample<R, D>) {
        let is_stop = sample.feedrate < self.limits.feedrate.scale(STOP);
        let feedrate = if is_stop { R::zero() } else { sample.feedrate };
        let point = LimitPoint { distance: self.distance, curve, u: sample.u, feedrate };
        let margin = sample.stretch.map_or_else(R::zero, |stretch| stretch.margin);
        self.samples.push(Measured { point, speed: sample.speed, margin });
    }

    /// Whether the path has a corner where this sample begins a span.
    fn breaks_at(&self, first: &Sample<R, D>) -> bool {
        self.end_tangent.is_some_and(|end| {
            let difference: [R; D] = core::array::from_fn(|d| first.tangent[d] - end[d]);
            R::norm(&difference) > self.break_tolerance
        })
    }
}

/// The curve at one parameter.
#[derive(Clone, Copy)]
struct Sample<R, const D: usize> {
    u: R,
    /// `|C'|`.
    speed: R,
    tangent: [R; D],
    feedrate: R,
    /// The stretch from the previous sample, once measured.
    stretch: Option<Stretch<R>>,
}

/// The path between two samples.
#[derive(Clone, Copy)]
struct Stretch<R> {
    length: R,
    /// By how much `V²` dips below the straight line.
    margin: R,
    /// Whether it is straight and short enough not to be halved.
    is_fine: bool,
}

/// One span of a curve, under given limits.
struct Span<'a, R, C> {
    shape: &'a C,
    index: usize,
    limits: &'a KinematicLimits<R>,
    rule: &'a GaussLegendre<R>,
    longest: R,
}

impl<R: Real, C> Span<'_, R, C> {
    /// Samples from one end of the span to the other, close enough to each other.
    fn walk<const D: usize>(&self) -> Vec<Sample<R, D>>
    where
        C: Differentiate<R, D>,
    {
        let (begin, end) = self.shape.span_bounds(self.index);
        let (coarsest, finest) = ((end - begin).scale(COARSEST), (end - begin).scale(FINEST));
        let mut here = self.sample(begin);
        let mut samples = Vec::from([here]);
        let mut step = coarsest;
        for trial in 0..=TRIALS {
            let wanted = here.u + step.min(self.longest / here.speed).max(finest);
            let is_inside = wanted > here.u && wanted < end - finest && trial < TRIALS;
            let mut next = self.sample(if is_inside { wanted } else { end });
            let stretch = self.measure(&here, &next);
            let width = next.u - here.u;
            // A step of `finest` is never refused, even if rounding makes it a little wider.
            if !stretch.is_fine && width > finest + finest.half() && trial < TRIALS {
                step = width.half();
                continue;
            }
            next.stretch = Some(stretch);
            samples.push(next);
            if !is_inside {
                break;
            }
            here = next;
            step = (width + width).min(coarsest);
        }
        samples
    }

    /// Adds a sample at each local minimum of the limit and at each cusp that lies between two samples.
    fn locate_extremes<const D: usize>(&self, samples: &mut Vec<Sample<R, D>>)
    where
        C: Differentiate<R, D>,
    {
        let cusps = samples.windows(2).filter_map(|pair| self.cusp(&pair[0], &pair[1]));
        let minima = samples.windows(3).filter_map(|three| self.minimum([&three[0], &three[1], &three[2]]));
        let located: Vec<_> = cusps.chain(minima).collect();
        if located.is_empty() {
            return;
        }
        samples.extend(located);
        samples.sort_by(|a, b| a.u.partial_cmp(&b.u).unwrap_or(core::cmp::Ordering::Equal));
        for i in (1..samples.len()).rev() {
            // A located sample has no stretch yet, and that after it has one that is too long.
            if samples[i].stretch.is_none() || (i > 1 && samples[i - 1].stretch.is_none()) {
                samples[i].stretch = Some(self.measure(&samples[i - 1], &samples[i]));
            }
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
        let rounding = middle.feedrate * R::resolution().sqrt();
        let is_least =
            from.feedrate - middle.feedrate > rounding && to.feedrate - middle.feedrate >= rounding;
        if !is_least {
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
        let golden = (R::from_ratio(5, 4).sqrt() - R::one().half()).min(R::one()); // (√5 - 1)/2
        let (mut from, mut to) = (from, to);
        let mut low = self.sample(to - (to - from) * golden);
        let mut high = self.sample(from + (to - from) * golden);
        for _ in 0..GOLDEN_STEPS {
            if value(&low) < value(&high) {
                to = high.u;
                high = low;
                low = self.sample(to - (to - from) * golden);
            } else {
                from = low.u;
                low = high;
                high = self.sample(from + (to - from) * golden);
            }
        }
        let least = if value(&low) < value(&high) { low } else { high };
        (least.u > from && least.u < to).then_some(least)
    }

    /// The curve and its limit at one parameter.
    fn sample<const D: usize>(&self, u: R) -> Sample<R, D>
    where
        C: Differentiate<R, D>,
    {
        let at = self.shape.derivatives_in(self.index, u);
        let (speed, tangent) = direction(&at.first);
        let feedrate = self.limits.feedrate_at_radius(nurbs_core::radius(&at));
        Sample { u, speed, tangent, feedrate, stretch: None }
    }

    /// Length of the path between two samples, and how far the limit dips in between.
    fn measure<const D: usize>(&self, from: &Sample<R, D>, to: &Sample<R, D>) -> Stretch<R>
    where
        C: Differentiate<R, D>,
    {
        let width = to.u - from.u;
        let inner: [Sample<R, D>; quadrature::POINTS] =
            core::array::from_fn(|i| self.sample(from.u + width * self.rule.points[i]));
        let length = width * self.rule.mean(&inner.map(|sample| sample.speed));

        let speeds = [from.speed, inner[quadrature::POINTS / 2].speed, to.speed];
        let begin = from.feedrate * from.feedrate;
        let rise = (to.feedrate - from.feedrate) * (to.feedrate + from.feedrate);
        let (mut margin, mut is_straight) = (R::zero(), true);
        for (x, sample) in self.rule.points.into_iter().zip(&inner).skip(1).take(quadrature::POINTS - 2) {
            let line = begin + rise * arc_share(speeds, x);
            let dip = line - sample.feedrate * sample.feedrate;
            margin = margin.max(dip);
            is_straight &= dip.abs() <= line.scale(STRAIGHTNESS);
        }
        let is_short = length <= self.longest + self.longest;
        let is_turning_little = cosine(from, to) >= R::one().half();
        // The dip between the three places is at most a little deeper than at the deepest of them.
        Stretch {
            length,
            margin: margin + margin.scale(-2),
            is_fine: is_straight && is_short && is_turning_little,
        }
    }
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

/// Length and direction of C'; the direction of a vanishing vector is 0.
fn direction<R: Real, const D: usize>(first: &[R; D]) -> (R, [R; D]) {
    let speed = R::norm(first);
    let divisor = if speed > R::zero() { speed } else { R::one() };
    (speed, first.map(|component| component / divisor))
}

/// Cosine of the angle between the tangents of two samples.
fn cosine<R: Real, const D: usize>(from: &Sample<R, D>, to: &Sample<R, D>) -> R {
    R::sum_of_products(from.tangent.into_iter().zip(to.tangent))
}
