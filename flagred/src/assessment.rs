//! What goes into a monitor and what comes out.

use crate::verdict::{Ended, Level};

/// A moment of a flight.
#[derive(Debug, Clone, Copy)]
pub struct Sample<'a> {
    /// When, in seconds; must not fall.
    pub t_s: f64,
    /// The effective command of each motor in [0, 1]; anything else, such as NaN, is unknown.
    pub motors: &'a [f64],
    /// Whether the vehicle is in the air.
    pub in_air: bool,
    /// The values of the signals that the monitor was told the names of; NaN is unknown.
    pub signals: &'a [f64],
}

/// What is known after a sample.
///
/// # Example: nothing is said on the ground
/// ```
/// # use flagred::{assessment::Sample, estimator::Estimator, monitor::Monitor, shipped};
/// # let profile = shipped::profile("flagred-paper").ok_or("not shipped")??;
/// # let rules = shipped::rule_set(&profile.rules).ok_or("not shipped")??;
/// # let estimator = Estimator::new(&profile, &rules)?;
/// # let mut monitor = Monitor::new(&estimator, 4, &[])?;
/// use flagred::assessment::{Assessment, Unknown};
///
/// let parked = Sample { t_s: 0.0, motors: &[0.0; 4], in_air: false, signals: &[] };
/// let Assessment { risk, elevated_risk_pct, level, .. } = monitor.push(&parked);
/// assert_eq!((risk, elevated_risk_pct, level), (Err(Unknown::OnGround), None, None));
/// # Ok::<(), Box<dyn std::error::Error>>(())
/// ```
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct Assessment {
    /// When, in seconds.
    pub t_s: f64,
    /// The risk of the moment, or why it is unknown.
    pub risk: Result<Estimate, Unknown>,
    /// The elevated risk in %; `None` where the risk is unknown.
    pub elevated_risk_pct: Option<f64>,
    /// The level; `None` on the ground and where the risk has been unknown for long.
    pub level: Option<Level>,
    /// The new level where this sample changed it.
    pub change: Option<Level>,
    /// The findings that ended with this sample.
    pub ended: Ended,
}

/// What is said about a moment whose inputs are known.
///
/// # Example: what rules say, and what is filled in
/// ```
/// # use flagred::{estimator::Estimator, shipped};
/// # let profile = shipped::profile("flagred-paper").ok_or("not shipped")??;
/// # let rules = shipped::rule_set(&profile.rules).ok_or("not shipped")??;
/// # let estimator = Estimator::new(&profile, &rules)?;
/// use flagred::assessment::Estimate;
///
/// let Estimate { coverage, filled_from, dominant_rule, clamped, .. } = estimator.at(&[0.3, 0.1]).ok_or("unknown")?;
/// assert_eq!((coverage, filled_from, dominant_rule, clamped), (1.0, None, Some(2), false));
/// // No rule speaks of a saturated vehicle whose motors all do the same, and a spread of 0.7 is off the map.
/// assert!(estimator.at(&[0.0, 0.0]).is_some_and(|saturated| saturated.filled_from.is_some()));
/// assert!(estimator.at(&[0.3, 0.7]).is_some_and(|off| off.clamped));
/// # Ok::<(), Box<dyn std::error::Error>>(())
/// ```
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct Estimate {
    /// The risk in %, from 0 to 100.
    pub risk_pct: f64,
    /// The largest firing strength of a rule, in [0, 1]: how well the rules know such inputs.
    pub coverage: f64,
    /// The distance to the nearest inputs that rules cover, in shares of the inputs' ranges, where the risk was
    /// filled in from there; `None` where rules gave it.
    pub filled_from: Option<f64>,
    /// The rule that fired most strongly, as its index in the model.
    pub dominant_rule: Option<usize>,
    /// Whether an input lay outside its range and was taken as the range's end.
    pub clamped: bool,
}

/// Why a risk is unknown.
///
/// # Example: the first samples of a flight
/// ```
/// # use flagred::{assessment::Sample, estimator::Estimator, monitor::Monitor, shipped};
/// # let profile = shipped::profile("flagred-paper").ok_or("not shipped")??;
/// # let rules = shipped::rule_set(&profile.rules).ok_or("not shipped")??;
/// # let estimator = Estimator::new(&profile, &rules)?;
/// # let mut monitor = Monitor::new(&estimator, 4, &[])?;
/// use flagred::assessment::Unknown;
///
/// let mut why = |t_s| monitor.push(&Sample { t_s, motors: &[0.5; 4], in_air: true, signals: &[] }).risk.err();
/// assert_eq!(why(0.0), Some(Unknown::NoValue { input: 0 })); // a first sample stands for no time yet
/// assert_eq!(why(0.1), Some(Unknown::WarmingUp { input: 0 }));
/// assert_eq!(why(0.1), Some(Unknown::OutOfOrder)); // the same again
/// # Ok::<(), Box<dyn std::error::Error>>(())
/// ```
#[derive(Debug, Clone, Copy, PartialEq)]
pub enum Unknown {
    /// The vehicle is on the ground.
    OnGround,
    /// The time stamp is not after the one before: the sample is repeated, late or damaged, and was left out.
    OutOfOrder,
    /// The window of an input does not reach back far enough yet.
    WarmingUp {
        /// The input, in the order of the profile.
        input: usize,
    },
    /// The window of an input holds too few samples.
    TooFewSamples {
        /// The input, in the order of the profile.
        input: usize,
        /// How many it holds.
        samples: u32,
    },
    /// Nothing is known of the signal of an input.
    NoValue {
        /// The input, in the order of the profile.
        input: usize,
    },
    /// No rule says anything about such inputs, and no part of the map is covered to fill it from.
    NoRule,
}

/// When an input counts as known.
///
/// # Example: keys of a profile
/// ```
/// use flagred::{assessment::Sampling, profile::Profile};
///
/// let text = "flagred: 1\nname: patient\nrules: my.yaml\nmin_samples: 20\ninputs: {margin: {mean: motor_margin}}";
/// let patient = Sampling { min_samples: 20, ..Sampling::default() };
/// assert_eq!(Profile::from_yaml(text)?.sampling, patient);
/// assert_eq!((patient.warm_up_s, patient.longest_gap_s), (1.0, 2.0));
/// # Ok::<(), fuzzy::diagnostic::Findings>(())
/// ```
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct Sampling {
    /// The fewest samples a window must hold: at a few samples per second a spread means little.
    pub min_samples: u32,
    /// How much time a window must cover before it counts, in seconds, or its whole length where that is less.
    pub warm_up_s: f64,
    /// Longer than this without a sample, in seconds, and what was before is forgotten.
    pub longest_gap_s: f64,
}

impl Default for Sampling {
    fn default() -> Self {
        Sampling {
            min_samples: 5,
            warm_up_s: 1.0,
            longest_gap_s: 2.0,
        }
    }
}
