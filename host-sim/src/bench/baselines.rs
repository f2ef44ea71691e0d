//! The field's own navigators, as far as a robot without a map can have them. Each says where it comes from and how its
//! parameters were chosen; none of them was tuned on the benchmark's test worlds.

pub mod pure_pursuit;
pub mod route;
