//! The navigators by name.

use super::baselines::pure_pursuit::PurePursuit;
use super::navigator::{Mission, Navigator};
use super::ours::Ours;

/// Makes a navigator for a run.
pub type Build = fn(&Mission) -> Box<dyn Navigator>;

/// A navigator that can be asked for.
#[derive(Clone, Copy, Debug)]
pub struct Controller {
    /// What it is asked for by.
    pub name: &'static str,
    /// What it is.
    pub about: &'static str,
    /// Makes one.
    pub build: Build,
}

/// All of them.
pub const CONTROLLERS: &[Controller] = &[
    Controller {
        name: "ours",
        about: "the library's navigator",
        build: |mission| Box::new(Ours::new(mission)),
    },
    Controller {
        name: "pure-pursuit",
        about: "pure pursuit (Coulter 1992), blind",
        build: |mission| Box::new(PurePursuit::new(mission)),
    },
];

/// By names between commas; `all` is every one.
pub fn named(list: &str) -> Result<Vec<Controller>, String> {
    if list == "all" {
        return Ok(CONTROLLERS.to_vec());
    }
    let mut chosen: Vec<Controller> = Vec::new();
    for name in list.split(',') {
        let Some(found) = CONTROLLERS.iter().find(|c| c.name == name) else {
            let known: Vec<&str> = CONTROLLERS.iter().map(|c| c.name).collect();
            return Err(format!(
                "unknown controller `{name}`; allowed: all, {}",
                known.join(", ")
            ));
        };
        if chosen.iter().all(|c| c.name != name) {
            chosen.push(*found);
        }
    }
    Ok(chosen)
}
