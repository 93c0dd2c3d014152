//! Numbers for the evaluation of formulas: plain numbers, and numbers that include their derivative.

use std::ops::{Add, Div, Mul, Neg, Sub};

/// The operations that formulas of membership functions and operators require of a number.
pub(super) trait Number:
    Copy
    + Add<Output = Self>
    + Sub<Output = Self>
    + Mul<Output = Self>
    + Div<Output = Self>
    + Neg<Output = Self>
{
    fn of(value: f64) -> Self;
    fn value(self) -> f64;
    fn exp(self) -> Self;
    fn cos(self) -> Self;
    fn sqrt(self) -> Self;
    fn powf(self, exponent: f64) -> Self;

    fn abs(self) -> Self {
        if self.value() < 0.0 { -self } else { self }
    }

    fn min(self, other: Self) -> Self {
        if other.value() < self.value() {
            other
        } else {
            self
        }
    }

    fn max(self, other: Self) -> Self {
        if other.value() > self.value() {
            other
        } else {
            self
        }
    }
}

impl Number for f64 {
    fn of(value: f64) -> Self {
        value
    }

    fn value(self) -> f64 {
        self
    }

    fn exp(self) -> Self {
        self.exp()
    }

    fn cos(self) -> Self {
        self.cos()
    }

    fn sqrt(self) -> Self {
        self.sqrt()
    }

    fn powf(self, exponent: f64) -> Self {
        self.powf(exponent)
    }
}

/// A number and its derivative (automatic differentiation).
#[derive(Clone, Copy)]
pub(super) struct Dual {
    pub(super) value: f64,
    pub(super) slope: f64,
}

impl Dual {
    /// Applies the chain rule: `value` and `derivative` are the value and the derivative of a function at this number.
    fn chain(self, value: f64, derivative: f64) -> Self {
        // The derivative of a constant is 0, even if the slope of the function is infinite.
        let slope = if self.slope == 0.0 {
            0.0
        } else {
            derivative * self.slope
        };
        Dual { value, slope }
    }
}

impl Number for Dual {
    fn of(value: f64) -> Self {
        Dual { value, slope: 0.0 }
    }

    fn value(self) -> f64 {
        self.value
    }

    fn exp(self) -> Self {
        self.chain(self.value.exp(), self.value.exp())
    }

    fn cos(self) -> Self {
        self.chain(self.value.cos(), -self.value.sin())
    }

    fn sqrt(self) -> Self {
        self.chain(self.value.sqrt(), 0.5 / self.value.sqrt())
    }

    fn powf(self, exponent: f64) -> Self {
        let derivative = exponent * self.value.powf(exponent - 1.0);
        self.chain(self.value.powf(exponent), derivative)
    }
}

impl Add for Dual {
    type Output = Self;

    fn add(self, other: Self) -> Self {
        Dual {
            value: self.value + other.value,
            slope: self.slope + other.slope,
        }
    }
}

impl Neg for Dual {
    type Output = Self;

    fn neg(self) -> Self {
        Dual {
            value: -self.value,
            slope: -self.slope,
        }
    }
}

impl Sub for Dual {
    type Output = Self;

    fn sub(self, other: Self) -> Self {
        self + -other
    }
}

impl Mul for Dual {
    type Output = Self;

    fn mul(self, other: Self) -> Self {
        Dual {
            value: self.value * other.value,
            slope: self.slope * other.value + self.value * other.slope,
        }
    }
}

impl Div for Dual {
    type Output = Self;

    fn div(self, other: Self) -> Self {
        let value = self.value / other.value;
        Dual {
            value,
            slope: (self.slope - value * other.slope) / other.value,
        }
    }
}
