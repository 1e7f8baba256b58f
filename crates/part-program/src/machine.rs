//! A machine's limits: the table `[machine]` of a TOML file.

use domains::machine::{
    ACCELERATION, CENTRIPETAL, CHORD_ERROR, DEVIATION, FEEDRATE, FLUCTUATION_LIMIT, INCREMENT, JERK,
    JUNCTION, KEYS, MAX_ITERATIONS, PARAMETER_TOLERANCE, PERIOD, S_STOPS,
};
use serde::ser::SerializeMap;
use serde::{Serialize, Serializer};
use toml::de::DeTable;

use crate::assumed_value::{AssumedValue, assumed};
use crate::axis_limits::{Axes, axes_from};
use crate::diagnostic::{Diagnostics, Report};
use crate::lean_toml::LeanToml;
use crate::source::Span;
use crate::text_length::{MAX_TEXT, opened};
use crate::toml_table::{self, TableReader};

/// The limits under which a part is run.
///
/// A file must give the period, the feedrate, the acceleration and the jerk, which differ between any two machines. The
/// other values set the quality of a run and the point at which a solver may stop. If a file does not give them, they
/// are
///
/// | limit | value | why |
/// |---|---|---|
/// | [`chord_error_mm`](Self::chord_error_mm) | 0.001 | the micrometre that a mill or a stage is built to; paper A takes half of it |
/// | [`position_increment_mm`](Self::position_increment_mm) | 1e-5 | 10 nm, FANUC's increment system IS-D |
/// | [`fluctuation_limit`](Self::fluctuation_limit) | 1e-4 | of a step of 0.1 mm, 100 mm/s at 1 ms, it is the 10 nm that drives tell apart: less could be computed, and no drive would see it |
/// | [`parameter_tolerance`](Self::parameter_tolerance) | 1e-10 | a nanometre of a path of 10 m, so that of the two tests of a solver the one of the fluctuation decides |
/// | [`s_stops`](Self::s_stops) | true | a spindle takes its time; a laser does not |
/// | [`max_iterations`](Self::max_iterations) | 8 | along the curves of papers A and D in `f64` a secant takes two on average, and the few steps, next to rest, that do not end within 5 do not end within 12 either: more give the same fluctuation |
#[derive(Clone, Debug, PartialEq, Serialize)]
pub struct Machine {
    /// T, time between two setpoints, in ms.
    pub interpolation_period_ms: f64,
    /// F, feedrate for moves for which the part commands none, in mm/s.
    pub feedrate_mm_per_s: f64,
    /// A, acceleration along the path, in mm/s².
    pub acceleration_mm_per_s2: f64,
    /// J, jerk along the path, in mm/s³.
    pub jerk_mm_per_s3: f64,
    /// E_max, distance allowed between chord and arc, in mm.
    pub chord_error_mm: f64,
    /// The least step that the drives resolve, in mm: a commanded position may be off the path by at most this.
    pub position_increment_mm: f64,
    /// Δ, feedrate fluctuation allowed, a ratio.
    pub fluctuation_limit: f64,
    /// ε, change of the parameter at which a solver may stop.
    pub parameter_tolerance: f64,
    /// K, iterations after which a solver must stop.
    pub max_iterations: u32,
    /// Whether the machine rests at S words, and at M3, M4 and M5: a laser's control passes them, as Grbl's does with `$32=1`.
    #[serde(skip_serializing_if = "is_true")]
    pub s_stops: bool,
    /// Acceleration across the path, in mm/s².
    #[serde(skip_serializing_if = "Option::is_none")]
    pub centripetal_acceleration_mm_per_s2: Option<f64>,
    /// How the plan passes a break of the tangent.
    #[serde(flatten)]
    pub junction: Junction,
    /// Limits of single axes.
    pub axes: Axes,
}

/// Serde hands over a reference.
#[allow(clippy::trivially_copy_pass_by_ref, reason = "as serde calls it")]
fn is_true(truth: &bool) -> bool {
    *truth
}

impl Machine {
    /// The largest chord error of a period that passes a corner, in mm, with the key that sets it: max(E, δ), where δ
    /// is `junction_deviation_mm`. With other junctions it is E.
    #[must_use]
    pub fn corner_error_mm(&self) -> (f64, &'static str) {
        match self.junction {
            Junction::DeviationMm(deviation) if deviation > self.chord_error_mm => {
                (deviation, DEVIATION.name)
            }
            _ => (self.chord_error_mm, CHORD_ERROR.name),
        }
    }
}

