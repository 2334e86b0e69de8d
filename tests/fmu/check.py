"""Exported models in FMPy: validated, simulated by both kinds of FMI, and compared with `mocc simulate`.

    python tests/fmu/check.py target/release/mocc [MODEL...]

FMUs that mocc imports are compared too; `FMUS` names a folder with those of others. Needs `fmpy`. A model is a file, or `FILE:NAME`; without any the examples are taken. Exits with 1 if something differs.
"""

import csv
import ctypes
import json
import os
import subprocess
import sys
import tempfile
import threading
import time
from pathlib import Path

import numpy as np
from fmpy import extract, read_model_description, simulate_fmu
from fmpy.fmi3 import FMU3Model, FMU3Slave
from fmpy.validation import validate_fmu

from examples import EXAMPLES

ROOT = Path(__file__).resolve().parents[2]
# Largest differences in units of the range of a variable: at communication points, and on a grid between them, where
# both are interpolated and a few points lie next to jumps.
AT_POINTS = 1e-5
BETWEEN = 1e-3

failures = []


def expect(holds: bool, what: str) -> None:
    if not holds:
        failures.append(what)
        print(f"  wrong: {what}")


def run(mocc: str, *arguments: str, **environment: str) -> None:
    environment = {**os.environ, **environment}
    done = subprocess.run([mocc, *arguments], cwd=ROOT, env=environment, capture_output=True, text=True)
    if done.returncode:
        raise SystemExit(f"mocc {' '.join(arguments)}\n{done.stderr}")


def reference(mocc: str, model: list[str], folder: Path) -> tuple[list[str], np.ndarray]:
    """The names of the columns and the rows of a run."""
    path = folder / "reference.csv"
    run(mocc, "simulate", *model, "--output", str(path))
    with open(path) as file:
        names = [column.split(" [")[0] for column in next(csv.reader(file))]
    return names, np.genfromtxt(path, delimiter=",", skip_header=1)


def compare(mocc: str, model: str, folder: Path) -> None:
    """Validates a model in both versions and compares both kinds with a run."""
    file, _, name = model.partition(":")
    arguments = [file, *(["--model", name] if name else [])]
    names, rows = reference(mocc, arguments, folder)
    t = rows[:, 0]
    jumps = t[1:][np.diff(t) == 0]
    for version in ("2", "3"):
        fmu = str(folder / f"model{version}.fmu")
        run(mocc, "export", "fmu", *arguments, "--fmi", version, "-o", fmu)
        found = validate_fmu(fmu)
        expect(not found, f"{model}, FMI {version}: {found[:2]}")
        description = read_model_description(fmu)
        default = description.defaultExperiment
        start, stop, step = (float(x) for x in (default.startTime, default.stopTime, default.stepSize))
        known = {
            v.name
            for v in description.modelVariables
            if v.variability == "continuous" and v.causality in ("local", "output")
        }
        picked = [n for n in names[1:] if n in known][:100]
        for kind, offered in (
            ("ModelExchange", description.modelExchange),
            ("CoSimulation", description.coSimulation),
        ):
            if offered is None:
                continue
            exchange = kind == "ModelExchange"
            result = simulate_fmu(
                fmu,
                fmi_type=kind,
                output=picked,
                start_time=start,
                stop_time=stop,
                output_interval=step,
                relative_tolerance=0.1 * float(default.tolerance) if exchange else None,
            )
            times = result["time"]
            expect(times[-1] > stop - 1e-6 * (stop - start), f"{model}, {kind}: ends at {times[-1]} s")
            grid = np.linspace(start, stop, 503)[1:-1] if exchange else times
            away = [abs(grid - jump) > 1e-8 + 2e-6 * (stop - start) for jump in jumps]
            kept = np.all(away, axis=0) if away else np.ones(len(grid), bool)
            worst, of = 0.0, ""
            for n in picked:
                expected = rows[:, names.index(n)]
                size = max(np.ptp(expected), 1e-3 * abs(expected).max(), 1e-9)
                a = np.interp(grid, t, expected)
                b = np.interp(grid, times, result[n].astype(float))
                error = abs(a - b)[kept] / size
                error = np.percentile(error, 98) if exchange else error.max(initial=0.0)
                worst, of = max((worst, of), (error, n))
            expect(worst < (BETWEEN if exchange else AT_POINTS), f"{model}, FMI {version}, {kind}: `{of}` differs by {worst:.1e}")
            print(f"  {model}, FMI {version}, {kind}: {len(times)} rows, {worst:.1e} at most")


