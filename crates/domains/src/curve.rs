//! The table `[curve]` of a curve file. The same ends hold for the numbers of curves in programs, drawings and JSON.

use crate::domain::Domain;
use crate::key::{Key, LeftOut, Value};
use crate::machine::FEED;

/// 10 km: it keeps squares and sums of coordinates far from the ends of every float.
pub const COORDINATE: Domain = Domain::of(-1e7, 1e7, "mm");

/// Nine decades up and down.
pub const WEIGHT: Domain = Domain::of(1e-9, 1e9, "");
/// A knot by itself.
pub const KNOT: Domain = Domain::of(-1e12, 1e12, "");
/// From the first knot to the last.
pub const KNOT_RANGE: Domain = Domain::of(1e-12, 2e12, "");
/// A knot that is not equal to the one before is greater by at least this share of the range. Neighbouring doubles are 1e-16 of
/// their size apart, but next to 0 far less, and over such a span derivatives leave the range of doubles.
pub const LEAST_KNOT_SPAN: f64 = 1e-18;
/// What a curve may jump from one double to the next, as a share of its control polygon: a length that is integrated over
/// such a span is not known any better.
pub const MOST_JUMP: f64 = 1e-9;

/// The kind of curve.
pub const SHAPE: Key = Key {
    name: "shape",
    value: Value::Word(&["nurbs", "trigonometric"]),
    left_out: LeftOut::Words("`\"nurbs\"`"),
    meaning: "a NURBS, or a spline of paper B",
};
/// p.
pub const DEGREE: Key = Key::whole("degree", [1, 9], "", "p of a NURBS; the order is p + 1");
/// Each coordinate of a control point.
pub const POINTS: Key = Key::number(
    "control_points_mm",
    COORDINATE,
    "P_0 … P_n, points of 2 or 3 coordinates, each of which is in this range",
);
/// Each weight.
pub const WEIGHTS: Key =
    Key::number("weights", WEIGHT, "w_0 … w_n of a NURBS, one a point").optional("all 1");
/// Each knot.
pub const KNOTS: Key = Key::number(
    "knots",
    KNOT,
    "u_0 … u_{n+p+1} of a NURBS, none less than the one before, the first and the last p + 1 times",
);
/// Feed of this curve.
pub const FEEDRATE: Key = Key::number("feedrate_mm_per_s", FEED, "F on this curve").optional("the machine's");
/// Whether it cuts.
pub const MOVE: Key = Key {
    name: "move",
    value: Value::Word(&["feed", "rapid"]),
    left_out: LeftOut::Words("`\"feed\"`"),
    meaning: "whether the curve is cut, or passed in rapid motion",
};
/// Whether it ends at rest.
pub const EXACT_STOP: Key = Key {
    name: "exact_stop",
    value: Value::Truth,
    left_out: LeftOut::Words("false"),
    meaning: "whether the machine rests at its end",
};
const FACTORS: Domain = Domain::of(-1e3, 1e3, "");
/// λ of paper B. For a larger value a segment is a loop far longer than its chord.
pub const LAMBDA: Key = Key::number("lambda", FACTORS, "shape factor λ of a trigonometric spline");
/// k of paper B.
pub const K: Key = Key::number("k", FACTORS, "shape factor k of a trigonometric spline");
/// What follows the last point.
pub const ENDS: Key = Key {
    name: "ends",
    value: Value::Word(&["continued", "repeated", "closed", "as-given"]),
    left_out: LeftOut::Words("`\"continued\"`"),
    meaning: "what follows the last point of a trigonometric spline",
};
/// How far polynomials may be from a trigonometric spline.
pub const TOLERANCE: Key = Key::number(
    "tolerance_mm",
    Domain::of(1e-9, 1.0, "mm"),
    "how far the polynomials that replace a trigonometric spline may be from it",
)
.or(1e-6);

/// The keys of the table `[curve]`.
pub const KEYS: [Key; 12] =
    [SHAPE, DEGREE, POINTS, WEIGHTS, KNOTS, FEEDRATE, MOVE, EXACT_STOP, LAMBDA, K, ENDS, TOLERANCE];
