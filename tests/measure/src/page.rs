//! A measured table or figure in a page for people: written there by a command, and compared ever after.

use crate::repository;
use anyhow::{Context, ensure};
use std::process::Command;

/// Where a table stands: in `file`, between the lines `begin` and `end`. A figure stands between them in a line.
#[derive(Clone, Copy, Debug)]
pub struct Page {
    /// From the repository's root.
    pub file: &'static str,
    /// A line, with its end; before a figure, a part of one.
    pub begin: &'static str,
    /// The same.
    pub end: &'static str,
    /// The command that writes it.
    pub renew: &'static str,
}

impl Page {
    /// Compares the table in the page, or puts it there. Another compiler's table is let stand: it names its compiler in
    /// its last line, and the budgets hold for any.
    pub fn hold(&self, table: &str, write: bool) -> anyhow::Result<()> {
        let file = self.file;
        let [before, present, after] = self.parts()?;
        let present = present.trim();
        let table = table.trim();
        if write {
            return self.put(&before, &format!("\n{table}\n\n"), &after);
        }
        let (here, there) = (table.lines().last(), present.lines().last());
        if here != there {
            println!("{file}: the table is another compiler's and is not compared");
            return Ok(());
        }
        ensure!(
            present == table,
            "{file}: the table is not what was measured: {}",
            self.renew
        );
        Ok(())
    }

    /// Compares a figure that no compiler changes, or puts it there.
    pub fn hold_figure(&self, figure: &str, write: bool) -> anyhow::Result<()> {
        let [before, present, after] = self.parts()?;
        if write {
            return self.put(&before, figure, &after);
        }
        ensure!(
            present == figure,
            "{}: it says {present}; measured was {figure}: {}",
            self.file,
            self.renew
        );
        Ok(())
    }

    /// The page up to where it begins, what is there, and the rest.
    fn parts(&self) -> anyhow::Result<[String; 3]> {
        let Self {
            file, begin, end, ..
        } = self;
        let text = std::fs::read_to_string(repository(file))
            .with_context(|| format!("{file}: cannot be read"))?;
        let (before, rest) = text
            .split_once(begin)
            .with_context(|| format!("{file}: there is no {begin}"))?;
        let (present, after) = rest
            .split_once(end)
            .with_context(|| format!("{file}: there is no {end}"))?;
        Ok([before, present, after].map(str::to_owned))
    }

    fn put(&self, before: &str, what: &str, after: &str) -> anyhow::Result<()> {
        let Self {
            file, begin, end, ..
        } = self;
        let new = format!("{before}{begin}{what}{end}{after}");
        std::fs::write(repository(file), new).with_context(|| format!("{file}: cannot be written"))
    }
}

/// Thousands apart.
pub fn grouped(number: u32) -> String {
    let digits = number.to_string();
    let mut text = String::new();
    for (i, digit) in digits.chars().enumerate() {
        if i > 0 && (digits.len() - i).is_multiple_of(3) {
            text.push(',');
        }
        text.push(digit);
    }
    text
}

/// Another compiler counts a little otherwise.
pub fn compiler() -> anyhow::Result<String> {
    let output = Command::new("rustc").arg("--version").output()?;
    let text = String::from_utf8(output.stdout)?;
    let version = text.split_whitespace().nth(1).context("rustc --version")?;
    Ok(format!("rustc {version}"))
}
