//! Cutter compensation: the way of the tool's centre beside the contour that a program writes.
//!
//! A move of the contour becomes the move beside it, at the radius of the tool. Its end is known only with the next move of the plane:
//!
//! | corner to it | what becomes of it |
//! |---|---|
//! | a turn below [`SMOOTH_RAD`](crate::gcode::contour::SMOOTH_RAD) | nothing: the next move goes on where this one ends |
//! | outer | an arc about the corner joins both ways, in a rapid move a straight line |
//! | inner | both ways end and begin where they meet |
//!
//! The first move goes straight, or as an arc, from where the tool is to the end of the way beside it; a straight one must be longer
//! than the radius. Moves across the plane stay where the last move in the plane ends. Behind G40 a straight move leads back to the
//! contour. Feeds are those of the tool's centre; in G93 the time of a move is that of its contour.
//!
//! # Source
//! LinuxCNC, "Cutter Radius Compensation" and "G41, G42"; what these pages leave open is found by what `rs274` prints of contours:
//! `scripts/canon` and `scripts/compensation` compare with it.

use crate::arc::{ArcMove, Circle, FULL_TURN_MM, Plane};
use crate::curve::Curve;
use crate::exact_stops::PathMode;
use crate::gcode::block_place::BlockPlace;
use crate::gcode::contour::{Corner, Point, Segment, Sense, angle_between, arc_into, corner};
use crate::moves::{MoveKind, Shape};

/// Most moves across the plane whose place is open: a loop without a move in the plane would make more and more.
const MAX_WAITING: usize = 100_000;

/// A way, where it is entered, how much of it is left from there, in mm, and the moves whose ends are known with it.
type Joined = (Segment, Point, f64, Vec<Beside>);

/// A compensation that is in force.
#[derive(Clone, Debug)]
pub(crate) struct Compensation {
    /// How far the centre is to the left of the contour, in mm; negative to the right.
    distance: f64,
    pub(crate) plane: Plane,
    /// The last move in the plane.
    last: Option<Last>,
    /// That move and the moves across the plane behind it, whose place in the plane the next move decides.
    waiting: Vec<Beside>,
}

/// The last move in the plane.
#[derive(Clone, Copy, Debug)]
struct Last {
    way: Segment,
    /// How much of the way is left before its end, in mm.
    left: f64,
    /// The direction of the contour at its end.
    direction: Point,
}

/// A move of the contour.
#[derive(Clone, Copy, Debug)]
pub(crate) struct ContourMove {
    pub(crate) start: [f64; 3],
    pub(crate) end: [f64; 3],
    /// The centre, the sense and the number of turns of an arc.
    pub(crate) about: Option<(Point, Sense, u32)>,
    pub(crate) beside: What,
}

/// What a move has besides its path.
#[derive(Clone, Copy, Debug)]
pub(crate) struct What {
    pub(crate) kind: MoveKind,
    pub(crate) feed: Option<f64>,
    pub(crate) place: BlockPlace,
    /// How its end is passed.
    pub(crate) end: PathMode,
    /// Whether the tool rests at its end, whatever the path mode.
    pub(crate) rests: bool,
}

/// A move of the tool's centre.
#[derive(Clone, Copy, Debug)]
pub(crate) struct Beside {
    from: [f64; 3],
    to: [f64; 3],
    about: Option<Around>,
    pub(crate) what: What,
}

/// The circle of an arc, and how far the contour turns on it.
#[derive(Clone, Copy, Debug)]
struct Around {
    centre: Point,
    sense: Sense,
    turns: u32,
    /// The angle of the contour's first turn, in rad, from which the way's differs by less than half a turn.
    angle: f64,
}

/// The reason why a move cannot be compensated.
#[derive(Clone, Copy, Debug, PartialEq)]
pub(crate) enum Fault {
    /// The first move is no longer than the radius.
    EntryTooShort { length: f64 },
    /// No arc leads from the tool's place into the way beside the first arc.
    NoArcIn,
    /// The tool does not fit into the arc.
    ArcTooSmall,
    /// The ways of two moves do not meet within both.
    NotReached,
    /// More than [`MAX_WAITING`] moves go across the plane in one place.
    TooManyAcross,
}

