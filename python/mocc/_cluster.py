"""Work on executors, in tasks that any worker may do, and that do not depend on which one does them.

A bundle (a model, a plan, recordings) has a hash. Tasks name it; a worker that does not know it yet says so, and the task
comes again with the bundle, which the worker compiles once. A worker of another version, or whose elementary functions
round differently, is refused. A task whose worker dies is given to another one.
"""

from __future__ import annotations

import hashlib
import os
import pickle
import socket
import threading
import time
from collections import OrderedDict
from collections.abc import Callable, Iterable
from concurrent.futures import FIRST_COMPLETED, BrokenExecutor, Executor, Future, wait
from dataclasses import dataclass, field
from typing import Any

from mocc import _mocc
from mocc._errors import Error, RequestError

VERSION = _mocc.__version__

SECONDS = 1.0
"""Wanted time of a task, s: long compared with what an executor needs to give it to a worker."""
AHEAD = 3
"""Tasks that wait or run, for each worker."""
DEATHS = 8
"""Workers that may die of a task before it is given up."""
KEPT = 4
"""Bundles that a worker keeps."""


@dataclass(frozen=True)
class Bundle:
    """What a worker must know to do tasks."""

    kind: str
    """What it is: a key of `MAKERS`."""
    content: bytes
    """The arguments, pickled."""
    hash: str
    """Of both."""

    @classmethod
    def of(cls, kind: str, *arguments: Any) -> Bundle:
        """The bundle of these arguments."""
        content = pickle.dumps(arguments, protocol=5)
        return cls(kind, content, hashlib.sha256(kind.encode() + content).hexdigest())


@dataclass(eq=False)
class Task:
    """A method of what a bundle makes, with its arguments."""

    method: str
    arguments: tuple[Any, ...]
    deaths: int = 0
    bring: bool = False
    """The bundle comes with it."""


@dataclass
class Team:
    """Workers behind an executor."""

    executor: Executor
    bundle: Bundle
    workers: set[str] = field(default_factory=set)
    """Threads that have done a task."""

    def run(self, more: Callable[[], Task | None], done: Callable[[Task, Any, float], None]) -> None:
        """Does tasks until `more` has none and all are done. `done` gets each with its answer and its time, s.

        Errors: those of a task, and `RequestError` for workers that are refused or die; then all others are cancelled.
        """
        running: dict[Future[Any], Task] = {}
        again: list[Task] = []
        try:
            while True:
                while len(running) < max(4, AHEAD * len(self.workers)):
                    task = again.pop() if again else more()
                    if task is None:
                        break
                    running[self._submit(task)] = task
                if not running:
                    return
                for future in wait(running, timeout=1.0, return_when=FIRST_COMPLETED).done:
                    task = running.pop(future)
                    outcome = self._outcome(task, future)
                    if outcome is None:
                        again.append(task)
                    else:
                        done(task, *outcome)
        finally:
            for future in running:
                future.cancel()

    def map(self, tasks: Iterable[Task]) -> list[Any]:
        """The answers to tasks, in their order. Errors: as for `run`."""
        waiting = list(tasks)
        queue = iter(waiting)
        answers: dict[int, Any] = {}
        self.run(lambda: next(queue, None), lambda task, answer, _: answers.update({id(task): answer}))
        return [answers[id(task)] for task in waiting]

    def _submit(self, task: Task) -> Future[Any]:
        content = (self.bundle.kind, self.bundle.content) if task.bring else None
        arguments = (VERSION, _mocc.arithmetic(), self.bundle.hash, content, task.method, task.arguments)
        try:
            return self.executor.submit(work, *arguments)
        except BrokenExecutor as why:
            raise _broken(why) from why

    def _outcome(self, task: Task, future: Future[Any]) -> tuple[Any, float] | None:
        """The answer and its time; `None` if the task has to be done again."""
        try:
            found = future.result()
        except Error:
            raise
        except (ImportError, AttributeError, pickle.UnpicklingError) as why:
            raise RequestError(
                f"a worker cannot do a task of mocc {VERSION} ({why}); install this version on all workers"
            ) from why
        except Exception as why:
            if isinstance(why, BrokenExecutor):
                raise _broken(why) from why
            if type(why).__name__ != "KilledWorker":
                raise
            # Dask blames a task after some deaths, though another one on the same worker may be the reason.
            task.deaths += 1
            if task.deaths >= DEATHS:
                raise RequestError(
                    f"the workers that did {task.method}{task.arguments!r:.60} died each time; do they have enough memory?"
                ) from why
            return None
        if found is None:
            task.bring = True
            return None
        worker, seconds, answer = found
        self.workers.add(worker)
        return answer, seconds


def _broken(why: Exception) -> RequestError:
    return RequestError(f"a worker has died, and with it the executor: {why}")


_made: OrderedDict[str, Any] = OrderedDict()
_making = threading.Lock()


