//! Finds the nearest few of many points.

/// A balanced k-d tree over points, stored as one slice: the middle element of a slice divides the others into two
/// subtrees.
pub(super) struct Tree {
    dimensions: usize,
    points: Vec<f64>,
    order: Vec<u32>,
    /// The neighbours that were found, nearest first: (squared distance, point).
    found: Vec<(f64, usize)>,
}

impl Tree {
    pub(super) fn new(dimensions: usize, points: Vec<f64>) -> Tree {
        let count = points.len() / dimensions.max(1);
        let mut tree = Tree {
            dimensions,
            points,
            order: (0..count as u32).collect(),
            found: Vec::new(),
        };
        let mut order = core::mem::take(&mut tree.order);
        tree.split(&mut order, 0);
        tree.order = order;
        tree
    }

    fn split(&self, order: &mut [u32], axis: usize) {
        if order.len() < 2 {
            return;
        }
        let middle = order.len() / 2;
        order.select_nth_unstable_by(middle, |a, b| {
            let coordinate = |i: &u32| self.points[*i as usize * self.dimensions + axis];
            // Ties are ordered by index, so that the tree and the choice among equal points are deterministic.
            coordinate(a).total_cmp(&coordinate(b)).then(a.cmp(b))
        });
        let next = (axis + 1) % self.dimensions;
        let (left, right) = order.split_at_mut(middle);
        self.split(left, next);
        self.split(&mut right[1..], next);
    }

    /// The `k` points nearest to `point`, nearest first, with their squared distances.
    pub(super) fn nearest(&mut self, point: &[f64], k: usize) -> &[(f64, usize)] {
        self.found.clear();
        let order = core::mem::take(&mut self.order);
        self.search(&order, 0, point, k);
        self.order = order;
        &self.found
    }

    fn search(&mut self, order: &[u32], axis: usize, point: &[f64], k: usize) {
        let middle = order.len() / 2;
        let Some(&index) = order.get(middle) else {
            return;
        };
        let index = index as usize;
        let here = &self.points[index * self.dimensions..][..self.dimensions];
        let away = point[axis] - here[axis];
        let square = here.iter().zip(point).map(|(a, b)| (a - b) * (a - b)).sum();
        self.insert((square, index), k);
        let next = (axis + 1) % self.dimensions;
        let (left, right) = (&order[..middle], &order[middle + 1..]);
        let (near, far) = if away < 0.0 {
            (left, right)
        } else {
            (right, left)
        };
        self.search(near, next, point, k);
        let worst = self.found.last().map_or(f64::INFINITY, |f| f.0);
        if self.found.len() < k || away * away <= worst {
            self.search(far, next, point, k);
        }
    }

    fn insert(&mut self, candidate: (f64, usize), k: usize) {
        let at = self.found.partition_point(|f| *f < candidate);
        if at < k {
            self.found.truncate(k - 1);
            self.found.insert(at, candidate);
        }
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use proptest::prelude::*;

    proptest! {
        #![proptest_config(ProptestConfig::with_cases(64))]

        #[test]
        fn the_tree_and_sorting_find_the_same_neighbours(
            points in prop::collection::vec(0u8..6, 3..120),
            point in prop::collection::vec(0u8..6, 3),
            k in 1usize..9,
        ) {
            let points: Vec<f64> = points.chunks_exact(3).flatten().map(|x| f64::from(*x)).collect();
            let point: Vec<f64> = point.iter().map(|x| f64::from(*x)).collect();
            let mut all: Vec<(f64, usize)> = points.chunks_exact(3).enumerate()
                .map(|(i, p)| (p.iter().zip(&point).map(|(a, b)| (a - b) * (a - b)).sum(), i))
                .collect();
            all.sort_by(|a, b| a.partial_cmp(b).unwrap());
            all.truncate(k);
            let mut tree = Tree::new(3, points);
            prop_assert_eq!(tree.nearest(&point, k), &all[..]);
        }
    }
}
