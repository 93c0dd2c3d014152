//! Embeds the gzipped page of `flagred studio` in the program, or an empty file if there is no page.

use std::{env, fs, io::Write, path::PathBuf};

use flate2::{Compression, write::GzEncoder};

/// The environment variable with the path of a page that is embedded instead of the one from `web/build`.
const VARIABLE: &str = "FLAGRED_STUDIO_PAGE";

fn main() -> std::io::Result<()> {
    println!("cargo::rerun-if-changed=build.rs");
    // Declares the folder as an input of the build, since cargo cannot watch a file that does not
    // exist yet.
    println!("cargo::rerun-if-changed=page");
    println!("cargo::rerun-if-env-changed={VARIABLE}");
    let page = match env::var_os(VARIABLE).map(PathBuf::from) {
        Some(named) => {
            println!("cargo::rerun-if-changed={}", named.display());
            fs::read(named)?
        }
        None => fs::read("page/studio.html").unwrap_or_default(),
    };
    let mut packed = GzEncoder::new(Vec::new(), Compression::best());
    packed.write_all(&page)?;
    let out = PathBuf::from(env::var_os("OUT_DIR").unwrap_or_default());
    fs::write(out.join("studio.html.gz"), packed.finish()?)
}
