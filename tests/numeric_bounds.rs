//! Error bounds of units, geometry and the circle fit, each measured against f64 and asserted on both sides, and what
//! happens at the ends of the number formats.

use core::f64::consts::{PI, TAU};
use fixed::types::{I2F30, I8F24, I16F16};
use fuzzypilot::geometry::{Point, Pose};
use fuzzypilot::sense::{CircleFit, fit_circle};
use fuzzypilot::units::{Angle, Metres, MetresPerSecond, PerMetre, RadiansPerSecond, Seconds};
use proptest::prelude::*;

const STEP: f64 = 1.0 / 65_536.0;
/// One step of an [`Angle`], radians.
const ANGLE_STEP: f64 = TAU / 4_294_967_296.0;

fn metres(x: f64) -> Metres {
    Metres::new(I16F16::from_num(x))
}

fn point(x: f64, y: f64) -> Point {
    Point::new(metres(x), metres(y))
}

fn f(m: Metres) -> f64 {
    m.get().to_num()
}

fn radians(a: Angle) -> f64 {
    f64::from(a.bits()) * ANGLE_STEP
}

/// Difference of two directions, the short way round.
fn off(a: f64, b: f64) -> f64 {
    let d = (a - b).rem_euclid(TAU);
    d.min(TAU - d)
}

/// About `n` angles over the whole turn, no two a multiple of each other, and the corners.
fn angles(n: u32) -> impl Iterator<Item = Angle> {
    let stride = (u32::MAX / n) | 1;
    (0..n)
        .map(move |i| i.wrapping_mul(stride) as i32)
        .chain((0..8u32).flat_map(|octant| {
            let edge = octant << 29;
            [edge.wrapping_sub(1), edge, edge.wrapping_add(1)].map(|bits| bits as i32)
        }))
        .map(Angle::from_bits)
}

/// A small generator, so that every run measures the same points.
struct Lcg(u64);

impl Lcg {
    fn bits(&mut self) -> u64 {
        self.0 = self
            .0
            .wrapping_mul(6_364_136_223_846_793_005)
            .wrapping_add(1_442_695_040_888_963_407);
        self.0 >> 32
    }

    fn between(&mut self, low: f64, high: f64) -> f64 {
        low + (high - low) * self.bits() as f64 / 4_294_967_296.0
    }

    /// Standard normal, as a sum of twelve.
    fn normal(&mut self) -> f64 {
        (0..12).map(|_| self.between(0.0, 1.0)).sum::<f64>() - 6.0
    }
}

macro_rules! saturates {
    ($($test:ident: $quantity:ident, $repr:ident;)+) => {$(
        #[test]
        fn $test() {
            type Q = $quantity;
            let (least, step) = (Q::from_bits(i32::MIN), Q::from_bits(1));
            assert_eq!(Q::MAX.bits(), i32::MAX);
            assert_eq!(Q::MAX + step, Q::MAX);
            assert_eq!(Q::MAX + Q::MAX, Q::MAX);
            assert_eq!(least - step, least);
            assert_eq!(least + least, least);
            assert_eq!(Q::ZERO - least, Q::MAX);
            assert_eq!(-least, Q::MAX);
            assert_eq!(least.abs(), Q::MAX);
            assert_eq!(Q::MAX.scale(I16F16::MAX), Q::MAX);
            assert_eq!(Q::MAX.scale(I16F16::MIN), least);
            assert_eq!(least.scale(I16F16::MIN), Q::MAX);
            assert_eq!(least.scale(I16F16::ONE), least);
            // Half a step rounds towards minus infinity.
            assert_eq!(step.scale(I16F16::lit("0.5")), Q::ZERO);
            assert_eq!((-step).scale(I16F16::lit("0.5")), -step);
            assert_eq!(least.limit(Q::MAX), -Q::MAX);
            assert_eq!(least.limit(Q::ZERO), Q::ZERO);
            assert_eq!(Q::MAX.limit(least), Q::ZERO);
            assert_eq!(Q::lit("1.5").get(), $repr::lit("1.5"));
            assert_eq!(Q::new($repr::MAX), Q::MAX);
            assert!(least < Q::ZERO && Q::ZERO < Q::MAX);
        }
    )+};
}

