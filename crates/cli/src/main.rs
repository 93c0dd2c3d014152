//! The program. All its code is in the library, which fuzz targets and tests can call.

use std::process::ExitCode;

fn main() -> ExitCode {
    flagred_cli::run(std::env::args_os()).into()
}
