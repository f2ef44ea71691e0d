//! Membership functions from the numbers that a file gives, checked, and brought to one form: what three formats write in
//! three ways is the same [`Shape`].

use super::cursor::Parameter;
use super::error::{ReadError, Source, counted, quoted};
use super::lexer::Token;
use super::limits;
use crate::fuzzy::model::{Place, Shape};

/// What kinds of membership functions a file can name, with their numbers in this order.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum Family {
    /// Left foot, peak, right foot.
    Triangle,
    /// Left foot, left shoulder, right shoulder, right foot.
    Trapezoid,
    /// Start, end.
    Rectangle,
    /// Where it is 0, where it is 1.
    Ramp,
    /// Where it is 1, where it is 0.
    FallingRamp,
    /// x, degree, x, degree…
    Points,
    /// Mean, deviation.
    Gaussian,
    /// Mean and deviation left, mean and deviation right.
    TwoSidedGaussian,
    /// Centre, width, slope.
    Bell,
    /// Inflection, slope.
    Sigmoid,
    /// Where it is 0, where it is 1.
    S,
    /// Where it is 1, where it is 0.
    Z,
}

impl Family {
    /// What its numbers are called; none if there may be any number of them.
    pub fn numbers(self) -> &'static [&'static str] {
        match self {
            Self::Triangle => &["left foot", "peak", "right foot"],
            Self::Trapezoid => &["left foot", "left shoulder", "right shoulder", "right foot"],
            Self::Rectangle => &["start", "end"],
            Self::Ramp | Self::S => &["where it is 0", "where it is 1"],
            Self::FallingRamp | Self::Z => &["where it is 1", "where it is 0"],
            Self::Points => &[],
            Self::Gaussian => &["mean", "deviation"],
            Self::TwoSidedGaussian => &[
                "left mean",
                "left deviation",
                "right mean",
                "right deviation",
            ],
            Self::Bell => &["centre", "width", "slope"],
            Self::Sigmoid => &["inflection", "slope"],
        }
    }

    /// The membership function. `name` is where the file names it, `order` where each of the family's numbers stands
    /// among the given ones (none: in the family's own order).
    pub fn shape(
        self,
        source: Source<'_>,
        name: Token<'_>,
        given: &[Parameter],
        order: &[usize],
    ) -> Result<Shape, ReadError> {
        let wanted = self.numbers();
        if self == Self::Points {
            return points(source, name, given);
        }
        if given.len() != wanted.len() {
            let mut names: Vec<&str> = wanted.to_vec();
            for (i, &at) in order.iter().enumerate() {
                names[at] = wanted[i];
            }
            let found = format!(
                "{} has {}",
                quoted(name.text),
                counted(given.len(), "number")
            );
            let allowed = format!("{}: {}", wanted.len(), names.join(", "));
            return Err(source.error(name.place, found, allowed));
        }
        let at = |i: usize| given[order.get(i).copied().unwrap_or(i)];
        let check = Check {
            source,
            family: self,
        };
        match self {
            Self::Triangle => {
                check.ascending(&[at(0), at(1), at(2)])?;
                let [left, peak, right] = [at(0), at(1), at(2)].map(|p| p.value);
                check.finite(at(1), 1)?;
                Ok(match left.is_finite() && right.is_finite() {
                    true => Shape::Triangle { left, peak, right },
                    // Open to a side.
                    false => trapezoid([left, peak, peak, right]),
                })
            }
            Self::Trapezoid => {
                let all = [at(0), at(1), at(2), at(3)];
                check.ascending(&all)?;
                Ok(trapezoid(all.map(|p| p.value)))
            }
            Self::Rectangle => {
                let (start, end) = (check.finite(at(0), 0)?, check.finite(at(1), 1)?);
                if start > end {
                    return Err(check.error(at(1).place, "the end is below the start"));
                }
                Ok(match start == end {
                    true => Shape::Singleton(start),
                    false => trapezoid([start, start, end, end]),
                })
            }
            Self::Ramp => Ok(Shape::Ramp {
                from: check.finite(at(0), 0)?,
                to: check.other(at(1), 1, at(0))?,
            }),
            Self::FallingRamp => Ok(Shape::Ramp {
                to: check.finite(at(0), 0)?,
                from: check.above(at(1), 1, at(0))?,
            }),
            Self::S => Ok(Shape::Spline {
                from: check.finite(at(0), 0)?,
                to: check.above(at(1), 1, at(0))?,
            }),
            Self::Z => Ok(Shape::Spline {
                to: check.finite(at(0), 0)?,
                from: check.above(at(1), 1, at(0))?,
            }),
            Self::Gaussian => Ok(Shape::Gaussian {
                mean: check.finite(at(0), 0)?,
                deviation: check.positive(at(1), 1)?,
            }),
            Self::TwoSidedGaussian => {
                let left = (check.finite(at(0), 0)?, check.positive(at(1), 1)?);
                let right = (check.finite(at(2), 2)?, check.positive(at(3), 3)?);
                if left.0 > right.0 {
                    return Err(check.error(
                        at(2).place,
                        "the right mean is below the left one, so the term never reaches 1",
                    ));
                }
                Ok(Shape::TwoSidedGaussian { left, right })
            }
            Self::Bell => Ok(Shape::Bell {
                centre: check.finite(at(0), 0)?,
                width: check.positive(at(1), 1)?,
                slope: check.positive(at(2), 2)?,
            }),
            Self::Sigmoid => {
                let inflection = check.finite(at(0), 0)?;
                let slope = check.finite(at(1), 1)?;
                if slope == 0.0 {
                    return Err(
                        check.error(at(1).place, "the slope is 0, so the term is ½ everywhere")
                    );
                }
                Ok(Shape::Sigmoid { inflection, slope })
            }
            Self::Points => points(source, name, given),
        }
    }
}

