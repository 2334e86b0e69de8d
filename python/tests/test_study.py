"""Calibration, diagnosis and sweeps."""

import json
import os
import signal
import subprocess
import sys
import threading
import time
from concurrent.futures import ProcessPoolExecutor, ThreadPoolExecutor

import numpy as np
import pytest
from conftest import PLAN, ROOT, TANK, recording

import mocc

pandas = pytest.importorskip("pandas")


@pytest.fixture(scope="module")
def fitted() -> mocc.Calibration:
    return mocc.calibrate(PLAN, {"one": recording(0.8, 1), "two": recording(0.8, 2)})


def test_a_calibration_finds_the_parameters(fitted):
    assert fitted.names == ["k", "x_0"] and fitted.converged
    for name, true in (("k", 0.8), ("x_0", 2.0)):
        assert abs(fitted.values[name] - true) < 4 * fitted.errors[name] < 0.05
    assert fitted.units == {"k": "1/s", "x_0": "m"} and fitted.bounds["k"] == (0.05, 5)
    assert np.allclose(np.sqrt(np.diag(fitted.covariance)), list(fitted.errors.values()), rtol=1e-9)
    assert "extends Tank" in fitted.model
    assert fitted.report.html.startswith("<!") and "<table>" in fitted._repr_html_()
    assert "converged" in repr(fitted)


def test_values_that_are_missing_are_not_compared(fitted):
    one, two = recording(0.8, 1), recording(0.8, 2)
    level = "level_mm"
    bad = np.arange(len(one[level])) % 7 == 3

    def fit(column):
        changed = {**one, level: column}
        return mocc.calibrate(PLAN, {"one": changed, "two": two})

    values = np.where(bad, np.nan, one[level])
    expected = fit(values).values
    assert expected != fitted.values
    masked = np.ma.masked_array(np.where(bad, 1e9, one[level]), mask=bad)
    assert fit(masked).values == expected
    nullable = pandas.array([None if b else float(x) for b, x in zip(bad, one[level], strict=True)], dtype="Float64")
    assert fit(nullable).values == expected
    texts = ["n/a" if b else repr(float(x)) for b, x in zip(bad, one[level], strict=True)]
    with pytest.warns(mocc.ModelWarning, match=f"`{level}` of `one`: .* values are no numbers"):
        assert fit(texts).values == expected


def test_durations_have_a_unit_of_their_own(fitted):
    one, two = recording(0.8, 1), recording(0.8, 2)
    timed = {name: {**frame, "t": pandas.to_timedelta(frame["t"], unit="s")} for name, frame in {"one": one, "two": two}.items()}
    assert np.allclose(list(mocc.calibrate(PLAN, timed).values.values()), list(fitted.values.values()), rtol=1e-6)
    for zone in (None, "UTC"):
        begin = pandas.Timestamp("2026-03-01 10:00", tz=zone)
        dated = {name: {**frame, "t": begin + frame["t"]} for name, frame in timed.items()}
        assert np.allclose(list(mocc.calibrate(PLAN, dated).values.values()), list(fitted.values.values()), rtol=1e-6)
    with pytest.raises(mocc.RequestError, match="count in seconds"):
        mocc.calibrate({**PLAN, "time": {"column": "t", "unit": "ms"}}, timed)


def test_a_signal_without_values_is_said():
    plan = {**PLAN, "signals": {**PLAN["signals"], "speed": {"variable": "y", "unit": "m", "sigma": 1.0}}}
    frames = {name: {**recording(0.8, seed), "speed": ["n/a"] * 81} for seed, name in enumerate(["one", "two"])}
    with pytest.warns(mocc.ModelWarning, match="no recording has a value of `speed`"):
        mocc.calibrate(plan, frames)


def test_residuals_and_jacobian_are_those_of_the_fit(fitted, tmp_path):
    r = fitted.residuals()
    assert r.shape == (162,) and abs((r @ r) / 160 - 1) < 0.3
    j = fitted.jacobian()
    assert j.shape == (162, 2)
    # The covariance is the inverse of J'J, and the gradient vanishes at the minimum.
    assert np.allclose(np.linalg.inv(j.T @ j), fitted.covariance, rtol=1e-6)
    assert np.abs(j.T @ r * np.sqrt(np.diag(fitted.covariance))).max() < 1e-2
    theta = np.array(list(fitted.values.values()))
    for k in range(2):
        h = 1e-4 * theta[k] * np.eye(2)[k]
        difference = (fitted.residuals(theta + h) - fitted.residuals(theta - h)) / (2e-4 * theta[k])
        assert np.allclose(difference, j[:, k], atol=1e-3 * np.abs(j[:, k]).max())
    assert (fitted.residuals({"k": 0.8}) == fitted.residuals([0.8, fitted.values["x_0"]])).all()
    fitted.report.save(tmp_path / "page.html")
    assert "iframe" in fitted.report._repr_html_()


