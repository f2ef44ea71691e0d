//! What the formats leave open and how their tools write them.

use super::read;
use host_sim::fuzzy::files::Format;
use host_sim::fuzzy::model::{
    Antecedent, Conjunction, Defuzzifier, Merge, Sampling, Shape, System,
};

const FLL: &str = "\
Engine: dimmer
InputVariable: light
  enabled: true
  range: 0.000 1.000
  lock-range: false
  term: dark Triangle 0.000 0.250 0.500
  term: bright Ramp 0.500 1.000
InputVariable: noise
  range: 0.000 1.000
  term: low Ramp 1.000 0.000
  term: high Ramp 0.000 1.000
OutputVariable: lamp
  enabled: true
  range: 0.000 1.000
  aggregation: Maximum
  defuzzifier: Centroid
  term: weak Ramp 1.000 0.000
  term: strong Ramp 0.000 1.000
RuleBlock:
  conjunction: Minimum
  disjunction: Maximum
  implication: Minimum
  rule: if light is dark then lamp is strong
";

fn with_rule(rule: &str) -> System {
    read(&format!("{FLL}  rule: {rule}\n"), Format::Fll)
}

fn is(input: usize, term: usize, negated: bool) -> Antecedent {
    Antecedent::Is {
        input,
        term,
        negated,
    }
}

fn antecedent(system: &System) -> &Antecedent {
    &system
        .blocks
        .last()
        .unwrap()
        .rules
        .last()
        .unwrap()
        .antecedent
}

#[test]
fn and_binds_tighter_than_or_in_fll() {
    let system =
        with_rule("if light is dark or light is bright and noise is not high then lamp is weak");
    let wanted = Antecedent::Or(vec![
        is(0, 0, false),
        Antecedent::And(vec![is(0, 1, false), is(1, 1, true)]),
    ]);
    assert_eq!(*antecedent(&system), wanted);
    let system = with_rule(
        "if (light is dark or light is bright) and noise is not not high then lamp is weak",
    );
    let wanted = Antecedent::And(vec![
        Antecedent::Or(vec![is(0, 0, false), is(0, 1, false)]),
        is(1, 1, false),
    ]);
    assert_eq!(*antecedent(&system), wanted);
}

#[test]
fn what_fll_leaves_out_is_what_its_tools_take() {
    let system = read(FLL, Format::Fll);
    let output = &system.outputs[0];
    let samples = Defuzzifier::Centroid {
        points: 1000,
        sampling: Sampling::Middles,
    };
    assert_eq!(output.defuzzifier, samples);
    assert_eq!(output.default, None);
    assert!(!output.clamp && !system.inputs[1].clamp);
    assert_eq!(system.blocks[0].name, "");
    let sum = FLL.replace("aggregation: Maximum", "aggregation: none");
    let sum = sum.replace("defuzzifier: Centroid", "defuzzifier: WeightedAverage");
    let sum = sum.replace(
        "Ramp 1.000 0.000\n  term: strong Ramp 0.000 1.000",
        "Constant 0\n  term: strong Constant 1",
    );
    let sum = read(
        &sum.replace("implication: Minimum", "implication: none"),
        Format::Fll,
    );
    assert_eq!(sum.outputs[0].merge, Merge::Sum);
}

#[test]
fn line_ends_marks_comments_and_blanks_do_not_matter() {
    let wanted = read(FLL, Format::Fll);
    assert_eq!(read(&FLL.replace('\n', "\r\n"), Format::Fll), wanted);
    assert_eq!(read(&FLL.replace('\n', "\r"), Format::Fll), wanted);
    assert_eq!(read(&format!("\u{feff}{FLL}"), Format::Fll), wanted);
    let loose = FLL
        .replace('\n', "   # a comment: with a colon\n\n")
        .replace(": ", " :\t");
    assert_eq!(
        read(&loose, Format::Fll).without_places(),
        wanted.without_places()
    );
}

#[test]
fn heights_of_1_and_open_triangles_are_read() {
    let one = FLL.replace("0.250 0.500", "0.250 0.500 1.0");
    assert_eq!(read(&one, Format::Fll), read(FLL, Format::Fll));
    let open = FLL.replace("Triangle 0.000", "Triangle -inf");
    let wanted = Shape::Ramp {
        from: 0.5,
        to: 0.25,
    };
    assert_eq!(read(&open, Format::Fll).inputs[0].terms[0].shape, wanted);
}

#[test]
fn a_disabled_rule_block_does_not_count() {
    let more = format!(
        "{FLL}RuleBlock: off\n  enabled: false\n  rule: if light is bright then lamp is weak\n"
    );
    assert_eq!(read(&more, Format::Fll), read(FLL, Format::Fll));
}

/// An OR that is not supported does no harm where no rule uses it; MATLAB writes one into every Sugeno system.
#[test]
fn operators_matter_where_they_are_used() {
    let unused = FLL.replace("disjunction: Maximum", "disjunction: AlgebraicSum");
    assert_eq!(read(&unused, Format::Fll), read(FLL, Format::Fll));
}

