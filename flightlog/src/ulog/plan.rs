//! What is read from the messages of each ULog topic.

use super::signals::{From, Spec};
use crate::Options;
use crate::angle::Angle;
use crate::place::{Place, vector_length};
use crate::signal::Label;

/// What the messages of one number are read for.
pub(super) enum Role {
    Nothing,
    /// Commands of motors or outputs: index in `outputs`.
    Outputs(usize, Vec<Place>),
    Status {
        arming: Option<Place>,
        mode: Option<Place>,
        system_type: Option<Place>,
    },
    Land(Place),
    Series(usize, Vec<Part>, Option<Place>),
}

/// One signal of a series.
pub(super) enum Part {
    Field(Place, f64),
    Length(Vec<Place>),
    Angle(Angle, [Place; 4]),
}

impl Part {
    pub(super) fn value(&self, body: &[u8]) -> Option<f64> {
        match self {
            Self::Field(place, scale) => Some(place.number(body)? * scale),
            Self::Length(places) => vector_length(places.iter().map(|place| place.number(body))),
            Self::Angle(angle, [w, x, y, z]) => {
                let number = |place: &Place| place.number(body);
                Some(angle.of([number(w)?, number(x)?, number(y)?, number(z)?]))
            }
        }
    }
}

/// The signals that a topic holds and that are asked for.
pub(super) fn parts(
    spec: &Spec,
    place: &impl Fn(&str) -> Option<Place>,
    options: &Options,
) -> Vec<(Part, Label)> {
    let part = |from: &From| {
        Some(match from {
            From::Field(field, scale) => (Part::Field(place(field)?, *scale), (*field).to_owned()),
            From::Length(fields) => {
                let places = fields.iter().map(|field| place(field));
                (
                    Part::Length(places.collect::<Option<_>>()?),
                    fields.join(", "),
                )
            }
            From::Angle(angle, field) => {
                let element = |index| place(&format!("{field}[{index}]"));
                let places = [element(0)?, element(1)?, element(2)?, element(3)?];
                (Part::Angle(*angle, places), (*field).to_owned())
            }
        })
    };
    spec.signals
        .iter()
        .filter(|(_, name, _)| options.wants(name))
        .filter_map(|(ways, name, unit)| {
            let (part, fields) = ways.iter().find_map(part)?;
            let label = Label {
                name: (*name).into(),
                unit: (*unit).into(),
                source: format!("{}.{fields}", spec.topic),
            };
            Some((part, label))
        })
        .collect()
}
