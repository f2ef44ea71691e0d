//! The import rules, held by reading `src/` as text: the engine knows no other module, the stages of a tick do not know
//! each other, only the tick touches the hardware's traits, nothing needs std, floats or the simulator, and one file is unsafe.

use std::collections::BTreeSet;
use std::fs;
use std::path::{Path, PathBuf};

/// The stages of a tick; they meet in `signals` only, and only `tick` knows them all.
const STAGES: [&str; 6] = ["sense", "localise", "guide", "behaviour", "guard", "drive"];

/// Imports against the rule that stand in the code: (file, the stage's item it names). Shrink it; never add to it
/// without a reason beside the entry.
const EXCEPTIONS: &[(&str, &str)] = &[];

/// Floats that stand in the code: (file, the type). The same rule.
const FLOATS: &[(&str, &str)] = &[
    // The speed of sound at a temperature: computed once, while settings are made, into a fixed-point constant. The
    // tick and the drivers compute with that constant in integers.
    ("ports/sound.rs", "f32"),
];

/// Files of the library that may be `unsafe`; the firmware's own (`main`) is aside, it has registers to reach. The same
/// rule.
const UNSAFE: &[&str] = &[
    // One block of instructions that the compiler does not offer otherwise, on processors that have them.
    "fuzzy/dsp.rs",
];

/// What only the ports, the tick and those who own both may name.
const HARDWARE: [&str; 5] = [
    "Ports",
    "WheelDrive",
    "WheelEncoders",
    "RangeSensors",
    "embedded_hal",
];

/// They.
const OWNERS: [&str; 6] = ["ports", "tick", "lib", "pilot", "firmware", "main"];

/// A source file: its path below `src/` and its code without comments and strings.
struct Source {
    path: String,
    code: String,
}

impl Source {
    /// The top module that the file belongs to: `fuzzy` for `fuzzy.rs` and `fuzzy/rules.rs`.
    fn module(&self) -> &str {
        let first = self.path.split('/').next().unwrap_or_default();
        first.strip_suffix(".rs").unwrap_or(first)
    }

    /// How many modules deep the file is below the crate: 1 for `fuzzy.rs`, 2 for `fuzzy/rules.rs`.
    fn depth(&self) -> usize {
        self.path.split('/').count()
    }
}

/// Strips comments, and what strings and characters hold.
fn code_of(text: &str) -> String {
    let mut out = String::new();
    let mut rest = text;
    while let Some(c) = rest.chars().next() {
        if rest.starts_with("//") {
            rest = &rest[rest.find('\n').unwrap_or(rest.len())..];
        } else if rest.starts_with("/*") {
            rest = &rest[rest.find("*/").map_or(rest.len(), |end| end + 2)..];
        } else if c == '"' {
            let mut end = 1;
            let bytes = rest.as_bytes();
            while end < bytes.len() && bytes[end] != b'"' {
                end += if bytes[end] == b'\\' { 2 } else { 1 };
            }
            out.push_str("\"\"");
            rest = &rest[(end + 1).min(rest.len())..];
        } else {
            out.push(c);
            rest = &rest[c.len_utf8()..];
        }
    }
    out
}

fn walk(folder: &Path, root: &Path, sources: &mut Vec<Source>) {
    let mut entries: Vec<PathBuf> = fs::read_dir(folder)
        .unwrap()
        .map(|entry| entry.unwrap().path())
        .collect();
    entries.sort();
    for entry in entries {
        if entry.is_dir() {
            walk(&entry, root, sources);
        } else if entry.extension().is_some_and(|e| e == "rs") {
            let parts: Vec<_> = entry.strip_prefix(root).unwrap().iter().collect();
            let parts: Vec<_> = parts.iter().map(|p| p.to_string_lossy()).collect();
            sources.push(Source {
                path: parts.join("/"),
                code: code_of(&fs::read_to_string(&entry).unwrap()),
            });
        }
    }
}

fn sources() -> Vec<Source> {
    let root = Path::new(env!("CARGO_MANIFEST_DIR")).join("src");
    let mut sources = Vec::new();
    walk(&root, &root, &mut sources);
    assert!(sources.len() > 20, "src/ was not found");
    sources
}

/// Words of the code: identifiers, and everything else a character at a time, blanks dropped.
fn words(code: &str) -> Vec<&str> {
    let mut words = Vec::new();
    let mut rest = code.trim_start();
    while let Some(c) = rest.chars().next() {
        let is_word = |c: char| c.is_alphanumeric() || c == '_';
        let end = if is_word(c) {
            rest.find(|c| !is_word(c)).unwrap_or(rest.len())
        } else {
            c.len_utf8()
        };
        words.push(&rest[..end]);
        rest = rest[end..].trim_start();
    }
    words
}

