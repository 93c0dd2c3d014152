//! Rules of other inputs, terms and ways to learn beside those that are shipped, each on vehicles it does not know.
//!
//! `scripts/compare-candidates DATA` makes the rows and runs it. For each candidate every vehicle is left out in turn, the
//! rules are learned from the rows of all others, both tables counting the same, and score the rows of the one left out.
//! The scores of all turns are pooled: the area under the ROC curve, on steps and on whole flights.

use std::{collections::BTreeSet, error::Error, fs, io::Write};

use flagred::{
    evaluation::{Prediction, Ranking},
    gap::{Filling, GapSettings},
};
use fuzzy::{
    Engine, Model,
    learn::{Direction, Learner, Resolution, Settings},
};

type Failure = Box<dyn Error>;

/// What a set of rules looks at and how it is learned.
struct Candidate {
    said: &'static str,
    /// Column, range and terms of each input.
    inputs: &'static [(&'static str, &'static str)],
    /// The output's terms and the operators.
    rest: &'static str,
    /// The rules that are written.
    rules: &'static str,
    resolution: Resolution,
    /// Whether the risk may not fall when an input other than the margin rises.
    monotone: bool,
    /// The tables that are learned from: steps, and whole flights.
    learned_from: [bool; 2],
}

const MARGIN: &str =
    "{range: [0, 0.5], partition: {very_low: 0, low: 0.1, medium: 0.2, high: 0.3}}";
const SPREAD: &str = "{range: [0, 0.5], partition: {low: 0, medium: 0.1, high: 0.2}}";
const UNSTEADY: &str = "{range: [0, 0.5], partition: {calm: 0, some: 0.025, much: 0.05}}";
const LOAD: &str = "{range: [0, 1], partition: {light: 0.3, medium: 0.6, heavy: 0.9}}";
const AT_LIMIT: &str = "{range: [0, 1], partition: {none: 0, much: 0.5}}";

const PAPER: &[(&str, &str)] = &[("margin", MARGIN), ("spread", SPREAD)];
const PAPER_5: &[(&str, &str)] = &[("margin_5", MARGIN), ("spread_5", SPREAD)];
const PAPER_20: &[(&str, &str)] = &[("margin_20", MARGIN), ("spread_20", SPREAD)];
const NOW: &[(&str, &str)] = &[("unsteady_2", UNSTEADY)];
const LATELY: &[(&str, &str)] = &[("unsteady_20", UNSTEADY)];
const BOTH: &[(&str, &str)] = &[("unsteady_2", UNSTEADY), ("unsteady_20", UNSTEADY)];
const LOADED: &[(&str, &str)] = &[
    ("unsteady_2", UNSTEADY),
    ("unsteady_20", UNSTEADY),
    ("load", LOAD),
];
const DIFFERING: &[(&str, &str)] = &[
    ("differing_2", SPREAD),
    ("differing_20", SPREAD),
    ("load", LOAD),
];
const MARGINAL: &[(&str, &str)] = &[
    ("unsteady_2", UNSTEADY),
    ("unsteady_20", UNSTEADY),
    ("margin", MARGIN),
];
const ALL: &[(&str, &str)] = &[
    ("unsteady_2", UNSTEADY),
    ("unsteady_20", UNSTEADY),
    ("load", LOAD),
    ("at_limit", AT_LIMIT),
];

/// The paper's terms and operators.
const MAMDANI: &str = "
outputs: {risk: {range: [0, 100], partition: [very_low, low, medium, high, very_high]}}
operators: {and: minimum, or: maximum, implication: minimum, aggregation: maximum}";

/// The paper's terms, since votes need a term at every risk; product and sum.
const OVERLAPPING: &str = "
outputs: {risk: {range: [0, 100], partition: [very_low, low, medium, high, very_high]}}
operators: {and: product, or: maximum, implication: product, aggregation: sum}";

/// Terms of equal width, product and sum: the centroid is the mean of the peaks, weighted with the strengths.
const LINEAR: &str = "
outputs:
  risk:
    range: [0, 100]
    terms: {very_low: {triangle: [0, 5, 10]}, low: {triangle: [20, 25, 30]}, medium: {triangle: [45, 50, 55]},
      high: {triangle: [70, 75, 80]}, very_high: {triangle: [90, 95, 100]}}
