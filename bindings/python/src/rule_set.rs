//! Rule sets: reading, editing, and evaluation, compiled at first use.

use std::sync::{Arc, PoisonError, RwLock};

use flagred_authoring::rewrite::rewritten;
use flagred_cli::Language;
use flagred_interchange::{Format, Losses};
use fuzzy::{
    Findings, Model,
    check::{self, Direction, Monotone},
    diagnostic::{Severity, quoted, suggest},
    drawing::variables_svg,
    format,
    map::Grid,
    model::MembershipFunction,
    rule,
    tree::Node,
    yaml,
};
use numpy::{IntoPyArray, PyArrayDyn, PyReadonlyArray1, PyReadonlyArrayDyn};
use pyo3::{
    IntoPyObjectExt,
    exceptions::{PyIndexError, PyKeyError},
    prelude::*,
    sync::PyOnceLock,
    types::{PyDict, PyTuple},
};

use crate::{
    compiled::Inputs,
    errors::{data_error, diagnostics, rule_set_error},
    explained_rows::explained_rows,
    explanation::Explanation,
    map::DecisionMap,
    source::Source,
    table::Table,
    threads::{count, interruptible, pool},
};

/// A rule set, inside `flagred.Model`.
#[pyclass(frozen, subclass, module = "flagred._core")]
pub(crate) struct RuleSet {
    current: RwLock<Arc<Source>>,
}

type RuleParts = (String, f64, Option<f64>, Option<u64>, Option<String>);

impl RuleSet {
    fn source(&self) -> Arc<Source> {
        let current = self.current.read();
        Arc::clone(&current.unwrap_or_else(PoisonError::into_inner))
    }

    fn replace(&self, source: Arc<Source>) {
        let mut current = self.current.write().unwrap_or_else(PoisonError::into_inner);
        *current = source;
    }

    pub(crate) fn model<T>(&self, of: impl FnOnce(&Model) -> T) -> T {
        of(&self.source().document.model)
    }

    /// The text that was read, or the result of edits.
    pub(crate) fn text(&self) -> String {
        self.source().text.clone()
    }

    /// Compiles the rule set, unless it is already compiled.
    pub(crate) fn compile(&self, py: Python<'_>) -> PyResult<()> {
        self.source().compiled(py).map(|_| ())
    }
}

/// Names of inputs: a list, or one name.
fn names(value: &Bound<'_, PyAny>) -> PyResult<Vec<String>> {
    if let Ok(one) = value.extract::<String>() {
        return Ok(vec![one]);
    }
    value.extract().map_err(|_| {
        let shown = value
            .repr()
            .map_or_else(|_| "?".into(), |text| text.to_string());
        let message = format!("{} is not a list of inputs", quoted(&shown));
        data_error(message, Some("write `rising=[\"service\"]`".into()))
    })
}

/// Evaluates the arguments of a Python call. Returns the values, or the outcomes if `with_reasons`.
fn evaluate_call<'py>(
    rule_set: &Bound<'py, RuleSet>,
    args: &Bound<'py, PyTuple>,
    named: Option<&Bound<'py, PyDict>>,
    threads: Option<usize>,
    with_reasons: bool,
) -> PyResult<Bound<'py, PyAny>> {
    let (py, source) = (rule_set.py(), rule_set.get().source());
    let compiled = source.compiled(py)?;
    match compiled.requested(py, args, named)? {
        Inputs::Numbers(numbers) => compiled.point(py, &numbers, with_reasons),
        Inputs::Arrays(values) => compiled.arrays(py, &values, threads, with_reasons),
        Inputs::Frame(frame) => by_frame(rule_set, frame, threads, with_reasons),
    }
}

/// Calls a Python function that evaluates a frame and returns a frame of the same library.
fn by_frame<'py>(
    rule_set: &Bound<'py, RuleSet>,
    frame: Bound<'py, PyAny>,
    threads: Option<usize>,
    with_reasons: bool,
) -> PyResult<Bound<'py, PyAny>> {
    static EVALUATE: PyOnceLock<Py<PyAny>> = PyOnceLock::new();
    let evaluate = EVALUATE.import(rule_set.py(), "flagred._frames", "evaluate")?;
    evaluate.call1((rule_set, frame, threads, with_reasons))
}

/// Returns the language with the given name.
pub(crate) fn language(name: &str) -> Option<Language> {
    match name {
        "rust" => Some(Language::Rust),
        "c" => Some(Language::C),
        "lua" => Some(Language::Lua),
        _ => None,
    }
}

