//! The robot's footprint about its centre of rotation: a rectangle, a convex polygon or a disc.

use crate::si;
use fuzzypilot::geometry::Point;
use fuzzypilot::navigate::{Footprint, MAX_VERTICES};

/// A footprint in the body's frame: x forward, y left, the origin is the centre of rotation.
#[derive(Clone, Debug, PartialEq)]
pub enum Body {
    /// A rectangle, its centre at the origin.
    Rectangle(Rectangle),
    /// A convex polygon around the origin.
    Polygon(Polygon),
    /// A disc about the origin with this radius, m.
    Disc(f64),
}

/// A rectangle, its centre at the centre of rotation.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Rectangle {
    /// Half the length, along x, m.
    pub half_length: f64,
    /// Half the width, along y, m.
    pub half_width: f64,
}

/// A convex polygon around the centre of rotation.
#[derive(Clone, Debug, PartialEq)]
pub struct Polygon {
    edges: Vec<Edge>,
}

/// From a vertex to the next, counter-clockwise.
#[derive(Clone, Copy, Debug, PartialEq)]
struct Edge {
    from: [f64; 2],
    /// Unit vector along it.
    along: [f64; 2],
    length: f64,
}

/// The Jackal's footprint in the benchmark: 0.508 × 0.430 m.
pub const JACKAL: Body = Body::Rectangle(Rectangle {
    half_length: 0.254,
    half_width: 0.215,
});

/// What [`Body::parse`] takes, for messages.
pub const BODIES: &str = "jackal, rectangle:LENGTHxWIDTH, disc:RADIUS, or polygon:X,Y:X,Y:… with 3 to 8 vertices, convex, \
     counter-clockwise around the centre of rotation; metres, up to 2 from there";

/// Corners that stand for a disc in pictures.
const ROUND: usize = 32;

impl Body {
    /// Reads `rectangle:0.508x0.430`, `disc:0.2`, `polygon:0.3,0.2:-0.2,0.2:-0.2,-0.2:0.3,-0.2`, or a preset's name.
    pub fn parse(text: &str) -> Result<Self, String> {
        let refused = || format!("allowed: {BODIES}");
        if text == "jackal" {
            return Ok(JACKAL);
        }
        let number = |text: &str| {
            let number = text.trim().parse::<f64>().ok();
            number.filter(|x| x.is_finite()).ok_or_else(refused)
        };
        let (kind, rest) = text.split_once(':').ok_or_else(refused)?;
        let body = match kind {
            "rectangle" => {
                let (length, width) = rest.split_once('x').ok_or_else(refused)?;
                Self::Rectangle(Rectangle {
                    half_length: number(length)? / 2.0,
                    half_width: number(width)? / 2.0,
                })
            }
            "disc" => Self::Disc(number(rest)?),
            "polygon" => {
                let vertices = rest.split(':').map(|vertex| {
                    let (x, y) = vertex.split_once(',').ok_or_else(refused)?;
                    Ok([number(x)?, number(y)?])
                });
                Self::Polygon(Polygon::new(&vertices.collect::<Result<Vec<_>, String>>()?))
            }
            _ => return Err(refused()),
        };
        // What the library drives with is what there is.
        match body.footprint() {
            Some(footprint) if footprint.check().is_ok() => Ok(body),
            _ => Err(refused()),
        }
    }

    /// The same as the library has it; none with more vertices than it takes.
    pub fn footprint(&self) -> Option<Footprint> {
        let point = |[x, y]: [f64; 2]| Point::new(si::metres(x), si::metres(y));
        Some(match self {
            Self::Rectangle(r) => Footprint::Rectangle {
                front: si::metres(r.half_length),
                rear: si::metres(r.half_length),
                half_width: si::metres(r.half_width),
            },
            Self::Disc(radius) => Footprint::Disc {
                radius: si::metres(*radius),
            },
            Self::Polygon(polygon) if polygon.edges.len() <= MAX_VERTICES => {
                Footprint::Polygon(polygon.vertices().map(point).collect())
            }
            Self::Polygon(_) => return None,
        })
    }

