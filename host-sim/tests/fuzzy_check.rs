//! `host-sim fuzzy check` can be trusted: what it does not see it does not call good, and what it cuts it writes elsewhere.

use assert_cmd::Command;
use host_sim::fuzzy::evaluate::{Evaluator, Exact};
use host_sim::fuzzy::files::load;
use host_sim::fuzzy::lower::lower;
use serde_json::Value;
use std::fmt::Write;
use std::fs;
use std::path::Path;
use tempfile::{TempDir, tempdir};

/// Two sets between the samples at 0.05, 0.15, …, one beyond the range.
const NARROW: &str = "\
Engine: narrow
InputVariable: x
  range: 0 10
  lock-range: true
  term: low Ramp 10 0
  term: high Ramp 0 10
OutputVariable: y
  range: 0 10
  lock-range: true
  aggregation: Maximum
  defuzzifier: Centroid 100
  default: nan
  term: a Triangle 2.96 2.98 3.04
  term: b Triangle 7.01 7.02 7.04
  term: off Triangle 12 13 14
RuleBlock: rules
  conjunction: Minimum
  disjunction: Maximum
  implication: Minimum
  activation: General
  rule: if x is low then y is a
  rule: if x is high then y is b
  rule: if x is not low then y is off
";

/// Nothing keeps its output in its range.
const LINEAR: &str = "\
Engine: linear
InputVariable: x
  range: 0 10
  lock-range: true
  term: low Ramp 10 0
  term: high Ramp 0 10
OutputVariable: y
  range: 0 1
  aggregation: UnboundedSum
  defuzzifier: WeightedAverage TakagiSugeno
  default: 0
  term: far Constant 500
  term: line Linear 3 9
OutputVariable: z
  range: 0 1
  aggregation: UnboundedSum
  defuzzifier: WeightedAverage TakagiSugeno
  default: 0
  term: one Constant 1
RuleBlock: rules
  conjunction: Minimum
  disjunction: Maximum
  implication: Minimum
  activation: General
  rule: if x is low then y is far
  rule: if x is high then y is line
";

fn sim(dir: &Path) -> Command {
    let mut command = Command::new(assert_cmd::cargo::cargo_bin!("host-sim"));
    command
        .current_dir(dir)
        .arg("fuzzy")
        .timeout(std::time::Duration::from_secs(300));
    command
}

/// Its exit code, what it prints, and what it complains of.
fn run(dir: &TempDir, args: &[&str]) -> (i32, String, String) {
    let output = sim(dir.path()).args(args).output().unwrap();
    let text = |bytes| String::from_utf8(bytes).unwrap();
    (
        output.status.code().unwrap(),
        text(output.stdout),
        text(output.stderr),
    )
}

fn with(text: &str) -> TempDir {
    let dir = tempdir().unwrap();
    fs::write(dir.path().join("design.fll"), text).unwrap();
    dir
}

fn json(dir: &TempDir, file: &str) -> Value {
    serde_json::from_slice(&fs::read(dir.path().join(file)).unwrap()).unwrap()
}

#[test]
fn sets_that_meet_no_sample_conclude_nothing() {
    let dir = with(NARROW);
    let (code, printed, said) = run(
        &dir,
        &["check", "design.fll", "--deny", "gaps,unreachable-terms"],
    );
    assert_eq!(code, 1);
    assert!(said.contains("gaps, unreachable-terms: found"), "{said}");
    for part in [
        "│ y      ┆ everywhere ┆ 100 % ┆ x = 5       │",
        "line 13: y is a   ┆ no sample meets it",
        "line 14: y is b   ┆ no sample meets it",
        "line 15: y is off ┆ no sample meets it",
        "no fixed point: line 13",
    ] {
        assert!(printed.contains(part), "`{part}` not in {printed}");
    }
    let (_, printed, _) = run(&dir, &["eval", "design.fll", "--input", "x=5"]);
    assert!(printed.contains("no value: the concluded sets meet no sample"));
    for to in ["rust", "c"] {
        let (code, _, said) = run(
            &dir,
            &["convert", "design.fll", "--to", to, "--out", "made.c"],
        );
        assert_eq!(code, 2);
        for part in ["line 13", "`a`", "100 samples", "`y`"] {
            assert!(said.contains(part), "`{part}` not in {said}");
        }
        assert!(!dir.path().join("made.c").exists());
    }
}

