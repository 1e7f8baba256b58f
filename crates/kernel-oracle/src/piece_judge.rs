//! Points, chords and turns of pieces in f64, by which steps in other formats are judged.

use nurbs_core::{Joint, ORIGIN_EXPONENT, Piece, PiecesBuf};
use real::{Backend, Real};

/// Part of a piece over which its direction is measured.
const TANGENT: f64 = 1e-6;

/// Cosine of the turn within a step over joints. If the path turns by more, the chord is not always found: the path
/// comes back, and the chord shrinks before it grows.
pub const RIGHT_ANGLE: f64 = 0.0;

/// Cosine of the turn up to which a chord on one piece is found, 60°: steps per chord are limited to a sixteenth above that of the piece's
/// slowest point.
const ON_ONE_PIECE: f64 = 0.5;

/// The longest way behind the last joint, over the whole chord, by the same limit: ways are measured along a few straight lines, and come
/// out up to a hundredth short.
const LONGEST_WAY: f64 = 1.05;

/// The longest way behind the last joint, over what it adds to the chord: the solver's trials there are limited to half above the
/// greatest step per chord. It is reached where the way turns by 48° from the chord up to the joint.
const LONGEST_REST: f64 = 1.5;

/// By how much the path turns over a step.
#[derive(Clone, Copy, Debug)]
pub struct Turns {
    /// Cosine of the sharpest turn at any joint, -1 where the tangent breaks.
    pub at_joint: f64,
    /// Cosine of the largest turn on any chord from its first direction.
    pub in_all: f64,
    /// The way on the last piece, over what it adds to the last chord; without end where it is too long for the whole chord too.
    stretch: f64,
}

impl Turns {
    /// Whether the solver's trials, on the piece of this row, reach as far as the step goes. Where the right end is out of their reach, the
    /// chord comes out too short, however few evaluations it took.
    #[must_use]
    pub fn leave_in_reach<R: Backend, const D: usize>(&self, row: Option<&Piece<R, D>>) -> bool {
        // A format of two integer bits may not hold such a trial.
        let room = row.map_or(f64::INFINITY, |row| R::max_value().to_f64() / row.step_per_chord[1].to_f64());
        self.in_all > RIGHT_ANGLE && self.stretch <= LONGEST_REST.min(room)
    }
}

/// Pieces in f64, with which those of every format are compared. They are exact to 1e-15 of a piece.
pub struct PieceJudge<const D: usize> {
    table: PiecesBuf<f64, D>,
}

impl<const D: usize> PieceJudge<D> {
    /// The judge of pieces that were cut for f64.
    #[must_use]
    pub fn of(table: PiecesBuf<f64, D>) -> Self {
        Self { table }
    }

    /// Number of pieces.
    #[must_use]
    pub fn piece_count(&self) -> usize {
        self.table.places().len()
    }

    /// The point at the fraction `t` of `piece`, relative to the origin of the piece `about`, in mm. Past the last
    /// piece it is the end of the path.
    #[must_use]
    pub fn point(&self, piece: usize, t: f64, about: usize) -> [f64; D] {
        let last = self.piece_count().saturating_sub(1);
        let (piece, t) = if piece > last { (last, 1.0) } else { (piece, t) };
        let pieces = self.table.as_pieces();
        let offset = pieces.offset(piece, t);
        let (from, to) = (pieces.pieces[about.min(last)].origin, pieces.pieces[piece].origin);
        core::array::from_fn(|d| {
            let origin = (to[d] - from[d]) as f64;
            origin.ldexp(ORIGIN_EXPONENT) + offset[d].ldexp(pieces.coordinate_exponent)
        })
    }

    /// The length of a step between two positions: the sum of the chords from corner to corner.
    #[must_use]
    pub fn step_length(&self, from: (usize, f64), to: (usize, f64)) -> f64 {
        self.legs(from, to).map(|[begin, end]| self.chord(begin, end)).sum()
    }

    /// The distance of two positions.
    fn chord(&self, from: (usize, f64), to: (usize, f64)) -> f64 {
        let (a, b) = (self.point(from.0, from.1, from.0), self.point(to.0, to.1, from.0));
        f64::norm(&core::array::from_fn::<_, D, _>(|d| b[d] - a[d]))
    }

    /// The ends of the chords that a step makes: from corner to corner.
    fn legs(&self, from: (usize, f64), to: (usize, f64)) -> impl Iterator<Item = [(usize, f64); 2]> {
        let pieces = self.table.as_pieces().pieces;
        let corners =
            (from.0..to.0).filter(|piece| pieces.get(*piece).is_some_and(|row| row.joint == Joint::Breaks));
        let mut begin = from;
        corners.map(Some).chain([None]).map(move |corner| {
            let end = corner.map_or(to, |piece| (piece, 1.0));
            [std::mem::replace(&mut begin, (end.0 + 1, 0.0)), end]
        })
    }

