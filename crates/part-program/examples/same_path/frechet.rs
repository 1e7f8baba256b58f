//! Whether two polylines are one path: their Fréchet distance is at most a tolerance.
//!
//! Two points walk along the two polylines, from start to end and never back. The Fréchet distance is the least length
//! of a leash between them that allows such a walk. The places of vertices do not matter, so a curve may be cut into
//! other pieces. But a loop that one polyline leaves out matters, and so does a stretch that is walked the other way.
//!
//! For segment i of the one and j of the other, the pairs of points within the tolerance are a convex set in the unit
//! square. The intervals on the sides of these squares tell which squares can be reached (H. Alt, M. Godau, Computing
//! the Fréchet distance between two polygonal curves, 1995, section 3). Only squares that are reached are looked at:
//! for paths near each other their number is proportional to the number of vertices.

use crate::point::{Point, distance};

/// How far two walkers get.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub(crate) enum Walk {
    /// To both ends.
    Ends,
    /// To this segment of the one and of the other, and then no further.
    Stops(usize, usize),
}

/// Walks along both polylines with a leash of `tolerance`. Each has at least two points.
pub(crate) fn walk(one: &[Point], other: &[Point], tolerance: f64) -> Walk {
    let near = |i: usize, j: usize| distance(one[i], other[j]) <= tolerance;
    let (last_i, last_j) = (one.len() - 2, other.len() - 2);
    if !near(0, 0) {
        return Walk::Stops(0, 0);
    }
    // Where squares of this row are entered from below: column and first parameter along the other polyline.
    let mut entries = first_row(one[0], other, tolerance);
    let mut furthest = (0, 0);
    for i in 0..=last_i {
        let mut above = Vec::new();
        // Where the square at hand is entered from the left. The first of a row is if the other walker may wait at its start.
        let waits = i == 0 || entries.first() == Some(&(0, 0.0));
        let wait = free(other[0], [one[i], one[i + 1]], tolerance).filter(|[from, _]| waits && *from == 0.0);
        let mut left = wait.map(|[from, _]| from);
        let mut below = entries.iter().copied().peekable();
        let mut j = 0;
        while j <= last_j {
            if left.is_none() {
                let Some((next, _)) = below.peek() else { break };
                j = *next;
            }
            let entry = below.next_if(|(column, _)| *column == j).map(|(_, from)| from);
            if i + j >= furthest.0 + furthest.1 {
                furthest = (i, j);
            }
            let top = free(one[i + 1], [other[j], other[j + 1]], tolerance);
            let right = free(other[j + 1], [one[i], one[i + 1]], tolerance);
            if let Some(from) = behind(top, left.is_some(), entry) {
                above.push((j, from));
            }
            if i == last_i && j == last_j {
                let to_corner = near(last_i + 1, last_j + 1) && (left.is_some() || entry.is_some());
                return if to_corner { Walk::Ends } else { Walk::Stops(furthest.0, furthest.1) };
            }
            left = behind(right, entry.is_some(), left);
            j += 1;
        }
        entries = above;
        if entries.is_empty() {
            break;
        }
    }
    Walk::Stops(furthest.0, furthest.1)
}

/// The squares of the first row that are entered from below: the other polyline as far as it stays near the first point.
fn first_row(point: Point, other: &[Point], tolerance: f64) -> Vec<(usize, f64)> {
    let mut entries = Vec::new();
    for (j, segment) in other.windows(2).enumerate() {
        match free(point, [segment[0], segment[1]], tolerance) {
            Some([0.0, to]) => {
                entries.push((j, 0.0));
                if to < 1.0 {
                    break;
                }
            }
            _ => break,
        }
    }
    entries
}

/// The first parameter at which a side may be left: all of what is free, when the square is entered on the side that it meets at its
/// beginning, and else what is not before the entry on the side across.
fn behind(free: Option<[f64; 2]>, is_open: bool, across: Option<f64>) -> Option<f64> {
    let [from, to] = free?;
    if is_open {
        return Some(from);
    }
    let first = from.max(across?);
    (first <= to).then_some(first)
}

