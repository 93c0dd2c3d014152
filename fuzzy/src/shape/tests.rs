//! Tables of degrees computed by hand, and the messages for invalid parameters.

use super::{MembershipFunction, straight::along};
use alloc::{string::ToString, vec};

const INFINITY: f64 = f64::INFINITY;
const NEG_INFINITY: f64 = f64::NEG_INFINITY;
const NAN: f64 = f64::NAN;

/// Compares the degrees at the given values; each row is x and the exact degree.
fn table(shape: MembershipFunction, rows: &[(f64, f64)]) {
    shape.validate().unwrap();
    for &(x, degree) in rows {
        let got = shape.membership(x);
        assert!(
            (got - degree).abs() <= 1e-15,
            "{shape:?} at {x}: {got} instead of {degree}"
        );
    }
    assert_eq!(shape.membership(NAN), 0.0, "{shape:?}");
    if let Some(corners) = shape.corners() {
        for &(x, _) in rows {
            assert_eq!(
                along(corners.iter().copied(), x),
                shape.membership(x),
                "{shape:?} at {x}"
            );
        }
    }
}

#[test]
fn triangle() {
    let shape = |left, peak, right| MembershipFunction::Triangle { left, peak, right };
    table(
        shape(0.0, 1.0, 3.0),
        &[
            (NEG_INFINITY, 0.0),
            (-1.0, 0.0),
            (0.0, 0.0),
            (0.25, 0.25),
            (1.0, 1.0),
            (2.0, 0.5),
            (2.5, 0.25),
            (3.0, 0.0),
            (4.0, 0.0),
            (INFINITY, 0.0),
        ],
    );
    // A vertical edge at the peak: 1 at the peak, 0 beyond it.
    table(
        shape(0.0, 0.0, 0.1),
        &[(-1e-300, 0.0), (0.0, 1.0), (0.05, 0.5), (0.1, 0.0)],
    );
    table(
        shape(0.0, 2.0, 2.0),
        &[(0.0, 0.0), (1.0, 0.5), (2.0, 1.0), (2.5, 0.0)],
    );
    table(shape(1.0, 1.0, 1.0), &[(0.5, 0.0), (1.0, 1.0), (1.5, 0.0)]);
}

#[test]
fn trapezoid_and_shoulders() {
    table(
        MembershipFunction::Trapezoid {
            left: 0.0,
            left_top: 2.0,
            right_top: 3.0,
            right: 7.0,
        },
        &[
            (NEG_INFINITY, 0.0),
            (0.0, 0.0),
            (0.5, 0.25),
            (2.0, 1.0),
            (2.5, 1.0),
            (3.0, 1.0),
            (4.0, 0.75),
            (7.0, 0.0),
            (INFINITY, 0.0),
        ],
    );
    table(
        MembershipFunction::Trapezoid {
            left: 1.0,
            left_top: 1.0,
            right_top: 2.0,
            right: 2.0,
        },
        &[(0.9, 0.0), (1.0, 1.0), (1.5, 1.0), (2.0, 1.0), (2.1, 0.0)],
    );
    table(
        MembershipFunction::LeftShoulder {
            top: 1.0,
            foot: 3.0,
        },
        &[
            (NEG_INFINITY, 1.0),
            (0.0, 1.0),
            (1.0, 1.0),
            (2.5, 0.25),
            (3.0, 0.0),
            (INFINITY, 0.0),
        ],
    );
    table(
        MembershipFunction::LeftShoulder {
            top: 1.0,
            foot: 1.0,
        },
        &[(0.0, 1.0), (1.0, 1.0), (1.1, 0.0)],
    );
    table(
        MembershipFunction::RightShoulder {
            foot: 1.0,
            top: 3.0,
        },
        &[
            (NEG_INFINITY, 0.0),
            (1.0, 0.0),
            (1.5, 0.25),
            (3.0, 1.0),
            (INFINITY, 1.0),
        ],
    );
    table(
        MembershipFunction::RightShoulder {
            foot: 1.0,
            top: 1.0,
        },
        &[(0.9, 0.0), (1.0, 1.0), (2.0, 1.0)],
    );
}

#[test]
fn rectangle_singleton_piecewise_constant() {
    table(
        MembershipFunction::Rectangle {
            left: 1.0,
            right: 2.0,
        },
        &[
            (NEG_INFINITY, 0.0),
            (0.9, 0.0),
            (1.0, 1.0),
            (2.0, 1.0),
            (2.1, 0.0),
            (INFINITY, 0.0),
        ],
    );
    table(
        MembershipFunction::Singleton { at: 1.0 },
        &[
            (NEG_INFINITY, 0.0),
            (0.9, 0.0),
            (1.0, 1.0),
            (1.1, 0.0),
            (INFINITY, 0.0),
        ],
    );
    // A rise, a step down at which the higher degree counts, a step up, and beyond the last point a constant degree.
    table(
        MembershipFunction::Piecewise {
            points: vec![
                (0.0, 0.25),
                (1.0, 0.75),
                (1.0, 0.5),
                (2.0, 0.0),
                (2.0, 1.0),
                (4.0, 0.5),
            ],
        },
        &[
            (NEG_INFINITY, 0.25),
            (0.0, 0.25),
            (0.5, 0.5),
            (1.0, 0.75),
            (1.5, 0.25),
            (2.0, 1.0),
            (3.0, 0.75),
            (4.0, 0.5),
            (INFINITY, 0.5),
        ],
    );
    table(
        MembershipFunction::Constant { value: 0.3 },
        &[(NEG_INFINITY, 0.3), (0.0, 0.3), (INFINITY, 0.3)],
    );
}

