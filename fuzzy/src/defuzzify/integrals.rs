//! Area and first moment of pieces.

use super::polyline::Piece;

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

    /// Adds a piece: `area += d (ya + yb) / 2`, `moment += d (x0 (ya + yb) / 2 + d (ya + 2 yb) / 6)`.
    pub(crate) fn add(&mut self, piece: &Piece) {
        let width = piece.to - piece.from;
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
