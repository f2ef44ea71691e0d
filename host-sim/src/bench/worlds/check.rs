//! Whether a robot has a chance in a world at all.

use super::error::{WorldError, short};
use super::planner;
use crate::bench::arena::{Arena, length};
use crate::bench::attempt::body_clearance;
use crate::bench::body::Body;
use rayon::prelude::*;

/// Shortest route, m. Of one without a length there is nothing to follow.
pub const SHORTEST: f64 = 0.1;

/// Refuses worlds whose start or goal lies in an obstacle or is one with the other, and those without a way for a disc
/// that fits into the body: what that one cannot pass, the body cannot. Sealed worlds must not have one.
pub fn check(place: &str, arenas: &[Arena], body: &Body) -> Result<(), WorldError> {
    arenas.par_iter().try_for_each(|arena| {
        fault(arena, body).map_or(Ok(()), |why| {
            Err(WorldError::Unusable {
                place: place.to_owned(),
                number: arena.number,
                why: short(&why),
            })
        })
    })
}

/// What forbids a world, and what is allowed.
pub(super) fn fault(arena: &Arena, body: &Body) -> Option<String> {
    let [gx, gy] = arena.goal;
    let [sx, sy, _] = arena.start;
    if length(&[[sx, sy], [gx, gy]]) <= arena.goal_radius {
        return Some(format!(
            "the start ({sx}, {sy}) is within {} m of the goal ({gx}, {gy}): the robot is there before it drives; allowed: a goal farther away",
            arena.goal_radius
        ));
    }
    if arena.route_length() < SHORTEST {
        return Some(format!(
            "the route from ({sx}, {sy}) to ({gx}, {gy}) is {:.3} m long; allowed: {SHORTEST} m or more",
            arena.route_length()
        ));
    }
    let moving: Vec<_> = arena.movers.iter().map(|m| m.at(0.0)).collect();
    if body_clearance(body, arena.start, &arena.circles) <= 0.0
        || body_clearance(body, arena.start, &moving) <= 0.0
    {
        return Some(format!(
            "the robot touches an obstacle where it starts, at ({sx}, {sy}); allowed: a free start"
        ));
    }
    let inside = arena.circles.iter().find(|c| {
        let (dx, dy) = (c.at[0] - gx, c.at[1] - gy);
        dx * dx + dy * dy < c.radius * c.radius
    });
    if let Some(c) = inside {
        return Some(format!(
            "the goal ({gx}, {gy}) is inside the obstacle at ({}, {}); allowed: a free goal",
            c.at[0], c.at[1]
        ));
    }
    let way = planner::route(
        &arena.circles,
        body.inner_radius(),
        [sx, sy],
        arena.goal,
        arena.goal_radius,
    );
    match (way.is_some(), arena.sealed) {
        (false, false) => Some(format!(
            "no route from ({sx}, {sy}) to within {} m of ({gx}, {gy}) for a disc of {} m; allowed: a world with one, or `sealed = true`",
            arena.goal_radius,
            body.inner_radius()
        )),
        (true, true) => Some("it is called sealed and has a route; allowed: none".to_owned()),
        _ => None,
    }
}
