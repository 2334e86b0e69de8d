"""A matrix of exported models in FMPy: 25 models, two versions of FMI, Model Exchange and Co-Simulation.

    python tests/fmu/matrix.py target/release/mocc [--library DIR] [--table FILE] [MODEL...]

Each is validated without a finding, agrees with `mocc simulate` within ten times the tolerance, has its events at the
same times, goes on from a state that was saved, restored or serialised in mid run, and has directional derivatives that
equal differences; `xmllint`, where it is installed, agrees with the schemas that FMPy ships. Models of the Standard
Library are taken if `--library` names the folder that holds it. `--table` writes the results as a table in Markdown.
Needs `fmpy`. Exits with 1 if something differs.
"""

import argparse
import ctypes
import shutil
import subprocess
import tempfile
import time
import zipfile
from pathlib import Path

import check
import fmpy
import numpy as np
from fmpy import extract, fmi2, fmi3, read_model_description, simulate_fmu
from fmpy.validation import validate_fmu

from examples import EXAMPLES

MORE = [
    "examples/filling.mol",
    "tests/fmu/models.mo:Hybrid.Smooth",
    "tests/fmu/models.mo:Hybrid.Integrator",
]
LIBRARY = [
    "Modelica.Blocks.Examples.PID_Controller",
    "Modelica.Blocks.Examples.BooleanNetwork1",
    "Modelica.Electrical.Analog.Examples.Rectifier",
    "Modelica.Electrical.Analog.Examples.HeatingRectifier",
    "Modelica.Mechanics.MultiBody.Examples.Elementary.FreeBody",
    "Modelica.Mechanics.MultiBody.Examples.Loops.Fourbar1",
    "Modelica.Mechanics.Rotational.Examples.CoupledClutches",
    "Modelica.Mechanics.Translational.Examples.ElastoGap",
    "Modelica.StateGraph.Examples.FirstExample",
    "Modelica.Thermal.HeatTransfer.Examples.Motor",
]
# Largest differences in units of the range of a variable and of the tolerance of the run.
TIMES_TOLERANCE = 10.0
# Rows are interpolated between communication points, so the grid is made of the rows of the reference.
POINTS = 200
# An event is at the same time if it is as close as that part of the run.
SAME_TIME = 1e-5


class Case:
    """A model in one version, and what is known of its run in mocc."""

    def __init__(self, mocc: str, model: str, version: str, library: str | None, folder: Path) -> None:
        file, _, name = model.partition(":")
        arguments = [file, *(["--model", name] if name else [])]
        if library is not None:
            arguments = ["--model", model, "--lib", library]
        self.model, self.version, self.folder = model, version, folder
        self.path = str(folder / f"case{version}.fmu")
        check.run(mocc, "export", "fmu", *arguments, "--fmi", version, "-o", self.path)
        self.description = read_model_description(self.path)
        default = self.description.defaultExperiment
        self.start, self.stop = float(default.startTime), float(default.stopTime)
        self.step, self.tolerance = float(default.stepSize), float(default.tolerance)
        self.names, self.rows = check.reference(mocc, arguments, folder)
        # Two integrators agree as well as both are accurate: CVode is given a tight tolerance too.
        tight = [*arguments, "--tolerance", str(1e-3 * self.tolerance)]
        _, self.tight_rows = check.reference(mocc, tight, folder)
        t = self.rows[:, 0]
        self.jumps = np.unique(t[1:][np.diff(t) == 0])
        self.unpacked = extract(self.path)
        self.findings: list[str] = []

    def expect(self, holds: bool, what: str) -> None:
        if not holds:
            self.findings.append(what)
            check.failures.append(f"{self.model}, FMI {self.version}: {what}")
            print(f"  wrong: {self.model}, FMI {self.version}: {what}")

    def instance(self, exchange: bool):
        """A fresh instance, initialised; in Model Exchange in continuous-time mode."""
        kind = self.description.modelExchange if exchange else self.description.coSimulation
        classes = {
            ("2", True): fmi2.FMU2Model,
            ("2", False): fmi2.FMU2Slave,
            ("3", True): fmi3.FMU3Model,
            ("3", False): fmi3.FMU3Slave,
        }
        made = classes[self.version, exchange](
            guid=self.description.guid,
            unzipDirectory=self.unpacked,
            modelIdentifier=kind.modelIdentifier,
            instanceName="x",
        )
        made.instantiate()
        if self.version == "2":
            made.setupExperiment(startTime=self.start, stopTime=self.stop)
            made.enterInitializationMode()
        else:
            made.enterInitializationMode(startTime=self.start, stopTime=self.stop)
        made.exitInitializationMode()
        if exchange:
            while (made.newDiscreteStates if self.version == "2" else made.updateDiscreteStates)()[0]:
                pass
            made.enterContinuousTimeMode()
        return made

    def reals(self) -> list[int]:
        kinds = ("Real", "Float64")
        found = [v for v in self.description.modelVariables if v.type in kinds and v.causality in ("local", "output")]
        return [v.valueReference for v in found if v.variability in ("continuous", "discrete")]

    def get(self, made, references: list[int]) -> np.ndarray:
        return np.array(made.getReal(references) if self.version == "2" else made.getFloat64(references))


