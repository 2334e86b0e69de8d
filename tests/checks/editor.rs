//! `mocc lsp`, with a client that speaks the protocol over pipes.

use std::io::{BufRead, BufReader, Read, Write};
use std::path::{Path, PathBuf};
use std::process::{Child, ChildStdin, ChildStdout, Command, Stdio};

use serde_json::{Value, json};

use super::door::Scratch;

const MODEL: &str = "model Push \"A force pushes a mass\"
  parameter Units.Force F = 25 \"Force of the magnet\";
  Translational.Force magnet(f = F);
  Translational.StopMass spool(m = 0.03, s_max = 3e-3);
equation
  connect(magnet.flange, spool.flange);
end Push;
";

/// An editor with one open file.
struct Editor {
    child: Child,
    input: Option<ChildStdin>,
    output: BufReader<ChildStdout>,
    address: String,
    text: String,
    next: u64,
    diagnostics: Vec<Value>,
    folder: Scratch,
}

impl Editor {
    fn open(text: &str) -> Editor {
        Editor::start(text, &json!({}))
    }

    /// The server runs in the folder of the file, as editors start it.
    fn start(text: &str, capabilities: &Value) -> Editor {
        let folder = Scratch::new();
        let path: PathBuf = folder.file("push.mo", text);
        let path = path.canonicalize().expect("the file");
        let mut child = Command::new(env!("CARGO_BIN_EXE_mocc"))
            .arg("lsp")
            .env_remove("MODELICAPATH")
            .current_dir(path.parent().expect("its folder"))
            .stdin(Stdio::piped())
            .stdout(Stdio::piped())
            .spawn()
            .expect("mocc starts");
        let input = child.stdin.take();
        let output = BufReader::new(child.stdout.take().expect("a pipe"));
        let address = format!("file://{}", path.display());
        let mut editor = Editor {
            child,
            input,
            output,
            address,
            text: text.to_owned(),
            next: 0,
            diagnostics: Vec::new(),
            folder,
        };
        let ready = editor.ask("initialize", json!({ "capabilities": capabilities }));
        assert_eq!(ready["serverInfo"]["name"], "mocc");
        assert_eq!(ready["capabilities"]["textDocumentSync"]["change"], 2);
        editor.tell("initialized", json!({}));
        let document =
            json!({ "uri": editor.address, "languageId": "modelica", "version": 1, "text": text });
        editor.tell("textDocument/didOpen", json!({ "textDocument": document }));
        editor.wait();
        editor
    }

    /// The folder of the first file.
    fn folder(&self) -> PathBuf {
        self.folder.path().canonicalize().expect("the folder")
    }

    /// Writes a file next to the first one.
    fn write(&self, name: &str, text: &str) -> PathBuf {
        let path = self.folder().join(name);
        std::fs::create_dir_all(path.parent().expect("its folder")).expect("a writable folder");
        std::fs::write(&path, text).expect("a writable folder");
        path
    }

    /// Opens another text, which the following requests are about, and waits for its diagnostics.
    fn turn_to(&mut self, path: &Path, text: &str) {
        (self.address, self.text) = (format!("file://{}", path.display()), text.to_owned());
        let document =
            json!({ "uri": self.address, "languageId": "modelica", "version": 1, "text": text });
        self.tell("textDocument/didOpen", json!({ "textDocument": document }));
        self.wait_for(path);
    }

    /// Waits for the diagnostics of a text.
    fn wait_for(&mut self, path: &Path) {
        loop {
            let message = self.receive();
            self.keep(&message);
            if message["params"]["uri"]
                .as_str()
                .is_some_and(|uri| uri.ends_with(&*path.to_string_lossy()))
            {
                return;
            }
        }
    }

    /// The answer to the wish to rename the name `shift` bytes into a part of the text.
    fn rename(&mut self, part: &str, shift: usize, new: &str) -> Value {
        let position = self.place(self.text.find(part).expect(part) + shift);
        let document = json!({ "uri": self.address });
        let wanted = json!({ "textDocument": document, "position": position, "newName": new });
        self.reply("textDocument/rename", wanted)
    }

    /// The text after the edits of an answer.
    fn edited(&self, reply: &Value) -> String {
        let edits = reply["result"]["changes"][self.address.as_str()].as_array();
        let mut edits = edits.unwrap_or_else(|| panic!("no edits: {reply}")).clone();
        let at = |place: &Value| {
            let line = place["line"].as_u64().expect("a line") as usize;
            let start: usize = self.text.split_inclusive('\n').take(line).map(str::len).sum();
            start + place["character"].as_u64().expect("a character") as usize
        };
        edits.sort_by_key(|edit| at(&edit["range"]["start"]));
        let mut text = self.text.clone();
        for edit in edits.iter().rev() {
            let range = at(&edit["range"]["start"])..at(&edit["range"]["end"]);
            text.replace_range(range, edit["newText"].as_str().expect("a text"));
        }
        text
    }

