"""Models: compilation and runs."""

from __future__ import annotations

import math
import warnings
from collections.abc import Callable, Iterable, Mapping
from dataclasses import dataclass
from functools import cached_property
from numbers import Real
from os import PathLike, fspath
from types import MappingProxyType
from typing import Any, Literal

import numpy as np

from mocc import _mocc
from mocc._errors import Error, ModelWarning, RequestError, SimulationError
from mocc._frames import Numbers, columns_of, finite, names_of, packed, view
from mocc._linear import Linearization, SteadyState
from mocc._result import Result, _near

Setting = float | int | bool | str | Iterable[Any]
"""A value of a parameter: a number in SI units, a Boolean, a Modelica expression as a string, or a list of these."""

Signal = Callable[[float], float] | tuple[Any, Any] | Any
"""A signal that drives an input: a function of time, a pair of times and values, a Series over time, or values spread
evenly over the run."""

METHODS = ("auto", "radau", "bdf", "dopri")
INTERPOLATIONS = ("hold", "linear", "monotone", "spline")

SAMPLES = 8
"""Samples of a function between two rows."""


@dataclass(frozen=True)
class Parameter:
    """A parameter of a model."""

    name: str
    """Full dotted name."""
    value: float | int | bool | str | None
    """Its value, in SI units; `None` if initialization determines it."""
    unit: str
    """Its unit, SI; empty if there is none."""
    display_unit: str
    """Unit that the model wants shown; may be empty."""
    description: str
    """The comment at the declaration; may be empty."""
    place: str | None
    """`file:line:column` of the declaration."""


@dataclass(frozen=True)
class Variable:
    """A variable that a run records."""

    name: str
    """Full dotted name."""
    kind: str
    """`continuous`, `discrete`, `Boolean` or `Integer`."""
    unit: str
    """Its unit, SI; empty if there is none."""
    display_unit: str
    """Unit that the model wants shown; may be empty."""
    description: str
    """The comment at the declaration; may be empty."""
    place: str | None
    """`file:line:column` of the declaration."""


