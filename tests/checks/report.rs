//! `mocc report`: facts of the page, and the page in a browser.

use std::path::{Path, PathBuf};
use std::process::Command;

use serde_json::Value;

use super::door::{Case, Reading, Scratch, suite_model};
use super::program::mocc;

/// All that the command is shown with.
const EXAMPLES: [&str; 11] = [
    "valve52.mol",
    "valve32.mol",
    "valve22.mol",
    "valve53.mol",
    "evolution/a_air_springs.mol",
    "evolution/b_mechanical_spring.mol",
    "evolution/c_seal_signals.mol",
    "evolution/d_dwell.mol",
    "evolution/e_functional_unit.mol",
    "bouncing_ball.mol",
    "oscillator.mol",
];

fn example(name: &str) -> String {
    format!("{}/examples/{name}", env!("CARGO_MANIFEST_DIR"))
}

/// Makes a page in a folder; its text.
fn page(folder: &Path, arguments: &[&str]) -> String {
    let mut all = vec!["report"];
    all.extend(arguments);
    all.extend(["--output", "page.html"]);
    let ended = mocc(folder, &all);
    assert_eq!((ended.status, ended.err.as_str()), (0, ""), "{arguments:?}");
    assert!(ended.out.ends_with("  wrote page.html\n"), "{}", ended.out);
    std::fs::read_to_string(folder.join("page.html")).expect("a page")
}

/// The page of an example.
fn page_of(folder: &Path, name: &str) -> String {
    page(folder, &[&example(name)])
}

/// The data of a page by the name of their element.
fn data(page: &str, id: &str) -> Option<Value> {
    let begin = format!("<script type=\"application/json\" id=\"{id}\">");
    let (_, rest) = page.split_once(&begin)?;
    let (text, _) = rest.split_once("</script>")?;
    Some(serde_json::from_str(text).expect("JSON"))
}

/// Base64, RFC 4648, by the alphabet's positions.
fn bytes(text: &str) -> Vec<u8> {
    let value = |c: u8| match c {
        b'A'..=b'Z' => u32::from(c - b'A'),
        b'a'..=b'z' => u32::from(c - b'a') + 26,
        b'0'..=b'9' => u32::from(c - b'0') + 52,
        b'+' => 62,
        b'/' => 63,
        other => panic!("{other} is not a digit of base64"),
    };
    let signs: Vec<u32> = text.bytes().filter(|c| *c != b'=').map(value).collect();
    let mut out = Vec::new();
    for chunk in signs.chunks(4) {
        let word = chunk.iter().enumerate().fold(0, |w, (i, s)| w | s << (18 - 6 * i));
        out.extend((0..chunk.len() - 1).map(|i| (word >> (16 - 8 * i)) as u8));
    }
    out
}

/// An array of the page.
fn numbers(data: &Value, k: usize) -> Vec<f64> {
    let array = &data["arrays"][k];
    match (array["f64"].as_str(), array["f32"].as_str()) {
        (Some(text), _) => bytes(text)
            .chunks_exact(8)
            .map(|b| f64::from_le_bytes(b.try_into().expect("eight")))
            .collect(),
        (_, Some(text)) => bytes(text)
            .chunks_exact(4)
            .map(|b| f64::from(f32::from_le_bytes(b.try_into().expect("four"))))
            .collect(),
        _ => panic!("array {k} is of no kind"),
    }
}

#[test]
fn every_component_has_its_box_and_every_connect_its_line() {
    let folder = Scratch::new();
    for name in EXAMPLES {
        let page = page(folder.path(), &[&example(name)]);
        let text = std::fs::read_to_string(example(name)).expect("an example");
        // The first diagram is that of the model itself.
        let Some(figure) = page.split("<figure").nth(1) else {
            assert!(page.contains("no components"), "{name}");
            continue;
        };
        let svg = figure.split_once("</svg>").expect("a picture").0;
        let lines = svg.matches("class=\"wire connect ").count();
        let written = text.lines().filter(|l| !l.trim_start().starts_with("//"));
        let of_model = match name {
            // Classes before the model have their own.
            "evolution/c_seal_signals.mol" => 9,
            // One of two arrays of four.
            "evolution/d_dwell.mol" => 4,
            _ => written.map(|l| l.matches("connect(").count()).sum(),
        };
        assert_eq!(lines, of_model, "{name}");
        let boxes = svg.matches("data-part=\"").count();
        let parts: Vec<&str> = svg
            .split("data-part=\"")
            .skip(1)
            .map(|rest| rest.split('"').next().expect("a name"))
            .collect();
        assert!(boxes > 0 && parts.iter().all(|p| !p.contains('.')), "{name}: {parts:?}");
        let flat = Case::file(example(name)).flat();
        for part in parts {
            assert!(flat.contains(&format!("{part}.")), "{name}: there is no `{part}`");
        }
    }
    let page = page(folder.path(), &[&example("valve52.mol")]);
    let first = page.split("<figure").nth(1).expect("a diagram");
    assert_eq!(first.matches("data-part=\"").count(), 29);
    // The pilot reads the switch; the restrictions to chamber 14 read the pilot.
    assert_eq!(first.matches("class=\"wire reads ").count(), 3);
    assert!(first.contains("pilot.on reads switch.on"), "the place of a binding");
    assert!(first.contains("connect(seal_p.spool, spool.seals)  "), "the place of a connect");
}

