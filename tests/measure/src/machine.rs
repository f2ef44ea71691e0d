//! The emulated microcontrollers: building the images (`tests/replica`) and running them in QEMU.

use crate::repository;
use anyhow::{Context, bail, ensure};
use std::path::{Path, PathBuf};
use std::process::{Child, Command, Stdio};
use std::time::{Duration, Instant};

/// One emulated microcontroller.
#[derive(Debug)]
pub struct Machine {
    /// Its core, for people.
    pub name: &'static str,
    /// Its core, for files.
    pub key: &'static str,
    /// What its image is compiled for.
    pub target: &'static str,
    emulator: &'static str,
    board: &'static [&'static str],
    /// Rate of its clock, Hz; on RISC-V QEMU counts nanoseconds.
    rate: f64,
    /// Whether it has a budget.
    pub budgeted: bool,
}

/// All of them.
pub const MACHINES: [Machine; 3] = [
    Machine {
        name: "Cortex-M4F",
        key: "m4f",
        target: "thumbv7em-none-eabihf",
        emulator: "qemu-system-arm",
        board: &["-machine", "netduinoplus2"],
        rate: 168e6,
        budgeted: true,
    },
    Machine {
        name: "Cortex-M0",
        key: "m0",
        target: "thumbv6m-none-eabi",
        emulator: "qemu-system-arm",
        board: &["-machine", "microbit"],
        rate: 16e6,
        budgeted: true,
    },
    Machine {
        name: "RISC-V",
        key: "rv32",
        target: "riscv32imc-unknown-none-elf",
        emulator: "qemu-system-riscv32",
        board: &["-machine", "sifive_e", "-bios", "none"],
        rate: 1e9,
        budgeted: false,
    },
];

/// What every image is compiled with.
const PROFILE: &str = "firmware";

/// How the emulator keeps time.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum Time {
    /// As it likes: fastest.
    Free,
    /// Every instruction takes equally long.
    Counted,
    /// As it likes, and every instruction is a line of the file `log`.
    Logged,
}

/// 2 to the power of `-icount`'s shift. Long enough for more than two ticks of the slowest clock an instruction, so that
/// the clock tells single instructions; short enough for a tick to end before the fastest wraps.
const NANOSECONDS: f64 = 256.0;
const SHIFT: &str = "shift=8,sleep=off";

/// No run takes longer than this.
const PATIENCE: Duration = Duration::from_secs(300);

/// A tool that is not there.
#[derive(Debug)]
pub struct Missing(pub String);

impl std::fmt::Display for Missing {
    fn fmt(&self, f: &mut std::fmt::Formatter<'_>) -> std::fmt::Result {
        f.write_str(&self.0)
    }
}

impl std::error::Error for Missing {}

impl Machine {
    /// Instructions between two readings of the clock.
    pub fn instructions(&self, ticks: u32) -> f64 {
        f64::from(ticks) / (self.rate * NANOSECONDS * 1e-9)
    }

    /// Runs `image` on a file of tapes in `folder`; answers with what it wrote.
    pub fn run(
        &self,
        image: &Path,
        folder: &Path,
        tapes: &[u8],
        time: Time,
    ) -> anyhow::Result<Outcome> {
        std::fs::write(folder.join("tape"), tapes)
            .with_context(|| format!("{}: cannot be written", folder.display()))?;
        let mut command = Command::new(self.emulator);
        command
            .current_dir(folder)
            .args(self.board)
            .args(["-display", "none", "-monitor", "none", "-serial", "none"])
            .args(["-semihosting-config", "enable=on,target=native"])
            .arg("-kernel")
            .arg(image)
            .stdin(Stdio::null())
            .stdout(Stdio::null())
            .stderr(Stdio::piped());
        match time {
            Time::Free => {}
            Time::Counted => {
                command.args(["-icount", SHIFT]);
            }
            Time::Logged => {
                command.args(["-d", "exec,nochain", "-D", "log"]);
                // One instruction a block; the older spelling is gone in newer versions.
                match version(self.emulator)? {
                    ..9 => command.arg("-singlestep"),
                    _ => command.args(["-accel", "tcg,one-insn-per-tb=on"]),
                };
            }
        }
        let child = command.spawn().map_err(|e| self.missing(&e))?;
        let failure = self.wait(child)?;
        let out = std::fs::read(folder.join("out")).unwrap_or_default();
        Ok(Outcome { out, failure })
    }

