//! Files that are written completely or not at all, and never over an input or another output of the same command.

use std::{
    fs::{self, File, Metadata, OpenOptions},
    io::{self, BufWriter, ErrorKind, Write},
    path::{Path, PathBuf},
};

use super::{Stdout, is_standard};
use crate::failure::Failure;

/// Maximum number of symbolic links that are followed, as in Linux.
const LINKS: usize = 40;

/// Whether an existing file is replaced.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub(crate) enum Replace {
    /// The content is derived from other files and can be regenerated.
    Yes,
    /// The file may be written by hand: it is replaced only with `--force`.
    No,
}

impl Replace {
    /// Returns the variant for the value of `--force`.
    pub(crate) fn forced(force: bool) -> Replace {
        if force { Replace::Yes } else { Replace::No }
    }
}

/// The destination of an output.
pub(crate) struct Output {
    named: PathBuf,
    destination: Destination,
}

enum Destination {
    Stdout,
    /// A device, a FIFO or a socket: it is written to and never replaced.
    Special,
    /// The path of the file after all symbolic links are resolved.
    File(PathBuf, Replace),
}

/// Identifies a file, whatever path leads to it.
#[derive(Debug, PartialEq, Eq)]
enum Identity {
    /// Device and inode.
    #[cfg(unix)]
    Node(u64, u64),
    /// The full path, with symbolic links resolved: for a file that does not exist yet, and for all files except on Unix.
    Path(PathBuf),
}

/// The files that a command reads and writes.
#[derive(Default)]
pub(crate) struct Files {
    known: Vec<FileUse>,
    /// Whether an output is `-`.
    stdout_is_taken: bool,
}

struct FileUse {
    identity: Identity,
    /// The name of the file for messages.
    shown: String,
    role: &'static str,
}

impl Files {
    /// Registers the inputs; `-` is standard input.
    ///
    /// # Errors
    ///
    /// If standard output is redirected to an input.
    pub(crate) fn reading<P: AsRef<Path>>(
        inputs: impl IntoIterator<Item = P>,
    ) -> Result<Files, Failure> {
        let mut files = Files::default();
        for input in inputs {
            let input = input.as_ref();
            // An input that is not a regular file, or cannot be read, is not registered: an output with that name
            // would not replace it.
            files.known.extend(of_input(input).map(|identity| FileUse {
                identity,
                shown: format!("`{}`", input.display()),
                role: "an input",
            }));
        }
        if let Some(stdout) = standard(Stream::Output) {
            files.claim(stdout, "standard output".to_owned())?;
        }
        Ok(files)
    }

    /// Registers an output; `-` is standard output.
    ///
    /// # Errors
    ///
    /// If the output is an input or another output, exists and must not be replaced, or cannot be written.
    pub(crate) fn output(&mut self, named: &Path, replace: Replace) -> Result<Output, Failure> {
        let shown = format!("`{}`", named.display());
        let output = |destination| Output {
            named: named.to_owned(),
            destination,
        };
        if is_standard(named) {
            if std::mem::replace(&mut self.stdout_is_taken, true) {
                return Err(Failure::usage("two outputs are `-`, standard output")
                    .help("name a file for one of them"));
            }
            // Standard output was compared with the inputs at the start.
            return Ok(output(Destination::Stdout));
        }
        let failed = |error: &io::Error| cannot_write(named, error);
        let found = match fs::metadata(named) {
            Ok(found) => Some(found),
            Err(error) if error.kind() == ErrorKind::NotFound => None,
            Err(error) => return Err(failed(&error)),
        };
        let target = target(named).map_err(|error| failed(&error))?;
        let same = match &found {
            None => Some(Identity::Path(target.clone())),
            Some(found) => identity(&target, found),
        };
        if let Some(same) = same {
            self.claim(same, shown.clone())?;
        }
        let Some(found) = found else {
            return Ok(output(Destination::File(target, replace)));
        };
        if found.is_dir() {
            return Err(Failure::usage(format!("{shown} is a folder")).help("name a file in it"));
        }
        if !found.is_file() {
            return Ok(output(Destination::Special));
        }
        if replace == Replace::No {
            return Err(exists(named));
        }
        // A file without write permission is not replaced.
        let opened = OpenOptions::new().write(true).open(&target);
        opened.map_err(|error| failed(&error))?;
        Ok(output(Destination::File(target, replace)))
    }

    /// Like [`Files::output`], for an optional output, which replaces an existing file.
    pub(crate) fn optional(&mut self, named: Option<&PathBuf>) -> Result<Option<Output>, Failure> {
        let output = named.map(|named| self.output(named, Replace::Yes));
        output.transpose()
    }

