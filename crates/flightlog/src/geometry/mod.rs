//! Motor geometry: how much each motor rolls, pitches and yaws the vehicle, with its source.

mod declared_layout;
pub(crate) mod infer;
pub(crate) mod tables;

pub(crate) use declared_layout::{DeclaredLayout, rotor_effects};

use crate::{Flight, Motor, Series, VehicleKind};

/// The mixer factors of the motors, and their source.
///
/// # Example: a yaw command is not an imbalance
/// ```
/// let log = "# frame: QUAD/X\nt_s,motor1,motor2,motor3,motor4\n0,0.6,0.6,0.4,0.4\n";
/// let flight = flagred_flightlog::read(log.as_bytes(), &flagred_flightlog::Options::default())?;
/// let geometry = flight.geometry.unwrap();
/// assert_eq!(geometry.frame.as_deref(), Some("QUAD/X"));
/// // All of the difference between these motors is yaw.
/// let (_, row) = flight.commands.rows().next().unwrap();
/// let yaw: f64 = geometry.factors.iter().zip(row).map(|([_, _, yaw], c)| yaw * c).sum();
/// assert!((yaw - 0.4).abs() < 1e-12);
/// # Ok::<(), flagred_flightlog::ReadError>(())
/// ```
#[derive(Debug, Clone, PartialEq)]
#[cfg_attr(feature = "serde", derive(serde::Serialize))]
#[cfg_attr(feature = "schema", derive(schemars::JsonSchema))]
#[non_exhaustive]
pub struct Geometry {
    /// `[roll, pitch, yaw]` of each motor, in the order of [`Flight::motors`]; the largest of each axis is 1. More
    /// thrust of a motor rolls the vehicle to the right if roll is positive (a motor on the left), raises the nose if
    /// pitch is positive (a motor in front), and turns the nose to the right if yaw is positive (a propeller that turns
    /// counter-clockwise). Yaw is 0 for all motors if no motor command turns the vehicle, as on a tricopter.
    pub factors: Vec<[f64; 3]>,
    /// The frame class and type with ArduPilot's names, such as `QUAD/X`; `None` for motor positions without a name.
    pub frame: Option<String>,
    /// Whether the geometry is declared, inferred or assumed.
    pub basis: Basis,
    /// The source, such as `FRAME_CLASS = 1, FRAME_TYPE = 1`.
    pub source: String,
    /// The reason why the commands contradict the geometry; `None` if they do not.
    pub doubt: Option<String>,
}

impl Geometry {
    /// The position of a motor on the vehicle, seen from above with the nose in front: `front left`, `rear`. `None` if
    /// there is no such motor, if the motor is in the middle, if the geometry is in doubt, or if it is not declared,
    /// because an inferred geometry may be rotated.
    pub fn position(&self, motor: usize) -> Option<&'static str> {
        // A motor up to 20 degrees to the side of an axis still counts as on the axis.
        const ON_AXIS: f64 = 0.364;
        let [roll, pitch, _] = *self.factors.get(motor)?;
        if self.basis != Basis::Declared || self.doubt.is_some() {
            return None;
        }
        let sign = |value: f64, other: f64| match value.abs() > ON_AXIS * other.abs() {
            true => value.signum(),
            false => 0.0,
        };
        Some(match (sign(pitch, roll), sign(roll, pitch)) {
            (1.0, 1.0) => "front left",
            (1.0, -1.0) => "front right",
            (1.0, _) => "front",
            (-1.0, 1.0) => "rear left",
            (-1.0, -1.0) => "rear right",
            (-1.0, _) => "rear",
            (_, 1.0) => "left",
            (_, -1.0) => "right",
            _ => return None,
        })
    }
}

/// The first and last time of the data that is read from every log, whichever signals are kept: the motor commands and
/// the signals of the geometry. Other signals are ignored, because the choice of kept signals must not affect when the
/// vehicle counts as armed or in the air. If a log contains none of this data, the times are those of all kept
/// signals.
pub(crate) fn span_s(flight: &Flight) -> Option<(f64, f64)> {
    let is_read = |series: &&Series| {
        let mut signals = series.signals();
        signals.any(|signal| infer::SIGNALS.contains(&signal.label.name.as_str()))
    };
    let series = flight.series.iter().filter(is_read).map(Series::t_s);
    std::iter::once(flight.commands.t_s())
        .chain(series)
        .filter_map(|t_s| Some((*t_s.first()?, *t_s.last()?)))
        .reduce(|a, b| (a.0.min(b.0), a.1.max(b.1)))
        .or_else(|| flight.time_span_s())
}

