//! The navigators by name.

use super::baselines::bendy::{self, Bendy};
use super::baselines::dwa::{self, Dwa};
use super::baselines::pure_pursuit::PurePursuit;
use super::baselines::regulated::{self, Regulated};
use super::baselines::vfh::{self, Vfh};
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
    Controller {
        name: "rpp",
        about: "regulated pure pursuit (Macenski et al. 2023)",
        build: |mission| Box::new(Regulated::new(mission, regulated::Parameters::default())),
    },
    Controller {
        name: "vfh",
        about: "VFH+ (Ulrich, Borenstein 1998)",
        build: |mission| Box::new(Vfh::new(mission, vfh::Parameters::default())),
    },
    Controller {
        name: "dwa",
        about: "dynamic window approach (Fox, Burgard, Thrun 1997)",
        build: |mission| Box::new(Dwa::new(mission, dwa::Parameters::default())),
    },
    Controller {
        name: "bendy",
        about: "BendyRuler (ArduPilot)",
        build: |mission| Box::new(Bendy::new(mission, bendy::Parameters::default())),
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
