"""Calibration and diagnosis."""

from __future__ import annotations

import html
import json
import math
import tomllib
import warnings
from collections.abc import Callable, Iterator, Mapping, Sequence
from concurrent.futures import Executor
from contextlib import contextmanager
from dataclasses import dataclass
from os import PathLike, fspath
from typing import Any

import numpy as np
from numpy.typing import NDArray

from mocc import _mocc
from mocc._bundle import Folders, beside, check_executor, check_travels
from mocc._bundle import packed as packed_folders
from mocc._cluster import Bundle, Fits, Spreader, Task, Team
from mocc._errors import ModelWarning, RequestError
from mocc._frames import Numbers, columns_of, finite, in_seconds, packed, readings, view
from mocc._model import Model, _number, source_of
from mocc._progress import Bar, Progress


Frame = tuple[str, list[tuple[str, bytes]]]
Strings = tuple[list[str], list[list[str]]]
Files = list[tuple[str, bytes]]
"""Files by their paths."""
Study = tuple[str, str | None, str | None, Strings | None, list[Frame], str | None]


class Report:
    """A page of its own. Notebooks show it in a frame; `save` writes it."""

    def __init__(self, page: str) -> None:
        self.html = page
        """The page."""

    def save(self, path: str | PathLike[str]) -> None:
        """Writes the page to a file. Errors: `OSError`."""
        with open(path, "w", encoding="utf-8") as file:
            file.write(self.html)

    def _repr_html_(self) -> str:
        page = html.escape(self.html, quote=True)
        return f'<iframe srcdoc="{page}" style="width:100%;height:40em;border:1px solid #ccc"></iframe>'


class Calibration:
    """A calibrated model, made by `calibrate`."""

    def __init__(self, native: _mocc.Calibration) -> None:
        self._native = native
        self.names: list[str] = native.names
        """Names of the fitted parameters, in the order of `covariance`, `residuals` and `jacobian`; one that is free for
        each recording comes once for each, as `NAME of RECORDING`."""
        self.values: dict[str, float] = dict(zip(native.names, native.values, strict=True))
        """The fitted values, in the units of the model."""
        self.units: dict[str, str] = dict(zip(native.names, native.units, strict=True))
        """Their units."""
        self.bounds: dict[str, tuple[float, float]] = dict(zip(native.names, native.bounds, strict=True))
        """The bounds of the search."""
        n = len(self.names)
        self.covariance: NDArray[np.float64] = np.array(native.covariance, dtype=float).reshape(n, n)
        """Covariance of the fitted values, shape `(n, n)`, in their units; zero for those at a bound."""
        self.result: dict[str, Any] = json.loads(native.json)
        """Everything else, as in `calibration.json`: intervals, quality by signal and recording, repairs of the data."""
        self.model: str = native.model
        """The source of the model, followed by one that extends it with the fitted values."""
        self.report = Report(native.page)
        """The page."""

    @property
    def errors(self) -> dict[str, float]:
        """Standard errors of the fitted values, in their units; infinite where the data do not determine them."""
        listed = {p["name"]: p["standard_error"] for p in self.result["parameters"]}
        spread = np.sqrt(np.diag(self.covariance))
        return {
            name: float(spread[k]) if name not in listed
            else math.inf if listed[name] is None else listed[name]
            for k, name in enumerate(self.names)
        }

    @property
    def converged(self) -> bool:
        """Nothing was left to gain."""
        return bool(self.result["converged"])

    def residuals(self, theta: Any = None) -> Numbers:
        """Model minus measurement, in units of the noise, for all training recordings, shape `(m,)`.

        The order is recording by recording, instant by instant, signal by signal; values that were not measured have
        none. `theta` holds values in the order of `names`, or maps names to values; without it, and for names that it
        does not hold, the fitted ones.
        Errors: `RequestError` for a wrong `theta`, `SimulationError` if a recording cannot be simulated there.
        """
        return self._asked(self._native.residuals, theta)

    def jacobian(self, theta: Any = None) -> NDArray[np.float64]:
        """Derivatives of `residuals` by the parameters, shape `(m, n)`, in 1 by the unit of the parameter; exact, also
        across events, where the engine can differentiate the run.

        Errors: as for `residuals`.
        """
        return self._asked(self._native.jacobian, theta).reshape(-1, len(self.names))

    def _asked(self, question: Callable[[bytes], _mocc.Values], theta: Any) -> Numbers:
        values = question(packed(self._theta(theta)))
        # A copy, since optimizers write into the arrays that they get.
        return view(values).copy()

    def _theta(self, theta: Any) -> Numbers:
        if theta is None:
            theta = {}
        if isinstance(theta, Mapping):
            unknown = [name for name in theta if name not in self.values]
            if unknown:
                raise RequestError(f"`{unknown[0]}` was not fitted; fitted are {', '.join(self.names)}")
            theta = [theta.get(name, value) for name, value in self.values.items()]
        found = finite(theta, "`theta`")
        if len(found) != len(self.names):
            raise RequestError(f"`theta` has {len(found)} values for {len(self.names)} parameters")
        return found

    def __repr__(self) -> str:
        ended = "converged" if self.converged else "not converged"
        return f"<mocc.Calibration of {self.result['model']}: {len(self.names)} parameters, {ended}>"

    def _repr_html_(self) -> str:
        rows = "".join(
            f"<tr><td><code>{html.escape(name)}</code></td><td>{self.values[name]:.6g}</td>"
            f"<td>± {error:.2g}</td><td>{html.escape(self.units[name])}</td></tr>"
            for name, error in self.errors.items()
        )
        return f"<p><code>{html.escape(repr(self)[1:-1])}</code></p><table>{rows}</table>"


