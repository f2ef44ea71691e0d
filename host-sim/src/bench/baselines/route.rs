//! A route as its followers need it: where the robot is along it, and a point some way on.

/// A polyline with arc lengths.
#[derive(Clone, Debug)]
pub struct Route {
    points: Vec<[f64; 2]>,
    /// Arc length of each point, m.
    at: Vec<f64>,
    /// Arc length reached so far, m: never goes back, so a route may pass itself.
    reached: f64,
}

/// How far ahead of the last place the nearest point is looked for, m.
const WINDOW: f64 = 2.0;

impl Route {
    /// From points, m; repeated ones are dropped.
    pub fn new(route: &[[f64; 2]]) -> Self {
        let mut points: Vec<[f64; 2]> = Vec::with_capacity(route.len());
        let mut at = Vec::with_capacity(route.len());
        for &point in route {
            match points.last() {
                Some(&last) => {
                    let step = distance(last, point);
                    if step > 1e-9 {
                        at.push(at.last().copied().unwrap_or(0.0) + step);
                        points.push(point);
                    }
                }
                None => {
                    points.push(point);
                    at.push(0.0);
                }
            }
        }
        Self {
            points,
            at,
            reached: 0.0,
        }
    }

    /// Whole length, m.
    pub fn length(&self) -> f64 {
        self.at.last().copied().unwrap_or(0.0)
    }

    /// Arc length of the nearest point ahead of the last one found, m.
    pub fn locate(&mut self, place: [f64; 2]) -> f64 {
        let mut best = (f64::INFINITY, self.reached);
        for k in 1..self.points.len() {
            if self.at[k] < self.reached || self.at[k - 1] > self.reached + WINDOW {
                continue;
            }
            let (from, to) = (self.points[k - 1], self.points[k]);
            let length = self.at[k] - self.at[k - 1];
            let (ex, ey) = ((to[0] - from[0]) / length, (to[1] - from[1]) / length);
            let along = ((place[0] - from[0]) * ex + (place[1] - from[1]) * ey).clamp(0.0, length);
            let foot = [from[0] + along * ex, from[1] + along * ey];
            let away = distance(foot, place);
            if away < best.0 {
                best = (away, self.at[k - 1] + along);
            }
        }
        self.reached = self.reached.max(best.1);
        self.reached
    }

    /// The point at an arc length, clamped to the ends.
    pub fn point(&self, at: f64) -> [f64; 2] {
        let k = self.at.partition_point(|a| *a < at);
        if k == 0 {
            return self.points[0];
        }
        if k == self.points.len() {
            return self.points[k - 1];
        }
        let share = (at - self.at[k - 1]) / (self.at[k] - self.at[k - 1]);
        let (from, to) = (self.points[k - 1], self.points[k]);
        [
            from[0] + share * (to[0] - from[0]),
            from[1] + share * (to[1] - from[1]),
        ]
    }
}

/// Distance of two points, m.
pub fn distance(a: [f64; 2], b: [f64; 2]) -> f64 {
    libm::hypot(a[0] - b[0], a[1] - b[1])
}
