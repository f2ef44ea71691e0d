//! Paths and the cursor on them: what is refused, lengths and places against f64, and a cursor that neither goes back
//! nor jumps.

use core::f64::consts::{PI, TAU};
use fixed::types::I16F16;
use fuzzypilot::geometry::{Point, Pose};
use fuzzypilot::guide::{
    Bends, Cursor, Fix, MAX_PIECES, Path, PathError, Segment, StoreError, StoredPath, Waypoint,
};
use fuzzypilot::units::{Angle, Metres, MetresPerSecond, PerMetre};
use proptest::prelude::*;

const STEP: f64 = 1.0 / 65_536.0;

fn metres(x: f64) -> Metres {
    Metres::new(I16F16::from_num(x))
}

fn f(m: Metres) -> f64 {
    m.get().to_num()
}

fn point(x: f64, y: f64) -> Point {
    Point::new(metres(x), metres(y))
}

fn angle(radians: f64) -> Angle {
    Angle::from_bits((radians.rem_euclid(TAU) / TAU * 4_294_967_296.0) as i64 as i32)
}

fn radians(a: Angle) -> f64 {
    f64::from(a.bits()) / 4_294_967_296.0 * TAU
}

fn pose(x: f64, y: f64, heading: f64) -> Pose {
    Pose::new(point(x, y), angle(heading))
}

/// Distance of a place from (x, y).
fn miss(p: Point, (x, y): (f64, f64)) -> f64 {
    (f(p.x) - x).hypot(f(p.y) - y)
}

/// Difference of two directions, the short way round.
fn off(a: f64, b: f64) -> f64 {
    let d = (a - b).rem_euclid(TAU);
    d.min(TAU - d)
}

fn line(x: f64, y: f64, heading: f64, length: f64) -> Segment {
    Segment::line(pose(x, y, heading), metres(length))
}

fn arc(x: f64, y: f64, radius: f64, from: f64, degrees: f64) -> Segment {
    Segment::arc(
        point(x, y),
        metres(radius),
        angle(from),
        I16F16::from_num(degrees),
    )
}

/// Points with tangents on a circle about the origin from angle 0, `turn` 1 counter-clockwise or −1 clockwise.
fn circle_points(radius: f64, n: usize, spacing: f64, turn: f64) -> Vec<Waypoint> {
    (0..n)
        .map(|i| {
            let at = turn * i as f64 * spacing / radius;
            pose(radius * at.cos(), radius * at.sin(), at + turn * PI / 2.0)
        })
        .collect()
}

#[test]
fn too_short() {
    assert_eq!(Path::points(&[], false), Err(PathError::TooShort));
    assert_eq!(
        Path::points(&[pose(0.0, 0.0, 0.0)], true),
        Err(PathError::TooShort)
    );
    assert_eq!(Path::segments(&[], true), Err(PathError::TooShort));
    assert_eq!(
        Path::segments_with_gaps(&[], false),
        Err(PathError::TooShort)
    );
}

#[test]
fn too_many() {
    let points: Vec<_> = (0..MAX_PIECES + 2)
        .map(|i| pose(i as f64 * 0.01, 0.0, 0.0))
        .collect();
    assert_eq!(Path::points(&points, false), Err(PathError::TooMany));
    assert_eq!(Path::points(&points[1..], true), Err(PathError::TooMany));
    assert_eq!(
        Path::points(&points[1..], false).unwrap().count(),
        MAX_PIECES
    );
    assert_eq!(
        Path::points(&points[2..], true).unwrap().count(),
        MAX_PIECES
    );
    let segments = vec![line(0.0, 0.0, 0.0, 0.01); MAX_PIECES + 1];
    assert_eq!(Path::segments(&segments, false), Err(PathError::TooMany));
    assert!(Path::segments(&segments[1..], false).is_ok());
}

#[test]
fn degenerate() {
    let here = pose(1.0, 1.0, 0.0);
    let points = [pose(0.0, 0.0, 0.0), here, here];
    assert_eq!(Path::points(&points, false), Err(PathError::Degenerate(1)));
    // A closed path that repeats its first point at its end.
    let points = [here, pose(2.0, 1.0, 0.0), here];
    assert!(Path::points(&points, false).is_ok());
    assert_eq!(Path::points(&points, true), Err(PathError::Degenerate(2)));

    let sound = line(0.0, 0.0, 0.0, 1.0);
    let raw = |radius: Metres, sweep| Segment::Arc {
        centre: point(0.0, 0.0),
        radius,
        from: Angle::ZERO,
        sweep,
    };
    for bad in [
        line(1.0, 0.0, 0.0, 0.0),
        line(1.0, 0.0, 0.0, -1.0),
        arc(0.0, 0.0, 0.0, 0.0, 90.0),
        arc(0.0, 0.0, -1.0, 0.0, 90.0),
        arc(0.0, 0.0, 1.0, 0.0, 0.0),
        raw(Metres::from_bits(1), 1),
        raw(Metres::from_bits(i32::MIN), i32::MIN),
    ] {
        let segments = [sound, bad];
        assert_eq!(
            Path::segments_with_gaps(&segments, false),
            Err(PathError::Degenerate(1))
        );
        assert_eq!(
            Path::segments(&segments, true),
            Err(PathError::Degenerate(1))
        );
    }
}

#[test]
fn a_sweep_beyond_one_turn_is_refused() {
    for sweep in [(1 << 24) + 1, 1 << 26, i32::MAX, i32::MIN] {
        let segments = [Segment::Arc {
            centre: point(0.0, 0.0),
            radius: metres(1000.0),
            from: Angle::ZERO,
            sweep,
        }];
        let path = Path::segments_with_gaps(&segments, false);
        assert_eq!(path, Err(PathError::Degenerate(0)), "{sweep}");
    }
}