    fn send(&mut self, message: &Value) {
        let text = message.to_string();
        let input = self.input.as_mut().expect("open");
        write!(input, "Content-Length: {}\r\n\r\n{text}", text.len()).expect("it reads");
        input.flush().expect("it reads");
    }

    fn receive(&mut self) -> Value {
        let mut length = 0;
        loop {
            let mut line = String::new();
            assert!(
                self.output.read_line(&mut line).expect("a header") > 0,
                "the server has ended"
            );
            match line.trim().split_once(": ") {
                Some((_, n)) => length = n.parse().expect("a length"),
                None => break,
            }
        }
        let mut bytes = vec![0; length];
        self.output.read_exact(&mut bytes).expect("a message");
        serde_json::from_slice(&bytes).expect("JSON")
    }

    fn tell(&mut self, method: &str, parameters: Value) {
        self.send(&json!({ "jsonrpc": "2.0", "method": method, "params": parameters }));
    }

    /// The whole answer to a request; diagnostics that come before are kept.
    fn reply(&mut self, method: &str, parameters: Value) -> Value {
        self.next += 1;
        let id = self.next;
        self.send(&json!({ "jsonrpc": "2.0", "id": id, "method": method, "params": parameters }));
        loop {
            let message = self.receive();
            if message["id"] == id {
                return message;
            }
            self.keep(&message);
        }
    }

    fn ask(&mut self, method: &str, parameters: Value) -> Value {
        let reply = self.reply(method, parameters);
        assert!(reply.get("error").is_none(), "{method}: {reply}");
        reply["result"].clone()
    }

    fn keep(&mut self, message: &Value) {
        assert_eq!(message["method"], "textDocument/publishDiagnostics");
        self.diagnostics = message["params"]["diagnostics"].as_array().expect("a list").clone();
    }

    /// Waits for diagnostics.
    fn wait(&mut self) {
        let message = self.receive();
        self.keep(&message);
    }

    /// Replaces a part of the text, as typing does.
    fn edit(&mut self, old: &str, new: &str) {
        let at = self.text.find(old).expect(old);
        let range = json!({ "start": self.place(at), "end": self.place(at + old.len()) });
        self.text = self.text.replacen(old, new, 1);
        let document = json!({ "uri": self.address, "version": 2 });
        let changes = json!([{ "range": range, "text": new }]);
        self.tell(
            "textDocument/didChange",
            json!({ "textDocument": document, "contentChanges": changes }),
        );
        self.wait();
    }

    fn place(&self, at: usize) -> Value {
        let before = &self.text[..at];
        let line = before.matches('\n').count();
        json!({ "line": line, "character": before.len() - before.rfind('\n').map_or(0, |k| k + 1) })
    }

    /// Asks about the place `shift` bytes into a part of the text.
    fn at(&mut self, method: &str, part: &str, shift: usize) -> Value {
        let at = self.text.find(part).expect(part) + shift;
        let position = self.place(at);
        self.ask(method, json!({ "textDocument": { "uri": self.address }, "position": position }))
    }

    fn of_document(&mut self, method: &str) -> Value {
        self.ask(method, json!({ "textDocument": { "uri": self.address } }))
    }

    fn close(mut self) {
        self.ask("shutdown", Value::Null);
        self.tell("exit", Value::Null);
        self.input = None;
        assert!(self.child.wait().expect("it ends").success());
    }
}

impl Drop for Editor {
    fn drop(&mut self) {
        let _ = self.child.kill();
        let _ = self.child.wait();
    }
}

#[test]
fn diagnostics_follow_the_text_and_repair_it() {
    let mut editor = Editor::open(MODEL);
    assert_eq!(editor.diagnostics, Vec::<Value>::new());
    editor.edit("f = F", "f = G");
    let found = editor.diagnostics.clone();
    assert_eq!((found.len(), &found[0]["code"]), (1, &json!("MO0202")), "{found:?}");
    assert_eq!(found[0]["range"]["start"], json!({ "line": 2, "character": 33 }));
    editor.edit("magnet.flange", "magnt.flange");
    let wrong = editor.diagnostics.iter().find(|d| d["message"].to_string().contains("magnt"));
    let range = wrong.expect("a diagnostic")["range"].clone();
    let context = json!({ "diagnostics": [] });
    let address = editor.address.clone();
    let actions = editor.ask(
        "textDocument/codeAction",
        json!({ "textDocument": { "uri": address }, "range": range, "context": context }),
    );
    assert_eq!(actions[0]["title"], "Replace `magnt` by `magnet`", "{actions}");
    let edit = &actions[0]["edit"]["changes"][address.as_str()][0];
    assert_eq!(edit["newText"], "magnet");
    assert_eq!(edit["range"]["end"]["character"], 15, "{edit}");
    editor.edit("magnt.flange", "magnet.flange");
    editor.edit("f = G", "f = F");
    assert_eq!(editor.diagnostics, Vec::<Value>::new());
    let repaired = |editor: &mut Editor| {
        let range = editor.diagnostics[0]["range"].clone();
        let uri = json!({ "uri": editor.address });
        editor.ask("textDocument/codeAction", json!({ "textDocument": uri, "range": range }))
            [0]["title"]
            .clone()
    };
    editor.edit("end Push;", "end Pish;");
    assert_eq!(repaired(&mut editor), "Replace `Pish` by `Push`");
    editor.edit("end Pish;", "end Push;");
    editor.edit("flange);\n", "flange)\n");
    assert_eq!(repaired(&mut editor), "Insert `;`");
    editor.close();
}