saturates! {
    metres_saturate: Metres, I16F16;
    metres_per_second_saturate: MetresPerSecond, I16F16;
    radians_per_second_saturate: RadiansPerSecond, I16F16;
    per_metre_saturates: PerMetre, I16F16;
    seconds_saturate: Seconds, I8F24;
}

#[test]
fn products_of_units_saturate() {
    let ends = [i32::MIN, -1, 0, 1, i32::MAX];
    for a in ends {
        for b in ends {
            let (speed, rate) = (
                MetresPerSecond::from_bits(a),
                RadiansPerSecond::from_bits(a),
            );
            let within = |got: i32, bits: u32| {
                let exact = (f64::from(a) * f64::from(b) / 2f64.powi(bits as i32)).floor();
                let exact = exact.clamp(f64::from(i32::MIN), f64::from(i32::MAX));
                assert_eq!(f64::from(got), exact, "{a} {b}");
            };
            within(speed.over(Seconds::from_bits(b)).bits(), 24);
            within(speed.on_arc(PerMetre::from_bits(b)).bits(), 16);
            within(rate.at(Metres::from_bits(b)).bits(), 16);
            // Wraps, whatever the size; only that it does not panic.
            let _ = rate.over(Seconds::from_bits(b));
        }
    }
}

#[test]
fn angle_over_time() {
    let mut lcg = Lcg(3);
    let mut worst = 0.0f64;
    for _ in 0..100_000 {
        let rate = RadiansPerSecond::from_bits(lcg.between(-3e5, 3e5) as i32);
        let time = Seconds::from_bits(lcg.between(0.0, 3e7) as i32);
        let exact = rate.get().to_num::<f64>() * time.get().to_num::<f64>();
        worst = worst.max(off(radians(rate.over(time)), exact));
    }
    println!("yaw rate over time: {worst:.3e} rad");
    assert!((1e-9..6e-9).contains(&worst));
}

#[test]
fn degrees_both_ways() {
    let (mut out, mut back, mut magnitude) = (0.0f64, 0.0f64, 0.0f64);
    for angle in angles(1 << 18) {
        let exact = radians(angle).to_degrees();
        let degrees = angle.degrees();
        out = out.max((degrees.to_num::<f64>() - exact).abs());
        magnitude = magnitude.max((angle.abs_degrees().to_num::<f64>() - exact.abs()).abs());
        let again = Angle::from_degrees(degrees);
        back = back.max(off(radians(again), radians(angle)).to_degrees());
    }
    println!("degrees: {out:.3e}, magnitude {magnitude:.3e}, back {back:.3e}");
    // Half a step of the degrees' format each.
    for worst in [out, magnitude, back] {
        assert!((0.99 * STEP / 2.0..1.01 * STEP / 2.0).contains(&worst));
    }

    let mut worst = 0.0f64;
    for bits in angles(1 << 18).map(Angle::bits) {
        let degrees = I16F16::from_bits(bits);
        let angle = Angle::from_degrees(degrees);
        worst = worst.max(off(radians(angle), degrees.to_num::<f64>().to_radians()));
    }
    println!("from degrees: {:.3e}°", worst.to_degrees());
    // Half a step of the angle, far below the documented 1.5e-5°; over ±91 turns.
    assert!((4e-8..4.4e-8).contains(&worst.to_degrees()));

    assert_eq!(Angle::deg("90"), Angle::QUARTER);
    assert_eq!(Angle::deg("180"), Angle::HALF);
    assert_eq!(Angle::deg("-180"), Angle::HALF);
    assert_eq!(Angle::deg("360"), Angle::ZERO);
    assert_eq!(Angle::deg("-450"), -Angle::QUARTER);
    assert_eq!(Angle::HALF.degrees(), I16F16::lit("-180"));
    assert_eq!(Angle::HALF.abs_degrees(), I16F16::lit("180"));
    for degrees in -179..180 {
        let whole = I16F16::from_num(degrees);
        assert_eq!(Angle::from_degrees(whole).degrees(), whole);
        assert_eq!(Angle::from_degrees(whole).abs_degrees(), whole.abs());
    }
}

