//! The degrees of membership of all values in an interval.

use alloc::vec::Vec;

use super::formula::{self, Span};
use crate::model::{MembershipFunction, Term};
use crate::rule::Hedge;

/// A term with hedges, and the positions between which its membership functions only rise or only fall.
#[derive(Debug, Clone)]
pub(super) struct RangedLiteral {
    /// The index of the input.
    pub(super) input: usize,
    /// The term; `None` for `any` without a term.
    term: Option<Term>,
    lower_cuts: Vec<f64>,
    upper_cuts: Vec<f64>,
    /// The hedges, in the order in which they are applied.
    hedges: Vec<Hedge>,
}

impl RangedLiteral {
    pub(super) fn new(input: usize, term: Option<Term>, hedges: Vec<Hedge>) -> Self {
        let of_upper = |term: &Term| cuts(&term.membership_function);
        let of_lower = |term: &Term| match &term.lower {
            Some(lower) => cuts(&lower.membership_function),
            None => Vec::new(),
        };
        RangedLiteral {
            input,
            upper_cuts: term.as_ref().map(of_upper).unwrap_or_default(),
            lower_cuts: term.as_ref().map(of_lower).unwrap_or_default(),
            term,
            hedges,
        }
    }

    /// Returns the positions between which the degree is linear; `None` for a literal with hedges, and for a term that
    /// is curved, has a step or is an interval type-2 term.
    pub(super) fn corners(&self) -> Option<Vec<f64>> {
        let term = self.term.as_ref()?;
        let corners = term.membership_function.corners()?;
        let mut positions: Vec<f64> = corners.into_iter().map(|(x, _)| x).collect();
        let count = positions.len();
        positions.dedup();
        let is_linear = self.hedges.is_empty() && term.lower.is_none();
        (is_linear && positions.len() == count).then_some(positions)
    }

    /// Returns the smallest and the largest degree of the values in an interval.
    pub(super) fn degrees(&self, low: f64, high: f64) -> (f64, f64) {
        let bare = match &self.term {
            None => (1.0, 1.0),
            Some(term) => {
                let of_upper = range(&term.membership_function, &self.upper_cuts, low, high);
                let of_lower = match &term.lower {
                    None => term.height * of_upper.0,
                    Some(lower) => {
                        let function = &lower.membership_function;
                        lower.height * range(function, &self.lower_cuts, low, high).0
                    }
                };
                (of_lower, term.height * of_upper.1)
            }
        };
        self.hedges.iter().fold(bare, |(low, high), hedge| {
            let (of_low, of_high) = (hedge.of(low), hedge.of(high));
            match hedge {
                Hedge::Not => (of_high, of_low),
                Hedge::Very | Hedge::Somewhat | Hedge::Extremely | Hedge::Seldom | Hedge::Any => {
                    (of_low, of_high)
                }
            }
        })
    }
}

/// Returns the positions of extrema and steps, each with the next smaller and the next larger number. The degrees at
/// these two numbers are the limits from both sides of a step.
fn cuts(function: &MembershipFunction) -> Vec<f64> {
    let cuts = function.cuts().into_iter();
    cuts.flat_map(|x| [x.next_down(), x, x.next_up()]).collect()
}

/// Returns the smallest and the largest degree of the values in an interval. `cuts` is the result of [`cuts`].
fn range(function: &MembershipFunction, cuts: &[f64], low: f64, high: f64) -> (f64, f64) {
    use MembershipFunction as F;
    let alone = |function: F| range(&function, &[], low, high);
    match *function {
        // Products and differences of monotone functions, whose extrema have no closed form.
        F::SigmoidProduct {
            left_inflection,
            left_slope,
            right_inflection,
            right_slope,
        } => {
            let (left, right) = (
                alone(sigmoid(left_inflection, left_slope)),
                alone(sigmoid(right_inflection, right_slope)),
            );
            (left.0 * right.0, left.1 * right.1)
        }
        F::SigmoidDifference {
            left_inflection,
            left_slope,
            right_inflection,
            right_slope,
        } => {
            let (left, right) = (
                alone(sigmoid(left_inflection, left_slope)),
                alone(sigmoid(right_inflection, right_slope)),
            );
            let (least, most) = (left.0 - right.1, left.1 - right.0);
            let nearest = if least > 0.0 {
                least
            } else if most < 0.0 {
                -most
            } else {
                0.0
            };
            (nearest, libm::fmax(most, -least))
        }
        F::Gaussian2 {
            left_mean,
            left_sd,
            right_mean,
            right_sd,
        } => {
            let half = |mean: f64, sd: f64, from: f64, to: f64| {
                let gaussian = F::Gaussian { mean, sd };
                (gaussian.membership(from), gaussian.membership(to))
            };
            let left = half(left_mean, left_sd, low.min(left_mean), high.min(left_mean));
            let right = half(
                right_mean,
                right_sd,
                high.max(right_mean),
                low.max(right_mean),
            );
            (left.0 * right.0, left.1 * right.1)
        }
        F::Function { ref formula } => {
            let span = formula::range(formula, |_| Span::between(low, high));
            // A degree that is not a number is 0.
            let least = if span.may_be_undefined { 0.0 } else { span.low };
            (least.clamp(0.0, 1.0), span.high.clamp(0.0, 1.0))
        }
        _ => {
            let inside = cuts.iter().copied().filter(|x| low < *x && *x < high);
            let all = inside.chain([low, high]);
            let degrees = all.map(|x| function.membership(x));
            degrees.fold((1.0, 0.0), |(least, most), degree| {
                (libm::fmin(least, degree), libm::fmax(most, degree))
            })
        }
    }
}

