//! A world of one's own as a TOML file:
//!
//! ```toml
//! start = [0.0, 0.0, 90.0]      # x, y (m), heading (degrees)
//! goal = [0.0, 8.0]
//! goal-radius = 0.5             # 1 when left out
//! sealed = false                # true: there is no way, and a robot ought to say so
//! route = [[0.0, 0.0], [0.0, 8.0]]   # planned when left out
//! circle = [{ at = [0.3, 4.0], radius = 0.2 }]
//! wall = [{ from = [-1.0, 0.0], to = [-1.0, 8.0] }]
//! mover = [{ from = [1.5, 2.0], to = [1.5, 6.0], speed = 0.4, radius = 0.2 }]
//! ```

use super::check::SHORTEST;
use super::error::WorldError;
use super::{text, wall};
use crate::bench::arena::{Arena, Circle, Mover, length};
use serde::Deserialize;
use std::path::Path;
use toml::Spanned;

/// How far from start and goal a route may begin and end, m.
const NEAR: f64 = 1.0;

#[derive(Deserialize)]
#[serde(deny_unknown_fields, rename_all = "kebab-case")]
struct Raw {
    start: Spanned<[f64; 3]>,
    goal: Spanned<[f64; 2]>,
    #[serde(default = "one")]
    goal_radius: Spanned<f64>,
    #[serde(default)]
    sealed: bool,
    route: Option<Spanned<Vec<Spanned<[f64; 2]>>>>,
    #[serde(default)]
    circle: Vec<Spanned<RawCircle>>,
    #[serde(default)]
    wall: Vec<Spanned<RawWall>>,
    #[serde(default)]
    mover: Vec<Spanned<RawMover>>,
}

#[derive(Deserialize)]
#[serde(deny_unknown_fields)]
struct RawCircle {
    at: [f64; 2],
    radius: f64,
}

#[derive(Deserialize)]
#[serde(deny_unknown_fields)]
struct RawWall {
    from: [f64; 2],
    to: [f64; 2],
}

#[derive(Deserialize)]
#[serde(deny_unknown_fields)]
struct RawMover {
    from: [f64; 2],
    to: [f64; 2],
    speed: f64,
    radius: f64,
}

fn one() -> Spanned<f64> {
    Spanned::new(0..0, 1.0)
}

/// Reads a world; its number is 0. Without a route in the file its route is left empty.
pub fn read(file: &Path) -> Result<Arena, WorldError> {
    let text = text::read(file, "a world as TOML")?;
    let source = Source {
        file: file.display().to_string(),
        text: &text,
    };
    let raw: Raw = toml::from_str(&text).map_err(|e| {
        source.wrong(
            e.span().map_or(0, |s| s.start),
            e.message().trim(),
            "a world: start, goal, goal-radius, sealed, route, circle, wall, mover",
        )
    })?;
    raw.arena(&source)
}

struct Source<'a> {
    file: String,
    text: &'a str,
}

impl Source<'_> {
    fn wrong(&self, at: usize, found: &str, allowed: &str) -> WorldError {
        let before = self.text.get(..at).unwrap_or(self.text);
        let line = before.matches('\n').count() + 1;
        WorldError::wrong(format!("{}:{line}", self.file), found, allowed)
    }

    /// Finds the first number that is not allowed.
    fn numbers(&self, at: usize, numbers: &[f64]) -> Result<(), WorldError> {
        match numbers.iter().find(|x| !x.is_finite() || x.abs() > 1000.0) {
            Some(x) => Err(self.wrong(at, &x.to_string(), "numbers from -1000 to 1000")),
            None => Ok(()),
        }
    }

    fn positive(&self, at: usize, what: &str, x: f64, most: f64) -> Result<(), WorldError> {
        if x > 0.0 && x <= most {
            Ok(())
        } else {
            let allowed = format!("{what} above 0 and up to {most}");
            Err(self.wrong(at, &x.to_string(), &allowed))
        }
    }

    /// The points of a route that leads from one end to the other.
    fn route(
        &self,
        route: &Spanned<Vec<Spanned<[f64; 2]>>>,
        [start, goal]: [[f64; 2]; 2],
    ) -> Result<Vec<[f64; 2]>, WorldError> {
        for point in route.get_ref() {
            self.numbers(point.span().start, point.get_ref())?;
        }
        let points: Vec<[f64; 2]> = route.get_ref().iter().map(|p| *p.get_ref()).collect();
        let found = match points[..] {
            [] => "a route without points".to_owned(),
            [_] => "a route of one point".to_owned(),
            _ if length(&points) < SHORTEST => "a route whose points are one place".to_owned(),
            [first, .., last] => {
                let off = |from, to| Some(length(&[from, to])).filter(|off| *off > NEAR);
                if let Some(off) = off(start, first) {
                    format!("a route that begins {off:.2} m from the start")
                } else if let Some(off) = off(last, goal) {
                    format!("a route that ends {off:.2} m from the goal")
                } else {
                    return Ok(points);
                }
            }
        };
        let allowed = format!(
            "two points or more, from within {NEAR} m of the start to within {NEAR} m of the goal, or no `route`: then it is planned"
        );
        Err(self.wrong(route.span().start, &found, &allowed))
    }
}

impl Raw {
    fn arena(self, source: &Source<'_>) -> Result<Arena, WorldError> {
        source.numbers(self.start.span().start, self.start.get_ref())?;
        source.numbers(self.goal.span().start, self.goal.get_ref())?;
        source.positive(
            self.goal_radius.span().start,
            "a goal-radius",
            *self.goal_radius.get_ref(),
            100.0,
        )?;
        let mut circles = Vec::new();
        for item in &self.circle {
            let (at, c) = (item.span().start, item.get_ref());
            source.numbers(at, &c.at)?;
            source.positive(at, "a radius", c.radius, 100.0)?;
            circles.push(Circle {
                at: c.at,
                radius: c.radius,
            });
        }
        for item in &self.wall {
            let w = item.get_ref();
            source.numbers(item.span().start, &[w.from, w.to].concat())?;
            circles.extend(wall::wall(w.from, w.to));
        }
        let mut movers = Vec::new();
        for item in &self.mover {
            let (at, m) = (item.span().start, item.get_ref());
            source.numbers(at, &[m.from, m.to].concat())?;
            source.positive(at, "a radius", m.radius, 100.0)?;
            source.positive(at, "a speed", m.speed, 10.0)?;
            movers.push(Mover {
                from: m.from,
                to: m.to,
                speed: m.speed,
                radius: m.radius,
            });
        }
        let [x, y, degrees] = self.start.into_inner();
        let route = match &self.route {
            None => Vec::new(),
            Some(route) => source.route(route, [[x, y], *self.goal.get_ref()])?,
        };
        Ok(Arena {
            number: 0,
            circles,
            unmapped: 0,
            movers,
            start: [x, y, degrees.to_radians()],
            goal: self.goal.into_inner(),
            goal_radius: self.goal_radius.into_inner(),
            sealed: self.sealed,
            route,
            course: None,
        })
    }
}
