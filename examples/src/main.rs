//! Assess a flight from a program of your own: `cargo run -p flagred-examples -- LOG`.

use flagred::{flight::Assessment, log, shipped};

fn assess(path: &str) -> Result<Assessment, flagred_flightlog::ReadError> {
    let flight = flagred_flightlog::open(path, &flagred_flightlog::Options::default())?;
    Ok(log::assess(&flight, &shipped::flagred(), None))
}

#[allow(clippy::print_stdout)]
fn main() -> Result<(), flagred_flightlog::ReadError> {
    let path = std::env::args().nth(1);
    let assessment = assess(path.as_deref().unwrap_or(STEADY))?;
    println!("{}", assessment.verdict);
    for finding in &assessment.findings {
        println!(
            "{}: {:.1} to {:.1} s",
            finding.severity, finding.from_s, finding.to_s
        );
    }
    Ok(())
}

/// The flight that comes with the examples.
const STEADY: &str = concat!(env!("CARGO_MANIFEST_DIR"), "/flights/steady.BIN");

#[cfg(test)]
mod tests {
    #[test]
    fn a_steady_wind_gives_no_finding() {
        let assessment = super::assess(super::STEADY).unwrap();
        assert_eq!(assessment.verdict.to_string(), "GOOD");
        assert!(assessment.findings.is_empty());
    }
}
