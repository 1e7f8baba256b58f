//! A comparison of a fixed format with a float, period by period.

use kernel_oracle::{Violation, demand};
use nurbs_core::ORIGIN_EXPONENT;
use real::{Backend, FormatName, Real};

use crate::next_setpoint::next_setpoint;
use crate::on_pieces::JUDGE;
use crate::piece_points::judge;
use crate::violation::Outcome;
use crate::{OnPieces, PlannedPath};

/// What two runs side by side came to.
#[derive(Clone, Copy, Debug, Default)]
pub struct SideBySide {
    /// The greatest share of the bound by which they were apart.
    pub apart_share: f64,
    /// The most that a chord was off the wanted one with all evaluations used up, as a part of the wanted one: in `R`, and in f64.
    pub missed_part: [f64; 2],
}

/// Runs `R` and f64 along the same pieces by the same plan and compares them. After n steps they may differ by n times
/// the bound of a chord's error, and by half as much again for the path's bends. A chord whose evaluations were used up
/// is off the wanted one by more: then they may differ by what it is off, and a step that turns by φ may divide that by
/// cos φ. Behind a corner of a right angle or more they are not compared: a chord may be found on either side of it.
///
/// # Errors
/// The first step at which they differ by more.
pub fn check_against_float<R: Backend, const D: usize>(
    planned: &PlannedPath<'_, D>,
) -> Result<Outcome<SideBySide>, Violation> {
    let (fixed, float) = match (OnPieces::<R, D>::new(planned), OnPieces::<f64, D>::new(planned)) {
        (Ok(fixed), Ok(float)) => (fixed, float),
        (Err(refusal), _) | (_, Err(refusal)) => return Ok(Outcome::Refused(refusal)),
    };
    let judge = match judge(planned) {
        Ok(judge) => judge,
        Err(refusal) => return Ok(Outcome::Refused(refusal)),
    };
    let name = R::name().to_string();
    let (one, other) = (fixed.interpolator(), float.interpolator());
    let (mut one_state, mut other_state) = (one.start(), other.start());
    let is_fixed = matches!(R::name(), FormatName::Fixed { .. });
    let unit = 1.0_f64.ldexp(-one.pieces.chord_exponent);
    let resolution = R::resolution().to_f64();
    let (mut joints, mut travelled, mut missed) = (0.0, 0.0, 0.0);
    let mut worst = SideBySide::default();
    let mut from = [(0, 0); 2];
    for step in 0..planned.most_periods() {
        let (Some(a), Some(b)) =
            (next_setpoint(&one, &mut one_state), next_setpoint(&other, &mut other_state))
        else {
            break;
        };
        let wanted = b.length * 1.0_f64.ldexp(-other.pieces.chord_exponent);
        travelled += wanted;
        joints += (b.piece - from[1].0) as f64;
        let to = [(a.piece, a.phase), (b.piece, b.phase)];
        let ahead = to[0].max(to[1]);
        let place = |(piece, phase): (usize, u64)| (piece, f64::from_phase(phase, 0));
        if ahead.0 >= judge.piece_count() {
            break;
        }
        let cosine = judge.turns(place(from[0].min(from[1])), place(ahead)).in_all;
        if cosine <= 0.0 {
            break;
        }
        for (run, evaluations) in [a.evaluations, b.evaluations].into_iter().enumerate() {
            if evaluations >= one.tolerance.max_evaluations {
                let off = (judge.step_length(place(from[run]), place(to[run])) - wanted).abs();
                worst.missed_part[run] = worst.missed_part[run].max(off / wanted);
                missed += off;
            }
        }
        missed /= cosine;
        from = to;
        let at = |piece: usize, phase: u64| judge.point(piece, f64::from_phase(phase, 0), b.piece);
        let (p, q) = (at(a.piece, a.phase), at(b.piece, b.phase));
        let apart = f64::norm(&core::array::from_fn::<_, D, _>(|d| p[d] - q[d]));
        let steps = step as f64 + 1.0;
        let absolute = if is_fixed { 8.0 * unit * (steps + joints) } else { 0.0 };
        let longest = planned.path.limits.feedrate;
        let origins = if a.piece == b.piece { 0.0 } else { 2.0 * 1.0_f64.ldexp(ORIGIN_EXPONENT) };
        let rounding = 1.5 * resolution * (absolute + 64.0 * (travelled + joints * longest));
        let judged = 1e-11 * travelled + JUDGE * planned.path.piece_mm;
        let bound = rounding + missed + judged + origins;
        let share = demand("apart from the float, mm", &name, step, apart, bound)?;
        worst.apart_share = worst.apart_share.max(share);
    }
    Ok(Outcome::Ran(worst))
}
