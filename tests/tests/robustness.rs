//! The shipped rules on coarse logs, with wrong limits, and with faults.
//!
//! `FLAGRED_SHARED=... cargo test -p flagred-tests --test robustness -- --ignored --nocapture` prints the figures.

use flagred::{estimator::Estimator, shipped};
use flagred_evaluation::{Prediction, Ranking};
use flagred_tests::{
    reference_data,
    simulated::{self, AS_FLOWN, ProfileRun, Replay, SimulatedFlight, on_all_cores},
};

fn estimator() -> Estimator {
    let profile = shipped::flagred().profile().clone();
    let rules = shipped::flagred_rules();
    Estimator::new(&profile, &rules).unwrap()
}

#[test]
#[ignore = "needs FLAGRED_SHARED"]
fn risk_on_coarse_logs_with_wrong_limits_and_faults() {
    let data = reference_data();
    let flights = simulated::flights(&data);
    let estimator = estimator();
    let replay = |how: Replay| on_all_cores(&flights, |flight| flight.replay(&estimator, how));
    let as_flown = replay(AS_FLOWN);

    println!(
        "area under ROC on steps, mean change of the risk in points, share of steps within 3 points, flights warned \
         of or not as with all samples, share of steps without a risk"
    );
    let table = [
        ("as flown, 25 Hz", AS_FLOWN, 0.89, 0.001),
        (
            "12.5 Hz",
            Replay {
                every: 2,
                ..AS_FLOWN
            },
            0.89,
            0.5,
        ),
        (
            "8.3 Hz",
            Replay {
                every: 3,
                ..AS_FLOWN
            },
            0.89,
            1.0,
        ),
        (
            "5 Hz",
            Replay {
                every: 5,
                ..AS_FLOWN
            },
            0.88,
            1.5,
        ),
        (
            "4.2 Hz",
            Replay {
                every: 6,
                ..AS_FLOWN
            },
            0.88,
            1.6,
        ),
        (
            "effective range 0.05 too low",
            Replay {
                wrong_by: (-0.05, 0.0),
                ..AS_FLOWN
            },
            0.88,
            3.5,
        ),
        (
            "lower end 0.05 too high",
            Replay {
                wrong_by: (0.05, 0.0),
                ..AS_FLOWN
            },
            0.88,
            3.5,
        ),
        (
            "upper end 0.05 too high",
            Replay {
                wrong_by: (0.0, 0.05),
                ..AS_FLOWN
            },
            0.88,
            3.5,
        ),
        (
            "upper end 0.05 too low",
            Replay {
                wrong_by: (0.0, -0.05),
                ..AS_FLOWN
            },
            0.88,
            3.5,
        ),
    ];
    for (name, how, least, most) in table {
        let said = replay(how);
        let RiskComparison {
            auc,
            change,
            near,
            unknown,
        } = compare(&flights, &as_flown, &said);
        let warned = |said: &ProfileRun| !said.warnings.is_empty();
        let pairs = as_flown.iter().zip(&said);
        let same = pairs.filter(|(a, b)| warned(a) == warned(b)).count();
        println!(
            "{name:30} {auc:.4} {change:6.2} {:5.1} % {same} of {} {:5.1} %",
            100.0 * near,
            flights.len(),
            100.0 * unknown
        );
        assert!(
            auc >= least && change <= most && unknown < 0.01,
            "{name}: {auc} {change} {unknown}"
        );
        assert!(
            near >= 0.95 || how.every > 3 || how.wrong_by != (0.0, 0.0),
            "{name}: {near}"
        );
    }
    // Two samples in a window do not determine a variation: unknown is better than a wrong number.
    let RiskComparison { unknown, .. } = compare(
        &flights,
        &as_flown,
        &replay(Replay {
            every: 25,
            ..AS_FLOWN
        }),
    );
    println!(
        "{:30} {:.0} % of the steps without a risk",
        "1 Hz",
        100.0 * unknown
    );
    assert_eq!(unknown, 1.0);

    faults(&flights, &as_flown);
}

/// Results compared with those of the unchanged flight.
struct RiskComparison {
    auc: f64,
    /// Mean change of the risk, in percentage points.
    change: f64,
    /// The share of steps whose risk changes by at most 3 points.
    near: f64,
    /// The share of steps without a risk.
    unknown: f64,
}

fn compare(
    flights: &[SimulatedFlight],
    as_flown: &[ProfileRun],
    said: &[ProfileRun],
) -> RiskComparison {
    let mut predictions = Vec::new();
    let (mut change, mut known, mut near, mut unknown) = (0.0, 0.0, 0.0, 0.0);
    for (i, flight) in flights
        .iter()
        .enumerate()
        .filter(|(_, f)| f.kind != "manoeuvre")
    {
        let steps = flight
            .steps
            .iter()
            .zip(&as_flown[i].steps)
            .zip(&said[i].steps);
        for (((_, critical), (_, before)), (_, score)) in steps {
            if score.is_finite() {
                known += 1.0;
                change += (score - before).abs();
                near += f64::from((score - before).abs() <= 3.0);
            } else {
                unknown += 1.0;
            }
            predictions.push(Prediction {
                score: *score,
                critical: *critical,
                group: i as u32,
            });
        }
    }
    let areas = Ranking::new(predictions).areas();
    RiskComparison {
        auc: areas.map_or(f64::NAN, |a| a.roc),
        change: change / known,
        near: near / known,
        unknown: unknown / (known + unknown),
    }
}

/// Prints the time from the fault of each flight to the first warning.
fn faults(flights: &[SimulatedFlight], said: &[ProfileRun]) {
    println!(
        "faults: seconds from the fault to the warning, `-` where none came before the end of the judged time"
    );
    for (flight, said) in flights.iter().zip(said).filter(|(f, _)| f.kind == "fault") {
        let Some((fault_s, ..)) = flight.events.iter().find(|(_, event, _)| event == "fault")
        else {
            continue;
        };
        let warned = said
            .warnings
            .iter()
            .find(|w| w.to_s >= *fault_s && w.from_s <= flight.judged.to_s);
        let answer = warned.map_or("-".to_owned(), |w| format!("{:.1}", w.from_s - fault_s));
        let lost = flight.lost_s.map_or(String::new(), |t_s| {
            format!(", lost {:.1} s after it", t_s - fault_s)
        });
        let episodes = flight.errors.episodes().len();
        println!(
            "{} {:12} {answer:>6}, {episodes} episodes{lost}",
            flight.id, flight.vehicle
        );
        // There was a warning before every loss of control.
        assert!(flight.lost_s.is_none() || warned.is_some(), "{}", flight.id);
    }
}
