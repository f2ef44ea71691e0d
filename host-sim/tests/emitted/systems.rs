//! The systems that are made into code.

use host_sim::fuzzy::emit::Design;
use host_sim::fuzzy::files::{Format, load, parse};
use host_sim::fuzzy::lower::{Lowered, lower};
use host_sim::fuzzy::model::{
    Antecedent, Conclusion, Conjunction, Defuzzifier, Input, Merge, Output, OutputTerm, Place,
    Rule, RuleBlock, Shape, System, Term,
};
use host_sim::fuzzy::random;
use rand::seq::SliceRandom;
use rand::{Rng, RngExt, SeedableRng};
use rand_pcg::Pcg64Mcg;
use std::fs;
use std::path::Path;

/// A system with its fixed point.
pub struct Made {
    /// What it is called in messages.
    pub name: String,
    /// What it says.
    pub system: System,
    /// Its fixed point.
    pub lowered: Lowered,
}

impl Made {
    fn new(name: String, system: System) -> Self {
        let lowered = lower(&system).unwrap_or_else(|error| panic!("{name}: {error}"));
        Self {
            name,
            system,
            lowered,
        }
    }

    /// As the writers take it, under a name of theirs.
    pub fn design<'a>(&'a self, name: &'a str) -> Design<'a> {
        Design {
            system: &self.system,
            lowered: &self.lowered,
            name,
            command: "host-sim fuzzy convert",
            bounds: None,
        }
    }
}

/// The checked-in designs.
pub fn designs() -> Vec<Made> {
    let folder = Path::new(env!("CARGO_MANIFEST_DIR")).join("designs");
    let mut files: Vec<_> = fs::read_dir(folder)
        .unwrap()
        .map(|entry| entry.unwrap().path())
        .filter(|file| {
            file.extension()
                .is_some_and(|e| e == "fll" || e == "fcl" || e == "fis")
        })
        .collect();
    files.sort();
    assert!(files.len() >= 8, "designs are missing");
    let made = files.into_iter().map(|file| {
        let name = file.file_name().unwrap().to_string_lossy().into_owned();
        Made::new(name, load(&file, None).unwrap())
    });
    made.collect()
}

/// Random systems of every kind. Some have no fixed point; they do not count.
pub fn random_systems(count: usize) -> Vec<Made> {
    let mut rng = Pcg64Mcg::seed_from_u64(20);
    let mut made = Vec::new();
    while made.len() < count {
        let system = random::system(&mut rng);
        if lower(&system).is_ok() {
            made.push(Made::new(format!("random system {}", made.len()), system));
        }
    }
    made
}

/// Names that no language takes, in a system that has all that is named.
pub fn weird_names() -> Made {
    let mut system = load(
        &Path::new(env!("CARGO_MANIFEST_DIR")).join("designs/greenhouse.fll"),
        None,
    )
    .unwrap();
    let mut names = [
        "int",
        "fn",
        "*/ #error /*",
        "1st",
        "",
        "Größe",
        "größe",
        "温度",
        "a b",
        "a_b",
        "aB",
        "self",
        "Self",
        "`x`",
        "\\",
        "??/",
        "\u{202e}reversed",
        "line\nbreak",
        "INPUTS",
        "fraction",
        "CONTROLLER",
        "least",
        "rules",
        "static",
        "NULL",
        "q16",
        "not",
        "[link]",
        "<b>",
        "x".repeat(64).leak(),
        "🚗",
        "__",
    ]
    .into_iter()
    .cycle();
    let mut next = || names.next().unwrap().to_owned();
    system.name = "*/ \"wei\\rd\" \n`name`".to_owned();
    for block in &mut system.blocks {
        block.name = next();
    }
    for input in &mut system.inputs {
        input.name = next();
        input.terms.iter_mut().for_each(|term| term.name = next());
    }
    for output in &mut system.outputs {
        output.name = next();
        output.terms.iter_mut().for_each(|term| term.name = next());
    }
    Made::new("weird names".to_owned(), system)
}

/// Hundreds of rules of full weight that a centre of sums adds: at one place more than 32 bits.
pub fn crowd() -> Made {
    let text = "Engine: crowd\nInputVariable: x\n  range: 0 10\n  term: low Ramp 8 2\n  term: high Ramp 2 8\n\
                OutputVariable: y\n  range: 0 30\n  aggregation: UnboundedSum\n  defuzzifier: Centroid 60\n  \
                term: rising Ramp 0 15\n  term: much Ramp 10 20\n  term: little Triangle 0 5 10\n\
                RuleBlock: all\n  disjunction: Maximum\n  implication: Minimum\n  activation: General\n  \
                rule: if x is low or x is high then y is rising\n  \
                rule: if x is low or x is high then y is much\n  \
                rule: if x is low then y is little\n";
    let mut system = parse("crowd", text.as_bytes(), Format::Fll).unwrap();
    // A file says nothing twice.
    let rules = &mut system.blocks[0].rules;
    let each = std::mem::take(rules).into_iter().zip([150, 150, 20]);
    *rules = each.flat_map(|(rule, times)| vec![rule; times]).collect();
    Made::new("a crowd of rules".to_owned(), system)
}

