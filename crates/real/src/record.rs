//! The recording wrapper: the same values, with the operations of a run written down as a data-flow graph.
//!
//! A graph is the trace of one run: its nodes hold the values, and its comparisons have the backend's outcome, which is
//! recorded with them. A cost model schedules a graph; a datapath can be generated from it.

use std::cell::RefCell;
use std::cmp::Ordering;
use std::collections::HashMap;

use crate::wrapper::{Wrapper, wrapper};
use crate::{Backend, Operation, OperationCounts, Real};

/// A node of a [`Graph`]: its place in [`Graph::nodes`].
#[derive(Clone, Copy, Debug, PartialEq, Eq, PartialOrd, Ord, Hash)]
pub struct NodeId(u32);

impl NodeId {
    /// The place in [`Graph::nodes`].
    #[must_use]
    pub const fn index(self) -> usize {
        self.0 as usize
    }
}

fn id(place: usize) -> NodeId {
    NodeId(u32::try_from(place).unwrap_or(u32::MAX)) // so many nodes would not fit the memory
}

/// The meaning of a node.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
#[non_exhaustive]
pub enum NodeKind {
    /// A number from outside, by the name it was given.
    Input(&'static str),
    /// A number from outside without a name: a constant, or data that the run was prepared with. Equal ones are one node.
    Constant,
    /// A number made of a 64-bit phase, an integer that comes from outside.
    FromPhase {
        /// The phase counts units of `2^(exponent - 64)`.
        exponent: i32,
    },
    /// An operation on the operands.
    Operation(Operation),
    /// A comparison of two operands, and how it turned out; `None` for a NaN.
    Compare(Option<Ordering>),
    /// A 64-bit phase made of the operand. The integer arithmetic on a phase is not recorded.
    ToPhase {
        /// The operand counts units of `2^exponent`.
        exponent: i32,
    },
}

/// A node: what it stands for and the value it had.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Node {
    /// What it stands for.
    pub kind: NodeKind,
    /// The exact value as a sum of two floats: -1, 0, 1 or NaN for a comparison, the fraction for a phase.
    pub value: (f64, f64),
    /// From where to where its operands are in the graph's list.
    operands: (usize, usize),
}

