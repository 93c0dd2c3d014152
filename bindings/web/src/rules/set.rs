//! A compiled rule set: its values, explanations, maps and pictures.

use flagred::gap::Filling;
use flagred_authoring::{
    Document,
    answers::Explained,
    slice::{self, Mapped},
};
use fuzzy::{
    Engine, Model,
    drawing::{
        Axis, Scale, Slice, explanation_svg, map_svg, rules_svg, surface_svg, variables_svg,
    },
    engine::{Outcome, State},
    map::{DecisionMap, Grid},
    model::Variable,
};
use serde::Serialize;
use wasm_bindgen::{JsError, prelude::wasm_bindgen};

use super::{exchange::refused, json, single::Memory};
use crate::failure::failure;

/// The number of points of the curve of a rule set with one input.
const CURVE_POINTS: usize = 401;

/// A compiled rule set.
#[wasm_bindgen(js_name = RuleSet)]
pub struct RuleSet {
    pub(super) engine: Engine,
    /// For a profile: its output, the filling of the gaps of its rules, and the name of the method.
    profile: Option<(usize, Filling, &'static str)>,
    /// The memory for evaluating single values; it is allocated when the first one is requested.
    pub(super) memory: Option<Memory>,
}

/// The content of a map: the output, one or two inputs as axes with the parts of their ranges that are shown, the
/// number of points along each axis, and the fixed values of the other inputs.
#[wasm_bindgen(js_name = View)]
#[derive(Debug, Clone)]
pub struct View {
    output: usize,
    axes: Vec<(usize, Scale)>,
    points: usize,
    fixed: Vec<f64>,
}

#[wasm_bindgen(js_class = View)]
impl View {
    /// Creates a view. `axes` contains for each axis the index of its input and the ends of the part to show.
    #[wasm_bindgen(constructor)]
    pub fn new(output: usize, axes: &[f64], points: usize, fixed: Vec<f64>) -> View {
        let axes = axes.chunks_exact(3).take(2);
        let axes = axes.map(|axis| match axis {
            [input, low, high] => (*input as usize, Scale::new(*low, *high)),
            _ => (usize::MAX, Scale::new(0.0, 1.0)),
        });
        View {
            output,
            axes: axes.collect(),
            points: points.clamp(2, 1001),
            fixed,
        }
    }
}

#[derive(Serialize)]
#[serde(rename_all = "camelCase")]
struct VariableOverview<'a> {
    name: &'a str,
    description: Option<&'a str>,
    unit: Option<&'a str>,
    low: f64,
    high: f64,
    /// The part of the range to show: the whole range, or only the part in which the terms' degrees change, with a
    /// margin, if that part is small.
    shown: [f64; 2],
}

impl<'a> VariableOverview<'a> {
    fn new(variable: &'a Variable) -> VariableOverview<'a> {
        let shown = slice::shown(variable);
        VariableOverview {
            name: &variable.name,
            description: variable.description.as_deref(),
            unit: variable.unit.as_deref(),
            low: variable.low,
            high: variable.high,
            shown: [shown.low, shown.high],
        }
    }
}

#[derive(Serialize)]
struct RuleSetOverview<'a> {
    name: &'a str,
    inputs: Vec<VariableOverview<'a>>,
    outputs: Vec<VariableOverview<'a>>,
    rules: Vec<String>,
    /// The index of the output that a profile uses as its risk.
    output: usize,
    /// The method by which a profile fills gaps between the rules.
    filling: Option<&'a str>,
}

#[derive(Serialize)]
#[serde(rename_all = "camelCase")]
struct Value<'a> {
    name: &'a str,
    value: Option<f64>,
    /// The lower end of the interval of an output that depends on interval type-2 terms; otherwise absent.
    #[serde(skip_serializing_if = "Option::is_none")]
    low: Option<f64>,
    /// The upper end of that interval.
    #[serde(skip_serializing_if = "Option::is_none")]
    high: Option<f64>,
    is_default: bool,
    coverage: f64,
    /// The number of the dominant rule, from 1.
    dominant_rule: Option<usize>,
    clamped: bool,
}

