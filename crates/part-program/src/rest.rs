//! The rests of a machine between two moves, whatever their directions. Only this file decides where they are.

use std::fmt;

use crate::joint::is_joined;
use crate::moves::MoveKind;
use crate::part::Part;

/// The reason why the machine rests between two moves.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
#[non_exhaustive]
pub enum Rest {
    /// A word between them acts: a spindle, a tool, a coolant.
    Auxiliary,
    /// The program wants an exact stop.
    ExactStop,
    /// One of them is rapid.
    Rapid,
    /// They do not meet.
    Gap,
}

impl fmt::Display for Rest {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        f.write_str(match self {
            Self::Auxiliary => "at an M, S, T, D or H word",
            Self::Rapid => "next to a rapid move",
            Self::Gap => "at a gap",
            Self::ExactStop => "at an exact stop",
        })
    }
}

impl Part {
    /// The reason why the machine rests before move `next`, if it does. Before the first move there is no rest.
    #[must_use]
    pub fn rest_before(&self, next: usize) -> Option<Rest> {
        let (before, after) = (self.moves.get(next.checked_sub(1)?)?, self.moves.get(next)?);
        if self.has_word_before(next) {
            Some(Rest::Auxiliary)
        } else if before.exact_stop {
            Some(Rest::ExactStop)
        } else if [before, after].iter().any(|one| one.kind == MoveKind::Rapid) {
            Some(Rest::Rapid)
        } else if self.has_gap_before(next) {
            Some(Rest::Gap)
        } else {
            None
        }
    }

    /// Whether a curve begins elsewhere than the one before it ends.
    #[must_use]
    pub fn has_gap_before(&self, next: usize) -> bool {
        let points = |index: usize| self.curves.get(index).map(|curve| curve.control_points_mm());
        match (next.checked_sub(1).and_then(points), points(next)) {
            (Some([.., end]), Some([start, ..])) => !is_joined(end, start),
            _ => false,
        }
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::read_part;

    #[test]
    fn each_reason_is_told() {
        let part = read_part("p.nc", "G0 X0 Y0\nG1 X1 F600\nX2\nG9 X3\nX4\nM8\nX5\nG0 X6\nG1 X7\n").unwrap();
        let reasons: Vec<_> = (0..part.moves.len()).map(|next| part.rest_before(next)).collect();
        let first = reasons.iter().position(|reason| *reason == Some(Rest::ExactStop)).unwrap();
        assert_eq!(
            reasons[first - 2..],
            [None, None, Some(Rest::ExactStop), Some(Rest::Auxiliary), Some(Rest::Rapid), Some(Rest::Rapid)]
        );
    }

    #[test]
    fn curves_that_do_not_meet_have_a_gap() {
        let line = |from: f64, to: f64| {
            format!(
                "[[curve]]\ndegree = 1\nknots = [0, 0, 1, 1]\ncontrol_points_mm = [[{from}, 0], [{to}, 0]]\n"
            )
        };
        let part = read_part("p.toml", &[line(0.0, 1.0), line(1.0, 2.0), line(3.0, 4.0)].concat()).unwrap();
        assert_eq!([0, 1, 2, 3].map(|next| part.rest_before(next)), [None, None, Some(Rest::Gap), None]);
    }
}