#[test]
fn where_only_an_empty_set_is_concluded_there_is_a_gap() {
    let wide = NARROW
        .replace("2.96 2.98 3.04", "2 3 4")
        .replace("if x is high then y is b", "if x is low then y is b")
        .replace("7.01 7.02 7.04", "6 7 8");
    let (_, printed, _) = run(&with(&wide), &["check", "design.fll", "--points", "100"]);
    assert!(printed.contains("x: exactly 10"), "{printed}");
    assert!(!printed.contains("everywhere"), "{printed}");
    // As soon as it reaches a sample there is none.
    let met = wide.replace("12 13 14", "9 13 14");
    let (code, printed, _) = run(
        &with(&met),
        &["check", "design.fll", "--points", "100", "--deny", "gaps"],
    );
    assert_eq!(code, 0, "{printed}");
}

/// All but a sliver of `x0` has a rule, and in that so many rules cross that no search sees its end.
fn crossing() -> String {
    let mut text = "Engine: crossing\n".to_owned();
    for input in 0..4 {
        let _ = writeln!(text, "InputVariable: x{input}\n  range: 0 1");
        for term in 0..60 {
            let left = f64::from(term) / 60.0;
            let (peak, right) = (left + 0.004, left + 0.008);
            let _ = writeln!(text, "  term: t{term} Triangle {left} {peak} {right}");
        }
    }
    text = text.replacen(
        "  term: t0 ",
        "  term: below Ramp 0.501 0.4\n  term: above Ramp 0.502 0.6\n  term: t0 ",
        1,
    );
    // Too far for fixed point, which is not what this is about.
    text += "OutputVariable: y\n  range: 1e12 1000000000001\n  aggregation: UnboundedSum\n  \
             defuzzifier: WeightedAverage TakagiSugeno\n  default: nan\n  term: one Constant 1e12\n";
    text += "RuleBlock: rules\n  conjunction: Minimum\n  disjunction: Maximum\n  implication: Minimum\n  \
             activation: General\n  rule: if x0 is below then y is one\n  rule: if x0 is above then y is one\n";
    for (a, b) in (0..3600).map(|i| (i / 60, i % 60)) {
        if (a * 31 + b * 17 + a * b * 13) % 5 == 0 {
            for (one, other) in [(1, 2), (2, 3), (3, 1)] {
                let _ = writeln!(
                    text,
                    "  rule: if x{one} is t{a} and x{other} is t{b} then y is one"
                );
            }
        }
    }
    text
}

#[test]
fn a_denied_finding_that_is_not_looked_for_everywhere_fails() {
    let dir = with(&crossing());
    let args = [
        "check",
        "design.fll",
        "--points",
        "16",
        "--json",
        "all.json",
    ];
    let (code, printed, said) = run(&dir, &[&args[..], &["--deny", "gaps"]].concat());
    assert!(
        printed
            .contains("as 16 points of 16 show them (too many pieces for the exact search): none"),
        "{printed}"
    );
    assert_eq!(json(&dir, "all.json")["search"], "sampled");
    assert_eq!(code, 1);
    assert!(
        said.contains("gaps (looked for at the grid's points only): could not be checked"),
        "{said}"
    );
    assert_eq!(run(&dir, &args).0, 0);
    // What the points show is found all the same.
    fs::write(
        dir.path().join("design.fll"),
        crossing().replace("  rule: if x0 is above then y is one\n", ""),
    )
    .unwrap();
    let (code, _, said) = run(&dir, &[&args[..], &["--deny", "gaps"]].concat());
    assert_eq!(code, 1);
    assert!(said.contains("gaps: found"), "{said}");
    assert_eq!(json(&dir, "all.json")["gaps"][0]["share"], 0.5);
}

