//! The field's own navigators, as far as a robot without a map can have them. Each says where it comes from and how its
//! parameters were chosen. None of them was tuned on the benchmark's test worlds.

pub mod bendy;
pub mod certainty;
pub mod destination;
pub mod dwa;
pub mod echoes;
pub mod pure_pursuit;
pub mod regulated;
pub mod route;
pub mod steer;
pub mod vfh;
