//! stub
mod evaluate;
pub use evaluate::{Derivatives, Differentiate, Evaluate};
