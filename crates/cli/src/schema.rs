//! `flagred schema`: the JSON Schemas of the formats that are read and written.

use std::io::Write;

use crate::{
    failure::{Exit, Failure},
    output::Stdout,
};

#[derive(clap::Args)]
pub(crate) struct Arguments {
    /// The format
    format: Format,
}

#[derive(Clone, Copy, clap::ValueEnum)]
enum Format {
    /// A rule set
    RuleSet,
    /// A profile
    Profile,
    /// What `flagred assess --json` prints
    Assess,
    /// What `flagred check --json` prints
    Check,
    /// What `flagred validate --json` prints
    #[value(alias = "evaluate")]
    Validate,
    /// What `flagred explain --json` prints
    Explain,
    /// What `flagred identify --json` prints
    Identify,
    /// What `flagred inspect --json` prints
    Inspect,
    /// What `flagred learn --json` prints
    Learn,
    /// What `flagred simplify --json` prints
    Simplify,
    /// What `flagred tune --json` prints
    Tune,
    /// A line of `flagred watch --jsonl`
    Watch,
    /// A line of `flagred watch --all --jsonl`
    WatchAll,
}

pub(crate) fn run(arguments: &Arguments) -> Result<Exit, Failure> {
    let mut out = Stdout::data();
    let text = match arguments.format {
        Format::RuleSet => {
            let schema = fuzzy::format::schema();
            serde_json::to_writer_pretty(&mut out, &schema).map_err(std::io::Error::from)?;
            "\n"
        }
        Format::Profile => flagred::profile::SCHEMA,
        Format::Assess => include_str!("../schemas/assess.json"),
        Format::Check => include_str!("../schemas/check.json"),
        Format::Validate => include_str!("../schemas/evaluate.json"),
        Format::Explain => include_str!("../schemas/explain.json"),
        Format::Identify => include_str!("../schemas/identify.json"),
        Format::Inspect => include_str!("../schemas/inspect.json"),
        Format::Learn => include_str!("../schemas/learn.json"),
        Format::Simplify => include_str!("../schemas/simplify.json"),
        Format::Tune => include_str!("../schemas/tune.json"),
        Format::Watch => include_str!("../schemas/watch.json"),
        Format::WatchAll => include_str!("../schemas/watch-all.json"),
    };
    write!(out, "{text}")?;
    out.finish()?;
    Ok(Exit::Clean)
}