#[test]
fn an_unsound_segment_has_a_curvature() {
    let segment = Segment::Arc {
        centre: point(0.0, 0.0),
        radius: Metres::from_bits(-1),
        from: Angle::ZERO,
        sweep: -1,
    };
    let _ = segment.curvature();
}

#[test]
fn gaps() {
    let tight = [line(0.0, 0.0, 0.0, 1.0), line(1.04, 0.0, 1.0, 1.0)];
    assert!(Path::segments(&tight, false).is_ok());
    let wide = [line(0.0, 0.0, 0.0, 1.0), line(1.06, 0.0, 1.0, 1.0)];
    assert_eq!(Path::segments(&wide, false), Err(PathError::Gap(1)));
    assert!(Path::segments_with_gaps(&wide, false).is_ok());
    // Open it is sound, closed the last does not meet the first.
    assert_eq!(Path::segments(&tight, true), Err(PathError::Gap(0)));
    let circle = [arc(0.0, 0.0, 8.0, 0.3, 360.0)];
    assert!(Path::segments(&circle, true).is_ok());
    for error in [
        PathError::TooShort,
        PathError::TooMany,
        PathError::Degenerate(3),
        PathError::Gap(7),
    ] {
        assert!(!error.to_string().is_empty());
    }
}

#[test]
fn lengths() {
    let mut worst = 0.0f64;
    for radius in [0.01, 0.3, 1.0, 8.0, 250.0, 5000.0] {
        for degrees in [-360.0, -90.0, -0.5, 1.0, 45.0, 180.0, 359.0, 360.0] {
            let length = f(arc(1.0, 2.0, radius, 0.4, degrees).length());
            let exact = f(metres(radius)) * f64::abs(degrees).to_radians();
            // The sweep's step is a 2^24th of a turn: what it makes at the radius, and two steps of length.
            let bound = 2.0 * STEP + radius * TAU / f64::from(1 << 24) + exact * 1e-7;
            assert!(
                (length - exact).abs() < bound,
                "{radius} {degrees}: {length} {exact}"
            );
            worst = worst.max((length - exact).abs() / bound);
        }
    }
    assert!(worst > 0.2);
    // More than a turn counts as one; the largest radius does not wrap.
    assert_eq!(
        arc(0.0, 0.0, 1.0, 0.0, 4000.0).length(),
        arc(0.0, 0.0, 1.0, 0.0, 360.0).length()
    );
    assert_eq!(arc(0.0, 0.0, 32_767.0, 0.0, 360.0).length(), Metres::MAX);
    assert_eq!(line(0.0, 0.0, 0.0, 3.25).length(), metres(3.25));

    let points = circle_points(8.0, 100, 0.25, 1.0);
    let path = Path::points(&points, false).unwrap();
    let chord = 16.0 * (0.25f64 / 16.0).sin();
    // Every chord is rounded down to a step, from ends rounded to one.
    assert!((f(path.length()) - 99.0 * chord).abs() < 99.0 * 1.5 * STEP);
    let closed = Path::points(&points, true).unwrap();
    assert_eq!((path.count(), closed.count()), (99, 100));
    assert!(closed.is_closed() && !path.is_closed());
    let across = 16.0 * (99.0f64 * 0.25 / 16.0).sin().abs();
    assert!((f(closed.length()) - f(path.length()) - across).abs() < 2.0 * STEP);

    let square: Vec<_> = (0..4)
        .map(|i| {
            let (x, y) = [(0.0, 0.0), (2.0, 0.0), (2.0, 2.0), (0.0, 2.0)][i];
            line(x, y, i as f64 * PI / 2.0, 2.0)
        })
        .collect();
    assert_eq!(Path::segments(&square, true).unwrap().length(), metres(8.0));
    // A path longer than the format saturates.
    let long = vec![line(0.0, 0.0, 0.0, 30_000.0); 3];
    assert_eq!(
        Path::segments_with_gaps(&long, false).unwrap().length(),
        Metres::MAX
    );
}

#[test]
fn places_on_lines_and_arcs() {
    let mut share = 0.0f64;
    for (radius, from, degrees) in [
        (8.0, 1.0, 180.0),
        (8.0, -2.0, -180.0),
        (0.5, 0.0, 360.0),
        (0.5, 3.0, -360.0),
        (40.0, 0.1, 17.0),
        (2.0, -3.1, -301.0),
    ] {
        let segment = arc(3.0, -4.0, radius, from, degrees);
        let length = radius * f64::abs(degrees).to_radians();
        for i in 0..=200 {
            let along = length * f64::from(i) / 200.0;
            let got = segment.at(metres(along));
            let turned = from + f64::signum(degrees) * along / radius;
            let place = (3.0 + radius * turned.cos(), -4.0 + radius * turned.sin());
            // 2e-5 of the radius from cosine and sine, two steps from rounding place and length.
            let bound = 2.4e-5 * radius + 2.0 * STEP;
            assert!(miss(got.at, place) < bound);
            share = share.max(miss(got.at, place) / bound);
            let tangent = turned + f64::signum(degrees) * PI / 2.0;
            assert!(off(radians(got.heading), tangent) < 1.5 * STEP / radius + 1e-6);
        }
        let curvature = f64::from(segment.curvature().get());
        assert!((curvature - f64::signum(degrees) / radius).abs() <= STEP);
        let (last, end) = (segment.at(Metres::MAX), segment.end());
        assert!(f((last.at - end.at).norm()) < 3.0 * STEP + 4e-5 * radius);
        assert!(off(radians(last.heading), radians(end.heading)) < 1.5 * STEP / radius + 1e-6);
        let exact = from + degrees.to_radians();
        let place = (3.0 + radius * exact.cos(), -4.0 + radius * exact.sin());
        assert!(miss(end.at, place) < 2.4e-5 * radius + 1.5 * STEP);
        // Limited at both ends.
        assert_eq!(segment.at(metres(-1.0)), segment.start());
    }
    assert!(share > 0.5, "{share}");

    let segment = line(1.0, 2.0, 0.7, 3.0);
    for along in [-1.0, 0.0, 0.4, 2.9, 3.0, 50.0] {
        let reached = f64::clamp(along, 0.0, 3.0);
        let got = segment.at(metres(along));
        let place = (1.0 + reached * 0.7f64.cos(), 2.0 + reached * 0.7f64.sin());
        assert!(miss(got.at, place) < 2.4e-5 * 3.0 + STEP);
        assert_eq!(got.heading, angle(0.7));
    }
    assert_eq!(segment.end(), segment.at(metres(3.0)));
    assert_eq!(segment.curvature(), PerMetre::ZERO);
}

