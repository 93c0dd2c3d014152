use alloc::{vec, vec::Vec};

use crate::Engine;
use crate::defuzzify::tests::{MINIMUM_MAXIMUM, model};
use crate::model::{Defuzzifier, MembershipFunction};
use crate::table::ClosedForm;

/// Returns the centroid of the maximum of triangles `(left, peak, right)` cut at their firing strengths, integrated
/// between the values at which the set has corners.
fn centroid_between_bends((low, high): (f64, f64), terms: &[([f64; 3], f64)]) -> f64 {
    let degree = |[left, peak, right]: [f64; 3], x: f64| {
        let (rising, falling) = ((x - left) / (peak - left), (right - x) / (right - peak));
        rising.min(falling).max(0.0)
    };
    let set = |x: f64| {
        let cut = terms.iter().map(|(term, h)| degree(*term, x).min(*h));
        cut.fold(0.0, f64::max)
    };
    let mut bends = vec![low, high];
    for ([left, peak, right], _) in terms {
        bends.extend([left, peak, right]);
        for (_, h) in terms {
            bends.extend([left + h * (peak - left), right - h * (right - peak)]);
        }
        for ([other, top, end], _) in terms {
            // Adds the crossing of two flanks: one through (a, 0) with the width w, one through (b, 0) with the width v.
            for (a, w) in [(left, peak - left), (right, peak - right)] {
                for (b, v) in [(other, top - other), (end, top - end)] {
                    bends.push((b * w - a * v) / (w - v));
                }
            }
        }
    }
    bends.retain(|x| low <= *x && *x <= high);
    bends.sort_by(f64::total_cmp);
    let (mut area, mut moment) = (0.0, 0.0);
    for ends in bends.windows(2) {
        let (from, to) = (ends[0], ends[1]);
        let (middle, width) = (0.5 * (from + to), to - from);
        // Simpson's rule is exact here, because the integrands are linear functions and their
        // products with x.
        let (a, b) = (set(from), set(to));
        area += width * 0.5 * (a + b);
        moment += width * (a * from + 2.0 * (a + b) * middle + b * to) / 6.0;
    }
    moment / area
}

#[test]
fn layers_have_the_centroid_of_the_set() {
    let mut state = 7_u64;
    let mut random = || {
        state = state
            .wrapping_mul(6_364_136_223_846_793_005)
            .wrapping_add(1_442_695_040_888_963_407);
        (state >> 11) as f64 / (1_u64 << 53) as f64
    };
    for round in 0..2000 {
        let (low, high) = [(0.0, 100.0), (-3e-6, 1e-6), (1e9, 3e9)][round % 3];
        let at = |share: f64| low + share * (high - low);
        let terms: Vec<([f64; 3], f64)> = (0..1 + round % 14)
            .map(|_| {
                let peak = 1.4 * random() - 0.2;
                let corners = [peak - 0.25 - random(), peak, peak + 0.25 + random()];
                let strength = match (random() * 5.0) as u32 {
                    0 => 0.0,
                    1 => 1e-3 * (1.0 + random()),
                    2 => 1.0,
                    _ => random(),
                };
                (corners.map(at), strength)
            })
            .collect();
        let shapes: Vec<(MembershipFunction, f64)> = terms
            .iter()
            .map(|&([left, peak, right], weight)| {
                (MembershipFunction::Triangle { left, peak, right }, weight)
            })
            .collect();
        let range = (low, high);
        let model = model(range, &shapes, MINIMUM_MAXIMUM, Defuzzifier::Centroid);
        let engine = Engine::new(&model).unwrap();
        let form = engine.table().unwrap().outputs[0].form();
        let is_layered = form == ClosedForm::Layers;
        assert!(is_layered || form == ClosedForm::Partition, "{form:?}");
        let Some(value) = engine.evaluate(&[0.5]).unwrap()[0].value() else {
            assert!(terms.iter().all(|(_, strength)| *strength == 0.0));
            continue;
        };
        let expected = centroid_between_bends(range, &terms);
        assert!(
            (value - expected).abs() <= 1e-12 * (high - low),
            "{round}: {value} {expected} {terms:?}"
        );
    }
}
