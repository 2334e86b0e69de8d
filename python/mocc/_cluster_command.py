"""`mocc sweep --cluster ADDRESS`: the command's sweep on the workers of a Dask cluster."""

from __future__ import annotations

import sys
import time
from pathlib import Path

from mocc import _mocc
from mocc._bundle import beside, check_travels, packed
from mocc._cluster import Bundle, Team, lines
from mocc._errors import Error
from mocc._progress import Bar

USAGE = 2
INTERRUPTED = 130


def sweep(arguments: list[str]) -> int:
    """Runs the command line; returns its exit status."""
    file, folders, address = _mocc.sweep_files(arguments)
    try:
        from distributed import Client
    except ImportError:
        return _refuse("`--cluster` needs Dask: `pip install \"mocc[cluster]\"`")
    try:
        text = Path(file).read_text(encoding="utf-8") if file is not None else None
    except (OSError, UnicodeDecodeError):
        text = None  # The compiler says why.
    try:
        check_travels(file, text)
        files = [*packed(folders), *beside(file)]
        native = _mocc.Sweep.command(arguments, text, files)
        if native.keeps_trajectories():
            return _refuse("trajectories need a folder that all workers share; use `--shard` in place of `--cluster`")
        journal = native.journal(None)
        before = len(journal.lines())
        try:
            client = Client(address, timeout="10s")  # type: ignore[no-untyped-call,unused-ignore]
        except (OSError, TimeoutError, ValueError) as why:
            return _refuse(f"no cluster answers at {address}: {why}")
        with client, Bar(len(native), "run") as bar:
            return _spread(native, Bundle.of("command", arguments, text, files), client, journal, before, bar)
    except Error as why:
        return _refuse(why.message)


def _spread(native: _mocc.Sweep, bundle: Bundle, client: object, journal: _mocc.Journal, before: int, bar: Bar) -> int:
    count, reached = len(native), before
    begun = time.perf_counter()

    def take(found: list[str]) -> None:
        nonlocal reached
        journal.push(found)
        reached += len(found)
        bar.reach(reached)

    team = Team(client.get_executor(), bundle)  # type: ignore[attr-defined]
    try:
        lines(native, team, before, take)
    except KeyboardInterrupt:
        print(f"interrupted after {reached} of {count} runs; the same command resumes from there", file=sys.stderr)
        return INTERRUPTED
    workers = max(1, len(team.workers))
    how = f"on {workers} worker{'s' if workers > 1 else ''} of a cluster"
    return native.finish(journal, count - before, time.perf_counter() - begun, how)


def _refuse(why: str) -> int:
    print(f"error: {why}", file=sys.stderr)
    return USAGE