/// Corners of boxes of a level: name, left, top, right, bottom.
fn boxes(svg: &str) -> Vec<(String, [f64; 4])> {
    let number = |text: &str, key: &str| -> f64 {
        let rest = text.split_once(&format!(" {key}=\"")).expect(key).1;
        rest.split('"').next().expect("a value").parse().expect("a number")
    };
    let mut found = Vec::new();
    for rest in svg.split("data-part=\"").skip(1) {
        let name = rest.split('"').next().expect("a name").to_owned();
        let rect = rest.split_once("<rect").expect("a box").1;
        let [x, y, w, h] = ["x", "y", "width", "height"].map(|k| number(rect, k));
        found.push((name, [x, y, x + w, y + h]));
    }
    found
}

#[test]
fn boxes_stand_apart_and_mimic_the_valve() {
    let folder = Scratch::new();
    for name in EXAMPLES {
        let page = page(folder.path(), &[&example(name)]);
        for figure in page.split("<figure").skip(1) {
            let svg = figure.split_once("</svg>").expect("a picture").0;
            let all = boxes(svg);
            for (i, (a, p)) in all.iter().enumerate() {
                for (b, q) in &all[i + 1..] {
                    let apart = p[2] < q[0] || q[2] < p[0] || p[3] < q[1] || q[3] < p[1];
                    assert!(apart, "{name}: `{a}` lies on `{b}`");
                }
            }
        }
    }
    let page = page(folder.path(), &[&example("valve52.mol")]);
    let all = boxes(page.split("<figure").nth(1).expect("a diagram"));
    let of = |name: &str| all.iter().find(|(n, _)| n == name).expect(name).1;
    let other = page_of(folder.path(), "valve53.mol");
    let other = boxes(other.split("<figure").nth(1).expect("a diagram"));
    let left = |name: &str| other.iter().find(|(n, _)| n == name).expect(name).1[0];
    let along = [
        "chamber_14",
        "seal_p",
        "seal_a",
        "seal_45",
        "seal_14",
        "seal_12",
        "seal_23",
        "seal_b",
        "chamber_12",
    ];
    assert!(along.windows(2).all(|w| left(w[0]) < left(w[1])), "the order of the 5/3-way valve");
    // Along the spool as in the valve: drive, seals with the chambers between them, air spring.
    let row = [
        "chamber_14",
        "seal_p",
        "seal_a",
        "seal_45",
        "seal_14",
        "seal_12",
        "seal_23",
        "seal_b",
        "chamber_12",
    ];
    for pair in row.windows(2) {
        assert!(of(pair[0])[2] < of(pair[1])[0], "{pair:?}");
        assert!(of(pair[0])[3] < of("spool")[1], "{pair:?} above the spool");
    }
    for (left, chamber, right) in [
        ("seal_a", "chamber_5", "seal_45"),
        ("seal_45", "chamber_4", "seal_14"),
        ("seal_14", "chamber_1", "seal_12"),
        ("seal_12", "chamber_2", "seal_23"),
        ("seal_23", "chamber_3", "seal_b"),
    ] {
        let middle = |n: &str| 0.5 * (of(n)[0] + of(n)[2]);
        assert!(middle(left) < middle(chamber) && middle(chamber) < middle(right), "{chamber}");
    }
}