class Model:
    """A compiled model, made by `compile`. Any number of threads may run it; pickles as its source."""

    def __init__(self, file: str | None, text: str | None, model: str | None, settings: list[str],
                 folders: list[str]) -> None:
        self._source = (file, text, model, settings, folders)
        self._native = _mocc.Model(*self._source)
        # The text that was compiled, whatever becomes of the file.
        self._source = (file, self._native.text, model, settings, folders)
        _warn(self._native.warnings)

    @property
    def name(self) -> str:
        """Full name of the model."""
        return self._native.name

    @cached_property
    def parameters(self) -> Mapping[str, Parameter]:
        """The parameters by name, with values in SI units."""
        return MappingProxyType({p[0]: Parameter(*p) for p in self._native.parameters()})

    @cached_property
    def variables(self) -> Mapping[str, Variable]:
        """The variables that a run records, by name."""
        return MappingProxyType({v[0]: Variable(*v) for v in self._native.variables()})

    @property
    def states(self) -> list[str]:
        """Names of the states."""
        return self._native.states()

    @property
    def inputs(self) -> list[str]:
        """Names of the inputs that `simulate(inputs=...)` may drive."""
        return list(self._inputs)

    @cached_property
    def _inputs(self) -> dict[str, str]:
        """What each input takes: `number`, `Boolean` or `Integer`."""
        return dict(self._native.inputs())

    @cached_property
    def flat(self) -> str:
        """The flat model as Modelica: all variables and equations, as `mocc flatten` prints it."""
        return self._native.flat()

    @cached_property
    def structure(self) -> str:
        """How the model is solved: states, blocks, differentiated equations, as `mocc structure` prints it."""
        return self._native.structure()

    def simulate(
        self,
        stop: float | None = None,
        *,
        set: Mapping[str, Setting] | None = None,
        inputs: Mapping[str, Signal] | Any | None = None,
        tolerance: float | None = None,
        method: Literal["auto", "radau", "bdf", "dopri"] = "auto",
        events: Literal["last", "both"] = "last",
        interval: float | None = None,
        interpolation: Literal["hold", "linear", "monotone", "spline"] = "linear",
    ) -> Result:
        """Runs the model.

        `stop`, s, `interval` between rows, s, and the relative `tolerance` default to the model's annotation, then to 1,
        a 500th of the run, and 1e-6.
        `set` overrides parameters by their dotted names, and start values as `x.start`, in SI units. A parameter on which
        the structure of the model depends compiles it again, once for each value.
        `inputs` drives inputs of the model: a table with a column `time` (or times as its index) and a column for each
        input, or a mapping from inputs to signals. A signal is a function of time (sampled eight times between two rows,
        with a monotone cubic between samples), a pair `(times, values)`, a Series over time, or values spread evenly
        over the run. `interpolation` is for values that are not functions. A Boolean input is true where its signal is
        not 0, and it and an Integer keep each value until the next. Inputs that are not driven keep their start value.
        `events="last"` keeps one row at each instant, the one after an event; `"both"` keeps the rows before and after,
        as the command does.

        Errors: `RequestError` for wrong arguments, `ModelError` if the model is wrong with these settings,
        `SimulationError` if the run fails; its `result` holds the rows before the failure. An exception of a function
        that drives an input is passed on. Ctrl-C raises `KeyboardInterrupt`.
        """
        _one_of("method", method, METHODS)
        _one_of("events", events, ("last", "both"))
        _one_of("interpolation", interpolation, INTERPOLATIONS)
        for name, value in (("stop", stop), ("interval", interval), ("tolerance", tolerance)):
            if value is not None:
                _number(name, value)
        drives = [] if inputs is None else self._drives(inputs, stop, interval, interpolation)
        try:
            run, statistics, warned, printed = self._native.simulate(
                settings_of(set or {}), drives, stop, interval, tolerance, method, events == "last"
            )
        except SimulationError as error:
            run = error.__dict__.pop("_run", None)
            if run is not None:
                error.result = Result(run, self.name, {})
            raise
        _warn(warned)
        for line in printed:
            print(line)
        return Result(run, self.name, statistics)

    def steady_state(
        self,
        *,
        set: Mapping[str, Setting] | None = None,
        inputs: Mapping[str, float] | None = None,
        outputs: Iterable[str] | None = None,
        solve: bool = False,
        tolerance: float | None = None,
    ) -> SteadyState:
        """The state in which the model comes to rest, with inputs held at constant values.

        It is simulated until nothing moves any more, ten times longer each time; then Newton's method makes the point
        exact. So of several steady states it is the one that the model reaches from its start, and it is never an
        unstable one. `solve=True` solves the equations from the initial values instead, which is immediate and also finds
        unstable states.
        `set` is that of `simulate`, `inputs` maps inputs to values, SI; the others keep their start value. `outputs` names
        further variables to be outputs; without it, those of the model.

        Errors: `SimulationError` if it does not come to rest; otherwise as for `simulate`.
        """
        kind = "solved" if solve else "settled"
        found = self._linear(kind, 0.0, {}, set, inputs, outputs, tolerance)
        return SteadyState(self.name, found, (set, dict(inputs or {})))

    def linearize(
        self,
        at: float | Literal["steady"] | SteadyState | Mapping[str, float] | None = None,
        *,
        set: Mapping[str, Setting] | None = None,
        inputs: Mapping[str, float] | None = None,
        outputs: Iterable[str] | None = None,
        tolerance: float | None = None,
    ) -> Linearization:
        """The linear system of the model at a point: `A`, `B`, `C` and `D` with names, from exact derivatives.

        `at` is an instant of a run, s; `"steady"`, where the model comes to rest; a `SteadyState`; or values of states,
        SI, by their names, where states that are not named keep their initial value. Without it, the start of a run.
        `inputs` maps inputs to values, SI, at which they are held; the others keep their start value. `outputs` names the
        outputs; without it, those of the model. `set` is that of `simulate`.
        Relations keep their values: the system is that of the branch on which the point is.

        Errors: `SimulationError` if the point is not reached, or has no linear system; otherwise as for `simulate`.
        """
        kind, time, states = "time", 0.0, dict[str, float]()
        if at is None:
            time = self._native.experiment()[0] or 0.0
        elif isinstance(at, SteadyState):
            kind, states = "states", dict(at.states)
            set = {**(at._origin[0] or {}), **(set or {})}
            inputs = {**at.inputs, **(inputs or {})}
        elif isinstance(at, Mapping):
            kind, states = "states", {name: _number(name, value) for name, value in at.items()}
        elif isinstance(at, str):
            _one_of("at", at, ("steady",))
            kind = "settled"
        else:
            time = _number("at", at)
        return Linearization(self.name, self._linear(kind, time, states, set, inputs, outputs, tolerance))

    def _linear(
        self,
        kind: str,
        time: float,
        states: Mapping[str, float],
        set: Mapping[str, Setting] | None,
        inputs: Mapping[str, float] | None,
        outputs: Iterable[str] | None,
        tolerance: float | None,
    ) -> dict[str, Any]:
        if tolerance is not None:
            _number("tolerance", tolerance)
        held = [(name, _number(name, float(value) if isinstance(value, (bool, np.bool_)) else value))
                for name, value in (inputs or {}).items()]
        names = None if outputs is None else list(outputs)
        return _mocc.linear_system(self._native, kind, time, list(states.items()), settings_of(set or {}), held, names,
                                   tolerance)

    def sensitivities(
        self,
        parameters: Iterable[str],
        variables: Iterable[str],
        times: Any,
        *,
        set: Mapping[str, Setting] | None = None,
        inputs: Mapping[str, Signal] | Any | None = None,
        tolerance: float | None = None,
        interpolation: Literal["hold", "linear", "monotone", "spline"] = "linear",
    ) -> tuple[Numbers, Numbers]:
        """A run and its derivatives: the values of variables, shape `(times, variables)`, and their derivatives by
        parameters, shape `(times, variables, parameters)`, in SI units.

        The derivatives are exact, also across events and along sliding modes. `parameters` are Real parameters that only
        enter equations, or start values as `x.start`. `times` are increasing instants, s; the run ends at the last of
        them. `set` also holds values of `parameters`; the other arguments are those of `simulate`.

        Errors: `RequestError` for other parameters, unknown variables and times that do not increase; otherwise as for
        `simulate`.
        """
        _one_of("interpolation", interpolation, INTERPOLATIONS)
        if tolerance is not None:
            _number("tolerance", tolerance)
        by, of = list(parameters), list(variables)
        instants = finite(times, "`times`")
        if len(instants) == 0 or np.any(np.diff(instants) <= 0):
            raise RequestError("`times` must be increasing instants, at least one")
        if not by or not of:
            raise RequestError("name at least one parameter and one variable")
        drives = [] if inputs is None else self._drives(inputs, float(instants[-1]), None, interpolation)
        settings = settings_of(set or {})
        values, slopes = _mocc.sensitivities(self._native, by, of, packed(instants), settings, drives, tolerance)
        shape = (len(instants), len(of))
        return view(values).reshape(shape), view(slopes).reshape(*shape, len(by))

    def _span(self, stop: float | None, interval: float | None) -> tuple[float, float, float]:
        start, end, spacing, _ = self._native.experiment()
        start = start or 0.0
        stop = stop if stop is not None else end if end is not None else start + 1.0
        return start, stop, interval or spacing or (stop - start) / 500

    def _drives(self, inputs: Any, stop: float | None, interval: float | None,
                interpolation: str) -> list[tuple[str, bytes, bytes, str]]:
        start, end, spacing = self._span(stop, interval)
        if not isinstance(inputs, Mapping) or ("time" in inputs and "time" not in self.inputs):
            inputs = _over_time(inputs)
        drives = []
        for name, signal in inputs.items():
            if name not in self.inputs:
                known = ", ".join(self.inputs) or "none"
                raise RequestError(f"the model has no input `{name}` that can be driven"
                                   f"{_near(name, self.inputs) or f'; its inputs are: {known}'}")
            what = f"the signal for `{name}`"
            if signal is None:
                raise RequestError(f"{what} is None; leave `{name}` out to keep its start value")
            takes = self._inputs[name]
            how = interpolation if takes == "number" else "hold"
            if callable(signal):
                count = max(2, math.ceil((end - start) / spacing - 1e-9) * SAMPLES + 1)
                times = np.linspace(start, end, min(count, 10_000_001))
                values = finite([_called(signal, t, name) for t in times.tolist()], what)
                if takes == "number":
                    how = "monotone"
                else:
                    times, values = _switching(signal, times, values, name)
            else:
                times, values = _sampled(signal, start, end, what)
            if len(times) != len(values):
                raise RequestError(f"{what} has {len(times)} times and {len(values)} values")
            if len(times) == 0:
                raise RequestError(f"{what} is empty")
            if takes == "Integer" and np.any(values != np.round(values)):
                row = int(np.flatnonzero(values != np.round(values))[0])
                raise RequestError(f"{what} is {values[row]} in row {row}, and `{name}` is an Integer")
            back = np.flatnonzero(np.diff(times) <= 0)
            if back.size:
                row = int(back[0]) + 1
                raise RequestError(f"{what} goes from {times[row - 1]} s to {times[row]} s in row"
                                   f" {row}; times must increase")
            drives.append((name, packed(times), packed(values), how))
        return drives

    def __reduce__(self) -> tuple[Any, ...]:
        return (Model, self._source)

    def __repr__(self) -> str:
        return (f"<mocc.Model {self.name}: {len(self.states)} states, {len(self.parameters)} parameters,"
                f" {len(self.variables)} variables>")