    /// What went wrong, if anything did.
    fn wait(&self, mut child: Child) -> anyhow::Result<Option<String>> {
        let begin = Instant::now();
        while child.try_wait()?.is_none() {
            if begin.elapsed() > PATIENCE {
                child.kill()?;
                child.wait()?;
                let limit = PATIENCE.as_secs();
                return Ok(Some(format!("{}: not finished in {limit} s", self.name)));
            }
            std::thread::sleep(Duration::from_millis(5));
        }
        let done = child.wait_with_output()?;
        let said = String::from_utf8_lossy(&done.stderr).trim().to_owned();
        Ok(match done.status.code() {
            Some(0) => None,
            code => Some(format!("{}: exit code {code:?}: {said}", self.name)),
        })
    }

    fn missing(&self, error: &std::io::Error) -> anyhow::Error {
        missing(self.emulator, error)
    }
}

fn missing(emulator: &str, error: &std::io::Error) -> anyhow::Error {
    let how = "apt-get install -y --no-install-recommends qemu-system-arm qemu-system-misc";
    Missing(format!(
        "{emulator} cannot be started ({error}); to get it: {how}"
    ))
    .into()
}

/// The emulator's major version.
fn version(emulator: &str) -> anyhow::Result<u32> {
    let output = Command::new(emulator)
        .arg("--version")
        .output()
        .map_err(|e| missing(emulator, &e))?;
    let text = String::from_utf8_lossy(&output.stdout).into_owned();
    let major = text
        .split_whitespace()
        .skip_while(|word| *word != "version")
        .nth(1)
        .and_then(|version| version.split('.').next())
        .and_then(|major| major.parse().ok());
    major.with_context(|| format!("{emulator} --version: not understood: {text}"))
}

/// What a run left behind.
#[derive(Clone, Debug)]
pub struct Outcome {
    /// What the image wrote.
    pub out: Vec<u8>,
    /// Why it ended early, if it did.
    pub failure: Option<String>,
}

impl Outcome {
    /// The words written, if the run went well.
    pub fn words(self) -> anyhow::Result<Vec<u32>> {
        if let Some(failure) = self.failure {
            bail!(failure);
        }
        let (words, rest) = self.out.as_chunks::<4>();
        ensure!(rest.is_empty(), "the image wrote half a word");
        Ok(words.iter().map(|word| u32::from_le_bytes(*word)).collect())
    }
}

/// The folder that this program was built in: `target/release/…` leads to `target`.
pub(crate) fn build_folder() -> anyhow::Result<PathBuf> {
    let here = std::env::current_exe()?;
    let mut above = here.ancestors();
    let folder = above.find(|folder| folder.join("CACHEDIR.TAG").is_file());
    Ok(folder.context("the build folder was not found")?.to_owned())
}

/// The images, built.
#[derive(Clone, Debug)]
pub struct Images {
    folder: PathBuf,
}

impl Images {
    /// Builds them for every machine as the firmware is built.
    pub fn build() -> anyhow::Result<Self> {
        Self::build_with(&[])
    }

    /// Builds one of them only.
    pub fn build_one(name: &str) -> anyhow::Result<Self> {
        Self::build_with(&["--bin", name])
    }

    fn build_with(choice: &[&str]) -> anyhow::Result<Self> {
        let images = Self {
            folder: build_folder()?.join("replica"),
        };
        for machine in &MACHINES {
            let status = images
                .command(machine)
                .args(choice)
                .status()
                .context("cargo cannot be started")?;
            let name = machine.name;
            ensure!(status.success(), "the image for {name} cannot be built");
        }
        Ok(images)
    }

    /// Builds an image with one of the package's features, and expects that it cannot be: what was said then, or nothing
    /// if it was built.
    pub fn refused(
        &self,
        machine: &Machine,
        name: &str,
        feature: &str,
    ) -> anyhow::Result<Option<String>> {
        let built = self
            .command(machine)
            .args(["--bin", name, "--features", feature])
            .output()
            .context("cargo cannot be started")?;
        let said = String::from_utf8_lossy(&built.stderr).into_owned();
        Ok((!built.status.success()).then_some(said))
    }

    fn command(&self, machine: &Machine) -> Command {
        let cargo = std::env::var_os("CARGO").unwrap_or_else(|| "cargo".into());
        let mut command = Command::new(cargo);
        command
            .current_dir(repository("."))
            // Those of `.cargo/config.toml` only.
            .env_remove("RUSTFLAGS")
            .env_remove("CARGO_ENCODED_RUSTFLAGS")
            .args(["build", "--quiet", "--package", "replica"])
            .args(["--profile", PROFILE, "--target", machine.target])
            .arg("--target-dir")
            .arg(&self.folder);
        command
    }

    /// The file of an image.
    pub fn of(&self, machine: &Machine, name: &str) -> PathBuf {
        let built = self.folder.join(machine.target).join(PROFILE);
        built.join(name)
    }
}
