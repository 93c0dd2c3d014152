//! Names of commands, options and values in other programs, and their equivalents here.

/// Names of commands in other programs, and the equivalent commands here.
pub(super) const COMMANDS: &[(&str, &str)] = &[
    (
        "analyze analyse analysis evaluate-flight risk",
        "`flagred assess` assesses a flight",
    ),
    (
        "train fit",
        "`flagred learn` learns rules from a table, `flagred tune` moves the numbers of a rule set",
    ),
    (
        "optimize optimise calibrate",
        "`flagred tune` moves the numbers of a rule set to fit a table",
    ),
    (
        "format prettify",
        "`flagred fmt` formats rule sets and profiles",
    ),
    (
        "run predict infer inference compute calc simulate",
        "`flagred explain` evaluates a rule set at one point, `flagred eval` at the points of a table",
    ),
    (
        "lint test verify",
        "`flagred check` lists the errors of rule sets and profiles",
    ),
    (
        "report",
        "`flagred assess FLIGHT --html report.html` writes a report",
    ),
    (
        "compare",
        "`flagred assess FLIGHTS --html all.html` compares flights, `flagred validate` compares profiles",
    ),
    (
        "score benchmark",
        "`flagred validate` measures how good the risks of profiles are",
    ),
    ("fleet", "`python -m flagred.fleet` (docs/fleet.md)"),
    (
        "init create generate-rules start",
        "`flagred new NAME` writes a rule set to start from",
    ),
    (
        "edit gui ui serve web open view",
        "`flagred studio` opens the page in the browser",
    ),
    (
        "draw graph chart",
        "`flagred plot` draws the terms of a rule set, `flagred map` its output",
    ),
    (
        "info dump stat",
        "`flagred inspect` shows the contents of a log",
    ),
    (
        "list ls profiles cat print",
        "`flagred show NAME` prints a built-in profile or rule set; `flagred show --help` lists them",
    ),
    (
        "live monitor connect",
        "`flagred watch` assesses a flight live",
    ),
    (
        "cluster discover",
        "`flagred identify` finds inputs, terms and rules for a column of a table",
    ),
    (
        "reduce prune minify shrink",
        "`flagred simplify` writes a rule set with fewer rules",
    ),
    (
        "generate codegen compile build",
        "`flagred export` writes a profile or a rule set as code",
    ),
    (
        "csv",
        "`flagred convert LOG --output flight.csv` writes a flight CSV",
    ),
    (
        "evalute evaluation",
        "`flagred eval` evaluates a rule set, `flagred validate` validates profiles",
    ),
];

/// Options of other programs, and the equivalent option here. An entry applies to the commands that have this option.
pub(super) const RENAMED: &[(&str, &str)] = &[
    (
        "--sep --separator --delim --field-separator -d -s -F",
        "--delimiter",
    ),
    (
        "--out --outfile --out-file --output-file --save --save-to --write",
        "--output",
    ),
    (
        "--picture --image --img --figure --png --pdf --html --plot --graph --save-plot",
        "--svg",
    ),
    ("--report --html-report", "--html"),
    ("--overwrite --yes --replace -f -y", "--force"),
    ("--resolution --grid --samples --n -n", "--points"),
    ("--set --at --with-value --fix --fixed", "--hold"),
    (
        "--skip --lenient --ignore-errors --skip-errors --skip-invalid",
        "--skip-bad-rows",
    ),
    ("--cv --k-fold --kfold --cross-validation", "--folds"),
    ("--label --response --output-column --y -y", "--target"),
    ("--inputs --features --feature", "--input"),
    ("--exclude --drop", "--ignore"),
    (
        "--epochs --max-iter --max-iterations --steps",
        "--iterations",
    ),
    ("--restarts", "--starts"),
    ("--freeze --fixed --lock", "--fix"),
    ("--rename --map-column", "--column"),
    ("--monotone --increasing", "--rising"),
    ("--decreasing", "--falling"),
    ("--random-state --random-seed", "--seed"),
    ("--min-rows --min-samples", "--min-support"),
    ("--pwm --pwm-range --min-max", "--range"),
    ("--config --settings --preset -p", "--profile"),
    ("--dt --interval --rate", "--step"),
    ("-c", "--csv"),
    ("-j", "--json"),
    ("--csv --to-csv", "--output"),
    ("--json --ndjson --json-lines", "--jsonl"),
    ("--json", "--csv"),
    ("--output-variable --variable --show --z", "--of"),
    ("--template --based-on --like --copy", "--from"),
    ("--3d --three-d --surface3d", "--surface"),
    ("--matlab --octave", "--fis"),
    ("--cpp --c++ --arduino", "--c"),
    ("--fuzzylite", "--fll"),
    ("--jfuzzylogic", "--fcl"),
    ("--jfml --xml", "--fml"),
    ("--ardupilot", "--lua"),
];

