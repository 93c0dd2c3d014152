//! The motor layout that parameters, messages or headers declare.

use super::tables;
use crate::Vehicle;
use crate::parameters::Parameters;

/// The maximum number of rotors that PX4 describes.
const PX4_ROTORS: u16 = 12;

/// The motor layout that a log or a live vehicle declares.
#[derive(Debug, Clone, PartialEq, Default)]
pub(crate) enum DeclaredLayout {
    #[default]
    Nothing,
    /// A frame with a fixed table; its type may be unknown.
    Frame {
        class: i64,
        kind: Option<i64>,
        source: String,
    },
    /// Factors by motor number.
    Factors {
        frame: Option<String>,
        factors: Vec<(u16, [f64; 3])>,
        source: String,
    },
}

impl DeclaredLayout {
    pub(super) fn source(&self) -> &str {
        match self {
            Self::Nothing => "",
            Self::Frame { source, .. } | Self::Factors { source, .. } => source,
        }
    }

    pub(crate) fn class(&self) -> Option<i64> {
        match self {
            Self::Frame { class, .. } => Some(*class),
            Self::Nothing | Self::Factors { .. } => None,
        }
    }

    pub(super) fn frame(&self) -> Option<String> {
        match self {
            Self::Nothing => None,
            Self::Frame { class, kind, .. } => Some(tables::name(*class, kind.unwrap_or(-1))),
            Self::Factors { frame, .. } => frame.clone(),
        }
    }

    /// The layout from FRAME_CLASS and FRAME_TYPE (firmware 3.5 and later). In older firmware, the class is in the
    /// message `Frame: QUAD`, and the parameter FRAME is the type. Without that message, the class is derived from
    /// the number of motors if only one class fits.
    pub(crate) fn of_ardupilot(parameters: &Parameters, vehicle: &Vehicle) -> Self {
        let frame = vehicle.frame.as_deref();
        let number = |name: &str| parameters.get(name).map(|value| value as i64);
        let named = frame.and_then(|frame| Some((frame, tables::parse(frame)?)));
        // 0 means that the class was never set.
        let class = number("FRAME_CLASS").filter(|&class| class > 0);
        if let (Some(class), Some(kind)) = (class, number("FRAME_TYPE")) {
            return Self::Frame {
                class,
                kind: Some(kind),
                source: format!("FRAME_CLASS = {class}, FRAME_TYPE = {kind}"),
            };
        }
        let old = || number("FRAME").map(|kind| (kind, format!("FRAME = {kind}")));
        let Some((frame, (class, kind))) = named else {
            if let (None, Some(motors), Some((kind, source))) = (class, vehicle.motors, old()) {
                let class = match (motors, kind) {
                    (4, _) => tables::QUAD,
                    (6, tables::Y6B) => tables::Y6,
                    (6, _) => tables::HEXA,
                    _ => return Self::Nothing,
                };
                return Self::Frame {
                    class,
                    kind: Some(kind),
                    source: format!("{motors} motors, {source}"),
                };
            }
            return class.map_or(Self::Nothing, |class| Self::Frame {
                class,
                kind: None,
                source: format!("FRAME_CLASS = {class}"),
            });
        };
        let new = || number("FRAME_TYPE").map(|kind| (kind, format!("FRAME_TYPE = {kind}")));
        let (kind, source) = match kind {
            Some(kind) => (Some(kind), format!("frame `{frame}`")),
            None => match new().or_else(old) {
                Some((kind, source)) => (Some(kind), format!("frame `{frame}`, {source}")),
                None => (None, format!("frame `{frame}`")),
            },
        };
        Self::Frame {
            class,
            kind,
            source,
        }
    }

