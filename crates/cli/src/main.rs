//! The program. All of it is in the library, where fuzz targets and tests reach it.

use std::process::ExitCode;

fn main() -> ExitCode {
    flagred_cli::run(std::env::args_os()).into()
}
