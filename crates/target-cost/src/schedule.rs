//! The begin and the end of each operation of a step on a target.
//!
//! A processor issues in program order. An operation begins when the one before it has been issued, its operands are
//! ready and its unit is free. A VLIW and an FPGA begin any operation that is ready; among several, the one with the
//! longest chain to the end goes first (list scheduling). In both cases no schedule is shorter than the critical path,
//! nor than the work of a unit divided by the number of such units.

use std::collections::BTreeMap;

use real::FormatName;
use serde::Serialize;

use crate::cycles::{Cycles, Level};
use crate::target::{Kind, Price, Target};
use crate::task::{Priced, Step, Task};

/// An operation of a step that the target does in one piece. A [`Task`] becomes one or more of them.
#[derive(Clone, Debug)]
struct Placeable {
    operation: Priced,
    price: Price,
    operands: Vec<usize>,
}

/// A step on a target.
#[derive(Clone, Debug, PartialEq)]
pub struct StepCost {
    /// From the first operation to the last result.
    pub length: Cycles,
    /// The longest chain of operations, each of which needs the result of the one before.
    pub critical_path: Cycles,
    /// Steps of other axes or paths may follow at this distance: the work of the busiest unit.
    pub initiation_interval: Cycles,
    /// Work by kind of operation, typical cycles.
    pub work: BTreeMap<&'static str, f64>,
    /// DSP blocks of all units that are used.
    pub dsp_blocks: u32,
    /// LUTs of all units that are used.
    pub luts: u32,
    /// The typical schedule, an entry each operation.
    pub placed: Vec<Placed>,
}

/// When an operation runs.
#[derive(Clone, Copy, Debug, PartialEq, Serialize)]
pub struct Placed {
    /// The operation.
    pub operation: Priced,
    /// The unit, by its place in the target's list.
    pub unit: Option<usize>,
    /// When it begins, in cycles.
    pub start: f64,
    /// When its result is there.
    pub end: f64,
}

/// Operations that a target has no price for in a format.
#[derive(Clone, Copy, Debug, PartialEq, Eq, Serialize)]
pub struct NoPrice {
    /// The first operation without a price.
    pub operation: Priced,
}

impl StepCost {
    /// Schedules `step`, whose numbers are of `format`, on `target`.
    ///
    /// # Errors
    /// [`NoPrice`] if an operation's cycles are unknown there.
    pub fn of(step: &Step, target: &Target, format: FormatName) -> Result<Self, NoPrice> {
        let todo = placeable(step, target, format)?;
        let length = Cycles::each(|level| length(&place(&todo, target, level)));
        let mut work = BTreeMap::new();
        for item in &todo {
            *work.entry(item.operation.name()).or_insert(0.0) += item.price.latency.typical;
        }
        // A unit is as large as its largest operation.
        let of_units = |size: fn(&Price) -> u32| {
            let mut units = vec![0_u32; target.unit.len()];
            for price in todo.iter().map(|item| item.price) {
                if let Some(unit) = price.unit {
                    units[unit] = units[unit].max(size(&price).saturating_mul(target.unit[unit].count));
                }
            }
            units.into_iter().fold(0, u32::saturating_add)
        };
        Ok(Self {
            length,
            critical_path: Cycles::each(|level| critical_path(&todo, level)),
            initiation_interval: Cycles::each(|level| initiation_interval(&todo, target, level)),
            work,
            dsp_blocks: of_units(|price| price.dsp_blocks),
            luts: of_units(|price| price.luts),
            placed: place(&todo, target, Level::Typical),
        })
    }

    /// The kind of operation that takes most of the work, and its share.
    #[must_use]
    pub fn dominating(&self) -> Option<(&'static str, f64)> {
        let total: f64 = self.work.values().sum();
        let (name, most) = self.work.iter().max_by(|a, b| a.1.total_cmp(b.1))?;
        (total > 0.0).then_some((name, most / total))
    }
}

/// The step in operations that the target prices.
fn placeable(step: &Step, target: &Target, format: FormatName) -> Result<Vec<Placeable>, NoPrice> {
    let mut todo = Vec::with_capacity(step.tasks.len());
    // The operation that yields the result of each task; `None` for a number that exists from the start.
    let mut results: Vec<Option<usize>> = Vec::with_capacity(step.tasks.len());
    for task in &step.tasks {
        let operands: Vec<usize> = task.operands.iter().filter_map(|operand| results[*operand]).collect();
        let mut lowering = Lowering { todo: &mut todo, target, format };
        results.push(lowering.task(task, operands)?);
    }
    Ok(todo)
}

struct Lowering<'a> {
    todo: &'a mut Vec<Placeable>,
    target: &'a Target,
    format: FormatName,
}

