//! `mocc watch`: a report that is made again whenever a file of the model is saved, in a page that updates itself.
//!
//! The page is served on 127.0.0.1 only, to requests for that host only: nothing of it leaves the machine. It asks for the
//! number of the last run twice a second. A run that fails leaves the last page, under its messages.

use std::io::{BufRead, BufReader, ErrorKind, Read, Write};
use std::net::{Ipv4Addr, TcpListener, TcpStream};
use std::path::{Path, PathBuf};
use std::sync::{Arc, Mutex};
use std::time::{Duration, Instant};

use super::args::runs::Watch;
use super::{Status, capture_errors, interrupt, print, report};
use crate::driver::stamps::stamps;
use crate::io::atomic_file::{scratch_path, take_file};
use crate::io::json::Json;
use crate::report::markup::{escaped, in_script};

/// Time between two looks at the files.
const PATIENCE: Duration = Duration::from_millis(150);
/// Time in which a browser must have sent its request.
const SLOW: Duration = Duration::from_secs(2);
/// Bytes of a request that are read.
const LONGEST_REQUEST: u64 = 1 << 14;

/// What is served.
#[derive(Default)]
struct Shown {
    /// Number of the run.
    version: u64,
    /// The last page that could be made.
    page: String,
    /// Messages of the last run.
    messages: String,
    /// The last run failed.
    failed: bool,
}

/// Runs the command, until Ctrl-C.
pub fn run(options: &Watch) -> Status {
    let listener = match TcpListener::bind((Ipv4Addr::LOCALHOST, options.port)) {
        Ok(listener) => listener,
        Err(why) => {
            eprintln!("error: cannot serve at port {}: {why}", options.port);
            return Status::Usage;
        }
    };
    let Ok(address) = listener.local_addr() else {
        eprintln!("error: the port has no address");
        return Status::Usage;
    };
    if let Some(file) = options.report.model.file.as_deref().filter(|file| !file.is_file()) {
        eprintln!("error: there is no file {}", file.display());
        return Status::Usage;
    }
    interrupt::listen();
    let shown = Arc::new(Mutex::new(Shown::default()));
    let served = Arc::clone(&shown);
    let port = address.port();
    // The process ends with the command, and with it this thread.
    std::thread::spawn(move || {
        for stream in listener.incoming().flatten() {
            // A browser that leaves is no error.
            let _ = answer(stream, port, &served);
        }
    });
    match print(&format!("http://{address}/\n")) {
        Status::Done => {}
        status => return status,
    }
    let places = places(options);
    loop {
        let seen = stamps(&places);
        make(options, &shown);
        // Saved while it ran: run again at once.
        while stamps(&places) == seen {
            if interrupt::is_requested() {
                return Status::Done;
            }
            std::thread::sleep(PATIENCE);
        }
        if interrupt::is_requested() {
            return Status::Done;
        }
        // An editor may write a file in several steps.
        std::thread::sleep(PATIENCE);
    }
}

/// The files and folders whose changes count.
fn places(options: &Watch) -> Vec<PathBuf> {
    let report = &options.report;
    let own = report.model.file.as_deref().and_then(Path::parent);
    let own = own.map(|p| if p == Path::new("") { Path::new(".") } else { p }.to_owned());
    let folders = report.model.folders.iter().chain(&report.model.allow_read);
    own.into_iter().chain(folders.cloned()).chain(report.data.iter().cloned()).collect()
}

/// Makes the page.
fn make(options: &Watch, shown: &Mutex<Shown>) {
    let begun = Instant::now();
    let path = scratch_path("html");
    let (status, messages) = capture_errors(|| report::make_page(&options.report, path.clone()));
    let failed = !matches!(status, Status::Done | Status::Interrupted);
    let page = take_file(&path).ok().and_then(|bytes| String::from_utf8(bytes).ok());
    let Ok(mut shown) = shown.lock() else { return };
    shown.version += 1;
    if let Some(page) = page.filter(|_| !failed) {
        shown.page = page;
    }
    (shown.messages, shown.failed) = (messages, failed);
    let outcome = if failed { "failed" } else { "done" };
    let line =
        format!("run {}: {outcome} in {:.2} s\n", shown.version, begun.elapsed().as_secs_f64());
    drop(shown);
    print(&line);
}

