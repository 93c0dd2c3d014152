//! The spellings of membership functions with a fixed number of parameters.

use fuzzy::model::{MembershipFunction, Term};

use crate::Format;

/// A shape; parameters are in the order of fuzzylite.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub(crate) enum Shape {
    Triangle,
    Trapezoid,
    Rectangle,
    /// `[start, end]`: rises from 0 at `start` to 1 at `end`, or falls if `end` is smaller.
    Ramp,
    /// `[end, start]`: a ramp with its end first.
    RampBack,
    Gaussian,
    /// `[mean, sd, mean, sd]`.
    Gaussian2,
    Bell,
    Sigmoid,
    /// `[left, rising, falling, right]`.
    SigmoidDifference,
    /// `[left, rising, falling, right]`.
    SigmoidProduct,
    S,
    Z,
    Pi,
    Cosine,
    /// `[half width, center]`.
    HalfCosine,
    Spike,
    Concave,
    Arc,
    SemiEllipse,
}

/// A shape, its names, and for each parameter in FIS and FCL the index of the parameter in FLL.
struct Spelling {
    shape: Shape,
    /// The names in FIS, FLL and FCL. Alternatives are separated by `|`; the first one is written.
    names: [&'static str; 3],
    fis: &'static [usize],
    fcl: &'static [usize],
}

const IN_ORDER: [usize; 4] = [0, 1, 2, 3];

const SPELLINGS: &[Spelling] = &{
    use Shape::*;
    const fn same(shape: Shape, count: usize, names: [&'static str; 3]) -> Spelling {
        let order = IN_ORDER.split_at(count).0;
        Spelling {
            shape,
            names,
            fis: order,
            fcl: order,
        }
    }
    [
        same(Triangle, 3, ["trimf", "Triangle", "TRIAN"]),
        same(Trapezoid, 4, ["trapmf", "Trapezoid", "TRAPE"]),
        same(Rectangle, 2, ["rectmf", "Rectangle", ""]),
        same(Ramp, 2, ["linsmf|rampmf", "Ramp", ""]),
        same(RampBack, 2, ["linzmf", "", ""]),
        Spelling {
            shape: Gaussian,
            names: ["gaussmf", "Gaussian", "GAUSS"],
            fis: &[1, 0],
            fcl: &[0, 1],
        },
        Spelling {
            shape: Gaussian2,
            names: ["gauss2mf", "GaussianProduct", "GAUSS2"],
            fis: &[1, 0, 3, 2],
            fcl: &[0, 1, 2, 3],
        },
        Spelling {
            shape: Bell,
            names: ["gbellmf", "Bell", "GBELL"],
            fis: &[1, 2, 0],
            fcl: &[1, 2, 0],
        },
        Spelling {
            shape: Sigmoid,
            names: ["sigmf", "Sigmoid", "SIGM"],
            fis: &[1, 0],
            fcl: &[1, 0],
        },
        Spelling {
            shape: SigmoidDifference,
            names: ["dsigmf", "SigmoidDifference", "DSIGM"],
            fis: &[1, 0, 2, 3],
            fcl: &[1, 0, 2, 3],
        },
        Spelling {
            shape: SigmoidProduct,
            names: ["psigmf", "SigmoidProduct", ""],
            fis: &[1, 0, 2, 3],
            fcl: &[1, 0, 2, 3],
        },
        same(S, 2, ["smf", "SShape", ""]),
        same(Z, 2, ["zmf", "ZShape", ""]),
        same(Pi, 4, ["pimf", "PiShape", ""]),
        same(Cosine, 2, ["cosinemf", "Cosine", ""]),
        same(HalfCosine, 2, ["", "", "COSINE"]),
        same(Spike, 2, ["spikemf", "Spike", ""]),
        same(Concave, 2, ["concavemf", "Concave", ""]),
        same(Arc, 2, ["", "Arc", ""]),
        same(SemiEllipse, 2, ["", "SemiEllipse", ""]),
    ]
};

impl Spelling {
    fn names(&self, format: Format) -> impl Iterator<Item = &'static str> {
        let names = self.names.get(format as usize).copied().unwrap_or("");
        names.split('|').filter(|name| !name.is_empty())
    }

    fn order(&self, format: Format) -> &'static [usize] {
        match format {
            Format::Fis => self.fis,
            Format::Fcl => self.fcl,
            Format::Fll | Format::Fml => IN_ORDER.get(..self.fis.len()).unwrap_or(&[]),
        }
    }
}

