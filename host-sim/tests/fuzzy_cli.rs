//! `host-sim fuzzy check`, `eval` and `surface` from outside: what they print and write, exit codes, and what they say of
//! wrong input.

use assert_cmd::Command;
use host_sim::fuzzy::evaluate::{Evaluator, Exact};
use host_sim::fuzzy::files::load;
use std::fs;
use std::path::Path;
use tempfile::{TempDir, tempdir};

/// One of everything that `check` looks for.
const BOILER: &str = "\
Engine: boiler
InputVariable: error
  range: -10 10
  term: cold Triangle 0 10 20
  term: right Triangle -5 0 5
  term: hot Ramp -2 -8
InputVariable: load
  range: 0 1
  lock-range: true
  term: light Trapezoid 0 0 0.2 0.4
  term: heavy Trapezoid 0.5 0.8 1 1
  term: extreme Triangle 1.2 1.5 1.8
OutputVariable: valve
  range: 0 100
  lock-range: true
  aggregation: Maximum
  defuzzifier: Centroid 100
  default: nan
  term: shut Triangle 0 0 30
  term: half Triangle 20 50 80
  term: open Triangle 70 100 100
  term: spare Triangle 40 45 50
RuleBlock: rules
  conjunction: Minimum
  disjunction: Maximum
  implication: Minimum
  activation: General
  rule: if error is cold then valve is open
  rule: if error is cold and load is heavy then valve is open
  rule: if error is right then valve is half
  rule: if load is extreme then valve is shut
  rule: if error is hot and load is light then valve is shut
";

const FAN: &str = concat!(env!("CARGO_MANIFEST_DIR"), "/designs/fan.fll");
const GREENHOUSE: &str = concat!(env!("CARGO_MANIFEST_DIR"), "/designs/greenhouse.fll");

fn sim(dir: &Path) -> Command {
    let mut command = Command::new(assert_cmd::cargo::cargo_bin!("host-sim"));
    command
        .current_dir(dir)
        .arg("fuzzy")
        .timeout(std::time::Duration::from_secs(120));
    command
}

/// Runs it and gives stdout back; nothing may appear on stderr.
fn done(dir: &Path, args: &[&str]) -> String {
    let output = sim(dir).args(args).assert().success().stderr("");
    String::from_utf8(output.get_output().stdout.clone()).unwrap()
}

/// Runs it, expects one line on stderr with every one of `parts` in it, and that the folder stays as it was.
fn refused(dir: &Path, args: &[&str], parts: &[&str]) {
    let before = names(dir);
    let output = sim(dir).args(args).assert().code(2).stdout("");
    let said = String::from_utf8(output.get_output().stderr.clone()).unwrap();
    assert_eq!(said.lines().count(), 1, "{args:?}: {said}");
    for part in parts {
        assert!(said.contains(part), "{args:?}: `{part}` not in {said}");
    }
    assert_eq!(names(dir), before, "{args:?} left something behind");
}

fn names(dir: &Path) -> Vec<String> {
    let mut names: Vec<String> = fs::read_dir(dir)
        .unwrap()
        .map(|e| e.unwrap().file_name().to_string_lossy().into_owned())
        .collect();
    names.sort();
    names
}

fn with(text: &str) -> TempDir {
    let dir = tempdir().unwrap();
    fs::write(dir.path().join("design.fll"), text).unwrap();
    dir
}

/// A printed table's rows, cell by cell.
fn rows(printed: &str) -> Vec<Vec<String>> {
    let rows = printed.lines().filter(|line| line.starts_with('│'));
    rows.map(|line| {
        line.trim_matches('│')
            .split('┆')
            .map(|cell| cell.trim().to_owned())
            .collect()
    })
    .collect()
}

