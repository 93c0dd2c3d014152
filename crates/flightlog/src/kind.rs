//! Kinds of files that are not flight logs, so that a message can name them.

/// A kind of file.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
#[non_exhaustive]
pub struct FileKind {
    /// The kind in words, such as `a PDF document`.
    pub name: &'static str,
    /// Advice on what to do, if it does not depend on the expected kind.
    pub help: Option<&'static str>,
}

const UNPACK: &str = "unpack it first";
const AS_CSV: &str = "save it as CSV (UTF-8)";
const AS_TEXT: &str = "save it as text, a table as CSV (UTF-8)";
const COMMAS: &str = "a flight CSV separates cells by commas, and numbers have a decimal point";

/// Signatures: the first bytes of a file, bytes that must occur after them, name, and help.
const SIGNATURES: &[(&[u8], &[u8], &str, &str)] = &[
    (b"\x89PNG", b"", "a PNG picture", ""),
    (b"\xff\xd8\xff", b"", "a JPEG picture", ""),
    (b"GIF8", b"", "a GIF picture", ""),
    (b"%PDF", b"", PDF, "copy its content into a text file"),
    (b"PK\x03\x04", b"xl/workbook", "an Excel file", AS_CSV),
    (b"PK\x03\x04", b"word/document", "a Word document", AS_TEXT),
    (
        b"PK\x03\x04",
        b"[Content_Types].xml",
        "an office document",
        AS_TEXT,
    ),
    (
        b"PK\x03\x04",
        b"vnd.oasis.opendocument",
        "an office document",
        AS_TEXT,
    ),
    (b"PK\x03\x04", b"", "a ZIP archive", UNPACK),
    (b"\xd0\xcf\x11\xe0", b"", "an old office document", AS_TEXT),
    (
        b"\x1f\x8b",
        b"",
        "compressed by gzip",
        "unpack it first: `gunzip FILE`",
    ),
    (b"7z\xbc\xaf", b"", "a 7z archive", UNPACK),
    (
        b"\x28\xb5\x2f\xfd",
        b"",
        "compressed by zstd",
        "unpack it first: `unzstd FILE`",
    ),
    (
        b"\xfd7zXZ",
        b"",
        "compressed by xz",
        "unpack it first: `unxz FILE`",
    ),
    (
        b"BZh",
        b"",
        "compressed by bzip2",
        "unpack it first: `bunzip2 FILE`",
    ),
    (b"PAR1", b"", "a Parquet file", "write it as CSV"),
    (
        b"\x93NUMPY",
        b"",
        "a NumPy array",
        "write it by `numpy.savetxt` as CSV",
    ),
    (b"MATLAB 5.0", b"", MAT, MAT_HELP),
    (b"\x89HDF", b"", MAT, MAT_HELP),
    (b"\x7fELF", b"", "a program", ""),
    (
        b"H Product:Blackbox",
        b"",
        BETAFLIGHT,
        "convert it with `blackbox_decode`, and rename its columns as docs/flight-csv.md describes",
    ),
    (b"<!DOCTYPE", b"", WEB_PAGE, ""),
    (b"<!doctype", b"", WEB_PAGE, ""),
    (b"<html", b"", WEB_PAGE, ""),
    (
        b"version https://git-lfs",
        b"",
        POINTER,
        "fetch the file itself with `git lfs pull`",
    ),
];

pub(crate) const BETAFLIGHT: &str = "a Betaflight log";
const PDF: &str = "a PDF document";
const WEB_PAGE: &str = "a web page";
const POINTER: &str = "a git-lfs pointer";
const MAT: &str = "a MAT or HDF5 file";
const MAT_HELP: &str = "name the .bin or .ulg log that it was made from; in MATLAB, write a fuzzy system by `writeFIS`, a table by `writetable`";

/// Kinds that are recognised without a signature.
const OTHERS: &[FileKind] = &[
    FileKind::LOG,
    FileKind::BINARY,
    FileKind::TEXT,
    FileKind::RULES,
    FileKind::PROFILE,
    FileKind::SEMICOLONS,
    FileKind::TABS,
    FileKind::PARAMETERS,
    FileKind::UTF_16,
];

impl FileKind {
    /// A flight log.
    pub const LOG: FileKind = FileKind {
        name: "a flight log",
        help: None,
    };
    const BINARY: FileKind = FileKind {
        name: "an unknown binary file",
        help: None,
    };
    const TEXT: FileKind = FileKind {
        name: "a text file",
        help: Some(
            "a flight CSV begins with the names of its columns, separated by commas: `t_s`, and `pwm1` or `motor1` and so on; a text log of ArduPilot begins with `FMT` lines",
        ),
    };
    const RULES: FileKind = FileKind {
        name: "a rule set",
        help: Some("`flagred check` examines a rule set"),
    };
    const PROFILE: FileKind = FileKind {
        name: "a profile",
        help: Some("`flagred assess --profile PROFILE FLIGHT` assesses a flight with it"),
    };
    const SEMICOLONS: FileKind = FileKind {
        name: "a table with semicolons between its cells",
        help: Some(COMMAS),
    };
    const TABS: FileKind = FileKind {
        name: "a table with tabs between its cells",
        help: Some(COMMAS),
    };
    pub(crate) const PARAMETERS: FileKind = FileKind {
        name: "a list of parameters",
        help: Some("name the log of a flight, which contains the parameters"),
    };
    pub(crate) const UTF_16: FileKind = FileKind {
        name: "text in UTF-16",
        help: Some("save it as UTF-8"),
    };

