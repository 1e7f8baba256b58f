//! Stages: a profile given by states, as few pieces of constant jerk as keep it.
//!
//! Two pieces of the same time lead from any state to any other. With the mean `v̄ = (v₀ + v₁)/2` they take the time
//! `h = 2Δs/(v̄ + √(v̄² + (a₀ - a₁) Δs/3))`, as one piece does, and the acceleration in the middle is `2Δv/h - (a₀ + a₁)/2`. Where that
//! is the mean of both, they are one.
//!
//! From each state the longest such arc is taken that is hardly slower than the profile and breaks no limit by more than a stretch of
//! time by 2⁻¹³ heals. Where none is found, one to a state further on or from one before takes its place.

use alloc::vec::Vec;

use real::Real;

use crate::plan::fastest::motion::State;

/// A stretch by 2⁻¹³ may be needed.
pub(crate) const TOLERANCE: i32 = -13;
/// An arc is hard where a stretch by 2⁻¹² would not do.
pub(crate) const HARD: i32 = -12;
/// An arc may be slower than the profile by 2⁻¹³ of its time.
const SLOWER: i32 = -13;
/// States that one arc passes, at most.
const LONGEST: usize = 1 << 10;
/// States further on, and arcs before, that are tried where none fits.
const FURTHER: usize = 12;
const BEFORE: usize = 4;
/// Newton's steps to where a piece is highest above the limit.
const HIGHEST: usize = 4;
/// They end where the next is nearer than this share of the time, as a power of two.
const NEAR: i32 = -12;
/// Steps to the time at a node, Newton's or halvings.
const STEPS: usize = 40;
/// The place is found to this share of the way between two limit points: the limit may have a narrow minimum just there.
const CLOSE: i32 = -30;

/// A state that the motion may pass, its time from the section's begin, and the last limit point up to it.
#[derive(Clone, Copy, Debug)]
pub(crate) struct Point<R> {
    pub(crate) state: State<R>,
    pub(crate) time: R,
    pub(crate) cell: usize,
}

/// Constant jerk for a time.
#[derive(Clone, Copy, Debug)]
pub(crate) struct Piece<R> {
    pub(crate) from: State<R>,
    pub(crate) to: State<R>,
    pub(crate) time: R,
}

impl<R: Real> Piece<R> {
    pub(crate) fn jerk(&self) -> R {
        (self.to.a - self.from.a) / self.time
    }

    /// The time at which the feed is highest or lowest within it.
    pub(crate) fn turn(&self) -> Option<R> {
        let (a, b) = (self.from.a, self.to.a);
        let turns = (a > R::zero() && b < R::zero()) || (a < R::zero() && b > R::zero());
        turns.then(|| self.time * (a / (a - b)))
    }
}

/// What a piece lasts at least: rounding of its feeds changes the jerk by no more than a small share then, [`rounding`].
pub(crate) fn shortest<R: Real>(feed: R, jerk: R) -> R {
    (R::resolution().sqrt() * feed.max(R::one().half()) / jerk).sqrt()
}

/// By how much time is stretched for the roundings of feeds.
pub(crate) fn rounding<R: Real>() -> R {
    R::resolution().sqrt().ldexp(1)
}

/// The time from one state to another at constant jerk.
pub(crate) fn time_between<R: Real>(from: &State<R>, to: &State<R>) -> Option<R> {
    let (length, mean) = (to.s - from.s, (from.v + to.v).half());
    let square = mean * mean + (from.a - to.a) * length * R::from_ratio(1, 3);
    if !(square >= R::zero() && length > R::zero()) {
        return None;
    }
    let sum = mean + square.sqrt();
    (sum > R::zero()).then(|| length.ldexp(1) / sum)
}

fn arc<R: Real>(from: &State<R>, to: &State<R>) -> Option<[Piece<R>; 2]> {
    let time = time_between(from, to).filter(|time| time.is_finite())?;
    let mean = (from.a + to.a).half();
    let a = ((to.v - from.v) / time).ldexp(1) - mean;
    let most = from.a.abs().max(to.a.abs());
    let a = if (a - mean).abs() <= most * R::resolution().sqrt().ldexp(-2) { mean } else { a };
    let half = time.half();
    let v = from.v + half * (from.a + a).half();
    let s = from.s + half * (from.v + v).half() - half * half * (a - from.a) * R::from_ratio(1, 12);
    let middle = State { s, v, a };
    Some([Piece { from: *from, to: middle, time: half }, Piece { from: middle, to: *to, time: half }])
}

/// The limits of a section.
pub(crate) struct Bounds<R> {
    /// Distance and square of the limit, which is linear between them.
    pub(crate) squares: Vec<(R, R)>,
    pub(crate) acceleration: R,
    pub(crate) jerk: R,
    /// What a piece lasts at least.
    pub(crate) shortest: R,
}

impl<R: Real> Bounds<R> {
    /// The least time between two points: an arc has two pieces.
    pub(crate) fn gap(&self) -> R {
        self.shortest.ldexp(1)
    }

