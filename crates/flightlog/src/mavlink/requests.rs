//! Decides what to request from a vehicle, and when to repeat a request.
#![expect(
    deprecated,
    reason = "old vehicles understand only the deprecated message that requests rates"
)]

use super::{
    Telemetry,
    dialect::{
        COMMAND_LONG_DATA, MavCmd, MavDataStream, MavMessage, PARAM_REQUEST_READ_DATA,
        REQUEST_DATA_STREAM_DATA,
    },
    telemetry::RATED,
};

/// The requested rate of motor commands in Hz, for which the shipped profiles are calibrated.
pub const MOTOR_RATE_HZ: f64 = 25.0;

/// The requested rate of each message in [`RATED`], in Hz.
const RATES_HZ: [f64; RATED.len()] = [MOTOR_RATE_HZ, 4.0, 4.0, 2.0, 2.0, 4.0, 4.0, 4.0, 2.0, 2.0];
/// The old message groups (streams) that contain the messages in [`RATED`].
const STREAMS: [MavDataStream; RATED.len()] = [
    MavDataStream::MAV_DATA_STREAM_RC_CHANNELS,
    MavDataStream::MAV_DATA_STREAM_EXTRA1,
    MavDataStream::MAV_DATA_STREAM_EXTENDED_STATUS,
    MavDataStream::MAV_DATA_STREAM_EXTENDED_STATUS,
    MavDataStream::MAV_DATA_STREAM_EXTRA3,
    MavDataStream::MAV_DATA_STREAM_POSITION,
    MavDataStream::MAV_DATA_STREAM_EXTRA2,
    MavDataStream::MAV_DATA_STREAM_EXTRA3,
    MavDataStream::MAV_DATA_STREAM_EXTENDED_STATUS,
    MavDataStream::MAV_DATA_STREAM_RC_CHANNELS,
];
/// The time to listen before the first request, in seconds. Rates apply to the whole link, and another station that
/// shares it may have requested higher rates.
const LISTEN_S: f64 = 1.0;
/// The share of the requested rate below which the rate is requested again.
const SLOW_AGAIN: f64 = 0.5;
/// The time to wait for the requested rate, in seconds.
const RATE_WAIT_S: f64 = 2.0;
/// The time to wait after a few requests without effect, in seconds; it is longer, because the link may be slow.
const SLOW_LINK_WAIT_S: f64 = 15.0;
/// The maximum packet loss that is compensated for in a measured rate.
const MAX_LOST: f64 = 0.9;
/// The time until a parameter is requested again, in seconds.
const PARAMETER_WAIT_S: f64 = 0.5;
/// The number of requests for a parameter. On a link that loses 3 of 10 packets in each direction, one parameter in a
/// million remains unknown.
const PARAMETER_TRIES: u32 = 20;

/// Decides what to request, and when to request it again.
#[derive(Debug, Default)]
pub struct Requests {
    rate_tries: u32,
    /// The time at which rates were last requested or measured, and the number of messages of each kind received until
    /// then.
    measured: Option<(f64, [u64; RATED.len()])>,
    /// Whether the rate of each message was too low in the latest measurement.
    slow: [bool; RATED.len()],
    used_data_stream: bool,
    has_been_fast: bool,
    slow_measurements: u32,
    /// Whether a rate that has just dropped is being measured, before it is requested again.
    measures: bool,
    slowed_hz: Option<f64>,
    parameter_tries: u32,
    parameters_asked_s: Option<f64>,
    parameters_done: bool,
}

impl Requests {
    /// Creates the state before any request.
    pub fn new() -> Requests {
        Requests::default()
    }

    /// Whether all parameters arrived, or were requested the maximum number of times.
    pub fn parameters_done(&self) -> bool {
        self.parameters_done
    }

    /// Returns the rate of the motor commands, in Hz, once after each drop below half of the requested rate, which
    /// happens if another station requests less or the link is too slow. The rate is measured after the drop, over at
    /// least two seconds.
    pub fn take_slowed_hz(&mut self) -> Option<f64> {
        self.slowed_hz.take()
    }

    /// Restarts the measurement of rates, after the link was silent.
    pub fn resume(&mut self) {
        self.measured = None;
        self.slow_measurements = 0;
        self.measures = false;
    }

