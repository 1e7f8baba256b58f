//! A way from rest to rest, and everything that limits the feed along it.

use nurbs_core::Differentiate;
use real::Real;

use crate::KinematicLimits;
use crate::axes::geometry::{Bend, Geometry, Piece};
use crate::cube_root::cube_root;
use crate::limit::axis_budget::Allowance;
use crate::limits::AXES;

/// Share of the time A/J over which a motion is looked at as one.
const MOMENT: f64 = 1.0 / 128.0;

/// The way between two distances at which the plan rests.
pub(crate) struct Way<'a, C> {
    pub(crate) geometry: &'a Geometry<'a, C>,
    pub(crate) limits: &'a KinematicLimits<f64>,
    pub(crate) begin: f64,
    pub(crate) end: f64,
    pub(crate) pieces: &'a [Piece],
    /// Whether the acceleration or jerk of an axis is limited.
    limits_axes: bool,
    /// Whether the path has less of its acceleration or jerk somewhere.
    has_allowances: bool,
}

/// Largest ratio of what a motion takes to what is allowed, of the feed, of accelerations and of jerks.
#[derive(Clone, Copy, Debug, Default, PartialEq)]
pub(crate) struct Strain {
    pub(crate) feed: f64,
    pub(crate) acceleration: f64,
    pub(crate) jerk: f64,
}

impl Strain {
    pub(crate) fn max(self, other: Self) -> Self {
        Self {
            feed: self.feed.max(other.feed),
            acceleration: self.acceleration.max(other.acceleration),
            jerk: self.jerk.max(other.jerk),
        }
    }

    /// Whether a stretch in time by this factor is enough.
    pub(crate) fn is_within(&self, stretch: f64) -> bool {
        let square = stretch * stretch;
        self.feed <= stretch && self.acceleration <= square && self.jerk <= square * stretch
    }

    /// By what a motion is to be stretched in time so that nothing is above what is allowed.
    pub(crate) fn stretch(&self) -> f64 {
        self.feed.max(Real::sqrt(self.acceleration)).max(cube_root(self.jerk))
    }
}

/// Feed, acceleration and jerk along the path at one place.
#[derive(Clone, Copy, Debug)]
pub(crate) struct Motion {
    pub(crate) distance: f64,
    pub(crate) feed: f64,
    pub(crate) acceleration: f64,
    pub(crate) jerk: f64,
}

fn rounding_at(distance: f64) -> f64 {
    (1.0 + distance.abs()) * 1e-12
}

impl<'a, C> Way<'a, C> {
    /// `None` if there is nothing of the path between the two distances.
    pub(crate) fn new<const D: usize>(
        geometry: &'a Geometry<'a, C>,
        limits: &'a KinematicLimits<f64>,
        (begin, end): (f64, f64),
    ) -> Option<Self>
    where
        C: Differentiate<f64, D>,
    {
        let rounding = rounding_at(end);
        let pieces = geometry.pieces_between(begin + rounding, end - rounding);
        let least = geometry.limit().allowance_over(begin, end);
        (end - begin > 2.0 * rounding && !pieces.is_empty()).then_some(Self {
            geometry,
            limits,
            begin,
            end,
            pieces,
            limits_axes: limits.limit_accelerations_of_axes(D),
            has_allowances: least.acceleration < limits.acceleration || least.jerk < limits.jerk,
        })
    }

    /// More than rounding may move a distance by.
    pub(crate) fn rounding(&self) -> f64 {
        rounding_at(self.end)
    }

    pub(crate) fn length(&self) -> f64 {
        self.end - self.begin
    }

    /// The time over which a motion is looked at as one: a period, or what is a small share of the time in which any jerk builds up its
    /// acceleration, if that is longer.
    pub(crate) fn moment(&self) -> f64 {
        let limits = self.limits;
        let path = limits.acceleration / limits.jerk;
        let of_axes = limits.axes.iter().filter_map(|axis| Some(axis.acceleration? / axis.jerk?));
        limits.interpolation_period.max(MOMENT * of_axes.fold(path, f64::min))
    }

