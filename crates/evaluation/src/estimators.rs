//! The estimators that are compared: profiles, and baselines without rules.

use flagred::estimator::Estimator;

use crate::baseline::Baseline;

/// All estimators that are compared: profiles first, then the baselines of [`crate::Baseline::all`].
pub struct Estimators {
    pub(crate) profiles: Vec<NamedEstimator>,
    pub(crate) baselines: [Baseline; 9],
}

/// A profile, and the name under which its results are listed.
pub(crate) struct NamedEstimator {
    pub(crate) name: String,
    pub(crate) estimator: Estimator,
}

impl Default for Estimators {
    /// Creates estimators without profiles: only the baselines.
    fn default() -> Estimators {
        Estimators {
            profiles: Vec::new(),
            baselines: Baseline::all(),
        }
    }
}

impl Estimators {
    /// Whether a profile has this name.
    pub fn has(&self, name: &str) -> bool {
        self.profiles.iter().any(|profile| profile.name == name)
    }

    /// Adds a profile under its own name, or under the name `otherwise` if another profile has the same name.
    pub fn add(&mut self, otherwise: &str, estimator: Estimator) {
        let own = &estimator.profile().name;
        let name = match self.has(own) {
            true => otherwise.to_owned(),
            false => own.clone(),
        };
        self.profiles.push(NamedEstimator { name, estimator });
    }

    /// The name and description of each estimator.
    pub fn names(&self) -> impl Iterator<Item = (&str, &str)> {
        let profiles = self.profiles.iter().map(|profile| {
            let description = profile.estimator.profile().description.as_deref();
            (profile.name.as_str(), description.unwrap_or_default())
        });
        let baselines = self.baselines.iter();
        profiles.chain(baselines.map(|baseline| (baseline.name, baseline.description)))
    }

    /// The signals, except those of the motors, that any estimator reads.
    pub fn signals(&self) -> Vec<&str> {
        let profiles = self.profiles.iter();
        let mut names: Vec<&str> = profiles
            .flat_map(|profile| profile.estimator.profile().signals())
            .chain(
                self.baselines
                    .iter()
                    .flat_map(|b| b.source.signal.carried()),
            )
            .collect();
        names.sort_unstable();
        names.dedup();
        names
    }
}