def test_scipy_finds_the_same_minimum(fitted):
    optimize = pytest.importorskip("scipy.optimize")
    found = optimize.least_squares(fitted.residuals, [0.3, 1.0], fitted.jacobian, x_scale=[1, 1])
    assert np.allclose(found.x, list(fitted.values.values()), rtol=1e-4)


def test_a_model_with_settings_and_names_of_keys():
    m = mocc.compile(TANK, set={"x_0": 2.0})
    keys = {**PLAN, "model": m, "free": {"k": {}}}
    heard = []
    c = mocc.calibrate(**keys, data={"one": recording(0.8, 1)}, profiles=False, progress=heard.append)
    assert abs(c.values["k"] - 0.8) < 0.02
    assert any("chi-square" in line for line in heard)


def test_a_table_of_recordings_in_memory():
    table = pandas.DataFrame({"file": ["a", "b"], "split": ["train", "validation"], "x_0": [2.0, 2.0]})
    plan = {
        **PLAN,
        "data": {"folder": ".", "table": "table", "file": "file", "split": "split"},
        "conditions": {"x_0": {"parameter": "x_0", "unit": "m"}},
        "free": {"k": {"min": 0.05, "max": 5}},
    }
    c = mocc.calibrate(plan, {"a": recording(0.8, 1), "b": recording(0.8, 2)}, table=table)
    assert [r["split"] for r in c.result["recordings"]] == ["train", "validation"]


def test_frames_give_the_result_of_files(tmp_path):
    (tmp_path / "tank.mol").write_text(TANK)
    frame = recording(0.8, 1)
    frame.to_csv(tmp_path / "one.csv", index=False)
    plan = tmp_path / "tank.toml"
    plan.write_text("""
        model = "tank.mol"
        [data]
        folder = "."
        [[recordings]]
        file = "one.csv"
        [time]
        column = "t"
        unit = "s"
        [signals]
        level_mm = { variable = "x", unit = "mm", sigma = 10.0 }
        [free]
        k = { min = 0.05, max = 5 }
    """)
    of_files = mocc.calibrate(plan)
    of_frames = mocc.calibrate(plan, {"one.csv": frame})
    assert of_files.values == of_frames.values and (of_files.covariance == of_frames.covariance).all()
    done = subprocess.run([sys.executable, "-m", "mocc", "calibrate", str(plan), "--out", str(tmp_path / "out")],
                          check=True, capture_output=True)
    assert done.returncode == 0
    command = json.loads((tmp_path / "out" / "calibration.json").read_text())
    assert command["parameters"] == of_frames.result["parameters"]


def with_nan(frame, rows):
    frame.loc[rows, "level_mm"] = np.nan
    return frame


def test_missing_values_are_skipped():
    c = mocc.calibrate(PLAN, {"one": with_nan(recording(0.8, 1), [3, 4])})
    assert c.residuals().shape == (79,)
    assert "2 values skipped" in c.result["repairs"][0]


@pytest.mark.parametrize(
    ("change", "frame", "code"),
    [
        ({}, lambda f: f.rename(columns={"level_mm": "level"}), "MO1013"),
        ({}, lambda f: f.drop(columns="t"), "MO1013"),
        ({}, lambda f: with_nan(f, slice(None)), "MO1041"),
        ({}, lambda f: f.assign(t=f["t"].to_numpy()[::-1]), "MO1011"),
        ({}, lambda f: f.assign(level_mm="high"), "MO1041"),
        ({"signals": {"level_mm": {"variable": "x", "unit": "bar"}}}, None, "MO1047"),
        ({"signals": {"level_mm": {"variable": "x", "unit": "inch"}}}, None, "MO1005"),
        ({"signals": {"level_mm": {"variable": "z", "unit": "mm"}}}, None, "MO1014"),
        ({"free": {"q": {}}}, None, "MO1015"),
        ({"fre": {}}, None, "MO1402"),
        ({"signals": None}, None, "MO1031"),
    ],
)
def test_wrong_plans_and_recordings_are_one_clear_exception(change, frame, code):
    data = recording(0.8, 1)
    with pytest.raises(mocc.RequestError) as caught:
        mocc.calibrate({**PLAN, **change}, {"one": frame(data) if frame else data})
    assert caught.value.code == code, str(caught.value)