/// Systems for the fast route: the designs that fit, and random ones, every second of them for a twin table.
pub fn fast_systems(count: usize) -> Vec<Made> {
    let mut rng = Pcg64Mcg::seed_from_u64(4);
    let fits = |made: &Made| made.design("").rule_base().is_ok();
    let designs = designs().into_iter().filter(fits);
    let random = (0..count).map(|i| {
        let system = ruspini(&mut rng, i % 2 == 0);
        Made::new(format!("random table {i}"), system)
    });
    let all: Vec<Made> = designs.chain(random).collect();
    for made in &all {
        let base = made.design("").rule_base();
        assert!(base.is_ok(), "{}: {base:?}", made.name);
    }
    all
}

fn ruspini(rng: &mut impl Rng, twin: bool) -> System {
    let inputs: Vec<Input> = (0..2).map(|i| input(rng, i, twin)).collect();
    let count = if twin { 2 } else { rng.random_range(1..=3) };
    let outputs: Vec<Output> = (0..count).map(|i| output(rng, i)).collect();
    let mut rules = Vec::new();
    for row in 0..inputs[0].terms.len() {
        for column in 0..inputs[1].terms.len() {
            let is = |input, term| Antecedent::Is {
                input,
                term,
                negated: false,
            };
            let mut both = vec![is(0, row), is(1, column)];
            both.shuffle(rng);
            let conclusions = outputs.iter().enumerate();
            rules.push(Rule {
                antecedent: Antecedent::And(both),
                conclusions: conclusions
                    .map(|(o, output)| (o, rng.random_range(0..output.terms.len())))
                    .collect(),
                weight: 1.0,
                place: Place::default(),
            });
        }
    }
    rules.shuffle(rng);
    System {
        name: "table".to_owned(),
        description: String::new(),
        inputs,
        outputs,
        blocks: vec![RuleBlock {
            name: String::new(),
            description: String::new(),
            and: Conjunction::Min,
            implication: Conjunction::Min,
            rules,
        }],
    }
}

/// Terms in any order, peaks even or not.
fn input(rng: &mut impl Rng, index: usize, even: bool) -> Input {
    let count = rng.random_range(2..=5);
    let gap = rng.random_range(1..=400);
    let mut at = rng.random_range(-1000..1000);
    let mut peaks = vec![f64::from(at) / 8.0];
    for _ in 1..count {
        at += if even { gap } else { rng.random_range(1..=400) };
        peaks.push(f64::from(at) / 8.0);
    }
    let last = peaks.len() - 1;
    let mut terms: Vec<Term> = (0..=last)
        .map(|i| Term {
            name: format!("term{i}"),
            shape: match i {
                0 => Shape::Ramp {
                    from: peaks[1],
                    to: peaks[0],
                },
                i if i == last => Shape::Ramp {
                    from: peaks[i - 1],
                    to: peaks[i],
                },
                i => Shape::Triangle {
                    left: peaks[i - 1],
                    peak: peaks[i],
                    right: peaks[i + 1],
                },
            },
            place: Place::default(),
        })
        .collect();
    terms.shuffle(rng);
    Input {
        name: format!("input{index}"),
        description: String::new(),
        range: peaks[0] - 1.0..=peaks[last] + 1.0,
        clamp: rng.random_bool(0.5),
        terms,
        place: Place::default(),
    }
}

fn output(rng: &mut impl Rng, index: usize) -> Output {
    let most = 10.0_f64.powf(rng.random_range(-1.0..4.0));
    let count = rng.random_range(1..=6);
    let terms: Vec<OutputTerm> = (0..count)
        .map(|i| OutputTerm {
            name: format!("term{i}"),
            conclusion: Conclusion::Constant(rng.random_range(-most..=most)),
            place: Place::default(),
        })
        .collect();
    Output {
        name: format!("output{index}"),
        description: String::new(),
        clamp: rng.random_bool(0.5),
        default: None,
        defuzzifier: Defuzzifier::WeightedAverage,
        merge: Merge::Sum,
        terms,
        range: -most..=most,
        place: Place::default(),
    }
}
