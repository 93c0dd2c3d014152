//! `flagred assess --html` and `--svg`: files that are complete, self-contained, and agree with the assessment of the
//! flight.

use std::{fmt::Write as _, fs, path::Path, process::Output};

use flagred_tests::{Folder, STEADY, flagred};
use serde_json::Value;

fn assess(logs: &[&str], more: &[&str]) -> Output {
    flagred()
        .arg("assess")
        .args(logs)
        .args(more)
        .output()
        .unwrap()
}

fn report(logs: &[&str], folder: &Folder) -> String {
    let file = folder.at("report.html");
    let output = assess(logs, &["--html", &file, "--fail-on", "never"]);
    assert!(
        output.stderr.is_empty(),
        "{}",
        String::from_utf8_lossy(&output.stderr)
    );
    fs::read_to_string(file).unwrap()
}

/// The points of the curve of a class, as the report's own script reads them.
fn curve(html: &str, class: &str) -> Vec<(f64, f64)> {
    let (_, rest) = html
        .split_once(&format!("<path class=\"line {class}\" d=\""))
        .unwrap();
    let (data, _) = rest.split_once('"').unwrap();
    data.replace("h0", "")
        .split(['M', 'L'])
        .filter(|point| !point.is_empty())
        .map(|point| {
            let (x, y) = point.split_once(' ').unwrap();
            (x.parse().unwrap(), y.parse().unwrap())
        })
        .collect()
}

#[test]
fn the_curves_have_the_values_of_the_json_document() {
    let folder = Folder::new();
    let html = report(&[STEADY], &folder);
    let document: Value = serde_json::from_slice(&assess(&[STEADY], &["--json"]).stdout).unwrap();
    for (class, name) in [
        ("risk", "risk"),
        ("elevated", "elevated_risk"),
        ("mean", "margin"),
    ] {
        let steps = document["steps"].as_array().unwrap();
        let known = steps.iter().filter_map(|step| step[name].as_f64());
        let (low, high) = known.fold((f64::MAX, f64::MIN), |(a, b), v| (a.min(v), b.max(v)));
        let drawn = curve(&html, class).into_iter().map(|(_, v)| v);
        let (least, most) = drawn.fold((f64::MAX, f64::MIN), |(a, b), v| (a.min(v), b.max(v)));
        assert!((least - low).abs() <= 0.051, "{name}: {least} is not {low}");
        assert!((most - high).abs() <= 0.051, "{name}: {most} is not {high}");
    }
    // The area behind the risk reaches from the lowest to the highest end of its intervals.
    let steps = document["steps"].as_array().unwrap();
    let ends = |name: &str| {
        let known = steps.iter().filter_map(|step| step[name].as_f64());
        known.fold((f64::MAX, f64::MIN), |(a, b), v| (a.min(v), b.max(v)))
    };
    let (_, band) = html.split_once("<path class=\"band risk\" d=\"").unwrap();
    let (band, _) = band.split_once('"').unwrap();
    let drawn = band
        .split(['M', 'L', 'Z'])
        .filter(|point| !point.is_empty());
    let drawn = drawn.map(|point| point.split_once(' ').unwrap().1.parse::<f64>().unwrap());
    let (least, most) = drawn.fold((f64::MAX, f64::MIN), |(a, b), v| (a.min(v), b.max(v)));
    assert!((least - ends("risk_low").0).abs() <= 0.051, "{least}");
    assert!((most - ends("risk_high").1).abs() <= 0.051, "{most}");
    assert!(html.contains("<span class=\"key filled risk\">interval of the risk</span>"));
    let start_s = document["steps"][0]["t_s"].as_f64().unwrap();
    assert!(html.contains("No threshold was reached"));
    assert!(
        html.contains("SERVO3_FUNCTION = 35"),
        "where motor 3 is known from"
    );
    assert!(
        html.contains("IF at_limit IS much THEN risk IS very_high"),
        "the rules in full"
    );
    assert!(
        html.contains("quiet_after_take_off_s: 3"),
        "the profile in full"
    );
    assert!((48.0..50.0).contains(&start_s));
}

