//! Costs of operations from instructions that were counted: `data/target-costs.toml`, which `scripts/firmware` writes.
//!
//! Two things are counted. Each operation is counted alone, with the call, the loads of its operands and the store of
//! its result. Whole steps are counted along two paths. In a step an operation has no call, but its numbers come from
//! tables, and registers spill. A library's soft float may be inlined, and is then cheaper than its call. So an
//! operation costs
//!
//! `(counted - counted copy)·g + λ`,
//!
//! where g and λ ≥ 0 are the same for all operations of a format. With g = 1, λ is chosen so that the costs of the
//! operations of a step of each path, summed over both paths, equal the traced steps. If the sum exceeds the traced
//! steps even with λ = 0, g < 1 is chosen instead. One number is fitted to two paths, one of which has half as many
//! operations again as the other. `feedbits targets --check` prints how well each step is predicted: least well one of
//! f32 on an FPU, because little of it is arithmetic.

use std::collections::BTreeMap;

use serde::Deserialize;

use crate::cycles::{Cycles, Level};
use crate::error::TargetError;
use crate::target::{Confidence, Known, Measure, Row, Target, Unknown};
use crate::task::Priced;

const COMMITTED: &str = include_str!("../../../data/target-costs.toml");
/// The committed counts.
#[derive(Clone, Debug, Deserialize)]
pub struct Calibration {
    toolchain: BTreeMap<String, String>,
    operations: BTreeMap<String, BTreeMap<String, Operations>>,
    target: Vec<Counted>,
}

/// Mean operations of a step.
type Operations = BTreeMap<String, f64>;

#[derive(Clone, Debug, Deserialize)]
struct Counted {
    name: String,
    format: Vec<CountedFormat>,
}

#[derive(Clone, Debug, Deserialize)]
struct CountedFormat {
    name: String,
    #[serde(default)]
    step: BTreeMap<String, CountedStep>,
    #[serde(default)]
    operation: BTreeMap<String, Cost>,
}

#[derive(Clone, Debug, Deserialize)]
struct CountedStep {
    instructions: Cost,
}

#[derive(Clone, Copy, Debug, Deserialize)]
struct Cost {
    mean: f64,
    cycles: Known,
}

impl Cost {
    fn of(&self, measure: Measure) -> Option<Cycles> {
        match (measure, self.cycles) {
            (Measure::Instructions, _) => Some(Cycles::exactly(self.mean)),
            (Measure::Cycles, Known::Cycles(cycles)) => Some(cycles),
            (Measure::Cycles, Known::Not(Unknown::Unknown)) => None,
        }
    }
}

/// The conversion from the cost of an operation alone to its cost in a step: g and λ.
#[derive(Clone, Copy, Debug)]
struct InAStep {
    gain: Cycles,
    overhead: Cycles,
}

/// A traced step beside its prediction from the costs of operations.
#[derive(Clone, Debug, PartialEq)]
pub struct Prediction {
    /// The number format.
    pub format: String,
    /// The path.
    pub path: String,
    /// Mean of a step, from the emulator.
    pub traced: Cycles,
    /// The sum of its operations' costs.
    pub predicted: Cycles,
}

impl Calibration {
    /// Reads the committed counts.
    ///
    /// # Errors
    /// [`TargetError::Toml`] if the file has been damaged.
    pub fn committed() -> Result<Self, TargetError> {
        toml::from_str(COMMITTED)
            .map_err(|error| TargetError::Toml { file: "data/target-costs.toml".to_string(), error })
    }

    /// The compiler and the emulator.
    #[must_use]
    pub fn toolchain(&self) -> &BTreeMap<String, String> {
        &self.toolchain
    }