    /// By how much time would have to be stretched for a piece to keep acceleration and jerk, as a share.
    fn strained(&self, piece: &Piece<R>) -> R {
        let over = |used: R, limit: R| used.abs() / limit - R::one();
        let acceleration = piece.from.a.abs().max(piece.to.a.abs());
        let by_acceleration = over(acceleration, self.acceleration).half();
        let by_jerk = over(piece.jerk(), self.jerk) * R::from_ratio(1, 3);
        if there_is_motion(piece) { by_acceleration.max(by_jerk).max(R::zero()) } else { R::max_value() }
    }

    /// The same for the limit, or more than `enough` if it is that at some place. As a share v² is highest above the line L of the
    /// limit where `2 a L = v² L'`. The difference changes by `2 j L` with time, so for j < 0 that is one place, and for j > 0 no
    /// place between the ends is higher than they are.
    fn broken(&self, piece: &Piece<R>, cell: &mut usize, enough: R) -> R {
        let jerk = piece.jerk();
        let mut broken = R::zero();
        let (mut time, mut here) = (R::zero(), piece.from);
        while let Some(&[(a, b0), (b, b1)]) = self.squares.get(*cell..*cell + 2) {
            let is_last = piece.to.s <= b || *cell + 2 >= self.squares.len();
            let end = if is_last { piece.time } else { time_at(piece, jerk, b, (here, time)) };
            let there = if is_last { piece.to } else { piece.from.after(end, jerk) };
            let slope = (b1 - b0) / (b - a);
            let above = |state: &State<R>| {
                let limit = b0 + slope * (state.s - a);
                let excess = state.v * state.v - limit;
                if excess > R::zero() { (excess / limit).half() } else { R::zero() }
            };
            broken = broken.max(above(&there)).max(above(&here));
            // At a jerk below zero the feed is at most that at the acceleration of the begin.
            let span = end - time;
            let top = here.v.max(there.v).max(here.v + here.a * span);
            let line = |at: R| b0 + slope * (at - a);
            if jerk < R::zero() && top * top > line(here.s).min(line(there.s)) {
                let mut highest = ((slope.half() - here.a) / jerk).max(R::zero()).min(span);
                for _ in 0..HIGHEST {
                    let state = here.after(highest, jerk);
                    broken = broken.max(above(&state));
                    let rise = (state.a * line(state.s)).ldexp(1) - state.v * state.v * slope;
                    let fall = (jerk * line(state.s)).ldexp(1);
                    let next = (highest - rise / fall).max(R::zero()).min(span);
                    if (next - highest).abs() <= span.ldexp(NEAR) {
                        break;
                    }
                    highest = next;
                }
            }
            if is_last || broken > enough {
                break;
            }
            (time, here) = (end, there);
            *cell += 1;
        }
        broken
    }

    /// Whether all parts of an arc last long enough.
    fn lasts(&self, pieces: &[Piece<R>; 2]) -> bool {
        pieces.iter().all(|piece| {
            let turn = piece.turn().unwrap_or(R::zero());
            let parts = [turn, piece.time - turn];
            parts.iter().all(|time| time.is_zero() || *time >= self.shortest)
        })
    }

    /// By how much time would have to be stretched for an arc to keep all limits, or more than `enough`.
    fn broken_by(&self, pieces: &[Piece<R>; 2], mut cell: usize, enough: R) -> R {
        let mut broken = self.strained(&pieces[0]).max(self.strained(&pieces[1]));
        for piece in pieces {
            if broken > enough {
                break;
            }
            broken = broken.max(self.broken(piece, &mut cell, enough));
        }
        broken
    }
}

/// Whether the feed does not fall below zero within a piece.
fn there_is_motion<R: Real>(piece: &Piece<R>) -> bool {
    let (from, to) = (piece.from, piece.to);
    let least = if from.a < R::zero() && to.a > R::zero() {
        let jerk = piece.jerk();
        from.v - from.a * from.a / (jerk + jerk)
    } else {
        from.v.min(to.v)
    };
    least >= R::zero()
}

/// When a piece is at a place, from an earlier state of it: first as if the acceleration stayed what it is there.
fn time_at<R: Real>(piece: &Piece<R>, jerk: R, place: R, (here, time): (State<R>, R)) -> R {
    let off = place - here.s;
    let square = (here.v * here.v + (here.a * off).ldexp(1)).max(R::zero());
    let mut end = (time + off.ldexp(1) / (here.v + square.sqrt())).min(piece.time);
    let (mut low, mut high) = (time, piece.time);
    let enough = (off * R::one().ldexp(CLOSE)).max((place.abs() * R::resolution()).ldexp(1));
    for _ in 0..STEPS {
        let state = piece.from.after(end, jerk);
        let rest = place - state.s;
        if rest.abs() <= enough {
            break;
        }
        if rest > R::zero() {
            low = end
        } else {
            high = end
        }
        let next = end + rest / state.v;
        // From rest the feed says nothing.
        end = if next > low && next < high { next } else { low + (high - low).half() };
    }
    end
}