#[test]
fn a_point_shows_both_values_and_the_rules_that_fire() {
    let dir = tempdir().unwrap();
    let said = done(
        dir.path(),
        &[
            "eval",
            FAN,
            "--input",
            "temperature=28",
            "--input",
            "humidity=55",
        ],
    );
    let rows = rows(&said);
    let output = rows.iter().find(|row| row[0] == "fan").unwrap();
    assert_eq!(output[1..], ["45", "45", "+0.0e0"]);
    let fired: Vec<&Vec<String>> = rows
        .iter()
        .filter(|row| row.last().unwrap().starts_with("if "))
        .collect();
    assert_eq!(fired.len(), 4);
    assert!(
        fired
            .iter()
            .all(|row| row[1] == "0.5000" && row[2] == "0.5000")
    );
}

/// A range a millionth of where it lies, and a default in its middle.
const FAR: &str = "\
Engine: far
InputVariable: Größe
  range: 1000000 1000001
  lock-range: true
  term: small Ramp 1000001 1000000
  term: large Ramp 1000000 1000001
OutputVariable: out
  range: 1000000 1000001
  lock-range: true
  aggregation: none
  defuzzifier: WeightedAverage TakagiSugeno
  default: 1000000.5
  term: low Constant 1000000.3
  term: follow Linear 1 0.5
RuleBlock: rules
  conjunction: Minimum
  disjunction: Maximum
  implication: Minimum
  activation: General
  rule: if Größe is small then out is low
  rule: if Größe is large then out is follow with 0.1234567
";

#[test]
fn numbers_are_told_as_far_as_they_matter() {
    let dir = with(FAR);
    let at = "Größe=1000000.5123456";
    let said = done(dir.path(), &["eval", "design.fll", "--input", at]);
    assert!(said.contains("far at Größe = 1000000.5123456\n"), "{said}");
    assert!(said.contains("with 0.1234567 "), "{said}");
    let rows = rows(&said);
    assert_eq!(rows[1][..2], ["Größe", "1000000.5123456"]);
    let output = rows.iter().find(|row| row[0] == "out").unwrap();
    let number = |cell: usize| output[cell].parse::<f64>().unwrap();
    let system = load(&dir.path().join("design.fll"), None).unwrap();
    let exact = Exact::new(&system).evaluate(&[1_000_000.512_345_6]);
    assert!((number(1) - exact.outputs[0].unwrap()).abs() < 1e-4);
    // Both values and their difference agree.
    assert!(number(3) != 0.0 && output[1] != output[2], "{output:?}");
    assert!(
        (number(2) - number(1) - number(3)).abs() < 2e-4,
        "{output:?}"
    );
    // What is drawn and written as code says the file's numbers, too.
    done(dir.path(), &["surface", "design.fll", "--out", "."]);
    let svg = fs::read_to_string(dir.path().join("design-memberships.svg")).unwrap();
    assert!(svg.contains("follow: 1·Größe + 0.5"), "{svg}");
    done(
        dir.path(),
        &["convert", "design.fll", "--to", "c", "--out", "far.c"],
    );
    let header = fs::read_to_string(dir.path().join("far.h")).unwrap();
    assert!(
        header.contains("/* Where no rule fires: 1000000.5. */"),
        "{header}"
    );
}

/// A text of a picture: what it says, and about where it stands, in the picture's own units.
#[derive(Debug)]
struct Text {
    says: String,
    x: [f64; 2],
    y: [f64; 2],
}

impl Text {
    fn overlaps(&self, other: &Self) -> bool {
        let apart = |a: [f64; 2], b: [f64; 2]| a[1] <= b[0] || b[1] <= a[0];
        !apart(self.x, other.x) && !apart(self.y, other.y)
    }
}

fn texts(svg: &str) -> Vec<Text> {
    let read = |part: &str| {
        let (head, rest) = part.split_once('>').unwrap();
        let says = rest.split("</text>").next().unwrap().trim().to_owned();
        let word = |name: &str| {
            let (_, rest) = head.split_once(&format!(" {name}=\"")).unwrap();
            rest.split('"').next().unwrap()
        };
        let number = |name: &str| word(name).parse::<f64>().unwrap();
        let size = number("font-size");
        // As wide as the face's digits.
        let width = 0.55 * size * says.chars().count() as f64;
        // Its top stands at y, or its middle.
        let below = if word("dy") == "0.76em" {
            0.4 * size
        } else {
            0.0
        };
        let [x, y] = [number("x"), number("y") + below];
        let half = |middle: f64, of: f64| [middle - of / 2.0, middle + of / 2.0];
        let (x, y) = match (head.contains("rotate"), word("text-anchor")) {
            (true, _) => (half(x, 0.7 * size), half(y, width)),
            (false, "middle") => (half(x, width), half(y, 0.7 * size)),
            (false, "end") => ([x - width, x], half(y, 0.7 * size)),
            (false, _) => ([x, x + width], half(y, 0.7 * size)),
        };
        Text { says, x, y }
    };
    svg.split("<text").skip(1).map(read).collect()
}

