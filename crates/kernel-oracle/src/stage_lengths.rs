//! The distances of periods over drawn stages, against the exact integral of the feed; and the clock that counts them.
//!
//! Stages begin and end anywhere in periods, and many may lie in one. Feeds and times of a case are numbers that every
//! format holds, so that what a period differs by is the rounding of its own computation.

use arbitrary::{Arbitrary, Unstructured};
use feed_plan::StageShape;
use real::{Backend, Datapath, DoubleDouble, I4F28, I16F48, Real, RuntimeFixed, RuntimeFormat};
use secant_interp::{LengthCursor, LengthStage, StepLengths, crossings};

use crate::fault::KernelFault;

/// One period in units of time.
const PERIOD: u64 = 1 << 32;
/// Feeds, and the bend of a shape, are whole numbers of 2⁻⁶: fine enough, and every format of the cases holds them.
const UNIT: i32 = -6;

/// A schedule of stages.
#[derive(Clone, Debug)]
pub struct StageCase {
    stages: Vec<DrawnStage>,
    /// Parts of periods by which the schedule is passed once more, as a run at a lower feed passes it.
    parts: Vec<u64>,
    /// Fraction bits of the run-time format.
    fraction_bits: u32,
}

#[derive(Clone, Copy, Debug)]
struct DrawnStage {
    duration: u64,
    feed: i32,
    change: i32,
    shape: StageShape<f64>,
}

impl<'a> Arbitrary<'a> for DrawnStage {
    fn arbitrary(bytes: &mut Unstructured<'a>) -> arbitrary::Result<Self> {
        let (feed, end) = (bytes.int_in_range(0..=64)?, bytes.int_in_range(0..=64)?);
        let places = bytes.int_in_range(0..=36)?;
        let shape = match bytes.int_in_range(0..=6)? {
            0 => StageShape::Cubic,
            1 => StageShape::Onset,
            2 => StageShape::Steady,
            3 => StageShape::Easing,
            4 => StageShape::Cosine,
            _ => StageShape::Bent(f64::from(bytes.int_in_range(-64..=64_i32)?).ldexp(UNIT)),
        };
        let duration = ((1 << places) + (bytes.arbitrary::<u64>()? & ((1 << places) - 1))).min(24 * PERIOD);
        Ok(Self { duration, feed, change: end - feed, shape })
    }
}

impl<'a> Arbitrary<'a> for StageCase {
    fn arbitrary(bytes: &mut Unstructured<'a>) -> arbitrary::Result<Self> {
        let count = bytes.int_in_range(1..=6)?;
        let stages = (0..count).map(|_| DrawnStage::arbitrary(bytes)).collect::<arbitrary::Result<_>>()?;
        // Parts may be tiny, but not all of them: the schedule would take 2³² of them a period.
        let least = |k: u32| if k == 0 { PERIOD / 64 } else { 1 };
        let parts =
            (0..8).map(|k| bytes.int_in_range(least(k)..=PERIOD)).collect::<arbitrary::Result<_>>()?;
        Ok(Self { stages, parts, fraction_bits: bytes.int_in_range(8..=62)? })
    }
}

impl DrawnStage {
    fn in_format<R: Backend>(&self) -> Option<LengthStage<R>> {
        let number = |units: i32| R::from_ratio(units, 1 << -UNIT);
        let stage = LengthStage::new(self.duration, number(self.feed), number(self.change))?;
        Some(stage.shaped(self.shape.try_map(|by| R::from_f64(by).ok_or(())).ok()?))
    }

    /// The distance up to the time `time` of the stage: `v t + Δv t₂ G(t/t₂)`, G the integral of the shape.
    fn distance(&self, time: u64) -> DoubleDouble {
        let of = |x: i32| DoubleDouble::from(f64::from(x)).ldexp(UNIT);
        let (t, whole) = (in_periods(time), in_periods(self.duration));
        let x = t / whole;
        let (square, cube) = (x * x, x * x * x);
        let third = DoubleDouble::from(1.0) / DoubleDouble::from(3.0);
        let integral = match self.shape {
            StageShape::Cubic => cube - (cube * x).half(),
            StageShape::Onset => cube * third,
            StageShape::Steady => square.half(),
            StageShape::Easing => square - cube * third,
            StageShape::Bent(by) => square.half() + DoubleDouble::from(by) * (square.half() - cube * third),
            StageShape::Cosine => DoubleDouble::from(integral_of_cosine(x.value())),
        };
        of(self.feed) * t + of(self.change) * whole * integral
    }
}

/// `x/2 - sin(πx)/(2π)`.
fn integral_of_cosine(x: f64) -> f64 {
    use std::f64::consts::PI;
    x / 2.0 - (PI * x).sin() / (2.0 * PI)
}

