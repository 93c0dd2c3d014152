//! The command line from a user's point of view: exit codes and messages.

use flagred_tests::{STEADY, flagred};

#[test]
fn wrong_usage_exits_with_2_and_suggests_a_correction() {
    let output = flagred().arg("asses").output().unwrap();
    assert_eq!(output.status.code(), Some(2));
    assert!(String::from_utf8_lossy(&output.stderr).contains("assess"));
}

/// The messages for arguments that are nearly right lead to the correct command.
#[test]
fn misplaced_arguments_are_reported_with_their_correct_position() {
    let rules = concat!(env!("CARGO_MANIFEST_DIR"), "/../rules/flagred.yaml");
    let profile = concat!(
        env!("CARGO_MANIFEST_DIR"),
        "/../rules/profiles/multirotor.yaml"
    );
    let folder = env!("CARGO_MANIFEST_DIR");
    let profile_of_rules = ["assess", "--profile", rules, STEADY];
    for (arguments, code, said, help) in [
        (
            &[STEADY][..],
            2,
            "is a file, not a command",
            "`flagred assess ",
        ),
        (
            &profile_of_rules,
            3,
            "is a rule set, not a profile",
            "`rules: flagred.yaml`",
        ),
        (
            &["explain", profile, "x=1"],
            3,
            "is a profile, not a rule set",
            "`flagred`",
        ),
        (
            &["eval", profile],
            3,
            "is a profile, not a rule set",
            "`flagred`",
        ),
        (
            &["assess", folder],
            3,
            "is a folder",
            "name the files in it",
        ),
        (
            &["assess", "nowhere.bin"],
            3,
            "`nowhere.bin` cannot be read",
            "check the path",
        ),
    ] {
        let output = flagred().args(arguments).output().unwrap();
        let reported = String::from_utf8(output.stderr).unwrap();
        assert_eq!(output.status.code(), Some(code), "{reported}");
        assert!(
            reported.contains(said) && reported.lines().count() == 2,
            "{reported}"
        );
        assert!(
            reported.contains("  help: ") && reported.contains(help),
            "{reported}"
        );
    }
}

#[test]
fn help_completions_and_manual_name_the_commands() {
    let commands = [
        "assess", "check", "dataset", "validate", "learn", "map", "watch",
    ];
    let said = |arguments: &[&str]| {
        let output = flagred().args(arguments).output().unwrap();
        assert_eq!(output.status.code(), Some(0), "{arguments:?}");
        String::from_utf8(output.stdout).unwrap()
    };
    for of in [
        &["--help"][..],
        &["completions", "bash"],
        &["completions", "zsh"],
        &["completions", "fish"],
        &["man"],
    ] {
        let text = said(of);
        for command in commands {
            assert!(text.contains(command), "{of:?} lacks {command}");
        }
    }
    assert!(said(&["man", "learn"]).contains("min\\-support"));

    let folder = std::env::temp_dir().join(format!("flagred-manual-{}", std::process::id()));
    said(&["man", "--folder", folder.to_str().unwrap()]);
    let pages = std::fs::read_dir(&folder).unwrap().count();
    std::fs::remove_dir_all(&folder).unwrap();
    assert!(pages > commands.len(), "{pages}");

    let profiles = ["flagred", "flagred-paper", "flagred-battery"].join(" ");
    for (shell, offered) in [
        (
            "bash",
            format!("--profile)\n                    COMPREPLY=($(compgen -W \"{profiles}\""),
        ),
        ("zsh", format!("{{ compadd {profiles}; _files }}")),
        ("fish", format!("or a file' -r -a \"{profiles}\"")),
    ] {
        assert!(said(&["completions", shell]).contains(&offered), "{shell}");
    }

    let output = flagred().args(["man", "lern"]).output().unwrap();
    assert_eq!(output.status.code(), Some(2));
    assert!(String::from_utf8_lossy(&output.stderr).contains("learn"));
}
