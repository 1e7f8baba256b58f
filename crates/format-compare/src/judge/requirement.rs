//! The requirements that a good run keeps, each with the figure found, its place, and the largest value allowed.

use feed_plan::Lead;
use limit_judge::{LimitFinding, StepPlace, Worst};
use serde::Serialize;

use crate::problem::problem::Problem;
use crate::run::run::AboutRun;

/// The chord-error limit takes the curve of a step as a circle of the radius at one point; where the radius changes
/// within the step the true distance differs by a few parts in a thousand.
const CHORD_ERROR_SLACK: f64 = 5e-3;

/// Plans keep the limits that a machine states up to their last digits.
const LIMIT_SLACK: f64 = 1e-6;

/// Requirements of the motion, beside the limits that are judged by differences.
const OF_MOTION: [&str; 6] = [
    "stops before the end of the path",
    "chord error",
    "corner error",
    "distance from the end of the path",
    PLACE_AHEAD,
    CHORDS_AHEAD,
];

/// A run whose place on the path is ahead of its plan reaches a bend at the feed of the straight before it, and one whose chords are ahead
/// comes to the end of the path early.
const PLACE_AHEAD: &str = "place ahead of the plan";
const CHORDS_AHEAD: &str = "chords ahead of the plan";

/// One requirement of a run.
#[derive(Clone, Debug, PartialEq, Serialize)]
pub struct Requirement {
    /// The quantity that is measured.
    pub what: &'static str,
    /// The figure found.
    pub found: f64,
    /// The largest value allowed.
    pub limit: f64,
    /// The unit of both: `mm`, `ratio` or `count`.
    pub unit: &'static str,
    /// The period in which the figure was found, for figures that belong to one period.
    #[serde(skip_serializing_if = "Option::is_none")]
    pub at: Option<PeriodEnd>,
    /// How far a motion may be from the setpoints, in mm, for a limit that is kept by such a motion and not by the setpoints themselves.
    #[serde(skip_serializing_if = "Option::is_none")]
    pub seen_within_mm: Option<f64>,
    /// Whether it is a limit of the motion, which a controller in any format must keep, and not one of how finely the format computes.
    #[serde(skip)]
    pub is_of_motion: bool,
    /// The message for a requirement that is not kept.
    #[serde(skip)]
    pub broken: String,
}

/// The end of a period of a run.
#[derive(Clone, Copy, Debug, PartialEq, Serialize)]
pub struct PeriodEnd {
    /// The line of the move in the part, if it is known.
    #[serde(skip_serializing_if = "Option::is_none")]
    pub line: Option<usize>,
    /// Number of the period, from 1.
    pub period: u64,
    /// Time at its end, in s.
    pub time_s: f64,
    /// The commanded point, in mm, in the part's coordinates.
    pub point_mm: [f64; 3],
}

impl PeriodEnd {
    fn of<const D: usize>(problem: &Problem<D>, step: &StepPlace) -> Self {
        let period = step.index + 1;
        Self {
            line: problem.lines.get(step.curve).copied(),
            period,
            time_s: period as f64 * problem.period_s(),
            point_mm: step.point_mm,
        }
    }
}

impl Requirement {
    /// Whether the requirement is kept. It is not kept if the figure is NaN.
    #[must_use]
    pub fn holds(&self) -> bool {
        self.found <= self.limit
    }

    /// The figure as a share of the limit; `None` if the limit is 0.
    #[must_use]
    pub fn used(&self) -> Option<f64> {
        (self.limit > 0.0).then(|| self.found / self.limit)
    }
}

/// By how much a run is ahead of its plan, with the shares of the chord error that are allowed.
fn ahead(run: &AboutRun) -> impl Iterator<Item = (&'static str, f64, f64)> {
    let of = |lead: &Lead<f64>| [(PLACE_AHEAD, 0.5, lead.place), (CHORDS_AHEAD, 0.1, lead.chords)];
    run.lead.iter().flat_map(of)
}

