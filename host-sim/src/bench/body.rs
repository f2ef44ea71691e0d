//! The robot's footprint: a rectangle about the centre of rotation.

/// A rectangle, its centre at the centre of rotation.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Rectangle {
    /// Half the length, along x, m.
    pub half_length: f64,
    /// Half the width, along y, m.
    pub half_width: f64,
}

/// The Jackal's footprint in the benchmark: 0.508 × 0.430 m.
pub const JACKAL: Rectangle = Rectangle {
    half_length: 0.254,
    half_width: 0.215,
};

impl Rectangle {
    /// Radius of the circle about the centre that holds it, m.
    pub fn outer_radius(&self) -> f64 {
        libm::hypot(self.half_length, self.half_width)
    }

    /// Radius of the largest circle about the centre inside it, m.
    pub fn inner_radius(&self) -> f64 {
        self.half_length.min(self.half_width)
    }

    /// Distance from the rectangle's edge to a point in the body's frame, m; negative inside, there the depth below the
    /// nearest edge.
    pub fn distance(&self, [x, y]: [f64; 2]) -> f64 {
        let (a, b) = (x.abs() - self.half_length, y.abs() - self.half_width);
        if a <= 0.0 || b <= 0.0 {
            a.max(b)
        } else {
            (a * a + b * b).sqrt()
        }
    }

    /// Square of the distance from the rectangle to a point, m²; zero inside.
    pub fn distance_squared(&self, [x, y]: [f64; 2]) -> f64 {
        let a = (x.abs() - self.half_length).max(0.0);
        let b = (y.abs() - self.half_width).max(0.0);
        a * a + b * b
    }

    /// The corners in the world's frame of a body at `pose`, counter-clockwise from the front left.
    pub fn corners(&self, [x, y, heading]: [f64; 3]) -> [[f64; 2]; 4] {
        let (sin, cos) = libm::sincos(heading);
        let (l, w) = (self.half_length, self.half_width);
        [[l, w], [-l, w], [-l, -w], [l, -w]]
            .map(|[u, v]| [x + u * cos - v * sin, y + u * sin + v * cos])
    }
}

/// A point of the world in the frame of a body at `pose`.
pub fn to_body([x, y, heading]: [f64; 3], point: [f64; 2]) -> [f64; 2] {
    let (sin, cos) = libm::sincos(heading);
    let (dx, dy) = (point[0] - x, point[1] - y);
    [dx * cos + dy * sin, dy * cos - dx * sin]
}
