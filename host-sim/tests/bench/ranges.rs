//! Ranges against a brute force over points of the circles' rims, and what goes wrong with them.

use fuzzypilot::ports::{Fault, Range};
use host_sim::bench::arena::Circle;
use host_sim::bench::ranging::{Disturbance, Ranging};
use host_sim::bench::seeds::{Purpose, stream};
use host_sim::bench::sensors::named;
use host_sim::recording::{BeamView, Disc};
use host_sim::world::{World, wrap};
use proptest::prelude::*;

/// Points on a rim, and how far the nearest point of an arc between two of them may be from both, m.
const POINTS: usize = 4000;

fn pose() -> impl Strategy<Value = [f64; 3]> {
    (-3.0..3.0, -3.0..3.0, -3.2..3.2).prop_map(|(x, y, h)| [x, y, h])
}

/// Circles of which none holds the origin of a sensor at `pose`.
fn circles() -> impl Strategy<Value = Vec<Circle>> {
    prop::collection::vec((-6.0..6.0, -6.0..6.0, 0.05..0.5), 1..20).prop_map(|all| {
        all.into_iter()
            .map(|(x, y, radius)| Circle { at: [x, y], radius })
            .collect()
    })
}

fn look(sensors: &[BeamView], pose: [f64; 3], circles: &[Circle]) -> Vec<f64> {
    let mut ranging = Ranging::new(sensors, Disturbance::MILD, None);
    ranging.look(pose, circles, &mut stream(1, 1, Purpose::Ranges));
    ranging.echoes().to_vec()
}

/// Nearest of many points of all rims that lie in a cone.
fn brute(sensor: &BeamView, pose: [f64; 3], circles: &[Circle]) -> f64 {
    let (sin, cos) = pose[2].sin_cos();
    let at = [
        pose[0] + sensor.x * cos - sensor.y * sin,
        pose[1] + sensor.x * sin + sensor.y * cos,
    ];
    let mut nearest = f64::INFINITY;
    for c in circles {
        for k in 0..POINTS {
            let turn = k as f64 / POINTS as f64 * std::f64::consts::TAU;
            let (dx, dy) = (
                c.at[0] + c.radius * turn.cos() - at[0],
                c.at[1] + c.radius * turn.sin() - at[1],
            );
            let off = wrap(dy.atan2(dx) - pose[2] - sensor.heading);
            if off.abs() <= sensor.width / 2.0 {
                nearest = nearest.min(dx.hypot(dy));
            }
        }
    }
    if nearest <= sensor.max_range {
        nearest
    } else {
        f64::INFINITY
    }
}

proptest! {
    #![proptest_config(ProptestConfig::with_cases(40))]
    #[test]
    fn a_cone_hears_the_nearest_point_inside(pose in pose(), circles in circles()) {
        prop_assume!(circles.iter().all(|c| {
            (c.at[0] - pose[0]).hypot(c.at[1] - pose[1]) > c.radius + 0.25
        }));
        let sensors = [
            BeamView { x: 0.1, y: 0.05, heading: 0.7, width: 0.3, max_range: 4.0 },
            BeamView { x: 0.0, y: -0.1, heading: -1.9, width: 1.2, max_range: 3.0 },
        ];
        for (sensor, echo) in sensors.iter().zip(look(&sensors, pose, &circles)) {
            let expected = brute(sensor, pose, &circles);
            // A point of the rim just outside of the cone, or just out of reach, makes a difference of a rim's step.
            let same = (echo - expected).abs() < 0.03 || (echo - sensor.max_range).abs() < 0.03;
            prop_assert!(same || echo == expected, "{echo} instead of {expected}");
        }
    }

    /// Sensors of one place are asked by sectors, others one by one.
    #[test]
    fn cones_hear_the_same_whether_they_share_a_place_or_not(pose in pose(), circles in circles()) {
        let mut sensors = named("cone16").unwrap();
        let together = look(&sensors, pose, &circles);
        sensors.push(BeamView { x: 1.0, ..sensors[0] });
        let apart = look(&sensors, pose, &circles);
        prop_assert_eq!(&together[..], &apart[..16]);
    }

    #[test]
    fn a_lidar_sees_what_single_rays_hit(pose in pose(), circles in circles()) {
        let sensors = named("lidar720").unwrap();
        let world = World {
            discs: circles
                .iter()
                .map(|c| Disc { name: String::new(), x: c.at[0], y: c.at[1], radius: c.radius })
                .collect(),
        };
        for (sensor, echo) in sensors.iter().zip(look(&sensors, pose, &circles)) {
            let ray = world
                .cast([pose[0], pose[1]], pose[2] + sensor.heading, sensor.max_range)
                .unwrap_or(f64::INFINITY);
            // On a rim or at the end of the reach the last bit decides.
            let rim = circles.iter().any(|c| {
                let (dx, dy) = (c.at[0] - pose[0], c.at[1] - pose[1]);
                let heading = pose[2] + sensor.heading;
                let across = dy * heading.cos() - dx * heading.sin();
                (across.abs() - c.radius).abs() < 1e-6
            });
            prop_assert!(rim || echo == ray || (echo - ray).abs() < 1e-6, "{echo} instead of {ray}");
        }
    }
}

