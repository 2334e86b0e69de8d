//! The protocol's side of requests: error codes, methods with the parameters that they need, and what the server offers.

use super::colours;
use super::message::{answer, refusal};
use crate::io::json::Json;

/// A message is not JSON.
pub const PARSE_ERROR: f64 = -32700.0;
/// A message is not a request, or comes at the wrong time.
pub const INVALID_REQUEST: f64 = -32600.0;
/// There is no such method.
pub const METHOD_NOT_FOUND: f64 = -32601.0;
/// A request lacks a parameter.
pub const INVALID_PARAMETERS: f64 = -32602.0;
/// The server has a bug.
pub const INTERNAL_ERROR: f64 = -32603.0;
/// The client has not introduced itself.
pub const NOT_INITIALIZED: f64 = -32002.0;
/// The request cannot be met.
pub const REQUEST_FAILED: f64 = -32803.0;
/// The client has withdrawn the request.
pub const CANCELLED: f64 = -32800.0;

/// Requests that are answered later; all but one are about a text.
pub const KNOWN: [&str; 16] = [
    "textDocument/codeAction",
    "textDocument/codeLens",
    "textDocument/completion",
    "textDocument/definition",
    "textDocument/documentHighlight",
    "textDocument/documentSymbol",
    "textDocument/foldingRange",
    "textDocument/formatting",
    "textDocument/hover",
    "textDocument/inlayHint",
    "textDocument/prepareRename",
    "textDocument/references",
    "textDocument/rename",
    "textDocument/semanticTokens/full",
    "textDocument/signatureHelp",
    SYMBOL,
];
/// The request that is about no text.
pub const SYMBOL: &str = "workspace/symbol";

/// The result of a request, or a code and the reason why there is none.
pub type Answer = Result<Json, (f64, String)>;

/// The message with an answer.
pub fn message_of(id: Json, result: Answer) -> Json {
    match result {
        Ok(result) => answer(id, result),
        Err((code, why)) => refusal(id, code, &why),
    }
}

/// The parameter that a request lacks.
pub fn lacking(method: &str, message: &Json) -> Option<&'static str> {
    let lacks = |keys: &[&str]| message.at(&[&["params"], keys].concat()).is_none();
    let has_place = [
        "completion",
        "definition",
        "documentHighlight",
        "hover",
        "prepareRename",
        "references",
        "rename",
        "signatureHelp",
    ];
    let is_at_place = method.rsplit('/').next().is_some_and(|name| has_place.contains(&name));
    if method == SYMBOL {
        return lacks(&["query"]).then_some("`query`");
    }
    if lacks(&["textDocument", "uri"]) {
        return Some("`textDocument.uri`");
    }
    if is_at_place && (lacks(&["position", "line"]) || lacks(&["position", "character"])) {
        return Some("`position` with `line` and `character`");
    }
    let needs_range = matches!(method, "textDocument/inlayHint" | "textDocument/codeAction");
    if needs_range && (lacks(&["range", "start"]) || lacks(&["range", "end"])) {
        return Some("`range`");
    }
    (method == "textDocument/rename" && lacks(&["newName"])).then_some("`newName`")
}

/// What the server offers, and its name.
pub fn capabilities() -> Json {
    let yes = || Json::flag(true);
    let legend = Json::object([
        ("tokenTypes", Json::list(colours::LEGEND.iter().map(|name| Json::text(*name)))),
        ("tokenModifiers", Json::list([])),
    ]);
    let triggers = |all: &[&str]| Json::list(all.iter().map(|text| Json::text(*text)));
    let sync = Json::object([
        ("openClose", yes()),
        // Incremental.
        ("change", Json::count(2)),
        ("save", yes()),
    ]);
    let capabilities = Json::object([
        ("positionEncoding", Json::text("utf-16")),
        ("textDocumentSync", sync),
        ("hoverProvider", yes()),
        ("definitionProvider", yes()),
        ("referencesProvider", yes()),
        ("documentHighlightProvider", yes()),
        ("renameProvider", Json::object([("prepareProvider", yes())])),
        ("workspaceSymbolProvider", yes()),
        ("signatureHelpProvider", Json::object([("triggerCharacters", triggers(&["(", ","]))])),
        ("codeLensProvider", Json::object([("resolveProvider", Json::flag(false))])),
        ("inlayHintProvider", yes()),
        ("documentFormattingProvider", yes()),
        ("documentSymbolProvider", yes()),
        ("foldingRangeProvider", yes()),
        (
            "codeActionProvider",
            Json::object([("codeActionKinds", Json::list([Json::text("quickfix")]))]),
        ),
        ("completionProvider", Json::object([("triggerCharacters", triggers(&[".", "("]))])),
        ("semanticTokensProvider", Json::object([("legend", legend), ("full", yes())])),
    ]);
    let info = Json::object([
        ("name", Json::text("mocc")),
        ("version", Json::text(env!("CARGO_PKG_VERSION"))),
    ]);
    Json::object([("capabilities", capabilities), ("serverInfo", info)])
}
