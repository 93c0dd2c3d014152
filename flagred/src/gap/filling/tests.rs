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
fn a_gap_between_two_knots_takes_from_both() {
    let filled = |method| {
        let values = vec![0.0, -1.0, -1.0, -1.0, 100.0];
        let covered = vec![true, false, false, false, true];
        let (values, distances) = fill(&line(5), values, covered, RANGE, method);
        assert_eq!(distances, [0.0, 0.25, 0.5, 0.25, 0.0]);
        values
    };
    assert_eq!(filled(GapMethod::Nearest)[1], 0.0);
    assert_eq!(filled(GapMethod::Nearest)[3], 100.0);
    // Of two that are equally near the higher one.
    assert_eq!(filled(GapMethod::Nearest)[2], 100.0);
    // 100 (1/0.75^2) / (1/0.25^2 + 1/0.75^2) = 10
    approx::assert_abs_diff_eq!(filled(GapMethod::INVERSE_DISTANCE)[1], 10.0, epsilon = 1e-9);
    approx::assert_abs_diff_eq!(filled(GapMethod::INVERSE_DISTANCE)[2], 50.0, epsilon = 1e-9);
    for (i, expected) in [0.0, 25.0, 50.0, 75.0, 100.0].into_iter().enumerate() {
        approx::assert_abs_diff_eq!(filled(GapMethod::Harmonic)[i], expected, epsilon = 1e-4);
    }
}

/// The table of the paper's ten rules at the knots, its corner left out, and what fills it: computed apart from this
/// program (numpy), from the same definitions.
#[test]
fn the_papers_corner_is_as_computed_elsewhere() {
    let model = crate::shipped::rule_set("flagred-paper").unwrap().unwrap();
    let engine = Engine::new(&model).unwrap();
    for (method, expected) in [
        (GapMethod::Nearest, [90.30, 79.57, 63.46, 50.0]),
        (GapMethod::INVERSE_DISTANCE, [84.76, 77.46, 65.21, 45.48]),
        (GapMethod::ThinPlate, [85.85, 76.57, 60.77, 39.89]),
        (GapMethod::Harmonic, [85.65, 77.51, 64.03, 47.67]),
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
        knots in prop::collection::vec((any::<bool>(), 0.0..100.0f64), 3 * 4 * 5),
    ) {
        let places = |n: u32| (0..n).map(|i| f64::from(i * i)).collect::<Vec<f64>>();
        let grid = Knots::over(vec![places(3), places(4), places(5)], vec![4.0, 9.0, 16.0]);
        let covered: Vec<bool> = knots.iter().map(|k| k.0).collect();
        let original: Vec<f64> = knots.iter().map(|k| k.1).collect();
        prop_assume!(covered.contains(&true));
        let known = || (0..60).filter(|i| covered[*i]).map(|i| original[i]);
        let (low, high) = (known().fold(f64::MAX, f64::min), known().fold(f64::MIN, f64::max));
        for method in GapMethod::ALL {
            let (values, distances) = fill(&grid, original.clone(), covered.clone(), RANGE, method);
            for i in 0..60 {
                prop_assert_eq!(distances[i] == 0.0, covered[i]);
                if covered[i] {
                    prop_assert_eq!(values[i], original[i]);
                } else if method == GapMethod::ThinPlate {
                    prop_assert!((0.0..=100.0).contains(&values[i]));
                } else {
                    prop_assert!(values[i] >= low - 1e-9 && values[i] <= high + 1e-9);
                }
            }
        }
    }
}
