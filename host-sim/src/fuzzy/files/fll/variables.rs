//! `InputVariable` and `OutputVariable`.

use super::{Component, DEFAULT_SAMPLES, OTHER_DISJUNCTIONS, RESERVED};
use crate::fuzzy::files::checks;
use crate::fuzzy::files::error::{ReadError, quoted};
use crate::fuzzy::files::lexer::{Kind, Token};
use crate::fuzzy::model::{
    Conclusion, Defuzzifier, Input, Merge, Output, OutputTerm, Sampling, Term,
};

/// FuzzyLite's other defuzzifiers.
const OTHER_DEFUZZIFIERS: &[&str] = &[
    "Bisector",
    "LargestOfMaximum",
    "MeanOfMaximum",
    "SmallestOfMaximum",
    "WeightedSum",
];

impl<'s> Component<'s, '_> {
    /// The component's name, which must be one.
    fn name(self) -> Result<Token<'s>, ReadError> {
        self.value(
            self.component.head,
            "the end of the line: a name is one word",
            |cursor| cursor.name("a name", RESERVED),
        )
    }

    fn enabled(self) -> Result<(), ReadError> {
        if self.flag("enabled", true)? {
            return Ok(());
        }
        let place = self
            .property("enabled")
            .map_or(self.component.head.place, |p| p.value_place);
        let found = "a disabled variable is not supported";
        Err(self.source.error(
            place,
            found,
            "`enabled: true`, or the file without the variable",
        ))
    }

    fn range(self) -> Result<std::ops::RangeInclusive<f64>, ReadError> {
        let Some(property) = self.property("range") else {
            let found = format!("{} has no range", quoted(self.component.head.value));
            return Err(self
                .source
                .error(self.component.head.place, found, "`range: start end`"));
        };
        let (start, end) = self.value(
            property,
            "the end of the line: a range has two numbers",
            |cursor| {
                Ok((
                    cursor.number("the range's start")?,
                    cursor.number("the range's end")?,
                ))
            },
        )?;
        checks::range(self.source, start, end)
    }

    pub(super) fn input(self) -> Result<Input, ReadError> {
        self.keys(&["description", "enabled", "range", "lock-range", "term"])?;
        let name = self.name()?;
        self.enabled()?;
        let mut terms: Vec<Term> = Vec::new();
        for (name, conclusion) in self.terms(false)? {
            let Conclusion::Set(shape) = conclusion else {
                continue;
            };
            terms.push(Term {
                name: name.text.to_owned(),
                shape,
                place: name.place,
            });
        }
        Ok(Input {
            name: name.text.to_owned(),
            description: self.description(),
            range: self.range()?,
            clamp: self.flag("lock-range", false)?,
            terms,
            place: name.place,
        })
    }

    pub(super) fn output(self) -> Result<Output, ReadError> {
        self.keys(&[
            "description",
            "enabled",
            "range",
            "lock-range",
            "aggregation",
            "defuzzifier",
            "default",
            "lock-previous",
            "term",
        ])?;
        let name = self.name()?;
        self.enabled()?;
        if self.flag("lock-previous", false)? {
            let place = self
                .property("lock-previous")
                .map_or(name.place, |p| p.value_place);
            let found = "keeping the previous value is not supported";
            return Err(self.source.error(place, found, "`lock-previous: false`"));
        }
        let defuzzifier = self.defuzzifier()?;
        let default = match self.property("default") {
            None => None,
            Some(property) => {
                let default = self.value(property, "the end of the line", |c| {
                    c.number("a number, or `nan` for none")
                })?;
                if default.value.is_infinite() {
                    let found = format!("the default is {}", default.value);
                    return Err(self.source.error(
                        default.place,
                        found,
                        "a finite number, or `nan` for none",
                    ));
                }
                Some(default.value).filter(|v| !v.is_nan())
            }
        };
        let terms = self.terms(true)?;
        Ok(Output {
            name: name.text.to_owned(),
            description: self.description(),
            range: self.range()?,
            clamp: self.flag("lock-range", false)?,
            default,
            defuzzifier,
            merge: self.merge(defuzzifier)?,
            terms: terms
                .into_iter()
                .map(|(name, conclusion)| OutputTerm {
                    name: name.text.to_owned(),
                    conclusion,
                    place: name.place,
                })
                .collect(),
            place: name.place,
        })
    }

    fn merge(self, defuzzifier: Defuzzifier) -> Result<Merge, ReadError> {
        let known = [
            ("Maximum", Some(Merge::Max)),
            ("UnboundedSum", Some(Merge::Sum)),
            ("none", None),
        ];
        let property = self.property("aggregation").filter(|p| !p.value.is_empty());
        let merge = match property {
            None => None,
            Some(property) => self.value(property, "the end of the line", |cursor| {
                self.operator(cursor, "aggregation", &known, OTHER_DISJUNCTIONS)
            })?,
        };
        match (merge, defuzzifier) {
            (Some(merge), _) => Ok(merge),
            // FuzzyLite adds the degrees then.
            (None, Defuzzifier::WeightedAverage) => Ok(Merge::Sum),
            (None, Defuzzifier::Centroid { .. }) => {
                let place = property.map_or(self.component.head.place, |p| p.value_place);
                let found = "a centroid without an aggregation";
                Err(self.source.error(place, found, "Maximum or UnboundedSum"))
            }
        }
    }

    fn defuzzifier(self) -> Result<Defuzzifier, ReadError> {
        let property = self
            .property("defuzzifier")
            .filter(|p| !matches!(p.value, "" | "none"));
        let Some(property) = property else {
            let place = self
                .property("defuzzifier")
                .map_or(self.component.head.place, |p| p.place);
            let found = format!("{} has no defuzzifier", quoted(self.component.head.value));
            let allowed = "`defuzzifier: Centroid samples` or `defuzzifier: WeightedAverage`";
            return Err(self.source.error(place, found, allowed));
        };
        self.value(property, "the end of the line", |cursor| {
            let known = [("Centroid", true), ("WeightedAverage", false)];
            if !self.operator(cursor, "defuzzifier", &known, OTHER_DEFUZZIFIERS)? {
                if cursor.peek().kind != Kind::End {
                    let kinds = [("TakagiSugeno", true), ("Automatic", true)];
                    self.operator(cursor, "kind of weighted average", &kinds, &["Tsukamoto"])?;
                }
                return Ok(Defuzzifier::WeightedAverage);
            }
            let points = match cursor.at_number() {
                false => DEFAULT_SAMPLES,
                true => {
                    let number = cursor.number("a number of samples")?;
                    checks::samples(self.source, number)?
                }
            };
            Ok(Defuzzifier::Centroid {
                points,
                sampling: Sampling::Middles,
            })
        })
    }
}
