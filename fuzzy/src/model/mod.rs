//! What an author wrote: variables, terms, operators and rules, as plain data.

use alloc::{string::String, vec::Vec};

use crate::rule;

mod builder;
pub(crate) mod document;
mod partition;
#[cfg(feature = "serde")]
pub(crate) use crate::shape::Role;
pub(crate) use crate::shape::{Form, Parts};
pub use crate::shape::{Shape, ShapeError};
pub use crate::table::{Aggregation, Conjunction, Disjunction, Implication};
pub use builder::ModelBuilder;
pub(crate) use partition::{between_peaks, even_peaks};

/// A rule set: inputs, outputs, operators and rules.
///
/// # Example: plain data, from a text and back
/// ```
/// let text = "fuzzy: 1
/// name: fan
/// inputs: {heat: {range: [0, 100], partition: [low, high]}}
/// outputs: {speed: {range: [0, 9], partition: [slow, fast]}}
/// rules: [IF heat IS high THEN speed IS fast]";
/// let mut model = fuzzy::yaml::parse(text)?.model;
/// model.rules[0].rule.weight = 0.5;
/// assert!(fuzzy::yaml::to_string(&model).contains("IF heat IS high THEN speed IS fast WITH 0.5"));
/// # Ok::<(), Box<dyn std::error::Error>>(())
/// ```
#[derive(Debug, Clone, PartialEq)]
pub struct Model {
    /// The name of the rule set.
    pub name: String,
    /// What it is for, in the author's words.
    pub description: Option<String>,
    /// The inputs, in the order in which the engine takes their values.
    pub inputs: Vec<Variable>,
    /// The outputs, in the order in which the engine gives their values.
    pub outputs: Vec<Output>,
    /// The operators all rules share.
    pub operators: Operators,
    /// The rules.
    pub rules: Vec<Rule>,
}

/// A linguistic variable: a range of numbers and the terms that name its parts.
///
/// # Example: terms side by side
/// ```
/// use fuzzy::model::{Shape, Variable};
///
/// let heat = Variable::new("heat", 0.0, 100.0)
///     .unit("°C")
///     .term("low", Shape::LeftShoulder { top: 20.0, foot: 30.0 })
///     .term("high", Shape::RightShoulder { foot: 20.0, top: 30.0 });
/// let at_22: Vec<f64> = heat.terms.iter().map(|term| term.membership(22.0)).collect();
/// assert_eq!(at_22, [0.8, 0.2]);
/// ```
#[derive(Debug, Clone, PartialEq)]
pub struct Variable {
    /// Its name in rules.
    pub name: String,
    /// What it means, in the author's words.
    pub description: Option<String>,
    /// The unit of its values, for people: `"%"`, `"m/s"`.
    pub unit: Option<String>,
    /// The lower end of its range.
    pub low: f64,
    /// The upper end of its range.
    pub high: f64,
    /// Its terms.
    pub terms: Vec<Term>,
}

/// A term: a name for a fuzzy part of a variable's range.
///
/// # Example: a term that is never quite true
/// ```
/// use fuzzy::model::{Shape, Term};
///
/// let comfortable = Shape::Triangle { left: 15.0, peak: 20.0, right: 25.0 };
/// let term = Term { name: "comfortable".into(), shape: comfortable, height: 0.8 };
/// assert_eq!((term.membership(20.0), term.membership(40.0)), (0.8, 0.0));
/// ```
#[derive(Debug, Clone, PartialEq)]
pub struct Term {
    /// Its name in rules.
    pub name: String,
    /// The membership function.
    pub shape: Shape,
    /// The height of the membership function, in (0, 1]; 1 where the author wrote none.
    pub height: f64,
}

/// An output variable, and how its fuzzy result becomes a number.
///
/// # Example: the key `outputs` of a rule set
/// ```
/// use fuzzy::model::{Defuzzifier, NoRuleFires};
///
/// let text = "fuzzy: 1
/// name: fan
/// inputs: {}
/// outputs: {speed: {range: [0, 9], partition: [slow, fast], defuzzifier: bisector, when_no_rule_fires: {value: 0}}}
/// rules: []";
/// let speed = &fuzzy::yaml::parse(text)?.model.outputs[0];
/// assert_eq!((speed.variable.name.as_str(), speed.variable.high), ("speed", 9.0));
/// assert_eq!((speed.defuzzifier, speed.samples), (Defuzzifier::Bisector, None));
/// assert_eq!(speed.when_no_rule_fires, NoRuleFires::Value(0.0));
/// # Ok::<(), Box<dyn std::error::Error>>(())
/// ```
#[derive(Debug, Clone, PartialEq)]
pub struct Output {
    /// Name, range and terms.
    pub variable: Variable,
    /// How the aggregated set becomes a number.
    pub defuzzifier: Defuzzifier,
    /// Integrate by sampling, to reproduce other programs; `None` is exact.
    pub samples: Option<Sampling>,
    /// What the output is where no rule fires.
    pub when_no_rule_fires: NoRuleFires,
}

