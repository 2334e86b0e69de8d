"""Tables and numbers from whatever library holds them: pandas, polars, pyarrow, NumPy, dictionaries."""

from __future__ import annotations

from collections.abc import Mapping
from typing import Any

import numpy as np
from numpy.typing import NDArray

from mocc import _mocc
from mocc._errors import RequestError

Numbers = NDArray[np.float64]


def numbers(values: Any, what: str) -> Numbers:
    """A vector of floats. Errors: it holds something else."""
    try:
        found = np.asarray(values)
        if found.dtype.kind == "m":
            return found.astype("timedelta64[ns]").astype(np.float64) * 1e-9
        if found.dtype.kind in "MSU":
            raise TypeError
        found = found.astype(np.float64)
    except (TypeError, ValueError):
        raise RequestError(f"{what} does not hold numbers") from None
    if found.ndim != 1:
        raise RequestError(f"{what} has {found.ndim} dimensions instead of one")
    return found


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
