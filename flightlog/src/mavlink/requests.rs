//! What to ask a vehicle for, and when to ask again.
#![expect(
    deprecated,
    reason = "the old way to ask for rates is what old vehicles understand"
)]

use super::{
    Telemetry,
    dialect::{
        COMMAND_LONG_DATA, MavCmd, MavDataStream, MavMessage, PARAM_REQUEST_READ_DATA,
        REQUEST_DATA_STREAM_DATA,
    },
};

/// How often motor commands are asked for: what the shipped profiles are calibrated on.
pub const MOTOR_RATE_HZ: f64 = 25.0;

/// Messages by number, and how often each is asked for in Hz: motor commands, attitude and the landed state.
const MESSAGES: [(f32, f64); 3] = [(36.0, MOTOR_RATE_HZ), (30.0, 4.0), (245.0, 4.0)];
/// The old groups of messages they are in, and their rates.
const STREAMS: [(MavDataStream, u16); 3] = [
    (
        MavDataStream::MAV_DATA_STREAM_RC_CHANNELS,
        MOTOR_RATE_HZ as u16,
    ),
    (MavDataStream::MAV_DATA_STREAM_EXTRA1, 4),
    (MavDataStream::MAV_DATA_STREAM_EXTENDED_STATUS, 4),
];
/// Seconds to wait for the wanted rate.
const RATE_WAIT_S: f64 = 2.0;
/// Seconds to wait after a few requests without effect: the link may be slow.
const RATE_PATIENCE_S: f64 = 15.0;
/// Seconds until a parameter is requested again, and the number of requests: on a link that loses 3 of 10 packets each
/// way, one in a million stays unknown.
const PARAMETER_WAIT_S: f64 = 0.5;
const PARAMETER_TRIES: u32 = 20;

/// Decides what to request, and when to request it again.
#[derive(Debug, Default)]
pub struct Requests {
    rate_tries: u32,
    rate_asked_s: Option<f64>,
    commands_then: u64,
    parameter_tries: u32,
    parameters_asked_s: Option<f64>,
    parameters_done: bool,
}

impl Requests {
    /// Nothing was requested yet.
    pub fn new() -> Requests {
        Requests::default()
    }

    /// Whether all parameters came, or were asked for often enough.
    pub fn parameters_done(&self) -> bool {
        self.parameters_done
    }

    /// Adds the messages to send now to `out`. The time is that of the receiver's clock, in seconds.
    pub fn due(&mut self, now_s: f64, telemetry: &Telemetry, out: &mut Vec<MavMessage>) {
        self.ask_rates(now_s, telemetry, out);
        if !self.parameters_done {
            self.ask_parameters(now_s, telemetry, out);
        }
    }

    /// Goes by the rate of the messages received: acknowledgements get lost.
    fn ask_rates(&mut self, now_s: f64, telemetry: &Telemetry, out: &mut Vec<MavMessage>) {
        let wait_s = if self.rate_tries < 4 {
            RATE_WAIT_S
        } else {
            RATE_PATIENCE_S
        };
        let refused = telemetry.interval_refused() && self.rate_tries == 1;
        let waited_s = self.rate_asked_s.map(|asked_s| now_s - asked_s);
        if waited_s.is_some_and(|waited_s| waited_s < wait_s) && !refused {
            return;
        }
        let came = telemetry.commands_seen() - self.commands_then;
        let enough = waited_s.is_some_and(|waited_s| came as f64 >= waited_s * MOTOR_RATE_HZ / 2.0);
        self.rate_asked_s = Some(now_s);
        self.commands_then = telemetry.commands_seen();
        if enough && !refused {
            return;
        }
        // The first two requests use the new command, the next ones alternate.
        let old_way = telemetry.interval_refused()
            || self.rate_tries >= 2 && self.rate_tries.is_multiple_of(2);
        self.rate_tries += 1;
        let system = telemetry.system();
        if old_way {
            out.extend(STREAMS.map(|(stream, rate_hz)| {
                MavMessage::REQUEST_DATA_STREAM(REQUEST_DATA_STREAM_DATA {
                    req_message_rate: rate_hz,
                    target_system: system,
                    target_component: 1,
                    req_stream_id: stream,
                    start_stop: 1,
                })
            }));
        } else {
            out.extend(MESSAGES.map(|(message, rate_hz)| {
                MavMessage::COMMAND_LONG(COMMAND_LONG_DATA {
                    param1: message,
                    param2: (1e6 / rate_hz) as f32,
                    command: MavCmd::MAV_CMD_SET_MESSAGE_INTERVAL,
                    target_system: system,
                    target_component: 1,
                    ..COMMAND_LONG_DATA::default()
                })
            }));
        }
    }

    fn ask_parameters(&mut self, now_s: f64, telemetry: &Telemetry, out: &mut Vec<MavMessage>) {
        let missing = telemetry.missing_parameters();
        if missing.is_empty() {
            self.parameters_done = true;
            return;
        }
        if self
            .parameters_asked_s
            .is_some_and(|asked_s| now_s - asked_s < PARAMETER_WAIT_S)
        {
            return;
        }
        if self.parameter_tries >= PARAMETER_TRIES {
            self.parameters_done = true;
            return;
        }
        self.parameters_asked_s = Some(now_s);
        self.parameter_tries += 1;
        out.extend(missing.iter().map(|name| {
            MavMessage::PARAM_REQUEST_READ(PARAM_REQUEST_READ_DATA {
                param_index: -1,
                target_system: telemetry.system(),
                target_component: 1,
                param_id: name.as_str().into(),
            })
        }));
    }
}

/// Whether everything is known that the motors and their range depend on.
pub fn parameters_known(telemetry: &Telemetry) -> bool {
    telemetry.missing_parameters().is_empty()
}
