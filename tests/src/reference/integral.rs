//! Defuzzification of any set that is given by its degree at a point, to about 1e-13 of its range.
//!
//! The range is halved until Gauss-Legendre rules of 15 and 20 nodes agree, so that steps and kinks need not be known. Degrees
//! are never negative, so the sums lose no digits, and numbers of 64 bits suffice for them. A maximum is where the derivative of
//! an interpolation changes its sign.

use std::sync::OnceLock;

use fuzzy::model::Defuzzifier;

use super::rules::Set;

/// The value of a set, `None` of one that is 0 everywhere; NaN where it hangs on digits that no number of 64 bits has, as the maxima of two peaks of almost one
/// height do.
pub fn defuzzify(set: &Set<'_>) -> Option<f64> {
    let panels = panels(set);
    if panels.len() >= MOST_PANELS {
        return Some(f64::NAN);
    }
    if panels.iter().all(|panel| panel.area <= 0.0) {
        return None;
    }
    Some(match set.defuzzifier {
        Defuzzifier::Centroid => {
            let area: f64 = panels.iter().map(|panel| panel.area).sum();
            let moment: f64 = panels.iter().map(|panel| panel.moment).sum();
            middle(set) + moment / area
        }
        Defuzzifier::Bisector => bisector(set, &panels),
        _ => maxima(set, &panels),
    })
}

fn middle(set: &Set<'_>) -> f64 {
    0.5 * (set.low + set.high)
}

/// A stretch on which the set is smooth, or too narrow to matter.
struct Panel {
    from: f64,
    to: f64,
    area: f64,
    moment: f64,
}

/// A set that is noise, since its degrees hang on rounding, has more.
const MOST_PANELS: usize = 20_000;

const FINE: usize = 20;
const COARSE: usize = 15;

/// Nodes and weights on [-1, 1], by Newton's method on Legendre's polynomials.
fn legendre(n: usize) -> Vec<(f64, f64)> {
    let polynomial = |x: f64| {
        let (mut before, mut here) = (1.0, x);
        for k in 2..=n {
            let k = k as f64;
            (before, here) = (here, ((2.0 * k - 1.0) * x * here - (k - 1.0) * before) / k);
        }
        (here, n as f64 * (x * here - before) / (x * x - 1.0))
    };
    (0..n)
        .map(|i| {
            let mut x = (std::f64::consts::PI * (i as f64 + 0.75) / (n as f64 + 0.5)).cos();
            for _ in 0..20 {
                let (value, slope) = polynomial(x);
                x -= value / slope;
            }
            let slope = polynomial(x).1;
            (x, 2.0 / ((1.0 - x * x) * slope * slope))
        })
        .collect()
}

fn rule(n: usize) -> &'static [(f64, f64)] {
    static RULES: [OnceLock<Vec<(f64, f64)>>; 2] = [OnceLock::new(), OnceLock::new()];
    RULES[usize::from(n == FINE)].get_or_init(|| legendre(n))
}

/// Area and moment from the middle of the range.
fn integral(set: &Set<'_>, n: usize, from: f64, to: f64) -> (f64, f64) {
    let (center, half) = (0.5 * (from + to), 0.5 * (to - from));
    let mut sums = (0.0, 0.0);
    for (node, weight) in rule(n) {
        let x = center + half * node;
        let y = half * weight * (set.degree)(x);
        sums.0 += y;
        sums.1 += y * (x - middle(set));
    }
    sums
}

fn panels(set: &Set<'_>) -> Vec<Panel> {
    let width = set.high - set.low;
    let mut cuts = set.cuts.clone();
    cuts.extend((0..64).map(|i| set.low + width * f64::from(i) / 64.0));
    cuts.sort_by(f64::total_cmp);
    cuts.dedup();
    let mut open: Vec<(f64, f64)> = cuts.windows(2).map(|ends| (ends[0], ends[1])).collect();
    let whole: f64 = open
        .iter()
        .map(|(from, to)| integral(set, FINE, *from, *to).0)
        .sum();
    open.reverse();
    let mut panels = Vec::new();
    while let Some((from, to)) = open.pop()
        && panels.len() < MOST_PANELS
    {
        let fine = integral(set, FINE, from, to);
        // A kink next to an end lies beyond the last node of both rules.
        let (first, last) = (from + 0.01 * (to - from), to - 0.01 * (to - from));
        let parts = [(from, first), (first, last), (last, to)];
        let parts: f64 = parts
            .iter()
            .map(|(a, b)| integral(set, COARSE, *a, *b).0)
            .sum();
        let center = 0.5 * (from + to);
        if (fine.0 - parts).abs() <= 4e-16 * whole
            || to - from <= 1e-15 * width
            || center <= from
            || center >= to
        {
            panels.push(Panel {
                from,
                to,
                area: fine.0,
                moment: fine.1,
            });
        } else {
            open.extend([(center, to), (from, center)]);
        }
    }
    panels
}