impl Compensation {
    pub(crate) fn new(distance: f64, plane: Plane) -> Self {
        Self { distance, plane, last: None, waiting: Vec::new() }
    }

    /// The radius of the tool, in mm.
    pub(crate) fn radius(&self) -> f64 {
        self.distance.abs()
    }

    /// The place of the block of the last move.
    pub(crate) fn last_place(&self) -> Option<BlockPlace> {
        self.waiting.first().map(|one| one.what.place)
    }

    /// Where the centre is, if it has begun to be beside the contour.
    pub(crate) fn at(&self) -> Option<[f64; 3]> {
        self.waiting.last().map(|one| one.to)
    }

    /// The moves that wait.
    pub(crate) fn waiting(&mut self) -> &mut Vec<Beside> {
        &mut self.waiting
    }

    /// Follows a move of the contour, from `here` if it is the first. Returns the moves whose ends are known now.
    pub(crate) fn follow(&mut self, one: ContourMove, here: [f64; 3]) -> Result<Vec<Beside>, Fault> {
        let [_, _, normal] = self.plane.axes();
        let (start, end) = (self.flat(one.start), self.flat(one.end));
        if start == end && one.about.is_none() {
            return self.go_across(one);
        }
        let contour = Segment { start, end, about: one.about.map(|(centre, sense, _)| (centre, sense)) };
        let (way, begin, left, mut done) = match self.last {
            None => {
                let (way, length) = self.entry(&contour, self.flat(here))?;
                (way, self.flat(here), length, Vec::new())
            }
            Some(last) => self.join(&last, &contour, &one)?,
        };
        let about = way.about.zip(one.about).map(|((centre, sense), (_, _, turns))| {
            let angle = contour.length() / radius(centre_of(&contour).unwrap_or(centre), start);
            Around { centre, sense, turns, angle }
        });
        done.append(&mut self.waiting);
        let (from, to) = (self.lifted(begin, one.start[normal]), self.lifted(way.end, one.end[normal]));
        self.waiting.push(Beside { from, to, about, what: one.beside });
        self.last = Some(Last { way, left, direction: contour.direction(end) });
        Ok(done)
    }

    /// A move across the plane: it waits with the one before it.
    fn go_across(&mut self, one: ContourMove) -> Result<Vec<Beside>, Fault> {
        let [_, _, normal] = self.plane.axes();
        let from = self.at().ok_or(Fault::EntryTooShort { length: 0.0 })?;
        if self.waiting.len() >= MAX_WAITING {
            return Err(Fault::TooManyAcross);
        }
        let to = self.lifted(self.flat(from), one.end[normal]);
        self.waiting.push(Beside { from, to, about: None, what: one.beside });
        Ok(Vec::new())
    }

    /// Joins the way beside a move to the last one: that way, where it begins, the length that is left of it, and the moves whose ends are
    /// known now.
    fn join(&mut self, last: &Last, contour: &Segment, one: &ContourMove) -> Result<Joined, Fault> {
        let [_, _, normal] = self.plane.axes();
        let way = contour.beside(self.distance).ok_or(Fault::ArcTooSmall)?;
        let whole = way.length();
        let bend = way.about.or(last.way.about).map(|(_, sense)| sense);
        let start = contour.start;
        match corner(last.direction, contour.direction(start), bend, self.distance) {
            Corner::Smooth => Ok((way, self.at().map_or(start, |at| self.flat(at)), whole, Vec::new())),
            Corner::Outer => {
                let mut done = std::mem::take(&mut self.waiting);
                let to = self.lifted(way.start, one.start[normal]);
                done.extend(self.around_corner(done.last(), start, to, one.beside));
                Ok((way, way.start, whole, done))
            }
            Corner::Inner => {
                let meeting = last.way.last_meeting(last.left, &way).ok_or(Fault::NotReached)?;
                self.end_at(meeting);
                Ok((way, meeting, whole - way.way_from_start(meeting), Vec::new()))
            }
        }
    }

