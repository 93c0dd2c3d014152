//! Conversion of a prepared set of straight terms to layers.

use alloc::{collections::BTreeMap, vec::Vec};

use super::PreparedSet;
use crate::table::{Base, Layers, ShapeKind, Strand};

/// The closed form of the centroid of a set of straight terms that are cut, and aggregated by maximum.
#[derive(Debug, Clone)]
pub(crate) struct PreparedLayers {
    pub(crate) bases: Vec<Base>,
    pub(crate) layers: Vec<Layers>,
}

/// The maximum number of parts of an output. The number of bases has the same limit, because each base takes memory
/// for one number per row.
const MAX_PARTS: usize = 1024;
/// The minimum difference of degrees; for smaller ones the coefficients would overflow.
const MIN_DIFFERENCE: f64 = 1e-100;

/// A part of the range on which a term is straight and the terms above it do not change.
struct LayerSegment {
    flank: u32,
    strength: u32,
    /// The indices of the firing strengths of the terms above this part, in ascending order.
    above: Vec<u32>,
    /// The lower end of the part, with the degree just inside.
    from: (f64, f64),
    /// The upper end of the part, with the degree just inside.
    to: (f64, f64),
}

impl PreparedLayers {
    /// Converts a prepared set whose terms are cut; `about` contains the origin of moments and the unit of length.
    /// `None` if a term is curved or there would be too many layers.
    pub(crate) fn new(prepared: &PreparedSet, about: (f64, f64)) -> Option<Self> {
        let is_straight = prepared
            .flanks
            .iter()
            .all(|f| f.kind == ShapeKind::PIECEWISE);
        if !is_straight {
            return None;
        }
        let mut parts = parts(prepared)?;
        parts.sort_by_key(|part| part.strength);
        let mut bases = Bases::default();
        let mut layers: Vec<Layers> = Vec::new();
        for of_term in parts.chunk_by(|a, b| a.strength == b.strength) {
            for parts in of_term.chunks(4) {
                let mut four = Layers::default();
                for (index, part) in parts.iter().enumerate() {
                    four.strength = part.strength;
                    four.bases[index] = bases.of(&part.above);
                    part.write(about, index, &mut four)?;
                }
                layers.push(four);
            }
        }
        if bases.bases.len() > MAX_PARTS {
            return None;
        }
        Some(PreparedLayers {
            bases: bases.bases,
            layers,
        })
    }
}

/// Returns the parts of all terms: the strands of all sections, where a strand is merged with its continuation on the
/// next section if the same terms are above both. `None` if there are too many.
fn parts(prepared: &PreparedSet) -> Option<Vec<LayerSegment>> {
    let mut parts: Vec<LayerSegment> = Vec::new();
    for section in &prepared.sections {
        let strands: &[Strand] = prepared
            .strands
            .get(section.first_strand as usize..section.end_strand as usize)?;
        let mut above = Vec::new();
        for strand in strands {
            let is_same = |part: &&mut LayerSegment| {
                part.flank == strand.flank && part.to.0 == section.from && part.above == above
            };
            let to = (section.to, strand.right);
            match parts.iter_mut().rev().find(is_same) {
                Some(part) => part.to = to,
                None => parts.push(LayerSegment {
                    flank: strand.flank,
                    strength: strand.strength,
                    above: above.clone(),
                    from: (section.from, strand.left),
                    to,
                }),
            }
            if let Err(place) = above.binary_search(&strand.strength) {
                above.insert(place, strand.strength);
            }
        }
        if parts.len() > MAX_PARTS {
            return None;
        }
    }
    Some(parts)
}

impl LayerSegment {
    /// Writes the numbers of this part as layer `index` of a group of four layers; `None` if they would overflow.
    fn write(&self, (origin, unit): (f64, f64), index: usize, four: &mut Layers) -> Option<()> {
        let ((from, left), (to, right)) = (self.from, self.to);
        let length = to - from;
        let width = length / unit;
        let (low, high) = (left.min(right), left.max(right));
        (four.low[index], four.high[index]) = (low, high);
        four.area[0][index] = width;
        four.moment[0][index] = width * (from + 0.5 * length - origin);
        let difference = high - low;
        if difference > 0.0 {
            if difference < MIN_DIFFERENCE {
                return None;
            }
            let (lower_end, sign) = if left < right {
                (from, -1.0)
            } else {
                (to, 1.0)
            };
            let half = 0.5 * width / difference;
            four.area[1][index] = -half;
            four.moment[1][index] = -half * (lower_end - origin);
            four.moment[2][index] = sign * half * (length / difference) / 3.0;
        }
        Some(())
    }
}

/// The bases, each defined by a set of firing strengths.
#[derive(Default)]
struct Bases {
    /// The index of the base of each set, plus one; the sets are in ascending order.
    known: BTreeMap<Vec<u32>, u32>,
    bases: Vec<Base>,
}

impl Bases {
    fn known(&self, set: &[u32]) -> Option<u32> {
        if set.is_empty() {
            return Some(0);
        }
        self.known.get(set).copied()
    }

    /// Returns the index of the base of a set, plus one, and adds the base if necessary; 0 for the empty set.
    fn of(&mut self, set: &[u32]) -> u32 {
        if let Some(base) = self.known(set) {
            return base;
        }
        let without = |index: usize| {
            let mut others = set.to_vec();
            let strength = others.remove(index);
            (others, strength)
        };
        // The new base is derived from an existing one, if possible.
        let near = (0..set.len()).find(|index| self.known(&without(*index).0).is_some());
        let (others, strength) = without(near.unwrap_or(0));
        let others = self.of(&others);
        self.bases.push(Base { others, strength });
        let base = self.bases.len() as u32;
        self.known.insert(set.to_vec(), base);
        base
    }
}

#[cfg(test)]
mod tests;