/// As jFuzzyLogic's examples are written.
const FCL: &str = "\
FUNCTION_BLOCK tank // one block a file
VAR_INPUT
    level : REAL;
END_VAR
VAR_OUTPUT
    valve : REAL;
END_VAR
FUZZIFY level
    TERM low := (0,1) (4,0) ;
    TERM fine := TRIAN 2 5 8;
    TERM high := (6,0)(10,1);
END_FUZZIFY
DEFUZZIFY valve
    TERM shut := 0;
    TERM half := 0.5;
    TERM open := 1;
    METHOD : COGS;
    DEFAULT := 0;
    RANGE := (0..1);
END_DEFUZZIFY
RULEBLOCK No1
    AND : MIN;
    ACT : MIN;
    ACCU : MAX;
    RULE 1 : IF NOT (level IS low OR level IS high) THEN valve IS half;
    RULE 2 : IF level IS low THEN valve IS open;
    RULE drain : if level is high then valve is shut with 0.5;
END_RULEBLOCK
END_FUNCTION_BLOCK
";

#[test]
fn jfuzzylogic_is_read() {
    let system = read(FCL, Format::Fcl);
    assert_eq!(system.name, "tank");
    let level = &system.inputs[0];
    // It has no range: it spans its terms.
    assert_eq!(level.range, 0.0..=10.0);
    let shapes: Vec<&Shape> = level.terms.iter().map(|t| &t.shape).collect();
    let wanted = [
        &Shape::Ramp { from: 4.0, to: 0.0 },
        &Shape::Triangle {
            left: 2.0,
            peak: 5.0,
            right: 8.0,
        },
        &Shape::Ramp {
            from: 6.0,
            to: 10.0,
        },
    ];
    assert_eq!(shapes, wanted);
    assert_eq!(system.outputs[0].merge, Merge::Max);
    assert_eq!(system.outputs[0].range, 0.0..=1.0);
    let rules = &system.blocks[0].rules;
    // De Morgan.
    assert_eq!(
        rules[0].antecedent,
        Antecedent::And(vec![is(0, 0, true), is(0, 2, true)])
    );
    assert_eq!(rules[2].weight, 0.5);
}

#[test]
fn fuzzylites_fcl_is_read() {
    let text = FCL
        .replace("TRIAN", "Triangle")
        .replace("THEN valve IS half;", "THEN valve IS half")
        .replace("THEN valve IS open;", "THEN valve IS open")
        .replace("    ACCU : MAX;\n", "")
        .replace(
            "    TERM low",
            "    RANGE := (0.000 .. 10.000);\n    TERM low",
        )
        .replace("METHOD : COGS;", "METHOD : COGS;\n    ACCU : MAX;")
        .replace("No1", "");
    let mut wanted = read(FCL, Format::Fcl).without_places();
    wanted.blocks[0].name.clear();
    assert_eq!(read(&text, Format::Fcl).without_places(), wanted);
    let locked = text.replace("METHOD : COGS;", "METHOD : COGS;\n    LOCK : RANGE;");
    assert!(read(&locked, Format::Fcl).outputs[0].clamp);
}

/// As MATLAB writes a Mamdani system, and Octave a name.
const FIS: &str = "\
%% a comment
[System]
Name='Tank-Level'
Type='mamdani'
Version=2.0
NumInputs=1
NumOutputs=1
NumRules=2
AndMethod='prod'
OrMethod='probor'
ImpMethod='prod'
AggMethod='sum'
DefuzzMethod='centroid'

[Input1]
Name='water level'
Range=[0 10]
NumMFs=2
MF1='low':'gauss2mf',[1 0 2 3]
MF2='not low':'sigmf',[-2 6]

[Output1]
Name='valve'
Range=[0 3]
NumMFs=2
MF1='shut':'zmf',[0 1]
MF2='open':'gbellmf',[0.5, 2, 1]

[Rules]
1, 2 (1) : 1
-2.000, 1 (0.25) : 2
";

#[test]
fn matlab_is_read() {
    let system = read(FIS, Format::Fis);
    assert_eq!(system.inputs[0].name, "water level");
    assert!(!system.inputs[0].clamp && !system.outputs[0].clamp);
    let shapes = [
        system.inputs[0].terms[0].shape.clone(),
        system.inputs[0].terms[1].shape.clone(),
    ];
    let wanted = [
        Shape::TwoSidedGaussian {
            left: (0.0, 1.0),
            right: (3.0, 2.0),
        },
        Shape::Sigmoid {
            inflection: 6.0,
            slope: -2.0,
        },
    ];
    assert_eq!(shapes, wanted);
    let output = &system.outputs[0];
    let ends = Defuzzifier::Centroid {
        points: 101,
        sampling: Sampling::Ends,
    };
    assert_eq!(output.defuzzifier, ends);
    assert_eq!(output.default, Some(1.5));
    assert_eq!(output.merge, Merge::Sum);
    let block = &system.blocks[0];
    assert_eq!(
        (block.and, block.implication),
        (Conjunction::Product, Conjunction::Product)
    );
    assert_eq!(block.rules[1].antecedent, is(0, 1, true));
    assert_eq!(block.rules[1].weight, 0.25);
}

