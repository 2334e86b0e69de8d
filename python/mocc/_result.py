"""The result of a run."""

from __future__ import annotations

import html
from collections.abc import Iterator, Sequence
from dataclasses import dataclass
from functools import cached_property
from os import PathLike, fspath
from typing import TYPE_CHECKING, Any

from mocc import _mocc
from mocc._frames import Numbers, view

if TYPE_CHECKING:
    import pandas
    import xarray


@dataclass(frozen=True)
class Event:
    """Something that happened at one instant."""

    time: float
    """When, s."""
    cause: str
    """Its cause in the names of the model, such as `spool.s >= s_max became true`."""
    place: str | None
    """`file:line:column` of the relation, if it is written somewhere."""


@dataclass(frozen=True)
class Column:
    """A recorded variable."""

    name: str
    """Full dotted name."""
    unit: str
    """Unit of the values, SI; empty if there is none."""
    display_unit: str
    """Unit that the model wants shown; may be empty."""
    description: str
    """The comment at the declaration; may be empty."""
    kind: str
    """`continuous`, `discrete`, `Boolean` (0 and 1) or `Integer`."""


class Figure:
    """A picture of a run. Notebooks show it; `save` writes it."""

    def __init__(self, run: Result, names: list[str] | None, title: str, width: int | None,
                 height: int | None, events: bool) -> None:
        self._run = run
        self._how = (title, names, (width, height), events)
        svg = run._run.svg(*self._how)
        self.svg: str = svg if svg is not None else _EMPTY
        """The picture as SVG."""

    def save(self, path: str | PathLike[str]) -> None:
        """Writes the picture to a file, as SVG or PNG by its extension.

        Errors: `RequestError` for another extension, or if the file cannot be written.
        """
        self._run._run.draw(fspath(path), *self._how)

    def _repr_svg_(self) -> str:
        return self.svg


class Result:
    """Rows, events and statistics of a run; all values are in SI units, times in s.

    `r["s"]` is a read-only NumPy view of the engine's memory, without a copy. Pickles, and polars, pyarrow and pandas
    read it without copies through the Arrow C stream.
    """

    def __init__(self, run: _mocc.Run, name: str, statistics: dict[str, Any]) -> None:
        self._run = run
        self.name = name
        """Full name of the model."""
        self.statistics = statistics
        """Counters of the run: `steps`, `rejected`, `rows`, `method`, `seconds`, `end` (s) and others."""

    @property
    def time(self) -> Numbers:
        """The instants, s, one for each row, as a read-only view."""
        return view(self._run.time())

    @cached_property
    def columns(self) -> list[Column]:
        """The recorded variables with their units and descriptions."""
        return [Column(*head) for head in self._run.columns()]

    @property
    def events(self) -> list[Event]:
        """The events in order of time."""
        return [Event(t, what, place or None) for t, what, place in self._run.events()]

    def __getitem__(self, name: str) -> Numbers:
        """The values of a variable, or of `time`, as a read-only view of shape `(rows,)`, in SI units.

        Errors: `KeyError` if no variable has this name.
        """
        position = self._run.position(name)
        if position is None:
            if name == "time":
                return self.time
            raise KeyError(f"no variable `{name}` was recorded{_near(name, self)}")
        values = self._run.values(position)
        assert values is not None
        return view(values)

    def __contains__(self, name: object) -> bool:
        return isinstance(name, str) and (name == "time" or self._run.position(name) is not None)

    def __iter__(self) -> Iterator[str]:
        return (column.name for column in self.columns)

    def __len__(self) -> int:
        """Number of rows."""
        return len(self._run.time())

    def keys(self) -> list[str]:
        """Names of the recorded variables."""
        return [column.name for column in self.columns]

    def to_pandas(self) -> pandas.DataFrame:
        """A DataFrame with the variables as columns and `time` as its index, s.

        `df.attrs["units"]` maps names to units. The frame is a copy, so it may be changed. Errors: `ImportError` without
        pandas.
        """
        import pandas

        data = {column.name: self._values(k) for k, column in enumerate(self.columns)}
        frame = pandas.DataFrame(data, index=pandas.Index(self.time, name="time", copy=True), copy=True)
        frame.attrs = {"model": self.name, "units": {c.name: c.unit for c in self.columns}}
        return frame

    def to_xarray(self) -> xarray.Dataset:
        """A Dataset over the dimension `time`, s; each variable has `units` and `long_name`.

        Errors: `ImportError` without xarray.
        """
        import xarray

        def attributes(column: Column) -> dict[str, str]:
            found = {"units": column.unit, "long_name": column.description}
            return {key: text for key, text in found.items() if text}

        data = {
            column.name: ("time", self._values(k), attributes(column))
            for k, column in enumerate(self.columns)
        }
        time = ("time", self.time, {"units": "s"})
        return xarray.Dataset(data, coords={"time": time}, attrs={"model": self.name})

    def __arrow_c_stream__(self, requested_schema: object | None = None) -> object:
        """A stream of the Arrow C data interface: `time` and the variables as `float64`, without copies."""
        return self._run.stream()

    def plot(self, *names: str, title: str | None = None, width: int | None = None,
             height: int | None = None, events: bool = False) -> Figure:
        """A picture with a panel for each unit; without names a choice of variables that move.

        `width` and `height` are in px; `events` marks events by vertical lines.
        Errors: `RequestError` for unknown names and impossible sizes.
        """
        shown = self.name if title is None else title
        return Figure(self, list(names) or None, shown, width, height, events)

    def __reduce__(self) -> tuple[Any, ...]:
        return (_restored, (self._run.parts(), self.name, self.statistics))

    def __repr__(self) -> str:
        s = self.statistics
        end, steps = s.get("end"), s.get("steps")
        return (f"<mocc.Result {self.name}: {len(self)} rows of {len(self.columns)} variables"
                f" to {end} s, {len(self._run.events())} events, {steps} steps>")

    def _repr_html_(self) -> str:
        svg = self._run.svg(self.name, None, (None, None), False) if len(self) else None
        return f"<div>{svg or ''}<p><code>{html.escape(repr(self)[1:-1])}</code></p></div>"

    def _values(self, position: int) -> Numbers:
        values = self._run.values(position)
        assert values is not None
        return view(values)


_EMPTY = '<svg xmlns="http://www.w3.org/2000/svg" width="1" height="1"/>'


def _near(name: str, names: Sequence[str] | Result) -> str:
    from difflib import get_close_matches

    found = get_close_matches(name, list(names), 1, 0.7)
    return f"; did you mean `{found[0]}`?" if found else ""


def _restored(parts: tuple[Any, ...], name: str, statistics: dict[str, Any]) -> Result:
    return Result(_mocc.Run.of_parts(*parts), name, statistics)