#[test]
fn conclusions_beyond_the_range_are_found_and_named_in_what_is_made() {
    let dir = with(LINEAR);
    let args = [
        "check",
        "design.fll",
        "--points",
        "100",
        "--deny",
        "beyond-range",
    ];
    let (code, printed, said) = run(&dir, &args);
    assert_eq!(code, 1, "{said}");
    assert!(said.contains("beyond-range: found"), "{said}");
    for part in [
        "conclusions beyond the range: 2",
        "line 12: y is far  ┆ 500       ┆ 0 to 1",
        "line 13: y is line ┆ 9 to 39   ┆ 0 to 1",
        "the output leaves its range",
    ] {
        assert!(printed.contains(part), "`{part}` not in {printed}");
    }
    let convert = ["convert", "design.fll", "--to"];
    let (_, made, _) = run(&dir, &[&convert[..], &["rust"]].concat());
    assert!(
        made.contains("by `far` (500), `line` (9 to 39) |"),
        "{made}"
    );
    assert!(made.contains("range: [-LIMIT, LIMIT],\n            clamp: true"));
    // The other output cannot leave its range: the compiler proves it again.
    assert!(made.contains("range: [q16(\"0\"), q16(\"1\")],\n            clamp: false"));
    let (code, ..) = run(&dir, &[&convert[..], &["c", "--out", "made.c"]].concat());
    assert_eq!(code, 0);
    let header = fs::read_to_string(dir.path().join("made.h")).unwrap();
    assert!(header.contains("values may be beyond by `far` (500), `line` (9 to 39)"));
    // Nothing is said of the error of what has no value.
    assert!(header.contains("- z: no rule concludes it\n"), "{header}");
    // Within the range nothing is found.
    let inside = LINEAR.replace("range: 0 1\n", "range: 0 500\n");
    let (code, _, said) = run(&with(&inside), &args);
    assert_eq!(code, 0, "{said}");
}

#[test]
fn without_a_table_turns_are_looked_for_on_the_grid() {
    let designs = concat!(env!("CARGO_MANIFEST_DIR"), "/designs/");
    let dir = tempdir().unwrap();
    for (design, why, turns) in [
        (
            "watering.fcl",
            "minutes: no table: rule 1 (line 40) has an OR",
            true,
        ),
        (
            "greenhouse.fll",
            "vents: no table: 4 inputs make no table",
            true,
        ),
        (
            "cruise.fis",
            "rule 1 (line 42) does not ask about each input once",
            false,
        ),
    ] {
        let file = format!("{designs}{design}");
        let (code, printed, said) = run(
            &dir,
            &[
                "check",
                &file,
                "--points",
                "10000",
                "--deny",
                "non-monotone",
            ],
        );
        assert_eq!(code, i32::from(turns), "{design}: {said}");
        assert!(printed.contains(why), "{printed}");
        assert!(printed.contains("of the range, sampled"), "{printed}");
    }
}

#[test]
fn what_the_lists_cut_is_in_the_file() {
    let mut spare = String::new();
    for i in 0..30 {
        let _ = writeln!(spare, "  term: spare{i} Triangle 4 5 6");
    }
    let dir = with(&NARROW.replace("RuleBlock:", &format!("{spare}RuleBlock:")));
    let args = [
        "check",
        "design.fll",
        "--points",
        "100",
        "--json",
        "all.json",
    ];
    let (code, printed, _) = run(
        &dir,
        &[&args[..], &["--deny", "unreachable-terms"]].concat(),
    );
    assert_eq!(code, 1);
    assert!(printed.contains("unreachable terms: 33\n"), "{printed}");
    assert!(
        printed.contains("… and 13 more; --json FILE writes all"),
        "{printed}"
    );
    let all = json(&dir, "all.json");
    let terms = all["unreachable_terms"].as_array().unwrap();
    assert_eq!(terms.len(), 33);
    assert_eq!(terms[32]["term"], "y is spare29");
    assert_eq!(terms[32]["line"], 45);
    assert_eq!(all["search"], "exact");
    assert_eq!(all["gaps"][0]["example"]["x"], 5.0);
}

