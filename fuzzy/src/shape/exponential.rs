//! The exponential function of curved shapes. Its results are bitwise equal on every machine. It does not branch, so
//! that the compiler can compute several values together.

/// Returns `e^-x` for `x >= 0`, with an error below 0.83 units in the last place. Returns 0 for NaN and above 708,
/// where the exact value is less than 3.4e-308.
///
/// With `k` the integer nearest to `x / ln 2` and `r = k ln 2 - x`, the result is `2^-k e^r`. Since `|r| <= ln 2 / 2`,
/// a polynomial approximates `e^r`. `ln 2` is split into a number with few digits, whose product with `k` is exact, and
/// a small remainder.
#[inline(always)]
pub(crate) fn exp_of_minus(x: f64) -> f64 {
    /// Adding this to a number below 2^51 rounds it to an integer, which is in the lowest bits of the sum.
    const ROUNDS: f64 = 6_755_399_441_055_744.0;
    const HIGH: f64 = 0.693_147_180_369_123_8;
    const LOW: f64 = 1.908_214_929_270_587_7e-10;
    /// The coefficients of a polynomial that approximates `(e^r - 1 - r) / r^2`, computed by interpolation at Chebyshev
    /// points. The relative error is 1e-18.
    const C: [f64; 11] = [
        0.5,
        0.166_666_666_666_666_69,
        0.041_666_666_666_666_664,
        0.008_333_333_333_330_062,
        0.001_388_888_888_888_655_2,
        0.000_198_412_698_630_536_18,
        2.480_158_731_714_449_8e-5,
        2.755_726_845_999_706_4e-6,
        2.755_728_296_954_995e-7,
        2.510_038_549_551_032e-8,
        2.091_123_663_026_154_5e-9,
    ];
    let is_normal = x < 708.0;
    let x = if is_normal { x } else { 708.0 };
    let rounded = x * core::f64::consts::LOG2_E + ROUNDS;
    let k = rounded - ROUNDS;
    let (high, low) = (k * HIGH - x, k * LOW);
    let r = high + low;
    let r2 = r * r;
    let r4 = r2 * r2;
    // Several short chains of operations are faster than Horner's single long one.
    let first = (C[0] + C[1] * r) + r2 * (C[2] + C[3] * r);
    let second = (C[4] + C[5] * r) + r2 * (C[6] + C[7] * r);
    let third = (C[8] + C[9] * r) + r2 * C[10];
    let polynomial = first + r4 * (second + r4 * third);
    // `high` is exact, and the remaining terms are small in comparison.
    let power = 1.0 + (high + (low + r2 * polynomial));
    let scale = f64::from_bits(1023u64.wrapping_sub(rounded.to_bits()) << 52);
    if is_normal { power * scale } else { 0.0 }
}

#[cfg(test)]
mod tests {
    use super::*;
    use proptest::prelude::*;

    #[test]
    fn exponentials_at_the_ends_and_at_known_values() {
        assert_eq!(exp_of_minus(0.0), 1.0);
        assert_eq!(exp_of_minus(1e-300), 1.0);
        assert_eq!(exp_of_minus(f64::INFINITY), 0.0);
        assert_eq!(exp_of_minus(f64::NAN), 0.0);
        assert_eq!(exp_of_minus(708.0), 0.0);
        assert!(exp_of_minus(707.9) > 3e-308);
        // These bits were computed on x86-64 and must be the same on every machine.
        assert_eq!(exp_of_minus(1.0).to_bits(), 0x3fd7_8b56_362c_ef38);
        assert_eq!(exp_of_minus(0.5).to_bits(), 0x3fe3_68b2_fc6f_960a);
        assert_eq!(exp_of_minus(100.0).to_bits(), 0x36ea_8c1f_14e2_af5d);
    }

    proptest! {
        /// Compares the results with `libm::exp`. The errors of both functions are below one unit in the last place,
        /// so their results are equal or adjacent numbers.
        #[test]
        fn libm_agrees(x in prop_oneof![0.0..1.0, 0.0..40.0, 0.0..707.9]) {
            let x: f64 = x;
            let (ours, reference) = (exp_of_minus(x).to_bits(), libm::exp(-x).to_bits());
            prop_assert!(ours.abs_diff(reference) <= 1, "{x}: {ours:x} {reference:x}");
        }
    }
}
