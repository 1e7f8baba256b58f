//! Contacts: caps made exactly tangent to what they lead from and to.
//!
//! Between nodes a cap that touches the profile at two of them is off its acceleration by what the jerk J changes it by from node to
//! node. So from a node of the profile its own motion goes on for t₁, which may be negative, then the jerk is -J for h, and t₂ from
//! another node the motion of the profile meets that in distance, feed and acceleration. Newton's method finds the three times:
//! after a time t at constant jerk, a change (ds, dv, da) before has become `(ds + dv t + da t²/2, dv + da t, da)`.

use alloc::vec::Vec;

use real::Real;

use crate::plan::fastest::grid::Node;
use crate::plan::fastest::motion::State;
use crate::plan::fastest::valleys::Carrier;

const STEPS: usize = 12;
/// A contact lies within two nodes of where the caps between nodes have it.
const MOVES: usize = 6;

/// A cap: the state where it begins, and its time.
#[derive(Clone, Copy, Debug)]
pub(crate) struct Cap<R> {
    pub(crate) from: State<R>,
    pub(crate) time: R,
}

/// The profile by its nodes.
pub(crate) struct Profile<'a, R> {
    pub(crate) nodes: &'a [Node<R>],
    pub(crate) carriers: Vec<Carrier<R>>,
    pub(crate) jerk: R,
}

impl<R: Real> Profile<'_, R> {
    pub(crate) fn state(&self, node: usize) -> State<R> {
        State { s: self.nodes[node].s, v: self.carriers[node].v, a: self.carriers[node].a }
    }

    /// The state of the motion through a node, which is at the distance `s`, at a time from it, and its jerk there.
    fn near(&self, node: usize, s: R, time: R) -> (State<R>, R) {
        let carrier = &self.carriers[node];
        let jerk = if time < R::zero() { carrier.jerk_before } else { carrier.jerk_behind };
        (State { s, v: carrier.v, a: carrier.a }.after(time, jerk), jerk)
    }

    /// The cap near the arc from one node to another that takes this time; `None` if none is found.
    pub(crate) fn cap(&self, [mut from, mut to]: [usize; 2], time: R) -> Option<Cap<R>> {
        let last = self.nodes.len() - 1;
        let mut guess = [R::zero(), time, R::zero()];
        for _ in 0..MOVES {
            let [t1, h, t2] = self.tangent([from, to], guess)?;
            let (begin, _) = self.near(from, self.nodes[from].s, t1);
            let (end, _) = self.near(to, self.nodes[to].s, t2);
            // A motion through a node says little beyond the next one.
            let nearer = |node: usize, s: R| {
                if node > 0 && s < self.nodes[node - 1].s {
                    node - 1
                } else if node < last && s > self.nodes[node + 1].s {
                    node + 1
                } else {
                    node
                }
            };
            let (next_from, next_to) = (nearer(from, begin.s), nearer(to, end.s));
            if (next_from, next_to) == (from, to) || next_from >= next_to {
                // At -J the feed is least at the ends.
                let moves = begin.v > R::zero() && end.v > R::zero();
                return moves.then_some(Cap { from: begin, time: h });
            }
            guess = [
                if next_from == from { t1 } else { R::zero() },
                h,
                if next_to == to { t2 } else { R::zero() },
            ];
            (from, to) = (next_from, next_to);
        }
        None
    }

    fn tangent(&self, [from, to]: [usize; 2], [mut t1, mut h, mut t2]: [R; 3]) -> Option<[R; 3]> {
        let down = R::zero() - self.jerk;
        let mut is_found = false;
        let between = self.nodes[to].s - self.nodes[from].s;
        for _ in 0..STEPS {
            // From the first node on: a distance from the path's begin would be too coarse.
            let (begin, j1) = self.near(from, R::zero(), t1);
            let end = begin.after(h, down);
            let (goal, j2) = self.near(to, between, t2);
            let by_t1 = [begin.v + h * (begin.a + (j1 * h).half()), begin.a + j1 * h, j1];
            let by_h = [end.v, end.a, down];
            let by_t2 = [R::zero() - goal.v, R::zero() - goal.a, R::zero() - j2];
            let off = [goal.s - end.s, goal.v - end.v, goal.a - end.a];
            let [d1, dh, d2] = solve([by_t1, by_h, by_t2], off)?;
            (t1, h, t2) = (t1 + d1, h + dh, t2 + d2);
            if !(h > R::zero()) || !h.is_finite() {
                return None;
            }
            let moved = d1.abs().max(dh.abs()).max(d2.abs());
            if moved <= h * R::resolution().ldexp(10) {
                is_found = true;
                break;
            }
        }
        is_found.then_some([t1, h, t2])
    }
}

/// The numbers by which the columns sum up to `sum`, by elimination.
fn solve<R: Real>(columns: [[R; 3]; 3], sum: [R; 3]) -> Option<[R; 3]> {
    let mut rows: [[R; 4]; 3] =
        core::array::from_fn(|r| [columns[0][r], columns[1][r], columns[2][r], sum[r]]);
    for pivot in 0..3 {
        let size = |row: usize| {
            let most = rows[row].iter().take(3).fold(R::zero(), |most, x| most.max(x.abs()));
            if most > R::zero() { rows[row][pivot].abs() / most } else { R::zero() }
        };
        let best = (pivot..3).fold(pivot, |best, row| if size(row) > size(best) { row } else { best });
        rows.swap(pivot, best);
        let lead = rows[pivot][pivot];
        if lead.is_zero() {
            return None;
        }
        let row = rows[pivot];
        for other in rows.iter_mut().skip(pivot + 1) {
            let factor = other[pivot] / lead;
            other.iter_mut().zip(row).for_each(|(x, y)| *x = *x - factor * y);
        }
    }
    let z = rows[2][3] / rows[2][2];
    let y = (rows[1][3] - rows[1][2] * z) / rows[1][1];
    let x = (rows[0][3] - rows[0][1] * y - rows[0][2] * z) / rows[0][0];
    Some([x, y, z])
}
