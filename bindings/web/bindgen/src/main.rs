//! `flagred-web-bindgen MODULE FOLDER NAME` processes a compiled WebAssembly module: it writes the module in the
//! form that web pages load, together with JavaScript and type declarations.
//!
//! The program `wasm-bindgen --target web` does the same, but its version must match the version of
//! `wasm-bindgen` with which the module was compiled. Here, Cargo.lock ensures the right version, and nothing
//! needs to be installed.

use std::{env, process::ExitCode};

use wasm_bindgen_cli_support::Bindgen;

#[expect(clippy::print_stderr, reason = "it is a program")]
fn main() -> ExitCode {
    let mut arguments = env::args().skip(1);
    let (Some(module), Some(folder), Some(name)) =
        (arguments.next(), arguments.next(), arguments.next())
    else {
        eprintln!("usage: flagred-web-bindgen MODULE FOLDER NAME");
        return ExitCode::from(2);
    };
    let mut bindgen = Bindgen::new();
    let written = bindgen
        .input_path(&module)
        .out_name(&name)
        .typescript(true)
        .remove_name_section(true)
        .remove_producers_section(true)
        .web(true)
        .and_then(|bindgen| bindgen.generate(folder));
    match written {
        Ok(()) => ExitCode::SUCCESS,
        Err(error) => {
            eprintln!("error: `{module}`: {error:#}");
            ExitCode::from(3)
        }
    }
}
