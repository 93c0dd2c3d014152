//! Measures how well scores rank critical cases above the others.

use std::collections::BTreeMap;

use crate::bootstrap::{Interval, bootstrap};

/// The score of a case, and whether the case was critical.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct Prediction {
    /// The score: finite; higher means more critical.
    pub score: f64,
    /// Whether the case was critical.
    pub critical: bool,
    /// The group, such as a flight. Predictions of a group are not independent.
    pub group: u32,
}

/// Predictions sorted by their scores.
///
/// # Example: one pair of four is ranked wrong
///
/// ```
/// use flagred_evaluation::{Prediction, Ranking};
///
/// let told = [(0.9, true), (0.8, false), (0.7, true), (0.1, false)];
/// let ranking = Ranking::new(told.into_iter().enumerate().map(|(i, (score, critical))| {
///     Prediction { score, critical, group: i as u32 }
/// }));
/// let areas = ranking.areas().ok_or("needs both kinds")?;
/// assert_eq!(areas.roc, 0.75);
/// # Ok::<(), &str>(())
/// ```
#[derive(Debug, Clone)]
pub struct Ranking {
    /// The predictions, highest score first.
    ranked: Vec<RankedPrediction>,
    groups: usize,
}

/// The counts of a group so far, from the highest score down.
#[derive(Debug, Clone, Copy, Default)]
struct GroupCount {
    critical: f64,
    others: f64,
    critical_of_tie: f64,
    others_of_tie: f64,
    pairs: f64,
}

impl GroupCount {
    fn end_tie(&mut self) {
        self.pairs += self.others_of_tie * (self.critical + self.critical_of_tie / 2.0);
        self.critical += self.critical_of_tie;
        self.others += self.others_of_tie;
        (self.critical_of_tie, self.others_of_tie) = (0.0, 0.0);
    }
}

#[derive(Debug, Clone, Copy)]
struct RankedPrediction {
    group: u32,
    critical: bool,
    /// Whether the next prediction has a lower score.
    ends_tie: bool,
}

/// The areas under the ROC curve and the precision-recall curve.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct Areas {
    /// The area under the receiver operating characteristic: the share of pairs of a critical and a non-critical
    /// prediction in which the critical one has the higher score; equal scores count half.
    pub roc: f64,
    /// The area under precision over recall, as average precision: `sum (recall_n - recall_n-1) precision_n` over the
    /// scores from the highest down.
    pub precision_recall: f64,
}

/// The intervals of [`Areas`].
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct Intervals {
    /// The interval of the area under the receiver operating characteristic.
    pub roc: Interval,
    /// The interval of the average precision.
    pub precision_recall: Interval,
}

/// How well scores rank within groups, such as flights.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct WithinGroups {
    /// The mean over the groups of the area under the receiver operating characteristic.
    pub roc: f64,
    /// The 95 % interval of this mean; `None` without resamples.
    pub interval: Option<Interval>,
    /// The number of groups with both critical and other predictions.
    pub groups: usize,
}

/// A point of the receiver operating characteristic.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct RocPoint {
    /// The share of the non-critical predictions whose score is at or above the threshold of this point.
    pub false_positive_rate: f64,
    /// The share of the critical predictions whose score is at or above the threshold of this point.
    pub true_positive_rate: f64,
}

impl Ranking {
    /// Ranks predictions; those with a score that is not finite are ignored.
    pub fn new(predictions: impl IntoIterator<Item = Prediction>) -> Ranking {
        let mut kept: Vec<Prediction> = predictions
            .into_iter()
            .filter(|p| p.score.is_finite())
            .collect();
        kept.sort_by(|a, b| b.score.total_cmp(&a.score));
        let mut numbers = BTreeMap::new();
        let ranked = kept
            .iter()
            .zip(kept.iter().skip(1).map(Some).chain([None]))
            .map(|(p, next)| {
                let fresh = numbers.len() as u32;
                RankedPrediction {
                    group: *numbers.entry(p.group).or_insert(fresh),
                    critical: p.critical,
                    ends_tie: next.is_none_or(|next| next.score < p.score),
                }
            })
            .collect();
        Ranking {
            ranked,
            groups: numbers.len(),
        }
    }

    /// The number of predictions.
    pub fn len(&self) -> usize {
        self.ranked.len()
    }

