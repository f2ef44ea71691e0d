//! Fuzzy systems of four kinds, to be evaluated on emulated microcontrollers and on the desktop alike.

use fixed::types::I16F16;
use fuzzypilot::fuzzy::Grade;
use fuzzypilot::fuzzy::system::shape::{bell, gaussian, ramp, sigmoid, trapezoid, triangle};
use fuzzypilot::fuzzy::system::{
    Block, Controller, Defuzzifier, Degree, Input, Linear,
    Literal::{Is, IsNot},
    Merge,
    Number::{self, Constant},
    Output, Rule, Samples, Set, System,
};

/// A number in steps of 2^-16.
const fn q(text: &str) -> i32 {
    I16F16::lit(text).to_bits()
}

/// Two inputs, nine rules, one output: triangles, minimum, height.
pub type Table = Controller<'static, 2, 6, 9, 1>;

/// Fan speed by temperature and humidity.
pub static TABLE: Table = {
    const COLD: u8 = 0;
    const MILD: u8 = 1;
    const HOT: u8 = 2;
    const DRY: u8 = 0;
    const FRESH: u8 = 1;
    const DAMP: u8 = 2;
    Controller::new(System::new(
        &[
            Input::new(
                [q("0"), q("50")],
                &[
                    &ramp(q("24"), q("18")),
                    &triangle(q("18"), q("24"), q("32")),
                    &ramp(q("24"), q("32")),
                ],
            ),
            Input::new(
                [q("0"), q("100")],
                &[
                    &ramp(q("55"), q("30")),
                    &triangle(q("30"), q("55"), q("80")),
                    &ramp(q("55"), q("80")),
                ],
            ),
        ],
        &[Block::min(&[
            Rule::new(&[&[Is(0, COLD), Is(1, DRY)]], &[(0, 0)]),
            Rule::new(&[&[Is(0, COLD), Is(1, FRESH)]], &[(0, 0)]),
            Rule::new(&[&[Is(0, COLD), Is(1, DAMP)]], &[(0, 1)]),
            Rule::new(&[&[Is(0, MILD), Is(1, DRY)]], &[(0, 0)]),
            Rule::new(&[&[Is(0, MILD), Is(1, FRESH)]], &[(0, 1)]),
            Rule::new(&[&[Is(0, MILD), Is(1, DAMP)]], &[(0, 2)]),
            Rule::new(&[&[Is(0, HOT), Is(1, DRY)]], &[(0, 1)]),
            Rule::new(&[&[Is(0, HOT), Is(1, FRESH)]], &[(0, 2)]),
            Rule::new(&[&[Is(0, HOT), Is(1, DAMP)]], &[(0, 2)]),
        ])],
        &[Output {
            range: [q("0"), q("100")],
            clamp: false,
            default: q("0"),
            complete: true,
            defuzzifier: Defuzzifier::WeightedAverage {
                merge: Merge::Sum,
                terms: &[Constant(q("0")), Constant(q("40")), Constant(q("100"))],
            },
        }],
    ))
};

/// Three inputs, curved terms, products, weights, NOT, OR; linear and constant conclusions.
pub type Curved = Controller<'static, 3, 7, 6, 2>;

/// Everything that takes a multiplication.
pub static CURVED: Curved = Controller::new(System::new(
    &[
        Input::new(
            [q("-4"), q("4")],
            &[
                &gaussian::<33>(q("-3"), q("1.25") as i64),
                &gaussian::<33>(q("0"), q("1.25") as i64),
                &gaussian::<33>(q("3"), q("1.25") as i64),
            ],
        ),
        Input::new(
            [q("0"), q("1")],
            &[
                &bell::<33>(q("0"), q("0.5") as i64, I16F16::lit("2.5")),
                &bell::<33>(q("1"), q("0.5") as i64, I16F16::lit("2.5")),
            ],
        ),
        Input::new(
            [q("-1"), q("1")],
            &[
                &sigmoid::<17>(q("0"), q("-0.25") as i64),
                &sigmoid::<17>(q("0"), q("0.25") as i64),
            ],
        )
        .unlimited(),
    ],
    &[Block::product(&[
        Rule::new(&[&[Is(0, 0), Is(1, 0), Is(2, 0)]], &[(0, 0), (1, 0)]),
        Rule::new(&[&[Is(0, 1), IsNot(1, 0)], &[Is(2, 1)]], &[(0, 1)]),
        Rule::new(&[&[Is(0, 2), Is(1, 1)]], &[(0, 2), (1, 1)]),
        Rule::new(&[&[IsNot(0, 1)]], &[(1, 2)]).weighted(Degree::lit("0.3")),
        Rule::new(&[&[Is(2, 0)], &[Is(0, 0)]], &[(0, 0)]).weighted(Degree::lit("0.9")),
        Rule::new(&[&[Is(1, 0), Is(1, 1)]], &[(0, 2), (1, 0)]),
    ])],
    &[
        Output {
            range: [q("-10"), q("10")],
            clamp: true,
            default: q("0"),
            complete: false,
            defuzzifier: Defuzzifier::WeightedAverage {
                merge: Merge::Max,
                terms: &[
                    Number::Linear(Linear {
                        coefficients: &[q("1.5"), q("-2"), q("0.25")],
                        shift: 16,
                        constant: q("0.5"),
                    }),
                    Number::Linear(Linear {
                        coefficients: &[q("-0.75"), q("4"), q("0")],
                        shift: 16,
                        constant: q("-1"),
                    }),
                    Constant(q("7")),
                ],
            },
        },
        Output {
            range: [q("0"), q("1")],
            clamp: false,
            default: q("0.5"),
            complete: false,
            defuzzifier: Defuzzifier::WeightedAverage {
                merge: Merge::Sum,
                terms: &[Constant(q("0")), Constant(q("0.6")), Constant(q("1"))],
            },
        },
    ],
));