#[test]
fn a_report_has_the_track_and_folded_signals() {
    let folder = Folder::new();
    let html = report(&[STEADY], &folder);
    let (_, points) = html.split_once("data-points=\"").unwrap();
    let (points, _) = points.split_once('"').unwrap();
    let points: Vec<Vec<f64>> = points
        .split(';')
        .map(|point| point.split(' ').map(|x| x.parse().unwrap()).collect())
        .collect();
    assert!((500..=1300).contains(&points.len()), "{}", points.len());
    assert_eq!(points[0][1..], [0.0, 0.0], "it starts at take-off");
    assert!(html.contains(">N</text>") && html.contains(" m</text>"));
    let flight = flagred_flightlog::open(STEADY, &Default::default()).unwrap();
    let signals = html.matches("<details class=\"signal\">").count();
    assert_eq!(signals, flight.signals().count());
    for unit in ["data-unit=\"V\"", "data-unit=\"°\"", "data-unit=\"m/s\""] {
        assert!(html.contains(unit), "no {unit}");
    }
    assert!(html.contains(">0:30</span>"), "minutes since take-off");
    assert!(html.len() < 600_000, "{} bytes", html.len());

    // A log without positions has no track, instead of a track at position 0.
    let log = folder.file("log.csv", long_log(20, 10));
    assert!(!report(&[&log], &folder).contains("<figure class=\"track\""));
}

/// The page contains nothing that makes a browser request another file.
#[test]
fn a_report_needs_no_network() {
    let folder = Folder::new();
    let html = report(&[STEADY], &folder);
    for word in [
        "http:", "https:", " src=", "<link", "@import", "fetch(", "url(//", "XMLHttp",
    ] {
        assert!(!html.contains(word), "`{word}` in the report");
    }
    assert!(html.contains("default-src 'none'"));
    assert_eq!(html.matches("<script>").count(), 1);
}

/// A flight CSV of an octocopter in gusts.
fn long_log(seconds: u32, hz: u32) -> String {
    let mut log = String::from(
        "## pwm_low_us: 1000\n## pwm_high_us: 2000\n\
         t_s,pwm1,pwm2,pwm3,pwm4,pwm5,pwm6,pwm7,pwm8,roll_des_deg,roll_deg,pitch_des_deg,pitch_deg,battery_v,in_air\n",
    );
    for i in 0..seconds * hz {
        let t_s = f64::from(i) / f64::from(hz);
        let gust = 1500.0 + 200.0 * (t_s * 0.7).sin() * (t_s * 2.9).sin();
        let _ = write!(log, "{t_s}");
        for motor in 0..8 {
            let _ = write!(
                log,
                ",{:.0}",
                gust + 20.0 * f64::from(motor) * (t_s * 0.31).cos()
            );
        }
        let _ = writeln!(
            log,
            ",0,{:.2},0,0,{:.2},1",
            gust / 500.0,
            16.8 - t_s / 600.0
        );
    }
    log
}

#[test]
fn ten_minutes_of_an_octocopter_stay_small() {
    let folder = Folder::new();
    let log = folder.file("log.csv", long_log(600, 25));
    let html = report(&[&log], &folder);
    assert!(html.len() < 1_500_000, "{} bytes", html.len());
    assert_eq!(html.matches("<figure class=\"panel small\"").count(), 8 + 6);
}

