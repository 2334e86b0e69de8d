"""Steady states and linear systems."""

from __future__ import annotations

import html
from collections.abc import Iterator, Mapping
from types import MappingProxyType
from typing import TYPE_CHECKING, Any

import numpy as np
from numpy.typing import NDArray

from mocc._result import _near

if TYPE_CHECKING:
    import scipy.signal

Matrix = NDArray[np.float64]


class SteadyState:
    """A state in which a model rests, made by `Model.steady_state`."""

    def __init__(self, name: str, found: dict[str, Any], origin: tuple[Any, ...]) -> None:
        self.name = name
        """Full name of the model."""
        self.time: float = found["time"]
        """When the model has come to rest, s; where the equations were solved, the start time."""
        self.states: Mapping[str, float] = _pairs(found["states"], found["x"])
        """Values of the states, SI."""
        self.inputs: Mapping[str, float] = _pairs(found["inputs"], found["u"])
        """Values of the inputs, SI."""
        self.outputs: Mapping[str, float] = _pairs(found["outputs"], found["y"])
        """Values of the outputs, SI."""
        self.units: Mapping[str, str] = MappingProxyType(dict(found["units"]))
        """Units of states, inputs and outputs; empty if there is none."""
        self.eigenvalues = _eigenvalues(found)
        """Eigenvalues of the linear system here, 1/s, shape `(states,)`, by descending real part."""
        self._values: Mapping[str, float] = MappingProxyType(dict(found["values"]))
        self._origin = origin

    @property
    def is_stable(self) -> bool:
        """Small deviations decay: all eigenvalues have negative real parts."""
        return bool(np.all(self.eigenvalues.real < 0))

    def __getitem__(self, name: str) -> float:
        """The value of a variable, SI. Errors: `KeyError` if no variable has this name."""
        try:
            return self._values[name]
        except KeyError:
            raise KeyError(f"no variable `{name}` was recorded{_near(name, list(self._values))}") from None

    def __contains__(self, name: object) -> bool:
        return name in self._values

    def keys(self) -> list[str]:
        """Names of the variables."""
        return list(self._values)

    def __repr__(self) -> str:
        return f"<mocc.SteadyState of {self.name}: {_listed(self.states)}>"

    def _repr_html_(self) -> str:
        rows = "".join(
            f"<tr><td><code>{html.escape(name)}</code></td><td>{value:.6g}</td>"
            f"<td>{html.escape(self.units.get(name, ''))}</td></tr>"
            for part in (self.states, self.inputs, self.outputs)
            for name, value in part.items()
        )
        return f"<p><code>{html.escape(self.name)}</code> rests at</p><table>{rows}</table>"


class Linearization:
    """A linear system `dx = A x + B u`, `y = C x + D u` for small deviations, made by `Model.linearize`.

    Unpacks into its matrices: `A, B, C, D = m.linearize()`; `scipy.signal.StateSpace(*m.linearize())` and
    `control.ss(*m.linearize())` take it as it is.
    """

    def __init__(self, name: str, found: dict[str, Any]) -> None:
        self.name = name
        """Full name of the model."""
        self.time: float = found["time"]
        """The instant, s."""
        self.states: list[str] = found["states"]
        """Names of the states: rows and columns of `A`, rows of `B`, columns of `C`."""
        self.inputs: list[str] = found["inputs"]
        """Names of the inputs: columns of `B` and `D`."""
        self.outputs: list[str] = found["outputs"]
        """Names of the outputs: rows of `C` and `D`."""
        n, m, p = len(self.states), len(self.inputs), len(self.outputs)
        self.A: Matrix = np.array(found["A"], dtype=float).reshape(n, n)
        """Derivatives of the rates by the states, shape `(states, states)`."""
        self.B: Matrix = np.array(found["B"], dtype=float).reshape(n, m)
        """Derivatives of the rates by the inputs, shape `(states, inputs)`."""
        self.C: Matrix = np.array(found["C"], dtype=float).reshape(p, n)
        """Derivatives of the outputs by the states, shape `(outputs, states)`."""
        self.D: Matrix = np.array(found["D"], dtype=float).reshape(p, m)
        """Derivatives of the outputs by the inputs, shape `(outputs, inputs)`."""
        self.x: Matrix = np.array(found["x"], dtype=float)
        """Values of the states, SI."""
        self.dx: Matrix = np.array(found["dx"], dtype=float)
        """Their rates, SI by s: zero at rest."""
        self.u: Matrix = np.array(found["u"], dtype=float)
        """Values of the inputs, SI."""
        self.y: Matrix = np.array(found["y"], dtype=float)
        """Values of the outputs, SI."""
        self.units: Mapping[str, str] = MappingProxyType(dict(found["units"]))
        """Units of states, inputs and outputs; empty if there is none."""
        self.eigenvalues = _eigenvalues(found)
        """Eigenvalues of `A`, 1/s, by descending real part."""
        parts = found.get("participation")
        self.participation: Matrix = np.full((n, n), np.nan) if parts is None else np.array(parts).reshape(n, n)
        """For each eigenvalue (row) the part of each state (column); each row sums to 1. NaN if they cannot be computed."""

    def __iter__(self) -> Iterator[Matrix]:
        return iter((self.A, self.B, self.C, self.D))

    def to_scipy(self) -> scipy.signal.StateSpace:
        """The system for `scipy.signal`. Errors: `ImportError` without SciPy."""
        import scipy.signal

        return scipy.signal.StateSpace(*self)

    def to_control(self) -> Any:
        """The system for python-control, with names. Errors: `ImportError` without python-control."""
        import control

        return control.ss(*self, states=self.states, inputs=self.inputs, outputs=self.outputs, name=self.name)

    def __repr__(self) -> str:
        return (f"<mocc.Linearization of {self.name} at {self.time:g} s: {len(self.states)} states,"
                f" {len(self.inputs)} inputs, {len(self.outputs)} outputs>")

    def _repr_html_(self) -> str:
        columns = [*self.states, *self.inputs]
        head = "".join(f"<th><code>{html.escape(name)}</code></th>" for name in columns)
        rows = [f"der({name})" for name in self.states] + self.outputs
        table = np.block([[self.A, self.B], [self.C, self.D]])
        body = "".join(
            f"<tr><th><code>{html.escape(name)}</code></th>" + "".join(f"<td>{x:.6g}</td>" for x in row) + "</tr>"
            for name, row in zip(rows, table, strict=True)
        )
        return f"<p><code>{html.escape(repr(self)[1:-1])}</code></p><table><tr><th></th>{head}</tr>{body}</table>"


def _eigenvalues(found: dict[str, Any]) -> NDArray[np.complex128]:
    pairs = found["eigenvalues"]
    if pairs is None:
        return np.full(len(found["states"]), np.nan, dtype=np.complex128)
    return np.array([complex(*pair) for pair in pairs], dtype=np.complex128)


def _pairs(names: list[str], values: list[float]) -> Mapping[str, float]:
    return MappingProxyType(dict(zip(names, values, strict=True)))


def _listed(values: Mapping[str, float]) -> str:
    shown = [f"{name} = {value:.6g}" for name, value in list(values.items())[:4]]
    more = len(values) - len(shown)
    return ", ".join(shown) + (f" and {more} more" if more else "")
