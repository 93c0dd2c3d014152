use super::*;
use alloc::vec;
use proptest::prelude::*;

const RANGE: (f64, f64) = (0.0, 100.0);

fn line(places: usize) -> Knots {
    let last = (places - 1) as f64;
    Knots::over(
        vec![(0..places).map(|i| i as f64 / last).collect()],
        vec![1.0],
    )
}

#[test]
fn a_gap_between_two_knots_is_interpolated() {
    let filled = |method| {
        let known = [Some(0.0), None, None, None, Some(100.0)];
        assert_eq!(distances(&line(5), &known), [0.0, 0.25, 0.5, 0.25, 0.0]);
        fill(&line(5), &known, RANGE, method)
    };
    assert_eq!(filled(GapMethod::Nearest)[1], 0.0);
    assert_eq!(filled(GapMethod::Nearest)[3], 100.0);
    // If two knots are equally near, the one with the higher value is used.
    assert_eq!(filled(GapMethod::Nearest)[2], 100.0);
    // 100 (1/0.75^2) / (1/0.25^2 + 1/0.75^2) = 10
    approx::assert_abs_diff_eq!(filled(GapMethod::INVERSE_DISTANCE)[1], 10.0, epsilon = 1e-9);
    approx::assert_abs_diff_eq!(filled(GapMethod::INVERSE_DISTANCE)[2], 50.0, epsilon = 1e-9);
    for (i, expected) in [0.0, 25.0, 50.0, 75.0, 100.0].into_iter().enumerate() {
        approx::assert_abs_diff_eq!(filled(GapMethod::Harmonic)[i], expected, epsilon = 1e-4);
    }
}

#[test]
fn beyond_the_outermost_peaks_only_the_distance_changes() {
    let text = "
fuzzy: 1
name: test
inputs: {x: {range: [0, 1], partition: {low: 0.5, middle: 0.6, high: 0.8}}}
outputs: {y: {range: [0, 100], partition: [small, medium, large]}}
rules: [IF x IS middle THEN y IS medium, IF x IS high THEN y IS large]
";
    let model = fuzzy::yaml::parse(text).unwrap().model;
    let engine = Engine::new(&model).unwrap();
    let filling = Filling::new(&engine, &model, 0, &GapSettings::default()).unwrap();
    let read = |x| filling.read(&[x]).unwrap();
    assert_eq!(read(0.0).value, read(0.5).value);
    approx::assert_abs_diff_eq!(read(0.5).distance, 0.05, epsilon = 1e-12);
    approx::assert_abs_diff_eq!(read(0.1).distance, 0.45, epsilon = 1e-12);
}

#[test]
fn with_very_many_inputs_a_gap_is_unknown() {
    let many = |list: &dyn Fn(i32) -> String, between: &str| {
        (0..24).map(list).collect::<Vec<String>>().join(between)
    };
    let inputs = many(
        &|i| format!("x{i}: {{range: [0, 1], partition: [low, high]}}"),
        ", ",
    );
    let read = |condition: &str| {
        let text = format!(
            "
fuzzy: 1
name: many
inputs: {{{inputs}}}
outputs: {{y: {{range: [0, 100], partition: [low, high]}}}}
rules: [IF {condition} THEN y IS low]
"
        );
        let model = fuzzy::yaml::parse(&text).unwrap().model;
        let engine = Engine::new(&model).unwrap();
        let filling = Filling::new(&engine, &model, 0, &GapSettings::default()).unwrap();
        filling.read(&[1.0; 24])
    };
    assert_eq!(read(&many(&|i| format!("x{i} IS low"), " AND ")), None);
    // Inputs that no rule reads do not count towards the limit.
    assert!(read("x0 IS low").is_some());
}

/// Fills the map of the paper's ten rules, in which no rule covers one corner, and compares the result with values
/// that were computed independently, with numpy, from the same definitions.
#[test]
fn the_papers_corner_has_the_independently_computed_values() {
    let model = crate::shipped::flagred_paper_rules();
    let engine = Engine::new(&model).unwrap();
    for (method, expected) in [
        (GapMethod::Nearest, [90.30, 79.57, 63.46, 50.0]),
        (GapMethod::INVERSE_DISTANCE, [81.93, 76.34, 65.92, 42.56]),
        (GapMethod::ThinPlate, [84.13, 75.15, 58.93, 36.74]),
        (GapMethod::Harmonic, [82.55, 75.92, 63.71, 46.12]),
    ] {
        let settings = GapSettings {
            method,
            coverage_below: None,
        };
        let filling = Filling::new(&engine, &model, 0, &settings).unwrap();
        let points = [[0.0, 0.0], [0.02, 0.01], [0.05, 0.0], [0.1, 0.0]];
        for (point, expected) in points.iter().zip(expected) {
            let value = filling.read(point).unwrap().value;
            approx::assert_abs_diff_eq!(value, expected, epsilon = 0.05);
        }
    }
}

proptest! {
    #![proptest_config(ProptestConfig::with_cases(32))]

    #[test]
    fn covered_knots_stay_and_averages_cannot_overshoot(
        known in prop::collection::vec(prop::option::of(0.0..100.0f64), 3 * 4 * 5),
    ) {
        let places = |n: u32| (0..n).map(|i| f64::from(i * i)).collect::<Vec<f64>>();
        let grid = Knots::over(vec![places(3), places(4), places(5)], vec![4.0, 9.0, 16.0]);
        prop_assume!(known.iter().any(Option::is_some));
        let low = known.iter().flatten().copied().fold(f64::MAX, f64::min);
        let high = known.iter().flatten().copied().fold(f64::MIN, f64::max);
        for (known, distance) in known.iter().zip(distances(&grid, &known)) {
            prop_assert_eq!(distance == 0.0, known.is_some());
        }
        for method in GapMethod::ALL {
            for (known, value) in known.iter().zip(fill(&grid, &known, RANGE, method)) {
                match known {
                    Some(known) => prop_assert_eq!(value, *known),
                    None if method == GapMethod::ThinPlate => {
                        prop_assert!((0.0..=100.0).contains(&value));
                    }
                    None => prop_assert!(value >= low - 1e-9 && value <= high + 1e-9),
                }
            }
        }
    }
}
