"""FMUs: the archive, and errors with their codes."""

import os
import zipfile
from pathlib import Path

import numpy as np
import pytest

import mocc

from conftest import TANK

RUNTIME = Path(mocc.__file__).with_name("libmocc_fmu.so")


def stand_in(folder):
    """A file that looks like a library with the functions of FMI 2."""
    path = folder / "runtime.so"
    path.write_bytes(b"\x7fELF a stand-in \0fmi2Instantiate\0fmi2DoStep\0fmi2GetDerivatives\0")
    return path


def test_an_fmu_holds_the_model_and_its_runtime(tmp_path):
    runtime = stand_in(tmp_path)
    path = mocc.export_fmu(TANK, tmp_path / "tank.fmu", set={"x_0": 3}, fmi=2, type="cs", runtime=runtime)
    with zipfile.ZipFile(path) as archive:
        names = set(archive.namelist())
        description = archive.read("modelDescription.xml").decode()
    assert names == {
        "modelDescription.xml",
        "binaries/linux64/Tank.so",
        "resources/model.mocc",
        "model.png",
        "extra/mocc/reference.csv",
    }
    assert 'fmiVersion="2.0"' in description and "<CoSimulation" in description
    assert "<ModelExchange" not in description and 'start="3.0"' in description


@pytest.mark.skipif(not RUNTIME.exists(), reason="the package was built without the runtime")
def test_the_package_has_a_runtime(tmp_path):
    path = mocc.export_fmu(TANK, tmp_path / "tank.fmu")
    with zipfile.ZipFile(path) as archive:
        assert archive.read("binaries/x86_64-linux/Tank.so") == RUNTIME.read_bytes()


@pytest.mark.skipif(not RUNTIME.exists(), reason="the package was built without the runtime")
def test_a_plan_runs_an_fmu_if_the_call_names_it(tmp_path):
    path = mocc.export_fmu("model Decay parameter Real k = 1; Real x(start = 1, fixed = true); equation der(x) = -k*x; "
                           "annotation(experiment(StopTime = 1)); end Decay;", tmp_path / "decay.fmu")
    t = np.linspace(0, 1, 21)
    plan = {
        "time": {"column": "t", "unit": "s"},
        "signals": {"x": {"variable": "x", "unit": "1", "sigma": 1e-3}},
        "free": {"k": {"min": 0.1, "max": 10}},
    }
    data = {"decay": {"t": t, "x": np.exp(-2 * t)}}
    found = mocc.calibrate(model=path, data=data, profiles=False, **plan)
    assert found.values["k"] == pytest.approx(2, rel=1e-4)
    file = tmp_path / "plan.toml"
    np.savetxt(tmp_path / "decay.csv", np.column_stack([t, data["decay"]["x"]]), delimiter=",", header="t,x", comments="")
    file.write_text("""model = "decay.fmu"
recordings = [{ file = "decay.csv" }]
data = { folder = "." }
time = { column = "t", unit = "s" }
signals = { x = { variable = "x", unit = "1", sigma = 1e-3 } }
free = { k = { min = 0.1, max = 10 } }
""")
    with pytest.raises(mocc.RequestError, match="MO1321"):
        mocc.calibrate(file, profiles=False)
    assert mocc.calibrate(file, profiles=False, allow_fmu=path).values["k"] == pytest.approx(2, rel=1e-4)


def test_wrong_arguments(tmp_path):
    with pytest.raises(mocc.RequestError, match="fmi is 4"):
        mocc.export_fmu(TANK, tmp_path / "tank.fmu", fmi=4)
    with pytest.raises(mocc.ModelError, match="MO0"):
        mocc.export_fmu("model M Real x = ; end M;", tmp_path / "m.fmu", fmi=2, runtime=stand_in(tmp_path))
    with pytest.raises(mocc.RequestError, match="MO1322"):
        mocc.export_fmu(TANK, tmp_path / "m.fmu", runtime=__file__)
    with pytest.raises(mocc.RequestError, match="not a compiled one"):
        mocc.export_fmu(mocc.compile(TANK), tmp_path / "m.fmu")


@pytest.mark.skipif(RUNTIME.exists() or "MOCC_FMU_RUNTIME" in os.environ, reason="the runtime is here")
def test_a_missing_runtime_is_named(tmp_path):
    with pytest.raises(mocc.RequestError, match="MO1300"):
        mocc.export_fmu(TANK, tmp_path / "tank.fmu")
