//! The square of the feed over the distance, from rest to rest: a quadratic spline, so that acceleration is continuous.
//!
//! `b = v²`, `a = b'/2`, `j = √b b''/2`: in a cell b'' is constant and a linear. Cells meet with equal b and b'. Over the first cell and the
//! last, which touch a rest, the jerk is constant instead, so with h the cell's width and s the distance from the rest
//!
//! ```text
//! b = b₁ (s/h)^(4/3)        a = (2/3) b₁/h (s/h)^(1/3)        j = (2/9) b₁^(3/2)/h²        time 3h/√b₁
//! ```
//!
//! In between b is a sum of quadratic B-splines on the nodes (The NURBS Book, 2.2), with coefficients c. On a cell of width h three of
//! them make the Bézier values `b_l, c, b_r`: `b_l = α c₀ + (1 - α) c₁` with α the share of the cell in its width and that of the
//! one before, `b_r` likewise, and
//!
//! ```text
//! b' = 2(c₁ - b_l)/h .. 2(b_r - c₁)/h        b'' = 2(b_l - 2c₁ + b_r)/h²
//! ```
//!
//! Where the rest's law ends, `b' = (4/3) b₁/h₀` ties the second coefficient to the first: `c₁ = c₀ (1 + 2h₁/(3h₀))`. So N cells
//! have N - 2 unknowns, and whatever is linear in b on a cell is a sum of three neighbours.

use alloc::vec::Vec;

use crate::cube_root::cube_root;

/// A linear function of the unknowns: weights of three neighbours, the first of them at an index.
#[derive(Clone, Copy, Debug, Default, PartialEq)]
pub(crate) struct Functional {
    pub(crate) first: usize,
    pub(crate) weights: [f64; 3],
}

impl Functional {
    pub(crate) fn of(&self, unknowns: &[f64]) -> f64 {
        let [u, v, w] = self.weights;
        match unknowns.get(self.first..) {
            Some([x, y, z, ..]) => u * x + v * y + w * z,
            _ => 0.0,
        }
    }

    /// This one times a number, and another on the same cell.
    pub(crate) fn times_plus(&self, factor: f64, other: &Self) -> Self {
        let weights = core::array::from_fn(|i| factor * self.weights[i] + other.weights[i]);
        Self { weights, ..*self }
    }

    pub(crate) fn times(&self, factor: f64) -> Self {
        Self { weights: self.weights.map(|weight| weight * factor), ..*self }
    }
}

/// b on one cell: its value at the left end, the Bézier value between, its value at the right end.
#[derive(Clone, Copy, Debug)]
pub(crate) struct Cell {
    pub(crate) width: f64,
    pub(crate) left: Functional,
    pub(crate) control: Functional,
    pub(crate) right: Functional,
}

impl Cell {
    /// b at the share x of the cell.
    pub(crate) fn value(&self, x: f64) -> Functional {
        let rest = 1.0 - x;
        self.left.times_plus(rest * rest, &self.control.times_plus(2.0 * x * rest, &self.right.times(x * x)))
    }

    /// The acceleration b'/2 there.
    pub(crate) fn acceleration(&self, x: f64) -> Functional {
        let [left, right] = [(x - 1.0) / self.width, x / self.width];
        self.left.times_plus(left, &self.control.times_plus(-left - right, &self.right.times(right)))
    }

    /// b''/2, the jerk over √b.
    pub(crate) fn half_bend(&self) -> Functional {
        let per = 1.0 / (self.width * self.width);
        self.left.times_plus(per, &self.control.times_plus(-2.0 * per, &self.right.times(per)))
    }
}

/// Number of unknowns over this many nodes.
pub(crate) fn unknowns(nodes: usize) -> usize {
    nodes.saturating_sub(3)
}

/// The cells between the two that touch a rest, `nodes.len() - 3` of them, in order; at least three.
pub(crate) fn cells(nodes: &[f64]) -> impl Iterator<Item = Cell> + '_ {
    let widths = move |i: usize| nodes.get(i..i + 2).map_or(0.0, |pair| pair[1] - pair[0]);
    let last = unknowns(nodes.len()).saturating_sub(1);
    let tie = move |rest: usize, beside: usize| 1.0 + 2.0 * widths(beside) / (3.0 * widths(rest));
    let (start_tie, end_tie) = (tie(0, 1), tie(last + 2, last + 1));
    (0..=last).map(move |i| {
        let width = widths(i + 1);
        let before = if i == 0 { 0.0 } else { widths(i) };
        let after = if i == last { 0.0 } else { widths(i + 2) };
        let (from_left, from_right) = (width / (before + width), after / (width + after));
        let on_unknowns = |[w0, w1, w2]: [f64; 3]| {
            if i == 0 {
                Functional { first: 0, weights: [w0 + start_tie * w1, w2, 0.0] }
            } else if i == last {
                Functional { first: last.saturating_sub(2), weights: [0.0, w0, end_tie * w1 + w2] }
            } else {
                let from_start = if i == 1 { start_tie } else { 1.0 };
                let to_end = if i + 1 == last { end_tie } else { 1.0 };
                Functional { first: i - 1, weights: [from_start * w0, w1, to_end * w2] }
            }
        };
        Cell {
            width,
            left: on_unknowns([from_left, 1.0 - from_left, 0.0]),
            control: on_unknowns([0.0, 1.0, 0.0]),
            right: on_unknowns([0.0, from_right, 1.0 - from_right]),
        }
    })
}