/// Two pieces from one point to another.
#[derive(Clone, Copy, Debug)]
pub(crate) struct Arc<R> {
    pub(crate) from: Point<R>,
    pub(crate) to: Point<R>,
    pub(crate) pieces: [Piece<R>; 2],
    /// By how much time must be stretched for them to keep the limits, as a share.
    pub(crate) broken: R,
}

impl<R: Real> Arc<R> {
    /// Whether it breaks them by more than others.
    pub(crate) fn is_hard(&self) -> bool {
        self.broken > R::one().ldexp(HARD)
    }
}

/// Pieces along points.
pub(crate) struct Fit<R> {
    pub(crate) pieces: Vec<Piece<R>>,
    /// By how much time must be stretched for them to keep the limits, as a share.
    pub(crate) stretch: R,
    /// The time of the jerk-free profile.
    pub(crate) free: R,
    /// From where to where arcs break a limit by more than others.
    pub(crate) hard: Vec<[R; 2]>,
}

impl<R: Real> Fit<R> {
    pub(crate) fn duration(&self) -> R {
        self.pieces.iter().fold(R::zero(), |sum, piece| sum + piece.time)
    }

    /// The pieces of arcs: one, where that does.
    pub(crate) fn of(arcs: &[Arc<R>], free: R) -> Self {
        let mut pieces = Vec::with_capacity(arcs.len() * 2);
        for Arc { pieces: [first, second], .. } in arcs {
            if (first.from.a + second.to.a).half() == first.to.a {
                pieces.push(Piece { from: first.from, to: second.to, time: first.time + second.time });
            } else {
                pieces.extend([*first, *second]);
            }
        }
        let hard = arcs.iter().filter(|arc| arc.is_hard()).map(|arc| [arc.from.state.s, arc.to.state.s]);
        Self { pieces, stretch: worst(arcs), free, hard: hard.collect() }
    }
}

/// By how much the worst of arcs breaks limits.
pub(crate) fn worst<R: Real>(arcs: &[Arc<R>]) -> R {
    arcs.iter().fold(R::zero(), |worst, arc| worst.max(arc.broken))
}

/// Few arcs along the points, from the first to the last.
pub(crate) fn fit<R: Real>(points: &[Point<R>], bounds: &Bounds<R>) -> Option<Vec<Arc<R>>> {
    let way = Way { points, bounds };
    let last = points.len().checked_sub(1)?;
    let mut joints = Vec::from([0]);
    while let Some(&here) = joints.last().filter(|here| **here < last) {
        if way.fits(here, here + 1) {
            joints.push(way.longest(here, last));
        } else {
            let (before, to) = way.least_broken(&joints, here, last)?;
            joints.truncate(joints.len() - before);
            joints.push(to);
        }
    }
    let arcs = joints.windows(2).map(|pair| {
        let (from, to) = (points[pair[0]], points[pair[1]]);
        let pieces = arc(&from.state, &to.state)?;
        let broken = bounds.broken_by(&pieces, from.cell, R::max_value());
        Some(Arc { from, to, pieces, broken })
    });
    arcs.collect()
}

struct Way<'a, R> {
    points: &'a [Point<R>],
    bounds: &'a Bounds<R>,
}

impl<R: Real> Way<'_, R> {
    /// By how much an arc between two points breaks the limits, or more than `enough`. An arc that is slower than the profile breaks
    /// one too.
    fn broken(&self, from: usize, to: usize, enough: R) -> Option<R> {
        let (from, to) = (self.points.get(from)?, self.points.get(to)?);
        let pieces = arc(&from.state, &to.state).filter(|pieces| self.bounds.lasts(pieces))?;
        let wanted = to.time - from.time;
        let late = ((pieces[0].time.ldexp(1) - wanted) / wanted - R::one().ldexp(SLOWER)).ldexp(-2);
        Some(if late > enough { late } else { late.max(self.bounds.broken_by(&pieces, from.cell, enough)) })
    }

    fn fits(&self, from: usize, to: usize) -> bool {
        let tolerance = R::one().ldexp(TOLERANCE);
        self.broken(from, to, tolerance).is_some_and(|broken| broken <= tolerance)
    }

    /// The furthest point that an arc leads to, by doubling and halving.
    fn longest(&self, here: usize, last: usize) -> usize {
        let (mut good, mut step) = (here + 1, 1);
        while step < LONGEST && good + step <= last && self.fits(here, good + step) {
            good += step;
            step *= 2;
        }
        while step > 1 {
            step /= 2;
            if good + step <= last && self.fits(here, good + step) {
                good += step;
            }
        }
        good
    }

    /// Where none fits from the last joint: how many joints are left out for an arc to which point.
    fn least_broken(&self, joints: &[usize], here: usize, last: usize) -> Option<(usize, usize)> {
        let (mut least, mut best) = (R::max_value(), None);
        for (before, from) in joints.iter().rev().take(BEFORE).enumerate() {
            for to in here + 1..=(here + FURTHER).min(last) {
                let Some(broken) = self.broken(*from, to, least).filter(|broken| *broken < least) else {
                    continue;
                };
                (least, best) = (broken, Some((before, to)));
                if broken <= R::one().ldexp(TOLERANCE) {
                    return best;
                }
            }
        }
        best
    }
}
