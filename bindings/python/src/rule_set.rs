//! Rule sets: read, edited, compiled when they are first used, and asked.

use std::{
    cell::RefCell,
    sync::{
        Arc, OnceLock, PoisonError, RwLock,
        atomic::{AtomicU64, Ordering},
    },
};

use fuzzy::{
    Engine, Findings, Model,
    check::{self, Monotone},
    diagnostic::suggest,
    drawing::variables_svg,
    engine::{Outcome as Raw, Scratch},
    format::{self, Document},
    map::Grid,
    rule,
    tree::Node,
    validate, yaml,
};
use numpy::{IntoPyArray, PyArrayMethods};
use pyo3::{
    IntoPyObjectExt,
    exceptions::PyIndexError,
    prelude::*,
    sync::PyOnceLock,
    types::{PyDict, PyFloat, PyInt, PyString, PyTuple},
};

use crate::{
    arrays::Arrays,
    arrow,
    errors::{data_error, diagnostics, rule_set_error},
    evaluate::Evaluator,
    explanation::Explanation,
    map::DecisionMap,
    outcome::{Outcome, Outcomes},
    table::{self, Table},
    threads::{interruptible, pool},
};

/// A rule set. `flagred.Model` is made of it.
#[pyclass(frozen, subclass, module = "flagred._core")]
pub(crate) struct RuleSet {
    current: RwLock<Arc<Source>>,
}

/// A rule set as it was read; an edit makes another.
struct Source {
    file: String,
    text: String,
    document: Document,
    compiled: OnceLock<Result<Arc<Compiled>, Findings>>,
}

/// A rule set that can be evaluated.
pub(crate) struct Compiled {
    /// No other has it, as long as the process lives.
    id: u64,
    pub(crate) engine: Engine,
    inputs: Vec<Py<PyString>>,
}

type RuleParts = (String, f64, Option<f64>, Option<u64>, Option<String>);

/// What each thread keeps for single evaluations, of the rule sets it used last.
struct Kept {
    id: u64,
    scratch: Scratch,
    outcomes: Vec<Raw>,
}

thread_local! {
    static KEPT: RefCell<Vec<Kept>> = const { RefCell::new(Vec::new()) };
}

const MOST_KEPT: usize = 8;

impl Source {
    fn new(file: String, text: String, document: Document) -> Arc<Source> {
        let compiled = OnceLock::new();
        Arc::new(Source {
            file,
            text,
            document,
            compiled,
        })
    }

    fn compile(&self, py: Python<'_>) -> Result<Arc<Compiled>, Findings> {
        static NEXT: AtomicU64 = AtomicU64::new(0);
        let invalid = validate(&self.document.model, &self.document.spans);
        if !invalid.is_empty() {
            return Err(Findings::locate(invalid, &self.text));
        }
        let engine = Engine::new(&self.document.model)?;
        let inputs = engine.input_names();
        Ok(Arc::new(Compiled {
            id: NEXT.fetch_add(1, Ordering::Relaxed),
            inputs: inputs
                .map(|name| PyString::intern(py, name).unbind())
                .collect(),
            engine,
        }))
    }

    /// The compiled rule set.
    fn compiled(&self, py: Python<'_>) -> PyResult<&Arc<Compiled>> {
        let compiled = self.compiled.get_or_init(|| self.compile(py));
        let drawn = |findings| rule_set_error(py, findings, &self.file, &self.text);
        compiled.as_ref().map_err(drawn)
    }
}

