//! The rows of the program: every limit of a way, on the cells of a grid.
//!
//! | limit | where in a cell | row, of b = v² |
//! |---|---|---|
//! | feed V | left end, quarters | `b ≤ V²` |
//! | acceleration A | left end | `\|b'/2\| ≤ A` |
//! | that of an axis | ends, middle | `\|e b'/2 + k b\| ≤ Aᵢ` |
//! | jerk J | ends | `\|b''/2\| ≤ J/√b` |
//! | that of an axis | ends | `\|e b''/2 + 3/2 k b' + c b\| ≤ Jᵢ/√b` |
//!
//! e, k and c are those of the cell's own span up to its ends. A row that cannot bind, whatever b up to V², a up to A and j up to J, is
//! left out. In the cells that touch a rest everything is a power of the distance times one of b where they end, so that all
//! limits together bound that.
//!
//! Lengths are in units of `length`, feeds in units of the largest: so the unknowns are near 1.

use alloc::vec::Vec;

use nurbs_core::Differentiate;
use real::Real;

use crate::axes::geometry::Bend;
use crate::axes::grid::Grid;
use crate::axes::program::{Program, Row, Term};
use crate::axes::spline::{Cell, Functional, cells};
use crate::axes::way::{Strain, Way};
use crate::cube_root::cube_root;
use crate::limits::AXES;

/// Shares of the limits that hold on each cell: 1, or less where a solution broke one between the places of its rows.
pub(crate) type Shares = [Strain];

/// How the way turns in a cell, and the limit of the feed.
pub(crate) struct WayCell {
    pub(crate) bends: [Bend; 3],
    pub(crate) feeds: [f64; 5],
}

/// The rows under construction.
struct Rows<'a, 'w, C> {
    way: &'a Way<'w, C>,
    rows: Vec<Row>,
    /// The unit of feed.
    feed: f64,
}

/// Shares of 1, or what the path has of its acceleration and jerk.
pub(crate) fn all_of<C>(way: &Way<'_, C>, grid: &Grid) -> Vec<Strain> {
    let share = |cell: &[f64]| {
        let of_path = way.of_path(cell[0], cell[1]);
        let (acceleration, jerk) = (of_path.acceleration, of_path.jerk);
        Strain {
            feed: 1.0,
            acceleration: acceleration / way.limits.acceleration,
            jerk: jerk / way.limits.jerk,
        }
    };
    grid.nodes.windows(2).map(share).collect()
}

/// The places of all cells.
pub(crate) fn places<const D: usize, C: Differentiate<f64, D>>(
    way: &Way<'_, C>,
    grid: &Grid,
) -> Vec<WayCell> {
    let mut places: Vec<WayCell> = Vec::with_capacity(grid.pieces.len());
    let mut before = usize::MAX;
    for (pair, piece) in grid.nodes.windows(2).zip(&grid.pieces) {
        let width = pair[1] - pair[0];
        let bend = |share: f64| {
            let piece = way.pieces.get(*piece);
            piece.map_or_else(Bend::default, |piece| way.bend_of(piece, pair[0] + share * width))
        };
        let left = places.last().filter(|_| before == *piece).map_or_else(|| bend(0.0), |last| last.bends[2]);
        let feeds = [0.0, 0.25, 0.5, 0.75, 1.0].map(|share| {
            let distance = if share < 1.0 { pair[0] + share * width } else { pair[1] };
            way.feed(distance)
        });
        places.push(WayCell { bends: [left, bend(0.5), bend(1.0)], feeds });
        before = *piece;
    }
    places
}

/// The program of a way on a grid, in units of this feed and of mm.
pub(crate) fn program<C>(
    way: &Way<'_, C>,
    grid: &Grid,
    places: &[WayCell],
    shares: &Shares,
    feed: f64,
) -> Option<Program> {
    let cells: Vec<Cell> = cells(&grid.nodes).collect();
    let mut rows = Rows { way, rows: Vec::new(), feed };
    let last = cells.len() + 1;
    for (i, cell) in cells.iter().enumerate() {
        let goes_on = grid.pieces.get(i + 1) == grid.pieces.get(i + 2) && i + 1 < cells.len();
        rows.cell(cell, places.get(i + 1)?, shares.get(i + 1)?, goes_on);
    }
    let (first_cell, last_cell) = (cells.first()?, cells.last()?);
    let widths = [grid.nodes[1] - grid.nodes[0], grid.nodes[last + 1] - grid.nodes[last]];
    for (b, width, place, share, towards) in [
        (first_cell.left, widths[0], places.first()?, shares.first()?, 1.0),
        (last_cell.right, widths[1], places.get(last)?, shares.get(last)?, -1.0),
    ] {
        let bound = rows.rest(width, place, share, towards) / (feed * feed);
        rows.rows.push(Row { w: b.times(1.0 / bound), p: None });
    }
    let mut terms = Vec::with_capacity(2 * cells.len() + 3);
    let mut before = 0.0;
    for cell in &cells {
        terms.push(Term { b: cell.left, weight: (before + cell.width) / 6.0 });
        terms.push(Term { b: cell.value(0.5), weight: cell.width * (2.0 / 3.0) });
        before = cell.width;
    }
    terms.push(Term { b: last_cell.right, weight: before / 6.0 });
    terms.push(Term { b: first_cell.left, weight: 3.0 * widths[0] });
    terms.push(Term { b: last_cell.right, weight: 3.0 * widths[1] });
    Some(Program { terms, rows: rows.rows })
}

