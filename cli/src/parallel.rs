//! Work on many files: on all cores, handed over in order, in bounded memory, and with a word on how far it is.

use std::{
    collections::BTreeMap,
    io::{IsTerminal, Write},
    sync::{
        atomic::{AtomicBool, AtomicUsize, Ordering},
        mpsc,
    },
    thread,
};

/// To the start of the line, and nothing on it.
const CLEAR_LINE: &str = "\r\x1b[K";

/// Works on all items on all cores and takes the results in the order of the items, whatever came first; `take` says
/// whether to go on. Not more results than a few for each core are held at a time.
///
/// Shows how far it is on standard error where that is a terminal; `unit` is what the items are.
pub(crate) fn in_order<T: Sync, R: Send>(
    items: &[T],
    unit: &str,
    work: impl Fn(&T) -> R + Sync,
    mut take: impl FnMut(&T, R) -> bool,
) {
    let next = AtomicUsize::new(0);
    let stop = AtomicBool::new(false);
    let shown = items.len() > 1 && std::io::stderr().is_terminal();
    let threads = thread::available_parallelism().map_or(1, usize::from);
    let (send, receive) = mpsc::sync_channel(threads);
    thread::scope(|scope| {
        for _ in 0..threads.min(items.len()) {
            let (send, next, stop, work) = (send.clone(), &next, &stop, &work);
            scope.spawn(move || {
                while !stop.load(Ordering::Relaxed) {
                    let i = next.fetch_add(1, Ordering::Relaxed);
                    let Some(item) = items.get(i) else {
                        break;
                    };
                    if send.send((i, work(item))).is_err() {
                        break;
                    }
                }
            });
        }
        drop(send);
        let mut early = BTreeMap::new();
        let mut taken = 0;
        for (done, (i, result)) in receive.into_iter().enumerate() {
            early.insert(i, result);
            if shown {
                // What is taken may have something to say. Nothing is left to tell a user whose standard error is closed.
                let _ = write!(std::io::stderr(), "{CLEAR_LINE}");
            }
            while let Some(result) = early.remove(&taken) {
                let goes_on = items.get(taken).is_some_and(|item| take(item, result));
                taken += 1;
                if !goes_on {
                    stop.store(true, Ordering::Relaxed);
                }
            }
            if shown && done + 1 < items.len() {
                let _ = write!(std::io::stderr(), "{} of {} {unit}", done + 1, items.len());
            }
        }
    });
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn results_come_in_the_order_of_the_items() {
        let items: Vec<u64> = (0..200).collect();
        let mut taken = Vec::new();
        in_order(
            &items,
            "numbers",
            |item| {
                // The first ones take longest.
                thread::sleep(std::time::Duration::from_micros(200 - item));
                item * item
            },
            |item, square| {
                assert_eq!(square, item * item);
                taken.push(*item);
                true
            },
        );
        assert_eq!(taken, items);
    }

    #[test]
    fn taking_can_stop() {
        let items: Vec<u64> = (0..10_000).collect();
        let mut taken = 0;
        in_order(
            &items,
            "numbers",
            |item| *item,
            |_, item| {
                taken += u64::from(item < 10);
                item < 10
            },
        );
        assert_eq!(taken, 10);
    }
}
