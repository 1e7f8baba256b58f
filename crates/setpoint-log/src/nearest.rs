//! The distance of a point from a path, wherever on it: segments in the cells of a grid, looked through from the point outward.

use crate::part_path::{FLAT_MM, PartPath, foot};

/// Cells of the grid along an axis, at most.
const MOST_CELLS: f64 = 64.0;

/// A grid of cells over the path.
pub(crate) struct Nearest<'p> {
    path: &'p PartPath,
    least: [f64; 3],
    cell_mm: f64,
    counts: [usize; 3],
    /// The segments of the cells one after another, and where those of each cell begin.
    segments: Vec<u32>,
    begins: Vec<usize>,
}

impl<'p> Nearest<'p> {
    pub(crate) fn new(path: &'p PartPath) -> Self {
        let all = |axis: usize| path.vertices.iter().map(move |vertex| vertex[axis]);
        let least: [f64; 3] = std::array::from_fn(|axis| all(axis).fold(f64::INFINITY, f64::min));
        let most: [f64; 3] = std::array::from_fn(|axis| all(axis).fold(f64::NEG_INFINITY, f64::max));
        let widest = (0..3).map(|axis| most[axis] - least[axis]).fold(0.0, f64::max);
        let cell_mm = (widest / MOST_CELLS).max(1e-6);
        let counts = std::array::from_fn(|axis| whole((most[axis] - least[axis]) / cell_mm) + 1);
        let mut grid = Self { path, least, cell_mm, counts, segments: Vec::new(), begins: Vec::new() };
        grid.fill();
        grid
    }

    /// Puts each segment into the cells that it may pass.
    fn fill(&mut self) {
        let mut of_cells: Vec<(u32, u32)> = Vec::new();
        for segment in 0..self.path.segments.len() {
            let [a, b] = self.path.ends(segment);
            // A walk in steps of half a cell meets each cell, or one beside it: the search looks one cell further.
            let parts =
                (0..3).map(|axis| whole(2.0 * (b[axis] - a[axis]).abs() / self.cell_mm)).max().unwrap_or(0)
                    + 1;
            let mut last = usize::MAX;
            for part in 0..=parts {
                let share = part as f64 / parts as f64;
                let at = std::array::from_fn(|axis| a[axis] + share * (b[axis] - a[axis]));
                let cell = self.index(self.cell_of(&at));
                if cell != last {
                    of_cells.push((as_u32(cell), as_u32(segment)));
                    last = cell;
                }
            }
        }
        of_cells.sort_unstable();
        of_cells.dedup();
        let cells = self.counts.iter().product();
        self.begins = vec![0; cells + 1];
        for (cell, _) in &of_cells {
            self.begins[*cell as usize + 1] += 1;
        }
        (0..cells).for_each(|cell| self.begins[cell + 1] += self.begins[cell]);
        self.segments = of_cells.into_iter().map(|(_, segment)| segment).collect();
    }

    fn cell_of(&self, point: &[f64; 3]) -> [usize; 3] {
        std::array::from_fn(|axis| {
            whole((point[axis] - self.least[axis]) / self.cell_mm).min(self.counts[axis] - 1)
        })
    }

    fn index(&self, [x, y, z]: [usize; 3]) -> usize {
        (z * self.counts[1] + y) * self.counts[0] + x
    }

    /// The least distance of a point from the path, in mm, where some place of it is no farther than `within_mm`.
    ///
    /// The nearest segment may be that of another curve than the nearest, so each that could be is looked at.
    pub(crate) fn distance(&self, point: &[f64; 3], within_mm: f64) -> f64 {
        let mut near: Vec<(f64, usize, f64)> = Vec::new();
        let mut least = within_mm;
        let centre = self.cell_of(point);
        let furthest = self.counts.into_iter().max().unwrap_or(0);
        for ring in 0..=furthest {
            // What a walk has put into a cell may reach into the next.
            let away_mm = (ring as f64 - 2.0).max(0.0) * self.cell_mm;
            if away_mm > least + FLAT_MM {
                break;
            }
            self.look_at_ring(centre, ring, &mut |segment| {
                let (share, off_2) = foot(point, &self.path.ends(segment), 0.0);
                let off_mm = off_2.sqrt();
                if off_mm <= least + FLAT_MM {
                    least = least.min(off_mm);
                    near.push((off_mm, segment, share));
                }
            });
        }
        near.retain(|(off_mm, ..)| *off_mm <= least + FLAT_MM);
        near.sort_unstable_by_key(|(_, segment, _)| *segment);
        near.dedup();
        let exact = near
            .iter()
            .map(|(off_mm, segment, share)| self.path.exact_distance(point, (*segment, *share), *off_mm));
        exact.reduce(f64::min).unwrap_or(within_mm)
    }

    /// Looks at the segments of all cells that are so many cells away.
    fn look_at_ring(&self, centre: [usize; 3], ring: usize, look: &mut impl FnMut(usize)) {
        let range = |axis: usize| {
            centre[axis].saturating_sub(ring)..=(centre[axis] + ring).min(self.counts[axis] - 1)
        };
        for z in range(2) {
            for y in range(1) {
                let is_side = z.abs_diff(centre[2]) == ring || y.abs_diff(centre[1]) == ring;
                for x in range(0) {
                    if !is_side && x.abs_diff(centre[0]) != ring {
                        continue;
                    }
                    let cell = self.index([x, y, z]);
                    let segments = &self.segments[self.begins[cell]..self.begins[cell + 1]];
                    segments.iter().for_each(|segment| look(*segment as usize));
                }
            }
        }
    }
}

/// The whole part of a number, 0 for one below.
#[allow(clippy::cast_possible_truncation, clippy::cast_sign_loss, reason = "it is clamped before")]
fn whole(x: f64) -> usize {
    x.clamp(0.0, 1e9) as usize
}

#[allow(clippy::cast_possible_truncation, reason = "a part has fewer segments than 2³²")]
fn as_u32(index: usize) -> u32 {
    index as u32
}