    /// Whether there are no predictions.
    pub fn is_empty(&self) -> bool {
        self.ranked.is_empty()
    }

    /// The number of critical predictions.
    pub fn critical(&self) -> usize {
        self.ranked
            .iter()
            .filter(|prediction| prediction.critical)
            .count()
    }

    /// The areas under the curves; `None` unless there are both critical and other predictions.
    pub fn areas(&self) -> Option<Areas> {
        self.weighted_areas(&vec![1; self.groups])
    }

    /// The 95 % intervals of the areas, over resamples that draw whole groups with replacement.
    ///
    /// The same seed gives the same intervals. `None` as for [`Ranking::areas`]; resamples without both critical and
    /// other predictions are ignored.
    pub fn bootstrap(&self, resamples: usize, seed: u64) -> Option<Intervals> {
        let [roc, precision_recall] = bootstrap(self.groups, resamples, seed, |weights| {
            let areas = self.weighted_areas(weights)?;
            Some([areas.roc, areas.precision_recall])
        })?;
        Some(Intervals {
            roc,
            precision_recall,
        })
    }

    /// The mean area under the receiver operating characteristic within groups, over the groups that have both
    /// critical and other predictions. It measures whether scores predict when a case is critical, and not only in
    /// which group. `None` if no group has both.
    ///
    /// # Example: the score distinguishes two flights, but not the moments within them
    /// ```
    /// use flagred_evaluation::{Prediction, Ranking};
    ///
    /// let told = [(0.9, true, 0), (0.9, true, 0), (0.9, false, 0), (0.1, true, 1), (0.1, false, 1), (0.1, false, 1)];
    /// let ranking = Ranking::new(told.map(|(score, critical, group)| Prediction { score, critical, group }));
    /// assert!(ranking.areas().ok_or("needs both")?.roc > 0.6);
    /// assert_eq!(ranking.within_groups(1000, 1).ok_or("needs both")?.roc, 0.5);
    /// # Ok::<(), &str>(())
    /// ```
    pub fn within_groups(&self, resamples: usize, seed: u64) -> Option<WithinGroups> {
        // The predictions of all groups are ranked together. When a tie ends, its counts are added to those of each
        // group.
        let mut counts = vec![GroupCount::default(); self.groups];
        let mut tied = Vec::new();
        for prediction in &self.ranked {
            if let Some(count) = counts.get_mut(prediction.group as usize) {
                if count.critical_of_tie + count.others_of_tie == 0.0 {
                    tied.push(prediction.group);
                }
                match prediction.critical {
                    true => count.critical_of_tie += 1.0,
                    false => count.others_of_tie += 1.0,
                }
            }
            if prediction.ends_tie {
                for group in tied.drain(..) {
                    if let Some(count) = counts.get_mut(group as usize) {
                        count.end_tie();
                    }
                }
            }
        }
        let areas: Vec<f64> = counts
            .iter()
            .filter(|count| count.critical > 0.0 && count.others > 0.0)
            .map(|count| count.pairs / (count.critical * count.others))
            .collect();
        let mean = |weights: &[u32]| {
            let drawn: u32 = weights.iter().sum();
            let weighted = areas.iter().zip(weights).map(|(a, w)| a * f64::from(*w));
            (drawn > 0).then(|| weighted.sum::<f64>() / f64::from(drawn))
        };
        let interval = bootstrap(areas.len(), resamples, seed, |weights| {
            Some([mean(weights)?])
        });
        Some(WithinGroups {
            roc: mean(&vec![1; areas.len()])?,
            interval: interval.map(|[interval]| interval),
            groups: areas.len(),
        })
    }

    /// The areas if each prediction counts as many times as `weights` specifies for its group.
    fn weighted_areas(&self, weights: &[u32]) -> Option<Areas> {
        let (mut critical, mut others) = (0_u64, 0_u64);
        let (mut critical_of_tie, mut others_of_tie) = (0_u64, 0_u64);
        let (mut pairs, mut precisions) = (0.0, 0.0);
        for prediction in &self.ranked {
            let weight = weights.get(prediction.group as usize).copied().unwrap_or(0);
            if prediction.critical {
                critical_of_tie += u64::from(weight);
            } else {
                others_of_tie += u64::from(weight);
            }
            if prediction.ends_tie {
                pairs += others_of_tie as f64 * (critical as f64 + critical_of_tie as f64 / 2.0);
                critical += critical_of_tie;
                others += others_of_tie;
                if critical_of_tie > 0 {
                    let precision = critical as f64 / (critical + others) as f64;
                    precisions += critical_of_tie as f64 * precision;
                }
                (critical_of_tie, others_of_tie) = (0, 0);
            }
        }
        (critical > 0 && others > 0).then(|| Areas {
            roc: pairs / (critical as f64 * others as f64),
            precision_recall: precisions / critical as f64,
        })
    }

