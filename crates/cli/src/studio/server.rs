//! Access to the page and its file, only for the user of this machine who started the studio.
//!
//! Every user of the machine can connect, and every page in a browser can send requests here.
//! Therefore the path begins with a token that cannot be guessed, the `Host` header must name the
//! served address (another site could use a host name that resolves to it), and requests from other
//! pages are refused.

use std::{
    borrow::Cow,
    io::Read,
    net::SocketAddr,
    sync::{
        Mutex, PoisonError,
        atomic::{AtomicBool, Ordering},
    },
};

use flagred_authoring::provenance::digits;
use fuzzy::yaml::LARGEST_BYTES;
use percent_encoding::{NON_ALPHANUMERIC, utf8_percent_encode};

use super::{
    file::{EditedFile, SaveResult},
    http::{Refusal, Request, Response, Status},
    page::Page,
};
use crate::failure::Failure;

/// The policy of responses other than the page.
const NOTHING: &str = "default-src 'none'";
/// A directive that is sent as a header, because browsers ignore it in a policy inside the page.
const NO_FRAMES: &str = "; frame-ancestors 'none'";

pub(super) struct Server {
    /// The host and port, as a browser names them.
    authority: String,
    token: String,
    /// A path that redirects to the page once. Other users can see it, because it is in the command line of the
    /// browser, but they cannot see the address of the page.
    ticket: String,
    is_used: AtomicBool,
    page: Page,
    file: Option<EditedFile>,
    /// Held while the content of the file is compared and the new content is written.
    saving: Mutex<()>,
}

impl Server {
    pub(super) fn new(
        address: SocketAddr,
        page: Page,
        file: Option<EditedFile>,
    ) -> Result<Server, Failure> {
        Ok(Server {
            // Browsers omit the default port of HTTP.
            authority: match address.port() {
                80 => address.ip().to_string(),
                _ => address.to_string(),
            },
            token: secret()?,
            ticket: secret()?,
            is_used: AtomicBool::new(false),
            page,
            file,
            saving: Mutex::new(()),
        })
    }

    /// The address of the page.
    pub(super) fn address(&self) -> String {
        format!("http://{}/{}/", self.authority, self.token)
    }

    /// The address that redirects to the page once.
    pub(super) fn address_once(&self) -> String {
        format!("http://{}/{}/", self.authority, self.ticket)
    }

    /// Waits until no file is being written.
    pub(super) fn finish(&self) {
        drop(self.saving.lock());
    }

    /// Returns whether the path of a request begins with the token or the ticket.
    pub(super) fn is_for_the_user<S: Read>(&self, request: &Request<S>) -> bool {
        let first = request.path.split('/').nth(1);
        first.is_some_and(|first| first == self.token || first == self.ticket)
    }

