"""Tables and numbers from whatever library holds them: pandas, polars, pyarrow, NumPy, dictionaries."""

from __future__ import annotations

import math
from collections.abc import Mapping
from typing import Any

import numpy as np
from numpy.typing import NDArray

from mocc import _mocc
from mocc._errors import RequestError

Numbers = NDArray[np.float64]


def numbers(values: Any, what: str) -> Numbers:
    """A vector of floats, NaN where a value is masked or missing; durations in s, and dates in s from the first one.

    Errors: it holds something else.
    """
    try:
        found = np.ma.asarray(values) if isinstance(values, np.ma.MaskedArray) else np.asarray(values)
        if found.dtype.kind == "O" and len(found) and hasattr(found[0], "timestamp"):
            # Dates with a time zone.
            found = np.array([value.timestamp() for value in found])
            found = found - found[0]
        elif in_seconds(found):
            if found.dtype.kind == "M":
                found = found - found[:1]
            seconds = found.astype("timedelta64[ns]").astype(np.float64) * 1e-9
            found = np.where(np.isnat(found), np.nan, seconds)
        elif found.dtype.kind in "SU":
            raise TypeError
        elif found.dtype.kind == "O":
            found = np.array([math.nan if _is_missing(value) else value for value in found]).astype(np.float64)
        else:
            found = np.ma.filled(found.astype(np.float64), np.nan)
    except (TypeError, ValueError):
        raise RequestError(f"{what} does not hold numbers") from None
    if found.ndim != 1:
        raise RequestError(f"{what} has {found.ndim} dimensions instead of one")
    return found


def in_seconds(values: Any) -> bool:
    """Whether a vector holds durations or dates, which have a unit of their own."""
    found = np.asarray(values)
    return found.dtype.kind in "mM" or found.dtype.kind == "O" and len(found) > 0 and hasattr(found[0], "timestamp")


def readings(values: Any, what: str) -> tuple[Numbers, int]:
    """A vector of floats, NaN where a value is no number, and how many texts are none; durations in s."""
    try:
        return numbers(values, what), 0
    except RequestError:
        pass
    found = np.array([_number_or_nan(value) for value in values], dtype=float)
    texts = sum(isinstance(value, str) and value.strip() != "" for value in values)
    return found, texts - int(np.count_nonzero(~np.isnan(found)))


def _is_missing(value: Any) -> bool:
    return value is None or type(value).__name__ in ("NAType", "NaTType")


def _number_or_nan(value: Any) -> float:
    try:
        return float(value)
    except (TypeError, ValueError):
        return math.nan


def finite(values: Any, what: str) -> Numbers:
    """A vector of finite floats. Errors: a value is NaN or infinite, or not a number."""
    found = numbers(values, what)
    wrong = np.flatnonzero(~np.isfinite(found))
    if wrong.size:
        row = int(wrong[0])
        raise RequestError(f"{what} is {found[row]} in row {row}; drop or fill such rows")
    return found


def names_of(frame: Any) -> list[str]:
    """The names of the columns of a table. Errors: it is not a table."""
    if isinstance(frame, Mapping):
        return [str(name) for name in frame]
    for attribute in ("column_names", "columns"):
        names = getattr(frame, attribute, None)
        if names is not None and not callable(names):
            return [str(name) for name in names]
    raise RequestError(f"expected a table with named columns, found {type(frame).__name__}")


def columns_of(frame: Any) -> dict[str, Any]:
    """The columns of a table by name; an index with a name, or one called `time`, is a column too."""
    columns = {name: frame[name] for name in names_of(frame)}
    index = getattr(frame, "index", None)
    if index is not None and not callable(index):
        name = getattr(index, "name", None)
        if name is not None and str(name) not in columns:
            columns = {str(name): index, **columns}
    return columns


def view(values: _mocc.Values) -> Numbers:
    """A read-only array over the memory of the engine, which it keeps alive."""
    if len(values) == 0:
        return np.empty(0)
    return np.frombuffer(memoryview(values), dtype=np.float64)


def packed(values: Numbers) -> bytes:
    """The bytes of a vector."""
    return np.ascontiguousarray(values, dtype=np.float64).tobytes()
