//! The value that halves the area of a prepared set.

use super::{Section, SetArrays, SetSegment};
use crate::table::operators::{larger, smaller};
use crate::table::{Flank, Output, ShapeKind};

impl SetArrays<'_> {
    pub(super) fn bisector(&self, strengths: &[f64]) -> Option<f64> {
        let area_of = |section: &Section| {
            let mut area = 0.0;
            self.parts(section, strengths, |part| area += part.area);
            area
        };
        let mut whole = 0.0;
        for section in self.sections {
            whole += area_of(section);
        }
        if whole <= 0.0 {
            return None;
        }
        let half = 0.5 * whole;
        let mut before = 0.0;
        for section in self.sections {
            let area = area_of(section);
            if before + area < half || area <= 0.0 {
                before += area;
                continue;
            }
            // The areas of the set to the left of the lower and of the upper end of the unvisited part of the section.
            let (mut left, mut right) = (before, before + area);
            let mut value = None;
            self.parts(section, strengths, |part| {
                let start = if part.from_left {
                    left
                } else {
                    right - part.area
                };
                if value.is_none() && start <= half && half <= start + part.area {
                    value = Some(self.position_of_area(&part, half - start));
                }
                if part.from_left {
                    left += part.area;
                } else {
                    right -= part.area;
                }
            });
            // Because of rounding, the value may be between two parts, so that no part contains it.
            return value.or(Some(section.to));
        }
        self.sections.last().map(|section| section.to)
    }

    /// Returns the position in a part at which the area, counted from the lower end of the part, reaches the given
    /// area.
    fn position_of_area(&self, part: &SetSegment<'_>, area: f64) -> f64 {
        let units = area / part.degree;
        let Some(flank) = part.flank else {
            return smaller(part.to, part.from + units * self.measure.unit);
        };
        if flank.kind == ShapeKind::PIECEWISE {
            // Solve units = left d + slope d^2 / 2 for d without cancellation.
            let (left, right) = (flank.degree(part.from), flank.degree(part.to));
            let slope = (right - left) * (self.measure.unit / (part.to - part.from));
            let root = libm::sqrt(larger(0.0, left * left + 2.0 * slope * units));
            let length = 2.0 * units / (left + root) * self.measure.unit;
            return smaller(part.to, part.from + length);
        }
        let tail = |x: f64| flank.tail(self.knots, self.measure, x, flank.degree(x)).0;
        let start = tail(part.from);
        let rest = |x: f64| libm::fabs(tail(x) - start) - units;
        self.newton((part.from, part.to), rest, |x| flank.degree(x))
    }

    /// Returns the root of a rising function, given its derivative per unit of length.
    fn newton(
        &self,
        (from, to): (f64, f64),
        f: impl Fn(f64) -> f64,
        derivative: impl Fn(f64) -> f64,
    ) -> f64 {
        let (mut from, mut to) = (from, to);
        let mut x = 0.5 * (from + to);
        for _ in 0..200 {
            let y = f(x);
            if y < 0.0 {
                from = x;
            } else {
                to = x;
            }
            let newton = x - y / derivative(x) * self.measure.unit;
            let inside = from < newton && newton < to;
            let next = if inside { newton } else { 0.5 * (from + to) };
            // Convergence is quadratic, so the error of the next step would be about the square of this one.
            let small = inside && libm::fabs(next - x) <= 1e-9 * self.measure.unit;
            if small || next <= from || next >= to {
                return next;
            }
            x = next;
        }
        x
    }

    /// Returns the bisector of a set that is aggregated by the sum. In such a set, the areas of the terms add up.
    pub(super) fn bisector_of_sum(&self, output: &Output, strengths: &[f64]) -> Option<f64> {
        let sum = |of: &dyn Fn(&Flank, f64) -> f64| {
            let mut sum = 0.0;
            for (term, &strength) in self.terms.iter().zip(strengths) {
                if strength > 0.0 {
                    for flank in self.flanks_of(term) {
                        sum += of(flank, strength);
                    }
                }
            }
            sum
        };
        let whole = sum(&|flank, strength| self.of_single_flank(flank, strength).0);
        if whole <= 0.0 {
            return None;
        }
        let area = |x: f64| sum(&|flank, strength| self.area_up_to(flank, strength, x));
        let degree = |x: f64| {
            sum(&|flank, strength| {
                if x < flank.from || x >= flank.to {
                    0.0
                } else if self.scales {
                    strength * flank.degree(x)
                } else {
                    smaller(strength, flank.degree(x))
                }
            })
        };
        let rest = |x: f64| area(x) - 0.5 * whole;
        Some(self.newton((output.low, output.high), rest, degree))
    }

    /// Returns the area to the left of `x` of a flank that is cut or scaled, as if it were the only one.
    fn area_up_to(&self, flank: &Flank, strength: f64, x: f64) -> f64 {
        if x <= flank.from {
            return 0.0;
        }
        let whole = self.of_single_flank(flank, strength).0;
        if x >= flank.to {
            return whole;
        }
        // The area between the foot and x.
        let degree = flank.degree(x);
        let tail = |x: f64, degree: f64| flank.tail(self.knots, self.measure, x, degree).0;
        let area = if self.scales {
            strength * tail(x, degree)
        } else if degree <= strength {
            tail(x, degree)
        } else {
            let (foot, low) = flank.foot();
            let clip = if low < strength {
                flank.position_of_degree(strength)
            } else {
                foot
            };
            let below = if clip == foot {
                0.0
            } else {
                tail(clip, strength)
            };
            below + strength * libm::fabs(x - clip) / self.measure.unit
        };
        if flank.right < flank.left {
            whole - area
        } else {
            area
        }
    }
}
