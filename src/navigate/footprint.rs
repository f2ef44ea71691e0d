//! The robot's outline seen from above, and how far a point of the body's frame is from it.
//!
//! Clearance is the Euclidean distance to the outline, below zero inside it: what stands beside a flank and what stands
//! before a corner are told apart, which a disc cannot.

use super::steps::{Bearing, Steps, Vector, root};
use crate::geometry::Point;
use crate::params::ParamError;
use crate::units::Metres;
use heapless::Vec;

/// The most vertices of a polygon.
pub const MAX_VERTICES: usize = 8;

/// The robot's outline, body frame: the origin is the middle of the axle.
#[derive(Clone, Debug, PartialEq, Eq)]
pub enum Footprint {
    /// A rectangle along the robot's axes.
    Rectangle {
        /// From the axle to the front.
        front: Metres,
        /// From the axle to the rear; positive.
        rear: Metres,
        /// Half the width.
        half_width: Metres,
    },
    /// A convex polygon around the origin, counter-clockwise.
    Polygon(Vec<Point, MAX_VERTICES>),
    /// A disc about the origin.
    Disc {
        /// Its radius.
        radius: Metres,
    },
}

/// A footprint made ready for a tick's many questions.
#[derive(Clone, Debug)]
pub struct Outline {
    shape: Shape,
    /// Farthest point ahead.
    pub(super) front: Steps,
    /// Farthest point behind; positive.
    pub(super) rear: Steps,
    /// Farthest point to a side.
    pub(super) half_width: Steps,
    /// Farthest point of all: the disc that it turns in.
    pub(super) reach: Steps,
}

#[derive(Clone, Debug)]
enum Shape {
    Rectangle(Rectangle),
    Polygon(Vec<Edge, MAX_VERTICES>),
    Disc { radius: Steps },
}

/// A rectangle along the body's axes.
#[derive(Clone, Copy, Debug)]
pub(super) struct Rectangle {
    /// Of its middle, forward of the axle's.
    middle: Steps,
    half_length: Steps,
    half_width: Steps,
}

impl Rectangle {
    #[inline(always)]
    fn clearance_by(self, point: Vector, norm: impl Fn(Vector) -> Steps) -> Steps {
        let ahead = (point.x - self.middle).abs() - self.half_length;
        let beside = point.y.abs() - self.half_width;
        if ahead <= Steps::ZERO || beside <= Steps::ZERO {
            ahead.max(beside)
        } else {
            norm(Vector::new(ahead, beside))
        }
    }

    /// As [`Outline::clearance_at_least`].
    #[inline(always)]
    pub fn clearance_at_least(self, point: Vector) -> Steps {
        self.clearance_by(point, Vector::norm_at_least)
    }
}

/// An edge of the polygon.
#[derive(Clone, Copy, Debug)]
struct Edge {
    from: Vector,
    along: Bearing,
    length: Steps,
}

impl Footprint {
    /// Whether the robot can be driven with it.
    ///
    /// # Errors
    ///
    /// A length that is not positive or above 2 m, fewer than three vertices, a polygon that is not convex and
    /// counter-clockwise around the origin.
    pub fn check(&self) -> Result<(), ParamError> {
        let sound = |length: &Metres| {
            (const { Metres::lit("0.01") }..=const { Metres::lit("2") }).contains(length)
        };
        let (ok, field, allowed) = match self {
            Self::Rectangle {
                front,
                rear,
                half_width,
            } => (
                [front, rear, half_width].into_iter().all(sound),
                "footprint",
                "front, rear and half width from 0.01 to 2 m",
            ),
            Self::Disc { radius } => (sound(radius), "footprint.radius", "0.01 to 2 m"),
            Self::Polygon(vertices) => (
                is_convex(vertices),
                "footprint.polygon",
                "3 to 8 vertices within 2 m, convex, counter-clockwise around the axle's middle",
            ),
        };
        if ok {
            Ok(())
        } else {
            Err(ParamError { field, allowed })
        }
    }

    /// Made ready; the footprint is [checked](Self::check).
    pub fn outline(&self) -> Outline {
        match self {
            Self::Rectangle {
                front,
                rear,
                half_width,
            } => {
                let [front, rear, half_width] = [*front, *rear, *half_width].map(Steps::of);
                let corner = Vector::new(front.max(rear), half_width);
                let half_length = (front + rear).half();
                Outline {
                    shape: Shape::Rectangle(Rectangle {
                        middle: front - half_length,
                        half_length,
                        half_width,
                    }),
                    front,
                    rear,
                    half_width,
                    reach: corner.norm() + Steps::from_bits(1),
                }
            }
            Self::Disc { radius } => {
                let radius = Steps::of(*radius);
                Outline {
                    shape: Shape::Disc { radius },
                    front: radius,
                    rear: radius,
                    half_width: radius,
                    reach: radius,
                }
            }
            Self::Polygon(vertices) => polygon(vertices),
        }
    }
}

fn polygon(vertices: &[Point]) -> Outline {
    let mut edges = Vec::new();
    let mut outline = Outline {
        shape: Shape::Disc {
            radius: Steps::ZERO,
        },
        front: Steps::ZERO,
        rear: Steps::ZERO,
        half_width: Steps::ZERO,
        reach: Steps::ZERO,
    };
    let mut last = vertices.last().copied().unwrap_or_default();
    for vertex in vertices {
        let (from, to) = (Vector::of(last), Vector::of(*vertex));
        let side = to - from;
        // There is room: no more edges than vertices.
        let _ = edges.push(Edge {
            from,
            along: Bearing::of(side.direction()),
            length: side.norm(),
        });
        outline.front = outline.front.max(to.x);
        outline.rear = outline.rear.max(-to.x);
        outline.half_width = outline.half_width.max(to.y.abs());
        outline.reach = outline.reach.max(to.norm() + Steps::from_bits(1));
        last = *vertex;
    }
    outline.shape = Shape::Polygon(edges);
    outline
}

