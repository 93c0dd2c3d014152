//! The page, built in or from a file, and its content security policy.

use std::{fs, io::Read, path::Path};

use flate2::read::GzDecoder;

use crate::failure::Failure;

/// The gzipped page that `build.rs` found.
const PACKED: &[u8] = include_bytes!(concat!(env!("OUT_DIR"), "/studio.html.gz"));

/// The texts that surround the policy in the page.
const POLICY: (&str, &str) = (
    "<meta http-equiv=\"Content-Security-Policy\" content=\"",
    "\">",
);

pub(super) struct Page {
    pub(super) html: String,
    /// The content security policy of the page, which contains the hashes of its scripts.
    pub(super) policy: String,
}

/// Returns the page in a file, or the built-in one.
pub(super) fn find(file: Option<&Path>) -> Result<Page, Failure> {
    match file {
        Some(path) => {
            let shown = path.display();
            let html = fs::read_to_string(path).map_err(|error| {
                Failure::unreadable(format!("`{shown}` cannot be read: {error}"))
                    .help("check the path")
            })?;
            page(html).ok_or_else(|| {
                Failure::unreadable(format!("`{shown}` is not the page of the studio"))
                    .help("`web/build` writes it to crates/cli/page/studio.html")
            })
        }
        None => built_in(PACKED),
    }
}

fn built_in(packed: &[u8]) -> Result<Page, Failure> {
    let mut html = String::new();
    let unpacked = GzDecoder::new(packed).read_to_string(&mut html);
    unpacked.ok().and_then(|_| page(html)).ok_or_else(|| {
        Failure::usage("this `flagred` was built without the page of the studio").help(
            "released programs have it; in a clone, run `web/build` and build the program again",
        )
    })
}

/// Extracts the policy of a page. A file without a policy is not the page.
fn page(html: String) -> Option<Page> {
    let (before, after) = POLICY;
    let policy = html.split_once(before)?.1.split_once(after)?.0;
    let is_header = policy.chars().all(|c| matches!(c, ' '..='~'));
    let policy = is_header.then(|| policy.to_owned())?;
    Some(Page { html, policy })
}

#[cfg(test)]
mod tests {
    use std::io::Write;

    use flate2::{Compression, write::GzEncoder};

    use super::*;

    fn packed(html: &str) -> Vec<u8> {
        let mut packed = GzEncoder::new(Vec::new(), Compression::fast());
        packed.write_all(html.as_bytes()).unwrap();
        packed.finish().unwrap()
    }

    #[test]
    fn the_policy_is_read_from_the_page() {
        let html = "<meta http-equiv=\"Content-Security-Policy\" content=\"default-src 'none'; script-src 'sha256-x='\">";
        let page = built_in(&packed(html)).unwrap();
        assert_eq!(page.policy, "default-src 'none'; script-src 'sha256-x='");
        assert_eq!(page.html, html);
    }

    #[test]
    fn a_program_without_the_page_explains_how_to_get_it() {
        let failure = built_in(&packed("")).map(|page| page.html).unwrap_err();
        let reported = failure.to_string();
        assert!(reported.contains("without the page") && reported.contains("`web/build`"));
    }

    #[test]
    fn a_policy_with_a_line_break_is_rejected() {
        let split = "<meta http-equiv=\"Content-Security-Policy\" content=\"default-src *;\r\nSet-Cookie: a=b\">";
        assert!(page(split.to_owned()).is_none());
        assert!(page("<html></html>".to_owned()).is_none());
    }
}
