//! What learned rules are worth on vehicles they were not learned from.
//!
//! Each vehicle is left out in turn, with its flights in changing conditions and in steady wind; the rules are learned
//! from all others, exactly as `scripts/learn-flagred` learns them from all, and say what they think of the one left out.
//! The scores of all turns are pooled. The terms, the windows and the thresholds of the verdict stay the same in every
//! turn: they were chosen on these vehicles, so the figures are a little kinder than those of other vehicles would be.
//!
//! `FLAGRED_SHARED=... cargo test -p flagred-tests --test leave_vehicles_out -- --ignored --nocapture` prints the figures.

use std::{collections::BTreeSet, fs, path::Path};

use flagred::{
    estimator::Estimator,
    evaluation::{Answer, Interval, Judged, Prediction, Ranking, Span, judge},
    profile::Profile,
    shipped,
};
use flagred_tests::{
    reference_data,
    simulated::{self, AS_FLOWN, Simulated, on_all_cores},
};
use fuzzy::{
    Model,
    learn::{Direction, Learner, Resolution, Settings},
};

/// A row to learn from: the inputs, the risk in %, the vehicle, and whether it was critical.
struct Row {
    values: Vec<f64>,
    vehicle: String,
    is_critical: bool,
}

fn settings() -> Settings {
    let given = fuzzy::rule::parse("IF at_limit IS none THEN risk IS low").unwrap();
    let rising = |name: &str| (name.to_owned(), Direction::Rising);
    Settings {
        resolution: Resolution::Mean,
        min_support: 5,
        complete: true,
        monotone: vec![
            rising("unsteady_now"),
            rising("unsteady_lately"),
            rising("load"),
        ],
        given: Some(given.condition),
        ..Settings::default()
    }
}

/// Learns from the rows of both sets but those of a vehicle; both sets count the same.
fn learn(blank: &Model, sets: &[&[Row]], without: &str) -> Model {
    let mut learner = Learner::new(blank, settings()).unwrap();
    for set in sets {
        let rows = || set.iter().filter(|row| row.vehicle != without);
        let weight = 1.0 / rows().count() as f64;
        for row in rows() {
            learner.add(&row.values, weight).unwrap();
        }
    }
    learner.finish().model
}

fn profile() -> Profile {
    shipped::flagred().profile().clone()
}

/// The rows of the campaign in steady wind, a flight each.
fn whole_flights(data: &Path) -> Vec<Row> {
    let text = fs::read_to_string(data.join("sitl/runs.csv")).unwrap();
    let mut lines = text.lines();
    let header: Vec<&str> = lines.next().unwrap().split(',').collect();
    let row = |line: &str| {
        let cells: Vec<&str> = line.split(',').collect();
        let cell = |name: &str| cells[header.iter().position(|h| *h == name).unwrap()];
        let number = |name: &str| cell(name).parse::<f64>().unwrap();
        let (low, high) = (number("c_limit_low"), number("c_limit_high"));
        // The variance over all motors and times is that of the motors' mean over time plus the mean square of the
        // spread between motors; what that has beyond the square of its mean is its variance over time.
        let square =
            number("c_std").powi(2) - number("c_std_time").powi(2) - number("c_std_motors").powi(2);
        let unsteady = square.max(0.0).sqrt() / (high - low);
        let load = (number("c_mean") - low) / (high - low);
        let error_deg = number("att_rmse_deg");
        let crashed = cell("crashed") == "1";
        let risk = if crashed {
            100.0
        } else {
            (error_deg * 20.0).min(100.0)
        };
        Row {
            values: vec![unsteady, unsteady, load, number("sat_lim_frac"), risk],
            vehicle: simulated::vehicle(cell("frame")),
            is_critical: crashed || error_deg >= 5.0,
        }
    };
    lines.map(row).collect()
}

/// The steps of a flight as rows.
fn steps(flight: &Simulated, estimator: &Estimator) -> Vec<Row> {
    let said = flight.replay(estimator, AS_FLOWN);
    let steps = flight.steps.iter().zip(said.steps);
    let row = |((t_s, is_critical), (mut values, _)): (&(f64, bool), (Vec<f64>, f64))| {
        values.push((flight.error_ahead_deg(*t_s) * 20.0).min(100.0));
        Row {
            values,
            vehicle: flight.vehicle.clone(),
            is_critical: *is_critical,
        }
    };
    steps.map(row).collect()
}

/// What rules that do not know a vehicle say of it.
struct Turn {
    /// Of its whole flights, and of the steps of its flights with their number.
    rows: Vec<Prediction>,
    steps: Vec<Prediction>,
    /// Of each of its flights: its number, and what the warnings come to.
    judged: Vec<(usize, Judged)>,
}

