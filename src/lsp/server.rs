//! The server: keeps the texts of the client, and hands its requests and the checks of texts to threads.

use std::collections::{BTreeMap, BTreeSet};
use std::ffi::OsString;
use std::io::{self, BufRead, Write};
use std::path::{Path, PathBuf};
use std::sync::Arc;
use std::sync::atomic::{AtomicBool, Ordering};
use std::sync::mpsc::{Receiver, Sender, TryRecvError, channel};

use super::asked::{Asked, is_toml};
use super::diagnostics::{Placed, check, check_plan, files_of, json};
use super::jobs::Worker;
use super::message::{Received, notification, read, refusal, write};
use super::plans::{Plan, is_plan};
use super::position::{Lines, path_of};
use super::protocol::{
    Answer, CANCELLED, INTERNAL_ERROR, INVALID_PARAMETERS, INVALID_REQUEST, KNOWN,
    METHOD_NOT_FOUND, NOT_INITIALIZED, PARSE_ERROR, REQUEST_FAILED, SYMBOL, capabilities, lacking,
    message_of,
};
use super::repairs;
use super::workspace::Workspace;
use crate::base::diag::Severity;
use crate::driver::files::canonical_folders;
use crate::driver::open_texts::{OpenTexts, canonical};
use crate::driver::project::NAME;
use crate::io::json::Json;

/// How the client ended.
#[derive(Clone, Copy, PartialEq, Eq, Debug)]
pub enum Ended {
    /// It asked for the end before.
    Orderly,
    /// It did not.
    Abruptly,
}

/// A text of the client.
struct Document {
    text: String,
    /// Its file, without links.
    path: PathBuf,
    /// The number that the client gave it.
    version: Option<Json>,
    /// Changed, itself or a file that it depends on, since it was checked.
    changed: bool,
    /// How often it has become `changed`.
    edition: u64,
    placed: Vec<Placed>,
    /// The files that its last check has read.
    reads: BTreeSet<PathBuf>,
}

impl Document {
    fn new(text: String, address: &str, version: Option<Json>) -> Document {
        let path = path_of(address).map_or_else(|| "untitled.mo".into(), |path| canonical(&path));
        let (placed, reads) = (Vec::new(), BTreeSet::new());
        Document { text, path, version, changed: true, edition: 0, placed, reads }
    }

    fn touch(&mut self) {
        self.changed = true;
        self.edition += 1;
    }
}

/// What the server waits for.
enum Event {
    Received(io::Result<Received>),
    /// The answer to a request.
    Answered {
        id: Json,
        answer: Answer,
    },
    /// The diagnostics of an edition of a text; none if the check has panicked.
    Checked {
        address: String,
        edition: u64,
        checked: Option<Checked>,
    },
}

struct Checked {
    placed: Vec<Placed>,
    diagnostics: Json,
    reads: BTreeSet<PathBuf>,
}

struct Server<W> {
    out: W,
    documents: BTreeMap<String, Document>,
    workspace: Workspace,
    initialized: bool,
    shut_down: bool,
    answers: Worker,
    checks: Worker,
    is_checking: bool,
    events: Sender<Event>,
    /// The requests that are not answered yet, by their numbers, and whether the client has withdrawn them.
    waiting: BTreeMap<String, Arc<AtomicBool>>,
}

/// Serves a client until it ends the connection. `modelica_path` is the value of `MODELICAPATH`.
pub fn serve(
    mut input: impl BufRead + Send + 'static,
    out: impl Write,
    modelica_path: Option<OsString>,
) -> io::Result<Ended> {
    let (events, received) = channel();
    let sender = events.clone();
    // Reading on a thread of its own shows whether more changes wait, so only the last is checked.
    std::thread::Builder::new().name("read".into()).spawn(move || {
        loop {
            let message = read(&mut input);
            let is_last = matches!(message, Ok(Received::End) | Err(_));
            if sender.send(Event::Received(message)).is_err() || is_last {
                break;
            }
        }
    })?;
    let mut server = Server {
        out,
        documents: BTreeMap::new(),
        workspace: Workspace {
            open: OpenTexts::new(BTreeMap::new()),
            modelica_path: canonical_folders(modelica_path.as_deref()),
            ..Workspace::default()
        },
        initialized: false,
        shut_down: false,
        answers: Worker::start("answer")?,
        checks: Worker::start("check")?,
        is_checking: false,
        events,
        waiting: BTreeMap::new(),
    };
    server.run(&received)
}