fn sigmoid(inflection: f64, slope: f64) -> MembershipFunction {
    MembershipFunction::Sigmoid { inflection, slope }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn degrees_of_an_interval() {
        let of = |text: &str, low: f64, high: f64| {
            let model: crate::Model = format!(
                "{{fuzzy: 1, name: n, inputs: {{x: {{range: [0, 10], terms: {{t: {text}}}}}}}, outputs: {{y: {{range: [0, 1], partition: [a, b]}}}}, rules: [IF x IS t THEN y IS a]}}"
            )
            .parse()
            .unwrap();
            let term = model.inputs[0].terms[0].clone();
            for hedges in [Vec::new(), Vec::from([Hedge::Very, Hedge::Not])] {
                let literal = RangedLiteral::new(0, Some(term.clone()), hedges.clone());
                let (least, most) = literal.degrees(low, high);
                for i in 0..=1000 {
                    let x = low + (high - low) * (f64::from(i) / 1000.0);
                    let hedged = |degree: f64| hedges.iter().fold(degree, |x, hedge| hedge.of(x));
                    for degree in [hedged(term.membership(x)), hedged(term.lower_membership(x))] {
                        assert!(
                            (least - 1e-15..=most + 1e-15).contains(&degree),
                            "{text} {x}"
                        );
                    }
                }
            }
            RangedLiteral::new(0, Some(term), Vec::new()).degrees(low, high)
        };
        assert_eq!(of("{triangle: [2, 4, 8]}", 3.0, 6.0), (0.5, 1.0));
        assert_eq!(of("{triangle: [2, 4, 8]}", 5.0, 6.0), (0.5, 0.75));
        assert_eq!(of("{rectangle: [2, 4], height: 0.5}", 3.0, 6.0), (0.0, 0.5));
        assert_eq!(of("{singleton: 4}", 3.0, 6.0), (0.0, 1.0));
        let step = of(
            "{piecewise: [[2, 0.25], [4, 1], [4, 0.5], [6, 0.75]]}",
            3.0,
            9.0,
        );
        assert!((step.0 - 0.5).abs() < 1e-15 && step.1 == 1.0, "{step:?}");
        assert_eq!(
            of(
                "{upper: {triangle: [2, 4, 8]}, lower: {triangle: [3, 4, 6]}}",
                3.5,
                5.0
            ),
            (0.5, 1.0)
        );
        of(
            "{gaussian2: {left_mean: 6, left_sd: 1, right_mean: 3, right_sd: 2}}",
            2.0,
            8.0,
        );
        of(
            "{sigmoid_difference: {left_inflection: 2, left_slope: 3, right_inflection: 5, right_slope: 1}}",
            1.0,
            9.0,
        );
        of(
            "{sigmoid_product: {left_inflection: 2, left_slope: 3, right_inflection: 5, right_slope: -1}}",
            1.0,
            9.0,
        );
        of("{pi_shape: [1, 3, 4, 9]}", 2.0, 8.0);
        of("{cosine: {center: 3, width: 4}}", 2.0, 4.0);
        of("{semi_ellipse: [3, 4]}", 2.0, 4.0);
        of(
            "{function: 'abs(sin(x)) * exp(-x / 4) + sqrt(x - 3) / 9'}",
            2.0,
            4.0,
        );
        of("{gaussian: {mean: [4, 5], sd: [1, 2]}}", 2.0, 7.0);
    }
}
