//! The motor layouts of ArduPilot's multirotor frames, by FRAME_CLASS and FRAME_TYPE.
//!
//! Source: <https://ardupilot.org/copter/docs/connect-escs-and-motors.html>. A motor on an arm
//! at the angle `a`, clockwise from the nose, rolls by `-sin(a)` and pitches by `cos(a)`. PX4
//! numbers the motors of its own frames in the same way.

/// A propeller that turns counter-clockwise pushes the nose to the right.
const CCW: f64 = 1.0;
const CW: f64 = -1.0;
/// The yaw factor of the front motors of a V frame, which have less leverage; the rear motors have 1.
const V: f64 = 0.7981;

pub(super) const QUAD: i64 = 1;
pub(super) const HEXA: i64 = 2;
pub(super) const OCTA: i64 = 3;
pub(super) const OCTAQUAD: i64 = 4;
pub(super) const Y6: i64 = 5;
pub(crate) const TRI: i64 = 7;
const DODECAHEXA: i64 = 12;
const DECA: i64 = 14;

pub(super) const PLUS: i64 = 0;
pub(super) const X: i64 = 1;
const H: i64 = 3;
const PLUS_REVERSED: i64 = 6;
pub(super) const Y6B: i64 = 10;

/// FRAME_CLASS, its name, and the number of its motors; `None` for classes that are not multirotors.
const CLASSES: &[(i64, &str, Option<u16>)] = &[
    (QUAD, "QUAD", Some(4)),
    (HEXA, "HEXA", Some(6)),
    (OCTA, "OCTA", Some(8)),
    (OCTAQUAD, "OCTAQUAD", Some(8)),
    (Y6, "Y6", Some(6)),
    (6, "HELI", None),
    (TRI, "TRI", Some(3)),
    (8, "SINGLE", None),
    (9, "COAX", None),
    (11, "HELI_DUAL", None),
    (DODECAHEXA, "DODECAHEXA", Some(12)),
    (13, "HELI_QUAD", None),
    (DECA, "DECA", Some(10)),
];

/// FRAME_TYPE and its name.
const KINDS: &[(i64, &str)] = &[
    (PLUS, "PLUS"),
    (X, "X"),
    (2, "V"),
    (H, "H"),
    (4, "VTAIL"),
    (5, "ATAIL"),
    (PLUS_REVERSED, "PLUSREV"),
    (Y6B, "Y6B"),
    (11, "Y6F"),
    (12, "BF_X"),
    (13, "DJI_X"),
    (14, "CW_X"),
    (15, "I"),
    (16, "NYT_PLUS"),
    (17, "NYT_X"),
    (18, "X_REV"),
    (19, "Y4"),
    (20, "X_COR"),
    (21, "CW_X_COR"),
];

/// Common layouts of vehicles with `motors` motors, the most common first.
pub(super) fn candidates(motors: usize) -> &'static [(i64, i64)] {
    match motors {
        3 => &[(TRI, X)],
        4 => &[
            (QUAD, X),
            (QUAD, PLUS),
            (QUAD, H),
            (QUAD, 12),
            (QUAD, 13),
            (QUAD, 14),
            (QUAD, 18),
            (QUAD, PLUS_REVERSED),
        ],
        6 => &[
            (HEXA, X),
            (HEXA, PLUS),
            (HEXA, H),
            (HEXA, 13),
            (HEXA, 14),
            (Y6, Y6B),
            (Y6, X),
            (Y6, 11),
        ],
        8 => &[
            (OCTAQUAD, X),
            (OCTA, X),
            (OCTA, PLUS),
            (OCTAQUAD, PLUS),
            (OCTAQUAD, H),
            (OCTAQUAD, 12),
            (OCTAQUAD, 14),
            (OCTAQUAD, 18),
            (OCTA, 2),
            (OCTA, H),
            (OCTA, 13),
            (OCTA, 14),
            (OCTA, 15),
        ],
        10 => &[(DECA, X), (DECA, PLUS)],
        12 => &[(DODECAHEXA, X), (DODECAHEXA, PLUS)],
        _ => &[],
    }
}

