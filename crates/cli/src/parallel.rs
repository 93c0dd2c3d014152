//! Work on many files: on all cores, with results in order, in bounded memory, with a progress bar.

use indicatif::{ProgressBar, ProgressStyle};
use rayon::prelude::*;

/// Processes all items on all cores, and passes the results to `take` in the order of the items, until it returns
/// false. Only the results of a few items per core are kept at a time.
///
/// Shows a progress bar on standard error if that is a terminal; `unit` names the items.
pub(crate) fn in_order<T: Sync, R: Send>(
    items: &[T],
    unit: &'static str,
    work: impl Fn(&T) -> R + Sync,
    mut take: impl FnMut(&T, R) -> bool,
) {
    let progress = progress(items.len(), unit);
    for block in items.chunks(rayon::current_num_threads() * 4) {
        let results: Vec<R> = block
            .par_iter()
            .map(|item| {
                let result = work(item);
                progress.inc(1);
                result
            })
            .collect();
        let goes_on = progress.suspend(|| {
            let mut results = block.iter().zip(results);
            results.all(|(item, result)| take(item, result))
        });
        if !goes_on {
            break;
        }
    }
    progress.finish_and_clear();
}

/// A progress bar; hidden for a single item, or if standard error is not a terminal.
pub(crate) fn progress(items: usize, unit: &'static str) -> ProgressBar {
    if items < 2 {
        return ProgressBar::hidden();
    }
    let style = ProgressStyle::with_template(&format!("{{pos}} of {{len}} {unit} {{wide_bar}}"));
    let bar = ProgressBar::new(items as u64);
    match style {
        Ok(style) => bar.with_style(style),
        Err(_) => bar,
    }
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
                // The first items take longest.
                std::thread::sleep(std::time::Duration::from_micros(200 - item));
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
    fn the_consumer_can_stop_early() {
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