operators: {and: product, or: maximum, implication: product, aggregation: sum}";

const NO_RULES: &str = "";
const AT_ITS_LIMIT: &str = "IF at_limit IS much THEN risk IS very_high";

fn candidates() -> Vec<Candidate> {
    use Resolution::{Heaviest, Mean, Strongest};
    let row = |said, inputs, rest, resolution, monotone| Candidate {
        said,
        inputs,
        rest,
        rules: NO_RULES,
        resolution,
        monotone,
        learned_from: [true, true],
    };
    let shipped = |said, learned_from| Candidate {
        learned_from,
        rules: AT_ITS_LIMIT,
        ..row(said, ALL, LINEAR, Mean, true)
    };
    vec![
        row(
            "the paper's inputs over 2 s and its terms, `strongest`",
            PAPER,
            MAMDANI,
            Strongest,
            false,
        ),
        row("... `heaviest`", PAPER, MAMDANI, Heaviest, false),
        row("... `mean`", PAPER, MAMDANI, Mean, false),
        row(
            "the paper's inputs over 5 s, `strongest`",
            PAPER_5,
            MAMDANI,
            Strongest,
            false,
        ),
        row("... `heaviest`", PAPER_5, MAMDANI, Heaviest, false),
        row("... `mean`", PAPER_5, MAMDANI, Mean, false),
        row(
            "the paper's inputs over 20 s, `mean`",
            PAPER_20,
            MAMDANI,
            Mean,
            false,
        ),
        row(
            "unsteady 2 s; `mean`, monotone, product and sum",
            NOW,
            LINEAR,
            Mean,
            true,
        ),
        row("unsteady 20 s", LATELY, LINEAR, Mean, true),
        row("both", BOTH, LINEAR, Mean, true),
        row("both and load", LOADED, LINEAR, Mean, true),
        row(
            "... `heaviest`, the paper's terms of risk",
            LOADED,
            OVERLAPPING,
            Heaviest,
            true,
        ),
        row("... `strongest`", LOADED, OVERLAPPING, Strongest, true),
        row(
            "mean spread between motors 2 s and 20 s, and load",
            DIFFERING,
            LINEAR,
            Mean,
            true,
        ),
        row(
            "both and the margin in place of load",
            MARGINAL,
            LINEAR,
            Mean,
            true,
        ),
        shipped("**both, load and at limit: as shipped**", [true, true]),
        Candidate {
            rest: MAMDANI,
            ..shipped("... min/min/max, terms to 0 and 100", [true, true])
        },
        shipped(
            "as shipped, learned from whole flights alone",
            [false, true],
        ),
        shipped("as shipped, learned from steps alone", [true, false]),
    ]
}

/// A CSV table of `flagred dataset`.
struct Table {
    header: Vec<String>,
    cells: Vec<Vec<String>>,
}

impl Table {
    fn read(path: &str) -> Result<Table, Failure> {
        let text = fs::read_to_string(path)?;
        let split = |line: &str| line.split(',').map(str::to_owned).collect::<Vec<String>>();
        let mut lines = text.lines().map(split);
        Ok(Table {
            header: lines.next().ok_or("an empty table")?,
            cells: lines.collect(),
        })
    }

    /// The columns of a candidate and the risk, with the vehicle.
    fn rows(&self, candidate: &Candidate) -> Result<Vec<(Vec<f64>, &str)>, Failure> {
        let place = |name: &str| {
            let found = self.header.iter().position(|column| column == name);
            found.ok_or_else(|| format!("no column `{name}`"))
        };
        let names = candidate.inputs.iter().map(|(name, _)| *name);
        let columns = names
            .chain(["risk"])
            .map(place)
            .collect::<Result<Vec<usize>, String>>()?;
        let vehicle = place("vehicle")?;
        let rows = self.cells.iter().map(|cells| {
            let values = columns.iter().map(|c| cells[*c].parse::<f64>());
            Ok((
                values.collect::<Result<Vec<f64>, _>>()?,
                cells[vehicle].as_str(),
            ))
        });
        rows.collect()
    }
}

