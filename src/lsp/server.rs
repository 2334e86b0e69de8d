//! The server: keeps the texts of the client, answers its requests, and reports diagnostics when it pauses.

use std::collections::BTreeMap;
use std::ffi::OsString;
use std::io::{self, BufRead, Write};
use std::path::PathBuf;
use std::sync::mpsc::{Receiver, TryRecvError, channel};

use super::answers;
use super::colours;
use super::diagnostics::{Placed, check, check_plan, json};
use super::lenses;
use super::message::{answer, notification, read, refusal, write};
use super::outline;
use super::plan_keys;
use super::plans::Plan;
use super::position::{offset_of, path_of, range};
use super::repairs;
use crate::base::diag::Problems;
use crate::base::source::SourceMap;
use crate::driver::compile::Request;
use crate::driver::project;
use crate::format::format;
use crate::io::json::Json;

/// Errors of the protocol.
const METHOD_NOT_FOUND: f64 = -32601.0;
const REQUEST_FAILED: f64 = -32803.0;

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
    /// Changed since its diagnostics were reported.
    changed: bool,
    placed: Vec<Placed>,
}

struct Server<W> {
    out: W,
    documents: BTreeMap<String, Document>,
    modelica_path: Option<OsString>,
    shut_down: bool,
}

/// Serves a client until it ends the connection. `modelica_path` is the value of `MODELICAPATH`.
pub fn serve(
    mut input: impl BufRead + Send + 'static,
    out: impl Write,
    modelica_path: Option<OsString>,
) -> io::Result<Ended> {
    let (sender, messages) = channel();
    // Reading on a thread of its own shows whether more changes wait, so only the last is checked.
    std::thread::Builder::new().name("read".into()).spawn(move || {
        loop {
            let message = read(&mut input);
            let is_last = !matches!(message, Ok(Some(_)));
            if sender.send(message).is_err() || is_last {
                break;
            }
        }
    })?;
    let documents = BTreeMap::new();
    let mut server = Server { out, documents, modelica_path, shut_down: false };
    server.run(&messages)
}

impl<W: Write> Server<W> {
    fn run(&mut self, messages: &Receiver<io::Result<Option<Json>>>) -> io::Result<Ended> {
        let ended = |server: &Self| if server.shut_down { Ended::Orderly } else { Ended::Abruptly };
        loop {
            let message = match messages.try_recv() {
                Ok(message) => message,
                Err(TryRecvError::Empty) => {
                    self.report()?;
                    match messages.recv() {
                        Ok(message) => message,
                        Err(_) => return Ok(ended(self)),
                    }
                }
                Err(TryRecvError::Disconnected) => return Ok(ended(self)),
            };
            let Some(message) = message? else { return Ok(ended(self)) };
            let method = message.text_at(&["method"]).unwrap_or_default().to_owned();
            if method == "exit" {
                return Ok(ended(self));
            }
            match message.at(&["id"]) {
                Some(id) if !method.is_empty() => {
                    let reply = match self.request(&method, &message) {
                        Ok(Some(result)) => answer(id, result),
                        Ok(None) => refusal(id, METHOD_NOT_FOUND, &format!("no method `{method}`")),
                        Err(why) => refusal(id, REQUEST_FAILED, &why),
                    };
                    write(&mut self.out, &reply)?;
                }
                _ => self.notified(&method, &message)?,
            }
        }
    }