/// How the plan passes a break of the tangent: key `junction`.
#[derive(Clone, Copy, Debug, Default, PartialEq)]
pub enum Junction {
    /// `"stop"`, the default: at rest.
    #[default]
    Stop,
    /// `"deviation"`: as if rounded within this many mm, key `junction_deviation_mm`.
    DeviationMm(f64),
    /// `"velocity-jump"`: with a jump of each axis's velocity by at most `velocity_jump_mm_per_s` of the axis's table.
    /// An axis without this key may not jump at all.
    VelocityJump,
}

impl Junction {
    /// How far a motion may be from its setpoints in windows that hold a corner, beside what is hidden everywhere, in
    /// mm: where corners are passed as if rounded, the rounding may be that far away. `None` where the velocity may
    /// jump there: then no window with a corner is judged.
    #[must_use]
    pub fn hidden_at_corners_mm(self) -> Option<f64> {
        match self {
            Self::Stop => Some(0.0),
            Self::DeviationMm(deviation) => Some(deviation),
            Self::VelocityJump => None,
        }
    }
}

/// As in a file: one key, or two.
impl Serialize for Junction {
    fn serialize<S: Serializer>(&self, serializer: S) -> Result<S::Ok, S::Error> {
        let mut keys = serializer.serialize_map(None)?;
        let name = match self {
            Self::Stop => "stop",
            Self::DeviationMm(_) => "deviation",
            Self::VelocityJump => "velocity-jump",
        };
        keys.serialize_entry("junction", name)?;
        if let Self::DeviationMm(deviation) = self {
            keys.serialize_entry("junction_deviation_mm", deviation)?;
        }
        keys.end()
    }
}

/// Reads a machine file: TOML with a table `[machine]`. The other tables of a curve file may stand beside it.
///
/// # Errors
/// Every fault of the text, each at its place.
pub fn read_machine(name: &str, text: &str) -> Result<Machine, Diagnostics> {
    read_table(name, text, from_table)
}

/// The increment of the drives, in mm, if the machine states a coarser one than the default; else `None`.
#[must_use]
pub fn coarse_increment_mm(position_increment_mm: f64) -> Option<f64> {
    let default = INCREMENT.default_number().unwrap_or(0.0);
    (position_increment_mm > default).then_some(position_increment_mm)
}

/// The limits that a machine's file states for motions, of those that it states at all.
#[derive(Clone, Debug, Default, PartialEq, Serialize)]
pub struct StatedLimits {
    /// T, time between two setpoints, in ms.
    pub interpolation_period_ms: Option<f64>,
    /// F, in mm/s.
    pub feedrate_mm_per_s: Option<f64>,
    /// A, acceleration along the path, in mm/s².
    pub acceleration_mm_per_s2: Option<f64>,
    /// J, jerk along the path, in mm/s³.
    pub jerk_mm_per_s3: Option<f64>,
    /// Acceleration across the path, in mm/s².
    pub centripetal_acceleration_mm_per_s2: Option<f64>,
    /// How breaks of the tangent are passed.
    #[serde(flatten)]
    pub junction: Junction,
    /// Limits of single axes.
    pub axes: Axes,
    /// By which share a run's feed may be off at cruise. Neither this nor the next value is a limit of the motion.
    #[serde(skip)]
    pub fluctuation_limit: f64,
    /// The least step that the drives resolve, in mm.
    #[serde(skip)]
    pub position_increment_mm: f64,
    /// The values that the file assumes. They are not among the limits above. The junction is: it cannot be assumed.
    #[serde(skip_serializing_if = "Vec::is_empty")]
    pub assumed: Vec<AssumedValue>,
}

impl StatedLimits {
    /// The value that the file assumes for a key of the table `[machine]`, or of an axis.
    #[must_use]
    pub fn assumed_value(&self, axis: Option<&str>, key: &str) -> Option<f64> {
        self.assumed.iter().find(|one| one.axis == axis && one.key == key).map(|one| one.value)
    }