/// Path length driven, laps included.
fn total(path: &Path<'_>, fix: &Fix) -> f64 {
    f64::from(fix.laps) * f(path.length()) + f(fix.progress)
}

#[test]
fn a_cursor_follows_a_line() {
    let segments = [line(0.0, 0.0, 0.0, 2.0), line(2.0, 0.0, 0.0, 3.0)];
    let path = Path::segments(&segments, false).unwrap();
    let mut cursor = Cursor::default();
    for i in 0..=60 {
        let x = f64::from(i) * 0.1 - 0.5;
        let fix = cursor.advance(&path, point(x, 0.25), metres(0.5));
        let foot = x.clamp(0.0, 5.0);
        // The lines' directions are exact here; their cosine is short by 1.3e-5.
        assert!((f(fix.progress) - foot).abs() < 2e-4, "{x}: {fix:?}");
        assert!((f(fix.remaining) - (5.0 - foot)).abs() < 2e-4);
        assert!((f(fix.cross_track) - 0.25).abs() < 1e-4);
        assert!((f(fix.distance) - 0.25f64.hypot(x - foot)).abs() < 3e-4);
        assert!(miss(fix.foot.at, (foot, 0.0)) < 3e-4);
        assert_eq!(fix.laps, 0);
    }
}

#[test]
fn the_next_corner_is_seen_within_reach_and_skipped_to() {
    let segments = [
        line(0.0, 0.0, 0.0, 2.0),
        // 10 degrees are a bend, not a corner.
        line(2.0, 0.0, 10.0f64.to_radians(), 1.0),
        line(2.9848, 0.1736, -80.0f64.to_radians(), 3.0),
    ];
    let path = Path::segments(&segments, false).unwrap();
    let mut cursor = Cursor::default();
    cursor.advance(&path, point(0.5, 0.0), metres(1.0));
    let mut bends = Bends::new();
    bends.follow(&path, &cursor, metres(2.51));
    assert_eq!(bends.corner(&cursor, metres(2.49)), None);
    let (way, jump) = bends.corner(&cursor, metres(2.51)).unwrap();
    assert!((f(way) - 2.5).abs() < 1e-3, "{way:?}");
    let quarter = Angle::QUARTER.bits();
    assert!(
        (jump + Angle::QUARTER).abs().bits() < quarter / 10_000,
        "{jump:?}"
    );
    cursor.skip(&path, way);
    // Behind it, where no other one is.
    bends.follow(&path, &cursor, metres(100.0));
    assert_eq!(bends.corner(&cursor, metres(100.0)), None);
    let fix = cursor.advance(&path, point(2.9848, 0.1736), metres(0.0));
    assert!((f(fix.progress) - 3.0).abs() < 1e-3, "{fix:?}");
    // Not beyond an open path's end.
    cursor.skip(&path, metres(100.0));
    let fix = cursor.advance(&path, point(0.0, 0.0), metres(0.0));
    assert_eq!(fix.remaining, Metres::ZERO);
}

#[test]
fn a_cursor_never_goes_back_and_never_beyond_its_reach() {
    let points = circle_points(3.0, 60, 0.25, 1.0);
    let segments = [
        line(0.0, 0.0, 0.0, 2.0),
        arc(2.0, 1.0, 1.0, -PI / 2.0, 180.0),
        line(2.0, 2.0, PI, 2.0),
        arc(0.0, 1.0, 1.0, PI / 2.0, 180.0),
    ];
    let paths = [
        Path::points(&points, false).unwrap(),
        Path::points(&points, true).unwrap(),
        Path::segments(&segments, false).unwrap(),
        Path::segments(&segments, true).unwrap(),
    ];
    let mut seed = 1u64;
    let mut random = move || {
        seed = seed
            .wrapping_mul(6_364_136_223_846_793_005)
            .wrapping_add(1_442_695_040_888_963_407);
        (seed >> 33) as f64 / 2_147_483_648.0
    };
    for path in paths {
        let (mut moved, mut held, mut limited) = (0, 0, 0);
        for run in 0..40 {
            let mut cursor = Cursor::default();
            let reach = [0.0, 0.05, 0.3, 1.0][run % 4];
            let mut before = 0.0;
            for _ in 0..100 {
                let place = point(random() * 10.0 - 5.0, random() * 10.0 - 5.0);
                let fix = cursor.advance(&path, place, metres(reach));
                let now = total(&path, &fix);
                let ahead = now - before;
                assert!(
                    (-1e-9..=reach + 2.0 * STEP).contains(&ahead),
                    "{ahead} of {reach}"
                );
                moved += u32::from(ahead > 0.0);
                held += u32::from(ahead == 0.0);
                limited += u32::from(reach > 0.0 && ahead > reach - 2.0 * STEP);
                if !path.is_closed() {
                    assert!((f(fix.remaining) - (f(path.length()) - now)).abs() < 2.0 * STEP);
                } else {
                    assert_eq!(fix.remaining, Metres::MAX);
                }
                before = now;
            }
            // A negative reach counts as none.
            let fix = cursor.advance(&path, point(0.0, 0.0), metres(-1.0));
            assert_eq!(total(&path, &fix), before);
        }
        assert!(moved > 100 && held > 100 && limited > 100);
    }
}

