//! Sensor sets by name, all at the robot's centre.

use crate::recording::BeamView;

/// Names that are always known, with what they are.
pub const NAMED: [(&str, &str); 4] = [
    ("cone16", "16 cones side by side over 270°, 4 m"),
    ("cone8", "8 cones side by side over 270°, 4 m"),
    ("ultrasonic5", "5 cones of 30°, 45° apart, 4 m"),
    ("lidar720", "720 beams over 270°, 4 m"),
];

/// Reach of all of them, m.
const REACH: f64 = 4.0;

/// Most sensors that `cones:…` may ask for.
const MOST_CONES: usize = 64;

/// Widest cone that the library's navigator takes, degrees.
const WIDEST: f64 = 90.0;

/// Sensors by name, or `cones:COUNT:FIELD:WIDTH` with degrees: COUNT cones whose axes divide FIELD evenly.
pub fn named(name: &str) -> Result<Vec<BeamView>, String> {
    match name {
        "cone16" => return Ok(side_by_side(16, 270.0)),
        "cone8" => return Ok(side_by_side(8, 270.0)),
        "ultrasonic5" => return Ok(fan(5, 225.0, 30.0)),
        "lidar720" => return Ok(fan(720, 270.0, 0.0)),
        _ => {}
    }
    let refused = || {
        let known: Vec<&str> = NAMED.iter().map(|(name, _)| *name).collect();
        format!(
            "unknown sensors `{name}`; allowed: {}, or cones:COUNT:FIELD:WIDTH (3 to {MOST_CONES} cones, a field up to 360°, each 0 to {WIDEST}° wide)",
            known.join(", ")
        )
    };
    let numbers = name.strip_prefix("cones:").ok_or_else(refused)?;
    let [count, field, width] = numbers.split(':').collect::<Vec<_>>()[..] else {
        return Err(refused());
    };
    let count: usize = count.parse().map_err(|_| refused())?;
    let field: f64 = field.parse().map_err(|_| refused())?;
    let width: f64 = width.parse().map_err(|_| refused())?;
    let fits = (3..=MOST_CONES).contains(&count)
        && field > 0.0
        && field <= 360.0
        && (0.0..=WIDEST).contains(&width);
    if fits {
        Ok(fan(count, field, width))
    } else {
        Err(refused())
    }
}

fn side_by_side(count: usize, field: f64) -> Vec<BeamView> {
    fan(count, field, field / count as f64)
}

/// Axes at the middles of equal parts of the field, from right to left; degrees.
fn fan(count: usize, field: f64, width: f64) -> Vec<BeamView> {
    let pitch = field / count as f64;
    (0..count)
        .map(|k| BeamView {
            x: 0.0,
            y: 0.0,
            heading: ((k as f64 + 0.5) * pitch - field / 2.0).to_radians(),
            width: width.to_radians(),
            max_range: REACH,
        })
        .collect()
}
