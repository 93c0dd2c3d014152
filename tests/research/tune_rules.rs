//! Tunes candidates for the default rule set, validates them on held-out vehicles, and writes the chosen one.
//!
//! `scripts/learn-flagred DATA` creates the rows and runs this program. It prints the ROC areas of each candidate. For the
//! chosen candidate, with the vote for sudden changes added (`with_step`), it prints areas with 95 % intervals over flights,
//! false alarms, a line for each real vehicle, and the reliability. All figures of a vehicle are computed with rules that
//! were tuned without it. The reliability is also written into the profiles.

use std::{collections::BTreeMap, error::Error, fs, io::Write, path::Path};

use flagred::gap::{Filling, GapSettings};
use flagred_tests::tuning::{
    AREAS, CANDIDATES, Data, FALSE_ALARM_SETS, Row, Set, Share, Votes, candidate, folds, judge,
    read, risks_pct, shares, tune, tune_without, with_shares, with_step,
};

/// The minimum number of critical steps, and also of other steps, that a real vehicle must have for its ROC area to be
/// printed.
const ENOUGH: usize = 20;
/// Number of bands of risk in the printed table.
const PRINTED_BANDS: usize = 10;
/// Number of bands of risk in profiles.
const PROFILE_BANDS: usize = 5;

type Result<T> = std::result::Result<T, Box<dyn Error + Send + Sync>>;

fn main() -> Result<()> {
    let arguments: Vec<String> = std::env::args().skip(1).collect();
    let [
        template,
        real,
        real2,
        sitl2,
        sitl3,
        upsets,
        upsets2,
        rule_set,
        profiles @ ..,
    ] = &arguments[..]
    else {
        return Err(
            "usage: tune_rules TEMPLATE.yaml REAL.csv REAL2.csv SITL2.csv SITL3.csv UPSETS.csv UPSETS2.csv OUT.yaml [PROFILE.yaml ...]"
                .into(),
        );
    };
    let text = fs::read_to_string(template)?;
    let model =
        fuzzy::yaml::parse(&text).map_err(|findings| format!("{template}: {findings:?}"))?;
    let data = Data {
        sets: [
            (Set::Real, real),
            (Set::Real2, real2),
            (Set::Sitl2, sitl2),
            (Set::Sitl3, sitl3),
        ]
        .map(|(set, path)| (set, Path::new(path))),
        upsets: [upsets, upsets2].map(Path::new),
    };
    let mut out = std::io::stdout().lock();
    writeln!(
        out,
        "| inputs beside at_limit | {} |\n|---|{}",
        AREAS.map(|area| area.name).join(" | "),
        "---|".repeat(AREAS.len())
    )?;
    let mut chosen = None;
    for inputs in CANDIDATES {
        let candidate = Candidate::new(&data, &candidate(&model.model, inputs))?;
        let cells = AREAS.iter().map(|area| {
            let ranking = judge(area, &candidate.rows, &candidate.unknown);
            ranking.areas().map_or(f64::NAN, |areas| areas.roc)
        });
        let cells: Vec<String> = cells.map(|area| format!("{area:.3}")).collect();
        writeln!(out, "| {} | {} |", inputs.join(", "), cells.join(" | "))?;
        chosen.get_or_insert(candidate);
    }
    let chosen = chosen.ok_or("no candidate")?;
    let rule_set_of = |votes: &Votes| with_step(votes.rule_set(&chosen.rows), &model.model);
    let without: Vec<fuzzy::Model> = chosen
        .left_out
        .iter()
        .map(rule_set_of)
        .collect::<std::result::Result<_, _>>()?;
    let inputs = without.first().ok_or("no vehicle")?.inputs.iter();
    let rows = read(
        &data,
        &inputs.map(|input| input.name.as_str()).collect::<Vec<_>>(),
    )?;
    let unknown = risks_pct(&without, &folds(&rows), &rows)?;
    print(&rows, &unknown, &mut out)?;
    print_shares(&rows, &unknown, &mut out)?;
    for path in profiles {
        let shares = |is_in| shares(&rows, &unknown, PROFILE_BANDS, is_in);
        let text = with_shares(
            &fs::read_to_string(path)?,
            &shares(Set::is_real),
            &shares(|set| !set.is_real()),
        );
        fs::write(
            path,
            text.ok_or_else(|| format!("{path}: no key `reliability`"))?,
        )?;
    }
    let model = with_step(chosen.rule_set()?, &model.model)?;
    let head = text
        .split_inclusive('\n')
        .take_while(|line| line.starts_with('#'));
    let rows = &chosen.rows;
    let flights = rows.iter().map(|row| row.flight).max();
    let provenance = format!(
        "#\n# Learned by `scripts/learn-flagred` from {} rows of {} flights of {} vehicles; judged on vehicles left out.\n",
        rows.len(),
        flights.map_or(0, |last| last + 1),
        folds(rows).len(),
    );
    let rules = fuzzy::yaml::to_string(&model);
    fs::write(
        rule_set,
        format!("{}{provenance}{rules}", head.collect::<String>()),
    )?;
    Ok(())
}

/// A tuned candidate.
struct Candidate {
    rows: Vec<Row>,
    tuned: Votes,
    /// The risk of each row in %, by rules tuned without its vehicle.
    unknown: Vec<f64>,
    /// For each fold, the rules that were tuned without its vehicles.
    left_out: Vec<Votes>,
}