#[test]
fn radians_both_ways() {
    let (mut out, mut back, mut from) = (0.0f64, 0.0f64, 0.0f64);
    for angle in angles(1 << 18) {
        let got = angle.radians();
        out = out.max((got.to_num::<f64>() - radians(angle)).abs());
        back = back.max(off(radians(Angle::from_radians(got)), radians(angle)));
        let many = I16F16::from_bits(angle.bits() >> 4);
        from = from.max(off(radians(Angle::from_radians(many)), many.to_num()));
    }
    println!("radians: {out:.3e}, back {back:.3e}, from {from:.3e}");
    assert!((0.99 * STEP / 2.0..1.01 * STEP / 2.0).contains(&out));
    assert!((0.99 * STEP / 2.0..1.01 * STEP / 2.0).contains(&back));
    // Over ±2048 rad the factor's own rounding shows.
    assert!((1e-9..1e-7).contains(&from));
}

#[test]
fn angles_wrap_and_saturate_where_documented() {
    let last = Angle::from_bits(i32::MAX);
    assert_eq!(last + Angle::from_bits(1), Angle::HALF);
    assert_eq!(-Angle::HALF, Angle::HALF);
    assert_eq!(Angle::HALF.abs(), last);
    assert!(!Angle::HALF.is_left() && last.is_left() && !Angle::ZERO.is_left());
    assert_eq!(Angle::QUARTER.scale(I16F16::MAX), last);
    assert_eq!(Angle::QUARTER.scale(I16F16::MIN), Angle::HALF);
    assert_eq!(Angle::HALF.scale(I16F16::MIN), last);
    assert_eq!(Angle::HALF.limit(last), -last);
    assert_eq!(last.limit(Angle::QUARTER), Angle::QUARTER);
    assert_eq!(last.limit(-Angle::QUARTER), Angle::ZERO);
    assert_eq!(Angle::HALF.limit(Angle::HALF), Angle::ZERO);
    // The difference of two headings is the short way round.
    let (a, b) = (Angle::deg("175"), Angle::deg("-175"));
    assert!(((b - a).degrees() - I16F16::lit("10")).abs() < I16F16::lit("0.001"));
}

#[test]
fn cosine_and_sine() {
    let one = |x: I2F30| x.to_num::<f64>();
    let (mut worst, mut length, mut mean) = (0.0f64, [f64::MAX, 0.0f64], 0.0f64);
    let mut n = 0.0;
    for angle in angles(1 << 20) {
        let (cos, sin) = angle.cos_sin();
        let (exact_sin, exact_cos) = radians(angle).sin_cos();
        worst = worst
            .max((one(cos) - exact_cos).abs())
            .max((one(sin) - exact_sin).abs());
        let norm = one(cos).hypot(one(sin));
        length = [length[0].min(norm), length[1].max(norm)];
        mean += norm;
        n += 1.0;
    }
    mean /= n;
    println!(
        "cos, sin: worst {worst:.3e}; length {:.3e} to {:.3e}, mean {:.3e}",
        length[0] - 1.0,
        length[1] - 1.0,
        mean - 1.0
    );
    assert!((1e-5..2e-5).contains(&worst));
    // The vector is a little short everywhere, never long.
    assert!(length[0] > 1.0 - 2.5e-5 && length[1] < 1.0);
    assert!((1e-5..1.6e-5).contains(&(1.0 - mean)));
}

#[test]
fn direction_of_a_vector() {
    let mut worst = 0.0f64;
    let mut judge = |x: i32, y: i32| {
        let got = radians(Angle::of(x, y));
        worst = worst.max(off(got, f64::from(y).atan2(f64::from(x))));
    };
    let ends = [i32::MIN, i32::MIN + 1, -1, 0, 1, i32::MAX - 1, i32::MAX];
    for x in ends {
        for y in ends {
            if (x, y) != (0, 0) {
                judge(x, y);
            }
        }
    }
    // Small vectors, and all octants at every size.
    for x in -60..60 {
        for y in -60..60 {
            if (x, y) != (0, 0) {
                judge(x, y);
            }
        }
    }
    let mut lcg = Lcg(5);
    for _ in 0..400_000 {
        let size = lcg.bits() % 31;
        let x = (lcg.bits() as u32 as i32) >> size;
        let y = (lcg.bits() as u32 as i32) >> (lcg.bits() % 31);
        if (x, y) != (0, 0) {
            judge(x, y);
        }
    }
    println!("direction: {worst:.3e} rad");
    assert!((1e-6..2.5e-6).contains(&worst));
    assert_eq!(Angle::of(0, 0), Angle::ZERO);
    assert_eq!(Angle::of(i32::MAX, 0), Angle::ZERO);
    assert_eq!(Point::default().direction(), Angle::ZERO);
}