/// The operations of a run in the order they were done, each after its operands.
#[derive(Clone, Debug, Default, PartialEq)]
pub struct Graph {
    nodes: Vec<Node>,
    operands: Vec<NodeId>,
    signals: Vec<(&'static str, NodeId)>,
    outputs: Vec<(&'static str, NodeId)>,
}

impl Graph {
    /// Runs `work`. Returns its result, and the operations that the [`Recorded`] numbers of this thread did meanwhile.
    ///
    /// An inner recording is a graph of its own, and adds nothing to the outer one.
    pub fn of<T>(work: impl FnOnce() -> T) -> (T, Graph) {
        let recording = Recording { number: next_number(), ..Recording::default() };
        let outer = RECORDING.replace(Some(recording));
        let result = work();
        let recording = RECORDING.replace(outer);
        (result, recording.map(|recording| recording.graph).unwrap_or_default())
    }

    /// What was recorded since the innermost running [`Graph::of`] began, or since the last call of this function in it: so a
    /// run is taken step by step, and a long one needs no more memory than a step. Numbers of before are constants for what
    /// follows, or inputs. Empty outside of a recording.
    #[must_use]
    pub fn so_far() -> Graph {
        RECORDING.with_borrow_mut(|recording| {
            let next = Recording { number: next_number(), ..Recording::default() };
            recording.as_mut().map(|now| std::mem::replace(now, next).graph).unwrap_or_default()
        })
    }

    /// All nodes; the operands of each come before it.
    #[must_use]
    pub fn nodes(&self) -> &[Node] {
        &self.nodes
    }

    /// All nodes with their ids, in order.
    pub fn iter(&self) -> impl DoubleEndedIterator<Item = (NodeId, &Node)> {
        self.nodes.iter().enumerate().map(|(place, node)| (id(place), node))
    }

    /// The node of this id.
    ///
    /// # Panics
    /// If the id is that of another, longer graph.
    #[must_use]
    pub fn node(&self, id: NodeId) -> &Node {
        &self.nodes[id.index()]
    }

    /// The operands of a node, in the order of [`Operation`].
    ///
    /// # Panics
    /// If the id is that of another, longer graph.
    #[must_use]
    pub fn operands(&self, id: NodeId) -> &[NodeId] {
        let (from, to) = self.node(id).operands;
        &self.operands[from..to]
    }

    /// The numbers that kernels have named, in the order of naming; a name may occur more than once.
    #[must_use]
    pub fn signals(&self) -> &[(&'static str, NodeId)] {
        &self.signals
    }

    /// The results, by the names that [`Recorded::output`] was given.
    #[must_use]
    pub fn outputs(&self) -> &[(&'static str, NodeId)] {
        &self.outputs
    }

    /// How many operations of each kind the graph has. [`Counted`](crate::Counted) counts the same, and also
    /// conversions from floats, which are constants here.
    #[must_use]
    pub fn counts(&self) -> OperationCounts {
        let mut counts = OperationCounts::default();
        for node in &self.nodes {
            match node.kind {
                NodeKind::Operation(operation) => counts.count(operation, node.operands.1 - node.operands.0),
                NodeKind::Compare(_) => counts.compare += 1,
                NodeKind::FromPhase { .. } | NodeKind::ToPhase { .. } => counts.convert += 1,
                NodeKind::Input(_) | NodeKind::Constant => {}
            }
        }
        counts
    }
}

/// A graph as it grows.
#[derive(Default)]
struct Recording {
    /// Marks the numbers of this recording; 0 stands for no recording.
    number: u32,
    graph: Graph,
    constants: HashMap<(u64, u64), NodeId>,
}

thread_local! {
    static RECORDING: RefCell<Option<Recording>> = const { RefCell::new(None) };
    static LAST_NUMBER: RefCell<u32> = const { RefCell::new(0) };
}

fn next_number() -> u32 {
    LAST_NUMBER.with_borrow_mut(|last| {
        *last = last.wrapping_add(1).max(1);
        *last
    })
}

impl Recording {
    fn push(&mut self, kind: NodeKind, operands: &[NodeId], value: (f64, f64)) -> NodeId {
        let id = id(self.graph.nodes.len());
        let first = self.graph.operands.len();
        self.graph.operands.extend_from_slice(operands);
        self.graph.nodes.push(Node { kind, value, operands: (first, self.graph.operands.len()) });
        id
    }

    /// The node of a number: its own, or that of a constant if it comes from outside of this recording.
    fn node_of<R: Backend>(&mut self, number: Recorded<R>) -> NodeId {
        match number.node {
            Some((recording, id)) if recording == self.number => id,
            _ => self.constant(number.value.to_f64_pair()),
        }
    }

    fn constant(&mut self, value: (f64, f64)) -> NodeId {
        let key = (value.0.to_bits(), value.1.to_bits());
        if let Some(id) = self.constants.get(&key) {
            return *id;
        }
        let id = self.push(NodeKind::Constant, &[], value);
        self.constants.insert(key, id);
        id
    }
}

/// A backend that records: computes exactly as `R` does, and writes into the [`Graph`] of its thread.
///
/// A number may be older than the recording or belong to another. It enters this one as an input if [`Recorded::input`]
/// or [`Real::signal`] names it first; else as a constant, when it is first used. Outside of a recording nothing is
/// written.
#[derive(Clone, Copy, Debug, Default)]
pub struct Recorded<R> {
    value: R,
    /// Recording and node; none for a number that is not in a graph yet.
    node: Option<(u32, NodeId)>,
}

impl<R: Backend> Recorded<R> {
    /// A number that is in no graph yet.
    #[must_use]
    pub fn new(value: R) -> Self {
        Self { value, node: None }
    }

    /// The backend's number.
    #[must_use]
    pub fn value(self) -> R {
        self.value
    }

    /// A number that enters the recording under this name.
    #[must_use]
    pub fn input(name: &'static str, value: R) -> Self {
        Self::written(value, |recording| recording.push(NodeKind::Input(name), &[], value.to_f64_pair()))
    }

    /// Notes this number as a result, and hands it on.
    pub fn output(self, name: &'static str) -> Self {
        Self::written(self.value, |recording| {
            let id = recording.node_of(self);
            recording.graph.outputs.push((name, id));
            id
        })
    }

    /// The node of this number in the graph that is being recorded, if it is in it.
    #[must_use]
    pub fn node(self) -> Option<NodeId> {
        let current = RECORDING.with_borrow(|recording| recording.as_ref().map(|recording| recording.number));
        self.node.filter(|(recording, _)| Some(*recording) == current).map(|(_, id)| id)
    }

    fn written(value: R, write: impl FnOnce(&mut Recording) -> NodeId) -> Self {
        let node = RECORDING.with_borrow_mut(|recording| {
            recording.as_mut().map(|recording| {
                let id = write(recording);
                (recording.number, id)
            })
        });
        Self { value, node }
    }

    fn with_operands(operands: &[Self], kind: NodeKind, value: (f64, f64), result: R) -> Self {
        Self::written(result, |recording| {
            let ids: Vec<NodeId> = operands.iter().map(|x| recording.node_of(*x)).collect();
            recording.push(kind, &ids, value)
        })
    }
}

impl<R: Backend> Wrapper for Recorded<R> {
    type Inner = R;

    fn inner(self) -> R {
        self.value
    }

    fn constant(value: R) -> Self {
        Self::new(value)
    }

    fn observe(operation: Operation, operands: &[Self], result: R) -> Self {
        Self::with_operands(operands, NodeKind::Operation(operation), result.to_f64_pair(), result)
    }

    fn compared(left: Self, right: Self, outcome: Option<Ordering>) {
        let value = outcome.map_or(f64::NAN, |ordering| f64::from(ordering as i8));
        Self::with_operands(&[left, right], NodeKind::Compare(outcome), (value, 0.0), left.value);
    }

    fn phase(_phase: u64, exponent: i32, result: R) -> Self {
        Self::with_operands(&[], NodeKind::FromPhase { exponent }, result.to_f64_pair(), result)
    }

    fn to_phase(value: Self, exponent: i32, result: u64) {
        let high = f64::from_phase(result, 0); // cut, so that the rest is not negative
        let low = f64::from_phase(result - high.to_phase(0), 0);
        Self::with_operands(&[value], NodeKind::ToPhase { exponent }, (high, low), value.value);
    }

    fn named(self, name: &'static str) -> Self {
        let value = self.value.signal(name);
        if RECORDING.with_borrow(Option::is_some) && self.node().is_none() {
            return Self::input(name, value);
        }
        Self::written(value, |recording| {
            let id = recording.node_of(self);
            recording.graph.signals.push((name, id));
            id
        })
    }
}

wrapper!(impl[R: Backend] Recorded<R>);

#[cfg(test)]
mod tests {
    use super::*;
    use crate::{Counted, I16F16};
    use num_traits::{One, Zero};

    type Number = Recorded<I16F16>;

    fn number(value: f64) -> Number {
        Number::from_f64(value).unwrap()
    }

    /// Newton's root of two, with a data-dependent end: something of everything.
    fn kernel<R: Real>(start: R, two: R) -> R {
        let mut x = start;
        for _ in 0..10 {
            let next = (x + two / x).half().signal("next");
            if (next - x).abs() <= R::resolution() {
                break;
            }
            x = next;
        }
        let length = R::norm(&[x, x.sqrt(), -x]);
        let phase = R::from_phase((x * R::from_ratio(1, 4)).to_phase(-1), 1);
        R::sum_of_products([(x, length), (phase, two)]).mul_add(x, two).ldexp(-2)
    }

    /// Every node's value is its operation on the values of its operands: the graph says what was computed.
    #[test]
    fn the_graph_can_be_computed_again() {
        let (result, graph) =
            Graph::of(|| kernel(Number::input("start", I16F16::one()), number(2.0)).output("result"));
        assert_eq!(result.value(), kernel(I16F16::one(), I16F16::from_ratio(2, 1)), "no value is changed");
        let value = |id: NodeId| I16F16::from_f64(graph.node(id).value.0).unwrap();
        let mut computed = 0;
        for (id, node) in graph.iter() {
            let operands: Vec<I16F16> = graph.operands(id).iter().map(|x| value(*x)).collect();
            assert!(graph.operands(id).iter().all(|operand| *operand < id));
            match node.kind {
                NodeKind::Operation(operation) => {
                    assert_eq!(operation.apply(&operands), value(id), "{id:?}: {node:?}");
                    computed += 1;
                }
                NodeKind::Compare(outcome) => assert_eq!(operands[0].partial_cmp(&operands[1]), outcome),
                NodeKind::ToPhase { exponent } => {
                    let phase = node.value.0.to_phase(0) + node.value.1.to_phase(0);
                    assert_eq!(operands[0].to_phase(exponent), phase);
                }
                NodeKind::Input(_) | NodeKind::Constant | NodeKind::FromPhase { .. } => {
                    assert!(operands.is_empty())
                }
            }
        }
        assert!(computed > 15, "{computed}");
        let [(name, output)] = graph.outputs() else { panic!("one output: {:?}", graph.outputs()) };
        assert_eq!((*name, value(*output)), ("result", result.value()));
    }

    #[test]
    fn the_counts_are_those_of_the_counting_wrapper() {
        let (_, graph) = Graph::of(|| kernel(Number::one(), number(2.0)));
        let two = Counted::<I16F16>::from_f64(2.0).unwrap();
        let (_, counts) = OperationCounts::of(|| kernel(Counted::one(), two));
        assert_eq!(graph.counts(), counts);
    }

    #[test]
    fn numbers_from_outside_are_constants_or_named_inputs() {
        let (x, y) = (number(3.0), number(3.0));
        let ((), graph) = Graph::of(|| {
            let named = y.signal("y");
            let _ = ((x * y) * named).signal("product");
            let _ = x.is_zero();
        });
        let kinds: Vec<NodeKind> = graph.nodes().iter().map(|node| node.kind).collect();
        let product = NodeKind::Operation(Operation::Mul);
        let expected = [
            NodeKind::Input("y"),
            NodeKind::Constant, // x and the unnamed y: the same number
            product,
            product,
            NodeKind::Constant, // zero
            NodeKind::Compare(Some(Ordering::Greater)),
        ];
        assert_eq!(kinds, expected);
        let ids = |graph: &Graph, i: u32| graph.operands(NodeId(i)).to_vec();
        assert_eq!(
            (ids(&graph, 2), ids(&graph, 3)),
            (vec![NodeId(1), NodeId(1)], vec![NodeId(2), NodeId(0)])
        );
        assert_eq!(graph.signals(), [("product", NodeId(3))]);
        assert_eq!(graph.node(NodeId(3)).value, (27.0, 0.0));
    }

    /// Taken step by step, a run gives the graphs that each step alone gives.
    #[test]
    fn a_run_is_taken_step_by_step() {
        let step = |x: Number, k: f64| (x * x.signal("x") + number(k)).signal("next");
        let (taken, rest) = Graph::of(|| {
            let mut x = number(0.5);
            let mut taken = Vec::new();
            for k in [0.25, 0.5, 0.25] {
                x = step(x, k);
                taken.push(Graph::so_far());
            }
            taken
        });
        let mut x = number(0.5);
        for (k, taken) in [0.25, 0.5, 0.25].into_iter().zip(taken) {
            let (next, alone) = Graph::of(|| step(x, k));
            assert_eq!(taken, alone);
            x = next;
        }
        assert!(rest.nodes().is_empty() && Graph::so_far().nodes().is_empty());
    }

    /// A state that is kept from one step to the next is data from outside for the next.
    #[test]
    fn recordings_do_not_mix() {
        let (sum, first) = Graph::of(|| number(1.0) + number(2.0));
        assert_eq!((first.nodes().len(), sum.node()), (3, None));
        let (inner, outer) = Graph::of(|| {
            let _ = sum + sum;
            Graph::of(|| -(sum + sum)).1
        });
        assert_eq!((inner.nodes().len(), outer.nodes().len()), (3, 2));
        assert_eq!(outer.nodes()[0].kind, NodeKind::Constant);
        let unrecorded = sum + sum;
        assert_eq!((unrecorded.value().to_f64(), unrecorded.node()), (6.0, None));
    }
}
