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

/// The largest strain in each cell of the grid, of pieces that follow each other from the way's begin.
pub(crate) fn strains<const D: usize, C: Differentiate<f64, D>>(
    way: &Way<'_, C>,
    grid: &Grid,
    pieces: &[FeedPiece<f64>],
) -> Vec<Strain> {
    let mut strains = alloc::vec![Strain::default(); grid.pieces.len()];
    let mut start = way.begin;
    let step = way.limits.interpolation_period / LOOKS;
    for piece in pieces {
        let mut count = LEAST;
        while count * step < piece.duration {
            count += count;
        }
        let mut look = 0.0;
        while look <= count {
            // Within the piece by more than rounding: where it ends, jerk and curvature may jump.
            let time = piece.duration * (look / count).clamp(WITHIN, 1.0 - WITHIN);
            let motion = Motion {
                distance: start + piece.distance(time),
                feed: piece.feed(time),
                acceleration: piece.acceleration(time),
                jerk: piece.jerk(time),
            };
            look += 1.0;
            if motion.distance < way.begin || motion.distance > way.end {
                continue;
            }
            let cell = grid.nodes.partition_point(|node| *node < motion.distance).saturating_sub(1);
            // At its ends a single point, or a jump, may be lower than what holds beside it.
            let beside = if look > 1.0 && look <= count { 0.0 } else { piece.length() * 2.0 * WITHIN };
            let most = way.least_feed(motion.distance - beside, motion.distance + beside);
            let bend = way.bend(motion.distance);
            if let Some(strain) = strains.get_mut(cell) {
                *strain = strain.max(way.strain(&motion, &bend, most));
            }
        }
        start += piece.length();
    }
    strains
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
