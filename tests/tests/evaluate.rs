//! `flagred validate` from a user's point of view, and scores of the shipped rules on the simulated flights.

use std::{fmt::Write as _, fs, process::Output};

use flagred_tests::{Folder, flagred, reference_data};
use serde_json::Value;

/// A minute of flight at 25 Hz: from 30 to 40 s the motors oscillate with growing amplitude, from 34 to 40 s the attitude is
/// wrong.
fn flight(kind: &str, in_trouble: bool) -> String {
    let mut text = format!(
        "# vehicle: {kind} quad\n# kind: {kind}\n# pwm_low_us: 1000\n# pwm_high_us: 2000\n\
         # judged_from_s: 10\n# judged_to_s: 55\n\
         t_s,pwm1,pwm2,pwm3,pwm4,roll_des_deg,roll_deg,pitch_des_deg,pitch_deg,in_air\n"
    );
    for i in 0..1500 {
        let t_s = f64::from(i) / 25.0;
        let swing = if in_trouble && (30.0..40.0).contains(&t_s) {
            300.0 * (t_s * 5.0).sin().powi(2) * ((t_s - 30.0) / 4.0).min(1.0)
        } else {
            4.0 * (t_s * 7.0).sin()
        };
        let off = if in_trouble && (34.0..40.0).contains(&t_s) {
            12.0
        } else {
            0.1
        };
        let (up, down) = (1550.0 + swing, 1550.0 - swing);
        writeln!(
            text,
            "{t_s},{up:.0},{down:.0},{up:.0},{down:.0},0,{off},0,0,1"
        )
        .unwrap();
    }
    text
}

fn evaluate(arguments: &[&str]) -> Output {
    let mut command = flagred();
    command.arg("validate").args(arguments).output().unwrap()
}

fn json(output: &Output) -> Value {
    let said = String::from_utf8_lossy(&output.stderr);
    serde_json::from_slice(&output.stdout).unwrap_or_else(|error| panic!("{error}: {said}"))
}

fn estimator<'a>(document: &'a Value, name: &str) -> &'a Value {
    let all = document["estimators"].as_array().unwrap();
    all.iter().find(|e| e["name"] == name).unwrap()
}

#[test]
fn flights_are_compared_step_by_step_and_episode_by_episode() {
    let folder = Folder::new();
    folder.file("a-calm.csv", flight("calm", false));
    folder.file("b-gusts.csv", flight("gusts", true));
    folder.file("c-manoeuvre.csv", flight("manoeuvre", true));
    // A folder may contain files other than flights.
    folder.file("README.md", "Not a flight.\n");
    let output = evaluate(&["--json", folder.path().to_str().unwrap()]);
    assert_eq!(output.status.code(), Some(0));
    let document = json(&output);
    let names: Vec<&Value> = document["estimators"]
        .as_array()
        .unwrap()
        .iter()
        .map(|e| &e["name"])
        .collect();
    assert_eq!(
        names,
        [
            "flagred",
            "flagred-paper",
            "margin_mean",
            "lowest_motor",
            "spread",
            "saturated_share",
            "motor_activity",
            "least_margin",
            "full_share",
            "ekf_wind",
            "true_wind"
        ]
    );
    // Each of two flights has 45 s in steps of half a second, including both ends. The manoeuvre is separate.
    assert_eq!(document["steps"], 2 * 91);
    assert_eq!(
        (&document["flights"], &document["left_out"]),
        (&2.into(), &1.into())
    );
    // The error over a second exceeds the limit from 34.2 to 40.8 s, so from 29.5 s on a step has a critical error
    // within 5 s.
    let flagred = estimator(&document, "flagred");
    assert_eq!(flagred["critical"], 23);
    assert!(flagred["auc"].as_f64().unwrap() > 0.9, "{flagred}");
    assert!(flagred["pr_auc"].as_f64().unwrap() > 0.7, "{flagred}");
    let unknown = estimator(&document, "ekf_wind");
    assert_eq!(
        (&unknown["auc"], &unknown["unknown"]),
        (&Value::Null, &182.into())
    );
    assert_eq!(unknown["reliability"], Value::Null);
    let cases = flagred["reliability"].as_array().unwrap().iter();
    assert_eq!(
        cases.map(|b| b["cases"].as_u64().unwrap()).sum::<u64>(),
        182
    );

    let warnings = &flagred["warnings"];
    assert_eq!(
        (
            &warnings["episodes"],
            &warnings["announced"],
            &warnings["false_warnings"]
        ),
        (&1.into(), &1.into(), &0.into())
    );
    let lead_s = warnings["lead_s_median"].as_f64().unwrap();
    assert!((0.3..4.2).contains(&lead_s), "{lead_s}");
    let kinds: Vec<&Value> = warnings["by_kind"]
        .as_array()
        .unwrap()
        .iter()
        .map(|k| &k["kind"])
        .collect();
    assert_eq!(kinds, ["calm", "gusts", "manoeuvre"]);
    let episode = &document["records"][1]["profiles"]["flagred"]["episodes"][0];
    assert!(
        (episode["from_s"].as_f64().unwrap() - 34.2).abs() < 0.1,
        "{episode}"
    );
}