/// Text in a log must not become markup of the page that shows it.
#[test]
fn nothing_in_a_log_is_markup() {
    const SAID: &[u8] = b"EKF3 IMU0 MAG0 in-flight yaw alignment complete";
    const HOSTILE: &[u8] = b"</title></svg><script>alert(2)</script>\x01&amp;12";
    let folder = Folder::new();
    let mut bytes = fs::read(STEADY).unwrap();
    let place = bytes
        .windows(SAID.len())
        .position(|window| window == SAID)
        .unwrap();
    bytes[place..place + HOSTILE.len()].copy_from_slice(HOSTILE);
    let log = folder.file("<img src=x> & <script>.bin", bytes);
    let svg = folder.at("risk.svg");
    let html = report(&[&log], &folder);
    assert_eq!(html.matches("<script").count(), 1, "only ours");
    assert!(!html.contains("<img") && !html.contains("</title></svg>"));
    assert!(
        html.contains("&lt;script&gt;alert(2)&lt;/script&gt;"),
        "what the log says is shown"
    );

    assess(&[&log], &["--svg", &svg]);
    let text = fs::read_to_string(&svg).unwrap();
    let tree = roxmltree::Document::parse(&text).unwrap();
    let curves = tree
        .descendants()
        .filter(|node| node.attribute("class") == Some("line risk"));
    assert_eq!(curves.count(), 1);
    assert!(!tree.descendants().any(|node| node.has_tag_name("script")));
    let said = tree.descendants().filter(|node| node.has_tag_name("title"));
    assert!(
        said.filter_map(|node| node.text())
            .any(|text| text.contains("<script>alert(2)"))
    );
}

/// Returns the log of a flight that is calm for 40 s. Then pairs of motors alternate between values near the lower
/// limit and values near the upper limit for 4 s (WARN with the paper's rules) and, after 20 s of calm, between the
/// limits themselves (FAIL).
fn saturating_log() -> String {
    let mut log =
        String::from("## pwm_low_us: 1000\n## pwm_high_us: 2000\nt_s,pwm1,pwm2,pwm3,pwm4,in_air\n");
    for i in 0..2100 {
        let from_limit = match i {
            1000..1100 => 110,
            1600.. => 0,
            _ => 500,
        };
        let (high, low) = match i % 20 < 10 {
            true => (2000 - from_limit, 1000 + from_limit),
            false => (1000 + from_limit, 2000 - from_limit),
        };
        let t_s = f64::from(i) * 0.04;
        let _ = writeln!(log, "{t_s},{high},{low},{high},{low},1");
    }
    log
}

#[test]
fn the_most_severe_finding_is_on_top_and_scales_have_units() {
    let folder = Folder::new();
    let log = folder.file("log.csv", saturating_log());
    let html = report(&[&log, "--profile", "flagred-paper"], &folder);
    let risk = html.split("Risk over time").nth(1).unwrap();
    let warn = risk.find("<rect class=\"warn\"").unwrap();
    let fail = risk.find("<rect class=\"fail\"").unwrap();
    assert!(warn < fail, "what is drawn later is on top");
    for said in ["WARN from 67 %", "FAIL from 85 %", ">100 %<"] {
        assert!(risk.contains(said), "no `{said}`");
    }
    // Each cause has one line, with the motor at its limit.
    let reported = html.matches("2 times, worst ").count();
    assert_eq!(reported, 1);
    for said in [
        " away from a limit, where a motor cannot correct anything. Motor 1 was closest to its ",
        "<br>Land now and gently, ",
        "margin very_low: ",
        "; output pwm1, margin ",
    ] {
        assert!(html.contains(said), "no `{said}`");
    }
}

/// The table lists the rule that a finding names although this rule was never dominant.
#[test]
fn the_rules_of_findings_are_listed() {
    let folder = Folder::new();
    let log = folder.file("log.csv", saturating_log());
    folder.file(
        "rules.yaml",
        "fuzzy: 1\nname: two\ninputs: {margin: {range: [0, 0.5], partition: {low: 0.1, high: 0.3}}}\n\
         outputs: {risk: {range: [0, 100], terms: {none: {constant: 0}, some: {constant: 50}, all: {constant: 100}}, defuzzifier: weighted_average}}\n\
         rules: [IF margin IS any THEN risk IS some, IF margin IS low THEN risk IS all WITH 0.9, IF margin IS high THEN risk IS none]\n",
    );
    let profile = folder.file(
        "profile.yaml",
        "flagred: 1\nname: two\nrules: rules.yaml\ninputs: {margin: {mean: motor_margin}}\n",
    );
    let html = report(&[&log, "--profile", &profile], &folder);
    assert!(html.contains(", rule 2"), "the cause is rule 2");
    let table = html.split("<th>Rule</th>").nth(1).unwrap();
    let (table, after) = table.split_once("</table>").unwrap();
    assert!(
        table.contains("<td class=\"n\">2</td><td>IF margin IS low THEN"),
        "{table}"
    );
    assert!(table.contains("never "), "{table}");
    assert!(after.contains("The others in the table are rules that findings name."));
}