#[test]
fn closed_paths_count_laps() {
    let one = [arc(0.0, 0.0, 3.0, 0.0, 360.0)];
    let backwards = [arc(0.0, 0.0, 3.0, 0.0, -360.0)];
    let four: Vec<_> = (0..4)
        .map(|i| arc(0.0, 0.0, 3.0, f64::from(i) * PI / 2.0, 90.0))
        .collect();
    let points = circle_points(3.0, 72, TAU * 3.0 / 72.0, 1.0);
    let paths = [
        (Path::segments(&one, true).unwrap(), 1.0),
        (Path::segments(&backwards, true).unwrap(), -1.0),
        (Path::segments(&four, true).unwrap(), 1.0),
        (Path::points(&points, true).unwrap(), 1.0),
    ];
    for (path, turn) in paths {
        let mut cursor = Cursor::default();
        for i in 0..1000 {
            // 1 cm outside, 1 % of a lap a tick.
            let lap = f64::from(i) / 100.0 + 0.001;
            let at = turn * lap * TAU;
            let place = point(3.01 * at.cos(), 3.01 * at.sin());
            let fix = cursor.advance(&path, place, metres(0.5));
            assert_eq!(f64::from(fix.laps), lap.floor(), "{i}");
            let expected = lap.fract() * f(path.length());
            assert!(
                (f(fix.progress) - expected).abs() < 0.01,
                "{i}: {fix:?} {expected}"
            );
            // Outside is right of a left turn, left of a right turn.
            assert!(
                (f(fix.cross_track) + turn * 0.01).abs() < 0.001,
                "{i}: {fix:?}"
            );
        }
    }
}

#[test]
fn a_full_circle_begun_before_its_start_holds_at_0() {
    for (degrees, turn) in [(360.0, 1.0), (-360.0, -1.0)] {
        for closed in [false, true] {
            let circle = [arc(0.0, 0.0, 2.0, 0.5, degrees)];
            let path = Path::segments(&circle, closed).unwrap();
            let mut cursor = Cursor::default();
            // From 20° before the start to 20° behind it.
            for step in -20..=20 {
                let before = turn * f64::from(step).to_radians();
                let place = point(2.0 * (0.5 + before).cos(), 2.0 * (0.5 + before).sin());
                let fix = cursor.advance(&path, place, metres(100.0));
                let expected = 2.0 * f64::from(step.max(0)).to_radians();
                assert_eq!(fix.laps, 0);
                assert!((f(fix.progress) - expected).abs() < 1e-4, "{step}: {fix:?}");
            }
        }
    }
}

#[test]
fn the_crossing_of_a_figure_eight_does_not_confuse() {
    // Gerono's lemniscate: through the origin twice a lap.
    let place = |t: f64| (4.0 * t.sin(), 4.0 * t.sin() * t.cos());
    let heading = |t: f64| (4.0 * (2.0 * t).cos()).atan2(4.0 * t.cos());
    let points: Vec<_> = (0..160)
        .map(|i| {
            let t = f64::from(i) * TAU / 160.0 + 0.01;
            pose(place(t).0, place(t).1, heading(t))
        })
        .collect();
    // The same figure of two circles that touch in the origin.
    let circles = [
        arc(2.0, 0.0, 2.0, PI, 360.0),
        arc(-2.0, 0.0, 2.0, 0.0, -360.0),
    ];
    let lemniscate = Path::points(&points, true).unwrap();
    let mut cursor = Cursor::default();
    let (mut worst, mut driven, mut at) = (0.0f64, 0.0, place(0.01));
    let start = at;
    for i in 0..4800 {
        let t = 0.01 + f64::from(i) * TAU / 1600.0;
        driven += (place(t).0 - at.0).hypot(place(t).1 - at.1);
        at = place(t);
        // A robot that weaves 8 cm to both sides.
        let side = 0.08 * (t * 9.0).sin();
        let robot = point(
            at.0 - side * heading(t).sin(),
            at.1 + side * heading(t).cos(),
        );
        let fix = cursor.advance(&lemniscate, robot, metres(0.3));
        // Only the lap's closing chord can differ from the driven length.
        worst = worst.max((total(&lemniscate, &fix) - driven).abs() / (1.0 + driven));
        assert!(
            (f(fix.cross_track) - side).abs() < 0.01,
            "{i}: {fix:?} {side}"
        );
    }
    println!("figure eight: progress within {worst:.4} of the length driven; start {start:?}");
    assert!(worst < 0.01);

    let path = Path::segments(&circles, true).unwrap();
    let mut cursor = Cursor::default();
    for i in 0..2000 {
        let lap = f64::from(i) / 1000.0 * 2.0;
        let (which, at) = ((lap as i64) % 2, lap.fract() * TAU);
        let (x, y) = if which == 0 {
            (2.0 + 2.0 * (PI + at).cos(), 2.0 * (PI + at).sin())
        } else {
            (-2.0 + 2.0 * (-at).cos(), 2.0 * (-at).sin())
        };
        let fix = cursor.advance(&path, point(x, y), metres(0.3));
        let expected = lap * TAU * 2.0;
        assert!(
            (total(&path, &fix) - expected).abs() < 0.002,
            "{i}: {fix:?} {expected}"
        );
        assert!(f(fix.distance) < 0.002);
    }
}