#[test]
fn placements_of_the_model_are_kept() {
    let folder = Scratch::new();
    let part = |name: &str, at: &str| {
        format!("Part {name} annotation(Placement(transformation(extent = {at})));")
    };
    let text = format!(
        "package P connector C Real p; flow Real q; end C; model Part C c; equation c.p = 1; end Part;
         model Leak C c; equation c.q = 0; end Leak;
         model Whole {} Leak b annotation(Placement(transformation(origin = {{100, 40}}, extent = {{{{-10, -10}}, {{10, 10}}}}))); equation connect(a.c, b.c); end Whole; end P;",
        part("a", "{{-10, -10}, {10, 10}}")
    );
    folder.file("p.mo", &text);
    let ended = mocc(folder.path(), &["report", "p.mo", "--diagram", "p.svg"]);
    assert_eq!((ended.status, ended.err.as_str()), (0, ""));
    let svg = std::fs::read_to_string(folder.path().join("p.svg")).expect("a picture");
    let all = boxes(&svg);
    let ((_, a), (_, b)) = (&all[0], &all[1]);
    // 100 to the right and 40 up, where a box is 20 wide.
    let scale = (a[2] - a[0]) / 20.0;
    let (x, y) = (b[0] - a[0], a[1] - b[1]);
    assert!((x - 100.0 * scale).abs() < 1.5 && (y - 40.0 * scale).abs() < 1.5, "{x} {y} {scale}");
    assert_eq!(svg.matches("class=\"wire connect ").count(), 1);
    assert!(!folder.path().join("p_report.html").exists(), "only the diagram was asked for");
}

#[test]
fn data_read_back_to_the_run() {
    let folder = Scratch::new();
    let page = page(folder.path(), &[&example("valve52.mol")]);
    let data = data(&page, "mocc-data").expect("data");
    let run = Case::file(example("valve52.mol")).run();
    let variables = data["variables"].as_array().expect("a list");
    assert_eq!(variables.len(), run.columns.len());
    let columns = data["runs"][0]["columns"].as_array().expect("a list");
    let mut moving = 0;
    for (k, column) in run.columns.iter().enumerate() {
        assert_eq!(variables[k]["name"], column.name.as_str());
        let exact = run.of(&column.name);
        let place = |i: usize| columns[k][i].as_u64().map(|x| x as usize);
        let (Some(t), Some(v)) = (place(0), place(1)) else {
            let only = columns[k].as_f64().expect("a value");
            assert!(exact.iter().all(|x| *x == only), "{}", column.name);
            continue;
        };
        moving += 1;
        assert_eq!(numbers(&data, t), run.time);
        let factor = columns[k][2].as_f64().expect("a factor");
        for (x, y) in exact.iter().zip(numbers(&data, v)) {
            // Single precision: half a unit in the last of 24 binary digits.
            let rounding = x.abs() * 2f64.powi(-24) + 1e-38;
            assert!((x - factor * y).abs() <= rounding, "{}: {x} {y}", column.name);
        }
    }
    assert!(moving > 100, "{moving}");
    // What was not chosen at first is there all the same.
    assert_eq!(data["show"].as_array().map(Vec::len), Some(5));
}

#[test]
fn the_spool_is_found_from_the_structure() {
    let folder = Scratch::new();
    let spool = |name: &str| data(&page(folder.path(), &[&example(name)]), "mocc-spool");
    let v52 = spool("valve52.mol").expect("a spool");
    let list = |v: &Value, key: &str, of: &str| -> Vec<String> {
        let all = v[key].as_array().expect("a list").iter();
        all.map(|s| s[of].as_str().expect("a text").to_owned()).collect()
    };
    let seals = ["seal_p", "seal_a", "seal_45", "seal_14", "seal_12", "seal_23", "seal_b"];
    assert_eq!(list(&v52, "seals", "name"), seals);
    assert_eq!(v52["stops"], serde_json::json!([0.0, 3.5e-3]));
    let contacts = list(&v52, "seals", "contact");
    assert_eq!(contacts[2..6], ["OpenToClose", "CloseToOpen", "OpenToClose", "CloseToOpen"]);
    let chambers = list(&v52, "chambers", "name");
    let side = |k: usize, side: &str| {
        let at = v52["seals"][k][side].as_u64().expect("a chamber") as usize;
        chambers[at].as_str()
    };
    let between: Vec<&str> = (0..7).map(|k| side(k, "left")).collect();
    let expected =
        ["chamber_14", "ambient", "chamber_5", "chamber_4", "chamber_1", "chamber_2", "chamber_3"];
    assert_eq!(between, expected);
    assert_eq!(side(6, "right"), "chamber_12");

    let springs = spool("evolution/b_mechanical_spring.mol").expect("a spool");
    assert_eq!(springs["seals"], serde_json::json!([]));
    let pistons: Vec<bool> = springs["drives"]
        .as_array()
        .expect("a list")
        .iter()
        .map(|d| d["piston"].as_bool().expect("a flag"))
        .collect();
    assert_eq!(pistons, [true, false]);
    assert_eq!(
        spool("evolution/c_seal_signals.mol").expect("a spool")["seals"].as_array().map(Vec::len),
        Some(7)
    );
    assert_eq!(
        spool("evolution/e_functional_unit.mol").expect("a spool")["seals"]
            .as_array()
            .map(Vec::len),
        Some(4)
    );
    for name in ["bouncing_ball.mol", "oscillator.mol"] {
        assert_eq!(spool(name), None, "{name}");
    }
}

