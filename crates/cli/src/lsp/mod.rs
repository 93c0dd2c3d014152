//! `flagred lsp`: a language server for rule sets and profiles, over standard input and output.

mod document;
mod transport;

use std::{collections::HashMap, io};

use flagred_authoring::{
    Document,
    completion::{self, Completion, Kind},
    layout, names,
};
use gen_lsp_types as lsp;
use lsp_server::{ErrorCode, ExtractError, Message, Notification, Request, Response};
use serde::{Serialize, de::DeserializeOwned};

use crate::failure::{Exit, Failure};
use document::Encoding;

#[derive(clap::Args)]
pub(crate) struct Arguments {
    /// Use standard input and output, which is always the case; accepted because editors add this
    /// option
    #[arg(long, hide = true)]
    stdio: bool,
}

pub(crate) fn run(_: &Arguments) -> Result<Exit, Failure> {
    let (mut from, mut to) = (io::stdin().lock(), io::stdout().lock());
    let mut server = Server::default();
    while let Some(message) = transport::read(&mut from).map_err(broken)? {
        let answers = match message {
            Message::Request(request) => vec![Message::Response(server.respond(request))],
            Message::Notification(notification) if notification.method == "exit" => {
                // The protocol requires exit code 1 if the editor did not send `shutdown` before.
                return match server.phase {
                    Phase::ShutDown => Ok(Exit::Clean),
                    _ => Err(Failure::shown(1)),
                };
            }
            Message::Notification(notification) => server.take(notification),
            Message::Response(_) => Vec::new(),
        };
        for answer in answers {
            // Writing fails if the editor has exited.
            if answer.write(&mut to).is_err() {
                return Ok(Exit::Clean);
            }
        }
    }
    Ok(Exit::Clean)
}

fn broken(error: impl std::fmt::Display) -> Failure {
    Failure::unreadable(format!("the editor violated the protocol: {error}"))
}

fn abilities(encoding: Encoding) -> lsp::InitializeResult {
    let triggers = [" ", ":", "[", "{", ","].map(str::to_owned);
    lsp::InitializeResult {
        capabilities: lsp::ServerCapabilities {
            position_encoding: Some(encoding.kind()),
            text_document_sync: Some(lsp::TextDocumentSyncKind::Full.into()),
            completion_provider: Some(lsp::CompletionOptions {
                trigger_characters: Some(triggers.to_vec()),
                ..lsp::CompletionOptions::default()
            }),
            hover_provider: Some(true.into()),
            definition_provider: Some(true.into()),
            rename_provider: Some(true.into()),
            document_formatting_provider: Some(true.into()),
            ..lsp::ServerCapabilities::default()
        },
        server_info: Some(lsp::ServerInfo {
            name: "flagred".into(),
            version: Some(env!("CARGO_PKG_VERSION").into()),
        }),
    }
}

#[derive(Default)]
struct Server {
    phase: Phase,
    encoding: Encoding,
    open: HashMap<lsp::Uri, Document>,
}

/// The state of the session.
#[derive(Default, Clone, Copy, PartialEq, Eq)]
enum Phase {
    #[default]
    Started,
    Initialized,
    ShutDown,
}

impl Server {
    /// Returns the answer to a request. The protocol allows some requests only in certain phases.
    fn respond(&mut self, request: Request) -> Response {
        let error = |code: ErrorCode, why: &str| {
            Response::new_err(request.id.clone(), code as i32, why.to_owned())
        };
        match (self.phase, request.method.as_str()) {
            (Phase::Started, "initialize") => {
                self.phase = Phase::Initialized;
                self.encoding = Encoding::of(&request.params);
                Response::new_ok(request.id, abilities(self.encoding))
            }
            (Phase::Started, _) => {
                error(ErrorCode::ServerNotInitialized, "send `initialize` first")
            }
            (Phase::Initialized, "initialize") => {
                error(ErrorCode::InvalidRequest, "`initialize` was sent already")
            }
            (Phase::Initialized, "shutdown") => {
                self.phase = Phase::ShutDown;
                Response::new_ok(request.id, ())
            }
            (Phase::Initialized, _) => self.answer(request),
            (Phase::ShutDown, _) => error(
                ErrorCode::InvalidRequest,
                "only `exit` may follow `shutdown`",
            ),
        }
    }

    /// Processes a notification, and returns the diagnostics of the document that it changes.
    fn take(&mut self, notification: Notification) -> Vec<Message> {
        let notification =
            match of::<lsp::DidOpenTextDocumentParams>(notification, "textDocument/didOpen") {
                Ok(opened) => {
                    return self.read(opened.text_document.uri, opened.text_document.text);
                }
                Err(notification) => notification,
            };
        let notification = match of::<lsp::DidChangeTextDocumentParams>(
            notification,
            "textDocument/didChange",
        ) {
            Ok(changed) => {
                let uri = changed.text_document.text_document_identifier.uri;
                // Each change contains the whole text, as the server requested.
                let text = changed.content_changes.into_iter().last().map(|change| match change {
                    lsp::TextDocumentContentChangeEvent::TextDocumentContentChangeWholeDocument(whole) => whole.text,
                    lsp::TextDocumentContentChangeEvent::TextDocumentContentChangePartial(part) => part.text,
                });
                return text.map_or_else(Vec::new, |text| self.read(uri, text));
            }
            Err(notification) => notification,
        };
        match of::<lsp::DidCloseTextDocumentParams>(notification, "textDocument/didClose") {
            Ok(closed) => {
                self.open.remove(&closed.text_document.uri);
                vec![diagnostics(closed.text_document.uri, Vec::new())]
            }
            Err(_) => Vec::new(),
        }
    }