def slave(fmu: str, folder: str):
    """An instance for Co-Simulation in step mode, and the value references of its variables."""
    description = read_model_description(fmu)
    identifier = description.coSimulation.modelIdentifier
    made = FMU3Slave(guid=description.guid, unzipDirectory=folder, modelIdentifier=identifier, instanceName="x")
    made.instantiate()
    made.enterInitializationMode(startTime=0, stopTime=0.12)
    made.exitInitializationMode()
    return made, {v.name: v.valueReference for v in description.modelVariables}


def states_and_threads(mocc: str, folder: Path) -> None:
    """A saved state goes on as the run without, and eight threads with an instance each agree."""
    fmu = str(folder / "threads.fmu")
    run(mocc, "export", "fmu", "examples/valve52.mol", "--fmi", "3", "-o", fmu)
    unpacked = extract(fmu)

    def steps(instance, first: int, last: int) -> None:
        for k in range(first, last):
            instance.doStep(k * 1e-3, 1e-3)

    plain, references = slave(fmu, unpacked)
    read = [references[n] for n in ("s", "p12")]
    steps(plain, 0, 30)
    state = plain.getFMUState()
    stored = plain.serializeFMUState(state)
    steps(plain, 30, 60)
    expected = np.array(plain.getFloat64(read))
    plain.setFMUState(state)
    steps(plain, 30, 60)
    expect(np.allclose(plain.getFloat64(read), expected, rtol=1e-4, atol=1e-8), "a restored state")
    other, _ = slave(fmu, unpacked)
    other.setFMUState(other.deserializeFMUState(stored))
    steps(other, 30, 60)
    expect(np.allclose(other.getFloat64(read), expected, rtol=1e-4, atol=1e-8), "a serialized state")

    results: list[list[float]] = []

    def work() -> None:
        instance, _ = slave(fmu, unpacked)
        steps(instance, 0, 60)
        results.append(list(instance.getFloat64(read)))
        instance.terminate()

    threads = [threading.Thread(target=work) for _ in range(8)]
    [thread.start() for thread in threads]
    [thread.join() for thread in threads]
    expect(len(results) == 8 and all(r == results[0] for r in results), f"eight threads: {results}")
    print("  states and threads")


def small_and_quick(mocc: str, folder: Path) -> None:
    """Archives of the valve are small and made without another program; their steps take no longer than a run."""
    total = 0
    for version in "23":
        fmu = folder / f"small{version}.fmu"
        begun = time.perf_counter()
        run(mocc, "export", "fmu", "examples/valve52.mol", "--fmi", version, "-o", str(fmu), PATH="")
        seconds = time.perf_counter() - begun
        total += fmu.stat().st_size
        # Whoever else uses the machine makes this longer.
        expect(seconds < 2, f"export for FMI {version}: {seconds:.2f} s")
    expect(total < 4e6, f"both archives have {total / 1e6:.2f} MB")

    # The runs of the engine and those in steps take turns.
    unpacked = extract(str(folder / "small3.fmu"))
    engine, stepped = [], []
    for _ in range(9):
        table = ("--output", str(folder / "run.csv"), "--interval", "1e-3", "--json")
        command = [mocc, "simulate", "examples/valve52.mol", *table]
        done = subprocess.run(command, cwd=ROOT, capture_output=True, text=True, check=True)
        engine.append(json.loads(done.stdout)["statistics"]["simulated"])
        instance, _ = slave(str(folder / "small3.fmu"), unpacked)
        begun = time.perf_counter()
        for k in range(120):
            instance.doStep(k * 1e-3, 1e-3)
        stepped.append(time.perf_counter() - begun)
        instance.terminate()
        instance.freeInstance()
    ratio = min(stepped) / min(engine)
    expect(ratio < 1.5, f"120 steps of 1 ms take {ratio:.2f} times the run")
    print(f"  both archives {total / 1e6:.2f} MB; 120 steps {1e3 * min(stepped):.1f} ms, {ratio:.2f} times the run")