def work(version: str, arithmetic: int, name: str, bundle: tuple[str, bytes] | None, method: str,
         arguments: tuple[Any, ...]) -> tuple[str, float, Any] | None:
    """Does a task on a worker: the thread, the time, s, and the answer; `None` if the bundle is missing."""
    where = f"the worker {socket.gethostname()}:{os.getpid()}"
    if version != VERSION:
        raise RequestError(f"{where} has mocc {VERSION}, the client has {version}; install one version everywhere")
    if arithmetic != _mocc.arithmetic():
        raise RequestError(
            f"the elementary functions of {where} round differently from the client's, so results would depend on who"
            " computes them; use one kind of machine and system"
        )
    begun = time.perf_counter()
    with _making:
        made = _made.get(name)
        if made is None:
            if bundle is None:
                return None
            made = MAKERS[bundle[0]](*pickle.loads(bundle[1]))
            _made[name] = made
            while len(_made) > KEPT:
                _made.popitem(last=False)
        _made.move_to_end(name)
    # Compiling is no part of the time that says how long tasks should be.
    begun = time.perf_counter() if bundle is not None else begun
    answer = getattr(made, method)(*arguments)
    thread = f"{socket.gethostname()}:{os.getpid()}:{threading.get_ident()}"
    return thread, time.perf_counter() - begun, answer


def _command(arguments: list[str], text: str | None, files: Any) -> _mocc.Sweep:
    try:
        return _mocc.Sweep.command(arguments, text, files)
    except SystemExit:
        raise RequestError("a worker cannot compile the model; its log says why") from None


class Fits:
    """Calibrations from other starts."""

    def __init__(self, study: tuple[Any, ...], folders: Any, files: Any) -> None:
        self._study = study
        self._folders = folders
        self._files = files

    def fit(self, plan: str) -> tuple[float, dict[str, float]] | None:
        """The sum of squares, and the values; `None` if the model cannot be simulated at the start."""
        from mocc._errors import SimulationError

        try:
            path, _, model, table, recordings, folder = self._study
            native = _mocc.calibrate(path, plan, model, table, recordings, folder, False, None, self._folders,
                                     self._files, None, [])
        except SimulationError:
            return None
        residuals = memoryview(native.residuals(b"".join(_eight(x) for x in native.values))).cast("B").cast("d")
        return sum(r * r for r in residuals), dict(zip(native.names, native.values, strict=True))


def _eight(x: float) -> bytes:
    import struct

    return struct.pack("=d", x)


MAKERS: dict[str, Callable[..., Any]] = {
    "sweep": _mocc.Sweep,
    "command": _command,
    "study": _mocc.Worker,
    "fits": Fits,
}


class Spreader:
    """Evaluates recordings on workers; the engine calls it with a problem and tasks."""

    def __init__(self, executor: Executor, bundle: Bundle) -> None:
        self._team = Team(executor, bundle)
        self._seconds = 0.0
        self._is_over = False

    def __call__(self, problem: bytes, tasks: list[bytes]) -> list[bytes | None]:
        """The answers, in the order of the tasks."""
        if self._is_over:
            raise RequestError("the work is cancelled")
        # Short evaluations are not worth a task each.
        parts = len(tasks) if self._seconds > 0.1 * SECONDS else max(1, len(self._team.workers), 2)
        groups = [list(range(k, len(tasks), parts)) for k in range(min(parts, len(tasks)))]
        begun = time.perf_counter()
        found = self._team.map(Task("answers", (problem, [tasks[i] for i in group])) for group in groups)
        self._seconds = (time.perf_counter() - begun) / max(1, len(tasks))
        out: list[bytes | None] = [None] * len(tasks)
        for group, answers in zip(groups, found, strict=True):
            for i, answer in zip(group, answers, strict=True):
                out[i] = answer
        return out

    def close(self) -> None:
        """Nothing is asked any more."""
        self._is_over = True


def lines(native: _mocc.Sweep, team: Team, begin: int, take: Callable[[list[str]], None]) -> None:
    """The lines of a sweep from run `begin` on, computed by a team and passed on in order."""
    count = len(native)
    ready: dict[int, tuple[int, list[str]]] = {}
    state = {"next": begin, "passed": begin, "rate": 0.0}

    def more() -> Task | None:
        start = int(state["next"])
        # Lines that wait for an earlier one are in memory.
        if start >= count or len(ready) > 64:
            return None
        share = -(-(count - start) // max(4, AHEAD * len(team.workers)))
        size = max(1, min(int(state["rate"] * SECONDS) or 4, share))
        state["next"] = min(start + size, count)
        return Task("lines", (start, int(state["next"]), 1, None))

    def done(task: Task, answer: list[str], seconds: float) -> None:
        start, end = task.arguments[:2]
        ready[start] = (end, answer)
        state["rate"] = (end - start) / max(seconds, 1e-6)
        while int(state["passed"]) in ready:
            end, found = ready.pop(int(state["passed"]))
            take(found)
            state["passed"] = end

    # `more` pauses while too much waits; it goes on when `done` has made room.
    while state["passed"] < count:
        team.run(more, done)