#[test]
fn gaussians() {
    let at_one_sd = 0.606_530_659_712_633_4; // exp(-1/2)
    let at_two_sd = 0.135_335_283_236_612_7; // exp(-2)
    table(
        MembershipFunction::Gaussian { mean: 1.0, sd: 2.0 },
        &[
            (NEG_INFINITY, 0.0),
            (-3.0, at_two_sd),
            (-1.0, at_one_sd),
            (1.0, 1.0),
            (3.0, at_one_sd),
            (5.0, at_two_sd),
            (INFINITY, 0.0),
        ],
    );
    table(
        MembershipFunction::Gaussian2 {
            left_mean: 1.0,
            left_sd: 0.5,
            right_mean: 2.0,
            right_sd: 3.0,
        },
        &[
            (NEG_INFINITY, 0.0),
            (0.5, at_one_sd),
            (1.0, 1.0),
            (1.5, 1.0),
            (2.0, 1.0),
            (5.0, at_one_sd),
            (8.0, at_two_sd),
            (INFINITY, 0.0),
        ],
    );
    // `left_mean` is above `right_mean`, so the degree is the product of both halves. The middle is one deviation from
    // each mean.
    table(
        MembershipFunction::Gaussian2 {
            left_mean: 2.0,
            left_sd: 0.5,
            right_mean: 1.0,
            right_sd: 0.5,
        },
        &[
            (NEG_INFINITY, 0.0),
            (1.0, at_two_sd),
            (1.5, at_one_sd * at_one_sd),
            (2.0, at_two_sd),
            (INFINITY, 0.0),
        ],
    );
}

#[test]
fn parts_of_ellipses() {
    // By the Pythagorean theorem, with sides 3, 4 and 5.
    table(
        MembershipFunction::SemiEllipse {
            left: -5.0,
            right: 5.0,
        },
        &[
            (NEG_INFINITY, 0.0),
            (-5.0, 0.0),
            (-4.0, 0.6),
            (-3.0, 0.8),
            (0.0, 1.0),
            (3.0, 0.8),
            (5.0, 0.0),
            (INFINITY, 0.0),
        ],
    );
    table(
        MembershipFunction::Arc {
            start: 0.0,
            end: 5.0,
        },
        &[
            (NEG_INFINITY, 0.0),
            (0.0, 0.0),
            (1.0, 0.6),
            (2.0, 0.8),
            (5.0, 1.0),
            (INFINITY, 1.0),
        ],
    );
    table(
        MembershipFunction::Arc {
            start: 5.0,
            end: 0.0,
        },
        &[
            (NEG_INFINITY, 1.0),
            (0.0, 1.0),
            (3.0, 0.8),
            (4.0, 0.6),
            (5.0, 0.0),
            (INFINITY, 0.0),
        ],
    );
}

#[test]
fn bell_and_sigmoids() {
    table(
        MembershipFunction::Bell {
            center: 1.0,
            width: 2.0,
            slope: 1.0,
        },
        &[
            (NEG_INFINITY, 0.0),
            (-3.0, 0.2),
            (-1.0, 0.5),
            (1.0, 1.0),
            (3.0, 0.5),
            (7.0, 0.1),
            (INFINITY, 0.0),
        ],
    );
    let third = 3.0_f64.ln();
    table(
        MembershipFunction::Sigmoid {
            inflection: 2.0,
            slope: 1.0,
        },
        &[
            (NEG_INFINITY, 0.0),
            (2.0 - third, 0.25),
            (2.0, 0.5),
            (2.0 + third, 0.75),
            (INFINITY, 1.0),
        ],
    );
    table(
        MembershipFunction::Sigmoid {
            inflection: 2.0,
            slope: -1.0,
        },
        &[
            (NEG_INFINITY, 1.0),
            (2.0 + third, 0.25),
            (2.0, 0.5),
            (INFINITY, 0.0),
        ],
    );
    table(
        MembershipFunction::SigmoidDifference {
            left_inflection: 0.0,
            left_slope: 1.0,
            right_inflection: third,
            right_slope: 1.0,
        },
        &[
            (NEG_INFINITY, 0.0),
            (0.0, 0.25),
            (third, 0.25),
            (INFINITY, 0.0),
        ],
    );
    table(
        MembershipFunction::SigmoidProduct {
            left_inflection: 0.0,
            left_slope: 1.0,
            right_inflection: 0.0,
            right_slope: -1.0,
        },
        &[
            (NEG_INFINITY, 0.0),
            (0.0, 0.25),
            (third, 3.0 / 16.0),
            (-third, 3.0 / 16.0),
            (INFINITY, 0.0),
        ],
    );
}

