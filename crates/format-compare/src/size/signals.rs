//! What each signal of a step on pieces is, and with which others its register is narrowed.
//!
//! The glossary of the book has the same words. σ is the step per chord, the step η on the piece over the length L of
//! the chord; t is the place on the piece, and W the weight of a rational piece.

/// Name, group and meaning of each signal.
const SIGNALS: [(&str, &str, &str); 26] = [
    ("parameter", "parameter", "t, the place on the piece, from 0 to 1"),
    ("coefficient", "coordinates", "a coefficient of the piece's polynomial"),
    ("shifted_coefficient", "coordinates", "a coefficient of the piece's polynomial about t"),
    ("offset", "coordinates", "the position from the piece's first point"),
    ("weight", "weight", "W at t"),
    ("weight_reciprocal", "weight", "1/W at t"),
    ("weight_coefficient", "step", "a coefficient of W about t, over W at t"),
    ("chord_length", "step", "L, the length of the chord"),
    ("step_per_chord", "step", "sigma, the step on the piece over the length of the chord"),
    ("step_per_chord_fall", "step", "by how much the next sigma is expected to be less than the last"),
    ("step", "step", "eta = sigma L, the step on the piece"),
    ("chord_variable", "step", "x, the variable of the chord's polynomials: eta over a power of two"),
    ("chord_coefficient", "coordinates", "a coefficient of the chord per step"),
    ("chord_per_step", "step", "q, the chord per step"),
    ("chord_turn", "step", "x q', how the chord per step changes"),
    ("chord_weight", "step", "a coefficient or value of W at the end of a trial step, over W at its begin"),
    ("chord_direction", "step", "sigma q, the chord over L"),
    ("chord_residual", "step", "f, the error of the chord's square"),
    ("chord_growth", "step", "g, how the speed grows over the step"),
    ("chord_travelled", "step", "the chord over a given step"),
    ("joint_direction", "step", "the chord over L, a part of it on the piece before"),
    ("joint_residual", "step", "the error of the chord's square, a part of the chord on the piece before"),
    ("joint_growth", "step", "how the speed grows over the step, a part of it on the piece before"),
    ("joint_pull", "step", "how the chord changes with the step, a part of it on the piece before"),
    ("joint_travelled", "step", "the part of the chord on the piece before, over L"),
    ("joint_step_per_chord", "step", "sigma in the scale of the next piece"),
];

/// The group and the meaning of a signal on pieces. Any other is one of the step, and without a meaning.
pub(crate) fn group_and_meaning(signal: &str) -> (&'static str, &'static str) {
    let row = SIGNALS.iter().find(|(name, ..)| *name == signal);
    row.map_or(("step", ""), |(_, group, meaning)| (group, meaning))
}

#[cfg(test)]
mod tests {
    use nurbs_core::{NurbsBuf, PieceLimits, compile};

    use super::*;

    /// Every signal of two pieces with weights and a joint.
    fn bounded() -> Vec<&'static str> {
        let points = vec![[0.0, 0.0], [10.0, 0.0], [10.0, 10.0], [20.0, 10.0]];
        let knots = vec![0.0, 0.0, 0.0, 0.5, 1.0, 1.0, 1.0];
        let curve = NurbsBuf::try_new(2, points, vec![1.0, 0.8, 0.8, 1.0], knots).unwrap();
        let limits = PieceLimits { length_mm: 32.0, step_mm: 0.06 };
        let table = compile::<f64, f64, 2>(&[curve.as_curve()], &limits).unwrap();
        table.bounds().iter().map(|bound| bound.signal).collect()
    }

    #[test]
    fn test_the_table_has_the_signals_that_are_bounded_and_no_other() {
        let (mut named, mut found) = (SIGNALS.map(|(name, ..)| name).to_vec(), bounded());
        named.sort_unstable();
        found.sort_unstable();
        assert_eq!(named, found);
    }
}
