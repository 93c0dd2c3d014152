//! The formulas of membership functions, as docs/rule-sets.md has them.

use std::f64::consts::PI;

use fuzzy::model::MembershipFunction;

/// The places at which a shape has a parameter.
pub(super) fn parameters(shape: &MembershipFunction) -> Vec<f64> {
    match *shape {
        MembershipFunction::Triangle { left, peak, right } => vec![left, peak, right],
        MembershipFunction::Trapezoid {
            left,
            left_top,
            right_top,
            right,
        }
        | MembershipFunction::PiShape {
            left,
            left_top,
            right_top,
            right,
        } => vec![left, left_top, right_top, right],
        MembershipFunction::LeftShoulder { top, foot }
        | MembershipFunction::RightShoulder { foot, top }
        | MembershipFunction::SShape { foot, top }
        | MembershipFunction::ZShape { top, foot } => vec![top, foot],
        MembershipFunction::Rectangle { left, right } => vec![left, right],
        MembershipFunction::Piecewise { ref points } => {
            points.iter().map(|point| point.0).collect()
        }
        MembershipFunction::Gaussian { mean, .. } => vec![mean],
        MembershipFunction::Gaussian2 {
            left_mean,
            right_mean,
            ..
        } => vec![left_mean, right_mean],
        MembershipFunction::Bell { center, .. } | MembershipFunction::Spike { center, .. } => {
            vec![center]
        }
        MembershipFunction::Cosine { center, width } => {
            vec![center - width / 2.0, center, center + width / 2.0]
        }
        MembershipFunction::Concave { end, .. } => vec![end],
        MembershipFunction::Arc { start, end } => vec![start, end],
        MembershipFunction::SemiEllipse { left, right } => vec![left, right],
        MembershipFunction::Sigmoid { inflection, .. } => vec![inflection],
        MembershipFunction::SigmoidDifference {
            left_inflection,
            right_inflection,
            ..
        }
        | MembershipFunction::SigmoidProduct {
            left_inflection,
            right_inflection,
            ..
        } => vec![left_inflection, right_inflection],
        MembershipFunction::Singleton { .. }
        | MembershipFunction::Function { .. }
        | MembershipFunction::Constant { .. }
        | MembershipFunction::Linear { .. } => vec![],
    }
}

