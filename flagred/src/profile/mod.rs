//! A profile: what a flight's signals mean to a rule set, and what its risk means to a pilot.

use alloc::{string::String, vec::Vec};

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

/// The JSON Schema of the format, for editors that complete and check while one types.
pub const SCHEMA: &str = include_str!("../../rules/profile-schema.json");

/// Everything between a flight and its verdict but the rules themselves.
///
/// # Example: a third input, without a line of code
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
    /// Its name.
    pub name: String,
    /// What it is for, in the author's words.
    pub description: Option<String>,
    /// The rule set: the name of a shipped one ([`crate::shipped`]), or a file beside the profile.
    pub rules: String,
    /// Over how many seconds an input is taken that names no window of its own.
    pub window_s: f64,
    /// Where each input of the rule set comes from.
    pub inputs: Vec<ProfileInput>,
    /// The output of the rule set that is the risk, in %.
    pub output: String,
    /// When an input counts as known.
    pub sampling: Sampling,
    /// What happens where no rule applies.
    pub gap: GapSettings,
    /// How risks add up to the elevated risk.
    pub elevated_risk: AccumulatorSettings,
    /// When levels are raised and lowered.
    pub verdict: VerdictSettings,
    /// Other outputs that are risks.
    pub other_risks: Vec<OtherRisk>,
    /// What a pilot reads where an input raised the risk. Inputs without an entry are described by their names.
    pub findings: Vec<CauseWords>,
    /// How often errors followed a risk, by rising risk; empty where it was not measured.
    pub reliability: Vec<Reliability>,
}

/// What a pilot reads where an input raised the risk.
#[derive(Debug, Clone, PartialEq, Eq)]
pub struct CauseWords {
    /// The name of the input in the profile.
    pub input: String,
    /// A word for programs: small letters, digits and `_`.
    pub code: String,
    /// Two or three words, at most 20 ASCII characters: part of texts of 50.
    pub brief: String,
    /// What happened, and what it means. `{value}` is the value of the input, `{percent}` 100 times that.
    pub text: String,
    /// What to do.
    pub advice: String,
}

/// The attitude error of a risk of 100 %, in degrees: the critical error of the paper.
pub const CRITICAL_ERROR_DEG: f64 = 5.0;

/// How many moments with a risk of a band were followed by a large attitude error.
#[derive(Debug, Clone, Copy, PartialEq)]
#[cfg_attr(feature = "serde", derive(serde::Serialize))]
#[cfg_attr(feature = "schema", derive(schemars::JsonSchema))]
pub struct Reliability {
    /// The lower end of the band in %; it belongs to it.
    pub from_pct: f64,
    /// The upper end in %; 100 belongs to the last band.
    pub to_pct: f64,
    /// On real vehicles.
    pub real: Option<Followed>,
    /// On simulated ones.
    pub simulated: Option<Followed>,
}

/// How many moments were followed by an attitude error over 5 degrees within 5 s.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
#[cfg_attr(feature = "serde", derive(serde::Serialize))]
#[cfg_attr(feature = "schema", derive(schemars::JsonSchema))]
pub struct Followed {
    /// All moments, one each 0.5 s.
    pub moments: u64,
    /// Those that were followed by such an error.
    pub followed: u64,
}

impl Followed {
    /// The share that was followed by such an error, in %; `None` without a moment.
    pub fn share_pct(&self) -> Option<f64> {
        (self.moments > 0).then(|| 100.0 * self.followed as f64 / self.moments as f64)
    }
}

/// Another output that is a risk, with levels of its own. Its findings are those of a profile of which it is the only risk.
#[derive(Debug, Clone, PartialEq)]
pub struct OtherRisk {
    /// The output of the rule set, in %.
    pub output: String,
    /// How its risks add up.
    pub elevated_risk: AccumulatorSettings,
    /// When to warn.
    pub warn: LevelSettings,
    /// When it fails.
    pub fail: LevelSettings,
}

/// An input of the rule set and where it comes from.
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
    /// Where its value comes from.
    pub source: Source,
    /// What that is divided by.
    pub ratio: Option<Ratio>,
    /// Its value on a vehicle that does not send its signal.
    pub if_missing: Option<f64>,
}

/// What makes an input a ratio: `x / max(per, at_least)` of the value `x` of its source and of another input of the profile,
/// which is not a ratio itself. The rule set need not have that input.
#[derive(Debug, Clone, PartialEq)]
pub struct Ratio {
    /// The input to divide by.
    pub per: String,
    /// The least to divide by, above 0.
    pub at_least: f64,
}

impl Profile {
    /// What is observed of samples of a craft, and the inputs of the profile, then those of `more`. The error is the name of a
    /// signal, or of an input of a ratio, that there is not.
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
                    // It has a place that no sample fills.
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

    /// Whether a ratio is made of the input of this name.
    pub(crate) fn is_part(&self, name: &str) -> bool {
        let mut ratios = self.inputs.iter().filter_map(|input| input.ratio.as_ref());
        ratios.any(|ratio| ratio.per == name)
    }

    /// Whether an input or a finding beside the risk is about the motors. A profile of which none is needs no motors: it can
    /// assess any table of signals.
    pub fn reads_motors(&self) -> bool {
        let mut signals = self.inputs.iter().map(|input| &input.source.signal);
        self.verdict.notices.any() || signals.any(Signal::is_made_of_motors)
    }

    /// The names of the signals beside the motors that it needs, each once.
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

    /// The same profile with another risk as the only one, and without what is told beside the risk.
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

    /// What it says about time.
    pub(crate) fn settings(&self) -> Settings {
        Settings {
            sampling: self.sampling,
            elevated_risk: self.elevated_risk,
            verdict: self.verdict,
        }
    }
}
