//! Profiles, which map the signals of a flight to the inputs of a rule set, and its risk to levels for the pilot.

use alloc::{string::String, vec::Vec};

use fuzzy::model::AllowedFinding;

use crate::{
    accumulator::AccumulatorSettings,
    channel::{self, Channel, Input},
    craft::Craft,
    follower::Settings,
    gap::GapSettings,
    source::{Signal, Source, channels},
    verdict::{LevelSettings, NoticeSettings, VerdictSettings},
};

mod read;
mod rewrite;

pub use crate::sample::Sampling;

/// The JSON Schema of the format, for editors that complete and check the text.
pub const SCHEMA: &str = include_str!("../../rules/profile-schema.json");

/// All settings for the assessment of a flight, except the rules.
///
/// # Example: an additional input without a change of code
///
/// ```
/// use flagred::profile::Profile;
///
/// let profile: Profile = "
/// flagred: 1
/// name: with-battery
/// rules: my-rules.yaml
/// window_s: 2
/// inputs:
///   margin: {mean: motor_margin}
///   spread: {std: motor_command}
///   lowest: {mean: {min: motor_margin}, window_s: 10}
///   battery: {last: battery_remaining_pct}
/// ".parse()?;
/// assert_eq!(profile.inputs.len(), 4);
/// assert_eq!(profile.signals(), ["battery_remaining_pct"]);
///
/// let mistake = "flagred: 1\nname: x\nrules: y\ninputs: {m: {meen: motor_margin}}".parse::<Profile>();
/// assert!(mistake.unwrap_err().to_string().contains("did you mean `mean`?"));
/// # Ok::<(), fuzzy::diagnostic::Findings>(())
/// ```
#[derive(Debug, Clone, PartialEq)]
pub struct Profile {
    /// The name of the profile, as reports show it.
    pub name: String,
    /// A description of the profile, written by its author.
    pub description: Option<String>,
    /// The rule set: the name of a shipped one ([`crate::shipped`]), or of a file next to the profile.
    pub rules: String,
    /// The window of inputs that do not set their own, in seconds.
    pub window_s: f64,
    /// The sources of the inputs of the rule set.
    pub inputs: Vec<ProfileInput>,
    /// The output of the rule set that is the risk, in %.
    pub output: String,
    /// The conditions under which an input counts as known.
    pub sampling: Sampling,
    /// How gaps of the rules are filled.
    pub gap: GapSettings,
    /// The parameters of the elevated risk.
    pub elevated_risk: AccumulatorSettings,
    /// The conditions under which levels are raised and cleared.
    pub verdict: VerdictSettings,
    /// Other outputs that are risks.
    pub other_risks: Vec<OtherRisk>,
    /// The words of findings for the pilot, by the input that raised the risk. Inputs without an entry are described by
    /// their names.
    pub findings: Vec<CauseWords>,
    /// How often large attitude errors followed each band of the risk, ascending; empty if it was not measured.
    pub reliability: Vec<Reliability>,
    /// The findings of `check` that the author accepts.
    pub allow: Vec<AllowedFinding>,
}

/// The codes of findings that the author of a profile can accept.
pub(crate) const FINDINGS: [&str; 6] = [
    "outvoted",
    "out-of-reach",
    "order",
    "unit",
    "unknown-signal",
    "missing-threshold",
];

/// An entry of `allow`, as an example in messages.
pub(crate) const ALLOW: &str =
    "{finding: outvoted, of: battery, because: it acts only with other inputs}";

/// The words of a finding for the pilot, by the input that raised the risk.
#[derive(Debug, Clone, PartialEq, Eq)]
pub struct CauseWords {
    /// The name of the input in the profile.
    pub input: String,
    /// A stable identifier for use by programs: lower-case letters, digits and `_`.
    pub code: String,
    /// Two or three words, at most 20 ASCII characters, for messages limited to 50 characters.
    pub brief: String,
    /// What happened, and what it means. `{value}` is the value of the input, `{percent}` 100 times that.
    pub text: String,
    /// What to do.
    pub advice: String,
}

/// The attitude error that counts as a risk of 100 %, in degrees: the critical error of the paper.
pub const CRITICAL_ERROR_DEG: f64 = 5.0;

/// How often a large attitude error followed moments with a risk in a band.
#[derive(Debug, Clone, Copy, PartialEq)]
#[cfg_attr(feature = "serde", derive(serde::Serialize))]
#[cfg_attr(feature = "schema", derive(schemars::JsonSchema))]
pub struct Reliability {
    /// The lower end of the band in %, inclusive.
    pub from_pct: f64,
    /// The upper end of the band in %, exclusive except for 100.
    pub to_pct: f64,
    /// The frequency on flights of real vehicles.
    pub real: Option<ErrorFrequency>,
    /// The frequency on flights of simulated vehicles.
    pub simulated: Option<ErrorFrequency>,
}

/// How many of the moments were followed by an attitude error over 5 degrees within 5 s.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
#[cfg_attr(feature = "serde", derive(serde::Serialize))]
#[cfg_attr(feature = "schema", derive(schemars::JsonSchema))]
#[cfg_attr(feature = "schema", schemars(rename = "Followed"))]
pub struct ErrorFrequency {
    /// The number of moments, one every 0.5 s.
    pub moments: u64,
    /// The number of these moments that were followed by an attitude error over 5 degrees within 5 s.
    pub followed: u64,
}