/// The names that directly follow `::` at `at`, one or a braced list of them: `a` of `a::b`, `a` and `c` of
/// `{a::b, c}`.
fn roots<'a>(words: &[&'a str], mut at: usize) -> Vec<&'a str> {
    if words.get(at..at + 2) != Some(&[":", ":"]) {
        return Vec::new();
    }
    at += 2;
    if words.get(at) != Some(&"{") {
        return words.get(at).copied().into_iter().collect();
    }
    let (mut found, mut depth, mut fresh) = (Vec::new(), 0, false);
    for &word in &words[at..] {
        match word {
            "{" => {
                depth += 1;
                fresh = depth == 1;
            }
            "}" => {
                depth -= 1;
                if depth == 0 {
                    break;
                }
            }
            "," => fresh = depth == 1,
            _ if fresh => {
                found.push(word);
                fresh = false;
            }
            _ => {}
        }
    }
    found
}

/// The crate's top modules that a file names, by `crate::` or by enough `super::`, in a `use` or in a path.
fn named(source: &Source) -> BTreeSet<&str> {
    let words = words(&source.code);
    let mut names = BTreeSet::new();
    for i in 0..words.len() {
        if matches!(words[i], "crate" | "fuzzypilot") {
            names.extend(roots(&words, i + 1));
        }
        // The first of a chain of as many `super` as lead up to the crate.
        if words[i] == "super" && (i == 0 || words[i - 1] != ":") {
            let mut supers = 1;
            while words.get(i + 3 * supers) == Some(&"super") && words[i + 3 * supers - 1] == ":" {
                supers += 1;
            }
            if supers >= source.depth() {
                names.extend(roots(&words, i + 3 * (supers - 1) + 1));
            }
        }
    }
    names
}

/// Every breach of the rules, as "file names what".
fn breaches(sources: &[Source]) -> Vec<String> {
    let mut found = Vec::new();
    for source in sources {
        let own = source.module();
        for name in named(source) {
            let breach = match own {
                // The engine knows nothing but itself.
                "fuzzy" => name != "fuzzy",
                // The root and a board know everything.
                "lib" | "main" | "firmware" => false,
                // The pilot knows all but what goes on around it.
                "pilot" => name == "firmware",
                // Nobody else knows that there is a wire, or an application around the tick.
                _ if matches!(name, "pilot" | "firmware") => true,
                _ if name == "link" && own != "link" => true,
                // Both ticks know everything below them, and not each other.
                "tick" => name == "navigate",
                "navigate" => name == "tick",
                // The wire carries paths, but drives nothing.
                "link" if name == "guide" => false,
                // The tables know the engine alone.
                "tables" => !matches!(name, "tables" | "fuzzy"),
                // Integers, units and geometry are below everything.
                "integer" => name != "integer",
                "units" => !matches!(name, "units" | "integer"),
                "geometry" => !matches!(name, "geometry" | "units" | "integer"),
                // The drivers know quantities and what is wrong with a setting.
                "ports" => !matches!(name, "ports" | "units" | "params" | "integer"),
                _ => {
                    (STAGES.contains(&name) || matches!(name, "tick" | "navigate" | "supervisor"))
                        && name != own
                }
            };
            if breach && !EXCEPTIONS.contains(&(source.path.as_str(), name)) {
                found.push(format!("{} names {name}", source.path));
            }
        }
        // In the code, comments and strings aside.
        let words = words(&source.code);
        for foreign in ["host_sim", "std", "alloc", "f16", "f32", "f64", "f128"] {
            if words.contains(&foreign) && !FLOATS.contains(&(source.path.as_str(), foreign)) {
                found.push(format!("{} names {foreign}", source.path));
            }
        }
        if words.contains(&"unsafe") && own != "main" && !UNSAFE.contains(&source.path.as_str()) {
            found.push(format!("{} names unsafe", source.path));
        }
        for hardware in HARDWARE {
            if words.contains(&hardware) && !OWNERS.contains(&own) {
                found.push(format!("{} names {hardware}", source.path));
            }
        }
    }
    found
}

#[test]
fn modules_import_only_what_they_may() {
    let found = breaches(&sources());
    assert!(found.is_empty(), "{found:#?}");
}

#[test]
fn every_exception_is_still_needed() {
    let sources = sources();
    for &(path, name) in EXCEPTIONS {
        let source = sources.iter().find(|s| s.path == path);
        let source = source.unwrap_or_else(|| panic!("{path} is gone"));
        assert!(named(source).contains(name), "{path} does not name {name}");
    }
    for &(path, float) in FLOATS {
        let source = sources.iter().find(|s| s.path == path);
        let source = source.unwrap_or_else(|| panic!("{path} is gone"));
        let words = words(&source.code);
        assert!(words.contains(&float), "{path} does not name {float}");
    }
    for &path in UNSAFE {
        let source = sources.iter().find(|s| s.path == path);
        let source = source.unwrap_or_else(|| panic!("{path} is gone"));
        let words = words(&source.code);
        assert!(words.contains(&"unsafe"), "{path} is not unsafe");
    }
}

#[test]
fn only_the_tick_knows_all_stages() {
    for source in sources() {
        let names = named(&source);
        let all = STAGES.iter().all(|stage| names.contains(stage));
        assert_eq!(all, source.path == "tick.rs", "{}", source.path);
    }
}