/// Each format has the numbers of its shapes in an order of its own.
#[test]
fn numbers_of_shapes_stand_where_each_format_has_them() {
    let gaussian = Shape::Gaussian {
        mean: 3.0,
        deviation: 0.5,
    };
    let two_sided = Shape::TwoSidedGaussian {
        left: (2.0, 0.25),
        right: (4.0, 0.75),
    };
    let bell = Shape::Bell {
        centre: 5.0,
        width: 2.0,
        slope: 3.0,
    };
    let sigmoid = Shape::Sigmoid {
        inflection: 6.0,
        slope: -2.0,
    };
    let s = Shape::Spline { from: 1.0, to: 2.0 };
    let z = Shape::Spline { from: 2.0, to: 1.0 };
    let up = Shape::Ramp { from: 1.0, to: 2.0 };
    let down = Shape::Ramp { from: 2.0, to: 1.0 };
    let block = Shape::Trapezoid {
        left: 1.0,
        rise: 1.0,
        fall: 2.0,
        right: 2.0,
    };
    let points = Shape::Points(vec![(0.0, 0.25), (1.0, 0.75), (1.0, 1.0)]);
    let upright = Shape::Triangle {
        left: 1.0,
        peak: 1.0,
        right: 2.0,
    };
    // At its end the last point counts: it is no rectangle, which has its end.
    let open = Shape::Points(vec![(1.0, 0.0), (1.0, 1.0), (2.0, 1.0), (2.0, 0.0)]);
    let fll = [
        ("Gaussian 3 0.5", &gaussian),
        ("GaussianProduct 2 0.25 4 0.75", &two_sided),
        ("Bell 5 2 3", &bell),
        ("Sigmoid 6 -2", &sigmoid),
        ("SShape 1 2", &s),
        ("ZShape 1 2", &z),
        ("Ramp 1 2", &up),
        ("Ramp 2 1", &down),
        ("Rectangle 1 2", &block),
        ("Rectangle 4 4", &Shape::Singleton(4.0)),
        ("Discrete 0 0.25 1 0.75 1 1", &points),
        ("Discrete 1 0 2 1", &up),
    ];
    for (text, wanted) in fll {
        let text = FLL.replace("Ramp 0.500 1.000", text);
        assert_eq!(read(&text, Format::Fll).inputs[0].terms[1].shape, *wanted);
    }
    let fcl = [
        ("GAUSS 3 0.5", &gaussian),
        ("GAUSS2 2 0.25 4 0.75", &two_sided),
        ("GBELL 2 3 5", &bell),
        ("Bell 5 2 3", &bell),
        ("SIGM -2 6", &sigmoid),
        ("Sigmoid 6 -2", &sigmoid),
        ("SShape 1 2", &s),
        ("ZShape 1 2", &z),
        ("(1, 1) (2, 0)", &down),
        ("(1, 0) (1, 1) (2, 1) (2, 0)", &open),
        ("TRAPE 1 1 2 2", &block),
        ("(1, 0) (1, 1) (2, 0)", &upright),
        ("TRIAN 1 1 2", &upright),
        ("4", &Shape::Singleton(4.0)),
        ("(0, 0.25) (1, 0.75) (1, 1)", &points),
    ];
    for (text, wanted) in fcl {
        let text = FCL.replace("TRIAN 2 5 8", text);
        let text = text.replace("level : REAL;", "level : REAL; RANGE := (0 .. 10);");
        assert_eq!(read(&text, Format::Fcl).inputs[0].terms[1].shape, *wanted);
    }
    let fis = [
        ("'gaussmf',[0.5 3]", &gaussian),
        ("'gauss2mf',[0.25 2 0.75 4]", &two_sided),
        ("'gbellmf',[2 3 5]", &bell),
        ("'sigmf',[-2 6]", &sigmoid),
        ("'smf',[1 2]", &s),
        ("'zmf',[1 2]", &z),
        ("'linsmf',[1 2]", &up),
        ("'linzmf',[1 2]", &down),
        ("'rectmf',[1 2]", &block),
        ("'discretemf',[0 0.25 1 0.75 1 1]", &points),
    ];
    for (text, wanted) in fis {
        let text = FIS.replace("'sigmf',[-2 6]", text);
        assert_eq!(read(&text, Format::Fis).inputs[0].terms[1].shape, *wanted);
    }
}

#[test]
fn fis_as_octave_may_write_it_is_read_the_same() {
    let text = include_str!("../../designs/cruise.fis");
    let plain = read(text, Format::Fis);
    let (head, rules) = text.split_once("[Rules]\n").unwrap();
    let rules: String = rules.lines().map(|rule| format!("{rule};\n")).collect();
    let head = head.replace('\'', "\"").replace("\"sugeno\"", "\"Sugeno\"");
    let written = format!("{head}[Rules]\n{rules}");
    assert!(written.contains("Type=\"Sugeno\"") && written.contains(": 1;\n"));
    assert_eq!(
        read(&written, Format::Fis).without_places(),
        plain.without_places()
    );
}