#[test]
fn long_numbers_in_pictures_stand_clear_of_each_other_and_of_the_edge() {
    let input = FAR.find("InputVariable").unwrap();
    let output = FAR.find("OutputVariable").unwrap();
    let second = FAR[input..output].replace("Größe", "second");
    let text = FAR.replace("Linear 1 0.5", "Linear 0.5 0.5 0");
    let dir = with(&text.replace("OutputVariable", &format!("{second}OutputVariable")));
    done(dir.path(), &["surface", "design.fll", "--out", "."]);
    for (file, least) in [("design-out.svg", 20), ("design-memberships.svg", 30)] {
        let svg = fs::read_to_string(dir.path().join(file)).unwrap();
        let texts = texts(&svg);
        let numbers: Vec<&Text> = texts
            .iter()
            .filter(|text| text.says.starts_with("100000"))
            .collect();
        assert!(numbers.len() >= least, "{file}: {}", numbers.len());
        for (index, text) in numbers.iter().enumerate() {
            // The picture is 1200 pixels wide, eight units each.
            assert!(text.x[0] >= 0.0 && text.x[1] <= 9600.0, "{file}: {text:?}");
            let others = numbers[index + 1..].iter().copied();
            let names = texts.iter().filter(|text| !text.says.starts_with("100000"));
            for other in others.chain(names) {
                assert!(!text.overlaps(other), "{file}: {text:?} and {other:?}");
            }
        }
    }
}

#[test]
fn where_no_rule_fires_it_says_so() {
    let dir = with(BOILER);
    let said = done(
        dir.path(),
        &[
            "eval",
            "design.fll",
            "--input",
            "error=-9",
            "--input",
            "load=0.45",
        ],
    );
    let rows = rows(&said);
    assert_eq!(
        rows.iter().find(|row| row[0] == "valve").unwrap()[1],
        "no rule fires"
    );
    assert_eq!(rows.iter().find(|row| row[0] == "load").unwrap()[2], "none");
}

#[test]
fn a_value_outside_its_range_is_told_with_what_follows() {
    let dir = with(BOILER);
    let eval = |more: &[&str]| done(dir.path(), &[&["eval", "design.fll"][..], more].concat());
    let open = "error lies outside -10 to 10: the announced error does not hold there\n";
    let said = eval(&["--input", "error=12", "--input", "load=1.5"]);
    assert!(said.contains(open), "{said}");
    assert!(
        said.contains("load lies outside 0 to 1: it counts as 1\n"),
        "{said}"
    );
    let grid = ["--input", "error=12", "--grid", "3", "--csv", "all.csv"];
    let said = eval(&grid);
    assert_eq!(said, format!("all.csv: rows: 3\n{open}"));
    let said = eval(&["--input", "error=10", "--input", "load=0"]);
    assert!(!said.contains("lies outside"), "{said}");
}

