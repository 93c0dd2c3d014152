//! `flagred check`: errors, gaps and conflicts in a rule set; whether a profile matches its rule set.

mod format;

use std::{
    io::Write,
    path::{Path, PathBuf},
};

use flagred::{
    check::{InputRisk, risks_of_single_inputs},
    profile::Profile,
    verdict::Level,
};
use flagred_authoring::{Examination, answers::CheckDocument, is_profile, provenance};
use fuzzy::{
    Source,
    check::{self, AcceptedFindings},
    diagnostic::{Findings, Severity},
    drawing::{number, visible},
};

use self::format::{Format, Sarif, write_github};
use crate::{
    built_in,
    diagnostics::{draw, read_text},
    failure::{Exit, Failure},
    numbers,
    output::{Files, Stdout},
    profile, rows,
};

#[derive(clap::Args)]
pub(crate) struct Arguments {
    /// Rule sets in YAML, FIS, FLL, FCL or FML, profiles in YAML, the name of a built-in profile, or `-` for standard input
    #[arg(required = true, value_name = "FILE")]
    models: Vec<PathBuf>,
    /// How to print the findings
    #[arg(long, value_enum, default_value = "text", value_name = "FORMAT")]
    format: Format,
    /// Print JSON documents instead of text, one for each file; the same as `--format json`
    #[arg(long, conflicts_with = "format")]
    json: bool,
    #[command(flatten)]
    claims: rows::OutputClaims,
    /// Warn where the coverage, the largest firing strength of any rule, is below this value from 0 to 1
    #[arg(long, value_name = "STRENGTH", default_value_t = 0.5, value_parser = numbers::degree_above_0)]
    coverage: f64,
    /// Also exit with 1 for findings of this severity or a higher one [default: only for errors]
    #[arg(long, value_name = "SEVERITY")]
    deny: Option<DenyLevel>,
}

#[derive(Clone, Copy, clap::ValueEnum)]
enum DenyLevel {
    /// Warnings
    Warnings,
    /// Warnings and notes
    Notes,
}

pub(crate) fn run(arguments: &Arguments) -> Result<Exit, Failure> {
    let worst_allowed = match arguments.deny {
        None => Severity::Warning,
        Some(DenyLevel::Warnings) => Severity::Note,
        Some(DenyLevel::Notes) => return check_all(arguments, None),
    };
    check_all(arguments, Some(worst_allowed))
}

fn check_all(arguments: &Arguments, worst_allowed: Option<Severity>) -> Result<Exit, Failure> {
    Files::reading(&arguments.models)?;
    let format = if arguments.json {
        Format::Json
    } else {
        arguments.format
    };
    let mut sarif = Sarif::default();
    let mut exit = Exit::Clean;
    for path in &arguments.models {
        // As in `assess`, a built-in name selects the profile of that name.
        let text = match built_in::profile_at(path) {
            Some(known) => known.text.to_owned(),
            None => read_text(path).map_err(|failure| arguments.claims.or_input(path, failure))?,
        };
        let file = path.display().to_string();
        let source = flagred_interchange::source(text);
        let text = source.text();
        let (of_profile, examined, accepted) = if is_profile(&source) {
            arguments.claims.about_rule_sets(path)?;
            let examined = examine_profile(path, &source)?;
            let (profile, findings, input_risks, accepted) = examined;
            let analysed = None;
            let examined = Examination { findings, analysed };
            (Some((profile, input_risks)), examined, accepted)
        } else {
            let examined = examine(&source, arguments)?;
            let accepted = examined.accepted();
            (None, examined, accepted)
        };
        let findings = &examined.findings;
        // Only text for people is coloured.
        let mut out = match format {
            Format::Text => Stdout::text(),
            _ => Stdout::data(),
        };
        match format {
            Format::Text => {
                write!(out, "{}", draw(&findings.0, &file, text, true))?;
                let steps = examined
                    .analysed
                    .iter()
                    .flat_map(|(document, _)| &document.model.provenance);
                for step in steps {
                    let made = visible(&provenance::words(step)).to_string();
                    writeln!(out, "{}: made by {made}", visible(&file))?;
                }
                // An entry that accepts no finding is itself reported as a finding.
                for one in accepted.iter().filter(|one| one.count > 0) {
                    let (code, because) = (visible(&one.finding), visible(&one.because));
                    let of = one
                        .of
                        .as_deref()
                        .map_or(String::new(), |of| format!(" of `{of}`"));
                    writeln!(
                        out,
                        "{}: {} x `{code}`{} accepted: {because}",
                        visible(&file),
                        one.count,
                        visible(&of)
                    )?;
                }
                if let Some((profile, input_risks)) = &of_profile {
                    write_input_risks(&mut out, &file, input_risks)?;
                    let reads_motors = profile.as_ref().is_none_or(Profile::reads_motors);
                    if !reads_motors {
                        writeln!(
                            out,
                            "{}: the profile reads no motors, so logs without motors can be assessed",
                            visible(&file)
                        )?;
                    }
                }
                writeln!(out, "{}: {}", visible(&file), summary(findings))?;
            }
            Format::Json => {
                let json = match &of_profile {
                    Some((profile, input_risks)) => {
                        let name = profile.as_ref().map(|profile| profile.name.as_str());
                        CheckDocument::profile(&file, name, &findings.0, input_risks)
                            .with_accepted(accepted)
                    }
                    None => CheckDocument::rules(&file, &examined),
                };

                serde_json::to_writer_pretty(&mut out, &json).map_err(std::io::Error::from)?;
                writeln!(out)?;
            }
            Format::Sarif => sarif.add(&findings.0, &file, text),
            Format::Github => write_github(&mut out, &findings.0, &file, text)?,
        }
        out.finish()?;
        let worst = findings.0.iter().map(|finding| finding.severity).max();
        let violates_claim = findings.0.iter().any(|one| one.code == "not-monotone");
        if worst > worst_allowed || violates_claim {
            exit = Exit::Findings;
        }
    }
    if format == Format::Sarif {
        let mut out = Stdout::data();
        sarif.write(&mut out)?;
        out.finish()?;
    }
    Ok(exit)
}