/// How a [`Geometry`] was determined.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
#[cfg_attr(feature = "serde", derive(serde::Serialize))]
#[cfg_attr(feature = "schema", derive(schemars::JsonSchema))]
#[cfg_attr(feature = "serde", serde(rename_all = "lowercase"))]
#[non_exhaustive]
pub enum Basis {
    /// Declared by parameters, messages or a header.
    Declared,
    /// Inferred from the motor commands, which fit only one of the common layouts.
    Inferred,
    /// The most common layout for this number of motors. The usual motor orders of ArduPilot and PX4 have the same yaw
    /// pattern; roll and pitch may be rotated.
    Assumed,
}

impl std::fmt::Display for Basis {
    fn fmt(&self, f: &mut std::fmt::Formatter<'_>) -> std::fmt::Result {
        f.write_str(match self {
            Self::Declared => "declared",
            Self::Inferred => "inferred",
            Self::Assumed => "assumed",
        })
    }
}

/// A frame of ArduPilot: its FRAME_CLASS and FRAME_TYPE, its name, and the number and the factors of each motor.
#[derive(Debug, Clone, PartialEq)]
#[non_exhaustive]
pub struct Frame {
    /// FRAME_CLASS.
    pub class: i64,
    /// FRAME_TYPE.
    pub kind: i64,
    /// The name, such as `QUAD/X`.
    pub name: String,
    /// The number and the factors of each motor; see [`Geometry::factors`].
    pub motors: Vec<(u16, [f64; 3])>,
}

/// Returns the frames of ArduPilot whose motors are known, for programs that read FRAME_CLASS and FRAME_TYPE
/// themselves.
///
/// # Example
/// ```
/// let x = flagred_flightlog::ardupilot_frames().find(|frame| frame.name == "QUAD/X").unwrap();
/// assert_eq!((x.class, x.kind, x.motors[0]), (1, 1, (1, [-1.0, 1.0, 1.0])));
/// ```
pub fn ardupilot_frames() -> impl Iterator<Item = Frame> {
    tables::frames().filter_map(|(class, kind)| {
        Some(Frame {
            class,
            kind,
            name: tables::name(class, kind),
            motors: tables::layout(class, kind)?,
        })
    })
}

/// The geometry of these motors from the declared layout. Quadrotors of an unknown type are assumed to have the usual
/// motor numbers.
pub(crate) fn of(motors: &[Motor], declared: &DeclaredLayout) -> Option<Geometry> {
    let layout = match declared {
        DeclaredLayout::Factors { factors, .. } => Some(factors.clone()),
        DeclaredLayout::Frame { class, kind, .. } => {
            // The type of a tricopter is rarely set. All types but one have the same layout, so X is assumed.
            let kind = kind.or((*class == tables::TRI).then_some(tables::X));
            kind.and_then(|kind| tables::layout(*class, kind))
        }
        DeclaredLayout::Nothing => None,
    };
    if let Some(factors) = layout.and_then(|layout| in_order(motors, &layout)) {
        return Some(Geometry {
            factors,
            frame: declared.frame(),
            basis: Basis::Declared,
            source: declared.source().to_owned(),
            doubt: None,
        });
    }
    let is_quad =
        motors.len() == 4 && !matches!(declared.class(), Some(class) if class != tables::QUAD);
    let factors =
        in_order(motors, &tables::layout(tables::QUAD, tables::X)?).filter(|_| is_quad)?;
    Some(Geometry {
        factors,
        frame: Some(tables::name(tables::QUAD, tables::X)),
        basis: Basis::Assumed,
        source: "usual order of four motors; the type of the frame is not known".into(),
        doubt: None,
    })
}

/// The geometry of a flight from the layout that its log declares, or inferred from its commands if the log declares
/// none. Records a doubt if the commands contradict the declared layout.
pub(crate) fn find(flight: &Flight, declared: &DeclaredLayout) -> Option<Geometry> {
    if !matches!(
        flight.vehicle.kind,
        VehicleKind::Multirotor | VehicleKind::Unknown
    ) {
        return None;
    }
    match of(&flight.motors, declared) {
        Some(mut geometry) if geometry.basis == Basis::Declared => {
            geometry.doubt = infer::contradiction(flight, &geometry);
            Some(geometry)
        }
        assumed => infer::geometry(flight, declared.class()).or(assumed),
    }
}

/// The factors of these motors, by their numbers; `None` if one is missing from the layout.
fn in_order(motors: &[Motor], layout: &[(u16, [f64; 3])]) -> Option<Vec<[f64; 3]>> {
    let of_motor = |motor: &Motor| {
        let found = layout.iter().find(|(number, _)| *number == motor.number);
        found.map(|(_, factors)| *factors)
    };
    let factors: Vec<[f64; 3]> = motors.iter().map(of_motor).collect::<Option<_>>()?;
    (factors.len() == layout.len()).then_some(factors)
}

#[cfg(test)]
mod tests;