    /// The receiver operating characteristic from (0, 0) to (1, 1), in steps of about `1 / steps` along the curve.
    pub fn roc(&self, steps: u32) -> Vec<RocPoint> {
        let critical = self.critical();
        let others = self.len() - critical;
        let mut points = vec![RocPoint {
            false_positive_rate: 0.0,
            true_positive_rate: 0.0,
        }];
        let (mut hits, mut alarms) = (0_usize, 0_usize);
        let mut last = 0.0;
        for prediction in &self.ranked {
            if prediction.critical {
                hits += 1;
            } else {
                alarms += 1;
            }
            let point = RocPoint {
                false_positive_rate: alarms as f64 / others.max(1) as f64,
                true_positive_rate: hits as f64 / critical.max(1) as f64,
            };
            let way = point.false_positive_rate + point.true_positive_rate;
            let is_last = hits + alarms == self.len();
            if prediction.ends_tie && (is_last || (way - last) * f64::from(steps) >= 1.0) {
                points.push(point);
                last = way;
            }
        }
        points
    }
}

/// The predictions in a band of risk.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct Band {
    /// The lower end of the band in %, inclusive.
    pub from_pct: f64,
    /// The upper end in %, exclusive except for 100.
    pub to_pct: f64,
    /// The number of predictions in the band.
    pub predictions: u64,
    /// The number of these predictions that were critical.
    pub critical: u64,
    /// The mean risk of these predictions in %; `None` without predictions.
    pub mean_risk_pct: Option<f64>,
}

/// Returns how many predictions were critical, for each tenth of the risk from 0 to 100 %.
///
/// # Example
/// ```
/// use flagred_evaluation::{Prediction, reliability};
///
/// let told = [(12.0, false), (18.0, false), (95.0, true), (97.0, false)];
/// let bands = reliability(told.map(|(score, critical)| Prediction { score, critical, group: 0 }));
/// assert_eq!((bands[1].predictions, bands[1].critical), (2, 0));
/// assert_eq!((bands[9].predictions, bands[9].critical, bands[9].mean_risk_pct), (2, 1, Some(96.0)));
/// ```
pub fn reliability(predictions: impl IntoIterator<Item = Prediction>) -> [Band; 10] {
    let mut bands = std::array::from_fn(|i| Band {
        from_pct: 10.0 * i as f64,
        to_pct: 10.0 * (i + 1) as f64,
        predictions: 0,
        critical: 0,
        mean_risk_pct: None,
    });
    for prediction in predictions {
        let index = (prediction.score / 10.0) as usize;
        if !(0.0..=100.0).contains(&prediction.score) {
            continue;
        }
        if let Some(band) = bands.get_mut(index.min(9)) {
            band.predictions += 1;
            band.critical += u64::from(prediction.critical);
            let mean = band.mean_risk_pct.unwrap_or(0.0);
            let step = (prediction.score - mean) / band.predictions as f64;
            band.mean_risk_pct = Some(mean + step);
        }
    }
    bands
}

#[cfg(test)]
mod tests {
    use super::*;
    use proptest::prelude::*;

    /// 200 predictions in 10 groups with many equal scores, computed with integers.
    fn predictions() -> Vec<Prediction> {
        (0..200_u32)
            .map(|i| {
                let score = (i * 37) % 101 / 7;
                let critical = (i * 53) % 97 + 4 * score > 90;
                Prediction {
                    score: f64::from(score),
                    critical,
                    group: i / 20,
                }
            })
            .collect()
    }

    #[test]
    fn areas_agree_with_scikit_learn() {
        let ranking = Ranking::new(predictions());
        let areas = ranking.areas().unwrap();
        assert_eq!((ranking.len(), ranking.critical()), (200, 68));
        // Computed by roc_auc_score and average_precision_score of scikit-learn 1.9.1.
        approx::assert_abs_diff_eq!(areas.roc, 0.731_896_167_557_932_2, epsilon = 1e-12);
        approx::assert_abs_diff_eq!(
            areas.precision_recall,
            0.561_360_775_396_844_8,
            epsilon = 1e-12
        );
    }

