//! Mistakes of newcomers, and of people who know other programs, each with the advice for it.
#![allow(clippy::unwrap_used, reason = "tests")]

#[path = "../common/mod.rs"]
mod common;

mod commands;
mod explained;
mod flights;
mod learning;
mod rule_sets;
mod tables;

use common::{flagred, folder};

const FAN: &str = "fuzzy: 1
name: fan
inputs:
  temperature: {range: [0, 40], partition: {cold: 10, mild: 20, hot: 30}}
  humidity: {range: [0, 100], partition: [dry, wet]}
outputs:
  fan: {range: [0, 100], terms: {slow: {constant: 0}, fast: {constant: 100}}, defuzzifier: weighted_average}
rules:
  - IF temperature IS NOT hot THEN fan IS slow
  - IF temperature IS hot AND humidity IS wet THEN fan IS fast
";

/// Creates a folder with the files that the mistaken command lines use.
fn files() -> tempfile::TempDir {
    let folder = folder(&[
        ("fan.yaml", FAN),
        ("profile.yaml", "flagred: 1\nname: mine\n"),
        (
            "rows.csv",
            "temperature,humidity,fan\n20,50,0\n40,100,100\n35,90,100\n",
        ),
        ("header.csv", "temperature,humidity,fan\n"),
        ("numbers.csv", "24,70\n1,2\n"),
        ("semicolons.csv", "t_s;motor1\n0,5;0,5\n"),
        ("words.csv", "heat,kind\n1,good\n2,bad\n"),
        (
            "comments.csv",
            "# made by hand\n\ntemperature,humidity\n20,50\n#N/A,50\n#1,50\n",
        ),
        (
            "units.csv",
            "temperature,humidity,fan\n20,50,5 %\n30,50,6 %\n",
        ),
        ("cells.csv", "temperature,humidity,fan\n20,5,50,0\n"),
        (
            "semicolon_cells.csv",
            "temperature;humidity;fan\n20,5;50;0\n",
        ),
        ("capitals.csv", "Temperature,humidity,fan\n20,50,0\n"),
        ("excel.csv", "sep=;\ntemperature;humidity;fan\n"),
        (
            "outside.csv",
            "temperature,humidity,fan\n20,50,0\n99,50,0\n",
        ),
        (
            "plane.csv",
            "# vehicle_kind: fixed wing\nt_s,motor1,motor2,motor3,motor4\n0,0.5,0.5,0.5,0.5\n",
        ),
        (
            "from_0.csv",
            "t_s,motor0,motor1,motor2,motor3\n0,0.5,0.5,0.5,0.5\n",
        ),
        ("fan_only.csv", "temperature,humidity,fans\n20,50,0\n"),
        (
            "german.csv",
            "temperature;humidity;fan\n20;50;0,0\n25;60;9,5\n30;70;30,5\n",
        ),
        (
            "places.csv",
            "temperature,humidity,fan,vehicle\n20,50,0,a\n25,50,50,b\n30,70,70,b\n",
        ),
        (
            "shares.csv",
            "temperature,humidity,fan\n20,0.5,0\n25,0.6,50\n30,0.9,70\n40,1,100\n",
        ),
        (
            "minus.csv",
            "temperature,humidity\n\u{2212}12,5\n20,\"1.234,5\"\n20,50\n# end\n",
        ),
        (
            "many.csv",
            "temperature,humidity,fan\n20,50,0\n20,50,x\n20,50,y\n20,50,z\n20,50,u\n20,50,v\n20,,1\n",
        ),
        ("bare.csv", "pwm_low_us: 1000\nt_s,pwm1\n0,1500\n"),
        (
            "min.csv",
            "# pwm_min_us: 1000\n# pwm_high_us: 2000\nt_s,pwm1\n0,1500\n",
        ),
        (
            "hexa.csv",
            "# frame: HEXA/X\nt_s,pwm1,pwm2,pwm3,pwm4\n0,1500,1500,1500,1500\n",
        ),
        ("copter.param", "MOT_PWM_MIN,1000\nMOT_PWM_MAX,2000\n"),
        ("log.mat", "MATLAB 5.0 MAT-file"),
        ("constant.csv", "temperature,fan\n20,5\n30,5\n35,5\n"),
        (
            "fahrenheit.csv",
            "temperature,humidity,fan\n68,50,0\n99,50,0\n30,50,0\n",
        ),
        (
            "flight.csv",
            "t_s,pwm1,pwm2,pwm3,pwm4\n0,1500,1500,1500,1500\n",
        ),
        ("time.csv", "time,pwm1\n0,1500\n0.1,1500\n"),
        ("t_ms.csv", "t_ms,pwm1\n0,1500\n100,1500\n"),
        ("no_rows.csv", "t_s,pwm1,pwm2,pwm3,pwm4\n"),
        ("tabs.csv", "t_s\tmotor1\n0.5\t0.5\n"),
        ("clock.csv", "t_s,motor1\n12:00:01,0.5\n"),
        (
            "microseconds.csv",
            "t_s,motor1\n0,0.5\n4000,0.5\n8000,0.5\n12000,0.5\n16000,0.5\n20000,0.5\n",
        ),
        ("backwards.csv", "t_s,motor1\n4,0.5\n3,0.5\n2,0.5\n1,0.5\n"),
        ("no_header.csv", "0,1500,1500\n1,1500,1500\n"),
        ("capital_motors.csv", "t_s,Motor_1\n0,0.5\n"),
        ("percent.csv", "t_s,motor1\n0,15%\n0.1,15%\n"),
        ("equals.csv", "# pwm_low_us = 1000\nt_s,pwm1\n0,1500\n"),
        ("rows.json", "[{\"temperature\": 20}]\n"),
        (
            "excel.xlsx",
            "PK\u{3}\u{4}[Content_Types].xml xl/workbook.xml",
        ),
        ("notes.md", "# Notes\n\n**Bold** text\n"),
        ("empty.csv", ""),
        ("script.fis", "fis = mamfis('Name', 'fan');\n"),
        (
            "fan.fll",
            "Engine: fan\nInputVariable: a\n  range: 0 10,5\n",
        ),
        ("fan.m", "fis = mamfis('Name', 'fan');\n"),
        ("fan.py", "import skfuzzy\n"),
        (
            "unknown.csv",
            "temperature,humidity\n20,null\n20,-\n20,N/A\n",
        ),
        (
            "open_quote.csv",
            "temperature,humidity\n5,20\n\"12,20\n4,3\n",
        ),
        ("transposed.csv", "temperature,5,24\nhumidity,20,70\n"),
        ("no_break.csv", "temperature,humidity\n5\u{a0},20\n"),
        ("cities.csv", "city,fan\nRome,5\nOslo,6\nBern,7\n"),
        ("report.pdf", "%PDF-1.7\n"),
        (
            "flight.bbl",
            "H Product:Blackbox flight data recorder by Nicholas Sherlock\nH Data version:2\n",
        ),
        ("vehicle.csv", "vehicle: x\nt_s,motor1\n0,0.5\n"),
        ("one_row.csv", "t_s,motor1,motor2,motor3\n0,0.5,0.5,0.5\n"),
        (
            "unsigned.yaml",
            "name: x\nrules: flagred-paper\ninputs:\n  margin: {mean: motor_margin}\n",
        ),
        (
            "commas.csv",
            "t_s,motor1,motor2,motor3\n0,00,0,5,0,5,0,5\n0,05,0,5,0,5,0,5\n",
        ),
    ]);
    let (_, fis, _) = flagred(folder.path(), &["export", "--fis", "fan.yaml"]);
    std::fs::write(folder.path().join("fan.fis"), fis).unwrap();
    folder
}

/// Asserts the exit code of each command line, and that its output contains the expected text.
fn assert_advice(folder: &tempfile::TempDir, mistakes: &[(&str, i32, &str)]) {
    let mut wrong = Vec::new();
    for &(typed, code, expected) in mistakes {
        let words: Vec<&str> = typed.split(' ').collect();
        let (exit, out, errors) = flagred(folder.path(), &words);
        if exit != Some(code) || !(out + &errors).contains(expected) {
            wrong.push(format!("{typed}: exit {exit:?}, {errors}"));
        }
    }
    assert!(wrong.is_empty(), "{}", wrong.join("\n"));
}
