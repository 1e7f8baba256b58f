//! The values that the templates show, as text in C.

use feed_plan::sinc_terms;
use foreign_text::in_a_comment;
use nurbs_core::{Joint, ORIGIN_EXPONENT, Piece, Pieces};
use real::{Backend, FormatName, Real, Trigonometric, sine_terms};
use secant_interp::{Crossing, LANDING_REACH, LengthStage, Section, StageShape, TABLE_LAYOUT};

use crate::c_part::CPart;
use crate::exponents::{Exponents, MOST_UNROLLED};
use crate::factors::Factors;
use crate::literal::{described_type, number, number_type};
use crate::name::CError;
use crate::overridden_run::OverriddenRun;
use crate::shapes::Shape;

/// Everything that the templates ask for. Numbers are constants of C.
pub(crate) struct Values {
    pub(crate) name: String,
    pub(crate) upper: String,
    pub(crate) about: String,
    pub(crate) fault: Option<String>,
    pub(crate) version: &'static str,
    pub(crate) layout: u16,
    pub(crate) period_ns: u64,
    pub(crate) periods: usize,
    pub(crate) checksum: u64,
    pub(crate) overrides: bool,
    pub(crate) overridden: Option<OverriddenRun>,
    pub(crate) feeds: Feeds,
    pub(crate) landing_jerk: String,
    pub(crate) landing_reach: String,
    pub(crate) origin_exponent: i32,
    pub(crate) table_bytes: usize,
    // The path.
    pub(crate) axes: usize,
    pub(crate) degree: usize,
    pub(crate) rational: bool,
    pub(crate) coordinate_exponent: i32,
    pub(crate) chord_exponent: i32,
    pub(crate) position_exponent: i32,
    pub(crate) position_shift: u32,
    pub(crate) has_joints: bool,
    pub(crate) uses: Uses,
    pub(crate) shapes: Vec<Shape>,
    pub(crate) pieces: Vec<PieceRow>,
    pub(crate) numerators: Vec<String>,
    pub(crate) weights: Vec<String>,
    pub(crate) stages: Vec<StageRow>,
    pub(crate) crossings: Vec<CrossingRow>,
    pub(crate) sections: Vec<Section>,
    pub(crate) max_evaluations: u32,
    pub(crate) behind_joint: u32,
    pub(crate) residual: String,
    pub(crate) growth: String,
    pub(crate) fluctuation: String,
    pub(crate) landing_step: String,
    pub(crate) exponents: Exponents,
    pub(crate) factors: Factors,
    // The format.
    pub(crate) format: String,
    pub(crate) format_words: String,
    pub(crate) number_type: &'static str,
    pub(crate) floating: bool,
    pub(crate) adds_places: bool,
    pub(crate) word_bits: u32,
    pub(crate) fraction_bits: u32,
    pub(crate) words: Words,
    pub(crate) zero: String,
    pub(crate) one: String,
    pub(crate) one_half: String,
    pub(crate) one_third: String,
    pub(crate) three_eighths: String,
    pub(crate) three_quarters: String,
    pub(crate) half_pi: String,
    pub(crate) cosine_series: Vec<String>,
    pub(crate) sine_series: Vec<String>,
    pub(crate) sinc_series: Vec<String>,
    pub(crate) max: String,
    pub(crate) resolution: String,
}

/// Which rarer parts of the code a path needs.
#[derive(Clone, Copy, Debug, Default)]
pub(crate) struct Uses {
    /// A joint inside a section where the polynomial continues.
    pub(crate) continues: bool,
    /// A corner inside a section.
    pub(crate) breaks: bool,
    /// The feed changes somewhere.
    pub(crate) shapes: bool,
    /// It changes in several ways.
    pub(crate) many_shapes: bool,
    pub(crate) bent: bool,
    pub(crate) cosine: bool,
    /// A number is shifted by the width of its word or more.
    pub(crate) far_shifts: bool,
    /// The constant 1/3.
    pub(crate) third: bool,
}

/// The bounds of a feed override, in units of 2⁻³².
#[derive(Clone, Copy, Debug, Default)]
pub(crate) struct Feeds {
    pub(crate) slope: u64,
    pub(crate) bend: u64,
    pub(crate) commanded: u64,
}

/// The words of a fixed-point format, and the layout of a float.
#[derive(Clone, Copy, Debug, Default)]
pub(crate) struct Words {
    pub(crate) unsigned: &'static str,
    pub(crate) wide: &'static str,
    pub(crate) signed_wide: &'static str,
    pub(crate) wide_max: &'static str,
    /// The exponent of the greatest power of 4 in a wide word.
    pub(crate) root_shift: u32,
    /// Digits of the significand, and the exponent's bias.
    pub(crate) digits: u32,
    pub(crate) bias: i32,
    /// Significands are shifted by less than this to become phases.
    pub(crate) farthest: i32,
    /// Squares of numbers scaled by two to this stay in range.
    pub(crate) half_range: i32,
    pub(crate) least_normal: &'static str,
    pub(crate) fraction_unit: &'static str,
    pub(crate) two: &'static str,
    pub(crate) two_to_64: &'static str,
}

