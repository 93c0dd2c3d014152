//! Sums that do not depend on the order of the summands.

/// The number of 64-bit limbs of a sum, which represent multiples of 2^-256 up to 2^256. This suffices for every weight
/// in [`WEIGHTS`](super::WEIGHTS) times memberships, and for more rows than fit in memory.
const LIMBS: usize = 8;

/// The exponent of the smallest step.
const MIN_EXPONENT: i32 = -256;

/// A fixed-point sum of non-negative numbers; the least significant limb comes first.
#[derive(Debug, Clone, Copy, Default, PartialEq, Eq)]
pub(super) struct Sum([u64; LIMBS]);

impl Sum {
    /// Adds a number; digits below the smallest step are truncated.
    pub(super) fn add(&mut self, x: f64) {
        const DIGITS: i32 = 52;
        const BIAS: i32 = 1023;
        let bits = x.to_bits();
        let exponent = (bits >> DIGITS) as i32;
        // Ignores numbers that are not finite or at most 0, and subnormal numbers, which are below the smallest step.
        if !(1..0x7ff).contains(&exponent) {
            return;
        }
        let digits = (bits & ((1 << DIGITS) - 1)) | (1 << DIGITS);
        let shift = exponent - BIAS - DIGITS - MIN_EXPONENT;
        let (digits, shift) = match u32::try_from(shift) {
            Ok(shift) => (digits, shift),
            Err(_) => (digits.checked_shr(shift.unsigned_abs()).unwrap_or(0), 0),
        };
        let wide = u128::from(digits) << (shift % 64);
        let mut carry = wide;
        for limb in self.0.iter_mut().skip((shift / 64) as usize) {
            if carry == 0 {
                return;
            }
            let sum = u128::from(*limb) + (carry & u128::from(u64::MAX));
            *limb = sum as u64;
            carry = (carry >> 64) + (sum >> 64);
        }
    }

    /// Returns the sum, rounded to a floating-point number.
    pub(super) fn value(self) -> f64 {
        let Some(top) = self.0.iter().rposition(|limb| *limb != 0) else {
            return 0.0;
        };
        // The two highest limbs have at least 65 significant bits, more than a floating-point number has.
        let low = top.saturating_sub(1);
        let limbs = self.0.iter().take(top + 1).skip(low).rev();
        let digits = limbs.fold(0_u128, |sum, limb| (sum << 64) | u128::from(*limb));
        libm::scalbn(digits as f64, 64 * low as i32 + MIN_EXPONENT)
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn sums_are_exact_at_any_exponent() {
        for scale in [1e-50, 1e-30, 1e-9, 1.0, 7.3, 1e20, 1e50] {
            let mut sum = Sum::default();
            for part in [0.5, 1e-3, 3.0, 0.25] {
                sum.add(part * scale);
            }
            let exact = 3.751 * scale;
            assert!((sum.value() - exact).abs() <= 1e-15 * exact, "{scale}");
        }
    }

    #[test]
    fn carries_reach_the_next_limbs_and_order_does_not_matter() {
        let (mut up, mut down) = (Sum::default(), Sum::default());
        let parts = [1.0 - f64::EPSILON / 2.0, f64::EPSILON / 2.0, 1e50, 1e-20];
        for part in parts {
            up.add(part);
        }
        for part in parts.iter().rev() {
            down.add(*part);
        }
        assert_eq!(up, down);
        let mut one = Sum::default();
        one.add(parts[0]);
        one.add(parts[1]);
        assert_eq!(one.value(), 1.0);
    }

    #[test]
    fn values_that_are_not_positive_add_nothing() {
        let mut sum = Sum::default();
        for x in [
            0.0,
            -1.0,
            f64::NAN,
            f64::INFINITY,
            1e-308,
            f64::from_bits(1),
        ] {
            sum.add(x);
        }
        assert_eq!(sum.value(), 0.0);
    }
}