@pytest.mark.parametrize(
    ("arguments", "text"),
    [
        ({}, "give a plan file"),
        ({"plan": "a.toml", "free": {}}, "either a file or keys"),
        ({"plan": PLAN, "data": [1]}, "map names"),
        ({"plan": PLAN, "data": {"one": 3}}, "expected a table"),
        ({"plan": PLAN, "data": {"one": {"t": [1, 2], "level_mm": [1]}}}, "1 rows instead of 2"),
        ({"plan": {**PLAN, "window": object()}, "data": {"one": {"t": [0, 1], "level_mm": [1, 1]}}}, "cannot hold a"),
        ({"plan": "no_such.toml"}, "no_such.toml"),
        ({"plan": {**PLAN, "recordings": [{"file": "a"}]}, "data": {"a": recording(1, 1), "b": recording(1, 2)}}, "file `b`"),
    ],
)
def test_wrong_arguments_are_one_clear_exception(arguments, text):
    with pytest.raises(mocc.RequestError, match=text):
        mocc.calibrate(**arguments)


@pytest.mark.parametrize(
    ("theta", "text"),
    [([1.0], "1 values for 2"), ([1.0, np.nan], "nan"), ({"q": 1.0}, "not fitted"), ("k", "numbers")],
)
def test_a_wrong_theta_is_one_clear_exception(fitted, theta, text):
    with pytest.raises(mocc.RequestError, match=text):
        fitted.residuals(theta)


# ---- Diagnosis ----


def test_a_complete_model_lacks_nothing():
    d = mocc.diagnose(PLAN, {"one": recording(0.8, 1), "two": recording(0.8, 2)})
    assert (d.verdict, d.effects, d.amended) == ("complete", [], None)
    assert "complete" in d.summary and "complete" in repr(d) and d.result["complete"]
    assert d.report.html.startswith("<!") and "iframe" in d._repr_html_()


def test_the_valve_of_the_tutorial_gets_its_detent():
    folder = ROOT / "docs" / "tutorial"
    heard = []
    d = mocc.diagnose(folder / "plan.toml", progress=heard.append)
    effect = d.effects[0]
    assert (d.verdict, effect.component) == ("effect_found", "Effects.Detent") and heard
    assert isinstance(d, mocc.Diagnosis) and isinstance(effect, mocc.Effect) and isinstance(d.report, mocc.Report)
    assert isinstance(effect.parameters["F"], mocc.Estimate) and effect.parameters["F"].value > 0
    assert effect.at and effect.law and effect.explains and effect.over is not None
    assert effect.parameters["F"].unit == "N" and effect.parameters["F"].error < effect.parameters["F"].value
    assert mocc.compile(d.amended).name.endswith("with_Detent")
    # The same from memory.
    table = pandas.read_csv(folder / "recordings" / "experiments.csv")
    frames = {name: pandas.read_csv(folder / "recordings" / name) for name in table["file"]}
    again = mocc.diagnose(folder / "plan.toml", frames, table=table, folder="no_such_folder")
    assert {**again.result, "seconds": 0} == {**d.result, "seconds": 0}


def test_a_diagnosis_of_many_recordings_is_the_same_on_an_executor():
    # From three recordings on, their number is a condition: the workers know it too.
    frames = {name: recording(0.8, seed) for seed, name in enumerate(["one", "two", "three", "four"], 1)}
    here = mocc.diagnose(PLAN, frames)
    with ThreadPoolExecutor(2) as executor:
        there = mocc.diagnose(PLAN, frames, executor=executor)
    assert {**there.result, "seconds": 0} == {**here.result, "seconds": 0}


def test_a_time_limit_ends_a_diagnosis():
    d = mocc.diagnose(ROOT / "docs" / "tutorial" / "plan.toml", time_limit=0)
    assert not d.result["complete"]


def test_ctrl_c_ends_a_diagnosis():
    def press():
        time.sleep(1)
        os.kill(os.getpid(), signal.SIGINT)

    thread = threading.Thread(target=press)
    thread.start()
    begun = time.monotonic()
    with pytest.raises(KeyboardInterrupt):
        mocc.diagnose(ROOT / "examples" / "valve52.toml", folder=ROOT / "tests" / "data" / "teststand" / "case-c")
    assert time.monotonic() - begun < 6
    thread.join()