/// A model whose strings look like markup.
fn nasty_model() -> String {
    suite_model("report/models/markup_in_strings")
}

#[test]
fn strings_of_models_are_not_markup() {
    let folder = Scratch::new();
    folder.file("nasty.mo", &nasty_model());
    let run = "</script><i>: k=2";
    let page = page(folder.path(), &["nasty.mo", "--run", run, "--run", "b: k=3"]);
    for broken in ["<img", "<i>", "</script><script>w", "<b>,", "</pre></section></script>"] {
        assert!(!page.contains(broken), "`{broken}` is markup");
    }
    let scripts = page.matches("<script").count();
    assert_eq!((scripts, page.matches("</script>").count()), (2, 2));
    let data = data(&page, "mocc-data").expect("data");
    assert_eq!(data["variables"][0]["text"], "</script> --> \" ' &amp; {body}");
    assert_eq!(data["runs"][0]["label"], "</script><i>");
    assert!(
        page.contains(
            "&lt;/script&gt;&lt;script&gt;window.nasty = 1&lt;/script&gt; &amp; &lt;b&gt;"
        )
    );
}

#[test]
fn several_runs_have_their_parameters_and_recordings() {
    let folder = Scratch::new();
    folder.file("decay.mo", "model Decay parameter Real k = 1 \"Rate\"; parameter Real c = 5; Real x(start = 1, fixed = true, unit = \"m\"); equation der(x) = -k*x; end Decay;");
    folder.file("seen.csv", "t_ms,x_mm\n0,1000\n500,606.5\n1000,367.9\n");
    let data_of = ["--data", "seen.csv", "--signal", "t_ms=time:ms", "--signal", "x_mm=x:mm"];
    let mut all = vec!["decay.mo", "--set", "c=7", "--stop", "2", "--tolerance", "1e-9"];
    all.extend(["--run", "slow: k=0.5", "--run", "k=2, c=3"]);
    all.extend(data_of);
    let first = page(folder.path(), &all);
    assert_eq!(first, page(folder.path(), &all), "the same bytes again");
    let data = data(&first, "mocc-data").expect("data");
    let labels: Vec<&str> = data["runs"]
        .as_array()
        .expect("a list")
        .iter()
        .filter_map(|r| r["label"].as_str())
        .collect();
    assert_eq!(labels, ["slow", "k=2, c=3"]);
    for (r, k) in [0.5, 2.0].into_iter().enumerate() {
        let column = &data["runs"][r]["columns"][0];
        let at = |i: usize| numbers(&data, column[i].as_u64().expect("a place") as usize);
        let (t, x) = (at(0), at(1));
        assert_eq!(t.last(), Some(&2.0));
        for (t, x) in t.iter().zip(x) {
            assert!((x - (-k * t).exp()).abs() < 1e-6, "{k} {t} {x}");
        }
    }
    let measured = &data["measured"][0];
    let place = |key: &str| measured[key].as_u64().expect("a place") as usize;
    assert_eq!(numbers(&data, place("time")), [0.0, 0.5, 1.0]);
    let values = numbers(&data, place("values"));
    assert!(values.iter().zip([1.0, 0.6065, 0.3679]).all(|(a, b)| (a - b).abs() < 1e-7));
    // One run sets c itself, the other takes it from --set.
    let row = first.split("data-find=\"c \"").nth(1).expect("the parameter c");
    let row = row.split("</tr>").next().expect("a row");
    assert_eq!(row.matches("<em>set</em>").count(), 2, "{row}");
    assert!(row.contains(">7 <em>") && row.contains(">3 <em>"), "{row}");
}