    /// `target` with a row for each counted operation in each format, and rows for the other fixed-point formats of
    /// the same word.
    pub(crate) fn complete(&self, file: &str, mut target: Target) -> Result<Target, TargetError> {
        let counted = self.target.iter().find(|counted| counted.name == target.name);
        let missing = || TargetError::NotCalibrated { file: file.to_string(), name: target.name.clone() };
        let counted = counted.ok_or_else(missing)?;
        for format in &counted.format {
            let rows = self.rows(counted, format, target.measure);
            // A 32-bit format stands for all formats of one word, a 64-bit format for all of two words.
            let word = match format.name.as_str() {
                "I4F28" => Some(32),
                "I4F60" => Some(64),
                _ => None,
            };
            if let Some(bits) = word {
                let general = |row: &Row| Row {
                    numbers: "fixed".to_string(),
                    max_bits: Some(bits),
                    confidence: Confidence::Medium,
                    source: format!("as {}: {}", row.numbers, row.source),
                    ..row.clone()
                };
                target.operation.extend(rows.iter().map(general));
            }
            target.operation.extend(rows);
        }
        Ok(target)
    }

    fn rows(&self, counted: &Counted, format: &CountedFormat, measure: Measure) -> Vec<Row> {
        let in_a_step = self.in_a_step(counted, format, measure);
        let row = |(operation, cycles): (Priced, Option<Cycles>)| {
            let cycles = cycles.zip(in_a_step).map(|(alone, InAStep { gain, overhead })| {
                Cycles::each(|level| alone.at(level) * gain.at(level) + overhead.at(level))
            });
            Row {
                name: operation,
                numbers: format.name.clone(),
                max_bits: None,
                cycles: cycles.map_or(Known::Not(Unknown::Unknown), |cycles| Known::Cycles(ordered(cycles))),
                per_bit: 0.0,
                per_fraction_bit: 0.0,
                busy: None,
                unit: None,
                dsp_blocks: 0,
                luts: 0,
                source: "counted in the emulator by scripts/firmware, data/target-costs.toml".to_string(),
                confidence: Confidence::High,
            }
        };
        alone(format, measure).into_iter().map(row).collect()
    }

    /// g and λ of a format. If its own steps were not traced, those of the format that is nearest in width.
    fn in_a_step(&self, counted: &Counted, format: &CountedFormat, measure: Measure) -> Option<InAStep> {
        let stands_in = match format.name.as_str() {
            "I32F32" | "I16F48" => "I4F60",
            name if name.starts_with('I') && format.step.is_empty() => "I4F28",
            name => name,
        };
        let traced = counted.format.iter().find(|known| known.name == stands_in)?;
        let (mut measured, mut sums, mut operations_made) = (Cycles::default(), Cycles::default(), 0.0);
        for (path, step) in &traced.step {
            let operations = self.operations.get(stands_in)?.get(path)?;
            measured = measured + step.instructions.of(measure)?;
            sums = sums + sum(operations, &alone(traced, measure))?;
            operations_made += count(operations);
        }
        let ratio = |level: Level| measured.at(level) / sums.at(level);
        Some(InAStep {
            gain: Cycles::each(|level| ratio(level).min(1.0)),
            overhead: Cycles::each(|level| {
                ((measured.at(level) - sums.at(level)) / operations_made).max(0.0)
            }),
        })
    }

    /// Every traced step of a target beside the sum of its operations' costs.
    #[must_use]
    pub fn predictions(&self, target: &str, measure: Measure) -> Vec<Prediction> {
        let mut predictions = Vec::new();
        for counted in self.target.iter().filter(|counted| counted.name == target) {
            for format in &counted.format {
                for (path, step) in &format.step {
                    let prediction = || {
                        let InAStep { gain, overhead } = self.in_a_step(counted, format, measure)?;
                        let operations = self.operations.get(&format.name)?.get(path)?;
                        let alone = sum(operations, &alone(format, measure))?;
                        let count = count(operations);
                        let predicted = |level| alone.at(level) * gain.at(level) + overhead.at(level) * count;
                        Some(Prediction {
                            format: format.name.clone(),
                            path: path.clone(),
                            traced: step.instructions.of(measure)?,
                            predicted: Cycles::each(predicted),
                        })
                    };
                    predictions.extend(prediction());
                }
            }
        }
        predictions
    }
}

/// Low, typical and high in this order: differences of intervals may be slightly out of order.
fn ordered(cycles: Cycles) -> Cycles {
    let typical = cycles.typical.max(0.0);
    Cycles { low: cycles.low.clamp(0.0, typical), typical, high: cycles.high.max(typical) }
}

