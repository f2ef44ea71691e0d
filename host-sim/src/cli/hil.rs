//! `host-sim hil`

use super::run::{self, Watch, json, report};
use super::{BadInput, Variants, check_folder, load, none_of_what_is_read, print, put, whole};
use anyhow::Context;
use clap::{ArgGroup, Args};
use comfy_table::{Table, presets::UTF8_FULL_CONDENSED};
use host_sim::hil::fault::{Fault, Faulty};
use host_sim::hil::hostile::{HostileReport, attack};
use host_sim::hil::line::INTERRUPTED;
use host_sim::hil::local::Local;
use host_sim::hil::report::{LinkReport, Received};
use host_sim::hil::serial::{self, BAUD};
use host_sim::hil::wire::Wire;
use host_sim::hil::{HilError, Outage};
use std::path::{Path, PathBuf};
use std::sync::atomic::Ordering;

#[derive(Args)]
#[command(group = ArgGroup::new("robot").required(true).args(["qemu", "port", "local"]))]
pub struct HilArguments {
    /// The firmware in QEMU.
    #[arg(long)]
    qemu: bool,
    /// A board on this serial port, /dev/ttyACM0 for example.
    #[arg(long, value_name = "PORT")]
    port: Option<String>,
    /// The firmware's pilot in this process: the same bytes, no wire.
    #[arg(long)]
    local: bool,
    /// Firmware image for QEMU; the one that `cargo fw` has built when left out.
    #[arg(long, value_name = "FILE", conflicts_with_all = ["port", "local"])]
    image: Option<PathBuf>,
    /// Baud rate of the port.
    #[arg(long, default_value_t = BAUD, conflicts_with_all = ["qemu", "local"])]
    baud: u32,
    /// Built-in scenario (see `host-sim list`) or a TOML file.
    #[arg(long, value_name = "NAME", default_value = "experiment-1")]
    scenario: String,
    #[command(flatten)]
    variants: Variants,
    /// Seed of the run's noise, and of the faults.
    #[arg(long, default_value_t = 1, value_parser = whole(0, u64::MAX), allow_hyphen_values = true)]
    seed: u64,
    /// Folder for the results; out/hil-SCENARIO when left out.
    #[arg(long, value_name = "DIR")]
    out: Option<PathBuf>,
    /// Spoil frames: [to-|from-]KIND[:RATE|@PERIOD[+COUNT]] with KIND truncate, corrupt, duplicate, reorder, drop,
    /// noise or silence; may be given several times.
    #[arg(long, value_name = "FAULT")]
    fault: Vec<Fault>,
    /// Arm the robot again by itself, after N good answers in a row, when the link has disarmed it.
    #[arg(
        long,
        value_name = "N",
        num_args = 0..=1,
        require_equals = true,
        default_missing_value = "5",
        value_parser = clap::value_parser!(u32).range(1..=1000)
    )]
    rearm: Option<u32>,
    /// Instead of a run: send N hostile frames (random, truncated, with bits flipped, played back) and see that the robot
    /// neither moves nor resets, and hears good ones again.
    #[arg(
        long,
        value_name = "N",
        value_parser = whole(1, 100_000_000),
        conflicts_with_all = ["fault", "rearm"]
    )]
    hostile: Option<u64>,
}

/// What is written beside a run's own files.
const FILES: [&str; 3] = ["link.json", "hostile.json", "target.log"];

