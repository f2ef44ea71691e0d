//! Wrong rule bases and distance tables do not compile: every file of `compile_fail/` is one mistake, its message
//! beside it, and the engine has no message that none of them shows.

use std::fs;
use std::path::{Path, PathBuf};

#[test]
fn wrong_tables_do_not_compile() {
    let cases = trybuild::TestCases::new();
    cases.pass("tests/compile_fail/pass/*.rs");
    cases.compile_fail("tests/compile_fail/*.rs");
}

/// Assertions that no table can reach, and why: the file and how many.
const WITHOUT_A_TABLE: &[(&str, usize)] = &[
    // Where the assembly finds the fields of the library's own type.
    ("dsp.rs", 3),
];

/// What the compiler says of a wrong table is what somebody has seen it say.
#[test]
fn every_message_of_the_engine_is_shown_by_a_wrong_table() {
    let root = Path::new(env!("CARGO_MANIFEST_DIR"));
    let shown = files(&root.join("tests/compile_fail"), "stderr").into_iter();
    let shown: String = shown
        .map(|file| fs::read_to_string(file).unwrap())
        .collect();
    let (mut messages, mut bare) = (0, Vec::new());
    for file in files(&root.join("src/fuzzy"), "rs") {
        let text = fs::read_to_string(&file).unwrap();
        let name = file.file_name().unwrap().to_string_lossy().into_owned();
        let found = messages_of(&text, name == "flaw.rs");
        for message in found.iter().flatten() {
            assert!(
                shown.contains(message),
                "{name}: `{}` is in no .stderr of tests/compile_fail",
                message.trim()
            );
            messages += 1;
        }
        let without = found.iter().filter(|message| message.is_none()).count();
        if without > 0 {
            bare.push((name, without));
        }
    }
    let wanted = WITHOUT_A_TABLE.iter();
    let wanted: Vec<_> = wanted
        .map(|&(name, count)| (name.to_owned(), count))
        .collect();
    assert_eq!(
        bare, wanted,
        "files with assertions without a text, and how many"
    );
    assert!(messages > 60, "only {messages} messages were found");
}

/// The files of a folder and the folders in it that end so.
fn files(folder: &Path, extension: &str) -> Vec<PathBuf> {
    let mut found = Vec::new();
    let mut entries: Vec<PathBuf> = fs::read_dir(folder)
        .unwrap()
        .map(|entry| entry.unwrap().path())
        .collect();
    entries.sort();
    for entry in entries {
        if entry.is_dir() {
            found.extend(files(&entry, extension));
        } else if entry.extension().is_some_and(|end| end == extension) {
            found.push(entry);
        }
    }
    found
}

/// What the calls that end a program make the compiler say, `None` where they have no text; and of flaws the parts of theirs.
/// Tests and comments are aside.
fn messages_of(source: &str, flaws: bool) -> Vec<Option<String>> {
    let code = match source.split_once("#[cfg(test)]") {
        Some((code, _)) => code,
        None => source,
    };
    let mut calls = vec![
        "assert!(",
        "assert_eq!(",
        "assert_ne!(",
        "panic!(",
        "unreachable!(",
    ];
    if flaws {
        calls.extend([".and(", ".named("]);
    }
    let mut found = Vec::new();
    for call in calls {
        for (at, _) in code.match_indices(call) {
            let line = code[..at].rfind('\n').map_or(0, |end| end + 1);
            if code[line..].trim_start().starts_with("//") {
                continue;
            }
            let text = arguments(&code[at + call.len()..]).split('"').nth(1);
            match text {
                // A flaw's: that is told by its parts, but for a name, a number or a comma.
                Some("{}") => {}
                _ if call.starts_with('.') => {
                    found.extend(
                        text.filter(|text| text.len() > 2)
                            .map(|text| Some(text.to_owned())),
                    );
                }
                _ => found.push(text.map(|text| format!("evaluation panicked: {text}\n"))),
            }
        }
    }
    found
}

/// Up to the parenthesis that closes what `text` is in.
fn arguments(text: &str) -> &str {
    let (mut depth, mut quoted) = (1, false);
    let mut before = ' ';
    for (at, c) in text.char_indices() {
        match c {
            '"' if before != '\\' => quoted = !quoted,
            '(' if !quoted => depth += 1,
            ')' if !quoted => depth -= 1,
            _ => {}
        }
        if depth == 0 {
            return &text[..at];
        }
        before = c;
    }
    text
}
