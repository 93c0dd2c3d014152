//! The values of a formula whose variables are intervals, by interval arithmetic.

use alloc::vec::Vec;

use crate::model::Formula;

/// The values of a part of a formula.
#[derive(Debug, Clone, Copy, PartialEq)]
pub(super) struct Span {
    pub(super) low: f64,
    pub(super) high: f64,
    /// Whether some values may be NaN or infinite.
    pub(super) may_be_undefined: bool,
}

impl Span {
    const ALL: Span = Span {
        low: f64::NEG_INFINITY,
        high: f64::INFINITY,
        may_be_undefined: true,
    };

    pub(super) fn between(low: f64, high: f64) -> Self {
        Span {
            low,
            high,
            may_be_undefined: false,
        }
    }

    fn point(self) -> Option<f64> {
        (self.low == self.high).then_some(self.low)
    }

    /// Returns the span of some numbers; [`Span::ALL`] if one of them is NaN.
    fn of(numbers: &[f64], may_be_undefined: bool) -> Span {
        if numbers.iter().any(|number| number.is_nan()) {
            return Span::ALL;
        }
        let low = numbers.iter().copied().fold(f64::INFINITY, libm::fmin);
        let high = numbers.iter().copied().fold(f64::NEG_INFINITY, libm::fmax);
        Span {
            low,
            high,
            may_be_undefined: may_be_undefined || !low.is_finite() || !high.is_finite(),
        }
    }
}

/// Returns an interval that contains all values of a formula, up to rounding. `variable` returns the interval of a
/// variable.
pub(super) fn range(formula: &Formula, variable: impl Fn(&str) -> Span) -> Span {
    formula.fold(
        &|number| Span::between(number, number),
        &variable,
        &|word, operands: Vec<Span>| match operands[..] {
            [x] => of_one(word, x),
            [x, y] => of_two(word, x, y),
            _ => Span::ALL,
        },
    )
}

fn of_one(word: &str, x: Span) -> Span {
    let monotone = |f: fn(f64) -> f64| Span::of(&[f(x.low), f(x.high)], x.may_be_undefined);
    // A monotone function that is undefined below `least` and above `most`.
    let partial = |f: fn(f64) -> f64, least: f64, most: f64| {
        if x.high < least || x.low > most {
            return Span::ALL;
        }
        let (low, high) = (libm::fmax(x.low, least), libm::fmin(x.high, most));
        let outside = low != x.low || high != x.high;
        Span::of(&[f(low), f(high)], x.may_be_undefined || outside)
    };
    let within = |low: f64, high: f64| Span {
        low,
        high,
        may_be_undefined: x.may_be_undefined,
    };
    match word {
        "-" => within(-x.high, -x.low),
        "abs" if x.low >= 0.0 => x,
        "abs" if x.high <= 0.0 => within(-x.high, -x.low),
        "abs" => within(0.0, libm::fmax(-x.low, x.high)),
        "exp" => monotone(libm::exp),
        "floor" => monotone(libm::floor),
        "ceil" => monotone(libm::ceil),
        "round" => monotone(libm::round),
        "atan" => monotone(libm::atan),
        "asinh" => monotone(libm::asinh),
        "sinh" => monotone(libm::sinh),
        "tanh" => monotone(libm::tanh),
        "sqrt" => partial(libm::sqrt, 0.0, f64::INFINITY),
        "log" => partial(libm::log, 0.0, f64::INFINITY),
        "log10" => partial(libm::log10, 0.0, f64::INFINITY),
        "log1p" => partial(libm::log1p, -1.0, f64::INFINITY),
        "asin" => partial(libm::asin, -1.0, 1.0),
        "acos" => partial(libm::acos, -1.0, 1.0),
        "sin" | "cos" => match (word, x.point()) {
            ("sin", Some(x)) => Span::between(libm::sin(x), libm::sin(x)),
            (_, Some(x)) => Span::between(libm::cos(x), libm::cos(x)),
            (_, None) => within(-1.0, 1.0),
        },
        "cosh" => Span {
            high: libm::fmax(libm::cosh(x.low), libm::cosh(x.high)),
            ..within(1.0, 1.0)
        },
        "not" => within(0.0, 1.0),
        _ => Span::ALL,
    }
}

