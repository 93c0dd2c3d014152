//! ArduPilot's frames, as text that the script parses once.

use std::collections::BTreeMap;

use flagred_flightlog::{Frame, ardupilot_frames};

/// Returns a line for each frame, such as `1/1 QUAD/X 1: -1 1 1 2: 1 -1 1 ...`: class and type, name, and the number, roll,
/// pitch and yaw of each motor.
pub(super) fn lines() -> Vec<String> {
    ardupilot_frames().map(|frame| line(&frame)).collect()
}

/// Returns `local MOTORS_OF = {[1] = 4, [2] = 6, ...}`: the number of motors of each class.
pub(super) fn motors_of_class() -> String {
    let classes: BTreeMap<i64, usize> = ardupilot_frames()
        .map(|frame| (frame.class, frame.motors.len()))
        .collect();
    let entries: Vec<String> = classes
        .iter()
        .map(|(class, motors)| format!("[{class}] = {motors}"))
        .collect();
    format!("  local MOTORS_OF = {{{}}}", entries.join(", "))
}

fn line(frame: &Frame) -> String {
    let motors: Vec<String> = frame
        .motors
        .iter()
        .map(|(number, [roll, pitch, yaw])| {
            format!(
                "{number}: {} {} {}",
                short(*roll),
                short(*pitch),
                short(*yaw)
            )
        })
        .collect();
    let Frame {
        class, kind, name, ..
    } = frame;
    format!("{class}/{kind} {name} {}", motors.join(" "))
}

fn short(factor: f64) -> String {
    // Adding 0 removes the sign of -0.
    ((factor + 0.0) as f32).to_string()
}