/// All combinations of class and type.
pub(super) fn frames() -> impl Iterator<Item = (i64, i64)> {
    let kinds = |class: i64| KINDS.iter().map(move |(kind, _)| (class, *kind));
    CLASSES.iter().flat_map(move |(class, ..)| kinds(*class))
}

/// Number of motors of a class.
pub(crate) fn motors_of_class(class: i64) -> Option<u16> {
    let (.., motors) = CLASSES.iter().find(|(number, ..)| *number == class)?;
    *motors
}

/// Name of a class.
pub(crate) fn name_of_class(class: i64) -> Option<&'static str> {
    let (_, name, _) = CLASSES.iter().find(|(number, ..)| *number == class)?;
    Some(name)
}

/// Name of a frame such as `QUAD/X`.
pub(super) fn name(class: i64, kind: i64) -> String {
    let class = name_of_class(class).unwrap_or_default();
    match KINDS.iter().find(|(number, _)| *number == kind) {
        Some((_, kind)) => format!("{class}/{kind}"),
        None => class.into(),
    }
}

/// Names of the types of a class that have a table.
pub(crate) fn kinds_of(class: i64) -> Vec<&'static str> {
    let kinds = KINDS
        .iter()
        .filter(|(kind, _)| layout(class, *kind).is_some());
    kinds.map(|(_, name)| *name).collect()
}

/// Class and type of a frame by its name, such as `QUAD/X`; older firmware logs only the class.
pub(crate) fn parse(name: &str) -> Option<(i64, Option<i64>)> {
    let name = name.trim().to_ascii_uppercase();
    let (class, kind) = match name.split_once(['/', ' ']) {
        Some((class, kind)) => (class, Some(kind.trim())),
        None => (name.as_str(), None),
    };
    let class = match class {
        "OCTA_QUAD" => "OCTAQUAD",
        "QUAD_X" => "QUAD",
        class => class,
    };
    let (class, ..) = CLASSES.iter().find(|(_, name, _)| *name == class)?;
    let kind = kind.and_then(|kind| match kind {
        "BF_X_REV" => Some(18),
        "X/CW_X" => Some(X),
        _ => KINDS
            .iter()
            .find(|(_, name)| *name == kind)
            .map(|(number, _)| *number),
    });
    Some((*class, kind))
}

/// The numbers of the motors of a frame and their factors; `None` for a frame without a fixed table.
pub(super) fn layout(class: i64, kind: i64) -> Option<Vec<(u16, [f64; 3])>> {
    let factors = match class {
        QUAD => quad(kind)?,
        HEXA => hexa(kind)?,
        OCTA => octa(kind)?,
        OCTAQUAD => octaquad(kind)?,
        Y6 => y6(kind),
        TRI => return Some(tri(kind)),
        DODECAHEXA => dodecahexa(kind)?,
        DECA => deca(kind)?,
        _ => return None,
    };
    Some((1..).zip(normalised(factors)).collect())
}

/// Divides the factors by the largest one of their axis.
pub(super) fn normalised(mut factors: Vec<[f64; 3]>) -> Vec<[f64; 3]> {
    for axis in 0..3 {
        let largest = factors
            .iter()
            .fold(0.0, |largest: f64, f| largest.max(f[axis].abs()));
        for factor in factors.iter_mut().filter(|_| largest > 0.0) {
            // The sine of 180 degrees is not quite 0.
            factor[axis] = (factor[axis] / largest * 1e9).round() / 1e9;
        }
    }
    factors
}

/// The factors of motors on arms at these angles, with these yaw factors.
fn arms(angles_deg: &[f64], yaw: &[f64]) -> Option<Vec<[f64; 3]>> {
    let factor = |(angle, yaw): (&f64, &f64)| {
        let (sin, cos) = angle.to_radians().sin_cos();
        [-sin, cos, *yaw]
    };
    Some(angles_deg.iter().zip(yaw).map(factor).collect())
}