pub fn execute(arguments: &HilArguments) -> anyhow::Result<()> {
    let scenario = load(&arguments.scenario, &arguments.variants)?;
    let folder = match &arguments.out {
        Some(folder) => folder.clone(),
        None => Path::new("out").join(format!("hil-{}", scenario.name)),
    };
    check_folder(&folder)?;
    let read = [("the scenario", Path::new(&arguments.scenario))];
    none_of_what_is_read("--out", &folder, &run::FILES, &read)?;
    none_of_what_is_read("--out", &folder, &FILES, &read)?;
    // Waits look at it, and whatever was started is ended in good order.
    ctrlc::set_handler(|| INTERRUPTED.store(true, Ordering::Relaxed))
        .context("signals: cannot be handled")?;
    let wire = connect(arguments)?;
    if let Some(count) = arguments.hostile {
        let report = attack(&scenario, arguments.seed, wire, count).map_err(flat)?;
        std::fs::create_dir_all(&folder)
            .with_context(|| format!("{}: cannot be created", folder.display()))?;
        put(&folder.join("hostile.json"), &json(&report)?)?;
        log(&folder, &report.log)?;
        print(stood(&report))?;
        return print(format_args!("written: {}\n", folder.display()));
    }

    let mut watch = Watch::new(&scenario, arguments.seed);
    let driven = host_sim::hil::run(
        &scenario,
        arguments.seed,
        wire,
        arguments.rearm,
        &mut |period| watch.period(period),
    )
    .map_err(flat)?;
    let summary = watch.write(driven.ending, &folder)?;
    put(&folder.join("link.json"), &json(&driven.report)?)?;
    log(&folder, &driven.log)?;
    print(report(&scenario, &summary))?;
    print(link(&driven.report))?;
    print(format_args!("written: {}\n", folder.display()))?;
    driven.outage.map_or(Ok(()), |outage| Err(outage.into()))
}

/// The error behind, by which the exit code goes.
fn flat(error: HilError) -> anyhow::Error {
    match error {
        HilError::Run(error) => error.into(),
        HilError::Outage(outage) => outage.into(),
    }
}

/// Writes what the robot has logged, if it can be had.
fn log(folder: &Path, log: &[u8]) -> anyhow::Result<()> {
    match log {
        [] => Ok(()),
        log => put(&folder.join("target.log"), log),
    }
}

/// Opens the wire that is asked for.
fn connect(arguments: &HilArguments) -> anyhow::Result<Box<dyn Wire>> {
    let wire: Box<dyn Wire> = match &arguments.port {
        Some(port) => {
            let open = serial::open(port, arguments.baud);
            Box::new(open.map_err(|error| Outage::Unopened {
                wire: port.clone(),
                why: error.to_string(),
            })?)
        }
        None if arguments.local => Box::new(Local::new()),
        None => emulator(arguments.image.as_deref())?,
    };
    if arguments.fault.is_empty() {
        return Ok(wire);
    }
    let faults = arguments.fault.clone();
    Ok(Box::new(Faulty::new(wire, faults, arguments.seed)))
}

#[cfg(unix)]
fn emulator(image: Option<&Path>) -> anyhow::Result<Box<dyn Wire>> {
    use host_sim::hil::qemu::{QEMU, Qemu, default_image};
    let image = image.map_or_else(default_image, Path::to_path_buf);
    if !image.is_file() {
        return Err(BadInput(format!(
            "--image {}: there is no such file; `cargo fw` builds the firmware's image",
            image.display()
        ))
        .into());
    }
    if !is_image(&image) {
        return Err(BadInput(format!(
            "--image {}: it is no program for ARM (a 32-bit ELF file); `cargo fw` builds the firmware's image",
            image.display()
        ))
        .into());
    }
    match Qemu::start(&image) {
        Ok(qemu) => Ok(Box::new(qemu)),
        Err(error) if error.kind() == std::io::ErrorKind::NotFound => Err(BadInput(format!(
            "--qemu: {QEMU} is not installed; `apt-get install qemu-system-arm` or the like does it"
        ))
        .into()),
        Err(error) => Err(Outage::Unopened {
            wire: format!("{QEMU} with {}", image.display()),
            why: error.to_string(),
        }
        .into()),
    }
}

/// Whether a file begins as an ELF file for 32-bit ARM does.
#[cfg(unix)]
fn is_image(path: &Path) -> bool {
    use std::io::Read;
    let mut head = [0; 20];
    let read = std::fs::File::open(path).and_then(|mut file| file.read_exact(&mut head));
    // Magic number, 32 bits, little endian; machine 40.
    read.is_ok() && head.starts_with(b"\x7fELF\x01\x01") && head.ends_with(&[40, 0])
}

