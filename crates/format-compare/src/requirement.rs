//! What a run must keep to be good, each with what was found and the most that is allowed.

use part_program::Junction;
use serde::Serialize;

use crate::{Fluctuation, Machine, Run};

/// The chord-error limit takes the curve of a step as a circle of the radius at one point; where the radius changes
/// within the step the true distance differs by a few parts in a thousand.
const CHORD_ERROR_SLACK: f64 = 5e-3;

/// One thing that a run must keep.
#[derive(Clone, Debug, PartialEq, Serialize)]
pub struct Requirement {
    /// What is measured.
    pub what: &'static str,
    /// What was found.
    pub found: f64,
    /// The most that is allowed.
    pub limit: f64,
    /// The unit of both: `mm`, `ratio` or `count`.
    pub unit: &'static str,
    /// What is said where it is not kept.
    #[serde(skip)]
    pub(crate) broken: String,
}

impl Requirement {
    /// Whether it is kept: a figure that is no number is not.
    #[must_use]
    pub fn holds(&self) -> bool {
        self.found <= self.limit
    }

    /// The part of the limit that is used; none where nothing at all is allowed.
    #[must_use]
    pub fn used(&self) -> Option<f64> {
        (self.limit > 0.0).then(|| self.found / self.limit)
    }
}

/// What was measured of a run.
pub(crate) struct Measured {
    pub(crate) fluctuation: Fluctuation,
    pub(crate) saturations: u64,
    pub(crate) chord_error_mm: f64,
    pub(crate) position_error_mm: f64,
    pub(crate) end_error_mm: f64,
}

/// All that a run must keep, what says most where it is not kept first.
pub(crate) fn requirements(run: &Run, machine: &Machine, measured: &Measured) -> Vec<Requirement> {
    let Measured { fluctuation, saturations, chord_error_mm, position_error_mm, end_error_mm } = *measured;
    let one =
        |what, (found, limit, unit): (f64, f64, _), broken| Requirement { what, found, limit, unit, broken };
    let chord = machine.chord_error_mm;
    let off = chord.min(machine.position_increment_mm);
    let full_step = machine.feedrate_mm_per_s * (machine.interpolation_period_ms / 1000.0);
    // The greater, or what is no number.
    let [place, rounding] = [run.resolution_mm / full_step, run.fluctuation_resolution];
    let step_of_format = if place.total_cmp(&rounding).is_gt() { place } else { rounding };
    vec![
        one(
            "stops before the end of the path",
            (f64::from(u8::from(!run.finished)), 0.0, "count"),
            format!("stops before the end of the path, after {} periods", run.steps.len()),
        ),
        one(
            "step of the format in a period's way",
            (step_of_format, 1.0, "ratio"),
            format!(
                "cannot run this feed: {full_step:.1e} mm a period is less than one step of {:.1e} mm",
                full_step * step_of_format
            ),
        ),
        one("overflows", (saturations as f64, 0.0, "count"), format!("{saturations} overflows")),
        one(
            "feedrate fluctuation at cruise",
            (fluctuation.cruise_max_abs, machine.fluctuation_limit, "ratio"),
            format!("fluctuation {:.1e} > {:.1e}", fluctuation.cruise_max_abs, machine.fluctuation_limit),
        ),
        one(
            "chord error",
            (chord_error_mm, chord * (1.0 + CHORD_ERROR_SLACK), "mm"),
            format!("chord error {chord_error_mm:.2e} > {chord:.2e} mm{}", allowed_at_corners(machine)),
        ),
        one(
            "position error",
            (position_error_mm, off, "mm"),
            format!("position error {position_error_mm:.1e} > {off:.1e} mm"),
        ),
        one(
            "distance from the end of the path",
            (end_error_mm, chord, "mm"),
            format!("ends {end_error_mm:.1e} mm from the end"),
        ),
    ]
}

/// Why the chord error may be exceeded by every format: the machine file lets corners be cut by more.
fn allowed_at_corners(machine: &Machine) -> String {
    match machine.junction {
        Junction::DeviationMm(deviation) if deviation > machine.chord_error_mm => format!(
            ": `junction_deviation_mm` lets corners be cut by {deviation} mm; lower it to `chord_error_mm`, or raise that to as much"
        ),
        _ => String::new(),
    }
}

#[cfg(test)]
mod tests {
    use real::Audit;

    use super::*;
    use crate::Verdict;

    #[test]
    fn a_verdict_names_each_requirement_that_is_not_kept_and_no_other() {
        let text = include_str!("../../../data/seed-000.toml");
        let machine = part_program::read_machine("seed-000.toml", text).unwrap();
        let (chord, limit) = (machine.chord_error_mm, machine.fluctuation_limit);
        let increment = machine.position_increment_mm;
        let full_step = machine.feedrate_mm_per_s * machine.interpolation_period_ms / 1000.0;
        let judged = |change: fn(&mut Run, &mut Measured, f64), figure: f64| {
            let audit = Audit::default();
            let fluctuation_resolution = 1e-9;
            let mut run = Run {
                steps: Vec::new(),
                finished: true,
                planned_periods: 0,
                resolution_mm: 1e-6,
                fluctuation_resolution,
                audit,
            };
            let mut measured = Measured {
                fluctuation: Fluctuation::default(),
                saturations: 0,
                chord_error_mm: 0.0,
                position_error_mm: 0.0,
                end_error_mm: 0.0,
            };
            change(&mut run, &mut measured, figure);
            Verdict::of(&requirements(&run, &machine, &measured))
        };
        type Change = fn(&mut Run, &mut Measured, f64);
        // What the figure is put into, the most that is allowed, and what is said beyond.
        let cases: [(Change, f64, &str); 7] = [
            (|run, _, figure| run.finished = figure == 0.0, 0.0, "stops before the end of the path"),
            (|run, _, figure| run.resolution_mm = figure, full_step, "cannot run this feed"),
            (|run, _, figure| run.fluctuation_resolution = figure, 1.0, "cannot run this feed"),
            (|_, found, figure| found.fluctuation.cruise_max_abs = figure, limit, "fluctuation "),
            (|_, found, figure| found.chord_error_mm = figure, chord * 1.005, "chord error "),
            (|_, found, figure| found.position_error_mm = figure, increment, "position error "),
            (|_, found, figure| found.end_error_mm = figure, chord, "ends "),
        ];
        for (change, most, said) in cases {
            assert_eq!(judged(change, most * 0.999), Verdict::Good, "{said}");
            for beyond in [most * 1.001 + 1e-9, f64::NAN] {
                let Verdict::Bad(reasons) = judged(change, beyond) else {
                    panic!("{said}: {beyond} is good")
                };
                assert!(reasons.len() == 1 && reasons[0].starts_with(said), "{reasons:?}");
            }
        }
        assert_eq!(
            judged(|_, found, _| found.saturations = 3, 0.0),
            Verdict::Bad(vec!["3 overflows".into()])
        );
    }

    /// The corners that the machine file lets be cut were called a chord error of the format.
    #[test]
    fn a_chord_error_that_the_junctions_allow_names_their_key() {
        let text = include_str!("../../../data/seed-000.toml");
        let mut machine = part_program::read_machine("seed-000.toml", text).unwrap();
        for (deviation, is_named) in [(1.01, true), (1.0, false)] {
            machine.junction = Junction::DeviationMm(deviation * machine.chord_error_mm);
            assert_eq!(
                allowed_at_corners(&machine).contains("`junction_deviation_mm`"),
                is_named,
                "{deviation}"
            );
        }
        machine.junction = Junction::Stop;
        assert_eq!(allowed_at_corners(&machine), "");
    }
}