pub(super) fn membership(shape: &MembershipFunction, x: f64) -> f64 {
    let sigmoid = |inflection: f64, slope: f64| 1.0 / (1.0 + (-slope * (x - inflection)).exp());
    let gaussian = |mean: f64, sd: f64| (-(x - mean).powi(2) / (2.0 * sd.powi(2))).exp();
    // An S from a to b, by its two parabolas.
    let s = |a: f64, b: f64| {
        if x <= a && a < b {
            0.0
        } else if x >= b {
            1.0
        } else if x < (a + b) / 2.0 {
            2.0 * ((x - a) / (b - a)).powi(2)
        } else {
            1.0 - 2.0 * ((x - b) / (b - a)).powi(2)
        }
    };
    let z = |a: f64, b: f64| {
        if x <= a {
            1.0
        } else if x >= b {
            0.0
        } else if x < (a + b) / 2.0 {
            1.0 - 2.0 * ((x - a) / (b - a)).powi(2)
        } else {
            2.0 * ((x - b) / (b - a)).powi(2)
        }
    };
    let trapezoid = |a: f64, b: f64, c: f64, d: f64| {
        if b <= x && x <= c {
            1.0
        } else if a < x && x < b {
            (x - a) / (b - a)
        } else if c < x && x < d {
            (d - x) / (d - c)
        } else {
            0.0
        }
    };
    match *shape {
        MembershipFunction::Triangle { left, peak, right } => trapezoid(left, peak, peak, right),
        MembershipFunction::Trapezoid {
            left,
            left_top,
            right_top,
            right,
        } => trapezoid(left, left_top, right_top, right),
        MembershipFunction::LeftShoulder { top, foot } => trapezoid(-1e9, -1e9, top, foot),
        MembershipFunction::RightShoulder { foot, top } => trapezoid(foot, top, 1e9, 1e9),
        MembershipFunction::Rectangle { left, right } => trapezoid(left, left, right, right),
        MembershipFunction::Singleton { at } => f64::from(x == at),
        MembershipFunction::Piecewise { ref points } => {
            let at = points
                .iter()
                .filter(|point| point.0 == x)
                .map(|point| point.1);
            let before = points.iter().rev().find(|point| point.0 < x);
            let after = points.iter().find(|point| point.0 > x);
            match (at.reduce(f64::max), before, after) {
                (Some(y), _, _) => y,
                (_, Some(a), Some(b)) => a.1 + (b.1 - a.1) * (x - a.0) / (b.0 - a.0),
                (_, Some(only), None) | (_, None, Some(only)) => only.1,
                (_, None, None) => 0.0,
            }
        }
        MembershipFunction::Gaussian { mean, sd } => gaussian(mean, sd),
        MembershipFunction::Gaussian2 {
            left_mean,
            left_sd,
            right_mean,
            right_sd,
        } => {
            let mut product = 1.0;
            if x < left_mean {
                product *= gaussian(left_mean, left_sd);
            }
            if x > right_mean {
                product *= gaussian(right_mean, right_sd);
            }
            product
        }
        MembershipFunction::Bell {
            center,
            width,
            slope,
        } => 1.0 / (1.0 + ((x - center) / width).abs().powf(2.0 * slope)),
        MembershipFunction::Sigmoid { inflection, slope } => sigmoid(inflection, slope),
        MembershipFunction::SigmoidDifference {
            left_inflection,
            left_slope,
            right_inflection,
            right_slope,
        } => (sigmoid(left_inflection, left_slope) - sigmoid(right_inflection, right_slope)).abs(),
        MembershipFunction::SigmoidProduct {
            left_inflection,
            left_slope,
            right_inflection,
            right_slope,
        } => sigmoid(left_inflection, left_slope) * sigmoid(right_inflection, right_slope),
        MembershipFunction::SShape { foot, top } => s(foot, top),
        MembershipFunction::ZShape { top, foot } => z(top, foot),
        MembershipFunction::PiShape {
            left,
            left_top,
            right_top,
            right,
        } => s(left, left_top).min(z(right_top, right)),
        MembershipFunction::Cosine { center, width } if (x - center).abs() > width / 2.0 => 0.0,
        MembershipFunction::Cosine { center, width } => {
            (1.0 + (2.0 / width * PI * (x - center)).cos()) / 2.0
        }
        MembershipFunction::Spike { center, width } => (-(10.0 / width * (x - center)).abs()).exp(),
        MembershipFunction::Concave { inflection, end } if inflection <= end && x < end => {
            (end - inflection) / (2.0 * end - inflection - x)
        }
        MembershipFunction::Concave { inflection, end } if inflection > end && x > end => {
            (inflection - end) / (inflection - 2.0 * end + x)
        }
        MembershipFunction::Concave { .. } => 1.0,
        MembershipFunction::Arc { start, end } => {
            // The height of a circle of radius |end - start| around `end`, divided by the radius.
            let radius = (end - start).abs();
            let passed = (x - end) * (end - start) >= 0.0;
            let away = if passed {
                0.0
            } else {
                (x - end).abs().min(radius)
            };
            (radius.powi(2) - away.powi(2)).sqrt() / radius
        }
        MembershipFunction::SemiEllipse { left, right } => {
            let (centre, radius) = ((left + right) / 2.0, (right - left) / 2.0);
            let away = (x - centre).abs().min(radius);
            (radius.powi(2) - away.powi(2)).sqrt() / radius
        }
        MembershipFunction::Function { ref formula } => {
            let degree = formula.evaluate(|_| x);
            if degree.is_nan() {
                0.0
            } else {
                degree.clamp(0.0, 1.0)
            }
        }
        MembershipFunction::Constant { value } => value,
        MembershipFunction::Linear { .. } => 0.0,
    }
}
