//! The drivers over embedded-hal: each against its part, mocked or modelled. What a robot builder relies on: commands
//! reach the pins, readings arrive with their age, every failure is a reading with its cause, and nothing waits.

#[path = "ports/analog.rs"]
mod analog;
#[path = "ports/bridge.rs"]
mod bridge;
#[path = "ports/echo.rs"]
mod echo;
#[path = "ports/quadrature.rs"]
mod quadrature;
#[path = "ports/ring.rs"]
mod ring;
#[path = "ports/robot.rs"]
mod robot;
#[path = "ports/time_of_flight.rs"]
mod time_of_flight;
#[path = "ports/wheel_loop.rs"]
mod wheel_loop;

use fixed::types::{I8F24, I16F16};
use fuzzypilot::units::{Metres, MetresPerSecond, Seconds};
use proptest::prelude::*;

fn fx(x: f64) -> I16F16 {
    I16F16::from_num(x)
}

fn metres(x: f64) -> Metres {
    Metres::new(fx(x))
}

fn speed(x: f64) -> MetresPerSecond {
    MetresPerSecond::new(fx(x))
}

fn seconds(x: f64) -> Seconds {
    Seconds::new(I8F24::from_num(x))
}

fn config(cases: u32) -> ProptestConfig {
    ProptestConfig {
        cases,
        failure_persistence: None,
        ..ProptestConfig::default()
    }
}
