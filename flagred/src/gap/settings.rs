//! What is a gap, and how it is filled.

use fuzzy::{
    Model,
    model::{Conjunction, Variable},
};

use super::complete::is_plain;

/// How a gap is filled.
///
/// # Example
/// ```
/// use flagred::gap::GapMethod;
///
/// assert!(GapMethod::ALL.contains(&GapMethod::default()));
/// assert!(GapMethod::ALL.contains(&GapMethod::INVERSE_DISTANCE));
/// ```
#[derive(Debug, Clone, Copy, PartialEq, Default)]
pub enum GapMethod {
    /// The value of the nearest covered knot, of equally near ones the highest.
    Nearest,
    /// `sum(v / d^power) / sum(1 / d^power)` over the nearest covered knots at the edge of the gap.
    ///
    /// Over *all* cells, as the method is often given, a corner reads an average of the whole map: 49 % for a
    /// saturated drone. Hence the number of neighbours.
    InverseDistance {
        /// The power of the distance, over 0.
        power: f64,
        /// How many knots count, at least 1.
        neighbours: usize,
    },
    /// The thin-plate spline through the covered knots nearest to each place: it continues slopes, and can overshoot;
    /// kept within the range of the output.
    #[default]
    ThinPlate,
    /// The solution of Laplace's equation: every filled value is the mean of its neighbours, so it is smooth and
    /// cannot overshoot.
    Harmonic,
}

impl GapMethod {
    /// Every method, those with settings as they are when nothing else is said.
    pub const ALL: [GapMethod; 4] = [
        GapMethod::Nearest,
        GapMethod::INVERSE_DISTANCE,
        GapMethod::ThinPlate,
        GapMethod::Harmonic,
    ];

    /// Its name, as profiles have it.
    pub fn name(self) -> &'static str {
        match self {
            GapMethod::Nearest => "nearest",
            GapMethod::InverseDistance { .. } => "inverse_distance",
            GapMethod::ThinPlate => "thin_plate",
            GapMethod::Harmonic => "harmonic",
        }
    }

    /// Inverse distance as it is when nothing else is said: power 2, 3 neighbours.
    pub const INVERSE_DISTANCE: GapMethod = GapMethod::InverseDistance {
        power: 2.0,
        neighbours: 3,
    };
}

/// What a cell must not be to count as covered, and how the others get their values.
#[derive(Debug, Clone, Copy, PartialEq, Default)]
#[non_exhaustive]
pub struct GapSettings {
    /// How the gap is filled.
    pub method: GapMethod,
    /// A cell is a gap below this coverage; `None` is the least with which the dominating antecedent can fire, see
    /// [`GapSettings::coverage_below`].
    pub coverage_below: Option<f64>,
}

impl GapSettings {
    /// The coverage below which a cell of the map of a model is a gap.
    ///
    /// Where none is set: if the terms of every input sum to 1 everywhere, the dominating antecedent has memberships of
    /// 0.5 at least, where two neighbours meet. With the minimum as AND it then fires at 0.5 or more, with the product
    /// of n inputs at `0.5^n`: less means that the dominating antecedent has no rule. With other terms, other
    /// conjunctions, rule blocks and activation methods only what no rule covers at all is a gap.
    pub fn coverage_below(&self, model: &Model) -> f64 {
        let least = || match model.operators.and {
            _ if !is_plain(model) => f64::MIN_POSITIVE,
            Conjunction::Minimum => 0.5,
            Conjunction::Product => libm::pow(0.5, model.inputs.len() as f64),
            Conjunction::BoundedDifference
            | Conjunction::Drastic
            | Conjunction::Einstein
            | Conjunction::Hamacher
            | Conjunction::NilpotentMinimum => f64::MIN_POSITIVE,
        };
        self.coverage_below
            .unwrap_or_else(|| match model.inputs.iter().all(sums_to_one) {
                true => least(),
                false => f64::MIN_POSITIVE,
            })
    }
}

/// Whether the memberships of a variable's terms sum to 1 all over its range.
fn sums_to_one(variable: &Variable) -> bool {
    const STEPS: u32 = 500;
    (0..=STEPS).all(|i| {
        let share = f64::from(i) / f64::from(STEPS);
        let x = variable.low + (variable.high - variable.low) * share;
        let memberships = variable.terms.iter();
        let sum: f64 = memberships
            .map(|t| t.height * t.membership_function.membership(x))
            .sum();
        (sum - 1.0).abs() < 1e-6
    })
}

#[cfg(test)]
mod tests {
    use super::*;
    use alloc::format;

    #[test]
    fn what_counts_as_covered_follows_from_the_terms_and_the_conjunction() {
        let below = |partition: &str, and: &str| {
            let text = format!(
                "
fuzzy: 1
name: test
inputs: {{a: {{range: [0, 1], {partition}}}, b: {{range: [0, 1], partition: [low, high]}}}}
outputs: {{y: {{range: [0, 1], partition: [low, high]}}}}
operators: {{and: {and}}}
rules: [IF a IS low THEN y IS low]
"
            );
            let model = fuzzy::yaml::parse(&text).unwrap().model;
            GapSettings::default().coverage_below(&model)
        };
        assert_eq!(below("partition: [low, high]", "minimum"), 0.5);
        assert_eq!(below("partition: [low, high]", "product"), 0.25);
        let bells = "terms: {low: {gaussian: {mean: 0, sd: 0.2}}}";
        assert_eq!(below(bells, "minimum"), f64::MIN_POSITIVE);
        assert_eq!(
            below("partition: [low, high]", "einstein"),
            f64::MIN_POSITIVE
        );
    }
}