/// A row of the table of pieces.
pub(crate) struct PieceRow {
    pub(crate) origin: String,
    pub(crate) range: String,
    pub(crate) joint_ratio: u16,
    pub(crate) joint_exponent: i8,
    pub(crate) coordinate_exponent: i8,
    pub(crate) step_exponent: i8,
    pub(crate) range_exponent: i8,
    pub(crate) joint: &'static str,
}

/// A row of the table of stages.
pub(crate) struct StageRow {
    pub(crate) duration: u64,
    pub(crate) reciprocal: u64,
    pub(crate) numbers: String,
    pub(crate) reciprocal_exponent: u32,
    pub(crate) shape: &'static str,
}

/// A row of the table of periods in which a stage ends.
pub(crate) struct CrossingRow {
    pub(crate) rest: u32,
    pub(crate) time: u32,
    pub(crate) stages: u32,
    pub(crate) distance: String,
}

/// Who reads the files.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub(crate) enum Reader {
    /// A compiler of C, which has types of certain widths.
    Compiler,
    /// A compiler of hardware, which has numbers of its own widths.
    Hardware,
}

impl Values {
    pub(crate) fn of<R: Backend, const D: usize>(
        part: &CPart<'_, R, D>,
        overridden: Option<OverriddenRun>,
        reader: Reader,
    ) -> Result<Self, CError> {
        let format = R::name();
        let number_type = match reader {
            Reader::Compiler => number_type(format).ok_or(CError::NoType(format))?,
            Reader::Hardware => described_type(format).ok_or(CError::NoWidth(format))?,
        };
        let run = part.path.interpolator();
        let (pieces, stages, sections) = (run.pieces, run.lengths.stages, part.path.sections());
        if pieces.pieces.is_empty() || sections.iter().any(|section| section.pieces.is_empty()) {
            return Err(CError::Empty);
        }
        if u32::try_from(pieces.pieces.len().max(stages.len())).is_err() {
            return Err(CError::TooLong);
        }
        let shapes = Shape::all_of(stages);
        let uses = Uses::of(&pieces, sections, &shapes);
        let ratio = |n, d| number(R::from_ratio(n, d));
        let (word_bits, fraction_bits) = (format.bits(), fraction_bits(format));
        let landing_jerk =
            part.feed_override.map_or_else(R::zero, |by| by.feeds.landing_jerk(run.landing_step));
        let exponent = pieces.coordinate_exponent.wrapping_sub(ORIGIN_EXPONENT + 64);
        let mut values = Self {
            name: part.name.as_str().to_owned(),
            upper: part.name.upper(),
            about: in_a_comment(&part.about),
            fault: part.fault.as_deref().map(in_a_comment),
            version: env!("CARGO_PKG_VERSION"),
            layout: TABLE_LAYOUT,
            period_ns: (part.period_s * 1e9).to_phase(-64),
            periods: part.run.periods,
            checksum: part.run.checksum,
            overrides: overridden.is_some(),
            overridden,
            feeds: part.feed_override.map_or_else(Feeds::default, |by| Feeds {
                slope: by.feeds.slope(),
                bend: by.feeds.bend(),
                commanded: by.commanded.to_phase(-32),
            }),
            landing_jerk: number(landing_jerk),
            landing_reach: number(landing_jerk.ldexp(LANDING_REACH)),
            origin_exponent: pieces.chord_exponent.saturating_add(ORIGIN_EXPONENT + 64).clamp(-64, 64),
            table_bytes: 0,
            axes: D,
            degree: pieces.degree,
            rational: pieces.is_rational(),
            coordinate_exponent: pieces.coordinate_exponent,
            chord_exponent: pieces.chord_exponent,
            position_exponent: exponent.clamp(-64, 64),
            position_shift: (-64_i32).wrapping_sub(exponent).max(0).unsigned_abs(),
            has_joints: sections.iter().any(|section| section.pieces.len() > 1),
            uses,
            pieces: pieces.pieces.iter().map(PieceRow::of).collect(),
            numerators: pieces.numerators.chunks(pieces.degree).map(by_coordinate).collect(),
            weights: pieces.weights.chunks(pieces.degree + 1).map(numbers).collect(),
            stages: stages.iter().map(|stage| StageRow::of(stage, uses.bent, shapes.first())).collect(),
            shapes,
            crossings: run.lengths.crossings.iter().map(CrossingRow::of).collect(),
            sections: sections.to_vec(),
            max_evaluations: run.tolerance.max_evaluations,
            behind_joint: secant_interp::BEHIND_JOINT,
            exponents: Exponents::of(&pieces, uses.far_shifts),
            factors: Factors::of(&run),
            residual: number(run.tolerance.residual),
            growth: number(run.tolerance.growth),
            fluctuation: number(run.tolerance.fluctuation),
            landing_step: number(run.landing_step),
            format: format.to_string(),
            format_words: format_words(format),
            number_type,
            floating: R::IS_FLOATING,
            adds_places: R::ADDS_PLACES,
            word_bits,
            fraction_bits,
            words: Words::of(format),
            zero: number(R::zero()),
            one: number(R::one()),
            one_half: ratio(1, 2),
            one_third: ratio(1, 3),
            three_eighths: ratio(3, 8),
            three_quarters: number(R::from_ratio(1, 2) + R::from_ratio(1, 4)),
            half_pi: number(R::half_pi()),
            cosine_series: (1..=sine_terms::<R>()).map(|k| ratio(1, 2 * k * (2 * k - 1))).collect(),
            sine_series: (1..=sine_terms::<R>()).map(|k| ratio(1, 2 * k * (2 * k + 1))).collect(),
            sinc_series: (1..=sinc_terms::<R>()).map(|k| ratio(4, 2 * k * (2 * k + 1))).collect(),
            max: number(R::max_value()),
            resolution: number(R::resolution()),
        };
        values.table_bytes = values.bytes_of_tables();
        Ok(values)
    }