impl<W: Write> Server<W> {
    fn run(&mut self, events: &Receiver<Event>) -> io::Result<Ended> {
        loop {
            let event = match events.try_recv() {
                Ok(event) => Some(event),
                Err(TryRecvError::Empty) => {
                    self.check_next();
                    events.recv().ok()
                }
                Err(TryRecvError::Disconnected) => None,
            };
            let ended = match event {
                None | Some(Event::Received(Ok(Received::End))) => true,
                Some(Event::Received(Err(why))) => return Err(why),
                Some(Event::Received(Ok(Received::Broken(why)))) => {
                    write(&mut self.out, &refusal(Json::null(), PARSE_ERROR, &why))?;
                    false
                }
                Some(Event::Received(Ok(Received::Message(message)))) => self.message(&message)?,
                Some(Event::Answered { id, answer }) => {
                    self.reply(id, answer)?;
                    false
                }
                Some(Event::Checked { address, edition, checked }) => {
                    self.is_checking = false;
                    self.checked(&address, edition, checked)?;
                    false
                }
            };
            if ended && !self.shut_down {
                self.answer_rest(events)?;
            }
            if ended {
                return Ok(if self.shut_down { Ended::Orderly } else { Ended::Abruptly });
            }
        }
    }

    /// Waits for the answers to the requests of a client that has said everything.
    fn answer_rest(&mut self, events: &Receiver<Event>) -> io::Result<()> {
        while !self.waiting.is_empty() {
            if let Ok(Event::Answered { id, answer }) = events.recv() {
                self.reply(id, answer)?;
            }
        }
        Ok(())
    }

    /// Deals with a message; true if it is the last one.
    fn message(&mut self, message: &Json) -> io::Result<bool> {
        let id = message.at(&["id"]);
        let Some(method) = message.text_at(&["method"]).filter(|method| !method.is_empty()) else {
            // An answer to something that the server never asks is nothing.
            let is_answer = ["result", "error"].iter().any(|key| message.at(&[key]).is_some());
            if !is_answer {
                let why = "this is neither a request nor a notification";
                let id = id.unwrap_or_else(Json::null);
                write(&mut self.out, &refusal(id, INVALID_REQUEST, why))?;
            }
            return Ok(false);
        };
        let method = method.to_owned();
        if method == "exit" {
            return Ok(true);
        }
        match id {
            None if self.initialized => self.notified(&method, message)?,
            // Before the client has introduced itself, notifications are dropped.
            None => {}
            Some(id) => {
                if let Some(answer) = self.request(&id, &method, message) {
                    write(&mut self.out, &message_of(id, answer))?;
                }
            }
        }
        Ok(false)
    }

    /// Sends an answer, unless the request has been withdrawn.
    fn reply(&mut self, id: Json, answer: Answer) -> io::Result<()> {
        match self.waiting.remove(&id.compact()) {
            Some(_) => write(&mut self.out, &message_of(id, answer)),
            None => Ok(()),
        }
    }

    /// Changes of texts.
    fn notified(&mut self, method: &str, message: &Json) -> io::Result<()> {
        let address = message.text_at(&["params", "textDocument", "uri"]).unwrap_or_default();
        let version = message.at(&["params", "textDocument", "version"]);
        match method {
            "textDocument/didOpen" => {
                let text = message.text_at(&["params", "textDocument", "text"]).unwrap_or_default();
                let document = Document::new(text.to_owned(), address, version);
                // Most files are opened as they are on disk.
                let is_new = self.workspace.text(&document.path).as_deref() != Some(text);
                let path = document.path.clone();
                self.documents.insert(address.to_owned(), document);
                self.opened();
                if is_new {
                    self.touch_dependents(&path, address);
                }
            }
            "textDocument/didChange" => {
                let Some(document) = self.documents.get_mut(address) else { return Ok(()) };
                for change in message.items_at(&["params", "contentChanges"]) {
                    let new = change.text_at(&["text"]).unwrap_or_default();
                    match change.at(&["range"]) {
                        None => document.text = new.to_owned(),
                        Some(place) => {
                            let lines = Lines::of(&document.text);
                            let of = |key| place.at(&[key]).map_or(0, |p| lines.offset_of(&p));
                            let (start, end) = (of("start"), of("end"));
                            document.text.replace_range(start..end.max(start), new);
                        }
                    }
                }
                document.version = version;
                document.touch();
                let path = document.path.clone();
                self.opened();
                self.touch_dependents(&path, address);
            }
            // A file on disk may be one of a library of any text.
            "textDocument/didSave" => self.saved(address),
            "workspace/didChangeWatchedFiles" => {
                for change in message.items_at(&["params", "changes"]) {
                    self.saved(change.text_at(&["uri"]).unwrap_or_default());
                }
            }
            "textDocument/didClose" => {
                let closed = self.documents.remove(address);
                self.opened();
                // Changes that were not saved are gone.
                if let Some(closed) = closed {
                    self.touch_dependents(&closed.path, address);
                }
                self.publish(address, Json::list([]), None)?;
            }
            "$/cancelRequest" => {
                let Some(id) = message.at(&["params", "id"]) else { return Ok(()) };
                if let Some(is_cancelled) = self.waiting.remove(&id.compact()) {
                    is_cancelled.store(true, Ordering::Relaxed);
                    write(&mut self.out, &refusal(id, CANCELLED, "the request was withdrawn"))?;
                }
            }
            _ => {}
        }
        Ok(())
    }

