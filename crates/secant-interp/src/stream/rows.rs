//! The rows of a section: pieces and stages, one number after the other.

use feed_plan::StageShape;
use nurbs_core::{Joint, Piece};
use real::FromWord;

use crate::step_lengths::LengthStage;
use crate::stream::bytes::Bytes;
use crate::stream::layout::RowShape;
use crate::stream::straight;

/// Joints, by their numbers in a file.
pub(crate) const JOINTS: [Joint; 3] = [Joint::Continues, Joint::Smooth, Joint::Breaks];

/// The bit of a joint's byte that says that the piece has the short row of a straight one. The bits above are 0, and a
/// reader refuses others.
pub(crate) const STRAIGHT: u8 = 1 << 2;

/// Takes the row of a piece, and whether it is the short row of a straight one; its coefficients follow. `Err` holds the field
/// that no file has, `None` says that bytes are missing.
pub(crate) fn piece<R: FromWord, const D: usize>(
    bytes: &mut Bytes<'_>,
    shape: &RowShape,
) -> Option<Result<(Piece<R, D>, bool), &'static str>> {
    let (origin, coordinate_exponent) = (bytes.array(Bytes::i64)?, bytes.i8()?);
    let (step_exponent, range_exponent) = (bytes.i8()?, bytes.i8()?);
    let (joint_exponent, joint_ratio, joint) = (bytes.i8()?, bytes.u16()?, bytes.u8()?);
    let is_straight = joint & STRAIGHT != 0;
    let step_per_chord = if is_straight {
        let least = bytes.number()?;
        let beside = if shape.beside_bytes() == 2 { bytes.i16()? } else { bytes.i8()?.into() };
        straight::range(least, beside.into())
    } else {
        bytes.array(Bytes::number)?
    };
    let Some(joint) = JOINTS.get(usize::from(joint & !STRAIGHT)).copied() else { return Some(Err("joint")) };
    let row = Piece {
        origin,
        coordinate_exponent,
        step_exponent,
        range_exponent,
        joint_ratio,
        joint_exponent,
        joint,
        step_per_chord,
    };
    Some(Ok((row, is_straight)))
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