def compile(
    path_or_text: str | PathLike[str] | None = None,
    model: str | None = None,
    set: Mapping[str, Setting] | None = None,
    lib: Iterable[str | PathLike[str]] = (),
) -> Model:
    """Compiles a model.

    `path_or_text` is a file, or the text of one: a string with a line break or a semicolon is a text. Without it, `model`
    is a model of a library. `model` is its full name; without it the last model of the file that is not partial.
    `set` overrides parameters by their dotted names, in SI units; a String parameter takes a string as it is. `lib` lists folders with libraries, in addition to
    `MODELICAPATH` and the shipped library.

    Errors: `ModelError` with all diagnostics if the model is wrong, `RequestError` if a file, a model or a parameter does
    not exist. Warnings are `ModelWarning`.
    """
    file, text = source_of(path_or_text)
    if isinstance(lib, (str, PathLike)):
        lib = [lib]
    folders = [fspath(folder) for folder in lib]
    given = settings_of(set or {})

    def made(settings: list[tuple[str, float | str]]) -> Model:
        return Model(file, text, model, [_expression(*setting) for setting in settings], folders)

    try:
        return made(given)
    except Error:
        quoted = _with_quotes(given, made)
        if quoted == given:
            raise
    return made(quoted)


def _with_quotes(given: list[tuple[str, float | str]], made: Callable[[Any], Model]) -> list[tuple[str, float | str]]:
    """Settings with quotes around the values of String parameters that are no expressions of the model."""
    others = [(name, value) for name, value in given if not isinstance(value, str)]
    if others == given:
        return given
    try:
        with warnings.catch_warnings():
            warnings.simplefilter("ignore")
            strings = made(others)._native.strings()
    except Error:
        return given
    plain = [(name, "".join(name.split()), value) for name, value in given]
    return [(name, quoted(value) if isinstance(value, str) and known in strings else value)
            for name, known, value in plain]