#[test]
fn names_are_explained_found_and_renamed() {
    let mut editor = Editor::open(MODEL);
    let hover = editor.at("textDocument/hover", "= F)", 2);
    let text = hover["contents"]["value"].as_str().expect("Markdown").to_owned();
    for part in ["parameter Units.Force F = 25", "F = 25 N", "Force of the magnet"] {
        assert!(text.contains(part), "no `{part}` in {text}");
    }
    // A modifier is an element of the class of the component.
    let hover = editor.at("textDocument/hover", "s_max", 1);
    assert!(hover["contents"]["value"].to_string().contains("StopMass.mo"), "{hover}");
    let hover = editor.at("textDocument/hover", "spool.flange", 8);
    assert!(hover["contents"]["value"].to_string().contains("flange"), "{hover}");
    let place = editor.at("textDocument/definition", "spool.flange", 1);
    assert_eq!(
        (&place["uri"], &place["range"]["start"]["line"]),
        (&json!(editor.address), &json!(3))
    );
    let place = editor.at("textDocument/definition", "StopMass", 2);
    let path = place["uri"].as_str().expect("an address").strip_prefix("file://").expect("a file");
    assert!(
        std::fs::read_to_string(Path::new(path)).is_ok_and(|text| text.contains("model StopMass"))
    );
    let places = editor.at("textDocument/references", "magnet(f", 1);
    assert_eq!(places.as_array().map(Vec::len), Some(2), "{places}");
    let at = editor.text.find("magnet(f").expect("it");
    let rename = |new: &str, editor: &Editor| json!({ "textDocument": { "uri": editor.address }, "position": editor.place(at), "newName": new });
    let wanted = rename("coil", &editor);
    let edits = editor.ask("textDocument/rename", wanted);
    let edits = edits["changes"][editor.address.as_str()].clone();
    assert_eq!(edits.as_array().map(Vec::len), Some(2), "{edits}");
    let wanted = rename("7", &editor);
    let reply = editor.reply("textDocument/rename", wanted);
    assert_eq!(reply["error"]["message"], "`7` is not a name");
    for (new, said) in [("model", "`model` is a keyword"), ("spool", "already a `spool`")] {
        let wanted = rename(new, &editor);
        let reply = editor.reply("textDocument/rename", wanted);
        assert!(reply["error"]["message"].to_string().contains(said), "{reply}");
    }
    editor.close();
}

#[test]
fn completion_knows_members_modifiers_and_classes() {
    let mut editor = Editor::open(MODEL);
    let labels = |items: &Value| -> Vec<String> {
        let items = items.as_array().expect("a list").iter();
        items.map(|i| i["label"].as_str().expect("a label").to_owned()).collect()
    };
    let has = |items: &Value, name: &str| labels(items).iter().any(|label| label == name);
    let items = editor.at("textDocument/completion", "spool.flange", 6);
    assert!(
        has(&items, "flange") && has(&items, "s") && !has(&items, "model"),
        "{:?}",
        labels(&items)
    );
    let items = editor.at("textDocument/completion", "Translational.Force", 14);
    assert!(has(&items, "Spring") && has(&items, "StopMass"), "{:?}", labels(&items));
    let items = editor.at("textDocument/completion", "(m = 0.03", 1);
    let first = &items[0];
    assert_eq!(
        (&first["insertText"], has(&items, "s_max")),
        (&json!("m = "), true),
        "{:?}",
        labels(&items)
    );
    let items = editor.at("textDocument/completion", "connect(", 0);
    for name in ["spool", "F", "Translational", "connect"] {
        assert!(has(&items, name), "no {name} in {:?}", labels(&items));
    }
    // An unfinished name does not hide the rest.
    editor.edit("equation\n", "equation\n  spool.\n");
    let items = editor.at("textDocument/completion", "  spool.\n", 8);
    assert!(has(&items, "flange"), "{:?}", labels(&items));
    editor.close();
}

