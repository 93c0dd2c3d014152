//! Which files there are to evaluate.

use std::{
    fs,
    path::{Path, PathBuf},
};

use flagred_flightlog::ReadError;

/// A file to evaluate.
pub struct Candidate {
    /// Where it is.
    pub path: PathBuf,
    /// Whether the user named it, and not only a folder that it is in, which may hold other things than flights.
    pub is_named: bool,
}

/// The files, and those in the folders and their folders, in the order of their names.
///
/// # Errors
/// A folder that cannot be read.
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
        // A link could lead back to where it came from.
        let kind = entry.file_type().map_err(unreadable)?;
        if kind.is_dir() {
            walk(&entry.path(), found)?;
        } else {
            found.push(entry.path());
        }
    }
    Ok(())
}
