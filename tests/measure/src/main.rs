//! `cargo bit-exact`, `cargo budgets`, `cargo engine`, `cargo systems` and `cargo navigation`.

use anyhow::{Context, bail, ensure};
use clap::{Args, Parser, Subcommand};
use comfy_table::{Table, presets::NOTHING};
use measure::budgets::{Budgets, Measured, readme};
use measure::counts::{COUNTED, count};
use measure::machine::{Images, MACHINES, Missing};
use measure::page::{Page, grouped};
use measure::{clock, digests, engine, exact, firmware, footprint, navigation, suite, systems};
use std::process::ExitCode;
use std::time::Instant;

/// Ticks that are compared when nobody asks for another number of them: what README.md tells.
const TICKS: usize = 1_050_000;

const README: Page = Page {
    file: "README.md",
    begin: "<!-- ticks: written by `cargo bit-exact --write` -->",
    end: "<!-- ticks end -->",
    renew: "cargo bit-exact --write",
};

/// Compares the tick on emulated microcontrollers with this machine's, and counts what it costs there.
#[derive(Parser)]
#[command(max_term_width = 100)]
struct Arguments {
    #[command(subcommand)]
    command: Command,
}

#[derive(Subcommand)]
enum Command {
    /// Compare the records of every scenario, other runs and invented ones, byte by byte, tests/digests.toml and the README's figure.
    BitExact(BitExact),
    /// Count instructions, stack, flash and memory, and compare them with tests/budgets.toml and the README's table.
    Budgets(Write),
    /// Evaluate general fuzzy systems: the same bits everywhere, the same count of instructions for every input, and the
    /// table in docs/engine.md.
    Systems(Write),
    /// Count one evaluation of the fine controller over a grid, and compare results, tests/engine.toml and docs/engine.md;
    /// tell how far it is off fuzzylite, or off f64.
    Engine(Write),
    /// Drive the navigator through generated worlds, compare every tick's record on emulated microcontrollers byte by byte,
    /// count them there, and compare digests and counts with tests/navigation.toml and docs/bench.md.
    Navigation(Write),
}

#[derive(Args)]
struct BitExact {
    /// At least as many ticks in all, over all machines.
    #[arg(long, default_value_t = TICKS)]
    ticks: usize,
    #[command(flatten)]
    write: Write,
}

#[derive(Args)]
struct Write {
    /// Write what was found instead of comparing with what is written.
    #[arg(long)]
    write: bool,
}

fn main() -> ExitCode {
    let done = match Arguments::parse().command {
        Command::BitExact(arguments) => bit_exact(&arguments),
        Command::Budgets(arguments) => budgets(arguments.write),
        Command::Systems(arguments) => systems::run(arguments.write),
        Command::Engine(arguments) => engine::run(arguments.write),
        Command::Navigation(arguments) => navigation::run(arguments.write),
    };
    match done {
        Ok(()) => ExitCode::SUCCESS,
        Err(error) => {
            eprintln!("error: {error:#}");
            ExitCode::from(if error.is::<Missing>() { 3 } else { 1 })
        }
    }
}

fn bit_exact(arguments: &BitExact) -> anyhow::Result<()> {
    let begin = Instant::now();
    match arguments.write.write {
        true => digests::write()?,
        false => digests::check()?,
    }
    let tapes = suite::compared(arguments.ticks.div_ceil(MACHINES.len()))?;
    let images = Images::build()?;
    let comparisons = exact::compare_all(&images, &tapes)?;
    let (mut ticks, mut differing, mut equal) = (0, 0, true);
    for (machine, comparison) in MACHINES.iter().zip(&comparisons) {
        println!("{}: {comparison}", machine.name);
        ticks += comparison.ticks;
        differing += comparison.differing;
        equal &= comparison.is_equal();
    }
    let seconds = begin.elapsed().as_secs();
    println!(
        "{} runs, {ticks} ticks in all, {differing} bytes differ from the desktop's ({seconds} s)",
        tapes.len()
    );
    ensure!(equal, "the records are not the same everywhere");
    if arguments.ticks != TICKS {
        return Ok(());
    }
    let all = grouped(u32::try_from(ticks)?);
    let figure = format!("{all}, {differing} differing bytes");
    README.hold_figure(&figure, arguments.write.write)
}

fn budgets(write: bool) -> anyhow::Result<()> {
    let images = Images::build()?;
    let runs = suite::counted()?;
    let (mut measured, mut others) = (Vec::new(), Vec::new());
    for machine in &MACHINES {
        let spans = clock::check(machine, &images)?;
        println!(
            "{}: the clock agrees with the log of single instructions in {spans} of {spans} spans",
            machine.name
        );
        let found = Measured {
            core: (machine.key, machine.name),
            footprint: footprint::library(machine, &images)?,
            needs: count(machine, &images, &runs)?,
        };
        match machine.budgeted {
            true => measured.push(found),
            false => others.push(found),
        }
    }
    println!("{}", report(measured.iter().chain(&others)));
    let whole = firmware::whole()?;
    println!(
        "the F411's whole image: {} bytes of flash, {} of static memory, {} of stack at the deepest that can be",
        whole.footprint.flash, whole.footprint.ram, whole.stack
    );
    let mut budgets = Budgets::read()?;
    let misfits = budgets.check(&measured, whole, write);
    for misfit in &misfits {
        println!("{misfit}");
    }
    let table = budgets.table(&measured, whole)?;
    if write {
        budgets.write()?;
        return readme(&table, true);
    }
    if !misfits.is_empty() {
        bail!(
            "{} budgets do not fit; if that is meant: cargo budgets --write",
            misfits.len()
        );
    }
    readme(&table, false).context("budgets fit, but")
}

/// What was measured, and where the worst was.
fn report<'m>(measured: impl IntoIterator<Item = &'m Measured>) -> Table {
    let mut table = Table::new();
    table.load_style(NOTHING);
    table.set_header(["core", "what", "median", "worst", "in", "contrived", "in"]);
    for Measured {
        core: (_, core),
        footprint,
        needs,
    } in measured
    {
        for ((_, what), spread) in COUNTED.iter().zip(&needs.instructions) {
            let [worst_at, contrived_at] = &spread.at;
            table.add_row([
                core,
                what.trim_matches('*'),
                &spread.median.to_string(),
                &spread.worst.to_string(),
                worst_at,
                &spread.contrived.to_string(),
                contrived_at,
            ]);
        }
        let bytes = [
            ("stack, bytes", needs.stack, needs.stack_at.as_str()),
            ("flash, bytes", footprint.flash, ""),
            ("static memory, bytes", footprint.ram, ""),
        ];
        for (what, bytes, at) in bytes {
            table.add_row([core, what, "", &bytes.to_string(), at, "", ""]);
        }
    }
    table
}
