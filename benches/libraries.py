#!/usr/bin/env python3
"""Simulates a sample of a Modelica library and says what stops the models that fail.

    python3 benches/libraries.py DIR/Library --mocc target/release/mocc --lib DIR --lib MSL --count 60

Every model with an `experiment` that names a stop time is a candidate; of the sorted names, every k-th is run, so
that the sample is the same everywhere. Each runs to its own stop time in a process of its own, with a limit of
seconds and of memory. The last lines count the reasons, by the code of the first error.
"""

import argparse
import collections
import json
import pathlib
import re
import resource
import subprocess
import tempfile
import time

# Comments and strings, which may contain anything.
SKIPPED = re.compile(r'//[^\n]*|/\*.*?\*/|"(?:\\.|[^"\\])*"', re.S)
# What opens and closes classes, and where an experiment is set.
MARKS = re.compile(
    r"\b(?P<end>end\s+(?P<ended>[\w']+)\s*;)"
    r"|(?P<partial>\bpartial\s+)?(?<![\w.])(?:(?:operator|impure|pure|expandable)\s+)?"
    r"(?P<kind>model|class|block|package|function|record|connector|type|operator)\s+(?:extends\s+)?(?P<name>[A-Za-z_]\w*)"
    r"(?P<short>\s*(?:\(|=))?"
    r"|(?P<experiment>\bexperiment\s*\([^)]*\bStopTime\s*=)"
)
CONTROL = {"if", "for", "when", "while"}


def models(file):
    """Full names of the models of a file that can be run."""
    text = SKIPPED.sub(" ", file.read_text(encoding="utf-8", errors="replace"))
    within = re.match(r"\W*within\s*([\w.]*)\s*;", text)
    prefix = [within[1]] if within and within[1] else []
    scopes, found = [], []
    for mark in MARKS.finditer(text):
        if mark["end"]:
            names = [name for name, _ in scopes]
            if mark["ended"] not in CONTROL and mark["ended"] in names:
                del scopes[len(names) - 1 - names[::-1].index(mark["ended"]):]
        elif mark["experiment"]:
            if scopes and scopes[-1][1]:
                found.append(".".join(prefix + [name for name, _ in scopes]))
        elif not (mark["short"] and mark["short"].strip() == "="):
            runs = mark["kind"] in ("model", "class", "block") and not mark["partial"]
            scopes.append((mark["name"], runs))
    return found


def sample(folder, count, pattern):
    """Every k-th of the sorted names, `count` of them or all, and the number of candidates."""
    files = [folder] if folder.is_file() else sorted(folder.rglob("*.mo"))
    names = sorted({name for file in files for name in models(file) if re.search(pattern, name)})
    count = min(count, len(names))
    return [names[(2 * i + 1) * len(names) // (2 * count)] for i in range(count)], len(names)


def run(model, args):
    """Simulates a model; its outcome as a row."""
    with tempfile.TemporaryDirectory() as scratch:
        command = [args.mocc, "simulate", "--model", model, "--output", f"{scratch}/r.csv"]
        command += [word for lib in args.lib for word in ("--lib", lib)] + args.option
        begun = time.time()
        used = resource.getrusage(resource.RUSAGE_CHILDREN)
        try:
            done = subprocess.run(command, capture_output=True, text=True, errors="replace", timeout=args.seconds)
            status, said = done.returncode, done.stdout + done.stderr
        except subprocess.TimeoutExpired as expired:
            status, said = -1, (expired.stderr or b"").decode(errors="replace")
        now = resource.getrusage(resource.RUSAGE_CHILDREN)
    error = next((line for line in said.splitlines() if line.startswith("error")), "")
    code = re.match(r"error\[(\w+)\]", error)
    reason = "" if status == 0 else "time" if status == -1 else code[1] if code else f"exit {status}"
    return {
        "model": model,
        "reason": reason,
        "message": "" if status == 0 else error,
        "seconds": round(time.time() - begun, 2),
        "processor": round(now.ru_utime + now.ru_stime - used.ru_utime - used.ru_stime, 2),
        "said": "" if status == 0 else said[:4000],
    }


def main():
    parser = argparse.ArgumentParser(description=__doc__, formatter_class=argparse.RawDescriptionHelpFormatter)
    parser.add_argument("library", type=pathlib.Path, nargs="*", help="folder or file of the library")
    parser.add_argument("--mocc", required=True, help="the program")
    parser.add_argument("--lib", action="append", default=[], help="folder that contains libraries")
    parser.add_argument("--count", type=int, default=60, help="number of models")
    parser.add_argument("--seconds", type=float, default=60, help="limit of each run")
    parser.add_argument("--only", default="", help="regular expression for names of models")
    parser.add_argument("--again", type=pathlib.Path, help="run the models that failed in this file of rows")
    parser.add_argument("--rows", type=pathlib.Path, help="where to write the rows, as JSON")
    parser.add_argument("--list", action="store_true", help="print the names and run nothing")
    parser.add_argument("--option", action="append", default=[], help="a further argument of mocc")
    args = parser.parse_args()
    if args.again:
        chosen = [row["model"] for row in json.loads(args.again.read_text()) if row["reason"]]
        total = len(chosen)
    else:
        chosen, total = [], 0
        for library in args.library:
            names, of = sample(library, args.count, args.only)
            chosen += names
            total += of
    if args.list:
        print("\n".join(chosen))
        return
    rows = []
    for model in chosen:
        rows.append(run(model, args))
        row = rows[-1]
        print(f"{row['reason'] or 'ran':8} {row['seconds']:7.2f} s  {model}  {row['message'][:160]}", flush=True)
        if args.rows:
            args.rows.write_text(json.dumps(rows, indent=1))
    reasons = collections.Counter(row["reason"] for row in rows if row["reason"])
    for reason, number in reasons.most_common():
        print(f"{number:4} {reason}")
    print(f"{len(rows) - reasons.total()} of {len(rows)} run, of {total} candidates")


if __name__ == "__main__":
    main()