/// A minute in the air at 25 Hz without assessed times in its header; from `upset_s` on the vehicle rolls over.
fn real_flight(vehicle: &str, upset_s: Option<f64>) -> String {
    let mut text = format!(
        "# vehicle_id: {vehicle}\n# pwm_low_us: 1000\n# pwm_high_us: 2000\n\
         t_s,pwm1,pwm2,pwm3,pwm4,roll_des_deg,roll_deg,pitch_des_deg,pitch_deg,in_air\n"
    );
    for i in 0..1600 {
        let t_s = f64::from(i) / 25.0;
        let in_air = (1.0..=61.0).contains(&t_s);
        let since_s = upset_s.map_or(-1.0, |upset_s| t_s - upset_s);
        let (high, low) = if since_s > -4.0 && upset_s.is_some() {
            (2000, 1000)
        } else {
            (1552, 1548)
        };
        let roll_deg = if in_air {
            (since_s * 100.0).clamp(0.1, 170.0)
        } else {
            0.0
        };
        writeln!(
            text,
            "{t_s},{high},{low},{high},{low},0,{roll_deg},0,0,{}",
            u8::from(in_air)
        )
        .unwrap();
    }
    text
}

#[test]
fn false_alarms_and_alarms_before_upsets_are_counted() {
    let folder = Folder::new();
    fs::create_dir_all(folder.path().join("flights/deep")).unwrap();
    folder.file("flights/a.csv", real_flight("board 1", None));
    folder.file("flights/b.csv", real_flight("board 1", None));
    folder.file("flights/deep/c.csv", real_flight("board 2", Some(40.0)));
    let path = folder.at("flights");
    let document = json(&evaluate(&["--json", &path]));
    let flagred = estimator(&document, "flagred");
    let alarms = &flagred["alarms"];
    let ordinary = &alarms["ordinary_flights"];
    assert_eq!(ordinary["flights"], 2, "{ordinary}");
    assert_eq!(ordinary["verdicts"]["GOOD"], 2);
    assert_eq!(
        (&ordinary["alarms"], &ordinary["fails"]),
        (&0.into(), &0.into())
    );
    assert_eq!(
        ordinary["alarms_per_hour_interval"],
        serde_json::json!([0.0, 0.0])
    );
    assert_eq!(ordinary["share_of_time_on"], 0.0);
    assert!((ordinary["hours"].as_f64().unwrap() - 120.0 / 3600.0).abs() < 1e-4);
    // A calm stretch lasts from 5 s after take-off to the landing, or to 10 s before the error.
    let calm = &alarms["calm_stretches"];
    assert_eq!((&calm["flights"], &calm["alarms"]), (&3.into(), &0.into()));
    let calm_s = calm["hours"].as_f64().unwrap() * 3600.0;
    assert!((134.0..136.0).contains(&calm_s), "{calm_s}");
    // The motors are at their limits for 4 s before the roll exceeds 60 degrees, at 40.6 s.
    let upsets = &alarms["upsets"];
    assert_eq!(
        (&upsets["before"], &upsets["within_1_s"], &upsets["never"]),
        (&1.into(), &0.into(), &0.into())
    );
    let upset_s = document["records"][2]["upsets_s"][0].as_f64().unwrap();
    assert!((40.5..40.7).contains(&upset_s), "{upset_s}");
    let lead_s = upsets["lead_s_median"].as_f64().unwrap();
    assert!((2.0..4.6).contains(&lead_s), "{lead_s}");

    // Steps from 2 s after take-off to 1 s before landing, or to the upset.
    assert_eq!(document["steps"], 2 * 115 + 76);
    // The error over a second exceeds 5 degrees soon after 40 s, so from about 35.2 s on a step has a critical error
    // within 5 s.
    let critical = flagred["critical"].as_u64().unwrap();
    assert!((10..=12).contains(&critical), "{critical}");
    assert_eq!(flagred["within_flight_flights"], 1);
    assert!(
        flagred["within_flight_auc"].as_f64().unwrap() > 0.8,
        "{flagred}"
    );
    let (quiet, onset) = (&flagred["quiet"], &flagred["onset"]);
    assert_eq!(quiet["critical"], onset["critical"]);
    assert!(quiet["auc"].as_f64().unwrap() > 0.8, "{quiet}");

    let text = evaluate(&[&path]);
    let text = String::from_utf8_lossy(&text.stdout);
    assert!(text.starts_with("3 flights of 2 vehicles"), "{text}");
    assert!(
        text.contains("upsets: 1; alarm before 1 (median lead"),
        "{text}"
    );
    let row = text
        .lines()
        .find(|line| line.starts_with("  board 1"))
        .unwrap();
    assert!(row.ends_with("no critical step"), "{row}");
}