    /// Radius of the circle about the centre that holds it, m.
    pub fn outer_radius(&self) -> f64 {
        match self {
            Self::Rectangle(r) => libm::hypot(r.half_length, r.half_width),
            Self::Disc(radius) => *radius,
            Self::Polygon(p) => p
                .vertices()
                .map(|[x, y]| libm::hypot(x, y))
                .fold(0.0, f64::max),
        }
    }

    /// Radius of the largest circle about the centre inside it, m.
    pub fn inner_radius(&self) -> f64 {
        match self {
            Self::Rectangle(r) => r.half_length.min(r.half_width),
            Self::Disc(radius) => *radius,
            Self::Polygon(p) => -p.distance([0.0, 0.0]),
        }
    }

    /// How far it reaches in a direction of the body's frame, given as a unit vector, m.
    fn extent(&self, [u, v]: [f64; 2]) -> f64 {
        match self {
            Self::Rectangle(r) => r.half_length * u.abs() + r.half_width * v.abs(),
            Self::Disc(radius) => *radius,
            Self::Polygon(p) => p.vertices().map(|[x, y]| x * u + y * v).fold(0.0, f64::max),
        }
    }

    /// How far it reaches ahead of the centre of rotation, m.
    pub fn front(&self) -> f64 {
        self.extent([1.0, 0.0])
    }

    /// How far it reaches behind it, m, positive.
    pub fn rear(&self) -> f64 {
        self.extent([-1.0, 0.0])
    }

    /// How far it reaches to the side that it reaches farther to, m.
    pub fn half_width(&self) -> f64 {
        self.extent([0.0, 1.0]).max(self.extent([0.0, -1.0]))
    }

    /// Distance from the edge to a point in the body's frame, m; negative inside, there the depth below the nearest edge.
    pub fn distance(&self, point: [f64; 2]) -> f64 {
        match self {
            Self::Rectangle(r) => r.distance(point),
            Self::Disc(radius) => libm::hypot(point[0], point[1]) - radius,
            Self::Polygon(p) => p.distance(point),
        }
    }

    /// Square of the distance to a point, m²; zero inside.
    pub fn distance_squared(&self, point: [f64; 2]) -> f64 {
        if let Self::Rectangle(r) = self {
            return r.distance_squared(point);
        }
        let distance = self.distance(point).max(0.0);
        distance * distance
    }

    /// Place of the edge that is nearest to a point, both in the body's frame, m.
    pub fn nearest(&self, [x, y]: [f64; 2]) -> [f64; 2] {
        if let Self::Disc(radius) = self {
            let far = libm::hypot(x, y);
            return if far > 0.0 {
                [x, y].map(|part| part / far * radius)
            } else {
                [*radius, 0.0]
            };
        }
        let corners = self.corners([0.0; 3]);
        let next = corners.iter().cycle().skip(1);
        let places = corners.iter().zip(next).map(|(from, to)| {
            let along = [to[0] - from[0], to[1] - from[1]];
            let length2 = along[0] * along[0] + along[1] * along[1];
            let share = ((x - from[0]) * along[0] + (y - from[1]) * along[1]) / length2;
            let share = share.clamp(0.0, 1.0);
            [0, 1].map(|k| from[k] + share * along[k])
        });
        let squared = |p: &[f64; 2]| (p[0] - x) * (p[0] - x) + (p[1] - y) * (p[1] - y);
        places
            .min_by(|a, b| squared(a).total_cmp(&squared(b)))
            .unwrap_or_default()
    }

