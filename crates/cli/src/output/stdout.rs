//! Standard output, whose reader may close it at any time.

use std::io::{self, BufWriter, StderrLock, StdoutLock, Write};

use anstream::{AutoStream, ColorChoice};

use crate::failure::Failure;

/// Standard output. If the reader closes the pipe, the command continues with the same exit code, and further output is
/// dropped.
pub(crate) struct Stdout(BufWriter<Pipe>);

struct Pipe {
    stream: Stream,
    is_closed: bool,
}

enum Stream {
    Out(AutoStream<StdoutLock<'static>>),
    Err(AutoStream<StderrLock<'static>>),
}

impl Stdout {
    /// Output for people: coloured if standard output is a terminal that supports it.
    pub(crate) fn text() -> Stdout {
        Stdout::new(Stream::Out(anstream::stdout().lock()))
    }

    /// Output for people, on standard error if standard output receives a document.
    pub(crate) fn beside(documents: &[&super::Output]) -> Stdout {
        if documents.iter().any(|output| output.is_stdout()) {
            Stdout::new(Stream::Err(anstream::stderr().lock()))
        } else {
            Stdout::text()
        }
    }

    /// Output for programs: bytes are written unchanged.
    pub(crate) fn data() -> Stdout {
        let lock = io::stdout().lock();
        Stdout::new(Stream::Out(AutoStream::new(lock, ColorChoice::AlwaysAnsi)))
    }

    fn new(stream: Stream) -> Stdout {
        let is_closed = false;
        Stdout(BufWriter::new(Pipe { stream, is_closed }))
    }

    /// Returns whether the reader has closed the pipe.
    pub(crate) fn is_closed(&self) -> bool {
        self.0.get_ref().is_closed
    }

    /// Flushes the buffer.
    pub(crate) fn finish(mut self) -> Result<(), Failure> {
        Ok(self.0.flush()?)
    }
}

impl Write for Stdout {
    fn write(&mut self, bytes: &[u8]) -> io::Result<usize> {
        self.0.write(bytes)
    }

    fn flush(&mut self) -> io::Result<()> {
        self.0.flush()
    }
}

impl Pipe {
    fn ignore_closed_pipe<T>(&mut self, result: io::Result<T>, dropped: T) -> io::Result<T> {
        match result {
            Err(error) if error.kind() == io::ErrorKind::BrokenPipe => {
                self.is_closed = true;
                Ok(dropped)
            }
            other => other,
        }
    }
}

impl Write for Pipe {
    fn write(&mut self, bytes: &[u8]) -> io::Result<usize> {
        if self.is_closed {
            return Ok(bytes.len());
        }
        let written = match &mut self.stream {
            Stream::Out(out) => out.write(bytes),
            Stream::Err(err) => err.write(bytes),
        };
        self.ignore_closed_pipe(written, bytes.len())
    }

    fn flush(&mut self) -> io::Result<()> {
        if self.is_closed {
            return Ok(());
        }
        let flushed = match &mut self.stream {
            Stream::Out(out) => out.flush(),
            Stream::Err(err) => err.flush(),
        };
        self.ignore_closed_pipe(flushed, ())
    }
}
