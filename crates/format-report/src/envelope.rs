//! A long series on few pixels: the least and the greatest value of each column.

/// The points to draw of a series that is sorted by x, over the range `[from, to]` that `columns` pixels show.
///
/// A series of up to two points a column is drawn unchanged. In a longer one, each column keeps its least and its
/// greatest value, in their order. So no extreme is lost, and the line fills the same pixels as the whole series.
pub(crate) fn envelope(points: &[(f64, f64)], (from, to): (f64, f64), columns: usize) -> Vec<(f64, f64)> {
    if points.len() <= 2 * columns || columns == 0 || to <= from {
        return points.to_vec();
    }
    let width = (to - from) / columns as f64;
    let column = |x: f64| ((x - from) / width).floor();
    let mut kept = Vec::with_capacity(2 * columns + 2);
    for part in points.chunk_by(|a, b| column(a.0) == column(b.0)) {
        let by_value = |a: &&(f64, f64), b: &&(f64, f64)| a.1.total_cmp(&b.1);
        let (Some(least), Some(greatest)) = (part.iter().min_by(by_value), part.iter().max_by(by_value))
        else {
            continue;
        };
        let (first, second) = if least.0 <= greatest.0 { (least, greatest) } else { (greatest, least) };
        kept.push(*first);
        if first != second {
            kept.push(*second);
        }
    }
    kept
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn extremes_stay_and_the_number_of_points_is_bounded() {
        let mut points: Vec<(f64, f64)> =
            (0..100_000).map(|i| (f64::from(i), (f64::from(i) * 0.37).sin())).collect();
        points[54_321].1 = 9.0;
        points[54_322].1 = -9.0;
        let kept = envelope(&points, (0.0, 100_000.0), 640);
        assert!(kept.len() <= 2 * 641, "{}", kept.len());
        assert!(kept.is_sorted_by(|a, b| a.0 <= b.0));
        assert!(kept.contains(&points[54_321]) && kept.contains(&points[54_322]));
        assert!(kept.iter().all(|point| points.contains(point) || !point.0.is_finite()));
    }

    #[test]
    fn a_short_series_is_drawn_as_it_is() {
        let points = [(0.0, 1.0), (1.0, 2.0)];
        assert_eq!(envelope(&points, (0.0, 1.0), 640), points);
    }
}