/// A flank of 0.6 on a range of 10,000, beside a weak rule that holds everywhere.
const STEEP: &str = "\
Engine: steep
InputVariable: x
  range: 0 10000
  term: low ZShape 3006.6 3007.2
  term: all Trapezoid -1 0 10000 10001
OutputVariable: y
  range: 0 100
  defuzzifier: WeightedAverage
  term: p Constant 0
  term: q Constant 100
RuleBlock: r
  activation: General
  rule: if x is low then y is q
  rule: if x is all then y is p with 0.05
";

#[test]
fn nowhere_above_holds_on_a_flank_between_the_points_of_the_grid() {
    for (text, from, to) in [
        (STEEP.to_owned(), 3006.6, 3007.2),
        (
            STEEP.replace("ZShape 3006.6 3007.2", "Bell 3006.9 0.05 3"),
            3006.6,
            3007.2,
        ),
    ] {
        let dir = with(&text);
        let (code, _, said) = run(&dir, &["check", "design.fll", "--json", "all.json"]);
        assert_eq!(code, 0, "{said}");
        let all = json(&dir, "all.json");
        let bound = all["errors"][0]["classes"][3]["nowhere_above"]
            .as_f64()
            .unwrap();
        let system = load(&dir.path().join("design.fll"), None).unwrap();
        let (exact, fixed) = (Exact::new(&system), lower(&system).unwrap());
        let worst = (0..=5000)
            .map(|i| from + (to - from) * f64::from(i) / 5000.0)
            .map(|x| [exact.evaluate(&[x]), fixed.evaluate(&[x])].map(|e| e.outputs[0].unwrap()))
            .map(|[exact, fixed]| (exact - fixed).abs())
            .fold(0.0, f64::max);
        assert!(
            0.1 * bound < worst && worst <= bound,
            "{worst}, {bound}: {text}"
        );
    }
}

/// Rules that end in a strip of 0.2 beside a gap: no even grid has a point where they are weak.
const HEATER: &str = "\
Engine: heater
InputVariable: t
  range: 0 100
  term: cold Ramp 20.7 20.5
  term: hot Ramp 30.5 30.7
InputVariable: h
  range: 0 100
  term: dry Ramp 40.4 40.2
OutputVariable: y
  range: 0 100
  default: 50
  defuzzifier: WeightedAverage
  term: p Constant 0
  term: q Constant 100
RuleBlock: r
  conjunction: Minimum
  activation: General
  rule: if t is cold and h is dry then y is p
  rule: if t is hot then y is q
";

#[test]
fn a_bound_is_told_where_no_point_of_the_grid_is() {
    let dir = with(HEATER);
    let args = ["check", "design.fll", "--json", "all.json"];
    let (code, printed, _) = run(&dir, &args);
    assert_eq!(code, 0);
    let all = json(&dir, "all.json");
    let classes = all["errors"][0]["classes"].as_array().unwrap();
    assert_eq!(
        classes[3]["points"], classes[2]["points"],
        "or this tests nothing"
    );
    let bound = classes[3]["nowhere_above"].as_f64().unwrap();
    assert!((50.0..50.01).contains(&bound), "{bound}");
    let row = printed
        .lines()
        .find(|line| line.contains(" > 0 ┆"))
        .expect(&printed);
    assert!(row.contains("5.0e1") && row.contains("50 %"), "{row}");
    let (code, _, said) = run(&dir, &[&args[..], &["--max-error", "1"]].concat());
    assert_eq!(code, 1, "{said}");
    assert!(said.contains("y 50 % (> 0)"), "{said}");
    let (code, ..) = run(&dir, &[&args[..], &["--max-error", "51"]].concat());
    assert_eq!(code, 0);
    // The default is what fixed point may take there, and is here what the rules say.
    let near = HEATER
        .replace("default: 50", "default: 0")
        .replace("  rule: if t is hot then y is q\n", "");
    let (code, _, said) = run(&with(&near), &["check", "design.fll", "--max-error", "1"]);
    assert_eq!(code, 0, "{said}");
}