/// The figures measured in a run.
#[derive(Default)]
pub(crate) struct Findings {
    pub(crate) fluctuation: Worst,
    pub(crate) saturations: u64,
    pub(crate) chord_error_mm: Worst,
    pub(crate) corner_error_mm: Worst,
    pub(crate) position_error_mm: Worst,
    pub(crate) end_error_mm: f64,
    /// What is taken of the limits that the machine states.
    pub(crate) limits: Vec<LimitFinding>,
    /// Number of steps, and the place of the last.
    pub(crate) periods: u64,
    pub(crate) last: Option<StepPlace>,
}

/// All requirements of a run. The one that tells most if it is broken comes first.
pub(crate) fn requirements<const D: usize>(
    run: &AboutRun,
    problem: &Problem<D>,
    found: &Findings,
) -> Vec<Requirement> {
    let machine = &problem.machine;
    let one = |what, (found, limit, unit): (f64, f64, _), step: Option<StepPlace>, broken: String| {
        let at = step.map(|step| PeriodEnd::of(problem, &step));
        // A part with a single move needs no line.
        let line = at.and_then(|at| at.line).filter(|_| problem.curves.len() > 1);
        let broken = line.map_or_else(|| broken.clone(), |line| format!("{broken} in line {line}"));
        let is_of_motion = OF_MOTION.contains(&what);
        Requirement { what, found, limit, unit, at, seen_within_mm: None, is_of_motion, broken }
    };
    let Findings { saturations, end_error_mm, .. } = *found;
    let last = found.last;
    let chord = machine.chord_error_mm;
    let (corner, corner_key) = machine.corner_error_mm();
    let off = chord.min(machine.position_increment_mm);
    let full_step = problem.full_step_mm();
    // The greater of both, or NaN if either is NaN.
    let [place, rounding] = [run.resolution_mm / full_step, run.fluctuation_resolution];
    let step_of_format = if place.total_cmp(&rounding).is_gt() { place } else { rounding };
    let increment = machine.position_increment_mm;
    let filament = run.filament_step_mm.map(|step| {
        let broken = format!(
            "steps of the filament of {step:.1e} > {increment:.1e} mm, {:.0} mm from its 0",
            problem.filament_mm.unwrap_or_default()
        );
        one("step of the filament's position", (step, increment, "mm"), None, broken)
    });
    let mut all = vec![
        one(
            "stops before the end of the path",
            (f64::from(u8::from(!run.finished)), 0.0, "count"),
            last.filter(|_| !run.finished),
            format!("stops before the end of the path, after {} periods", found.periods),
        ),
        one(
            "step of the format in a period's way",
            (step_of_format, 1.0, "ratio"),
            None,
            format!(
                "cannot run this feed: {full_step:.1e} mm a period is less than one step of {:.1e} mm",
                full_step * step_of_format
            ),
        ),
        one("overflows", (saturations as f64, 0.0, "count"), None, format!("{saturations} overflows")),
        one(
            "feedrate fluctuation at cruise",
            (found.fluctuation.figure, machine.fluctuation_limit, "ratio"),
            found.fluctuation.at,
            format!("fluctuation {:.1e} > {:.1e}", found.fluctuation.figure, machine.fluctuation_limit),
        ),
        one(
            "chord error",
            (found.chord_error_mm.figure, chord * (1.0 + CHORD_ERROR_SLACK), "mm"),
            found.chord_error_mm.at,
            format!("chord error {:.2e} > {chord:.2e} mm", found.chord_error_mm.figure),
        ),
        one(
            "corner error",
            (found.corner_error_mm.figure, corner * (1.0 + CHORD_ERROR_SLACK), "mm"),
            found.corner_error_mm.at,
            format!("corner error {:.2e} > {corner:.2e} mm of `{corner_key}`", found.corner_error_mm.figure),
        ),
        one(
            "position error",
            (found.position_error_mm.figure, off, "mm"),
            found.position_error_mm.at,
            format!("position error {:.1e} > {off:.1e} mm", found.position_error_mm.figure),
        ),
        one(
            "distance from the end of the path",
            (end_error_mm, chord, "mm"),
            last,
            format!("ends {end_error_mm:.1e} mm from the end"),
        ),
    ];
    all.extend(filament);
    for (what, share, found) in ahead(run) {
        let most = chord * share;
        let broken = format!("{what} by {found:.1e} > {most:.1e} mm");
        all.push(one(what, (found, most, "mm"), None, broken));
    }
    all.extend(found.limits.iter().map(|finding| {
        let LimitFinding { limit, taken, periods, seen_within_mm, .. } = finding;
        let over = if *periods == 1 { "a period".to_string() } else { format!("{periods} periods") };
        let broken = format!("{} {:.3} times its limit, seen over {over}", limit.what(), taken.figure);
        let row = one(limit.what(), (taken.figure, 1.0 + LIMIT_SLACK, "ratio"), taken.at, broken);
        Requirement { seen_within_mm: *seen_within_mm, is_of_motion: true, ..row }
    }));
    all
}