    /// A place in the plane.
    fn flat(&self, point: [f64; 3]) -> Point {
        let [first, second, _] = self.plane.axes();
        [point[first], point[second]]
    }

    /// The place in space above one in the plane.
    fn lifted(&self, [x, y]: Point, height: f64) -> [f64; 3] {
        let [first, second, normal] = self.plane.axes();
        let mut point = [0.0; 3];
        (point[first], point[second], point[normal]) = (x, y, height);
        point
    }

    /// The way of the first move, and the length before its end in which it may end earlier.
    fn entry(&self, contour: &Segment, here: Point) -> Result<(Segment, f64), Fault> {
        if contour.about.is_some() {
            // LinuxCNC wants it on both sides of the arc.
            let fits = [-1.0, 1.0].iter().all(|side| contour.beside(side * self.distance).is_some());
            if !fits {
                return Err(Fault::ArcTooSmall);
            }
            let way = arc_into(here, contour, self.distance).ok_or(Fault::NoArcIn)?;
            return Ok((way, way.length()));
        }
        let length = contour.length();
        if length <= self.radius() {
            return Err(Fault::EntryTooShort { length });
        }
        let way = contour.beside(self.distance).ok_or(Fault::ArcTooSmall)?;
        Ok((way, length))
    }

    /// The move around an outer corner, from the end of the last move to the start of the next way.
    fn around_corner(
        &self,
        last: Option<&Beside>,
        corner: Point,
        to: [f64; 3],
        what: What,
    ) -> Option<Beside> {
        let from = last?.to;
        let sense = if self.distance > 0.0 { Sense::Clockwise } else { Sense::Counterclockwise };
        let angle = angle_between(corner, self.flat(from), self.flat(to), sense);
        let around = Around { centre: corner, sense, turns: 1, angle };
        let about = Some(around).filter(|_| what.kind == MoveKind::Feed);
        Some(Beside { from, to, about, what: What { rests: false, ..what } })
    }

    /// Ends the last move in the plane at a place, with the moves behind it.
    fn end_at(&mut self, place: Point) {
        let [first, second, _] = self.plane.axes();
        for (index, one) in self.waiting.iter_mut().enumerate() {
            if index > 0 {
                (one.from[first], one.from[second]) = (place[0], place[1]);
            }
            (one.to[first], one.to[second]) = (place[0], place[1]);
        }
    }
}

impl Beside {
    /// Puts the move at this place on an axis, which was not known before.
    pub(crate) fn put(&mut self, axis: usize, place: f64) {
        (self.from[axis], self.to[axis]) = (place, place);
    }

    /// The curve, and the kind of it; `None` if the move has no length.
    pub(crate) fn curve(&self, plane: Plane) -> Option<(Curve, Shape)> {
        let Some(around) = self.about else {
            return (self.from != self.to).then(|| (Curve::line(self.from, self.to), Shape::Line));
        };
        let [first, second, _] = plane.axes();
        let in_plane = |point: [f64; 3]| [point[first], point[second]];
        let angle = angle_between(around.centre, in_plane(self.from), in_plane(self.to), around.sense);
        let radius = radius(around.centre, in_plane(self.from));
        // The ends alone leave a full turn open.
        let is_turned_on =
            (angle + std::f64::consts::TAU - around.angle).abs() < (angle - around.angle).abs();
        let is_next_to_nothing = angle * radius <= FULL_TURN_MM;
        let turns = match (is_turned_on, is_next_to_nothing) {
            (false, true) if around.turns == 1 => return None,
            (true, false) => around.turns + 1,
            _ => around.turns,
        };
        let circle = Circle::Centre(around.centre);
        let clockwise = around.sense == Sense::Clockwise;
        let arc = ArcMove { turns, ..ArcMove::new(plane, clockwise, [self.from, self.to], circle) };
        arc.spiral().ok().map(|(curve, _)| (curve, Shape::Arc))
    }
}

fn radius(centre: Point, at: Point) -> f64 {
    (at[0] - centre[0]).hypot(at[1] - centre[1])
}

fn centre_of(arc: &Segment) -> Option<Point> {
    arc.about.map(|(centre, _)| centre)
}
