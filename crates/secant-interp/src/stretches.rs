//! The stretches of a path between the stops on the way.
//!
//! A stop is a corner at which the plan comes to rest. A run of the whole path gets there a little early or late, for each
//! rounding and each chord over a corner has moved it against the plan, and then the chord of a period cuts the corner.
//! A run stretch by stretch lands on each stop as on the end of a path, and begins the next stretch there, on time.

use core::ops::Range;

use real::Real;

use crate::PieceInterpolator;
use crate::step_lengths::StepLengths;

/// The path and the plan from one stop to the next.
#[derive(Clone, Debug, PartialEq, Eq)]
pub struct Stretch {
    /// The pieces between the stops.
    pub pieces: Range<usize>,
    /// The stages from rest to rest.
    pub stages: Range<usize>,
}

/// The stretches of a path of `pieces` pieces, in order.
///
/// `stops` has an entry for each stage of the plan: the number of the piece that begins where the stage comes to rest, or
/// `None` if it ends at a feed, or at no joint of two pieces. A rest on a joint that is no later than the one before, as a
/// dwell is, belongs to the stretch before it. There are never more stretches than pieces.
pub fn stretches(
    stops: impl IntoIterator<Item = Option<usize>>,
    pieces: usize,
) -> impl Iterator<Item = Stretch> {
    let mut stops = stops.into_iter().enumerate().peekable();
    let (mut piece, mut stage) = (0, 0);
    core::iter::from_fn(move || {
        stops.peek()?;
        let mut end = None;
        while let Some((index, stop)) = stops.next() {
            let joint = stop.filter(|joint| piece < *joint && *joint < pieces);
            end = end.or(joint);
            // What rests on the same joint dwells there.
            let dwells = stops.peek().is_some_and(|(_, next)| next.is_some() && *next == end);
            if end.is_some() && !dwells {
                let stretch = Stretch { pieces: piece..end.unwrap_or(pieces), stages: stage..index + 1 };
                (piece, stage) = (stretch.pieces.end, stretch.stages.end);
                return Some(stretch);
            }
            if stops.peek().is_none() {
                return Some(Stretch { pieces: piece..pieces, stages: stage..index + 1 });
            }
        }
        None
    })
}

impl<'a, R: Real, const D: usize> PieceInterpolator<'a, R, D> {
    /// The run of one stretch: its setpoints number pieces from the stretch's first. It ends on the stop.
    #[must_use]
    pub fn on(&self, stretch: &Stretch) -> PieceInterpolator<'a, R, D> {
        let stages = self.lengths.stages.get(stretch.stages.clone()).unwrap_or_default();
        PieceInterpolator {
            pieces: self.pieces.part(stretch.pieces.clone()),
            lengths: StepLengths { stages },
            ..*self
        }
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    fn of(stops: &[Option<usize>], pieces: usize) -> Vec<(Range<usize>, Range<usize>)> {
        stretches(stops.iter().copied(), pieces).map(|one| (one.pieces, one.stages)).collect()
    }

    #[test]
    fn a_path_without_stops_is_one_stretch() {
        assert_eq!(of(&[None, None, Some(9)], 9), [(0..9, 0..3)]);
        assert_eq!(of(&[None], 1), [(0..1, 0..1)]);
        assert_eq!(of(&[], 4), []);
    }

    #[test]
    fn each_stop_ends_a_stretch() {
        assert_eq!(
            of(&[None, Some(2), None, None, Some(5), None, Some(7)], 7),
            [(0..2, 0..2), (2..5, 2..5), (5..7, 5..7)]
        );
    }

    #[test]
    fn a_dwell_belongs_to_the_stretch_before_it() {
        assert_eq!(of(&[Some(2), Some(2), None, Some(6), Some(6)], 6), [(0..2, 0..2), (2..6, 2..5)]);
    }

    #[test]
    fn a_rest_that_is_no_joint_or_goes_back_ends_nothing() {
        assert_eq!(of(&[None, Some(3), Some(1), None, Some(99)], 6), [(0..3, 0..2), (3..6, 2..5)]);
        assert_eq!(of(&[Some(0), Some(4)], 4), [(0..4, 0..2)]);
    }
}
