//! Damaged copies of bytes, reproducible by their seed.

use fastrand::Rng;

/// Numbers that often cause errors in parsers of text.
const NUMBERS: [&str; 12] = [
    "0",
    "-1",
    "1e308",
    "-1e308",
    "1e-320",
    "nan",
    "inf",
    "65535",
    "4294967296",
    "-0.0",
    "99999999999999999999",
    "0.1",
];

/// A random byte; small numbers and extremes are more frequent, because they often cause errors in lengths and counts.
pub fn byte(random: &mut Rng) -> u8 {
    match random.u8(..4) {
        0 => *random
            .choice(&[0, 1, 2, 3, 0x7f, 0x80, 0xfe, 0xff])
            .unwrap(),
        _ => random.u8(..),
    }
}

/// A copy with one to twelve mutations: bytes overwritten, removed, added, repeated or cut off, lines moved, numbers replaced.
pub fn damaged(bytes: &[u8], random: &mut Rng) -> Vec<u8> {
    let mut bytes = bytes.to_vec();
    let wounds = random.usize(1..=12);
    for _ in 0..random.usize(1..=wounds) {
        if bytes.is_empty() {
            break;
        }
        let at = random.usize(..bytes.len());
        let count = random.usize(1..=64).min(bytes.len() - at);
        match random.u8(..14) {
            0 => drop(bytes.drain(at..at + count)),
            1 => {
                let added: Vec<u8> = (0..count).map(|_| byte(random)).collect();
                bytes.splice(at..at, added);
            }
            2 => {
                let again = bytes[at..at + count].to_vec();
                let to = random.usize(..bytes.len());
                bytes.splice(to..to, again);
            }
            3 => bytes.truncate(at.max(1)),
            4 => bytes[at..at + count].fill(0),
            5 => (bytes[at..at + count].iter_mut()).for_each(|b| *b = byte(random)),
            6 => {
                let line = span(&bytes, at, |b| *b != b'\n');
                let taken: Vec<u8> = bytes.drain(line).chain([b'\n']).collect();
                let to = random.usize(..=bytes.len());
                let to = span(&bytes, to, |b| *b != b'\n').start;
                bytes.splice(to..to, taken);
            }
            7 | 8 => {
                let number = span(&bytes, at, |b| b.is_ascii_digit() || b"+-.e".contains(b));
                bytes.splice(number, random.choice(NUMBERS).unwrap().bytes());
            }
            _ => bytes[at] = byte(random),
        }
    }
    bytes
}

/// The range of bytes around a position that satisfy `belongs`.
fn span(bytes: &[u8], at: usize, belongs: impl Fn(&u8) -> bool) -> std::ops::Range<usize> {
    let start = bytes[..at].iter().rposition(|b| !belongs(b));
    let end = bytes[at..].iter().position(|b| !belongs(b));
    start.map_or(0, |start| start + 1)..end.map_or(bytes.len(), |end| at + end)
}
