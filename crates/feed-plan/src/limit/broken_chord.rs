//! A chord over breaks of the tangent, and how far it leaves the path.

use real::Real;

use crate::limit::vector::difference;

/// A limit is set where a measure is more than 2⁻⁸ above the allowed value, and it is found with the same tolerance.
pub(crate) const SLACK: i32 = -8;
/// Secants in the search for the length at which h is the allowed distance.
const SECANTS: usize = 6;

/// A point of the path, and where it lies.
#[derive(Clone, Copy, Debug)]
pub(crate) struct PathPoint<R, const D: usize> {
    pub(crate) distance: R,
    pub(crate) point: [R; D],
    pub(crate) tangent: [R; D],
}

/// Half of the chord at which `measure` has the allowed value, found by secants between `held`, a half chord that keeps
/// it, and `over`, one that does not. Where the measure is convex each secant falls short of the solution.
pub(crate) fn crossing<R: Real, const D: usize>(
    mut chord: Chord<'_, R, D>,
    mut held: (R, R),
    mut over: (R, R),
    allowed: R,
    measure: impl Fn(&Chord<'_, R, D>) -> R,
) -> R {
    for _ in 0..SECANTS {
        let (width, rise) = (over.0 - held.0, over.1 - held.1);
        let room = allowed - held.1;
        if !(room > allowed.ldexp(SLACK) && rise > R::zero()) {
            break;
        }
        let half = held.0 + width * (room / rise);
        chord.change_to(half);
        let found = measure(&chord);
        // The tolerance for `over`: rounding must not throw the search back to where it began.
        let is_over = found > allowed + allowed.ldexp(SLACK).half();
        if is_over { over = (half, found) } else { held = (half, found) }
    }
    held.0
}

/// A chord over a break, as far before it as behind it along the path.
pub(crate) struct Chord<'a, R, const D: usize> {
    places: &'a [PathPoint<R, D>],
    at: R,
    centre: [R; D],
    pub(crate) half: R,
    /// The range of the places within the chord: the first, and the one behind the last.
    within: (usize, usize),
}

impl<'a, R: Real, const D: usize> Chord<'a, R, D> {
    /// A chord of no length over the break at a distance; `None` beyond the places.
    pub(crate) fn new(places: &'a [PathPoint<R, D>], at: R) -> Option<Self> {
        let first = places.partition_point(|place| place.distance < at);
        let centre = places.get(first)?.point;
        let mut chord = Self { places, at, centre, half: R::zero(), within: (first, first) };
        chord.lengthen_to(R::zero());
        Some(chord)
    }

    fn distance_of(&self, place: usize) -> Option<R> {
        self.places.get(place).map(|place| place.distance)
    }

    pub(crate) fn lengthen_to(&mut self, half: R) {
        let (begin, end) = (self.at - half, self.at + half);
        let (mut first, mut beyond) = self.within;
        while first > 0 && self.distance_of(first - 1).is_some_and(|distance| distance >= begin) {
            first -= 1;
        }
        while self.distance_of(beyond).is_some_and(|distance| distance <= end) {
            beyond += 1;
        }
        (self.half, self.within) = (half, (first, beyond));
    }

    pub(crate) fn change_to(&mut self, half: R) {
        let (first, beyond) = self.within;
        let within = self.places.get(first..beyond).unwrap_or_default();
        let skipped = within.partition_point(|place| place.distance < self.at - half);
        let kept = within.partition_point(|place| place.distance <= self.at + half);
        self.within = (first + skipped, first + kept);
        self.lengthen_to(half);
    }

    /// Half of the next longer chord that ends at a place; the largest number if there is none.
    pub(crate) fn next_break(&self) -> R {
        let (first, beyond) = self.within;
        let before = first.checked_sub(1).and_then(|place| self.distance_of(place));
        let before = before.map_or_else(R::max_value, |distance| self.at - distance);
        let behind = self.distance_of(beyond).map_or_else(R::max_value, |distance| distance - self.at);
        before.min(behind)
    }

    /// Moves the chord along the path so that the break divides it at this share of its length. Returns the vectors
    /// from its begin to the break and from the break to its end.
    pub(crate) fn sides(&self, share: R) -> [[R; D]; 2] {
        let (begin, end) = if share == R::one().half() {
            let (first, beyond) = self.within;
            (self.point(first, self.at - self.half), self.point(beyond, self.at + self.half))
        } else {
            let length = self.half + self.half;
            (self.find(self.at - length * share), self.find(self.at + length * (R::one() - share)))
        };
        [difference(&self.centre, &begin), difference(&end, &self.centre)]
    }

    fn find(&self, distance: R) -> [R; D] {
        self.point(self.places.partition_point(|place| place.distance < distance), distance)
    }

    /// The point at a distance that lies between place `next` and the one before. It is on the cubic with the points
    /// and tangents of both; beyond the ends, the path goes straight on.
    fn point(&self, next: usize, distance: R) -> [R; D] {
        let before = next.checked_sub(1).and_then(|place| self.places.get(place));
        match (before, self.places.get(next)) {
            (Some(from), Some(to)) if to.distance > from.distance => from.on_the_way_to(to, distance),
            (Some(near), _) | (None, Some(near)) => {
                let length = distance - near.distance;
                core::array::from_fn(|d| near.point[d] + length * near.tangent[d])
            }
            (None, None) => self.centre,
        }
    }
}

impl<R: Real, const D: usize> PathPoint<R, D> {
    /// The point at a distance between this place and the next.
    fn on_the_way_to(&self, to: &Self, distance: R) -> [R; D] {
        let length = to.distance - self.distance;
        let x = (distance - self.distance) / length;
        let rest = R::one() - x;
        let bend = x * rest;
        core::array::from_fn(|d| {
            let step = to.point[d] - self.point[d];
            let (first, last) = (length * self.tangent[d] - step, length * to.tangent[d] - step);
            self.point[d] + x * step + bend * (rest * first - x * last)
        })
    }
}
