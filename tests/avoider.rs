//! The avoider against the unfeasible region: whatever the tables say, the commanded direction clears every near
//! obstacle on the committed side. Checked in f64, over both printed variants of the tables and every bearing.

use fixed::types::{I8F8, I16F16};
use fuzzypilot::behaviour::avoider::avoid;
use fuzzypilot::geometry::Point;
use fuzzypilot::params::{Avoider, Limits};
use fuzzypilot::signals::{Behaviour, Controller, Obstacle, Sensed, Turn};
use fuzzypilot::tables::coarse::{CoarseSet, SpeedInput};
use fuzzypilot::units::{Angle, Metres, MetresPerSecond};
use proptest::prelude::*;

const ROBOT: f64 = 0.1;
const MARGIN: f64 = 0.08;
/// What the avoider adds to the edge of the unfeasible region, degrees.
const EDGE: f64 = 0.5;
/// Yaw rate and radians have a step of 1.5e-5, sines an error of 2e-5: well below a hundredth of a degree.
const ROUNDING: f64 = 0.01;

fn metres(x: f64) -> Metres {
    Metres::new(I16F16::from_num(x))
}

fn avoider(tables: CoarseSet, speed_input: SpeedInput) -> Avoider {
    Avoider {
        tables,
        speed_input,
        range: metres(2.0),
        margin: metres(MARGIN),
        // A turn of 1 rad is a yaw rate of 1 rad/s: the command can be read back.
        deflection_rate: I16F16::ONE,
        overshoot: Angle::deg("20"),
    }
}

fn limits() -> Limits {
    Limits {
        speed: MetresPerSecond::lit("1"),
        yaw_rate: I16F16::lit("100"),
        acceleration: I16F16::lit("100"),
        yaw_acceleration: I16F16::lit("100"),
        wheel_speed: MetresPerSecond::lit("100"),
    }
}

/// Bearing in degrees, distance to the centre, radius.
fn obstacle(bearing: f64, distance: f64, radius: f64) -> Obstacle {
    let (sin, cos) = bearing.to_radians().sin_cos();
    Obstacle {
        centre: Point::new(metres(distance * cos), metres(distance * sin)),
        radius: metres(radius),
        residual: Metres::ZERO,
        echoes: 7,
    }
}

fn sensed(obstacles: &[Obstacle]) -> Sensed {
    let mut sensed = Sensed::default();
    for o in obstacles {
        sensed.obstacles.push(*o).unwrap();
    }
    sensed
}

fn run(settings: &Avoider, side: Turn, held: &Obstacle, others: &[Obstacle]) -> Behaviour {
    avoid(
        settings,
        &limits(),
        metres(ROBOT),
        &sensed(others),
        side,
        held,
        held.sight(metres(ROBOT) + settings.margin),
    )
}

/// The commanded turn in degrees, left positive.
fn turn(behaviour: &Behaviour) -> f64 {
    behaviour.twist.angular.get().to_num::<f64>().to_degrees()
}

fn wrap(degrees: f64) -> f64 {
    (degrees + 180.0).rem_euclid(360.0) - 180.0
}

/// β/2 in degrees, from the numbers as the library stores them.
fn half_angle(o: &Obstacle) -> f64 {
    let reach = (o.radius + metres(ROBOT) + metres(MARGIN))
        .get()
        .to_num::<f64>();
    let (x, y): (f64, f64) = (o.centre.x.get().to_num(), o.centre.y.get().to_num());
    let distance = x.hypot(y);
    if distance <= reach {
        90.0
    } else {
        (reach / distance).asin().to_degrees()
    }
}

fn bearing(o: &Obstacle) -> f64 {
    let (x, y): (f64, f64) = (o.centre.x.get().to_num(), o.centre.y.get().to_num());
    y.atan2(x).to_degrees()
}

/// The obstacle's bearing after the turn, positive on the side where it belongs: θ + Δθ in the chapter's words.
fn after(side: Turn, o: &Obstacle, turn: f64) -> f64 {
    let bearing = wrap(bearing(o) - turn);
    match side {
        Turn::Right => bearing,
        Turn::Left => -bearing,
    }
}

fn deflection(behaviour: &Behaviour) -> f64 {
    I8F8::from_bits(behaviour.trace.deflection_output).to_num()
}

fn any_side() -> impl Strategy<Value = Turn> {
    prop_oneof![Just(Turn::Left), Just(Turn::Right)]
}

fn any_settings() -> impl Strategy<Value = Avoider> {
    (
        prop_oneof![Just(CoarseSet::Corrected), Just(CoarseSet::Printed)],
        prop_oneof![Just(SpeedInput::Deflection), Just(SpeedInput::Bearing)],
    )
        .prop_map(|(tables, input)| avoider(tables, input))
}

