//! What every picture needs, whichever command draws it: colours, texts, and round numbers along an axis.

pub(crate) mod palette;
pub(crate) mod text;

/// Round numbers within a range, its ends included, that part it into about so many pieces.
pub(crate) fn ticks(low: f64, high: f64, pieces: f64) -> Vec<f64> {
    let rough = (high - low) / pieces;
    if rough <= 0.0 || !rough.is_finite() {
        return Vec::new();
    }
    let power = 10f64.powf(rough.log10().floor());
    let steps = [1.0, 2.0, 2.5, 5.0, 10.0].map(|step| step * power);
    let step = steps
        .into_iter()
        .find(|step| *step >= rough * 0.999)
        .unwrap_or(rough);
    let first = (low / step - 1e-9).ceil() as i64;
    let last = (high / step + 1e-9).floor() as i64;
    (first..=last).map(|i| i as f64 * step).collect()
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn ticks_are_round_and_within() {
        assert_eq!(ticks(0.0, 100.0, 5.0), [0.0, 20.0, 40.0, 60.0, 80.0, 100.0]);
        assert_eq!(ticks(0.0, 100.0, 4.0), [0.0, 25.0, 50.0, 75.0, 100.0]);
        let found = ticks(0.0, 0.5, 5.0);
        assert_eq!(found.len(), 6);
        approx::assert_abs_diff_eq!(found[5], 0.5, epsilon = 1e-12);
        assert_eq!(ticks(-3.0, 9.0, 5.0), [-2.5, 0.0, 2.5, 5.0, 7.5]);
        assert_eq!(ticks(14.0, 16.8, 4.0), [14.0, 15.0, 16.0]);
        assert!(ticks(1.0, 1.0, 5.0).is_empty());
    }
}