/// The parameters of a segment whose points are within the tolerance of a point.
fn free(point: Point, [from, to]: [Point; 2], tolerance: f64) -> Option<[f64; 2]> {
    let along: Point = std::array::from_fn(|axis| to[axis] - from[axis]);
    let away: Point = std::array::from_fn(|axis| from[axis] - point[axis]);
    let dot = |a: Point, b: Point| a[0] * b[0] + a[1] * b[1] + a[2] * b[2];
    let (square, half, rest) = (dot(along, along), dot(along, away), dot(away, away) - tolerance * tolerance);
    if square == 0.0 {
        return (rest <= 0.0).then_some([0.0, 1.0]);
    }
    // From the nearest point, so that long segments keep their digits.
    let nearest = -half / square;
    let offset: Point = std::array::from_fn(|axis| away[axis] + nearest * along[axis]);
    let reach = (tolerance * tolerance - dot(offset, offset)) / square;
    if reach < 0.0 {
        return None;
    }
    let (first, last) = ((nearest - reach.sqrt()).max(0.0), (nearest + reach.sqrt()).min(1.0));
    (first <= last).then_some([first, last])
}

#[cfg(test)]
mod tests {
    use super::*;

    fn line(points: &[(f64, f64)]) -> Vec<Point> {
        points.iter().map(|(x, y)| [*x, *y, 0.0]).collect()
    }

    #[test]
    fn other_vertices_are_the_same_path() {
        let one = line(&[(0.0, 0.0), (10.0, 0.0), (10.0, 5.0)]);
        let other = line(&[(0.0, 0.0), (3.0, 0.0), (3.001, 0.0), (10.0, 0.0), (10.0, 1.0), (10.0, 5.0)]);
        assert_eq!(walk(&one, &other, 1e-6), Walk::Ends);
        assert_eq!(walk(&other, &one, 1e-6), Walk::Ends);
        assert_eq!(walk(&one, &one, 1e-9), Walk::Ends);
    }

    #[test]
    fn what_differs_is_found_where_it_is() {
        let one = line(&[(0.0, 0.0), (10.0, 0.0), (10.0, 5.0), (0.0, 5.0)]);
        let other = line(&[(0.0, 0.0), (10.0, 0.0), (10.0, 5.1), (0.0, 5.1)]);
        assert_eq!(walk(&one, &other, 0.2), Walk::Ends);
        assert_eq!(walk(&one, &other, 0.05), Walk::Stops(2, 1));
        assert_eq!(walk(&one, &line(&[(1.0, 0.0), (10.0, 0.0)]), 0.5), Walk::Stops(0, 0));
    }

    /// Every point of the one is near the other, and the other way round; the way along them is another.
    #[test]
    fn loops_and_directions_matter() {
        let straight = line(&[(0.0, 0.0), (10.0, 0.0)]);
        let back = line(&[(0.0, 0.0), (7.0, 0.0), (3.0, 0.0), (10.0, 0.0)]);
        assert_eq!(walk(&straight, &back, 2.01), Walk::Ends);
        assert_ne!(walk(&straight, &back, 1.99), Walk::Ends);
        let square = line(&[(0.0, 0.0), (4.0, 0.0), (4.0, 4.0), (0.0, 4.0), (0.0, 0.0)]);
        let reversed: Vec<_> = square.iter().rev().copied().collect();
        assert_ne!(walk(&square, &reversed, 1.0), Walk::Ends);
        let twice = [square.clone(), square.clone()].concat();
        assert_ne!(walk(&square, &twice, 1.0), Walk::Ends);
        assert_eq!(walk(&twice, &twice, 1e-6), Walk::Ends);
    }

    /// Shorter than the tolerance, so that many squares are free.
    #[test]
    fn short_segments_are_walked() {
        let fine: Vec<Point> = (0..=2000_u32).map(|k| [f64::from(k) * 1e-4, 0.0, 0.0]).collect();
        let coarse = line(&[(0.0, 0.0), (0.2, 0.0)]);
        assert_eq!(walk(&fine, &coarse, 1e-3), Walk::Ends);
        assert_eq!(walk(&coarse, &fine, 1e-3), Walk::Ends);
        assert_eq!(walk(&fine, &fine, 1e-3), Walk::Ends);
    }
}