fn config(cases: u32) -> ProptestConfig {
    ProptestConfig {
        cases,
        failure_persistence: None,
        ..ProptestConfig::default()
    }
}

proptest! {
    #![proptest_config(config(20_000))]

    #[test]
    fn the_next_heading_is_outside_the_unfeasible_region(
        settings in any_settings(),
        side in any_side(),
        at in -180.0..180.0f64,
        distance in prop_oneof![0.0..0.5f64, 0.0..4.0f64],
        radius in prop_oneof![Just(0.0), 0.0..2.0f64],
    ) {
        let held = obstacle(at, distance, radius);
        let half = half_angle(&held);
        for others in [&[][..], &[held]] {
            let turn = turn(&run(&settings, side, &held, others));
            let theta = after(side, &held, turn);
            prop_assert!(theta > half, "{theta} <= {half}");
            // Nor farther than the tables are allowed to overshoot: half of "any direction" would pass, too.
            // At its rim the half angle is as sensitive as a square root: a step of distance is most of a degree.
            prop_assert!(theta <= half + EDGE + 20.0 + 1.0, "{theta}, {half}");
        }
    }

    #[test]
    fn an_obstacle_in_the_way_is_turned_away_from(
        settings in any_settings(),
        side in any_side(),
        share in -0.98..0.98f64,
        distance in 0.3..2.0f64,
        radius in 0.0..1.0f64,
    ) {
        let half = half_angle(&obstacle(0.0, distance, radius));
        let held = obstacle(share * half, distance, radius);
        let angular = run(&settings, side, &held, &[held]).twist.angular.bits();
        match side {
            Turn::Right => prop_assert!(angular < 0),
            Turn::Left => prop_assert!(angular > 0),
        }
    }

    #[test]
    fn left_is_right_in_a_mirror(
        settings in any_settings(),
        at in -179.0..179.0f64,
        distance in 0.0..3.0f64,
        radius in 0.0..1.0f64,
    ) {
        let held = obstacle(at, distance, radius);
        let mut image = held;
        image.centre.y = -held.centre.y;
        let right = run(&settings, Turn::Right, &held, &[held]);
        let left = run(&settings, Turn::Left, &image, &[image]);
        // But for the last bits: the direction of a vector is not rounded alike on both sides.
        let apart = |a: i32, b: i32| (a - b).abs();
        prop_assert!(apart(right.twist.linear.bits(), left.twist.linear.bits()) < 33);
        prop_assert!(wrap(turn(&right) + turn(&left)).abs() < ROUNDING);
        prop_assert!(apart(right.trace.deflection_output.into(), left.trace.deflection_output.into()) < 9);
    }

    /// Nearest first, as the sensors list them; the one held is among them.
    #[test]
    fn the_next_heading_clears_every_near_obstacle(
        settings in any_settings(),
        side in any_side(),
        discs in prop::collection::vec((-180.0..180.0f64, 0.35..2.4f64, 0.02..0.4f64), 1..=8),
        which in any::<prop::sample::Index>(),
    ) {
        let mut all: Vec<Obstacle> = discs.iter().map(|d| obstacle(d.0, d.1, d.2)).collect();
        all.sort_by_key(|o| o.centre.norm() - o.radius);
        let held = all[which.index(all.len())];
        let size = |m: Metres| m.get().to_num::<f64>();
        // Those near enough to matter: within range, and not behind the one held; `by` is for the rounding of both.
        let near = |by: f64| {
            all.iter().filter(move |o| {
                let surface = size(o.centre.norm()) - size(o.radius);
                surface - ROBOT < 2.0 + by && surface < size(held.centre.norm()) + size(held.radius) + by
            })
        };
        let clear = |direction: f64, by: f64, edge: f64| {
            near(edge).all(|o| wrap(bearing(o) - direction).abs() >= half_angle(o) + by)
        };
        // Surrounded, there is nothing to ask for.
        let free = (0..3600).any(|i| clear(f64::from(i) * 0.1 - 180.0, 2.0 * EDGE + 0.1, 0.001));
        if free {
            let turn = turn(&run(&settings, side, &held, &all));
            prop_assert!(clear(turn, -ROUNDING, -0.001), "{turn}");
        }
    }
}