#[test]
#[ignore = "needs FLAGRED_SHARED"]
fn rules_hold_on_vehicles_they_were_not_learned_from() {
    let data = reference_data();
    let blank = fs::read_to_string("../rules/to-learn/flagred.yaml").unwrap();
    let blank = fuzzy::yaml::parse(&blank).unwrap().model;
    let all = shipped::flagred_rules();
    let estimator = Estimator::new(&profile(), &all).unwrap();
    let flights = simulated::flights(&data);
    let whole = whole_flights(&data);
    let of_flights = on_all_cores(&flights, |flight| match flight.kind.as_str() {
        "manoeuvre" => Vec::new(),
        _ => steps(flight, &estimator),
    });
    let of_steps: Vec<Row> = of_flights.into_iter().flatten().collect();
    assert_eq!((whole.len(), of_steps.len()), (612, 44_369));

    // From all of them: the shipped rules.
    let learned = learn(&blank, &[&of_steps, &whole], "nobody");
    let text = |model: &Model| {
        model
            .rules
            .iter()
            .map(|r| r.rule.to_string())
            .collect::<Vec<_>>()
    };
    assert_eq!(text(&learned), text(&all));

    let names = whole
        .iter()
        .chain(&of_steps)
        .map(|row| row.vehicle.as_str());
    let vehicles: Vec<&str> = names.collect::<BTreeSet<_>>().into_iter().collect();
    let turns = on_all_cores(&vehicles, |vehicle| {
        let rules = learn(&blank, &[&of_steps, &whole], vehicle);
        turn(
            vehicle,
            &Estimator::new(&profile(), &rules).unwrap(),
            &whole,
            &flights,
        )
    });

    let area = |name: &str, predictions: Vec<Prediction>| {
        let ranking = Ranking::new(predictions);
        let areas = ranking.areas().unwrap();
        let Interval { low, high } = ranking.bootstrap(200, 1).unwrap().roc;
        println!(
            "{name}: area under ROC {:.4} [{low:.3}, {high:.3}], under precision-recall {:.3}, {} of {} critical",
            areas.roc,
            areas.precision_recall,
            ranking.critical(),
            ranking.len()
        );
        areas.roc
    };
    println!("{} vehicles, each left out in turn", vehicles.len());
    let rows = area(
        "whole flights in steady wind",
        turns.iter().flat_map(|t| t.rows.clone()).collect(),
    );
    let series = area(
        "steps in changing conditions",
        turns.iter().flat_map(|t| t.steps.clone()).collect(),
    );
    let judged: Vec<(&Simulated, &Judged)> = turns
        .iter()
        .flat_map(|turn| &turn.judged)
        .map(|(i, judged)| (&flights[*i], judged))
        .collect();
    let warnings = warnings(&judged);
    assert!(rows >= 0.96, "{rows}");
    assert!(series >= 0.88, "{series}");
    assert!(warnings.ramps_announced >= 0.85);
    assert!(warnings.lead_s > 5.0);
    assert!(warnings.answer_s < 1.5 && warnings.answer_from_good_s < 1.5);
    assert!(
        warnings.false_per_hour <= 6.0,
        "{}",
        warnings.false_per_hour
    );
    assert_eq!(warnings.of_calm, 0);
}

fn turn(vehicle: &str, estimator: &Estimator, whole: &[Row], flights: &[Simulated]) -> Turn {
    let mut turn = Turn {
        rows: Vec::new(),
        steps: Vec::new(),
        judged: Vec::new(),
    };
    for (i, row) in whole
        .iter()
        .enumerate()
        .filter(|(_, row)| row.vehicle == vehicle)
    {
        turn.rows.push(Prediction {
            score: estimator.at(&row.values[..4]).unwrap().risk_pct,
            critical: row.is_critical,
            group: i as u32,
        });
    }
    for (i, flight) in flights
        .iter()
        .enumerate()
        .filter(|(_, f)| f.vehicle == vehicle)
    {
        let said = flight.replay(estimator, AS_FLOWN);
        if flight.kind != "manoeuvre" {
            let steps = flight.steps.iter().zip(said.steps);
            turn.steps
                .extend(steps.map(|((_, critical), (_, score))| Prediction {
                    score,
                    critical: *critical,
                    group: i as u32,
                }));
        }
        let judged = judge(
            &said.warnings,
            flight.errors.episodes(),
            &[flight.judged],
            flight.lost_s,
        );
        turn.judged.push((i, judged));
    }
    turn
}

struct Figures {
    ramps_announced: f64,
    lead_s: f64,
    answer_s: f64,
    answer_from_good_s: f64,
    false_per_hour: f64,
    of_calm: usize,
}

