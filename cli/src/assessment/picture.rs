//! A small picture of a value over time, for the terminal: one column is the highest value of its span.

use std::fmt::Write as _;

/// Eighths of a character cell, from empty to full.
const EIGHTHS: [char; 9] = [' ', '▁', '▂', '▃', '▄', '▅', '▆', '▇', '█'];

/// Rows of the picture.
const ROWS: usize = 5;

/// Draws `points` (time in seconds, value in percent or unknown) `width` columns wide.
///
/// A column stands for an equal span of time and shows the highest value in it, so that no peak is lost;
/// `·` marks spans in which the value is unknown, and a blank one in which there was no step at all.
pub(crate) fn over_time(points: &[(f64, Option<f64>)], width: usize) -> String {
    let (Some(first), Some(last)) = (points.first(), points.last()) else {
        return String::new();
    };
    let (start_s, span_s) = (first.0, (last.0 - first.0).max(f64::MIN_POSITIVE));
    let mut columns: Vec<Option<Option<f64>>> = vec![None; width];
    for &(t_s, value) in points {
        let column = ((t_s - start_s) / span_s * width as f64) as usize;
        if let Some(cell) = columns.get_mut(column.min(width.saturating_sub(1))) {
            let known = cell.flatten();
            *cell = Some(match (known, value) {
                (Some(a), Some(b)) => Some(a.max(b)),
                (a, b) => a.or(b),
            });
        }
    }

    let mut text = String::new();
    for row in (0..ROWS).rev() {
        let label = match row {
            r if r + 1 == ROWS => "100 % ┤",
            0 => "  0 % ┤",
            _ => "      │",
        };
        let line: String = columns.iter().map(|&column| cell(column, row)).collect();
        let _ = writeln!(text, "{label}{}", line.trim_end());
    }
    let (from, to) = (
        format!("{start_s:.0} s"),
        format!("{:.0} s", start_s + span_s),
    );
    let _ = writeln!(text, "      └{}", "─".repeat(width));
    let _ = writeln!(
        text,
        "       {from}{to:>rest$}",
        rest = width.saturating_sub(from.chars().count())
    );
    text
}

/// The character of one column in one row, counted from the bottom.
fn cell(column: Option<Option<f64>>, row: usize) -> char {
    match column {
        None => ' ',
        Some(None) if row == 0 => '·',
        Some(None) => ' ',
        Some(Some(percent)) => {
            // At least one eighth: a risk of 0 is known, and looks known.
            let eighths = ((percent / 100.0 * (ROWS * 8) as f64).round() as usize).max(1);
            EIGHTHS[eighths.saturating_sub(row * 8).min(8)]
        }
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn a_peak_of_one_step_is_seen_and_the_unknown_is_marked() {
        let mut points: Vec<(f64, Option<f64>)> =
            (0..400).map(|i| (i as f64 * 0.1, Some(10.0))).collect();
        points[200].1 = Some(100.0);
        for point in &mut points[..40] {
            point.1 = None;
        }
        insta::assert_snapshot!(over_time(&points, 40), @r"
        100 % ┤                    █
              │                    █
              │                    █
              │                    █
          0 % ┤····▄▄▄▄▄▄▄▄▄▄▄▄▄▄▄▄█▄▄▄▄▄▄▄▄▄▄▄▄▄▄▄▄▄▄▄
              └────────────────────────────────────────
               0 s                                 40 s
        ");
    }

    #[test]
    fn nothing_to_draw_is_nothing() {
        assert_eq!(over_time(&[], 40), "");
        assert!(over_time(&[(3.0, Some(50.0))], 10).contains("3 s"));
    }
}
