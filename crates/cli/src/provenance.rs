//! The provenance step that a command writes into a rule set, with the data files.

use std::{
    fs::File,
    io::{self, BufRead as _, BufReader},
    path::{Path, PathBuf},
};

use flagred_authoring::provenance::digits;
use fuzzy::{
    Model,
    model::{DataFile, ProvenanceStep},
};
use sha2::{Digest as _, Sha256};

use crate::failure::Failure;

/// Returns the text of a rule set that a command derived from another one, with the provenance step.
pub(crate) fn rule_set(
    original_text: &str,
    model: Model,
    step: ProvenanceStep,
) -> Result<String, Failure> {
    flagred_authoring::provenance::rule_set(original_text, model, step).map_err(|findings| {
        let problems = findings.0.into_iter().map(|finding| finding.message);
        Failure::unreadable("the new rule set could not be read back, and nothing was written")
            .details(problems.collect())
            .help("check the rows for extreme values")
    })
}

/// Returns the names and hashes of data files.
pub(crate) fn data(tables: &[PathBuf]) -> Result<Vec<DataFile>, Failure> {
    tables.iter().map(|path| data_file(path)).collect()
}

fn data_file(path: &Path) -> Result<DataFile, Failure> {
    // The content of standard input and pipes cannot be read again for a hash.
    let sha256 = match path.is_file() {
        true => Some(sha256(path).map_err(|error| {
            Failure::unreadable(format!("`{}` cannot be read: {error}", path.display()))
        })?),
        false => None,
    };
    let name = path.file_name().unwrap_or(path.as_os_str());
    Ok(DataFile {
        file: name.to_string_lossy().into_owned(),
        sha256,
    })
}

fn sha256(path: &Path) -> io::Result<String> {
    let mut file = BufReader::new(File::open(path)?);
    let mut hash = Sha256::new();
    loop {
        let read = file.fill_buf()?;
        if read.is_empty() {
            return Ok(digits(&hash.finalize()));
        }
        hash.update(read);
        let length = read.len();
        file.consume(length);
    }
}
