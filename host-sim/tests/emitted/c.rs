//! Sources of C: compiled with every warning an error and with what C leaves open trapped, run, and compiled for
//! microcontrollers.

use super::systems::{Made, crowd, designs, random_systems, weird_names};
use super::{campaign, cases, folder, put};
use host_sim::fuzzy::emit::c::write;
use std::fmt::Write;
use std::path::{Path, PathBuf};
use std::process::{Command, Output};

const WARNINGS: [&str; 9] = [
    "-std=c99",
    "-Wall",
    "-Wextra",
    "-Wpedantic",
    "-Wconversion",
    "-Wsign-conversion",
    "-Wshadow",
    "-Wundef",
    "-Werror",
];

const MAIN: &str = "#include <stdio.h>
#include <stdlib.h>

static int32_t next(void)
{
    int32_t number;
    if (fread(&number, sizeof number, 1U, stdin) != 1U)
    {
        exit(1);
    }
    return number;
}

#define RUN(name, NAME) \\
    static void run_##name(void) \\
    { \\
        int32_t left; \\
        for (left = next(); left > 0; left--) \\
        { \\
            int32_t in[NAME##_INPUTS]; \\
            int32_t out[NAME##_OUTPUTS]; \\
            int32_t alone[NAME##_OUTPUTS]; \\
            uint32_t degrees[NAME##_RULES]; \\
            uint32_t i; \\
            for (i = 0U; i < NAME##_INPUTS; i++) \\
            { \\
                in[i] = next(); \\
            } \\
            name##_evaluate(in, out, degrees); \\
            name##_evaluate(in, alone, NULL); \\
            for (i = 0U; i < NAME##_OUTPUTS; i++) \\
            { \\
                if (out[i] != alone[i]) \\
                { \\
                    exit(1); \\
                } \\
            } \\
            (void)fwrite(out, sizeof out, 1U, stdout); \\
            (void)fwrite(degrees, sizeof degrees, 1U, stdout); \\
        } \\
    }
";

/// Runs a compiler; `None` where there is none.
fn compiler(name: &str, folder: &Path, arguments: &[&str]) -> Option<Output> {
    let output = Command::new(name)
        .current_dir(folder)
        .args(arguments)
        .output()
        .ok();
    if output.is_none() {
        println!("skipped: {name} is not here");
    }
    output
}

fn succeeded(output: &Output) {
    let said = String::from_utf8_lossy(&output.stderr);
    assert!(output.status.success(), "{said}");
}

/// Writes the files, and gives their sources' names.
fn written(folder: &Path, systems: &[Made]) -> Vec<String> {
    let each = systems.iter().enumerate().map(|(i, made)| {
        let name = format!("m{i}");
        let files = write(&made.design(&name), &format!("{name}.h"));
        put(folder.join(format!("{name}.h")), &files.header);
        put(folder.join(format!("{name}.c")), &files.source);
        format!("{name}.c")
    });
    each.collect()
}

#[test]
fn the_same_integers_as_the_library() {
    let mut systems = designs();
    systems.push(weird_names());
    systems.push(crowd());
    systems.extend(random_systems(campaign().0));
    let folder = folder("c");
    let sources = written(&folder, &systems);
    let (mut includes, mut runs, mut calls) = (String::new(), String::new(), String::new());
    for i in 0..systems.len() {
        writeln!(includes, "#include \"m{i}.h\"").unwrap();
        writeln!(runs, "RUN(m{i}, M{i})").unwrap();
        writeln!(calls, "    run_m{i}();").unwrap();
    }
    put(
        folder.join("main.c"),
        &format!("{includes}{MAIN}\n{runs}\nint main(void)\n{{\n{calls}    return 0;\n}}\n"),
    );
    let mut arguments = WARNINGS.to_vec();
    arguments.extend([
        "-O1",
        "-fsanitize=undefined",
        "-fno-sanitize-recover=all",
        "-o",
        "all",
        "main.c",
    ]);
    arguments.extend(sources.iter().map(String::as_str));
    let Some(output) = compiler("gcc", &folder, &arguments) else {
        return;
    };
    succeeded(&output);
    let asked: Vec<_> = systems
        .iter()
        .map(|made| {
            let inputs = cases::inputs(made, 400);
            let expected = cases::expected(made, &inputs);
            (made, inputs, expected)
        })
        .collect();
    cases::compare(&folder.join("all"), &asked);
}

/// No float, no division, no library: the compiler's own shifts and products of 64 bits are all that is left open.
#[test]
fn microcontrollers_need_nothing_else() {
    let folder = folder("bare");
    let systems = designs();
    let sources = written(&folder, &systems);
    for processor in ["cortex-m0", "cortex-m4"] {
        let cpu = format!("-mcpu={processor}");
        let mut arguments = WARNINGS.to_vec();
        arguments.extend([
            &cpu,
            "-mthumb",
            "-mfloat-abi=soft",
            "-Os",
            "-ffreestanding",
            "-c",
        ]);
        arguments.extend(sources.iter().map(String::as_str));
        let Some(output) = compiler("arm-none-eabi-gcc", &folder, &arguments) else {
            return;
        };
        succeeded(&output);
        let objects: Vec<PathBuf> = sources
            .iter()
            .map(|source| folder.join(source).with_extension("o"))
            .collect();
        let names: Vec<&str> = objects
            .iter()
            .map(|object| object.to_str().unwrap())
            .collect();
        let Some(output) = compiler("arm-none-eabi-nm", &folder, &[&["-u"], &names[..]].concat())
        else {
            return;
        };
        succeeded(&output);
        let text = String::from_utf8(output.stdout).unwrap();
        let open = text
            .lines()
            .filter_map(|line| line.trim().strip_prefix("U "));
        for symbol in open {
            let own = [
                "__aeabi_lmul",
                "__aeabi_llsl",
                "__aeabi_llsr",
                "__aeabi_lcmp",
                "__aeabi_ulcmp",
            ];
            assert!(
                own.contains(&symbol) || symbol.starts_with("__gnu_thumb1"),
                "{processor}: {symbol}"
            );
        }
        if let Some(output) = compiler("arm-none-eabi-size", &folder, &names) {
            println!("{processor}\n{}", String::from_utf8_lossy(&output.stdout));
        }
    }
}