/// What is asked for: a number, or a value for each row.
enum Asked<'py> {
    /// In the order of the inputs.
    Numbers(Vec<f64>),
    /// In the order of the inputs.
    Arrays(Vec<Bound<'py, PyAny>>),
    /// A table, or a dict by the names of the inputs.
    Frame(Bound<'py, PyAny>),
}

impl RuleSet {
    fn source(&self) -> Arc<Source> {
        let current = self.current.read();
        Arc::clone(&current.unwrap_or_else(PoisonError::into_inner))
    }

    pub(crate) fn model<T>(&self, of: impl FnOnce(&Model) -> T) -> T {
        of(&self.source().document.model)
    }

    /// Compiles the rule set, where that is not done yet.
    pub(crate) fn compile(&self, py: Python<'_>) -> PyResult<()> {
        self.source().compiled(py).map(|_| ())
    }
}

impl Compiled {
    /// Arguments in the order of the inputs.
    fn asked<'py>(
        &self,
        py: Python<'py>,
        args: &Bound<'py, PyTuple>,
        named: Option<&Bound<'py, PyDict>>,
    ) -> PyResult<Asked<'py>> {
        // `model({"service": 8, "food": 9})`, for names that are no words of Python.
        let mapping = match named {
            None if args.len() == 1 => args.get_item(0)?.cast_into::<PyDict>().ok(),
            _ => None,
        };
        let values: Vec<Bound<'py, PyAny>> = match mapping.as_ref().or(named) {
            Some(named) if args.is_empty() || mapping.is_some() => self.by_name(py, named)?,
            Some(_) => {
                let help = "write `model(8, 9)` or `model(service=8, food=9)`".to_owned();
                return Err(data_error(
                    "values are given by place and by name",
                    Some(help),
                ));
            }
            _ => args.iter().collect(),
        };
        let numbers: Option<Vec<f64>> = values.iter().map(number).collect();
        match numbers {
            Some(numbers) => Ok(Asked::Numbers(numbers)),
            None => match values.as_slice() {
                [one] if named.is_none() && is_frame(py, one)? => Ok(Asked::Frame(one.clone())),
                _ => Ok(Asked::Arrays(values)),
            },
        }
    }

    fn by_name<'py>(
        &self,
        py: Python<'py>,
        named: &Bound<'py, PyDict>,
    ) -> PyResult<Vec<Bound<'py, PyAny>>> {
        let mut values = Vec::with_capacity(self.inputs.len());
        for name in &self.inputs {
            match named.get_item(name.bind(py))? {
                Some(value) => values.push(value),
                None => break,
            }
        }
        if values.len() == self.inputs.len() && values.len() == named.len() {
            return Ok(values);
        }
        let names = || self.engine.input_names();
        for key in named.keys() {
            let key: String = key.extract()?;
            if self.engine.input(&key).is_none() {
                let message = format!("there is no input `{key}`");
                return Err(data_error(message, suggest(&key, names())));
            }
        }
        let missing = names().find(|name| !named.contains(*name).unwrap_or(false));
        let message = format!("input `{}` has no value", missing.unwrap_or_default());
        Err(data_error(
            message,
            Some("None and NaN say that it is unknown".into()),
        ))
    }

    /// Evaluates one point.
    fn outcomes<T>(&self, numbers: &[f64], take: impl FnOnce(&[Raw]) -> T) -> PyResult<T> {
        KEPT.with_borrow_mut(|kept| {
            let at = match kept.iter().position(|kept| kept.id == self.id) {
                Some(at) => at,
                None => {
                    kept.truncate(MOST_KEPT - 1);
                    let outputs = self.engine.output_names().len();
                    let new = Kept {
                        id: self.id,
                        scratch: self.engine.scratch(),
                        outcomes: vec![Raw::default(); outputs],
                    };
                    kept.insert(0, new);
                    0
                }
            };
            let Kept {
                scratch, outcomes, ..
            } = &mut kept[at];
            let done = self.engine.evaluate_with(scratch, numbers, outcomes);
            done.map_err(|error| data_error(error, None))?;
            Ok(take(outcomes))
        })
    }

    /// The only thing, or a dict by the names of the outputs.
    fn by_output<'py, T: IntoPyObject<'py>>(
        &self,
        py: Python<'py>,
        things: impl IntoIterator<Item = T>,
    ) -> PyResult<Bound<'py, PyAny>> {
        let mut things = things.into_iter();
        if self.engine.output_names().len() == 1
            && let Some(only) = things.next()
        {
            return only.into_bound_py_any(py);
        }
        let dict = PyDict::new(py);
        for (name, thing) in self.engine.output_names().zip(things) {
            dict.set_item(name, thing)?;
        }
        Ok(dict.into_any())
    }

    fn arrays<'py>(
        &self,
        py: Python<'py>,
        values: &[Bound<'py, PyAny>],
        threads: Option<usize>,
        with_reasons: bool,
    ) -> PyResult<Bound<'py, PyAny>> {
        let expected = self.inputs.len();
        if values.len() != expected {
            let message = format!(
                "the model has {expected} inputs, but {} values were given",
                values.len()
            );
            return Err(data_error(message, None));
        }
        let arrays = Arrays::new(py, values)?;
        let rows = arrays.shape.iter().product();
        let mut evaluator = Evaluator::new(&self.engine, threads, with_reasons)?;
        let results = evaluator.run(py, rows, &arrays.columns()?)?;
        let shaped = results.into_iter().map(|result| match result.reasons {
            Some(reasons) => {
                let outcomes = Outcomes::new(py, result.value, reasons, &arrays.shape)?;
                outcomes.into_bound_py_any(py)
            }
            // A number, as NumPy gives for arrays without axes.
            None if arrays.shape.is_empty() => result.value[0].into_bound_py_any(py),
            None => Ok(result
                .value
                .into_pyarray(py)
                .reshape(arrays.shape.clone())?
                .into_any()),
        });
        let shaped: Vec<Bound<'py, PyAny>> = shaped.collect::<PyResult<_>>()?;
        self.by_output(py, shaped)
    }
}