#[test]
fn motors_that_idle_in_the_air_are_reported_without_contradictions() {
    let folder = Folder::new();
    let mut log = String::from("t_s,motor1,motor2,motor3,motor4,in_air\n");
    for i in 0..3000 {
        let command = if i < 2000 { 0.5 } else { 0.0 };
        log += &format!("{:.2}", f64::from(i) * 0.02);
        log += &format!(",{command}").repeat(4);
        log += ",1\n";
    }
    let log = folder.file("log.csv", log);
    let output = assess(&[&log], &["-v"]);
    let reported = String::from_utf8_lossy(&output.stdout);
    for said in [
        "`risk` is unknown for 6 % of the time: the motors idled",
        "FAIL 43.0 to 60.0 s: The motors had idled for 3 s while the autopilot reported",
        "motors idle in the air, WARN at 43.2 s, FAIL at 43.3 s",
    ] {
        assert!(reported.contains(said), "no `{said}`: {reported}");
    }
    assert!(
        !reported.contains("on the ground") && !reported.contains("over 80 %"),
        "{reported}"
    );
}

#[test]
fn several_flights_are_compared_on_one_scale() {
    let folder = Folder::new();
    let log = folder.file("long.csv", long_log(200, 10));
    let html = report(&[STEADY, &log], &folder);
    assert!(html.contains("2 flights compared"));
    assert_eq!(html.matches("<section id=\"flight").count(), 2);
    let lengths: Vec<&str> = html
        .split("data-length=\"")
        .skip(1)
        .filter_map(|rest| rest.split('"').next())
        .collect();
    assert_eq!(lengths.len(), 2);
    assert_eq!(lengths[0], lengths[1]);
}

#[test]
fn a_report_that_cannot_be_written_fails_and_leaves_no_file() {
    let folder = Folder::new();
    let file = folder.at("missing/report.html");
    let output = assess(&[STEADY], &["--html", &file]);
    let message = String::from_utf8_lossy(&output.stderr);
    assert_eq!(output.status.code(), Some(2), "{message}");
    assert!(
        message.contains("report.html` cannot be written"),
        "{message}"
    );
    assert!(
        message.contains("help: check that its folder exists"),
        "{message}"
    );

    let kept = folder.at("kept.html");
    fs::create_dir(&kept).unwrap();
    let output = assess(&[STEADY], &["--html", &kept]);
    assert_eq!(output.status.code(), Some(2));
    let names: Vec<_> = fs::read_dir(folder.path())
        .unwrap()
        .map(|e| e.unwrap().file_name())
        .collect();
    assert_eq!(names, ["kept.html"], "no draft is left");

    let output = assess(&[STEADY, STEADY], &["--svg", "x.svg"]);
    assert_eq!(output.status.code(), Some(2));
}

/// The report of a log without a verdict shows the contents that were read, and the reason.
#[test]
fn a_flight_without_a_verdict_is_reported_as_such() {
    let folder = Folder::new();
    let log = folder.at("ground.csv");
    let text = long_log(20, 10).replace(",1\n", ",0\n");
    fs::write(&log, text).unwrap();
    let html = report(&[&log], &folder);
    assert!(html.contains("<span class=\"badge na\">NA</span>"));
    assert!(html.contains("No verdict: "));
    let svg = folder.at("risk.svg");
    let output = assess(&[&log], &["--svg", &svg]);
    assert_eq!(output.status.code(), Some(3));
    assert!(!Path::new(&svg).exists());
}
