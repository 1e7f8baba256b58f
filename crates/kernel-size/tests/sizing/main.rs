//! Kernels judged, sized, priced and written, each against what is known otherwise.

mod answers;
mod baseline;
mod brute_force;
mod faults;
mod inputs;
mod kernels;