/// What an output is where no rule fires.
///
/// # Example: one rule, and a value that it says nothing of
/// ```
/// use fuzzy::engine::State;
///
/// let text = |what: &str| format!("fuzzy: 1
/// name: fan
/// inputs: {{heat: {{range: [0, 100], terms: {{high: {{right_shoulder: [60, 90]}}}}}}}}
/// outputs: {{speed: {{range: [0, 9], partition: [slow, fast], when_no_rule_fires: {what}}}}}
/// rules: [IF heat IS high THEN speed IS fast]");
/// let at_20 = |what: &str| -> Result<State, Box<dyn std::error::Error>> {
///     let model = fuzzy::yaml::parse(&text(what))?.model;
///     Ok(fuzzy::Engine::new(&model)?.evaluate(&[20.0])?[0].state)
/// };
/// assert_eq!(at_20("undefined")?, State::NoRuleFired);
/// assert_eq!(at_20("{value: 0}")?, State::Default(0.0));
/// assert!(at_20("error").is_err());
/// # Ok::<(), Box<dyn std::error::Error>>(())
/// ```
#[derive(Debug, Clone, Copy, PartialEq)]
pub enum NoRuleFires {
    /// The output is undefined there, and says so.
    Undefined,
    /// Evaluation is an error there.
    Error,
    /// A value the author chose.
    Value(f64),
}

/// How an aggregated fuzzy set becomes a number.
///
/// # Example: five numbers of one set, the triangle from 0 over 0 to 9 cut at one half
/// ```
/// # use fuzzy::{Engine, model::{Defuzzifier, Model, Output, Shape, Variable}, rule};
/// # let rule = rule::parse("IF heat IS high THEN speed IS slow WITH 0.5")?;
/// let by = |defuzzifier| -> Result<f64, Box<dyn std::error::Error>> {
///     # let model = Model::builder("fan")
///     #     .input(Variable::new("heat", 0.0, 1.0).term("high", Shape::RightShoulder { foot: 0.0, top: 1.0 }))
///     #     .output(Output::new(Variable::new("speed", 0.0, 9.0).term("slow", Shape::LeftShoulder { top: 0.0, foot: 9.0 })).defuzzifier(defuzzifier))
///     #     .rule(rule.clone()).build();
///     let outcome = Engine::new(&model)?.evaluate(&[1.0])?[0];
///     Ok(outcome.value().ok_or("no rule fired")?)
/// };
/// assert_eq!((by(Defuzzifier::Centroid)?, by(Defuzzifier::Bisector)?), (3.5, 3.375));
/// assert_eq!((by(Defuzzifier::SmallestOfMaxima)?, by(Defuzzifier::LargestOfMaxima)?), (0.0, 4.5));
/// assert_eq!(by(Defuzzifier::MeanOfMaxima)?, 2.25);
/// # Ok::<(), Box<dyn std::error::Error>>(())
/// ```
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub enum Defuzzifier {
    /// The centre of gravity of the aggregated set.
    Centroid,
    /// The value that halves the area of the aggregated set.
    Bisector,
    /// The smallest value at which the aggregated set is highest.
    SmallestOfMaxima,
    /// The mean of all values at which the aggregated set is highest.
    MeanOfMaxima,
    /// The largest value at which the aggregated set is highest.
    LargestOfMaxima,
    /// Takagi-Sugeno: `sum(w z) / sum(w)` over the rules.
    WeightedAverage,
    /// Takagi-Sugeno: `sum(w z)` over the rules.
    WeightedSum,
}

/// Sampled integration, for parity with other programs only.
///
/// # Example: what ten samples make of a centroid
/// ```
/// # use fuzzy::{Engine, model::{Model, Output, Sampling, SamplingRule, Shape, Variable}, rule};
/// # let rule = rule::parse("IF heat IS high THEN speed IS slow")?;
/// # let output = Output::new(Variable::new("speed", 0.0, 9.0).term("slow", Shape::LeftShoulder { top: 0.0, foot: 9.0 }));
/// let centroid = |output: Output| -> Result<f64, Box<dyn std::error::Error>> {
///     # let model = Model::builder("fan")
///     #     .input(Variable::new("heat", 0.0, 1.0).term("high", Shape::RightShoulder { foot: 0.0, top: 1.0 }))
///     #     .output(output).rule(rule.clone()).build();
///     let outcome = Engine::new(&model)?.evaluate(&[1.0])?[0];
///     Ok(outcome.value().ok_or("no rule fired")?)
/// };
/// assert!((centroid(output.clone())? - 3.0).abs() < 1e-12); // of a triangle from 0 over 0 to 9
/// let coarse = Sampling { samples: 10, rule: SamplingRule::Midpoint };
/// assert!((centroid(output.samples(coarse))? - 3.0).abs() > 0.01);
/// # Ok::<(), Box<dyn std::error::Error>>(())
/// ```
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub struct Sampling {
    /// The number of samples over the output's range.
    pub samples: usize,
    /// Where they stand.
    pub rule: SamplingRule,
}