/// Rises to 1 and falls to 0.5, whatever the row of the second rule about `b` says.
const HILL: &str = "\
Engine: hill
InputVariable: x
  range: 0 2
  term: a Triangle -1 0 1
  term: b Triangle 0 1 2
  term: c Triangle 1 2 3
OutputVariable: y
  range: 0 1
  defuzzifier: WeightedAverage
  term: o0 Constant 0
  term: o4 Constant 0.4
  term: o5 Constant 0.5
  term: o1 Constant 1
RuleBlock: r
  activation: General
  rule: if x is a then y is o0
  rule: if x is b then y is o1
  rule: if x is b then y is o4 with 0
  rule: if x is c then y is o5
";

#[test]
fn an_output_that_turns_is_not_called_monotone_by_its_table() {
    let nested = "\
Engine: nested
InputVariable: x
  range: 0 10
  term: narrow Triangle 4.9 5 5.1
  term: wide Triangle -10 5.05 20
OutputVariable: y
  range: 0 1
  defuzzifier: WeightedAverage
  term: zero Constant 0
  term: one Constant 1
RuleBlock: r
  activation: General
  rule: if x is narrow then y is zero
  rule: if x is wide then y is one
";
    let check = ["check", "design.fll", "--deny", "non-monotone"];
    for (text, parts) in [
        // A rule without a weight says nothing.
        (
            HILL.to_owned(),
            ["non-monotone cells: 1\n", "a 0 → b 1 → c 0.5"],
        ),
        // Two in a cell are neither of them.
        (
            HILL.replace(" with 0", ""),
            [
                "y: no table: rule 2 (line 17) and rule 3 (line 18) ask the same",
                "sampled: 1\n",
            ],
        ),
        // A term inside another one.
        (
            nested.to_owned(),
            ["non-monotone cells: none\n", "sampled: 1\n"],
        ),
    ] {
        let (code, printed, said) = run(&with(&text), &check);
        assert_eq!(code, 1, "{printed}");
        assert!(said.contains("non-monotone: found"), "{said}");
        for part in parts {
            assert!(printed.contains(part), "`{part}` not in {printed}");
        }
    }
    let slope = HILL
        .replace("  rule: if x is b then y is o4 with 0\n", "")
        .replace("c then y is o5", "c then y is o1");
    let (code, printed, _) = run(&with(&slope), &check);
    assert_eq!(code, 0, "{printed}");
}

#[test]
fn examples_are_not_rounded_out_of_what_they_are_examples_of() {
    let text = "\
Engine: edge
InputVariable: x
  range: 0 10
  term: lo Trapezoid -1 0 4.999 5.0000003
  term: hi Trapezoid 5.0000003 5.001 10 11
OutputVariable: y
  range: 0 100
  default: 0
  defuzzifier: WeightedAverage
  term: p Constant 100
RuleBlock: r
  activation: General
  rule: if x is lo then y is p
  rule: if x is hi then y is p
";
    let dir = with(text);
    let (_, printed, _) = run(&dir, &["check", "design.fll", "--json", "all.json"]);
    assert!(printed.contains("┆ x = 5.0000003 "), "{printed}");
    let all = json(&dir, "all.json");
    assert_eq!(all["gaps"][0]["example"]["x"], 5.0000003);
    let at = all["errors"][0]["classes"][3]["at"]["x"].as_f64().unwrap();
    assert!(printed.contains(&format!("┆ x = {at} ")), "{printed}");
}

/// `f64` has no digits left of a degree of 5e-324, and what it makes of a quotient of two is no measure for anything.
#[test]
fn degrees_that_f64_hardly_has_are_not_compared() {
    let tails = "Engine: tail\nInputVariable: x\n  range: 0 100\n  term: low Gaussian 0 1\n  term: high Gaussian 100 1\n\
         OutputVariable: y\n  range: 0 20\n  defuzzifier: WeightedAverage\n  default: 0\n\
         term: p Constant 10.7\n  term: q Constant 15.4\n\
         RuleBlock: r\n  activation: General\n  rule: if x is low then y is p\n  rule: if x is high then y is q\n";
    let args = ["check", "design.fll", "--points", "20000"];
    let (code, printed, said) = run(&with(tails), &args);
    assert_eq!((code, &said[..]), (0, ""), "{printed}");
    // 10.7 all along its tail, whatever the last digits say: nothing there rises and falls.
    assert!(!printed.contains("11 at"), "{printed}");
}