/// A spline with its unknowns.
pub(crate) struct Spline<'a> {
    nodes: &'a [f64],
    cells: Vec<Cell>,
    x: &'a [f64],
}

impl<'a> Spline<'a> {
    pub(crate) fn new(nodes: &'a [f64], x: &'a [f64]) -> Self {
        Self { nodes, cells: cells(nodes).collect(), x }
    }

    /// b at a distance, and b''.
    pub(crate) fn at(&self, distance: f64) -> (f64, f64) {
        let node = |i: usize| self.nodes.get(i).copied().unwrap_or_default();
        let index = self.nodes.partition_point(|node| *node <= distance).saturating_sub(1);
        let last = self.nodes.len().saturating_sub(2);
        let rest = |from: f64, width: f64, cell: Option<&Cell>, end: fn(&Cell) -> Functional| {
            let b = cell.map_or(0.0, |cell| end(cell).of(self.x));
            let root = cube_root(from.max(width * 1e-9) / width);
            let square = root * root;
            (b * square * square, b * (4.0 / 9.0) / (square * width * width))
        };
        if index == 0 {
            rest(distance - node(0), node(1) - node(0), self.cells.first(), |cell| cell.left)
        } else if index >= last {
            rest(node(last + 1) - distance, node(last + 1) - node(last), self.cells.last(), |cell| cell.right)
        } else {
            let share = (distance - node(index)) / (node(index + 1) - node(index));
            let cell = self.cells.get(index - 1);
            cell.map_or((0.0, 0.0), |cell| (cell.value(share).of(self.x), 2.0 * cell.half_bend().of(self.x)))
        }
    }
}

/// The unknowns of the spline on these nodes that is near a function with this value and second derivative: a coefficient is the
/// function where the coefficient has most of its weight, less `h²/8` of the second derivative.
pub(crate) fn near(nodes: &[f64], at: impl Fn(f64) -> (f64, f64)) -> Vec<f64> {
    let last = unknowns(nodes.len()).saturating_sub(1);
    let coefficient = |i: usize| match i {
        0 => nodes.get(1).map(|node| at(*node).0),
        _ if i == last => nodes.get(last + 2).map(|node| at(*node).0),
        _ => nodes.get(i + 1..i + 3).map(|pair| {
            let (value, bend) = at(0.5 * (pair[0] + pair[1]));
            let width = pair[1] - pair[0];
            (value - 0.125 * width * width * bend).max(0.5 * value)
        }),
    };
    (0..=last).filter_map(coefficient).collect()
}

#[cfg(test)]
mod tests {
    use super::*;

    fn nodes() -> Vec<f64> {
        vec![0.0, 0.3, 0.8, 1.0, 1.9, 2.1, 3.0, 3.2, 3.7]
    }

    #[test]
    fn cells_meet_with_equal_feed_and_acceleration() {
        let x = [0.4, 0.9, 1.3, 0.7, 2.0, 0.5];
        let cells: Vec<_> = cells(&nodes()).collect();
        assert_eq!(cells.len(), x.len());
        for pair in cells.windows(2) {
            assert!((pair[0].value(1.0).of(&x) - pair[1].value(0.0).of(&x)).abs() < 1e-14);
            assert!((pair[0].acceleration(1.0).of(&x) - pair[1].acceleration(0.0).of(&x)).abs() < 1e-13);
        }
        for cell in &cells {
            // Of a quadratic, differences are exact.
            let (low, high) = (cell.value(0.25).of(&x), cell.value(0.75).of(&x));
            assert!((cell.acceleration(0.5).of(&x) - (high - low) / cell.width).abs() < 1e-13);
            let (low, high) = (cell.acceleration(0.0).of(&x), cell.acceleration(1.0).of(&x));
            assert!((cell.half_bend().of(&x) - (high - low) / cell.width).abs() < 1e-12);
        }
    }

    #[test]
    fn the_rests_law_goes_on_with_equal_acceleration() {
        let x = [0.4, 0.9, 1.3, 0.7, 2.0, 0.5];
        let cells: Vec<_> = cells(&nodes()).collect();
        assert!((cells[0].value(0.0).of(&x) - 0.4).abs() < 1e-15);
        assert!((cells[0].acceleration(0.0).of(&x) - 2.0 / 3.0 * 0.4 / 0.3).abs() < 1e-13);
        assert!((cells[5].value(1.0).of(&x) - 0.5).abs() < 1e-15);
        assert!((cells[5].acceleration(1.0).of(&x) + 2.0 / 3.0 * 0.5 / 0.5).abs() < 1e-13);
    }
}
