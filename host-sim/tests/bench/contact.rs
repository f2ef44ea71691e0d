//! The contact test of bodies against one that walks around their edges in the world's frame.

use host_sim::bench::arena::Circle;
use host_sim::bench::attempt::body_clearance;
use host_sim::bench::body::{Body, JACKAL};
use proptest::prelude::*;

/// Distance of a point from a segment, m.
fn from_segment(p: [f64; 2], a: [f64; 2], b: [f64; 2]) -> f64 {
    let (ex, ey) = (b[0] - a[0], b[1] - a[1]);
    let share = ((p[0] - a[0]) * ex + (p[1] - a[1]) * ey) / (ex * ex + ey * ey);
    let share = share.clamp(0.0, 1.0);
    (p[0] - a[0] - share * ex).hypot(p[1] - a[1] - share * ey)
}

/// Signed distance of a point from a convex polygon at a pose, from its corners alone.
fn from_polygon(corners: &[[f64; 2]], [x, y, heading]: [f64; 3], p: [f64; 2]) -> f64 {
    let corner = |[along, left]: [f64; 2]| {
        [
            x + along * heading.cos() + left * (heading + std::f64::consts::FRAC_PI_2).cos(),
            y + along * heading.sin() + left * (heading + std::f64::consts::FRAC_PI_2).sin(),
        ]
    };
    let corners: Vec<[f64; 2]> = corners.iter().copied().map(corner).collect();
    let count = corners.len();
    let edges = (0..count).map(|k| (corners[k], corners[(k + 1) % count]));
    let inside = edges
        .clone()
        .all(|(a, b)| (b[0] - a[0]) * (p[1] - a[1]) - (b[1] - a[1]) * (p[0] - a[0]) >= 0.0);
    let away = edges
        .map(|(a, b)| from_segment(p, a, b))
        .fold(f64::INFINITY, f64::min);
    if inside { -away } else { away }
}

proptest! {
    #[test]
    fn clearance_is_the_distance_from_the_edges(
        x in -2.0..2.0, y in -2.0..2.0, heading in -3.2..3.2,
        circles in prop::collection::vec((-1.5..1.5, -1.5..1.5, 0.01..0.4), 1..6),
    ) {
        let pose = [x, y, heading];
        let circles: Vec<Circle> = circles
            .into_iter()
            .map(|(dx, dy, radius)| Circle { at: [x + dx, y + dy], radius })
            .collect();
        let rectangle = [[0.254, 0.215], [-0.254, 0.215], [-0.254, -0.215], [0.254, -0.215]];
        // Six corners, the centre not in the middle.
        let beetle = [[0.5, 0.0], [0.3, 0.2], [-0.1, 0.2], [-0.2, 0.1], [-0.2, -0.1], [0.3, -0.2]];
        let name: Vec<String> = beetle.iter().map(|[x, y]| format!("{x},{y}")).collect();
        let parsed = Body::parse(&format!("polygon:{}", name.join(":"))).unwrap();
        for (body, corners) in [(JACKAL, &rectangle[..]), (parsed, &beetle[..])] {
            let expected = circles
                .iter()
                .map(|c| from_polygon(corners, pose, c.at) - c.radius)
                .fold(1.0, f64::min);
            let measured = body_clearance(&body, pose, &circles);
            prop_assert!((measured - expected).abs() < 1e-9, "{measured} instead of {expected}");
        }
        let expected = circles
            .iter()
            .map(|c| (c.at[0] - x).hypot(c.at[1] - y) - 0.3 - c.radius)
            .fold(1.0, f64::min);
        let measured = body_clearance(&Body::Disc(0.3), pose, &circles);
        prop_assert!((measured - expected).abs() < 1e-9, "{measured} instead of {expected}");
    }
}