    fn claim(&mut self, identity: Identity, shown: String) -> Result<(), Failure> {
        if let Some(other) = self.known.iter().find(|known| known.identity == identity) {
            let FileUse {
                shown: other, role, ..
            } = other;
            let message = match shown == *other {
                true => format!("{shown} cannot be written: it is also {role}"),
                false => format!(
                    "{shown} cannot be written: it is the same file as {other}, which is {role}"
                ),
            };
            return Err(Failure::usage(message).help("name another file to write"));
        }
        self.known.push(FileUse {
            identity,
            shown,
            role: "another output",
        });
        Ok(())
    }
}

impl Output {
    pub(crate) fn is_stdout(&self) -> bool {
        matches!(self.destination, Destination::Stdout)
    }

    pub(crate) fn write(&self, text: &str) -> Result<(), Failure> {
        self.write_with(|out| out.write_all(text.as_bytes()))
    }

    /// Writes the output of `fill`. A file is written completely or not at all: a temporary file in the same folder is
    /// written, synced, and then renamed.
    pub(crate) fn write_with(
        &self,
        fill: impl FnOnce(&mut dyn Write) -> io::Result<()>,
    ) -> Result<(), Failure> {
        let failed = |error: io::Error| cannot_write(&self.named, &error);
        match &self.destination {
            Destination::Stdout => {
                let mut out = Stdout::data();
                fill(&mut out)?;
                out.finish()
            }
            Destination::Special => {
                let written = open_special(&self.named).and_then(|special| {
                    let mut out = BufWriter::new(special);
                    fill(&mut out)?;
                    out.flush()
                });
                match written {
                    // The reader closed the pipe.
                    Err(error) if error.kind() == ErrorKind::BrokenPipe => Ok(()),
                    written => written.map_err(failed),
                }
            }
            Destination::File(target, replace) => {
                write_file(target, *replace, fill).map_err(|error| match error.kind() {
                    ErrorKind::AlreadyExists => exists(&self.named),
                    _ => failed(error),
                })
            }
        }
    }
}

/// Writes several texts: files, then devices, then standard output, which may block. If one text cannot be written, the
/// others are still written.
///
/// # Errors
///
/// The first failure, if there is one.
pub(crate) fn write_all(mut texts: Vec<(&Output, String)>) -> Result<(), Failure> {
    texts.sort_by_key(|(output, _)| match output.destination {
        Destination::File(..) => 0,
        Destination::Special => 1,
        Destination::Stdout => 2,
    });
    let mut failed = None;
    for (output, text) in texts {
        let written = output.write(&text);
        failed = failed.or(written.err());
    }
    failed.map_or(Ok(()), Err)
}

/// Creates a file to which data is appended over time. An existing file is refused; an existing device is opened.
pub(crate) fn new_file(named: &Path) -> Result<File, Failure> {
    let special = fs::metadata(named).is_ok_and(|found| !found.is_file() && !found.is_dir());
    let opened = match special {
        true => OpenOptions::new().write(true).open(named),
        false => File::create_new(named),
    };
    opened.map_err(|error| match error.kind() {
        ErrorKind::AlreadyExists => {
            Failure::usage(format!("`{}` exists already", named.display())).help("name a new file")
        }
        _ => cannot_write(named, &error),
    })
}

/// Returns whether a file can be replaced, that is, whether a new file can be written to its folder.
pub(crate) fn can_replace(path: &Path) -> bool {
    let target = target(path).ok();
    let folder = target.as_deref().and_then(Path::parent);
    folder.is_some_and(|folder| draft().tempfile_in(folder).is_ok())
}

fn draft() -> tempfile::Builder<'static, 'static> {
    let mut draft = tempfile::Builder::new();
    draft.prefix(".flagred-").suffix(".part");
    // Mode of a new file, reduced by the umask.
    #[cfg(unix)]
    draft.permissions(std::os::unix::fs::PermissionsExt::from_mode(0o666));
    draft
}

fn write_file(
    target: &Path,
    replace: Replace,
    fill: impl FnOnce(&mut dyn Write) -> io::Result<()>,
) -> io::Result<()> {
    let folder = target.parent().unwrap_or(Path::new("/"));
    let draft = draft().tempfile_in(folder)?;
    let mut out = BufWriter::new(draft.as_file());
    fill(&mut out)?;
    out.flush()?;
    drop(out);
    if let Ok(old) = fs::metadata(target) {
        keep(draft.as_file(), &old)?;
    }
    draft.as_file().sync_all()?;
    match replace {
        Replace::Yes => draft.persist(target)?,
        Replace::No => draft.persist_noclobber(target)?,
    };
    Ok(())
}

