//! Ascending positions as functions of free numbers.

/// Positions that keep their order and minimum distances for any values of the free numbers.
///
/// Fixed positions, and the two ends, divide the line into segments. The length of a segment, minus its minimum
/// distances, is divided among its distances in the proportions `exp(z)`; the first `z` of each segment is 0. A
/// distance that is 0 stays 0.
#[derive(Debug, Clone)]
pub(crate) struct OrderedPositions {
    segments: Vec<Segment>,
    count: usize,
}

/// The part between two fixed positions.
#[derive(Debug, Clone)]
struct Segment {
    from: f64,
    to: f64,
    /// For `from` and for `to`: whether it is an end of the range, which a position may reach, rather than a fixed
    /// position.
    is_end: [bool; 2],
    /// The distances between successive positions, including the ends: `None` if it stays 0, otherwise the minimum
    /// distance and the initial share.
    distances: Vec<Option<(f64, f64)>>,
}

/// The minimum initial share of a distance in a segment, so that it can grow.
const MIN_SHARE: f64 = 1e-3;

/// The distance from the end of the range, as a share of the segment, below which a position is set
/// to the end.
const AT_END: f64 = 1e-9;

impl OrderedPositions {
    /// Creates positions from `positions`, which ascend from `low` to `high`; the flag of a position is true if
    /// the position is fixed. The minimum distance of neighbours is `apart`, or their current distance if that
    /// is smaller.
    pub(crate) fn new(
        positions: &[(f64, bool)],
        low: f64,
        high: f64,
        apart: f64,
    ) -> OrderedPositions {
        let mut segments = Vec::new();
        // At an end of the range there is no neighbour, so no minimum distance.
        let mut inner = vec![(low, 0.0)];
        let fixed_end = [(high, true)];
        for (i, (position, is_fixed)) in positions.iter().chain(&fixed_end).enumerate() {
            let is_beside_end = i == 0 || i == positions.len();
            inner.push((*position, if is_beside_end { 0.0 } else { apart }));
            if *is_fixed {
                let is_end = [segments.is_empty(), i == positions.len()];
                segments.push(Segment::new(&inner, is_end));
                inner = vec![(*position, 0.0)];
            }
        }
        OrderedPositions {
            segments,
            count: positions.len(),
        }
    }

    /// The number of free numbers.
    pub(crate) fn free(&self) -> usize {
        self.segments.iter().map(Segment::free).sum()
    }

    /// The positions for given free numbers. If all free numbers are 0, these are the original positions.
    pub(crate) fn positions(&self, free: &[f64]) -> Vec<f64> {
        let mut rest = free;
        let mut positions = Vec::with_capacity(self.count + 1);
        for segment in &self.segments {
            let (own, behind) = rest.split_at(segment.free().min(rest.len()));
            rest = behind;
            segment.append_positions(own, &mut positions);
        }
        // The last position is the upper end of the range, which is not part of the result.
        positions.truncate(self.count);
        positions
    }
}

impl OrderedPositions {
    /// Whether these positions can result from some free numbers.
    pub(crate) fn contains(&self, positions: &[f64]) -> bool {
        let mut rest = positions;
        self.segments.iter().all(|segment| {
            let inner = segment.distances.len().saturating_sub(1).min(rest.len());
            let (own, behind) = rest.split_at(inner);
            // The positions of the segment are followed by the fixed position that ends it.
            rest = behind.get(1..).unwrap_or_default();
            segment.contains(own) && behind.first().is_none_or(|fixed| *fixed == segment.to)
        })
    }
}

impl Segment {
    fn contains(&self, positions: &[f64]) -> bool {
        let slack = 1e-12 * (self.to - self.from);
        let ends = positions.iter().copied().chain([self.to]);
        let mut before = self.from;
        let last = self.distances.len().saturating_sub(1);
        let mut distances = ends.zip(&self.distances).enumerate();
        distances.all(|(i, (position, distance))| {
            let apart = position - before;
            before = position;
            let [first_end, last_end] = self.is_end;
            let is_beside_end = (first_end && i == 0) || (last_end && i == last);
            match distance {
                Some(_) if is_beside_end => apart >= 0.0,
                Some((least, _)) => apart > 0.0 && apart >= least - slack,
                None => apart == 0.0,
            }
        })
    }

