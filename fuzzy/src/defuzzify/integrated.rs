//! Outputs without a closed form, whose aggregated set is integrated, sampled or summed in each evaluation.

use super::curves::Curves;
use super::maxima::{HighestDegree, Maxima};
use super::piece::{Integrals, Piece, unit};
use super::singletons::Singletons;
use super::workspace::Workspace;
use super::{ConsequentOperators, Strengths};
use crate::model::{Output, Sampling};
use crate::table::SetDefuzzifier;
use crate::table::operators::{larger, smaller};

/// A fuzzy output without a closed form.
#[derive(Debug, Clone)]
pub(crate) struct IntegratedSet {
    low: f64,
    high: f64,
    operators: ConsequentOperators,
    defuzzifier: SetDefuzzifier,
    set: Set,
}

#[derive(Debug, Clone)]
enum Set {
    /// Integrated piece by piece.
    Pieces(Curves),
    /// Sampled, to reproduce the results of other programs.
    Samples(Sampling, Curves),
    /// All terms are singletons.
    Singletons(Singletons),
}

impl IntegratedSet {
    pub(crate) fn new(
        output: &Output,
        operators: ConsequentOperators,
        defuzzifier: SetDefuzzifier,
    ) -> Self {
        let (low, high) = (output.variable.low, output.variable.high);
        let curves = || Curves::new(&output.variable.terms, low, high);
        let set = match (Singletons::new(output), output.samples) {
            (Some(singletons), _) => Set::Singletons(singletons),
            (None, Some(sampling)) => Set::Samples(sampling, curves()),
            (None, None) => Set::Pieces(curves()),
        };
        IntegratedSet {
            low,
            high,
            operators,
            defuzzifier,
            set,
        }
    }

    /// Returns the maximum number of cuts of an evaluation, not counting a fixed number per firing strength.
    pub(crate) fn cuts(&self) -> usize {
        match &self.set {
            Set::Pieces(curves) => curves.workspace(),
            Set::Samples(..) | Set::Singletons(_) => 0,
        }
    }

    /// Returns the value; `None` if no rule fired. The function is not inlined, to keep the code of closed forms small.
    #[inline(never)]
    pub(crate) fn value(&self, strengths: Strengths<'_>, workspace: &mut Workspace) -> Option<f64> {
        let value = match &self.set {
            Set::Pieces(curves) => self.exact(
                |workspace, visit| {
                    curves.pieces(strengths, self.operators, workspace, visit);
                },
                workspace,
            ),
            Set::Samples(sampling, curves) => {
                let steps = sampling.samples.saturating_mul(strengths.strengths.len());
                if !workspace.steps.take(steps) {
                    return None;
                }
                sampling.value(self.defuzzifier, (self.low, self.high), |x| {
                    curves.degree(strengths, self.operators, x)
                })
            }
            Set::Singletons(singletons) => {
                singletons.value(strengths, self.operators, self.defuzzifier)
            }
        }?;
        Some(larger(self.low, smaller(self.high, value)))
    }

    /// Returns the value of a set; `pieces` visits the pieces of the set from left to right.
    fn exact(
        &self,
        pieces: impl Fn(&mut Workspace, &mut dyn FnMut(&Piece<'_>)),
        workspace: &mut Workspace,
    ) -> Option<f64> {
        let unit = unit(self.high - self.low);
        let mut whole = Integrals::about(self.low + 0.5 * (self.high - self.low), unit);
        match self.defuzzifier {
            SetDefuzzifier::Centroid => {
                pieces(workspace, &mut |piece| whole.add(piece));
                whole.centroid()
            }
            SetDefuzzifier::Bisector => {
                pieces(workspace, &mut |piece| whole.add(piece));
                let half = 0.5 * whole.area * unit;
                let mut sum = 0.0;
                let mut bisector = None;
                pieces(workspace, &mut |piece| {
                    if bisector.is_none() {
                        let area = piece.area();
                        if sum + area >= half && area > 0.0 {
                            bisector = Some(piece.position_of_area(half - sum));
                        }
                        sum += area;
                    }
                });
                bisector.filter(|_| whole.area > 0.0)
            }
            SetDefuzzifier::Maxima(which) => {
                let mut highest = HighestDegree::default();
                pieces(workspace, &mut |piece| highest.see(piece));
                let mut maxima = Maxima::of(highest);
                pieces(workspace, &mut |piece| maxima.see(piece));
                maxima.value(which).filter(|_| highest.0 > 0.0)
            }
        }
    }
}