#[test]
fn a_step_is_quiet_until_the_error_is_critical() {
    let folder = Folder::new();
    folder.file("gusts.csv", flight("gusts", true));
    let document = json(&evaluate(&["--json", folder.path().to_str().unwrap()]));
    let flagred = estimator(&document, "flagred");
    // The error is critical from 34.2 to 40.8 s. Steps are quiet up to 34 s and from 46 s on (5 s without a critical
    // error), and onset steps up to 34 s and from 51 s on (10 s without one).
    let steps = |part: &Value| part["cases"].as_u64().unwrap() + part["unknown"].as_u64().unwrap();
    assert_eq!(steps(&flagred["quiet"]), 49 + 19);
    assert_eq!(steps(&flagred["onset"]), 49 + 9);
    assert_eq!(flagred["quiet"]["critical"], 10);
}

#[test]
fn without_a_critical_step_there_is_no_area() {
    let folder = Folder::new();
    folder.file("calm.csv", flight("calm", false));
    folder.file("README.md", "Not a flight.\n");
    let path = folder.path().to_str().unwrap();
    let output = evaluate(&[path]);
    assert_eq!(output.status.code(), Some(0));
    let text = String::from_utf8_lossy(&output.stdout);
    let row = text
        .lines()
        .find(|line| line.starts_with("spread"))
        .unwrap();
    assert_eq!(row.matches("no critical step").count(), 3, "{row}");
    assert!(
        text.contains("1 file left out:\n     1  ") && text.contains("not a flight log"),
        "{text}"
    );
    let document = json(&evaluate(&["--json", path]));
    let spread = estimator(&document, "spread");
    assert_eq!(
        (&spread["auc"], &spread["no_auc"]),
        (&Value::Null, &"no critical step".into())
    );
    let left_out = &document["left_out_files"][0];
    assert!(left_out["file"].as_str().unwrap().ends_with("README.md"));
    assert!(
        !left_out["reason"].as_str().unwrap().contains("README.md"),
        "{left_out}"
    );
}

