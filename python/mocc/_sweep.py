"""Many runs of one model."""

from __future__ import annotations

import pickle
from collections.abc import Iterable, Mapping
from concurrent.futures import Executor
from functools import lru_cache
from typing import TYPE_CHECKING, Any, Literal

import numpy as np

from mocc import _mocc
from mocc._errors import RequestError
from mocc._model import METHODS, Model, _number, _one_of, _setting

if TYPE_CHECKING:
    import pandas

TASKS = 64
"""Number of tasks that an executor gets."""


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
) -> pandas.DataFrame:
    """Runs a model with all combinations of values, or with a Latin hypercube sample of them.

    `vary` maps parameters, or start values as `x.start`, to lists of values, in SI units; with `sample`, the number of
    runs, also to pairs `(lowest, highest)`. `measures` maps names to expressions such as `"when(s > 0.95*s_max)"`.
    `stop`, s, `interval`, s, `tolerance` and `method` are those of `Model.simulate`.
    The DataFrame has a row for each run, in order, with the values, the measures in SI units (NaN if something did not
    happen), and `status`, `error`, `steps` and `events`; `df.attrs["units"]` maps columns to units. A run that fails has a
    row too. The table does not depend on `jobs`, the number of threads (by default all cores), or on `executor`, any
    `concurrent.futures.Executor`, which then does the work in tasks of its own.

    Errors: `RequestError` for wrong arguments and unknown parameters, `ModelError` if the model is wrong,
    `ImportError` without pandas. Ctrl-C raises `KeyboardInterrupt`.
    """
    import pandas

    _one_of("method", method, METHODS)
    for name, value in (("stop", stop), ("interval", interval), ("tolerance", tolerance)):
        if value is not None:
            _number(name, value)
    if not vary:
        raise RequestError("`vary` is empty; map parameters to lists of values")
    if sample is not None and sample < 1:
        raise RequestError(f"`sample` is {sample}; it is the number of runs")
    formulas = [f"{name} = {text}" for name, text in (measures or {}).items()]
    points = [(name, _points(name, values, sample)) for name, values in vary.items()]
    drawn = None if sample is None else (sample, seed)
    arguments = (*model._source, points, drawn, formulas, (stop, interval, tolerance, method))
    native = _mocc.Sweep(*arguments)
    rows = native.rows(0, len(native), jobs) if executor is None else _spread(native, arguments, executor)
    columns = {}
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


def _points(name: str, values: Any, sample: int | None) -> tuple[float, float] | list[float | str]:
    if isinstance(values, tuple):
        if sample is None or len(values) != 2:
            raise RequestError(f"`{name}` has a tuple; give a list of values, or `(lowest, highest)` with `sample`")
        return _number(name, values[0]), _number(name, values[1])
    if isinstance(values, (str, bool, int, float)):
        values = [values]
    if not isinstance(values, Iterable):
        raise RequestError(f"`{name}` varies over a {type(values).__name__}; give a list of values")
    found = [_setting(name, value) for value in np.asarray(values).tolist()]
    if not found:
        raise RequestError(f"`{name}` varies over no values")
    return found


def _spread(native: _mocc.Sweep, arguments: tuple[Any, ...], executor: Executor) -> list[tuple[Any, ...]]:
    count = len(native)
    bundle = pickle.dumps(arguments)
    size = max(1, -(-count // TASKS))
    tasks = [executor.submit(_task, bundle, k, min(k + size, count)) for k in range(0, count, size)]
    try:
        return [row for task in tasks for row in task.result()]
    finally:
        for task in tasks:
            task.cancel()


def _task(bundle: bytes, begin: int, end: int) -> list[tuple[Any, ...]]:
    return _compiled(bundle).rows(begin, end, 1)


@lru_cache(maxsize=4)
def _compiled(bundle: bytes) -> _mocc.Sweep:
    """A worker compiles a model once."""
    return _mocc.Sweep(*pickle.loads(bundle))


