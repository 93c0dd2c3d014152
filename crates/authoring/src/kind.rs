//! Kinds of files that are not text, so that a message can name them.

/// A kind of file that is not a rule set or a profile.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub struct Kind {
    /// The kind of file, such as `a PDF document`.
    pub name: &'static str,
    /// What to do.
    pub help: &'static str,
}

const LOG: &str = "`flagred assess` reads flight logs";

/// The first bytes of files, with their kinds.
const STARTS: [(&[u8], Kind); 8] = [
    (
        b"%PDF-",
        Kind {
            name: "a PDF document",
            help: "copy the rules into a text file",
        },
    ),
    (
        b"PK\x03\x04",
        Kind {
            name: "a ZIP archive or an office document",
            help: "unpack it, or save it as text",
        },
    ),
    (
        b"\x1f\x8b",
        Kind {
            name: "compressed by gzip",
            help: "unpack it: `gunzip FILE`",
        },
    ),
    (
        b"\xfd7zXZ\0",
        Kind {
            name: "compressed by xz",
            help: "unpack it: `unxz FILE`",
        },
    ),
    (
        b"\x89PNG",
        Kind {
            name: "a picture",
            help: "name the text file",
        },
    ),
    (
        b"\xa3\x95",
        Kind {
            name: "a flight log of ArduPilot",
            help: LOG,
        },
    ),
    (
        b"ULog\x01\x12\x35",
        Kind {
            name: "a flight log of PX4",
            help: LOG,
        },
    ),
    (
        b"MATLAB 5.0",
        Kind {
            name: "a MAT file",
            help: "in MATLAB, write the system by `writeFIS`",
        },
    ),
];

/// Returns whether bytes begin with a byte order mark of UTF-16.
pub fn is_utf16(bytes: &[u8]) -> bool {
    matches!(bytes.get(..2), Some([0xff, 0xfe] | [0xfe, 0xff]))
}

/// Returns the kind of bytes that are not text; `None` for text and for unknown bytes.
pub fn binary(bytes: &[u8]) -> Option<Kind> {
    if let Some((_, kind)) = STARTS.iter().find(|(start, _)| bytes.starts_with(start)) {
        return Some(*kind);
    }
    if is_utf16(bytes) || !bytes.contains(&0) {
        return None;
    }
    // In UTF-16, one byte of each ASCII letter is 0.
    const LOOKED_AT: usize = 1000;
    let (pairs, _) = bytes.as_chunks::<2>();
    let pairs = || pairs.iter().take(LOOKED_AT);
    let halves = pairs()
        .filter(|pair| (pair[0] == 0) != (pair[1] == 0))
        .count();
    Some(match 2 * halves > pairs().count() {
        true => Kind {
            name: "text in UTF-16 without a byte order mark",
            help: "save the file as UTF-8",
        },
        false => Kind {
            name: "not a text file",
            help: "a rule set is a text file that begins with `fuzzy: 1`",
        },
    })
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn kinds_are_recognised_by_their_bytes() {
        let utf16: Vec<u8> = "fuzzy: 1\nname: ä"
            .encode_utf16()
            .flat_map(u16::to_le_bytes)
            .collect();
        let cases: [(&[u8], Option<&str>); 8] = [
            (b"%PDF-1.7\n\xe2", Some("a PDF document")),
            (
                b"PK\x03\x04\x14",
                Some("a ZIP archive or an office document"),
            ),
            (b"\x1f\x8b\x08", Some("compressed by gzip")),
            (b"\xa3\x95\x80", Some("a flight log of ArduPilot")),
            (&utf16, Some("text in UTF-16 without a byte order mark")),
            (&[0; 100], Some("not a text file")),
            (b"\xff\xfef\0", None),
            ("fuzzy: 1\nname: ä".as_bytes(), None),
        ];
        for (bytes, name) in cases {
            assert_eq!(binary(bytes).map(|kind| kind.name), name, "{bytes:?}");
        }
    }
}