    /// Makes the texts of the client known to answers and checks.
    fn opened(&mut self) {
        let all = self.documents.iter().filter(|(address, _)| path_of(address).is_some());
        let texts = all.clone().map(|(_, d)| (d.path.clone(), Arc::from(d.text.as_str())));
        self.workspace.open = OpenTexts::new(texts.collect());
        let addresses = all.map(|(address, d)| (d.path.clone(), address.clone()));
        self.workspace.addresses = Arc::new(addresses.collect());
    }

    /// The texts that depend on a file are checked again. Texts with errors may wait for any file.
    fn touch_dependents(&mut self, path: &Path, address: &str) {
        for (other, document) in &mut self.documents {
            let has_errors = || {
                let mut all = document.placed.iter();
                all.any(|placed| placed.diagnostic.severity == Severity::Error)
            };
            if other != address && (document.reads.contains(path) || has_errors()) {
                document.touch();
            }
        }
    }

    /// A file has another content on disk.
    fn saved(&mut self, address: &str) {
        let Some(path) = path_of(address).map(|path| canonical(&path)) else { return };
        if path.file_name().is_some_and(|name| name == NAME) {
            self.documents.values_mut().for_each(Document::touch);
            return;
        }
        // Texts of the client go before those on disk, and their changes are known; but plans are checked with the files.
        let is_open = self.documents.values().any(|document| document.path == path);
        for document in self.documents.values_mut() {
            let depends = document.reads.contains(&path) && document.path != path;
            if depends && (!is_open || is_toml(&document.path)) {
                document.touch();
            }
        }
        if !is_open {
            self.touch_dependents(&path, "");
        }
    }

    /// Checks a text that has changed, while no other is checked.
    fn check_next(&mut self) {
        if self.is_checking {
            return;
        }
        let Some((address, document)) = self.documents.iter().find(|(_, d)| d.changed) else {
            return;
        };
        let (address, edition) = (address.clone(), document.edition);
        let (path, text) = (document.path.clone(), document.text.clone());
        let workspace = self.workspace.clone();
        self.is_checking = true;
        let event = move |checked| Event::Checked { address, edition, checked };
        self.checks.run(move || checked(&workspace, &path, text), event, &self.events);
    }

    /// Publishes diagnostics, unless the text has changed since.
    fn checked(&mut self, address: &str, edition: u64, checked: Option<Checked>) -> io::Result<()> {
        let found = self.documents.get_mut(address).filter(|d| d.edition == edition);
        let Some(document) = found else { return Ok(()) };
        document.changed = false;
        let Some(checked) = checked else { return Ok(()) };
        (document.placed, document.reads) = (checked.placed, checked.reads);
        let version = document.version.clone();
        self.publish(address, checked.diagnostics, version)
    }

    fn publish(
        &mut self,
        address: &str,
        diagnostics: Json,
        version: Option<Json>,
    ) -> io::Result<()> {
        let mut parameters = vec![("uri", Json::text(address)), ("diagnostics", diagnostics)];
        parameters.extend(version.map(|version| ("version", version)));
        let parameters = Json::object(parameters);
        write(&mut self.out, &notification("textDocument/publishDiagnostics", parameters))
    }

