//! The library's own tick against the simulated robot: convergence, accuracy, avoidance and repeatability, each with
//! bounds on both sides, so that a metric that measures nothing fails too.

mod avoiding;
mod experiment;
mod following;
mod harness;