#[wasm_bindgen(js_class = RuleSet)]
impl RuleSet {
    /// Compiles a rule set in YAML, FIS, FLL, FCL or FML, or the rule set of a profile.
    #[wasm_bindgen(constructor)]
    pub fn new(text: &str) -> Result<RuleSet, JsError> {
        RuleSet::of(&super::text::document(text))
    }

    /// The rule set's name, inputs, outputs and rules, as JSON.
    pub fn about(&self) -> Result<String, JsError> {
        let model = self.model();
        let outputs = model.outputs.iter().map(|output| &output.variable);
        json(&RuleSetOverview {
            name: &model.name,
            inputs: model.inputs.iter().map(VariableOverview::new).collect(),
            outputs: outputs.map(VariableOverview::new).collect(),
            rules: model
                .rules
                .iter()
                .map(|rule| rule.rule.to_string())
                .collect(),
            output: self.profile.as_ref().map_or(0, |(output, ..)| *output),
            filling: self.profile.as_ref().map(|(_, _, method)| *method),
        })
    }

    /// The outputs at a point, as a JSON array.
    pub fn evaluate(&self, point: &[f64]) -> Result<String, JsError> {
        let outcomes = self
            .engine
            .evaluate(point)
            .map_err(|error| failure(error, None))?;
        let names = self.engine.output_names();
        let value = |(name, outcome): (_, &Outcome)| {
            let (low, high) = match outcome.state {
                State::Interval { low, high } => (Some(low), Some(high)),
                _ => (None, None),
            };
            Value {
                name,
                value: outcome.value(),
                low,
                high,
                is_default: matches!(outcome.state, State::Default(_)),
                coverage: outcome.coverage,
                dominant_rule: outcome.dominant_rule.map(|rule| rule + 1),
                clamped: outcome.clamped,
            }
        };
        json(&names.zip(&outcomes).map(value).collect::<Vec<_>>())
    }

    /// The outputs of many rows. `columns` contains the columns of the inputs one after another; the result
    /// contains the columns of the outputs in the same way. NaN means unknown.
    #[wasm_bindgen(js_name = evaluateColumns)]
    pub fn evaluate_columns(&self, columns: &[f64]) -> Result<Vec<f64>, JsError> {
        let inputs = self.engine.input_names().len();
        let rows = columns.len() / inputs.max(1);
        if rows == 0 {
            return Ok(Vec::new());
        }
        let columns: Vec<&[f64]> = columns.chunks(rows).collect();
        let mut values = vec![0.0; rows * self.engine.output_names().len()];
        let mut outputs: Vec<&mut [f64]> = values.chunks_mut(rows).collect();
        let evaluated = self.engine.evaluate_columns(&columns, &mut outputs);
        evaluated.map_err(|error| failure(error, None))?;
        Ok(values)
    }

    /// The document of `flagred explain --json`.
    pub fn explain(&self, point: &[f64]) -> Result<String, JsError> {
        let explanation = self.engine.explain(point);
        let explanation = explanation.map_err(|error| failure(error, None))?;
        let silent = self.engine.silent(&explanation);
        let silent = silent.map_err(|error| failure(error, None))?;
        let changes = self.engine.what_if(point);
        let changes = changes.map_err(|error| failure(error, None))?;
        json(&Explained::new(&self.model().name, &explanation).with_reasons(silent, changes))
    }

    /// Chooses a value for each input that is not an axis: the one in `fixed` if it is finite; otherwise the middle
    /// of the range, or the peak of a term if the output varies more there.
    #[wasm_bindgen(js_name = held)]
    pub fn fixed_values(&self, output: usize, axes: &[usize], fixed: &[f64]) -> Vec<f64> {
        let fixed: Vec<Option<f64>> = fixed.iter().map(|x| x.is_finite().then_some(*x)).collect();
        let x = axes.first().copied().unwrap_or(0);
        slice::fixed_values(&self.mapped(output), &fixed, (x, axes.get(1).copied()))
    }