def quoted(text: str) -> str:
    """A string of Modelica; one that is written as such stays."""
    if text.startswith('"'):
        return text
    return '"' + text.replace("\\", "\\\\").replace('"', '\\"').replace("\n", "\\n") + '"'


def source_of(path_or_text: str | PathLike[str] | None) -> tuple[str | None, str | None]:
    """The file and the text that are meant."""
    if isinstance(path_or_text, str) and ("\n" in path_or_text or ";" in path_or_text):
        return "<text>", path_or_text
    if path_or_text is None:
        return None, None
    if not isinstance(path_or_text, (str, PathLike)):
        if isinstance(path_or_text, Model):
            raise RequestError("this is a compiled model; give its file or its text")
        raise RequestError(f"`path_or_text` is a {type(path_or_text).__name__}; give the path of a file, or its text")
    return fspath(path_or_text), None


def settings_of(given: Mapping[str, Setting]) -> list[tuple[str, float | str]]:
    """Values of parameters as numbers and Modelica expressions. Errors: a value is neither, or not finite."""
    return [(name, _setting(name, value)) for name, value in given.items()]


def _setting(name: str, value: Any) -> float | str:
    if isinstance(value, (bool, np.bool_)):
        return "true" if value else "false"
    if isinstance(value, str):
        return value
    if isinstance(value, Real):
        return _number(name, value)
    if isinstance(value, Iterable):
        items = (_setting(name, item) for item in value)
        return "{" + ", ".join(x if isinstance(x, str) else _literal(x) for x in items) + "}"
    raise RequestError(f"`{name}` is a {type(value).__name__}; give a number, a Boolean, a list or an expression")