    /// Whether sweeps over the coefficients are written out.
    pub(crate) fn is_unrolled(&self) -> bool {
        self.degree <= MOST_UNROLLED
    }

    /// Whether a piece ends at a joint of this name. Where the code asks for corners, a piece ends at one.
    pub(crate) fn has_joint(&self, name: &str) -> bool {
        self.pieces.iter().any(|row| row.joint == name)
    }

    /// Whether a factor of order one may be split at 14 bits, so that its products need no word of 64.
    pub(crate) fn splits_factors(&self) -> bool {
        self.word_bits == 32 && (17..=28).contains(&self.fraction_bits)
    }

    /// Bytes of the tables on a controller of 32 bits, each row filled up to whole words of its widest member.
    fn bytes_of_tables(&self) -> usize {
        let number = self.word_bits as usize / 8;
        let filled = |bytes: usize| bytes.next_multiple_of(8);
        let small = if self.floating { 2 } else { 5 };
        let piece = filled((8 * self.axes + 2 * number).next_multiple_of(2) + 2 + small - 1);
        let stage = filled(16 + (3 + usize::from(self.uses.bent)) * number + 2);
        let crossing = (12 + number).next_multiple_of(number.max(4));
        let rows = self.pieces.len() * piece
            + self.stages.len() * stage
            + self.crossings.len() * crossing
            + self.sections.len() * 16;
        rows + number
            * (self.numerators.len() * self.degree * self.axes + self.weights.len() * (self.degree + 1))
    }
}

impl Uses {
    fn of<R: Backend, const D: usize>(
        pieces: &Pieces<'_, R, D>,
        sections: &[Section],
        shapes: &[Shape],
    ) -> Self {
        let width = R::name().bits().cast_signed();
        let inner = || {
            let all_but_last = |section: &Section| section.pieces.start..section.pieces.end.saturating_sub(1);
            sections.iter().flat_map(all_but_last).filter_map(|piece| pieces.pieces.get(piece))
        };
        let has = |name| shapes.iter().any(|shape| shape.name == name);
        Self {
            far_shifts: pieces.pieces.iter().any(|row| farthest_shift(pieces, row) >= width),
            continues: inner().any(|piece| piece.joint == Joint::Continues),
            breaks: inner().any(|piece| piece.joint == Joint::Breaks),
            shapes: !shapes.is_empty(),
            many_shapes: shapes.len() > 1,
            bent: has("BENT"),
            cosine: has("COSINE"),
            third: has("BENT") || has("ONSET") || has("EASING"),
        }
    }
}

/// The largest exponent, in magnitude, by which a step shifts a number on a piece or at its end.
fn farthest_shift<R: Real, const D: usize>(pieces: &Pieces<'_, R, D>, row: &Piece<R, D>) -> i32 {
    let [coordinate, step, range, joint] =
        [row.coordinate_exponent, row.step_exponent, row.range_exponent, row.joint_exponent].map(i32::from);
    let (units, per_power) = (coordinate - range + pieces.chord_exponent, range - step);
    let degree = i32::try_from(pieces.degree).unwrap_or(i32::MAX);
    let ends = [1, degree].map(|k| [units + k * per_power, k * per_power]);
    let others = [coordinate - pieces.coordinate_exponent, range, joint, 8];
    ends.as_flattened().iter().chain(&others).map(|exponent| exponent.abs()).max().unwrap_or(0)
}