#[cfg(not(unix))]
fn emulator(_: Option<&Path>) -> anyhow::Result<Box<dyn Wire>> {
    Err(BadInput("--qemu: needs Unix sockets; allowed here are --port and --local".into()).into())
}

/// The link's figures, and what happened.
fn link(report: &LinkReport) -> String {
    let mut table = Table::new();
    table.load_style(UTF8_FULL_CONDENSED);
    table.set_header(["link", "value"]);
    let bad = |r: &Received| {
        format!(
            "{} overlong, {} truncated, {} corrupt",
            r.overlong, r.truncated, r.corrupt
        )
    };
    let mut rows = vec![
        ("robot", report.target.clone()),
        ("firmware", report.firmware.clone()),
        (
            "ticks",
            format!(
                "{} answered, {} lost, {} while disarmed",
                report.ticks, report.lost_ticks, report.disarmed_ticks
            ),
        ),
        (
            "speed",
            format!(
                "{:.1} × real time, {:.0} round trips a second (after {:.1} s of set-up)",
                report.times_real_time, report.round_trips_per_s, report.setup_s
            ),
        ),
        (
            "frames",
            format!(
                "{} sent, {} of them again for want of an answer; {} received, {} of them late",
                report.frames_sent, report.retries, report.received.good, report.late
            ),
        ),
        ("bad frames here", bad(&report.received)),
        ("bad frames there", bad(&report.received_by_target)),
    ];
    if report.stack_bytes > 0 {
        rows.push(("deepest stack", format!("{} bytes", report.stack_bytes)));
    }
    if !report.faults.is_empty() {
        let faults = report.faults.iter();
        let faults: Vec<String> = faults.map(|(kind, n)| format!("{n} {kind}")).collect();
        rows.push(("faults on purpose", faults.join(", ")));
    }
    if let Some(after) = report.motors_stopped_after_ms {
        let text = format!("{after:.0} ms after their last command, at most");
        rows.push(("motors stopped by themselves", text));
    }
    for (name, value) in rows {
        table.add_row([name.to_owned(), value]);
    }
    let mut text = format!("{table}\n");
    for event in report.events.iter().take(SHOWN) {
        text += &format!("{:10.2} s  {}\n", event.time_s, event.what);
    }
    if report.events.len() > SHOWN {
        text += &format!("{:>10}    and so on: see link.json\n", "…");
    }
    text
}

/// What hostile frames came to.
fn stood(report: &HostileReport) -> String {
    let mut table = Table::new();
    table.load_style(UTF8_FULL_CONDENSED);
    table.set_header(["hostile frames", "value"]);
    let r = &report.received_by_target;
    let rows = [
        ("robot", report.target.clone()),
        (
            "sent",
            format!(
                "{} random, {} truncated, {} with bits flipped, {} played back, in {:.1} s; {} of them to a monitor",
                report.random,
                report.truncated,
                report.flipped,
                report.replayed,
                report.seconds,
                report.in_monitor
            ),
        ),
        (
            "the robot counts",
            format!(
                "{} good, {} overlong, {} truncated, {} corrupt, {} of another version",
                r.good, r.overlong, r.truncated, r.corrupt, r.other_version
            ),
        ),
        ("moved, was armed", "never".to_owned()),
        (
            "reset",
            format!(
                "never: {:.1} s to {:.1} s since its start",
                f64::from(report.uptime_ms.0) / 1e3,
                f64::from(report.uptime_ms.1) / 1e3
            ),
        ),
        (
            "heard again",
            format!(
                "after {} good frames at most, in {} looks; then set up, armed and stopped",
                report.recovered_after, report.checks
            ),
        ),
    ];
    for (name, value) in rows {
        table.add_row([name.to_owned(), value]);
    }
    format!("{table}\n")
}

/// Events that are printed.
const SHOWN: usize = 40;
