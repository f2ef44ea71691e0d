//! A design as a header and a source of C99: no float, no memory but the stack, nothing but `stdint.h` and `stddef.h`, no
//! behaviour that C leaves open. The same integers as [`Lowered`](crate::fuzzy::lower::Lowered), bit by bit.

mod header;
mod runtime;
mod source;

use super::Design;
use super::names::{Identifiers, Taken, identifier};

/// Two files that belong together.
#[derive(Clone, Debug, PartialEq, Eq)]
pub struct Files {
    /// `NAME.h`.
    pub header: String,
    /// `NAME.c`, which includes it.
    pub source: String,
}

/// Writes both; `header` is what the source includes.
pub fn write(design: &Design<'_>, header: &str) -> Files {
    let names = Names::of(design);
    Files {
        header: header::text(design, &names),
        source: source::text(design, &names, header),
    }
}

/// What a file may be called from a design's name.
pub fn file_stem(name: &str) -> String {
    prefix(name)
}

/// Whether a header of this name, without `.h`, would take the place of one of C's or POSIX's.
pub fn shadows(stem: &str) -> bool {
    HEADERS.contains(&stem)
}

/// Macros and constants of every header, without the controller's name.
const OWN: [&str; 7] = [
    "h", "inputs", "outputs", "terms", "rules", "full", "evaluate",
];
/// What is said of a variable.
const DERIVED: [&str; 4] = ["_fraction", "_least", "_most", "_default"];
/// Of `stdint.h`: a controller of such a name gets another.
const STANDARD: [&str; 13] = [
    "int",
    "uint",
    "intmax",
    "uintmax",
    "intptr",
    "uintptr",
    "size",
    "ptrdiff",
    "sig",
    "wchar",
    "wint",
    "int_least",
    "int_fast",
];

struct Names {
    /// The controller's, in front of all that the header names.
    prefix: String,
    all: Identifiers,
}

impl Names {
    fn of(design: &Design<'_>) -> Self {
        Self {
            prefix: prefix(design.name),
            all: Identifiers::new(design.lowered.tables(), Taken::of(&OWN), &DERIVED),
        }
    }

    /// A macro's or a constant's whole name.
    fn shout(&self, name: &str) -> String {
        format!("{}_{name}", self.prefix).to_ascii_uppercase()
    }
}

/// Headers of C and POSIX whose names one word can be: a header of the same name would take their place where it lies in an
/// include path. `stdint.h` is among those that ours needs itself.
const HEADERS: [&str; 43] = [
    "assert",
    "complex",
    "ctype",
    "dirent",
    "dlfcn",
    "errno",
    "fcntl",
    "fenv",
    "float",
    "grp",
    "inttypes",
    "iso646",
    "limits",
    "locale",
    "malloc",
    "math",
    "memory",
    "poll",
    "pthread",
    "pwd",
    "sched",
    "semaphore",
    "setjmp",
    "signal",
    "stdalign",
    "stdarg",
    "stdatomic",
    "stdbool",
    "stddef",
    "stdint",
    "stdio",
    "stdlib",
    "stdnoreturn",
    "string",
    "strings",
    "tgmath",
    "threads",
    "time",
    "uchar",
    "unistd",
    "utime",
    "wchar",
    "wctype",
];
fn prefix(name: &str) -> String {
    let name = identifier(name, "fuzzy", 0);
    if shadows(&name) {
        return format!("fuzzy_{name}");
    }
    // `INT32_MAX` is not ours, whatever a variable is called.
    let bare = name.trim_end_matches(|c: char| c.is_ascii_digit());
    if STANDARD.contains(&bare) {
        format!("fuzzy_{name}")
    } else {
        name
    }
}