    /// The piece that a distance is in, the earlier one at a joint.
    pub(crate) fn piece_at(&self, distance: f64) -> Option<&'a Piece> {
        let next = self.pieces.partition_point(|piece| piece.end < distance);
        self.pieces.get(next).or(self.pieces.last())
    }

    pub(crate) fn bend<const D: usize>(&self, distance: f64) -> Bend
    where
        C: Differentiate<f64, D>,
    {
        self.piece_at(distance).map_or_else(Bend::default, |piece| self.bend_of(piece, distance))
    }

    /// How a piece bends at a distance; not at all where no axis is limited, for the bend counts for axes alone.
    pub(crate) fn bend_of<const D: usize>(&self, piece: &Piece, distance: f64) -> Bend
    where
        C: Differentiate<f64, D>,
    {
        if self.limits_axes { self.geometry.bend(piece, distance) } else { Bend::default() }
    }

    /// The limit of the feed.
    pub(crate) fn feed(&self, distance: f64) -> f64 {
        self.geometry.limit().at(distance)
    }

    /// The least limit of the feed between two distances, beyond the rests at both ends.
    pub(crate) fn least_feed(&self, from: f64, to: f64) -> f64 {
        let inside = |distance: f64| distance.clamp(self.begin, self.end);
        let rests = from <= self.begin || to >= self.end;
        if rests {
            self.feed(0.5 * (from + to))
        } else {
            self.geometry.limit().minimum_over(inside(from), inside(to))
        }
    }

    /// Whether everything that limits the feed is the same between two distances: the way is straight and the limit of the feed
    /// level.
    pub(crate) fn is_even(&self, from: f64, to: f64) -> bool {
        let is_line = |distance: f64| self.piece_at(distance).filter(|piece| piece.is_line);
        let middle = 0.5 * (from + to);
        is_line(middle).is_some_and(|piece| piece.begin <= from && to <= piece.end)
            && self.geometry.limit().is_level_over(from, to)
    }

    /// How calm the way is between two distances, if a motion at the limit takes no more of any acceleration and jerk there than
    /// this share: the limit of the feed in the middle, and the curvature.
    pub(crate) fn calm<const D: usize>(&self, from: f64, to: f64, share: f64) -> Option<(f64, f64)>
    where
        C: Differentiate<f64, D>,
    {
        let middle = 0.5 * (from + to);
        let feed = self.feed(middle);
        if self.is_even(from, to) {
            return Some((feed, 0.0));
        }
        let piece =
            self.piece_at(middle).filter(|piece| !piece.is_line && piece.begin <= from && to <= piece.end)?;
        let (begin, end) = (self.feed(from), self.feed(to));
        let acceleration = 0.5 * (end - begin) * (end + begin) / (to - from);
        // As if the acceleration changed its sign over the stretch.
        let jerk = 2.0 * acceleration * feed / (to - from);
        let bend = self.bend_of(piece, middle);
        let strain = self.strain(&Motion { distance: middle, feed, acceleration, jerk }, &bend, feed);
        let curvature = Real::sqrt(bend.k.iter().fold(0.0, |sum, k| sum + k * k));
        (strain.acceleration <= share && strain.jerk <= share).then_some((feed, curvature))
    }

    /// The path's jerk on a straight way in the direction of this bend.
    pub(crate) fn jerk_along(&self, bend: &Bend) -> f64 {
        let of_axes = (0..AXES).filter_map(|i| Some((bend.e[i].abs(), self.limits.axes[i].jerk?)));
        of_axes.fold(self.limits.jerk, |least, (e, most)| if e * least > most { most / e } else { least })
    }

    /// The path's acceleration on a straight way in the direction of this bend.
    pub(crate) fn acceleration_along(&self, bend: &Bend) -> f64 {
        let of_axes = (0..AXES).filter_map(|i| Some((bend.e[i].abs(), self.limits.axes[i].acceleration?)));
        of_axes.fold(
            self.limits.acceleration,
            |least, (e, most)| if e * least > most { most / e } else { least },
        )
    }

    /// The acceleration and jerk that the path has between two distances.
    pub(crate) fn of_path(&self, from: f64, to: f64) -> Allowance<f64> {
        let all = Allowance::of_path(self.limits);
        if self.has_allowances { self.geometry.limit().allowance_over(from, to).min(all) } else { all }
    }

    /// What a motion takes of what is allowed where the path bends like this.
    pub(crate) fn strain(&self, motion: &Motion, bend: &Bend, most: f64) -> Strain {
        let &Motion { feed: v, acceleration: a, jerk: j, distance } = motion;
        let of_path = self.of_path(distance, distance);
        let mut strain = Strain {
            feed: if v > 0.0 { v / most } else { 0.0 },
            acceleration: a.abs() / of_path.acceleration,
            jerk: j.abs() / of_path.jerk,
        };
        // The velocities of axes are in the limit of the feed.
        for (i, axis) in self.limits.axes.iter().enumerate().filter(|_| self.limits_axes) {
            let (e, k, c) = (bend.e[i], bend.k[i], bend.c[i]);
            if let Some(most) = axis.velocity {
                strain.feed = strain.feed.max(e.abs() * v / most);
            }
            if let Some(most) = axis.acceleration {
                strain.acceleration = strain.acceleration.max((e * a + k * v * v).abs() / most);
            }
            if let Some(most) = axis.jerk {
                strain.jerk = strain.jerk.max((e * j + 3.0 * k * v * a + c * v * v * v).abs() / most);
            }
        }
        strain
    }
}
