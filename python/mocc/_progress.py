"""How far work has come: a bar in notebooks and terminals, or a function of the caller."""

from __future__ import annotations

import sys
from collections.abc import Callable
from types import TracebackType
from typing import Any, Self

Progress = Callable[[str], object]
"""Called with a line of text now and then."""


class Bar:
    """A bar of tqdm, where it is installed; it shows nothing otherwise. `with` closes it."""

    def __init__(self, total: int | None, unit: str) -> None:
        self._bar = _tqdm(total, unit)

    def line(self, text: str) -> None:
        """Shows a line of text."""
        if self._bar is not None:
            self._bar.set_description_str(text)

    def reach(self, done: int) -> None:
        """Moves to a number of things done."""
        if self._bar is not None:
            self._bar.update(done - self._bar.n)

    def __enter__(self) -> Self:
        return self

    def __exit__(self, kind: type[BaseException] | None, error: BaseException | None,
                 trace: TracebackType | None) -> None:
        if self._bar is not None:
            self._bar.close()


def _tqdm(total: int | None, unit: str) -> Any:
    try:
        from tqdm.auto import tqdm
    except ImportError:
        return None
    if total is None:
        return tqdm(bar_format="{desc} [{elapsed}]", file=sys.stderr)
    return tqdm(total=total, unit=unit, file=sys.stderr)
