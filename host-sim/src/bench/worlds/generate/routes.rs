//! `generated:routes`: routes of known shape on open ground, on which the distance from the route can be judged, and one
//! with a cylinder on it that the route does not know.

use crate::bench::arena::{Arena, Circle, Course, Stretch};
use crate::bench::worlds::error::WorldError;
use crate::bench::worlds::numbers::Numbers;
use crate::track::Piece;
use std::f64::consts::{FRAC_PI_2, PI};

/// What they are asked for by.
pub const NAME: &str = "routes";

/// Distance of the points that stand for a route where one of points is wanted, m: 5 cm off at 1 m radius are 0.3 mm.
const SPACING: f64 = 0.02;

/// How near to its end a route counts as driven, m.
const ARRIVED: f64 = 0.3;

/// Radius of the cylinder in the way, m, and where it stands.
const CYLINDER: f64 = 0.1;
const CYLINDER_AT: [f64; 2] = [4.0, 0.02];

/// A route by name: its pieces, and where it is cut into parts.
struct Route {
    name: &'static str,
    pieces: Vec<Piece>,
    /// Names and ends of its parts, m; one part without an end is all of it.
    parts: Vec<(&'static str, f64)>,
    cylinder: bool,
}

/// All of them, by number.
fn routes() -> Vec<Route> {
    let line = |from, to| Piece::Line { from, to };
    // To the left from the origin, looking along x.
    let left = |radius: f64, sweep: f64| Piece::Arc {
        centre: [0.0, radius],
        radius,
        from: -FRAC_PI_2,
        sweep,
    };
    // On to the right where a half circle to the left has ended, looking back along x.
    let right = |radius: f64| Piece::Arc {
        centre: [0.0, 3.0 * radius],
        radius,
        from: -FRAC_PI_2,
        sweep: -PI,
    };
    let whole = |name, pieces| Route {
        name,
        pieces,
        parts: vec![("whole", f64::INFINITY)],
        cylinder: false,
    };
    vec![
        whole("line", vec![line([0.0, 0.0], [10.0, 0.0])]),
        whole("arc-r5", vec![left(5.0, PI)]),
        whole("arc-r2", vec![left(2.0, 1.5 * PI)]),
        whole("arc-r1", vec![left(1.0, 1.5 * PI)]),
        whole("s-r1.5", vec![left(1.5, PI), right(1.5)]),
        whole("dual-semicircle-r8", vec![left(8.0, PI), right(8.0)]),
        Route {
            parts: vec![("approach", 5.0), ("exit", f64::INFINITY)],
            ..whole(
                "corner",
                vec![line([0.0, 0.0], [5.0, 0.0]), line([5.0, 0.0], [5.0, 5.0])],
            )
        },
        Route {
            cylinder: true,
            ..whole("pass", vec![line([0.0, 0.0], [10.0, 0.0])])
        },
    ]
}

/// Those that were asked for.
pub fn make(option: Option<&str>, numbers: &Numbers) -> Result<Vec<Arena>, WorldError> {
    if let Some(option) = option {
        return Err(WorldError::wrong(
            "generated",
            format!("`{option}`"),
            "no option of routes",
        ));
    }
    let routes = routes();
    let count = routes.len() as u32;
    let asked = numbers.below(count);
    if let Some(number) = asked.iter().find(|n| **n >= count) {
        return Err(WorldError::wrong(
            "generated",
            format!("route {number}"),
            format!("0 to {}", count - 1),
        ));
    }
    let made = routes.into_iter().zip(0..);
    Ok(made
        .filter(|(_, number)| asked.contains(number))
        .map(|(route, number)| arena(route, number))
        .collect())
}

fn arena(route: Route, number: u32) -> Arena {
    let points = points(&route.pieces);
    let mut from = 0.0;
    let mut stretches = Vec::new();
    for (name, to) in route.parts {
        stretches.push(Stretch {
            name: name.to_owned(),
            along: from..to,
        });
        from = to;
    }
    let cylinder = Circle {
        at: CYLINDER_AT,
        radius: CYLINDER,
    };
    Arena {
        number,
        circles: if route.cylinder {
            vec![cylinder]
        } else {
            Vec::new()
        },
        unmapped: usize::from(route.cylinder),
        movers: Vec::new(),
        start: route.pieces[0].at(0.0),
        goal: points[points.len() - 1],
        goal_radius: ARRIVED,
        sealed: false,
        route: points,
        course: Some(Course {
            name: route.name.to_owned(),
            pieces: route.pieces,
            stretches,
            passed: route.cylinder.then_some(CYLINDER_AT[0] + CYLINDER),
        }),
    }
}

/// The pieces as points, both ends included.
fn points(pieces: &[Piece]) -> Vec<[f64; 2]> {
    let mut points = Vec::new();
    for piece in pieces {
        let count = (piece.length() / SPACING).ceil();
        points.extend((0..count as usize).map(|k| {
            let [x, y, _] = piece.at(piece.length() * k as f64 / count);
            [x, y]
        }));
    }
    points.extend(pieces.last().map(|piece| {
        let [x, y, _] = piece.at(piece.length());
        [x, y]
    }));
    points
}