impl ErrorFrequency {
    /// The share of `followed` in `moments`, in %; `None` without any moment.
    pub fn share_pct(&self) -> Option<f64> {
        (self.moments > 0).then(|| 100.0 * self.followed as f64 / self.moments as f64)
    }
}

/// Another output that is a risk, with its own levels. The findings about it are the same as if it were the only risk of the
/// profile.
#[derive(Debug, Clone, PartialEq)]
pub struct OtherRisk {
    /// The output of the rule set, in %.
    pub output: String,
    /// The parameters of the elevated risk of this output.
    pub elevated_risk: AccumulatorSettings,
    /// The conditions for WARN.
    pub warn: LevelSettings,
    /// The conditions for FAIL.
    pub fail: LevelSettings,
}

/// An input of the rule set and its source.
///
/// # Example
/// ```
/// use flagred::profile::{Profile, ProfileInput};
/// use flagred::source::{Motors, Signal, Source, Statistic};
///
/// let text = "flagred: 1\nname: windy\nrules: my.yaml\ninputs: {wind: {last: wind_m_s}}";
/// let source = Source { statistic: Statistic::Last, motors: Motors::Pooled, signal: Signal::named("wind_m_s"), window_s: 2.0, exponential: false };
/// let wind = ProfileInput { name: "wind".into(), source, ratio: None, if_missing: None };
/// assert_eq!(text.parse::<Profile>()?.inputs, [wind]);
/// # Ok::<(), fuzzy::diagnostic::Findings>(())
/// ```
#[derive(Debug, Clone, PartialEq)]
pub struct ProfileInput {
    /// The name of the input in the rule set.
    pub name: String,
    /// The source of the value.
    pub source: Source,
    /// The division by another input, if the input is a ratio.
    pub ratio: Option<Ratio>,
    /// The value to assume on a vehicle that does not send the signal of the input.
    pub if_missing: Option<f64>,
}

/// The division of an input by another input of the profile. The value of the input is `x / max(per, at_least)`, where
/// `x` is the value of its source. The other input must not be a ratio itself, and does not need to be an input of the
/// rule set.
#[derive(Debug, Clone, PartialEq)]
pub struct Ratio {
    /// The name of the input to divide by.
    pub per: String,
    /// The minimum of the divisor, above 0.
    pub at_least: f64,
}

impl Profile {
    /// Returns the channels for the samples of a craft, and the inputs: the inputs of the profile, followed by one
    /// input for each source in `more`. The error is the name of a missing signal, or of a missing input of a ratio.
    pub(crate) fn channels<'a>(
        &'a self,
        more: &'a [Source],
        craft: Craft<'a>,
    ) -> Result<(Vec<Channel>, Vec<Input>), String> {
        let mut names = craft.signals.to_vec();
        for input in &self.inputs {
            for name in input.source.signal.carried() {
                match input.if_missing {
                    _ if names.contains(&name) => {}
                    // The signal gets a channel, but no sample ever provides a value.
                    Some(_) => names.push(name),
                    None => return Err(name.into()),
                }
            }
        }
        let sources = self.inputs.iter().map(|input| &input.source);
        let (channels, mut inputs) = channels(sources.chain(more), &names)?;
        let place = |name: &String| {
            let place = self.inputs.iter().position(|input| input.name == *name);
            place.ok_or_else(|| name.clone())
        };
        for (input, of) in inputs.iter_mut().zip(&self.inputs) {
            let is_sent = of.source.signal.carried().all(|name| craft.sends(name));
            input.if_missing = of.if_missing.filter(|_| !is_sent);
            let Some(ratio) = &of.ratio else { continue };
            input.ratio = Some(channel::Ratio {
                per: place(&ratio.per)?,
                at_least: ratio.at_least,
            });
        }
        Ok((channels, inputs))
    }

    /// Whether a ratio divides by the input with the given name.
    pub(crate) fn is_part(&self, name: &str) -> bool {
        let mut ratios = self.inputs.iter().filter_map(|input| input.ratio.as_ref());
        ratios.any(|ratio| ratio.per == name)
    }

    /// Whether an input, or a finding that is not about the risk, reads the motors. If not, the profile can assess any
    /// table of signals.
    pub fn reads_motors(&self) -> bool {
        let mut signals = self.inputs.iter().map(|input| &input.source.signal);
        self.verdict.notices.any() || signals.any(Signal::is_computed_from_commands)
    }

    /// The names of the signals, other than motor commands, that the profile needs, without duplicates.
    pub fn signals(&self) -> Vec<&str> {
        let mut names: Vec<&str> = Vec::new();
        for input in &self.inputs {
            for name in input.source.signal.carried() {
                if !names.contains(&name) {
                    names.push(name);
                }
            }
        }
        names
    }

    /// The same profile with another risk as its only risk, and without notices.
    pub(crate) fn of_risk(&self, risk: &OtherRisk) -> Profile {
        Profile {
            output: risk.output.clone(),
            elevated_risk: risk.elevated_risk,
            verdict: VerdictSettings {
                warn: risk.warn,
                fail: risk.fail,
                notices: NoticeSettings::default(),
                ..self.verdict
            },
            other_risks: Vec::new(),
            ..self.clone()
        }
    }

    /// The settings that concern time.
    pub(crate) fn settings(&self) -> Settings {
        Settings {
            sampling: self.sampling,
            elevated_risk: self.elevated_risk,
            verdict: self.verdict,
        }
    }
}