impl<C> Rows<'_, '_, C> {
    /// `|w| ≤ bound`.
    fn band(&mut self, w: &Functional, bound: f64, p: Option<[f64; 3]>) {
        for sign in [1.0, -1.0] {
            self.rows.push(Row { w: w.times(sign / bound), p });
        }
    }

    /// The rows of a cell; those of its right end only where the next cell has no such rows.
    fn cell(&mut self, cell: &Cell, place: &WayCell, share: &Strain, goes_on: bool) {
        let limits = self.way.limits;
        let unit = self.feed * self.feed;
        for (x, feed) in [0.0, 0.25, 0.5, 0.75].into_iter().zip(place.feeds) {
            let bound = feed * feed / unit * share.feed;
            self.rows.push(Row { w: cell.value(x).times(1.0 / bound), p: None });
        }
        let fastest = place.feeds.iter().fold(0.0_f64, |most, feed| most.max(*feed));
        for (x, bend) in [0.0, 0.5, 1.0].into_iter().zip(&place.bends) {
            let (b, a) = (cell.value(x), cell.acceleration(x));
            if x == 1.0 && goes_on {
                continue;
            }
            if x == 0.0 {
                self.band(&a, limits.acceleration / unit * share.acceleration, None);
            }
            for i in 0..AXES {
                let Some(most) = limits.axes[i].acceleration else { continue };
                let (e, k) = (bend.e[i], bend.k[i]);
                if e.abs() * limits.acceleration + k.abs() * fastest * fastest > most * share.acceleration {
                    let w = a.times_plus(e, &b.times(k));
                    self.band(&w, most / unit * share.acceleration, None);
                }
            }
        }
        let unit = unit * self.feed;
        let half_bend = cell.half_bend();
        for (x, bend) in [(0.0, &place.bends[0]), (1.0, &place.bends[2])] {
            let (b, a) = (cell.value(x), cell.acceleration(x));
            self.band(&half_bend, limits.jerk / unit * share.jerk, Some(b.weights));
            for i in 0..AXES {
                let Some(most) = limits.axes[i].jerk else { continue };
                let (e, k, c) = (bend.e[i], bend.k[i], bend.c[i]);
                let by_bend = 3.0 * k.abs() * limits.acceleration + c.abs() * fastest * fastest;
                if e.abs() * limits.jerk + by_bend * fastest > most * share.jerk {
                    let w = half_bend.times_plus(e, &a.times_plus(3.0 * k, &b.times(c)));
                    self.band(&w, most / unit * share.jerk, Some(b.weights));
                }
            }
        }
    }

    /// The largest b at the end of a cell that touches a rest; `towards` is the direction away from the rest.
    fn rest(&self, width: f64, place: &WayCell, share: &Strain, towards: f64) -> f64 {
        let limits = self.way.limits;
        // (3/4)^(4/3), (1/2)^(4/3), (1/4)^(4/3), (1/2)^(1/3)
        const POWERS: [f64; 3] = [0.681_420_222_312_052_6, 0.396_850_262_992_049_9, 0.157_490_131_236_859_15];
        const ROOT: f64 = 0.793_700_525_984_099_7;
        let [near, _, far] = if towards > 0.0 { [0, 1, 2] } else { [2, 1, 0] };
        let feeds = &place.feeds;
        let [quarter, three] = if towards > 0.0 { [1, 3] } else { [3, 1] };
        let end = if towards > 0.0 { 4 } else { 0 };
        let square = |feed: f64| feed * feed * share.feed;
        let mut most = square(feeds[end]);
        most = most.min(square(feeds[three]) / POWERS[0]).min(square(feeds[2]) / POWERS[1]);
        most = most.min(square(feeds[quarter]) / POWERS[2]);
        let two_ninths = 2.0 / 9.0 / (width * width);
        let by_jerk = |b: f64, jerk: f64, of: f64| {
            let feed = cube_root(jerk * share.jerk / of);
            if of * b * Real::sqrt(b) > jerk * share.jerk { feed * feed } else { b }
        };
        most = by_jerk(most, limits.jerk, two_ninths);
        most = most.min(limits.acceleration * share.acceleration * width * 1.5);
        for i in 0..AXES {
            let axis = &limits.axes[i];
            for (bend, q, root, power) in
                [(near, 0.0, 0.0, 0.0), (1, 0.5, ROOT, POWERS[1]), (far, 1.0, 1.0, 1.0)]
            {
                let Bend { e, k, c } = place.bends[bend];
                if let Some(jerk) = axis.jerk {
                    let of = e[i] * two_ninths + towards * 2.0 * k[i] / width * q + c[i] * q * q;
                    most = by_jerk(most, jerk, of.abs());
                }
                if let Some(acceleration) = axis.acceleration {
                    let of = (towards * e[i] * (2.0 / 3.0) / width * root + k[i] * power).abs();
                    let acceleration = acceleration * share.acceleration;
                    most = if of * most > acceleration { acceleration / of } else { most };
                }
            }
        }
        most
    }
}
