"""The native part of the package."""

from collections.abc import Callable
from typing import Any

__version__: str

_Head = tuple[str, str, str, str, str]
_Event = tuple[float, str, str]
_Frame = tuple[str, list[tuple[str, bytes]]]
_Strings = tuple[list[str], list[list[str]]]

_Folders = list[tuple[str, list[tuple[str, bytes]]]]
_Files = list[tuple[str, bytes]]

def main(arguments: list[str]) -> int: ...
def arithmetic() -> int: ...
def linear_system(
    model: Model,
    at: str,
    time: float,
    states: list[tuple[str, float]],
    settings: list[tuple[str, float | str]],
    inputs: list[tuple[str, float]],
    outputs: list[str] | None,
    tolerance: float | None,
) -> dict[str, Any]: ...
def sensitivities(
    model: Model,
    parameters: list[str],
    variables: list[str],
    times: bytes,
    settings: list[tuple[str, float | str]],
    inputs: list[tuple[str, bytes, bytes, str]],
    tolerance: float | None,
) -> tuple[Values, Values]: ...
def sweep_files(arguments: list[str]) -> tuple[str | None, list[str], str | None]: ...
def study_files(
    plan: str,
    plan_text: str | None,
    model_text: str | None,
    table: _Strings | None,
    recordings: list[_Frame],
    folder: str | None,
) -> tuple[str, list[str], list[str]]: ...

class Values:
    def __len__(self) -> int: ...
    def address(self) -> int: ...
    def __buffer__(self, flags: int, /) -> memoryview: ...

class Run:
    def columns(self) -> list[_Head]: ...
    def time(self) -> Values: ...
    def values(self, column: int) -> Values | None: ...
    def position(self, name: str) -> int | None: ...
    def events(self) -> list[_Event]: ...
    def stream(self) -> object: ...
    def svg(
        self, title: str, names: list[str] | None, size: tuple[int | None, int | None], events: bool
    ) -> str | None: ...
    def draw(
        self, path: str, title: str, names: list[str] | None, size: tuple[int | None, int | None], events: bool
    ) -> bool: ...
    def parts(self) -> tuple[list[_Head], bytes, list[bytes], list[int], list[_Event]]: ...
    @staticmethod
    def of_parts(
        columns: list[_Head], time: bytes, vectors: list[bytes], places: list[int], events: list[_Event]
    ) -> Run: ...

class Model:
    def __init__(
        self, file: str | None, text: str | None, model: str | None, settings: list[str], folders: list[str]
    ) -> None: ...
    @property
    def name(self) -> str: ...
    @property
    def text(self) -> str | None: ...
    @property
    def warnings(self) -> list[str]: ...
    def experiment(self) -> tuple[float | None, float | None, float | None, float | None]: ...
    def parameters(self) -> list[tuple[str, float | int | bool | str | None, str, str, str, str | None]]: ...
    def variables(self) -> list[tuple[str, str, str, str, str, str | None]]: ...
    def states(self) -> list[str]: ...
    def strings(self) -> list[str]: ...
    def inputs(self) -> list[tuple[str, str]]: ...
    def flat(self) -> str: ...
    def structure(self) -> str: ...
    def simulate(
        self,
        settings: list[tuple[str, float | str]],
        inputs: list[tuple[str, bytes, bytes, str]],
        stop: float | None,
        interval: float | None,
        tolerance: float | None,
        method: str,
        right_limits: bool,
    ) -> tuple[Run, dict[str, Any], list[str], list[str]]: ...

class Calibration:
    json: str
    page: str
    model: str
    names: list[str]
    units: list[str]
    bounds: list[tuple[float, float]]
    values: list[float]
    covariance: list[float]
    warnings: list[str]
    def residuals(self, values: bytes) -> Values: ...
    def jacobian(self, values: bytes) -> Values: ...

def calibrate(
    plan: str,
    plan_text: str | None,
    model_text: str | None,
    table: _Strings | None,
    recordings: list[_Frame],
    folder: str | None,
    profiles: bool,
    progress: Callable[[str], object] | None,
    folders: _Folders,
    files: _Files,
    spread: Callable[[bytes, list[bytes]], list[bytes | None]] | None,
    allow_fmu: list[str],
) -> Calibration: ...
def diagnose(
    plan: str,
    plan_text: str | None,
    model_text: str | None,
    table: _Strings | None,
    recordings: list[_Frame],
    folder: str | None,
    effects: str | None,
    only: list[str],
    time_limit: float | None,
    progress: Callable[[str], object] | None,
    spread: Callable[[bytes, list[bytes]], list[bytes | None]] | None,
    allow_fmu: list[str],
) -> tuple[str, str, str, tuple[str, str] | None, list[str]]: ...

class Sweep:
    def __init__(
        self,
        file: str | None,
        text: str | None,
        model: str | None,
        settings: list[str],
        folders: list[str],
        vary: list[tuple[str, tuple[float, float] | list[float | str]]],
        sample: tuple[int, int] | None,
        measures: list[str],
        options: tuple[float | None, float | None, float | None, str],
        files: _Folders,
    ) -> None: ...
    @staticmethod
    def command(arguments: list[str], text: str | None, files: _Folders) -> Sweep: ...
    def __len__(self) -> int: ...
    def fields(self) -> list[tuple[str, str, str, str]]: ...
    def lines(
        self, begin: int, end: int, jobs: int | None, tell: Callable[[str], object] | None
    ) -> list[str]: ...
    def row(self, text: str) -> tuple[Any, ...]: ...
    def journal(self, path: str | None) -> Journal: ...
    def keeps_trajectories(self) -> bool: ...
    def finish(self, journal: Journal, done: int, seconds: float, how: str) -> int: ...

class Journal:
    def lines(self) -> list[str]: ...
    def push(self, lines: list[str]) -> None: ...
    def close(self) -> None: ...
    def remove(self) -> None: ...

class Worker:
    def __init__(
        self,
        plan: str,
        plan_text: str | None,
        model_text: str | None,
        table: _Strings | None,
        recordings: list[_Frame],
        folder: str | None,
        effects: str | None,
        folders: _Folders,
        files: _Files,
    ) -> None: ...
    def answers(self, problem: bytes, tasks: list[bytes]) -> list[bytes | None]: ...
