//! Messages to the vehicle and its ground station.

use flagred::{
    flight::{Finding, Words},
    monitor::Update,
    verdict::{Level, Measure},
};
use flagred_flightlog::mavlink::{
    Packet,
    dialect::{
        HEARTBEAT_DATA, MavAutopilot, MavMessage, MavModeFlag, MavSeverity, MavState, MavType,
        NAMED_VALUE_FLOAT_DATA, STATUSTEXT_DATA,
    },
};

use fuzzy::drawing::visible;

/// The name under which the risk is sent.
pub(crate) const RISK: &str = "FR_RISK";
/// The name under which the elevated risk is sent.
pub(crate) const ELEVATED: &str = "FR_ELEV";
/// The sender's system id until a vehicle is found: 255, which ground stations use.
pub(crate) const DEFAULT_SYSTEM: u8 = 255;
/// Maximum length of a STATUSTEXT.
const TEXT: usize = 50;

/// The first byte of `custom_mode` in the heartbeats of a watch. The other three bytes are the running time of the watch in tenths
/// of a second. If two watches follow one vehicle, the one that has run longer sends the warnings.
const WATCH: u32 = 0xf1 << 24;
const AGE: u32 = (1 << 24) - 1;

// MAVLink message ids.
const HEARTBEAT: u32 = 0;
const NAMED_VALUE_FLOAT: u32 = 251;
const STATUSTEXT: u32 = 253;

/// The beginning of every text.
const PREFIX: &str = "FLAGRED: ";

/// The heartbeat of an onboard computer that has been running for this time.
pub(crate) fn heartbeat(age_s: f64) -> MavMessage {
    MavMessage::HEARTBEAT(HEARTBEAT_DATA {
        custom_mode: WATCH | ((age_s * 10.0) as u32).min(AGE),
        mavtype: MavType::MAV_TYPE_ONBOARD_CONTROLLER,
        autopilot: MavAutopilot::MAV_AUTOPILOT_INVALID,
        base_mode: MavModeFlag::empty(),
        system_status: MavState::MAV_STATE_ACTIVE,
        mavlink_version: 3,
    })
}

/// The running time in a heartbeat of another watch, in seconds.
pub(crate) fn age_of(packet: &Packet<'_>) -> Option<f64> {
    // Only messages that may be such a heartbeat are decoded.
    if packet.id != HEARTBEAT || packet.component == 1 {
        return None;
    }
    let Some(MavMessage::HEARTBEAT(beat)) = packet.message() else {
        return None;
    };
    let is_watch = beat.custom_mode & !AGE == WATCH
        && beat.mavtype == MavType::MAV_TYPE_ONBOARD_CONTROLLER
        && beat.autopilot == MavAutopilot::MAV_AUTOPILOT_INVALID;
    is_watch.then(|| f64::from(beat.custom_mode & AGE) / 10.0)
}

/// The risk in a packet of another watch, or of a program on the autopilot.
pub(crate) fn risk_of(packet: &Packet<'_>) -> Option<f32> {
    if packet.id != NAMED_VALUE_FLOAT {
        return None;
    }
    let Some(MavMessage::NAMED_VALUE_FLOAT(value)) = packet.message() else {
        return None;
    };
    (value.name.to_str() == Ok(RISK)).then_some(value.value)
}

/// The topic of a watch's text: its first word, usually a level.
pub(crate) fn topic_of(packet: &Packet<'_>) -> Option<String> {
    if packet.id != STATUSTEXT {
        return None;
    }
    topic(&packet.message()?)
}

/// Like [`topic_of`], for a decoded message.
pub(crate) fn topic(message: &MavMessage) -> Option<String> {
    let MavMessage::STATUSTEXT(status) = message else {
        return None;
    };
    let words = status.text.to_str().ok()?.strip_prefix(PREFIX)?;
    words.split_whitespace().next().map(str::to_owned)
}

/// The text about a station that reduces the rate of the motor commands.
pub(crate) fn slowed_text(rate_hz: f64, asker: Option<(u8, u8)>) -> String {
    match asker {
        Some((system, _)) => {
            format!("{PREFIX}station {system} slows motor data to {rate_hz:.0} Hz")
        }
        None => format!("{PREFIX}motor data slowed to {rate_hz:.0} Hz"),
    }
}

/// A NAMED_VALUE_FLOAT message with a time on the vehicle's clock.
pub(crate) fn value(t_s: f64, name: &str, value: f64) -> MavMessage {
    MavMessage::NAMED_VALUE_FLOAT(NAMED_VALUE_FLOAT_DATA {
        time_boot_ms: (t_s * 1e3).round() as u32,
        value: value as f32,
        name: name.into(),
    })
}