@dataclass(frozen=True)
class Estimate:
    """A fitted parameter of an effect."""

    value: float
    """Its value."""
    error: float
    """Its standard error; infinite if the data do not determine it."""
    unit: str
    """The unit of both; empty if there is none."""


@dataclass(frozen=True)
class Effect:
    """An effect that the model lacks."""

    component: str
    """Name of its class, or `parameter` if a parameter of the model varies."""
    at: list[str]
    """The connectors or parameters where it acts."""
    over: list[str]
    """The variables that its law depends on."""
    law: str
    """Its law."""
    parameters: dict[str, Estimate]
    """Its fitted parameters."""
    explains: str
    """What it does, as a sentence."""


class Diagnosis:
    """The result of `diagnose`."""

    def __init__(self, found: tuple[str, str, str, tuple[str, str] | None, list[str]]) -> None:
        text, page, self.summary, amended, _ = found
        self.result: dict[str, Any] = json.loads(text)
        """Everything, as in `diagnosis.json`."""
        self.verdict: str = self.result["verdict"]
        """`complete` if the model lacks nothing, `effect_found`, or `unexplained`."""
        self.effects: list[Effect] = [_effect(e) for e in self.result["effects"]]
        """The effects that were found."""
        self.amended: str | None = amended[1] if amended else None
        """The source of the model, followed by one with the effects; `None` if none was found."""
        self.report = Report(page)
        """The page with the evidence."""

    def __repr__(self) -> str:
        names = ", ".join(e.component for e in self.effects)
        return f"<mocc.Diagnosis: {self.verdict}{': ' + names if names else ''}>"

    def __str__(self) -> str:
        return self.summary

    def _repr_html_(self) -> str:
        return f"<pre>{html.escape(self.summary)}</pre>{self.report._repr_html_()}"


def calibrate(
    plan: str | PathLike[str] | Mapping[str, Any] | None = None,
    data: Mapping[str, Any] | None = None,
    *,
    table: Any | None = None,
    folder: str | PathLike[str] | None = None,
    profiles: bool = True,
    starts: int | Mapping[str, Any] = 1,
    seed: int = 1,
    executor: Executor | None = None,
    progress: Progress | bool | None = None,
    allow_fmu: str | PathLike[str] | Sequence[str | PathLike[str]] = (),
    **keys: Any,
) -> Calibration:
    """Fits the free parameters of a plan to recordings.

    `plan` is a plan file, or a mapping with the keys of one, which may also be given by name: `model`, `time`, `signals`,
    `free`, `fixed`, `inputs`, `starts`, `conditions`, `recordings`, `window`, `skip`, `every`. `model` is a file, a text,
    or a `Model`.
    `data` maps names to tables in memory: recordings that take the place of files of these names. Without `recordings`
    and `table`, each of them is a training recording. NaN marks values that were not measured, and so does a mask; times may
    be durations or dates. `table` takes the place of
    the plan's table of recordings, and `folder` is that of files.
    `profiles=False` takes confidence intervals from standard errors alone, which is faster.
    With a number as `starts`, so many fits begin at different points: the first where the plan starts, the others in a
    Latin hypercube over the parameters that have a `min` and a `max`, which `seed` decides; the best one counts.
    `executor` is any `concurrent.futures.Executor`, whose workers do the fits from these starts, and the runs of the
    recordings and their derivatives; the result is the same.
    `progress=True` shows a bar where tqdm is installed; a function is called with lines of text.
    `allow_fmu` names FMUs, or folders with FMUs, that a plan file or a model may run: foreign code. One that `model` names
    here is allowed.

    Errors: `RequestError` if the plan or a recording is wrong, such as a missing column or a wrong unit; `ModelError`;
    `SimulationError` if the model cannot be simulated at the start. Ctrl-C raises `KeyboardInterrupt`.
    """
    check_executor(executor)
    if isinstance(starts, Mapping):
        # The entry of the plan, which has the same name.
        keys, starts = {**keys, "starts": starts}, 1
    if starts < 1:
        raise RequestError(f"`starts` is {starts}; it is the number of fits")
    fmus = _allowed(allow_fmu, plan, keys)
    study = _study(plan, data, table, folder, keys)
    with _told(progress) as tell:
        if starts > 1:
            study = _from_best_start(study, starts, seed, executor, tell)
        with _elsewhere(study, None, executor) as spread:
            native = _mocc.calibrate(*study, profiles=profiles, progress=tell, folders=[], files=[], spread=spread,
                                     allow_fmu=fmus)
    _warn(native.warnings)
    return Calibration(native)