#[test]
fn completion_knows_elements_of_arrays_literals_and_attributes() {
    let text = "model M\n  type Mode = enumeration(slow, fast);\n  model Part\n    Real x = 1;\n    Mode m = Mode.slow;\n  end Part;\n  Part p[2, 2];\n  Real y(unit = \"m\") = p[1, 2].x;\nend M;\n";
    let mut editor = Editor::open(text);
    let labels = |items: Value| -> Vec<String> {
        let items = items.as_array().expect("a list").iter();
        items.map(|i| i["label"].as_str().expect("a label").to_owned()).collect()
    };
    assert_eq!(labels(editor.at("textDocument/completion", "p[1, 2].x", 8)), ["x", "m"]);
    assert_eq!(labels(editor.at("textDocument/completion", "Mode.slow", 5)), ["slow", "fast"]);
    let found = labels(editor.at("textDocument/completion", "(unit", 1));
    assert!(found.contains(&"displayUnit".to_owned()) && found[0] == "start", "{found:?}");
    editor.close();
}

/// A wrong plan has diagnostics, and a repair.
#[test]
fn plans_are_checked_while_they_are_written() {
    let mut editor = Editor::open(MODEL);
    let text = "model = \"push.mo\"\n[goal]\nminimise = \"x = final(spool.s)\"\n[free]\nF = { min = 1, max = 2 }\n";
    editor.address = editor.address.replace("push.mo", "plan.toml");
    editor.text = text.to_owned();
    let document =
        json!({ "uri": editor.address, "languageId": "toml", "version": 1, "text": text });
    editor.tell("textDocument/didOpen", json!({ "textDocument": document }));
    editor.wait();
    let codes: Vec<&Value> = editor.diagnostics.iter().map(|d| &d["code"]).collect();
    assert!(codes.contains(&&json!("MO1402")), "{codes:?}");
    editor.edit("minimise", "minimize");
    assert_eq!(editor.diagnostics, Vec::<Value>::new());
    editor.close();
}

#[test]
fn the_whole_text_is_formatted_outlined_folded_and_coloured() {
    let mut editor = Editor::open(&MODEL.replace("  connect(", "connect( "));
    let edits = editor.of_document("textDocument/formatting");
    assert_eq!(edits[0]["newText"], MODEL, "{edits}");
    let outline = editor.of_document("textDocument/documentSymbol");
    assert_eq!(
        (&outline[0]["name"], &outline[0]["detail"]),
        (&json!("Push"), &json!("A force pushes a mass"))
    );
    let names: Vec<&str> = outline[0]["children"]
        .as_array()
        .expect("children")
        .iter()
        .filter_map(|c| c["name"].as_str())
        .collect();
    assert_eq!(names, ["F", "magnet", "spool"]);
    let folds = editor.of_document("textDocument/foldingRange");
    assert_eq!((&folds[0]["startLine"], &folds[0]["endLine"]), (&json!(0), &json!(6)));
    let tokens = editor.of_document("textDocument/semanticTokens/full");
    let data: Vec<u64> =
        tokens["data"].as_array().expect("data").iter().filter_map(Value::as_u64).collect();
    // `model`, a keyword, and `Push`, a type.
    assert_eq!(data[..10], [0, 0, 5, 0, 0, 0, 6, 4, 1, 0]);
    assert_eq!(data.len() % 5, 0);
    let reply =
        editor.reply("textDocument/moniker", json!({ "textDocument": { "uri": editor.address } }));
    assert_eq!(reply["error"]["code"], -32601);
    editor.close();
}

#[test]
fn hints_show_units_and_values_after_modification() {
    let text = MODEL
        .replace("m = 0.03", "m = 2*m_0")
        .replace("equation", "  parameter Units.Mass m_0 = 0.015;\nequation");
    let mut editor = Editor::open(&text);
    let all =
        json!({ "start": { "line": 0, "character": 0 }, "end": { "line": 99, "character": 0 } });
    let wanted = json!({ "textDocument": { "uri": editor.address }, "range": all });
    let hints = editor.ask("textDocument/inlayHint", wanted);
    let all: Vec<(u64, String)> = hints
        .as_array()
        .expect("a list")
        .iter()
        .map(|h| {
            (
                h["position"]["line"].as_u64().expect("a line"),
                h["label"].as_str().expect("a text").to_owned(),
            )
        })
        .collect();
    let has = |line: u64, text: &str| all.contains(&(line, text.to_owned()));
    // F = 25 is in N; f = F is 25 N after the modification, m = 2*m_0 is 0.03 kg, s_max = 3e-3 is in m.
    assert!(has(1, "N") && has(3, "= 0.03 kg") && has(3, "m") && has(4, "kg"), "{all:?}");
    let lenses =
        editor.ask("textDocument/codeLens", json!({ "textDocument": { "uri": editor.address } }));
    let titles: Vec<&str> = lenses
        .as_array()
        .expect("a list")
        .iter()
        .filter_map(|l| l["command"]["title"].as_str())
        .collect();
    assert_eq!(titles, ["Simulate", "Report", "Check"]);
    assert_eq!(lenses[0]["command"]["arguments"][1], "Push");
    editor.close();
}