/// Whether a term is a number that is computed from the inputs, rather than a fuzzy set.
pub(crate) fn is_computed(term: &Term) -> bool {
    matches!(
        term.membership_function,
        MembershipFunction::Constant { .. }
            | MembershipFunction::Linear { .. }
            | MembershipFunction::Function { .. }
    )
}

/// A linear function, from a coefficient for each input followed by the constant; missing ones are 0.
pub(crate) fn linear(numbers: &[f64], inputs: &[&str]) -> MembershipFunction {
    let coefficients = inputs.iter().zip(numbers);
    let coefficients = coefficients
        .filter(|&(_, &coefficient)| coefficient != 0.0)
        .map(|(input, &coefficient)| ((*input).to_owned(), coefficient));
    MembershipFunction::Linear {
        coefficients: coefficients.collect(),
        constant: numbers.get(inputs.len()).copied().unwrap_or(0.0),
    }
}

/// Returns the shape with the given name in a format, and the number of its parameters in that
/// format.
pub(crate) fn named(format: Format, name: &str) -> Option<(Shape, usize)> {
    let is = |known: &str| known.eq_ignore_ascii_case(name);
    let spelling = SPELLINGS.iter().find(|s| s.names(format).any(is))?;
    Some((spelling.shape, spelling.order(format).len()))
}

/// The parameters of a shape in the order of a format, such as `left peak right`.
pub(crate) fn parameters(format: Format, shape: Shape) -> String {
    let names: &[&str] = match shape {
        Shape::Triangle => &["left", "peak", "right"],
        Shape::Trapezoid => &["left", "left_top", "right_top", "right"],
        Shape::Rectangle => &["left", "right"],
        Shape::Ramp => &["start", "end"],
        Shape::RampBack => &["end", "start"],
        Shape::Gaussian => &["mean", "sd"],
        Shape::Gaussian2 => &["left_mean", "left_sd", "right_mean", "right_sd"],
        Shape::Bell => &["center", "width", "slope"],
        Shape::Sigmoid => &["inflection", "slope"],
        Shape::SigmoidDifference | Shape::SigmoidProduct => &["left", "rising", "falling", "right"],
        Shape::S => &["foot", "top"],
        Shape::Z => &["top", "foot"],
        Shape::Pi => &["left", "left_top", "right_top", "right"],
        Shape::Cosine | Shape::Spike => &["center", "width"],
        Shape::HalfCosine => &["half_width", "center"],
        Shape::Concave => &["inflection", "end"],
        Shape::Arc | Shape::SemiEllipse => &["start", "end"],
    };
    let spelling = SPELLINGS.iter().find(|known| known.shape == shape);
    let order = spelling.map_or(&[][..], |spelling| spelling.order(format));
    let names = order.iter().filter_map(|index| names.get(*index).copied());
    names.collect::<Vec<_>>().join(" ")
}

/// The names of all shapes in a format; if a shape has alternative names, only the first.
pub(crate) fn names(format: Format) -> impl Iterator<Item = &'static str> + Clone {
    SPELLINGS
        .iter()
        .filter_map(move |spelling| spelling.names(format).next())
}