#[test]
fn s_z_and_pi() {
    table(
        MembershipFunction::SShape {
            foot: 0.0,
            top: 4.0,
        },
        &[
            (NEG_INFINITY, 0.0),
            (0.0, 0.0),
            (1.0, 0.125),
            (2.0, 0.5),
            (3.0, 0.875),
            (4.0, 1.0),
            (INFINITY, 1.0),
        ],
    );
    table(
        MembershipFunction::ZShape {
            top: 0.0,
            foot: 4.0,
        },
        &[
            (NEG_INFINITY, 1.0),
            (0.0, 1.0),
            (1.0, 0.875),
            (2.0, 0.5),
            (3.0, 0.125),
            (4.0, 0.0),
            (INFINITY, 0.0),
        ],
    );
    table(
        MembershipFunction::PiShape {
            left: 0.0,
            left_top: 2.0,
            right_top: 3.0,
            right: 5.0,
        },
        &[
            (NEG_INFINITY, 0.0),
            (0.0, 0.0),
            (0.5, 0.125),
            (1.0, 0.5),
            (2.0, 1.0),
            (3.0, 1.0),
            (4.5, 0.125),
            (5.0, 0.0),
            (INFINITY, 0.0),
        ],
    );
    table(
        MembershipFunction::PiShape {
            left: 1.0,
            left_top: 1.0,
            right_top: 1.0,
            right: 1.0,
        },
        &[(0.9, 0.0), (1.0, 1.0), (1.1, 0.0)],
    );
}

#[test]
fn cosine_spike_concave() {
    table(
        MembershipFunction::Cosine {
            center: 1.0,
            width: 4.0,
        },
        &[
            (NEG_INFINITY, 0.0),
            (-1.0, 0.0),
            (0.0, 0.5),
            (1.0, 1.0),
            (2.0, 0.5),
            (3.0, 0.0),
            (3.5, 0.0),
            (INFINITY, 0.0),
        ],
    );
    let tenth = 0.367_879_441_171_442_33; // exp(-1)
    table(
        MembershipFunction::Spike {
            center: 1.0,
            width: 10.0,
        },
        &[
            (NEG_INFINITY, 0.0),
            (0.0, tenth),
            (1.0, 1.0),
            (2.0, tenth),
            (INFINITY, 0.0),
        ],
    );
    table(
        MembershipFunction::Concave {
            inflection: 1.0,
            end: 3.0,
        },
        &[
            (NEG_INFINITY, 0.0),
            (-3.0, 0.25),
            (1.0, 0.5),
            (2.0, 2.0 / 3.0),
            (3.0, 1.0),
            (INFINITY, 1.0),
        ],
    );
    table(
        MembershipFunction::Concave {
            inflection: 3.0,
            end: 1.0,
        },
        &[
            (NEG_INFINITY, 1.0),
            (1.0, 1.0),
            (2.0, 2.0 / 3.0),
            (3.0, 0.5),
            (7.0, 0.25),
            (INFINITY, 0.0),
        ],
    );
}

#[test]
fn invalid_parameters_do_not_give_nan() {
    for shape in [
        MembershipFunction::Gaussian { mean: NAN, sd: 0.0 },
        MembershipFunction::Bell {
            center: 0.0,
            width: 0.0,
            slope: NAN,
        },
        MembershipFunction::Concave {
            inflection: 1.0,
            end: INFINITY,
        },
        MembershipFunction::Piecewise { points: vec![] },
        MembershipFunction::Constant { value: NAN },
    ] {
        for x in [NEG_INFINITY, -1.0, 0.0, 1.0, INFINITY, NAN] {
            let degree = shape.membership(x);
            assert!((0.0..=1.0).contains(&degree), "{shape:?} at {x}: {degree}");
        }
    }
}

#[test]
fn messages_name_the_parameter() {
    let message = |shape: MembershipFunction| shape.validate().unwrap_err().to_string();
    assert_eq!(
        message(MembershipFunction::Gaussian { mean: 1.0, sd: 0.0 }),
        "`sd` is 0, but must be greater than 0"
    );
    assert_eq!(
        message(MembershipFunction::Bell {
            center: f64::NAN,
            width: 1.0,
            slope: 1.0
        }),
        "`center` is NaN, not a finite number"
    );
    assert_eq!(
        message(MembershipFunction::Piecewise {
            points: vec![(0.0, 0.5), (1.0, 1.5)]
        }),
        "the degree 1.5 at 1 is outside [0, 1]"
    );
    assert_eq!(
        message(MembershipFunction::Piecewise {
            points: vec![(1.0, 0.5), (0.0, 0.5)]
        }),
        "the points are not in ascending order: 0 follows 1"
    );
    assert_eq!(
        message(MembershipFunction::Concave {
            inflection: 1.0,
            end: 1.0
        }),
        "`inflection` and `end` are both 1"
    );
    assert_eq!(
        message(MembershipFunction::Rectangle {
            left: -1.7e308,
            right: 1.7e308
        }),
        "`left` is too large"
    );
}
