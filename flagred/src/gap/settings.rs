//! Settings that define a gap and how it is filled.

use fuzzy::{
    Model,
    model::{Conjunction, Variable},
};

use super::complete::is_plain;

/// The method that fills a gap.
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
    /// The value of the nearest covered knot; if several knots are equally near, the highest of their values.
    Nearest,
    /// `sum(v / d^power) / sum(1 / d^power)` over the nearest covered knots at the edge of the gap.
    ///
    /// In its usual form, over *all* cells, the method would give a corner of the map an average of the whole map: 49 %
    /// for a saturated drone. Therefore the number of neighbours is limited.
    InverseDistance {
        /// The power of the distance, above 0.
        power: f64,
        /// The number of knots that count, at least 1.
        neighbours: usize,
    },
    /// The thin-plate spline through the nearest covered knots. It continues slopes and can overshoot; values are kept
    /// within the range of the output.
    #[default]
    ThinPlate,
    /// The solution of Laplace's equation. Every filled value is the mean of its neighbours, so the result is smooth
    /// and cannot overshoot.
    Harmonic,
}

impl GapMethod {
    /// All methods, with default parameters.
    pub const ALL: [GapMethod; 4] = [
        GapMethod::Nearest,
        GapMethod::INVERSE_DISTANCE,
        GapMethod::ThinPlate,
        GapMethod::Harmonic,
    ];

    /// The name of the method in profiles.
    pub fn name(self) -> &'static str {
        match self {
            GapMethod::Nearest => "nearest",
            GapMethod::InverseDistance { .. } => "inverse_distance",
            GapMethod::ThinPlate => "thin_plate",
            GapMethod::Harmonic => "harmonic",
        }
    }

    /// Inverse distance with default parameters: power 2, 3 neighbours.
    pub const INVERSE_DISTANCE: GapMethod = GapMethod::InverseDistance {
        power: 2.0,
        neighbours: 3,
    };
}

/// The conditions under which a cell is a gap, and the method that fills it.
#[derive(Debug, Clone, Copy, PartialEq, Default)]
#[non_exhaustive]
pub struct GapSettings {
    /// The method that fills gaps.
    pub method: GapMethod,
    /// A cell with a lower coverage is a gap. `None` selects the lowest strength with which the dominant antecedent can
    /// fire, see [`GapSettings::coverage_below`].
    pub coverage_below: Option<f64>,
}

impl GapSettings {
    /// The coverage below which a cell of the map of a model is a gap.
    ///
    /// The default follows from the operators. If the terms of every input sum to 1 everywhere, the dominant antecedent
    /// has memberships of at least 0.5, the value where two neighbours meet. It then fires with a strength of at least
    /// 0.5 if AND is the minimum, and of at least `0.5^n` if AND is the product and there are n inputs. A lower
    /// coverage means that the dominant antecedent has no rule. With other terms, other conjunctions, rule blocks and
    /// activation methods, only points that no rule covers at all are gaps.
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

/// Whether the memberships of a variable's terms sum to 1 over its whole range.
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
    fn the_coverage_of_a_gap_follows_from_the_terms_and_the_conjunction() {
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