#[test]
fn names_are_changed_in_other_files_of_the_project() {
    let mut editor = Editor::open("model Base\n  parameter Real gain = 2;\nend Base;\n");
    let folder = PathBuf::from(editor.address.trim_start_matches("file://"));
    let folder = folder.parent().expect("its folder").to_owned();
    let other = "model User\n  Base b(gain = 3) \"gain\";\n  Real y = b.gain;\nend User;\n";
    std::fs::write(folder.join("mocc.toml"), "libraries = [\".\"]\n").expect("a writable folder");
    std::fs::write(folder.join("Base.mo"), "model Base\n  parameter Real gain = 2;\nend Base;\n")
        .expect("a file");
    std::fs::write(folder.join("User.mo"), other).expect("a file");
    // The class of a file is found by its name in a folder of libraries.
    let address = format!("file://{}", folder.join("Base.mo").display());
    let text = std::fs::read_to_string(folder.join("Base.mo")).expect("the file");
    let document = json!({ "uri": address, "languageId": "modelica", "version": 1, "text": text });
    editor.tell("textDocument/didOpen", json!({ "textDocument": document }));
    let place = json!({ "line": 1, "character": 17 });
    let wanted = json!({ "textDocument": { "uri": address }, "position": place, "context": { "includeDeclaration": true } });
    let places = editor.ask("textDocument/references", wanted);
    let of = |name: &str, places: &Value| {
        let all = places.as_array().expect("a list").iter();
        all.filter(|p| p["uri"].as_str().is_some_and(|u| u.ends_with(name))).count()
    };
    assert_eq!((of("Base.mo", &places), of("User.mo", &places)), (1, 2), "{places}");
    let wanted =
        json!({ "textDocument": { "uri": address }, "position": place, "newName": "factor" });
    let edits = editor.ask("textDocument/rename", wanted);
    let changed = edits["changes"].as_object().expect("edits");
    assert_eq!(changed.len(), 2, "{edits}");
    editor.close();
}

#[test]
fn keys_of_plans_are_completed() {
    let mut editor = Editor::open(MODEL);
    let text = "model = \"push.mo\"\n[goal]\n";
    let address = editor.address.replace("push.mo", "plan.toml");
    let document = json!({ "uri": address, "languageId": "toml", "version": 1, "text": text });
    editor.tell("textDocument/didOpen", json!({ "textDocument": document }));
    let wanted =
        json!({ "textDocument": { "uri": address }, "position": { "line": 2, "character": 0 } });
    let items = editor.ask("textDocument/completion", wanted);
    assert_eq!(
        (&items[0]["label"], &items[1]["label"]),
        (&json!("minimize"), &json!("maximize")),
        "{items}"
    );
    editor.close();
}

#[test]
fn a_repair_replaces_the_misspelled_word_alone() {
    let text = "model A\n  Real x(start = 1, fixd = true);\nequation\n  der(x) = -x;\nend A;\n";
    let mut editor = Editor::open(text);
    let range = editor.diagnostics[0]["range"].clone();
    let uri = editor.address.clone();
    let actions = editor.ask(
        "textDocument/codeAction",
        json!({ "textDocument": { "uri": uri }, "range": range, "context": {} }),
    );
    let changes = json!({ "result": { "changes": actions[0]["edit"]["changes"] } });
    assert_eq!(editor.edited(&changes), text.replace("fixd", "fixed"));
    editor.close();
}

const LIBRARY: &str = "package L
  constant Real g = 9.81;
  type Kind = enumeration(slow, fast);
  function twice
    input Real u;
    output Real y;
  algorithm
    y := 2*u;
  end twice;
  record Pair
    Real first;
    Real second;
  end Pair;
  model PartA
    outer Real T;
    Real z = T;
  end PartA;
  model PartB
    extends PartA;
    Real extra = z;
  end PartB;
  model A
    inner Real T = 3;
    replaceable model Part = PartA constrainedby PartA;
    Part part;
    Kind kind = Kind.slow;
  end A;
  model M
    import S = L.twice;
    Pair p = Pair(first = 1, second = L.twice(u = 1)) \"first\";
    parameter Real k = 3*g;
    Real q = k*time;
    Real s = S(u = q) + sum(q for q in 1:3);
    A a(redeclare model Part = PartB);
  end M;
end L;
";

