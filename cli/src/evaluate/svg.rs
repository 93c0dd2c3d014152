//! The evaluation as a picture: the receiver operating characteristic of every estimator, and the reliability of risks.

use std::fmt::Write as _;

use flagred::evaluation::{Band, RocPoint};

use super::{Evaluation, scores::Evaluated};
use crate::drawing::text::Escaped;

/// Eight colours that the colour-blind can tell apart (Okabe and Ito, 2008); one without any is the eighth.
const COLOURS: [&str; 8] = [
    "#d55e00", "#0072b2", "#009e73", "#cc79a7", "#e69f00", "#56b4e9", "#8a7f00", "#555555",
];

/// Lines differ in their dashes as well.
const DASHES: [&str; 4] = ["none", "7 3", "2 3", "9 3 2 3"];

/// The side of a panel, and the room around it, in pixels.
const SIDE: f64 = 360.0;
const LEFT: f64 = 60.0;
const TOP: f64 = 44.0;
const APART: f64 = 80.0;
const LEGEND: f64 = 250.0;

/// Draws an evaluation.
pub(super) fn draw(evaluation: &Evaluation) -> String {
    let second = LEFT + SIDE + APART;
    let width = second + SIDE + 20.0 + LEGEND;
    let lines = evaluation.estimators.len() as f64;
    let height = (TOP + SIDE + 56.0).max(TOP + lines * 18.0 + 20.0);
    let mut svg = format!(
        "<svg xmlns=\"http://www.w3.org/2000/svg\" viewBox=\"0 0 {width} {height}\" font-family=\"sans-serif\" font-size=\"12\">\n\
         <rect width=\"100%\" height=\"100%\" fill=\"white\"/>\n"
    );
    panel(
        &mut svg,
        LEFT,
        "receiver operating characteristic",
        ("share of the others", "share of the critical ones"),
    );
    panel(
        &mut svg,
        second,
        "reliability",
        ("risk in %", "share that became critical in %"),
    );
    for x in [LEFT, second] {
        let points = [(0.0, 0.0), (1.0, 1.0)];
        polyline(&mut svg, x, points.into_iter(), "#bbbbbb", "2 4");
    }
    for (i, evaluated) in evaluation.estimators.iter().enumerate() {
        let (colour, dash) = style(i);
        if evaluated.all.areas.is_some() {
            let at = |p: &RocPoint| (p.false_positive_rate, p.true_positive_rate);
            polyline(&mut svg, LEFT, evaluated.roc.iter().map(at), colour, dash);
        }
        if let Some(bands) = &evaluated.reliability {
            let points = bands.iter().filter_map(point);
            polyline(&mut svg, second, points.clone(), colour, dash);
            for (x, y) in points {
                let (x, y) = place(second, x, y);
                let _ = writeln!(
                    svg,
                    "<circle cx=\"{x:.1}\" cy=\"{y:.1}\" r=\"3\" fill=\"{colour}\"/>"
                );
            }
        }
        legend(&mut svg, second + SIDE + 24.0, i, evaluated);
    }
    svg.push_str("</svg>\n");
    svg
}

fn style(i: usize) -> (&'static str, &'static str) {
    (COLOURS[i % COLOURS.len()], DASHES[i % DASHES.len()])
}

/// The mean risk of a band and its critical share; nothing where too little fell into it.
fn point(band: &Band) -> Option<(f64, f64)> {
    const FEWEST: u64 = 5;
    let share = band.critical as f64 / band.predictions.max(FEWEST) as f64;
    let risk = band.mean_risk_pct.filter(|_| band.predictions >= FEWEST)?;
    Some((risk / 100.0, share))
}

/// Where a point of the unit square stands in the panel at `left`.
fn place(left: f64, x: f64, y: f64) -> (f64, f64) {
    (left + x * SIDE, TOP + (1.0 - y) * SIDE)
}

fn panel(svg: &mut String, left: f64, title: &str, (x_label, y_label): (&str, &str)) {
    let middle = left + SIDE / 2.0;
    let percent = title == "reliability";
    let _ = writeln!(
        svg,
        "<text x=\"{middle}\" y=\"{}\" text-anchor=\"middle\" font-size=\"14\">{title}</text>",
        TOP - 16.0
    );
    for tick in 0..=5 {
        let share = f64::from(tick) / 5.0;
        let label = match percent {
            true => format!("{}", tick * 20),
            false => format!("{share:.1}"),
        };
        let (x, y) = place(left, share, share);
        let (bottom, right) = (TOP + SIDE, left + SIDE);
        let _ = writeln!(
            svg,
            "<path d=\"M{x} {TOP}V{bottom}M{left} {y}H{right}\" stroke=\"#eeeeee\"/>\
             <text x=\"{x}\" y=\"{}\" text-anchor=\"middle\">{label}</text>\
             <text x=\"{}\" y=\"{}\" text-anchor=\"end\">{label}</text>",
            bottom + 16.0,
            left - 6.0,
            y + 4.0
        );
    }
    let (label_x, label_y) = (left - 40.0, TOP + SIDE / 2.0);
    let _ = writeln!(
        svg,
        "<rect x=\"{left}\" y=\"{TOP}\" width=\"{SIDE}\" height=\"{SIDE}\" fill=\"none\" stroke=\"#888888\"/>\
         <text x=\"{middle}\" y=\"{}\" text-anchor=\"middle\">{x_label}</text>\
         <text transform=\"translate({label_x} {label_y}) rotate(-90)\" text-anchor=\"middle\">{y_label}</text>",
        TOP + SIDE + 36.0
    );
}

fn polyline(
    svg: &mut String,
    left: f64,
    points: impl Iterator<Item = (f64, f64)>,
    colour: &str,
    dash: &str,
) {
    svg.push_str("<polyline points=\"");
    for (x, y) in points {
        let (x, y) = place(left, x, y);
        let _ = write!(svg, "{x:.1},{y:.1} ");
    }
    let _ = writeln!(
        svg,
        "\" fill=\"none\" stroke=\"{colour}\" stroke-width=\"1.8\" stroke-dasharray=\"{dash}\"/>"
    );
}

fn legend(svg: &mut String, left: f64, i: usize, evaluated: &Evaluated) {
    let (colour, dash) = style(i);
    let y = TOP + 8.0 + 18.0 * i as f64;
    let area = evaluated.all.areas;
    let area = area.map_or("unknown".to_owned(), |area| format!("{:.3}", area.roc));
    let name = Escaped(&evaluated.name);
    let _ = writeln!(
        svg,
        "<path d=\"M{left} {y}h28\" stroke=\"{colour}\" stroke-width=\"1.8\" stroke-dasharray=\"{dash}\"/>\
         <text x=\"{}\" y=\"{}\">{name} {area}</text>",
        left + 36.0,
        y + 4.0
    );
}

#[cfg(test)]
mod tests {
    use flagred::evaluation::{Prediction, Ranking, reliability};

    use super::*;
    use crate::evaluate::scores::Scores;

    #[test]
    fn a_picture_holds_every_estimator_by_name_and_area() {
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
        let evaluated = |name: &str, is_risk: bool| Evaluated {
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
            estimators: vec![evaluated("a<b", true), evaluated("spread", false)],
            warnings: Vec::new(),
            alarms: Vec::new(),
            records: Vec::new(),
        };
        insta::assert_snapshot!(draw(&evaluation));
    }
}
