//! The cost of a run on a target: of its mean step, and of its dearest.

use std::collections::BTreeMap;

use real::FormatName;
use serde::Serialize;

use crate::cycles::Cycles;
use crate::recorded_run::RecordedRun;
use crate::schedule::{NoPrice, StepCost};
use crate::target::{Kind, Measure, Target};
use crate::task::Priced;

/// The cost of a run on one target.
#[derive(Clone, Debug, PartialEq, Serialize)]
#[serde(untagged)]
pub enum Cost {
    /// Every operation has a price.
    Known(PeriodCost),
    /// An operation has no price, since nobody has published it.
    Unknown {
        /// The operation.
        unknown: &'static str,
    },
}

/// The cost of a period.
#[derive(Clone, Debug, PartialEq, Serialize)]
pub struct PeriodCost {
    /// Mean over the run.
    pub mean: f64,
    /// The dearest period of the run.
    pub max: f64,
    /// Low and high of the mean.
    pub mean_range: [f64; 2],
    /// Low and high of the dearest period.
    pub max_range: [f64; 2],
    /// The unit of the figures.
    pub measure: Measure,
    /// The source of the figures.
    pub level: CostSource,
    /// The dearest period, in microseconds, if the clock is known.
    pub microseconds_max: Option<f64>,
    /// Low and high of the dearest period, in microseconds: the fewest cycles at the fastest clock, the most at the slowest.
    pub microseconds_range: Option<[f64; 2]>,
    /// The dearest period as a share of the interpolation period, if the clock is known.
    pub share_of_period: Option<f64>,
    /// The kind of operation that takes most of the work.
    pub dominating: &'static str,
    /// The share of the work that this kind of operation takes.
    pub dominating_share: f64,
    /// DSP blocks, on an FPGA.
    #[serde(skip_serializing_if = "Option::is_none")]
    pub dsp_blocks: Option<u32>,
    /// LUTs of the units that are shared, on an FPGA.
    #[serde(skip_serializing_if = "Option::is_none")]
    pub luts: Option<u32>,
    /// On an FPGA, the least distance between the starts of two steps, of different axes.
    #[serde(skip_serializing_if = "Option::is_none")]
    pub initiation_interval_max: Option<f64>,
}

/// The source of a figure.
#[derive(Clone, Copy, Debug, PartialEq, Eq, Serialize)]
#[serde(rename_all = "snake_case")]
pub enum CostSource {
    /// The recorded step runs on a model of the target that is taken from manuals.
    Scheduled,
    /// The recorded step, where the cost of an operation was counted in an emulator of the instruction set.
    ScheduledOnCountedCosts,
}

impl PeriodCost {
    /// Whether the dearest period fits the interpolation period; unknown without a clock.
    #[must_use]
    pub fn fits(&self) -> Option<bool> {
        self.share_of_period.map(|share| share <= 1.0)
    }

    /// Whether the dearest period is certainly longer than another's: the ranges do not overlap.
    #[must_use]
    pub fn is_longer_than(&self, other: &Self) -> bool {
        match (self.microseconds_range, other.microseconds_range) {
            (Some(own), Some(other)) => own[0] > other[1],
            _ => self.max_range[0] > other.max_range[1],
        }
    }

    /// Whether it certainly costs more than another: on a processor time; on an FPGA no block and no LUT less, and one of them or the
    /// time more.
    #[must_use]
    pub fn is_dearer_than(&self, other: &Self) -> bool {
        let (own, other_size) = ((self.dsp_blocks, self.luts), (other.dsp_blocks, other.luts));
        let is_no_smaller = own.0 >= other_size.0 && own.1 >= other_size.1;
        is_no_smaller && (own != other_size || self.is_longer_than(other))
    }
}

/// Mean operations of a step, by kind.
#[must_use]
pub fn operations(run: &RecordedRun) -> BTreeMap<&'static str, f64> {
    let mut kinds = BTreeMap::new();
    let total: u32 = run.steps.iter().map(|(_, count)| count).sum();
    for (step, count) in &run.steps {
        for task in step.tasks.iter().filter(|task| task.operation != Priced::Load) {
            *kinds.entry(task.operation.name()).or_insert(0.0) += f64::from(*count) / f64::from(total.max(1));
        }
    }
    kinds
}

/// The cost of a period of the run on `target`. The period is the time that a step may take, if there is one.
#[must_use]
pub fn cost(run: &RecordedRun, target: &Target, format: FormatName, period_s: Option<f64>) -> Cost {
    let priced = run
        .steps
        .iter()
        .map(|(step, count)| Ok((StepCost::of(step, target, format)?, f64::from(*count))))
        .collect::<Result<Vec<_>, NoPrice>>();
    let priced = match priced {
        Ok(priced) => priced,
        Err(none) => return Cost::Unknown { unknown: none.operation.name() },
    };
    let steps: f64 = priced.iter().map(|(_, count)| count).sum();
    let mean = priced.iter().map(|(step, count)| step.length * (count / steps.max(1.0))).sum::<Cycles>();
    let max = priced.iter().map(|(step, _)| step.length).fold(Cycles::default(), Cycles::max);
    let mut work: BTreeMap<&'static str, f64> = BTreeMap::new();
    for (step, count) in &priced {
        step.work.iter().for_each(|(name, cycles)| *work.entry(name).or_insert(0.0) += cycles * count);
    }
    let all: f64 = work.values().sum();
    let (dominating, most) = work.into_iter().max_by(|a, b| a.1.total_cmp(&b.1)).unwrap_or(("nothing", 0.0));
    let clock = target.clock_mhz(format).filter(|_| target.measure == Measure::Cycles);
    let fpga = target.kind == Kind::Fpga;
    Cost::Known(PeriodCost {
        mean: mean.typical,
        max: max.typical,
        mean_range: [mean.low, mean.high],
        max_range: [max.low, max.high],
        measure: target.measure,
        level: if target.calibrated { CostSource::ScheduledOnCountedCosts } else { CostSource::Scheduled },
        microseconds_max: clock.map(|mhz| max.typical / mhz.typical),
        microseconds_range: clock.map(|mhz| [max.low / mhz.high, max.high / mhz.low]),
        share_of_period: clock
            .zip(period_s)
            .map(|(mhz, period_s)| max.typical / mhz.typical * 1e-6 / period_s),
        dominating,
        dominating_share: if all > 0.0 { most / all } else { 0.0 },
        dsp_blocks: fpga.then(|| priced.iter().map(|(step, _)| step.dsp_blocks).max().unwrap_or(0)),
        luts: fpga.then(|| priced.iter().map(|(step, _)| step.luts).max().unwrap_or(0)),
        initiation_interval_max: fpga
            .then(|| priced.iter().map(|(step, _)| step.initiation_interval.typical).fold(0.0, f64::max)),
    })
}
