//! The tuned design's files.

use super::report::Report;
use crate::cli::fuzzy::DesignArguments;
use crate::cli::fuzzy::design::Design;
use crate::cli::put_all;
use crate::cli::run::json;
use anyhow::{Context, anyhow, bail};
use host_sim::fuzzy::check::bounds;
use host_sim::fuzzy::emit::{self, rust};
use host_sim::fuzzy::files::writing::WriteError;
use host_sim::fuzzy::files::{Format, fcl, fll, parse};
use host_sim::fuzzy::lower::lower;
use host_sim::fuzzy::model::System;
use host_sim::fuzzy::picture;
use host_sim::plot::{membership_svg, write_pair};
use std::path::Path;

/// The format that the result is written in: the design's own, FuzzyLite's where that cannot be written.
pub struct Written(Format);

impl Written {
    /// For a design.
    pub fn of(design: &DesignArguments) -> Self {
        let from = design.from.map(super::super::From::format);
        match from.or_else(|| Format::of(&design.file)) {
            Some(Format::Fcl) => Self(Format::Fcl),
            _ => Self(Format::Fll),
        }
    }

    /// What begins a comment.
    fn comment(&self) -> &'static str {
        match self.0 {
            Format::Fcl => "//",
            Format::Fll | Format::Fis => "#",
        }
    }

    /// A design as text.
    pub fn text(&self, system: &System) -> Result<String, WriteError> {
        match self.0 {
            Format::Fcl => fcl::write(system),
            Format::Fll | Format::Fis => fll::write(system),
        }
    }

    /// Writes everything, after a last look at the result: it reads back as what was judged, and every check accepts it.
    /// `how` is the command that found it, for the design's head.
    pub fn write(
        &self,
        out: &Path,
        design: &Design,
        tuned: &System,
        report: &Report,
        how: &str,
    ) -> anyhow::Result<()> {
        let name = format!("tuned.{}", self.0.extension());
        let text = format!(
            "{} {}: {how}\n{}",
            self.comment(),
            design.title(),
            self.text(tuned)?
        );
        let again = parse(&name, text.as_bytes(), self.0)?;
        if again.without_places() != tuned.clone().without_places() {
            bail!("{name}: reads back as another design than was judged; nothing of it is written");
        }
        let lowered = lower(tuned).with_context(|| format!("{name}: refused by the checks"))?;
        // As convert makes it of the design beside it.
        let module = rust::write(
            &emit::Design {
                system: tuned,
                lowered: &lowered,
                name: if tuned.name.is_empty() {
                    "tuned"
                } else {
                    &tuned.name
                },
                command: &format!("host-sim fuzzy convert {name} --to rust"),
                bounds: Some(&bounds(tuned, &lowered)),
            },
            rust::Route::Auto,
        )
        .map_err(|why| anyhow!("{name}: {why}"))?;
        let mut variables = picture::variables(&design.system);
        let mut after = picture::variables(tuned);
        for variable in &mut variables {
            variable.axis.name += ", before";
        }
        for variable in &mut after {
            variable.axis.name += ", after";
        }
        let pairs = variables.into_iter().zip(after);
        let shown: Vec<_> = pairs.flat_map(|(before, after)| [before, after]).collect();
        let svg = membership_svg(&format!("{}, tuned", design.title()), &shown)?;
        std::fs::create_dir_all(out)
            .with_context(|| format!("{}: cannot be created", out.display()))?;
        put_all(&[
            (&out.join(name), text.as_bytes()),
            (&out.join("tuned.rs"), module.as_bytes()),
            (&out.join("report.json"), &json(report)?),
        ])?;
        write_pair(out, "memberships", &svg)
    }
}
