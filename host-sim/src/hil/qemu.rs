//! The firmware's image in an emulator, with the link on a socket.

use super::wire::{Patient, Stream, Wire};
use std::io::{self, ErrorKind, Read};
use std::os::unix::net::UnixStream;
use std::os::unix::process::CommandExt;
use std::path::{Path, PathBuf};
use std::process::{Child, Command, ExitStatus, Stdio};
use std::sync::{Arc, Mutex, PoisonError};
use std::thread::{self, JoinHandle};
use std::time::{Duration, Instant};

/// The emulator.
pub const QEMU: &str = "qemu-system-arm";

/// Longest time until the emulator has opened its socket.
const START: Duration = Duration::from_millis(1800);

/// Longest time in which the log is read when it has ended.
const LAST_WORDS: Duration = Duration::from_millis(100);

/// Most of the log that is kept, bytes.
const MAX_LOG: usize = 16 << 20;

impl Patient for UnixStream {
    fn set_patience(&mut self, patience: Duration) -> io::Result<()> {
        self.set_read_timeout(Some(patience))?;
        self.set_write_timeout(Some(patience))
    }
}

/// Where `cargo fw` puts the image: in the target directory that this program came from, too.
pub fn default_image() -> PathBuf {
    let inside = Path::new("thumbv7em-none-eabihf/firmware/fuzzypilot");
    let own = std::env::current_exe().ok();
    let beside = own
        .iter()
        .flat_map(|exe| exe.ancestors().skip(2))
        .map(|folder| folder.join(inside))
        .find(|image| image.is_file());
    beside.unwrap_or_else(|| Path::new("target").join(inside))
}

/// A running emulator; it ends with this.
struct Emulator {
    child: Child,
    socket: PathBuf,
    log: Arc<Mutex<Vec<u8>>>,
    readers: Vec<JoinHandle<()>>,
}

impl Drop for Emulator {
    fn drop(&mut self) {
        self.kill();
        let _ = self.child.wait();
        self.hear_out();
        let _ = std::fs::remove_file(&self.socket);
    }
}

/// Collects what comes, until it ends.
fn collect(mut from: impl Read + Send + 'static, log: &Arc<Mutex<Vec<u8>>>) -> JoinHandle<()> {
    let log = Arc::clone(log);
    thread::spawn(move || {
        let mut bytes = [0; 4096];
        while let Ok(count @ 1..) = from.read(&mut bytes) {
            let mut log = log.lock().unwrap_or_else(PoisonError::into_inner);
            if log.len() < MAX_LOG {
                log.extend(&bytes[..count]);
            }
        }
    })
}

/// The emulator's end of the wire.
pub struct Qemu {
    stream: Stream<UnixStream>,
    emulator: Emulator,
}

impl Qemu {
    /// Starts the emulator, and the image in it.
    ///
    /// # Errors
    ///
    /// There is no emulator ([`ErrorKind::NotFound`]), or it does not start.
    pub fn start(image: &Path) -> io::Result<Self> {
        let begin = Instant::now();
        let nanos = std::time::UNIX_EPOCH
            .elapsed()
            .map_or(0, |d| d.subsec_nanos());
        let name = format!("fuzzypilot-{}-{nanos}.sock", std::process::id());
        let socket = std::env::temp_dir().join(name);
        let mut link = std::ffi::OsString::from("socket,id=hil,server=on,wait=off,path=");
        // A comma in an option's value is written twice.
        link.push(socket.to_string_lossy().replace(',', ",,"));
        let mut child = Command::new(QEMU)
            .args(["-M", "netduinoplus2", "-nographic", "-monitor", "none"])
            .args(["-semihosting-config", "enable=on,target=native"])
            .args(["-serial", "null", "-chardev"])
            .arg(link)
            .args(["-serial", "chardev:hil", "-kernel"])
            .arg(image)
            // A terminal's Ctrl-C is for this program, which ends the emulator.
            .process_group(0)
            .stdin(Stdio::null())
            .stdout(Stdio::piped())
            .stderr(Stdio::piped())
            .spawn()?;
        let log = Arc::default();
        let mut readers = Vec::new();
        readers.extend(child.stdout.take().map(|out| collect(out, &log)));
        readers.extend(child.stderr.take().map(|out| collect(out, &log)));
        let mut emulator = Emulator {
            child,
            socket,
            log,
            readers,
        };
        loop {
            match UnixStream::connect(&emulator.socket) {
                Ok(stream) => {
                    let name = format!("{QEMU} with {}", image.display());
                    return Ok(Self {
                        stream: Stream::new(stream, name),
                        emulator,
                    });
                }
                Err(error) => {
                    if let Some(words) = emulator.last_words(Duration::ZERO) {
                        return Err(io::Error::other(words));
                    }
                    if begin.elapsed() > START {
                        return Err(io::Error::new(
                            ErrorKind::TimedOut,
                            format!("it has not opened its socket: {error}"),
                        ));
                    }
                    thread::sleep(Duration::from_millis(5));
                }
            }
        }
    }
}

impl Emulator {
    /// Kills it with all that it has started: what is called like the emulator may be a script around it.
    fn kill(&self) {
        // Its group is named after it; that there is none any more is no error.
        let group = rustix::process::Pid::from_child(&self.child);
        let _ = rustix::process::kill_process_group(group, rustix::process::Signal::KILL);
    }

    /// Waits until all that it has said is read; not for long: somebody else may hold its end of a pipe.
    fn hear_out(&mut self) {
        let end = Instant::now() + LAST_WORDS;
        while Instant::now() < end && !self.readers.iter().all(JoinHandle::is_finished) {
            thread::sleep(Duration::from_millis(1));
        }
        self.readers.clear();
    }

    /// How it ended, if it has or does soon, with the last line that it said.
    fn last_words(&mut self, patience: Duration) -> Option<String> {
        let end = Instant::now() + patience;
        let status = loop {
            match self.child.try_wait() {
                Ok(Some(status)) => break status,
                Ok(None) if Instant::now() < end => thread::sleep(Duration::from_millis(5)),
                _ => return None,
            }
        };
        self.kill();
        self.hear_out();
        let log = self.log.lock().unwrap_or_else(PoisonError::into_inner);
        let text = String::from_utf8_lossy(&log);
        let last = text.lines().rev().find(|line| !line.trim().is_empty());
        let said = last.filter(|line| line.len() < 300 && line.starts_with(QEMU));
        let said = said.map_or_else(String::new, |line| format!(": {line}"));
        Some(format!("the emulator has ended ({}){said}", ending(status)))
    }
}

fn ending(status: ExitStatus) -> String {
    use std::os::unix::process::ExitStatusExt;
    match (status.signal(), status.code()) {
        (Some(signal), _) => format!("signal {signal}"),
        (_, Some(code)) => format!("exit code {code}"),
        _ => status.to_string(),
    }
}

impl Wire for Qemu {
    fn send(&mut self, frame: &[u8]) -> io::Result<()> {
        self.stream.send(frame)
    }

    fn receive(&mut self, room: &mut [u8], patience: Duration) -> io::Result<usize> {
        self.stream.receive(room, patience)
    }

    fn now(&self) -> Duration {
        self.stream.now()
    }

    fn name(&self) -> String {
        self.stream.name()
    }

    fn last_words(&mut self) -> Option<String> {
        // The socket closes a moment before the process is gone.
        self.emulator.last_words(Duration::from_millis(200))
    }

    fn log(&self) -> Vec<u8> {
        let log = self.emulator.log.lock();
        log.unwrap_or_else(PoisonError::into_inner).clone()
    }
}
