//! Activation methods, which select the rules of a block that fire and adjust their strengths.

use super::PartialConjunction;

/// The default minimum firing strength; smaller strengths count as 0. It absorbs rounding errors in strengths whose
/// exact value is 0, such as the strength of `x IS a AND x IS not a` with `bounded_difference`.
pub const MIN_STRENGTH: f64 = 1e-12;

/// An activation method: selects the rules of a block that fire and adjusts their strengths, given the weighted degrees
/// of their antecedents. The methods are those of fuzzylite 7.
///
/// A rule whose strength is below the least strength of the rule set never fires. Two strengths whose difference is
/// below the least strength count as equal.
#[derive(Debug, Clone, Copy, PartialEq, Default)]
pub enum Activation {
    /// All rules fire.
    #[default]
    General,
    /// The first rules, in the order of the rule set, with a strength of at least `at_least`.
    First {
        /// The maximum number of rules that fire.
        rules: u32,
        /// The minimum strength of these rules.
        at_least: f64,
    },
    /// The last rules, in the order of the rule set, with a strength of at least `at_least`.
    Last {
        /// The maximum number of rules that fire.
        rules: u32,
        /// The minimum strength of these rules.
        at_least: f64,
    },
    /// The strongest rules; among equally strong ones the first.
    Highest {
        /// The maximum number of rules that fire.
        rules: u32,
    },
    /// The weakest rules that fire; among equally weak ones the first.
    Lowest {
        /// The maximum number of rules that fire.
        rules: u32,
    },
    /// All rules, with their strengths divided by the sum of all strengths of the block.
    Proportional,
    /// The rules whose strength passes a comparison with a number.
    Threshold {
        /// The comparison.
        comparison: Comparison,
        /// The number to compare with.
        strength: f64,
    },
}

/// A comparison of a firing strength with a threshold.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub enum Comparison {
    /// `<`
    Below,
    /// `<=`
    AtMost,
    /// `=`
    Equal,
    /// `!=`
    NotEqual,
    /// `>=`
    AtLeast,
    /// `>`
    Above,
}

impl Activation {
    /// Replaces the strengths of all rules of a block, in the order of the rules, by the strengths with which they
    /// fire. Rules that do not fire get a strength below `least`.
    pub(crate) fn activate(self, least: f64, rules: &mut [PartialConjunction]) {
        match self {
            Activation::General => {}
            Activation::First {
                rules: count,
                at_least,
            } => first(count, at_least, least, rules.iter_mut()),
            Activation::Last {
                rules: count,
                at_least,
            } => first(count, at_least, least, rules.iter_mut().rev()),
            Activation::Highest { rules: count } => {
                rules.sort_unstable_by(|a, b| {
                    let strongest = b.degree[0].total_cmp(&a.degree[0]);
                    strongest.then(a.at.cmp(&b.at))
                });
                first(count, 0.0, least, rules.iter_mut());
                rules.sort_unstable_by_key(|rule| rule.at);
            }
            Activation::Lowest { rules: count } => {
                rules.sort_unstable_by(|a, b| {
                    let weakest = a.degree[0].total_cmp(&b.degree[0]);
                    weakest.then(a.at.cmp(&b.at))
                });
                first(count, 0.0, least, rules.iter_mut());
                rules.sort_unstable_by_key(|rule| rule.at);
            }
            Activation::Proportional => {
                let sum: f64 = rules.iter().map(|rule| rule.degree[0]).sum();
                if sum > 0.0 {
                    for rule in rules {
                        rule.degree[0] /= sum;
                    }
                }
            }
            Activation::Threshold {
                comparison,
                strength,
            } => {
                for rule in rules {
                    if !comparison.is_true(rule.degree[0], strength, least) {
                        rule.degree[0] = 0.0;
                    }
                }
            }
        }
    }
}

