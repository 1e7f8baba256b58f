//! The words of a part program whose numbers have ends of their own. All other numbers are those of a curve.

use crate::curve::{KNOTS, POINTS, WEIGHTS};
use crate::domain::Domain;
use crate::key::{Key, Value};
use crate::machine::FEED;

const fn of(name: &'static str, key: Key, meaning: &'static str) -> Key {
    Key { name, value: key.value, left_out: crate::LeftOut::Words(""), meaning }
}

/// A place of an axis.
pub const PLACE: Key = of("X, Y, Z", POINTS, "a place, in mm after offsets and units");
/// F.
pub const FEED_WORD: Key = Key {
    name: "F",
    value: Value::Number(FEED),
    left_out: crate::LeftOut::Words("the machine's"),
    meaning: "the feed, in mm/s after its unit; above the upper end the machine's own is taken, with a warning",
};
/// A knot of G06.2.
pub const KNOT: Key = of("K of G06.2", KNOTS, "a knot");
/// A weight.
pub const WEIGHT: Key = of("R of G06.2, P of G5.2, PW", WEIGHTS, "a weight");
/// Turns of an arc.
pub const TURNS: Key = Key::whole("P of G2, G3", [1, 10_000], "turns", "turns of an arc").optional("1");
/// Repetitions of a cycle.
pub const REPEATS: Key =
    Key::whole("L, K of a cycle", [0, 10_000], "", "how often the cycle is executed").optional("1");
/// Steps of a hole.
pub const STEPS: Key = Key::number(
    "Q of G73, G83",
    Domain::of(1e-7, 1e7, "mm"),
    "depth of a step; a hole has at most 10,000 of them",
);

/// The words.
pub const KEYS: [Key; 7] = [PLACE, FEED_WORD, KNOT, WEIGHT, TURNS, REPEATS, STEPS];
