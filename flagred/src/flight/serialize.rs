//! An assessment as serde data, with the names that docs/json.md describes.

use alloc::string::{String, ToString};

use serde::{Serialize, Serializer, ser::SerializeMap, ser::SerializeStruct};

use super::{Assessment, Finding, Step, Summary, Verdict};
use crate::sample::serialize_risk;

impl Serialize for Verdict {
    fn serialize<S: Serializer>(&self, serializer: S) -> Result<S::Ok, S::Error> {
        let mut fields = serializer.serialize_struct("Verdict", 3)?;
        fields.serialize_field("verdict", &self.to_string())?;
        if let Verdict::NotAvailable(reason) = self {
            fields.serialize_field("reason", &reason.to_string())?;
            fields.serialize_field("help", &reason.help())?;
        }
        fields.end()
    }
}

impl Serialize for Assessment {
    fn serialize<S: Serializer>(&self, serializer: S) -> Result<S::Ok, S::Error> {
        #[derive(Serialize)]
        struct Fields<'a> {
            #[serde(flatten)]
            verdict: &'a Verdict,
            findings: &'a [Finding],
            findings_left_out: u64,
            summary: &'a Summary,
            steps: Steps<'a>,
            widened_step_s: Option<f64>,
        }
        let fields = Fields {
            verdict: &self.verdict,
            findings: &self.findings,
            findings_left_out: self.findings_left_out,
            summary: &self.summary,
            steps: self.steps_by_name(),
            widened_step_s: self.widened_step_s,
        };
        fields.serialize(serializer)
    }
}

impl Assessment {
    /// The steps as serde data, with the inputs by their names.
    pub fn steps_by_name(&self) -> Steps<'_> {
        Steps(self)
    }
}

impl Step {
    /// The step as serde data, with the inputs by their names: those of [`Assessment::inputs`].
    pub fn by_name<'a>(&'a self, names: &'a [String]) -> impl Serialize + 'a {
        Named { names, step: self }
    }
}

/// The steps of a flight as serde data; from [`Assessment::steps_by_name`].
#[derive(Debug, Clone, Copy)]
pub struct Steps<'a>(&'a Assessment);

impl Serialize for Steps<'_> {
    fn serialize<S: Serializer>(&self, serializer: S) -> Result<S::Ok, S::Error> {
        let names = &self.0.inputs;
        serializer.collect_seq(self.0.steps.iter().map(|step| Named { names, step }))
    }
}

struct Named<'a> {
    names: &'a [String],
    step: &'a Step,
}

impl Serialize for Named<'_> {
    fn serialize<S: Serializer>(&self, serializer: S) -> Result<S::Ok, S::Error> {
        struct Inputs<'a, 'b>(&'b Named<'a>);
        impl Serialize for Inputs<'_, '_> {
            fn serialize<S: Serializer>(&self, serializer: S) -> Result<S::Ok, S::Error> {
                serializer.collect_map(self.0.names.iter().zip(&self.0.step.inputs))
            }
        }
        let step = self.step;
        let mut fields = serializer.serialize_map(None)?;
        fields.serialize_entry("t_s", &step.t_s)?;
        serialize_risk(&mut fields, step.estimate, step.elevated_risk_pct)?;
        fields.serialize_entry("margin", &step.margin)?;
        fields.serialize_entry("spread", &step.spread)?;
        fields.serialize_entry("judged", &step.judged)?;
        fields.serialize_entry("inputs", &Inputs(self))?;
        fields.end()
    }
}