fn quad(kind: i64) -> Option<Vec<[f64; 3]>> {
    const FRONT_RIGHT_FIRST: &[f64] = &[45.0, -135.0, -45.0, 135.0];
    const RIGHT_FIRST: &[f64] = &[90.0, -90.0, 0.0, 180.0];
    const BETAFLIGHT: &[f64] = &[135.0, 45.0, -135.0, -45.0];
    // A V-tail rolls with its front motors and yaws with the tilted rear ones.
    let tail = |yaw: f64| {
        let (sin, cos) = 60_f64.to_radians().sin_cos();
        let rear = 160_f64.to_radians().cos();
        Some(vec![
            [-sin, cos, 0.0],
            [0.0, rear, -yaw],
            [sin, cos, 0.0],
            [0.0, rear, yaw],
        ])
    };
    match kind {
        PLUS => arms(RIGHT_FIRST, &[CCW, CCW, CW, CW]),
        X => arms(FRONT_RIGHT_FIRST, &[CCW, CCW, CW, CW]),
        2 => arms(FRONT_RIGHT_FIRST, &[V, CCW, -V, CW]),
        H => arms(FRONT_RIGHT_FIRST, &[CW, CW, CCW, CCW]),
        4 => tail(CCW),
        5 => tail(CW),
        PLUS_REVERSED => arms(RIGHT_FIRST, &[CW, CW, CCW, CCW]),
        12 => arms(BETAFLIGHT, &[CW, CCW, CCW, CW]),
        13 => arms(&[45.0, -45.0, -135.0, 135.0], &[CCW, CW, CCW, CW]),
        14 => arms(&[45.0, 135.0, -135.0, -45.0], &[CCW, CW, CCW, CW]),
        16 => arms(RIGHT_FIRST, &[0.0; 4]),
        17 => arms(FRONT_RIGHT_FIRST, &[0.0; 4]),
        18 => arms(BETAFLIGHT, &[CCW, CW, CW, CCW]),
        19 => Some(vec![
            [-1.0, 1.0, CCW],
            [0.0, -1.0, CW],
            [0.0, -1.0, CCW],
            [1.0, 1.0, CW],
        ]),
        _ => None,
    }
}

fn hexa(kind: i64) -> Option<Vec<[f64; 3]>> {
    const IN_TURN: &[f64] = &[CCW, CW, CCW, CW, CCW, CW];
    match kind {
        PLUS => arms(
            &[0.0, 180.0, -120.0, 60.0, -60.0, 120.0],
            &[CW, CCW, CW, CCW, CCW, CW],
        ),
        X => arms(
            &[90.0, -90.0, -30.0, 150.0, 30.0, -150.0],
            &[CW, CCW, CW, CCW, CCW, CW],
        ),
        H => Some(vec![
            [-1.0, 0.0, CW],
            [1.0, 0.0, CCW],
            [1.0, 1.0, CW],
            [-1.0, -1.0, CCW],
            [-1.0, 1.0, CCW],
            [1.0, -1.0, CW],
        ]),
        13 => arms(&[30.0, -30.0, -90.0, -150.0, 150.0, 90.0], IN_TURN),
        14 => arms(&[30.0, 90.0, 150.0, -150.0, -90.0, -30.0], IN_TURN),
        _ => None,
    }
}

fn octa(kind: i64) -> Option<Vec<[f64; 3]>> {
    const OPPOSITE: &[f64] = &[CW, CW, CCW, CCW, CCW, CCW, CW, CW];
    const IN_TURN: &[f64] = &[CCW, CW, CCW, CW, CCW, CW, CCW, CW];
    match kind {
        PLUS => arms(
            &[0.0, 180.0, 45.0, 135.0, -45.0, -135.0, -90.0, 90.0],
            OPPOSITE,
        ),
        X => arms(
            &[22.5, -157.5, 67.5, 157.5, -22.5, -112.5, -67.5, 112.5],
            OPPOSITE,
        ),
        2 => Some(vec![
            [0.83, 0.34, CW],
            [-0.67, -0.32, CW],
            [0.67, -0.32, CCW],
            [-0.5, -1.0, CCW],
            [1.0, 1.0, CCW],
            [-0.83, 0.34, CCW],
            [-1.0, 1.0, CW],
            [0.5, -1.0, CW],
        ]),
        H => Some(vec![
            [-1.0, 1.0, CW],
            [1.0, -1.0, CW],
            [-1.0, 0.333, CCW],
            [-1.0, -1.0, CCW],
            [1.0, 1.0, CCW],
            [1.0, -0.333, CCW],
            [1.0, 0.333, CW],
            [-1.0, -0.333, CW],
        ]),
        13 => arms(
            &[22.5, -22.5, -67.5, -112.5, -157.5, 157.5, 112.5, 67.5],
            IN_TURN,
        ),
        14 => arms(
            &[22.5, 67.5, 112.5, 157.5, -157.5, -112.5, -67.5, -22.5],
            IN_TURN,
        ),
        15 => Some(vec![
            [0.333, -1.0, CW],
            [-0.333, 1.0, CW],
            [1.0, -1.0, CCW],
            [0.333, 1.0, CCW],
            [-0.333, -1.0, CCW],
            [-1.0, 1.0, CCW],
            [-1.0, -1.0, CW],
            [1.0, 1.0, CW],
        ]),
        _ => None,
    }
}

