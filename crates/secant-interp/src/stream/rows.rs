//! The rows of a section: pieces and stages, one number after the other.

use feed_plan::StageShape;
use nurbs_core::{Joint, Piece};
use real::FromWord;

use crate::step_lengths::LengthStage;
use crate::stream::bytes::Bytes;

/// Joints, by their numbers in a file.
pub(crate) const JOINTS: [Joint; 3] = [Joint::Continues, Joint::Smooth, Joint::Breaks];

/// Takes the row of a piece; its coefficients follow. `Err` holds the field that no file has, `None` says that bytes are
/// missing.
pub(crate) fn piece<R: FromWord, const D: usize>(
    bytes: &mut Bytes<'_>,
) -> Option<Result<Piece<R, D>, &'static str>> {
    let (origin, coordinate_exponent) = (bytes.array(Bytes::i64)?, bytes.i8()?);
    let (step_exponent, range_exponent) = (bytes.i8()?, bytes.i8()?);
    let (joint_exponent, joint_ratio, joint) = (bytes.i8()?, bytes.u16()?, bytes.u8()?);
    let step_per_chord = bytes.array(Bytes::number)?;
    let Some(joint) = JOINTS.get(usize::from(joint)).copied() else { return Some(Err("joint")) };
    Some(Ok(Piece {
        origin,
        coordinate_exponent,
        step_exponent,
        range_exponent,
        joint_ratio,
        joint_exponent,
        joint,
        step_per_chord,
    }))
}

/// Takes a stage; what it returns is as of [`piece`].
pub(crate) fn stage<R: FromWord>(bytes: &mut Bytes<'_>) -> Option<Result<LengthStage<R>, &'static str>> {
    let (duration, shape) = (bytes.u64()?, bytes.u8()?);
    let [feed, change, bend] = bytes.array(Bytes::number)?;
    let shape = match shape {
        0 => StageShape::Cubic,
        1 => StageShape::Onset,
        2 => StageShape::Steady,
        3 => StageShape::Easing,
        4 => StageShape::Cosine,
        5 => StageShape::Bent(bend),
        _ => return Some(Err("shape")),
    };
    // What follows from the duration is computed as it was when the path was compiled.
    Some(LengthStage::new(duration, feed, change).map(|stage| stage.shaped(shape)).ok_or("duration"))
}
