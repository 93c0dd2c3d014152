//! Serialisation of types that are not plain data: kinds by their names, tables by their columns.

use serde::ser::{Serialize, SerializeStruct, Serializer};

use crate::{Commands, Event, Format, Gap, Interval, Intervals, Series, Signal, VehicleKind};

macro_rules! by_name {
    ($($kind:ty),*) => {$(
        impl Serialize for $kind {
            fn serialize<S: Serializer>(&self, serializer: S) -> Result<S::Ok, S::Error> {
                serializer.collect_str(self)
            }
        }
    )*};
}

by_name!(Format, VehicleKind);

/// `{ "t_s": [..], "raw": [[..], ..] }`, with one row for each sample; unknown values are NaN.
impl Serialize for Commands {
    fn serialize<S: Serializer>(&self, serializer: S) -> Result<S::Ok, S::Error> {
        let rows: Vec<&[f64]> = self.rows().map(|(_, row)| row).collect();
        let mut fields = serializer.serialize_struct("Commands", 2)?;
        fields.serialize_field("t_s", self.t_s())?;
        fields.serialize_field("raw", &rows)?;
        fields.end()
    }
}

/// `{ "t_s": [..], "signals": [{ "name", "unit", "source", "values": [..] }, ..] }`
impl Serialize for Series {
    fn serialize<S: Serializer>(&self, serializer: S) -> Result<S::Ok, S::Error> {
        struct Column<'a>(Signal<'a>);

        impl Serialize for Column<'_> {
            fn serialize<S: Serializer>(&self, serializer: S) -> Result<S::Ok, S::Error> {
                let label = self.0.label;
                let mut fields = serializer.serialize_struct("Signal", 4)?;
                fields.serialize_field("name", &label.name)?;
                fields.serialize_field("unit", &label.unit)?;
                fields.serialize_field("source", &label.source)?;
                fields.serialize_field("values", self.0.values)?;
                fields.end()
            }
        }

        let signals: Vec<Column<'_>> = self.signals().map(Column).collect();
        let mut fields = serializer.serialize_struct("Series", 2)?;
        fields.serialize_field("t_s", self.t_s())?;
        fields.serialize_field("signals", &signals)?;
        fields.end()
    }
}

/// An [`Event`] as serde data.
#[derive(serde::Serialize)]
#[cfg_attr(feature = "schema", derive(schemars::JsonSchema))]
pub(crate) struct EventFields<'a, T> {
    /// The time on the clock of the log, in seconds.
    t_s: f64,
    /// The text, or the name of the mode.
    what: &'a T,
}

impl<T: Serialize> Serialize for Event<T> {
    fn serialize<S: Serializer>(&self, serializer: S) -> Result<S::Ok, S::Error> {
        let (t_s, what) = (self.t_s(), &self.what);
        EventFields { t_s, what }.serialize(serializer)
    }
}

/// [`Intervals`] as serde data.
#[derive(serde::Serialize)]
#[cfg_attr(feature = "schema", derive(schemars::JsonSchema))]
pub(crate) struct IntervalsFields<'a> {
    /// The total length of the intervals, in seconds.
    duration_s: f64,
    /// The rule that determined the intervals, such as `EV 28 (not landed) to EV 18 (land
    /// complete)`.
    rule: &'a str,
    /// The intervals, in order of time, without overlap.
    spans: &'a [Interval],
}

impl Serialize for Intervals {
    fn serialize<S: Serializer>(&self, serializer: S) -> Result<S::Ok, S::Error> {
        let fields = IntervalsFields {
            duration_s: self.duration_s(),
            rule: &self.rule,
            spans: &self.spans,
        };
        fields.serialize(serializer)
    }
}

/// A [`Gap`] as serde data.
#[derive(serde::Serialize)]
#[cfg_attr(feature = "schema", derive(schemars::JsonSchema))]
pub(crate) struct GapFields {
    /// Description of the missing information.
    reason: String,
    /// Advice for the pilot.
    help: Option<&'static str>,
}

impl Serialize for Gap {
    fn serialize<S: Serializer>(&self, serializer: S) -> Result<S::Ok, S::Error> {
        let (reason, help) = (self.to_string(), self.help());
        GapFields { reason, help }.serialize(serializer)
    }
}

#[cfg(test)]
mod tests {
    use crate::Flight;

    #[test]
    fn a_flight_as_json() {
        let log = "# frame: QUAD/X\n# effective_low: 0.25\n# effective_high: 1\nt_s,motor1,motor2,motor3,motor4,in_air,roll_deg\n0,0.5,,0.5,0.5,0,1.5\n1,0.5,0.5,0.5,0.5,1,\n3,0.5,0.5,0.5,0.5,1,2\n";
        let flight: Flight = crate::read(log.as_bytes(), &crate::Options::default()).unwrap();
        let json = serde_json::to_value(&flight).unwrap();
        assert_eq!(json["format"], "flight CSV");
        assert_eq!(json["motors"][0]["number"], 1);
        assert_eq!(json["geometry"]["basis"], "declared");
        assert_eq!(json["effective_range"]["low"], 0.25);
        assert_eq!(json["commands"]["t_s"][2], 3.0);
        assert!(json["commands"]["raw"][0][1].is_null());
        let roll = &json["series"][0]["signals"][0];
        assert_eq!(
            (&roll["name"], &roll["unit"]),
            (&"roll_deg".into(), &"deg".into())
        );
        assert!(roll["values"][1].is_null());
        assert_eq!(json["in_air"]["duration_s"], 2.0);
        assert_eq!(json["in_air"]["spans"][0]["start_s"], 1.0);
        assert_eq!(json["report"]["messages"], 3);
        let gaps = serde_json::to_value(flight.gaps()).unwrap();
        assert_eq!(
            gaps[0]["reason"],
            "the attitude or its set point is not in the log"
        );
    }
}
