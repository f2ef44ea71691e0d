//! Bad files: each is an error, none a panic; what each error says stands in `messages.txt`. After a change that is meant,
//! `FUZZYPILOT_RENEW=1` writes that file anew: read what changed.

use super::files;
use host_sim::fuzzy::files::error::ReadError;
use host_sim::fuzzy::files::{Format, limits, load, parse};
use std::fmt::Write;
use std::fs;
use std::path::Path;

/// Errors about a file as a whole, which have no line.
const WITHOUT_A_LINE: &[&str] = &["utf-16.fll"];

#[test]
fn every_bad_file_is_an_error_with_the_message_on_record() {
    let files = files("tests/designs/bad");
    assert!(files.len() > 200, "{} files", files.len());
    let mut said = String::new();
    for file in files {
        let name = file.file_name().unwrap().to_str().unwrap();
        let bytes = fs::read(&file).unwrap();
        let format = Format::of(&file).unwrap();
        let error = match parse(name, &bytes, format) {
            Ok(system) => panic!("{name} is read: {system:?}"),
            Err(error) => error,
        };
        assert_eq!(
            error.place().is_none(),
            WITHOUT_A_LINE.contains(&name),
            "{error}"
        );
        writeln!(said, "{error}\n").unwrap();
    }
    let record = Path::new(env!("CARGO_MANIFEST_DIR")).join("tests/designs/messages.txt");
    if std::env::var_os("FUZZYPILOT_RENEW").is_some() {
        fs::write(&record, &said).unwrap();
    }
    let recorded = fs::read_to_string(&record).unwrap_or_default();
    for (now, then) in said.split("\n\n").zip(recorded.split("\n\n")) {
        assert_eq!(now, then, "messages.txt has another message");
    }
    assert_eq!(
        said.len(),
        recorded.len(),
        "messages.txt has more or fewer messages"
    );
}

fn message(bytes: &[u8], format: Format) -> String {
    parse("file", bytes, format).unwrap_err().to_string()
}

#[test]
fn a_huge_file_is_an_error_and_is_not_read_whole() {
    let folder = tempfile::tempdir().unwrap();
    let file = folder.path().join("huge.fll");
    let line = "  term: low Triangle 0 1 2\n";
    fs::write(&file, line.repeat(10_000_000 / line.len())).unwrap();
    let error = load(&file, None).unwrap_err();
    assert!(error.is::<ReadError>());
    let said = error.to_string();
    assert!(
        said.ends_with("huge.fll: the file is too large; allowed is at most 1048576 bytes"),
        "{said}"
    );
    // As much as is allowed is read: what is wrong with it is something else.
    let most = vec![b' '; limits::BYTES];
    assert!(message(&most, Format::Fll).contains("the file ends here"));
    assert!(message(&[most, vec![b' ']].concat(), Format::Fll).contains("too large"));
}

#[cfg(target_os = "linux")]
#[test]
fn a_device_without_an_end_is_an_error() {
    let error = load(Path::new("/dev/zero"), Some(Format::Fll)).unwrap_err();
    assert!(error.to_string().contains("too large"), "{error}");
}

#[test]
fn binaries_are_errors() {
    for format in Format::ALL {
        // A picture's beginning, noise, zeros.
        let said = message(b"\x89PNG\r\n\x1a\n\0\0\0\rIHDR", format);
        assert!(
            said.contains("file:1:1: found the byte 0x89, which is not UTF-8"),
            "{said}"
        );
        let noise: Vec<u8> = (0..4096u32)
            .map(|i| (i.wrapping_mul(2_654_435_761) >> 24) as u8)
            .collect();
        assert!(message(&noise, format).contains("allowed is a text in UTF-8"));
        assert!(message(&[0; 100], format).contains("control character U+0000"));
    }
}

#[test]
fn files_that_are_not_there_or_no_files_are_errors() {
    let folder = tempfile::tempdir().unwrap();
    let error = load(&folder.path().join("none.fll"), None).unwrap_err();
    assert!(
        error.is::<ReadError>() && error.to_string().contains("cannot be read"),
        "{error}"
    );
    let error = load(folder.path(), Some(Format::Fis)).unwrap_err();
    assert!(
        error.is::<ReadError>() && error.to_string().contains("cannot be read"),
        "{error}"
    );
    let error = load(Path::new("design.txt"), None).unwrap_err();
    let said = "design.txt: the extension names no format; allowed is one of .fll, .fcl, .fis";
    assert_eq!(error.to_string(), said);
}

/// Nesting far beyond what is allowed neither overflows a stack nor takes long.
#[test]
fn deep_nesting_is_an_error() {
    for (open, close) in [("(", ")"), ("not (", ")"), ("not ", "")] {
        let condition = format!("{}x is a{}", open.repeat(100_000), close.repeat(100_000));
        let fcl = format!(
            "FUNCTION_BLOCK f VAR_INPUT x : REAL; END_VAR RULEBLOCK r RULE 1 : IF {condition} THEN y IS b;"
        );
        let said = message(fcl.as_bytes(), Format::Fcl);
        assert!(
            said.contains("nested too deeply; allowed is 16 levels"),
            "{said}"
        );
        assert!(said.len() < 400, "{said}");
    }
    let fll = format!(
        "Engine:\nRuleBlock:\n  rule: if {}x is a",
        "(".repeat(100_000)
    );
    assert!(message(fll.as_bytes(), Format::Fll).contains("nested too deeply"));
}

/// Every prefix of a good file is an error or still a system, never a panic.
#[test]
fn a_file_cut_anywhere_never_panics() {
    for file in super::designs() {
        let bytes = fs::read(&file).unwrap();
        let format = Format::of(&file).unwrap();
        for end in 0..bytes.len() {
            super::fuzz::check(&bytes[..end], format);
        }
    }
}

/// The documentation's page names the limits that hold.
#[test]
fn the_limits_are_documented() {
    let page = Path::new(env!("CARGO_MANIFEST_DIR")).join("../docs/design-files.md");
    let page = fs::read_to_string(page).unwrap().replace('\n', " ");
    assert_eq!((limits::BYTES, limits::SAMPLES), (1 << 20, 10_000));
    for said in [
        "A file of 1 MiB".to_owned(),
        "10,000 samples".to_owned(),
        format!(
            "1 to {} inputs, 1 to {} outputs",
            limits::INPUTS,
            limits::OUTPUTS
        ),
        format!("{} terms a variable", limits::TERMS),
        format!("{} points a term", limits::POINTS),
        format!("{} rules in {} blocks", limits::RULES, limits::BLOCKS),
        format!("{} propositions a condition", limits::PROPOSITIONS),
        format!("nested {} deep", limits::DEPTH),
        format!("names of {} characters", limits::NAME),
    ] {
        assert!(
            page.contains(&said),
            "`{said}` is not in docs/design-files.md"
        );
    }
}