#[test]
fn a_grid_is_the_whole_surface() {
    let dir = tempdir().unwrap();
    let said = done(
        dir.path(),
        &[
            "eval", GREENHOUSE, "--input", "wind=3", "--grid", "6", "--csv", "all.csv",
        ],
    );
    assert_eq!(said, "all.csv: rows: 216\n");
    let system = load(Path::new(GREENHOUSE), None).unwrap();
    let exact = Exact::new(&system);
    let mut reader = csv::Reader::from_path(dir.path().join("all.csv")).unwrap();
    let header: Vec<String> = reader
        .headers()
        .unwrap()
        .iter()
        .map(str::to_owned)
        .collect();
    let inputs = system.inputs.len();
    assert_eq!(
        header[inputs..],
        ["vents", "heating", "vents (fixed)", "heating (fixed)"]
    );
    let mut count = 0;
    for row in reader.records() {
        let row: Vec<f64> = row
            .unwrap()
            .iter()
            .map(|cell| cell.parse().unwrap())
            .collect();
        assert_eq!(
            row[header.iter().position(|name| name == "wind").unwrap()],
            3.0
        );
        let expected = exact.evaluate(&row[..inputs]).outputs;
        assert_eq!(
            row[inputs..inputs + 2],
            [expected[0].unwrap(), expected[1].unwrap()]
        );
        for (fixed, exact) in row[inputs + 2..].iter().zip(&row[inputs..]) {
            assert!((fixed - exact).abs() < 1.0, "{row:?}");
        }
        count += 1;
    }
    assert_eq!(count, 216);
}

#[test]
fn a_good_design_has_no_finding_and_a_small_error() {
    let dir = tempdir().unwrap();
    let deny = "gaps,dead-rules,unreachable-terms,non-monotone,no-fixed-point";
    let said = done(dir.path(), &["check", FAN, "--deny", deny]);
    for what in [
        "gaps, where no rule fires",
        "dead rules",
        "unreachable terms",
        "non-monotone cells",
    ] {
        assert!(said.contains(&format!("{what}: none\n")), "{said}");
    }
    let rows = rows(&said);
    let error = rows.iter().find(|row| row[0] == "fan").unwrap();
    let number = |cell: usize| error[cell].parse::<f64>().unwrap();
    assert!(
        number(3) > 0.0 && number(3) <= number(4) && number(4) <= number(7) && number(7) < 0.01
    );
}

/// What the documentation shows first can be pasted into a file, and is sound.
#[test]
fn the_documentations_ten_lines_are_a_design() {
    let page = concat!(env!("CARGO_MANIFEST_DIR"), "/../docs/fuzzy.md");
    let page = fs::read_to_string(page).unwrap();
    let (_, listing) = page.split_once("```text\n").unwrap();
    let (listing, _) = listing.split_once("```").unwrap();
    let dir = with(listing);
    let deny = "gaps,dead-rules,unreachable-terms,non-monotone,no-fixed-point";
    done(dir.path(), &["check", "design.fll", "--deny", deny]);
    let input = ["eval", "design.fll", "--input", "temperature=28"];
    let said = done(dir.path(), &input);
    let rows = rows(&said);
    let output = rows.iter().find(|row| row[0] == "fan").unwrap();
    assert_eq!(output[1], "70");
}

#[test]
fn every_kind_of_finding_is_named_with_its_place() {
    let dir = with(BOILER);
    let said = done(dir.path(), &["check", "design.fll", "--points", "5000"]);
    for part in [
        // Between -5, where right ends, and hot, which needs the load light.
        "error: -10 to -5",
        "load: 0.4 to 1",
        "error = -7.5, load = 0.7",
        "no term of load at 0.4 to 0.5",
        "line 29: if error is cold and load is heavy then valve is open",
        "on the grid never above rule 1, which concludes the same",
        "line 31: if load is extreme then valve is shut",
        "never fires in the ranges",
        "line 12: load is extreme",
        "line 22: valve is spare",
    ] {
        assert!(said.contains(part), "`{part}` not in {said}");
    }
    let dir = tempdir().unwrap();
    let coarse = concat!(env!("CARGO_MANIFEST_DIR"), "/designs/coarse-deflection.fll");
    let said = done(dir.path(), &["check", coarse, "--points", "1000"]);
    assert!(said.contains("L 0 → Z 90 → R 0"), "{said}");
}

