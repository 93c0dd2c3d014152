//! A sliding window over a stream: readers process slices, and memory is bounded.

use std::io::{self, BufRead, Read};

/// The size of the window in bytes; every record of every format is much shorter.
const WINDOW: usize = 1 << 18;

pub(crate) struct Input<'r> {
    source: Box<dyn Read + 'r>,
    buffer: Vec<u8>,
    start: usize,
    end: usize,
    taken: u64,
    /// The last consumed byte.
    last: Option<u8>,
    at_end: bool,
    /// Whether the source is compressed. Compressed data may end early or be damaged; the data before that is used.
    compressed: bool,
    failure: Option<String>,
}

impl<'r> Input<'r> {
    pub(crate) fn new(source: Box<dyn Read + 'r>, compressed: bool) -> Self {
        Self {
            source,
            buffer: vec![0; WINDOW],
            start: 0,
            end: 0,
            taken: 0,
            last: None,
            at_end: false,
            compressed,
            failure: None,
        }
    }

    /// Fills the window and returns it, with `true` if it contains all remaining bytes.
    pub(crate) fn window(&mut self) -> io::Result<(&[u8], bool)> {
        self.buffer.copy_within(self.start..self.end, 0);
        self.end -= self.start;
        self.start = 0;
        while self.end < WINDOW && !self.at_end {
            self.read_more()?;
        }
        Ok((&self.buffer[..self.end], self.at_end))
    }

    /// Passes windows to `scan`, with `true` at the end of the log. `scan` returns the number of
    /// bytes that it processed: at least one of every window and, at the end of the log, as many as
    /// it can use.
    pub(crate) fn scan(&mut self, mut scan: impl FnMut(&[u8], bool) -> usize) -> io::Result<()> {
        loop {
            let (window, at_end) = self.window()?;
            let used = scan(window, at_end);
            self.consume(used);
            if at_end || used == 0 {
                return Ok(());
            }
        }
    }

    fn read_more(&mut self) -> io::Result<()> {
        match self.source.read(&mut self.buffer[self.end..]) {
            Ok(0) => self.at_end = true,
            Ok(read) => self.end += read,
            Err(error) if error.kind() == io::ErrorKind::Interrupted => {}
            Err(error) if self.compressed => {
                self.failure = Some(format!("the gzip file is truncated or damaged ({error})"));
                self.at_end = true;
            }
            Err(error) => return Err(error),
        }
        Ok(())
    }

    /// The number of bytes consumed so far.
    pub(crate) fn taken(&self) -> u64 {
        self.taken
    }

    /// Whether the bytes consumed so far end with a line end.
    pub(crate) fn is_at_line_end(&self) -> bool {
        matches!(self.last, None | Some(b'\n' | b'\r'))
    }

    /// The reason why the stream ended early; `None` if it did not.
    pub(crate) fn failure(&self) -> Option<&str> {
        self.failure.as_deref()
    }

    /// The rest of the stream, starting with the bytes in the window.
    pub(crate) fn into_rest(self) -> impl Read + 'r {
        let seen = io::Cursor::new(self.buffer[self.start..self.end].to_vec());
        seen.chain(self.source)
    }
}

impl Read for Input<'_> {
    fn read(&mut self, to: &mut [u8]) -> io::Result<usize> {
        let from = self.fill_buf()?;
        let count = from.len().min(to.len());
        to[..count].copy_from_slice(&from[..count]);
        self.consume(count);
        Ok(count)
    }
}

impl BufRead for Input<'_> {
    fn fill_buf(&mut self) -> io::Result<&[u8]> {
        if self.start == self.end && !self.at_end {
            self.start = 0;
            self.end = 0;
            while self.end == 0 && !self.at_end {
                self.read_more()?;
            }
        }
        Ok(&self.buffer[self.start..self.end])
    }

    fn consume(&mut self, count: usize) {
        let count = count.min(self.end - self.start);
        self.start += count;
        self.taken += count as u64;
        if count > 0 {
            self.last = self.buffer.get(self.start - 1).copied();
        }
    }
}
