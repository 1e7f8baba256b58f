//! The place of the coordinates that `rs274` prints.
//!
//! They are the program's coordinates. A point `p` in them is at `R(θ)·(p + g92) + g5x` in the machine's coordinates. θ
//! is the rotation about Z (`SET_XY_ROTATION`, in degrees), g92 the offset of G92 (`SET_G92_OFFSET`), and g5x the
//! offset of the work coordinate system (`SET_G5X_OFFSET`). The length of the tool is left out: the path is that of its
//! tip.

use crate::vector::difference;

/// The offsets in force, in mm and rad.
#[derive(Clone, Copy, Debug, Default, PartialEq)]
pub(crate) struct Frame {
    pub(crate) g5x: [f64; 3],
    pub(crate) g92: [f64; 3],
    pub(crate) rotation: f64,
    /// From the spindle to the tool's tip.
    pub(crate) tool: [f64; 3],
}

impl Frame {
    /// The program's zero in the machine's coordinates.
    pub(crate) fn zero(&self) -> [f64; 3] {
        let turned = self.turned(self.g92);
        std::array::from_fn(|axis| turned[axis] + self.g5x[axis])
    }

    /// This frame relative to the first one, whose coordinates are those of the part.
    pub(crate) fn seen_from(&self, first: &Self) -> Self {
        let zero = first.turned_back(difference(&self.zero(), &first.zero()));
        Self { g5x: zero, g92: [0.0; 3], rotation: self.rotation - first.rotation, tool: self.tool }
    }

    /// The point `p` of the program in the coordinates of the first frame. In the first frame itself it is `p` to the
    /// last bit.
    pub(crate) fn place(&self, p: [f64; 3], first: &Self) -> [f64; 3] {
        let seen = self.seen_from(first);
        let turned = seen.turned(p);
        std::array::from_fn(|axis| turned[axis] + seen.g5x[axis])
    }

    /// The direction or distance that a turn about Z brings to this one.
    pub(crate) fn turned_back(&self, p: [f64; 3]) -> [f64; 3] {
        Self { rotation: -self.rotation, ..*self }.turned(p)
    }

    /// A direction or a distance, turned about Z.
    pub(crate) fn turned(&self, p: [f64; 3]) -> [f64; 3] {
        if self.rotation == 0.0 {
            return p;
        }
        let (sin, cos) = self.rotation.sin_cos();
        [p[0] * cos - p[1] * sin, p[0] * sin + p[1] * cos, p[2]]
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    /// The output of `G10 L2 P1 X10 Y20 Z30 R45`, `G1 X3 Y0` and `G53 G1 X1`: X is then at 1 on the machine, and Y is
    /// where it was.
    #[test]
    fn a_rotation_comes_before_the_offset() {
        let frame = Frame { g5x: [10.0, 20.0, 30.0], rotation: 45.0_f64.to_radians(), ..Frame::default() };
        let [one, other] =
            [[3.0, 0.0, 4.0], [-4.8640, 7.8640, 4.0]].map(|p| frame.place(p, &Frame::default()));
        assert!((other[0] - 1.0).abs() < 1e-4 && (other[1] - one[1]).abs() < 1e-4, "{one:?} {other:?}");
    }

    #[test]
    fn coordinates_from_the_own_zero_keep_their_bits() {
        let frame = Frame { g5x: [0.1, 0.7, -3.3], g92: [1e3, 0.3, 9.9], ..Frame::default() };
        assert_eq!(frame.place([0.1, 0.2, 0.3], &frame), [0.1, 0.2, 0.3]);
        let turned = Frame { rotation: 0.7, ..frame };
        assert_eq!(turned.place([0.1, 0.2, 0.3], &turned), [0.1, 0.2, 0.3]);
    }
}