    pub(super) fn respond<S: Read>(&self, request: &mut Request<S>) -> Response<'_> {
        let mut response = self.answer(request).unwrap_or_else(Response::from);
        let has_policy = |(name, _): &(&str, String)| *name == "Content-Security-Policy";
        if !response.headers.iter().any(has_policy) {
            let policy = format!("{NOTHING}{NO_FRAMES}");
            response.headers.push(("Content-Security-Policy", policy));
        }
        for (name, value) in [
            ("Cache-Control", "no-store"),
            ("Cross-Origin-Opener-Policy", "same-origin"),
            ("Cross-Origin-Resource-Policy", "same-origin"),
            ("Referrer-Policy", "no-referrer"),
            ("X-Content-Type-Options", "nosniff"),
        ] {
            response.headers.push((name, value.to_owned()));
        }
        response
    }

    fn answer<S: Read>(&self, request: &mut Request<S>) -> Result<Response<'_>, Refusal> {
        if request.header("host").as_deref() != Some(&self.authority) {
            return Err(Status::FORBIDDEN.refusal("requests under this host name are refused"));
        }
        let own = format!("http://{}", self.authority);
        if request.header("origin").is_some_and(|origin| origin != own) {
            return Err(Status::FORBIDDEN.refusal("requests from other pages are refused"));
        }
        let unknown = || Status::NOT_FOUND.refusal("there is nothing at this address");
        let path = request.path.strip_prefix('/').ok_or_else(unknown)?;
        let (first, rest) = path.split_once('/').ok_or_else(unknown)?;
        let is_page = first == self.token;
        match (rest, request.method.as_str()) {
            ("", "GET" | "HEAD") if first == self.ticket => self.lead(),
            ("", "GET" | "HEAD") if is_page => Ok(self.page()),
            ("api/file", "GET" | "HEAD") if is_page => self.read(request),
            ("api/file", "PUT") if is_page => self.save(request),
            ("" | "api/file", _) if is_page => {
                Err(Status::METHOD_NOT_ALLOWED
                    .refusal("this method is not supported at this address"))
            }
            _ => Err(unknown()),
        }
    }

    fn lead(&self) -> Result<Response<'_>, Refusal> {
        if self.is_used.swap(true, Ordering::Relaxed) {
            return Err(Status::NOT_FOUND.refusal(
                "this address was already opened; use the one that `flagred studio` printed. If you did not open it yourself, stop `flagred studio`",
            ));
        }
        Ok(Response {
            status: Status::SEE_OTHER,
            headers: vec![("Location", format!("/{}/", self.token))],
            body: Cow::Borrowed(""),
        })
    }

    fn page(&self) -> Response<'_> {
        Response {
            status: Status::OK,
            headers: vec![
                ("Content-Type", "text/html; charset=utf-8".to_owned()),
                (
                    "Content-Security-Policy",
                    format!("{}{NO_FRAMES}", self.page.policy),
                ),
            ],
            body: Cow::Borrowed(&self.page.html),
        }
    }

    fn read<S: Read>(&self, request: &Request<S>) -> Result<Response<'_>, Refusal> {
        let Some(file) = &self.file else {
            return Ok(Response {
                status: Status::NO_CONTENT,
                headers: Vec::new(),
                body: Cow::Borrowed(""),
            });
        };
        let content = file.read().map_err(failed)?;
        let is_known = request.header("if-none-match").as_ref() == Some(&content.tag);
        let name = utf8_percent_encode(&file.name(), NON_ALPHANUMERIC).to_string();
        Ok(Response {
            status: match is_known {
                true => Status::NOT_MODIFIED,
                false => Status::OK,
            },
            headers: vec![
                ("Content-Type", "text/plain; charset=utf-8".to_owned()),
                ("ETag", content.tag),
                ("X-File-Name", name),
                ("X-Read-Only", file.read_only.is_some().to_string()),
            ],
            body: match is_known {
                true => Cow::Borrowed(""),
                false => Cow::Owned(content.text),
            },
        })
    }

    fn save<S: Read>(&self, request: &mut Request<S>) -> Result<Response<'_>, Refusal> {
        let file = self
            .file
            .as_ref()
            .ok_or_else(|| Status::NOT_FOUND.refusal("there is no file to save to"))?;
        let expected = request
            .header("if-match")
            .ok_or_else(|| Status::PRECONDITION_REQUIRED.refusal("`If-Match` is missing"))?;
        if file.read_only.is_some() {
            return Err(Status::FORBIDDEN.refusal(&format!("`{}` is read only", file.name())));
        }
        let text = request.body(LARGEST_BYTES)?;
        let _saving = self.saving.lock().unwrap_or_else(PoisonError::into_inner);
        match file.save(&text, &expected).map_err(failed)? {
            SaveResult::Yes(tag) => Ok(Response {
                status: Status::NO_CONTENT,
                headers: vec![("ETag", tag)],
                body: Cow::Borrowed(""),
            }),
            SaveResult::Changed => {
                let words = format!("`{}` was changed on disk meanwhile", file.name());
                Err(Status::PRECONDITION_FAILED.refusal(&words))
            }
        }
    }
}

fn failed(failure: Failure) -> Refusal {
    Status::INTERNAL_ERROR.refusal(&failure.to_string())
}

/// Returns a random secret, in digits and letters.
fn secret() -> Result<String, Failure> {
    let mut bytes = [0; 16];
    getrandom::fill(&mut bytes).map_err(|error| {
        Failure::unreadable(format!("the system provides no random numbers: {error}"))
    })?;
    Ok(digits(&bytes))
}
