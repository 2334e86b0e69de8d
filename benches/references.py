#!/usr/bin/env python3
"""Compares trajectories with the published ones of a library, as the Modelica Association ships them.

    python3 benches/references.py REFERENCES/ModelicaTest --mocc target/release/mocc --lib MSL --rows rows.json

REFERENCES is a checkout of modelica/MAP-LIB_ReferenceResults, of the same version as the library. Every folder with
a `comparisonSignals.txt` is a model, whose trajectories lie beside it. Each model runs in a process of its own, over
the time of its reference, with its own tolerance. A signal agrees if at least 99 % of its samples lie in a tube
around the reference: 0.2 % of the duration wide in time, and 0.2 % of the range of the signal in value.
"""

import argparse
import bisect
import collections
import concurrent.futures
import csv
import json
import pathlib
import re
import subprocess
import tempfile
import time

VALUES = {"true": 1.0, "false": 0.0}
# Share of the duration, and of the range of a signal, by which a sample may differ.
WIDTH = 2e-3
# Share of the samples that must lie in the tube.
INSIDE = 0.99
LIBRARIES = ("Modelica", "ModelicaTest")


def table(path):
    """Columns of a file of comma-separated values, by name without spaces."""
    with open(path, newline="", encoding="utf-8", errors="replace") as file:
        rows = csv.reader(file)
        names = [{"Time": "time"}.get(name, name.replace(" ", "")) for name in next(rows)]
        columns = [[] for _ in names]
        for row in rows:
            for column, text in zip(columns, row):
                number = VALUES.get(text.strip().lower())
                column.append(float(text) if number is None else number)
    return dict(zip(names, columns))


def share_inside(reference_times, reference, times, values, duration):
    """Share of the samples that lie in the tube around a reference."""
    largest = max(map(abs, reference))
    width = WIDTH * max(max(reference) - min(reference), 1e-3 * largest, 1e-9)
    outside = 0
    for at, value in zip(times, values):
        first = max(0, bisect.bisect_left(reference_times, at - WIDTH * duration) - 1)
        last = bisect.bisect_right(reference_times, at + WIDTH * duration) + 1
        near = reference[first:last]
        outside += not near or not min(near) - width <= value <= max(near) + width
    return 1 - outside / max(1, len(times))


def compared(reference, names, found):
    """The signal that agrees worst, and the share of it in the tube; of a missing one none."""
    times = reference["time"]
    worst, worst_name = 1.0, ""
    for name in names:
        if name == "time" or name not in reference:
            continue
        if name not in found:
            if max(reference[name]) == min(reference[name]):
                continue  # A parameter, which the result does not repeat.
            return None, name
        share = share_inside(times, reference[name], found["time"], found[name], times[-1] - times[0])
        if share < worst:
            worst, worst_name = share, name
    return worst, worst_name


def model_of(folder):
    """Full name of the model whose reference a folder holds: the library is the outermost of its folders."""
    first = next(i for i, part in enumerate(folder.parts) if part in LIBRARIES)
    return ".".join(folder.parts[first:])


def run(signals, args):
    """Simulates the model of a reference; its outcome as a row."""
    folder = signals.parent
    model = model_of(folder)
    row = {"model": model, "reason": "", "message": "", "signal": "", "inside": None, "seconds": 0.0}
    file, creation = folder / f"{folder.name}.csv", folder / "creation.txt"
    if not file.exists() or not creation.exists():
        return row | {"reason": "no file", "message": f"{file.name} or {creation.name}"}
    tolerance = re.search(r"^Tolerance=([\d.eE+-]+)", creation.read_text(errors="replace"), re.M)
    reference = table(file)
    start, stop = reference["time"][0], reference["time"][-1]
    with tempfile.TemporaryDirectory() as scratch:
        command = [args.mocc, "simulate", "--model", model, "--output", f"{scratch}/r.csv"]
        command += ["--stop", repr(stop), "--interval", repr((stop - start) / 1000)]
        command += ["--tolerance", tolerance[1] if tolerance else "1e-6"]
        command += [word for lib in args.lib for word in ("--lib", lib)] + args.option
        begun = time.time()
        try:
            done = subprocess.run(command, capture_output=True, text=True, errors="replace", timeout=args.seconds)
        except subprocess.TimeoutExpired:
            return row | {"reason": "time", "seconds": args.seconds}
        row["seconds"] = round(time.time() - begun, 2)
        if done.returncode != 0:
            said = done.stdout + done.stderr
            error = next((line for line in said.splitlines() if line.startswith("error")), "")
            code = re.match(r"error\[(\w+)\]", error)
            return row | {"reason": code[1] if code else f"exit {done.returncode}", "message": error}
        found = table(f"{scratch}/r.csv")
    names = [line.strip().replace(" ", "") for line in signals.read_text().splitlines() if line.strip()]
    row["inside"], row["signal"] = compared(reference, names, found)
    if row["inside"] is None:
        return row | {"reason": "missing", "message": f"{row['signal']} is not in the result"}
    if row["inside"] < INSIDE:
        row |= {"reason": "differs", "message": f"{100 * row['inside']:.1f} % of {row['signal']} inside"}
    return row


def main():
    parser = argparse.ArgumentParser(description=__doc__, formatter_class=argparse.RawDescriptionHelpFormatter)
    parser.add_argument("references", type=pathlib.Path, nargs="+", help="folder of references")
    parser.add_argument("--mocc", required=True, help="the program")
    parser.add_argument("--lib", action="append", default=[], help="folder that contains libraries")
    parser.add_argument("--seconds", type=float, default=60, help="limit of each run")
    parser.add_argument("--jobs", type=int, default=2, help="number of runs at a time")
    parser.add_argument("--only", default="", help="regular expression for names of models")
    parser.add_argument("--again", type=pathlib.Path, help="run the models that failed in this file of rows")
    parser.add_argument("--rows", type=pathlib.Path, help="where to write the rows, as JSON")
    parser.add_argument("--option", action="append", default=[], help="a further argument of mocc")
    args = parser.parse_args()
    signals = sorted(file for folder in args.references for file in folder.rglob("comparisonSignals.txt"))
    if args.again:
        failed = {row["model"] for row in json.loads(args.again.read_text()) if row["reason"]}
        signals = [file for file in signals if model_of(file.parent) in failed]
    signals = [file for file in signals if re.search(args.only, model_of(file.parent))]
    rows = []
    with concurrent.futures.ThreadPoolExecutor(args.jobs) as pool:
        for row in pool.map(lambda file: run(file, args), signals):
            rows.append(row)
            print(f"{row['reason'] or 'agrees':8} {row['seconds']:7.2f} s  {row['model']}  {row['message'][:160]}", flush=True)
            if args.rows:
                args.rows.write_text(json.dumps(rows, indent=1))
    reasons = collections.Counter(row["reason"] for row in rows if row["reason"])
    for reason, number in reasons.most_common():
        print(f"{number:4} {reason}")
    print(f"{len(rows) - reasons.total()} of {len(rows)} agree")


if __name__ == "__main__":
    main()