def test_a_wrong_diagnosis_is_one_clear_exception():
    with pytest.raises(mocc.RequestError, match="negative"):
        mocc.diagnose(PLAN, {}, time_limit=-1)
    with pytest.raises(mocc.RequestError) as caught:
        mocc.diagnose(PLAN, {"one": recording(0.8, 1)}, effects="no_such_folder")
    assert caught.value.code == "MO1020"
    with pytest.raises(mocc.RequestError, match="did you mean `SensorGain`") as caught:
        mocc.diagnose(PLAN, {"one": recording(0.8, 1)}, only="SensorGian")
    assert caught.value.code == "MO1023"


def test_a_search_may_be_restricted():
    frames = {name: recording(0.8, seed) for seed, name in enumerate(["one", "two"], 1)}
    for frame in frames.values():
        frame["level_mm"] += 100 * frame["t"]
    d = mocc.diagnose(PLAN, frames, only=["SensorDrift", "SensorGain"])
    assert [effect.component for effect in d.effects] == ["Effects.SensorDrift"]
    assert "restricted to SensorDrift, SensorGain" in d.summary


# ---- Sweeps ----


def test_a_sweep_is_a_table_with_units(tank):
    frame = mocc.sweep(tank, {"k": [0.5, 1.0], "n": [2, 4]}, {"level": "final(x)", "half": "when(x < 1)"})
    assert frame.columns.tolist() == ["run", "k", "n", "level", "half", "status", "error", "steps", "events"]
    assert frame["k"].tolist() == [0.5, 0.5, 1.0, 1.0] and frame["n"].tolist() == [2, 4, 2, 4]
    assert np.allclose(frame["level"], 2 * np.exp(-4 * frame["k"] * frame["n"] / 2), atol=1e-5)
    assert np.allclose(frame["half"], np.log(2) / (frame["k"] * frame["n"] / 2), atol=1e-4)
    assert (frame["status"] == "ok").all() and frame.attrs["units"]["level"] == "m"


def test_a_sample_and_numbers_of_threads(tank):
    arguments = {"vary": {"k": (0.1, 1.0), "x_0": (1.0, 2.0)}, "measures": {"level": "final(x)"}, "sample": 100}
    frame = mocc.sweep(tank, **arguments, seed=3)
    assert len(frame) == 100 and frame["k"].between(0.1, 1.0).all()
    assert mocc.sweep(tank, **arguments, seed=3, jobs=1).equals(frame)
    assert not mocc.sweep(tank, **arguments, seed=4).equals(frame)


@pytest.mark.parametrize("kind", [ProcessPoolExecutor, ThreadPoolExecutor])
def test_executors_give_the_same_table(tank, kind):
    import multiprocessing

    arguments = {"vary": {"k": np.linspace(0.1, 1.0, 150)}, "measures": {"level": "final(x)"}}
    frame = mocc.sweep(tank, **arguments)
    more = {"mp_context": multiprocessing.get_context("spawn")} if kind is ProcessPoolExecutor else {}
    with kind(2, **more) as executor:
        spread = mocc.sweep(tank, **arguments, executor=executor)
    assert spread.to_csv() == frame.to_csv()


def test_a_run_that_fails_has_a_row(tank):
    m = mocc.compile(TANK.replace("equation", "equation\n  assert(x < x_max, \"too much\");")
                     .replace("input", "parameter Real x_max = 9; input"))
    frame = mocc.sweep(m, {"x_max": [1.0, 9.0]}, {"level": "final(x)"})
    assert frame["status"].tolist() == ["failed", "ok"]
    assert "too much" in frame["error"][0] and np.isnan(frame["level"][0])


@pytest.mark.parametrize(
    ("arguments", "text"),
    [
        ({"vary": {}}, "empty"),
        ({"vary": {"k": []}}, "no values"),
        ({"vary": {"k": (0.1, 1.0)}}, "with `sample`"),
        ({"vary": {"k": [np.nan]}}, "finite"),
        ({"vary": {"k": object()}}, "list of values"),
        ({"vary": {"q": [1.0]}}, "q"),
        ({"vary": {"k": [1.0]}, "measures": {"m": "final("}}, "m"),
        ({"vary": {"k": [1.0]}, "sample": 0}, "sample"),
        ({"vary": {"k": [1.0]}, "method": "euler"}, "method"),
    ],
)
def test_wrong_sweeps_are_one_clear_exception(tank, arguments, text):
    with pytest.raises(mocc.RequestError, match=text):
        mocc.sweep(tank, **arguments)