#[test]
fn what_is_denied_fails() {
    let dir = with(BOILER);
    let denied = |deny: &str| {
        let output = sim(dir.path())
            .args(["check", "design.fll", "--points", "100", "--deny", deny])
            .assert();
        let output = output.get_output().clone();
        (
            output.status.code(),
            String::from_utf8(output.stderr).unwrap(),
        )
    };
    let (code, said) = denied("dead-rules,gaps");
    assert_eq!(code, Some(1));
    assert!(
        said.contains("dead-rules, gaps: found, and denied by --deny"),
        "{said}"
    );
    assert_eq!(denied("unreachable-terms").0, Some(1));
    assert_eq!(denied("non-monotone,no-fixed-point").0, Some(0));
    assert_eq!(denied("holes").0, Some(2));
}

/// That points take long is said only where they do, and corners are told wherever they are left out.
#[test]
fn a_grid_says_what_it_leaves_out() {
    let dir = tempdir().unwrap();
    let looked = |points: &str| {
        let args = [
            "check", GREENHOUSE, "--points", points, "--json", "all.json",
        ];
        let said = done(dir.path(), &args);
        let json = fs::read_to_string(dir.path().join("all.json")).unwrap();
        let json: serde_json::Value = serde_json::from_str(&json).unwrap();
        assert!(!said.contains("takes long"), "{said}");
        assert_eq!(json["points_limited"], false);
        (
            said.contains("corners, which are left out: --points for more"),
            json["corners"].clone(),
        )
    };
    assert_eq!(looked("100"), (true, false.into()));
    assert_eq!(looked("20000"), (false, true.into()));
}

#[test]
fn a_place_that_cannot_be_written_is_bad_input() {
    let dir = tempdir().unwrap();
    for args in [
        &["check", FAN, "--points", "100", "--json", "no/x"][..],
        &["eval", FAN, "--grid", "2", "--csv", "no/x"],
        &["convert", FAN, "--to", "rust", "--out", "no/x"],
    ] {
        refused(dir.path(), args, &["no/x: cannot be written"]);
    }
}

/// A fast module's values are whole steps of its own format, within what it announces; the general fixed point's are finer.
#[test]
fn what_a_fast_module_computes_is_seen() {
    let dir = tempdir().unwrap();
    let grid = |route: &str| {
        let file = format!("{route}.csv");
        let args = [
            "eval", FAN, "--grid", "41", "--csv", &file, "--route", route,
        ];
        done(dir.path(), &args);
        let text = fs::read_to_string(dir.path().join(file)).unwrap();
        let mut lines = text.lines();
        let head = lines.next().unwrap().to_owned();
        let numbers = lines.map(|line| {
            let cells = line.split(',').skip(2).map(|cell| cell.parse().unwrap());
            cells.collect::<Vec<f64>>()
        });
        (head, numbers.collect::<Vec<_>>())
    };
    let ((general_head, general), (head, fast)) = (grid("general"), grid("fast"));
    assert!(general_head.ends_with("fan,fan (fixed)") && head.ends_with("fan,fan (fast)"));
    let whole = |rows: &[Vec<f64>]| rows.iter().all(|row| (row[1] * 256.0).fract() == 0.0);
    assert!(whole(&fast) && !whole(&general));
    let worst = |rows: &[Vec<f64>]| {
        let errors = rows.iter().map(|row| (row[0] - row[1]).abs());
        errors.fold(0.0, f64::max)
    };
    assert!((0.001..0.011).contains(&worst(&fast)), "{}", worst(&fast));
    assert!(worst(&general) < 0.0008, "{}", worst(&general));
    let point = ["--input", "temperature=28", "--input", "humidity=57.5"];
    let said = done(
        dir.path(),
        &[&["eval", FAN, "--route", "fast"], &point[..]].concat(),
    );
    assert!(
        said.contains("fast route") && !said.contains("fixed point"),
        "{said}"
    );
    // Two outputs over even terms are a twin table: the robot's own.
    let fine = concat!(env!("CARGO_MANIFEST_DIR"), "/designs/fine.fll");
    let args = [
        "eval", fine, "--grid", "9", "--csv", "fine.csv", "--route", "fast",
    ];
    done(dir.path(), &args);
    refused(
        dir.path(),
        &[
            "eval", GREENHOUSE, "--grid", "2", "--csv", "x.csv", "--route", "fast",
        ],
        &[
            "greenhouse.fll: --route fast does not fit: it takes 2 inputs, and there are 4; allowed is --route general",
        ],
    );
}