#[test]
fn norm_is_rounded_down_to_a_step() {
    let mut lcg = Lcg(7);
    let mut worst = 0.0f64;
    for _ in 0..300_000 {
        let x = (lcg.bits() as u32 as i32) >> (2 + lcg.bits() % 28);
        let y = (lcg.bits() as u32 as i32) >> (2 + lcg.bits() % 28);
        let p = Point::new(Metres::from_bits(x), Metres::from_bits(y));
        let short = f64::from(x).hypot(f64::from(y)) - f64::from(p.norm().bits());
        assert!((-1e-6..1.0).contains(&short), "{x} {y}: {short}");
        worst = worst.max(short);
    }
    assert!(worst > 0.999);
    let corner = Point::new(Metres::from_bits(i32::MIN), Metres::from_bits(i32::MIN));
    assert_eq!(corner.norm(), Metres::MAX);
    assert_eq!(
        Point::new(Metres::from_bits(i32::MIN), Metres::ZERO).norm(),
        Metres::MAX
    );
    assert_eq!(point(3.0, 4.0).norm(), metres(5.0));
    assert_eq!(point(0.0, -2.5).norm(), metres(2.5));
    assert_eq!(Point::default().norm(), Metres::ZERO);
}

#[test]
fn rotation_and_frames() {
    let mut lcg = Lcg(11);
    let (mut rotation, mut round_trip) = (0.0f64, 0.0f64);
    for angle in angles(1 << 16) {
        let (x, y) = (lcg.between(-50.0, 50.0), lcg.between(-50.0, 50.0));
        let p = point(x, y);
        let (sin, cos) = radians(angle).sin_cos();
        let (x, y) = (f(p.x), f(p.y));
        let turned = p.rotated(angle);
        let miss = (f(turned.x) - (x * cos - y * sin)).hypot(f(turned.y) - (x * sin + y * cos));
        // A share of the length, once two rounded products are allowed for.
        rotation = rotation.max((miss - 2.0 * STEP).max(0.0) / x.hypot(y));
        let pose = Pose::new(point(lcg.between(-9.0, 9.0), lcg.between(-9.0, 9.0)), angle);
        let again = pose.to_world(pose.to_body(p));
        let far = f(pose.to_body(p).norm());
        round_trip = round_trip.max((f((again - p).norm()) - 4.0 * STEP).max(0.0) / far);
    }
    println!("rotated: {rotation:.3e} of the length; body and back {round_trip:.3e}");
    assert!((1e-5..2.5e-5).contains(&rotation));
    assert!((1e-5..5e-5).contains(&round_trip));
    // The ends saturate and do not panic.
    let far = Point::new(Metres::from_bits(i32::MIN), Metres::from_bits(i32::MIN));
    for angle in angles(1 << 8) {
        let _ = far.rotated(angle);
        let _ = Pose::new(far, angle).to_body(Point::new(Metres::MAX, Metres::MAX));
        let _ = Pose::new(far, angle).to_world(far);
        let _ = Point::polar(Metres::from_bits(i32::MIN), angle);
    }
    assert_eq!(far.rotated(Angle::deg("45")).y, Metres::from_bits(i32::MIN));
}

#[test]
fn rotation_is_rounded_to_nearest() {
    // Vectors so short that cosine and sine are exact beside the rounding: it has no bias, and half a step a product.
    let (mut worst, mut bias, mut n) = (0.0f64, 0.0, 0.0);
    let mut lcg = Lcg(23);
    for angle in angles(1 << 16) {
        let (x, y) = (
            lcg.between(-900.0, 900.0) as i32,
            lcg.between(-900.0, 900.0) as i32,
        );
        let p = Point::new(Metres::from_bits(x), Metres::from_bits(y)).rotated(angle);
        let (sin, cos) = radians(angle).sin_cos();
        let off = f64::from(p.x.bits()) - (f64::from(x) * cos - f64::from(y) * sin);
        worst = worst.max(off.abs());
        bias += f64::from(p.y.bits()) - (f64::from(x) * sin + f64::from(y) * cos);
        n += 1.0;
    }
    assert!((0.9..1.05).contains(&worst), "{worst}");
    assert!((bias / n).abs() < 0.01, "{}", bias / n);
}