/// A time in periods, exactly: it has at most 40 digits.
fn in_periods(time: u64) -> DoubleDouble {
    DoubleDouble::from((time as f64).ldexp(-32))
}

impl StageCase {
    /// Passes the stages in f64, f32, I4F28, I16F48 and the run-time format.
    ///
    /// # Errors
    /// The first period whose distance is off the integral by more than its roundings, and the first disagreement of the clock.
    pub fn check(&self) -> Result<u32, KernelFault> {
        let mut periods = self.in_format::<f64>()?;
        periods += self.in_format::<f32>()?;
        periods += self.in_format::<I4F28>()?;
        periods += self.in_format::<I16F48>()?;
        let Datapath { rounding, overflow } = Datapath::default();
        let width = self.fraction_bits + 2;
        let Some(format) = RuntimeFormat::new(width, self.fraction_bits, rounding, overflow) else {
            return Ok(periods);
        };
        format.run::<0, _>(|| self.in_format::<RuntimeFixed<0>>()).map(|more| periods + more)
    }

    fn in_format<R: Backend>(&self) -> Result<u32, KernelFault> {
        let stages: Vec<LengthStage<R>> = self.stages.iter().filter_map(DrawnStage::in_format).collect();
        let crossed = crossings(&stages);
        let known = StepLengths { stages: &stages, crossings: &crossed };
        let plain = StepLengths { stages: &stages, crossings: &[] };
        let total: u64 = self.stages.iter().map(|stage| stage.duration).sum();
        let (mut first, mut second) = (LengthCursor::default(), LengthCursor::default());
        let (mut time, mut periods) = (0, 0);
        while let Some(length) = plain.advance(&mut first) {
            same::<R, _>("a period by its crossing", known.advance(&mut second), Some(length))?;
            same::<R, _>("the place behind a crossing", second, first)?;
            let next = (time + PERIOD).min(total);
            self.demand(length, (time, next))?;
            (time, periods) = (next, periods + 1);
        }
        same::<R, _>("a crossing behind the end", known.advance(&mut second), None)?;
        same::<R, _>("the time of all periods", time, total)?;
        same::<R, _>("the number of periods", plain.periods() as u64, u64::from(periods))?;
        self.in_parts(&plain, total)?;
        Ok(periods)
    }

    /// The same schedule by other parts of time.
    fn in_parts<R: Backend>(&self, lengths: &StepLengths<'_, R>, total: u64) -> Result<(), KernelFault> {
        let (mut cursor, mut time) = (LengthCursor::default(), 0);
        for part in self.parts.iter().cycle() {
            let Some(length) = lengths.advance_by(&mut cursor, *part) else { break };
            let next = (time + part).min(total);
            self.demand(length, (time, next))?;
            time = next;
        }
        same::<R, _>("the time of all parts", time, total)
    }

    /// Compares the distance of an interval with the integral.
    ///
    /// Each stage of the interval adds a part: the mean of the shape, off by up to six units of the resolution, for the
    /// middle and the width are cut and four products rounded; times the change of feed, which is at most 1; rounded
    /// with the feed to a digit of up to 2; times the part's length, cut; and the sum is rounded. That is ten units at
    /// most, of a sum that is no more than 2.
    fn demand<R: Backend>(&self, length: R, (from, to): (u64, u64)) -> Result<(), KernelFault> {
        let (mut begin, mut parts, mut exact) = (0, 0.0, DoubleDouble::from(0.0));
        for stage in &self.stages {
            let end = begin + stage.duration;
            let (low, high) = (from.max(begin), to.min(end));
            if low < high {
                parts += 1.0;
                exact = exact + (stage.distance(high - begin) - stage.distance(low - begin));
            }
            begin = end;
        }
        let (high, low) = length.to_f64_pair();
        let off = (DoubleDouble::new(high, low) - exact).value().abs();
        // The integral of a cosine is taken in f64, up to a time of 24 periods.
        let of_judge = if self.has_cosine() { 1e-13 } else { 0.0 };
        let bound = 10.0 * parts * R::resolution().to_f64() + of_judge;
        if off <= bound {
            return Ok(());
        }
        Err(KernelFault {
            what: format!("the distance from {from} to {to}"),
            format: R::name().to_string(),
            found: format!("{high:e}, off by {off:e}"),
            expected: format!("{:e}, within {bound:e}", exact.value()),
        })
    }

    fn has_cosine(&self) -> bool {
        self.stages.iter().any(|stage| stage.shape == StageShape::Cosine)
    }
}

fn same<R: Backend, T: PartialEq + std::fmt::Debug>(
    what: &str,
    found: T,
    expected: T,
) -> Result<(), KernelFault> {
    KernelFault::unless_equal::<R, _>(|| what.to_string(), found, expected)
}
