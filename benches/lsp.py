"""Measures how long `mocc lsp` takes to answer: `python benches/lsp.py target/release/mocc [FOLDER]`.

For the valve of the examples, and for EngineV6 of the Modelica Standard Library 4.1.0 if its folder is given. Prints the
median of several requests of each kind, from the request to the answer, in ms.
"""

import json
import os
import pathlib
import statistics
import subprocess
import sys
import time

ROOT = pathlib.Path(__file__).resolve().parents[1]
ENGINE = "Modelica/Mechanics/MultiBody/Examples/Loops/EngineV6.mo"
REPETITIONS = 9


class Client:
    """The protocol over the standard streams of the server."""

    def __init__(self, program, libraries):
        environment = {**os.environ, **({"MODELICAPATH": libraries} if libraries else {})}
        pipe = subprocess.PIPE
        self.server = subprocess.Popen([program, "lsp"], stdin=pipe, stdout=pipe, env=environment)
        self.count = 0
        self.request("initialize", {"capabilities": {}})

    def send(self, **message):
        body = json.dumps({"jsonrpc": "2.0", **message}).encode()
        self.server.stdin.write(b"Content-Length: %d\r\n\r\n" % len(body) + body)
        self.server.stdin.flush()

    def receive(self):
        length = 0
        while (line := self.server.stdout.readline().strip()):
            key, value = line.split(b":")
            if key.lower() == b"content-length":
                length = int(value)
        return json.loads(self.server.stdout.read(length))

    def request(self, method, parameters):
        self.count += 1
        self.send(id=self.count, method=method, params=parameters)
        while (message := self.receive()).get("id") != self.count:
            pass
        assert "error" not in message, message
        return message["result"]

    def wait_for_diagnostics(self):
        while self.receive().get("method") != "textDocument/publishDiagnostics":
            pass

    def close(self):
        self.request("shutdown", None)
        self.send(method="exit")
        self.server.wait()


def milliseconds(work):
    begun = time.perf_counter()
    work()
    return 1e3 * (time.perf_counter() - begun)


def place(text, words, offset):
    before = text[: text.index(words) + offset]
    return {"line": before.count("\n"), "character": len(before) - before.rfind("\n") - 1}


def measure(program, libraries, path, words, offset):
    client = Client(program, libraries)
    uri, text = path.as_uri(), path.read_text()
    document = {"uri": uri}
    item = {"uri": uri, "languageId": "modelica", "version": 1, "text": text}
    client.send(method="textDocument/didOpen", params={"textDocument": item})
    client.wait_for_diagnostics()
    where = {"textDocument": document, "position": place(text, words, offset)}
    end = {"line": text.count("\n") + 1, "character": 0}
    whole = {"textDocument": document, "range": {"start": {"line": 0, "character": 0}, "end": end}}
    version = 1

    def edited():
        nonlocal version
        version += 1
        changes = [{"text": text + "\n" * (version % 2)}]
        identifier = {"uri": uri, "version": version}
        client.send(
            method="textDocument/didChange",
            params={"textDocument": identifier, "contentChanges": changes},
        )
        client.wait_for_diagnostics()

    context = {**where, "context": {"includeDeclaration": True}}
    kinds = {
        "diagnostics after a change": edited,
        "inlay hints of the whole text": lambda: client.request("textDocument/inlayHint", whole),
        "hover, with the value": lambda: client.request("textDocument/hover", where),
        "definition": lambda: client.request("textDocument/definition", where),
        "references": lambda: client.request("textDocument/references", context),
        "completion": lambda: client.request("textDocument/completion", where),
        "lenses": lambda: client.request("textDocument/codeLens", {"textDocument": document}),
    }
    out = {}
    for kind, work in kinds.items():
        times = [milliseconds(work) for _ in range(REPETITIONS)]
        out[kind] = (statistics.median(times), max(times))
    client.close()
    return out


def main():
    program = sys.argv[1]
    cases = [(ROOT / "examples" / "valve52.mol", None, "s_max          = 3.5e-3", 1)]
    if len(sys.argv) > 2:
        folder = pathlib.Path(sys.argv[2]).resolve()
        cases.append((folder / ENGINE, str(folder), "cylinder1(", 1))
    for path, libraries, words, offset in cases:
        print(f"{path.name}: median, and the longest of {REPETITIONS}, ms")
        for kind, (median, longest) in measure(program, libraries, path, words, offset).items():
            print(f"  {kind}: {median:.1f}, {longest:.1f}")


if __name__ == "__main__":
    main()
