//! The world as it truly is, in `f64`: discs, and what a beam or the robot's rim meets.

use crate::recording::Disc;

/// Circular obstacles on an empty plane.
#[derive(Clone, Debug, Default, PartialEq)]
pub struct World {
    /// The obstacles.
    pub discs: Vec<Disc>,
}

impl World {
    /// Distance along a ray from (x, y) in direction `heading` to the first surface, if within `reach`. A ray that
    /// starts inside a disc meets it at 0.
    pub fn cast(&self, [x, y]: [f64; 2], heading: f64, reach: f64) -> Option<f64> {
        let (sin, cos) = libm::sincos(heading);
        let mut nearest = f64::INFINITY;
        for disc in &self.discs {
            let (dx, dy) = (disc.x - x, disc.y - y);
            let (along, across) = (dx * cos + dy * sin, dy * cos - dx * sin);
            let half = disc.radius * disc.radius - across * across;
            if half < 0.0 {
                continue;
            }
            let half = half.sqrt();
            if along + half >= 0.0 {
                nearest = nearest.min((along - half).max(0.0));
            }
        }
        (nearest <= reach).then_some(nearest)
    }

    /// Like [`World::cast`] for a cone of full angle `width`: its nearest echo anywhere inside, as an ultrasonic
    /// sensor hears it.
    pub fn cast_cone(&self, at: [f64; 2], heading: f64, width: f64, reach: f64) -> Option<f64> {
        if width <= 0.0 {
            return self.cast(at, heading, reach);
        }
        let mut nearest = f64::INFINITY;
        for disc in &self.discs {
            let (dx, dy) = (disc.x - at[0], disc.y - at[1]);
            let off = wrap(libm::atan2(dy, dx) - heading);
            if off.abs() <= width / 2.0 {
                nearest = nearest.min((libm::hypot(dx, dy) - disc.radius).max(0.0));
            }
        }
        for edge in [heading - width / 2.0, heading + width / 2.0] {
            nearest = nearest.min(self.cast(at, edge, reach).unwrap_or(f64::INFINITY));
        }
        (nearest <= reach).then_some(nearest)
    }

    /// Distance from the rim of a robot of `radius` at (x, y) to the nearest surface, and which disc; negative means
    /// contact, infinite an empty world.
    pub fn clearance(&self, [x, y]: [f64; 2], radius: f64) -> (f64, Option<usize>) {
        self.discs
            .iter()
            .enumerate()
            .map(|(i, d)| ((d.x - x).hypot(d.y - y) - d.radius - radius, Some(i)))
            .fold((f64::INFINITY, None), |best, new| {
                if new.0 < best.0 { new } else { best }
            })
    }

    /// The disc whose centre is nearest to (x, y).
    pub fn nearest_centre(&self, [x, y]: [f64; 2]) -> Option<&Disc> {
        self.discs.iter().min_by(|a, b| {
            (a.x - x)
                .hypot(a.y - y)
                .total_cmp(&(b.x - x).hypot(b.y - y))
        })
    }
}

/// An angle in (−π, π].
pub fn wrap(angle: f64) -> f64 {
    let turned = angle.rem_euclid(std::f64::consts::TAU);
    if turned > std::f64::consts::PI {
        turned - std::f64::consts::TAU
    } else {
        turned
    }
}
