//! Determines how each ULog topic is used.

use super::signals::{SignalSource, TopicSpec};
use crate::Options;
use crate::angle::Angle;
use crate::field::{NumericField, vector_length};
use crate::signal::Label;

/// How the messages of one topic are used.
pub(super) enum TopicRole {
    Nothing,
    /// Commands of motors or outputs: the index in `outputs`, and the fields of the commands.
    Outputs(usize, Vec<NumericField>),
    Status {
        arming: Option<NumericField>,
        mode: Option<NumericField>,
        system_type: Option<NumericField>,
    },
    Land(NumericField),
    Series(usize, Vec<ResolvedSource>, Option<NumericField>),
}

/// One signal of a series.
pub(super) enum ResolvedSource {
    Field(NumericField, f64),
    Length(Vec<NumericField>),
    Position(NumericField, f64),
    If(NumericField, NumericField),
    Angle(Angle, [NumericField; 4]),
}

impl ResolvedSource {
    pub(super) fn value(&self, body: &[u8]) -> Option<f64> {
        match self {
            Self::Field(field, scale) => Some(field.number(body)? * scale),
            Self::Length(fields) => vector_length(fields.iter().map(|field| field.number(body))),
            Self::Position(field, scale) => {
                let number = field.number(body).filter(|number| *number != 0.0);
                number.map(|number| number * scale)
            }
            Self::If(field, flag) => {
                let valid = flag.number(body).filter(|flag| *flag == 1.0);
                valid.and_then(|_| field.number(body))
            }
            Self::Angle(angle, [w, x, y, z]) => {
                let number = |field: &NumericField| field.number(body);
                Some(angle.of([number(w)?, number(x)?, number(y)?, number(z)?]))
            }
        }
    }
}

/// The signals that a topic contains and that the options request.
pub(super) fn parts(
    spec: &TopicSpec,
    find: &impl Fn(&str) -> Option<NumericField>,
    options: &Options,
) -> Vec<(ResolvedSource, Label)> {
    let part = |from: &SignalSource| {
        Some(match from {
            SignalSource::Field(field, scale) => (
                ResolvedSource::Field(find(field)?, *scale),
                (*field).to_owned(),
            ),
            SignalSource::Length(fields) => {
                let found = fields.iter().map(|field| find(field));
                (
                    ResolvedSource::Length(found.collect::<Option<_>>()?),
                    fields.join(", "),
                )
            }
            SignalSource::Position(field, scale) => (
                ResolvedSource::Position(find(field)?, *scale),
                (*field).to_owned(),
            ),
            SignalSource::If(field, flag) => (
                ResolvedSource::If(find(field)?, find(flag)?),
                (*field).to_owned(),
            ),
            SignalSource::Angle(angle, field) => {
                let element = |index| find(&format!("{field}[{index}]"));
                let found = [element(0)?, element(1)?, element(2)?, element(3)?];
                (ResolvedSource::Angle(*angle, found), (*field).to_owned())
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