def derivatives(mocc: str, folder: Path) -> None:
    """Directional derivatives equal differences, and adjoint ones their transpose."""
    fmu = str(folder / "derivatives.fmu")
    run(mocc, "export", "fmu", "tests/fmu/models.mo", "--model", "Hybrid.Smooth", "--fmi", "3", "-o", fmu)
    description = read_model_description(fmu)
    identifier = description.modelExchange.modelIdentifier
    model = FMU3Model(guid=description.guid, unzipDirectory=extract(fmu), modelIdentifier=identifier, instanceName="x")
    model.instantiate()
    model.enterInitializationMode(startTime=0)
    model.exitInitializationMode()
    model.updateDiscreteStates()
    model.enterContinuousTimeMode()
    rates = [unknown.variable for unknown in description.derivatives]
    states, unknowns = [r.derivative.valueReference for r in rates], [r.valueReference for r in rates]
    n = len(states)
    x, dx = (ctypes.c_double * n)(), (ctypes.c_double * n)()
    model.getContinuousStates(x, n)
    exact = np.array([model.getDirectionalDerivative(unknowns, [s], [1.0]) for s in states]).T

    def rate() -> np.ndarray:
        model.setContinuousStates(x, n)
        model.getContinuousStateDerivatives(dx, n)
        return np.array(dx)

    for k in range(n):
        at, h = x[k], 1e-6
        x[k] = at + h
        above = rate()
        x[k] = at - h
        below = rate()
        x[k] = at
        difference = (above - below) / (2 * h)
        expect(np.allclose(exact[:, k], difference, rtol=1e-6, atol=1e-8), f"derivatives by state {k}: {exact[:, k]}, {difference}")
    rate()
    seed = np.arange(1.0, n + 1)
    adjoint = model.getAdjointDerivative(unknowns, states, list(seed), nSensitivity=n)
    expect(np.allclose(adjoint, exact.T @ seed), f"adjoint derivatives: {adjoint}")
    print("  derivatives")


def casadi_reads_the_jacobian(mocc: str, folder: Path) -> None:
    """The Jacobian by CasADi, where it is installed, is that of the equations at a = 1, b = 2, where z = 1."""
    try:
        import casadi
    except ImportError:
        return
    fmu = str(folder / "casadi.fmu")
    run(mocc, "export", "fmu", "tests/fmu/models.mo", "--model", "Hybrid.Smooth", "--fmi", "3", "-o", fmu)
    model = casadi.DaeBuilder("smooth", str(extract(fmu)), {})
    found = np.array(model.create("f", ["x"], ["ode"]).jacobian()([1, 2], 0))
    expected = np.array([[-1.5, -0.25 + np.cos(2)], [-np.exp(-1) - 0.5, -0.25]])
    expect(np.allclose(found, expected), f"CasADi: {found}")
    print("  CasADi")


def imported(mocc: str, fmu: str, folder: Path) -> None:
    """An FMU, run by mocc, equals the same run in FMPy."""
    description = read_model_description(fmu)
    default = description.defaultExperiment
    for flag, kind, offered in (
        ("me", "ModelExchange", description.modelExchange),
        ("cs", "CoSimulation", description.coSimulation),
    ):
        if offered is None:
            continue
        path = folder / "imported.csv"
        done = subprocess.run(
            [mocc, "simulate", fmu, "--fmi-type", flag, "--output", str(path)], capture_output=True, text=True
        )
        expect(done.returncode == 0, f"{fmu}, {flag}: {done.stderr}")
        if done.returncode:
            continue
        with open(path) as file:
            names = [column.split(" [")[0] for column in next(csv.reader(file))]
        rows = np.atleast_2d(np.genfromtxt(path, delimiter=",", skip_header=1))
        t = rows[:, 0]
        known = {v.name for v in description.modelVariables if v.type != "String" and not v.dimensions}
        picked = [n for n in names[1:] if n in known][:100]
        step = float(default.stepSize) if default and default.stepSize else (t[-1] - t[0]) / 500
        exchange = kind == "ModelExchange"
        result = simulate_fmu(
            fmu,
            fmi_type=kind,
            output=picked,
            start_time=t[0],
            stop_time=t[-1],
            output_interval=step,
            relative_tolerance=1e-8 if exchange else None,
        )
        # The last row may lie at an event that ends the run.
        grid = np.linspace(t[0], t[-1], 503)[1:-1] if exchange else result["time"][:-1]
        jumps = t[1:][np.diff(t) == 0]
        away = [abs(grid - jump) > 1e-7 + 2e-6 * (t[-1] - t[0]) for jump in jumps]
        kept = np.all(away, axis=0) if away else np.ones(len(grid), bool)
        worst, of = 0.0, ""
        for n in picked:
            found = rows[:, names.index(n)]
            size = max(np.ptp(found), 1e-3 * abs(found).max(), 1e-9)
            error = abs(np.interp(grid, t, found) - np.interp(grid, result["time"], result[n].astype(float)))
            error = error[kept] / size
            error = np.percentile(error, 98) if exchange else error.max(initial=0.0)
            worst, of = max((worst, of), (error, n))
        expect(worst < (BETWEEN if exchange else 1e-9), f"{fmu}, {kind}: `{of}` differs by {worst:.1e}")
        print(f"  {Path(fmu).name} imported, {kind}: {len(rows)} rows, {worst:.1e} at most")