/// Checks of numbers, with their names in the messages.
#[derive(Clone, Copy)]
struct Check<'s> {
    source: Source<'s>,
    family: Family,
}

impl Check<'_> {
    fn error(self, place: Place, found: &str) -> ReadError {
        self.source.error(place, found, "")
    }

    fn name(self, i: usize) -> &'static str {
        self.family.numbers().get(i).copied().unwrap_or("number")
    }

    fn finite(self, p: Parameter, i: usize) -> Result<f64, ReadError> {
        match p.value.is_finite() {
            true => Ok(p.value),
            false => Err(self.source.error(
                p.place,
                format!("{}: {} is not finite", self.name(i), p.value),
                "a finite number",
            )),
        }
    }

    fn positive(self, p: Parameter, i: usize) -> Result<f64, ReadError> {
        match self.finite(p, i)? {
            x if x > 0.0 => Ok(x),
            x => Err(self.source.error(
                p.place,
                format!("{}: found {x}", self.name(i)),
                "a number above 0",
            )),
        }
    }

    /// Another number than the first.
    fn other(self, p: Parameter, i: usize, first: Parameter) -> Result<f64, ReadError> {
        match self.finite(p, i)? {
            x if x == first.value => Err(self.source.error(
                p.place,
                format!(
                    "{}: found {x}, which is also {}",
                    self.name(i),
                    self.name(0)
                ),
                format!("a number other than {x}"),
            )),
            x => Ok(x),
        }
    }

    /// A number above the first.
    fn above(self, p: Parameter, i: usize, first: Parameter) -> Result<f64, ReadError> {
        match self.finite(p, i)? {
            x if x > first.value => Ok(x),
            x => Err(self.source.error(
                p.place,
                format!("{}: found {x}", self.name(i)),
                format!("a number above {}", first.value),
            )),
        }
    }

    /// Feet and shoulders: none falls back, the last lies above the first, only the outer ones may be open.
    fn ascending(self, all: &[Parameter]) -> Result<(), ReadError> {
        for (i, p) in all.iter().enumerate() {
            if p.value.is_nan() {
                self.finite(*p, i)?;
            }
            let left = 2 * i < all.len();
            if p.value == f64::INFINITY && left || p.value == f64::NEG_INFINITY && !left {
                self.finite(*p, i)?;
            }
            if let Some(before) = i.checked_sub(1).map(|j| all[j])
                && p.value < before.value
            {
                return Err(self.source.error(
                    p.place,
                    format!("{}: found {}", self.name(i), p.value),
                    format!("{} (the {}) or more", before.value, self.name(i - 1)),
                ));
            }
        }
        if let [first, .., last] = all
            && first.value == last.value
        {
            return Err(self.source.error(
                last.place,
                format!("the right foot, {}, is the left one, too", last.value),
                format!("a number above {}", first.value),
            ));
        }
        Ok(())
    }
}