/// Selects the first `count` rules that fire with a strength of at least `at_least`.
fn first<'a>(
    count: u32,
    at_least: f64,
    least: f64,
    rules: impl Iterator<Item = &'a mut PartialConjunction>,
) {
    let mut left = count;
    for rule in rules {
        let fires =
            rule.degree[0] >= least && Comparison::AtLeast.is_true(rule.degree[0], at_least, least);
        if fires && left > 0 {
            left -= 1;
        } else {
            rule.degree[0] = 0.0;
        }
    }
}

impl Comparison {
    /// Returns whether the comparison is true. Numbers whose difference is below `least` are equal.
    fn is_true(self, strength: f64, threshold: f64, least: f64) -> bool {
        let equal = libm::fabs(strength - threshold) < least;
        match self {
            Comparison::Below => !equal && strength < threshold,
            Comparison::AtMost => equal || strength < threshold,
            Comparison::Equal => equal,
            Comparison::NotEqual => !equal,
            Comparison::AtLeast => equal || strength > threshold,
            Comparison::Above => !equal && strength > threshold,
        }
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use alloc::vec::Vec;

    /// Returns the strengths with which rules of the given strengths fire.
    fn after(activation: Activation, strengths: &[f64]) -> Vec<f64> {
        let rules = strengths.iter().zip(0..);
        let mut rules: Vec<PartialConjunction> = rules
            .map(|(&degree, at)| PartialConjunction::new(degree, at))
            .collect();
        activation.activate(1e-6, &mut rules);
        rules.iter().map(|rule| rule.degree[0]).collect()
    }

    fn threshold(comparison: Comparison, strength: f64) -> Activation {
        Activation::Threshold {
            comparison,
            strength,
        }
    }

    #[test]
    fn activations_equal_values_computed_by_hand() {
        const ALL: [f64; 5] = [0.25, 1e-7, 0.75, 0.5, 0.75];
        for (activation, expected) in [
            (Activation::General, ALL),
            (
                Activation::First {
                    rules: 2,
                    at_least: 0.0,
                },
                [0.25, 0.0, 0.75, 0.0, 0.0],
            ),
            (
                Activation::First {
                    rules: 2,
                    at_least: 0.5,
                },
                [0.0, 0.0, 0.75, 0.5, 0.0],
            ),
            (
                Activation::Last {
                    rules: 1,
                    at_least: 0.0,
                },
                [0.0, 0.0, 0.0, 0.0, 0.75],
            ),
            (
                Activation::Last {
                    rules: 9,
                    at_least: 0.6,
                },
                [0.0, 0.0, 0.75, 0.0, 0.75],
            ),
            (Activation::Highest { rules: 1 }, [0.0, 0.0, 0.75, 0.0, 0.0]),
            (
                Activation::Highest { rules: 3 },
                [0.0, 0.0, 0.75, 0.5, 0.75],
            ),
            (Activation::Lowest { rules: 2 }, [0.25, 0.0, 0.0, 0.5, 0.0]),
            (
                threshold(Comparison::Above, 0.5),
                [0.0, 0.0, 0.75, 0.0, 0.75],
            ),
            (
                threshold(Comparison::AtLeast, 0.5 + 1e-7),
                [0.0, 0.0, 0.75, 0.5, 0.75],
            ),
            (
                threshold(Comparison::Below, 0.5),
                [0.25, 1e-7, 0.0, 0.0, 0.0],
            ),
            (
                threshold(Comparison::AtMost, 0.5),
                [0.25, 1e-7, 0.0, 0.5, 0.0],
            ),
            (
                threshold(Comparison::Equal, 0.75),
                [0.0, 0.0, 0.75, 0.0, 0.75],
            ),
            (
                threshold(Comparison::NotEqual, 0.75),
                [0.25, 1e-7, 0.0, 0.5, 0.0],
            ),
        ] {
            assert_eq!(after(activation, &ALL), expected, "{activation:?}");
        }
    }

    #[test]
    fn shares_sum_to_one() {
        let shares = after(Activation::Proportional, &[0.25, 0.0, 0.75, 0.5]);
        assert_eq!(shares, [0.25 / 1.5, 0.0, 0.5, 0.5 / 1.5]);
        assert_eq!(after(Activation::Proportional, &[0.0, 0.0]), [0.0, 0.0]);
    }
}
