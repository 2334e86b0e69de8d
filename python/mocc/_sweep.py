"""Many runs of one model."""

from __future__ import annotations

from collections.abc import Callable, Iterable, Mapping
from concurrent.futures import Executor
from contextlib import nullcontext
from os import PathLike, fspath
from typing import TYPE_CHECKING, Any, Literal

import numpy as np

from mocc import _mocc
from mocc._bundle import beside, check_executor, check_travels, packed
from mocc._cluster import Bundle, Team, lines
from mocc._errors import RequestError
from mocc._model import METHODS, Model, _number, _one_of, _setting
from mocc._progress import Bar

if TYPE_CHECKING:
    import pandas


def sweep(
    model: Model,
    vary: Mapping[str, Any],
    measures: Mapping[str, str] | None = None,
    *,
    sample: int | None = None,
    seed: int = 1,
    stop: float | None = None,
    interval: float | None = None,
    tolerance: float | None = None,
    method: Literal["auto", "radau", "bdf", "dopri"] = "auto",
    jobs: int | None = None,
    executor: Executor | None = None,
    journal: str | PathLike[str] | None = None,
    progress: bool | Callable[[int, int], object] = False,
) -> pandas.DataFrame:
    """Runs a model with all combinations of values, or with a Latin hypercube sample of them.

    `vary` maps parameters, or start values as `x.start`, to lists of values, in SI units; with `sample`, the number of
    runs, also to pairs `(lowest, highest)`. `measures` maps names to expressions such as `"when(s > 0.95*s_max)"`.
    `stop`, s, `interval`, s, `tolerance` and `method` are those of `Model.simulate`.
    The DataFrame has a row for each run, in order, with the values, the measures in SI units (NaN if something did not
    happen), and `status`, `error`, `steps` and `events`; `df.attrs["units"]` maps columns to units. A run that fails has a
    row too. The table does not depend on `jobs`, the number of threads (by default all cores), or on `executor`, any
    `concurrent.futures.Executor`, whose workers then do the runs.
    `journal` is a file that holds the rows so far: the same call resumes from there, and the last row removes it.
    `progress=True` shows a bar where tqdm is installed; a function is called with the number of runs done and of all.

    Errors: `RequestError` for wrong arguments and unknown parameters, for workers of another version, and for a journal of
    another sweep; `ModelError` if the model is wrong; `ImportError` without pandas. Ctrl-C raises `KeyboardInterrupt`.
    """
    import pandas

    _one_of("method", method, METHODS)
    for name, value in (("stop", stop), ("interval", interval), ("tolerance", tolerance)):
        if value is not None:
            _number(name, value)
    if not isinstance(model, Model):
        raise RequestError(f"`model` is a {type(model).__name__}; give a model that `mocc.compile` has made")
    if not isinstance(vary, Mapping):
        raise RequestError(f"`vary` is a {type(vary).__name__}; map names of parameters to lists of values")
    if not isinstance(measures or {}, Mapping):
        raise RequestError(f"`measures` is a {type(measures).__name__}; map names to expressions, such as"
                           ' {"t": "when(x > 1)"}')
    check_executor(executor)
    if not vary:
        raise RequestError("`vary` is empty; map parameters to lists of values")
    if sample is not None and sample < 1:
        raise RequestError(f"`sample` is {sample}; it is the number of runs")
    formulas = [f"{name} = {text}" for name, text in (measures or {}).items()]
    points = [(name, _points(name, values, sample)) for name, values in vary.items()]
    drawn = None if sample is None else (sample, seed)
    files = [] if executor is None else [*packed(model._source[4]), *beside(model._source[0])]
    arguments = (*model._source, points, drawn, formulas, (stop, interval, tolerance, method), files)
    native = _mocc.Sweep(*arguments)
    team = None
    if executor is not None:
        check_travels(model._source[0], model._source[1])
        team = Team(executor, Bundle.of("sweep", *arguments))
    rows = _rows(native, jobs, team, journal, progress)
    columns: dict[str, Any] = {}
    fields = native.fields()
    for (name, kind, _, _), values in zip(fields, zip(*rows, strict=True), strict=True):
        if kind == "Real":
            columns[name] = np.array([np.nan if v is None else v for v in values], dtype=np.float64)
        elif kind == "Integer":
            columns[name] = np.array(values, dtype=np.int64)
        else:
            columns[name] = np.array(values, dtype=object)
    frame = pandas.DataFrame(columns)
    frame.attrs = {"model": model.name, "units": {name: unit for name, _, unit, _ in fields}}
    return frame


def _rows(native: _mocc.Sweep, jobs: int | None, team: Team | None, journal: str | PathLike[str] | None,
          progress: bool | Callable[[int, int], object]) -> list[tuple[Any, ...]]:
    count = len(native)
    kept = None if journal is None else native.journal(fspath(journal))
    found = [] if kept is None else kept.lines()
    before = len(found)
    bar = Bar(count, "run") if progress is True else None
    tell = progress if callable(progress) else None

    def take(more: list[str]) -> None:
        found.extend(more)
        if kept is not None:
            kept.push(more)
        if bar is not None:
            bar.reach(len(found))
        if tell is not None:
            tell(len(found), count)

    with bar or nullcontext():
        try:
            if team is not None:
                lines(native, team, before, take)
            elif kept is None and bar is None and tell is None:
                found = native.lines(before, count, jobs, None)
            else:
                native.lines(before, count, jobs, lambda line: take([line]))
        except BaseException:
            # The journal survives whatever ends this.
            if kept is not None:
                kept.close()
            raise
    if kept is not None:
        kept.remove()
    return [native.row(line) for line in found]


def _points(name: str, values: Any, sample: int | None) -> tuple[float, float] | list[float | str]:
    if isinstance(values, tuple):
        if sample is None or len(values) != 2:
            raise RequestError(f"`{name}` has a tuple; give a list of values, or `(lowest, highest)` with `sample`")
        return _number(name, values[0]), _number(name, values[1])
    if isinstance(values, (str, bool, int, float, np.generic)):
        values = [values]
    if not isinstance(values, Iterable):
        raise RequestError(f"`{name}` varies over a {type(values).__name__}; give a list of values")
    found = [_setting(name, value) for value in np.asarray(values).tolist()]
    if not found:
        raise RequestError(f"`{name}` varies over no values")
    return found