def imports(mocc: str, folder: Path) -> None:
    """Own FMUs, and those of others in the folder that `FMUS` names, in both programs."""
    for version in ("2", "3"):
        for k, model in enumerate(("examples/valve52.mol", "examples/bouncing_ball.mol")):
            fmu = str(folder / f"import{k}_{version}.fmu")
            run(mocc, "export", "fmu", model, "--fmi", version, "-o", fmu)
            imported(mocc, fmu, folder)
    for fmu in sorted(Path(os.environ["FMUS"]).glob("*.fmu")) if "FMUS" in os.environ else []:
        imported(mocc, str(fmu), folder)


def steps_off_the_grid(mocc: str, folder: Path) -> None:
    """Values at communication points that are no rows of the default run: sums of held inputs."""
    fmu = str(folder / "off.fmu")
    run(mocc, "export", "fmu", "tests/fmu/models.mo", "--model", "Hybrid.Integrator", "--fmi", "3", "-o", fmu)
    unpacked = extract(fmu)
    for size in (0.07, 0.1, 0.23):
        instance, references = slave(fmu, unpacked)
        expected = 0.0
        for k in range(15):
            instance.setFloat64([references["u"]], [0.01 * k])
            instance.doStep(k * size, size)
            expected += 0.01 * k * size
            found = instance.getFloat64([references["y"]])[0]
            expect(abs(found - expected) < 1e-9, f"after {k + 1} steps of {size} s: {found}, {expected}")
    print("  steps off the grid")


PLANT = """
model Plant
  {blocks}
equation
  {equations}
  annotation(experiment(StopTime = 2));
end Plant;
"""


def components(mocc: str, folder: Path) -> None:
    """An FMU inside a model holds its inputs from one communication point to the next: sums in closed form."""
    for version in ("2", "3"):
        fmu = folder / f"part{version}.fmu"
        model = ["tests/fmu/models.mo", "--model", "Hybrid.Integrator"]
        run(mocc, "export", "fmu", *model, "--fmi", version, "-o", str(fmu))
        run(mocc, "import", str(fmu), "-o", str(folder / "Part.mo"), "--name", "Part")
        plant = folder / "plant.mo"
        blocks = "Part a(k = 3); Part b(k = 2, communicationStep = 0.25); Part c;"
        equations = "a.u = 1 - a.y; b.u = cos(time); c.u = -b.y;"
        part = (folder / "Part.mo").read_text()
        plant.write_text(part + PLANT.format(blocks=blocks, equations=equations))
        refused = subprocess.run([mocc, "simulate", str(plant)], cwd=folder, capture_output=True, text=True)
        expect(refused.returncode != 0 and "--allow-fmu" in refused.stderr, f"foreign code on its own: {refused.stderr}")
        run(mocc, "simulate", str(plant), "--allow-fmu", str(fmu), "--output", str(folder / "plant.csv"))
        with open(folder / "plant.csv") as file:
            names = [column.split(" [")[0] for column in next(csv.reader(file))]
        rows = np.genfromtxt(folder / "plant.csv", delimiter=",", skip_header=1)
        last = dict(zip(names, rows[-1]))
        expect(abs(last["a.y"] - (1 - 0.7**20)) < 1e-6, f"a loop through an FMU: {last['a.y']}")
        expected = 0.5 * np.cos(0.25 * np.arange(8)).sum()
        expect(abs(last["b.y"] - expected) < 1e-6, f"a sampled input: {last['b.y']}, {expected}")
        expect(last["a.isHigh"] == 1 and last["c.n"] == np.floor(last["c.y"]), "outputs of other types")
    sweep = folder / "sweep.csv"
    arguments = ["--vary", "a.k=1:5:9", "--measure", "y = final(a.y)", "--allow-fmu", str(fmu), "--output", str(sweep)]
    run(mocc, "sweep", str(plant), *arguments)
    found = np.genfromtxt(sweep, delimiter=",", names=True)
    expected = [1 - (1 - 0.1 * k) ** 20 for k in np.linspace(1, 5, 9)]
    expect(np.allclose(found["y"], expected, atol=1e-6), f"a sweep: {found['y']}")
    # What a command unpacks is gone when it ends.
    scratch = folder / "scratch"
    scratch.mkdir()
    for command in (["simulate", "--output", str(folder / "plant.csv")], ["flatten"], ["structure"]):
        run(mocc, *command, str(plant), "--allow-fmu", str(fmu), TMPDIR=str(scratch))
        left = [path.name for path in scratch.iterdir()]
        expect(not left, f"{command[0]} leaves {left}")
    print("  components")


