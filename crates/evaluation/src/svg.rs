//! The evaluation as a picture: the ROC curve of every estimator, and the reliability of risks.

use fuzzy::drawing::{Colour, Plot, PlotLine, Scale, plots_svg};

use crate::{Evaluation, ranking::Band, scores::ProfileScores};

/// Draws an evaluation.
pub fn draw(evaluation: &Evaluation) -> String {
    let estimators = || evaluation.estimators.iter().enumerate();
    let roc = estimators().map(|(i, evaluated)| {
        let known = evaluated.all.areas.map(|_| evaluated.roc.iter());
        let points = known.into_iter().flatten();
        let points = points.map(|p| (p.false_positive_rate, p.true_positive_rate));
        PlotLine::new(i, name(evaluated), points.collect())
    });
    let reliability = estimators().map(|(i, evaluated)| {
        let bands = evaluated.reliability.iter().flatten();
        PlotLine {
            dots: true,
            ..PlotLine::new(i, name(evaluated), bands.filter_map(point).collect())
        }
    });
    let diagonal = |end: f64| {
        std::iter::once(PlotLine {
            colour: Colour(0xbb, 0xbb, 0xbb),
            dash: "2 4",
            ..PlotLine::new(0, "", vec![(0.0, 0.0), (end, end)])
        })
    };
    let (shares, percent) = (Scale::new(0.0, 1.0), Scale::new(0.0, 100.0));
    let plots = [
        Plot {
            title: "ROC curve".into(),
            x: (shares, "false positive rate".into()),
            y: (shares, "true positive rate".into()),
            series: diagonal(1.0).chain(roc).collect(),
        },
        Plot {
            title: "Reliability".into(),
            x: (percent, "risk [%]".into()),
            y: (percent, "share that became critical [%]".into()),
            series: diagonal(100.0).chain(reliability).collect(),
        },
    ];
    plots_svg("ROC curves and reliability", &plots)
}

/// A label with the name of an estimator and its area under the ROC curve.
fn name(evaluated: &ProfileScores) -> String {
    let area = evaluated.all.areas;
    let area = area.map_or("unknown".to_owned(), |area| format!("{:.3}", area.roc));
    format!("{} {area}", evaluated.name)
}

/// The mean risk and the share of critical cases in a band, in percent; `None` if the band contains too few
/// predictions.
fn point(band: &Band) -> Option<(f64, f64)> {
    const FEWEST: u64 = 5;
    let risk_pct = band.mean_risk_pct.filter(|_| band.predictions >= FEWEST)?;
    Some((
        risk_pct,
        100.0 * band.critical as f64 / band.predictions as f64,
    ))
}

#[cfg(test)]
mod tests {
    use crate::{Prediction, Ranking, reliability};

    use super::*;
    use crate::scores::Scores;

    #[test]
    fn a_picture_contains_every_estimator_with_its_area() {
        let cases = (0..200_u32).map(|i| Prediction {
            score: f64::from(i) / 2.0,
            critical: (i * 53) % 97 + i > 150,
            group: i,
        });
        let ranking = Ranking::new(cases.clone());
        let scores = || Scores {
            cases: 200,
            unknown: 0,
            critical: ranking.critical(),
            areas: ranking.areas(),
            intervals: None,
            within: None,
        };
        let evaluated = |name: &str, is_risk: bool| ProfileScores {
            name: name.into(),
            description: String::new(),
            all: scores(),
            quiet: scores(),
            onset: scores(),
            by_vehicle: Vec::new(),
            by_kind: Vec::new(),
            reliability: is_risk.then(|| reliability(cases.clone())),
            roc: ranking.roc(20),
        };
        let evaluation = Evaluation {
            cases: "flights",
            horizon_s: None,
            flights: 200,
            critical: ranking.critical(),
            left_out: Vec::new(),
            all: Vec::new(),
            estimators: vec![evaluated("a<b", true), evaluated("spread", false)],
            warnings: Vec::new(),
            alarms: Vec::new(),
            records: Vec::new(),
        };
        insta::with_settings!({snapshot_path => "../tests/snapshots"}, {
            insta::assert_snapshot!(draw(&evaluation));
        });
    }
}