    #[test]
    fn intervals_agree_with_a_bootstrap_in_numpy() {
        let ranking = Ranking::new(predictions());
        let found = ranking.bootstrap(2000, 7).unwrap();
        // Computed with NumPy's random number generator from 20,000 resamples of the ten groups, with the areas of
        // scikit-learn.
        for (found, expected) in [
            (found.roc.low, 0.6782),
            (found.roc.high, 0.7840),
            (found.precision_recall.low, 0.4992),
            (found.precision_recall.high, 0.6467),
        ] {
            approx::assert_abs_diff_eq!(found, expected, epsilon = 0.01);
        }
        assert_eq!(ranking.bootstrap(50, 7), ranking.bootstrap(50, 7));
    }

    #[test]
    fn without_both_kinds_there_is_no_area() {
        let all_of = |critical| {
            Ranking::new((0..5).map(move |group| Prediction {
                score: f64::from(group),
                critical,
                group,
            }))
        };
        for ranking in [all_of(true), all_of(false), Ranking::new([])] {
            assert_eq!(ranking.areas(), None);
            assert_eq!(ranking.bootstrap(10, 1), None);
            assert!(!ranking.roc(10).is_empty());
        }
    }

    #[test]
    fn a_risk_is_counted_in_its_tenth() {
        let at = |score| Prediction {
            score,
            critical: score > 50.0,
            group: 0,
        };
        let bands = reliability([0.0, 9.9, 10.0, 95.0, 100.0, f64::NAN, 101.0].map(at));
        let counts = bands.map(|band| (band.predictions, band.critical));
        assert_eq!(counts[0], (2, 0));
        assert_eq!(counts[1], (1, 0));
        assert_eq!(counts[9], (2, 2));
        assert_eq!(bands[9].mean_risk_pct, Some(97.5));
        assert_eq!(bands[5].mean_risk_pct, None);
    }

    #[test]
    fn the_area_within_groups_is_the_mean_of_their_own() {
        let within = Ranking::new(predictions()).within_groups(200, 1).unwrap();
        let areas: Vec<f64> = (0..10)
            .filter_map(|group| {
                let own = predictions().into_iter().filter(|p| p.group == group);
                Ranking::new(own).areas().map(|areas| areas.roc)
            })
            .collect();
        let mean = areas.iter().sum::<f64>() / areas.len() as f64;
        assert_eq!(within.groups, areas.len());
        approx::assert_abs_diff_eq!(within.roc, mean, epsilon = 1e-12);
        let interval = within.interval.unwrap();
        assert!(interval.low < mean && mean < interval.high);
    }

    proptest! {
        #![proptest_config(ProptestConfig::with_cases(64))]

        #[test]
        fn the_area_is_the_share_of_pairs_in_order(
            drawn in prop::collection::vec((0_u8..12, any::<bool>()), 2..60),
        ) {
            let ranking = Ranking::new(drawn.iter().enumerate().map(|(i, (score, critical))| Prediction {
                score: f64::from(*score), critical: *critical, group: i as u32,
            }));
            let (mut pairs, mut in_order) = (0.0, 0.0);
            for (a, _) in drawn.iter().filter(|d| d.1) {
                for (b, _) in drawn.iter().filter(|d| !d.1) {
                    pairs += 1.0;
                    in_order += if a > b { 1.0 } else if a == b { 0.5 } else { 0.0 };
                }
            }
            match ranking.areas() {
                Some(areas) => {
                    prop_assert!((areas.roc - in_order / pairs).abs() < 1e-12);
                    // The area under the curve itself, by the trapezoidal rule, is the same.
                    let trapezoids: f64 = ranking.roc(1_000_000).windows(2).map(|p| {
                        (p[1].false_positive_rate - p[0].false_positive_rate)
                            * (p[0].true_positive_rate + p[1].true_positive_rate) / 2.0
                    }).sum();
                    prop_assert!((trapezoids - areas.roc).abs() < 1e-12);
                }
                None => prop_assert_eq!(pairs, 0.0),
            }
        }
    }
}