impl Lowering<'_> {
    fn task(&mut self, task: &Task, operands: Vec<usize>) -> Result<Option<usize>, NoPrice> {
        let has = |operation| self.target.row(operation, self.format).is_some();
        match task.operation {
            Priced::Load if !has(Priced::Load) => Ok(None),
            Priced::MulAdd if !has(Priced::MulAdd) => {
                let product = self.one(Priced::Mul, operands.clone())?;
                self.one(Priced::Add, [operands, vec![product]].concat()).map(Some)
            }
            Priced::SumOfProducts => self.sum_of_products(task.terms, operands).map(Some),
            Priced::Norm if has(Priced::Norm) => {
                let more = (2..task.terms).try_fold(operands, |chain, _| self.more(chain))?;
                self.one(Priced::Norm, more).map(Some)
            }
            Priced::Norm => {
                let sum = self.sum_of_products(task.terms, operands)?;
                self.one(Priced::Sqrt, vec![sum]).map(Some)
            }
            operation => self.one(operation, operands).map(Some),
        }
    }

    /// One operation at its price.
    fn one(&mut self, operation: Priced, operands: Vec<usize>) -> Result<usize, NoPrice> {
        let price = self.target.price(operation, self.format).ok_or(NoPrice { operation })?;
        self.todo.push(Placeable { operation, price, operands });
        Ok(self.todo.len() - 1)
    }

    /// Adds one more product to a sum.
    fn more(&mut self, operands: Vec<usize>) -> Result<Vec<usize>, NoPrice> {
        let task = Task { operation: Priced::MulAdd, terms: 1, operands: Vec::new() };
        Ok(self.task(&task, operands)?.into_iter().collect())
    }

    /// A sum at its own price plus that of each further product; without such a price, products and a chain of sums.
    fn sum_of_products(&mut self, terms: usize, operands: Vec<usize>) -> Result<usize, NoPrice> {
        if self.target.row(Priced::SumOfProducts, self.format).is_some() {
            let first = self.one(Priced::SumOfProducts, operands)?;
            let chain = (2..terms).try_fold(vec![first], |chain, _| self.more(chain))?;
            return Ok(chain.last().copied().unwrap_or(first));
        }
        let products: Vec<usize> =
            (0..terms.max(1)).map(|_| self.one(Priced::Mul, operands.clone())).collect::<Result<_, _>>()?;
        let (first, rest) = products.split_first().unwrap_or((&0, &[]));
        rest.iter().try_fold(*first, |sum, product| self.one(Priced::Add, vec![sum, *product]))
    }
}

fn length(placed: &[Placed]) -> f64 {
    placed.iter().map(|placed| placed.end).fold(0.0, f64::max)
}

fn critical_path(todo: &[Placeable], level: Level) -> f64 {
    to_the_end(todo, level).into_iter().fold(0.0, f64::max)
}

/// The longest chain from the begin of each operation to the end of the step.
fn to_the_end(todo: &[Placeable], level: Level) -> Vec<f64> {
    let mut after = vec![0.0_f64; todo.len()];
    for (index, item) in todo.iter().enumerate().rev() {
        after[index] += item.price.latency.at(level);
        for operand in &item.operands {
            after[*operand] = after[*operand].max(after[index]);
        }
    }
    after
}

/// How long an operation occupies its unit, or blocks the issue of the next.
fn busy(price: &Price, kind: Kind, level: Level) -> f64 {
    let default = if kind == Kind::Processor { price.latency.at(level) } else { 1.0 };
    price.busy.unwrap_or(default).min(price.latency.at(level).max(1.0))
}

fn initiation_interval(todo: &[Placeable], target: &Target, level: Level) -> f64 {
    let mut work = vec![0.0; target.unit.len()];
    for item in todo {
        if let Some(unit) = item.price.unit {
            work[unit] += busy(&item.price, target.kind, level) / f64::from(target.unit[unit].count);
        }
    }
    let issued = target.issue_per_cycle.map_or(0.0, |width| todo.len() as f64 / f64::from(width));
    work.into_iter().fold(issued, f64::max)
}