fn octaquad(kind: i64) -> Option<Vec<[f64; 3]>> {
    const DIAGONALS: &[f64] = &[45.0, -45.0, -135.0, 135.0, -45.0, 45.0, 135.0, -135.0];
    const CLOCKWISE: &[f64] = &[45.0, 45.0, 135.0, 135.0, -135.0, -135.0, -45.0, -45.0];
    const BETAFLIGHT: &[f64] = &[135.0, 45.0, -135.0, -45.0, 135.0, 45.0, -135.0, -45.0];
    match kind {
        PLUS => arms(
            &[0.0, -90.0, 180.0, 90.0, -90.0, 0.0, 90.0, 180.0],
            &[CCW, CW, CCW, CW, CCW, CW, CCW, CW],
        ),
        X => arms(DIAGONALS, &[CCW, CW, CCW, CW, CCW, CW, CCW, CW]),
        2 => arms(DIAGONALS, &[V, -V, CCW, CW, V, -V, CCW, CW]),
        H => arms(DIAGONALS, &[CW, CCW, CW, CCW, CW, CCW, CW, CCW]),
        12 => arms(BETAFLIGHT, &[CW, CCW, CCW, CW, CCW, CW, CW, CCW]),
        14 => arms(CLOCKWISE, &[CCW, CW, CW, CCW, CCW, CW, CW, CCW]),
        18 => arms(BETAFLIGHT, &[CCW, CW, CW, CCW, CW, CCW, CCW, CW]),
        // Both motors of an arm turn in the same direction. ArduPilot drives the upper ones at 0.9, which is ignored
        // here.
        20 => arms(DIAGONALS, &[CCW, CW, CCW, CW, CW, CCW, CW, CCW]),
        21 => arms(CLOCKWISE, &[CCW, CCW, CW, CW, CCW, CCW, CW, CW]),
        _ => None,
    }
}

fn y6(kind: i64) -> Vec<[f64; 3]> {
    match kind {
        Y6B => vec![
            [-1.0, 0.5, CW],
            [-1.0, 0.5, CCW],
            [0.0, -1.0, CW],
            [0.0, -1.0, CCW],
            [1.0, 0.5, CW],
            [1.0, 0.5, CCW],
        ],
        11 => vec![
            [0.0, -1.0, CCW],
            [-1.0, 0.5, CCW],
            [1.0, 0.5, CCW],
            [0.0, -1.0, CW],
            [-1.0, 0.5, CW],
            [1.0, 0.5, CW],
        ],
        _ => vec![
            [-1.0, 0.666, CCW],
            [1.0, 0.666, CW],
            [1.0, 0.666, CCW],
            [0.0, -1.333, CW],
            [-1.0, 0.666, CW],
            [0.0, -1.333, CCW],
        ],
    }
}

/// A tricopter yaws by a servo, so no motor has a yaw factor. Its motors are 1 (right), 2 (left) and 4 (rear).
fn tri(kind: i64) -> Vec<(u16, [f64; 3])> {
    let up = if kind == PLUS_REVERSED { -1.0 } else { 1.0 };
    vec![
        (1, [-1.0, 0.5 * up, 0.0]),
        (2, [1.0, 0.5 * up, 0.0]),
        (4, [0.0, -up, 0.0]),
    ]
}

