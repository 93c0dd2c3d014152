//! Whole vehicles left out.

use std::collections::{BTreeMap, BTreeSet};

use flagred::evaluation::{Prediction, Ranking};
use rayon::prelude::*;

use super::{
    objective::Area,
    rows::{Row, Set},
    search::tune,
    votes::Votes,
};

/// The number of folds.
pub const FOLDS: usize = 5;

/// The fold of each vehicle: real and simulated vehicles are dealt out in turn, in a random order that is always the same.
pub fn folds(rows: &[Row]) -> BTreeMap<&str, usize> {
    let mut random = fastrand::Rng::with_seed(1);
    let is_real = |row: &&Row| row.set == Set::Real;
    let mut folds = BTreeMap::new();
    for real in [true, false] {
        let rows = rows.iter().filter(|row| is_real(row) == real);
        let vehicles: BTreeSet<&str> = rows.map(|row| row.vehicle.as_str()).collect();
        let mut vehicles: Vec<&str> = vehicles.into_iter().collect();
        random.shuffle(&mut vehicles);
        let dealt = vehicles.into_iter().zip((0..FOLDS).cycle());
        folds.extend(dealt);
    }
    folds
}

/// For each fold, rules that know none of its vehicles.
pub fn tune_without(template: &Votes, rows: &[Row], folds: &BTreeMap<&str, usize>) -> Vec<Votes> {
    let without = |fold: usize| {
        let known = rows
            .iter()
            .filter(|row| folds.get(row.vehicle.as_str()) != Some(&fold));
        tune(template, &known.collect::<Vec<&Row>>())
    };
    (0..FOLDS).into_par_iter().map(without).collect()
}

/// The rows of an area ranked by risk; a group is a flight.
pub fn judge(area: &Area, rows: &[Row], risks_pct: &[f64]) -> Ranking {
    let rows = rows
        .iter()
        .zip(risks_pct)
        .filter(|(row, _)| (area.holds)(row));
    Ranking::new(rows.map(|(row, risk_pct)| Prediction {
        score: *risk_pct,
        critical: row.is_critical,
        group: row.flight,
    }))
}