#[test]
fn signs() {
    // Obstacle on the left: turn right, negative yaw, positive Δθ; and the other way round.
    let settings = avoider(CoarseSet::Corrected, SpeedInput::Deflection);
    for (at, side, sign) in [
        (15.0, Turn::Right, -1.0),
        (-15.0, Turn::Left, 1.0),
        (0.0, Turn::Right, -1.0),
    ] {
        let held = obstacle(at, 0.6, 0.2);
        let out = run(&settings, side, &held, &[held]);
        assert!(turn(&out) * sign > 10.0, "{at}: {}", turn(&out));
        assert!(deflection(&out) > 0.0);
        // θ is the bearing, mirrored when the committed side is left.
        assert_eq!(out.trace.controller, Controller::Coarse);
        let theta = f64::from(out.trace.angle_input) / 65_536.0;
        assert!((theta - at.abs()).abs() < 0.01, "{theta}");
    }
}

#[test]
fn the_trace_holds_what_the_tables_were_asked() {
    let settings = avoider(CoarseSet::Corrected, SpeedInput::Deflection);
    let held = obstacle(30.0, 1.3, 0.2);
    let out = run(&settings, Turn::Right, &held, &[held]);
    // Free distance 1.0 of 2 m: half of the s axis, row M alone. Columns Z and R at 2/3 and 1/3.
    assert!((f64::from(out.trace.distance_input) / 65_536.0 - 0.5).abs() < 1e-4);
    assert!((deflection(&out) - 60.0).abs() < 0.05);
    assert_eq!(out, run(&settings, Turn::Right, &held, &[held]));
}

#[test]
fn table_7_3_as_printed_turns_into_the_obstacle_until_the_constraint() {
    // Near and well to the left: cell (N, R) says L as printed.
    let held = obstacle(60.0, 0.45, 0.2);
    let half = half_angle(&held);
    for input in [SpeedInput::Deflection, SpeedInput::Bearing] {
        let printed = run(
            &avoider(CoarseSet::Printed, input),
            Turn::Right,
            &held,
            &[held],
        );
        let corrected = run(
            &avoider(CoarseSet::Corrected, input),
            Turn::Right,
            &held,
            &[held],
        );
        assert!(deflection(&printed) < 0.0, "{}", deflection(&printed));
        assert!(deflection(&corrected) > 0.0);
        // The fuzzy output alone heads into it…
        assert!(60.0 + deflection(&printed) < half);
        assert!(60.0 + deflection(&corrected) > half);
        // …the command does not.
        for out in [printed, corrected] {
            assert!(after(Turn::Right, &held, turn(&out)) > half);
        }
    }
}

#[test]
fn the_constraint_corrects_more_often_than_once() {
    // How much of the near field the fuzzy output alone gets wrong, and that nothing of it is left.
    let count = |tables| {
        let settings = avoider(tables, SpeedInput::Deflection);
        let mut wrong = 0;
        let mut all = 0;
        for at in -80..=80 {
            for distance in [0.45, 0.6, 0.9, 1.3, 1.9] {
                let held = obstacle(f64::from(at), distance, 0.2);
                let out = run(&settings, Turn::Right, &held, &[held]);
                let half = half_angle(&held);
                all += 1;
                wrong += i32::from(f64::from(at) + deflection(&out) < half);
                assert!(after(Turn::Right, &held, turn(&out)) > half);
            }
        }
        (wrong, all)
    };
    let (printed, all) = count(CoarseSet::Printed);
    let (corrected, _) = count(CoarseSet::Corrected);
    println!("unfeasible by the tables alone: printed {printed}, corrected {corrected} of {all}");
    assert!(corrected > 0 && printed > corrected + all / 50);
}

#[test]
fn an_obstacle_beside_the_held_one_is_cleared_too() {
    // A wall of three discs to the right of the held one: passing right means passing all of them.
    let settings = avoider(CoarseSet::Corrected, SpeedInput::Deflection);
    let held = obstacle(5.0, 0.7, 0.15);
    let wall = [
        held,
        obstacle(-30.0, 0.75, 0.15),
        obstacle(-65.0, 0.8, 0.15),
    ];
    let alone = turn(&run(&settings, Turn::Right, &held, &[held]));
    let together = turn(&run(&settings, Turn::Right, &held, &wall));
    assert!(alone > -60.0 && together < -85.0, "{alone} {together}");
    // One behind the held one does not matter yet.
    let behind = [held, obstacle(-30.0, 1.6, 0.15)];
    let unmoved = turn(&run(&settings, Turn::Right, &held, &behind));
    assert!((unmoved - alone).abs() < ROUNDING);
}

#[test]
fn speed_falls_with_the_distance_and_never_exceeds_the_limit() {
    let settings = avoider(CoarseSet::Corrected, SpeedInput::Deflection);
    let at = |distance: f64| {
        let held = obstacle(60.0, distance, 0.2);
        let linear = run(&settings, Turn::Right, &held, &[held]).twist.linear;
        linear.get().to_num::<f64>()
    };
    let speeds: Vec<f64> = (3..25).map(|i| at(0.1 * f64::from(i))).collect();
    assert!(
        speeds.iter().all(|v| (0.33..=1.0).contains(v)),
        "{speeds:?}"
    );
    assert!(speeds[0] < 0.34 && speeds[21] > 0.66, "{speeds:?}");
}

