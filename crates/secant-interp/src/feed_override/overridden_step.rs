//! A period of a run with feed override, and the way in which such a run comes to the end of its path.

use nurbs_core::{MAX_DEGREE, ORIGIN_EXPONENT, Piece, Shifted};
use real::Real;

use crate::feed_override::feed_override::{FeedOverride, OverrideState};
use crate::feed_override::landing::{Landing, LandingStep};
use crate::pieces::chord_step::sum_within;
use crate::pieces::piece_interpolator::{PieceInterpolator, Wanted};
use crate::pieces::place::step_to_end;
use crate::pieces::state::{PieceSetpoint, PieceState};

/// An overridden run this near to the end in the last period of its schedule lands at once: a step that is longer by
/// 2⁻⁵ J T³ adds twice that to the jerk.
pub const LANDING_REACH: i32 = -5;

impl<R: Real, const D: usize> PieceInterpolator<'_, R, D> {
    /// [`step`](Self::step) with the plan's time stretched by [`FeedOverride::advance`]: feed override and feed hold.
    /// In a period of hold the setpoint is that of the period before.
    ///
    /// A slower run has not reached the end of the path when its plan is over. It comes to rest there. Then it travels
    /// the remaining length from rest to rest within A and J, in about a dozen periods, even if held meanwhile, and
    /// stands at the end for two more periods. A remaining length that the format cannot hold, or of more than a
    /// thousand landing steps, is travelled in landing steps.
    pub fn step_overridden(
        &self,
        state: &mut PieceState<R, D>,
        feeds: &FeedOverride,
        rates: &mut OverrideState,
    ) -> Option<PieceSetpoint<R, D>> {
        let Some(row) = self.pieces.pieces.get(state.piece) else {
            let is_early = feeds.advance(&self.lengths, &mut state.cursor, rates).is_some();
            if !is_early {
                feeds.approach(rates);
            }
            return (is_early || rates.landing.pauses()).then(|| self.hold(state));
        };
        let wanted = match feeds.advance(&self.lengths, &mut state.cursor, rates) {
            Some(length) => {
                rates.landing = Landing::default();
                let is_last = self.lengths.is_over(&state.cursor);
                let more = if is_last {
                    feeds.landing_jerk(self.landing_step).ldexp(LANDING_REACH)
                } else {
                    R::zero()
                };
                Wanted { length, reach: sum_within(length, more, R::max_value()) }
            }
            None => {
                feeds.approach(rates);
                self.land(state, row, feeds, &mut rates.landing)
            }
        };
        if wanted.reach <= R::zero() {
            return Some(self.hold(state));
        }
        Some(self.follow_aside(state, row, wanted))
    }

    /// The chord of a period behind the end of an overridden schedule.
    #[cold]
    #[inline(never)]
    fn land(
        &self,
        state: &PieceState<R, D>,
        row: &Piece<R, D>,
        feeds: &FeedOverride,
        landing: &mut Landing,
    ) -> Wanted<R> {
        let Some(remaining) = self.remaining(state, row) else { return self.landing(state, row) };
        let longest = self.landing_step;
        match landing.advance(remaining, longest, feeds.landing_jerk(longest)) {
            LandingStep::Part(part) => Wanted { length: part, reach: part },
            LandingStep::Last => Wanted { length: remaining.min(longest), reach: longest },
            LandingStep::Over => self.landing(state, row),
        }
    }

    /// The length to the end of the path, in chord units: the chord to the end of the piece, the straight line to the
    /// last piece, and the chord over that. `None` if the format cannot hold it.
    fn remaining(&self, state: &PieceState<R, D>, row: &Piece<R, D>) -> Option<R> {
        let to_end = self.across(row, &state.at, step_to_end(state, row))?;
        let last = self.pieces.pieces.len().saturating_sub(1);
        let (Some(next), Some(end)) = (self.pieces.pieces.get(state.piece + 1), self.pieces.pieces.get(last))
        else {
            return Some(to_end);
        };
        let exponent = self.pieces.chord_exponent.saturating_add(ORIGIN_EXPONENT + 64).clamp(-64, 64);
        let between: [R; D] = core::array::from_fn(|d| {
            let distance = end.origin[d].abs_diff(next.origin[d]);
            if distance == 0 { R::zero() } else { R::from_phase(distance, exponent) }
        });
        let mut at = Shifted::default();
        self.pieces.shift_to_begin::<MAX_DEGREE, false>(last, &mut at);
        let over_last = self.across(end, &at, end.whole())?;
        let sum = |a: R, b: R| (a <= R::max_value() - b).then(|| a + b);
        sum(sum(to_end, R::norm(&between))?, over_last)
    }

    /// The chord of a step on a piece; `None` for a step that is longer than the piece's polynomials are scaled for: half
    /// of x's unit, or the whole piece if that is the unit.
    fn across(&self, row: &Piece<R, D>, at: &Shifted<R, D>, step: R) -> Option<R> {
        let range = i32::from(row.range_exponent);
        let is_near =
            R::IS_FLOATING || row.range_exponent == row.step_exponent || step <= R::power_of_two(range - 1);
        is_near.then(|| R::norm(&self.chord(row, at, R::one()).over(step)))
    }
}
