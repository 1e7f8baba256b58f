//! A chord over breaks of the tangent, and the path that it leaves.

use real::Real;

use crate::limit::vector::difference;

/// A limit is set where a measure is more than 2⁻⁸ above what is allowed, and found to that.
pub(crate) const SLACK: i32 = -8;
/// Secants to the length at which h is what is allowed.
const SECANTS: usize = 6;

/// A place of the path.
#[derive(Clone, Copy, Debug)]
pub(crate) struct Place<R, const D: usize> {
    pub(crate) distance: R,
    pub(crate) point: [R; D],
    pub(crate) tangent: [R; D],
}

/// Half of the chord at which `measure` is what is allowed: between one that holds and one that does not, by secants. Where the measure
/// is convex each is short of it.
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
        if !(room > allowed.scale(SLACK) && rise > R::zero()) {
            break;
        }
        let half = held.0 + width * (room / rise);
        chord.change_to(half);
        let found = measure(&chord);
        // What rounding adds must not throw it back to where it began.
        let is_over = found > allowed + allowed.scale(SLACK).half();
        if is_over { over = (half, found) } else { held = (half, found) }
    }
    held.0
}

/// A chord over a break, as far before it as behind it along the path.
pub(crate) struct Chord<'a, R, const D: usize> {
    places: &'a [Place<R, D>],
    at: R,
    centre: [R; D],
    pub(crate) half: R,
    /// The places from the first to the second are within the chord.
    within: (usize, usize),
}

impl<'a, R: Real, const D: usize> Chord<'a, R, D> {
    /// Of no length; `None` beyond the places.
    pub(crate) fn new(places: &'a [Place<R, D>], at: R) -> Option<Self> {
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

    /// Half of the next longer chord that ends at a place; of any length beyond them.
    pub(crate) fn next_break(&self) -> R {
        let (first, beyond) = self.within;
        let before = first.checked_sub(1).and_then(|place| self.distance_of(place));
        let before = before.map_or_else(R::max_value, |distance| self.at - distance);
        let behind = self.distance_of(beyond).map_or_else(R::max_value, |distance| distance - self.at);
        before.min(behind)
    }

    /// From the begin of a chord of this length that has the break at this share of it to the break, and from there to its end.
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

    /// The point at this distance, which is before place `next` and not before the one before that: by the cubic that has the
    /// tangents of both, or straight on beyond the ends.
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

impl<R: Real, const D: usize> Place<R, D> {
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
