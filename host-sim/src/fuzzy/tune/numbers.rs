//! The numbers of a model that can move, one after the other.

use crate::fuzzy::model::{Conclusion, Shape, System};

/// A variable.
#[derive(Clone, Copy, Debug, PartialEq, Eq, PartialOrd, Ord)]
pub enum Variable {
    /// Index of an input.
    Input(usize),
    /// Index of an output.
    Output(usize),
}

/// What a number says.
#[derive(Clone, Copy, Debug, PartialEq)]
pub enum Role {
    /// Where a membership function has a knot or its middle, on the variable's axis.
    Knot,
    /// How wide or steep a curved one is.
    Width,
    /// What is concluded, on the output's axis.
    Constant,
    /// An input's factor in what is concluded (index of the input); without one, the sum's constant.
    Linear(Option<usize>),
}

/// A number's place in a model.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Slot {
    /// Of which variable.
    pub variable: Variable,
    /// Of which of its terms.
    pub term: usize,
    /// What it says.
    pub role: Role,
}

/// Shows every number that can move, always in the same order.
pub fn visit(system: &mut System, see: &mut impl FnMut(Slot, &mut f64)) {
    for (index, input) in system.inputs.iter_mut().enumerate() {
        let variable = Variable::Input(index);
        for (term, of) in input.terms.iter_mut().enumerate() {
            shape(&mut of.shape, &mut |role, x| {
                let slot = Slot {
                    variable,
                    term,
                    role,
                };
                see(slot, x);
            });
        }
    }
    for (index, output) in system.outputs.iter_mut().enumerate() {
        let variable = Variable::Output(index);
        for (term, of) in output.terms.iter_mut().enumerate() {
            let mut see = |role, x: &mut f64| {
                let slot = Slot {
                    variable,
                    term,
                    role,
                };
                see(slot, x);
            };
            match &mut of.conclusion {
                Conclusion::Constant(x) => see(Role::Constant, x),
                Conclusion::Linear {
                    coefficients,
                    constant,
                } => {
                    for (input, x) in coefficients.iter_mut().enumerate() {
                        see(Role::Linear(Some(input)), x);
                    }
                    see(Role::Linear(None), constant);
                }
                Conclusion::Set(set) => shape(set, &mut see),
            }
        }
    }
}

/// A bell's exponent and the degrees of points stay.
fn shape(shape: &mut Shape, see: &mut impl FnMut(Role, &mut f64)) {
    let mut knots: Vec<&mut f64> = Vec::new();
    let mut widths: Vec<&mut f64> = Vec::new();
    match shape {
        Shape::Triangle { left, peak, right } => knots.extend([left, peak, right]),
        Shape::Trapezoid {
            left,
            rise,
            fall,
            right,
        } => knots.extend([left, rise, fall, right]),
        Shape::Ramp { from, to } | Shape::Spline { from, to } => knots.extend([from, to]),
        Shape::Singleton(at) => knots.push(at),
        Shape::Points(points) => knots.extend(points.iter_mut().map(|point| &mut point.0)),
        Shape::Gaussian { mean, deviation } => {
            knots.push(mean);
            widths.push(deviation);
        }
        Shape::TwoSidedGaussian { left, right } => {
            knots.extend([&mut left.0, &mut right.0]);
            widths.extend([&mut left.1, &mut right.1]);
        }
        Shape::Bell { centre, width, .. } => {
            knots.push(centre);
            widths.push(width);
        }
        Shape::Sigmoid { inflection, slope } => {
            knots.push(inflection);
            widths.push(slope);
        }
    }
    knots.into_iter().for_each(|x| see(Role::Knot, x));
    widths.into_iter().for_each(|x| see(Role::Width, x));
}