#[test]
fn errors_are_reported() {
    let folder = Scratch::new();
    folder.file("m.mo", "model M parameter Real k = 1; Real x = k*time; end M;");
    folder.file("seen.csv", "t,y\n0,1\n1,2\n");
    let cases: [(&[&str], &str); 7] = [
        (&["--run", "a: k"], "`k` in the run `a: k` is not an override"),
        (&["--run", "a: k=1", "--run", "a: k=2"], "two runs have the label `a`"),
        (&["--run", "a: q=1"], "no parameter `q`"),
        (&["--data", "seen.csv"], "no column is named like a variable"),
        (&["--data", "seen.csv", "--signal", "y=z:1"], "the model has no variable `z`"),
        (&["--signal", "y=x:furlong"], "unknown unit `furlong`"),
        (&["--show", "z"], "there is no variable `z`"),
    ];
    for (arguments, message) in cases {
        let mut all = vec!["report", "m.mo"];
        all.extend(arguments);
        let ended = mocc(folder.path(), &all);
        assert_eq!(ended.status, 2, "{arguments:?}: {}", ended.err);
        assert!(ended.err.contains(message), "{}", ended.err);
        assert!(!folder.path().join("m_report.html").exists(), "{arguments:?}");
    }
    folder.file("bad.mo", "model B Real x(start = 1, fixed = true); equation der(x) = x^2; end B;");
    let ended = mocc(folder.path(), &["report", "bad.mo", "--stop", "2"]);
    assert_eq!(ended.status, 3, "{}", ended.err);
    assert!(!folder.path().join("bad_report.html").exists());
}

// ---- In a browser ----

/// Debian's name for it, and others'.
fn chromium() -> Option<PathBuf> {
    let path = std::env::var_os("PATH")?;
    let names = ["chromium", "chromium-browser", "google-chrome"];
    let found = std::env::split_paths(&path)
        .find_map(|folder| names.iter().map(|n| folder.join(n)).find(|file| file.is_file()));
    if found.is_none() {
        eprintln!("skipped: Chromium is not installed (Debian: apt-get install chromium)");
    }
    found
}

/// What a page says of itself after `script` has run in it: the text of an element that the script
/// writes, and what the console said.
fn browse(chromium: &Path, folder: &Path, page: &str, script: &str) -> (String, String) {
    let probe = format!(
        "<script>window.addEventListener('load', () => setTimeout(() => {{ let said; try {{ said = (() => {{ {script} }})(); }} catch (why) {{ said = 'threw ' + why; }} const p = document.createElement('pre'); p.id = 'probe'; p.textContent = String(said); document.body.append(p); }}, 300));</script>\n</body>"
    );
    let (before, after) = page.rsplit_once("</body>").expect("a page");
    let path = folder.join("probe.html");
    std::fs::write(&path, format!("{before}{probe}{after}")).expect("a writable folder");
    let output = Command::new(chromium)
        .args(["--headless", "--no-sandbox", "--disable-gpu", "--disable-dev-shm-usage"])
        .args(["--window-size=1300,2000", "--virtual-time-budget=5000", "--enable-logging=stderr"])
        .arg(format!("--user-data-dir={}", folder.join("profile").display()))
        .arg("--dump-dom")
        .arg(format!("file://{}", path.display()))
        .output()
        .expect("Chromium starts");
    let dom = String::from_utf8_lossy(&output.stdout).into_owned();
    let log = String::from_utf8_lossy(&output.stderr);
    let console: Vec<&str> = log.lines().filter(|l| l.contains("CONSOLE")).collect();
    let said = dom.split_once("<pre id=\"probe\">").map(|(_, rest)| rest);
    let said = said.and_then(|rest| rest.split_once("</pre>")).map(|(said, _)| said.to_owned());
    (said.unwrap_or_else(|| format!("nothing; {log}")), console.join("\n"))
}

