//! A design as the commands have it: read, and in fixed point if it has such a form.

use super::convert::{Route, unfit};
use super::{DesignArguments, From};
use crate::cli::BadInput;
use host_sim::fuzzy::fast::Fast;
use host_sim::fuzzy::files::load;
use host_sim::fuzzy::lower::{Fixed, LowerError, Lowered, lower};
use host_sim::fuzzy::model::System;

/// A design.
pub struct Design {
    /// What it says.
    pub system: System,
    /// Its file's name without folder and extension.
    pub stem: String,
    /// Its fixed point, or why it has none.
    pub fixed: Result<Lowered, LowerError>,
}

impl Design {
    /// Reads a design file.
    pub fn load(arguments: &DesignArguments) -> anyhow::Result<Self> {
        let system = load(&arguments.file, arguments.from.map(From::format))?;
        let stem = arguments.file.file_stem().unwrap_or_default();
        Ok(Self {
            fixed: lower(&system),
            stem: stem.to_string_lossy().into_owned(),
            system,
        })
    }

    /// Lends its fixed point, opened, or nothing if it has none.
    pub fn opened<R>(&self, use_it: impl FnOnce(Option<Fixed<'_>>) -> R) -> R {
        match &self.fixed {
            Ok(lowered) => lowered.open(|fixed| use_it(Some(fixed))),
            Err(_) => use_it(None),
        }
    }

    /// What a module of the fast route computes; `None` if the route is another.
    pub fn fast(&self, file: &DesignArguments, route: Route) -> anyhow::Result<Option<Fast>> {
        if route == Route::General {
            return Ok(None);
        }
        let file = file.file.display();
        let fast = match &self.fixed {
            Ok(lowered) => Fast::new(&self.system, lowered).map_err(|why| unfit(&file, &why)),
            Err(why) => Err(format!("{file}: {why}")),
        };
        match fast {
            Ok(fast) => Ok(Some(fast)),
            Err(why) if route == Route::Fast => Err(BadInput(why).into()),
            Err(_) => Ok(None),
        }
    }

    /// What can be told apart of an output: a step of its fixed point; without one, a millionth of its range.
    pub fn resolution(&self, output: usize) -> f64 {
        let fixed = self.fixed.as_ref().ok();
        match fixed.and_then(|fixed| fixed.tables().outputs.get(output)) {
            Some(output) => output.format.value(1),
            None => self.system.outputs.get(output).map_or(0.0, |output| {
                1e-6 * (output.range.end() - output.range.start())
            }),
        }
    }

    /// The system's own name, or its file's.
    pub fn title(&self) -> String {
        if self.system.name.is_empty() {
            self.stem.clone()
        } else {
            self.system.name.clone()
        }
    }

    /// What to print where fixed point is missing; empty where it is not.
    pub fn note(&self) -> String {
        match &self.fixed {
            Ok(_) => String::new(),
            Err(why) => format!("no fixed point: {why}\n"),
        }
    }
}
