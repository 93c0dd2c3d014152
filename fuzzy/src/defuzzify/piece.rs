//! Stretches of an aggregated set, and integrals over them.

/// A stretch on which the aggregated set is a straight line, or a smooth curve.
pub(crate) struct Piece<'a> {
    /// Where it begins.
    pub(crate) from: f64,
    /// Where it ends.
    pub(crate) to: f64,
    /// The degree just inside `from`.
    pub(crate) left: f64,
    /// The degree just inside `to`.
    pub(crate) right: f64,
    /// The degree at `x` of a curve; a straight piece has none.
    pub(crate) curve: Option<&'a dyn Fn(f64) -> f64>,
}

/// The area of a set and its first moment about `origin`.
#[derive(Debug, Clone, Copy)]
pub(crate) struct Integrals {
    pub(crate) area: f64,
    pub(crate) moment: f64,
    /// Where the moment is measured from: the middle of the range, against cancellation.
    pub(crate) origin: f64,
}

impl Integrals {
    pub(crate) fn about(origin: f64) -> Self {
        Integrals {
            area: 0.0,
            moment: 0.0,
            origin,
        }
    }

    /// Adds a piece. A straight one has `area = d (ya + yb) / 2` and
    /// `moment = d (x0 (ya + yb) / 2 + d (ya + 2 yb) / 6)`; a curve is integrated to the last digits.
    pub(crate) fn add(&mut self, piece: &Piece<'_>) {
        let width = piece.to - piece.from;
        if let Some(curve) = piece.curve {
            let (area, moment) = integrate(curve, piece.from, piece.to, self.origin, self.area);
            self.area += area;
            self.moment += moment;
            return;
        }
        let (left, right) = (piece.left, piece.right);
        let mean = 0.5 * (left + right);
        self.area += width * mean;
        self.moment +=
            width * ((piece.from - self.origin) * mean + width * (left + 2.0 * right) / 6.0);
    }

    /// The centre of gravity; `None` without area.
    pub(crate) fn centroid(&self) -> Option<f64> {
        (self.area > 0.0).then(|| self.origin + self.moment / self.area)
    }
}

impl Piece<'_> {
    /// The area from the piece's beginning to `x`.
    pub(crate) fn area_to(&self, x: f64) -> f64 {
        match self.curve {
            Some(curve) => integrate(curve, self.from, x, self.from, 0.0).0,
            None => {
                let (width, length) = (self.to - self.from, x - self.from);
                length * (self.left + 0.5 * (self.right - self.left) * (length / width))
            }
        }
    }

    /// Where the area from the piece's beginning reaches `area`, which is at most the piece's.
    pub(crate) fn where_area_is(&self, area: f64) -> f64 {
        if self.curve.is_none() {
            // area = left d + slope d^2 / 2, solved for d without a difference of like numbers.
            let slope = (self.right - self.left) / (self.to - self.from);
            let root = libm::sqrt(libm::fmax(0.0, self.left * self.left + 2.0 * slope * area));
            let length = if area > 0.0 {
                2.0 * area / (self.left + root)
            } else {
                0.0
            };
            return libm::fmin(self.from + length, self.to);
        }
        root(self.from, self.to, |x| self.area_to(x) - area)
    }
}

/// Gauss-Legendre with 8 nodes on [-1, 1]: exact for polynomials up to degree 15.
/// Half of the nodes; the others are their mirror images. (Abramowitz and Stegun, table 25.4.)
const NODES: [(f64, f64); 4] = [
    (0.183_434_642_495_649_8, 0.362_683_783_378_362),
    (0.525_532_409_916_329, 0.313_706_645_877_887_3),
    (0.796_666_477_413_626_7, 0.222_381_034_453_374_48),
    (0.960_289_856_497_536_3, 0.101_228_536_290_376_26),
];

/// Where a stretch is halved no further.
const DEEPEST: usize = 48;

/// How well a stretch and its halves must agree, as a part of the area: the halves are then exact to
/// rounding where the curve is smooth, and to this where it has a kink that was not found before.
const AGREEMENT: f64 = 1e-13;

