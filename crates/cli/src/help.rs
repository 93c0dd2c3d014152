//! The examples at the end of each command's help. A test parses every line.

pub(crate) const FLAGRED: &str = "\
Examples:
  flagred assess flight.bin                      verdict, findings, risk over time
  flagred assess flight.bin --html report.html   a report to open in a browser
  flagred assess *.bin --html all.html           compare several flights
  flagred inspect flight.bin                     the contents of a log
  flagred new my-rules                           a commented rule set to start from
  flagred check my-rules.yaml                    its errors, gaps and conflicts
  flagred explain my-rules.yaml temperature=24 humidity=70   how a result comes about
  flagred studio my-rules.yaml                   edit it in the browser, with its map beside it
  flagred plot my-rules.yaml                     the terms of its variables
  flagred map my-rules.yaml                      the output over the inputs
  flagred learn my-rules.yaml rows.csv --output learned.yaml   rules from a table
  flagred tune learned.yaml rows.csv --output tuned.yaml    fit the numbers of the rules
  flagred identify rows.csv --target risk --output found.yaml  inputs, terms and rules from a table
  flagred simplify tuned.yaml --output shorter.yaml         the same with fewer rules
  flagred watch udpin:0.0.0.0:14550              assess a flight live
  flagred completions bash                       completions for your shell

Each command has its own help: flagred assess --help";

pub(crate) const ASSESS: &str = "\
Examples:
  flagred assess flight.bin
  flagred assess flight.bin --html report.html --svg risk.svg
  flagred assess --json flight.ulg
  flagred assess --csv --step 1 flight.tlog.gz
  flagred assess --fail-on fail *.bin
  flagred assess --profile flagred-paper flight.bin
  flagred assess --profile my-profile.yaml flight.csv

Exit code 1: a flight has the verdict of --fail-on or a worse one. Exit code 3: a log cannot be read or has no verdict.";

