//! The lower level: the two fuzzy controllers between the higher level's decision and a desired twist.

pub mod avoider;
pub mod fine;
pub mod follower;