#[test]
fn the_root_is_no_std() {
    let sources = sources();
    let root = sources.iter().find(|s| s.path == "lib.rs").unwrap();
    assert!(root.code.contains("#![no_std]"));
    assert!(!root.code.contains("extern crate"));
}

/// The rules can fail: each made-up file breaks one.
#[test]
fn breaches_are_seen() {
    let bad = [
        ("fuzzy/rules.rs", "use crate::units::Angle;", "units"),
        ("fuzzy/rules.rs", "use super::super::units::Angle;", "units"),
        ("fuzzy.rs", "use super::{fuzzy, params};", "params"),
        ("fuzzy.rs", "fn f(x: crate::signals::Twist) {}", "signals"),
        (
            "guide/law.rs",
            "use crate::{\n    units::{Angle, drive},\n    drive::drive,\n};",
            "drive",
        ),
        ("guide/law.rs", "use crate :: guard :: guard;", "guard"),
        (
            "drive.rs",
            "fn f() { crate::localise::Localiser::pose(); }",
            "localise",
        ),
        (
            "sense/scan.rs",
            "use super::super::behaviour::avoider;",
            "behaviour",
        ),
        ("localise.rs", "use crate::supervisor::Mode;", "supervisor"),
        ("params.rs", "use crate::tick::Robot;", "tick"),
        ("navigate.rs", "use crate::tick::Robot;", "tick"),
        ("tick.rs", "use crate::navigate::Navigator;", "navigate"),
        ("guard.rs", "use crate::navigate::Near;", "navigate"),
        (
            "sense/scan.rs",
            "use crate::link::message::Reading;",
            "link",
        ),
        ("tick.rs", "use crate::link::record::encode;", "link"),
        ("fuzzy.rs", "use crate::pilot::Pilot;", "pilot"),
        ("link/message.rs", "use crate::pilot::Pilot;", "pilot"),
        ("link/message.rs", "use crate::drive::drive;", "drive"),
        ("tables/fine.rs", "use crate::params::Law;", "params"),
        ("geometry.rs", "use crate::signals::Obstacle;", "signals"),
        ("guard.rs", "use std::vec::Vec;", "std"),
        ("guard.rs", "let x = 1.0 as f32;", "f32"),
        ("guard.rs", "use host_sim::World;", "host_sim"),
        ("fuzzy/twin.rs", "fn f() { unsafe { g() } }", "unsafe"),
        ("fuzzy.rs", "unsafe impl Sync for Twin {}", "unsafe"),
        ("firmware/pipe.rs", "unsafe extern \"C\" {}", "unsafe"),
        ("ports/echo.rs", "let x = 1.0 as f32;", "f32"),
        ("ports/sound.rs", "let x = 1.0 as f64;", "f64"),
        ("ports/echo.rs", "use crate::geometry::Point;", "geometry"),
        (
            "sense.rs",
            "fn f(ports: crate::ports::RangeSensors) {}",
            "RangeSensors",
        ),
        ("drive.rs", "use embedded_hal::pwm;", "embedded_hal"),
    ];
    for (path, code, name) in bad {
        let source = Source {
            path: path.into(),
            code: code_of(code),
        };
        assert_eq!(
            breaches(&[source]),
            [format!("{path} names {name}")],
            "{code}"
        );
    }
    let good = [
        (
            "fuzzy/rules.rs",
            "use super::{Activation, Grade}; // crate::units",
        ),
        ("fuzzy/rules.rs", "use crate::fuzzy::Grade; /* f64 */"),
        (
            "guide/law.rs",
            "use super::cursor::Cursor; use crate::guide::Path;",
        ),
        (
            "guide/law.rs",
            "use crate::{units::{Angle, drive}, geometry::Pose};",
        ),
        ("guard.rs", "panic!(\"crate::drive, std, f32\");"),
        ("tick.rs", "use crate::{drive, guard, sense};"),
        ("navigate.rs", "use crate::{behaviour, guide};"),
        (
            "link/message.rs",
            "use super::frame::VERSION; use crate::{guide::PathError, signals};",
        ),
        ("pilot/session.rs", "use crate::{link, pilot, tick};"),
        ("tick.rs", "use crate::ports::{Ports, RangeSensors};"),
        ("sense.rs", "use crate::ports::{Fault, Range};"),
        ("ports/sound.rs", "let x = 1.0 as f32;"),
        ("fuzzy/dsp.rs", "unsafe { asm!(\"nop\") }"),
        ("lib.rs", "#![deny(unsafe_code)] // unsafe"),
        ("main/motors.rs", "unsafe { register.write() }"),
        (
            "ports/echo.rs",
            "use super::Range; use crate::units::Metres; use embedded_hal::digital;",
        ),
    ];
    for (path, code) in good {
        let source = Source {
            path: path.into(),
            code: code_of(code),
        };
        assert_eq!(breaches(&[source]), [""; 0], "{code}");
    }
}