    /// The limits with those that the file assumes, as if it stated them.
    #[must_use]
    pub fn with_assumed(mut self) -> Self {
        for AssumedValue { axis, key, value } in std::mem::take(&mut self.assumed) {
            if let Some(limit) = self.limit(axis, key) {
                *limit = Some(value);
            }
        }
        self
    }

    /// The limits without those that the file assumes.
    fn without_assumed(mut self, assumed: Vec<AssumedValue>) -> Self {
        for AssumedValue { axis, key, .. } in &assumed {
            if let Some(limit) = self.limit(*axis, key) {
                *limit = None;
            }
        }
        Self { assumed, ..self }
    }

    /// The limit of a key, of those that a file may leave out.
    fn limit(&mut self, axis: Option<&str>, key: &str) -> Option<&mut Option<f64>> {
        let axes = &mut self.axes;
        let limits = match axis {
            None => vec![
                (&PERIOD, &mut self.interpolation_period_ms),
                (&FEEDRATE, &mut self.feedrate_mm_per_s),
                (&ACCELERATION, &mut self.acceleration_mm_per_s2),
                (&JERK, &mut self.jerk_mm_per_s3),
                (&CENTRIPETAL, &mut self.centripetal_acceleration_mm_per_s2),
            ],
            Some("x") => axes.x.by_keys(),
            Some("y") => axes.y.by_keys(),
            Some("z") => axes.z.by_keys(),
            Some("u") => axes.u.by_keys(),
            Some("v") => axes.v.by_keys(),
            Some("w") => axes.w.by_keys(),
            Some("a") => axes.a.by_keys(),
            Some("b") => axes.b.by_keys(),
            Some("c") => axes.c.by_keys(),
            Some(_) => Vec::new(),
        };
        limits.into_iter().find(|(of, _)| of.name == key).map(|(_, limit)| limit)
    }
}

/// Reads the limits of a machine file, each of which may be left out: a motion that was made is judged by those that
/// its machine has, and not by those that the file assumes.
///
/// # Errors
/// Every fault of the text, each at its place.
pub fn read_limits(name: &str, text: &str) -> Result<StatedLimits, Diagnostics> {
    read_table(name, text, limits_from_table)
}

/// Reads the table `[machine]` of a text by a function that returns `None` after it has reported an error.
fn read_table<T>(
    name: &str,
    text: &str,
    from_table: impl FnOnce(&mut Report<'_>, Span, &DeTable<'_>) -> Option<T>,
) -> Result<T, Diagnostics> {
    let mut report = opened(name, text, MAX_TEXT)?;
    let rest = LeanToml::of(text).into_rest();
    let machine = toml_table::parse(&mut report, &rest).and_then(|document| {
        toml_table::refuse_unknown_tables(&mut report, document.get_ref());
        let mut root = TableReader::new(&mut report, "the file", Span::default(), document.get_ref());
        let Some((header, table)) = root.table("machine") else {
            if !root.report.has_errors() {
                root.report.error(Span::default(), "the file has no table [machine]").expected(
                    "[machine] with interpolation_period_ms, feedrate_mm_per_s and the other limits",
                );
            }
            return None;
        };
        from_table(&mut report, header, table)
    });
    match (report.finish(), machine) {
        (Ok(_), Some(machine)) => Ok(machine),
        (Err(errors), _) => Err(errors),
        (Ok(_), None) => Err(Diagnostics::default()),
    }
}

/// Reads the limits of the table `[machine]`. Its other keys are read for their faults.
fn limits_from_table(report: &mut Report<'_>, header: Span, table: &DeTable<'_>) -> Option<StatedLimits> {
    let mut keys = TableReader::new(report, "[machine]", header, table);
    let mut limits = StatedLimits {
        interpolation_period_ms: keys.optional_number(&PERIOD),
        feedrate_mm_per_s: keys.optional_number(&FEEDRATE),
        acceleration_mm_per_s2: keys.optional_number(&ACCELERATION),
        jerk_mm_per_s3: keys.optional_number(&JERK),
        centripetal_acceleration_mm_per_s2: keys.optional_number(&CENTRIPETAL),
        junction: Junction::Stop,
        axes: Axes::default(),
        fluctuation_limit: 0.0,
        position_increment_mm: 0.0,
        assumed: Vec::new(),
    };
    keys.number(&CHORD_ERROR);
    limits.position_increment_mm = keys.number(&INCREMENT).unwrap_or_default();
    limits.fluctuation_limit = keys.number(&FLUCTUATION_LIMIT).unwrap_or_default();
    keys.number(&PARAMETER_TOLERANCE);
    keys.whole_number(&MAX_ITERATIONS);
    keys.truth_or(S_STOPS.name, true);
    limits.junction = junction(&mut keys);
    let mut assumed = assumed(&mut keys, None, &KEYS);
    let axes = keys.table("axes");
    keys.finish();
    let axes = axes.map(|(header, table)| axes_from(report, header, table));
    if let Some((axes, of_axes)) = axes {
        limits.axes = axes;
        assumed.extend(of_axes);
    }
    Some(limits.without_assumed(assumed))
}