/// Named arguments, fields of records, names of redeclarations, literals; not the words of strings and loops.
#[test]
fn every_form_of_a_name_is_renamed() {
    let mut editor = Editor::open(LIBRARY);
    // The index of a loop hides a component, which is a warning.
    assert!(editor.diagnostics.iter().all(|d| d["severity"] == 2), "{:?}", editor.diagnostics);
    let cases = [
        ("input Real u", 11, "uu", vec![("Real u", "Real uu"), ("2*u", "2*uu"), ("(u =", "(uu =")]),
        ("Real first", 5, "one", vec![("Real first", "Real one"), ("(first", "(one")]),
        (
            "model Part =",
            6,
            "Piece",
            vec![("model Part ", "model Piece "), ("    Part part", "    Piece part")],
        ),
        ("(slow", 1, "late", vec![("(slow", "(late"), (".slow", ".late")]),
        ("Real q", 5, "w", vec![("Real q", "Real w"), ("(u = q)", "(u = w)")]),
        ("PartB\n", 0, "Other", vec![("PartB", "Other")]),
    ];
    for (part, shift, new, replaced) in cases {
        let reply = editor.rename(part, shift, new);
        let expected =
            replaced.iter().fold(LIBRARY.to_owned(), |text, (old, new)| text.replace(old, new));
        assert_eq!(editor.edited(&reply), expected, "{part}");
    }
    editor.close();
}

#[test]
fn what_would_change_the_meaning_is_not_renamed() {
    let mut editor = Editor::open(LIBRARY);
    for (part, shift, new, said) in [
        ("Real T =", 5, "temperature", "`inner` or `outer`"),
        ("Real q", 5, "g", "would mean the renamed `q`"),
        ("Real g", 5, "k", "already means something else"),
        ("Real z", 5, "extra", "`extra`"),
        ("Real q", 5, "Real", "name of the language"),
        ("Real q", 5, "time", "name of the language"),
        ("Real q", 5, "q q", "not a name"),
        ("S(u", 0, "three", "another name for `twice`"),
        ("S = L", 0, "three", "no name"),
        ("first\"", 0, "two", "no name"),
    ] {
        let reply = editor.rename(part, shift, new);
        let message =
            reply["error"]["message"].as_str().unwrap_or_else(|| panic!("{new}: {reply}"));
        assert!(message.contains(said), "{part} {new}: {message}");
    }
    editor.close();
}

/// A library in a folder, and a model in another project that uses it.
fn library(editor: &Editor) -> (PathBuf, PathBuf) {
    editor.write("P/package.mo", "package P\nend P;\n");
    editor.write("P/package.order", "Body\nWorld\n");
    let body =
        editor.write("P/Body.mo", "within P;\nmodel Body\n  parameter Real mass = 1;\nend Body;\n");
    editor.write("P/World.mo", "within P;\nmodel World\n  Body body(mass = 2);\nend World;\n");
    let deep = "P/A/B/C/D/E";
    for (k, name) in ["A", "B", "C", "D", "E"].iter().enumerate() {
        let within = ["P", "A", "B", "C", "D"][..=k].join(".");
        let folder = deep.split('/').take(k + 2).collect::<Vec<_>>().join("/");
        let text = format!("within {within};\npackage {name}\nend {name};\n");
        editor.write(&format!("{folder}/package.mo"), &text);
    }
    let inner = "within P.A.B.C.D.E;\nmodel Deep\n  Body body(mass = 3);\nend Deep;\n";
    editor.write(&format!("{deep}/Deep.mo"), inner);
    editor.write("user/mocc.toml", "libraries = [\"..\"]\n");
    let user = editor.write("user/Use.mo", "model Use\n  P.Body b(mass = 4);\nend Use;\n");
    (body, user)
}

/// The files of an answer, by the ends of their addresses.
fn files_of(reply: &Value) -> Vec<String> {
    let changes = reply["result"]["changes"].as_object();
    let all = changes.unwrap_or_else(|| panic!("no changes: {reply}"));
    let name = |address: &String| address.rsplit('/').next().unwrap_or_default().to_owned();
    let mut names: Vec<String> = all.keys().map(name).collect();
    names.sort();
    names
}

#[test]
fn all_files_that_use_a_declaration_are_changed_once() {
    let mut editor = Editor::open(MODEL);
    let (body, user) = library(&editor);
    let text = std::fs::read_to_string(&user).expect("the file");
    editor.turn_to(&user, &text);
    let all = ["Body.mo", "Deep.mo", "Use.mo", "World.mo"];
    assert_eq!(files_of(&editor.rename("mass", 0, "m")), all);
    // From the declaration, too, as the other project is open.
    let text = std::fs::read_to_string(&body).expect("the file");
    editor.turn_to(&body, &text);
    assert_eq!(files_of(&editor.rename("mass", 0, "m")), all);
    editor.close();
}

#[cfg(unix)]
#[test]
fn a_linked_file_has_the_address_of_the_client() {
    let mut editor = Editor::open(MODEL);
    let (body, _) = library(&editor);
    let link = editor.folder().join("link");
    std::os::unix::fs::symlink(body.parent().expect("its folder"), &link).expect("a link");
    let path = link.join("Body.mo");
    let text = std::fs::read_to_string(&path).expect("the file");
    editor.turn_to(&path, &text);
    let reply = editor.rename("mass", 0, "m");
    assert_eq!(files_of(&reply), ["Body.mo", "Deep.mo", "World.mo"]);
    assert!(editor.edited(&reply).contains("Real m ="), "{reply}");
    editor.close();
}