fn bisector(set: &Set<'_>, panels: &[Panel]) -> f64 {
    let half = 0.5 * panels.iter().map(|panel| panel.area).sum::<f64>();
    let mut sum = 0.0;
    for panel in panels {
        if sum + panel.area >= half {
            let (mut from, mut to) = (panel.from, panel.to);
            for _ in 0..100 {
                let center = 0.5 * (from + to);
                if sum + integral(set, FINE, panel.from, center).0 < half {
                    from = center;
                } else {
                    to = center;
                }
            }
            return 0.5 * (from + to);
        }
        sum += panel.area;
    }
    set.high
}

/// A place or a plateau at which the set may be highest.
#[derive(Clone, Copy)]
struct Top {
    from: f64,
    to: f64,
    degree: f64,
}

fn place(x: f64, degree: f64) -> Top {
    Top {
        from: x,
        to: x,
        degree,
    }
}

fn maxima(set: &Set<'_>, panels: &[Panel]) -> f64 {
    let width = set.high - set.low;
    let narrow = 1e-11 * width;
    let mut tops: Vec<Top> = Vec::new();
    for panel in panels {
        if panel.to - panel.from <= narrow {
            let y = (set.degree)(0.5 * (panel.from + panel.to));
            tops.push(place(panel.from, y));
            tops.push(place(panel.to, y));
            continue;
        }
        let inside: Vec<(f64, f64)> = (0..=64)
            .map(|i| {
                // Just inside, past a step at the end.
                let part = (f64::from(i) / 64.0).clamp(1e-12, 1.0 - 1e-12);
                let x = panel.from + (panel.to - panel.from) * part;
                (x, (set.degree)(x))
            })
            .collect();
        let most = inside.iter().fold(0.0, |most: f64, (_, y)| most.max(*y));
        let least = inside
            .iter()
            .fold(f64::INFINITY, |least: f64, (_, y)| least.min(*y));
        if most - least <= 1e-15 * most {
            tops.push(Top {
                from: panel.from,
                to: panel.to,
                degree: most,
            });
            continue;
        }
        tops.push(place(panel.from, inside[0].1));
        tops.push(place(panel.to, inside[64].1));
        for triple in inside.windows(3) {
            let [(from, left), (_, center), (to, right)] = *triple else {
                continue;
            };
            if center >= left && center >= right {
                let x = stationary(set, panel, from, to);
                tops.push(place(x, (set.degree)(x)));
            }
        }
        // A peak next to an end, unless it is the end itself.
        for [(end, at_end), (next, _)] in [[inside[0], inside[1]], [inside[64], inside[63]]] {
            let x = stationary(set, panel, end.min(next), end.max(next));
            let y = (set.degree)(x);
            if y > at_end * (1.0 + 1e-13) {
                tops.push(place(x, y));
            }
        }
    }
    let highest = |tops: &[Top]| tops.iter().fold(0.0, |most: f64, top| most.max(top.degree));
    let about = highest(&tops) * (1.0 - 1e-6);
    for top in &mut tops {
        // Panels end about 1e-8 beside a kink.
        if top.from == top.to && top.degree >= about {
            let x = steepest(set, top.from - 1e-6 * width, top.from + 1e-6 * width);
            let degree = (set.degree)(x);
            if degree > top.degree * (1.0 + 1e-13) {
                *top = place(x, degree);
            }
        }
    }
    let highest = highest(&tops);
    let as_high_as = |factor: f64| {
        let tops = tops.iter().copied();
        tops.filter(move |top| top.degree >= highest * (1.0 - factor))
    };
    // Plateaus of several panels, and places outside of them.
    let mut plateaus: Vec<Top> = Vec::new();
    for top in as_high_as(1e-13).filter(|top| top.from < top.to) {
        match plateaus.last_mut() {
            Some(last) if top.from - last.to <= 1e-9 * width => last.to = top.to,
            _ => plateaus.push(top),
        }
    }
    plateaus.retain(|top| top.to - top.from > 1e-9 * width);
    for plateau in &mut plateaus {
        plateau.from = end_of_plateau(set, plateau.from, plateau.degree, -1.0);
        plateau.to = end_of_plateau(set, plateau.to, plateau.degree, 1.0);
    }
    let beside = |x: f64| {
        let near = |top: &Top| top.from - 1e-6 * width <= x && x <= top.to + 1e-6 * width;
        !plateaus.iter().any(near)
    };
    let mut points: Vec<f64> = Vec::new();
    for top in as_high_as(1e-13).filter(|top| beside(top.from)) {
        match points.last() {
            Some(last) if top.from - last <= 1e-10 * width => {}
            _ => points.push(top.from),
        }
    }
    // Whether another place is almost as high, farther away than a smooth top is flat.
    let all = points
        .iter()
        .copied()
        .chain(plateaus.iter().flat_map(|top| [top.from, top.to]));
    let smallest = all.clone().fold(f64::INFINITY, f64::min);
    let largest = all.fold(f64::NEG_INFINITY, f64::max);
    let far = |top: &Top| top.from < smallest - 1e-3 * width || top.to > largest + 1e-3 * width;
    let close = |pair: &[f64]| pair[1] - pair[0] < 1e-3 * width;
    if as_high_as(1e-7).any(|top| far(&top)) || points.windows(2).any(close) {
        return f64::NAN;
    }
    let mean = if plateaus.is_empty() {
        points.iter().sum::<f64>() / points.len() as f64
    } else {
        let moment: f64 = plateaus
            .iter()
            .map(|t| 0.5 * (t.from + t.to) * (t.to - t.from))
            .sum();
        moment / plateaus.iter().map(|top| top.to - top.from).sum::<f64>()
    };
    match set.defuzzifier {
        Defuzzifier::SmallestOfMaxima => smallest,
        Defuzzifier::LargestOfMaxima => largest,
        _ => mean,
    }
}