#[test]
fn the_page_works_in_a_browser() {
    let Some(chromium) = chromium() else { return };
    let folder = Scratch::new();
    let page = page(folder.path(), &[&example("valve52.mol")]);
    let script = "
        const m = window.__mocc, moved = () => m.machine.moving.getAttribute('transform');
        const traces = document.querySelectorAll('#traces-figure path.trace');
        const filled = [...traces].every(t => t.getAttribute('d').length > 200 && !t.getAttribute('d').includes('NaN'));
        const rest = moved();
        m.machine.slider.value = 0.5;
        m.machine.slider.dispatchEvent(new Event('input'));
        const cursor = m.figure.cursor, stroke = moved();
        m.go(0.0272);
        const open = [...document.querySelectorAll('.seal')].map(s => s.querySelector('ellipse').getAttribute('fill') === '#ffffff');
        m.figure.zoom([0.01, 0.03]);
        const zoomed = m.figure.view.join(' ');
        document.querySelector('#traces-figure .panel > svg').dispatchEvent(new MouseEvent('dblclick'));
        const whole = m.figure.view.join(' ');
        m.open('seal_45');
        const level = [...document.querySelectorAll('.level')].filter(l => !l.hidden).map(l => l.dataset.level);
        const s = m.value(m.data.runs[0], m.byName.get('s'), 0.06);
        return JSON.stringify({ traces: traces.length, filled, rest, stroke, cursor, open, zoomed, whole, level, s });";
    let (said, console) = browse(&chromium, folder.path(), &page, script);
    assert_eq!(console, "", "the console is silent");
    let said: Value = serde_json::from_str(&said).unwrap_or_else(|why| panic!("{why}: {said}"));
    assert_eq!(said["traces"], 5);
    assert_eq!(said["filled"], true);
    assert_eq!(said["rest"], "translate(0.00 0)");
    // Halfway through the run the valve is switched on: 46 px are the whole stroke.
    assert_eq!(said["stroke"], "translate(46.00 0)");
    assert!((said["cursor"].as_f64().expect("a time") - 0.06).abs() < 1e-9);
    // The edges on the way: 1 feeds 4, and 2 is vented through 3.
    assert_eq!(said["open"], serde_json::json!([false, false, false, true, false, true, false]));
    assert_eq!(
        (said["zoomed"].as_str(), said["whole"].as_str()),
        (Some("0.01 0.03"), Some("0 0.12"))
    );
    assert_eq!(said["level"], serde_json::json!(["seal_45"]));
    assert!((said["s"].as_f64().expect("a stroke") - 3.5e-3).abs() < 1e-9);
}

#[test]
fn all_examples_open_without_a_word_of_the_console() {
    let Some(chromium) = chromium() else { return };
    let folder = Scratch::new();
    for name in EXAMPLES {
        let page = page(folder.path(), &[&example(name)]);
        let script = "const t = document.querySelectorAll('path.trace'); return t.length > 0 && [...t].every(p => p.getAttribute('d').startsWith('M') && !/NaN|Infinity/.test(p.getAttribute('d'))) && !/NaN|undefined/.test(document.querySelector('main').textContent.replace(/<pre[^]*/, ''));";
        let (said, console) = browse(&chromium, folder.path(), &page, script);
        assert_eq!((said.as_str(), console.as_str()), ("true", ""), "{name}");
    }
    folder.file("nasty.mo", &nasty_model());
    let page = page(folder.path(), &["nasty.mo", "--run", "</script><i>: k=2", "--run", "b: k=3"]);
    let script = "return [window.nasty, document.querySelectorAll('path.trace').length, document.querySelectorAll('i i, main > img, b b').length].join();";
    let (said, console) = browse(&chromium, folder.path(), &page, script);
    assert_eq!((said.as_str(), console.as_str()), (",2,0", ""));
}