fn place(todo: &[Placeable], target: &Target, level: Level) -> Vec<Placed> {
    let mut machine = Machine::new(target, level);
    let mut ends = vec![f64::NAN; todo.len()];
    let mut placed = Vec::with_capacity(todo.len());
    let mut waiting: Vec<usize> = (0..todo.len()).collect();
    let urgency = to_the_end(todo, level);
    while !waiting.is_empty() {
        // `None` while an operand has no end yet.
        let ready = |index: usize| {
            todo[index].operands.iter().try_fold(0.0_f64, |latest, operand| {
                let end = ends[*operand];
                (!end.is_nan()).then(|| latest.max(end))
            })
        };
        let next = match target.kind {
            Kind::Processor => Some(0),
            // The operations that may begin earliest; among them the one with the longest chain to the end.
            Kind::Vliw | Kind::Fpga => {
                let start = |place: usize| {
                    let index = waiting[place];
                    ready(index).map(|t| (machine.earliest(&todo[index].price, t), -urgency[index], place))
                };
                let candidates = (0..waiting.len()).filter_map(start);
                candidates
                    .min_by(|a, b| a.0.total_cmp(&b.0).then(a.1.total_cmp(&b.1)))
                    .map(|(_, _, place)| place)
            }
        };
        let Some(place) = next else { break };
        let index = waiting.remove(place);
        let item = &todo[index];
        let start = machine.begin(&item.price, ready(index).unwrap_or(0.0));
        ends[index] = start + item.price.latency.at(level);
        placed.push(Placed { operation: item.operation, unit: item.price.unit, start, end: ends[index] });
    }
    placed
}

/// The occupied units and issues.
struct Machine<'a> {
    target: &'a Target,
    level: Level,
    /// For each unit, the time at which each of its copies becomes free.
    units: Vec<Vec<f64>>,
    /// A processor's next issue.
    in_order: f64,
    /// Number of issues in each cycle. The key is the bits of the whole number of the cycle, which sort as the numbers
    /// do.
    issued: BTreeMap<u64, u32>,
}

impl<'a> Machine<'a> {
    fn new(target: &'a Target, level: Level) -> Self {
        let units = target.unit.iter().map(|unit| vec![0.0; unit.count as usize]).collect();
        Self { target, level, units, in_order: 0.0, issued: BTreeMap::new() }
    }

    /// The copy of a unit that is free first.
    fn copy(&self, unit: usize) -> (usize, f64) {
        let copies = self.units[unit].iter().copied().enumerate();
        copies.min_by(|a, b| a.1.total_cmp(&b.1)).unwrap_or((0, 0.0))
    }

    /// The earliest begin of an operation whose operands are ready at `ready`.
    fn earliest(&self, price: &Price, ready: f64) -> f64 {
        let free = price.unit.map_or(0.0, |unit| self.copy(unit).1);
        let mut start = ready.max(free).max(self.in_order);
        if let Some(width) = self.target.issue_per_cycle.filter(|_| self.target.kind != Kind::Processor) {
            start = start.ceil();
            while self.issued.get(&start.to_bits()).is_some_and(|issued| *issued >= width) {
                start += 1.0;
            }
        }
        start
    }

