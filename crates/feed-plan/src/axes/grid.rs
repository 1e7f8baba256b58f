//! The nodes of the spline: even in planned time where something changes, closer where the feed or its limit changes fast, far apart
//! where nothing does, and one at each knot and joint.

use alloc::vec::Vec;

use nurbs_core::Differentiate;

use crate::axes::profile::{Profile, rest_width};
use crate::axes::way::Way;

/// Cells for each change of the feed, or of its limit, by a factor e.
const CELLS_PER_E: f64 = 12.0;
/// No more nodes than these: a longer way keeps the plan that it has.
const MOST_NODES: usize = 200_000;

/// Nodes from one rest to the next, and which piece of the way each cell is on.
#[derive(Clone, Debug)]
pub(crate) struct Grid {
    pub(crate) nodes: Vec<f64>,
    pub(crate) pieces: Vec<usize>,
}

impl Grid {
    /// Cells that take `cell_time` in the profile, or less; `None` if there are too few or too many.
    pub(crate) fn new<const D: usize, C: Differentiate<f64, D>>(
        way: &Way<'_, C>,
        profile: &Profile,
        cell_time: f64,
        coarser: f64,
    ) -> Option<Self> {
        let measure = profile.measure(cell_time, CELLS_PER_E / coarser);
        let wanted = |distance: f64| {
            let next = profile.points.partition_point(|point| point.distance < distance);
            let Some(before) = next.checked_sub(1) else { return 0.0 };
            match (profile.points.get(before..=next), measure.get(before..=next)) {
                (Some([from, to]), Some([low, high])) => {
                    low + (high - low) * (distance - from.distance) / (to.distance - from.distance)
                }
                _ => measure.last().copied().unwrap_or_default(),
            }
        };
        let place = |wanted: f64| {
            let next = measure.partition_point(|sum| *sum < wanted);
            let before = next.checked_sub(1)?;
            match (profile.points.get(before..=next), measure.get(before..=next)) {
                (Some([from, to]), Some([low, high])) if high > low => {
                    Some(from.distance + (to.distance - from.distance) * (wanted - low) / (high - low))
                }
                _ => None,
            }
        };
        let (first, last) = (way.pieces.first()?, way.pieces.last()?);
        let start =
            way.begin + rest_width(way, way.begin, cell_time).min(0.5 * (first.end.min(way.end) - way.begin));
        let end =
            way.end - rest_width(way, way.end, cell_time).min(0.5 * (way.end - last.begin.max(way.begin)));
        let (mut nodes, mut pieces) = (Vec::from([way.begin, start]), Vec::from([0]));
        for (index, piece) in way.pieces.iter().enumerate() {
            let (from, to) = (piece.begin.max(start), piece.end.min(end));
            if !(to > from) {
                continue;
            }
            let (low, high) = (wanted(from), wanted(to));
            let mut count = 1.0;
            while count < high - low {
                count += 1.0;
            }
            let mut number = 1.0;
            while number < count && nodes.len() < MOST_NODES {
                let node = place(low + (high - low) * number / count);
                if let Some(node) = node.filter(|node| *node > *nodes.last().unwrap_or(&to) && *node < to) {
                    nodes.push(node);
                    pieces.push(index);
                }
                number += 1.0;
            }
            nodes.push(to);
            pieces.push(index);
        }
        nodes.push(way.end);
        pieces.push(way.pieces.len() - 1);
        let increases = nodes.windows(2).all(|pair| pair[1] > pair[0]);
        (increases && nodes.len() > 6 && nodes.len() < MOST_NODES).then_some(Self { nodes, pieces })
    }
}