#[test]
fn inside_the_grown_circle_the_half_angle_is_a_quarter_turn() {
    let grown = metres(ROBOT + MARGIN);
    for (distance, quarter) in [(0.0, true), (0.37, true), (0.39, false)] {
        let half = obstacle(10.0, distance, 0.2).unfeasible_half_angle(grown);
        assert_eq!(half == Angle::QUARTER, quarter, "{distance}");
    }
}

#[test]
fn the_edge_is_half_an_angle_beside_the_bearing() {
    let grown = metres(ROBOT + MARGIN);
    for at in -18..18 {
        for (distance, radius) in [
            (0.25, 0.01),
            (0.5, 0.2),
            (1.3, 0.4),
            (30.0, 2.0),
            (9000.0, 10.0),
        ] {
            let obstacle = obstacle(f64::from(at) * 10.0 + 3.0, distance, radius);
            let half = half_angle(&obstacle);
            for (turn, sign) in [(Turn::Left, 1.0), (Turn::Right, -1.0)] {
                let edge = obstacle.unfeasible_edge(grown, turn);
                let degrees = f64::from(edge.angle().bits()) * 360.0 / 4_294_967_296.0;
                let apart = wrap(degrees - bearing(&obstacle) - sign * half);
                assert!(apart.abs() < ROUNDING, "{at}, {distance}: {apart}");
                // As long as one: a metre along itself is a metre.
                let along = edge.along(edge.ahead(metres(1.0)));
                let squared: f64 = along.get().to_num();
                assert!((squared - 1.0).abs() < 1.0 / 4096.0, "{squared}");
            }
        }
    }
    // Inside the grown circle it is across.
    let inside = obstacle(40.0, 0.2, 0.2);
    for (turn, across) in [(Turn::Left, 130.0), (Turn::Right, -50.0)] {
        let edge = inside.unfeasible_edge(grown, turn).angle();
        let degrees = f64::from(edge.bits()) * 360.0 / 4_294_967_296.0;
        assert!((degrees - across).abs() < ROUNDING, "{degrees}");
    }
}

#[test]
fn any_overshoot_that_checked_allows_keeps_the_constraint() {
    for degrees in ["0", "60", "90", "120", "150", "179"] {
        let settings = Avoider {
            overshoot: Angle::deg(degrees),
            ..avoider(CoarseSet::Corrected, SpeedInput::Deflection)
        };
        // Out of sight this tick: what is in sight is checked a second time, and mended there.
        for at in [-20.0, 0.0, 20.0, 60.0] {
            let held = obstacle(at, 0.45, 0.2);
            let theta = after(
                Turn::Right,
                &held,
                turn(&run(&settings, Turn::Right, &held, &[])),
            );
            assert!(
                theta > half_angle(&held),
                "overshoot {degrees}: heads {theta} degrees beside the centre of an obstacle at {at}"
            );
        }
    }
}

fn extreme() -> impl Strategy<Value = Metres> {
    prop_oneof![
        prop::sample::select(vec![
            i32::MIN,
            i32::MIN + 1,
            -1,
            0,
            1,
            i32::MAX - 1,
            i32::MAX
        ]),
        any::<i32>(),
        -200_000..200_000i32,
    ]
    .prop_map(Metres::from_bits)
}

fn any_obstacle() -> impl Strategy<Value = Obstacle> {
    (extreme(), extreme(), extreme(), any::<u8>()).prop_map(|(x, y, radius, echoes)| Obstacle {
        centre: Point::new(x, y),
        radius,
        residual: Metres::ZERO,
        echoes,
    })
}

proptest! {
    #![proptest_config(config(5_000))]

    #[test]
    fn extremes_never_panic(
        base in any_settings(),
        side in any_side(),
        held in any_obstacle(),
        others in prop::collection::vec(any_obstacle(), 0..=8),
        robot in extreme(),
        range in extreme(),
        margin in extreme(),
        overshoot in any::<i32>(),
        rate in any::<i32>(),
        speed in any::<i32>(),
    ) {
        let settings = Avoider {
            range,
            margin,
            overshoot: Angle::from_bits(overshoot),
            deflection_rate: I16F16::from_bits(rate),
            ..base
        };
        let limits = Limits { speed: MetresPerSecond::from_bits(speed), ..limits() };
        let sight = held.sight(robot + settings.margin);
        let _ = avoid(&settings, &limits, robot, &sensed(&others), side, &held, sight);
    }
}
