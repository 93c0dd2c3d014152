use alloc::vec;

use crate::Engine;
use crate::model::{
    Aggregation, Defuzzifier, Implication, MembershipFunction, Model, Operators, Output, Variable,
};

/// Returns a model with one output that has these terms. Each term has a rule that always fires, and the firing
/// strength of the rule is the weight given with the term.
pub(super) fn model(
    (low, high): (f64, f64),
    terms: &[(MembershipFunction, f64)],
    (implication, aggregation): (Implication, Aggregation),
    defuzzifier: Defuzzifier,
) -> Model {
    let mut variable = Variable::new("y", low, high);
    for (i, (shape, _)) in terms.iter().enumerate() {
        variable = variable.term(format!("t{i}"), shape.clone());
    }
    let mut output = Output::new(variable);
    output.defuzzifier = defuzzifier;
    let on = MembershipFunction::Rectangle {
        left: 0.0,
        right: 1.0,
    };
    let mut model = Model::builder("test")
        .input(Variable::new("x", 0.0, 1.0).term("on", on))
        .output(output);
    for (i, (_, weight)) in terms.iter().enumerate() {
        let rule = format!("IF x IS on THEN y IS t{i} WITH {weight}");
        model = model.rule(rule.parse().unwrap());
    }
    let mut model = model.build();
    model.operators = Operators {
        implication,
        aggregation,
        ..Operators::default()
    };
    model
}

fn value(
    range: (f64, f64),
    terms: &[(MembershipFunction, f64)],
    operators: (Implication, Aggregation),
    defuzzifier: Defuzzifier,
) -> f64 {
    let engine = Engine::new(&model(range, terms, operators, defuzzifier)).unwrap();
    let outcome = engine.evaluate(&[0.5]).unwrap()[0];
    outcome.value().unwrap_or(f64::NAN)
}

fn gaussian(mean: f64, sd: f64) -> MembershipFunction {
    MembershipFunction::Gaussian { mean, sd }
}

const PRODUCT_SUM: (Implication, Aggregation) = (Implication::Product, Aggregation::Sum);
const PRODUCT_MAXIMUM: (Implication, Aggregation) = (Implication::Product, Aggregation::Maximum);
pub(super) const MINIMUM_MAXIMUM: (Implication, Aggregation) =
    (Implication::Minimum, Aggregation::Maximum);

#[test]
fn a_maximum_close_to_the_end_of_a_piece_is_found() {
    let terms = [(gaussian(52.2, 16.0), 1.0), (gaussian(67.9, 21.1), 0.74)];
    let mean = value((0.0, 100.0), &terms, PRODUCT_SUM, Defuzzifier::MeanOfMaxima);
    // At the maximum, the derivative of the sum is 0.
    let slope = |x: f64| {
        let one = |m: f64, s: f64| (x - m) / (s * s) * (-0.5 * ((x - m) / s).powi(2)).exp();
        one(52.2, 16.0) + 0.74 * one(67.9, 21.1)
    };
    assert!(
        slope(mean - 1e-7) < 0.0 && slope(mean + 1e-7) > 0.0,
        "{mean}"
    );
    assert!((mean - 56.539).abs() < 1e-3, "{mean}");
}

#[test]
fn two_maxima_of_one_height_and_one_between_two_cuts() {
    // Far apart, two terms give a sum with two maxima; close together, one maximum in the middle.
    for (distance, expected) in [(20.0, None), (8.0, Some(50.0))] {
        let terms = [
            (gaussian(50.0 - distance, 10.0), 1.0),
            (gaussian(50.0 + distance, 10.0), 1.0),
        ];
        let of = |defuzzifier| value((0.0, 100.0), &terms, PRODUCT_SUM, defuzzifier);
        let smallest = of(Defuzzifier::SmallestOfMaxima);
        let largest = of(Defuzzifier::LargestOfMaxima);
        assert!(
            (smallest + largest - 100.0).abs() < 1e-9,
            "{smallest} {largest}"
        );
        assert!((of(Defuzzifier::MeanOfMaxima) - 50.0).abs() < 1e-9);
        match expected {
            Some(x) => assert!((smallest - x).abs() < 1e-9, "{smallest}"),
            None => assert!(smallest > 30.0 && smallest < 32.0, "{smallest}"),
        }
    }
}

