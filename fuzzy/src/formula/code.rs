//! Formulas as flat code, which is also used by tables in firmware.

use libm::{
    acos, acosh, asin, asinh, atan, atan2, atanh, ceil, cos, cosh, exp, fabs, floor, fmod, log,
    log1p, log10, pow, round, sin, sinh, sqrt, tan, tanh,
};

/// The code of an operation, followed by its operand: the number for [`Operation::NUMBER`], and the index of the
/// variable for [`Operation::INPUT`]. It is a pair of numbers because code shares an array with the corners of
/// piecewise linear terms.
pub(crate) type Instruction = [f64; 2];

/// An operation on a stack of numbers.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub(crate) struct Operation(pub(crate) u32);

/// The maximum depth of the evaluation stack.
pub(crate) const DEEPEST: usize = 32;

/// Defines operations, each with its name in formulas, its code and its operands.
macro_rules! operations {
    ($($name:ident $word:literal $number:literal ($($operand:ident),*) $value:expr;)+) => {
        impl Operation {
            /// Pushes a number.
            pub(crate) const NUMBER: Operation = Operation(0);
            /// Pushes the value of a variable.
            pub(crate) const INPUT: Operation = Operation(1);
            $(pub(crate) const $name: Operation = Operation($number);)+

            /// All operations that have operands, each with its name and the number of operands.
            #[cfg(feature = "alloc")]
            pub(crate) const ALL: &[(Operation, &str, usize)] = &[
                $((Operation($number), $word, [$(stringify!($operand)),*].len())),+
            ];

            /// Returns the result of the operation; `b` is ignored if the operation takes one operand. Comparisons
            /// and logical operations return 1 for true and 0 for false; as operands, all numbers other than 0 are
            /// true.
            fn of(self, a: f64, b: f64) -> f64 {
                match self {
                    $(Operation::$name => {
                        operations!(@bind (a, b) ($($operand),*));
                        $value
                    })+
                    _ => f64::NAN,
                }
            }

            fn operands(self) -> usize {
                match self {
                    Operation::NUMBER | Operation::INPUT => 0,
                    $(Operation::$name => [$(stringify!($operand)),*].len(),)+
                    _ => 0,
                }
            }
        }
    };
    (@bind ($a:ident, $b:ident) ($x:ident)) => { let $x = $a; };
    (@bind ($a:ident, $b:ident) ($x:ident, $y:ident)) => { let ($x, $y) = ($a, $b); };
}

// The codes appear in exported data and must never change.
operations! {
    OR "or" 2 (x, y) truth(x != 0.0 || y != 0.0);
    AND "and" 3 (x, y) truth(x != 0.0 && y != 0.0);
    NOT "not" 4 (x) truth(x == 0.0);
    LESS "<" 5 (x, y) truth(x < y);
    LESS_OR_EQUAL "<=" 6 (x, y) truth(x <= y);
    GREATER ">" 7 (x, y) truth(x > y);
    GREATER_OR_EQUAL ">=" 8 (x, y) truth(x >= y);
    EQUAL "==" 9 (x, y) truth(x == y);
    UNEQUAL "!=" 10 (x, y) truth(x != y);
    ADD "+" 11 (x, y) x + y;
    SUBTRACT "-" 12 (x, y) x - y;
    MULTIPLY "*" 13 (x, y) x * y;
    DIVIDE "/" 14 (x, y) x / y;
    REMAINDER "%" 15 (x, y) fmod(x, y);
    NEGATE "-" 16 (x) -x;
    POWER "^" 17 (x, y) pow(x, y);
    ABS "abs" 18 (x) fabs(x);
    ACOS "acos" 19 (x) acos(x);
    ACOSH "acosh" 20 (x) acosh(x);
    ASIN "asin" 21 (x) asin(x);
    ASINH "asinh" 22 (x) asinh(x);
    ATAN "atan" 23 (x) atan(x);
    ATAN2 "atan2" 24 (y, x) atan2(y, x);
    ATANH "atanh" 25 (x) atanh(x);
    CEIL "ceil" 26 (x) ceil(x);
    COS "cos" 27 (x) cos(x);
    COSH "cosh" 28 (x) cosh(x);
    EXP "exp" 29 (x) exp(x);
    FLOOR "floor" 30 (x) floor(x);
    LOG "log" 31 (x) log(x);
    LOG10 "log10" 32 (x) log10(x);
    LOG1P "log1p" 33 (x) log1p(x);
    MAX "max" 34 (x, y) if x.is_nan() || x > y { x } else { y };
    MIN "min" 35 (x, y) if x.is_nan() || x < y { x } else { y };
    ROUND "round" 36 (x) round(x);
    SIN "sin" 37 (x) sin(x);
    SINH "sinh" 38 (x) sinh(x);
    SQRT "sqrt" 39 (x) sqrt(x);
    TAN "tan" 40 (x) tan(x);
    TANH "tanh" 41 (x) tanh(x);
}

fn truth(holds: bool) -> f64 {
    f64::from(u8::from(holds))
}

#[cfg(feature = "alloc")]
impl Operation {
    pub(crate) fn with(self, operand: f64) -> Instruction {
        [f64::from(self.0), operand]
    }

    /// Returns the index of the variable that an instruction reads.
    #[cfg(feature = "alloc")]
    pub(crate) fn input_of(instruction: &Instruction) -> Option<usize> {
        let [operation, operand] = *instruction;
        (Operation(operation as u32) == Operation::INPUT).then_some(operand as usize)
    }
}

/// Returns the value of a formula; NaN if the code is damaged.
pub(crate) fn evaluate(code: &[Instruction], value: impl Fn(usize) -> f64) -> f64 {
    let mut stack = [f64::NAN; DEEPEST];
    let mut depth = 0usize;
    for &[operation, operand] in code {
        let operation = Operation(operation as u32);
        let Some(first) = depth.checked_sub(operation.operands()) else {
            return f64::NAN;
        };
        let at = |i: usize| stack.get(i).copied().unwrap_or(f64::NAN);
        let result = match operation {
            Operation::NUMBER => operand,
            Operation::INPUT => value(operand as usize),
            _ => operation.of(at(first), at(first + 1)),
        };
        let Some(top) = stack.get_mut(first) else {
            return f64::NAN;
        };
        *top = result;
        depth = first + 1;
    }
    let [result, ..] = stack;
    result
}

/// Returns the maximum depth of the stack during evaluation.
#[cfg(feature = "alloc")]
pub(crate) fn depth(code: &[Instruction]) -> usize {
    let (mut depth, mut deepest) = (0usize, 0);
    for [operation, _] in code {
        depth = depth.saturating_sub(Operation(*operation as u32).operands()) + 1;
        deepest = deepest.max(depth);
    }
    deepest
}