fn warnings(judged: &[(&Simulated, &Judged)]) -> Figures {
    let but_manoeuvres: Vec<_> = judged
        .iter()
        .filter(|(f, _)| f.kind != "manoeuvre")
        .collect();
    let hours: f64 = but_manoeuvres
        .iter()
        .map(|(f, _)| f.judged.length_s() / 3600.0)
        .sum();
    let of_all = but_manoeuvres
        .iter()
        .flat_map(|(_, judged)| &judged.warnings);
    let false_ones = of_all.filter(|warning| warning.is_false).count();
    let calm = but_manoeuvres.iter().filter(|(f, _)| f.kind == "calm");
    let of_calm = calm.map(|(_, judged)| judged.warnings.len()).sum();

    // Ramps: a flight in rising wind, or the last that was done was a ramp.
    let (mut ramps, mut firsts) = (Vec::new(), Vec::new());
    let (mut answers, mut from_good) = (Vec::new(), Vec::new());
    for (flight, judged) in &but_manoeuvres {
        let mut group_until_s = f64::NEG_INFINITY;
        for (n, answer) in judged.answers.iter().enumerate() {
            let starts_s = answer.episode.from_s;
            let last = last_event(flight, starts_s);
            let is_ramp = flight.kind == "rising"
                || last.is_some_and(|(t_s, event, _)| {
                    event == "ramp_start" || (event == "ramp_end" && starts_s - t_s <= 5.0)
                });
            if is_ramp {
                ramps.push(answer);
                if starts_s > group_until_s + 5.0 {
                    firsts.push(answer);
                }
                group_until_s = answer.episode.to_s;
            }
            let is_sharp = |(_, event, time_constant_s): &&(f64, String, f64)| {
                flight.kind == "gusts"
                    && (event == "wind_step" || event == "gust_start")
                    && *time_constant_s <= 1.0
            };
            if let Some((t_s, ..)) = last.filter(is_sharp)
                && starts_s - t_s <= 10.0
                && judged.answers[..n]
                    .iter()
                    .all(|before| before.episode.from_s < *t_s)
            {
                let on = judged.warnings.iter().map(|warning| warning.span);
                let on: Vec<Span> = on.filter(|warning| warning.to_s >= *t_s).collect();
                let answer_s = on
                    .first()
                    .map_or(f64::INFINITY, |w| (w.from_s - t_s).max(0.0));
                answers.push(answer_s);
                if on.first().is_none_or(|warning| warning.from_s > *t_s) {
                    from_good.push(answer_s);
                }
            }
        }
    }
    let announced = |answers: &[&Answer]| {
        let announced = answers.iter().filter(|answer| answer.is_announced());
        announced.count() as f64 / answers.len() as f64
    };
    let lead_s = |answers: &[&Answer]| {
        let announced = answers.iter().filter(|answer| answer.is_announced());
        median(announced.filter_map(|answer| answer.lead_s()).collect())
    };
    let figures = Figures {
        ramps_announced: announced(&ramps),
        lead_s: lead_s(&ramps),
        answer_s: median(answers.clone()),
        answer_from_good_s: median(from_good.clone()),
        false_per_hour: false_ones as f64 / hours,
        of_calm,
    };
    println!(
        "rising wind and ramps: {:.0} % of {} episodes announced, median lead {:.1} s; of the first of each group {:.0} % of {}, {:.1} s",
        100.0 * figures.ramps_announced,
        ramps.len(),
        figures.lead_s,
        100.0 * announced(&firsts),
        firsts.len(),
        lead_s(&firsts)
    );
    println!(
        "sharp gusts: median {:.2} s to answer over {}; {:.2} s over the {} that found it silent",
        figures.answer_s,
        answers.len(),
        figures.answer_from_good_s,
        from_good.len()
    );
    println!(
        "false warnings: {:.1} per hour in {hours:.2} h; in calm and light wind {of_calm} of any kind",
        figures.false_per_hour
    );
    figures
}

/// The last thing that was done to a flight before a time.
fn last_event(flight: &Simulated, before_s: f64) -> Option<&(f64, String, f64)> {
    const DONE: [&str; 8] = [
        "wind_step",
        "gust_start",
        "gust_end",
        "ramp_start",
        "ramp_end",
        "calm",
        "fault",
        "manoeuvre_start",
    ];
    let done =
        |(t_s, event, _): &&(f64, String, f64)| *t_s <= before_s && DONE.contains(&event.as_str());
    flight.events.iter().rfind(done)
}

fn median(mut values: Vec<f64>) -> f64 {
    values.sort_by(f64::total_cmp);
    let middle = values.len() / 2;
    if values.len() % 2 == 1 {
        return values[middle];
    }
    (values[middle - 1] + values[middle]) / 2.0
}