/// The fast route's error is that which its modules announce, and counts where a module would take it.
#[test]
fn an_error_above_the_limit_fails() {
    let dir = tempdir().unwrap();
    let said = done(
        dir.path(),
        &["check", FAN, "--points", "1000", "--route", "auto"],
    );
    let rows = rows(&said);
    let share = |row: &[String]| row[8].trim_end_matches(" %").parse::<f64>().unwrap();
    let [general, fast] = ["≥ 1/2", "fast route"].map(|line| {
        let row = rows
            .iter()
            .find(|row| row.get(1).is_some_and(|cell| cell == line));
        share(row.unwrap())
    });
    assert!(general < 0.01 && fast > 0.01, "{said}");
    let module = done(
        dir.path(),
        &["convert", FAN, "--to", "rust", "--route", "fast"],
    );
    let announced = module
        .lines()
        .find(|line| line.ends_with("of `fan`"))
        .unwrap();
    let announced: f64 = announced["//! * ".len()..]
        .split(' ')
        .next()
        .unwrap()
        .parse()
        .unwrap();
    // Of a range of 100; the table has two digits.
    assert!(
        (announced - fast).abs() <= 0.06 * fast,
        "{announced} for {fast}"
    );

    let limited = |limit: &str, route: &str| {
        let output = sim(dir.path())
            .args([
                "check",
                FAN,
                "--points",
                "1000",
                "--max-error",
                limit,
                "--route",
                route,
            ])
            .assert();
        let output = output.get_output().clone();
        let said = String::from_utf8(output.stderr).unwrap();
        (output.status.code(), said)
    };
    let (code, said) = limited("0.01", "auto");
    assert_eq!(code, Some(1));
    assert!(
        said.contains("off by up to fan 0.011 % (fast route), and --max-error allows 0.01 %"),
        "{said}"
    );
    assert_eq!(limited("0.02", "fast").0, Some(0));
    assert_eq!(limited("0.01", "general").0, Some(0));
    let (code, said) = limited("1e-6", "general");
    assert_eq!(code, Some(1));
    assert!(said.contains("(≥ 1/2)"), "{said}");
    for wrong in ["0", "-1", "NaN", "101", "much"] {
        assert_eq!(limited(wrong, "auto").0, Some(2), "{wrong}");
    }
    // Nothing can be promised of what has no fixed point, nor of a design that the route does not take.
    let dir = with(&BOILER.replace("range: 0 1\n", "range: 1e12 1000000000001\n"));
    sim(dir.path())
        .args(["check", "design.fll", "--max-error", "50"])
        .assert()
        .code(1);
    sim(dir.path())
        .args(["check", "design.fll", "--route", "general"])
        .assert()
        .code(0);
    let dir = with(BOILER);
    sim(dir.path())
        .args(["check", "design.fll", "--route", "fast"])
        .assert()
        .code(2);
}

#[test]
fn a_design_without_fixed_point_is_evaluated_in_f64_and_says_why() {
    let far = "range: 1e12 1000000000001";
    let dir = with(&BOILER.replace("range: 0 1\n", &format!("{far}\n")));
    let point = ["--input", "error=5", "--input", "load=1e12"];
    let said = done(dir.path(), &[&["eval", "design.fll"][..], &point].concat());
    assert!(
        said.contains("no fixed point: ") && said.contains("load"),
        "{said}"
    );
    assert_eq!(
        rows(&said).iter().find(|row| row[0] == "valve").unwrap()[2],
        "–"
    );
    let output = sim(dir.path())
        .args(["check", "design.fll", "--deny", "no-fixed-point"])
        .assert();
    output.code(1);
}