def validated(case: Case) -> None:
    found = validate_fmu(case.path)
    case.expect(not found, f"FMPy finds {found[:2]}")
    if shutil.which("xmllint") is None:
        return
    folder = Path(fmpy.__file__).parent / "schema" / f"fmi{case.version}"
    schema = folder / ("fmi2ModelDescription.xsd" if case.version == "2" else "fmi3ModelDescription.xsd")
    with zipfile.ZipFile(case.path) as archive:
        files = [("modelDescription.xml", schema)]
        terminals = "terminalsAndIcons/terminalsAndIcons.xml"
        if case.version == "3" and terminals in archive.namelist():
            files.append((terminals, folder / "fmi3TerminalsAndIcons.xsd"))
        for name, schema in files:
            text = archive.read(name)
            done = subprocess.run(["xmllint", "--noout", "--schema", str(schema), "-"], input=text, capture_output=True)
            case.expect(done.returncode == 0, f"xmllint on {name}: {done.stderr.decode()[:300]}")


def simulated(case: Case, exchange: bool) -> float:
    """Simulates by FMPy; the largest difference to mocc in units of ten times the tolerance."""
    kind = "ModelExchange" if exchange else "CoSimulation"
    variables = {v.name: v for v in case.description.modelVariables}

    states = {unknown.variable.derivative.name for unknown in case.description.derivatives}

    def is_compared(name: str) -> bool:
        v = variables.get(name)
        if v is None or v.causality not in ("local", "output") or v.type not in ("Real", "Float64"):
            return False
        # What an integrator keeps within its tolerance are states; small differences of large ones are not.
        return not exchange or name in states or v.causality == "output"

    picked = [n for n in case.names[1:] if is_compared(n)][:200]
    rows = case.tight_rows if exchange else case.rows
    t = rows[:, 0]
    result = simulate_fmu(
        case.path,
        fmi_type=kind,
        output=picked,
        start_time=case.start,
        stop_time=case.stop,
        output_interval=case.step,
        record_events=exchange,
        relative_tolerance=1e-4 * case.tolerance if exchange else None,
    )
    times = result["time"]
    span = case.stop - case.start
    end = t[-1]
    case.expect(times[-1] > end - case.step - 1e-6 * span, f"{kind} ends at {times[-1]} s, mocc at {end} s")
    away = [abs(times - jump) > 1e-8 + 1e-4 * span for jump in case.jumps]
    kept = (np.all(away, axis=0) if away else np.ones(len(times), bool)) & (times <= end)
    worst, of = 0.0, ""
    for n in picked:
        expected = rows[:, case.names.index(n)]
        size = max(np.ptp(expected), abs(expected).max(), 1e-7)
        # Between rows of mocc, values are read from lines, so only common instants count.
        found = result[n].astype(float)
        at = np.interp(times, t, expected)
        common = kept & np.isin(np.round(times / span, 12), np.round(t / span, 12))
        error = (abs(at - found) / size)[common].max(initial=0.0)
        worst, of = max((worst, of), (error, n))
    instants = int((kept & np.isin(np.round(times / span, 12), np.round(t / span, 12))).sum())
    case.expect(instants > 100 or len(times) < 150, f"{kind}: only {instants} instants are compared")
    relative = worst / (TIMES_TOLERANCE * case.tolerance)
    case.expect(relative <= 1, f"{kind}: `{of}` differs by {worst:.1e} of its size, {relative:.1f} times what may be")
    if exchange:
        same_events(case, np.unique(times[1:][np.diff(times) < 1e-12 * span]))
    return relative


