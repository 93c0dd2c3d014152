//! The objective of tuned rules.

use std::collections::HashMap;

use super::{
    rows::{Row, Set},
    votes::{Input, Votes, WeightedSum},
};

/// A set of rows for which the area under the ROC curve is part of the score.
#[derive(Debug, Clone, Copy)]
pub struct Area {
    /// The name of this set of rows.
    pub name: &'static str,
    /// Whether a row belongs to the set.
    pub contains: fn(&Row) -> bool,
    /// The weight of the area.
    weight: f64,
}

/// The sets of rows whose areas are part of the score. There are few real vehicles, and half of the real flights are of
/// one vehicle. Therefore the areas of real flights have only two fifths of the total weight.
pub const AREAS: [Area; 8] = [
    Area {
        name: "real",
        contains: |row| row.set.is_real(),
        weight: 2.0,
    },
    Area {
        name: "real, quiet for 5 s",
        contains: |row| row.set.is_real() && row.is_quiet_5_s,
        weight: 2.0,
    },
    Area {
        name: "sitl2 without manoeuvres",
        contains: |row| row.set == Set::Sitl2 && row.kind != "manoeuvre",
        weight: 1.0,
    },
    Area {
        name: "sitl2 without manoeuvres, quiet for 10 s",
        contains: |row| row.set == Set::Sitl2 && row.kind != "manoeuvre" && row.is_quiet_10_s,
        weight: 1.0,
    },
    Area {
        name: "sitl3",
        contains: |row| row.set == Set::Sitl3,
        weight: 1.0,
    },
    Area {
        name: "sitl3, quiet for 5 s",
        contains: |row| row.set == Set::Sitl3 && row.is_quiet_5_s,
        weight: 1.0,
    },
    Area {
        name: "sitl3, gusts and rising wind",
        contains: |row| row.set == Set::Sitl3 && matches!(row.kind.as_str(), "gusts" | "rising"),
        weight: 1.0,
    },
    Area {
        name: "sitl2 and sitl3",
        contains: |row| !row.set.is_real(),
        weight: 1.0,
    },
];

/// A set of rows over which a high risk is a false alarm.
#[derive(Debug, Clone, Copy)]
pub struct FalseAlarmSet {
    /// The name of this set of rows.
    pub name: &'static str,
    /// Whether a row belongs to the set.
    pub contains: fn(&Row) -> bool,
    /// The highest risk without a penalty, in %.
    pub above_pct: f64,
    /// The penalty if the risks exceed `above_pct` by 1 percentage point on average.
    cost: f64,
}

/// The sets of rows over which a high risk is penalised.
pub const FALSE_ALARM_SETS: [FalseAlarmSet; 3] = [
    FalseAlarmSet {
        name: "ordinary real flights",
        contains: |row| row.set.is_real() && row.kind == "ordinary",
        above_pct: 50.0,
        cost: 0.015,
    },
    FalseAlarmSet {
        name: "sitl3 hover, yaw, mission and pilot, not critical",
        contains: |row| {
            let kinds = ["hover_noise", "yaw", "mission", "pilot"];
            row.set == Set::Sitl3 && kinds.contains(&row.kind.as_str()) && !row.is_critical
        },
        above_pct: 50.0,
        cost: 0.015,
    },
    FalseAlarmSet {
        name: "sitl2 calm",
        contains: |row| row.set == Set::Sitl2 && row.kind == "calm",
        above_pct: 30.0,
        cost: 0.01,
    },
];

/// The rows in the form that the search needs: a column for each voting input.
pub(super) struct Problem {
    pub(super) columns: Vec<Vec<f64>>,
    /// For each row, the degree of the common condition of all votes, and the weighted sum of the fixed rules.
    given: Vec<(f64, WeightedSum)>,
    /// The rows of each of [`AREAS`]: those that became critical, and the others.
    areas: Vec<[Vec<u32>; 2]>,
    /// The weight of each row: `sqrt(n) / n` with the number `n` of rows of its vehicle, so that
    /// long logs do not dominate.
    weights: Vec<f64>,
    /// The rows of each of [`FALSE_ALARM_SETS`].
    excesses: Vec<Vec<u32>>,
}

impl Problem {
    pub(super) fn new(rows: &[&Row], votes: &Votes) -> Problem {
        let column = |input: &Input| rows.iter().map(|row| row.inputs[input.place]).collect();
        let which = |contains: &dyn Fn(&Row) -> bool| {
            let all = rows.iter().enumerate().filter(|(_, row)| contains(row));
            all.map(|(i, _)| i as u32).collect::<Vec<u32>>()
        };
        let area = |area: &Area| {
            [true, false]
                .map(|critical| which(&|row| (area.contains)(row) && row.is_critical == critical))
        };
        let mut of_vehicle: HashMap<(Set, &str), f64> = HashMap::new();
        for row in rows {
            *of_vehicle.entry((row.set, &row.vehicle)).or_default() += 1.0;
        }
        let weight = |row: &&Row| 1.0 / of_vehicle[&(row.set, row.vehicle.as_str())].sqrt();
        Problem {
            weights: rows.iter().map(weight).collect(),
            columns: votes.inputs.iter().map(column).collect(),
            given: rows.iter().map(|row| votes.given(&row.inputs)).collect(),
            areas: AREAS.iter().map(area).collect(),
            excesses: FALSE_ALARM_SETS
                .iter()
                .map(|excess| which(&excess.contains))
                .collect(),
        }
    }

    /// The score of votes, given their sums at each row.
    pub(super) fn score(&self, sums: impl Iterator<Item = WeightedSum>) -> f64 {
        let risk = |((given, written), votes): (&(f64, WeightedSum), WeightedSum)| {
            let weights = written.weights + given * votes.weights;
            (written.values + given * votes.values) / weights.max(1e-9)
        };
        let risks: Vec<f64> = self.given.iter().zip(sums).map(risk).collect();
        let mut score = 0.0;
        for (area, rows) in AREAS.iter().zip(&self.areas) {
            score += area.weight * self.roc(&risks, rows);
        }
        score /= AREAS.iter().map(|area| area.weight).sum::<f64>();
        for (excess, rows) in FALSE_ALARM_SETS.iter().zip(&self.excesses) {
            let over = rows
                .iter()
                .map(|row| (risks[*row as usize] - excess.above_pct).max(0.0));
            score -= excess.cost * over.sum::<f64>() / rows.len().max(1) as f64;
        }
        score
    }

    /// The area under the ROC curve, with risks in steps of 0.05 %; 0 if one class is missing.
    fn roc(&self, risks: &[f64], [critical, others]: &[Vec<u32>; 2]) -> f64 {
        const STEPS: usize = 2000;
        let count = |rows: &[u32]| {
            let mut counts = [0.0; STEPS];
            for row in rows {
                let step = (risks[*row as usize] * (STEPS as f64 / 100.0)) as usize;
                counts[step.min(STEPS - 1)] += self.weights[*row as usize];
            }
            counts
        };
        let (critical, others) = (count(critical), count(others));
        let all = critical.iter().sum::<f64>() * others.iter().sum::<f64>();
        let (mut below, mut pairs) = (0.0, 0.0);
        for (critical, others) in critical.iter().zip(others) {
            pairs += critical * (below + others / 2.0);
            below += others;
        }
        if all > 0.0 { pairs / all } else { 0.0 }
    }
}
