//! The answers of a vehicle to requests.

use std::time::Duration;

use flagred_flightlog::{
    Flight,
    mavlink::dialect::{COMMAND_ACK_DATA, MavCmd, MavMessage, MavResult},
};

use super::{StandIn, messages::parameter, output};

/// The message number of SERVO_OUTPUT_RAW.
const SERVO_OUTPUT_RAW: f32 = 36.0;

impl StandIn {
    pub(super) fn answer(&mut self, message: &MavMessage) {
        if !self.answers {
            self.requested = true;
            return;
        }
        match message {
            MavMessage::PARAM_REQUEST_READ(request) => {
                self.requested = true;
                let name = request.param_id.to_str().unwrap();
                let known = self.parameters.iter().find(|(known, _)| known == name);
                if let Some((name, value)) = known {
                    let reply = parameter(name, *value);
                    self.send_outside_flight(&reply);
                }
            }
            MavMessage::COMMAND_LONG(command) => {
                if command.param1 == SERVO_OUTPUT_RAW && self.obeys {
                    self.every = Duration::from_secs_f64(f64::from(command.param2) * 1e-6);
                }
                self.send_outside_flight(&MavMessage::COMMAND_ACK(COMMAND_ACK_DATA {
                    command: MavCmd::MAV_CMD_SET_MESSAGE_INTERVAL,
                    result: MavResult::MAV_RESULT_ACCEPTED,
                    ..COMMAND_ACK_DATA::default()
                }));
            }
            _ => {}
        }
    }

    /// Moves the motors of the vehicle to consecutive outputs from `first_output` on (counted from 1).
    pub fn remap(&mut self, first_output: usize) {
        self.shift = first_output - 1;
        for (name, _) in &mut self.parameters {
            let output = name
                .strip_prefix("SERVO")
                .and_then(|rest| rest.strip_suffix("_FUNCTION"));
            if let Some(output) = output {
                let output = (output.parse::<usize>().unwrap() - 1 + self.shift) % 32 + 1;
                *name = format!("SERVO{output}_FUNCTION");
            }
        }
    }
}

/// The parameters of a flight.
pub(super) fn parameters(flight: &Flight) -> Vec<(String, f64)> {
    let range = flight.range.as_ref().unwrap();
    let own = range.source.starts_with("MOT_PWM");
    let or_zero = |value: f64| if own { value } else { 0.0 };
    let mut parameters = vec![
        ("MOT_PWM_MIN".to_owned(), or_zero(range.low)),
        ("MOT_PWM_MAX".to_owned(), or_zero(range.high)),
        ("MOT_SPIN_MIN".to_owned(), flight.effective_range.low),
        ("MOT_SPIN_MAX".to_owned(), flight.effective_range.high),
        ("RCMAP_THROTTLE".to_owned(), 3.0),
        ("RC3_MIN".to_owned(), range.low),
        ("RC3_MAX".to_owned(), range.high),
        ("FRAME_CLASS".to_owned(), 1.0),
        ("FRAME_TYPE".to_owned(), 1.0),
    ];
    for number in 0..32 {
        let motor = flight
            .motors
            .iter()
            .find(|motor| output(&motor.output) == number);
        let function = motor.map_or(0.0, |motor| f64::from(motor.number) + 32.0);
        parameters.push((format!("SERVO{}_FUNCTION", number + 1), function));
    }
    parameters
}