/// Where the samples of a sampled integration stand.
///
/// # Example: two samples of a triangle from 0 over 0 to 9, whose centroid is 3
/// ```
/// # use fuzzy::{Engine, model::{Model, Output, Sampling, SamplingRule, Shape, Variable}, rule};
/// # let triangle = rule::parse("IF heat IS high THEN speed IS slow")?;
/// let centroid = |rule| -> Result<f64, Box<dyn std::error::Error>> {
///     # let model = Model::builder("fan")
///     #     .input(Variable::new("heat", 0.0, 1.0).term("high", Shape::RightShoulder { foot: 0.0, top: 1.0 }))
///     #     .output(Output::new(Variable::new("speed", 0.0, 9.0).term("slow", Shape::LeftShoulder { top: 0.0, foot: 9.0 })).samples(Sampling { samples: 2, rule }))
///     #     .rule(triangle.clone()).build();
///     let outcome = Engine::new(&model)?.evaluate(&[1.0])?[0];
///     Ok(outcome.value().ok_or("no rule fired")?)
/// };
/// assert_eq!(centroid(SamplingRule::Midpoint)?, 3.375); // at 2.25 and 6.75
/// assert_eq!(centroid(SamplingRule::Trapezoid)?, 0.0); // at 0 and 9
/// # Ok::<(), Box<dyn std::error::Error>>(())
/// ```
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub enum SamplingRule {
    /// `low + (i + 0.5) (high - low) / N`, i = 0..N.
    Midpoint,
    /// `low + i (high - low) / (N - 1)`, i = 0..N, equal weights at inner points, half at the ends.
    Trapezoid,
}

/// The operators that all rules of a model share.
///
/// # Example
/// ```
/// use fuzzy::model::{Aggregation, Conjunction, Operators};
///
/// // Mamdani's: minimum, maximum, minimum, maximum.
/// assert_eq!(Operators::default().and, Conjunction::Minimum);
/// let summing = Operators { aggregation: Aggregation::Sum, ..Operators::default() };
/// assert_eq!(summing.and, Conjunction::Minimum);
/// ```
#[derive(Debug, Clone, Copy, PartialEq, Eq, Default)]
pub struct Operators {
    /// AND.
    pub and: Conjunction,
    /// OR.
    pub or: Disjunction,
    /// How a firing strength cuts or scales a consequent.
    pub implication: Implication,
    /// How the consequents of one output join.
    pub aggregation: Aggregation,
}

/// A rule and where it came from.
///
/// # Example: provenance is no weight
/// ```
/// let text = "fuzzy: 1
/// name: fan
/// inputs: {heat: {range: [0, 100], partition: [low, high]}}
/// outputs: {speed: {range: [0, 9], partition: [slow, fast]}}
/// rules: [{rule: IF heat IS high THEN speed IS fast WITH 0.9, confidence: 0.4, support: 12}]";
/// let rule = &fuzzy::yaml::parse(text)?.model.rules[0];
/// assert_eq!((rule.rule.weight, rule.confidence, rule.support), (0.9, Some(0.4), Some(12)));
/// # Ok::<(), Box<dyn std::error::Error>>(())
/// ```
#[derive(Debug, Clone, PartialEq)]
pub struct Rule {
    /// The rule itself, with its weight.
    pub rule: rule::Rule,
    /// How sure its source is of it, in [0, 1]: provenance, not a weight.
    pub confidence: Option<f64>,
    /// How many samples stand behind it.
    pub support: Option<u64>,
    /// The consequents it beat, with their degrees.
    pub against: Vec<Beaten>,
    /// The author's note.
    pub note: Option<String>,
}

/// A consequent that lost against the one in the rule, when the rule was learned.
///
/// # Example: what was said against a rule
/// ```
/// use fuzzy::model::Beaten;
///
/// # let text = "fuzzy: 1
/// # name: fan
/// # inputs: {heat: {range: [0, 100], partition: [low, high]}}
/// # outputs: {speed: {range: [0, 9], partition: [slow, fast]}}
/// # rules: []";
/// # let model = fuzzy::yaml::parse(text)?.model;
/// # let mut learner = fuzzy::learn::Learner::new(&model, Default::default())?;
/// learner.add(&[100.0, 9.0], 1.0)?;
/// learner.add(&[75.0, 0.0], 1.0)?;
/// let against = &learner.finish().model.rules[0].against;
/// assert_eq!(against[..], [Beaten { term: "slow".into(), degree: 0.75, support: 1 }]);
/// # Ok::<(), Box<dyn std::error::Error>>(())
/// ```
#[derive(Debug, Clone, PartialEq)]
pub struct Beaten {
    /// The term that lost.
    pub term: String,
    /// Its degree.
    pub degree: f64,
    /// How many samples stood behind it.
    pub support: u64,
}