#[test]
fn a_rounded_top_has_one_maximum() {
    for slope in [0.3, 1.0, 3.0] {
        let bell = MembershipFunction::Bell {
            center: 50.0,
            width: 20.0,
            slope,
        };
        for operators in [PRODUCT_MAXIMUM, PRODUCT_SUM, MINIMUM_MAXIMUM] {
            for defuzzifier in [
                Defuzzifier::SmallestOfMaxima,
                Defuzzifier::MeanOfMaxima,
                Defuzzifier::LargestOfMaxima,
            ] {
                let x = value((0.0, 100.0), &[(bell.clone(), 1.0)], operators, defuzzifier);
                assert!(
                    (x - 50.0).abs() < 1e-7,
                    "{slope} {operators:?} {defuzzifier:?}: {x}"
                );
            }
        }
    }
}

const MAXIMA: [Defuzzifier; 3] = [
    Defuzzifier::SmallestOfMaxima,
    Defuzzifier::MeanOfMaxima,
    Defuzzifier::LargestOfMaxima,
];

#[test]
fn a_bell_has_its_maximum_in_the_middle_under_every_implication() {
    // The flanks are not polynomials.
    let bell = |slope: f64| MembershipFunction::Bell {
        center: 30.1,
        width: 19.3,
        slope,
    };
    for slope in [0.4, 1.284, 1.387, 2.08] {
        for implication in [
            Implication::Hamacher,
            Implication::Einstein,
            Implication::BoundedDifference,
        ] {
            for aggregation in [Aggregation::Maximum, Aggregation::Einstein] {
                for defuzzifier in MAXIMA {
                    let terms = [(bell(slope), 0.8)];
                    let x = value(
                        (0.0, 100.0),
                        &terms,
                        (implication, aggregation),
                        defuzzifier,
                    );
                    assert!(
                        (x - 30.1).abs() < 1e-9,
                        "{slope} {implication:?} {aggregation:?} {defuzzifier:?}: {x}"
                    );
                }
            }
        }
    }
}

#[test]
fn a_maximum_beside_the_middle_of_a_bell() {
    let bell = MembershipFunction::Bell {
        center: 50.0,
        width: 12.0,
        slope: 0.82,
    };
    let ramp = MembershipFunction::RightShoulder {
        foot: 0.0,
        top: 100.0,
    };
    let terms = [(bell, 1.0), (ramp, 0.02)];
    let x = value((0.0, 100.0), &terms, PRODUCT_SUM, Defuzzifier::MeanOfMaxima);
    // The value at which the slope of the bell equals that of the ramp.
    let bell = |t: f64| 1.64 * t.powf(0.64) / 12.0 / (1.0 + t.powf(1.64)).powi(2);
    let (mut low, mut high): (f64, f64) = (0.0, 1.0);
    while low < 0.5 * (low + high) && 0.5 * (low + high) < high {
        let middle = 0.5 * (low + high);
        *(if bell(middle) < 0.02 / 100.0 {
            &mut low
        } else {
            &mut high
        }) = middle;
    }
    assert!((x - 50.0 - 12.0 * low).abs() < 1e-9, "{x}, {low}");
}

#[test]
fn a_nilpotent_minimum_cuts_out_a_plateau() {
    // With a strength of 0.3, the nilpotent minimum leaves only the part of a Gaussian where its degree is above
    // 0.7, and this part has the height 0.3.
    let half = 10.0 * (-2.0 * 0.7_f64.ln()).sqrt();
    for (aggregation, terms) in [
        (Aggregation::Maximum, vec![(gaussian(40.0, 10.0), 0.3)]),
        (Aggregation::Sum, vec![(gaussian(40.0, 10.0), 0.3)]),
        // The same term in combination with a lower one.
        (
            Aggregation::NilpotentMaximum,
            vec![(gaussian(40.0, 10.0), 0.3), (gaussian(80.0, 5.0), 0.2)],
        ),
    ] {
        let of = |defuzzifier| {
            let operators = (Implication::NilpotentMinimum, aggregation);
            value((0.0, 100.0), &terms, operators, defuzzifier)
        };
        for (defuzzifier, expected) in MAXIMA.into_iter().zip([40.0 - half, 40.0, 40.0 + half]) {
            let x = of(defuzzifier);
            assert!(
                (x - expected).abs() < 1e-9,
                "{aggregation:?} {defuzzifier:?}: {x}"
            );
        }
    }
}