#[test]
fn charts_have_two_axes_stand_over_variables_and_are_saved() {
    let Some(chromium) = chromium() else { return };
    let folder = Scratch::new();
    let page = page(folder.path(), &[&example("valve52.mol")]);
    let script = "
        const m = window.__mocc, show = (...names) => { m.chosen.splice(0, m.chosen.length, ...names.map(n => m.byName.get(n))); };
        const count = q => document.querySelectorAll(q).length;
        const change = (select, value) => { select.value = value; select.dispatchEvent(new Event('change')); };
        show('s', 'p14', 'p12', 'v');
        change(m.layout, 'unit'); const unit = count('#traces-figure .panel');
        change(m.layout, 'each'); const each = count('#traces-figure .panel');
        change(m.layout, 'pairs'); const pairs = count('#traces-figure .panel');
        // Every panel has numbers on its axis of time.
        const axes = [...document.querySelectorAll('#traces-figure .panel > svg')].every(p => [...p.querySelectorAll('text')].some(t => t.textContent === '60'));
        const svg = m.picture();
        // Drag up and down: only values are zoomed.
        const own = m.figure.panels[0], box = own.plot.getBoundingClientRect();
        const send = (type, x, y) => own.plot.dispatchEvent(new PointerEvent(type, { clientX: box.left + x, clientY: box.top + y, pointerId: 1, button: 0 }));
        own.plot.setPointerCapture = () => {};
        send('pointerdown', 200, 40); send('pointermove', 201, 100); send('pointerup', 201, 100);
        const band = own.band.map(v => v.toFixed(2)).join(' '), whole = m.figure.view.join(' ');
        m.figure.showAll();
        m.figure.zoom([0.02, 0.021]);
        const csv = m.table().trim().split('\\n');
        m.figure.showAll();
        change(m.over, String(m.byName.get('s')));
        const over = [count('#plane-figure path.trace'), document.getElementById('traces-figure').hidden];
        m.go(0.025);
        const dots = count('#plane-figure circle');
        return JSON.stringify({ unit, each, pairs, axes, svg: svg.startsWith('<svg') && !svg.includes('var(--'), band, whole, head: csv[0], rows: csv.length, over, dots });";
    let (said, console) = browse(&chromium, folder.path(), &page, script);
    assert_eq!(console, "", "the console is silent");
    let said: Value = serde_json::from_str(&said).unwrap_or_else(|why| panic!("{why}: {said}"));
    assert_eq!(
        (&said["unit"], &said["each"], &said["pairs"]),
        (&3.into(), &4.into(), &2.into()),
        "{said}"
    );
    assert_eq!((&said["axes"], &said["svg"]), (&true.into(), &true.into()), "{said}");
    assert_eq!(said["whole"], "0 0.12", "the time stays: {said}");
    let band: Vec<f64> = said["band"]
        .as_str()
        .expect("a band")
        .split(' ')
        .map(|v| v.parse().expect("a number"))
        .collect();
    assert!(band[1] - band[0] > 0.5 && band[1] - band[0] < 2.5, "60 px of 162 of 3.9 mm: {said}");
    assert_eq!(said["head"], "time [s],s [m],p14 [Pa],p12 [Pa],v [m/s]");
    assert!(said["rows"].as_u64().expect("a count") > 3, "{said}");
    assert_eq!(said["over"], serde_json::json!([3, true]), "{said}");
    assert_eq!(said["dots"], 3, "{said}");
}

#[test]
fn the_page_fits_a_narrow_window_and_a_dark_theme() {
    let Some(chromium) = chromium() else { return };
    let folder = Scratch::new();
    let page = page(folder.path(), &[&example("valve52.mol")]);
    // The window of a headless browser is not narrower than 500 px, so the page is in a frame of 400 px.
    std::fs::write(folder.path().join("inner.html"), &page).expect("a writable folder");
    let outer = "<!DOCTYPE html><html><body><iframe id=\"f\" src=\"inner.html\" style=\"width:400px;height:3000px\"></iframe></body></html>";
    let script = "
        const inner = document.getElementById('f').contentWindow;
        if (!inner.__mocc) return 'no page';
        inner.__mocc.go(0.05);
        const wide = inner.document.documentElement.scrollWidth;
        const values = [...inner.document.querySelectorAll('#traces-figure .value')].map(v => v.getBoundingClientRect());
        const inside = values.every(b => b.width > 0 && b.left >= 0 && b.right <= 400);
        return JSON.stringify({ wide, values: values.length, inside });";
    let (said, _) = browse(&chromium, folder.path(), outer, script);
    if said.contains("SecurityError") || said.contains("no page") {
        eprintln!("skipped: the browser separates files from each other");
    } else {
        let said: Value = serde_json::from_str(&said).unwrap_or_else(|why| panic!("{why}: {said}"));
        assert!(said["wide"].as_u64().expect("a width") <= 400, "{said}");
        assert_eq!((&said["values"], &said["inside"]), (&5.into(), &true.into()), "{said}");
    }
    assert!(page.contains("@media (prefers-color-scheme: dark)"));
    for hard in ["fill: '#fff'", "stroke: '#eceff2'"] {
        assert!(!page.contains(hard), "`{hard}` does not follow the theme");
    }
}