/// Reads the table `[machine]`; `None` after an error was reported.
pub(crate) fn from_table(report: &mut Report<'_>, header: Span, table: &DeTable<'_>) -> Option<Machine> {
    let mut keys = TableReader::new(report, "[machine]", header, table);
    let interpolation_period_ms = keys.number(&PERIOD);
    let feedrate_mm_per_s = keys.number(&FEEDRATE);
    let acceleration_mm_per_s2 = keys.number(&ACCELERATION);
    let jerk_mm_per_s3 = keys.number(&JERK);
    let chord_error_mm = keys.number(&CHORD_ERROR);
    let position_increment_mm = keys.number(&INCREMENT);
    let fluctuation_limit = keys.number(&FLUCTUATION_LIMIT);
    let parameter_tolerance = keys.number(&PARAMETER_TOLERANCE);
    let max_iterations = keys.whole_number(&MAX_ITERATIONS);
    let s_stops = keys.truth_or(S_STOPS.name, true);
    let centripetal_acceleration_mm_per_s2 = keys.optional_number(&CENTRIPETAL);
    let junction = junction(&mut keys);
    // A plan keeps what a file assumes as what it states.
    assumed(&mut keys, None, &KEYS);
    let axes = keys.table("axes");
    keys.finish();
    let axes = axes.map_or_else(Axes::default, |(header, table)| axes_from(report, header, table).0);
    let jumps = [axes.x, axes.y, axes.z].map(|axis| axis.velocity_jump_mm_per_s);
    match junction {
        Junction::VelocityJump if jumps == [None; 3] => {
            let message = "`junction` is \"velocity-jump\", but no axis has `velocity_jump_mm_per_s`";
            report
                .error(header, message)
                .expected("a table [machine.axes.x] with it, for each axis that may jump");
        }
        Junction::Stop | Junction::DeviationMm(_) if jumps != [None; 3] => {
            let message = "`velocity_jump_mm_per_s` says nothing unless `junction` is \"velocity-jump\"";
            report.error(header, message).expected("a line `junction = \"velocity-jump\"` in [machine]");
        }
        _ => {}
    }
    Some(Machine {
        interpolation_period_ms: interpolation_period_ms?,
        feedrate_mm_per_s: feedrate_mm_per_s?,
        acceleration_mm_per_s2: acceleration_mm_per_s2?,
        jerk_mm_per_s3: jerk_mm_per_s3?,
        chord_error_mm: chord_error_mm?,
        position_increment_mm: position_increment_mm?,
        fluctuation_limit: fluctuation_limit?,
        parameter_tolerance: parameter_tolerance?,
        max_iterations: max_iterations?,
        s_stops,
        centripetal_acceleration_mm_per_s2,
        junction,
        axes,
    })
}