    /// The corners in the world's frame of a body at `pose`, counter-clockwise; of a disc as many as it takes to look round.
    pub fn corners(&self, pose: [f64; 3]) -> Vec<[f64; 2]> {
        let frame = BodyFrame::new(pose);
        let corners: Vec<[f64; 2]> = match self {
            Self::Rectangle(r) => {
                let (l, w) = (r.half_length, r.half_width);
                vec![[l, w], [-l, w], [-l, -w], [l, -w]]
            }
            Self::Disc(radius) => (0..ROUND)
                .map(|k| {
                    let (sin, cos) = libm::sincos(k as f64 / ROUND as f64 * std::f64::consts::TAU);
                    [radius * cos, radius * sin]
                })
                .collect(),
            Self::Polygon(p) => p.vertices().collect(),
        };
        corners
            .into_iter()
            .map(|corner| frame.tell(corner))
            .collect()
    }
}

impl Rectangle {
    fn distance(&self, [x, y]: [f64; 2]) -> f64 {
        let (a, b) = (x.abs() - self.half_length, y.abs() - self.half_width);
        if a <= 0.0 || b <= 0.0 {
            a.max(b)
        } else {
            (a * a + b * b).sqrt()
        }
    }

    fn distance_squared(&self, [x, y]: [f64; 2]) -> f64 {
        let a = (x.abs() - self.half_length).max(0.0);
        let b = (y.abs() - self.half_width).max(0.0);
        a * a + b * b
    }
}

impl Polygon {
    fn new(vertices: &[[f64; 2]]) -> Self {
        let next = vertices.iter().cycle().skip(1);
        let edges = vertices.iter().zip(next).map(|(&from, to)| {
            let (dx, dy) = (to[0] - from[0], to[1] - from[1]);
            let length = libm::hypot(dx, dy);
            Edge {
                from,
                along: [dx / length, dy / length],
                length,
            }
        });
        Self {
            edges: edges.collect(),
        }
    }

    fn vertices(&self) -> impl Iterator<Item = [f64; 2]> + '_ {
        self.edges.iter().map(|edge| edge.from)
    }

    fn distance(&self, [x, y]: [f64; 2]) -> f64 {
        let mut inside = f64::NEG_INFINITY;
        let mut nearest = f64::INFINITY;
        for edge in &self.edges {
            let (dx, dy) = (x - edge.from[0], y - edge.from[1]);
            let [u, v] = edge.along;
            // Outside is to the right of an edge.
            let out = dx * v - dy * u;
            inside = inside.max(out);
            if out > 0.0 {
                let along = dx * u + dy * v;
                let beyond = (along - edge.length).max(-along).max(0.0);
                nearest = nearest.min(out * out + beyond * beyond);
            }
        }
        if inside > 0.0 { nearest.sqrt() } else { inside }
    }
}

/// The frame of a body, for many points.
#[derive(Clone, Copy, Debug)]
pub struct BodyFrame {
    at: [f64; 2],
    cos: f64,
    sin: f64,
}

impl BodyFrame {
    /// Of a body at x, y (m), heading (rad).
    pub fn new([x, y, heading]: [f64; 3]) -> Self {
        let (sin, cos) = libm::sincos(heading);
        Self {
            at: [x, y],
            cos,
            sin,
        }
    }

    /// A point of the world as the body has it.
    pub fn see(&self, point: [f64; 2]) -> [f64; 2] {
        let (dx, dy) = (point[0] - self.at[0], point[1] - self.at[1]);
        [dx * self.cos + dy * self.sin, dy * self.cos - dx * self.sin]
    }

    /// A point that the body has, in the world.
    pub fn tell(&self, [x, y]: [f64; 2]) -> [f64; 2] {
        [
            self.at[0] + x * self.cos - y * self.sin,
            self.at[1] + x * self.sin + y * self.cos,
        ]
    }
}

/// A point of the world in the frame of a body at `pose`.
pub fn to_body(pose: [f64; 3], point: [f64; 2]) -> [f64; 2] {
    BodyFrame::new(pose).see(point)
}
