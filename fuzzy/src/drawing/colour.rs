//! Colours: two scales with monotone lightness, so that they stay ordered in grey and for colour-blind readers, and a
//! set of unordered colours.

/// A colour: red, green, blue. Its `Display` format is that of CSS: `#fde725`.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub struct Colour(pub u8, pub u8, pub u8);

impl std::fmt::Display for Colour {
    fn fmt(&self, f: &mut std::fmt::Formatter<'_>) -> std::fmt::Result {
        write!(f, "#{:02x}{:02x}{:02x}", self.0, self.1, self.2)
    }
}

/// Eleven evenly spaced colours of viridis (Smith and van der Walt 2015, CC0).
const VIRIDIS: [Colour; 11] = [
    Colour(0x44, 0x01, 0x54),
    Colour(0x48, 0x25, 0x76),
    Colour(0x41, 0x44, 0x87),
    Colour(0x35, 0x60, 0x8d),
    Colour(0x2a, 0x78, 0x8e),
    Colour(0x21, 0x91, 0x8c),
    Colour(0x22, 0xa8, 0x84),
    Colour(0x44, 0xbf, 0x70),
    Colour(0x7a, 0xd1, 0x51),
    Colour(0xbd, 0xdf, 0x26),
    Colour(0xfd, 0xe7, 0x25),
];

/// A scale from pale yellow to dark red, whose upper end stands out, also in print.
const REDS: [Colour; 5] = [
    Colour(0xff, 0xfa, 0xd6),
    Colour(0xfe, 0xd9, 0x76),
    Colour(0xfc, 0x8d, 0x3c),
    Colour(0xd7, 0x30, 0x27),
    Colour(0x6e, 0x08, 0x26),
];

/// Returns the colour for a fraction from 0 to 1 of a range whose ends are neither good nor bad.
pub fn viridis(share: f64) -> Colour {
    between(&VIRIDIS, share)
}

/// Returns the colour for a fraction from 0 to 1 of a range whose upper end is bad.
pub fn reds(share: f64) -> Colour {
    between(&REDS, share)
}

/// Returns the colour for a fraction from 0 to 1 of the range of an output: [`reds`] for a risk, which is an output with a
/// name such as `risk` or `battery_risk`, otherwise [`viridis`].
pub fn output_colour(output: &str, share: f64) -> Colour {
    match output == "risk" || output.ends_with("_risk") {
        true => reds(share),
        false => viridis(share),
    }
}

impl Colour {
    /// Black.
    pub const BLACK: Colour = Colour(0, 0, 0);
    /// White.
    pub const WHITE: Colour = Colour(255, 255, 255);

    /// Blends with another colour; `share`, from 0 to 1, is the weight of the other one.
    pub fn mix(self, to: Colour, share: f64) -> Colour {
        let part =
            |a: u8, b: u8| (f64::from(a) + (f64::from(b) - f64::from(a)) * share).round() as u8;
        Colour(part(self.0, to.0), part(self.1, to.1), part(self.2, to.2))
    }

    /// Returns black or white, whichever is easier to read on this colour (by the relative luminance of WCAG 2).
    pub fn ink(self) -> Colour {
        let linear = |c: u8| {
            let c = f64::from(c) / 255.0;
            if c <= 0.04045 {
                c / 12.92
            } else {
                ((c + 0.055) / 1.055).powf(2.4)
            }
        };
        let luminance = 0.2126 * linear(self.0) + 0.7152 * linear(self.1) + 0.0722 * linear(self.2);
        if luminance > 0.18 {
            Colour::BLACK
        } else {
            Colour::WHITE
        }
    }
}

fn between<const N: usize>(stops: &[Colour; N], share: f64) -> Colour {
    let position = share.clamp(0.0, 1.0) * (N - 1) as f64;
    let below = (position as usize).min(N - 2);
    stops[below].mix(stops[below + 1], position - below as f64)
}

/// Okabe and Ito's colours without black (2008).
const OKABE_ITO: [Colour; 7] = [
    Colour(0x56, 0xb4, 0xe9),
    Colour(0xe6, 0x9f, 0x00),
    Colour(0x00, 0x9e, 0x73),
    Colour(0xf0, 0xe4, 0x42),
    Colour(0x00, 0x72, 0xb2),
    Colour(0xd5, 0x5e, 0x00),
    Colour(0xcc, 0x79, 0xa7),
];

/// Returns a colour for the i-th of several unordered items. After seven colours, the same colours follow in lighter
/// shades.
pub fn distinct(i: usize) -> Colour {
    let lighter = (i / OKABE_ITO.len() % 4) as f64 * 0.22;
    OKABE_ITO[i % OKABE_ITO.len()].mix(Colour::WHITE, lighter)
}

/// Works like [`distinct`], but the colours are dark enough for a thin line on white: yellow is omitted, and after
/// six colours, darker ones follow.
pub fn distinct_line(i: usize) -> Colour {
    const ORDER: [usize; 6] = [5, 4, 2, 6, 1, 0];
    let darker = (i / ORDER.len() % 3) as f64 * 0.35;
    OKABE_ITO[ORDER[i % ORDER.len()]].mix(Colour::BLACK, darker)
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn lightness_changes_one_way_only() {
        let lightness =
            |c: Colour| 2126 * u32::from(c.0) + 7152 * u32::from(c.1) + 722 * u32::from(c.2);
        let along = |colour: fn(f64) -> Colour| -> Vec<u32> {
            let shares = (0..=100).map(|i| f64::from(i) / 100.0);
            shares.map(|share| lightness(colour(share))).collect()
        };
        assert!(along(viridis).is_sorted(), "{:?}", along(viridis));
        assert!(along(reds).iter().rev().is_sorted(), "{:?}", along(reds));
    }

    #[test]
    fn colours_are_clamped_beyond_the_ends() {
        assert_eq!(viridis(-1.0), VIRIDIS[0]);
        assert_eq!(viridis(2.0).to_string(), "#fde725");
        assert_eq!(
            (reds(0.0).to_string(), reds(1.0).to_string()),
            ("#fffad6".into(), "#6e0826".into())
        );
        let of = |output| output_colour(output, 1.0);
        assert_eq!((of("battery_risk"), of("risk")), (REDS[4], REDS[4]));
        assert_eq!((of("risky"), of("fan")), (VIRIDIS[10], VIRIDIS[10]));
        assert_eq!(VIRIDIS[0].ink(), Colour::WHITE);
        assert_eq!(VIRIDIS[10].ink(), Colour::BLACK);
    }
}