/// Each operation alone, without the copying of its operands.
fn alone(format: &CountedFormat, measure: Measure) -> Vec<(Priced, Option<Cycles>)> {
    let cost = |name: &str| format.operation.get(name).and_then(|cost| cost.of(measure));
    let less = |name: &str, than: &str| {
        let (cost, than) = (cost(name)?, cost(than)?);
        Some(Cycles::each(|level| (cost.at(level) - than.at(level)).max(0.0)))
    };
    let own = |name: &str| less(name, "copy");
    // The kernel `to_phase` also makes a number of its phase again.
    let convert = own("fraction").zip(less("to_phase", "fraction")).map(|(from, to)| (from + to) * 0.5);
    // Powers of two are usually known when the program is built.
    let scale = own("half");
    vec![
        (Priced::Add, own("add")),
        (Priced::Compare, own("max")),
        (Priced::Mul, own("mul")),
        (Priced::MulAdd, own("mul_add")),
        (Priced::SumOfProducts, own("sum_of_products")),
        (Priced::Div, own("div")),
        (Priced::Sqrt, own("sqrt")),
        (Priced::Norm, own("norm")),
        (Priced::Scale, scale),
        (Priced::Convert, convert),
    ]
}

/// Number of operations of a step, of all kinds. Each product of a sum beyond the second counts as one operation.
fn count(operations: &Operations) -> f64 {
    let of = |name: &str| operations.get(name).copied().unwrap_or(0.0);
    let listed: f64 = operations.iter().filter(|(name, _)| !name.ends_with("_terms")).map(|(_, n)| n).sum();
    listed
        + more_terms(of("sum_of_products"), of("sum_of_products_terms"))
        + more_terms(of("norm"), of("norm_terms"))
}

fn more_terms(sums: f64, terms: f64) -> f64 {
    (terms - 2.0 * sums).max(0.0)
}

/// The costs of the operations of a step, added up.
fn sum(operations: &Operations, costs: &[(Priced, Option<Cycles>)]) -> Option<Cycles> {
    let cost =
        |operation: Priced| costs.iter().find(|(name, _)| *name == operation).and_then(|(_, cost)| *cost);
    let of = |name: &str| operations.get(name).copied().unwrap_or(0.0);
    let mut sum = cost(Priced::MulAdd)?
        * (more_terms(of("sum_of_products"), of("sum_of_products_terms"))
            + more_terms(of("norm"), of("norm_terms")));
    for (operation, _) in costs {
        let count = of(operation.name());
        if count > 0.0 {
            sum = sum + cost(*operation)? * count;
        }
    }
    Some(sum)
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::built_in;

    /// The additive model against the emulator.
    #[test]
    fn steps_are_predicted_as_well_as_said() {
        let calibration = Calibration::committed().unwrap();
        let mut checked = 0;
        for target in built_in().unwrap().iter().filter(|target| target.calibrated) {
            for p in calibration.predictions(&target.name, target.measure) {
                let ratio = p.predicted.typical / p.traced.typical;
                println!("{} {} {}: {ratio:.3}", target.name, p.format, p.path);
                let has_fpu = ["cortex-m4f", "cortex-m7"].contains(&target.name.as_str());
                let bound = if has_fpu && p.format == "f32" { 0.18 } else { 0.11 };
                assert!((ratio - 1.0).abs() <= bound, "{} {p:?}: {ratio:.4}", target.name);
                checked += 1;
            }
        }
        assert!(checked >= 50, "{checked} steps");
    }

    /// Cheap and dear in the same order as the emulator has them, where they differ by more than a fifth.
    #[test]
    fn formats_are_ranked_as_in_the_emulator() {
        let calibration = Calibration::committed().unwrap();
        for target in built_in().unwrap().iter().filter(|target| target.calibrated) {
            let steps = calibration.predictions(&target.name, target.measure);
            for (a, b) in steps.iter().flat_map(|a| steps.iter().map(move |b| (a, b))) {
                if a.path == b.path && a.traced.typical > 1.2 * b.traced.typical {
                    assert!(a.predicted.typical > b.predicted.typical, "{}: {a:?} {b:?}", target.name);
                }
            }
        }
    }
}