/// Answers one request.
fn answer(mut stream: TcpStream, port: u16, shown: &Mutex<Shown>) -> std::io::Result<()> {
    stream.set_read_timeout(Some(SLOW))?;
    let mut reader = BufReader::new(stream.try_clone()?.take(LONGEST_REQUEST));
    let (mut line, mut host) = (String::new(), String::new());
    reader.read_line(&mut line)?;
    loop {
        let mut header = String::new();
        match reader.read_line(&mut header) {
            Ok(0) => break,
            Ok(_) if header.trim().is_empty() => break,
            Ok(_) => {
                if let Some((name, value)) = header.split_once(':')
                    && name.eq_ignore_ascii_case("host")
                {
                    host = value.trim().to_owned();
                }
            }
            Err(why) if why.kind() == ErrorKind::Interrupted => {}
            Err(why) => return Err(why),
        }
    }
    // A page of another site cannot read this one under a name of its own.
    let is_own = [format!("127.0.0.1:{port}"), format!("localhost:{port}")].contains(&host);
    let mut words = line.split_whitespace();
    let (method, path) = (words.next().unwrap_or(""), words.next().unwrap_or(""));
    let poisoned = || std::io::Error::other("the run has failed");
    let (status, kind, body) = match (is_own, method, path) {
        (false, ..) => ("403 Forbidden", "text/plain", "only for 127.0.0.1\n".to_owned()),
        (true, "GET", "/") => {
            let shown = shown.lock().map_err(|_| poisoned())?;
            ("200 OK", "text/html; charset=utf-8", page(&shown))
        }
        (true, "GET", "/version") => {
            let shown = shown.lock().map_err(|_| poisoned())?;
            ("200 OK", "text/plain", shown.version.to_string())
        }
        _ => ("404 Not Found", "text/plain", "not here\n".to_owned()),
    };
    write!(
        stream,
        "HTTP/1.1 {status}\r\nContent-Type: {kind}\r\nContent-Length: {}\r\nCache-Control: no-store\r\nConnection: close\r\n\r\n",
        body.len()
    )?;
    stream.write_all(body.as_bytes())
}

/// The page with what updates it, and the messages of the last run.
fn page(shown: &Shown) -> String {
    let empty = "<!DOCTYPE html><html lang=\"en\"><head><meta charset=\"utf-8\"><title>mocc watch</title></head><body></body></html>";
    let page = if shown.page.is_empty() { empty } else { shown.page.as_str() };
    let (before, after) = page.rsplit_once("</body>").unwrap_or((page, ""));
    let messages = match shown.messages.trim() {
        "" => String::new(),
        text => {
            let heading = match (shown.failed, shown.version) {
                (true, 0) => "",
                (true, _) if shown.page.is_empty() => "The run failed.",
                (true, _) => "The run failed: below is the last page that could be made.",
                (false, _) => "",
            };
            format!(
                "<aside id=\"mocc-messages\" role=\"alert\" style=\"position:fixed;left:0;right:0;bottom:0;max-height:50vh;overflow:auto;\
                 padding:10px 16px;background:#fff4ec;color:#1a1a1a;border-top:3px solid #c05200;z-index:9\"><b>{heading}</b>\
                 <pre style=\"margin:4px 0;white-space:pre-wrap\">{}</pre></aside>\n",
                escaped(&without_colours(text))
            )
        }
    };
    let version = in_script(&Json::text(shown.version.to_string()).compact());
    format!(
        "{before}{messages}<script>const version = {version};\n{UPDATE}</script>\n</body>{after}"
    )
}

/// A text of the terminal without the codes of its colours.
fn without_colours(text: &str) -> String {
    let mut parts = text.split("\u{1b}[");
    let first = parts.next().unwrap_or("").to_owned();
    parts.fold(first, |out, part| out + part.split_once('m').map_or(part, |(_, rest)| rest))
}

/// Reloads the page once there is another run, and keeps what is shown, where, and the place in the page.
const UPDATE: &str = include_str!("watch.js");