fn dodecahexa(kind: i64) -> Option<Vec<[f64; 3]>> {
    const SPIN: &[f64] = &[CCW, CW, CW, CCW, CCW, CW, CW, CCW, CCW, CW, CW, CCW];
    let first_deg = match kind {
        PLUS => 0.0,
        X => 30.0,
        _ => return None,
    };
    let angles: Vec<f64> = (0..12)
        .map(|motor| first_deg + 60.0 * f64::from(motor / 2))
        .collect();
    arms(&angles, SPIN)
}

fn deca(kind: i64) -> Option<Vec<[f64; 3]>> {
    let first_deg = match kind {
        PLUS => 0.0,
        X | 14 => 18.0,
        _ => return None,
    };
    let angles: Vec<f64> = (0..10)
        .map(|motor| first_deg + 36.0 * f64::from(motor))
        .collect();
    arms(&angles, &[CCW, CW, CCW, CW, CCW, CW, CCW, CW, CCW, CW])
}

#[cfg(test)]
mod tests {
    use super::*;

    fn all() -> Vec<(String, Vec<[f64; 3]>)> {
        let classes = CLASSES.iter().map(|(class, ..)| *class);
        let frames = classes.flat_map(|class| KINDS.iter().map(move |(kind, _)| (class, *kind)));
        let known = frames.filter_map(|(class, kind)| {
            let layout = layout(class, kind)?;
            assert_eq!(Some(layout.len()), motors_of_class(class).map(usize::from));
            Some((
                name(class, kind),
                layout.into_iter().map(|(_, f)| f).collect(),
            ))
        });
        known.collect()
    }

    /// On a ring of equal arms the axes are independent, and each is balanced.
    #[test]
    fn ring_layouts_are_balanced_with_independent_axes() {
        let frames = all();
        assert!(frames.len() > 40, "{}", frames.len());
        let rings = frames.into_iter().filter(|(_, factors)| {
            let largest = factors.iter().map(|[_, _, yaw]| yaw.abs());
            let radius = factors.iter().map(|[roll, pitch, _]| roll.hypot(*pitch));
            let same = |mut values: Vec<f64>| {
                values.sort_by(f64::total_cmp);
                values[values.len() - 1] - values[0] < 1e-6
            };
            same(largest.collect()) && same(radius.collect())
        });
        let mut count = 0;
        for (name, factors) in rings {
            count += 1;
            for axis in 0..3 {
                let of = |axis: usize| factors.iter().map(move |f| f[axis]);
                let sum: f64 = of(axis).sum();
                assert!(sum.abs() < 1e-6, "{name}, axis {axis}: {sum}");
                for other in 0..axis {
                    let product: f64 = of(axis).zip(of(other)).map(|(a, b)| a * b).sum();
                    assert!(
                        product.abs() < 1e-6,
                        "{name}, {axis} and {other}: {product}"
                    );
                }
            }
        }
        assert!(count > 20, "{count}");
    }

    #[test]
    fn signs_are_those_of_the_motors_on_a_quad() {
        let x = layout(QUAD, X).unwrap();
        // Front right, rear left, front left, rear right.
        let signs: Vec<[f64; 3]> = x.iter().map(|(_, f)| f.map(f64::signum)).collect();
        let expected = [
            [-1.0, 1.0, 1.0],
            [1.0, -1.0, 1.0],
            [1.0, 1.0, -1.0],
            [-1.0, -1.0, -1.0],
        ];
        assert_eq!(signs, expected);
    }

    #[test]
    fn names_are_read_back() {
        for (name, class, kind) in [
            ("QUAD/X", QUAD, Some(X)),
            ("OCTAQUAD/X_REV", OCTAQUAD, Some(18)),
            ("OCTA_QUAD", OCTAQUAD, None),
            ("hexa/plus", HEXA, Some(PLUS)),
            ("DECA/X/CW_X", DECA, Some(X)),
            ("Y6", Y6, None),
        ] {
            assert_eq!(parse(name), Some((class, kind)), "{name}");
        }
        assert_eq!(parse("my quad"), None);
        assert_eq!(name(HEXA, 13), "HEXA/DJI_X");
    }
}
