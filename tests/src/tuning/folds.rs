//! Cross-validation over vehicles.

use std::collections::{BTreeMap, BTreeSet};

use flagred_evaluation::{Prediction, Ranking};
use rayon::prelude::*;

use super::{objective::Area, rows::Row, search::tune, votes::Votes};

/// The fold of each vehicle. Each real vehicle has its own fold; simulated vehicles are distributed over these folds in
/// turn, in a random but fixed order.
pub fn folds(rows: &[Row]) -> BTreeMap<&str, usize> {
    let vehicles = |are_real: bool| -> Vec<&str> {
        let rows = rows.iter().filter(|row| row.set.is_real() == are_real);
        let vehicles: BTreeSet<&str> = rows.map(|row| row.vehicle.as_str()).collect();
        vehicles.into_iter().collect()
    };
    let (real, mut simulated) = (vehicles(true), vehicles(false));
    fastrand::Rng::with_seed(1).shuffle(&mut simulated);
    let folds = 0..real.len().max(1);
    let dealt = simulated.into_iter().zip(folds.clone().cycle());
    real.into_iter().zip(folds).chain(dealt).collect()
}

/// The risk of each row in %, from rules tuned without the vehicles of its fold, and these rules for each fold.
pub fn tune_without(
    template: &Votes,
    rows: &[Row],
    folds: &BTreeMap<&str, usize>,
) -> (Vec<f64>, Vec<Votes>) {
    let fold = |row: &Row| folds[row.vehicle.as_str()];
    let last = folds.values().max().copied().unwrap_or_default();
    let without = |left_out: usize| {
        let known = rows.iter().filter(|row| fold(row) != left_out);
        tune(template, &known.collect::<Vec<&Row>>())
    };
    let tuned: Vec<Votes> = (0..=last).into_par_iter().map(without).collect();
    let risk_pct = |row: &Row| tuned[fold(row)].risk_pct(&row.inputs);
    (rows.iter().map(risk_pct).collect(), tuned)
}

/// Ranks the rows of an area by risk, grouped by flight.
pub fn judge(area: &Area, rows: &[Row], risks_pct: &[f64]) -> Ranking {
    let rows = rows
        .iter()
        .zip(risks_pct)
        .filter(|(row, _)| (area.contains)(row));
    Ranking::new(rows.map(|(row, risk_pct)| Prediction {
        score: *risk_pct,
        critical: row.is_critical,
        group: row.flight,
    }))
}
