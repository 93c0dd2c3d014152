//! `--range`: the range of the motor outputs if a log or a vehicle does not report it.

use flagred_flightlog::{Options, PulseRange};

use crate::failure::Failure;
use fuzzy::tree::number_advice;

#[derive(clap::Args)]
pub(crate) struct RangeArgument {
    /// Range of the motor outputs in microseconds, used if the log or the vehicle reports none: `--range 1100 1900`.
    /// Without it, such a log has no verdict, and `watch` assumes 1000 to 2000
    #[arg(long, num_args = 2, value_names = ["LOW", "HIGH"], value_parser = pulse_width)]
    range: Option<Vec<u16>>,
}

fn pulse_width(text: &str) -> Result<u16, String> {
    let is_width = |width: &u16| (500..=2500).contains(width);
    if let Some(width) = text.parse().ok().filter(is_width) {
        return Ok(width);
    }
    // Both limits may have been given as one word, as in `1100,1900` or `1100-1900`.
    let parts = text.split([',', '-', ':', ';']).map(str::parse::<u16>);
    let both: Vec<u16> = parts.flatten().filter(is_width).collect();
    Err(match both.as_slice() {
        [low, high] => format!("write two numbers: `--range {low} {high}`"),
        _ if text.parse::<f64>().is_err() => number_advice(text).unwrap_or_else(|| {
            "write two numbers of microseconds, such as `--range 1100 1900`".into()
        }),
        _ => "write microseconds from 500 to 2500, without decimals".into(),
    })
}

impl RangeArgument {
    /// Returns the given range, if any.
    pub(crate) fn given(&self) -> Result<Option<PulseRange>, Failure> {
        let Some(&[low_us, high_us]) = self.range.as_deref() else {
            return Ok(None);
        };
        let range = PulseRange::new(low_us, high_us)
            .map_err(|error| Failure::usage(format!("--range: {error}")).help(error.help()))?;
        Ok(Some(range))
    }

    /// Returns options that read a whole log, with the given range.
    pub(crate) fn options(&self) -> Result<Options, Failure> {
        let mut options = Options::default();
        options.range = self.given()?;
        Ok(options)
    }
}