/// The index, in the order of a format, of a parameter that is not finite but must be. Only an outer side of a triangle
/// or a trapezoid may be open: `-inf` on the left or `inf` on the right.
pub(crate) fn not_finite(shape: Shape, written: &[f64]) -> Option<usize> {
    let closed = |from: usize, to: usize| {
        let inner = written.iter().enumerate().take(to).skip(from);
        inner
            .filter(|(_, x)| !x.is_finite())
            .map(|(index, _)| index)
            .next()
    };
    let last = written.len().saturating_sub(1);
    let has_sides = matches!(shape, Shape::Triangle | Shape::Trapezoid);
    let is_open = |index: usize, side: f64| has_sides && written.get(index) == Some(&side);
    match (is_open(0, f64::NEG_INFINITY), is_open(last, f64::INFINITY)) {
        (false, false) => closed(0, written.len()),
        // The top next to an open side may be infinite too.
        (true, false) if written.get(1) == Some(&f64::NEG_INFINITY) => closed(2, written.len()),
        (true, false) => closed(1, written.len()),
        (false, true) if written.get(last.saturating_sub(1)) == Some(&f64::INFINITY) => {
            closed(0, last.saturating_sub(1))
        }
        (false, true) => closed(0, last),
        (true, true) => Some(last),
    }
}

/// Creates a membership function from its parameters in the order of a format. [`not_finite`] must have returned `None`
/// for these parameters.
pub(crate) fn read(format: Format, shape: Shape, written: &[f64]) -> Option<MembershipFunction> {
    use MembershipFunction as To;
    let spelling = SPELLINGS.iter().find(|known| known.shape == shape)?;
    let mut p = [0.0; 4];
    for (&to, &value) in spelling.order(format).iter().zip(written) {
        *p.get_mut(to)? = value;
    }
    Some(match (shape, p) {
        (Shape::Triangle, [left, peak, right, _]) => match (left.is_finite(), right.is_finite()) {
            (false, true) => To::LeftShoulder {
                top: peak,
                foot: right,
            },
            (true, false) => To::RightShoulder {
                foot: left,
                top: peak,
            },
            _ => To::Triangle { left, peak, right },
        },
        (Shape::Trapezoid, [left, left_top, right_top, right]) => {
            match (left.is_finite(), right.is_finite()) {
                (false, true) => To::LeftShoulder {
                    top: right_top,
                    foot: right,
                },
                (true, false) => To::RightShoulder {
                    foot: left,
                    top: left_top,
                },
                _ => To::Trapezoid {
                    left,
                    left_top,
                    right_top,
                    right,
                },
            }
        }
        (Shape::Rectangle, [left, right, ..]) => To::Rectangle { left, right },
        (Shape::Ramp, [start, end, ..]) | (Shape::RampBack, [end, start, ..]) => {
            match start <= end {
                true => To::RightShoulder {
                    foot: start,
                    top: end,
                },
                false => To::LeftShoulder {
                    top: end,
                    foot: start,
                },
            }
        }
        (Shape::Gaussian, [mean, sd, ..]) => To::Gaussian { mean, sd },
        (Shape::Gaussian2, [left_mean, left_sd, right_mean, right_sd]) => To::Gaussian2 {
            left_mean,
            left_sd,
            right_mean,
            right_sd,
        },
        (Shape::Bell, [center, width, slope, _]) => To::Bell {
            center,
            width,
            slope,
        },
        (Shape::Sigmoid, [inflection, slope, ..]) => To::Sigmoid { inflection, slope },
        (Shape::SigmoidDifference, [left, rising, falling, right]) => To::SigmoidDifference {
            left_inflection: left,
            left_slope: rising,
            right_inflection: right,
            right_slope: falling,
        },
        (Shape::SigmoidProduct, [left, rising, falling, right]) => To::SigmoidProduct {
            left_inflection: left,
            left_slope: rising,
            right_inflection: right,
            right_slope: falling,
        },
        // MATLAB treats an S with swapped ends as a step between them; so does fuzzylite.
        (Shape::S, [foot, top, ..]) => To::SShape { foot, top },
        (Shape::Z, [top, foot, ..]) => To::ZShape { top, foot },
        (Shape::Pi, [left, left_top, right_top, right]) => To::PiShape {
            left,
            left_top,
            right_top,
            right,
        },
        (Shape::Cosine, [center, width, ..]) => To::Cosine { center, width },
        (Shape::HalfCosine, [half, center, ..]) => To::Cosine {
            center,
            width: 2.0 * half,
        },
        (Shape::Spike, [center, width, ..]) => To::Spike { center, width },
        (Shape::Concave, [inflection, end, ..]) => To::Concave { inflection, end },
        (Shape::Arc, [start, end, ..]) => To::Arc { start, end },
        (Shape::SemiEllipse, [left, right, ..]) => To::SemiEllipse { left, right },
    })
}

