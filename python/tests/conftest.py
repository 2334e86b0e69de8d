"""Models and recordings that several tests use."""

import signal
from pathlib import Path

import numpy as np
import pytest

import mocc

ROOT = Path(__file__).parents[2]

# A shell starts commands in the background with Ctrl-C ignored, and Python leaves that as it is.
signal.signal(signal.SIGINT, signal.default_int_handler)

TANK = """
model Tank "A tank that empties"
  parameter Real k(unit = "1/s") = 0.5 "Rate";
  parameter Real x_0(unit = "m") = 2 "Level at the start";
  parameter Integer n = 2 "Number of pipes";
  parameter Boolean open = true "The pipes are open";
  input Real u(unit = "m/s") "Inflow";
  Real x(unit = "m", start = x_0, fixed = true) "Level";
  Real y(unit = "m") = 2*x;
equation
  der(x) = if open then u - k*(n/2)*x else u;
  annotation(experiment(StopTime = 4));
end Tank;
"""

PLAN = {
    "model": TANK,
    "time": {"column": "t", "unit": "s"},
    "signals": {"level_mm": {"variable": "x", "unit": "mm", "sigma": 10.0}},
    "free": {"k": {"min": 0.05, "max": 5}, "x_0": {"min": 0.5, "max": 5}},
}
"""The plan of a calibration of the tank to `recording`."""

BALL = """
model Ball
  parameter Real e = 0.8 "Share of the speed that a bounce leaves";
  Real h(unit = "m", start = 1, fixed = true) "Height";
  Real v(unit = "m/s", start = 0, fixed = true) "Speed";
equation
  der(h) = v;
  der(v) = -9.81;
  when h < 0 then
    reinit(v, -e*pre(v));
  end when;
  annotation(experiment(StopTime = 1));
end Ball;
"""


@pytest.fixture(scope="session")
def tank() -> mocc.Model:
    return mocc.compile(TANK)


@pytest.fixture(scope="session")
def ball() -> mocc.Model:
    return mocc.compile(BALL)


@pytest.fixture(scope="session")
def valve() -> mocc.Model:
    return mocc.compile(ROOT / "examples" / "valve52.mol")


def recording(k: float, seed: int, sigma: float = 0.01):
    """Levels of a tank that empties, with noise."""
    pandas = pytest.importorskip("pandas")
    t = np.linspace(0, 4, 81)
    noise = np.random.default_rng(seed).normal(0, sigma, t.size)
    return pandas.DataFrame({"t": t, "level_mm": 1e3 * (2 * np.exp(-k * t) + noise)})
