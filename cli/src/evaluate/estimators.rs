//! Who is compared: the profiles, and the baselines that need no rules.

use flagred::{estimator::Estimator, evaluation::Baseline, shipped};

use crate::{failure::Failure, profile};

/// All that are compared; profiles first.
pub(super) struct Estimators {
    pub(super) profiles: Vec<Named>,
    pub(super) baselines: [Baseline; 9],
}

/// A profile and what it goes by.
pub(super) struct Named {
    pub(super) name: String,
    pub(super) estimator: Estimator,
}

impl Estimators {
    /// The shipped profiles, and those that were asked for.
    pub(super) fn new(asked: &[String]) -> Result<Estimators, Failure> {
        let mut profiles: Vec<Named> = Vec::new();
        let shipped = shipped::profile_names().into_iter().map(str::to_owned);
        for wanted in shipped.chain(asked.iter().cloned()) {
            if profiles.iter().any(|p| p.name == wanted) {
                continue;
            }
            let estimator = profile::load(&wanted)?.estimator;
            let own = &estimator.profile().name;
            // A file may call itself what another is called already.
            let name = match profiles.iter().any(|p| p.name == *own) {
                true => wanted,
                false => own.clone(),
            };
            profiles.push(Named { name, estimator });
        }
        Ok(Estimators {
            profiles,
            baselines: Baseline::all(),
        })
    }

    /// The name of each with what it is.
    pub(super) fn names(&self) -> impl Iterator<Item = (&str, &str)> {
        let profiles = self.profiles.iter().map(|profile| {
            let description = profile.estimator.profile().description.as_deref();
            (profile.name.as_str(), description.unwrap_or_default())
        });
        let baselines = self.baselines.iter();
        profiles.chain(baselines.map(|baseline| (baseline.name, baseline.description)))
    }

    /// The signals beside the motors that any of them looks at.
    pub(super) fn signals(&self) -> Vec<&str> {
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
