//! Contour lines by marching squares.

/// A segment of a contour line. Coordinates are in units of cells, relative to the first cell.
pub(super) type Piece = [(f64, f64); 2];

/// Returns the segments of the contour line at `level`, given the values at the corners of the grid cells. Cells with an
/// unknown corner have no segments.
pub(super) fn pieces(
    columns: usize,
    rows: usize,
    value: impl Fn(usize, usize) -> Option<f64>,
    level: f64,
) -> Vec<Piece> {
    let mut pieces = Vec::new();
    for i in 0..columns.saturating_sub(1) {
        for j in 0..rows.saturating_sub(1) {
            // The corners of the cell: lower left, lower right, upper right, upper left.
            let corners = [(i, j), (i + 1, j), (i + 1, j + 1), (i, j + 1)];
            let values = corners.map(|(i, j)| value(i, j));
            let [Some(a), Some(b), Some(c), Some(d)] = values else {
                continue;
            };
            let values = [a, b, c, d];
            let mut crossings: Vec<(f64, f64)> = Vec::with_capacity(4);
            for k in 0..4 {
                let (from, to) = (values[k], values[(k + 1) % 4]);
                if (from >= level) == (to >= level) {
                    continue;
                }
                let share = (level - from) / (to - from);
                let (p, q) = (corners[k], corners[(k + 1) % 4]);
                let between = |p: usize, q: usize| p as f64 + (q as f64 - p as f64) * share;
                crossings.push((between(p.0, q.0), between(p.1, q.1)));
            }
            match crossings[..] {
                [p, q] => pieces.push([p, q]),
                // A saddle: the mean of the corners determines which points are connected.
                [p, q, r, s] => {
                    let middle = values.iter().sum::<f64>() / 4.0;
                    if (middle >= level) == (a >= level) {
                        pieces.extend([[p, q], [r, s]]);
                    } else {
                        pieces.extend([[p, s], [q, r]]);
                    }
                }
                _ => {}
            }
        }
    }
    pieces
}

/// Joins adjacent segments to lines.
pub(super) fn lines(mut pieces: Vec<Piece>) -> Vec<Vec<(f64, f64)>> {
    let near = |a: (f64, f64), b: (f64, f64)| (a.0 - b.0).abs() + (a.1 - b.1).abs() < 1e-9;
    // A line through a node of the grid has segments of length 0 in the surrounding cells.
    pieces.retain(|[first, second]| !near(*first, *second));
    let mut lines = Vec::new();
    while let Some([first, second]) = pieces.pop() {
        let mut line = std::collections::VecDeque::from([first, second]);
        while let (Some(&front), Some(&back)) = (line.front(), line.back()) {
            let next = pieces.iter().position(|[p, q]| {
                near(*p, back) || near(*q, back) || near(*p, front) || near(*q, front)
            });
            let Some(next) = next else {
                break;
            };
            let [p, q] = pieces.swap_remove(next);
            if near(p, back) {
                line.push_back(q);
            } else if near(q, back) {
                line.push_back(p);
            } else if near(p, front) {
                line.push_front(q);
            } else {
                line.push_front(p);
            }
        }
        lines.push(line.into_iter().collect());
    }
    lines
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn a_plane_has_one_straight_contour() {
        let pieces = pieces(5, 4, |i, _| Some(i as f64 * 10.0), 25.0);
        assert_eq!(pieces.len(), 3);
        let lines = lines(pieces);
        assert_eq!(lines.len(), 1);
        assert_eq!(lines[0].len(), 4);
        assert!(lines[0].iter().all(|(x, _)| *x == 2.5));
    }

    #[test]
    fn a_hill_has_a_closed_contour_and_unknown_values_have_none() {
        let hill = |i: usize, j: usize| {
            let (x, y) = (i as f64 - 5.0, j as f64 - 5.0);
            Some(30.0 - x * x - y * y)
        };
        let lines = lines(pieces(11, 11, hill, 20.0));
        assert_eq!(lines.len(), 1);
        assert_eq!(lines[0].first(), lines[0].last());
        assert!(pieces(11, 11, |_, _| None, 20.0).is_empty());
    }

    #[test]
    fn the_mean_of_the_corners_decides_a_saddle() {
        let saddle = |i: usize, j: usize| Some(if i == j { 10.0 } else { 0.0 });
        assert_eq!(pieces(2, 2, saddle, 4.0).len(), 2);
        assert_eq!(pieces(2, 2, saddle, 6.0).len(), 2);
        assert_ne!(pieces(2, 2, saddle, 4.0), pieces(2, 2, saddle, 6.0));
    }
}
