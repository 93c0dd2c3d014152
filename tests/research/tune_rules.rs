//! Tunes the rules to fly with, and judges them on vehicles that they were not tuned on.
//!
//! `scripts/learn-flagred DATA` makes the rows and runs it. Prints how well the risk ranks the steps before an attitude
//! error, with 95 % intervals over flights, and how often it is high where it should not be; writes the rule set that is
//! tuned on all rows.

use std::{error::Error, fs, io::Write, path::Path};

use flagred::gap::{Filling, GapSettings};
use flagred_tests::tuning::{
    AREAS, Data, EXCESSES, FOLDS, Row, Set, Votes, folds, judge, read, tune, tune_without,
};

fn main() -> Result<(), Box<dyn Error + Send + Sync>> {
    let arguments: Vec<String> = std::env::args().skip(1).collect();
    let [template, real, sitl2, sitl3, upsets, rule_set] = &arguments[..] else {
        return Err(
            "usage: tune_rules TEMPLATE.yaml REAL.csv SITL2.csv SITL3.csv UPSETS.csv OUT.yaml"
                .into(),
        );
    };
    let text = fs::read_to_string(template)?;
    let model =
        fuzzy::yaml::parse(&text).map_err(|findings| format!("{template}: {findings:?}"))?;
    let template = Votes::new(&model.model)?;
    let data = Data {
        sets: [(Set::Real, real), (Set::Sitl2, sitl2), (Set::Sitl3, sitl3)]
            .map(|(set, path)| (set, Path::new(path))),
        upsets: Path::new(upsets),
    };
    let rows = read(&data, &template.names())?;
    let folds = folds(&rows);
    let (tuned, left_out) = rayon::join(
        || tune(&template, &rows.iter().collect::<Vec<&Row>>()),
        || tune_without(&template, &rows, &folds),
    );
    let known: Vec<f64> = rows.iter().map(|row| tuned.risk_pct(&row.inputs)).collect();
    let unknown = |row: &Row| left_out[folds[row.vehicle.as_str()]].risk_pct(&row.inputs);
    let unknown: Vec<f64> = rows.iter().map(unknown).collect();

    let model = tuned.rule_set(&rows);
    // The engine says the same, and nowhere is a gap that a monitor would fill.
    let engine = fuzzy::Engine::new(&model)?;
    let filling = Filling::new(&engine, &model, 0, &GapSettings::default())?;
    for (row, risk_pct) in rows.iter().zip(&known) {
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
    let mut out = std::io::stdout().lock();
    writeln!(
        out,
        "| steps | ROC area, vehicles left out | all vehicles known | steps | critical, % |\n|---|---|---|---|---|"
    )?;
    for area in &AREAS {
        let ranking = judge(area, &rows, &unknown);
        let (areas, intervals) = ranking
            .areas()
            .zip(ranking.bootstrap(300, 1))
            .ok_or("nothing was critical")?;
        let known = judge(area, &rows, &known)
            .areas()
            .ok_or("nothing was critical")?;
        writeln!(
            out,
            "| {} | {:.3} [{:.3}, {:.3}] | {:.3} | {} | {:.1} |",
            area.name,
            areas.roc,
            intervals.roc.low,
            intervals.roc.high,
            known.roc,
            ranking.len(),
            100.0 * ranking.critical() as f64 / ranking.len() as f64
        )?;
    }
    writeln!(
        out,
        "\n| steps | risk above | vehicles left out, % of steps | all vehicles known |\n|---|---|---|---|"
    )?;
    for excess in &EXCESSES {
        let share = |risks: &[f64]| {
            let of = rows
                .iter()
                .zip(risks)
                .filter(|(row, _)| (excess.holds)(row));
            let risks: Vec<f64> = of.map(|(_, risk)| *risk).collect();
            let above = risks
                .iter()
                .filter(|risk| **risk > excess.above_pct)
                .count();
            100.0 * above as f64 / risks.len() as f64
        };
        writeln!(
            out,
            "| {} | {} | {:.1} | {:.1} |",
            excess.name,
            excess.above_pct,
            share(&unknown),
            share(&known)
        )?;
    }
    let head = text
        .split_inclusive('\n')
        .take_while(|line| line.starts_with('#'));
    let flights = rows
        .iter()
        .map(|row| row.flight)
        .max()
        .map_or(0, |last| last + 1);
    let provenance = format!(
        "#\n# Learned by `scripts/learn-flagred` from {} rows of {flights} flights of {} vehicles, {FOLDS} folds of vehicles left out to judge it.\n",
        rows.len(),
        folds.len(),
    );
    let rules = fuzzy::yaml::to_string(&model);
    fs::write(
        rule_set,
        format!("{}{provenance}{rules}", head.collect::<String>()),
    )?;
    Ok(())
}
