//! The maxima of an aggregated set.

use super::piece::{Piece, root};
use crate::model::Defuzzifier;

/// Degrees this close to the highest, relative to it, count as the highest. Rounding changes a plateau made of two slopes by
/// less.
const PLATEAU: f64 = 1e-12;

/// The highest degree seen.
#[derive(Debug, Default, Clone, Copy)]
pub(crate) struct Highest(pub(crate) f64);

impl Highest {
    pub(crate) fn see(&mut self, piece: &Piece<'_>) {
        let inner = peak(piece).map_or(0.0, |(_, degree)| degree);
        self.0 = self.0.max(piece.left).max(piece.right).max(inner);
    }
}

/// The values where the set is highest.
#[derive(Debug, Default, Clone, Copy)]
pub(crate) struct Maxima {
    least_degree: f64,
    smallest: Option<f64>,
    largest: f64,
    length: f64,
    moment: f64,
    points: f64,
    sum: f64,
}

impl Maxima {
    pub(crate) fn of(highest: Highest) -> Self {
        Maxima {
            least_degree: highest.0 * (1.0 - PLATEAU),
            ..Maxima::default()
        }
    }

    pub(crate) fn see(&mut self, piece: &Piece<'_>) {
        let least = self.least_degree;
        let high = |degree: f64| degree >= least;
        let middle = 0.5 * (piece.from + piece.to);
        let flat = piece.curve.is_none_or(|curve| high(curve(0.5)));
        let (left, right) = (high(piece.left), high(piece.right));
        if left && right && flat {
            let width = piece.to - piece.from;
            self.point(piece.from);
            self.largest = piece.to;
            self.length += width;
            self.moment += width * middle;
            return;
        }
        if left {
            self.point(piece.from);
        }
        if let Some((x, degree)) = peak(piece)
            && high(degree)
        {
            self.point(x);
        }
        if right {
            self.point(piece.to);
        }
    }

    fn point(&mut self, x: f64) {
        if self.smallest.is_some() && x == self.largest {
            return;
        }
        self.smallest = self.smallest.or(Some(x));
        self.largest = x;
        self.points += 1.0;
        self.sum += x;
    }

    /// The value; `None` of a set that is 0 everywhere.
    pub(crate) fn value(&self, defuzzifier: Defuzzifier) -> Option<f64> {
        let smallest = self.smallest?;
        Some(match defuzzifier {
            Defuzzifier::SmallestOfMaxima => smallest,
            Defuzzifier::LargestOfMaxima => self.largest,
            _ if self.length > 0.0 => self.moment / self.length,
            _ => self.sum / self.points,
        })
    }
}

/// The maximum inside a curve that rises from its beginning and falls to its end, with its degree.
fn peak(piece: &Piece<'_>) -> Option<(f64, f64)> {
    let curve = piece.curve?;
    // The derivative by central differences of sixth order.
    let step = 0.02;
    let derivative = |part: f64| {
        let difference = |k: f64| curve(part + k * step) - curve(part - k * step);
        45.0 * difference(1.0) - 9.0 * difference(2.0) + difference(3.0)
    };
    let (a, b) = (3.0 * step, 1.0 - 3.0 * step);
    if derivative(a) > 0.0 && derivative(b) < 0.0 {
        let part = root(a, b, derivative);
        Some((piece.from + (piece.to - piece.from) * part, curve(part)))
    } else {
        None
    }
}