#[cfg(test)]
mod tests {
    use part_program::{read_machine, read_part};

    use super::*;
    use crate::Verdict;

    #[test]
    fn a_verdict_names_each_requirement_that_is_not_kept_and_no_other() {
        let machine = "[machine]\ninterpolation_period_ms = 3.0\nfeedrate_mm_per_s = 200.0\nacceleration_mm_per_s2 = 5000.0\n\
                       jerk_mm_per_s3 = 400000.0\nchord_error_mm = 0.0005\nfluctuation_limit = 1e-6\n";
        let part = read_part("p.nc", "G0 X0 Y0\nG1 X10 F6000\n").unwrap();
        let problem = Problem::<2>::new(&part, &read_machine("m.toml", machine).unwrap()).unwrap();
        let machine = &problem.machine;
        let (chord, limit) = (machine.chord_error_mm, machine.fluctuation_limit);
        let increment = machine.position_increment_mm;
        let full_step = problem.full_step_mm();
        let judged = |change: fn(&mut AboutRun, &mut Findings, f64), figure: f64| {
            let mut run = AboutRun {
                finished: true,
                resolution_mm: 1e-6,
                fluctuation_resolution: 1e-9,
                ..AboutRun::default()
            };
            let mut found = Findings::default();
            change(&mut run, &mut found, figure);
            Verdict::of(&requirements(&run, &problem, &found))
        };
        fn lead(place: f64, chords: f64) -> Option<Lead<f64>> {
            Some(Lead { place, chords, at: 0.0 })
        }
        type Change = fn(&mut AboutRun, &mut Findings, f64);
        // Each case: how a figure is set, the largest value allowed, and the message for a greater one.
        let cases: [(Change, f64, &str); 10] = [
            (|run, _, figure| run.finished = figure == 0.0, 0.0, "stops before the end of the path"),
            (|run, _, figure| run.resolution_mm = figure, full_step, "cannot run this feed"),
            (|run, _, figure| run.fluctuation_resolution = figure, 1.0, "cannot run this feed"),
            (|_, found, figure| found.fluctuation.figure = figure, limit, "fluctuation "),
            (|_, found, figure| found.chord_error_mm.figure = figure, chord * 1.005, "chord error "),
            (|_, found, figure| found.corner_error_mm.figure = figure, chord * 1.005, "corner error "),
            (|_, found, figure| found.position_error_mm.figure = figure, increment, "position error "),
            (|_, found, figure| found.end_error_mm = figure, chord, "ends "),
            (|run, _, figure| run.lead = lead(figure, 0.0), chord * 0.5, "place ahead of the plan by "),
            (|run, _, figure| run.lead = lead(0.0, figure), chord * 0.1, "chords ahead of the plan by "),
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
}