def same_events(case: Case, found: np.ndarray) -> None:
    """Each event of mocc is one in FMPy."""
    near = SAME_TIME * (case.stop - case.start)
    inner = case.jumps[(case.jumps > case.start + near) & (case.jumps < case.stop - near)]
    missing = [at for at in inner if not len(found) or abs(found - at).min() > near]
    case.expect(not missing, f"events at {missing[:4]} s are none in FMPy, which has {found[:8]}")


def stepped(case: Case, made, first: int, last: int) -> np.ndarray:
    """Values after steps of Co-Simulation."""
    size = (case.stop - case.start) / POINTS
    for k in range(first, last):
        made.doStep(case.start + k * size, size)
    return case.get(made, case.reals())


def saved_state(case: Case) -> None:
    """Co-Simulation goes on from a state that was saved or serialised."""
    ends_at = case.rows[-1, 0]
    first = int(POINTS / 4 * (ends_at - case.start) / (case.stop - case.start))
    last = 2 * first
    made = case.instance(False)
    stepped(case, made, 0, first)
    state = made.getFMUState()
    stored = made.serializeFMUState(state)
    expected = stepped(case, made, first, last)
    size = np.maximum(abs(expected), 1e-6 * abs(expected).max(initial=0.0) + 1e-12)
    made.setFMUState(state)
    restored = stepped(case, made, first, last)
    made.freeFMUState(state)
    made.terminate()
    made.freeInstance()
    other = case.instance(False)
    loaded = other.deserializeFMUState(stored)
    other.setFMUState(loaded)
    again = stepped(case, other, first, last)
    other.terminate()
    other.freeInstance()
    for what, found in (("restored", restored), ("serialised", again)):
        error = (abs(found - expected) / size).max(initial=0.0)
        # The integrator starts afresh, so the runs differ by its errors.
        case.expect(error < 1e3 * case.tolerance, f"a {what} state goes on with a difference of {error:.1e}")


def saved_point(case: Case) -> None:
    """Model Exchange is the same to the bit after a state is restored."""
    made = case.instance(True)
    order = len(case.description.derivatives)
    x = (ctypes.c_double * max(order, 1))()
    made.getContinuousStates(x, order)
    state = made.getFMUState()
    expected = case.get(made, case.reals())
    made.setTime(case.start + 0.01 * (case.stop - case.start))
    for k in range(order):
        x[k] = 1.01 * x[k] + 1e-3
    made.setContinuousStates(x, order)
    try:
        case.get(made, case.reals())
    except Exception:
        pass  # The displaced point need not have values.
    made.setFMUState(state)
    found = case.get(made, case.reals())
    case.expect(np.array_equal(found, expected, equal_nan=True), "a restored point of Model Exchange differs")
    made.freeFMUState(state)
    made.terminate()
    made.freeInstance()