/// Where a set is highest that rises to a kink and falls from it: by trisection.
fn steepest(set: &Set<'_>, from: f64, to: f64) -> f64 {
    let (mut from, mut to) = (from.max(set.low), to.min(set.high));
    for _ in 0..100 {
        let third = (to - from) / 3.0;
        if (set.degree)(from + third) < (set.degree)(to - third) {
            from += third;
        } else {
            to -= third;
        }
    }
    0.5 * (from + to)
}

/// The plateau goes on beyond a panel's end, unless that is a cut.
fn end_of_plateau(set: &Set<'_>, end: f64, degree: f64, side: f64) -> f64 {
    if set.cuts.contains(&end) {
        return end;
    }
    let width = set.high - set.low;
    let (mut inside, mut outside) = (end, end + side * 1e-5 * width);
    for _ in 0..60 {
        let x = 0.5 * (inside + outside);
        if (set.degree)(x) >= degree * (1.0 - 1e-15) {
            inside = x;
        } else {
            outside = x;
        }
    }
    inside
}

/// Where the slope of the set changes from rising to falling, by central differences whose errors of the second and fourth order
/// are taken out.
fn stationary(set: &Set<'_>, panel: &Panel, from: f64, to: f64) -> f64 {
    let (mut from, mut to) = (from, to);
    for _ in 0..60 {
        let x = 0.5 * (from + to);
        let room = (x - panel.from).min(panel.to - x);
        let step = room.min((panel.to - panel.from) / 40.0);
        let slope = |step: f64| ((set.degree)(x + step) - (set.degree)(x - step)) / (2.0 * step);
        let (one, half, quarter) = (slope(step), slope(0.5 * step), slope(0.25 * step));
        let (first, second) = ((4.0 * half - one) / 3.0, (4.0 * quarter - half) / 3.0);
        if (16.0 * second - first) / 15.0 > 0.0 {
            from = x;
        } else {
            to = x;
        }
    }
    0.5 * (from + to)
}