fn junction(keys: &mut TableReader<'_, '_, '_>) -> Junction {
    let named = keys.word(&JUNCTION);
    if named == Some("deviation") {
        return keys.number(&DEVIATION).map_or(Junction::Stop, Junction::DeviationMm);
    }
    if keys.optional_number(&DEVIATION).is_some() {
        let span = keys.optional(DEVIATION.name).map_or_else(Span::default, |value| value.span().into());
        let message = format!("`{}` says nothing unless `junction` is \"deviation\"", DEVIATION.name);
        keys.report.error(span, message).expected("a line `junction = \"deviation\"`");
    }
    if named == Some("velocity-jump") { Junction::VelocityJump } else { Junction::Stop }
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::axis_limits::AxisLimits;

    const GOOD: &str = "[machine]
interpolation_period_ms = 3.0
feedrate_mm_per_s = 200
acceleration_mm_per_s2 = 5000.0
jerk_mm_per_s3 = 400_000.0
chord_error_mm = 0.0005
fluctuation_limit = 1e-6
parameter_tolerance = 1e-6
max_iterations = 5
";

    #[test]
    fn reads_limits_and_axes() {
        let text = format!(
            "{GOOD}centripetal_acceleration_mm_per_s2 = 2500\n[machine.axes.x]\nvelocity_mm_per_s = 150\n\
             [machine.axes.z]\njerk_mm_per_s3 = 1e5\n"
        );
        let machine = read_machine("m.toml", &text).unwrap();
        assert_eq!(machine.feedrate_mm_per_s, 200.0);
        assert_eq!(machine.jerk_mm_per_s3, 400_000.0);
        assert_eq!(machine.max_iterations, 5);
        assert_eq!(machine.centripetal_acceleration_mm_per_s2, Some(2500.0));
        assert_eq!(machine.axes.x.velocity_mm_per_s, Some(150.0));
        assert_eq!(machine.axes.y, AxisLimits::default());
        assert_eq!(machine.axes.z.jerk_mm_per_s3, Some(1e5));
    }

    /// A log's machine states what it states; a word that is wrong is wrong here too.
    #[test]
    fn limits_may_be_left_out_and_not_misspelled() {
        let text = "[machine]\n[machine.axes.x]\nvelocity_mm_per_s = 100\n";
        let limits = read_limits("m.toml", text).unwrap();
        assert_eq!((limits.jerk_mm_per_s3, limits.axes.x.velocity_mm_per_s), (None, Some(100.0)));
        let of_machine = read_machine("m.toml", GOOD).unwrap();
        let stated = read_limits("m.toml", GOOD).unwrap();
        assert_eq!(stated.jerk_mm_per_s3, Some(of_machine.jerk_mm_per_s3));
        assert_eq!((stated.junction, stated.axes), (of_machine.junction, of_machine.axes));
        let errors = read_limits("m.toml", "[machine]\njerk_mm_per_s3 = -1\nfeed = 3\n").unwrap_err();
        assert_eq!(errors.count(), 2, "{errors}");
    }

    #[test]
    fn every_limit_is_checked_and_all_errors_are_said() {
        let text = "[machine]
interpolation_period_ms = 0
feedrate_mm_per_s = nan
acceleration_mm_per_s2 = -5000.0
jerk_mm_per_s3 = inf
chord_error_mm = \"fine\"
fluctuation_limit = 1.0
parameter_tolerance = 0.0
max_iterations = 0
centripetal_acceleration_mm_per_s2 = -1
feed_rate = 3
[machine.axes.x]
velocity = 3
[machine.axes.q]
";
        let errors = read_machine("m.toml", text).unwrap_err();
        let said: Vec<_> = errors.iter().map(|e| format!("{}:{} {}", e.line, e.column, e.message)).collect();
        let expected = [
            "2:27 `interpolation_period_ms` is 0",
            "3:21 `feedrate_mm_per_s` is NaN",
            "4:26 `acceleration_mm_per_s2` is -5000",
            "5:18 `jerk_mm_per_s3` is inf",
            "6:18 `chord_error_mm` holds a string",
            "7:21 `fluctuation_limit` is 1",
            "8:23 `parameter_tolerance` is 0",
            "9:18 `max_iterations` is 0",
            "10:38 `centripetal_acceleration_mm_per_s2` is -1",
            "11:1 unknown key `feed_rate` in [machine]",
            "13:1 unknown key `velocity` in [machine.axes.x]",
            "14:15 unknown key `q` in [machine.axes]",
        ];
        assert_eq!(said, expected);
    }

    /// What a file assumes is part of its machine, and no limit that a log is judged by.
    #[test]
    fn what_is_assumed_is_no_stated_limit() {
        let text = format!(
            "{GOOD}assumed = [\"jerk_mm_per_s3\", \"chord_error_mm\"]\n[machine.axes.y]\njerk_mm_per_s3 = 7\n\
             velocity_mm_per_s = 9\nassumed = [\"jerk_mm_per_s3\"]\n"
        );
        assert_eq!(read_machine("m.toml", &text).unwrap().jerk_mm_per_s3, 400_000.0);
        let limits = read_limits("m.toml", &text).unwrap();
        assert_eq!((limits.jerk_mm_per_s3, limits.axes.y.jerk_mm_per_s3), (None, None));
        assert_eq!(
            (limits.acceleration_mm_per_s2, limits.axes.y.velocity_mm_per_s),
            (Some(5000.0), Some(9.0))
        );
        assert_eq!(limits.assumed_value(None, "jerk_mm_per_s3"), Some(400_000.0));
        assert_eq!(limits.assumed_value(Some("y"), "jerk_mm_per_s3"), Some(7.0));
        let all = limits.with_assumed();
        assert_eq!((all.jerk_mm_per_s3, all.axes.y.jerk_mm_per_s3), (Some(400_000.0), Some(7.0)));
        let turning = format!(
            "{GOOD}[machine.axes.a]\njerk_deg_per_s3 = 8\nvelocity_deg_per_s = 5\nassumed = [\"jerk_deg_per_s3\"]\n"
        );
        let limits = read_limits("m.toml", &turning).unwrap();
        assert_eq!((limits.axes.a.jerk_deg_per_s3, limits.axes.a.velocity_deg_per_s), (None, Some(5.0)));
        assert_eq!(limits.with_assumed().axes.a.jerk_deg_per_s3, Some(8.0));
        for (list, expected) in [
            ("[\"jerk\"]", "`assumed` names \"jerk\", which has no value in [machine]"),
            ("[\"position_increment_mm\"]", "which has no value in [machine]"),
            ("[\"junction\"]", "which has no value in [machine]"),
            ("[3]", "`assumed` names 3, which has no value in [machine]"),
            ("\"jerk_mm_per_s3\"", "`assumed` holds a string"),
        ] {
            let text = format!("{GOOD}assumed = {list}\n");
            for errors in [read_limits("m.toml", &text).err(), read_machine("m.toml", &text).err()] {
                let said = errors.unwrap().to_string();
                assert!(said.contains(expected), "{list}: {said}");
            }
        }
    }

    #[test]
    fn junctions_are_chosen_and_contradictions_are_said() {
        let read = |more: &str| read_machine("m.toml", &format!("{GOOD}{more}"));
        assert_eq!(read("").unwrap().junction, Junction::Stop);
        assert_eq!(read("junction = \"stop\"\n").unwrap().junction, Junction::Stop);
        let deviation = read("junction = \"deviation\"\njunction_deviation_mm = 0.01\n").unwrap();
        assert_eq!(deviation.junction, Junction::DeviationMm(0.01));
        let jump = "junction = \"velocity-jump\"\n";
        let axis = "[machine.axes.y]\nvelocity_jump_mm_per_s = 5\n";
        let machine = read(&format!("{jump}{axis}")).unwrap();
        assert_eq!(machine.junction, Junction::VelocityJump);
        assert_eq!(machine.axes.y.velocity_jump_mm_per_s, Some(5.0));
        for (more, message) in [
            ("junction = \"fast\"\n", "`junction` is \"fast\""),
            ("junction = 3\n", "`junction` is 3"),
            ("junction = \"deviation\"\n", "`junction_deviation_mm` is missing in [machine]"),
            ("junction = \"deviation\"\njunction_deviation_mm = 0\n", "`junction_deviation_mm` is 0"),
            (
                "junction_deviation_mm = 0.01\n",
                "`junction_deviation_mm` says nothing unless `junction` is \"deviation\"",
            ),
            (jump, "`junction` is \"velocity-jump\", but no axis has `velocity_jump_mm_per_s`"),
            (axis, "`velocity_jump_mm_per_s` says nothing unless `junction` is \"velocity-jump\""),
        ] {
            let errors = read(more).unwrap_err();
            assert_eq!(errors.iter().next().unwrap().message, message, "{more}");
        }
    }

    #[test]
    fn a_table_beside_the_machine_that_no_reader_has_is_refused() {
        let read = |more: &str| read_machine("m.toml", &format!("{GOOD}{more}"));
        assert!(read("[curve]\ndegree = 3\n[table_1]\nf = 2\n").is_ok());
        let errors = read("[axes.x]\nvelocity_mm_per_s = 150\n").unwrap_err().to_string();
        assert!(
            errors.contains("unknown key `axes` in the file") && errors.contains("[machine.axes.x]"),
            "{errors}"
        );
        let errors = read("[machin.axes.x]\nvelocity_mm_per_s = 150\n").unwrap_err().to_string();
        assert!(errors.contains("did you mean `machine`"), "{errors}");
    }

    #[test]
    fn the_drives_increment_is_ten_nanometres_unless_the_file_says_another() {
        let read = |more: &str| read_machine("m.toml", &format!("{GOOD}{more}"));
        assert_eq!(read("").unwrap().position_increment_mm, 1e-5);
        assert_eq!(read("position_increment_mm = 1e-6\n").unwrap().position_increment_mm, 1e-6);
        let errors = read("position_increment_mm = 0\n").unwrap_err();
        assert_eq!(errors.iter().next().unwrap().message, "`position_increment_mm` is 0");
    }

    /// Only values that a user must look up are required.
    #[test]
    fn four_keys_are_a_machine() {
        let four = "[machine]\nfeedrate_mm_per_s = 50\nacceleration_mm_per_s2 = 1000\njerk_mm_per_s3 = 40000\n\
                    interpolation_period_ms = 1\n";
        let machine = read_machine("m.toml", four).unwrap();
        assert_eq!((machine.chord_error_mm, machine.position_increment_mm), (1e-3, 1e-5));
        assert_eq!((machine.fluctuation_limit, machine.parameter_tolerance), (1e-4, 1e-10));
        assert_eq!((machine.max_iterations, machine.junction), (8, Junction::Stop));
        let spelled = "chord_error_mm = 0.001\nposition_increment_mm = 1e-5\nfluctuation_limit = 1e-4\n\
                       parameter_tolerance = 1e-10\nmax_iterations = 8\njunction = \"stop\"\n";
        assert_eq!(read_machine("m.toml", &format!("{four}{spelled}")).unwrap(), machine);
        let keys: Vec<&str> = four.lines().skip(1).collect();
        for key in keys {
            let errors = read_machine("m.toml", &four.replace(key, "")).unwrap_err();
            let name = key.split(' ').next().unwrap();
            let said = errors.iter().map(|error| error.message.clone()).collect::<Vec<_>>();
            assert_eq!(said, [format!("`{name}` is missing in [machine]")]);
        }
        let errors = read_machine("m.toml", &format!("{four}max_iterations = 0\n")).unwrap_err();
        assert_eq!(errors.iter().next().unwrap().message, "`max_iterations` is 0");
    }

    #[test]
    fn a_key_without_its_unit_or_with_another_is_found() {
        for (key, meant) in [
            ("feedrate", "feedrate_mm_per_s"),
            ("feed_rate", "feedrate_mm_per_s"),
            ("acceleration_mm_per_s", "acceleration_mm_per_s2"),
            ("jerk", "jerk_mm_per_s3"),
            ("jerk_m_per_s3", "jerk_mm_per_s3"),
            ("interpolation_period", "interpolation_period_ms"),
            ("interpolation_period_us", "interpolation_period_ms"),
            ("chord_eror_mm", "chord_error_mm"),
            ("junction_deviation", "junction_deviation_mm"),
        ] {
            let errors = read_machine("m.toml", &format!("{GOOD}{key} = 1\n")).unwrap_err().to_string();
            assert!(errors.contains(&format!("did you mean `{meant}`?")), "{errors}");
        }
    }

    #[test]
    fn a_missing_limit_and_a_missing_table_are_named() {
        let errors = read_machine("m.toml", &GOOD.replace("feedrate_mm_per_s = 200\n", "")).unwrap_err();
        assert_eq!(errors.iter().next().unwrap().message, "`feedrate_mm_per_s` is missing in [machine]");
        let errors = read_machine("m.toml", "").unwrap_err();
        assert_eq!(errors.iter().next().unwrap().message, "the file has no table [machine]");
    }

    #[test]
    fn a_syntax_error_has_a_place() {
        let errors = read_machine("m.toml", "[machine]\nfeedrate_mm_per_s = = 3\n").unwrap_err();
        assert_eq!(errors.iter().next().unwrap().line, 2);
    }
}
