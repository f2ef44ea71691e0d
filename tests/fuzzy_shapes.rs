//! Membership functions: exact where they are promised to be, and curved ones within the errors that the documentation
//! states.

use fixed::types::I16F16;
use fuzzypilot::fuzzy::system::shape::{
    bell, gaussian, points, ramp, sigmoid, singleton, spline, trapezoid, triangle,
    two_sided_gaussian,
};
use fuzzypilot::fuzzy::system::{
    Block, Controller, Defuzzifier, Degree, Input, LIMIT, Literal::Is, Merge, Number, Output,
    Piece, Rule, System,
};
use proptest::prelude::*;

/// The degree of a term at `x`: what the one rule of a system with this one term fires with.
fn degree(term: &[Piece], x: i32) -> f64 {
    let terms = [term];
    let inputs = [Input::new([-1, 1], &terms).unlimited().with_gaps()];
    let rules = [Rule::new(&[&[Is(0, 0)]], &[(0, 0)])];
    let blocks = [Block::min(&rules)];
    let outputs = [Output {
        range: [0, 1],
        clamp: false,
        default: 0,
        complete: false,
        defuzzifier: Defuzzifier::WeightedAverage {
            merge: Merge::Sum,
            terms: &[Number::Constant(1)],
        },
    }];
    let system = System::checked(&inputs, &blocks, &outputs).unwrap();
    let evaluation = Controller::<1, 1, 1, 1>::new(system).evaluate([x]);
    f64::from(evaluation.rules[0].bits()) / f64::from(Degree::ONE.bits())
}

/// The worst error of a term between `low` and `high`, of 20,000 places.
fn worst(term: &[Piece], [low, high]: [i32; 2], exact: impl Fn(f64) -> f64) -> f64 {
    let step = ((i64::from(high) - i64::from(low)) / 20_000).max(1) as usize;
    (low..=high)
        .step_by(step)
        .map(|x| (degree(term, x) - exact(x.into())).abs())
        .fold(0.0, f64::max)
}

/// An error is within what is stated, and not so far within that the statement would be an excuse.
fn states(error: f64, stated: f64, what: &str) {
    assert!(error <= stated, "{what}: {error:.5}, stated {stated}");
    assert!(error >= 0.4 * stated, "{what}: {error:.5}, stated {stated}");
}

#[test]
fn curves_are_as_near_as_stated() {
    let gauss = |x: f64| (-0.5 * x * x / 1e12).exp();
    let around = [-8_000_000, 8_000_000];
    states(
        worst(&gaussian::<17>(0, 1_000_000), around, gauss),
        0.008,
        "Gaussian",
    );
    states(
        worst(&gaussian::<33>(0, 1_000_000), around, gauss),
        0.002,
        "Gaussian",
    );
    states(
        worst(&gaussian::<65>(0, 1_000_000), around, gauss),
        0.0005,
        "Gaussian",
    );

    let two = |x: f64| match x {
        x if x < -2e6 => gauss(x + 2e6),
        x if x > 1e6 => gauss((x - 1e6) / 2.0),
        _ => 1.0,
    };
    let (left, right) = ((-2_000_000, 1_000_000), (1_000_000, 2_000_000));
    let around = [-9_000_000, 14_000_000];
    states(
        worst(&two_sided_gaussian::<18>(left, right), around, two),
        0.008,
        "two-sided",
    );
    states(
        worst(&two_sided_gaussian::<34>(left, right), around, two),
        0.002,
        "two-sided",
    );
    states(
        worst(&two_sided_gaussian::<66>(left, right), around, two),
        0.0005,
        "two-sided",
    );

    for sign in [1, -1] {
        let logistic = |x: f64| 1.0 / (1.0 + (-x / 1e6 * f64::from(sign)).exp());
        let around = [-20_000_000, 20_000_000];
        let width = 1_000_000 * i64::from(sign);
        states(
            worst(&sigmoid::<9>(0, width), around, logistic),
            0.014,
            "sigmoid",
        );
        states(
            worst(&sigmoid::<17>(0, width), around, logistic),
            0.0038,
            "sigmoid",
        );
        states(
            worst(&sigmoid::<33>(0, width), around, logistic),
            0.001,
            "sigmoid",
        );

        let s = |x: f64| {
            let t = (x / 1e6 * f64::from(sign)).clamp(0.0, 1.0);
            if t < 0.5 {
                2.0 * t * t
            } else {
                1.0 - 2.0 * (1.0 - t) * (1.0 - t)
            }
        };
        let around = [-1_100_000, 1_100_000];
        let to = 1_000_000 * sign;
        states(worst(&spline::<9>(0, to), around, s), 0.0075, "spline");
        states(worst(&spline::<17>(0, to), around, s), 0.0019, "spline");
        states(worst(&spline::<33>(0, to), around, s), 0.0005, "spline");
    }

    // The bell's errors are stated for many slopes: the worst of them.
    let mut errors = [0.0f64; 3];
    for slope in [
        "0.5", "0.7", "1", "1.5", "2", "2.5", "3", "4", "5", "6.5", "8", "10", "12",
    ] {
        let slope: I16F16 = slope.parse().unwrap();
        let bell_ = |x: f64| 1.0 / (1.0 + (x / 1e5).abs().powf(2.0 * slope.to_num::<f64>()));
        for around in [[-1_000_000, 1_000_000], [-200_000, 200_000]] {
            let found = [
                worst(&bell::<17>(0, 100_000, slope), around, bell_),
                worst(&bell::<33>(0, 100_000, slope), around, bell_),
                worst(&bell::<65>(0, 100_000, slope), around, bell_),
            ];
            for (error, found) in errors.iter_mut().zip(found) {
                *error = error.max(found);
            }
        }
    }
    states(errors[0], 0.014, "bell");
    states(errors[1], 0.0031, "bell");
    states(errors[2], 0.0011, "bell");
}