/// Two inputs, sets, a centroid: Mamdani.
pub type Mamdani = Controller<'static, 2, 5, 4, 2>;

const SAMPLES: Samples = Samples::middles([q("0"), q("30")], 50);
static LITTLE: [Grade; 50] = SAMPLES.of(&triangle(q("0"), q("5"), q("10")));
static SOME: [Grade; 50] = SAMPLES.of(&triangle(q("10"), q("15"), q("20")));
static MUCH: [Grade; 50] = SAMPLES.of(&gaussian::<33>(q("25"), q("2.5") as i64));

static SETS: [Set<'static>; 3] = [&LITTLE, &SOME, &MUCH];

/// Sets that are cut off: merged term by term where the largest counts, rule by rule where they are added.
pub static MAMDANI: Mamdani = {
    const fn output(merge: Merge) -> Output<'static> {
        Output {
            range: [q("0"), q("30")],
            clamp: false,
            default: q("3"),
            complete: false,
            defuzzifier: Defuzzifier::Centroid {
                merge,
                samples: SAMPLES,
                terms: &SETS,
            },
        }
    }
    Controller::new(System::new(
        &[
            Input::new(
                [q("0"), q("10")],
                &[
                    &ramp(q("4"), q("1")),
                    &trapezoid(q("1"), q("4"), q("6"), q("9")),
                    &ramp(q("6"), q("9")),
                ],
            ),
            Input::new(
                [q("0"), q("10")],
                &[&ramp(q("3"), q("1")), &ramp(q("7"), q("9"))],
            )
            .with_gaps(),
        ],
        &[Block::min(&[
            Rule::new(&[&[Is(0, 0)], &[Is(1, 0)]], &[(0, 0), (1, 0)]),
            Rule::new(&[&[Is(0, 2)], &[Is(1, 1)]], &[(0, 2), (1, 2)]),
            Rule::new(&[&[Is(0, 1)]], &[(0, 1), (1, 1)]),
            Rule::new(&[&[Is(0, 0), Is(1, 1)]], &[(0, 1), (1, 0)]),
        ])],
        &[output(Merge::Max), output(Merge::Sum)],
    ))
};

/// One input, hundreds of rules, a centre of sums.
pub type Crowd = Controller<'static, 1, 2, 320, 1>;

const PLACES: Samples = Samples::ends([q("0"), q("30")], 20);
static RISING: [Grade; 20] = PLACES.of(&ramp(q("0"), q("15")));
static HIGH: [Grade; 20] = PLACES.of(&ramp(q("10"), q("20")));
static LOW: [Grade; 20] = PLACES.of(&triangle(q("0"), q("5"), q("10")));

/// At both ends of the input 300 rules hold fully, and from 20 on so do their sets: what they add there takes more than 32
/// bits.
pub static CROWD: Crowd = {
    const RULES: [Rule; 320] = {
        let rising = Rule::new(&[&[Is(0, 0)], &[Is(0, 1)]], &[(0, 0)]);
        let high = Rule::new(&[&[Is(0, 0)], &[Is(0, 1)]], &[(0, 1)]);
        let mut rules = [Rule::new(&[&[Is(0, 0)]], &[(0, 2)]); 320];
        let mut i = 0;
        while i < 300 {
            rules[i] = if i % 2 == 0 { rising } else { high };
            i += 1;
        }
        rules
    };
    Controller::new(System::new(
        &[Input::new(
            [q("0"), q("10")],
            &[&ramp(q("8"), q("2")), &ramp(q("2"), q("8"))],
        )],
        &[Block::min(&RULES)],
        &[Output {
            range: [q("0"), q("30")],
            clamp: false,
            default: q("0"),
            complete: true,
            defuzzifier: Defuzzifier::Centroid {
                merge: Merge::Sum,
                samples: PLACES,
                terms: &[&RISING, &HIGH, &LOW],
            },
        }],
    ))
};

/// Inputs `number` of a repeatable sequence: the ends of all numbers first, then anywhere in the variables' ranges and
/// a little beyond.
pub fn inputs<const I: usize>(system: &System<'_>, number: u32) -> [i32; I] {
    let ends = [i32::MIN, i32::MAX, 0, -1];
    let mut state = number.wrapping_mul(0x9E37_79B9) ^ 0x5bd1_e995;
    let mut inputs = [0; I];
    for (i, place) in inputs.iter_mut().enumerate() {
        state = (state ^ (state >> 15)).wrapping_mul(0x2C1B_3C6D);
        state = (state ^ (state >> 12)).wrapping_mul(0x297A_2D39);
        state ^= state >> 15;
        let end = (number >> (2 * i)) & 3;
        *place = match (number, system.inputs().get(i)) {
            (0..64, _) => ends.get(end as usize).copied().unwrap_or(0),
            (_, Some(input)) => {
                let [low, high] = input.range.map(i64::from);
                let span = high.wrapping_sub(low);
                let share = i64::from(state >> 8).wrapping_mul(span.wrapping_mul(9) >> 3) >> 24;
                (low.wrapping_sub(span >> 4).wrapping_add(share)) as i32
            }
            _ => 0,
        };
    }
    inputs
}

/// How many inputs each system is given.
pub const NUMBERS: u32 = 1000;

/// All bits of rule degrees in a word, to compare.
pub fn digest(degrees: &[Degree]) -> u32 {
    degrees.iter().fold(0x811C_9DC5, |digest, degree| {
        (digest ^ degree.bits()).wrapping_mul(0x0100_0193)
    })
}