    /// Creates a segment from positions, each with the minimum distance from the previous one. The first and the last
    /// position are fixed.
    fn new(positions: &[(f64, f64)], is_end: [bool; 2]) -> Segment {
        let least = |pair: &[(f64, f64)]| {
            let [(before, _), (position, apart)] = *pair else {
                return None;
            };
            let distance = position - before;
            let least = apart.min(distance);
            (distance > 0.0).then_some((least, distance - least))
        };
        let mut distances: Vec<Option<(f64, f64)>> = positions.windows(2).map(least).collect();
        let spare: f64 = distances.iter().flatten().map(|(_, rest)| rest).sum();
        for (_, share) in distances.iter_mut().flatten() {
            *share = if spare > 0.0 {
                (*share / spare).max(MIN_SHARE)
            } else {
                1.0
            };
        }
        let end = |position: Option<&(f64, f64)>| position.map_or(0.0, |(position, _)| *position);
        Segment {
            from: end(positions.first()),
            to: end(positions.last()),
            is_end,
            distances,
        }
    }

    fn free(&self) -> usize {
        self.distances.iter().flatten().count().saturating_sub(1)
    }

    /// Appends the positions after `from`, including `to`.
    fn append_positions(&self, free: &[f64], positions: &mut Vec<f64>) {
        let moved = || std::iter::once(0.0).chain(free.iter().copied());
        let known = || self.distances.iter().flatten().zip(moved());
        let least: f64 = known().map(|((least, _), _)| least).sum();
        let sum: f64 = known().map(|((_, share), z)| share * z.exp()).sum();
        let spare = (self.to - self.from - least).max(0.0);
        let mut z = moved();
        let mut at = self.from;
        let first = positions.len();
        for distance in &self.distances {
            if let Some((least, share)) = distance {
                at += least + spare * share * z.next().unwrap_or(0.0).exp() / sum;
            }
            positions.push(at.min(self.to));
        }
        // Positions that touch the upper end are set exactly to it, to remove rounding errors.
        let touching = self
            .distances
            .iter()
            .rev()
            .take_while(|distance| distance.is_none());
        let touching = touching.count() + 1;
        let last = positions.len().saturating_sub(touching).max(first);
        for position in positions.iter_mut().skip(last) {
            *position = self.to;
        }
        // A position that is pulled beyond the range comes as close to the end of the range as the free numbers allow.
        // It is then set to that end.
        let near = AT_END * (self.to - self.from);
        let [first_end, last_end] = self.is_end;
        if let Some(position) = positions.get_mut(first).filter(|_| first_end)
            && *position - self.from < near
        {
            *position = self.from;
        }
        if let Some(position) = last.checked_sub(1).and_then(|i| positions.get_mut(i))
            && last_end
            && last > first
            && self.to - *position < near
        {
            *position = self.to;
        }
    }
}

#[cfg(test)]
mod tests {
    use proptest::prelude::*;

    use super::*;

    #[test]
    fn zeros_give_the_original_positions() {
        let positions = [(0.0, false), (0.2, false), (0.5, false)];
        let ordered = OrderedPositions::new(&positions, 0.0, 1.0, 0.05);
        // The first position stays at the end of the range, so two are free.
        assert_eq!(ordered.free(), 2);
        let same = ordered.positions(&[0.0; 2]);
        for ((position, _), same) in positions.iter().zip(same) {
            assert!((position - same).abs() < 1e-12, "{same}");
        }
    }

    #[test]
    fn fixed_positions_stay() {
        let ordered =
            OrderedPositions::new(&[(0.2, false), (0.5, true), (0.7, false)], 0.0, 1.0, 0.0);
        let moved = ordered.positions(&[3.0, -2.0]);
        assert_eq!(moved[1], 0.5);
        assert!(moved[0] < 0.1 && moved[2] > 0.9, "{moved:?}");
    }

    proptest! {
        #[test]
        fn order_distance_and_range_are_kept(
            mut positions in prop::collection::vec((0.0..10.0_f64, any::<bool>()), 1..8),
            apart in 0.0..2.0_f64,
            free in prop::collection::vec(-30.0..30.0_f64, 16),
        ) {
            positions.sort_by(|a, b| a.0.total_cmp(&b.0));
            let ordered = OrderedPositions::new(&positions, 0.0, 10.0, apart);
            let moved = ordered.positions(&free[..ordered.free()]);
            prop_assert_eq!(moved.len(), positions.len());
            let as_given: Vec<f64> = positions.iter().map(|(position, _)| *position).collect();
            prop_assert!(ordered.contains(&as_given));
            for ((before, is_fixed), after) in positions.iter().zip(&moved) {
                prop_assert!(!is_fixed || before == after);
                prop_assert!((0.0..=10.0).contains(after));
            }
            for i in 1..moved.len() {
                let least = apart.min(positions[i].0 - positions[i - 1].0);
                prop_assert!(moved[i] - moved[i - 1] >= least - 1e-9, "{:?}", moved);
            }
        }
    }
}
