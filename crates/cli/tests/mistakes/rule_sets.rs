//! Mistakes with rule sets and profiles: `check`, `map`, `plot`, `export`, `import`, `new`, `fmt`, `show`.

use super::{assert_advice, files};

/// Each mistake: the command line, its exit code, and a part of its message.
const MISTAKES: &[(&str, i32, &str)] = &[
    ("import fan.m", 3, "`writeFIS(fis, \"name\")`"),
    ("import fan.py", 3, "docs/from-scikit-fuzzy.md"),
    ("import fan.yaml", 3, "needs no import"),
    ("new foo.yaml", 2, "write `foo`"),
    ("new sub/foo", 2, "write `foo -o sub/foo.yaml`"),
    ("new mine --profile", 2, "flagred-battery"),
    (
        "map fan.yaml -o map.svg",
        2,
        "for a picture write `--svg map.svg`",
    ),
    ("map fan.yaml --check fan.yaml", 3, "`fan.yaml`"),
    ("check .", 3, "`.` is a folder"),
    ("export --fis fan.yaml -o fan.fll", 2, "write `fan.fis`"),
    ("map fan.yaml --csv -o fan.yaml", 2, "write `fan.txt`"),
    (
        "map fan.yaml --coverage-below 0.2",
        2,
        "choose an interpolation with `--fill`",
    ),
    (
        "map fan.yaml --hold humidity=5 --hold humidity=6",
        2,
        "`humidity` has two values",
    ),
    (
        "map fan.yaml --points 0",
        2,
        "write a whole number from 2 to 1001",
    ),
    (
        "map fan.yaml --fill nearest --coverage-below 50",
        2,
        "write a number above 0 and at most 1",
    ),
    (
        "check flagred-batery",
        3,
        "did you mean the built-in `flagred-battery`?",
    ),
    (
        "map fan.yaml --x temperature:0-20",
        2,
        "write `temperature:0..20`",
    ),
    (
        "map fan.yaml --x temperature 0 20",
        2,
        "write `--x INPUT:LOW..HIGH`",
    ),
    ("plot fan.yaml --html x.html", 2, "write `--svg x.svg`"),
    ("fmt fan.yaml --write", 2, "leave the option out"),
    (
        "check fan.yaml --coverage 50",
        2,
        "write a number above 0 and at most 1\n",
    ),
    (
        "map fan.yaml --output fan",
        2,
        "`--of fan` shows this output",
    ),
    ("import fan.fis out.yaml", 2, "write `--output out.yaml`"),
    (
        "import --format fis fan.fis",
        2,
        "the format is recognised by the content",
    ),
    ("import script.fis", 3, "`writeFIS(fis, \"name\")`"),
    ("import fan.fll", 3, "write a decimal point: `10.5`"),
    ("import rows.csv", 3, "a table of values, not a rule set"),
    ("plot fan.yaml --output fan.svg", 2, "write `--svg fan.svg`"),
    ("plot fan.yaml temperature", 2, "`plot` draws all variables"),
    ("plot fan.yaml --csv", 2, "`flagred map RULES --csv`"),
    (
        "map fan.yaml -o map.png",
        2,
        "for a picture write `--svg map.svg`",
    ),
    (
        "map fan.yaml temperature humidity",
        2,
        "write `--x temperature --y humidity`",
    ),
    (
        "map fan.yaml temperature=3",
        2,
        "write `--hold temperature=3`",
    ),
    ("map flight.csv", 3, "`flagred assess flight.csv`"),
    ("export --format fis fan.yaml", 2, "write `--fis`"),
    (
        "export --fis new.fis fan.yaml",
        2,
        "write `--fis fan.yaml --output new.fis`",
    ),
    ("export fan.yaml --matlab", 2, "write `--fis`"),
    (
        "fmt fan.yaml -o out.yaml",
        2,
        "`fmt` formats files in place",
    ),
    ("fmt fan.fll", 3, "`flagred import fan.fll`"),
    ("new my rules", 2, "write `my-rules`"),
    (
        "new my-rules --template flagred",
        2,
        "write `--from flagred`",
    ),
    (
        "studio fan.yaml rows.csv",
        2,
        "`studio` takes one file at a time",
    ),
    (
        "studio fan.yaml --browser",
        2,
        "the page opens in the browser by default",
    ),
    ("check fan.yaml --strict", 2, "write `--deny warnings`"),
    (
        "check fan.yaml --rising temperature humidity",
        3,
        "`--rising humidity`",
    ),
    ("check profile", 3, "did you mean `profile.yaml`?"),
    ("check notes.md", 3, "is a document, not a rule set"),
    ("check rows.csv", 1, "a table of values, not a rule set"),
    (
        "show fan.yaml",
        2,
        "`show` prints built-in profiles and rule sets",
    ),
    ("check --csv fan.yaml", 2, "write `--json`"),
    ("map fan.yaml --csv out.csv", 2, "write `--output out.csv`"),
    (
        "check fan.yaml --json out.json",
        2,
        "`flagred check fan.yaml --json > out.json` writes this file",
    ),
    (
        "plot fan.yaml --png terms.png",
        2,
        "write `--svg terms.svg`",
    ),
    (
        "map fan.yaml --hold temperature 5",
        2,
        "write `--hold temperature=5`",
    ),
    (
        "map fan.yaml --hold temperature=5,5",
        2,
        "write a decimal point: `5.5`",
    ),
    (
        "map fan.yaml --hold temperature=5,humidity=3",
        2,
        "`--hold temperature=5 --hold humidity=3`",
    ),
    (
        "map fan.yaml --x temperature,humidity",
        2,
        "write `--x temperature --y humidity`",
    ),
    ("map --json fan.yaml", 2, "write `--csv`"),
    (
        "map fan.yaml --check earlier.csv",
        3,
        "`flagred map fan.yaml --csv --output earlier.csv` writes it",
    ),
    (
        "check fan.yaml --rising temperature,humidity",
        2,
        "`--rising temperature --rising humidity`",
    ),
    (
        "export rust fan.yaml",
        2,
        "an option begins with dashes: write `--rust`",
    ),
    (
        "export --fis -o built-in.fis",
        0,
        "wrote `built-in.fis`: the built-in rule set `flagred`",
    ),
    (
        "check zzz.yaml",
        3,
        "help: check the path; the folder has `fan.yaml`, `profile.yaml`, `unsigned.yaml`",
    ),
    ("check nope.yaml", 3, "help: check the path"),
    ("check fam.yaml", 3, "did you mean `fan.yaml`?"),
    (
        "check unsigned.yaml",
        1,
        "error[missing-key]: the profile has no key `flagred`",
    ),
];

#[test]
fn each_mistake_has_its_advice() {
    assert_advice(&files(), MISTAKES);
}
