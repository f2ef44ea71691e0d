//! The navigator's geometry against f64: clearances of all three kinds of footprint, and the polar map against every
//! point in every sector.

use fixed::types::I16F16;
use fuzzypilot::geometry::Point;
use fuzzypilot::navigate::{Footprint, MapParams, Near, PolarMap, SECTORS, Steps, Vector};
use fuzzypilot::units::Metres;
use proptest::prelude::*;

/// A step of the navigator's lengths, m; directions have a step of 2⁻¹⁴.
const STEP: f64 = 1.0 / 4096.0;

fn metres(x: f64) -> Metres {
    Metres::new(I16F16::from_num(x))
}

fn vector([x, y]: [f64; 2]) -> Vector {
    Vector::of(Point::new(metres(x), metres(y)))
}

fn f(steps: Steps) -> f64 {
    f64::from(steps.bits()) * STEP
}

fn jackal() -> Footprint {
    Footprint::Rectangle {
        front: metres(0.3),
        rear: metres(0.2),
        half_width: metres(0.215),
    }
}

const HOUSE: [[f64; 2]; 5] = [
    [-0.2, -0.2],
    [0.2, -0.2],
    [0.4, 0.0],
    [0.2, 0.2],
    [-0.2, 0.2],
];

fn polygon(corners: &[[f64; 2]]) -> Footprint {
    let point = |[x, y]: &[f64; 2]| Point::new(metres(*x), metres(*y));
    Footprint::Polygon(corners.iter().map(point).collect())
}

/// Signed distance of a point to a convex polygon, counter-clockwise.
fn distance(corners: &[[f64; 2]], [x, y]: [f64; 2]) -> f64 {
    let mut outside = f64::INFINITY;
    let mut inside = f64::NEG_INFINITY;
    for (i, a) in corners.iter().enumerate() {
        let b = corners[(i + 1) % corners.len()];
        let (ex, ey) = (b[0] - a[0], b[1] - a[1]);
        let length = ex.hypot(ey);
        let (px, py) = (x - a[0], y - a[1]);
        inside = inside.max((px * ey - py * ex) / length);
        let share = ((px * ex + py * ey) / (length * length)).clamp(0.0, 1.0);
        outside = outside.min((px - share * ex).hypot(py - share * ey));
    }
    if inside > 0.0 { outside } else { inside }
}

fn config(cases: u32) -> ProptestConfig {
    ProptestConfig {
        cases,
        failure_persistence: None,
        ..ProptestConfig::default()
    }
}

proptest! {
    #![proptest_config(config(2000))]

    #[test]
    fn clearances_are_euclidean(x in -2.0..2.0, y in -2.0..2.0) {
        let rectangle = [[-0.2, -0.215], [0.3, -0.215], [0.3, 0.215], [-0.2, 0.215]];
        let at = vector([x, y]);
        for (footprint, wanted, allowed) in [
            (jackal(), distance(&rectangle, [x, y]), 3.0 * STEP),
            // An edge's direction is rounded to 2⁻¹⁴, which is as much over 2 m.
            (polygon(&HOUSE), distance(&HOUSE, [x, y]), 5.0 * STEP),
            (Footprint::Disc { radius: metres(0.25) }, x.hypot(y) - 0.25, 3.0 * STEP),
        ] {
            footprint.check().unwrap();
            let got = f(footprint.outline().clearance(at));
            prop_assert!((got - wanted).abs() <= allowed, "{footprint:?}: {got}, not {wanted}");
        }
    }

    /// In every sector the free travel is that of the nearest point in the corridor, no less and no more.
    #[test]
    fn the_map_is_the_nearest_point_in_each_corridor(
        points in prop::collection::vec((-1.5..1.5f64, -1.5..1.5f64), 1..20),
    ) {
        let params = MapParams {
            look: metres(1.6),
            hard: metres(0.02),
            soft: metres(0.06),
            turning: metres(0.01),
        };
        let outline = jackal().outline();
        let body = [[-0.2, -0.215], [0.3, -0.215], [0.3, 0.215], [-0.2, 0.215]];
        let points: Vec<_> = points.into_iter().map(|(x, y)| [x, y]).collect();
        let mut near = Near::new();
        near.collect(points.iter().map(|p| vector(*p)), &outline);
        let mut map = PolarMap::new();
        map.draw(&params, &near, &outline, Steps::ZERO);
        for sector in 0..SECTORS {
            let (sin, cos) = (sector as f64 / SECTORS as f64 * std::f64::consts::TAU).sin_cos();
            let free = |half_width: f64, front: f64| {
                let ahead = points.iter().filter_map(|[x, y]| {
                    let (along, beside) = (x * cos + y * sin, (y * cos - x * sin).abs());
                    (beside < half_width && along > front).then_some(along - 0.3)
                });
                ahead.fold(1.6, f64::min)
            };
            // A corridor a little wider and one a little narrower bound what rounding can do.
            let tight = 5.0 * STEP;
            let got = map.free(&near, sector);
            for (got, half_width) in [(f(got.hard), 0.235), (f(got.soft), 0.275)] {
                prop_assert!(got <= free(half_width - tight, 0.3 + tight) + tight, "sector {sector}: {got}");
                // Points between flank and front may shorten it further, never lengthen it.
                let beside = points.iter().any(|[x, y]| {
                    let (along, beside) = (x * cos + y * sin, (y * cos - x * sin).abs());
                    beside < half_width + tight && along > 0.0 && along <= 0.3 + tight
                });
                prop_assert!(beside || got >= free(half_width + tight, 0.3) - tight, "sector {sector}: {got}");
            }
        }
        // Turning in place as far as the map allows touches nothing.
        for (room, sign) in [(map.left, 1.0), (map.right, -1.0)] {
            let room = f64::from(room.bits()) / 4_294_967_296.0 * std::f64::consts::TAU;
            let mut before: Vec<f64> = points.iter().map(|p| distance(&body, *p)).collect();
            for k in 1..=(room / 0.01) as i32 {
                let (sin, cos) = (sign * 0.01 * f64::from(k)).sin_cos();
                for ([x, y], before) in points.iter().zip(&mut before) {
                    let now = distance(&body, [x * cos + y * sin, y * cos - x * sin]);
                    prop_assert!(now > -0.002 || now >= *before || *before < 0.01, "touched after {k}");
                    *before = now;
                }
            }
        }
    }
}

#[test]
fn footprints_that_are_none_are_refused() {
    let mut clockwise = HOUSE;
    clockwise.reverse();
    let mut dented = HOUSE;
    dented[2] = [0.0, 0.0];
    let aside = HOUSE.map(|[x, y]| [x + 0.5, y]);
    let huge = HOUSE.map(|[x, y]| [x * 10.0, y * 10.0]);
    for bad in [&clockwise[..], &dented, &aside, &huge, &HOUSE[..2], &[]] {
        let error = polygon(bad).check().unwrap_err();
        assert_eq!(error.field, "footprint.polygon", "{bad:?}");
    }
    for radius in [0.0, -1.0, 3.0] {
        let footprint = Footprint::Disc {
            radius: metres(radius),
        };
        assert_eq!(footprint.check().unwrap_err().field, "footprint.radius");
    }
}
