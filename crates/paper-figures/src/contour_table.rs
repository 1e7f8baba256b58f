//! Paper D's last comparison: the error of a curve cut by the fine straight moves of a CAM system against that of the NURBS.

use format_compare::{Options, Problem};
use nurbs_core::{Evaluate, NurbsBuf};
use part_program::{Part, write_g1};
use path_smooth::{FitOptions, fit_curves};
use serde::Serialize;
use servo_sim::{Servo, ServoParameters, contour_error};

use crate::error::PaperError;
use crate::judged::{Judged, machine, part, problem};
use crate::papers_data::{PAPER_D, SERVO};

/// The tolerance of a CAM system's straight moves, in mm: with it the printed error of 0.01 mm comes out.
const CAM_TOLERANCE_MM: f64 = 0.01;
/// A fine one.
const FINE_TOLERANCE_MM: f64 = 0.001;
/// F4000 as in the paper's circle test; limits of a machining centre. The control passes corners of the moves as if they were
/// rounded within their tolerance.
const MACHINE: &str = r#"[machine]
interpolation_period_ms = 1
feedrate_mm_per_s = 66.66666666666667
acceleration_mm_per_s2 = 1000
centripetal_acceleration_mm_per_s2 = 1000
jerk_mm_per_s3 = 50000
chord_error_mm = 0.0005
junction = "deviation"
junction_deviation_mm = 0.01
"#;

/// A path, run by one servo, and its distance from the curve that was drawn.
#[derive(Clone, Debug, PartialEq, Serialize)]
pub struct ContourRow {
    /// What the control reads.
    pub path: &'static str,
    /// Its curves or moves.
    pub curves: usize,
    /// The time of the run, in s.
    pub time_s: f64,
    /// Largest distance of a setpoint from the curve, in mm.
    pub setpoint_error_mm: f64,
    /// Largest distance of the table from the curve, in mm.
    pub contour_error_mm: f64,
    /// Root mean square of that distance, in mm.
    pub contour_error_rms_mm: f64,
    /// What the paper prints of its own part, in mm.
    #[serde(skip_serializing_if = "Option::is_none")]
    pub printed_mm: Option<f64>,
}

/// Runs paper D's curve as NURBS, as straight moves within 0.01 and 0.001 mm, and as curves fitted to the former, all planned
/// alike, through the drive of `data/servo.toml` at the setting of table 2, part d.
///
/// # Errors
/// [`PaperError`].
pub fn contour_table() -> Result<Vec<ContourRow>, PaperError> {
    let nurbs = part("paper D", PAPER_D)?;
    let cam = straight_moves(&nurbs, CAM_TOLERANCE_MM)?;
    let fine = straight_moves(&nurbs, FINE_TOLERANCE_MM)?;
    let fit = |every_point| {
        let options = FitOptions { every_point, ..FitOptions::within(CAM_TOLERANCE_MM) };
        fit_curves(&cam, &options).map(|fitted| fitted.path).map_err(PaperError::of("the fit"))
    };
    let [few, every] = [fit(false)?, fit(true)?];
    let rows = [
        ("G1 within 0.01 mm of the curve", &cam, Some(0.01)),
        ("these moves by convert --fit 0.01", &few, None),
        ("these by --fit 0.01 --every-point", &every, None),
        ("G1 within 0.001 mm of the curve", &fine, None),
        ("G06.2, the NURBS", &nurbs, Some(0.001)),
    ];
    let truth = problem(&nurbs, &machine("the machine", MACHINE)?)?;
    rows.into_iter().map(|(path, part, printed_mm)| row(path, part, printed_mm, &truth)).collect()
}

/// A part as the straight moves of a CAM system.
fn straight_moves(part: &Part, tolerance_mm: f64) -> Result<Part, PaperError> {
    let text = write_g1(part, tolerance_mm, None).map_err(PaperError::of("straight moves"))?;
    self::part("straight moves", &text)
}

fn row(
    path: &'static str,
    part: &Part,
    printed_mm: Option<f64>,
    truth: &Problem<2>,
) -> Result<ContourRow, PaperError> {
    let problem = problem(part, &truth.machine)?;
    let judged = Judged::new(&problem, &Options::default())?;
    let setpoints: Vec<[f64; 2]> =
        judged.run.steps.iter().map(|step| [step.point_mm[0], step.point_mm[1]]).collect();
    let curves: Vec<_> = truth.curves.iter().map(NurbsBuf::as_curve).collect();
    let begin = curves.first().map(|curve| curve.point(curve.domain().0));
    let begin = begin.ok_or("no curve").map_err(PaperError::of(path))?;
    let drive = drive()?;
    let servo =
        Servo::<f64, 2>::try_new(&[drive; 2], problem.period_s(), begin).map_err(PaperError::of(path))?;
    let trace = servo.run(setpoints.iter().copied()).map_err(PaperError::of(path))?;
    let table = trace.contour_error(&curves).map_err(PaperError::of(path))?;
    let commanded = contour_error(&curves, setpoints).map_err(PaperError::of(path))?;
    Ok(ContourRow {
        path,
        curves: problem.curves.len(),
        time_s: judged.run.steps.len() as f64 * problem.period_s(),
        setpoint_error_mm: commanded.max,
        contour_error_mm: table.max,
        contour_error_rms_mm: table.rms,
        printed_mm,
    })
}

/// The drive at the setting of table 2, part d.
fn drive() -> Result<ServoParameters, PaperError> {
    let drive = ServoParameters::from_toml(SERVO).map_err(PaperError::of("the drive"))?;
    Ok(ServoParameters {
        feed_forward: 0.99,
        backlash_acceleration_mm_per_s2: 4000.0,
        backlash_acceleration_ms: 4.0,
        ..drive.with_velocity_gain(300.0)
    })
}
