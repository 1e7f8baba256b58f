//! The powers of two by which a step scales its numbers in fixed point, and the C functions that do so: which sign an exponent
//! has on all pieces is known when the code is written.

use nurbs_core::{Piece, Pieces};
use real::Backend;

/// The highest degree whose sweeps over the coefficients are written out.
pub(crate) const MOST_UNROLLED: usize = 4;

/// The C function for each scaling of a step.
#[derive(Clone, Debug, Default)]
pub(crate) struct Exponents {
    /// For the coefficients q_k that a step along a piece changes, if they are written out.
    pub(crate) powers: Vec<&'static str>,
    /// From a step to x.
    pub(crate) to_variable: &'static str,
    /// From a piece's units to those of the path; `None` if they are the same on all pieces.
    pub(crate) to_path: Option<&'static str>,
    /// From a step to the phase.
    pub(crate) to_phase: ToPhase,
}

/// How far a step is moved to the left to become a phase, on all pieces.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq)]
pub(crate) enum ToPhase {
    /// By a part of a word of 32 bits.
    WithinAWord,
    /// By that word and a part of another.
    BeyondAWord,
    #[default]
    Any,
}

/// One function for exponents of these signs.
fn scaling(exponents: impl Iterator<Item = i32> + Clone) -> &'static str {
    let least = exponents.clone().min().unwrap_or(0);
    match (least, exponents.max().unwrap_or(0)) {
        (0.., _) => "raised",
        (_, ..0) => "lowered",
        (_, 0) => "lowered_or_kept",
        _ => GENERAL,
    }
}

/// The function for any exponent.
const GENERAL: &str = "times_power_of_two";

impl Exponents {
    /// `far_shifts` says that an exponent of some piece has the width of a word.
    pub(crate) fn of<R: Backend, const D: usize>(pieces: &Pieces<'_, R, D>, far_shifts: bool) -> Self {
        let rows = || pieces.pieces.iter();
        let changed = if pieces.is_rational() { pieces.degree } else { pieces.degree.saturating_sub(1) };
        let written = if pieces.degree > MOST_UNROLLED { 0 } else { changed };
        // h^k in units of 2^e mm is x^(k-1) η 2^(e - r + k (r - s)) in mm.
        let of_power = |row: &Piece<R, D>, k: i32| {
            let [e, s, r] = [row.coordinate_exponent, row.step_exponent, row.range_exponent].map(i32::from);
            e - r + pieces.chord_exponent + k * (r - s)
        };
        let to_path = |row: &Piece<R, D>| i32::from(row.coordinate_exponent) - pieces.coordinate_exponent;
        let named = |name| if far_shifts { GENERAL } else { name };
        Self {
            powers: (1..).take(written).map(|k| named(scaling(rows().map(|row| of_power(row, k))))).collect(),
            to_variable: named(scaling(rows().map(|row| -i32::from(row.range_exponent)))),
            to_path: (!R::IS_FLOATING && rows().any(|row| to_path(row) != 0))
                .then(|| named(scaling(rows().map(to_path)))),
            to_phase: ToPhase::of(pieces),
        }
    }

    /// Whether some scaling takes this function.
    pub(crate) fn use_function(&self, name: &str) -> bool {
        let others = [Some(self.to_variable), self.to_path];
        self.powers.iter().copied().chain(others.into_iter().flatten()).any(|used| used == name)
    }
}

impl ToPhase {
    fn of<R: Backend, const D: usize>(pieces: &Pieces<'_, R, D>) -> Self {
        let real::FormatName::Fixed { fraction_bits, .. } = R::name() else { return Self::Any };
        let distance = |row: &Piece<R, D>| 64 - i64::from(fraction_bits) - i64::from(row.step_exponent);
        let all = |range: std::ops::Range<i64>| {
            R::name().bits() == 32 && pieces.pieces.iter().all(|row| range.contains(&distance(row)))
        };
        match (all(1..32), all(32..63)) {
            (true, _) => Self::WithinAWord,
            (_, true) => Self::BeyondAWord,
            _ => Self::Any,
        }
    }
}