#[test]
fn pictures_of_all_outputs_and_of_the_terms() {
    let dir = tempdir().unwrap();
    let hold = ["--axes", "sunlight,wind", "--hold", "humidity=60"];
    done(
        dir.path(),
        &[&["surface", GREENHOUSE, "--out", "deep/down"][..], &hold].concat(),
    );
    let mut expected = Vec::new();
    for what in ["heating", "memberships", "vents"] {
        expected.extend([
            format!("greenhouse-{what}.png"),
            format!("greenhouse-{what}.svg"),
        ]);
    }
    let folder = dir.path().join("deep/down");
    assert_eq!(names(&folder), expected);
    let svg = fs::read_to_string(folder.join("greenhouse-vents.svg")).unwrap();
    for text in [
        "greenhouse: vents",
        "held: temperature = 22.5, humidity = 60",
        "sunlight",
        "wind",
    ] {
        assert!(svg.contains(text), "{text}");
    }
    // With gaps.
    let dir = with(BOILER);
    done(dir.path(), &["surface", "design.fll"]);
    let svg = fs::read_to_string(dir.path().join("out/fuzzy/design-valve.svg")).unwrap();
    assert!(svg.contains("no value"));
    let svg = fs::read_to_string(dir.path().join("out/fuzzy/design-memberships.svg")).unwrap();
    assert!(svg.contains("out of this range: extreme"));
}

#[test]
fn every_output_has_its_own_picture_whatever_it_is_called() {
    let outputs = |names: &[&str]| {
        let mut text = BOILER.to_owned();
        let start = text.find("OutputVariable").unwrap();
        let end = text.find("RuleBlock").unwrap();
        let output = text[start..end].to_owned();
        let more: String = names
            .iter()
            .map(|name| output.replace("valve", name))
            .collect();
        text.insert_str(end, &more);
        for name in names {
            text += &format!("  rule: if error is cold then {name} is open\n");
        }
        text
    };
    let dir = with(&outputs(&["memberships", "Valve", "VALVE"]));
    done(dir.path(), &["surface", "design.fll", "--out", "."]);
    let pictures: Vec<String> = names(dir.path())
        .into_iter()
        .filter(|name| name.ends_with(".svg"))
        .collect();
    assert_eq!(
        pictures,
        [
            "design-VALVE-3.svg",
            "design-Valve-2.svg",
            "design-memberships-2.svg",
            "design-memberships.svg",
            "design-valve.svg"
        ]
    );
    let svg = fs::read_to_string(dir.path().join("design-memberships.svg")).unwrap();
    assert!(svg.contains("extreme"), "the terms, not the output");
    // One picture that cannot be written: none is.
    let dir = with(BOILER);
    fs::create_dir_all(dir.path().join("out/design-valve.png")).unwrap();
    let failed = sim(dir.path())
        .args(["surface", "design.fll", "--out", "out"])
        .assert()
        .code(1);
    let said = String::from_utf8(failed.get_output().stderr.clone()).unwrap();
    assert!(
        said.contains("design-valve.png: cannot be written"),
        "{said}"
    );
    assert_eq!(names(&dir.path().join("out")), ["design-valve.png"]);
}