#[pymethods]
impl RuleSet {
    #[new]
    #[pyo3(signature = (text, file = "<text>", unfinished = false))]
    fn new(py: Python<'_>, text: String, file: &str, unfinished: bool) -> PyResult<Self> {
        let source = Source::read(py, text, file, unfinished)?;
        Ok(RuleSet {
            current: RwLock::new(source),
        })
    }

    fn _name(&self) -> String {
        self.model(|model| model.name.clone())
    }

    fn _description(&self) -> Option<String> {
        self.model(|model| model.description.clone())
    }

    fn _rule_count(&self) -> usize {
        self.model(|model| model.rules.len())
    }

    /// Text, weight, confidence, support and note of a rule.
    fn _rule(&self, index: usize) -> PyResult<RuleParts> {
        let parts = |rule: &fuzzy::model::Rule| {
            let text = rule.rule.to_string();
            (
                text,
                rule.rule.weight,
                rule.confidence,
                rule.support,
                rule.note.clone(),
            )
        };
        let rule = self.model(|model| model.rules.get(index).map(parts));
        rule.ok_or_else(|| PyIndexError::new_err("there is no such rule"))
    }

    /// The text of a rule with another weight.
    #[staticmethod]
    fn _weighted(py: Python<'_>, text: &str, weight: f64) -> PyResult<String> {
        let rule = rule::parse(text).map_err(|finding| {
            rule_set_error(py, &Findings::locate(vec![*finding], text), "<rule>", text)
        });
        Ok(rule?.with(weight).to_string())
    }

    /// The names of the inputs, in the order of their values.
    fn _input_names(&self) -> Vec<String> {
        self.model(|model| {
            model
                .inputs
                .iter()
                .map(|input| input.name.clone())
                .collect()
        })
    }

    /// The names of the outputs.
    fn _output_names(&self) -> Vec<String> {
        let name = |output: &fuzzy::model::Output| output.variable.name.clone();
        self.model(|model| model.outputs.iter().map(name).collect())
    }

    /// The names of the outputs that depend on type-2 terms and therefore have an interval.
    fn _interval_names(&self) -> Vec<String> {
        let name = |output: &fuzzy::model::Output| output.variable.name.clone();
        self.model(|model| {
            let outputs = model.outputs.iter();
            let outputs = outputs.filter(|output| model.has_interval(output));
            outputs.map(name).collect()
        })
    }

    /// The names of the variables with values in rows of data: the inputs, and the measured output.
    fn _measured_names(&self) -> Vec<String> {
        let name = |variable: &fuzzy::model::Variable| variable.name.clone();
        self.model(|model| model.measured_variables().map(name).collect())
    }

    /// The text that was read, and the name of its file.
    fn _text(&self) -> (String, String) {
        let source = self.source();
        (source.text.clone(), source.file.clone())
    }

    /// The model as a document, in JSON.
    fn _json(&self) -> PyResult<String> {
        let json = self.model(|model| serde_json::to_string(&format::write(model)));
        json.map_err(|error| data_error(error, None))
    }

    /// The model in JSON, with lists of named entries instead of objects, so that the order of the entries is preserved
    /// if a program sorts the keys of objects.
    fn _json_lists(&self) -> PyResult<String> {
        let json = self.model(serde_json::to_string);
        json.map_err(|error| data_error(error, None))
    }

    /// Replaces the model by a document in JSON; comments of the text are kept where possible. Nothing changes if the
    /// document has errors.
    fn _edit(&self, py: Python<'_>, json: &str) -> PyResult<()> {
        let tree: Result<Node, _> = serde_json::from_str(json);
        let text = yaml::to_text(&tree.map_err(|error| data_error(error, None))?);
        let (before, edited) = (self.source(), Source::read(py, text, "<model>", true)?);
        let text = rewritten(&before.text, &before.document, &edited.document.model);
        self.replace(Source::read(py, text, "<model>", true)?);
        Ok(())
    }

    /// Returns the text to save in the given format, and warnings. If the current text is already in this format, it is
    /// returned unchanged.
    #[pyo3(signature = (format, lossy = false))]
    fn _to_text(
        &self,
        py: Python<'_>,
        format: &str,
        lossy: bool,
    ) -> PyResult<(String, Vec<String>)> {
        let source = self.source();
        if let Some(language) = language(format) {
            let model = &source.document.model;
            let code = flagred_cli::export_rules(model, language, lossy);
            return code.map_err(|error| data_error(error, None));
        }
        let known = Format::ALL
            .into_iter()
            .find(|known| known.ending() == format);
        if Format::of(&source.text) == known && !source.text.is_empty() {
            return Ok((source.text.clone(), Vec::new()));
        }
        let model = &source.document.model;
        let Some(known) = known else {
            return Ok((yaml::to_string(model), Vec::new()));
        };
        let losses = match lossy {
            true => Losses::Accept,
            false => Losses::Refuse,
        };
        match flagred_interchange::write(model, known, losses) {
            Ok(written) => {
                let warnings = written.findings.0.iter();
                let warnings = warnings.filter(|finding| finding.severity == Severity::Warning);
                Ok((written.text, warnings.map(|w| w.message.clone()).collect()))
            }
            Err(findings) => Err(rule_set_error(py, &findings, &source.file, &source.text)),
        }
    }

