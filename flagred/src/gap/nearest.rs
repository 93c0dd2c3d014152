//! The nearest covered node of every node: an exact distance transform.
//!
//! One pass along each axis, in which every line of nodes is the lower envelope of parabolas, one standing on
//! each node of the line with the distance found so far (Felzenszwalb and Huttenlocher 2012). The cost is
//! linear in the number of nodes, in any number of dimensions.

use super::fill::Lattice;

const NONE: u32 = u32::MAX;

/// The nearest covered node and its squared distance.
#[derive(Debug, Clone, Copy)]
pub(super) struct Nearest {
    square: f64,
    node: u32,
}

impl Nearest {
    /// The node; `None` where nothing is covered.
    pub(super) fn node(&self) -> Option<usize> {
        (self.node != NONE).then_some(self.node as usize)
    }

    /// The distance; infinite where nothing is covered.
    pub(super) fn distance(&self) -> f64 {
        libm::sqrt(self.square)
    }
}

/// The nearest covered node of every node.
pub(super) fn nearest(lattice: &Lattice, covered: &[bool]) -> Vec<Nearest> {
    let mut field: Vec<Nearest> = covered
        .iter()
        .enumerate()
        .map(|(node, covered)| match covered {
            true => Nearest {
                square: 0.0,
                node: node as u32,
            },
            false => Nearest {
                square: f64::INFINITY,
                node: NONE,
            },
        })
        .collect();
    let longest = lattice.shape.iter().copied().max().unwrap_or(0);
    let mut line = Vec::with_capacity(longest);
    let mut envelope = Vec::with_capacity(longest);
    for (axis, (&length, &stride)) in lattice.shape.iter().zip(&lattice.strides).enumerate() {
        let step = lattice.step(axis);
        for first in 0..field.len() {
            if lattice.place(first, axis) != 0 {
                continue;
            }
            line.clear();
            line.extend((0..length).map(|i| field[first + i * stride]));
            lower_envelope(&line, step, &mut envelope);
            let mut parabola = 0;
            for i in 0..length {
                let x = i as f64 * step;
                while envelope.get(parabola + 1).is_some_and(|p| p.from <= x) {
                    parabola += 1;
                }
                if let Some(p) = envelope.get(parabola) {
                    let away = x - p.vertex as f64 * step;
                    field[first + i * stride] = Nearest {
                        square: line[p.vertex].square + away * away,
                        node: line[p.vertex].node,
                    };
                }
            }
        }
    }
    field
}

/// A parabola of the envelope, and from which x on it is the lowest.
struct Parabola {
    vertex: usize,
    from: f64,
}

/// The lower envelope of `square[i] + (x - i step)^2`.
fn lower_envelope(line: &[Nearest], step: f64, envelope: &mut Vec<Parabola>) {
    envelope.clear();
    for (vertex, nearest) in line.iter().enumerate() {
        if nearest.node == NONE {
            continue;
        }
        let x = vertex as f64 * step;
        let mut from = f64::NEG_INFINITY;
        while let Some(last) = envelope.last() {
            let last_x = last.vertex as f64 * step;
            // Where the two parabolas cross.
            from = ((nearest.square + x * x) - (line[last.vertex].square + last_x * last_x))
                / (2.0 * (x - last_x));
            if from > last.from {
                break;
            }
            envelope.pop();
            from = f64::NEG_INFINITY;
        }
        envelope.push(Parabola { vertex, from });
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use proptest::prelude::*;

    proptest! {
        #![proptest_config(ProptestConfig::with_cases(64))]

        #[test]
        fn it_finds_what_trying_all_finds(covered in prop::collection::vec(prop::bool::weighted(0.1), 4 * 3 * 6)) {
            let lattice = Lattice::new(&[4, 3, 6]);
            let found = nearest(&lattice, &covered);
            for (node, found) in found.iter().enumerate() {
                let here = lattice.point(node);
                let least = (0..covered.len()).filter(|n| covered[*n]).map(|n| {
                    lattice.point(n).iter().zip(&here).map(|(a, b)| (a - b) * (a - b)).sum::<f64>()
                }).fold(f64::INFINITY, f64::min);
                prop_assert_eq!(least.is_finite(), found.node().is_some());
                if least.is_finite() {
                    prop_assert!((found.distance() - least.sqrt()).abs() < 1e-12);
                }
            }
        }
    }
}
