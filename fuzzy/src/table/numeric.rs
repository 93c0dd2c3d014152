//! Numerical integration and root finding.

/// Gauss-Legendre quadrature with 8 nodes on [-1, 1], which is exact for polynomials up to degree 15. Only half of the
/// nodes are listed; the other half are their mirror images. (Abramowitz and Stegun, table 25.4.)
const NODES: [(f64, f64); 4] = [
    (0.183_434_642_495_649_8, 0.362_683_783_378_362),
    (0.525_532_409_916_329, 0.313_706_645_877_887_3),
    (0.796_666_477_413_626_7, 0.222_381_034_453_374_48),
    (0.960_289_856_497_536_3, 0.101_228_536_290_376_26),
];

/// Returns the integrals of `f(x)` and of `(x - origin) f(x)` between two values.
pub(crate) fn gauss(f: impl Fn(f64) -> f64, from: f64, to: f64, origin: f64) -> (f64, f64) {
    let (middle, half) = (0.5 * (from + to), 0.5 * (to - from));
    let (mut area, mut moment) = (0.0, 0.0);
    for (node, weight) in NODES {
        let (left, right) = (f(middle - half * node), f(middle + half * node));
        area += weight * (left + right);
        moment += weight * node * (right - left);
    }
    (
        half * area,
        half * ((middle - origin) * area + half * moment),
    )
}

/// Returns the root of a function that changes sign between `a` and `b`, accurate to the last digit, by bisection with
/// regula falsi (Illinois).
pub(crate) fn root(a: f64, b: f64, f: impl Fn(f64) -> f64) -> f64 {
    let (mut a, mut b) = (a, b);
    let (mut fa, mut fb) = (f(a), f(b));
    let rising = fb > fa;
    for step in 0..200 {
        let guess = b - fb * (b - a) / (fb - fa);
        let middle = 0.5 * (a + b);
        // Every third step halves the interval, so that a flat function cannot stall the search.
        let x = if step % 3 != 2 && guess > a && guess < b {
            guess
        } else {
            middle
        };
        if x <= a || x >= b {
            break;
        }
        let fx = f(x);
        if fx == 0.0 {
            return x;
        }
        if (fx > 0.0) == rising {
            if (b - x) < 0.5 * (b - a) {
                fa *= 0.5;
            }
            (b, fb) = (x, fx);
        } else {
            if (x - a) < 0.5 * (b - a) {
                fb *= 0.5;
            }
            (a, fa) = (x, fx);
        }
    }
    0.5 * (a + b)
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn roots_to_the_last_digit() {
        assert!((root(0.0, 2.0, |x| x * x - 2.0) - 2f64.sqrt()).abs() < 1e-15);
        assert!((root(0.0, 1.0, |x| 0.3 - x) - 0.3).abs() < 1e-15);
        assert!((root(0.0, 1.0, |x| (x - 0.7).powi(9)) - 0.7).abs() < 1e-8);
    }

    #[test]
    fn a_polynomial_is_integrated_exactly() {
        // x^15 and (x - 1) x^14 over [0, 2].
        let (area, _) = gauss(|x| x.powi(15), 0.0, 2.0, 0.0);
        assert!((area / 4096.0 - 1.0).abs() < 1e-14, "{area}");
        let (area, moment) = gauss(|x| x.powi(14), 0.0, 2.0, 1.0);
        assert!((moment / (4096.0 - area) - 1.0).abs() < 1e-13, "{moment}");
    }
}
