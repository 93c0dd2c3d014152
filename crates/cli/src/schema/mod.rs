//! `flagred schema`: the JSON Schemas of the formats that are read and written.

mod closed;

use std::io::Write;

use flagred_authoring::answers::{CheckDocument, Explained};
use flagred_report::{document::Document as FlightDocument, moment::Moment};
use schemars::{JsonSchema, SchemaGenerator, generate::SchemaSettings};
use serde_json::Value;

use self::closed::closed;
use crate::{
    failure::{Exit, Failure},
    identify, inspect, learn,
    output::Stdout,
    simplify, tune, watch,
};

#[derive(clap::Args)]
pub(crate) struct Arguments {
    /// The format whose schema is printed
    format: Format,
}

#[derive(Clone, Copy, clap::ValueEnum)]
enum Format {
    /// A rule set
    RuleSet,
    /// A profile
    Profile,
    /// The output of `flagred assess --json`
    Assess,
    /// The output of `flagred check --json`
    Check,
    /// The output of `flagred validate --json`
    #[value(alias = "evaluate")]
    Validate,
    /// The output of `flagred explain --json`
    Explain,
    /// The output of `flagred identify --json`
    Identify,
    /// The output of `flagred inspect --json`
    Inspect,
    /// The output of `flagred learn --json`
    Learn,
    /// The output of `flagred simplify --json`
    Simplify,
    /// The output of `flagred tune --json`
    Tune,
    /// A line of `flagred watch --jsonl`
    Watch,
    /// A line of `flagred watch --all --jsonl`
    WatchAll,
}

pub(crate) fn run(arguments: &Arguments) -> Result<Exit, Failure> {
    let mut out = Stdout::data();
    let schema = match arguments.format {
        Format::RuleSet => {
            serde_json::to_value(fuzzy::format::schema()).map_err(std::io::Error::from)?
        }
        Format::Profile => {
            write!(out, "{}", flagred::profile::SCHEMA)?;
            out.finish()?;
            return Ok(Exit::Clean);
        }
        Format::Assess => of::<FlightDocument<'_>>("assess", "assess --json"),
        Format::Check => of::<CheckDocument<'_>>("check", "check --json"),
        Format::Validate => of::<flagred_evaluation::Document<'_>>("evaluate", "validate --json"),
        Format::Explain => of::<Explained<'_>>("explain", "explain --json"),
        Format::Identify => of::<identify::Document<'_>>("identify", "identify --json"),
        Format::Inspect => of::<inspect::Document<'_>>("inspect", "inspect --json"),
        Format::Learn => of::<learn::Document<'_>>("learn", "learn --json"),
        Format::Simplify => of::<simplify::Document<'_>>("simplify", "simplify --json"),
        Format::Tune => of::<tune::Document<'_>>("tune", "tune --json"),
        Format::Watch => of::<watch::Line<'_>>("watch", "watch --jsonl"),
        Format::WatchAll => of::<watch::FleetLine<'_>>("watch-all", "watch --all --jsonl"),
    };
    serde_json::to_writer_pretty(&mut out, &schema).map_err(std::io::Error::from)?;
    writeln!(out)?;
    out.finish()?;
    Ok(Exit::Clean)
}

fn generator() -> SchemaGenerator {
    SchemaSettings::draft2020_12()
        .for_serialize()
        .into_generator()
}

/// Returns the schema of a document that a command prints, under this name.
fn of<T: JsonSchema>(name: &str, command: &str) -> Value {
    let mut schema = generator().into_root_schema_for::<T>();
    schema.insert("$id".into(), format!("flagred.{name}/1").into());
    schema.insert("title".into(), format!("flagred {command}").into());
    closed(schema.to_value())
}

/// Returns the types of the documents that the npm package returns, as the `$defs` of a schema.
pub fn npm_types() -> Value {
    let mut generator = generator();
    generator.subschema_for::<FlightDocument<'_>>();
    generator.subschema_for::<Moment<'_>>();
    generator.subschema_for::<Explained<'_>>();
    closed(serde_json::json!({"$defs": generator.take_definitions(true)}))
}