/// `n` points spread evenly over `span` degrees of a circle, its middle seen from the origin.
fn arc(centre: (f64, f64), radius: f64, facing: f64, span: f64, n: usize) -> Vec<(f64, f64)> {
    (0..n)
        .map(|i| {
            let share = i as f64 / (n - 1) as f64 - 0.5;
            let angle = facing + (share * span).to_radians();
            (
                centre.0 + radius * angle.cos(),
                centre.1 + radius * angle.sin(),
            )
        })
        .collect()
}

fn fit(points: &[(f64, f64)]) -> Option<CircleFit> {
    let points: Vec<Point> = points.iter().map(|&(x, y)| point(x, y)).collect();
    fit_circle(&points)
}

/// Worst relative error of the radius, and of the centre's place, over circles of `radius` seen on arcs of `span`.
fn worst_fit(radius: f64, span: f64, lcg: &mut Lcg) -> (f64, f64) {
    let (mut worst, mut misplaced) = (0.0f64, 0.0f64);
    for n in [3, 4, 5, 8, 13, 32, 64] {
        for _ in 0..40 {
            let bearing = lcg.between(-PI, PI);
            let distance = lcg.between(0.0, 8.0);
            let centre = (distance * bearing.cos(), distance * bearing.sin());
            let facing = lcg.between(-PI, PI);
            let fit = fit(&arc(centre, radius, facing, span, n))
                .unwrap_or_else(|| panic!("no circle: r {radius}, {span}°, {n} points"));
            worst = worst.max((f(fit.radius) - radius).abs() / radius);
            let miss = (f(fit.centre.x) - centre.0).hypot(f(fit.centre.y) - centre.1);
            misplaced = misplaced.max(miss / radius);
        }
    }
    (worst, misplaced)
}

#[test]
fn exact_circles() {
    let mut lcg = Lcg(13);
    // Span in degrees, and bounds of the radius' relative error over radii of 0.2 m and more.
    let spans = [
        (30.0, 4e-4..2.1e-3),
        (60.0, 1e-4..6e-4),
        (90.0, 4e-5..5e-4),
        (180.0, 3e-5..2e-4),
        (330.0, 1e-5..1.5e-4),
    ];
    println!("radius   span  radius off  centre off");
    for (span, bounds) in spans {
        for radius in [0.05, 0.1, 0.2, 0.5, 1.0, 2.0, 5.0] {
            let (off, misplaced) = worst_fit(radius, span, &mut lcg);
            println!("{radius:6} {span:6} {off:11.2e} {misplaced:11.2e}");
            if radius >= 0.2 {
                assert!(bounds.contains(&off));
            }
            // At 5 cm the step of the coordinates itself, 0.3 permille of the radius, is what limits.
            assert!(off < 1e-2 && misplaced < 1e-2);
        }
    }
}

#[test]
fn noisy_circles() {
    // 1 cm (one σ) of noise on every coordinate, radius 1 m.
    let mut lcg = Lcg(17);
    println!("  span  n  radius off   bias  residual");
    for span in [90.0, 120.0, 180.0] {
        for n in [16, 32, 64] {
            let (mut worst, mut bias, mut residual) = (0.0f64, 0.0, 0.0);
            const RUNS: u32 = 2000;
            for _ in 0..RUNS {
                let bearing = lcg.between(-PI, PI);
                let centre = (3.0 * bearing.cos(), 3.0 * bearing.sin());
                // The side that a robot at the origin sees.
                let points: Vec<_> = arc(centre, 1.0, bearing + PI, span, n)
                    .into_iter()
                    .map(|(x, y)| (x + 0.01 * lcg.normal(), y + 0.01 * lcg.normal()))
                    .collect();
                let fit = fit(&points).unwrap();
                let off = f(fit.radius) - 1.0;
                worst = worst.max(off.abs());
                bias += off / f64::from(RUNS);
                residual += f(fit.residual) / f64::from(RUNS);
            }
            println!("{span:6} {n:2} {worst:11.4} {bias:7.4} {residual:8.4}");
            // Kåsa's fit reads short arcs too small, a little; the residual is the radial noise.
            assert!((0.003..0.12).contains(&worst));
            assert!((-0.012..0.001).contains(&bias));
            assert!((0.008..0.0102).contains(&residual));
        }
    }
}

