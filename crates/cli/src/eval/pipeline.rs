//! One thread reads blocks of rows, several threads evaluate them, and the calling thread writes them in order. Memory
//! does not grow with the table.

use std::{
    io::{self, Write},
    sync::mpsc::{Receiver, Sender, SyncSender, channel, sync_channel},
    thread,
};

use super::{
    Plan,
    rows::{Block, Evaluator},
    tally::Tally,
};
use crate::{
    failure::Failure,
    table::{self, Reader},
};

/// The maximum number of blocks that are queued for each thread.
const WAITING: usize = 2;

/// A block after evaluation.
type BlockResult = Result<(Block, Tally), Failure>;

/// Evaluates the rows of the table and writes the results, until the table ends or `is_read` returns false.
///
/// # Errors
/// If the output cannot be written. If the table cannot be read to its end, the earlier rows are written, and the
/// inner result is the error.
pub(super) fn run<W: Write + ?Sized>(
    plan: &Plan,
    reader: Reader,
    out: &mut W,
    is_read: impl Fn(&W) -> bool,
) -> io::Result<Result<Tally, Failure>> {
    let threads = match plan.engine.model().keeps_previous() {
        // Each row depends on the row before it, so one thread evaluates all of them.
        true => 1,
        false => thread::available_parallelism().map_or(1, usize::from),
    };
    thread::scope(|scope| {
        let (spare, spares) = channel();
        // Thread `i` evaluates every n-th block, so the order of the results is known.
        let (to_threads, from_threads): (Vec<_>, Vec<_>) = (0..threads)
            .map(|_| {
                let (to_thread, blocks) = sync_channel(WAITING);
                let (done, from_thread) = sync_channel(WAITING);
                scope.spawn(move || evaluate(plan, blocks, done));
                (to_thread, from_thread)
            })
            .unzip();
        let reading = scope.spawn(move || read(plan, reader, &to_threads, &spares));
        let written = write(plan, from_threads, &spare, out, is_read);
        let read = reading.join().unwrap_or_else(|_| {
            Err(Failure::unreadable(
                "the thread that reads the points ended early",
            ))
        });
        let tally = written?;
        Ok(tally.and_then(|tally| read.map(|()| tally)))
    })
}

fn read(
    plan: &Plan,
    mut reader: Reader,
    threads: &[SyncSender<Block>],
    spares: &Receiver<Block>,
) -> Result<(), Failure> {
    for thread in threads.iter().cycle() {
        let mut block = spares.try_recv().unwrap_or_default();
        let read = block.read(&mut reader);
        let is_last = !matches!(read, Ok(true));
        let is_gone = thread.send(block).is_err();
        read.map_err(|error| table::broken(&plan.header.file, &error))?;
        if is_last || is_gone {
            break;
        }
    }
    Ok(())
}

fn evaluate(plan: &Plan, blocks: Receiver<Block>, done: SyncSender<BlockResult>) {
    let mut evaluator = Evaluator::new(plan);
    for mut block in blocks {
        let evaluated = evaluator.evaluate(&mut block);
        if done.send(evaluated.map(|tally| (block, tally))).is_err() {
            break;
        }
    }
}

fn write<W: Write + ?Sized>(
    plan: &Plan,
    threads: Vec<Receiver<BlockResult>>,
    spare: &Sender<Block>,
    out: &mut W,
    is_read: impl Fn(&W) -> bool,
) -> io::Result<Result<Tally, Failure>> {
    let mut tally = Tally::new(plan);
    for thread in threads.iter().cycle() {
        // If the next thread has no further block, the table has ended.
        match thread.recv() {
            Err(_) => break,
            Ok(Err(failure)) => return Ok(Err(failure)),
            Ok(Ok((block, of_block))) => {
                out.write_all(&block.written)?;
                tally.merge(of_block);
                // Sending fails only if reading has ended; the spare block is then not needed.
                let _ = spare.send(block);
            }
        }
        if !is_read(out) {
            break;
        }
    }
    Ok(Ok(tally))
}