#[test]
fn a_strength_equal_to_the_highest_degree_up_to_rounding_cuts_nothing_off() {
    let bell = MembershipFunction::Bell {
        center: 50.0,
        width: 20.0,
        slope: 3.0,
    };
    for operators in [
        MINIMUM_MAXIMUM,
        (Implication::Minimum, Aggregation::Sum),
        (Implication::NilpotentMinimum, Aggregation::Maximum),
    ] {
        for defuzzifier in MAXIMA {
            let of = |strength: f64| {
                let terms = [(bell.clone(), strength)];
                value((0.0, 100.0), &terms, operators, defuzzifier)
            };
            let x = of(1.0 - 2e-16);
            assert!(
                (x - 50.0).abs() < 1e-9,
                "{operators:?} {defuzzifier:?}: {x}"
            );
            // A strength that is lower by more than rounding cuts the term off where its degree equals the strength.
            let cut = 20.0 * 1e-9_f64.powf(1.0 / 6.0);
            let expected = match defuzzifier {
                Defuzzifier::SmallestOfMaxima => 50.0 - cut,
                Defuzzifier::LargestOfMaxima => 50.0 + cut,
                _ => 50.0,
            };
            let x = of(1.0 - 1e-9);
            assert!(
                (x - expected).abs() < 1e-6,
                "{operators:?} {defuzzifier:?}: {x}"
            );
        }
    }
}

#[test]
fn a_drastic_aggregation_is_1_where_two_terms_are_over_the_least_strength() {
    let terms = [(gaussian(30.0, 5.0), 1.0), (gaussian(60.0, 5.0), 1.0)];
    let of = |defuzzifier| {
        let operators = (Implication::Product, Aggregation::Drastic);
        value((-10.0, 100.0), &terms, operators, defuzzifier)
    };
    let reach = 5.0 * (-2.0 * 1e-12_f64.ln()).sqrt();
    assert!((of(Defuzzifier::SmallestOfMaxima) - (60.0 - reach)).abs() < 1e-9);
    assert!((of(Defuzzifier::LargestOfMaxima) - (30.0 + reach)).abs() < 1e-9);
    for defuzzifier in [
        Defuzzifier::MeanOfMaxima,
        Defuzzifier::Centroid,
        Defuzzifier::Bisector,
    ] {
        let x = of(defuzzifier);
        assert!((x - 45.0).abs() < 1e-9, "{defuzzifier:?}: {x}");
    }
}

/// Compares the same set in different units of length.
#[test]
fn wide_and_narrow_ranges_keep_their_precision() {
    let triangle = |unit: f64| MembershipFunction::Triangle {
        left: 0.0,
        peak: 25.0 * unit,
        right: 50.0 * unit,
    };
    let shoulder = |unit: f64| MembershipFunction::RightShoulder {
        foot: 25.0 * unit,
        top: 50.0 * unit,
    };
    for implication in [Implication::Minimum, Implication::Product] {
        for aggregation in [
            Aggregation::Maximum,
            Aggregation::Sum,
            Aggregation::BoundedSum,
            Aggregation::ProbabilisticSum,
        ] {
            for defuzzifier in [
                Defuzzifier::Centroid,
                Defuzzifier::Bisector,
                Defuzzifier::MeanOfMaxima,
            ] {
                for curved in [false, true] {
                    let of = |unit: f64| {
                        let first = if curved {
                            gaussian(25.0 * unit, 12.0 * unit)
                        } else {
                            triangle(unit)
                        };
                        let terms = [(first, 0.4), (shoulder(unit), 0.7)];
                        let range = (0.0, 100.0 * unit);
                        value(range, &terms, (implication, aggregation), defuzzifier) / unit
                    };
                    let expected = of(1.0);
                    for unit in [1e-200, 1e-172, 1e-90, 1e90, 1e158, 1e305] {
                        let x = of(unit);
                        assert!(
                            (x - expected).abs() < 1e-9,
                            "{implication:?} {aggregation:?} {defuzzifier:?} {curved} {unit}: {x}, not {expected}"
                        );
                    }
                }
            }
        }
    }
}

#[test]
fn a_range_without_room_for_digits_is_refused() {
    let terms = [(gaussian(0.0, 1.0), 1.0)];
    let model = model(
        (0.0, 1e-280),
        &terms,
        MINIMUM_MAXIMUM,
        Defuzzifier::Centroid,
    );
    let findings = Engine::new(&model).unwrap_err();
    assert!(findings.to_string().contains("too narrow"), "{findings}");
}
