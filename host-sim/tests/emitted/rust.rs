//! Modules of Rust, compiled as one crate without std.

use super::fast;
use super::systems::{Made, crowd, designs, fast_systems, random_systems, weird_names};
use super::{campaign, cases, folder, put};
use host_sim::fuzzy::emit::rust::{Route, write};
use std::fmt::Write;
use std::path::Path;
use std::process::Command;

const MANIFEST: &str = r#"[package]
name = "emitted"
version = "0.0.0"
edition = "2024"

[workspace]

[dependencies]
fixed = "1.31"
fuzzypilot = { path = "ROOT" }

[profile.dev]
debug = false
opt-level = 1
"#;

const MAIN: &str = "use emitted::*;
use std::io::{Read, Write};

macro_rules! general {
    ($module:ident, $numbers:ident, $found:ident) => {
        for _ in 0..$numbers.next().unwrap() {
            let inputs = std::array::from_fn(|_| $numbers.next().unwrap());
            let now = $module::CONTROLLER.evaluate(inputs);
            assert_eq!($module::evaluate(inputs), now.outputs);
            $found.extend(now.outputs);
            $found.extend(now.rules.map(|degree| degree.bits() as i32));
        }
    };
}

macro_rules! fast {
    ($module:ident, $numbers:ident, $found:ident) => {
        for _ in 0..$numbers.next().unwrap() {
            let inputs = std::array::from_fn(|_| $numbers.next().unwrap());
            $found.extend($module::evaluate(inputs));
        }
    };
}

fn main() {
    let mut bytes = Vec::new();
    std::io::stdin().read_to_end(&mut bytes).unwrap();
    let mut numbers = bytes.chunks_exact(4).map(|b| i32::from_ne_bytes(b.try_into().unwrap()));
    let mut found: Vec<i32> = Vec::new();
CALLS
    let found: Vec<u8> = found.into_iter().flat_map(i32::to_ne_bytes).collect();
    std::io::stdout().write_all(&found).unwrap();
}
";

fn cargo(folder: &Path, arguments: &[&str]) {
    let cargo = std::env::var_os("CARGO").unwrap_or_else(|| "cargo".into());
    let output = Command::new(cargo)
        .args(arguments)
        .args(["--offline", "--quiet", "--target-dir", "target"])
        .current_dir(folder)
        .output()
        .unwrap();
    let said = String::from_utf8_lossy(&output.stderr);
    assert!(output.status.success(), "{arguments:?}: {said}");
}

#[test]
fn the_same_integers_as_the_library() {
    let (count, long) = campaign();
    let mut general = designs();
    general.push(weird_names());
    general.push(crowd());
    general.extend(random_systems(count));
    let fast = fast_systems(count / 4);
    let folder = folder("rust");
    let root = Path::new(env!("CARGO_MANIFEST_DIR")).parent().unwrap();
    std::fs::create_dir_all(folder.join("src")).unwrap();
    put(
        folder.join("Cargo.toml"),
        &MANIFEST.replace("ROOT", root.to_str().unwrap()),
    );
    std::fs::copy(root.join("Cargo.lock"), folder.join("Cargo.lock")).unwrap();
    let mut library =
        "//! Modules as they are written.\n#![no_std]\n#![deny(warnings)]\n".to_owned();
    let mut calls = String::new();
    let mut files = Vec::new();
    let mut add = |made: &Made, route, kind: &str| {
        let module = format!("m{}", files.len());
        let file = folder.join("src").join(format!("{module}.rs"));
        put(
            file.clone(),
            &write(&made.design(&made.system.name), route).unwrap(),
        );
        writeln!(library, "pub mod {module};").unwrap();
        writeln!(calls, "    {kind}!({module}, numbers, found);").unwrap();
        files.push(file);
    };
    let mut systems = Vec::new();
    for made in &general {
        add(made, Route::General, "general");
        let inputs = cases::inputs(made, 300);
        let expected = cases::expected(made, &inputs);
        systems.push((made, inputs, expected));
    }
    for made in &fast {
        add(made, Route::Fast, "fast");
        let inputs = cases::inputs(made, 2000);
        let expected = fast::expected(made, &inputs);
        systems.push((made, inputs, expected));
    }
    put(folder.join("src/lib.rs"), &library);
    put(folder.join("src/main.rs"), &MAIN.replace("CALLS", &calls));
    cargo(&folder, &["build"]);
    cases::compare(&folder.join("target/debug/emitted"), &systems);
    let check = ["--check", "--edition", "2024"];
    match Command::new("rustfmt").args(check).args(&files).output() {
        Ok(output) => assert!(
            output.status.success(),
            "{}",
            String::from_utf8_lossy(&output.stdout)
        ),
        Err(_) => println!("skipped: rustfmt is not here"),
    }
    if long {
        cargo(&folder, &["clippy", "--", "-D", "warnings"]);
    }
}
