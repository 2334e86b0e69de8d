//! `mocc watch`: the served page follows its file, keeps the last good page, and is for this machine only.

use std::io::{BufRead, BufReader, Read, Write};
use std::net::TcpStream;
use std::process::{Child, Command, Stdio};
use std::time::{Duration, Instant};

use super::door::Scratch;
use super::program::mocc;

const MODEL: &str = "model M\n  parameter Real k = 2;\n  Real x(start = 1, fixed = true);\nequation\n  der(x) = -k*x;\nend M;\n";
/// Time within which a change must be served.
const PATIENCE: Duration = Duration::from_secs(20);

struct Watching {
    child: Child,
    address: String,
}

impl Drop for Watching {
    fn drop(&mut self) {
        // It may have ended.
        let _ = self.child.kill();
        let _ = self.child.wait();
    }
}

impl Watching {
    fn start(folder: &Scratch) -> Watching {
        let mut child = Command::new(env!("CARGO_BIN_EXE_mocc"))
            .current_dir(folder.path())
            .args(["watch", "m.mo"])
            .env_remove("MODELICAPATH")
            .stdout(Stdio::piped())
            .stderr(Stdio::null())
            .spawn()
            .expect("mocc starts");
        let mut output = BufReader::new(child.stdout.take().expect("a pipe"));
        let mut line = String::new();
        output.read_line(&mut line).expect("its address");
        let address = line.trim().trim_start_matches("http://").trim_end_matches('/').to_owned();
        // The pipe must not fill or close while it runs.
        std::thread::spawn(move || std::io::copy(&mut output, &mut std::io::sink()));
        Watching { child, address }
    }

    fn get(&self, path: &str, host: &str) -> String {
        let mut stream = TcpStream::connect(&self.address).expect("it serves");
        write!(stream, "GET {path} HTTP/1.1\r\nHost: {host}\r\n\r\n").expect("it reads");
        let mut answer = String::new();
        stream.read_to_string(&mut answer).expect("it answers");
        answer
    }

    fn page(&self) -> String {
        self.get("/", &self.address)
    }

    fn version(&self) -> String {
        let answer = self.get("/version", &self.address);
        answer.rsplit("\r\n\r\n").next().unwrap_or_default().to_owned()
    }

    /// Waits for another run than that of this number.
    fn after(&self, version: &str) -> String {
        let begun = Instant::now();
        loop {
            let now = self.version();
            if now != version {
                return now;
            }
            assert!(begun.elapsed() < PATIENCE, "no run after {version}");
            std::thread::sleep(Duration::from_millis(50));
        }
    }
}

#[test]
fn the_page_follows_its_file() {
    let folder = Scratch::new();
    folder.file("m.mo", MODEL);
    let watching = Watching::start(&folder);
    let first = watching.after("0");
    let page = watching.page();
    assert!(page.starts_with("HTTP/1.1 200") && page.contains("<h1>M</h1>"), "{page:.300}");
    assert!(!page.contains("<aside"), "no messages");
    // A file that other programs write does not count, nor does reading the model.
    folder.file("notes.md", "nothing");
    folder.file("m.mo", &MODEL.replace("-k*x", "-k*q"));
    let second = watching.after(&first);
    let page = watching.page();
    assert!(page.contains("The run failed") && page.contains("error[MO"), "the message");
    assert!(page.contains("<h1>M</h1>"), "the last good page stays");
    folder.file("m.mo", &MODEL.replace("model M", "model N").replace("end M", "end N"));
    watching.after(&second);
    let page = watching.page();
    assert!(page.contains("<h1>N</h1>") && !page.contains("<aside"), "the new page");
}

#[test]
fn the_page_is_for_this_machine_only() {
    let folder = Scratch::new();
    folder.file("m.mo", MODEL);
    let watching = Watching::start(&folder);
    watching.after("0");
    assert!(watching.address.starts_with("127.0.0.1:"), "{}", watching.address);
    assert!(watching.get("/", "example.org").starts_with("HTTP/1.1 403"));
    assert!(watching.get("/../m.mo", &watching.address).starts_with("HTTP/1.1 404"));
}

#[test]
fn wrong_use_is_refused() {
    let folder = Scratch::new();
    let ended = mocc(folder.path(), &["watch", "none.mo"]);
    assert_eq!((ended.status, ended.err.as_str()), (2, "error: there is no file none.mo\n"));
    let ended = mocc(folder.path(), &["watch", "none.mo", "--port", "99999"]);
    assert_eq!(ended.status, 2, "{}", ended.err);
}