/// A text that ground stations show and read out.
pub(crate) fn status(level: Level, text: &str) -> MavMessage {
    let mut bytes = [0; TEXT];
    let text = visible(text);
    let ends = text.char_indices().map(|(start, c)| start + c.len_utf8());
    let end = ends.take_while(|end| *end <= TEXT).last().unwrap_or(0);
    for (byte, letter) in bytes.iter_mut().zip(text.bytes().take(end)) {
        *byte = letter;
    }
    MavMessage::STATUSTEXT(STATUSTEXT_DATA {
        severity: match level {
            Level::Good | Level::Info => MavSeverity::MAV_SEVERITY_INFO,
            Level::Warn => MavSeverity::MAV_SEVERITY_WARNING,
            Level::Fail => MavSeverity::MAV_SEVERITY_CRITICAL,
        },
        text: bytes.into(),
        ..STATUSTEXT_DATA::default()
    })
}

/// Returns the text of a change of level with its cause, in at most 50 characters: `FLAGRED: WARN risk 78 %, fighting
/// gusts`; if motors are near a limit, `FLAGRED: WARN risk 78 %, upper limit, motor 3`; or `FLAGRED: WARN motor 3
/// weak: +24 %`. `finding` is the finding with its texts. If it is `None` although the level is above GOOD, nothing raises
/// the risk any more, but the balance of the motors differs from that before the alarm. The text then states that the
/// level stays.
pub(crate) fn level_text(
    level: Level,
    update: &Update,
    finding: Option<(&Finding, &Words)>,
) -> String {
    if level > Level::Good && finding.is_none() {
        return format!("{PREFIX}{level} stays: motor balance is off");
    }
    let elevated = || ("elevated", update.elevated_risk_pct);
    let risk = || ("risk", update.risk.ok().map(|estimate| estimate.risk_pct));
    let (name, value) = match finding {
        Some((finding, _)) if !finding.is_of_risk() => ("", None),
        Some((finding, _)) => match (&finding.risk_output, finding.measure) {
            (Some(other), _) => (other.as_str(), Some(finding.value_pct)),
            (None, Measure::ElevatedRisk) => elevated(),
            (None, _) => risk(),
        },
        None => risk(),
    };
    let mut text = format!("{PREFIX}{level}");
    if let Some(value) = value {
        text += &format!(" {name} {value:.0} %");
    }
    let [first, second] = finding.map_or(["", ""], |(_, words)| {
        words.brief.each_ref().map(String::as_str)
    });
    let first = match finding {
        Some((finding, _)) if finding.is_of_risk() => format!(", {first}"),
        Some(_) => format!(" {first}"),
        None => String::new(),
    };
    for words in [first.as_str(), second] {
        let words = visible(words);
        if text.len() + words.len() > TEXT {
            break;
        }
        text += &words;
    }
    text
}

/// The text for a risk that becomes unknown during an alarm.
pub(crate) fn unknown_text(last: Level) -> String {
    format!("{PREFIX}risk unknown, last level {last}")
}

#[cfg(test)]
mod tests {
    use super::*;
    use flagred_flightlog::mavlink::{PacketScan, Sender, Version, next_packet};

    /// Names from rule sets, which may be part of the text, can contain any characters.
    #[test]
    fn a_text_is_safe_on_a_terminal_and_ends_with_a_whole_character() {
        let MavMessage::STATUSTEXT(sent) = status(Level::Warn, "a\u{1b}[2J\u{202e}") else {
            panic!("another message");
        };
        assert_eq!(sent.text.to_str().unwrap(), "a\\u{1b}[2J\\u{202e}");
        let long = "x".repeat(TEXT - 1) + "é";
        let MavMessage::STATUSTEXT(sent) = status(Level::Warn, &long) else {
            panic!("another message");
        };
        assert_eq!(sent.text.to_str().unwrap(), "x".repeat(TEXT - 1));
    }

    #[test]
    fn a_text_of_any_length_fits() {
        for length in [0, 30, 49, 50, 51, 90] {
            let text = "x".repeat(length);
            let bytes = Sender::new(191).packet(Version::V1, 1, &status(Level::Fail, &text));
            let PacketScan::Packet(packet) = next_packet(&bytes) else {
                panic!("{bytes:?}");
            };
            let Some(MavMessage::STATUSTEXT(read)) = packet.message() else {
                panic!("{packet:?}");
            };
            assert_eq!(read.text.to_str().unwrap().len(), length.min(50));
            assert_eq!(read.severity, MavSeverity::MAV_SEVERITY_CRITICAL);
        }
    }
}
