//! Contours in a plane, of straight lines and arcs, and ways beside them at an even distance.
//!
//! A distance is positive to the left of the way, seen along it. The way beside a line is parallel to it; the way beside an arc has its
//! centre, and a radius that is less by the distance where the arc turns to the left, and greater where it turns to the right.

use std::f64::consts::{PI, TAU};

use crate::arc::FULL_TURN_MM;

/// A point, or a direction, in a plane.
pub(crate) type Point = [f64; 2];

/// How far places may be off one another by rounding, in mm.
const ROUNDING_MM: f64 = 1e-9;

/// A turn, in rad, that LinuxCNC takes for none: `scripts/canon` and contours at random show that it lies at 0.05.
pub(crate) const SMOOTH_RAD: f64 = 0.05;

/// A straight line, or an arc.
#[derive(Clone, Copy, Debug, PartialEq)]
pub(crate) struct Segment {
    pub(crate) start: Point,
    pub(crate) end: Point,
    /// The centre and the sense of an arc.
    pub(crate) about: Option<(Point, Sense)>,
}

/// The sense in which an arc turns.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub(crate) enum Sense {
    Clockwise,
    Counterclockwise,
}

impl Sense {
    /// 1 for counterclockwise, -1 for clockwise.
    pub(crate) fn sign(self) -> f64 {
        if self == Self::Clockwise { -1.0 } else { 1.0 }
    }
}

/// What a corner is for a tool that passes it on one side.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub(crate) enum Corner {
    /// The contour goes on as before.
    Smooth,
    /// The tool goes around it.
    Outer,
    /// The tool stops short of it.
    Inner,
}

/// The corner between two directions, for a tool at this distance. Where the contour goes back the way it came, the sense decides in
/// which it bends there: that of the next segment, or of the one before if the next is straight.
pub(crate) fn corner(before: Point, behind: Point, bend: Option<Sense>, distance: f64) -> Corner {
    let turn = cross(before, behind).atan2(dot(before, behind)) * distance.signum();
    let goes_back = turn.abs() >= PI - SMOOTH_RAD;
    let bends_away = bend.is_some_and(|sense| sense.sign() * distance < 0.0);
    if turn.abs() <= SMOOTH_RAD {
        Corner::Smooth
    } else if if goes_back { !bends_away } else { turn < 0.0 } {
        Corner::Outer
    } else {
        Corner::Inner
    }
}

impl Segment {
    /// The unit vector of the way at one of its points. The two ends of a line are apart, and no point of an arc is its centre.
    pub(crate) fn direction(&self, at: Point) -> Point {
        let along = match self.about {
            None => minus(self.end, self.start),
            Some((centre, sense)) => {
                let arm = minus(at, centre);
                [-arm[1] * sense.sign(), arm[0] * sense.sign()]
            }
        };
        let length = along[0].hypot(along[1]);
        [along[0] / length, along[1] / length]
    }

    /// The segment at a distance; `None` if the arc is too small for it.
    pub(crate) fn beside(&self, distance: f64) -> Option<Self> {
        if let Some((centre, sense)) = self.about {
            let radius = length(minus(self.start, centre)).min(length(minus(self.end, centre)));
            if distance * sense.sign() >= radius {
                return None;
            }
        }
        let moved = |at: Point| {
            let [x, y] = self.direction(at);
            [at[0] - distance * y, at[1] + distance * x]
        };
        Some(Self { start: moved(self.start), end: moved(self.end), about: self.about })
    }

    /// The length in mm, of the first turn of an arc.
    pub(crate) fn length(&self) -> f64 {
        match self.about {
            None => length(minus(self.end, self.start)),
            Some((centre, sense)) => {
                let angle = angle_between(centre, self.start, self.end, sense);
                let radius = length(minus(self.start, centre));
                radius * if angle * radius <= FULL_TURN_MM { TAU } else { angle }
            }
        }
    }

    /// How far, in mm, a point on the line or the circle of this segment lies before the end. It is negative for points behind the end of
    /// a line.
    pub(crate) fn way_to_end(&self, point: Point) -> f64 {
        match self.about {
            None => dot(minus(self.end, point), self.direction(point)),
            Some((centre, sense)) => {
                length(minus(self.end, centre)) * angle_between(centre, point, self.end, sense)
            }
        }
    }

    /// How far, in mm, a point on the line or the circle of this segment lies behind the start.
    pub(crate) fn way_from_start(&self, point: Point) -> f64 {
        match self.about {
            None => dot(minus(point, self.start), self.direction(point)),
            Some((centre, sense)) => {
                length(minus(self.start, centre)) * angle_between(centre, self.start, point, sense)
            }
        }
    }