#[test]
fn wrong_arguments_are_named_with_what_is_allowed() {
    let dir = tempdir().unwrap();
    let here = dir.path();
    let eval = |inputs: &[&'static str]| {
        let given = inputs.iter().flat_map(|input| ["--input", *input]);
        ["eval", FAN].into_iter().chain(given).collect::<Vec<_>>()
    };
    refused(here, &eval(&[]), &["missing: temperature, humidity"]);
    refused(here, &eval(&["temperature=20"]), &["missing: humidity"]);
    refused(
        here,
        &eval(&["heat=20"]),
        &["heat", "allowed: temperature, humidity"],
    );
    refused(
        here,
        &eval(&["temperature"]),
        &["found no `=`", "NAME=VALUE"],
    );
    refused(
        here,
        &eval(&["temperature=warm"]),
        &["found `warm`", "a finite number"],
    );
    refused(
        here,
        &eval(&["temperature=NaN"]),
        &["found `NaN`", "a finite number"],
    );
    refused(here, &eval(&["humidity=1", "humidity=2"]), &["given twice"]);
    let grid = ["eval", GREENHOUSE, "--grid", "100", "--csv", "all.csv"];
    refused(here, &grid, &["100 to the power of 4", "2000000 at most"]);
    let surface = |args: &[&'static str]| [&["surface", GREENHOUSE][..], args].concat();
    refused(here, &surface(&["--axes", "wind"]), &["wind", "NAME,NAME"]);
    refused(
        here,
        &surface(&["--axes", "wind,wind"]),
        &["the same input twice"],
    );
    refused(
        here,
        &surface(&["--axes", "wind,rain"]),
        &["rain", "humidity"],
    );
    refused(
        here,
        &surface(&["--hold", "temperature=1"]),
        &["is drawn over"],
    );
    refused(
        here,
        &["check", "none.fll"],
        &["none.fll", "cannot be read"],
    );
}

/// Sets between the samples at 0.05, 0.15, …
const MISSED: &str = "\
Engine: missed
InputVariable: x
  range: 0 10
  term: lo Ramp 10 0
  term: hi Ramp 0 10
OutputVariable: y
  range: 0 10
  default: nan
  aggregation: Maximum
  defuzzifier: Centroid 100
  term: a Triangle 2.96 2.98 3.04
  term: b Triangle 7.01 7.02 7.04
RuleBlock: r
  conjunction: Minimum
  disjunction: Maximum
  implication: Minimum
  activation: General
  rule: if x is lo then y is a
  rule: if x is hi then y is b
";

#[test]
fn a_value_that_no_rule_concludes_is_called_the_default() {
    let eval = |text: &str, at: &[&str]| {
        let said = done(
            with(text).path(),
            &[&["eval", "design.fll"][..], at].concat(),
        );
        rows(&said)
            .into_iter()
            .find(|row| row[0] == "y" || row[0] == "valve")
            .unwrap()
    };
    let missed = MISSED.replace("default: nan", "default: 5");
    assert_eq!(
        eval(&missed, &["--input", "x=5"])[1],
        "5, the default: the concluded sets meet no sample"
    );
    let silent = BOILER.replace("default: nan", "default: 5");
    let nowhere = ["--input", "error=-9", "--input", "load=0.45"];
    let row = eval(&silent, &nowhere);
    assert_eq!(
        row[1..3],
        ["5, the default: no rule fires", "5, the default"]
    );
    // What rules conclude is no default, whatever its value.
    let row = eval(&silent, &["--input", "error=0", "--input", "load=0.5"]);
    assert!(
        !row[1].contains("default") && !row[2].contains("default"),
        "{row:?}"
    );
}

#[test]
fn a_picture_without_a_value_does_not_say_why() {
    let dir = with(MISSED);
    done(dir.path(), &["surface", "design.fll", "--out", "."]);
    let svg = fs::read_to_string(dir.path().join("design-y.svg")).unwrap();
    assert!(svg.contains("no line: no value") && !svg.contains("no rule fires"));
}

#[test]
fn what_is_read_is_not_written_over() {
    let dir = with(BOILER);
    let here = dir.path();
    fs::hard_link(here.join("design.fll"), here.join("linked.fll")).unwrap();
    for args in [
        &["check", "design.fll", "--json", "design.fll"][..],
        &["check", "design.fll", "--json", "./linked.fll"],
        &["eval", "design.fll", "--grid", "3", "--csv", "design.fll"],
        &["eval", "linked.fll", "--grid", "3", "--csv", "design.fll"],
        &[
            "convert",
            "linked.fll",
            "--to",
            "fcl",
            "--out",
            "design.fll",
        ],
    ] {
        refused(
            here,
            args,
            &["the design that is read", "allowed is another file"],
        );
    }
    fs::hard_link(here.join("design.fll"), here.join("design-valve.svg")).unwrap();
    let picture = ["surface", "design.fll", "--out", "."];
    refused(
        here,
        &picture,
        &["design-valve.svg is the design that is read"],
    );
    for file in ["design.fll", "linked.fll"] {
        assert_eq!(fs::read_to_string(here.join(file)).unwrap(), BOILER);
    }
}
