//! The tuned design's files.

use super::report::Report;
use crate::cli::fuzzy::DesignArguments;
use crate::cli::fuzzy::design::Design;
use crate::cli::put_all;
use crate::cli::run::json;
use anyhow::{Context, anyhow, bail};
use host_sim::fuzzy::check::bounds;
use host_sim::fuzzy::emit::{self, rust};
use host_sim::fuzzy::fast::Fast;
use host_sim::fuzzy::files::writing::WriteError;
use host_sim::fuzzy::files::{Format, adapt, fcl, fll, parse};
use host_sim::fuzzy::lower::lower;
use host_sim::fuzzy::model::{Defuzzifier, Output, Sampling, System};
use host_sim::fuzzy::picture;
use host_sim::plot::{membership_svg, pair};
use std::path::{Path, PathBuf};

/// The format that the result is written in, one that can say what the design computes.
#[derive(Clone, Copy)]
enum Language {
    Fll,
    Fcl,
}

/// Names the pictures.
const MEMBERSHIPS: &str = "memberships";

/// How the result is written.
pub struct Written {
    language: Language,
    /// Whether names that the language has not become the nearest that it has.
    adapt: bool,
    /// Whether the robot is to drive with it: then its module is of the fast route where the design is what that takes.
    drives: bool,
}

impl Written {
    /// For a design: its own format; of MATLAB's, which is not written, FCL where a centroid is sampled from end to end, for
    /// FLL cannot say that, and FLL otherwise, for FCL has no linear terms. No design has both.
    pub fn of(design: &DesignArguments, system: &System, adapt: bool, drives: bool) -> Self {
        let ends = |output: &Output| {
            let sampling = match output.defuzzifier {
                Defuzzifier::Centroid { sampling, .. } => Some(sampling),
                Defuzzifier::WeightedAverage => None,
            };
            sampling == Some(Sampling::Ends)
        };
        let from = design.from.map(super::super::From::format);
        let language = match from.or_else(|| Format::of(&design.file)) {
            Some(Format::Fcl) => Language::Fcl,
            Some(Format::Fis) if system.outputs.iter().any(ends) => Language::Fcl,
            _ => Language::Fll,
        };
        Self {
            language,
            adapt,
            drives,
        }
    }

    fn format(&self) -> Format {
        match self.language {
            Language::Fll => Format::Fll,
            Language::Fcl => Format::Fcl,
        }
    }

    fn design_file(&self) -> String {
        format!("tuned.{}", self.format().extension())
    }

    /// The files that [`Written::write`] makes: the design, the module, the report, and the pictures.
    pub fn files(&self) -> [String; 5] {
        [
            self.design_file(),
            "tuned.rs".to_owned(),
            "report.json".to_owned(),
            format!("{MEMBERSHIPS}.svg"),
            format!("{MEMBERSHIPS}.png"),
        ]
    }

    /// What begins a comment.
    fn comment(&self) -> &'static str {
        match self.language {
            Language::Fcl => "//",
            Language::Fll => "#",
        }
    }

    /// A design as it is written, which names are changed for that, and the text.
    pub fn text(&self, system: &System) -> Result<(System, Vec<String>, String), WriteError> {
        let mut system = system.clone();
        let changes = match (self.adapt, self.language) {
            (false, _) => Vec::new(),
            (true, Language::Fcl) => adapt::to_fcl(&mut system),
            (true, Language::Fll) => adapt::names_to_fll(&mut system),
        };
        let text = match self.language {
            Language::Fcl => fcl::write(&system),
            Language::Fll => fll::write(&system),
        }?;
        Ok((system, changes, text))
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
        let name = self.design_file();
        let (said, _, text) = self.text(tuned)?;
        let text = format!("{} {}: {how}\n{text}", self.comment(), design.title());
        let again = parse(&name, text.as_bytes(), self.format())?;
        let computed = |system: &System| system.clone().without_places().without_descriptions();
        if computed(&again) != computed(&said) {
            bail!("{name}: reads back as another design than was judged; nothing of it is written");
        }
        let lowered = lower(&said).with_context(|| format!("{name}: refused by the checks"))?;
        // As convert makes it of the design beside it.
        let module = |route, option| {
            let design = emit::Design {
                system: &said,
                lowered: &lowered,
                name: if said.name.is_empty() {
                    "tuned"
                } else {
                    &said.name
                },
                command: &format!("host-sim fuzzy convert {name} --to rust{option}"),
                bounds: Some(&bounds(&said, &lowered)),
            };
            rust::write(&design, route)
        };
        let fast = self.drives && Fast::new(&said, &lowered).is_ok();
        let module = match fast {
            true => module(rust::Route::Fast, " --route fast"),
            false => module(rust::Route::General, ""),
        };
        let module = module.map_err(|why| anyhow!("{name}: {why}"))?;
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
        let [(_, svg), (_, png)] = pair(MEMBERSHIPS, &svg)?;
        let files = self.files().map(|file| out.join(file));
        let contents = [
            text.as_bytes(),
            module.as_bytes(),
            &json(report)?,
            &svg,
            &png,
        ];
        let files: Vec<(&Path, &[u8])> = files.iter().map(PathBuf::as_path).zip(contents).collect();
        put_all(&files)
    }
}