fn one_ahead() -> [Circle; 1] {
    [Circle {
        at: [2.0, 0.0],
        radius: 0.5,
    }]
}

#[test]
fn dropouts_come_as_often_as_asked_and_are_time_outs() {
    let sensors = named("cone16").unwrap();
    let harsh = Disturbance {
        dropout: 0.05,
        ..Disturbance::MILD
    };
    let mut ranging = Ranging::new(&sensors, harsh, None);
    let mut rng = stream(3, 0, Purpose::Ranges);
    let mut lost = 0;
    for _ in 0..2000 {
        ranging.look([0.0; 3], &one_ahead(), &mut rng);
        lost += ranging
            .readings
            .iter()
            .filter(|r| r.range == Range::Invalid(Fault::Timeout))
            .count();
    }
    let share = lost as f64 / (2000.0 * 16.0);
    assert!((share - 0.05).abs() < 0.005, "{share}");
}

#[test]
fn a_grazed_surface_sends_nothing_back_beyond_the_specular_angle() {
    let beam = |y: f64| BeamView {
        x: 0.0,
        y,
        heading: 0.0,
        width: 0.0,
        max_range: 4.0,
    };
    // Offsets of 0.8 and 0.9 radii: incidence of 53 and 64 degrees.
    let sensors = [beam(0.40), beam(0.45)];
    let echoes = |specular: f64| {
        let disturbance = Disturbance {
            specular,
            ..Disturbance::MILD
        };
        let mut ranging = Ranging::new(&sensors, disturbance, None);
        ranging.look([0.0; 3], &one_ahead(), &mut stream(1, 1, Purpose::Ranges));
        ranging.echoes().to_vec()
    };
    let all = echoes(std::f64::consts::FRAC_PI_2);
    assert!(all.iter().all(|e| e.is_finite()), "{all:?}");
    let some = echoes(std::f64::consts::FRAC_PI_3);
    assert!(some[0].is_finite() && some[1].is_infinite(), "{some:?}");
}

#[test]
fn cross_talk_brings_a_neighbours_echo_and_a_dead_sensor_none() {
    let sensors = named("cone16").unwrap();
    let crossed = Disturbance {
        cross_talk: 1.0,
        ..Disturbance::MILD
    };
    // Wide enough for the two cones in the middle only.
    let small = [Circle {
        at: [2.0, 0.0],
        radius: 0.2,
    }];
    let heard = |disturbance, dead| {
        let mut ranging = Ranging::new(&sensors, disturbance, dead);
        ranging.look([0.0; 3], &small, &mut stream(1, 1, Purpose::Ranges));
        let echo = |r: &fuzzypilot::ports::RangeReading| matches!(r.range, Range::Echo(_));
        ranging.readings.iter().map(echo).collect::<Vec<_>>()
    };
    let alone: Vec<usize> = (0..16)
        .filter(|k| heard(Disturbance::MILD, None)[*k])
        .collect();
    assert_eq!(alone, [7, 8]);
    let with: Vec<usize> = (0..16).filter(|k| heard(crossed, None)[*k]).collect();
    assert_eq!(with, [6, 7, 8, 9]);
    let dead: Vec<usize> = (0..16)
        .filter(|k| heard(Disturbance::MILD, Some(7))[*k])
        .collect();
    assert_eq!(dead, [8]);
}
