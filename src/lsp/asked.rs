//! A request about a text, with copies of all that its answer needs.

use std::path::{Path, PathBuf};
use std::sync::Arc;
use std::sync::atomic::AtomicBool;

use super::answers;
use super::colours;
use super::lenses;
use super::outline;
use super::plan_keys;
use super::plans::is_plan;
use super::position::Lines;
use super::protocol::SYMBOL;
use super::rename;
use super::symbols;
use super::workspace::Workspace;
use crate::base::source::SourceMap;
use crate::driver::compile::Request;
use crate::format::format;
use crate::io::json::Json;

/// A request about a text.
pub struct Asked {
    /// The files of the client.
    pub workspace: Workspace,
    /// The file.
    pub path: PathBuf,
    /// Its text.
    pub text: String,
    /// The method.
    pub method: String,
    /// The message.
    pub message: Json,
    /// The client has withdrawn it.
    pub is_cancelled: Arc<AtomicBool>,
}

impl Asked {
    /// The answer. The error says why there is none.
    pub fn answer(&self) -> Result<Json, String> {
        let (text, message) = (self.text.as_str(), &self.message);
        let lines = Lines::of(text);
        let place = |keys: &[&str]| message.at(keys).map_or(0, |p| lines.offset_of(&p));
        let offset = place(&["params", "position"]);
        if is_toml(&self.path) {
            let is_own = is_plan(&self.path, text) || text.trim().is_empty();
            return Ok(match self.method.as_str() {
                "textDocument/completion" if is_own => {
                    plan_keys::completion(&self.path.to_string_lossy(), text, offset)
                }
                _ => Json::null(),
            });
        }
        let or_null = |answer: Option<Json>| Ok(answer.unwrap_or_else(Json::null));
        match self.method.as_str() {
            "textDocument/formatting" => return Ok(formatted(text)),
            "textDocument/documentSymbol" => return Ok(outline::symbols(text)),
            "textDocument/foldingRange" => return Ok(outline::folds(text)),
            "textDocument/semanticTokens/full" => return Ok(colours::tokens(text)),
            SYMBOL => {
                let query = message.text_at(&["params", "query"]).unwrap_or_default();
                return Ok(symbols::classes(&self.workspace, query, &self.is_cancelled));
            }
            _ => {}
        }
        let workspace = &self.workspace;
        let request: Request = workspace.request(&self.path, self.text.clone());
        match self.method.as_str() {
            "textDocument/hover" => or_null(answers::hover(&request, offset)),
            "textDocument/definition" => or_null(answers::definition(workspace, &request, offset)),
            "textDocument/documentHighlight" => or_null(answers::highlights(&request, offset)),
            "textDocument/signatureHelp" => or_null(symbols::signature(&request, offset)),
            "textDocument/prepareRename" => rename::prepare(&request, offset),
            "textDocument/references" => {
                let is_declared = message.at(&["params", "context", "includeDeclaration"]);
                let is_declared = is_declared != Some(Json::flag(false));
                let cancelled = &self.is_cancelled;
                let found =
                    answers::references(workspace, &request, offset, is_declared, cancelled);
                or_null(found)
            }
            "textDocument/completion" => Ok(answers::completion(&request, offset)),
            "textDocument/rename" => {
                let new = message.text_at(&["params", "newName"]).unwrap_or_default();
                rename::rename(workspace, &request, offset, new, &self.is_cancelled)
            }
            "textDocument/codeLens" => Ok(lenses::lenses(&request)),
            "textDocument/inlayHint" => {
                let part =
                    (place(&["params", "range", "start"]), place(&["params", "range", "end"]));
                Ok(lenses::hints(&request, part))
            }
            _ => Ok(Json::null()),
        }
    }
}

/// A plan, a test or the settings of a project.
pub fn is_toml(file: &Path) -> bool {
    file.extension().is_some_and(|e| e == "toml")
}

/// The edit that formats a text; none if it has syntax errors.
fn formatted(text: &str) -> Json {
    let id = SourceMap::default().add("text.mo", text);
    match format(id, text) {
        Ok(new) if new != text => Json::list([Json::object([
            ("range", Lines::of(text).range(0, text.len())),
            ("newText", Json::text(new)),
        ])]),
        _ => Json::list([]),
    }
}
