//! The example in C (`examples/c`), built and run on every machine: what it prints, its digest of every byte included, is
//! what the library computes here.

mod reference;

use std::path::Path;
use std::process::Command;

/// What the build script ends with when a tool is not there.
const MISSING: i32 = 3;

/// Builds and runs one kind in a folder of its own; what it printed.
fn run(kind: &str, folder: &Path) -> Option<String> {
    let script = Path::new(env!("CARGO_MANIFEST_DIR")).join("../examples/c/build");
    let output = Command::new("bash")
        .arg(script)
        .arg("--out")
        .arg(folder)
        .arg(kind)
        .output()
        .expect("bash can be started");
    let said = String::from_utf8_lossy(&output.stderr).into_owned();
    let in_ci = std::env::var("CI").is_ok_and(|ci| ci == "true");
    match output.status.code() {
        Some(0) => Some(String::from_utf8(output.stdout).unwrap()),
        Some(MISSING) if !in_ci => {
            eprintln!("not run: {kind}: {said}");
            None
        }
        code => panic!("{kind}: exit code {code:?}: {said}"),
    }
}

fn compare(kind: &str) {
    let folder = tempfile::tempdir().unwrap();
    if let Some(printed) = run(kind, folder.path()) {
        assert_eq!(printed, reference::print(), "{kind}");
    }
}

#[test]
fn the_reference_avoids_and_follows() {
    let text = reference::print();
    let avoided: Option<&str> = text
        .lines()
        .find_map(|l| l.strip_prefix("of these avoiding: "));
    assert!(
        (20..80).contains(&avoided.unwrap().parse::<i32>().unwrap()),
        "{text}"
    );
}

#[test]
fn a_desktop_with_the_static_library() {
    compare("desktop");
}

#[test]
fn a_desktop_with_the_shared_library() {
    compare("shared");
}

#[test]
fn a_cortex_m4f() {
    compare("m4");
}

#[test]
fn a_cortex_m0() {
    compare("m0");
}