#[test]
fn a_class_takes_its_file_along() {
    let mut editor = Editor::open(MODEL);
    let (body, _) = library(&editor);
    let text = std::fs::read_to_string(&body).expect("the file");
    editor.turn_to(&body, &text);
    let reply = editor.rename("model Body", 6, "Corps");
    let message = reply["error"]["message"].as_str().expect("a refusal");
    assert!(message.contains("cannot rename files"), "{message}");
    editor.close();
    let edit = json!({ "documentChanges": true, "resourceOperations": ["create", "rename"] });
    let mut editor = Editor::start(MODEL, &json!({ "workspace": { "workspaceEdit": edit } }));
    let (body, _) = library(&editor);
    editor.turn_to(&body, &text);
    let reply = editor.rename("model Body", 6, "Corps");
    let steps = reply["result"]["documentChanges"].as_array().expect("steps").clone();
    let last = steps.last().expect("a step");
    assert_eq!((&last["kind"], &last["oldUri"]), (&json!("rename"), &json!(editor.address)));
    assert!(last["newUri"].as_str().is_some_and(|uri| uri.ends_with("/P/Corps.mo")), "{last}");
    let of = |name: &str| {
        let is = |step: &&Value| {
            step["textDocument"]["uri"].as_str().is_some_and(|uri| uri.ends_with(name))
        };
        steps.iter().find(is).map_or(0, |step| step["edits"].as_array().map_or(0, Vec::len))
    };
    let counts = [of("P/Body.mo"), of("World.mo"), of("Deep.mo"), of("package.order")];
    assert_eq!(counts, [2, 1, 1, 1], "{steps:?}");
    editor.close();
}

/// The server runs in the folder of the workspace, so that relative paths would be short.
#[test]
fn definitions_do_not_depend_on_the_working_directory() {
    let mut editor = Editor::open(MODEL);
    library(&editor);
    for folder in ["P", "lib/Seals"] {
        let name = folder.rsplit('/').next().expect("a name");
        editor.write(&format!("{folder}/package.mo"), &format!("package {name}\nend {name};\n"));
        let part = editor.write(
            &format!("{folder}/FlowSeal.mo"),
            &format!("within {name};\nmodel FlowSeal\nend FlowSeal;\n"),
        );
        let text = format!("within {name};\nmodel Use\n  FlowSeal f;\nend Use;\n");
        let path = editor.write(&format!("{folder}/Use.mo"), &text);
        editor.turn_to(&path, &text);
        assert_eq!(editor.diagnostics, Vec::<Value>::new());
        let found = editor.at("textDocument/definition", "FlowSeal f", 1);
        assert_eq!(found["uri"], json!(format!("file://{}", part.display())));
    }
    editor.close();
}

#[test]
fn texts_that_are_not_saved_are_seen() {
    let mut editor = Editor::open(MODEL);
    editor.write("Q/package.mo", "package Q\nend Q;\n");
    let (a, b) = (
        "within Q;\nmodel A\n  parameter Real k = 1;\nend A;\n",
        "within Q;\nmodel B\n  A a(k = 2);\nend B;\n",
    );
    let (first, second) = (editor.write("Q/A.mo", a), editor.write("Q/B.mo", b));
    editor.turn_to(&second, b);
    assert_eq!(editor.diagnostics, Vec::<Value>::new());
    editor.turn_to(&first, a);
    editor.edit("Real k", "Real kk");
    // The text that uses it is checked again.
    editor.wait_for(&second);
    assert_eq!(editor.diagnostics.len(), 1, "{:?}", editor.diagnostics);
    // A class that is on no disk.
    let new = "within Q;\nmodel New\n  A a(kk = 2);\nend New;\n";
    let path = first.with_file_name("New.mo");
    editor.turn_to(&path, new);
    assert_eq!(editor.diagnostics, Vec::<Value>::new());
    editor.close();
}

#[test]
fn problems_of_other_files_name_them() {
    let mut editor = Editor::open(MODEL);
    editor.write("Q/package.mo", "package Q\nend Q;\n");
    editor.write("Q/A.mo", "within Q;\nmodel A\n  Real x = kx;\nend A;\n");
    let text = "within Q;\nmodel B\n  A a;\nend B;\n";
    let path = editor.write("Q/B.mo", text);
    editor.turn_to(&path, text);
    let found = &editor.diagnostics[0];
    assert!(
        found["message"].as_str().is_some_and(|m| m.starts_with("in A.mo, line 3: ")),
        "{found}"
    );
    let related = &found["relatedInformation"][0]["location"];
    assert!(related["uri"].as_str().is_some_and(|uri| uri.ends_with("Q/A.mo")), "{found}");
    assert_eq!(related["range"]["start"]["line"], 2, "{found}");
    editor.close();
}