/// A number of Python, or None, which is unknown; `None` for anything else.
fn number(value: &Bound<'_, PyAny>) -> Option<f64> {
    if let Ok(float) = value.cast::<PyFloat>() {
        return Some(float.value());
    }
    if value.is_instance_of::<PyInt>() {
        return value.extract().ok();
    }
    value.is_none().then_some(f64::NAN)
}

fn is_frame(py: Python<'_>, value: &Bound<'_, PyAny>) -> PyResult<bool> {
    static IS_FRAME: PyOnceLock<Py<PyAny>> = PyOnceLock::new();
    let is_frame = IS_FRAME.import(py, "flagred._frames", "is_frame")?;
    is_frame.call1((value,))?.extract()
}

/// The answer to a frame is a frame of the same library, which Python knows.
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

/// The model that a text holds, in whatever format; of an `unfinished` one in YAML.
fn read(text: &str, unfinished: bool) -> Result<Document, Findings> {
    if !unfinished {
        return interchange::document(text);
    }
    let tree = yaml::read(text)?;
    format::read_unfinished(&tree).map_err(|findings| Findings::locate(findings, text))
}

#[pymethods]
impl RuleSet {
    #[new]
    #[pyo3(signature = (text, file = "<text>", unfinished = false))]
    fn new(py: Python<'_>, text: String, file: &str, unfinished: bool) -> PyResult<Self> {
        let document = py.detach(|| read(&text, unfinished));
        let document = document.map_err(|findings| rule_set_error(py, &findings, file, &text))?;
        let source = Source::new(file.to_owned(), text, document);
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

    /// The text it was read from, and the name of its file.
    fn _text(&self) -> (String, String) {
        let source = self.source();
        (source.text.clone(), source.file.clone())
    }

    /// The model as a document, in JSON.
    fn _json(&self) -> PyResult<String> {
        let json = self.model(|model| serde_json::to_string(&format::write(model)));
        json.map_err(|error| data_error(error, None))
    }

    /// Puts a document, in JSON, in the place of the model. Nothing changes where it has errors.
    fn _edit(&self, py: Python<'_>, json: &str) -> PyResult<()> {
        let tree: Result<Node, _> = serde_json::from_str(json);
        let text = yaml::to_text(&tree.map_err(|error| data_error(error, None))?);
        let edited = RuleSet::new(py, text, "<model>", true)?;
        let mut current = self.current.write().unwrap_or_else(PoisonError::into_inner);
        *current = edited.source();
        Ok(())
    }

    /// Another model that is equal, and apart: an edit of one does not change the other.
    fn _share(&self, other: &RuleSet) {
        let mut current = self.current.write().unwrap_or_else(PoisonError::into_inner);
        *current = other.source();
    }

    fn _equals(&self, other: &RuleSet) -> bool {
        self.source().document.model == other.source().document.model
    }

    /// The rule set in YAML; comments of a file it was read from are not in it.
    fn to_yaml(&self) -> String {
        self.model(yaml::to_string)
    }

    /// Evaluates the rule set, and gives values.
    ///
    /// Parameters
    /// ----------
    /// values
    ///     A number for each input, in their order or by their names: ``model(8, 9)``, ``model(service=8, food=9)``,
    ///     ``model({"service": 8, "food": 9})``. Or arrays that broadcast against each other. Or one frame with a column for
    ///     each input: pandas, polars, pyarrow, DuckDB, and whatever else hands over Arrow data. None, null and NaN are
    ///     unknown.
    /// threads
    ///     How many threads evaluate arrays and frames; as many as there are cores where it is None.
    ///
    /// Returns
    /// -------
    /// float, numpy.ndarray or frame
    ///     The value of the output; NaN where it is unknown, null in frames. With several outputs a dict by their names. A
    ///     frame gives a frame of the same library.
    ///
    /// Raises
    /// ------
    /// DataError
    ///     An input has no value, a name is no input, or a value is no number.
    /// RuleSetError
    ///     The rule set is not finished, or was built wrong.
    #[pyo3(signature = (*args, threads = None, **named))]
    fn __call__<'py>(
        slf: &Bound<'py, Self>,
        args: &Bound<'py, PyTuple>,
        threads: Option<usize>,
        named: Option<&Bound<'py, PyDict>>,
    ) -> PyResult<Bound<'py, PyAny>> {
        let (py, source) = (slf.py(), slf.get().source());
        let compiled = source.compiled(py)?;
        match compiled.asked(py, args, named)? {
            Asked::Numbers(numbers) => compiled.outcomes(&numbers, |outcomes| {
                let values = outcomes.iter().map(|o| o.value().unwrap_or(f64::NAN));
                compiled.by_output(py, values)
            })?,
            Asked::Arrays(values) => compiled.arrays(py, &values, threads, false),
            Asked::Frame(frame) => by_frame(slf, frame, threads, false),
        }
    }

    /// Evaluates the rule set, and says what its values rest on.
    ///
    /// Parameters
    /// ----------
    /// values
    ///     As the model is called.
    /// threads
    ///     As the model is called.
    ///
    /// Returns
    /// -------
    /// Outcome, Outcomes or frame
    ///     Value, coverage, dominant rule and whether an input was clamped: of a point, as arrays, or as the columns of a
    ///     frame. With several outputs a dict by their names.
    ///
    /// Examples
    /// --------
    /// >>> model.evaluate(service=8, food=9)
    /// Outcome(value=18.394444444444446, coverage=0.9, dominant_rule=2, clamped=False, state='defined')
    #[pyo3(signature = (*args, threads = None, **named))]
    fn evaluate<'py>(
        slf: &Bound<'py, Self>,
        args: &Bound<'py, PyTuple>,
        threads: Option<usize>,
        named: Option<&Bound<'py, PyDict>>,
    ) -> PyResult<Bound<'py, PyAny>> {
        let (py, source) = (slf.py(), slf.get().source());
        let compiled = source.compiled(py)?;
        match compiled.asked(py, args, named)? {
            Asked::Numbers(numbers) => compiled.outcomes(&numbers, |outcomes| {
                compiled.by_output(py, outcomes.iter().map(|raw| Outcome::from(*raw)))
            })?,
            Asked::Arrays(values) => compiled.arrays(py, &values, threads, true),
            Asked::Frame(frame) => by_frame(slf, frame, threads, true),
        }
    }

    /// Evaluates a table that Arrow's C interface hands over.
    #[pyo3(signature = (frame, threads = None, with_reasons = false))]
    fn _table(
        &self,
        py: Python<'_>,
        frame: &Bound<'_, PyAny>,
        threads: Option<usize>,
        with_reasons: bool,
    ) -> PyResult<Table> {
        let source = self.source();
        let compiled = source.compiled(py)?;
        let mut reader = arrow::import(frame)?;
        let schema = reader.schema();
        let names: Vec<&str> = compiled.engine.input_names().collect();
        let columns = schema.fields().iter().map(|field| field.name().as_str());
        let places = names.iter().map(|name| {
            columns
                .clone()
                .position(|column| column == *name)
                .ok_or_else(|| {
                    let message = format!("the table has no column `{name}`");
                    data_error(message, suggest(name, columns.clone()))
                })
        });
        let places: Vec<usize> = places.collect::<PyResult<_>>()?;
        let schema = table::schema(&self._output_names(), with_reasons);
        let mut evaluator = Evaluator::new(&compiled.engine, threads, with_reasons)?;
        let mut batches = Vec::new();
        // A stream may be made in Python, which asks for the interpreter itself.
        while let Some(batch) = py.detach(|| reader.next()) {
            let batch = batch.map_err(|error| data_error(error, None))?;
            let columns = names.iter().zip(&places);
            let columns = columns.map(|(name, at)| arrow::numbers(name, batch.column(*at)));
            let columns: Vec<_> = columns.collect::<PyResult<_>>()?;
            let columns: Vec<&[f64]> = columns.iter().map(|column| &**column).collect();
            let results = evaluator.run(py, batch.num_rows(), &columns)?;
            batches.push(table::batch(&schema, results)?);
        }
        Ok(Table { batches, schema })
    }

    /// Says why the outputs are what they are at one point.
    ///
    /// Parameters
    /// ----------
    /// values
    ///     A number for each input, in their order or by their names.
    ///
    /// Returns
    /// -------
    /// Explanation
    ///     The degree of each term, the rules that fired and their shares. Jupyter draws it, ``print`` writes it.
    ///
    /// Raises
    /// ------
    /// DataError
    ///     An input has no value, or is no finite number.
    #[pyo3(signature = (*args, **named))]
    fn explain<'py>(
        &self,
        py: Python<'py>,
        args: &Bound<'py, PyTuple>,
        named: Option<&Bound<'py, PyDict>>,
    ) -> PyResult<Explanation> {
        let source = self.source();
        let compiled = source.compiled(py)?;
        let Asked::Numbers(numbers) = compiled.asked(py, args, named)? else {
            let help = "give a number for each input".to_owned();
            return Err(data_error("one point is explained at a time", Some(help)));
        };
        let explanation = compiled.engine.explain(&numbers);
        let explanation = explanation.map_err(|error| data_error(error, None))?;
        Explanation::new(py, explanation, Arc::clone(compiled))
    }

    /// Evaluates an output over a grid of the inputs.
    ///
    /// Parameters
    /// ----------
    /// points
    ///     How many points there are along each axis, from one end of the range to the other.
    /// output
    ///     The output; the first where it is None.
    /// threads
    ///     How many threads evaluate it; as many as there are cores where it is None.
    /// fixed
    ///     Inputs that are held at a value, by their names. The others are the axes.
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
        threads: Option<usize>,
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

    /// Looks for gaps, contradictions and jumps in the rules.
    ///
    /// Parameters
    /// ----------
    /// coverage
    ///     The firing strength that some rule should reach everywhere.
    /// monotone
    ///     Claims about the outputs: ``"service:increasing"``, or ``"service:increasing:tip"`` for one of several.
    ///
    /// Returns
    /// -------
    /// list of Diagnostic
    ///     What an author should know, in the order of the text; ``str()`` draws one.
    #[pyo3(signature = (*, coverage = 0.5, monotone = None))]
    fn check<'py>(
        &self,
        py: Python<'py>,
        coverage: f64,
        monotone: Option<Vec<String>>,
    ) -> PyResult<Vec<Bound<'py, PyAny>>> {
        let mut options = check::Options::default();
        options.coverage = coverage;
        for claim in monotone.unwrap_or_default() {
            let claim = claim.parse::<Monotone>();
            options
                .monotone
                .push(claim.map_err(|help| data_error("no claim", Some(help)))?);
        }
        let source = self.source();
        let checked = Arc::clone(&source);
        let checked = interruptible(py, move || {
            check::document(&checked.document, &checked.text, &options)
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