def diagnose(
    plan: str | PathLike[str] | Mapping[str, Any] | None = None,
    data: Mapping[str, Any] | None = None,
    *,
    table: Any | None = None,
    folder: str | PathLike[str] | None = None,
    effects: str | PathLike[str] | None = None,
    only: str | Sequence[str] = (),
    time_limit: float | None = None,
    executor: Executor | None = None,
    progress: Progress | bool | None = None,
    allow_fmu: str | PathLike[str] | Sequence[str | PathLike[str]] = (),
    **keys: Any,
) -> Diagnosis:
    """Finds the physical effects that a model lacks, from recordings.

    `effects` is a folder with further effects, in addition to the shipped ones. `only` names the effects among which to
    search, `parameter` for parameters that vary; all of them if it is empty. `time_limit`, s, ends the search with the
    best verdict so far. The other arguments, and the errors, are those of `calibrate`.
    """
    check_executor(executor)
    if time_limit is not None and _number("time_limit", time_limit) < 0:
        raise RequestError(f"`time_limit` is {time_limit} s, which is negative")
    fmus = _allowed(allow_fmu, plan, keys)
    study = _study(plan, data, table, folder, keys)
    own = None if effects is None else fspath(effects)
    with _told(progress) as tell, _elsewhere(study, own, executor) as spread:
        found = _mocc.diagnose(*study, effects=own, only=[only] if isinstance(only, str) else list(only),
                               time_limit=time_limit, progress=tell, spread=spread, allow_fmu=fmus)
    _warn(found[4])
    return Diagnosis(found)


@contextmanager
def _told(progress: Progress | bool | None) -> Iterator[Progress | None]:
    """The function that is told how far the work has come."""
    if progress is True:
        with Bar(None, "") as bar:
            yield bar.line
    else:
        yield progress or None


@contextmanager
def _elsewhere(study: Study, effects: str | None, executor: Executor | None) -> Iterator[Spreader | None]:
    """What evaluates recordings on the workers of an executor."""
    if executor is None:
        yield None
        return
    sent, folders, files = _travelling(study, [] if effects is None else [effects])
    spread = Spreader(executor, Bundle.of("study", *sent, effects, folders, files))
    try:
        yield spread
    finally:
        spread.close()


def _travelling(study: Study, folders: list[str]) -> tuple[Study, Folders, Files]:
    """A study with its plan and its model in memory, its folders of libraries and effects, and its other files."""
    path, text, model, table, recordings, folder = study
    model_file, libraries, paths = _mocc.study_files(*study)
    if text is None:
        text = _read(path)
    if model is None:
        model = _read(model_file)
    check_travels(model_file, model)
    files = []
    for found in paths:
        with open(found, "rb") as file:
            files.append((found, file.read()))
    sent = [*packed_folders([*libraries, *folders]), *beside(model_file)]
    return (path, text, model, table, recordings, folder), sent, files