    /// The turns between two positions.
    #[must_use]
    pub fn turns(&self, from: (usize, f64), to: (usize, f64)) -> Turns {
        let on_leg = |[begin, end]: [(usize, f64); 2]| self.turns_on_chord(begin, end);
        let straight = Turns { at_joint: 1.0, in_all: 1.0, stretch: 0.0 };
        let both = |a: Turns, b: Turns| Turns {
            at_joint: a.at_joint.min(b.at_joint),
            in_all: a.in_all.min(b.in_all),
            // Only on the last chord is a place looked for.
            stretch: b.stretch,
        };
        let turns = self.legs(from, to).map(on_leg).fold(straight, both);
        let has_corner = self.legs(from, to).count() > 1;
        Turns { at_joint: if has_corner { -1.0 } else { turns.at_joint }, ..turns }
    }

    /// The turns along a chord without a corner: at the joints, at the end, and halfway to it on the last piece.
    fn turns_on_chord(&self, (from, begin): (usize, f64), (to, end): (usize, f64)) -> Turns {
        let last = self.piece_count().saturating_sub(1);
        let (from, to, end) = if to > last { (from.min(last), last, 1.0) } else { (from, to, end) };
        let direction = |piece: usize, begin: f64, end: f64| {
            let (a, b) = (self.point(piece, begin, piece), self.point(piece, end, piece));
            let way: [f64; D] = core::array::from_fn(|d| b[d] - a[d]);
            let length = f64::norm(&way);
            way.map(|x| x / length)
        };
        let cosine = |a: &[f64; D], b: &[f64; D]| (0..D).map(|d| a[d] * b[d]).sum::<f64>();
        let near = |t: f64| (t - TANGENT).max(0.0);
        let first = direction(from, near(begin), near(begin) + TANGENT);
        let halfway = if from == to { f64::midpoint(begin, end) } else { end / 2.0 };
        let late = [halfway, end].map(|t| direction(to, near(t), near(t) + TANGENT));
        let (mut at_joint, mut in_all) = (1.0_f64, cosine(&first, &late[0]).min(cosine(&first, &late[1])));
        for piece in from..to {
            let (before, after) = (direction(piece, 1.0 - TANGENT, 1.0), direction(piece + 1, 0.0, TANGENT));
            at_joint = at_joint.min(cosine(&before, &after));
            in_all = in_all.min(cosine(&first, &before)).min(cosine(&first, &after));
        }
        let stretch = if from < to {
            self.stretch((from, begin), (to, end))
        } else if in_all > ON_ONE_PIECE {
            1.0
        } else {
            f64::INFINITY
        };
        Turns { at_joint, in_all, stretch }
    }

    /// The [stretch](Turns::stretch) of a chord over joints.
    fn stretch(&self, from: (usize, f64), to: (usize, f64)) -> f64 {
        let joint = (to.0, 0.0);
        let rest = self.way(joint, to);
        let (before, whole) = (self.chord(from, joint), self.chord(from, to));
        if rest <= 0.0 {
            0.0
        } else if whole > before && rest <= LONGEST_WAY * whole {
            rest / (whole - before)
        } else {
            f64::INFINITY
        }
    }

    /// Largest distance of the path from the chord between two positions, in mm. The path is sampled at three places of
    /// each piece and at the joints. Each position comes with its point, relative to the origin of the first position's
    /// piece.
    #[must_use]
    pub fn chord_error(
        &self,
        (from, start): ((usize, f64), &[f64; D]),
        (to, end): ((usize, f64), &[f64; D]),
    ) -> f64 {
        let chord: [f64; D] = core::array::from_fn(|d| end[d] - start[d]);
        let length = f64::norm(&chord);
        let distance = |at: [f64; D]| {
            let arm: [f64; D] = core::array::from_fn(|d| at[d] - start[d]);
            if length <= 0.0 {
                return f64::norm(&arm);
            }
            let along = f64::sum_of_products((0..D).map(|d| (arm[d], chord[d]))) / length;
            let along = along.max(0.0).min(length) / length;
            f64::norm(&core::array::from_fn::<_, D, _>(|d| arm[d] - along * chord[d]))
        };
        self.between(from, to).map(distance).fold(0.0, f64::max)
    }

    /// Length of the path between two positions, in mm, by the same samples.
    #[must_use]
    pub fn way(&self, from: (usize, f64), to: (usize, f64)) -> f64 {
        let end = self.point(to.0, to.1, from.0);
        let mut last = self.point(from.0, from.1, from.0);
        let mut way = 0.0;
        for at in self.between(from, to).chain([end]) {
            way += f64::norm(&core::array::from_fn::<_, D, _>(|d| at[d] - last[d]));
            last = at;
        }
        way
    }

    /// Points between two positions, at three places of each piece and at the joints, relative to the origin of the
    /// first position's piece.
    fn between(&self, from: (usize, f64), to: (usize, f64)) -> impl Iterator<Item = [f64; D]> {
        let last = to.0.min(self.piece_count().saturating_sub(1));
        (from.0..=last).flat_map(move |piece| {
            let begin = if piece == from.0 { from.1 } else { 0.0 };
            let end = if piece == to.0 { to.1 } else { 1.0 };
            let places: &[f64] = if piece == to.0 { &[0.25, 0.5, 0.75] } else { &[0.25, 0.5, 0.75, 1.0] };
            places.iter().map(move |share| self.point(piece, begin + (end - begin) * share, from.0))
        })
    }
}
