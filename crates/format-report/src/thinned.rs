//! Lines in the plane with no more points than a picture shows.
//!
//! A program of hours has millions of setpoints, a picture only some hundred thousand pixels. A line on a grid of cells
//! keeps one point in each cell that it enters. If several lines go from one cell to the same next cell, only the first
//! is kept.

use std::collections::HashSet;

/// A cell of the grid.
type Cell = (i64, i64);

/// The lines of each group, thinned to at most so many points in total: unchanged if they have no more, or else on the
/// finest grid that is coarse enough. Its cells are at least a quarter of a pixel. Groups must be given in order of
/// importance: a line of a later group is left out where an earlier one has drawn it.
pub(crate) fn thinned(groups: &[Vec<&[(f64, f64)]>], pixel: f64, most: usize) -> Vec<Vec<Vec<(f64, f64)>>> {
    let count: usize = groups.iter().flatten().map(|line| line.len()).sum();
    if count <= most || pixel.is_nan() || pixel <= 0.0 {
        return groups.iter().map(|lines| lines.iter().map(|line| line.to_vec()).collect()).collect();
    }
    let mut size = pixel / 4.0;
    loop {
        let mut seen = HashSet::new();
        let mut left = most;
        let found: Option<Vec<_>> =
            groups.iter().map(|lines| on_grid(lines, size, &mut seen, &mut left)).collect();
        if let Some(found) = found {
            return found;
        }
        size *= 2.0;
    }
}

/// The lines on a grid; `None` if they have more points than are left.
fn on_grid(
    lines: &[&[(f64, f64)]],
    size: f64,
    seen: &mut HashSet<(Cell, Cell)>,
    left: &mut usize,
) -> Option<Vec<Vec<(f64, f64)>>> {
    #[allow(clippy::cast_possible_truncation, reason = "cells beyond the range of 64 bits are one cell")]
    let cell = |point: &(f64, f64)| ((point.0 / size).round() as i64, (point.1 / size).round() as i64);
    let mut found = Vec::new();
    for line in lines {
        let Some(first) = line.first() else { continue };
        let (mut at, mut kept) = (cell(first), vec![*first]);
        for point in &line[1..] {
            let next = cell(point);
            if next == at {
                continue;
            }
            if seen.insert((at, next)) {
                *left = left.checked_sub(1)?;
                kept.push(*point);
            } else if kept.len() > 1 {
                found.push(std::mem::replace(&mut kept, vec![*point]));
            } else {
                kept = vec![*point];
            }
            at = next;
        }
        if kept.len() > 1 {
            found.push(kept);
        }
    }
    Some(found)
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn few_points_stay_as_they_are() {
        let line = [(0.0, 0.0), (1.0, 1.0), (1.0, 1.0)];
        assert_eq!(thinned(&[vec![&line]], 0.1, 3), [vec![line.to_vec()]]);
    }

    /// Ten laps of a circle are drawn once, with as many points as are allowed, and no point is off the circle.
    #[test]
    fn a_path_over_itself_is_drawn_once() {
        let points: Vec<_> =
            (0..200_000).map(|i| (f64::from(i) * std::f64::consts::TAU / 20_000.0).sin_cos()).collect();
        let (early, late) = points.split_at(100_000);
        let found = thinned(&[vec![early], vec![late]], 0.002, 5000);
        let count: usize = found.iter().flatten().map(Vec::len).sum();
        assert!((3000..6000).contains(&count), "{count}");
        assert!(found[1].iter().map(Vec::len).sum::<usize>() < 50, "{}", found[1].len());
        let around = |quarter: f64| {
            found[0].iter().flatten().any(|(x, y)| (x - quarter.sin()).hypot(y - quarter.cos()) < 0.01)
        };
        assert!((0..8).all(|i| around(f64::from(i) * 0.785)));
    }

    #[test]
    fn any_number_of_points_comes_below_the_limit() {
        let points: Vec<_> = (0..50_000).map(|i| (f64::from(i % 251), f64::from(i % 241))).collect();
        let found = thinned(&[vec![&points]], 0.01, 500);
        let count: usize = found.iter().flatten().map(Vec::len).sum();
        assert!(count > 0 && count <= 1000, "{count}");
    }
}
