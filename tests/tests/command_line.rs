//! The command line as its users meet it: exit codes, and what is said where.

use flagred_tests::flagred;

#[test]
fn wrong_usage_is_2_and_says_what_is_right() {
    let output = flagred().arg("asses").output().unwrap();
    assert_eq!(output.status.code(), Some(2));
    assert!(String::from_utf8_lossy(&output.stderr).contains("assess"));
}

#[test]
fn help_names_every_command() {
    let output = flagred().arg("--help").output().unwrap();
    assert_eq!(output.status.code(), Some(0));
    assert!(String::from_utf8_lossy(&output.stdout).contains("assess"));
}