#[test]
fn a_file_that_is_not_a_flight_does_not_stop_the_others() {
    let folder = Folder::new();
    let good = folder.file("good.csv", flight("gusts", true));
    let bad = folder.file("notes.txt", "took off at noon\n");
    let picture = folder.at("curves.svg");
    let output = evaluate(&[&bad, &good, "--svg", &picture]);
    assert_eq!(output.status.code(), Some(3));
    let said = String::from_utf8_lossy(&output.stderr);
    assert!(
        said.contains("notes.txt") && said.contains("help:"),
        "{said}"
    );
    let text = String::from_utf8_lossy(&output.stdout);
    assert!(
        text.starts_with("1 flight of 1 vehicle, 0.02 h in the air, 91 steps"),
        "{text}"
    );
    assert!(
        text.contains("warnings of flagred") && text.contains("reliability of"),
        "{text}"
    );
    assert!(
        fs::read_to_string(&picture)
            .unwrap()
            .contains("true_wind unknown")
    );

    let nothing = evaluate(&[&bad]);
    assert_eq!(nothing.status.code(), Some(3));
    assert!(nothing.stdout.is_empty());
}

#[test]
fn whole_flights_are_evaluated_from_a_table() {
    let folder = Folder::new();
    let table = folder.file(
        "rows.csv",
        "frame,c_limit_low,c_limit_high,margin_mean,margin_min_mean,c_mean,c_std,c_std_time,c_std_motors,sat_lim_frac,wind_mean,att_rmse_deg,crashed\n\
         a,0,1,0.4,0.39,0.6,0.011,0.01,0.003,0,3,0.2,0\n\
         a,0,1,0.35,0.3,0.65,0.075,0.02,0.07,0.02,9,3.1,0\n\
         b,0,1,0.2,0.1,0.8,0.16,0.04,0.12,0.1,12,6.2,0\n\
         b,0,1,0.1,0.02,0.9,0.2,0.05,0.14,0.2,7,4.0,1\n",
    );
    let output = evaluate(&["--json", "--rows", &table]);
    let document = json(&output);
    assert_eq!(document["cases"], "flights");
    for (name, auc) in [("lowest_motor", 1.0), ("true_wind", 0.75)] {
        let estimator = estimator(&document, name);
        assert_eq!(estimator["critical"], 2, "{name}");
        assert_eq!(estimator["auc"], auc, "{name}");
    }
    // A table of whole flights contains neither noise nor yaw.
    assert_eq!(estimator(&document, "flagred")["auc"], Value::Null);
    assert_eq!(estimator(&document, "flagred")["warnings"], Value::Null);

    let bad = folder.file("bad.csv", "c_mean,att_rmse_deg\nhalf,1\n");
    let output = evaluate(&["--rows", &bad]);
    let said = String::from_utf8_lossy(&output.stderr);
    // The table contains only the load, and no profile reads only the load.
    assert!(
        said.contains("has no column for its input `unsteady_now`"),
        "{said}"
    );
    let output = evaluate(&["--rows", &bad, &bad]);
    assert_eq!(output.status.code(), Some(2));
}