def _literal(x: float) -> str:
    return str(int(x)) if x.is_integer() and abs(x) < 2**53 else repr(x)


def _expression(name: str, value: float | str) -> str:
    return f"{name}={value if isinstance(value, str) else _literal(value)}"


def _number(name: str, value: Any) -> float:
    if isinstance(value, bool) or not isinstance(value, Real):
        raise RequestError(f"`{name}` is a {type(value).__name__}, not a number")
    number = float(value)
    if not math.isfinite(number):
        raise RequestError(f"`{name}` is {number}, not a finite number")
    return number


def _one_of(name: str, value: Any, known: tuple[str, ...]) -> None:
    if value not in known:
        raise RequestError(f"`{name}` is {value!r}; it may be {', '.join(map(repr, known))}")


def _called(function: Callable[[float], float], t: float, name: str) -> float:
    try:
        return float(function(t))
    except Exception as error:
        error.add_note(f"raised by the function that drives the input `{name}`, at {t} s")
        raise


def _switching(function: Callable[[float], float], times: Numbers, values: Numbers, name: str) -> tuple[Numbers, Numbers]:
    """The instants at which a function takes another value, found to the last digit between its samples."""
    found_times, found_values = [times[0]], [values[0]]
    for k in np.flatnonzero(np.diff(values)):
        low, high = float(times[k]), float(times[k + 1])
        while low < (middle := 0.5 * (low + high)) < high:
            if _called(function, middle, name) == values[k]:
                low = middle
            else:
                high = middle
        found_times.append(high)
        found_values.append(_called(function, high, name))
    return finite(found_times, f"the time of `{name}`"), finite(found_values, f"the signal for `{name}`")


def _over_time(frame: Any) -> dict[str, tuple[Any, Any]]:
    columns = columns_of(frame)
    time = columns.pop("time", None)
    if time is None:
        index = getattr(frame, "index", None)
        if index is None or callable(index):
            raise RequestError("the table of inputs has no column `time`; its columns are "
                               + ", ".join(names_of(frame)))
        if type(index).__name__ == "RangeIndex" and getattr(index, "name", None) is None:
            raise RequestError("the table of inputs has no column `time`, and its index counts rows; add a column `time`, s,"
                               " or make the times its index")
        time = index
        columns.pop(str(getattr(index, "name", None)), None)
    return {name: (time, values) for name, values in columns.items()}


def _sampled(signal: Any, start: float, end: float, what: str) -> tuple[Numbers, Numbers]:
    if isinstance(signal, tuple) and len(signal) == 2:
        times, values = signal
        return finite(times, f"the time of {what}"), finite(values, what)
    index = getattr(signal, "index", None)
    if index is not None and not callable(index):
        return finite(index, f"the time of {what}"), finite(signal, what)
    values = finite(np.atleast_1d(signal), what)
    return np.linspace(start, end, len(values)), values


def _warn(rendered: list[str]) -> None:
    for text in rendered:
        warnings.warn(text, ModelWarning, stacklevel=3)
