//! The `flagred` command.

fn main() {}