    fn begin(&mut self, price: &Price, ready: f64) -> f64 {
        let start = self.earliest(price, ready);
        let busy = busy(price, self.target.kind, self.level);
        if let Some(unit) = price.unit {
            let copy = self.copy(unit).0;
            self.units[unit][copy] = start + busy;
        }
        match self.target.kind {
            Kind::Processor => {
                self.in_order = start + busy / f64::from(self.target.issue_per_cycle.unwrap_or(1))
            }
            Kind::Vliw | Kind::Fpga => *self.issued.entry(start.to_bits()).or_insert(0) += 1,
        }
        start
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::target::{Confidence, Known, Row, Unit};
    use proptest::prelude::*;

    const FORMAT: FormatName = FormatName::fixed(4, 28);

    fn row(name: Priced, cycles: f64, unit: Option<&str>, busy: Option<f64>) -> Row {
        Row {
            name,
            numbers: "fixed".into(),
            max_bits: None,
            cycles: Known::Cycles(Cycles::exactly(cycles)),
            per_bit: 0.0,
            per_fraction_bit: 0.0,
            busy,
            unit: unit.map(String::from),
            dsp_blocks: u32::from(unit == Some("multiplier")) * 4,
            luts: 0,
            source: "a test".into(),
            confidence: Confidence::High,
        }
    }

    fn target(kind: Kind, multipliers: u32, issue: Option<u32>) -> Target {
        Target {
            name: "test".into(),
            title: "Test".into(),
            kind,
            measure: Default::default(),
            issue_per_cycle: issue,
            clock: Vec::new(),
            unit: vec![
                Unit { name: "multiplier".into(), count: multipliers },
                Unit { name: "divider".into(), count: 1 },
            ],
            calibrated: false,
            operation: vec![
                row(Priced::Add, 1.0, None, None),
                row(Priced::Compare, 1.0, None, None),
                row(Priced::Mul, 3.0, Some("multiplier"), Some(1.0)),
                row(Priced::Div, 40.0, Some("divider"), Some(40.0)),
                row(Priced::Sqrt, 20.0, Some("divider"), Some(20.0)),
                row(Priced::Scale, 0.0, None, None),
                row(Priced::Convert, 1.0, None, None),
            ],
        }
    }

    fn step(tasks: &[(Priced, usize, &[usize])]) -> Step {
        let task = |(operation, terms, operands): &(Priced, usize, &[usize])| Task {
            operation: *operation,
            terms: *terms,
            operands: operands.to_vec(),
        };
        Step { tasks: tasks.iter().map(task).collect() }
    }

    /// Two products and their sum: with one multiplier 1 + 3 + 1 cycles, with two 3 + 1.
    #[test]
    fn a_sum_of_two_products_by_hand() {
        let step = step(&[(Priced::Load, 1, &[]), (Priced::SumOfProducts, 2, &[0, 0, 0, 0])]);
        for (multipliers, expected, interval) in [(1, 5.0, 2.0), (2, 4.0, 1.0)] {
            let cost = StepCost::of(&step, &target(Kind::Fpga, multipliers, None), FORMAT).unwrap();
            assert_eq!((cost.length.typical, cost.critical_path.typical), (expected, 4.0));
            assert_eq!(cost.initiation_interval.typical, interval);
            assert_eq!(cost.dsp_blocks, 4 * multipliers);
            assert_eq!(cost.dominating(), Some(("mul", 6.0 / 7.0)));
        }
    }

    /// On a processor that waits for each result, a step is the sum of its operations.
    #[test]
    fn a_processor_that_does_one_thing_at_a_time_takes_the_sum() {
        let tasks = step(&[
            (Priced::Load, 1, &[]),
            (Priced::Mul, 1, &[0, 0]),
            (Priced::Div, 1, &[0, 0]),
            (Priced::MulAdd, 1, &[1, 2, 0]),
        ]);
        let mut target = target(Kind::Processor, 1, None);
        target.operation.iter_mut().for_each(|row| row.busy = None);
        let cost = StepCost::of(&tasks, &target, FORMAT).unwrap();
        assert_eq!(cost.length.typical, 3.0 + 40.0 + 3.0 + 1.0);
    }

    #[test]
    fn an_operation_without_a_price_is_named() {
        let mut target = target(Kind::Fpga, 1, None);
        target.operation.retain(|row| row.name != Priced::Div);
        let refused = StepCost::of(&step(&[(Priced::Div, 1, &[])]), &target, FORMAT).unwrap_err();
        assert_eq!(refused.operation, Priced::Div);
    }

    fn any_step() -> impl Strategy<Value = Step> {
        let kinds = [Priced::Add, Priced::Mul, Priced::MulAdd, Priced::Div, Priced::Sqrt, Priced::Scale];
        let kinds =
            [&kinds[..], &[Priced::SumOfProducts, Priced::Norm, Priced::Load, Priced::Compare]].concat();
        let task = (
            prop::sample::select(kinds),
            1..5_usize,
            prop::collection::vec(any::<prop::sample::Index>(), 0..4),
        );
        prop::collection::vec(task, 1..80).prop_map(|tasks| Step {
            tasks: tasks
                .into_iter()
                .enumerate()
                .map(|(index, (operation, terms, operands))| Task {
                    operation,
                    terms,
                    operands: if index == 0 || operation == Priced::Load {
                        Vec::new()
                    } else {
                        operands.iter().map(|operand| operand.index(index)).collect()
                    },
                })
                .collect(),
        })
    }

    proptest! {
        /// No schedule is shorter than its critical path, nor than the work of a unit; none is longer than doing one
        /// thing after the other; and a unit never does two at a time.
        #[test]
        fn schedules_keep_their_bounds(
            step in any_step(),
            multipliers in 1..5_u32,
            issue in prop::option::of(1..9_u32),
            kind in prop::sample::select(vec![Kind::Processor, Kind::Vliw, Kind::Fpga]),
        ) {
            let target = target(kind, multipliers, issue);
            let cost = StepCost::of(&step, &target, FORMAT).unwrap();
            let total: f64 = cost.work.values().sum();
            let length = cost.length.typical;
            prop_assert!(length >= cost.critical_path.typical - 1e-9);
            prop_assert!(length + 1e-9 >= cost.initiation_interval.typical - 1.0, "{cost:?}");
            prop_assert!(length <= total + cost.placed.len() as f64 + 1e-9, "{length} {total}");
            for (index, a) in cost.placed.iter().enumerate() {
                let divider = Some(1);
                for b in cost.placed.iter().skip(index + 1).filter(|b| b.unit == divider && a.unit == divider) {
                    prop_assert!(a.end <= b.start || b.end <= a.start, "{a:?} {b:?}");
                }
                let together = cost.placed.iter().filter(|b| b.unit == Some(0) && b.start == a.start).count();
                prop_assert!(a.unit != Some(0) || together <= multipliers as usize);
            }
        }
    }
}