impl Candidate {
    fn new(data: &Data<'_>, template: &fuzzy::Model) -> Result<Candidate> {
        let template = Votes::new(template)?;
        let rows = read(data, &template.names())?;
        let (tuned, (unknown, left_out)) = rayon::join(
            || tune(&template, &rows.iter().collect::<Vec<&Row>>()),
            || tune_without(&template, &rows, &folds(&rows)),
        );
        Ok(Candidate {
            tuned,
            unknown,
            left_out,
            rows,
        })
    }

    /// Returns the rule set, after verifying that the engine gives the same risks and that the rules leave no gap for a
    /// monitor to fill.
    fn rule_set(&self) -> Result<fuzzy::Model> {
        let model = self.tuned.rule_set(&self.rows);
        let engine = fuzzy::Engine::new(&model)?;
        let filling = Filling::new(&engine, &model, 0, &GapSettings::default())?;
        for row in &self.rows {
            let risk_pct = self.tuned.risk_pct(&row.inputs);
            let outcome = engine.evaluate(&row.inputs)?[0];
            let differs = |value: f64| (value - risk_pct).abs() > 1e-6;
            if outcome.value().is_none_or(differs) || filling.is_gap(outcome.coverage) {
                return Err(format!(
                    "the rule set gives {outcome:?} at {:?}, not {risk_pct}",
                    row.inputs
                )
                .into());
            }
        }
        Ok(model)
    }
}

/// Prints the scores of risks in %, for all sets of rows.
fn print(rows: &[Row], risks_pct: &[f64], out: &mut impl Write) -> Result<()> {
    writeln!(
        out,
        "\n| steps | ROC area, vehicles left out | steps | critical, % |\n|---|---|---|---|"
    )?;
    for area in &AREAS {
        let ranking = judge(area, rows, risks_pct);
        let (areas, intervals) = ranking
            .areas()
            .zip(ranking.bootstrap(300, 1))
            .ok_or("nothing was critical")?;
        writeln!(
            out,
            "| {} | {:.3} [{:.3}, {:.3}] | {} | {:.1} |",
            area.name,
            areas.roc,
            intervals.roc.low,
            intervals.roc.high,
            ranking.len(),
            100.0 * ranking.critical() as f64 / ranking.len() as f64
        )?;
    }
    writeln!(
        out,
        "\n| steps | risk above | vehicles left out, % of steps |\n|---|---|---|"
    )?;
    for excess in &FALSE_ALARM_SETS {
        let of = rows.iter().zip(risks_pct);
        let risks: Vec<f64> = of
            .filter(|(row, _)| (excess.contains)(row))
            .map(|(_, risk)| *risk)
            .collect();
        let above = risks.iter().filter(|risk| **risk > excess.above_pct);
        let share = 100.0 * above.count() as f64 / risks.len() as f64;
        writeln!(
            out,
            "| {} | {} | {share:.1} |",
            excess.name, excess.above_pct
        )?;
    }
    print_vehicles(rows, risks_pct, out)
}

/// Prints a line for each real vehicle.
fn print_vehicles(rows: &[Row], risks_pct: &[f64], out: &mut impl Write) -> Result<()> {
    writeln!(
        out,
        "\n| real vehicle | ROC area | steps | critical |\n|---|---|---|---|"
    )?;
    let mut vehicles: BTreeMap<&str, Vec<usize>> = BTreeMap::new();
    for (i, row) in rows.iter().enumerate() {
        if row.set.is_real() {
            vehicles.entry(&row.vehicle).or_default().push(i);
        }
    }
    let mut areas = Vec::new();
    for (vehicle, places) in &vehicles {
        let own: Vec<Row> = places.iter().map(|i| rows[*i].clone()).collect();
        let risks: Vec<f64> = places.iter().map(|i| risks_pct[*i]).collect();
        let ranking = judge(&AREAS[0], &own, &risks);
        let critical = ranking.critical();
        let is_enough = critical >= ENOUGH && ranking.len() - critical >= ENOUGH;
        let area = ranking.areas().filter(|_| is_enough);
        areas.extend(area.map(|area| area.roc));
        let area = area.map_or("-".to_owned(), |area| format!("{:.3}", area.roc));
        writeln!(out, "| {vehicle} | {area} | {} | {critical} |", own.len())?;
    }
    areas.sort_by(f64::total_cmp);
    let mean = areas.iter().sum::<f64>() / areas.len().max(1) as f64;
    if let (Some(least), Some(most)) = (areas.first(), areas.last()) {
        writeln!(
            out,
            "\nOf {} vehicles with at least {ENOUGH} critical and {ENOUGH} other steps: mean {mean:.3}, from {least:.3} to {most:.3}.",
            areas.len()
        )?;
    }
    Ok(())
}

/// Prints the reliability in bands of 10 %.
fn print_shares(rows: &[Row], risks_pct: &[f64], out: &mut impl Write) -> Result<()> {
    writeln!(out, "\n| risk | real | sitl2 | sitl3 |\n|---|---|---|---|")?;
    let sets: [fn(Set) -> bool; 3] = [
        Set::is_real,
        |set| set == Set::Sitl2,
        |set| set == Set::Sitl3,
    ];
    let columns = sets.map(|is_in| shares(rows, risks_pct, PRINTED_BANDS, is_in));
    for band in 0..PRINTED_BANDS {
        let cell = |shares: &Vec<Share>| {
            let Share { moments, followed } = shares[band];
            format!(
                "{:.0} % of {moments}",
                100.0 * followed as f64 / moments.max(1) as f64
            )
        };
        let cells = columns.each_ref().map(cell).join(" | ");
        let width_pct = 100 / PRINTED_BANDS;
        writeln!(
            out,
            "| {} to {} % | {cells} |",
            band * width_pct,
            (band + 1) * width_pct
        )?;
    }
    Ok(())
}