#[test]
fn files_of_other_tools_are_left_alone() {
    let mut editor = Editor::open(MODEL);
    let text = "[package]\nname = \"x\"\n";
    let path = editor.write("Cargo.toml", text);
    editor.turn_to(&path, text);
    assert_eq!(editor.diagnostics, Vec::<Value>::new());
    editor.close();
}

#[test]
fn broken_messages_are_refused_and_the_next_is_read() {
    let mut editor = Editor::open(MODEL);
    let code = |editor: &mut Editor, method: &str, parameters: Value| {
        editor.reply(method, parameters)["error"]["code"].clone()
    };
    let input = editor.input.as_mut().expect("open");
    input.write_all(b"Content-Length: 5\r\n\r\n{bad}").expect("it reads");
    assert_eq!(editor.receive()["error"]["code"], -32700);
    assert_eq!(code(&mut editor, "foo/bar", json!({})), -32601);
    assert_eq!(code(&mut editor, "$/x", json!({})), -32601);
    assert_eq!(code(&mut editor, "textDocument/hover", json!({})), -32602);
    assert_eq!(code(&mut editor, "initialize", json!({})), -32600);
    editor.send(&json!({ "jsonrpc": "2.0", "id": 99 }));
    assert_eq!(editor.receive()["error"]["code"], -32600);
    assert_eq!(editor.reply("shutdown", Value::Null)["result"], Value::Null);
    assert_eq!(code(&mut editor, "textDocument/hover", json!({})), -32600);
}

#[test]
fn completion_sees_the_classes_around_a_place() {
    let mut editor = Editor::open(MODEL);
    library(&editor);
    let labels = |items: Value| -> Vec<String> {
        let items = items.as_array().expect("a list").iter();
        items.map(|i| i["label"].as_str().expect("a label").to_owned()).collect()
    };
    let mut of = |line: &str| {
        let text = format!(
            "within P;\nmodel ZZ\n  constant Real g = 1;\n  model I\n  {line}\n  end I;\nend ZZ;\n"
        );
        let at = text.find('|').expect("a place");
        let path = editor.folder().join("P/ZZ.mo");
        editor.turn_to(&path, &text.replace('|', ""));
        let position = editor.place(at);
        let document = json!({ "uri": editor.address });
        let wanted = json!({ "textDocument": document, "position": position });
        labels(editor.ask("textDocument/completion", wanted))
    };
    let found = of("Bod|");
    for name in ["Body", "World", "g", "Real", "time", "sin", "Units"] {
        assert!(found.iter().any(|label| label == name), "no {name} in {found:?}");
    }
    for line in ["Body b(|);", "Body b(final |", "Body b(ma|"] {
        let found = of(line);
        assert_eq!(found.contains(&"mass".to_owned()), !line.contains("final"), "{line} {found:?}");
    }
    assert_eq!(of("Real x(unit=\"|\");"), [""; 0]);
    assert_eq!(of("// a|"), [""; 0]);
    assert!(of("Real x(min = 1, |);").contains(&"max".to_owned()));
    editor.close();
}

#[test]
fn calls_have_signatures_and_names_are_highlighted() {
    let mut editor = Editor::open(LIBRARY);
    let help = editor.at("textDocument/signatureHelp", "Pair(first = 1, ", 16);
    assert_eq!(help["signatures"][0]["label"], "Pair(Real first, Real second)", "{help}");
    assert_eq!(help["activeParameter"], 1);
    let places = editor.at("textDocument/documentHighlight", "Kind.slow", 6);
    assert_eq!(places.as_array().map(Vec::len), Some(2), "{places}");
    let prepared = editor.at("textDocument/prepareRename", "Real q", 5);
    assert_eq!(prepared["placeholder"], "q");
    let found = editor.ask("workspace/symbol", json!({ "query": "partb" }));
    assert_eq!(
        (&found[0]["name"], &found[0]["containerName"]),
        (&json!("PartB"), &json!("L")),
        "{found}"
    );
    let hover = editor.at("textDocument/hover", "S(u", 2);
    assert!(hover["contents"]["value"].to_string().contains("input Real u"), "{hover}");
    editor.close();
}

#[test]
fn hover_shows_values_after_modification() {
    let text = "model T\n  model B\n    parameter Real a = 1;\n    parameter Real b = 2*a;\n  end B;\n  parameter Real k = 4;\n  B x(a = k + 1);\n  Real r = x.b;\n  parameter Boolean on = k > 3;\nend T;\n";
    let mut editor = Editor::open(text);
    for (part, shift, value) in [("(a = k", 1, "= 5"), ("x.b", 2, "= 10"), ("on =", 0, "= true")] {
        let hover = editor.at("textDocument/hover", part, shift);
        assert!(hover["contents"]["value"].to_string().contains(value), "{part}: {hover}");
    }
    editor.close();
}