/// Directions after the name of an input, and the option for each.
pub(super) const DIRECTIONS: &[(&str, &str)] = &[
    ("increasing rising inc up", "--rising"),
    ("decreasing falling dec down", "--falling"),
];

/// Options of flagred that take the name of a file to write.
pub(super) const WRITTEN: &[&str] = &["--output", "--svg", "--html"];

/// Options of flagred that take the name of a file whose extension is the name of the option: `--svg map.svg`.
pub(super) const PICTURES: &[&str] = &["--svg", "--html"];

/// Options by which other programs name a file that is a positional argument of flagred.
pub(super) const FILES: &[&str] = &[
    "--file",
    "--files",
    "--log",
    "--logs",
    "--flight",
    "--flights",
    "--rules",
    "--model",
    "--ruleset",
    "--data",
    "--dataset",
    "--table",
    "--rows",
    "--points",
    "--in",
    "--input",
    "--input-file",
    "-i",
];

/// Advice for options of single commands: the commands, the options, and the advice, in which `VALUE` is the value
/// that follows the option.
pub(super) const OPTIONS: &[(&str, &str, &str)] = &[
    (
        "learn tune",
        "--target --label --output-column",
        "the target is the output of the rule set; if its column has another name, write `--column OUTPUT=VALUE`",
    ),
    (
        "import",
        "--format --from --type --fis --fll --fcl --fml",
        "the format is recognised by the content: leave the option out",
    ),
    (
        "plot",
        "--csv --values --points",
        "`flagred map RULES --csv` prints a table of values",
    ),
    (
        "inspect",
        "--csv --to-csv --table",
        "`flagred convert FLIGHT --output flight.csv` writes a table",
    ),
    (
        "check validate simplify learn tune identify",
        "--csv",
        "write `--json`",
    ),
    (
        "eval dataset convert",
        "--json",
        "the table is CSV: leave the option out",
    ),
    (
        "fmt",
        "--output --out -o --stdout",
        "`fmt` formats files in place; to keep the original, write `flagred fmt - < IN.yaml > OUT.yaml`",
    ),
    (
        "fmt",
        "--write --fix --in-place --inplace -i -w",
        "`fmt` formats files in place: leave the option out",
    ),
    (
        "check",
        "--strict --werror --pedantic -W",
        "write `--deny warnings`",
    ),
    (
        "assess watch validate inspect",
        "--rules --ruleset --model",
        "a profile names the rule set: `flagred new NAME --profile flagred` writes a profile; assess with `--profile NAME.yaml`",
    ),
    (
        "identify",
        "--rules --model",
        "`identify` makes a new rule set; `flagred learn` and `flagred tune` start from one",
    ),
    (
        "assess watch",
        "--threshold --warn --fail --limit",
        "thresholds belong to a profile: `flagred new NAME --profile flagred` writes one to edit; assess with `--profile NAME.yaml`",
    ),
    (
        "new",
        "--inputs --outputs --input --output-name --terms",
        "`new` writes a commented example: edit its inputs and outputs",
    ),
    (
        "watch",
        "--baud --baudrate --baud-rate --speed -b",
        "the baud rate follows the serial port: `/dev/ttyUSB0:VALUE`",
    ),
    (
        "check",
        "--fix --write",
        "`check` changes no file; `flagred fmt` formats one",
    ),
    (
        "eval learn tune identify explain map",
        "--header --no-header --headers",
        "the first line of a table names its columns: leave the option out",
    ),
    (
        "learn tune",
        "--terms --max-terms --partitions",
        "the terms are those of the rule set; `flagred identify` chooses terms",
    ),
    (
        "tune learn identify",
        "--learning-rate --lr --momentum --batch-size --population --method --optimizer --algorithm",
        "the search has no such setting: leave the option out",
    ),
    (
        "learn identify",
        "--epochs --iterations",
        "only `flagred tune` has iterations: leave the option out",
    ),
    (
        "studio",
        "--browser --open",
        "the page opens in the browser by default: leave the option out",
    ),
    (
        "export",
        "--python --py",
        "the Python package `flagred` evaluates the file itself: no export is needed",
    ),
];

/// Values of options in other programs, and the equivalent value here. An entry applies only to options that accept
/// the value here.
pub(super) const VALUES: &[(&str, &str)] = &[
    ("mse rmse l2 square sq", "squared"),
    ("logloss cross-entropy crossentropy bce nll", "log"),
    ("auc rank roc", "ranking"),
    ("error errors critical red", "fail"),
    ("warning", "warn"),
    ("warn warning all", "warnings"),
    ("note info", "notes"),
    ("none off no", "never"),
    ("sh shell", "bash"),
    ("pwsh ps", "powershell"),
    ("rules ruleset rule_set model yaml", "rule-set"),
    ("idw inverse", "inverse-distance"),
    ("spline tps", "thin-plate"),
    ("laplace", "harmonic"),
];
