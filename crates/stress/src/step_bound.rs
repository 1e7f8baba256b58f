//! The largest number of evaluations and operations of a step, from the loops of the code.

use secant_interp::BEHIND_JOINT;

/// The most that one step on compiled pieces may take.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub struct StepBound {
    /// Evaluations of the chord.
    pub evaluations: u64,
    /// Operations of [`real::Real`], comparisons and conversions among them.
    pub operations: u64,
}

/// The lengths of the loops of a step.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub struct StepShape {
    /// p.
    pub degree: usize,
    /// D.
    pub dimensions: usize,
    /// Whether a point takes a division.
    pub rational: bool,
    /// K: the evaluations that the pieces share.
    pub max_evaluations: u32,
    /// Pieces that the step touches: those that it leaves, and the one that it ends on.
    pub pieces: usize,
    /// Stages of the plan that its period touches.
    pub stages: usize,
}

impl StepBound {
    /// The bound of a step of this shape.
    ///
    /// The degree is p, the number of dimensions D, and K the evaluations allowed. Each line counts the code that it
    /// names:
    ///
    /// | what | operations | times |
    /// |---|---|---|
    /// | the mean feed over a part of a period (`step_lengths`); the most for a cosine, of 9 terms and 11 | 180 | stages |
    /// | one evaluation and its correction (`chord_step`): two Horner chains a coordinate, two for the weight | 2pD + 2p + 9D + 48 | K, and two for each piece behind the first |
    /// | re-expansion about the point (`Pieces::shifted`): p(p+1)/2 products a coordinate, as many for the weight; the division by the weight; scaling | (D + 1) (p(p+1)/2 + 6p + 4) | pieces |
    /// | to the end of a piece, and past a whole one (`over`, twice) | 2 (2pD + 2p + 5D + 8) | pieces |
    /// | start value, range, joint: the rest of `travel` and `cross` | 80 | pieces |
    /// | the point itself (`Pieces::offset`) | (p + 4) (D + 1) | 1 |
    /// | landing step, and the calls between | 10 | 1 |
    #[must_use]
    pub fn of(shape: &StepShape) -> Self {
        let StepShape { degree, dimensions, rational, max_evaluations, pieces, stages } = *shape;
        let (p, d) = (degree as u64, dimensions as u64);
        let (pieces, stages, most) = (pieces as u64, stages as u64, u64::from(max_evaluations.max(1)));
        let weight = u64::from(rational);
        let evaluation = 2 * p * d + 2 * p * weight + 9 * d + 48;
        let expansion = (d + weight) * (p * (p + 1) / 2 + 6 * p + 4);
        let over = 2 * p * d + 2 * p * weight + 5 * d + 8;
        let evaluations = most + u64::from(BEHIND_JOINT) * pieces.saturating_sub(1);
        Self {
            evaluations,
            operations: stages * 180
                + evaluations * evaluation
                + pieces * (expansion + 2 * over + 80)
                + (p + 4) * (d + weight)
                + 10,
        }
    }
}