/// A tooth that ends in a jump, far narrower than a box of three inputs: 11 % off where `check` once saw nothing.
#[test]
fn a_tooth_between_all_points_counts_for_max_error() {
    let input = |name: &str, more: &str| {
        let terms: String = (0..9)
            .map(|i| {
                let [left, peak, right] = [i - 1, i, i + 1].map(|i| f64::from(i) / 8.0);
                format!("  term: t{i} Triangle {left} {peak} {right}\n")
            })
            .collect();
        format!("InputVariable: {name}\n  range: 0 1\n{terms}{more}")
    };
    let tooth =
        "  term: saw Discrete 0 0 0.30714 0 0.3072 1 0.3072 0 1 0\n  term: all Ramp -2 -1\n";
    let asks: String = ["a", "b", "c"]
        .iter()
        .flat_map(|name| {
            (0..9).map(move |i| format!("  rule: if {name} is t{i} then y is lo with 0.001\n"))
        })
        .collect();
    let saw = format!(
        "Engine: saw\n{}{}{}OutputVariable: y\n  range: 0 100\n  defuzzifier: WeightedAverage\n  term: lo Constant 0\n  \
         term: hi Constant 100\nRuleBlock: r\n  conjunction: Minimum\n  activation: General\n  \
         rule: if a is saw then y is hi\n  rule: if a is all then y is lo with 0.5\n{asks}",
        input("a", tooth),
        input("b", ""),
        input("c", ""),
    );
    let (code, _, said) = run(&with(&saw), &["check", "design.fll", "--max-error", "1"]);
    assert_eq!(code, 1);
    assert!(said.contains("--max-error allows 1 %"), "{said}");
}

/// 4,096 rules about sets of which the largest counts: fewer points, and it says so.
#[test]
fn thousands_of_rules_get_fewer_points_and_it_is_said() {
    let axis = |name: &str, kind: &str, count: i32, step: f64| -> String {
        (0..count)
            .map(|i| {
                let [left, peak, right] = [i - 1, i, i + 1].map(|i| f64::from(i) * step);
                format!(
                    "  term: {name}{i} {kind} {}\n",
                    match kind {
                        "Gaussian" => format!("{peak} {}", step / 2.0),
                        _ => format!("{left} {peak} {right}"),
                    }
                )
            })
            .collect()
    };
    let mut text = "Engine: many\n".to_owned();
    for name in ["a", "b"] {
        text += &format!(
            "InputVariable: {name}\n  range: 0 63\n{}",
            axis("t", "Gaussian", 64, 1.0)
        );
    }
    text += &format!(
        "OutputVariable: y\n  range: 0 100\n  aggregation: Maximum\n  defuzzifier: Centroid 100\n{}\
         RuleBlock: r\n  conjunction: Minimum\n  implication: Minimum\n  activation: General\n",
        axis("o", "Triangle", 11, 10.0)
    );
    for i in 0..64 {
        for j in 0..64 {
            text += &format!(
                "  rule: if a is t{i} and b is t{j} then y is o{}\n",
                (i + j) * 10 / 126
            );
        }
    }
    let begin = std::time::Instant::now();
    let (code, printed, said) = run(&with(&text), &["check", "design.fll"]);
    assert_eq!((code, &said[..]), (0, ""), "{printed}");
    let thinner = "points (of 100000 that were asked for; each takes long, with so many rules and samples; \
                   too few for the terms' corners, which are left out):";
    assert!(printed.contains(thinner), "{printed}");
    // Some seconds on two idle cores; nothing waits for minutes.
    assert!(begin.elapsed().as_secs() < 100, "{:?}", begin.elapsed());
}