    /// Changes of texts.
    fn notified(&mut self, method: &str, message: &Json) -> io::Result<()> {
        let address = message.text_at(&["params", "textDocument", "uri"]).unwrap_or_default();
        match method {
            "textDocument/didOpen" => {
                let text = message.text_at(&["params", "textDocument", "text"]).unwrap_or_default();
                let document =
                    Document { text: text.to_owned(), changed: true, placed: Vec::new() };
                self.documents.insert(address.to_owned(), document);
            }
            "textDocument/didChange" => {
                let Some(document) = self.documents.get_mut(address) else { return Ok(()) };
                for change in message.items_at(&["params", "contentChanges"]) {
                    let new = change.text_at(&["text"]).unwrap_or_default();
                    match change.at(&["range"]) {
                        None => document.text = new.to_owned(),
                        Some(place) => {
                            let of =
                                |key| place.at(&[key]).map_or(0, |p| offset_of(&document.text, &p));
                            let (start, end) = (of("start"), of("end"));
                            document.text.replace_range(start..end.max(start), new);
                        }
                    }
                }
                document.changed = true;
            }
            // A file on disk may be one of a library of any text.
            "textDocument/didSave" | "workspace/didChangeWatchedFiles" => {
                self.documents.values_mut().for_each(|document| document.changed = true);
            }
            "textDocument/didClose" => {
                self.documents.remove(address);
                self.publish(address, Json::list([]))?;
            }
            _ => {}
        }
        Ok(())
    }

    /// Reports the diagnostics of the texts that have changed.
    fn report(&mut self) -> io::Result<()> {
        let changed: Vec<String> =
            self.documents.iter().filter(|(_, d)| d.changed).map(|(a, _)| a.clone()).collect();
        for address in changed {
            let Some(request) = self.compiled(&address) else { continue };
            let toml = request.file.as_deref().filter(|f| is_toml(&f.to_string_lossy()));
            let (placed, session) = match toml {
                None => check(&request),
                Some(path) => check_plan(&Plan {
                    path,
                    text: request.text.clone(),
                    modelica_path: self.modelica_path.clone(),
                }),
            };
            let text = request.text.as_deref().unwrap_or_default();
            let all = json(&placed, text, &session);
            if let Some(document) = self.documents.get_mut(&address) {
                (document.changed, document.placed) = (false, placed);
            }
            self.publish(&address, all)?;
        }
        Ok(())
    }

    fn publish(&mut self, address: &str, diagnostics: Json) -> io::Result<()> {
        let parameters = Json::object([("uri", Json::text(address)), ("diagnostics", diagnostics)]);
        write(&mut self.out, &notification("textDocument/publishDiagnostics", parameters))
    }

    /// The request that compiles a text.
    fn compiled(&self, address: &str) -> Option<Request> {
        let text = self.documents.get(address)?.text.clone();
        let file = path_of(address).unwrap_or_else(|| "untitled.mo".into());
        let (mut sources, mut problems) = (SourceMap::default(), Problems::new());
        let project = project::of(Some(&file), &mut sources, &mut problems);
        Some(Request {
            text: Some(text),
            folders: project.libraries.into_iter().filter(|folder| folder.is_dir()).collect(),
            readable: project.allow_read,
            modelica_path: self.modelica_path.clone(),
            ..Request::new(Some(file), None)
        })
    }

    /// The texts of the client by their files.
    fn open(&self) -> BTreeMap<PathBuf, String> {
        let all = self.documents.iter();
        all.filter_map(|(address, d)| Some((path_of(address)?, d.text.clone()))).collect()
    }

