//! Logs with faults of known size: each is found, and nothing else.

mod corners;
mod motion;
mod planted;
mod refused;
mod times;
mod unjudged;