#[test]
fn points_on_an_arc_give_the_arc() {
    for turn in [1.0, -1.0] {
        // 0.25 m apart on a circle of 8 m: the chord alone would be off by 0.98 mm.
        let points = circle_points(8.0, 180, 0.25, turn);
        let path = Path::points(&points, false).unwrap();
        let mut worst = [0.0f64; 3];
        for (n, side) in [0.0, 0.3, -0.3].into_iter().enumerate() {
            let mut cursor = Cursor::default();
            for i in 0..1700 {
                let at = turn * f64::from(i) * 0.026 / 8.0;
                let radius = 8.0 + side;
                let place = point(radius * at.cos(), radius * at.sin());
                let fix = cursor.advance(&path, place, metres(0.5));
                let outside = -turn * side;
                worst[n] = worst[n].max((f(fix.cross_track) - outside).abs());
                let tangent = at + turn * PI / 2.0;
                // Beside the chord, foot and tangent belong to a place up to 4.7 mm away.
                assert!(off(radians(fix.foot.heading), tangent) < 8e-4);
            }
        }
        println!("discrete points: cross-track off by {worst:.6?} m at 0, ±0.3 m");
        assert!(worst[0] > 1e-5 && worst[0] < 2e-4);
        assert!(worst[1].max(worst[2]) < 1e-3);
    }
}

/// Pieces remembered from tick to tick say the same as those looked at anew.
#[test]
fn bends_ahead_are_what_the_cursor_sees() {
    // A wave of arcs between lines, 0.3 m a piece.
    let mut segments = Vec::new();
    let (mut x, mut y, mut heading) = (0.0f64, 0.0f64, 0.0f64);
    for number in 0..60 {
        if number % 3 == 2 {
            segments.push(line(x, y, heading, 0.3));
            (x, y) = (x + 0.3 * heading.cos(), y + 0.3 * heading.sin());
            continue;
        }
        let degrees = [34.0f64, -34.0, 17.0, -17.0][number % 4];
        let (side, radius) = (degrees.signum(), 0.3 / degrees.to_radians().abs());
        let centre = heading + side * PI / 2.0;
        let (cx, cy) = (x + radius * centre.cos(), y + radius * centre.sin());
        segments.push(arc(cx, cy, radius, centre + PI, degrees));
        heading += degrees.to_radians();
        let out = heading - side * PI / 2.0;
        (x, y) = (cx + radius * out.cos(), cy + radius * out.sin());
    }
    let path = Path::segments(&segments, false).unwrap();
    let mut cursor = Cursor::default();
    let mut bends = Bends::new();
    let mut changes = 0;
    for tick in 0..400 {
        bends.follow(&path, &cursor, metres(1.0));
        if tick > 2 {
            for lead in [0.0, 0.1, 0.25, 0.6, 0.95] {
                let lead = metres(lead);
                let got = bends.curvature(&path, &cursor, lead);
                let seen = cursor.curvature_ahead(&path, lead);
                // Where a piece begins either is right.
                let beside = cursor.curvature_ahead(&path, lead - metres(0.002));
                assert!(
                    got == seen || got == beside,
                    "{tick}, {lead:?}: {got:?}, {seen:?}"
                );
                changes += u32::from(got != cursor.curvature_ahead(&path, Metres::ZERO));
            }
        }
        cursor.skip(&path, metres(0.047));
    }
    assert!(changes > 500, "{changes}");
}

#[test]
fn curvature_ahead() {
    let segments = [
        line(0.0, 0.0, 0.0, 2.0),
        arc(2.0, 4.0, 4.0, -PI / 2.0, 90.0),
        arc(10.0, 4.0, 4.0, PI, -90.0),
    ];
    let quarter = TAU;
    let path = Path::segments(&segments, false).unwrap();
    let mut cursor = Cursor::default();
    let at = |cursor: &Cursor, path: &Path<'_>, lead: f64| {
        f64::from(cursor.curvature_ahead(path, metres(lead)).get())
    };
    for (lead, curvature) in [
        (-5.0, 0.0),
        (0.0, 0.0),
        (1.99, 0.0),
        (2.01, 0.25),
        (2.0 + quarter - 0.01, 0.25),
        (2.0 + quarter + 0.01, -0.25),
        (1000.0, -0.25),
    ] {
        assert_eq!(at(&cursor, &path, lead), curvature, "{lead}");
    }
    cursor.advance(&path, point(1.5, 0.0), metres(9.0));
    assert_eq!(at(&cursor, &path, 0.4), 0.0);
    assert_eq!(at(&cursor, &path, 0.6), 0.25);
    assert_eq!(
        cursor.curvature_ahead(&path, Metres::MAX).get(),
        I16F16::lit("-0.25")
    );

    // Closed: on from the last piece to the first.
    let oval = [
        line(0.0, 0.0, 0.0, 2.0),
        arc(2.0, 1.0, 1.0, -PI / 2.0, 180.0),
        line(2.0, 2.0, PI, 2.0),
        arc(0.0, 1.0, 1.0, PI / 2.0, 180.0),
    ];
    let path = Path::segments(&oval, true).unwrap();
    let cursor = Cursor::default();
    let lap = 4.0 + TAU;
    for (lead, curvature) in [(1.0, 0.0), (3.0, 1.0), (lap + 1.0, 0.0), (lap + 3.0, 1.0)] {
        assert_eq!(at(&cursor, &path, lead), curvature, "{lead}");
    }

    // Between points it is the turn of their tangents over the chord.
    let points = circle_points(8.0, 20, 0.25, -1.0);
    let path = Path::points(&points, false).unwrap();
    assert!((at(&Cursor::default(), &path, 1.0) + 0.125).abs() < 2e-4);
}