/// Gives a file the owner and mode of the file that it replaces.
fn keep(draft: &File, old: &Metadata) -> io::Result<()> {
    #[cfg(unix)]
    {
        use std::os::unix::fs::{MetadataExt, fchown};
        let new = draft.metadata()?;
        if (new.uid(), new.gid()) != (old.uid(), old.gid()) {
            match fchown(draft, Some(old.uid()), Some(old.gid())) {
                // Only root may change owners. Another user's file then belongs to the current user, as with any editor.
                Err(error) if error.kind() == ErrorKind::PermissionDenied => {}
                other => other?,
            }
        }
    }
    draft.set_permissions(old.permissions())
}

/// Resolves all symbolic links, even if the target does not exist yet.
fn target(path: &Path) -> io::Result<PathBuf> {
    let mut path = path.to_owned();
    for _ in 0..LINKS {
        if let Ok(full) = path.canonicalize() {
            return Ok(full);
        }
        let folder = match path.parent() {
            Some(folder) if folder != Path::new("") => folder.canonicalize()?,
            _ => Path::new(".").canonicalize()?,
        };
        let Some(name) = path.file_name() else {
            return Err(ErrorKind::NotFound.into());
        };
        let full = folder.join(name);
        match full.read_link() {
            Ok(link) => path = folder.join(link),
            Err(_) => return Ok(full),
        }
    }
    Err(io::Error::other("too many links"))
}

/// Returns the identity of an input, which may be `-`; `None` if it is not a regular file or cannot be read.
fn of_input(input: &Path) -> Option<Identity> {
    match is_standard(input) {
        true => standard(Stream::Input),
        false => identity(input, &fs::metadata(input).ok()?),
    }
}

/// Returns the first input that an earlier path in the list also leads to.
pub(crate) fn repeated(inputs: &[PathBuf]) -> Option<&PathBuf> {
    let identity = |input: &PathBuf| {
        let path = || Identity::Path(input.canonicalize().unwrap_or_else(|_| input.clone()));
        of_input(input).unwrap_or_else(path)
    };
    let mut known = Vec::new();
    inputs.iter().find(|input| {
        let identity = identity(input);
        let is_known = known.contains(&identity);
        known.push(identity);
        is_known
    })
}

/// Returns the identity of a regular file; `None` for anything else.
#[cfg(unix)]
fn identity(_: &Path, found: &Metadata) -> Option<Identity> {
    use std::os::unix::fs::MetadataExt;
    let node = || Identity::Node(found.dev(), found.ino());
    found.is_file().then(node)
}

#[cfg(not(unix))]
fn identity(path: &Path, found: &Metadata) -> Option<Identity> {
    let full = path.canonicalize().ok().filter(|_| found.is_file());
    full.map(Identity::Path)
}

enum Stream {
    Input,
    Output,
}

/// Returns the file that a standard stream is redirected to.
#[cfg(unix)]
fn standard(stream: Stream) -> Option<Identity> {
    use std::os::fd::AsFd;
    let owned = match stream {
        Stream::Input => io::stdin().as_fd().try_clone_to_owned(),
        Stream::Output => io::stdout().as_fd().try_clone_to_owned(),
    };
    let found = File::from(owned.ok()?).metadata().ok()?;
    identity(Path::new("-"), &found)
}

#[cfg(not(unix))]
fn standard(_: Stream) -> Option<Identity> {
    None
}

/// Opens a device or a FIFO, or connects to a socket.
fn open_special(path: &Path) -> io::Result<Box<dyn Write>> {
    #[cfg(unix)]
    {
        use std::os::unix::{fs::FileTypeExt, net::UnixStream};
        if fs::metadata(path)?.file_type().is_socket() {
            return Ok(Box::new(UnixStream::connect(path)?));
        }
    }
    Ok(Box::new(OpenOptions::new().write(true).open(path)?))
}

fn exists(named: &Path) -> Failure {
    Failure::usage(format!("`{}` exists already", named.display()))
        .help("name another file, or replace this one with `--force`")
}

pub(super) fn cannot_write(named: &Path, error: &io::Error) -> Failure {
    let failure = Failure::usage(format!("`{}` cannot be written: {error}", named.display()));
    match error.kind() {
        ErrorKind::NotFound | ErrorKind::PermissionDenied => {
            failure.help("check that its folder exists and can be written to")
        }
        ErrorKind::StorageFull | ErrorKind::QuotaExceeded | ErrorKind::FileTooLarge => {
            failure.help("free some disk space, then run the command again")
        }
        _ => failure,
    }
}