    /// Returns the names of the terms of a variable.
    fn _term_names(&self, variable: &str) -> Vec<String> {
        self.model(|model| {
            let terms = model.variables().find(|known| known.name == variable);
            let terms = terms.into_iter().flat_map(|variable| &variable.terms);
            terms.map(|term| term.name.clone()).collect()
        })
    }

    /// The degrees of membership of values in a term. Values outside the range of the variable are clamped.
    fn _degrees<'py>(
        &self,
        variable: &str,
        term: &str,
        values: PyReadonlyArrayDyn<'py, f64>,
    ) -> PyResult<Bound<'py, PyArrayDyn<f64>>> {
        let py = values.py();
        let source = self.source();
        let model = &source.document.model;
        let outputs = model.outputs.iter().map(|output| &output.variable);
        let variable = model
            .inputs
            .iter()
            .chain(outputs)
            .find(|v| v.name == variable);
        let variable = variable.ok_or_else(|| PyKeyError::new_err("there is no such variable"))?;
        let found = variable.terms.iter().find(|known| known.name == term);
        let function = &found
            .ok_or_else(|| PyKeyError::new_err(term.to_owned()))?
            .membership_function;
        if matches!(function, MembershipFunction::Linear { .. }) {
            let message = format!("the term `{term}` is a linear consequent and has no degrees");
            return Err(data_error(message, None));
        }
        let (low, high, values) = (variable.low, variable.high, values.as_array());
        let degree = |value: &f64| match value.is_nan() {
            true => f64::NAN,
            false => function.membership(value.clamp(low, high)),
        };
        Ok(values.map(degree).into_pyarray(py))
    }

    /// Returns a line for each rule that contributes to a row: the numbers of the row, the output
    /// and the rule, the strength, the share, and the dominant rule of the row. `columns` are in
    /// the order of the inputs. A row with an unknown input has no rules.
    fn _explain_rows<'py>(
        &self,
        py: Python<'py>,
        columns: Vec<PyReadonlyArray1<'py, f64>>,
    ) -> PyResult<Bound<'py, PyDict>> {
        let source = self.source();
        let compiled = Arc::clone(source.compiled(py)?);
        explained_rows(py, compiled, &columns)
    }

    /// Makes `other` an independent copy of this model: editing one of them does not change the other one.
    fn _share(&self, other: &RuleSet) {
        self.replace(other.source());
    }

    fn _equals(&self, other: &RuleSet) -> bool {
        self.source().document.model == other.source().document.model
    }

    /// The rule set in YAML, without the comments of the file.
    fn to_yaml(&self) -> String {
        self.model(yaml::to_string)
    }

    /// Evaluates the rule set and returns the values.
    ///
    /// Parameters
    /// ----------
    /// values
    ///     A number for each input, in their order or by their names: ``model(8, 9)``, ``model(service=8, food=9)``,
    ///     ``model({"service": 8, "food": 9})``. Or arrays that broadcast against each other. Or one frame with a column for
    ///     each input: pandas, polars, pyarrow, DuckDB, or any other library that exports Arrow data. None, null and NaN are
    ///     unknown.
    /// threads
    ///     The number of threads for arrays and frames; by default the number of cores.
    ///
    /// Returns
    /// -------
    /// float, numpy.ndarray or frame
    ///     The value of the output; NaN if it is unknown, null in frames. With several outputs, a dict by their names. For a
    ///     frame, a frame of the same library.
    ///
    /// Raises
    /// ------
    /// DataError
    ///     An input has no value, a name is not an input, or a value is not a number.
    /// RuleSetError
    ///     The rule set is not finished, or has errors.
    #[pyo3(signature = (*args, threads = None, **named))]
    fn __call__<'py>(
        slf: &Bound<'py, Self>,
        args: &Bound<'py, PyTuple>,
        #[pyo3(from_py_with = count)] threads: Option<usize>,
        named: Option<&Bound<'py, PyDict>>,
    ) -> PyResult<Bound<'py, PyAny>> {
        evaluate_call(slf, args, named, threads, false)
    }

    /// Evaluates the rule set and returns the values with their reasons.
    ///
    /// Parameters
    /// ----------
    /// values
    ///     As in a call of the model.
    /// threads
    ///     As in a call of the model.
    ///
    /// Returns
    /// -------
    /// Outcome, Outcomes or frame
    ///     The value, the coverage, the dominant rule, and whether an input was clamped: for a point as one outcome,
    ///     for arrays as arrays, for a frame as its columns. Outputs that depend on type-2 terms also have the ends of
    ///     their interval, ``low`` and ``high``; in a frame, the output ``tip`` then has the columns ``tip_low`` and
    ///     ``tip_high``. With several outputs, a dict by their names.
    ///
    /// Examples
    /// --------
    /// >>> model.evaluate(service=8, food=9)
    /// Outcome(value=18.394444444444446, coverage=0.9, dominant_rule=3, clamped=False, state='defined')
    #[pyo3(signature = (*args, threads = None, **named))]
    fn evaluate<'py>(
        slf: &Bound<'py, Self>,
        args: &Bound<'py, PyTuple>,
        #[pyo3(from_py_with = count)] threads: Option<usize>,
        named: Option<&Bound<'py, PyDict>>,
    ) -> PyResult<Bound<'py, PyAny>> {
        evaluate_call(slf, args, named, threads, true)
    }

    /// Evaluates the rule set for inputs that are known only as intervals.
    ///
    /// Parameters
    /// ----------
    /// values
    ///     A number, or a pair ``(low, high)``, for each input, in their order or by their names.
    ///
    /// Returns
    /// -------
    /// IntervalOutcome
    ///     An interval that contains every value of the output for inputs inside these intervals, and whether the
    ///     output may have no value. With several outputs, a dict by their names.
    ///
    /// Raises
    /// ------
    /// DataError
    ///     An input has no value, an end is not a finite number, or the ends are in the wrong order.
    ///
    /// Examples
    /// --------
    /// >>> tip = model.evaluate_interval(service=(7.5, 8.5), food=9)
    /// >>> tip.low < model(7.5, 9) < model(8.5, 9) < tip.high
    /// True
    #[pyo3(signature = (*args, **named))]
    fn evaluate_interval<'py>(
        slf: &Bound<'py, Self>,
        args: &Bound<'py, PyTuple>,
        named: Option<&Bound<'py, PyDict>>,
    ) -> PyResult<Bound<'py, PyAny>> {
        let (py, source) = (slf.py(), slf.get().source());
        source.compiled(py)?.intervals(py, args, named)
    }

    /// Evaluates a table from Arrow's C interface.
    #[pyo3(signature = (frame, threads = None, with_reasons = false))]
    fn _table(
        &self,
        py: Python<'_>,
        frame: &Bound<'_, PyAny>,
        #[pyo3(from_py_with = count)] threads: Option<usize>,
        with_reasons: bool,
    ) -> PyResult<Table> {
        let source = self.source();
        let compiled = source.compiled(py)?;
        compiled.table(frame, threads, with_reasons)
    }

    /// Explains the outputs at a point, or at each row of a frame.
    ///
    /// Parameters
    /// ----------
    /// values
    ///     A number for each input, in their order or by their names. Or one frame with a column for each input.
    ///
    /// Returns
    /// -------
    /// Explanation or frame
    ///     For a point, the degree of each term, the rules that fired and their shares; Jupyter draws it, ``print`` prints it.
    ///     For a frame, a frame of the same library with a row for each rule that contributes to an output of a row: ``row``,
    ///     ``output``, ``rule``, ``strength``, ``share`` and the ``dominant_rule`` of that row and output. A row with an
    ///     unknown input has no rules.
    ///
    /// Raises
    /// ------
    /// DataError
    ///     An input has no value, or is not a finite number.
    #[pyo3(signature = (*args, **named))]
    fn explain<'py>(
        slf: &Bound<'py, Self>,
        args: &Bound<'py, PyTuple>,
        named: Option<&Bound<'py, PyDict>>,
    ) -> PyResult<Bound<'py, PyAny>> {
        static EXPLAIN: PyOnceLock<Py<PyAny>> = PyOnceLock::new();
        let (py, source) = (slf.py(), slf.get().source());
        let compiled = source.compiled(py)?;
        let numbers = match compiled.requested(py, args, named)? {
            Inputs::Numbers(numbers) => numbers,
            Inputs::Frame(frame) => {
                let explain = EXPLAIN.import(py, "flagred._frames", "explain")?;
                return explain.call1((slf, frame));
            }
            Inputs::Arrays(_) => {
                let help = "give a number for each input, or a frame with a column for each input";
                let message = "arrays cannot be explained";
                return Err(data_error(message, Some(help.into())));
            }
        };
        let explanation = compiled.engine.explain(&numbers);
        let explanation = explanation.map_err(|error| data_error(error, None))?;
        Explanation::new(py, explanation, Arc::clone(compiled))?.into_bound_py_any(py)
    }

    /// Evaluates an output over a grid of the inputs.
    ///
    /// Parameters
    /// ----------
    /// points
    ///     The number of points along each axis, from one end of the range to the other.
    /// output
    ///     The output; by default the first.
    /// threads
    ///     The number of threads; by default the number of cores.
    /// fixed
    ///     Inputs with a fixed value, by their names. The axes are the inputs without one.
    ///
    /// Returns
    /// -------
    /// DecisionMap
    ///     Values, coverage and dominant rules as arrays. Jupyter draws one or two axes.
    ///
    /// Raises
    /// ------
    /// DataError
    ///     There is no such input or output, or the grid is too large.
    #[pyo3(signature = (*, points = 51, output = None, threads = None, **fixed))]
    fn map(
        &self,
        py: Python<'_>,
        points: usize,
        output: Option<&str>,
        #[pyo3(from_py_with = count)] threads: Option<usize>,
        fixed: Option<&Bound<'_, PyDict>>,
    ) -> PyResult<DecisionMap> {
        let source = self.source();
        let compiled = Arc::clone(source.compiled(py)?);
        let engine = &compiled.engine;
        let grid_error = |error| data_error(error, None);
        let mut grid = Grid::new(engine, points).map_err(grid_error)?;
        for (name, value) in fixed.into_iter().flatten() {
            let name: String = name.extract()?;
            if engine.input(&name).is_none() {
                let message = format!("there is no input `{name}`");
                return Err(data_error(message, suggest(&name, engine.input_names())));
            }
            grid = grid.fix(&name, value.extract()?).map_err(grid_error)?;
        }
        let output = match output {
            None => 0,
            Some(name) => engine.output(name).ok_or_else(|| {
                let message = format!("there is no output `{name}`");
                data_error(message, suggest(name, engine.output_names()))
            })?,
        };
        let pool = pool(threads)?;
        interruptible(py, move || {
            pool.install(|| DecisionMap::new(compiled, grid, output))
        })?
    }

    /// Checks the rules for gaps, contradictions and jumps.
    ///
    /// Parameters
    /// ----------
    /// coverage
    ///     The firing strength that at least one rule should reach everywhere.
    /// rising, falling
    ///     Inputs. When an input in ``rising`` rises, no output may fall; when an input in ``falling`` rises, no
    ///     output may rise. Write ``["service"]``, or ``["service:tip"]`` for one of several outputs.
    ///
    /// Returns
    /// -------
    /// list of Diagnostic
    ///     The findings in the order of the text; ``str()`` shows one with its source lines.
    #[pyo3(signature = (*, coverage = 0.5, rising = Vec::new(), falling = Vec::new()))]
    fn check<'py>(
        &self,
        py: Python<'py>,
        coverage: f64,
        #[pyo3(from_py_with = names)] rising: Vec<String>,
        #[pyo3(from_py_with = names)] falling: Vec<String>,
    ) -> PyResult<Vec<Bound<'py, PyAny>>> {
        let mut options = check::Options::default();
        options.coverage = coverage;
        let rising = rising
            .iter()
            .map(|claim| Monotone::new(claim, Direction::Increasing));
        let falling = falling
            .iter()
            .map(|claim| Monotone::new(claim, Direction::Decreasing));
        options.monotone = rising.chain(falling).collect();
        let source = self.source();
        let compiled = match source.compile(py) {
            Ok(compiled) => Arc::clone(compiled),
            Err(findings) => return diagnostics(py, findings, &source.file, &source.text),
        };
        let checked = Arc::clone(&source);
        let checked = interruptible(py, move || {
            let Source { document, text, .. } = &*checked;
            check::document(document, &compiled.engine, text, &options)
        })?;
        let (findings, _) =
            checked.map_err(|finding| data_error(&finding.message, finding.help.clone()))?;
        diagnostics(py, &findings, &source.file, &source.text)
    }

    /// The terms of all variables, as SVG.
    fn _variables_svg(&self) -> String {
        self.model(|model| variables_svg(model, &[]))
    }
}
