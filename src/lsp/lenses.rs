//! Inlay hints, and lenses over models: commands that the client runs.

use crate::driver::compile::{Request, Session};
use crate::driver::hints::runnable;
use crate::io::json::Json;

use super::position::Lines;

/// The lenses: title, and the command that the client runs with the file and the name of the model.
const LENSES: [(&str, &str); 3] =
    [("Simulate", "mocc.simulate"), ("Report", "mocc.report"), ("Check", "mocc.check")];

/// The lenses of a text.
pub fn lenses(request: &Request) -> Json {
    let text = request.text.as_deref().unwrap_or_default();
    let file = request.file.as_deref().map(|f| f.display().to_string()).unwrap_or_default();
    let (lines, mut out) = (Lines::of(text), Vec::new());
    for model in runnable(text) {
        for (title, command) in LENSES {
            let arguments = [Json::text(file.as_str()), Json::text(model.name.as_str())];
            let command = Json::object([
                ("title", Json::text(title)),
                ("command", Json::text(command)),
                ("arguments", Json::list(arguments)),
            ]);
            out.push(Json::object([("range", lines.place(model.place)), ("command", command)]));
        }
    }
    Json::list(out)
}

/// The hints in a part of a text, by bytes.
pub fn hints(request: &Request, (from, to): (usize, usize)) -> Json {
    let text = request.text.as_deref().unwrap_or_default();
    let lines = Lines::of(text);
    let hints = Session::hints(request, (from as u32, to as u32));
    Json::list(hints.into_iter().map(|hint| {
        Json::object([
            ("position", lines.position(hint.at as usize)),
            ("label", Json::text(hint.text)),
            ("paddingLeft", Json::flag(true)),
        ])
    }))
}
