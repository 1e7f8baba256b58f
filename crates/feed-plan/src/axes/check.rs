//! What pieces of a plan take of what is allowed, seen closely.

use alloc::vec::Vec;
use core::ops::Range;

use nurbs_core::Differentiate;

use crate::FeedPiece;
use crate::axes::grid::Grid;
use crate::axes::way::{Motion, Strain, Way};

/// Looks in each period, at least, or in each [moment](Way::moment) that is longer.
const LOOKS: f64 = 10.0;
/// Looks in each piece between joints, at least.
const LEAST: f64 = 4.0;
/// Share of a piece from its ends, and from joints, to the nearest look.
const WITHIN: f64 = 1e-8;

/// The largest strain in each cell of the grid, of pieces that follow each other from the way's begin. Looks at least
/// ten times a period, or a [moment](Way::moment) that is longer, and on both sides of each knot and joint, where the
/// jerk of an axis jumps. Where the way is even, feed and acceleration are largest at an end of a piece, and its jerk
/// is constant: there it looks at both ends alone.
pub(crate) fn strains<const D: usize, C: Differentiate<f64, D>>(
    way: &Way<'_, C>,
    grid: &Grid,
    pieces: &[FeedPiece<f64>],
) -> Vec<Strain> {
    let mut strains = alloc::vec![Strain::default(); grid.pieces.len()];
    let mut start = way.begin;
    for piece in pieces {
        let end = start + piece.length();
        let first = way.pieces.partition_point(|of_way| of_way.end <= start);
        let joints = way.pieces.iter().skip(first).map(|of_way| of_way.end).take_while(|joint| *joint < end);
        let looks = Looks { way, grid, piece, start };
        let mut begin = (0.0, start);
        for joint in joints {
            let place = (time_at(piece, joint - start), joint);
            looks.over([begin, place], &mut strains);
            begin = place;
        }
        looks.over([begin, (piece.duration, end)], &mut strains);
        start = end;
    }
    strains
}

/// What looks at a piece that starts at a distance.
struct Looks<'a, 'w, C> {
    way: &'a Way<'w, C>,
    grid: &'a Grid,
    piece: &'a FeedPiece<f64>,
    start: f64,
}

impl<C> Looks<'_, '_, C> {
    /// Looks from one time and distance to another, between which there is no joint.
    fn over<const D: usize>(&self, [from, to]: [(f64, f64); 2], strains: &mut [Strain])
    where
        C: Differentiate<f64, D>,
    {
        // Within by more than rounding: where it ends, jerk and curvature may jump. There a single point of the limit, or a
        // jump of it, may be lower than what holds beside it.
        let (time, beside) = (self.piece.duration * WITHIN, self.piece.length() * 2.0 * WITHIN);
        let times = [from.0 + time, to.0 - time].map(|place| place.clamp(time, self.piece.duration - time));
        let ends = times.map(|time| self.at(time, beside));
        for (cell, strain) in ends.into_iter().flatten() {
            raise(strains, cell..cell + 1, strain);
        }
        if self.way.is_even(from.1 + beside, to.1 - beside) {
            if let [Some((first, strain)), Some((last, _))] = ends
                && self.piece.start_feed == self.piece.end_feed
            {
                raise(strains, first..last + 1, strain);
            }
            return;
        }
        let step = self.way.moment() / LOOKS;
        let mut count = LEAST;
        while count * step < times[1] - times[0] {
            count += count;
        }
        let mut number = 1.0;
        while number < count {
            if let Some((cell, strain)) = self.at(times[0] + (times[1] - times[0]) * number / count, 0.0) {
                raise(strains, cell..cell + 1, strain);
            }
            number += 1.0;
        }
    }

    /// The cell in which the piece is at a time, and the strain there; the limit is the least up to `beside` away.
    fn at<const D: usize>(&self, time: f64, beside: f64) -> Option<(usize, Strain)>
    where
        C: Differentiate<f64, D>,
    {
        let &Self { way, grid, piece, start } = self;
        let motion = Motion {
            distance: start + piece.distance(time),
            feed: piece.feed(time),
            acceleration: piece.acceleration(time),
            jerk: piece.jerk(time),
        };
        if motion.distance < way.begin || motion.distance > way.end {
            return None;
        }
        let cell = grid.nodes.partition_point(|node| *node < motion.distance).saturating_sub(1);
        // Rounding may put a place beside a rest on it, where the limit is 0.
        let inside = motion.distance.clamp(way.begin + way.rounding(), way.end - way.rounding());
        let most = way.least_feed(inside - beside, inside + beside);
        Some((cell, way.strain(&motion, &way.bend(motion.distance), most)))
    }
}

/// Raises the strains of cells to what was found in them.
fn raise(strains: &mut [Strain], cells: Range<usize>, found: Strain) {
    for strain in strains.get_mut(cells).unwrap_or_default() {
        *strain = strain.max(found);
    }
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