    /// The answer to a request; none if it comes later.
    fn request(&mut self, id: &Json, method: &str, message: &Json) -> Option<Answer> {
        if self.shut_down {
            return Some(Err((INVALID_REQUEST, "the server is shutting down".to_owned())));
        }
        match method {
            "initialize" if self.initialized => {
                return Some(Err((INVALID_REQUEST, "the server is initialized".to_owned())));
            }
            "initialize" => {
                self.initialize(message);
                return Some(Ok(capabilities()));
            }
            _ if !self.initialized => {
                return Some(Err((NOT_INITIALIZED, "the server is not initialized".to_owned())));
            }
            "shutdown" => {
                self.shut_down = true;
                return Some(Ok(Json::null()));
            }
            _ if !KNOWN.contains(&method) => {
                return Some(Err((METHOD_NOT_FOUND, format!("no method `{method}`"))));
            }
            _ => {}
        }
        if let Some(why) = lacking(method, message) {
            return Some(Err((INVALID_PARAMETERS, format!("`{method}` needs {why}"))));
        }
        let address = message.text_at(&["params", "textDocument", "uri"]).unwrap_or_default();
        let document = self.documents.get(address);
        if document.is_none() && method != SYMBOL {
            return Some(Ok(Json::null()));
        }
        if method == "textDocument/codeAction" {
            return document.map(|document| Ok(repairs(document, address, message)));
        }
        let (path, text) = document.map(|d| (d.path.clone(), d.text.clone())).unwrap_or_default();
        let is_cancelled = Arc::new(AtomicBool::new(false));
        self.waiting.insert(id.compact(), Arc::clone(&is_cancelled));
        let (workspace, method, message) =
            (self.workspace.clone(), method.to_owned(), message.clone());
        let by = move || {
            if is_cancelled.load(Ordering::Relaxed) {
                return Ok(Json::null());
            }
            let asked = Asked { workspace, path, text, method, message, is_cancelled };
            asked.answer().map_err(|why| (REQUEST_FAILED, why))
        };
        let id = id.clone();
        let event = move |answer: Option<Answer>| {
            let bug = || Err((INTERNAL_ERROR, "this is a bug in mocc".to_owned()));
            Event::Answered { id, answer: answer.unwrap_or_else(bug) }
        };
        self.answers.run(by, event, &self.events);
        None
    }

    fn initialize(&mut self, message: &Json) {
        self.initialized = true;
        let folders = message.items_at(&["params", "workspaceFolders"]);
        let root = message.text_at(&["params", "rootUri"]);
        let root = root.filter(|_| folders.is_empty());
        let addresses = folders.iter().filter_map(|folder| folder.text_at(&["uri"])).chain(root);
        let folders = addresses.filter_map(path_of).map(|path| canonical(&path)).collect();
        self.workspace.folders = Arc::new(folders);
        let edits = ["params", "capabilities", "workspace", "workspaceEdit"];
        let at = |key: &'static str| [&edits[..], &[key]].concat();
        let kinds = message.items_at(&at("resourceOperations"));
        let is_rename = |kind: &Json| *kind == Json::text("rename");
        let has_steps = message.at(&at("documentChanges")) == Some(Json::flag(true));
        self.workspace.renames_files = has_steps && kinds.iter().any(is_rename);
    }
}

/// The diagnostics of a text.
fn checked(workspace: &Workspace, path: &Path, text: String) -> Checked {
    let (placed, session) = match is_toml(path) {
        false => check(&workspace.request(path, text.clone())),
        true if !is_plan(path, &text) => Default::default(),
        true => check_plan(&Plan {
            path,
            text: Some(text.clone()),
            modelica_path: workspace.modelica_path.clone(),
        }),
    };
    let diagnostics = json(&placed, path, &text, &session, workspace);
    let reads = files_of(&session).iter().map(|file| canonical(file)).collect();
    Checked { placed, diagnostics, reads }
}

/// The repairs of the diagnostics in the range of a request.
fn repairs(document: &Document, address: &str, message: &Json) -> Json {
    let lines = Lines::of(&document.text);
    let place = |end| message.at(&["params", "range", end]).map_or(0, |p| lines.offset_of(&p));
    // Those of an older text are elsewhere now.
    let placed = if document.changed { &[][..] } else { &document.placed };
    repairs::actions(placed, &document.text, address, (place("start"), place("end")))
}