/// Area and first moment about `origin` of a curve, by Gauss-Legendre on stretches halved until they agree.
/// `known_area` is the area of the rest of the set: nothing far below it is worth halving for.
fn integrate(
    curve: &dyn Fn(f64) -> f64,
    from: f64,
    to: f64,
    origin: f64,
    known_area: f64,
) -> (f64, f64) {
    let mut stack = [(0.0, 0.0, 0.0, 0.0); DEEPEST + 1];
    let (area, moment) = gauss(curve, from, to, origin);
    stack[0] = (from, to, area, moment);
    let mut open = 1;
    let (mut sum, mut sum_of_moments) = (0.0, 0.0);
    let reach = (to - from) + libm::fabs(0.5 * (from + to) - origin);
    while open > 0 {
        open -= 1;
        let (a, b, area, moment) = stack[open];
        let middle = 0.5 * (a + b);
        let left = gauss(curve, a, middle, origin);
        let right = gauss(curve, middle, b, origin);
        let (halves, moments) = (left.0 + right.0, left.1 + right.1);
        let allowed = AGREEMENT * (known_area + sum + halves);
        let agree =
            libm::fabs(halves - area) <= allowed && libm::fabs(moments - moment) <= allowed * reach;
        if agree || open + 2 > DEEPEST || middle <= a || middle >= b {
            sum += halves;
            sum_of_moments += moments;
        } else {
            stack[open] = (middle, b, right.0, right.1);
            stack[open + 1] = (a, middle, left.0, left.1);
            open += 2;
        }
    }
    (sum, sum_of_moments)
}

fn gauss(curve: &dyn Fn(f64) -> f64, from: f64, to: f64, origin: f64) -> (f64, f64) {
    let (middle, half) = (0.5 * (from + to), 0.5 * (to - from));
    let (mut area, mut moment) = (0.0, 0.0);
    for (node, weight) in NODES {
        let (left, right) = (curve(middle - half * node), curve(middle + half * node));
        area += weight * (left + right);
        moment += weight * node * (right - left);
    }
    let area = half * area;
    (area, (middle - origin) * area + half * half * moment)
}

/// The place between `a` and `b` where a function that changes sign there is 0: bisection with regula
/// falsi (Illinois), to the last digit.
pub(crate) fn root(a: f64, b: f64, f: impl Fn(f64) -> f64) -> f64 {
    let (mut a, mut b) = (a, b);
    let (mut fa, mut fb) = (f(a), f(b));
    let rising = fb > fa;
    for step in 0..200 {
        let guess = b - fb * (b - a) / (fb - fa);
        let middle = 0.5 * (a + b);
        // Every third step halves, so that a flat function cannot stall the search.
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

    fn curve<'a>(from: f64, to: f64, f: &'a dyn Fn(f64) -> f64) -> Piece<'a> {
        Piece {
            from,
            to,
            left: f(from),
            right: f(to),
            curve: Some(f),
        }
    }

    #[test]
    fn a_line_integrates_like_its_curve() {
        let f = |x: f64| 0.2 + 0.1 * x;
        let line = Piece {
            curve: None,
            ..curve(1.0, 4.0, &f)
        };
        let (mut straight, mut curved) = (Integrals::about(2.0), Integrals::about(2.0));
        straight.add(&line);
        curved.add(&curve(1.0, 4.0, &f));
        assert!((straight.area - curved.area).abs() < 1e-15);
        assert!((straight.moment - curved.moment).abs() < 1e-15);
        assert!((straight.area - 1.35).abs() < 1e-15);
        for area in [0.0, 0.3, 1.0, 1.35] {
            let x = line.where_area_is(area);
            assert!((line.area_to(x) - area).abs() < 1e-15);
            assert!((curve(1.0, 4.0, &f).where_area_is(area) - x).abs() < 1e-14);
        }
    }

    #[test]
    fn smooth_curves_kinks_and_steps() {
        let area = |f: &dyn Fn(f64) -> f64| {
            let mut integrals = Integrals::about(0.5);
            integrals.add(&curve(0.0, 1.0, f));
            (integrals.area, integrals.centroid().unwrap())
        };
        let (exponential, centroid) = area(&|x| x.exp());
        assert!((exponential - (1f64.exp() - 1.0)).abs() < 1e-14);
        assert!((centroid - 1.0 / (1f64.exp() - 1.0)).abs() < 1e-14);
        let (kink, _) = area(&|x| (x - 0.3).abs());
        assert!((kink - 0.29).abs() < 1e-12, "{kink}");
        let (step, _) = area(&|x| if x < 0.3 { 1.0 } else { 0.5 });
        assert!((step - 0.65).abs() < 1e-12, "{step}");
    }

    #[test]
    fn roots_to_the_last_digit() {
        assert!((root(0.0, 2.0, |x| x * x - 2.0) - 2f64.sqrt()).abs() < 1e-15);
        assert!((root(0.0, 1.0, |x| 0.3 - x) - 0.3).abs() < 1e-15);
        assert!((root(0.0, 1.0, |x| (x - 0.7).powi(9)) - 0.7).abs() < 1e-8);
    }
}