#[test]
fn speeds_that_the_path_allows() {
    let root = |squared: u64| (squared as f64 / 4_294_967_296.0).sqrt();
    let allowed = |path: &Path<'_>, x: f64| {
        let mut cursor = Cursor::default();
        cursor.advance(path, point(x, 0.0), metres(50.0));
        let (braking, lateral) = (I16F16::lit("0.5"), I16F16::lit("0.2"));
        root(cursor.speed_limit_squared(
            path,
            MetresPerSecond::lit("100"),
            braking,
            lateral,
            metres(0.1),
        ))
    };
    // To rest at an open end: v² = 2·a·s.
    let end = [line(0.0, 0.0, 0.0, 4.0)];
    let path = Path::segments(&end, false).unwrap();
    for x in [0.0, 1.0, 3.5, 3.9] {
        assert!((allowed(&path, x) - (2.0 * 0.5 * (4.0 - x)).sqrt()).abs() < 1e-3);
    }
    assert!(allowed(&path, 9.0) < 1e-9);
    // Into a bend: √(a_lat·r) at its start, more before it.
    let bend = [
        line(0.0, 0.0, 0.0, 4.0),
        arc(4.0, 2.0, 2.0, -PI / 2.0, 170.0),
        line(4.347, 3.970, 1.396_263 * 2.125, 60.0),
    ];
    let path = Path::segments_with_gaps(&bend, false).unwrap();
    for x in [0.0, 2.0, 3.9] {
        let exact = (0.2f64 * 2.0 + 2.0 * 0.5 * (4.0 - x)).sqrt();
        assert!((allowed(&path, x) - exact).abs() < 1e-3);
    }
    // A corner of 90°; one of 10° is none.
    for (degrees, corner) in [(90.0f64, true), (-20.0, true), (10.0, false)] {
        let lines = [
            line(0.0, 0.0, 0.0, 4.0),
            line(4.0, 0.0, degrees.to_radians(), 19.0),
        ];
        let path = Path::segments(&lines, false).unwrap();
        let to_end = (2.0 * 0.5 * 22.0f64).sqrt();
        let exact = if corner {
            (0.01 + 2.0 * 0.5 * 3.0f64).sqrt()
        } else {
            to_end
        };
        assert!((allowed(&path, 1.0) - exact).abs() < 1e-3, "{degrees}");
    }
}

/// A path that was made piece by piece: its segments, and what each asks for.
struct Route {
    segments: Vec<Segment>,
    /// Where each piece begins, and the square of the speed that it allows.
    pieces: Vec<(f64, f64)>,
    /// Whether there is a corner where each begins.
    corners: Vec<bool>,
    length: f64,
    closed: bool,
}

const LATERAL: f64 = 0.5;
const AT_CORNERS: f64 = 0.1;
const BRAKING: f64 = 0.5;

impl Route {
    /// Of (length, curvature, turn before it) each.
    fn new(parts: &[(f64, f64, f64)], closed: bool) -> Self {
        let mut route = Self {
            segments: Vec::new(),
            pieces: Vec::new(),
            corners: Vec::new(),
            length: 0.0,
            closed,
        };
        let (mut x, mut y, mut heading) = (0.0f64, 0.0f64, 0.0f64);
        let start = heading;
        for &(length, curvature, turn) in parts {
            heading += turn;
            route.corners.push(turn.abs() > 15f64.to_radians());
            let bend = if curvature == 0.0 {
                route.segments.push(line(x, y, heading, length));
                x += length * heading.cos();
                y += length * heading.sin();
                f64::INFINITY
            } else {
                let (radius, side) = (1.0 / curvature.abs(), curvature.signum());
                let from = heading - side * PI / 2.0;
                let (cx, cy) = (x - radius * from.cos(), y - radius * from.sin());
                let swept = length * curvature;
                route
                    .segments
                    .push(arc(cx, cy, radius, from, swept.to_degrees()));
                x = cx + radius * (from + swept).cos();
                y = cy + radius * (from + swept).sin();
                heading += swept;
                LATERAL * radius
            };
            route.pieces.push((route.length, bend));
            route.length += f(route.segments.last().unwrap().length());
        }
        // The first piece's corner is met when the path closes.
        route.corners[0] = off(start + parts[0].2, heading) > 15f64.to_radians();
        route
    }

