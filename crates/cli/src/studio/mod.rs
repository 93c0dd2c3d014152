//! `flagred studio`: the page in the browser, served on this machine or written as one file.

mod file;
mod http;
mod page;
mod server;
mod unauthenticated;

use std::{
    io::{self, Write},
    net::{Ipv4Addr, TcpListener},
    path::PathBuf,
    sync::{
        Arc,
        atomic::{AtomicUsize, Ordering},
        mpsc,
    },
    thread,
    time::Duration,
};

use fuzzy::drawing::visible;

use crate::{
    failure::{Exit, Failure},
    numbers::whole,
    output::{self, Files, Replace, Stdout},
};
use file::EditedFile;
use server::Server;
use unauthenticated::UnauthenticatedConnections;

/// Maximum number of open connections.
const CONNECTIONS: usize = 256;

#[derive(clap::Args)]
pub(crate) struct Arguments {
    /// The rule set or profile that the page edits; without one it starts with an example
    #[arg(value_name = "FILE")]
    file: Option<PathBuf>,

    /// Show the file and its changes, but never write it
    #[arg(long, requires = "file")]
    read_only: bool,

    /// The port on this machine [default: a free port]
    #[arg(
        long,
        value_name = "NUMBER",
        default_value_t = 0,
        hide_default_value = true,
        value_parser = whole(0, u16::MAX)
    )]
    port: u16,

    /// Do not open a browser, only print the address
    #[arg(long)]
    no_browser: bool,

    /// Write the page to this file instead of serving it, one HTML page that opens offline; `-` is standard output
    #[arg(long, value_name = "FILE", value_parser = output::page_path, conflicts_with_all = ["file", "port", "no_browser"])]
    html: Option<PathBuf>,

    /// Serve the page in this file instead of the built-in one
    #[arg(long, value_name = "FILE")]
    page: Option<PathBuf>,
}

/// Serves the page until interrupted.
pub(crate) fn run(arguments: &Arguments) -> Result<Exit, Failure> {
    let file = arguments
        .file
        .as_ref()
        .map(|path| EditedFile::open(path, arguments.read_only))
        .transpose()?;
    let page = page::find(arguments.page.as_deref())?;
    if let Some(html) = &arguments.html {
        let mut files = Files::reading(&arguments.page)?;
        files.output(html, Replace::Yes)?.write(&page.html)?;
        return Ok(Exit::Clean);
    }
    let (interrupt, interrupted) = mpsc::channel();
    ctrlc::set_handler(move || {
        // Sending fails only for a second interrupt, after the first has been received.
        let _ = interrupt.send(());
    })
    .map_err(|error| Failure::unreadable(format!("cannot set the handler for Ctrl-C: {error}")))?;
    let (listener, address) = TcpListener::bind((Ipv4Addr::LOCALHOST, arguments.port))
        .and_then(|listener| listener.local_addr().map(|address| (listener, address)))
        .map_err(|error| cannot_serve(arguments.port, &error))?;
    let file_line = file.as_ref().map(|file| match file.read_only {
        None => format!("edits `{}`", file.name()),
        Some("") => format!("shows `{}`, read only", file.name()),
        Some(why) => format!("shows `{}`, read only: {why}", file.name()),
    });
    let server = Arc::new(Server::new(address, page, file)?);
    let mut out = Stdout::text();
    writeln!(out, "{}", server.address())?;
    if let Some(line) = file_line {
        writeln!(out, "{}", visible(&line))?;
    }
    writeln!(out, "Ctrl-C stops the server")?;
    out.finish()?;
    let serving = Arc::clone(&server);
    thread::spawn(move || accept(&listener, &serving));
    if !arguments.no_browser
        && let Err(error) = open::that_detached(server.address_once())
    {
        output::print_note(&format!("no browser could be opened: {error}"));
    }
    // An error means that no interrupt can arrive any more.
    let _ = interrupted.recv();
    server.finish();
    Ok(Exit::Clean)
}

/// Answers each connection in its own thread, because browsers open connections before they use them.
fn accept(listener: &TcpListener, server: &Arc<Server>) {
    let open = Arc::new(AtomicUsize::new(0));
    let unauthenticated = Arc::new(UnauthenticatedConnections::default());
    for connection in listener.incoming() {
        let Ok(stream) = connection else {
            // The error may be temporary, such as too many open files.
            thread::sleep(Duration::from_millis(100));
            continue;
        };
        if open.fetch_add(1, Ordering::Relaxed) >= CONNECTIONS {
            open.fetch_sub(1, Ordering::Relaxed);
            continue;
        }
        let (server, open) = (Arc::clone(server), Arc::clone(&open));
        let unauthenticated = Arc::clone(&unauthenticated);
        let number = unauthenticated.admit(&stream);
        thread::spawn(move || {
            // The error of a failed connection cannot be reported to anybody.
            let _ = http::serve(&stream, |request| {
                if server.is_for_the_user(request) {
                    unauthenticated.forget(number);
                }
                server.respond(request)
            });
            unauthenticated.forget(number);
            open.fetch_sub(1, Ordering::Relaxed);
        });
    }
}

fn cannot_serve(port: u16, error: &io::Error) -> Failure {
    match error.kind() {
        io::ErrorKind::AddrInUse => Failure::usage(format!("port {port} is in use"))
            .help("name another port, or leave `--port` out to use a free one"),
        _ => Failure::usage(format!("port {port} cannot be opened: {error}")),
    }
}
