//! Small writers of flight logs, for log layouts of which no real log may be redistributed.

/// A value of a field.
#[derive(Debug, Clone, Copy)]
pub enum Value<'a> {
    /// A number, in the logged unit.
    Number(f64),
    /// A text.
    Text(&'a str),
}

impl From<f64> for Value<'_> {
    fn from(number: f64) -> Self {
        Self::Number(number)
    }
}

impl<'a> From<&'a str> for Value<'a> {
    fn from(text: &'a str) -> Self {
        Self::Text(text)
    }
}

/// An ArduPilot DataFlash log, in both binary and text form.
#[derive(Debug, Default)]
pub struct DataFlash {
    /// The binary log.
    pub bytes: Vec<u8>,
    /// The same log as text.
    pub text: String,
    kinds: std::collections::HashMap<String, (u8, String)>,
}

impl DataFlash {
    /// Creates a log that defines FMT, as every log must.
    pub fn new() -> Self {
        let mut log = Self::default();
        log.define(128, "FMT", "BBnNZ", "Type,Length,Name,Format,Columns");
        log
    }

    /// Defines a message.
    pub fn define(&mut self, type_id: u8, name: &str, kinds: &str, labels: &str) {
        let widths = kinds.bytes().map(width);
        let length = 3 + widths.sum::<usize>();
        self.bytes.extend([0xa3, 0x95, 128, type_id, length as u8]);
        for (text, width) in [(name, 4), (kinds, 16), (labels, 64)] {
            self.bytes.extend(padded(text, width));
        }
        self.text += &format!("FMT, {type_id}, {length}, {name}, {kinds}, {labels}\n");
        self.kinds.insert(name.into(), (type_id, kinds.into()));
    }

    /// Writes a message.
    ///
    /// # Panics
    ///
    /// If the message was not defined.
    pub fn write<'a>(&mut self, name: &str, values: impl IntoIterator<Item = Value<'a>>) {
        let (type_id, kinds) = self.kinds[name].clone();
        self.bytes.extend([0xa3, 0x95, type_id]);
        self.text += name;
        for (kind, value) in kinds.bytes().zip(values) {
            match value {
                Value::Text(text) => {
                    self.bytes.extend(padded(text, width(kind)));
                    self.text += &format!(", {text}");
                }
                Value::Number(number) => {
                    self.bytes.extend(encoded(kind, number));
                    self.text += &format!(", {number}");
                }
            }
        }
        self.text += "\n";
    }

    /// Writes a parameter; PARM must be defined as `QNf`.
    pub fn parameter(&mut self, time_us: f64, name: &str, value: f64) {
        self.write("PARM", [time_us.into(), name.into(), value.into()]);
    }
}

fn width(kind: u8) -> usize {
    match kind {
        b'B' | b'b' | b'M' => 1,
        b'H' | b'h' | b'c' | b'C' => 2,
        b'I' | b'i' | b'f' | b'n' | b'L' | b'e' | b'E' => 4,
        b'Q' | b'q' | b'd' => 8,
        b'N' => 16,
        _ => 64,
    }
}

fn padded(text: &str, width: usize) -> Vec<u8> {
    let mut bytes = text.as_bytes().to_vec();
    bytes.resize(width, 0);
    bytes
}

fn encoded(kind: u8, number: f64) -> Vec<u8> {
    match kind {
        b'B' | b'M' => vec![number as u8],
        b'H' => (number as u16).to_le_bytes().into(),
        b'h' => (number as i16).to_le_bytes().into(),
        b'c' => ((number * 100.0).round() as i16).to_le_bytes().into(),
        b'I' => (number as u32).to_le_bytes().into(),
        b'i' => (number as i32).to_le_bytes().into(),
        b'L' => ((number * 1e7).round() as i32).to_le_bytes().into(),
        b'f' => (number as f32).to_le_bytes().into(),
        b'Q' => (number as u64).to_le_bytes().into(),
        other => unimplemented!("fields of type {}", char::from(other)),
    }
}

/// A PX4 ULog file.
#[derive(Debug)]
pub struct ULog {
    /// The file.
    pub bytes: Vec<u8>,
}

impl ULog {
    /// Creates the file of a log that began at the given time.
    pub fn new(start_us: u64) -> Self {
        let mut bytes = b"ULog\x01\x12\x35\x01".to_vec();
        bytes.extend(start_us.to_le_bytes());
        Self { bytes }
    }

