"""Compile and simulate models of machines, fit them to recordings, and find the effects they lack.

    import mocc

    m = mocc.compile("valve52.mol")
    r = m.simulate(set={"p_supply": 3e5})
    r["s"], r.to_pandas(), r.plot("s", "p12")

    c = mocc.calibrate("valve52.toml")
    d = mocc.diagnose("valve52.toml")

All values are in SI units, and times in s, unless a unit is named.
"""

from mocc._errors import (
    Error,
    InternalError,
    ModelError,
    ModelWarning,
    Problem,
    RequestError,
    SimulationError,
)
from mocc._fmu import export_fmu
from mocc._linear import Linearization, SteadyState
from mocc._mocc import __version__
from mocc._model import Model, Parameter, Variable, compile
from mocc._result import Column, Event, Figure, Result
from mocc._study import Calibration, Diagnosis, Effect, Estimate, Report, calibrate, diagnose
from mocc._sweep import sweep

__all__ = [
    "Calibration",
    "Column",
    "Diagnosis",
    "Effect",
    "Error",
    "Estimate",
    "Event",
    "Figure",
    "InternalError",
    "Linearization",
    "Model",
    "ModelError",
    "ModelWarning",
    "Parameter",
    "Problem",
    "Report",
    "RequestError",
    "Result",
    "SimulationError",
    "SteadyState",
    "Variable",
    "__version__",
    "calibrate",
    "compile",
    "diagnose",
    "export_fmu",
    "sweep",
]
