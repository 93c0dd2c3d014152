//! Finds the files to evaluate.

use std::{
    fs,
    path::{Path, PathBuf},
};

use flagred_flightlog::ReadError;

/// A file to evaluate.
pub struct Candidate {
    /// The path of the file.
    pub path: PathBuf,
    /// Whether the user named the file itself. If it was found in a folder, it may be something other than a flight.
    pub is_named: bool,
}

/// Returns the files that `paths` names, and all files in the folders that it names and in their subfolders. The files of
/// each named folder are sorted by path.
///
/// # Errors
/// If a folder cannot be read.
pub fn files(paths: &[PathBuf]) -> Result<Vec<Candidate>, ReadError> {
    let mut found = Vec::new();
    for path in paths {
        if path.is_dir() {
            let mut inside = Vec::new();
            walk(path, &mut inside)?;
            inside.sort();
            found.extend(inside.into_iter().map(|path| Candidate {
                path,
                is_named: false,
            }));
        } else {
            found.push(Candidate {
                path: path.clone(),
                is_named: true,
            });
        }
    }
    Ok(found)
}

fn walk(folder: &Path, found: &mut Vec<PathBuf>) -> Result<(), ReadError> {
    let unreadable = |source| ReadError::Io {
        path: folder.display().to_string(),
        source,
    };
    for entry in fs::read_dir(folder).map_err(unreadable)? {
        let entry = entry.map_err(unreadable)?;
        // `file_type` does not follow links: a link could lead back to a folder that contains it.
        let kind = entry.file_type().map_err(unreadable)?;
        if kind.is_dir() {
            walk(&entry.path(), found)?;
        } else {
            found.push(entry.path());
        }
    }
    Ok(())
}