    /// Square of the speed allowed at `here`, by walking all pieces as far as braking from 1 m/s reaches.
    fn allowed_squared(&self, here: f64) -> f64 {
        let mut limit = 1.0f64;
        let count = self.pieces.len();
        for k in 0.. {
            let (lap, i) = (k / count, k % count);
            let base = lap as f64 * self.length;
            let (start, bend) = (base + self.pieces[i].0, self.pieces[i].1);
            let end = base + self.pieces.get(i + 1).map_or(self.length, |next| next.0);
            if start - here > 1.1 {
                break;
            }
            let brake =
                |squared: f64, there: f64| squared + 2.0 * BRAKING * (there - here).max(0.0);
            if k > 0 && self.corners[i] && start > here {
                limit = limit.min(brake(AT_CORNERS * AT_CORNERS, start));
            }
            if end > here {
                limit = limit.min(brake(bend, start));
            }
            if !self.closed && i + 1 == count {
                return limit.min(brake(0.0, end));
            }
        }
        limit
    }

    /// Drives along for `ticks` steps of `step`, with what the cursor allows and what is allowed at each.
    fn drive(&self, step: f64, ticks: usize) -> Vec<(f64, f64)> {
        let path = Path::segments_with_gaps(&self.segments, self.closed).unwrap();
        let mut cursor = Cursor::default();
        let (mut lap, mut last) = (0.0, 0.0);
        (0..ticks)
            .map(|tick| {
                let at = (tick as f64 * step) % self.length;
                let i = self.pieces.partition_point(|piece| piece.0 <= at) - 1;
                let place = self.segments[i].at(metres(at - self.pieces[i].0)).at;
                let fix = cursor.advance(&path, place, metres(2.0 * step + 0.01));
                if f(fix.progress) < last {
                    lap += self.length;
                }
                last = f(fix.progress);
                let squared = cursor.speed_limit_squared(
                    &path,
                    MetresPerSecond::lit("1"),
                    I16F16::from_num(BRAKING),
                    I16F16::from_num(LATERAL),
                    metres(AT_CORNERS),
                );
                let squared = (squared as f64 / 4_294_967_296.0).min(1.0);
                (squared, self.allowed_squared(lap + last))
            })
            .collect()
    }
}

fn parts(least: f64, most: f64) -> impl Strategy<Value = Vec<(f64, f64, f64)>> {
    let curvature = prop_oneof![Just(0.0), 0.4..1.5f64, -1.5..-0.4f64];
    let turn = prop_oneof![3 => Just(0.0), 1 => 0.5..2.0f64, 1 => -2.0..-0.5f64, 1 => Just(0.1)];
    prop::collection::vec((least..most, curvature, turn), 1..=12)
}

proptest! {
    #![proptest_config(ProptestConfig { cases: 300, failure_persistence: None, ..ProptestConfig::default() })]

    /// Pieces are few enough here for the cursor to look at all that matters.
    #[test]
    fn the_speed_limit_is_that_of_walking_all_pieces(parts in parts(0.7, 2.5), closed in any::<bool>()) {
        let route = Route::new(&parts, closed);
        // Once past the end of an open path, nothing is asked any more.
        let ticks = if closed { 400 } else { ((route.length - 0.02) / 0.05) as usize };
        for (tick, (limit, exact)) in route.drive(0.05, ticks).into_iter().enumerate() {
            prop_assert!((limit - exact).abs() < 2e-3, "tick {tick}: {limit}, not {exact}");
        }
    }

    /// Where they are too many for it, the limit is lower, never higher, and it comes back.
    #[test]
    fn what_was_not_looked_at_may_be_an_end(parts in parts(0.03, 0.3), closed in any::<bool>()) {
        let route = Route::new(&parts, closed);
        let ticks = if closed { 200 } else { ((route.length - 0.02) / 0.02).max(0.0) as usize };
        for (tick, (limit, exact)) in route.drive(0.02, ticks).into_iter().enumerate() {
            prop_assert!(limit < exact + 2e-3, "tick {tick}: {limit}, above {exact}");
        }
    }
}

#[test]
fn a_circle_of_one_piece_allows_the_same_all_round() {
    let route = Route::new(&[(TAU * 0.8, 1.0 / 0.8, 0.0)], true);
    for (tick, (limit, _)) in route.drive(0.05, 600).into_iter().enumerate() {
        assert!((limit - LATERAL * 0.8).abs() < 1e-3, "{tick}: {limit}");
    }
}

#[test]
fn dense_points_do_not_hold_the_cursor_back() {
    // Points 1 cm apart, a robot at 2 m/s and 10 Hz: 20 cm a tick, of which the cursor makes good eight pieces.
    let points: Vec<_> = (0..2000)
        .map(|i| pose(f64::from(i) * 0.01, 0.0, 0.0))
        .collect();
    let path = Path::points(&points, false).unwrap();
    let mut cursor = Cursor::default();
    for i in 0..50 {
        let x = f64::from(i) * 0.2;
        let fix = cursor.advance(&path, point(x, 0.0), metres(1.0));
        assert!((f(fix.progress) - x).abs() < 0.02, "{i}: {fix:?}");
    }
}

fn raw() -> impl Strategy<Value = i32> {
    prop_oneof![
        any::<i32>(),
        prop::sample::select(vec![
            i32::MIN,
            i32::MIN + 1,
            -1,
            0,
            1,
            i32::MAX - 1,
            i32::MAX
        ]),
        -300_000..300_000i32,
    ]
}

fn raw_point() -> impl Strategy<Value = Point> {
    (raw(), raw()).prop_map(|(x, y)| Point::new(Metres::from_bits(x), Metres::from_bits(y)))
}

fn raw_pose() -> impl Strategy<Value = Pose> {
    (raw_point(), any::<i32>()).prop_map(|(at, turn)| Pose::new(at, Angle::from_bits(turn)))
}