/// Straight between two points, in f64.
fn line(x: f64, (x0, y0): (f64, f64), (x1, y1): (f64, f64)) -> f64 {
    y0 + (x - x0) / (x1 - x0) * (y1 - y0)
}

/// Zero up to `a`, one from `b` to `c`, zero from `d`; upright flanks belong to their top.
fn trapezoid_exactly(x: f64, [a, b, c, d]: [f64; 4]) -> f64 {
    if x < a || x > d {
        0.0
    } else if x < b {
        line(x, (a, 0.0), (b, 1.0))
    } else if x <= c {
        1.0
    } else {
        line(x, (c, 1.0), (d, 0.0))
    }
}

/// Numbers of a term: near each other, anywhere, and at the ends.
fn ascending(n: usize) -> impl Strategy<Value = Vec<i32>> {
    let number = prop_oneof![
        -LIMIT..=LIMIT,
        -40..40i32,
        Just(-LIMIT),
        Just(LIMIT),
        -3_000_000..3_000_000i32
    ];
    prop::collection::vec(number, n).prop_map(|mut all| {
        all.sort_unstable();
        all
    })
}

/// Everywhere, and close to every number of a term.
fn places(numbers: &[i32]) -> Vec<i32> {
    let mut all = vec![i32::MIN, -LIMIT, -1, 0, 1, LIMIT, i32::MAX];
    for pair in numbers.windows(2) {
        let (a, b) = (i64::from(pair[0]), i64::from(pair[1]));
        all.extend(
            [
                a - 1,
                a,
                a + 1,
                a + (b - a) / 3,
                (a + b) / 2,
                b - 1,
                b,
                b + 1,
            ]
            .map(|x| x as i32),
        );
    }
    all
}

/// Half a step of a degree, and a quarter from the slope's own rounding.
const EXACT: f64 = 0.7501 / 16_777_216.0;

/// A number as an input without a range takes it.
fn taken(x: i32) -> f64 {
    f64::from(x.clamp(-LIMIT, LIMIT))
}

proptest! {
    #![proptest_config(ProptestConfig { cases: 300, failure_persistence: None, ..ProptestConfig::default() })]

    #[test]
    fn straight_terms_are_exact(n in ascending(4), degrees in prop::array::uniform4(0..=1u32 << 24)) {
        let real: Vec<f64> = n.iter().map(|&x| x.into()).collect();
        let (a, b, c, d) = (n[0], n[1], n[2], n[3]);
        for x in places(&n) {
            let at = taken(x);
            let wanted = trapezoid_exactly(at, [real[0], real[1], real[2], real[3]]);
            let got = degree(&trapezoid(a, b, c, d), x);
            prop_assert!((got - wanted).abs() <= EXACT, "trapezoid {n:?} at {x}: {got}, {wanted}");

            let wanted = trapezoid_exactly(at, [real[0], real[1], real[1], real[2]]);
            let got = degree(&triangle(a, b, c), x);
            prop_assert!((got - wanted).abs() <= EXACT, "triangle {n:?} at {x}: {got}, {wanted}");

            let got = degree(&singleton(b), x);
            prop_assert_eq!(got, f64::from(u8::from(at == real[1])));

            let rising = if at >= real[2] { 1.0 } else { line(at, (real[0], 0.0), (real[2], 1.0)).max(0.0) };
            let got = degree(&ramp(a, c), x);
            prop_assert!((got - rising).abs() <= EXACT, "ramp {n:?} at {x}: {got}, {rising}");
            if a < c {
                let got = degree(&ramp(c, a), x);
                prop_assert!((got - (1.0 - rising)).abs() <= EXACT, "ramp back {n:?} at {x}: {got}");
            }

            let points_: Vec<(i32, Degree)> = n.iter().zip(degrees).map(|(&x, d)| (x, Degree::from_bits(d))).collect();
            let height = |i: usize| f64::from(degrees[i]) / 16_777_216.0;
            let behind = real.iter().rposition(|&from| from <= at);
            let wanted = match behind {
                None => height(0),
                Some(3) => height(3),
                Some(i) => line(at, (real[i], height(i)), (real[i + 1], height(i + 1))),
            };
            let got = degree(&points([points_[0], points_[1], points_[2], points_[3]]), x);
            prop_assert!((got - wanted).abs() <= EXACT, "points {n:?} {degrees:?} at {x}: {got}, {wanted}");
        }
    }

    #[test]
    fn curves_of_any_size_make_terms(centre in -LIMIT..=LIMIT, width in prop_oneof![1..100i64, 1..=1i64 << 40], slope in 1..i32::MAX) {
        // `degree` makes a system of each: its check would find points out of order.
        let slope = I16F16::from_bits(slope);
        for x in [i32::MIN, centre, centre.saturating_add(1), 0, i32::MAX] {
            for term in [&gaussian::<33>(centre, width)[..], &bell::<33>(centre, width, slope), &sigmoid::<17>(centre, width),
                &sigmoid::<17>(centre, -width), &two_sided_gaussian::<34>((centre.min(0), width), (centre.max(0), width))] {
                prop_assert!((0.0..=1.0).contains(&degree(term, x)));
            }
            prop_assert_eq!(degree(&gaussian::<33>(centre, width), centre), 1.0);
            prop_assert_eq!(degree(&bell::<33>(centre, width, slope), centre), 1.0);
        }
    }
}
