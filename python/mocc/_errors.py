"""The exceptions and the warning of the package."""

from __future__ import annotations

from dataclasses import dataclass
from typing import TYPE_CHECKING, Any, Self

if TYPE_CHECKING:
    from mocc._result import Result


@dataclass(frozen=True)
class Problem:
    """One diagnostic."""

    code: str | None
    """Stable code, such as `MO0201`, which `mocc explain` explains; `None` for wrong arguments."""
    message: str
    """One sentence."""
    place: str | None = None
    """`file:line:column`, if it is about a place."""
    help: str | None = None
    """How to repair it."""
    notes: tuple[str, ...] = ()
    """Background, such as the section of the Modelica specification."""
    rendered: str = ""
    """The message with an excerpt of the source."""
    time: float | None = None
    """Time of a failure within a run, s."""


class Error(Exception):
    """Every exception of this package. Its attributes are those of the first of its `problems`."""

    problems: tuple[Problem, ...]
    """All diagnostics, sorted by place."""

    def __init__(self, message: str, problems: tuple[Problem, ...] = ()) -> None:
        self.problems = problems or (Problem(None, message, rendered=f"error: {message}"),)
        super().__init__(message, self.problems)

    @classmethod
    def of(cls, problems: list[dict[str, Any]]) -> Self:
        """The exception for these diagnostics."""
        found = tuple(Problem(**{**p, "notes": tuple(p["notes"])}) for p in problems)
        return cls(found[0].message, found)

    @property
    def code(self) -> str | None:
        """Stable code, such as `MO0201`; `None` for wrong arguments."""
        return self.problems[0].code

    @property
    def message(self) -> str:
        """One sentence."""
        return self.problems[0].message

    @property
    def place(self) -> str | None:
        """`file:line:column`, if it is about a place."""
        return self.problems[0].place

    @property
    def help(self) -> str | None:
        """How to repair it."""
        return self.problems[0].help

    @property
    def rendered(self) -> str:
        """All diagnostics with excerpts of the source."""
        return "\n\n".join(p.rendered for p in self.problems)

    def __str__(self) -> str:
        return self.rendered.removeprefix("error: ")


class ModelError(Error):
    """The model is wrong."""


class RequestError(Error, ValueError):
    """An argument, a plan or a recording is wrong."""


class SimulationError(Error):
    """The numerics failed, or an assertion of the model is violated."""

    result: Result | None = None
    """The rows before the failure, if it was a single run."""

    @property
    def time(self) -> float | None:
        """Time of the failure within the run, s."""
        return self.problems[0].time


class InternalError(Error):
    """A bug in mocc."""


class ModelWarning(UserWarning):
    """A warning of the compiler or of a run, with an excerpt of the source."""