fn of_two(word: &str, x: Span, y: Span) -> Span {
    let may_be_undefined = x.may_be_undefined || y.may_be_undefined;
    let corners = |f: fn(f64, f64) -> f64| {
        let of = |x: f64| [f(x, y.low), f(x, y.high)];
        Span::of(&[of(x.low), of(x.high)].concat(), may_be_undefined)
    };
    let truth = |always: bool, never: bool| Span {
        low: f64::from(u8::from(always && !may_be_undefined)),
        high: f64::from(u8::from(!never || may_be_undefined)),
        may_be_undefined: false,
    };
    match word {
        "+" => corners(|x, y| x + y),
        "-" => corners(|x, y| x - y),
        "*" => corners(|x, y| x * y),
        "/" if y.low > 0.0 || y.high < 0.0 => corners(|x, y| x / y),
        "max" if !may_be_undefined => corners(libm::fmax),
        "min" if !may_be_undefined => corners(libm::fmin),
        "^" => power(x, y, may_be_undefined),
        "<" => truth(x.high < y.low, x.low >= y.high),
        "<=" => truth(x.high <= y.low, x.low > y.high),
        ">" => truth(x.low > y.high, x.high <= y.low),
        ">=" => truth(x.low >= y.high, x.high < y.low),
        "==" | "!=" | "and" | "or" => truth(false, false),
        _ => Span::ALL,
    }
}

/// Returns the span of the powers for a positive whole exponent, a positive base, or a base of at least 0 with a positive
/// exponent; otherwise [`Span::ALL`].
fn power(x: Span, y: Span, may_be_undefined: bool) -> Span {
    let corners = |low: f64, high: f64| {
        let of = |x: f64| [libm::pow(x, y.low), libm::pow(x, y.high)];
        [of(low), of(high)].concat()
    };
    match y.point() {
        Some(exponent) if exponent == libm::floor(exponent) && exponent > 0.0 => {
            let is_even = exponent % 2.0 == 0.0;
            let mut ends = corners(x.low, x.high);
            if is_even && x.low < 0.0 && x.high > 0.0 {
                ends.push(0.0);
            }
            Span::of(&ends, may_be_undefined)
        }
        _ if x.low > 0.0 || (x.low >= 0.0 && y.low > 0.0) => {
            Span::of(&corners(x.low, x.high), may_be_undefined)
        }
        _ => Span::ALL,
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn values_lie_in_the_span() {
        for text in [
            "2 * x^2 - 3 * x + 1",
            "x^3 / (y + 3)",
            "abs(x) - max(x, y) * min(x, 2)",
            "exp(-x^2 / 2) + tanh(y) - atan(x)",
            "sqrt(y) + log(y + 1) * cosh(x)",
            "(x > 0 and y < 1) + (x <= y) * 2 - (x == y)",
            "floor(x) + ceil(y) - round(x) + sin(x) * cos(y)",
            "(y + 1)^x + x % 2",
            "log10(x) + acos(x) / asin(y) + 1 / x",
            "not x + x^-2 + y^0.5",
        ] {
            let formula: Formula = text.parse().unwrap();
            for (x, y) in [((-1.5, 0.5), (0.0, 0.75)), ((0.25, 2.0), (1.0, 1.0))] {
                let span = range(&formula, |name| match name {
                    "x" => Span::between(x.0, x.1),
                    _ => Span::between(y.0, y.1),
                });
                let part =
                    |(low, high): (f64, f64), i: i32| low + (high - low) * f64::from(i) / 50.0;
                for (i, j) in (0..=50).flat_map(|i| (0..=50).map(move |j| (i, j))) {
                    let (x, y) = (part(x, i), part(y, j));
                    let value = formula.evaluate(|name| if name == "x" { x } else { y });
                    if value.is_finite() {
                        let inside = span.low - 1e-12 <= value && value <= span.high + 1e-12;
                        assert!(inside, "{text} at {x}, {y}: {value}, {span:?}");
                    } else {
                        assert!(
                            span.may_be_undefined,
                            "{text} at {x}, {y}: {value}, {span:?}"
                        );
                    }
                }
            }
        }
        let square: Formula = "x^2".parse().unwrap();
        let span = range(&square, |_| Span::between(-2.0, 1.0));
        assert_eq!(span, Span::between(0.0, 4.0));
    }
}