/// The documented scores of the shipped rules, on the flights they were learned from; `leave_vehicles_out.rs` has the
/// scores on held-out vehicles.
#[test]
#[ignore = "needs FLAGRED_SHARED"]
fn the_shipped_rules_on_the_simulated_flights() {
    let data = reference_data();
    let rows = json(&evaluate(&[
        "--json",
        "--rows",
        data.join("sitl/runs.csv").to_str().unwrap(),
    ]));
    let series = json(&evaluate(&[
        "--json",
        data.join("sitl2/timeseries").to_str().unwrap(),
    ]));
    assert_eq!(series["steps"], 44_369);
    // The table of whole flights lacks inputs of the default rules.
    assert!(estimator(&rows, "flagred")["auc"].is_null());
    for (document, least) in [(&series, 0.89)] {
        let flagred = estimator(document, "flagred")["auc"].as_f64().unwrap();
        assert!(flagred >= least, "{flagred}");
        for other in document["estimators"].as_array().unwrap() {
            if let Some(auc) = other["auc"].as_f64().filter(|_| other["name"] != "flagred") {
                assert!(auc < flagred, "{other}");
            }
        }
    }
    // Python gives the same values (roc_auc_score over the same steps and rows).
    for (document, name, auc) in [
        (&series, "true_wind", 0.801),
        (&series, "ekf_wind", 0.791),
        (&series, "lowest_motor", 0.780),
        (&series, "spread", 0.852),
        (&series, "saturated_share", 0.727),
        (&series, "flagred-paper", 0.694),
        (&rows, "true_wind", 0.802),
        (&rows, "saturated_share", 0.941),
    ] {
        let found = estimator(document, name)["auc"].as_f64().unwrap();
        assert!((found - auc).abs() < 0.0015, "{name}: {found} not {auc}");
    }
    let warnings = &estimator(&series, "flagred")["warnings"];
    let of = |kind: &str| {
        let kinds = warnings["by_kind"].as_array().unwrap();
        kinds.iter().find(|k| k["kind"] == kind).unwrap()
    };
    assert_eq!(warnings["episodes"], 268);
    assert!(
        warnings["false_per_hour"].as_f64().unwrap() <= 6.0,
        "{warnings}"
    );
    assert_eq!(of("calm")["warnings"], 0);
    assert!(of("rising")["announced_share"].as_f64().unwrap() >= 0.85);
    assert!(of("rising")["lead_s_median"].as_f64().unwrap() > 5.0);
}

/// An independent program in Python computes the areas of three baselines on the same real flights, from steps that are
/// 0.25 s apart (docs/validation.md lists the differences of its definitions).
#[test]
#[ignore = "needs FLAGRED_SHARED"]
fn the_baselines_on_the_real_flights() {
    let folder = reference_data().join("real/flights");
    let document = json(&evaluate(&["--json", folder.to_str().unwrap()]));
    assert_eq!(
        (&document["flights"], &document["left_out"]),
        (&53.into(), &0.into())
    );
    for (name, auc, quiet_auc, within) in [
        ("motor_activity", 0.793, 0.603, 0.649),
        ("least_margin", 0.489, 0.471, 0.531),
        ("full_share", 0.528, 0.512, 0.523),
    ] {
        let of = estimator(&document, name);
        for (found, expected) in [
            (&of["auc"], auc),
            (&of["quiet"]["auc"], quiet_auc),
            (&of["within_flight_auc"], within),
        ] {
            let found = found.as_f64().unwrap();
            assert!(
                (found - expected).abs() < 0.01,
                "{name}: {found} not {expected}"
            );
        }
        assert_eq!(of["within_flight_flights"], 36, "{name}");
    }
    let alarms = &estimator(&document, "flagred")["alarms"];
    let flights =
        |of: &Value| of["flights"].as_u64().unwrap() + of["not_assessed"].as_u64().unwrap();
    assert_eq!(flights(&alarms["ordinary_flights"]), 15);
    let calm_hours = alarms["calm_stretches"]["hours"].as_f64().unwrap();
    assert!((calm_hours - 0.61).abs() < 0.01, "{calm_hours}");
    // A sixth upset, an attitude failure, appears only in a message of its log.
    let upsets: usize = document["records"]
        .as_array()
        .unwrap()
        .iter()
        .map(|record| record["upsets_s"].as_array().unwrap().len())
        .sum();
    assert_eq!(upsets, 5);
}