def _from_best_start(study: Study, starts: int, seed: int, executor: Executor | None,
                     tell: Progress | None) -> Study:
    """The study whose plan starts at the best of several fits."""
    path, text, model, table, recordings, folder = study
    plan = tomllib.loads(text if text is not None else _read(path))
    free = plan.get("free", {})
    ranged = [name for name, entry in free.items()
              if name != "each" and isinstance(entry, dict) and {"min", "max"} <= entry.keys()]
    if not ranged:
        raise RequestError("`starts` needs parameters with `min` and `max`, between which fits can begin")
    plans = [toml(plan)]
    random = np.random.default_rng(seed)
    columns = {name: random.permutation(starts - 1) + random.random(starts - 1) for name in ranged}
    for k in range(starts - 1):
        moved = {**free}
        for name in ranged:
            low, high = float(free[name]["min"]), float(free[name]["max"])
            share = columns[name][k] / (starts - 1)
            # Over decades, where a parameter spans some.
            start = low * (high / low) ** share if 0 < 10 * low < high else low + (high - low) * share
            moved[name] = {**free[name], "start": start}
        plans.append(toml({**plan, "free": moved}))
    if executor is None:
        fits = Fits(study, [], [])
        found = []
        for k, one in enumerate(plans):
            found.append(fits.fit(one))
            if tell is not None:
                tell(f"start {k + 1} of {starts}")
    else:
        team = Team(executor, Bundle.of("fits", *_travelling(study, [])))
        found = team.map(Task("fit", (one,)) for one in plans)
    ended = [one for one in found if one is not None]
    if not ended:
        return study
    best = min(ended, key=lambda one: one[0])[1]
    moved = {name: {**entry, "start": best[name]} if name in best and isinstance(entry, dict) else entry
             for name, entry in free.items()}
    return path, toml({**plan, "free": moved}), model, table, recordings, folder


def _known(path: str) -> dict[str, Any]:
    """The entries of a plan file; none if it cannot be read, which the engine reports."""
    try:
        return tomllib.loads(_read(path))
    except (RequestError, tomllib.TOMLDecodeError):
        return {}


def _read(path: str) -> str:
    try:
        with open(path, encoding="utf-8") as file:
            return file.read()
    except (OSError, UnicodeDecodeError) as why:
        raise RequestError(f"cannot read {path}: {why}") from None


def _study(plan: Any, data: Mapping[str, Any] | None, table: Any, folder: Any,
           keys: dict[str, Any]) -> Study:
    """The plan's path and text, the model's text, the table, the recordings, and the folder."""
    if data is not None and not isinstance(data, Mapping):
        raise RequestError(f"`data` is a {type(data).__name__}; map names of recordings to tables")
    recordings = [(str(name), _frame(frame, str(name))) for name, frame in (data or {}).items()]
    rows = None if table is None else _strings(table)
    path, text, model = "plan", None, None
    if plan is not None and not isinstance(plan, (str, PathLike, Mapping)):
        raise RequestError(f"`plan` is a {type(plan).__name__}; give a plan file, or a mapping with the keys of a plan")
    if isinstance(plan, (str, PathLike)):
        if keys:
            raise RequestError(f"`{next(iter(keys))}` belongs into the plan file; give either a file or keys")
        path = fspath(plan)
        if recordings:
            _check_durations(_known(path), data or {})
    else:
        given = {**(plan or {}), **keys}
        _check_durations(given, data or {})
        if not given:
            raise RequestError("give a plan file, or the keys of a plan such as `model`, `signals` and `free`")
        if not recordings and rows is None and not {"recordings", "data"} & given.keys():
            raise RequestError("`data` is missing; map names of recordings to tables, or name files in `recordings`")
        model = _model(given)
        given["data"] = {"folder": "." if folder is None else fspath(folder), **given.get("data", {})}
        if rows is not None and "file" in rows[0]:
            given["data"].setdefault("file", "file")
        if "recordings" not in given and rows is None and "table" not in given["data"]:
            given["recordings"] = [{"file": name} for name, _ in recordings]
        elif "recordings" in given and rows is None:
            named = {str(entry.get("file")) for entry in given["recordings"] if isinstance(entry, Mapping)}
            unused = [name for name, _ in recordings if name not in named]
            if unused:
                raise RequestError(f"no entry of `recordings` has the file `{unused[0]}`, which is in `data`")
        if rows is not None:
            given["data"] = {"table": "table", **given["data"]}
        text = toml(given)
    return path, text, model, rows, recordings, None if folder is None else fspath(folder)


def _check_durations(plan: Mapping[str, Any], data: Mapping[str, Any]) -> None:
    """Errors: a time column holds durations or dates, and the plan gives it another unit than s."""
    time = plan.get("time")
    column, unit = (time.get("column"), time.get("unit", "s")) if isinstance(time, Mapping) else (None, "s")
    for name, frame in data.items():
        values = columns_of(frame).get(str(column))
        if unit != "s" and values is not None and in_seconds(values):
            raise RequestError(f"`{column}` of `{name}` holds durations or dates, which count in seconds: "
                               f"give `time` the unit s instead of {unit}")


