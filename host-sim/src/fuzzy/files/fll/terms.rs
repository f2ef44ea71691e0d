//! `term: name Shape numbers`

use super::{Component, HEDGES, RESERVED};
use crate::fuzzy::files::checks;
use crate::fuzzy::files::cursor::{Cursor, Parameter};
use crate::fuzzy::files::error::{ReadError, counted, one_of, quoted};
use crate::fuzzy::files::lexer::Token;
use crate::fuzzy::files::limits;
use crate::fuzzy::files::shapes::Family;
use crate::fuzzy::model::Conclusion;

/// Shapes of terms.
const SHAPES: &[(&str, Family)] = &[
    ("Bell", Family::Bell),
    ("Discrete", Family::Points),
    ("Gaussian", Family::Gaussian),
    ("GaussianProduct", Family::TwoSidedGaussian),
    ("Ramp", Family::Ramp),
    ("Rectangle", Family::Rectangle),
    ("SShape", Family::S),
    ("Sigmoid", Family::Sigmoid),
    ("Trapezoid", Family::Trapezoid),
    ("Triangle", Family::Triangle),
    ("ZShape", Family::Z),
];

/// Shapes that FuzzyLite has and this project does not.
const OTHER_SHAPES: &[&str] = &[
    "Arc",
    "Binary",
    "Concave",
    "Cosine",
    "Function",
    "PiShape",
    "SemiEllipse",
    "SigmoidDifference",
    "SigmoidProduct",
    "Spike",
];

impl<'s> Component<'s, '_> {
    pub(super) fn terms(self, output: bool) -> Result<Vec<(Token<'s>, Conclusion)>, ReadError> {
        let mut all: Vec<(Token<'s>, Conclusion)> = Vec::new();
        for property in self.component.properties.iter().filter(|p| p.key == "term") {
            let (name, conclusion) =
                self.value(*property, "a number, or the end of the line", |c| {
                    self.term(c, output)
                })?;
            let earlier = all.iter().map(|(n, _)| (n.text, n.place));
            checks::unique(self.source, "the term", name.text, name.place, earlier)?;
            all.push((name, conclusion));
            checks::count(self.source, name.place, "terms", all.len(), limits::TERMS)?;
        }
        Ok(all)
    }

    fn term(
        self,
        cursor: &mut Cursor<'s, '_>,
        output: bool,
    ) -> Result<(Token<'s>, Conclusion), ReadError> {
        let mut words = RESERVED.to_vec();
        words.extend(HEDGES);
        let name = cursor.name("a term's name", &words)?;
        let shape = cursor.peek();
        let (constant, linear) = (shape.text == "Constant", shape.text == "Linear");
        if !output && (constant || linear) {
            let found = format!("{} is for outputs", quoted(shape.text));
            return Err(self.source.error(shape.place, found, shapes_allowed(false)));
        }
        if OTHER_SHAPES.contains(&shape.text) {
            let found = format!("the shape {} is not supported", quoted(shape.text));
            return Err(self
                .source
                .error(shape.place, found, shapes_allowed(output)));
        }
        let family = SHAPES
            .iter()
            .find(|(name, _)| *name == shape.text)
            .map(|s| s.1);
        if family.is_none() && !constant && !linear {
            return Err(cursor.unexpected(shapes_allowed(output)));
        }
        cursor.take();
        let mut numbers = Vec::new();
        while cursor.at_number() {
            numbers.push(cursor.number("a number")?);
            checks::count(
                self.source,
                shape.place,
                "numbers",
                numbers.len(),
                2 * limits::POINTS + 1,
            )?;
        }
        // What stops the numbers is named before their count is.
        cursor.end("a number, or the end of the line")?;
        let conclusion = match family {
            Some(family) => {
                self.height(family, &mut numbers)?;
                Conclusion::Set(family.shape(self.source, shape, &numbers, &[])?)
            }
            None => self.number_conclusion(shape, constant, &numbers)?,
        };
        Ok((name, conclusion))
    }

    /// Takes a height, which may follow the numbers of a shape, away if it is one.
    fn height(self, family: Family, numbers: &mut Vec<Parameter>) -> Result<(), ReadError> {
        let extra = match family {
            Family::Points => numbers.len() % 2 == 1,
            _ => numbers.len() == family.numbers().len() + 1,
        };
        let Some(height) = numbers.last().filter(|_| extra) else {
            return Ok(());
        };
        if height.value == 1.0 {
            numbers.pop();
            return Ok(());
        }
        let found = format!("a term with the height {} is not supported", height.value);
        Err(self
            .source
            .error(height.place, found, "the height 1, or none"))
    }

    fn number_conclusion(
        self,
        name: Token<'s>,
        constant: bool,
        numbers: &[Parameter],
    ) -> Result<Conclusion, ReadError> {
        if let Some(bad) = numbers.iter().find(|p| !p.value.is_finite()) {
            let found = format!("{} is not finite", bad.value);
            return Err(self.source.error(bad.place, found, "a finite number"));
        }
        match (constant, numbers) {
            (true, [value]) => Ok(Conclusion::Constant(value.value)),
            (false, [coefficients @ .., constant]) => Ok(Conclusion::Linear {
                coefficients: coefficients.iter().map(|p| p.value).collect(),
                constant: constant.value,
            }),
            _ => {
                let found = format!(
                    "{} has {}",
                    quoted(name.text),
                    counted(numbers.len(), "number")
                );
                let allowed = match constant {
                    true => "1: the value",
                    false => "a number for each input, and the constant",
                };
                Err(self.source.error(name.place, found, allowed))
            }
        }
    }
}

fn shapes_allowed(output: bool) -> String {
    let names = SHAPES.iter().map(|(name, _)| *name);
    let more: &[&str] = if output { &["Constant", "Linear"] } else { &[] };
    one_of(names.chain(more.iter().copied()))
}