    /// Kinds of text that may be meant for another command.
    pub(crate) const PLAIN: &[FileKind] = &[
        FileKind::TEXT,
        FileKind::RULES,
        FileKind::PROFILE,
        FileKind::SEMICOLONS,
        FileKind::TABS,
        FileKind::PARAMETERS,
    ];

    /// Whether the content is text.
    pub fn is_text(self) -> bool {
        FileKind::PLAIN.contains(&self) || [WEB_PAGE, POINTER].contains(&self.name)
    }

    /// Advice for users who pass a file of this kind instead of a log.
    pub(crate) fn help_for_log(self) -> Option<&'static str> {
        // The advice for a PDF document is to copy its text, but text is not a log.
        self.help.filter(|_| self.name != PDF)
    }

    /// Returns the kind with the given name.
    pub(crate) fn named(name: &str) -> Option<FileKind> {
        let signed = SIGNATURES.iter().map(kind);
        let mut kinds = OTHERS.iter().copied().chain(signed);
        kinds.find(|kind| kind.name == name)
    }
}

fn kind(&(.., name, help): &(&[u8], &[u8], &'static str, &'static str)) -> FileKind {
    FileKind {
        name,
        help: Some(help).filter(|help| !help.is_empty()),
    }
}

/// Returns the kind of a file with a signature.
pub(crate) fn signed(start: &[u8]) -> Option<FileKind> {
    let contains =
        |part: &[u8]| part.is_empty() || start.windows(part.len()).any(|bytes| bytes == part);
    let mut signatures = SIGNATURES.iter();
    let found = signatures.find(|(first, then, ..)| start.starts_with(first) && contains(then));
    found.map(kind)
}

/// Whether a file begins with the mark of UTF-16.
pub(crate) fn is_utf16(start: &[u8]) -> bool {
    start.starts_with(b"\xff\xfe") || start.starts_with(b"\xfe\xff")
}

/// Whether a text lists parameters: each line has one name in capitals, and numbers.
pub(crate) fn is_parameters(start: &[u8]) -> bool {
    let text = String::from_utf8_lossy(&start[..start.len().min(1024)]);
    let lines = text.lines().map(str::trim);
    let mut lines = lines.filter(|line| !line.is_empty() && !line.starts_with('#'));
    let is_entry = |line: &str| {
        let cells = line.split([',', '\t', ' ']).filter(|cell| !cell.is_empty());
        let (numbers, names): (Vec<&str>, Vec<&str>) =
            cells.partition(|cell| cell.parse::<f64>().is_ok());
        let is_name = |c: char| c.is_ascii_uppercase() || c.is_ascii_digit() || c == '_';
        matches!(names[..], [name] if name.len() > 2 && name.chars().all(is_name))
            && !numbers.is_empty()
    };
    lines.next().is_some_and(is_entry) && lines.take(2).all(is_entry)
}

/// The kind of a file that is not a log and has no signature.
pub(crate) fn of_rest(start: &[u8]) -> FileKind {
    let start = &start[..start.len().min(1024)];
    // A character may be cut off at the end.
    let is_utf8 =
        std::str::from_utf8(start).map_or_else(|error| error.error_len().is_none(), |_| true);
    let is_control = |byte: &u8| *byte < 0x20 && !byte.is_ascii_whitespace();
    if !is_utf8 && start.iter().any(is_control) {
        return FileKind::BINARY;
    }
    let text = String::from_utf8_lossy(start);
    let starts = |key: &str| text.lines().any(|line| line.starts_with(key));
    let of_others = [
        "[System]",
        "Engine:",
        "FUNCTION_BLOCK",
        "<fuzzySystem",
        "<FuzzyController",
    ];
    let header = text.lines().find(|line| !line.starts_with('#'));
    let separates =
        |sign: char| header.is_some_and(|header| header.contains(sign) && !header.contains(','));
    if starts("fuzzy:") || of_others.into_iter().any(starts) {
        FileKind::RULES
    } else if starts("flagred:") {
        FileKind::PROFILE
    } else if separates(';') {
        FileKind::SEMICOLONS
    } else if separates('\t') {
        FileKind::TABS
    } else {
        FileKind::TEXT
    }
}

#[cfg(test)]
mod tests {
    #[test]
    fn kinds_are_recognised_by_their_bytes() {
        let cases: [(&[u8], Option<&str>); 9] = [
            (b"%PDF-1.7\n\xe2", Some("a PDF document")),
            (b"PK\x03\x04\x14", Some("a ZIP archive")),
            (
                b"PK\x03\x04\x14[Content_Types].xml..xl/workbook.xml",
                Some("an Excel file"),
            ),
            (b"\x1f\x8b\x08", Some("compressed by gzip")),
            (b"\xa3\x95\x80", Some("a flight log")),
            (b"\xff\xfef\0", Some("text in UTF-16")),
            (b"\xfe\0\x01", Some("an unknown binary file")),
            (b"name,ort\n1,M\xfcnchen\n", None),
            ("fuzzy: 1\nname: ä".as_bytes(), None),
        ];
        for (bytes, name) in cases {
            assert_eq!(
                crate::kind_of(bytes).map(|kind| kind.name),
                name,
                "{bytes:?}"
            );
        }
    }
}