    /// The answer to a request; none if there is no such method. The error says why it failed.
    fn request(&mut self, method: &str, message: &Json) -> Result<Option<Json>, String> {
        match method {
            "initialize" => return Ok(Some(capabilities())),
            "shutdown" => {
                self.shut_down = true;
                return Ok(Some(Json::null()));
            }
            _ => {}
        }
        let address = message.text_at(&["params", "textDocument", "uri"]).unwrap_or_default();
        let Some(compiled) = self.compiled(address) else { return Ok(Some(Json::null())) };
        let text = compiled.text.as_deref().unwrap_or_default();
        let place = |keys: &[&str]| message.at(keys).map_or(0, |p| offset_of(text, &p));
        let offset = place(&["params", "position"]);
        let file = compiled.file.as_ref().map(|f| f.to_string_lossy()).unwrap_or_default();
        if is_toml(&file) {
            return Ok(match method {
                "textDocument/completion" => Some(plan_keys::completion(&file, text, offset)),
                "textDocument/codeAction" => Some(self.repairs(address, message, text)),
                _ => Some(Json::null()),
            });
        }
        let or_null = |answer: Option<Json>| Ok(Some(answer.unwrap_or_else(Json::null)));
        match method {
            "textDocument/hover" => or_null(answers::hover(&compiled, offset)),
            "textDocument/definition" => or_null(answers::definition(&compiled, offset)),
            "textDocument/references" => {
                or_null(answers::references(&compiled, offset, &self.open()))
            }
            "textDocument/completion" => Ok(Some(answers::completion(&compiled, offset))),
            "textDocument/rename" => {
                let new = message.text_at(&["params", "newName"]).unwrap_or_default();
                answers::rename(&compiled, offset, new, &self.open()).map(Some)
            }
            "textDocument/codeLens" => Ok(Some(lenses::lenses(&compiled))),
            "textDocument/inlayHint" => {
                let part =
                    (place(&["params", "range", "start"]), place(&["params", "range", "end"]));
                Ok(Some(lenses::hints(&compiled, part)))
            }
            "textDocument/formatting" => Ok(Some(formatted(text))),
            "textDocument/documentSymbol" => Ok(Some(outline::symbols(text))),
            "textDocument/foldingRange" => Ok(Some(outline::folds(text))),
            "textDocument/semanticTokens/full" => Ok(Some(colours::tokens(text))),
            "textDocument/codeAction" => Ok(Some(self.repairs(address, message, text))),
            _ => Ok(None),
        }
    }
}

impl<W: Write> Server<W> {
    /// The repairs of the diagnostics in the range of a request.
    fn repairs(&self, address: &str, message: &Json, text: &str) -> Json {
        let place = |end| message.at(&["params", "range", end]).map_or(0, |p| offset_of(text, &p));
        let placed = self.documents.get(address).map_or(&[][..], |d| &d.placed);
        repairs::actions(placed, text, address, (place("start"), place("end")))
    }
}

/// A plan, a test or the settings of a project.
fn is_toml(file: &str) -> bool {
    file.ends_with(".toml")
}

/// The edit that formats a text; none if it has syntax errors.
fn formatted(text: &str) -> Json {
    let id = SourceMap::default().add("text.mo", text);
    match format(id, text) {
        Ok(new) if new != text => Json::list([Json::object([
            ("range", range(text, 0, text.len())),
            ("newText", Json::text(new)),
        ])]),
        _ => Json::list([]),
    }
}

fn capabilities() -> Json {
    let yes = || Json::flag(true);
    let legend = Json::object([
        ("tokenTypes", Json::list(colours::LEGEND.iter().map(|name| Json::text(*name)))),
        ("tokenModifiers", Json::list([])),
    ]);
    let triggers = [".", "("].map(Json::text);
    let sync = Json::object([
        ("openClose", yes()),
        // Incremental.
        ("change", Json::count(2)),
        ("save", yes()),
    ]);
    let capabilities = Json::object([
        ("textDocumentSync", sync),
        ("hoverProvider", yes()),
        ("definitionProvider", yes()),
        ("referencesProvider", yes()),
        ("renameProvider", yes()),
        ("codeLensProvider", Json::object([("resolveProvider", Json::flag(false))])),
        ("inlayHintProvider", yes()),
        ("documentFormattingProvider", yes()),
        ("documentSymbolProvider", yes()),
        ("foldingRangeProvider", yes()),
        (
            "codeActionProvider",
            Json::object([("codeActionKinds", Json::list([Json::text("quickfix")]))]),
        ),
        ("completionProvider", Json::object([("triggerCharacters", Json::list(triggers))])),
        ("semanticTokensProvider", Json::object([("legend", legend), ("full", yes())])),
    ]);
    let info = Json::object([
        ("name", Json::text("mocc")),
        ("version", Json::text(env!("CARGO_PKG_VERSION"))),
    ]);
    Json::object([("capabilities", capabilities), ("serverInfo", info)])
}