    /// Where this segment, of which the last `left` mm are taken, first meets the next one, seen back from its end.
    pub(crate) fn last_meeting(&self, left: f64, next: &Self) -> Option<Point> {
        let is_on_both = |point: &Point| {
            let back = self.way_to_end(*point);
            let on = next.way_from_start(*point);
            (-ROUNDING_MM..=left + ROUNDING_MM).contains(&back)
                && (-ROUNDING_MM..=next.length() + ROUNDING_MM).contains(&on)
        };
        let found = self.meetings(next).into_iter().flatten().filter(is_on_both);
        found.min_by(|a, b| self.way_to_end(*a).total_cmp(&self.way_to_end(*b)))
    }

    /// The points at which the lines or circles of two segments meet. Of an arc whose two ends are off one circle by the rounding of its
    /// numbers, the circle is that of the end, as LinuxCNC's is.
    fn meetings(&self, other: &Self) -> [Option<Point>; 2] {
        match (self.about, other.about) {
            (None, None) => {
                let (a, b) = (self.direction(self.end), other.direction(other.start));
                let share = cross(minus(other.start, self.end), b) / cross(a, b);
                [Some([self.end[0] + share * a[0], self.end[1] + share * a[1]]), None]
            }
            (None, Some((centre, _))) => {
                let radius = length(minus(other.end, centre));
                line_and_circle(self.end, self.direction(self.end), centre, radius)
            }
            (Some((centre, _)), None) => {
                let radius = length(minus(self.end, centre));
                line_and_circle(other.start, other.direction(other.start), centre, radius)
            }
            (Some((one, _)), Some((two, _))) => {
                let between = minus(two, one);
                let apart = length(between);
                let (r, s) = (length(minus(self.end, one)), length(minus(other.end, two)));
                if apart == 0.0 {
                    return [None; 2];
                }
                // Both circles meet on the line across the centres' at this distance from the first.
                let foot = (apart * apart + r * r - s * s) / (2.0 * apart);
                let along = [between[0] / apart, between[1] / apart];
                let at = [one[0] + foot * along[0], one[1] + foot * along[1]];
                line_and_circle(at, [-along[1], along[0]], one, r)
            }
        }
    }
}

/// The points at which a line meets a circle.
fn line_and_circle(point: Point, direction: Point, centre: Point, radius: f64) -> [Option<Point>; 2] {
    let to_foot = dot(minus(centre, point), direction);
    let off = cross(direction, minus(centre, point));
    let square = radius * radius - off * off;
    // A line that touches may miss by rounding.
    if square < -ROUNDING_MM * radius {
        return [None; 2];
    }
    let half = square.max(0.0).sqrt();
    [to_foot - half, to_foot + half]
        .map(|way| Some([point[0] + way * direction[0], point[1] + way * direction[1]]))
}

/// The angle from one point to another about a centre, 0 to a full turn.
pub(crate) fn angle_between(centre: Point, from: Point, to: Point, sense: Sense) -> f64 {
    let (a, b) = (minus(from, centre), minus(to, centre));
    (cross(a, b).atan2(dot(a, b)) * sense.sign()).rem_euclid(TAU)
}

/// The arc from a place, where the tool is, to the end of the way beside an arc, in the direction that it has there. Its centre lies on
/// the line from that end to the centre of the arc.
pub(crate) fn arc_into(from: Point, arc: &Segment, distance: f64) -> Option<Segment> {
    let (centre, sense) = arc.about?;
    let end = arc.beside(distance)?.end;
    let to_centre = minus(centre, end);
    let inward = [to_centre[0] / length(to_centre), to_centre[1] / length(to_centre)];
    let chord = minus(from, end);
    let radius = dot(chord, chord) / (2.0 * dot(inward, chord));
    let about = Some(([end[0] + radius * inward[0], end[1] + radius * inward[1]], sense));
    (radius > 0.0 && radius.is_finite()).then_some(Segment { start: from, end, about })
}

fn minus(a: Point, b: Point) -> Point {
    [a[0] - b[0], a[1] - b[1]]
}

fn dot(a: Point, b: Point) -> f64 {
    a[0] * b[0] + a[1] * b[1]
}

fn cross(a: Point, b: Point) -> f64 {
    a[0] * b[1] - a[1] * b[0]
}

fn length(a: Point) -> f64 {
    a[0].hypot(a[1])
}