/// The name and parameters of a membership function in a format; `None` if the format has no such shape.
pub(crate) fn write(
    format: Format,
    function: &MembershipFunction,
) -> Option<(&'static str, Vec<f64>)> {
    use MembershipFunction as From;
    let (shape, p) = match *function {
        From::Triangle { left, peak, right } => (Shape::Triangle, [left, peak, right, 0.0]),
        From::Trapezoid {
            left,
            left_top,
            right_top,
            right,
        } => (Shape::Trapezoid, [left, left_top, right_top, right]),
        From::Rectangle { left, right } => (Shape::Rectangle, [left, right, 0.0, 0.0]),
        From::RightShoulder { foot, top } => (Shape::Ramp, [foot, top, 0.0, 0.0]),
        From::LeftShoulder { top, foot } if format == Format::Fis => {
            (Shape::RampBack, [top, foot, 0.0, 0.0])
        }
        From::LeftShoulder { top, foot } => (Shape::Ramp, [foot, top, 0.0, 0.0]),
        From::Gaussian { mean, sd } => (Shape::Gaussian, [mean, sd, 0.0, 0.0]),
        From::Gaussian2 {
            left_mean,
            left_sd,
            right_mean,
            right_sd,
        } => (Shape::Gaussian2, [left_mean, left_sd, right_mean, right_sd]),
        From::Bell {
            center,
            width,
            slope,
        } => (Shape::Bell, [center, width, slope, 0.0]),
        From::Sigmoid { inflection, slope } => (Shape::Sigmoid, [inflection, slope, 0.0, 0.0]),
        From::SigmoidDifference {
            left_inflection,
            left_slope,
            right_inflection,
            right_slope,
        } => (
            Shape::SigmoidDifference,
            [left_inflection, left_slope, right_slope, right_inflection],
        ),
        From::SigmoidProduct {
            left_inflection,
            left_slope,
            right_inflection,
            right_slope,
        } => (
            Shape::SigmoidProduct,
            [left_inflection, left_slope, right_slope, right_inflection],
        ),
        From::SShape { foot, top } => (Shape::S, [foot, top, 0.0, 0.0]),
        From::ZShape { top, foot } => (Shape::Z, [top, foot, 0.0, 0.0]),
        From::PiShape {
            left,
            left_top,
            right_top,
            right,
        } => (Shape::Pi, [left, left_top, right_top, right]),
        From::Cosine { center, width } if format == Format::Fcl => {
            (Shape::HalfCosine, [0.5 * width, center, 0.0, 0.0])
        }
        From::Cosine { center, width } => (Shape::Cosine, [center, width, 0.0, 0.0]),
        From::Spike { center, width } => (Shape::Spike, [center, width, 0.0, 0.0]),
        From::Concave { inflection, end } => (Shape::Concave, [inflection, end, 0.0, 0.0]),
        From::Arc { start, end } => (Shape::Arc, [start, end, 0.0, 0.0]),
        From::SemiEllipse { left, right } => (Shape::SemiEllipse, [left, right, 0.0, 0.0]),
        _ => return None,
    };
    let spelling = SPELLINGS.iter().find(|known| known.shape == shape)?;
    let name = spelling.names(format).next()?;
    let order = spelling.order(format);
    Some((
        name,
        order
            .iter()
            .filter_map(|&from| p.get(from).copied())
            .collect(),
    ))
}