def coupled(mocc: str, folder: Path) -> None:
    """Two FMUs in libcosim, where it is installed: y of the one integrates that of the other, 0 after one step."""
    try:
        from libcosimpy.CosimExecution import CosimExecution
        from libcosimpy.CosimObserver import CosimObserver
        from libcosimpy.CosimSlave import CosimLocalSlave
    except ImportError:
        return
    fmu = str(folder / "coupled.fmu")
    run(mocc, "export", "fmu", "tests/fmu/models.mo", "--model", "Hybrid.Integrator", "--fmi", "2", "-o", fmu)
    references = {v.name: v.valueReference for v in read_model_description(fmu).modelVariables}
    execution = CosimExecution.from_step_size(100_000_000)
    first, second = (execution.add_local_slave(CosimLocalSlave(fmu, name)) for name in ("first", "second"))
    observer = CosimObserver.create_last_value()
    execution.add_observer(observer)
    execution.real_initial_value(first, references["u"], 1.0)
    execution.connect_real_variables(first, references["y"], second, references["u"])
    execution.step(20)
    x = observer.last_real_values(first, [references["y"]])[0]
    y = observer.last_real_values(second, [references["y"]])[0]
    # Inputs are held: 0.1 s times the sum of the values before, with or without that of the last step.
    expect(abs(x - 2) < 1e-6 and any(abs(y - 0.01 * s) < 1e-6 for s in (171, 190)), f"libcosim: {x}, {y}")
    print("  libcosim")


def two_in_one_process(mocc: str, folder: Path) -> None:
    """Two different FMUs in this process step by turns and agree with each alone."""
    found = []
    for model in ("examples/valve52.mol", "examples/valve32.mol"):
        fmu = str(folder / f"{Path(model).stem}_two.fmu")
        run(mocc, "export", "fmu", model, "--fmi", "3", "-o", fmu)
        unpacked = extract(fmu)
        alone, _ = slave(fmu, unpacked)
        together, _ = slave(fmu, unpacked)
        floats = [v.valueReference for v in read_model_description(fmu).modelVariables if v.type == "Float64"]
        found.append((alone, together, floats[1:50]))
    for alone, _, _ in found:
        for k in range(50):
            alone.doStep(k * 1e-3, 1e-3)
    for k in range(50):
        for _, together, _ in found:
            together.doStep(k * 1e-3, 1e-3)
    for alone, together, read in found:
        expect(list(alone.getFloat64(read)) == list(together.getFloat64(read)), "two FMUs in one process")
    print("  two FMUs in one process")


def main() -> None:
    mocc = str(Path(sys.argv[1]).resolve())
    with tempfile.TemporaryDirectory() as folder:
        for model in sys.argv[2:] or EXAMPLES:
            compare(mocc, model, Path(folder))
        if not sys.argv[2:]:
            small_and_quick(mocc, Path(folder))
            states_and_threads(mocc, Path(folder))
            derivatives(mocc, Path(folder))
            casadi_reads_the_jacobian(mocc, Path(folder))
            imports(mocc, Path(folder))
            steps_off_the_grid(mocc, Path(folder))
            components(mocc, Path(folder))
            coupled(mocc, Path(folder))
            two_in_one_process(mocc, Path(folder))
    if failures:
        raise SystemExit(f"{len(failures)} findings")


if __name__ == "__main__":
    main()