/// A trapezoid; one that is open to one side only and slopes on the other is a ramp.
fn trapezoid([left, rise, fall, right]: [f64; 4]) -> Shape {
    let (open_left, open_right) = (left == f64::NEG_INFINITY, right == f64::INFINITY);
    if open_left && !open_right && fall < right && fall.is_finite() {
        Shape::Ramp {
            from: right,
            to: fall,
        }
    } else if open_right && !open_left && left < rise && rise.is_finite() {
        Shape::Ramp {
            from: left,
            to: rise,
        }
    } else {
        Shape::Trapezoid {
            left,
            rise,
            fall,
            right,
        }
    }
}

/// Points; those of a ramp, a triangle or a trapezoid are one. Not those that end in a jump: there the last point counts, and
/// with a triangle it would be its peak.
fn points(source: Source<'_>, name: Token<'_>, given: &[Parameter]) -> Result<Shape, ReadError> {
    let pairs = given.len() / 2;
    if given.len() % 2 == 1 || !(2..=limits::POINTS).contains(&pairs) {
        let found = match given.len() % 2 {
            1 => format!("{} make no points", counted(given.len(), "number")),
            _ => format!("found {}", counted(pairs, "point")),
        };
        let allowed = format!("2 to {} points: x, degree, x, degree…", limits::POINTS);
        return Err(source.error(name.place, found, allowed));
    }
    let mut last = f64::NEG_INFINITY;
    let mut all = Vec::with_capacity(pairs);
    for pair in given.chunks_exact(2) {
        let [x, degree] = [pair[0], pair[1]];
        if !x.value.is_finite() || x.value < last {
            let found = format!("x of a point: found {}", x.value);
            let allowed = match last.is_finite() {
                true => format!("a number from {last} up, where the last point was"),
                false => "a finite number".to_owned(),
            };
            return Err(source.error(x.place, found, allowed));
        }
        if !(0.0..=1.0).contains(&degree.value) {
            let found = format!("degree of a point: found {}", degree.value);
            return Err(source.error(degree.place, found, "0 to 1"));
        }
        last = x.value;
        all.push((x.value, degree.value));
    }
    Ok(match *all.as_slice() {
        [(from, 0.0), (to, 1.0)] if from < to => Shape::Ramp { from, to },
        [(to, 1.0), (from, 0.0)] if to < from => Shape::Ramp { from, to },
        [(left, 0.0), (peak, 1.0), (right, 0.0)] if peak < right => {
            Shape::Triangle { left, peak, right }
        }
        [(left, 0.0), (rise, 1.0), (fall, 1.0), (right, 0.0)] if fall < right => Shape::Trapezoid {
            left,
            rise,
            fall,
            right,
        },
        _ => Shape::Points(all),
    })
}

/// Between which values a shape changes; none if it is a curve or open.
pub fn extent(shape: &Shape) -> Option<(f64, f64)> {
    let (a, b) = match *shape {
        Shape::Triangle { left, right, .. } | Shape::Trapezoid { left, right, .. } => (left, right),
        Shape::Ramp { from, to } | Shape::Spline { from, to } => (from.min(to), from.max(to)),
        Shape::Singleton(x) => (x, x),
        Shape::Points(ref points) => (points.first()?.0, points.last()?.0),
        Shape::Gaussian { .. }
        | Shape::TwoSidedGaussian { .. }
        | Shape::Bell { .. }
        | Shape::Sigmoid { .. } => return None,
    };
    (a.is_finite() && b.is_finite()).then_some((a, b))
}