def _allowed(allow: Any, plan: Any, keys: dict[str, Any]) -> list[str]:
    """The FMUs that may run: those that are named in the call."""
    named = [allow] if isinstance(allow, (str, PathLike)) else list(allow)
    model = {**(plan if isinstance(plan, Mapping) else {}), **keys}.get("model")
    if isinstance(model, (str, PathLike)) and fspath(model).lower().endswith(".fmu"):
        named.append(model)
    return [fspath(path) for path in named]


def _model(plan: dict[str, Any]) -> str | None:
    """Replaces a model that is not a file; returns its text."""
    model = plan.get("model")
    if isinstance(model, Model):
        file, text, name, settings, folders = model._source
        plan["model"] = file or "<text>"
        plan.setdefault("name", name or model.name)
        if folders:
            plan.setdefault("libraries", folders)
        fixed = dict(setting.split("=", 1) for setting in settings)
        plan["fixed"] = {**fixed, **plan.get("fixed", {})} or None
        return text
    if isinstance(model, (str, PathLike)):
        plan["model"], text = source_of(model)
        return text
    return None


def _frame(frame: Any, name: str) -> list[tuple[str, bytes]]:
    columns = []
    length = None
    for column, values in columns_of(frame).items():
        # The plan may not need a column of texts; the engine reports it if none of them is a number.
        found, texts = readings(values, column)
        if 0 < texts < len(found):
            text = f"`{column}` of `{name}`: {texts} of {len(found)} values are no numbers, and taken as missing"
            warnings.warn(text, ModelWarning, stacklevel=4)
        if length is not None and len(found) != length:
            raise RequestError(f"`{column}` of `{name}` has {len(found)} rows instead of {length}")
        length = len(found)
        columns.append((column, packed(found)))
    if not columns:
        raise RequestError(f"`{name}` has no columns")
    return columns


def _strings(table: Any) -> Strings:
    columns = columns_of(table)
    rows = zip(*([_text(value) for value in values] for values in columns.values()), strict=True)
    return list(columns), [list(row) for row in rows]


def _text(value: Any) -> str:
    if isinstance(value, (float, np.floating)):
        return repr(float(value))
    return str(value)


def toml(plan: Mapping[str, Any]) -> str:
    """A plan as TOML. Errors: a value that no plan can hold."""
    plan = {key: value for key, value in plan.items() if value is not None}
    lines = [f"{_key(k)} = {_toml(v)}" for k, v in plan.items() if not isinstance(v, Mapping) and k != "recordings"]
    for key, value in plan.items():
        if isinstance(value, Mapping):
            lines += ["", f"[{_key(key)}]"]
            lines += [f"{_key(k)} = {_toml(v)}" for k, v in value.items()]
    for recording in plan.get("recordings", []):
        lines += ["", "[[recordings]]"]
        lines += [f"{_key(k)} = {_toml(v)}" for k, v in recording.items()]
    return "\n".join(lines) + "\n"


def _toml(value: Any) -> str:
    if isinstance(value, (bool, np.bool_)):
        return "true" if value else "false"
    if isinstance(value, (int, np.integer)):
        return str(int(value))
    if isinstance(value, (float, np.floating)):
        return repr(float(value))
    if isinstance(value, (str, PathLike)):
        return json.dumps(fspath(value))
    if isinstance(value, Mapping):
        return "{ " + ", ".join(f"{_key(k)} = {_toml(v)}" for k, v in value.items()) + " }"
    if isinstance(value, (list, tuple, np.ndarray)):
        return "[" + ", ".join(_toml(v) for v in value) + "]"
    raise RequestError(f"a plan cannot hold a {type(value).__name__}")


def _key(name: str) -> str:
    is_bare = name.isascii() and name.replace("_", "").replace("-", "").isalnum()
    return name if is_bare else json.dumps(name)


def _effect(found: dict[str, Any]) -> Effect:
    def estimate(p: dict[str, Any]) -> Estimate:
        error = math.inf if p["stderr"] is None else p["stderr"]
        return Estimate(p["value"], error, p["unit"])

    parameters = {name: estimate(p) for name, p in found["parameters"].items()}
    return Effect(found["component"], found["at"], found["over"], found["law"], parameters, found["explains"])


def _warn(rendered: list[str]) -> None:
    for text in rendered:
        warnings.warn(text, ModelWarning, stacklevel=3)