    fn read(&mut self, uri: lsp::Uri, text: String) -> Vec<Message> {
        let document = document::open(&uri, text);
        let found = document::diagnostics(&document, &uri, self.encoding);
        self.open.insert(uri.clone(), document);
        vec![diagnostics(uri, found)]
    }

    fn answer(&self, request: Request) -> Response {
        let id = request.id.clone();
        let encoding = self.encoding;
        let at = |there: &lsp::TextDocumentPositionParams| {
            let document = self.open.get(&there.text_document.uri)?;
            Some((document, encoding.offset(document.text(), there.position)))
        };
        let done = match request.method.as_str() {
            "textDocument/completion" => reply(request, |requested: lsp::CompletionParams| {
                let (document, offset) = at(&requested.text_document_position_params)?;
                let found = completion::at(document, offset).into_iter();
                Some(found.map(item).collect::<Vec<_>>())
            }),
            "textDocument/hover" => reply(request, |requested: lsp::HoverParams| {
                let (document, offset) = at(&requested.text_document_position_params)?;
                let meant = names::describe(document, offset)?;
                let markdown = lsp::MarkupContent::new(lsp::MarkupKind::Markdown, meant.markdown);
                let range = encoding.range(document.text(), &meant.span);
                Some(lsp::Hover {
                    contents: markdown.into(),
                    range: Some(range),
                })
            }),
            "textDocument/definition" => reply(request, |requested: lsp::DefinitionParams| {
                let there = &requested.text_document_position_params;
                let (document, offset) = at(there)?;
                let span = names::definition(document, offset)?;
                let range = encoding.range(document.text(), &span);
                Some(lsp::Location {
                    uri: there.text_document.uri.clone(),
                    range,
                })
            }),
            "textDocument/rename" => {
                let requested: lsp::RenameParams = match serde_json::from_value(request.params) {
                    Ok(requested) => requested,
                    Err(error) => {
                        return Response::new_err(
                            id,
                            ErrorCode::InvalidParams as i32,
                            error.to_string(),
                        );
                    }
                };
                let there = &requested.text_document_position_params;
                let Some((document, offset)) = at(there) else {
                    return Response::new_ok(id, None::<lsp::WorkspaceEdit>);
                };
                match names::rename(document, offset, &requested.new_name) {
                    Err(why) => return Response::new_err(id, ErrorCode::RequestFailed as i32, why),
                    Ok(spans) => {
                        let edit = |span| lsp::TextEdit {
                            range: encoding.range(document.text(), span),
                            new_text: requested.new_name.clone(),
                        };
                        let edits = spans.iter().map(edit).collect();
                        let changes = HashMap::from([(there.text_document.uri.clone(), edits)]);
                        Ok(lsp::WorkspaceEdit {
                            changes: Some(changes),
                            ..lsp::WorkspaceEdit::default()
                        })
                        .and_then(serde_json::to_value)
                    }
                }
            }
            "textDocument/formatting" => {
                reply(request, |requested: lsp::DocumentFormattingParams| {
                    let document = self.open.get(&requested.text_document.uri)?;
                    let formatted = layout::formatted(document.text()).ok()?;
                    let range = encoding.range(document.text(), &(0..document.text().len()));
                    Some(vec![lsp::TextEdit {
                        range,
                        new_text: formatted,
                    }])
                })
            }
            other => {
                let why = format!("`{other}` is not supported");
                return Response::new_err(id, ErrorCode::MethodNotFound as i32, why);
            }
        };
        match done {
            Ok(value) => Response::new_ok(id, value),
            Err(error) => Response::new_err(id, ErrorCode::InvalidParams as i32, error.to_string()),
        }
    }
}

fn item(found: Completion) -> lsp::CompletionItem {
    let kind = match found.kind {
        Kind::Keyword => lsp::CompletionItemKind::Keyword,
        Kind::Variable => lsp::CompletionItemKind::Variable,
        Kind::Choice => lsp::CompletionItemKind::EnumMember,
        Kind::Key => lsp::CompletionItemKind::Property,
        Kind::Signal => lsp::CompletionItemKind::Value,
    };
    lsp::CompletionItem {
        insert_text: (found.text != found.label).then_some(found.text),
        label: found.label,
        kind: Some(kind),
        detail: found.detail,
        ..lsp::CompletionItem::default()
    }
}

/// Deserialises the parameters of a request and serialises its answer; `null` if there is no answer.
fn reply<P: DeserializeOwned, A: Serialize>(
    request: Request,
    answer: impl FnOnce(P) -> Option<A>,
) -> serde_json::Result<serde_json::Value> {
    serde_json::to_value(answer(serde_json::from_value(request.params)?))
}

/// Returns the parameters of a notification with this method; otherwise returns the notification as the error.
fn of<P: DeserializeOwned>(notification: Notification, method: &str) -> Result<P, Notification> {
    match notification.extract(method) {
        Ok(parameters) => Ok(parameters),
        Err(ExtractError::MethodMismatch(notification)) => Err(notification),
        // A malformed notification changes nothing: the next one contains the whole text again.
        Err(ExtractError::JsonError { method, .. }) => Err(Notification::new(method, ())),
    }
}

fn diagnostics(uri: lsp::Uri, diagnostics: Vec<lsp::Diagnostic>) -> Message {
    let parameters = lsp::PublishDiagnosticsParams {
        uri,
        version: None,
        diagnostics,
    };
    Message::Notification(Notification::new(
        "textDocument/publishDiagnostics".into(),
        parameters,
    ))
}