def derivatives(case: Case) -> None:
    """Directional derivatives by states and inputs equal differences, with relations held."""
    description = case.description
    with zipfile.ZipFile(case.path) as archive:
        if b"providesDirectionalDerivative" not in archive.read("modelDescription.xml"):
            return
    made = case.instance(True)
    rates = [unknown.variable for unknown in description.derivatives]
    n = len(rates)
    if n == 0:
        return
    states = [r.derivative.valueReference for r in rates]
    unknowns = [r.valueReference for r in rates]
    x, dx = (ctypes.c_double * n)(), (ctypes.c_double * n)()
    made.getContinuousStates(x, n)
    # Away from the symmetric points at which runs begin.
    for k in range(n):
        x[k] = x[k] * (1 + 1e-4 * (k + 1) / n) + 1e-9

    def rate() -> np.ndarray:
        made.setContinuousStates(x, n)
        (made.getDerivatives if case.version == "2" else made.getContinuousStateDerivatives)(dx, n)
        return np.array(dx)

    try:
        base = rate()
    except Exception:
        made.freeInstance()
        return
    worst = 0.0
    for k in range(n):
        rate()
        exact = np.array(made.getDirectionalDerivative(unknowns, [states[k]], [1.0]))
        at, errors = x[k], []
        # States differ in size, such as positions and masses: of all displacements the best one counts.
        for h in [*(abs(at) * 10.0**-k for k in range(3, 8)), *(10.0**-k for k in range(4, 9))]:
            try:
                x[k] = at + h
                above = rate()
                x[k] = at - h
                below = rate()
            except Exception:
                continue
            finally:
                x[k] = at
            difference = (above - below) / (2 * h)
            # The differences cannot be better than rounding allows.
            rounding = 1e-11 * np.maximum(abs(base), abs(above)) / h
            size = np.maximum(abs(difference), abs(exact)) + 1e-6 * abs(difference).max(initial=0.0) + 1e-12
            errors.append(np.maximum(abs(exact - difference) - rounding, 0) / size)
        if errors:
            worst = max(worst, np.min(errors, axis=0).max())
    case.expect(worst < 1e-4, f"directional derivatives differ from differences by {worst:.1e}")
    made.freeInstance()


def examined(mocc: str, model: str, library: str | None, folder: Path) -> list[str]:
    """All checks of a model; a row of the table."""
    cells = []
    begun = time.monotonic()
    for version in ("2", "3"):
        case = Case(mocc, model, version, library, folder)
        validated(case)
        for exchange in (True, False):
            offered = case.description.modelExchange if exchange else case.description.coSimulation
            if offered is None:
                cells.append("not offered")
                continue
            cells.append(f"{simulated(case, exchange):.2f}")
            if exchange:
                saved_point(case)
                derivatives(case)
            else:
                saved_state(case)
        shutil.rmtree(case.unpacked, ignore_errors=True)
    events = len(case.jumps)
    states = len(case.description.derivatives)
    print(f"  {model}: {cells}, {states} states, {events} events, {time.monotonic() - begun:.1f} s")
    return [f"`{model.partition(':')[2] or Path(model).name}`", str(states), str(events), *cells]


def main() -> None:
    parser = argparse.ArgumentParser()
    parser.add_argument("mocc")
    parser.add_argument("models", nargs="*")
    parser.add_argument("--library")
    parser.add_argument("--table")
    options = parser.parse_intermixed_args()
    mocc = str(Path(options.mocc).resolve())
    work = [(m, None) for m in options.models or EXAMPLES + MORE if not m.startswith("Modelica.")]
    if options.library:
        own = [m for m in options.models if m.startswith("Modelica.")]
        work += [(m, options.library) for m in (own if options.models else LIBRARY)]
    rows = []
    for model, library in work:
        with tempfile.TemporaryDirectory() as folder:
            rows.append(examined(mocc, model, library, Path(folder)))
    if options.table:
        head = ["model", "states", "events", "FMI 2, ME", "FMI 2, CS", "FMI 3, ME", "FMI 3, CS"]
        lines = [head, ["---"] * len(head), *rows]
        Path(options.table).write_text("".join(f"| {' | '.join(line)} |\n" for line in lines))
    if check.failures:
        raise SystemExit(f"{len(check.failures)} findings")


if __name__ == "__main__":
    main()
