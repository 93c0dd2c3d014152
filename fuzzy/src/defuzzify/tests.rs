use crate::Engine;
use crate::model::{
    Aggregation, Defuzzifier, Implication, MembershipFunction, Model, Operators, Output, Variable,
};

/// An output of these terms, with a rule for each that fires with its weight.
fn model(
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
const MINIMUM_MAXIMUM: (Implication, Aggregation) = (Implication::Minimum, Aggregation::Maximum);

#[test]
fn a_maximum_close_to_the_end_of_a_piece_is_found() {
    let terms = [(gaussian(52.2, 16.0), 1.0), (gaussian(67.9, 21.1), 0.74)];
    let mean = value((0.0, 100.0), &terms, PRODUCT_SUM, Defuzzifier::MeanOfMaxima);
    // Where the derivative of the sum is 0.
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
    // Apart, a sum has two maxima; close to each other, one in the middle.
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

/// The same set, in any unit of length.
#[test]
fn wide_and_narrow_ranges() {
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