    /// Writes a message.
    pub fn message(&mut self, letter: u8, body: &[u8]) {
        self.bytes.extend((body.len() as u16).to_le_bytes());
        self.bytes.push(letter);
        self.bytes.extend(body);
    }

    /// Defines a topic, as in `name:uint64_t timestamp;float[4] q;`.
    pub fn define(&mut self, text: &str) {
        self.message(b'F', text.as_bytes());
    }

    /// Writes a parameter, as a float.
    pub fn parameter(&mut self, name: &str, value: f32) {
        let key = format!("float {name}");
        let mut body = vec![key.len() as u8];
        body.extend(key.bytes());
        body.extend(value.to_le_bytes());
        self.message(b'P', &body);
    }

    /// Writes a subscription: assigns the number `id` to an instance of a topic.
    pub fn announce(&mut self, instance: u8, id: u16, name: &str) {
        let mut body = vec![instance];
        body.extend(id.to_le_bytes());
        body.extend(name.bytes());
        self.message(b'A', &body);
    }

    /// Writes a data message of a topic that consists of a timestamp and floats.
    pub fn floats(&mut self, id: u16, time_us: u64, values: &[f32]) {
        let mut body = id.to_le_bytes().to_vec();
        body.extend(time_us.to_le_bytes());
        body.extend(values.iter().flat_map(|value| value.to_le_bytes()));
        self.message(b'D', &body);
    }

    /// Writes a data message of a topic that consists of a timestamp and bytes.
    pub fn flags(&mut self, id: u16, time_us: u64, values: &[u8]) {
        let mut body = id.to_le_bytes().to_vec();
        body.extend(time_us.to_le_bytes());
        body.extend(values);
        self.message(b'D', &body);
    }
}

/// A MAVLink telemetry log.
#[derive(Debug, Default)]
pub struct Tlog {
    /// The file.
    pub bytes: Vec<u8>,
}

/// A MAVLink message: number, CRC_EXTRA, length in version 1.
pub type Message = (u32, u8, usize);

/// HEARTBEAT.
pub const HEARTBEAT: Message = (0, 50, 9);
/// PARAM_VALUE.
pub const PARAM_VALUE: Message = (22, 220, 25);
/// SERVO_OUTPUT_RAW.
pub const SERVO_OUTPUT_RAW: Message = (36, 222, 21);
/// ATTITUDE.
pub const ATTITUDE: Message = (30, 39, 28);
/// NAV_CONTROLLER_OUTPUT.
pub const NAV_CONTROLLER_OUTPUT: Message = (62, 183, 26);
/// GLOBAL_POSITION_INT.
pub const GLOBAL_POSITION_INT: Message = (33, 104, 28);
/// STATUSTEXT.
pub const STATUSTEXT: Message = (253, 83, 51);

impl Tlog {
    /// Writes a packet of MAVLink 1 or 2, sent by the given system and component.
    pub fn packet(
        &mut self,
        stamp_us: u64,
        version: u8,
        from: (u8, u8),
        message: Message,
        payload: &[u8],
    ) {
        self.bytes.extend(stamp_us.to_be_bytes());
        self.bytes.extend(packet(version, from, message, payload));
    }
}

/// Returns a packet of MAVLink 1 or 2, sent by the given system and component.
pub fn packet(
    version: u8,
    (system, component): (u8, u8),
    (id, extra, length): Message,
    payload: &[u8],
) -> Vec<u8> {
    let mut payload = payload.to_vec();
    payload.resize(payload.len().max(length), 0);
    let mut packet = match version {
        1 => vec![0xfe, payload.len() as u8, 0, system, component, id as u8],
        _ => {
            while payload.len() > 1 && payload.last() == Some(&0) {
                payload.pop();
            }
            let [a, b, c, _] = id.to_le_bytes();
            vec![
                0xfd,
                payload.len() as u8,
                0,
                0,
                0,
                system,
                component,
                a,
                b,
                c,
            ]
        }
    };
    packet.extend(&payload);
    // The checksum bit by bit, as in its definition.
    let mut sum = 0xffff_u16;
    for byte in packet[1..].iter().chain([&extra]) {
        sum ^= u16::from(*byte);
        for _ in 0..8 {
            sum = match sum & 1 {
                1 => (sum >> 1) ^ 0x8408,
                _ => sum >> 1,
            };
        }
    }
    packet.extend(sum.to_le_bytes());
    packet
}
