//! How soon the shipped rules report a fault or an upset: the simulated flights of `sitl3` by kind of fault.
//!
//! `FLAGRED_SHARED=... cargo test -p flagred-tests --test faults -- --ignored --nocapture` prints the table.

use std::collections::BTreeMap;

use flagred_tests::{flagred, reference_data, simulated::on_all_cores};
use serde_json::Value;

/// A flight, its fault, and the time at which its error first exceeded 5 degrees after the fault.
struct Flight {
    id: String,
    what: String,
    over_s: Option<f64>,
}

/// The results of the flights with one kind of fault.
#[derive(Default)]
struct FaultResults {
    in_time: usize,
    late: Vec<String>,
    small: usize,
    alarms_of_small: usize,
}

#[test]
#[ignore = "needs FLAGRED_SHARED"]
fn faults_and_upsets_are_reported_within_a_second() {
    let data = reference_data().join("sitl3");
    let rows = |name: &str| {
        let mut table = csv::Reader::from_path(data.join(name)).unwrap();
        let rows = table.deserialize::<BTreeMap<String, String>>();
        rows.map(Result::unwrap).collect::<Vec<_>>()
    };
    let mut faults: BTreeMap<String, f64> = BTreeMap::new();
    for event in rows("events.csv") {
        if event["event"] == "fault" {
            let t_s = event["t_s"].parse().unwrap();
            faults.entry(event["flight_id"].clone()).or_insert(t_s);
        }
    }
    let flights: Vec<Flight> = rows("index.csv")
        .into_iter()
        .filter(|row| matches!(row["kind"].as_str(), "fault" | "upset"))
        .map(|row| {
            let fault_s = faults.get(&row["id"]).copied().unwrap_or(0.0);
            let starts = row["over5_list"].split([' ', ';']);
            let starts = starts.filter_map(|span| span.split('-').next()?.parse().ok());
            let first_s = row["first_over5_s"].parse().ok();
            let crash_s = row["crash_time_s"].parse().ok();
            let after = starts.chain(first_s).chain(crash_s);
            Flight {
                id: row["id"].clone(),
                what: row["subkind"].clone(),
                over_s: after.filter(|t_s| *t_s >= fault_s).reduce(f64::min),
            }
        })
        .collect();
    assert!(flights.len() > 50);

    let alarms = on_all_cores(&flights, |flight| {
        let path = data.join(format!("timeseries/{}.csv.gz", flight.id));
        let mut assess = flagred();
        assess.arg("assess").arg(path);
        let output = assess
            .args(["--json", "--fail-on", "never"])
            .output()
            .unwrap();
        let document: Value = serde_json::from_slice(&output.stdout).unwrap();
        let findings = document["findings"].as_array().unwrap();
        let alarms = findings.iter().filter(|f| f["severity"] != "INFO");
        let seconds = |value: &Value| value.as_f64().unwrap();
        alarms
            .map(|f| (seconds(&f["raised_s"]), seconds(&f["to_s"])))
            .collect::<Vec<(f64, f64)>>()
    });

    let mut table: BTreeMap<&str, FaultResults> = BTreeMap::new();
    for (flight, alarms) in flights.iter().zip(&alarms) {
        let reported = table.entry(&flight.what).or_default();
        let Some(over_s) = flight.over_s else {
            reported.small += 1;
            reported.alarms_of_small += usize::from(!alarms.is_empty());
            continue;
        };
        let is_reported =
            |(raised_s, to_s): &(f64, f64)| *raised_s <= over_s + 1.0 && *to_s >= over_s - 10.0;
        match alarms.iter().any(is_reported) {
            true => reported.in_time += 1,
            false => {
                let raised_s = alarms.iter().map(|(raised_s, _)| *raised_s);
                let after = raised_s.filter(|raised_s| *raised_s > over_s);
                let delay = after.map(|raised_s| raised_s - over_s).reduce(f64::min);
                reported.late.push(match delay {
                    Some(delay_s) => format!("{} after {delay_s:.1} s", flight.id),
                    None => format!("{} never", flight.id),
                });
            }
        }
    }
    println!(
        "what, told within 1 s, told later or never; flights without an error over 5 degrees, with an alarm"
    );
    for (what, reported) in &table {
        println!(
            "{what:14} {:3} {:?}; {:3} {:3}",
            reported.in_time, reported.late, reported.small, reported.alarms_of_small
        );
    }
    let share = |what: &[&str]| {
        let of = || what.iter().map(|what| &table[what]);
        let in_time: usize = of().map(|reported| reported.in_time).sum();
        let late: usize = of().map(|reported| reported.late.len()).sum();
        in_time as f64 / (in_time + late) as f64
    };
    // Bumps are not included, because a bump is over before it appears in a window of two seconds.
    let faults = [
        "dead_motor",
        "motor_partial",
        "motor_total",
        "weak_motor",
        "wrong_order",
    ];
    assert!(share(&faults) >= 0.9, "{}", share(&faults));
    assert_eq!(share(&["motor_total", "dead_motor"]), 1.0);
}