    /// The cells of a map: all values, then all coverages, then the numbers of the dominant rules, then whether the
    /// value was filled (1 or 0). In each of these lists, the point of the second axis varies fastest. NaN is unknown.
    pub fn map(&self, view: &View) -> Result<Vec<f64>, JsError> {
        let cells = self.slice(view)?.cells;
        let number = |rule: Option<usize>| rule.map_or(f64::NAN, |rule| rule as f64 + 1.0);
        let values = cells.iter().map(|cell| cell.value.unwrap_or(f64::NAN));
        let coverages = cells.iter().map(|cell| cell.coverage);
        let rules = cells.iter().map(|cell| number(cell.rule));
        let filled = cells
            .iter()
            .map(|cell| f64::from(u8::from(cell.filled_from.is_some())));
        Ok(values.chain(coverages).chain(rules).chain(filled).collect())
    }

    /// The picture of `flagred map`; `kind` is `map`, `surface` or `rules`.
    #[wasm_bindgen(js_name = mapSvg)]
    pub fn map_svg(&self, kind: &str, view: &View) -> Result<String, JsError> {
        let slice = self.slice(view)?;
        match kind {
            "map" => Ok(map_svg(&slice)),
            "rules" => Ok(rules_svg(&slice, self.model())),
            "surface" => surface_svg(&slice)
                .ok_or_else(|| failure("a surface needs two inputs, but only one is left", None)),
            _ => {
                let help = "write `map`, `surface` or `rules`";
                Err(failure(
                    format!("`{kind}` is not a kind of picture"),
                    Some(help),
                ))
            }
        }
    }

    /// The picture of `flagred plot`.
    #[wasm_bindgen(js_name = termsSvg)]
    pub fn terms_svg(&self) -> Result<String, JsError> {
        let model = self.model();
        let mut curves = Vec::new();
        for output in 0..model.outputs.len() {
            if model.inputs.len() == 1 {
                let grid = Grid::new(&self.engine, CURVE_POINTS);
                let grid = grid.map_err(|error| failure(error, None))?;
                let map = DecisionMap::new(&self.engine, grid, output);
                let map = map.map_err(|error| failure(error, None))?;
                curves.extend(Slice::new(model, &map));
            }
        }
        Ok(variables_svg(model, &curves))
    }

    /// The picture of `flagred explain`.
    #[wasm_bindgen(js_name = explanationSvg)]
    pub fn explanation_svg(&self, point: &[f64]) -> Result<String, JsError> {
        let explanation = self.engine.explain(point);
        let explanation = explanation.map_err(|error| failure(error, None))?;
        Ok(explanation_svg(self.model(), &explanation))
    }

    fn model(&self) -> &Model {
        self.engine.model()
    }

    fn mapped(&self, output: usize) -> Mapped<'_> {
        let filling = self.profile.as_ref();
        let filling = filling.filter(|(risk, ..)| *risk == output);
        Mapped {
            model: self.model(),
            engine: &self.engine,
            output,
            filling: filling.map(|(_, filling, method)| (filling, *method)),
        }
    }

    /// Compiles an open text.
    pub(super) fn of(document: &Document) -> Result<RuleSet, JsError> {
        if !document.is_profile() {
            let engine = document.source().engine().map_err(refused)?.clone();
            let profile = None;
            let memory = None;
            return Ok(RuleSet {
                engine,
                profile,
                memory,
            });
        }
        let estimator = document.estimator();
        let estimator = estimator.ok_or_else(|| refused(document.findings().clone()))?;
        let engine = estimator.engine().clone();
        let profile = estimator.profile();
        let output = engine.output(&profile.output).unwrap_or(0);
        let filling = Filling::new(&engine, engine.model(), output, &profile.gap);
        let filling = filling.map_err(|error| failure(error, None))?;
        Ok(RuleSet {
            profile: Some((output, filling, profile.gap.method.name())),
            engine,
            memory: None,
        })
    }

    fn slice(&self, view: &View) -> Result<Slice, JsError> {
        let inputs = &self.model().inputs;
        let axis = |(input, part): &(usize, Scale)| {
            let variable = inputs.get(*input)?;
            Some((*input, Axis::new(variable, *part, view.points)))
        };
        let mut axes = view.axes.iter().filter_map(axis);
        let x = axes.next();
        let x = x.ok_or_else(|| failure("a map needs an input along an axis", None))?;
        let cut = slice::cut(
            &self.mapped(view.output),
            x,
            axes.next(),
            view.fixed.clone(),
        );
        cut.map_err(|error| failure(error, None))
    }
}
