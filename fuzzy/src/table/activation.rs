//! Activation methods: which rules of a block fire, and how strongly.

use super::Partial;

/// Firing strengths below this are 0 where a rule set does not say otherwise: it is what rounding leaves of an exact 0, as in
/// `x IS a AND x IS not a` under `bounded_difference`.
pub const LEAST_STRENGTH: f64 = 1e-12;

/// Which rules of a block fire, and how strongly, from the weighted degrees of their antecedents. As in fuzzylite 7.
///
/// A strength below the least strength of the rule set never fires, and two strengths nearer than that are equal.
#[derive(Debug, Clone, Copy, PartialEq, Default)]
pub enum Activation {
    /// All rules.
    #[default]
    General,
    /// The first rules, in the order of the rule set, whose strength is at least `at_least`.
    First {
        /// How many.
        rules: u32,
        /// Their least strength.
        at_least: f64,
    },
    /// The last rules whose strength is at least `at_least`.
    Last {
        /// How many.
        rules: u32,
        /// Their least strength.
        at_least: f64,
    },
    /// The strongest rules; of equal ones the first.
    Highest {
        /// How many.
        rules: u32,
    },
    /// The weakest rules that fire; of equal ones the first.
    Lowest {
        /// How many.
        rules: u32,
    },
    /// All rules, with the strength divided by the sum of all strengths of the block.
    Proportional,
    /// The rules whose strength compares so with a number.
    Threshold {
        /// How.
        comparison: Comparison,
        /// The number.
        strength: f64,
    },
}

/// How a firing strength compares with a threshold.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub enum Comparison {
    /// `<`
    Below,
    /// `<=`
    AtMost,
    /// `=`
    Equal,
    /// Not equal.
    NotEqual,
    /// `>=`
    AtLeast,
    /// `>`
    Above,
}

impl Activation {
    /// Changes the strengths of all rules of a block, which stand in the order of the rules, to those with which they fire. A
    /// rule that does not fire has a strength below `least`.
    pub(crate) fn activate(self, least: f64, rules: &mut [Partial]) {
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
                    if !comparison.holds(rule.degree[0], strength, least) {
                        rule.degree[0] = 0.0;
                    }
                }
            }
        }
    }
}

/// Keeps the first so many that fire with at least a strength.
fn first<'a>(count: u32, at_least: f64, least: f64, rules: impl Iterator<Item = &'a mut Partial>) {
    let mut left = count;
    for rule in rules {
        let fires =
            rule.degree[0] >= least && Comparison::AtLeast.holds(rule.degree[0], at_least, least);
        if fires && left > 0 {
            left -= 1;
        } else {
            rule.degree[0] = 0.0;
        }
    }
}

impl Comparison {
    /// Whether it holds, where numbers nearer than `least` are equal.
    fn holds(self, strength: f64, threshold: f64, least: f64) -> bool {
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

    /// The strengths with which rules of these strengths fire.
    fn after(activation: Activation, strengths: &[f64]) -> Vec<f64> {
        let rules = strengths.iter().zip(0..);
        let mut rules: Vec<Partial> = rules
            .map(|(&degree, at)| Partial::new(degree, at))
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
    fn values_by_hand() {
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