#[test]
fn a_residual_tells_what_is_no_circle() {
    // Two walls of a right corner, 1 m each.
    let corner: Vec<_> = (0..16)
        .map(|i| f64::from(i) / 15.0)
        .flat_map(|t| [(2.0, t), (2.0 + t, 0.0)])
        .collect();
    let fit = fit(&corner).unwrap();
    assert!((0.03..0.3).contains(&f(fit.residual)));
}

#[test]
fn lines_and_coincident_points_have_no_circle() {
    let mut lcg = Lcg(19);
    for n in [3usize, 4, 7, 16, 64] {
        // Below 10 cm the coordinates' own rounding, 8 µm, can bend a line.
        for size in [0.1, 0.3, 1.0, 10.0, 10_000.0] {
            for turn in 0..72 {
                let angle = f64::from(turn) * TAU / 72.0 + 0.01;
                let at = (lcg.between(-9.0, 9.0), lcg.between(-9.0, 9.0));
                let line: Vec<_> = (0..n)
                    .map(|i| {
                        let along = size * (i as f64 / (n - 1) as f64 - 0.5);
                        (at.0 + along * angle.cos(), at.1 + along * angle.sin())
                    })
                    .collect();
                assert_eq!(fit(&line), None, "{n} points on {size} m");
            }
        }
        let place = point(lcg.between(-9.0, 9.0), lcg.between(-9.0, 9.0));
        assert_eq!(fit_circle(&vec![place; n]), None);
        let mut two = vec![place; n];
        two[0] = place + point(0.3, 0.1);
        assert_eq!(fit_circle(&two), None);
    }
    assert_eq!(fit_circle(&[]), None);
    assert_eq!(fit_circle(&[point(1.0, 0.0), point(0.0, 1.0)]), None);
    let many: Vec<_> = arc((0.0, 0.0), 1.0, 0.0, 300.0, 65);
    assert_eq!(fit(&many), None);
    assert!(fit(&many[..64]).is_some());
}

fn extreme() -> impl Strategy<Value = i32> {
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
        -20..20i32,
        -500_000..500_000i32,
    ]
}

proptest! {
    #![proptest_config(ProptestConfig { cases: 4000, failure_persistence: None, ..ProptestConfig::default() })]

    #[test]
    fn any_points_fit_without_panic(
        points in prop::collection::vec((extreme(), extreme()), 0..70),
        common in prop::option::of((extreme(), 0..66usize)),
    ) {
        let mut points: Vec<Point> = points
            .into_iter()
            .map(|(x, y)| Point::new(Metres::from_bits(x), Metres::from_bits(y)))
            .collect();
        if let Some((bits, from)) = common {
            for p in points.iter_mut().skip(from) {
                p.x = Metres::from_bits(bits);
            }
        }
        if let Some(fit) = fit_circle(&points) {
            prop_assert!((3..=64).contains(&points.len()));
            prop_assert!(fit.radius >= Metres::ZERO && fit.residual >= Metres::ZERO);
        }
    }

    #[test]
    fn any_geometry_without_panic(a in extreme(), b in extreme(), c in extreme(), d in extreme(), turn in any::<i32>()) {
        let p = Point::new(Metres::from_bits(a), Metres::from_bits(b));
        let pose = Pose::new(Point::new(Metres::from_bits(c), Metres::from_bits(d)), Angle::from_bits(turn));
        let _ = (p + pose.at, p - pose.at, p.norm(), p.direction(), pose.to_body(p), pose.to_world(p));
        let _ = Point::polar(p.x, pose.heading);
        let angle = pose.heading;
        let factor = I16F16::from_bits(a);
        let _ = (angle.degrees(), angle.radians(), angle.abs_degrees(), angle.scale(factor), angle.cos_sin());
        let _ = (Angle::from_degrees(factor), Angle::from_radians(factor), angle.limit(Angle::from_bits(b)));
    }
}
