//! What to type: the examples under the help of each command. Every line is tried by a test.

pub(crate) const FLAGRED: &str = "\
What to type:
  flagred assess flight.bin                      how risky was that flight, when, and which motor
  flagred assess flight.bin --html report.html   the same to look at: opens offline, prints
  flagred assess *.bin --html all.html           several flights compared
  flagred inspect flight.bin                     what is in a log, and what it lacks
  flagred new my-rules                           a commented rule set to start from
  flagred check my-rules.yaml                    what is wrong with it, what it leaves open
  flagred explain my-rules.yaml temperature=24 humidity=70   why the answer is what it is
  flagred map my-rules.yaml                      what it decides, over its inputs
  flagred learn my-rules.yaml rows.csv --output learned.yaml   its rules, learned from flights
  flagred watch udpin:0.0.0.0:14550              the risk of a flight while it is flown
  flagred completions bash                       completions for your shell

Each command has its own help: flagred assess --help";

pub(crate) const ASSESS: &str = "\
What to type:
  flagred assess flight.bin
  flagred assess flight.bin --html report.html --svg risk.svg
  flagred assess --json flight.ulg
  flagred assess --csv --step 1 flight.tlog.gz
  flagred assess --fail-on fail *.bin
  flagred assess --profile flagred-paper flight.bin
  flagred assess --profile my-profile.yaml flight.csv";

pub(crate) const CHECK: &str = "\
What to type:
  flagred check my-rules.yaml
  flagred check my-rules.yaml --monotone temperature:increasing
  flagred check --deny warnings rules/*.yaml
  flagred check --json my-rules.yaml";

pub(crate) const CONVERT: &str = "\
What to type:
  flagred convert flight.bin --output flight.csv
  flagred convert flight.ulg --output -          to another program
  flagred assess flight.csv                      what was written is a flight like any other";

pub(crate) const DATASET: &str = "\
What to type:
  flagred dataset *.bin --profile flagred        a row for each time in the air
  flagred dataset *.bin --window 10              a row for every 10 seconds
  flagred dataset *.bin --profile flagred --ahead 5 --every 0.25

The rows go to standard output, for flagred learn: flagred dataset *.bin > rows.csv";

pub(crate) const EVAL: &str = "\
What to type:
  flagred eval my-rules.yaml points.csv
  flagred eval my-rules.yaml";

pub(crate) const EVALUATE: &str = "\
What to type:
  flagred evaluate flights/*.bin
  flagred evaluate flights/*.bin --profile my-profile.yaml --svg curves.svg
  flagred evaluate --rows rows.csv
  flagred evaluate --json flights/*.bin";

pub(crate) const EXPLAIN: &str = "\
What to type:
  flagred explain my-rules.yaml temperature=24 humidity=70
  flagred explain --json my-rules.yaml temperature=24 humidity=70";

pub(crate) const EXPORT: &str = "\
What to type:
  flagred export --rust --output profile.rs
  flagred export --c --output profile.h flagred-paper
  flagred export --c my-profile.yaml

What flies with it: in Rust the crate flagred without its default features, in C the library
flagred-c and its header flagred.h.";

pub(crate) const INSPECT: &str = "\
What to type:
  flagred inspect flight.bin
  flagred inspect --json flight.ulg";

pub(crate) const LEARN: &str = "\
What to type:
  flagred learn my-rules.yaml rows.csv --output learned.yaml
  flagred learn my-rules.yaml rows.csv --resolve mean --min-support 5 --group-by vehicle --output learned.yaml
  flagred learn my-rules.yaml rows.csv --column margin=margin_mean --skip-bad-rows --output learned.yaml
  flagred learn my-rules.yaml rows.csv --compare-gaps --output learned.yaml
  flagred check learned.yaml                     what the learned rules leave open";

pub(crate) const MAP: &str = "\
What to type:
  flagred map my-rules.yaml
  flagred map my-rules.yaml --svg map.svg
  flagred map my-rules.yaml --surface --svg surface.svg
  flagred map my-rules.yaml --activations        which rule decides where
  flagred map my-rules.yaml --fix battery=20 --x margin:0..0.3 --y spread
  flagred map my-rules.yaml --csv --fill none";

pub(crate) const NEW: &str = "\
What to type:
  flagred new my-rules
  flagred new --output - my-rules";

pub(crate) const COMPLETIONS: &str = "\
What to type:
  flagred completions bash
  flagred completions zsh
  flagred completions fish

Where it goes: for bash ~/.local/share/bash-completion/completions/flagred, for fish
~/.config/fish/completions/flagred.fish, for zsh a file _flagred in a folder of $fpath.";

pub(crate) const MAN: &str = "\
What to type:
  flagred man
  flagred man assess
  flagred man --all man1";

pub(crate) const WATCH: &str = "\
What to type:
  flagred watch udpin:0.0.0.0:14550              a vehicle or a router that sends here
  flagred watch tcp:127.0.0.1:5760               a simulator
  flagred watch /dev/ttyACM0:57600               a telemetry radio
  flagred watch udpin:0.0.0.0:14550 --no-send --record flight.tlog
  flagred watch udpin:0.0.0.0:14550 --jsonl      a JSON object a line, for another program";

#[cfg(test)]
mod tests {
    use clap::{CommandFactory, Parser};

    use crate::Arguments;

    /// Every line that begins with the program is a command line that the program takes.
    #[test]
    fn what_help_says_to_type_can_be_typed() {
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
    fn the_definitions_are_sound() {
        Arguments::command().debug_assert();
    }
}