impl PieceRow {
    fn of<R: Backend, const D: usize>(row: &Piece<R, D>) -> Self {
        let origin: Vec<_> = row.origin.iter().map(|x| crate::literal::word(*x, 64)).collect();
        Self {
            origin: origin.join(", "),
            range: numbers(&row.step_per_chord),
            joint_ratio: row.joint_ratio,
            joint_exponent: row.joint_exponent,
            coordinate_exponent: row.coordinate_exponent,
            step_exponent: row.step_exponent,
            range_exponent: row.range_exponent,
            joint: match row.joint {
                Joint::Continues => "CONTINUES",
                Joint::Smooth => "SMOOTH",
                Joint::Breaks => "BREAKS",
            },
        }
    }
}

impl StageRow {
    /// A stage; one in which the feed does not change takes any shape that the plan has.
    fn of<R: Backend>(stage: &LengthStage<R>, has_bend: bool, any: Option<&Shape>) -> Self {
        let changes = !stage.change.is_zero();
        let mut fields = vec![stage.period_share, stage.feed, stage.change];
        if has_bend {
            fields.push(if let StageShape::Bent(by) = stage.shape { by } else { R::zero() });
        }
        Self {
            duration: stage.duration,
            reciprocal: stage.reciprocal,
            numbers: numbers(&fields),
            reciprocal_exponent: stage.reciprocal_exponent,
            shape: if changes { Shape::of(&stage.shape).name } else { any.map_or("0u", |shape| shape.name) },
        }
    }
}

impl CrossingRow {
    fn of<R: Backend>(crossing: &Crossing<R>) -> Self {
        let Crossing { rest, time, stages, distance } = *crossing;
        Self { rest, time, stages, distance: number(distance) }
    }
}

impl Words {
    fn of(format: FormatName) -> Self {
        let fixed = |unsigned, wide, signed_wide, wide_max, root_shift| Self {
            unsigned,
            wide,
            signed_wide,
            wide_max,
            root_shift,
            ..Self::default()
        };
        match (format, format.bits()) {
            (FormatName::Float { .. }, 32) => Self {
                unsigned: "uint32_t",
                digits: 24,
                bias: 127,
                farthest: 62,
                half_range: 75,
                least_normal: "0x1.0p-126f",
                fraction_unit: "0x1.0p-32f",
                two: "2.0f",
                two_to_64: "0x1.0p+64f",
                ..Self::default()
            },
            (FormatName::Float { .. }, _) => Self {
                unsigned: "uint64_t",
                digits: 53,
                bias: 1023,
                farthest: 64,
                half_range: 600,
                least_normal: "0x1.0p-1022",
                fraction_unit: "0x1.0p-63",
                two: "2.0",
                two_to_64: "0x1.0p+64",
                ..Self::default()
            },
            (_, 8) => fixed("uint8_t", "uint32_t", "int32_t", "UINT32_MAX", 30),
            (_, 16) => fixed("uint16_t", "uint32_t", "int32_t", "UINT32_MAX", 30),
            // Widths between words are described, not compiled.
            (_, 17..=32) => fixed("uint32_t", "uint64_t", "int64_t", "UINT64_MAX", 62),
            _ => fixed("uint64_t", "wide", "int64_t", "", 0),
        }
    }
}

fn fraction_bits(format: FormatName) -> u32 {
    if let FormatName::Fixed { fraction_bits, .. } = format { fraction_bits } else { 0 }
}

fn format_words(format: FormatName) -> String {
    match format {
        FormatName::Fixed { integer_bits, fraction_bits, .. } => format!(
            "fixed point, {integer_bits} bits before the point with the sign and {fraction_bits} behind it, so that a word w stands \
             for w / 2^{fraction_bits}"
        ),
        _ => format!("the binary float of {} bits", format.bits()),
    }
}

fn numbers<R: Backend>(numbers: &[R]) -> String {
    numbers.iter().map(|x| number(*x)).collect::<Vec<_>>().join(", ")
}

/// The coefficients of each coordinate.
fn by_coordinate<R: Backend, const D: usize>(rows: &[[R; D]]) -> String {
    let coordinate =
        |d: usize| rows.iter().filter_map(|row| row.get(d)).map(|x| number(*x)).collect::<Vec<_>>();
    (0..D).map(|d| format!("{{ {} }}", coordinate(d).join(", "))).collect::<Vec<_>>().join(", ")
}