pub(crate) const CHECK: &str = "\
Examples:
  flagred check my-rules.yaml
  flagred check my-rules.yaml --rising temperature   exit code 1 if the output falls
  flagred check --deny warnings rules/*.yaml
  flagred check my-profile.yaml                  a profile with its rule set
  flagred check --format json my-rules.yaml
  flagred check --format sarif rules/*.yaml      for code scanning
  flagred check --format github rules/*.yaml     annotations on GitHub

Exit code 1: there is an error or a finding of --deny, or an output violates --rising or --falling.";

pub(crate) const CONVERT: &str = "\
Examples:
  flagred convert flight.bin --output flight.csv
  flagred convert flight.ulg --output -          to standard output
  flagred assess flight.csv                      the CSV can be assessed";

pub(crate) const DATASET: &str = "\
Examples:
  flagred dataset *.bin --profile flagred        a row for each flight
  flagred dataset *.bin --window 10              a row for every 10 seconds
  flagred dataset *.bin --profile flagred --horizon 5 --every 0.25
  flagred dataset *.bin --output rows.csv";

pub(crate) const EVAL: &str = "\
Examples:
  flagred eval my-rules.yaml points.csv
  flagred eval my-rules.yaml points.csv --output results.csv --with coverage,rule,clamped,error
  flagred eval my-rules.yaml points.csv --delimiter tab --column temperature=t_c --skip-bad-rows
  flagred eval my-rules.yaml measured.csv --suffix _model --output compared.csv     with the errors
  flagred eval my-rules.yaml                     points from standard input

With --suffix, the outputs are also compared with measured values in columns of their names: RMS error, mean error, worst rows.
Exit code 1: a row has no value. Empty cells, NA and NaN are unknown values.";

pub(crate) const VALIDATE: &str = "\
Examples:
  flagred validate flights/*.bin
  flagred validate flights/*.bin --profile my-profile.yaml --svg curves.svg
  flagred validate --rows rows.csv
  flagred validate --json flights/*.bin";

pub(crate) const EXPLAIN: &str = "\
Examples:
  flagred explain my-rules.yaml temperature=24 humidity=70
  flagred explain my-rules.yaml temperature=24 humidity=70 --svg explanation.svg
  flagred explain --json my-rules.yaml temperature=24 humidity=70
  flagred explain my-rules.yaml --rows points.csv -o reasons.csv     the dominant rule and the shares, for each row";

pub(crate) const EXPORT: &str = "\
Examples:
  flagred export --rust --output profile.rs
  flagred export --c --output profile.h flagred-paper
  flagred export --c my-profile.yaml
  flagred export --fis my-rules.yaml --output my-rules.fis

`--fis`, `--fll`, `--fcl` and `--fml` write a rule set for MATLAB, fuzzylite, jFuzzyLogic and JFML. What the
format cannot express is an error. With `--lossy` it is left out with a warning; a term that rules need remains an error.";

pub(crate) const IMPORT: &str = "\
Examples:
  flagred import tipper.fis --output tipper.yaml
  flagred import --lossy crane.fcl

Commands that take a rule set also take such files as they are: `flagred check tipper.fis`.";

pub(crate) const FMT: &str = "\
Examples:
  flagred fmt my-rules.yaml
  flagred fmt --check rules/*.yaml               in a test: exit code 1 if a layout differs";

pub(crate) const LSP: &str = "\
Examples:
  flagred lsp                                    started by the editor: see docs/editors.md";

pub(crate) const STUDIO: &str = "\
Examples:
  flagred studio                                 the page, in the browser
  flagred studio my-rules.yaml                   edits the file
  flagred studio my-rules.yaml --read-only       follows the file while another editor writes it
  flagred studio --html studio.html              the page as one file, to open offline";

pub(crate) const INSPECT: &str = "\
Examples:
  flagred inspect flight.bin
  flagred inspect --json flight.ulg";

pub(crate) const IDENTIFY: &str = "\
Examples:
  flagred identify cars.csv --target mpg --output cars.yaml
  flagred identify cars.csv --target mpg --input weight --input year --output cars.yaml
  flagred identify cars.csv --target mpg --clusters --lines --output cars.yaml
  flagred tune cars.yaml cars.csv --round 3 --output tuned.yaml     fit its numbers";

pub(crate) const LEARN: &str = "\
Examples:
  flagred learn my-rules.yaml rows.csv --output learned.yaml
  flagred learn my-rules.yaml rows.csv --resolve mean --min-support 5 --group-by vehicle --output learned.yaml
  flagred learn my-rules.yaml rows.csv --column margin=margin_mean --skip-bad-rows --output learned.yaml
  flagred learn my-rules.yaml rows.csv --compare-gaps --output learned.yaml
  flagred check learned.yaml                     the gaps of the learned rules

Cross-validation has 10 folds, or a fold for each of up to 50 groups of --group-by.
Exit code 1: the output violates --rising or --falling.";

pub(crate) const TUNE: &str = "\
Examples:
  flagred tune my-rules.yaml rows.csv --output tuned.yaml
  flagred tune my-rules.yaml rows.csv --round 2 --svg moved.svg --output tuned.yaml
  flagred tune my-rules.yaml rows.csv --only heat --fix heat.hot --rising heat --output tuned.yaml
  flagred tune my-rules.yaml rows.csv --loss ranking --column risk=failed --group-by vehicle --rule-weights --output tuned.yaml

Ctrl-C ends the search and writes the best rule set so far.";

pub(crate) const SIMPLIFY: &str = "\
Examples:
  flagred simplify my-rules.yaml --output shorter.yaml
  flagred simplify my-rules.yaml --tolerance 2 --output shorter.yaml    in the unit of the output
  flagred simplify my-rules.yaml rows.csv --rows-only --output shorter.yaml";

pub(crate) const MAP: &str = "\
Examples:
  flagred map my-rules.yaml
  flagred map my-rules.yaml --svg map.svg
  flagred map my-rules.yaml --surface --svg surface.svg
  flagred map my-rules.yaml --activations        the dominant rule of each cell
  flagred map my-rules.yaml --hold battery=20 --x margin:0..0.3 --y spread
  flagred map my-profile.yaml                    interpolated as in the profile
  flagred map my-rules.yaml --values             numbers, a table for each slice
  flagred map my-rules.yaml --csv -o my-rules.map.csv
  flagred map my-rules.yaml --check my-rules.map.csv     in a test: exit code 1 if an output differs
  flagred map my-rules.yaml --check compared.csv --suffix _model     a table of `eval --suffix _model`

docs/ci.md shows how to use --csv and --check in CI.";

pub(crate) const PLOT: &str = "\
Examples:
  flagred plot my-rules.yaml
  flagred plot my-rules.yaml --svg terms.svg";

pub(crate) const NEW: &str = "\
Examples:
  flagred new my-rules
  flagred new my-profile --profile flagred               the default profile, to change its thresholds
  flagred new my-profile --profile flagred-paper
  flagred new --output - my-rules";

pub(crate) const SHOW: &str = "\
Examples:
  flagred show flagred
  flagred show flagred --rules";

pub(crate) const SCHEMA: &str = "\
Examples:
  flagred schema rule-set
  flagred schema profile
  flagred schema assess";

pub(crate) const COMPLETIONS: &str = "\
Examples:
  flagred completions bash
  flagred completions zsh
  flagred completions fish

Bash reads completions from ~/.local/share/bash-completion/completions/flagred, fish from
~/.config/fish/completions/flagred.fish, and zsh from a file _flagred in a folder of $fpath.";

pub(crate) const MAN: &str = "\
Examples:
  flagred man
  flagred man assess
  flagred man --folder man1";

pub(crate) const WATCH: &str = "\
Examples:
  flagred watch udpin:0.0.0.0:14550              packets from a vehicle or a router
  flagred watch tcp:127.0.0.1:5760               a simulator
  flagred watch /dev/ttyACM0:57600               a telemetry radio
  flagred watch udpin:0.0.0.0:14550 --no-send --record flight.tlog
  flagred watch udpin:0.0.0.0:14550 --jsonl      JSON lines, for another program

Exit code 1: a flight was WARN or FAIL. Exit code 3: there is no verdict.";

#[cfg(test)]
mod tests {
    use clap::{CommandFactory, Parser};

    use crate::Arguments;

    /// Every line that begins with the program is a valid command line.
    #[test]
    fn every_example_parses() {
        let mut tried = 0;
        let mut commands = vec![Arguments::command()];
        commands.extend(Arguments::command().get_subcommands().cloned());
        for command in &commands {
            let help = command.get_after_help().map(ToString::to_string);
            let help = help.unwrap_or_else(|| panic!("{} has no examples", command.get_name()));
            for line in help
                .lines()
                .filter_map(|line| line.strip_prefix("  flagred "))
            {
                let words = line.split("   ").next().unwrap().split_whitespace();
                let typed = std::iter::once("flagred").chain(words);
                if let Err(error) = Arguments::try_parse_from(typed) {
                    panic!("flagred {line}: {error}");
                }
                tried += 1;
            }
        }
        assert!(tried > 45, "{tried}");
    }

    #[test]
    fn the_definitions_of_arguments_are_valid() {
        Arguments::command().debug_assert();
    }
}
