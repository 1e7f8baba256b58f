//! A part for a controller: path and plan in one format, as the source of a Rust module.

use std::fmt::Write;

use nurbs_core::{Joint, Piece};
use real::Backend;
use secant_interp::{
    CompiledPath, Constant, Crossing, LengthStage, PeriodLimits, PieceInterpolator, PositionChecksum,
    Section, StageShape, TABLE_LAYOUT, number_function, number_type,
};

use crate::refusal::Refusal;
use crate::run::job::Job;
use crate::run::on_pieces;

/// A module of constants, and the results that a controller must reproduce.
#[derive(Clone, Debug, PartialEq)]
pub struct Constants {
    /// The module: `Number`, `PERIOD_S`, `PERIODS`, `CHECKSUM`, `PATH` and `SECTIONS`.
    pub source: String,
    /// Sections from stop to stop.
    pub sections: usize,
    /// Rows of the tables.
    pub pieces: usize,
    /// Stages of the plan.
    pub stages: usize,
    /// Bytes of all tables, on a controller of 32 bits.
    pub bytes: usize,
    /// Setpoints of all runs.
    pub periods: usize,
    /// [`PositionChecksum`] of all setpoints.
    pub checksum: u64,
    /// What a period may take.
    pub limits: PeriodLimits,
    /// p of the pieces.
    pub degree: usize,
    /// Whether the pieces have no weights and no corners within a section, and no stage is a cosine: the kind of part that bounds
    /// of a period are known for.
    pub is_plain: bool,
}

impl Constants {
    /// Compiles the part and its plan, and runs the result. The plan must rest at each gap of the part.
    pub(crate) fn of<R: Backend, const D: usize>(job: &Job<'_, D>) -> Result<Self, Refusal> {
        let number = number_type(R::name()).ok_or(Refusal::NoType(R::name()))?;
        let path = on_pieces::compiled::<R, D>(job)?;
        let whole = path.interpolator();
        let (periods, checksum) = run(&whole, path.sections(), job.most_periods())?;
        let mut constants = Self {
            source: String::new(),
            sections: path.sections().len(),
            pieces: path.table().places().len(),
            stages: path.stages().len(),
            bytes: bytes(&path),
            periods,
            checksum,
            limits: path.period_limits(),
            degree: path.interpolator().pieces.degree,
            is_plain: is_plain(&path),
        };
        constants.source = constants.module(&number, &whole, path.sections(), job.problem.period_s());
        Ok(constants)
    }

    /// The text of the module.
    fn module<R: Backend, const D: usize>(
        &self,
        number: &str,
        path: &PieceInterpolator<'_, R, D>,
        sections: &[Section],
        period_s: f64,
    ) -> String {
        let Self { periods, checksum, .. } = self;
        let [major, minor] = secant_interp::VERSION;
        let mut text = String::from(USES);
        let _ = write!(
            text,
            "const _: () = assert!(\n    matches!(secant_interp::VERSION, [{major}, {minor}]),\n    \
             \"these constants are for secant-interp {major}.{minor}: take that version, or run `feedbits compile` again\"\n);\n\
             const _: () = secant_interp::TablesOf::<{TABLE_LAYOUT}>::ARE_READ;\n\n"
        );
        let _ = write!(
            text,
            "/// The number format.\npub type Number = {number};\n\n\
             /// T, the interpolation period, in s.\n{UNASKED}pub const PERIOD_S: f64 = {period_s:?};\n\n\
             /// Setpoints from begin to end.\n{UNASKED}pub const PERIODS: usize = {periods};\n\n\
             /// `secant_interp::PositionChecksum` of all of them.\n{UNASKED}pub const CHECKSUM: u64 = {checksum:#018x};\n\n\
             /// Path and plan.\npub static PATH: PieceInterpolator<'static, Number, {D}> = {};\n\n\
             /// From stop to stop.\n{UNASKED}pub static SECTIONS: [Section; {}] = [\n",
            Constant(path),
            sections.len()
        );
        for Section { pieces, stages } in sections {
            let _ = writeln!(text, "    Section {{ pieces: {pieces:?}, stages: {stages:?} }},");
        }
        text += "];\n";
        if let Some(function) = number_function(R::name()) {
            text += "\n";
            text += &function;
        }
        text
    }
}

/// See [`Constants::is_plain`].
fn is_plain<R: Backend, const D: usize>(path: &CompiledPath<R, D>) -> bool {
    let pieces = path.interpolator().pieces;
    let within = |section: &Section| section.pieces.start..section.pieces.end.saturating_sub(1);
    let rows = path.sections().iter().filter_map(|section| pieces.pieces.get(within(section)));
    let has_corners = rows.flatten().any(|row| row.joint == Joint::Breaks);
    let has_cosines = path.stages().iter().any(|stage| stage.shape == StageShape::Cosine);
    !pieces.is_rational() && !has_corners && !has_cosines
}

/// The attribute before items that a program need not use.
const UNASKED: &str = "#[allow(dead_code, reason = \"a program need not ask\")]\n";

/// The imports for the names in the constants.
const USES: &str = "use nurbs_core::{Joint, Piece, Pieces};
use secant_interp::{ChordTolerance, Crossing, LengthStage, PieceInterpolator, StageShape, StepLengths, Section};

";

/// The number of setpoints of the runs from stop to stop, and the checksum of their positions.
pub(crate) fn run<R: Backend, const D: usize>(
    path: &PieceInterpolator<'_, R, D>,
    sections: &[Section],
    most: u64,
) -> Result<(usize, u64), Refusal> {
    let mut checksum = PositionChecksum::default();
    let mut periods = 0;
    for run in sections.iter().map(|section| path.on(section)) {
        let mut state = run.start();
        while let Some(setpoint) = run.step(&mut state) {
            checksum.add(run.pieces.position(setpoint.piece, &setpoint.offset));
            periods += 1;
            if periods as u64 > most {
                return Err(Refusal::Unfinished { periods, format: R::name() });
            }
        }
    }
    Ok((periods, checksum.value()))
}

/// Bytes of the tables, with numbers in words of the format and addresses in words of 32 bits.
fn bytes<R: Backend, const D: usize>(path: &CompiledPath<R, D>) -> usize {
    fn of<W, const D: usize>(rows: [usize; 4]) -> usize {
        let stage = size_of::<LengthStage<W>>() + size_of::<Crossing<W>>();
        let sizes = [size_of::<Piece<W, D>>(), size_of::<[W; D]>(), size_of::<W>(), stage];
        rows.iter().zip(sizes).map(|(count, size)| count * size).sum()
    }
    let pieces = path.table().as_pieces();
    let rows = [pieces.pieces.len(), pieces.numerators.len(), pieces.weights.len(), path.stages().len()];
    let sections = size_of::<[u32; 4]>() * path.sections().len();
    sections
        + match R::name().bits() {
            8 => of::<u8, D>(rows),
            16 => of::<u16, D>(rows),
            32 => of::<u32, D>(rows),
            _ => of::<u64, D>(rows),
        }
}