fn raw_segment() -> impl Strategy<Value = Segment> {
    prop_oneof![
        (raw_pose(), raw()).prop_map(|(start, length)| Segment::Line {
            start,
            length: Metres::from_bits(length),
        }),
        (raw_point(), raw(), any::<i32>(), raw()).prop_map(|(centre, radius, from, sweep)| {
            Segment::Arc {
                centre,
                radius: Metres::from_bits(radius),
                from: Angle::from_bits(from),
                sweep,
            }
        }),
        (raw_point(), raw(), any::<i32>(), raw()).prop_map(|(centre, radius, from, degrees)| {
            Segment::arc(
                centre,
                Metres::from_bits(radius.saturating_abs()),
                Angle::from_bits(from),
                I16F16::from_bits(degrees),
            )
        }),
    ]
}

/// Drives a cursor over `places` and looks everywhere.
fn exercise(path: &Path<'_>, places: &[(Point, i32)]) -> Result<(), TestCaseError> {
    let mut cursor = Cursor::default();
    let mut before = (0u16, Metres::ZERO);
    let _ = path.start();
    for &(place, reach) in places {
        let fix = cursor.advance(path, place, Metres::from_bits(reach));
        prop_assert!((fix.laps, fix.progress) >= before);
        prop_assert!(fix.distance >= Metres::ZERO && fix.remaining >= Metres::ZERO);
        before = (fix.laps, fix.progress);
        let _ = cursor.curvature_ahead(path, Metres::from_bits(reach));
        let any = I16F16::from_bits(reach);
        let _ = cursor.speed_limit_squared(path, MetresPerSecond::new(any), any, any, place.x);
    }
    Ok(())
}

proptest! {
    #![proptest_config(ProptestConfig { cases: 1500, failure_persistence: None, ..ProptestConfig::default() })]

    #[test]
    fn any_segments_without_panic(
        segments in prop::collection::vec(raw_segment(), 0..12),
        closed in any::<bool>(),
        places in prop::collection::vec((raw_point(), raw()), 1..12),
    ) {
        for segment in &segments {
            let _ = (segment.length(), segment.start(), segment.end());
            // A radius below zero is no segment; see `an_unsound_segment_has_a_curvature`.
            if !matches!(segment, Segment::Arc { radius, .. } if *radius < Metres::ZERO) {
                let _ = segment.curvature();
            }
            for (_, along) in &places {
                let _ = segment.at(Metres::from_bits(*along));
            }
        }
        let _ = Path::segments(&segments, closed);
        let sound: Vec<_> = segments
            .into_iter()
            .filter(|s| Path::segments_with_gaps(core::slice::from_ref(s), closed).is_ok())
            .collect();
        if let Ok(path) = Path::segments_with_gaps(&sound, closed) {
            exercise(&path, &places)?;
        }
    }

    #[test]
    fn any_points_without_panic(
        points in prop::collection::vec(raw_pose(), 0..12),
        closed in any::<bool>(),
        places in prop::collection::vec((raw_point(), raw()), 1..12),
    ) {
        if let Ok(path) = Path::points(&points, closed) {
            exercise(&path, &places)?;
        }
    }

    /// A stored path is the borrowed one, refusals included, and a refused one is no path.
    #[test]
    fn a_stored_path_is_the_borrowed_one(
        segments in prop::collection::vec(raw_segment(), 0..4),
        points in prop::collection::vec(raw_pose(), 0..6),
        closed in any::<bool>(),
        gaps in any::<bool>(),
    ) {
        let mut store: StoredPath<4, 6> = StoredPath::new();
        store.begin_segments(closed);
        for segment in &segments {
            store.push_segment(*segment).unwrap();
        }
        let borrowed = match gaps {
            true => Path::segments_with_gaps(&segments, closed),
            false => Path::segments(&segments, closed),
        };
        prop_assert_eq!(store.commit(gaps), borrowed.map(|_| ()));
        prop_assert_eq!(store.path(), borrowed.ok());
        store.begin_points(closed);
        prop_assert_eq!(store.path(), None);
        for point in &points {
            store.push_point(*point).unwrap();
        }
        let borrowed = Path::points(&points, closed);
        prop_assert_eq!(store.commit(gaps), borrowed.map(|_| ()));
        prop_assert_eq!(store.path(), borrowed.ok());
        let mut other: StoredPath<1, 6> = StoredPath::new();
        if let Ok(path) = borrowed {
            prop_assert_eq!(other.copy(&path), Ok(()));
            prop_assert_eq!(other.path(), Some(path));
        }
    }
}

#[test]
fn a_store_says_what_it_cannot_take() {
    let line = Segment::line(Pose::default(), metres(1.0));
    let mut store: StoredPath<1, 2> = StoredPath::new();
    assert_eq!(store.commit(false), Err(PathError::TooShort));
    assert_eq!(
        store.push_point(Pose::default()),
        Err(StoreError::OtherForm)
    );
    store.push_segment(line).unwrap();
    store.commit(false).unwrap();
    assert!(store.path().is_some());
    // A piece too many changes the path that was checked: it is none any more.
    assert_eq!(store.push_segment(line), Err(StoreError::Full { most: 1 }));
    assert!(store.path().is_none());
    store.begin_points(true);
    assert_eq!(store.stored(), 0);
    assert_eq!(store.push_segment(line), Err(StoreError::OtherForm));
    let three = [
        pose(0.0, 0.0, 0.0),
        pose(1.0, 0.0, 0.0),
        pose(2.0, 0.0, 0.0),
    ];
    let path = Path::points(&three, false).unwrap();
    assert_eq!(store.copy(&path), Err(StoreError::Full { most: 2 }));
    assert!(store.path().is_none());
}
