//! `cargo engine`: what one evaluation of the fine controller costs on each core, and what it is linked with.

use crate::machine::{Images, MACHINES, Machine, Time};
use anyhow::{Context, bail, ensure};
use fuzzypilot::behaviour::fine::FineMotion;
use object::{Object, ObjectSymbol, SymbolKind};
use replica::fine::{CONTROLLER, grid, mix};

/// The ways in the image's order.
const WAYS: [&str; 3] = ["plain Rust", "compiled in", "by reference"];

/// What a core may need: instructions by [`WAYS`], bytes of flash.
struct Bar {
    core: &'static str,
    instructions: [u32; 3],
    flash: u64,
}

/// By the core's key.
const BARS: [Bar; 3] = [
    Bar {
        core: "m4f",
        instructions: [80, 55, 45],
        flash: 512,
    },
    Bar {
        core: "m0",
        instructions: [170, 160, 170],
        flash: 512,
    },
    Bar {
        core: "rv32",
        instructions: [110, 110, 110],
        flash: 512,
    },
];

/// Counts, prints, and compares with the bars and with this machine's results.
pub fn run() -> anyhow::Result<()> {
    let images = Images::build()?;
    let expected = grid().fold(0, |sum, (d, error)| {
        let FineMotion {
            speed, yaw_rate, ..
        } = CONTROLLER.evaluate(d, error);
        mix(sum, (speed.bits(), yaw_rate.bits()))
    });
    let mut misses = Vec::new();
    for machine in &MACHINES {
        let bar = BARS
            .iter()
            .find(|bar| bar.core == machine.key)
            .context("a core without a bar")?;
        misses.extend(core(machine, &images, bar, expected)?);
    }
    if misses.is_empty() {
        return Ok(());
    }
    bail!("{}", misses.join("; "))
}

fn core(
    machine: &Machine,
    images: &Images,
    bar: &Bar,
    expected: u32,
) -> anyhow::Result<Vec<String>> {
    let folder = tempfile::tempdir()?;
    let words = machine
        .run(
            &images.of(machine, "fine"),
            folder.path(),
            &[],
            Time::Counted,
        )?
        .words()?;
    let [empty, thousand, _, call, _, ways @ ..] = words.as_slice() else {
        bail!("{}: nothing was counted", machine.name);
    };
    let instructions = |ticks: u32| machine.instructions(ticks).round() as u32;
    ensure!(
        instructions(thousand.wrapping_sub(*empty)).abs_diff(1000) <= 32,
        "{}: the clock is no instruction counter",
        machine.name
    );
    let mut misses = Vec::new();
    let (ways, rest) = ways.as_chunks::<3>();
    ensure!(rest.is_empty() && ways.len() == WAYS.len(), "half a way");
    for ((name, [least, most, sum]), bar) in WAYS.iter().zip(ways).zip(bar.instructions) {
        let [least, most] = [least, most].map(|t| instructions(t.saturating_sub(*call)) + 1);
        println!(
            "{}, {name}: {least} to {most} instructions (at most {bar})",
            machine.name
        );
        if most > bar || least != most {
            misses.push(format!(
                "{}, {name}: {least} to {most} instructions; allowed is one number up to {bar}",
                machine.name
            ));
        }
        if *sum != expected {
            misses.push(format!(
                "{}, {name}: the results are not this machine's",
                machine.name
            ));
        }
    }
    let (flash, foreign) = alone(machine, images)?;
    println!("{}: {flash} bytes of code and tables", machine.name);
    if flash > bar.flash {
        misses.push(format!(
            "{}: {flash} bytes of code and tables; allowed is {}",
            machine.name, bar.flash
        ));
    }
    if !foreign.is_empty() {
        misses.push(format!(
            "{}: linked with {}",
            machine.name,
            foreign.join(", ")
        ));
    }
    Ok(misses)
}

/// Bytes of the controller's function, scales and tables; and what of floats and divisions is linked with it. That it
/// links says that nothing panics.
fn alone(machine: &Machine, images: &Images) -> anyhow::Result<(u64, Vec<String>)> {
    let image = images.of(machine, "fine-alone");
    let bytes = std::fs::read(&image).with_context(|| image.display().to_string())?;
    let file = object::File::parse(&*bytes)?;
    let (mut flash, mut code, mut foreign) = (0, 0, Vec::new());
    for symbol in file.symbols() {
        let name = symbol.name()?;
        let own = name == "fine_controller" || name.contains("CONTROLLER") || name.contains("TWIN");
        if own {
            flash += symbol.size();
        }
        if name == "fine_controller" && symbol.kind() == SymbolKind::Text {
            code = symbol.size();
        }
        if ["__aeabi_f", "__aeabi_d", "div", "panic"]
            .iter()
            .any(|part| name.contains(part))
        {
            foreign.push(name.to_owned());
        }
    }
    ensure!(code > 0, "{}: no controller in the image", machine.name);
    Ok((flash, foreign))
}
