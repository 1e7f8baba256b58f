//! What pieces of a plan take of what is allowed, seen closely.

use alloc::vec::Vec;

use nurbs_core::Differentiate;

use crate::FeedPiece;
use crate::axes::grid::Grid;
use crate::axes::way::{Motion, Strain, Way};

/// Looks in each period, at least.
const LOOKS: f64 = 10.0;
/// Looks in each piece, at least.
const LEAST: f64 = 4.0;

/// Share of a piece from its ends to the nearest look.
const WITHIN: f64 = 1e-8;

/// The largest strain in each cell of the grid, of pieces that follow each other from the way's begin. Looks at least
/// ten times a period, and on both sides of each knot and joint, where the jerk of an axis jumps.
pub(crate) fn strains<const D: usize, C: Differentiate<f64, D>>(
    way: &Way<'_, C>,
    grid: &Grid,
    pieces: &[FeedPiece<f64>],
) -> Vec<Strain> {
    let mut strains = alloc::vec![Strain::default(); grid.pieces.len()];
    let mut start = way.begin;
    let step = way.limits.interpolation_period / LOOKS;
    for piece in pieces {
        let mut look = |time: f64, beside: f64| {
            let motion = Motion {
                distance: start + piece.distance(time),
                feed: piece.feed(time),
                acceleration: piece.acceleration(time),
                jerk: piece.jerk(time),
            };
            if motion.distance < way.begin || motion.distance > way.end {
                return;
            }
            let cell = grid.nodes.partition_point(|node| *node < motion.distance).saturating_sub(1);
            let most = way.least_feed(motion.distance - beside, motion.distance + beside);
            let bend = way.bend(motion.distance);
            if let Some(strain) = strains.get_mut(cell) {
                *strain = strain.max(way.strain(&motion, &bend, most));
            }
        };
        let mut count = LEAST;
        while count * step < piece.duration {
            count += count;
        }
        let mut number = 0.0;
        while number <= count {
            // Within the piece by more than rounding: where it ends, jerk and curvature may jump. There a single point
            // of the limit, or a jump of it, may be lower than what holds beside it.
            let is_end = number == 0.0 || number == count;
            let beside = if is_end { piece.length() * 2.0 * WITHIN } else { 0.0 };
            look(piece.duration * (number / count).clamp(WITHIN, 1.0 - WITHIN), beside);
            number += 1.0;
        }
        let end = start + piece.length();
        let first = way.pieces.partition_point(|of_way| of_way.end <= start);
        for joint in way.pieces.iter().skip(first).map(|of_way| of_way.end).take_while(|joint| *joint < end) {
            let (share, beside) =
                (time_at(piece, joint - start) / piece.duration, piece.length() * 2.0 * WITHIN);
            for side in [-WITHIN, WITHIN] {
                look(piece.duration * (share + side).clamp(WITHIN, 1.0 - WITHIN), beside);
            }
        }
        start = end;
    }
    strains
}

/// When a piece has gone this far, by halving.
fn time_at(piece: &FeedPiece<f64>, distance: f64) -> f64 {
    let (mut before, mut behind) = (0.0, piece.duration);
    for _ in 0..f64::MANTISSA_DIGITS {
        let middle = 0.5 * (before + behind);
        if piece.distance(middle) < distance { before = middle } else { behind = middle }
    }
    0.5 * (before + behind)
}

/// By what all of it is to be stretched in time.
pub(crate) fn stretch(strains: &[Strain]) -> f64 {
    let most = strains.iter().fold(Strain::default(), |most, strain| most.max(*strain));
    most.stretch().max(1.0)
}

/// The time of pieces.
pub(crate) fn duration(pieces: &[FeedPiece<f64>]) -> f64 {
    pieces.iter().fold(0.0, |sum, piece| sum + piece.duration)
}