    /// The layout from the positions, thrust axes and moment ratios of PX4's control allocation (1.13 and later), or
    /// from the number of the airframe in older versions.
    pub(crate) fn of_px4(parameters: &Parameters) -> Self {
        if let Some(factors) = rotors(parameters) {
            return Self::Factors {
                frame: None,
                factors,
                source: "CA_ROTORn_PX, PY, KM".into(),
            };
        }
        let airframe = parameters.get("SYS_AUTOSTART").map(|number| number as i64);
        let group = airframe.and_then(|number| Some((number, airframe_group(number)?)));
        group.map_or(Self::Nothing, |(number, (class, kind))| Self::Frame {
            class,
            kind: Some(kind),
            source: format!("SYS_AUTOSTART = {number}"),
        })
    }
}

/// The mixer factors, computed from the moments of the rotors.
fn rotors(parameters: &Parameters) -> Option<Vec<(u16, [f64; 3])>> {
    let (moments, _): (Vec<[f64; 3]>, Vec<_>) = rotor_effects(parameters)?.into_iter().unzip();
    let turns = |axis: usize| moments.iter().any(|moment| moment[axis].abs() > 1e-9);
    // Positions that were never set are all 0.
    (turns(0) && turns(1)).then(|| (1..).zip(tables::normalised(moments)).collect())
}

/// The moment per unit of command of each rotor, `position x axis - KM axis`, and its force along the axis, both
/// multiplied by the thrust coefficient (<https://docs.px4.io/main/en/config/actuators.html>).
pub(crate) fn rotor_effects(parameters: &Parameters) -> Option<Vec<([f64; 3], [f64; 3])>> {
    let count = parameters.get("CA_ROTOR_COUNT")? as u16;
    let coefficients = thrust_coefficients(parameters, count.min(PX4_ROTORS));
    (0..count.min(PX4_ROTORS))
        .map(|rotor| {
            let of = |name: &str| parameters.get(&format!("CA_ROTOR{rotor}_{name}"));
            let or = |name: &str, default: f64| of(name).unwrap_or(default);
            let (px, py, pz) = (of("PX")?, of("PY")?, or("PZ", 0.0));
            let (ax, ay, az) = (or("AX", 0.0), or("AY", 0.0), or("AZ", -1.0));
            let (km, ct) = (of("KM")?, coefficients[usize::from(rotor)]);
            let moment = [
                py * az - pz * ay - km * ax,
                pz * ax - px * az - km * ay,
                px * ay - py * ax - km * az,
            ];
            Some((
                moment.map(|part| part * ct),
                [ax, ay, az].map(|part| part * ct),
            ))
        })
        .collect()
}

/// CA_ROTORn_CT of every rotor. Unless the values of all rotors are known, all rotors count as equal, which is the
/// default: combining known values with assumed ones could introduce a difference that the vehicle does not have.
fn thrust_coefficients(parameters: &Parameters, count: u16) -> Vec<f64> {
    let known = (0..count).map(|rotor| parameters.get(&format!("CA_ROTOR{rotor}_CT")));
    let known: Option<Vec<f64>> = known.collect();
    known.unwrap_or_else(|| vec![1.0; usize::from(count)])
}

/// FRAME_CLASS and FRAME_TYPE of the layout of a PX4 airframe, which depends on the group that its
/// number belongs to (<https://docs.px4.io/main/en/airframes/airframe_reference.html>).
fn airframe_group(airframe: i64) -> Option<(i64, i64)> {
    use super::tables::{HEXA, OCTA, OCTAQUAD, PLUS, QUAD, X, Y6, Y6B};
    Some(match airframe {
        // The hexacopter of PX4's own simulator.
        10_044 => (HEXA, X),
        // The wide frames are numbered like the other X frames.
        4000..=4999 | 10_000..=10_999 => (QUAD, X),
        5000..=5999 => (QUAD, PLUS),
        6000..=6999 => (HEXA, X),
        7000..=7999 => (HEXA, PLUS),
        8000..=8999 => (OCTA, X),
        9000..=9999 => (OCTA, PLUS),
        11_000..=11_999 => (Y6, Y6B),
        12_000..=12_999 => (OCTAQUAD, X),
        _ => return None,
    })
}