fn is_convex(vertices: &[Point]) -> bool {
    let far = |v: &Point| {
        v.x.abs() > const { Metres::lit("2") } || v.y.abs() > const { Metres::lit("2") }
    };
    if vertices.len() < 3 || vertices.iter().any(far) {
        return false;
    }
    let mut turned = 0u64;
    let ring = || vertices.iter().cycle().copied();
    for ((a, b), c) in ring()
        .zip(ring().skip(1))
        .zip(ring().skip(2))
        .take(vertices.len())
    {
        let (side, next) = (b - a, c - b);
        let turn = next.direction() - side.direction();
        // The origin lies to the left of every edge.
        let within = (Point::default() - a).direction() - side.direction();
        if side == Point::default() || !turn.is_left() || !within.is_left() {
            return false;
        }
        turned = turned.wrapping_add(turn.bits().unsigned_abs().into());
    }
    // Once round, not twice.
    turned < (3 << 31)
}

impl Outline {
    /// Distance of a point to the outline, exact to a step or two; inside below zero, there as far as to the nearest
    /// edge.
    pub fn clearance(&self, point: Vector) -> Steps {
        self.clearance_by(point, Vector::norm)
    }

    /// No more than the clearance, and where that is positive at least 0.991 of it: a rectangle's without a root. What a tick
    /// asks for, of many points.
    pub(super) fn clearance_at_least(&self, point: Vector) -> Steps {
        self.clearance_by(point, Vector::norm_at_least)
    }

    /// The rectangle, if it is one: who asks for many points in a row asks that.
    pub(super) fn rectangle(&self) -> Option<Rectangle> {
        match self.shape {
            Shape::Rectangle(rectangle) => Some(rectangle),
            _ => None,
        }
    }

    #[inline(always)]
    fn clearance_by(&self, point: Vector, norm: impl Fn(Vector) -> Steps) -> Steps {
        match &self.shape {
            Shape::Rectangle(rectangle) => rectangle.clearance_by(point, norm),
            // A bound would be a part of the radius short.
            Shape::Disc { radius } => point.norm() - *radius,
            Shape::Polygon(edges) => clearance_to(edges, point),
        }
    }

    /// Whether a point lies inside the outline and deeper than this, which is 0 or more.
    pub(super) fn covers(&self, point: Vector, deeper: Steps) -> bool {
        match &self.shape {
            Shape::Rectangle(rectangle) => {
                (point.x - rectangle.middle).abs() < rectangle.half_length - deeper
                    && point.y.abs() < rectangle.half_width - deeper
            }
            Shape::Disc { radius } => {
                let inner = *radius - deeper;
                inner > Steps::ZERO && point.norm_squared() < inner.squared()
            }
            Shape::Polygon(edges) => is_inside(edges, point, deeper),
        }
    }
}

/// Whether a point lies deeper inside all edges.
fn is_inside(edges: &[Edge], point: Vector, deeper: Steps) -> bool {
    edges
        .iter()
        .all(|edge| (point - edge.from).in_frame(edge.along).y > deeper)
}

fn clearance_to(edges: &[Edge], point: Vector) -> Steps {
    let mut inside = -Steps::MAX;
    let mut nearest = u32::MAX;
    for edge in edges {
        let place = (point - edge.from).in_frame(edge.along);
        // Counter-clockwise: outside is to the right.
        let out = -place.y;
        inside = inside.max(out);
        if out > Steps::ZERO {
            let beyond = (place.x - edge.length).max(-place.x).max(Steps::ZERO);
            nearest = nearest.min(Vector::new(beyond, out).norm_squared());
        }
    }
    if inside > Steps::ZERO {
        root(nearest)
    } else {
        inside
    }
}

#[cfg(test)]
mod tests {
    use super::{Footprint, Steps, Vector};
    use crate::geometry::Point;
    use crate::units::Metres;

    #[test]
    fn what_is_covered_is_deeper_than_its_clearance() {
        let m = |text| Metres::lit(text);
        let triangle = [("0.4", "0"), ("-0.2", "0.3"), ("-0.2", "-0.3")];
        let shapes = [
            Footprint::Rectangle {
                front: m("0.3"),
                rear: m("0.2"),
                half_width: m("0.215"),
            },
            Footprint::Disc { radius: m("0.25") },
            Footprint::Polygon(
                triangle
                    .iter()
                    .map(|(x, y)| Point::new(m(x), m(y)))
                    .collect(),
            ),
        ];
        for outline in shapes.map(|shape| shape.outline()) {
            for deep in [0, 123] {
                for x in (-2000..2000).step_by(37) {
                    for y in (-2000..2000).step_by(41) {
                        let place = Vector::new(Steps::from_bits(x), Steps::from_bits(y));
                        let deep = Steps::from_bits(deep);
                        let exact = outline.clearance(place) < -deep;
                        assert_eq!(outline.covers(place, deep), exact, "{x}, {y}, {deep:?}");
                        let [least, whole] =
                            [outline.clearance_at_least(place), outline.clearance(place)];
                        assert!(least <= whole + Steps::from_bits(1), "{x}, {y}: {least:?}");
                        assert!(
                            least.bits() >= whole.bits().min(whole.bits() * 991 / 1000) - 2,
                            "{x}, {y}"
                        );
                    }
                }
            }
        }
    }
}
