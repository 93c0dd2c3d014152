//! The formulas of membership functions, as in docs/rule-sets.md.

use std::f64::consts::PI;

use fuzzy::model::MembershipFunction;

use super::number::Number;

/// The parameters of a shape that are positions on the axis, and positions that follow directly from its parameters.
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
        MembershipFunction::SemiEllipse { left, right } => {
            vec![left, (left + right) / 2.0, right]
        }
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

/// The degree at `x`; with a dual number also its slope.
pub(super) fn membership<T: Number>(shape: &MembershipFunction, x: T) -> T {
    let (at, n) = (x.value(), T::of);
    let (zero, one, two) = (n(0.0), n(1.0), n(2.0));
    // 1 / (1 + e^-t). Where it is near 1, this form avoids cancellation in its slope.
    let sigmoid = |inflection: f64, slope: f64| {
        let t = n(slope) * (x - n(inflection));
        if t.value() > 0.0 {
            one - one / (one + t.exp())
        } else {
            one / (one + (-t).exp())
        }
    };
    let gaussian = |mean: f64, sd: f64| {
        let z = (x - n(mean)) / n(sd);
        (-(z * z) / two).exp()
    };
    // An S-shape from a to b, by its two parabolas.
    let s = |a: f64, b: f64| {
        let square = |from: f64| {
            let t = (x - n(from)) / n(b - a);
            two * t * t
        };
        if at <= a && a < b {
            zero
        } else if at >= b {
            one
        } else if at < (a + b) / 2.0 {
            square(a)
        } else {
            one - square(b)
        }
    };
    let z = |a: f64, b: f64| {
        if at <= a {
            one
        } else if at >= b {
            zero
        } else {
            one - s(a, b)
        }
    };
    let trapezoid = |a: f64, b: f64, c: f64, d: f64| {
        if b <= at && at <= c {
            one
        } else if a < at && at < b {
            (x - n(a)) / n(b - a)
        } else if c < at && at < d {
            (n(d) - x) / n(d - c)
        } else {
            zero
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
        MembershipFunction::Singleton { at: place } => n(f64::from(at == place)),
        MembershipFunction::Piecewise { ref points } => {
            let here = points.iter().filter(|point| point.0 == at);
            let before = points.iter().rev().find(|point| point.0 < at);
            let after = points.iter().find(|point| point.0 > at);
            match (here.map(|point| point.1).reduce(f64::max), before, after) {
                (Some(y), _, _) => n(y),
                (_, Some(a), Some(b)) => n(a.1) + n((b.1 - a.1) / (b.0 - a.0)) * (x - n(a.0)),
                (_, Some(only), None) | (_, None, Some(only)) => n(only.1),
                (_, None, None) => zero,
            }
        }
        MembershipFunction::Gaussian { mean, sd } => gaussian(mean, sd),
        MembershipFunction::Gaussian2 {
            left_mean,
            left_sd,
            right_mean,
            right_sd,
        } => {
            let mut product = one;
            if at < left_mean {
                product = product * gaussian(left_mean, left_sd);
            }
            if at > right_mean {
                product = product * gaussian(right_mean, right_sd);
            }
            product
        }
        MembershipFunction::Bell {
            center,
            width,
            slope,
        } => one / (one + ((x - n(center)) / n(width)).abs().powf(2.0 * slope)),
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
        MembershipFunction::Cosine { center, width } if (at - center).abs() > width / 2.0 => zero,
        MembershipFunction::Cosine { center, width } => {
            (one + (n(2.0 / width * PI) * (x - n(center))).cos()) / two
        }
        MembershipFunction::Spike { center, width } => {
            (-(n(10.0 / width) * (x - n(center))).abs()).exp()
        }
        MembershipFunction::Concave { inflection, end }
            if inflection <= end && at < end || inflection > end && at > end =>
        {
            n(end - inflection) / (n(2.0 * end - inflection) - x)
        }
        MembershipFunction::Concave { .. } => one,
        MembershipFunction::Arc { start, end } => {
            // The height of a circle of radius |end - start| around `end`, divided by the radius.
            let away = (x - n(end)) / n(start - end);
            let away = away.max(zero).min(one);
            (one - away * away).sqrt()
        }
        MembershipFunction::SemiEllipse { left, right } => {
            let (centre, radius) = ((left + right) / 2.0, (right - left) / 2.0);
            let away = ((x - n(centre)) / n(radius)).abs().min(one);
            (one - away * away).sqrt()
        }
        MembershipFunction::Function { ref formula } => {
            let degree = formula.evaluate(|_| at);
            n(if degree.is_nan() {
                0.0
            } else {
                degree.clamp(0.0, 1.0)
            })
        }
        MembershipFunction::Constant { value } => n(value),
        MembershipFunction::Linear { .. } => zero,
    }
}