fn main() -> Result<(), Failure> {
    let mut arguments = std::env::args().skip(1);
    let (Some(steps), Some(flights)) = (arguments.next(), arguments.next()) else {
        return Err("usage: compare_candidates STEPS.csv FLIGHTS.csv".into());
    };
    let tables = [Table::read(&steps)?, Table::read(&flights)?];
    let mut out = std::io::stdout();
    writeln!(out, "| rules | steps | whole flights |\n|---|---|---|")?;
    for candidate in candidates() {
        let [steps, flights] = areas(&candidate, &tables)?;
        writeln!(out, "| {} | {steps:.3} | {flights:.3} |", candidate.said)?;
    }
    Ok(())
}

/// The area under the ROC curve on the rows of each table, every vehicle scored by rules that do not know it.
fn areas(candidate: &Candidate, tables: &[Table; 2]) -> Result<[f64; 2], Failure> {
    let inputs = candidate.inputs.iter();
    let inputs: String = inputs
        .map(|(name, terms)| format!("\n  {name}: {terms}"))
        .collect();
    let text = format!(
        "fuzzy: 1\nname: candidate\ninputs:{inputs}{}\nrules: [{}]",
        candidate.rest, candidate.rules
    );
    let blank = fuzzy::yaml::parse(&text)
        .map_err(|findings| format!("{findings:?}"))?
        .model;
    let sets = [tables[0].rows(candidate)?, tables[1].rows(candidate)?];
    let vehicles: BTreeSet<&str> = sets.iter().flatten().map(|(_, vehicle)| *vehicle).collect();
    let mut scores = [Vec::new(), Vec::new()];
    for vehicle in vehicles {
        let model = learn(candidate, &blank, &sets, vehicle)?;
        let engine = Engine::new(&model)?;
        let filling = Filling::new(&engine, &model, 0, &GapSettings::default())?;
        for (set, scores) in sets.iter().zip(&mut scores) {
            for (values, _) in set.iter().filter(|(_, of)| *of == vehicle) {
                let (risk, inputs) = values.split_last().ok_or("a row without cells")?;
                let outcome = engine.evaluate(inputs)?[0];
                let filled = || filling.read(inputs).map(|reading| reading.value);
                let said = match filling.is_gap(outcome.coverage) {
                    true => filled(),
                    false => outcome.value(),
                };
                scores.push(Prediction {
                    score: said.ok_or("no rules at all")?,
                    // 5 degrees of attitude error, or a crash.
                    critical: *risk >= 100.0,
                    group: 0,
                });
            }
        }
    }
    let [steps, flights] = scores;
    let area = |scores| Ranking::new(scores).areas().ok_or("nothing was critical");
    Ok([area(steps)?.roc, area(flights)?.roc])
}

fn learn(
    candidate: &Candidate,
    blank: &Model,
    sets: &[Vec<(Vec<f64>, &str)>; 2],
    without: &str,
) -> Result<Model, Failure> {
    let rising = candidate
        .inputs
        .iter()
        .filter(|(name, _)| *name != "at_limit");
    let monotone = rising.map(|(name, _)| {
        let direction = match name.starts_with("margin") {
            true => Direction::Falling,
            false => Direction::Rising,
        };
        ((*name).to_owned(), direction)
    });
    let given = candidate.inputs.iter().any(|(name, _)| *name == "at_limit");
    let given = given.then(|| fuzzy::rule::parse("IF at_limit IS none THEN risk IS low"));
    let settings = Settings {
        resolution: candidate.resolution,
        min_support: if candidate.monotone { 5 } else { 1 },
        complete: candidate.monotone,
        monotone: if candidate.monotone {
            monotone.collect()
        } else {
            Vec::new()
        },
        given: given
            .transpose()
            .map_err(|finding| finding.message)?
            .map(|rule| rule.condition),
        ..Settings::default()
    };
    let mut learner = Learner::new(blank, settings)?;
    let sets = sets.iter().zip(candidate.learned_from);
    for (set, _) in sets.filter(|(_, is_learned_from)| *is_learned_from) {
        let rows = || set.iter().filter(|(_, vehicle)| *vehicle != without);
        let weight = 1.0 / rows().count() as f64;
        for (values, _) in rows() {
            learner.add(values, weight)?;
        }
    }
    Ok(learner.finish().model)
}
