//! The operations of a recorded step, as a target prices them.

use real::{Graph, NodeId, NodeKind, Operation};
use serde::{Deserialize, Serialize};

/// An operation that has a price.
#[derive(Clone, Copy, Debug, PartialEq, Eq, PartialOrd, Ord, Hash, Serialize, Deserialize)]
#[serde(rename_all = "snake_case")]
pub enum Priced {
    /// A sum, a difference or a change of sign.
    Add,
    /// A comparison.
    Compare,
    /// A product.
    Mul,
    /// `a·b + c`; where it has no price, a product and a sum.
    MulAdd,
    /// A sum of two products, rounded once; where it has no price, products and sums. More products cost a `MulAdd` each.
    SumOfProducts,
    /// A quotient.
    Div,
    /// A square root.
    Sqrt,
    /// The length of a vector of two; where it has no price, a sum of products and a square root.
    Norm,
    /// A multiplication by a power of two.
    Scale,
    /// A number made of a 64-bit phase, or a phase of a number.
    Convert,
    /// A number that comes from memory; where it has no price, it costs nothing.
    Load,
}

impl Priced {
    /// The name in a target file.
    #[must_use]
    pub const fn name(self) -> &'static str {
        match self {
            Self::Add => "add",
            Self::Compare => "compare",
            Self::Mul => "mul",
            Self::MulAdd => "mul_add",
            Self::SumOfProducts => "sum_of_products",
            Self::Div => "div",
            Self::Sqrt => "sqrt",
            Self::Norm => "norm",
            Self::Scale => "scale",
            Self::Convert => "convert",
            Self::Load => "load",
        }
    }
}

/// An operation of a step.
#[derive(Clone, Debug, PartialEq, Eq, Hash)]
pub struct Task {
    /// The operation.
    pub operation: Priced,
    /// Products of a sum of products, components of a norm; else 1.
    pub terms: usize,
    /// The tasks whose results it takes, all before it.
    pub operands: Vec<usize>,
}

/// A step: its tasks in the order they were done.
#[derive(Clone, Debug, Default, PartialEq, Eq, Hash)]
pub struct Step {
    /// The tasks.
    pub tasks: Vec<Task>,
}

impl Step {
    /// The tasks of a recorded graph: one for each node, in the graph's order.
    ///
    /// A decision that was taken by a comparison is not an operand of later operations: the graph is the trace of one
    /// path.
    #[must_use]
    pub fn of(graph: &Graph) -> Self {
        Self { tasks: graph.iter().map(|(id, node)| task(graph, id, node.kind)).collect() }
    }

    /// Number of operations, without loads.
    #[must_use]
    pub fn operations(&self) -> usize {
        self.tasks.iter().filter(|task| task.operation != Priced::Load).count()
    }
}

fn task(graph: &Graph, id: NodeId, kind: NodeKind) -> Task {
    let operands: Vec<usize> = graph.operands(id).iter().map(|operand| operand.index()).collect();
    let (operation, terms) = match kind {
        NodeKind::Operation(operation) => match operation {
            Operation::Add | Operation::Sub | Operation::Neg => (Priced::Add, 1),
            Operation::Mul => (Priced::Mul, 1),
            Operation::MulAdd => (Priced::MulAdd, 1),
            Operation::SumOfProducts => (Priced::SumOfProducts, operands.len() / 2),
            Operation::Div => (Priced::Div, 1),
            Operation::Sqrt => (Priced::Sqrt, 1),
            Operation::Norm => (Priced::Norm, operands.len()),
            // The trait has only these operations; a new one is priced as a product until it is named here.
            Operation::Scale { .. } => (Priced::Scale, 1),
            _ => (Priced::Mul, 1),
        },
        NodeKind::Compare(_) => (Priced::Compare, 1),
        NodeKind::FromPhase { .. } | NodeKind::ToPhase { .. } => (Priced::Convert, 1),
        _ => (Priced::Load, 1),
    };
    Task { operation, terms, operands }
}