    /// Adds the messages to send now to `out`. `now_s` is the time of the receiver's clock in seconds; `lost_share` is
    /// the share of the vehicle's packets that are lost on the way. Lost packets do not make a rate count as low.
    ///
    /// A message with a sufficient rate is not requested, so that no rate of a shared link is lowered.
    pub fn due(
        &mut self,
        now_s: f64,
        telemetry: &Telemetry,
        lost_share: f64,
        out: &mut Vec<MavMessage>,
    ) {
        self.ask_rates(now_s, telemetry, lost_share, out);
        if !self.parameters_done {
            self.ask_parameters(now_s, telemetry, out);
        }
    }

    /// Requests again the rates that are too low. They are measured from the received messages, because
    /// acknowledgements may be lost.
    fn ask_rates(
        &mut self,
        now_s: f64,
        telemetry: &Telemetry,
        lost_share: f64,
        out: &mut Vec<MavMessage>,
    ) {
        let seen = telemetry.seen();
        let Some((measured_s, then)) = self.measured else {
            self.measured = Some((now_s, seen));
            return;
        };
        let wait_s = match self.rate_tries {
            _ if self.measures => RATE_WAIT_S,
            0 => LISTEN_S,
            1..4 => RATE_WAIT_S,
            _ => SLOW_LINK_WAIT_S,
        };
        let is_refused =
            telemetry.interval_refused() && !self.used_data_stream && self.slow.contains(&true);
        let waited_s = now_s - measured_s;
        if waited_s < wait_s && !is_refused {
            return;
        }
        if !is_refused {
            // In the first measurement, one more message is assumed to have arrived just outside the measured time, so
            // that a sufficient rate is never judged too low.
            let (share, outside) = if self.rate_tries == 0 {
                (1.0, 1.0)
            } else {
                (SLOW_AGAIN, 0.0)
            };
            let arrives = 1.0 - lost_share.clamp(0.0, MAX_LOST);
            let rate_hz = |i: usize| (seen[i] - then[i]) as f64 / waited_s / arrives;
            self.slow = std::array::from_fn(|i| {
                telemetry.wants(i)
                    && rate_hz(i) + outside / waited_s / arrives < share * RATES_HZ[i]
            });
            self.has_been_fast |= !self.slow[0];
            self.slow_measurements = if self.slow[0] {
                self.slow_measurements + 1
            } else {
                0
            };
            // The rate is reported after the second slow measurement: the first one also contains commands from before
            // the drop, and a short silence of the link has ended by the second one.
            if self.slow_measurements == 2 && self.has_been_fast {
                self.slowed_hz = Some(rate_hz(0));
            }
            // If another station requested a lower rate, that rate is measured before a new request, because the
            // request would raise it.
            let is_asked = telemetry.rate_asker().is_some();
            self.measures = self.slow_measurements == 1 && self.has_been_fast && is_asked;
        }
        self.measured = Some((now_s, seen));
        if self.measures {
            return;
        }
        if !self.slow.contains(&true) {
            // The link is fast enough, so a later low rate is requested again without the long wait for slow links.
            self.rate_tries = 1;
            return;
        }
        // The first two requests use the new command; further ones alternate between the old and the new command.
        let by_data_stream = telemetry.interval_refused()
            || self.rate_tries >= 2 && self.rate_tries.is_multiple_of(2);
        self.used_data_stream |= by_data_stream;
        self.rate_tries += 1;
        let system = telemetry.system();
        for i in (0..RATED.len()).filter(|&i| self.slow[i]) {
            out.push(match by_data_stream {
                true => MavMessage::REQUEST_DATA_STREAM(REQUEST_DATA_STREAM_DATA {
                    req_message_rate: RATES_HZ[i] as u16,
                    target_system: system,
                    target_component: 1,
                    req_stream_id: STREAMS[i],
                    start_stop: 1,
                }),
                false => MavMessage::COMMAND_LONG(COMMAND_LONG_DATA {
                    param1: RATED[i] as f32,
                    param2: (1e6 / RATES_HZ[i]) as f32,
                    command: MavCmd::MAV_CMD_SET_MESSAGE_INTERVAL,
                    target_system: system,
                    target_component: 1,
                    ..COMMAND_LONG_DATA::default()
                }),
            });
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

/// Whether all parameters that determine the motors and their range are known, or known not to exist.
pub fn parameters_known(telemetry: &Telemetry) -> bool {
    telemetry.missing_parameters().is_empty()
}