/// Returns all findings, and the analysis if the rule set can be analysed.
fn examine<'s>(source: &'s Source, arguments: &Arguments) -> Result<Examination<'s>, Failure> {
    let mut options = check::Options::default();
    options.coverage = arguments.coverage;
    options.monotone = arguments.claims.monotone()?;
    flagred_authoring::examine(source, &options).map_err(|finding| {
        Failure::usage(format!("`--rising` or `--falling`: {}", finding.message))
            .help_if(arguments.claims.joined().or(finding.help))
    })
}

/// A profile, all findings about it and its rule set, the highest risk that each of its inputs causes while all other inputs
/// are calm, and the findings that the author accepts.
type ExaminedProfile = (
    Option<Profile>,
    Findings,
    Vec<InputRisk>,
    Vec<AcceptedFindings>,
);

/// Reads and checks a profile. Errors of its rule set are returned as a failure, because they are in another file.
fn examine_profile(path: &Path, source: &Source) -> Result<ExaminedProfile, Failure> {
    let profile = match Profile::from_source(source) {
        Ok(profile) => profile,
        Err(findings) => return Ok((None, findings, Vec::new(), Vec::new())),
    };
    let is_file = path != Path::new("-") && built_in::profile_at(path).is_none();
    let folder = is_file.then(|| path.parent()).flatten();
    let file = path.display().to_string();
    let rules = profile::rule_set(&profile, (&file, source), folder)?;
    let (findings, estimator) = profile::examine(source, &rules);
    let input_risks = estimator
        .as_ref()
        .map(risks_of_single_inputs)
        .unwrap_or_default();
    let accepted = profile::accepted(source, &rules);
    Ok((Some(profile), findings, input_risks, accepted))
}

/// Writes a line for each input: `battery  0 (empty)  battery_risk 95 %, FAIL`.
fn write_input_risks(
    out: &mut impl Write,
    file: &str,
    input_risks: &[InputRisk],
) -> Result<(), Failure> {
    if input_risks.is_empty() {
        return Ok(());
    }
    let file = visible(file);
    writeln!(
        out,
        "{file}: the highest risk that each input causes while all others are calm:"
    )?;
    let rows: Vec<[String; 3]> = input_risks.iter().map(row).collect();
    let width = |column: usize| {
        let cells = rows.iter().map(|row| row[column].chars().count());
        cells.max().unwrap_or(0)
    };
    let (first, second) = (width(0), width(1));
    for [input, value, risk] in &rows {
        writeln!(out, "  {input:<first$}  {value:<second$}  {risk}")?;
    }
    Ok(())
}

fn row(one: &InputRisk) -> [String; 3] {
    let value = number(one.value, 4);
    let value = match &one.term {
        Some(term) => format!("{value} ({})", visible(term)),
        None => value,
    };
    let mut risk = format!("{} {:.0} %", visible(&one.risk_output), one.risk_pct);
    if one.level > Level::Good {
        risk += &format!(", {}", one.level);
    }
    [visible(&one.input).to_string(), value, risk]
}

fn summary(findings: &Findings) -> String {
    let count = |severity: Severity, word: &str| {
        let count = findings.0.iter().filter(|f| f.severity == severity).count();
        let plural = if count == 1 { "" } else { "s" };
        (count > 0).then(|| format!("{count} {word}{plural}"))
    };
    let counts = [
        count(Severity::Error, "error"),
        count(Severity::Warning, "warning"),
        count(Severity::Note, "note"),
    ];
    let counts: Vec<String> = counts.into_iter().flatten().collect();
    if counts.is_empty() {
        "no findings".into()
    } else {
        counts.join(", ")
    }
}
