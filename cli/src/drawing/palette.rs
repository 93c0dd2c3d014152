//! Colours that those who tell few colours apart can still put in order, of the maps that `flagred map` draws and of the
//! report's. An output in general has a scale without a meaning, a risk one that says which end is bad.

/// A colour: red, green, blue.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub(crate) struct Colour(pub(crate) u8, pub(crate) u8, pub(crate) u8);

impl std::fmt::Display for Colour {
    fn fmt(&self, f: &mut std::fmt::Formatter<'_>) -> std::fmt::Result {
        write!(f, "#{:02x}{:02x}{:02x}", self.0, self.1, self.2)
    }
}

/// Eleven even steps of viridis (Smith and van der Walt 2015, CC0): its lightness rises evenly, so that it also prints
/// in grey, and it is the same to those who do not tell red from green.
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

/// From pale to dark red as a risk rises: what is bad stands out, on paper too.
const RISK: [Colour; 5] = [
    Colour(0xff, 0xfa, 0xd6),
    Colour(0xfe, 0xd9, 0x76),
    Colour(0xfc, 0x8d, 0x3c),
    Colour(0xd7, 0x30, 0x27),
    Colour(0x6e, 0x08, 0x26),
];

/// The colour of a share from 0 to 1 of an output's range.
pub(crate) fn viridis(share: f64) -> Colour {
    between(&VIRIDIS, share)
}

/// The colour of a risk from 0 to 1.
pub(crate) fn risk(share: f64) -> Colour {
    between(&RISK, share)
}

fn between<const N: usize>(stops: &[Colour; N], share: f64) -> Colour {
    let place = share.clamp(0.0, 1.0) * (N - 1) as f64;
    let below = (place as usize).min(N - 2);
    mix(stops[below], stops[below + 1], place - below as f64)
}

/// A colour on the way from one to another.
pub(crate) fn mix(from: Colour, to: Colour, share: f64) -> Colour {
    let part = |a: u8, b: u8| (f64::from(a) + (f64::from(b) - f64::from(a)) * share).round() as u8;
    Colour(part(from.0, to.0), part(from.1, to.1), part(from.2, to.2))
}

/// Black or white, whichever can be read on a colour (relative luminance of WCAG 2).
pub(crate) fn ink(on: Colour) -> Colour {
    let linear = |c: u8| {
        let c = f64::from(c) / 255.0;
        if c <= 0.04045 {
            c / 12.92
        } else {
            ((c + 0.055) / 1.055).powf(2.4)
        }
    };
    let luminance = 0.2126 * linear(on.0) + 0.7152 * linear(on.1) + 0.0722 * linear(on.2);
    if luminance > 0.18 {
        Colour(0, 0, 0)
    } else {
        Colour(255, 255, 255)
    }
}

/// Okabe and Ito's eight colours without black: areas that lie side by side and have no order.
const OKABE_ITO: [Colour; 7] = [
    Colour(0x56, 0xb4, 0xe9),
    Colour(0xe6, 0x9f, 0x00),
    Colour(0x00, 0x9e, 0x73),
    Colour(0xf0, 0xe4, 0x42),
    Colour(0x00, 0x72, 0xb2),
    Colour(0xd5, 0x5e, 0x00),
    Colour(0xcc, 0x79, 0xa7),
];

/// A colour for the i-th of many things; after seven, lighter ones.
pub(crate) fn distinct(i: usize) -> Colour {
    let lighter = (i / OKABE_ITO.len() % 4) as f64 * 0.22;
    mix(
        OKABE_ITO[i % OKABE_ITO.len()],
        Colour(255, 255, 255),
        lighter,
    )
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
        assert!(along(risk).iter().rev().is_sorted(), "{:?}", along(risk));
    }

    #[test]
    fn ends_and_beyond() {
        assert_eq!(viridis(-1.0), VIRIDIS[0]);
        assert_eq!(viridis(2.0).to_string(), "#fde725");
        assert_eq!(
            (risk(0.0).to_string(), risk(1.0).to_string()),
            ("#fffad6".into(), "#6e0826".into())
        );
        assert_eq!(ink(VIRIDIS[0]), Colour(255, 255, 255));
        assert_eq!(ink(VIRIDIS[10]), Colour(0, 0, 0));
    }
}
