"""Runs: rows, settings, inputs, events, failures."""

import csv
import os
import pickle
import signal
import subprocess
import sys
import threading
import time
from pathlib import Path

import numpy as np
import pytest
from conftest import BALL, ROOT, TANK

import mocc


def test_values_are_views_without_copies(tank):
    r = tank.simulate()
    assert r["x"].base is not None and not r["x"].flags.writeable
    assert np.shares_memory(r["x"], r["x"])
    with pytest.raises(ValueError, match="read-only"):
        r["x"][0] = 1.0
    assert np.allclose(r["x"], 2 * np.exp(-0.5 * r.time), rtol=1e-5)
    # A view outlives its result.
    x = r["x"]
    del r
    assert x[0] == 2.0


def test_a_result_is_a_mapping_of_columns(tank):
    r = tank.simulate()
    assert "x" in r and "time" in r and "z" not in r
    assert r["time"].shape == r["x"].shape == (len(r),)
    assert set(r) == set(r.keys()) and "y" in r.keys()
    assert next(c for c in r.columns if c.name == "x").unit == "m"
    with pytest.raises(KeyError, match="no variable"):
        r["velocity"]
    assert r.statistics["steps"] > 0 and r.statistics["end"] == 4.0
    assert "Tank" in repr(r) and "<svg" in r._repr_html_()


def test_settings_of_a_run_and_of_the_structure(tank):
    assert np.allclose(tank.simulate(set={"k": 2})["x"][-1], 2 * np.exp(-8), atol=1e-6)
    assert np.allclose(tank.simulate(set={"n": 4, "k": 1})["x"][-1], 2 * np.exp(-8), atol=1e-6)
    assert tank.simulate(set={"open": False})["x"][-1] == 2.0
    assert tank.simulate(set={"x_0": 3})["x"][0] == 3.0
    assert tank.simulate(1, interval=0.5).time.tolist() == [0, 0.5, 1]
    assert tank.simulate(set={"k": "0.25*2"})["x"][-1] == tank.simulate()["x"][-1]
    for method in ("radau", "bdf", "dopri"):
        assert tank.simulate(method=method, tolerance=1e-8).statistics["method"] == method


def test_results_equal_those_of_the_command_to_the_bit(valve, tmp_path):
    file = tmp_path / "valve.csv"
    command = [sys.executable, "-m", "mocc", "simulate", str(ROOT / "examples" / "valve52.mol"),
               "--output", str(file), "--set", "p_supply=3e5"]
    subprocess.run(command, check=True, capture_output=True)
    with file.open() as lines:
        names, *rows = csv.reader(lines)
    table = np.array(rows, dtype=float)
    r = valve.simulate(set={"p_supply": 3e5}, events="both")
    assert len(r) == len(table) and names[1:] == r.keys()
    for k, name in enumerate(names):
        assert (table[:, k] == r[name]).all(), name


def test_events_last_keeps_one_row_an_instant(ball):
    last, both = ball.simulate(), ball.simulate(events="both")
    assert len(both) > len(last)
    assert (np.diff(last.time) > 0).all()
    event = last.events[0]
    at = both.time == event.time
    assert at.sum() == 2 and both["v"][at][0] < 0 < both["v"][at][1]
    assert last["v"][last.time == event.time] == both["v"][at][1]
    assert "h" in event.cause and event.place.startswith("<text>:")
    assert abs(event.time - np.sqrt(2 / 9.81)) < 1e-6


# ---- Inputs ----


def test_inputs_are_functions_pairs_or_values(tank):
    constant = tank.simulate(inputs={"u": lambda t: 1.0})["x"][-1]
    assert abs(constant - 2.0) < 1e-6
    assert np.isclose(tank.simulate(inputs={"u": ([0.0, 4.0], [1.0, 1.0])})["x"][-1], 2.0)
    assert np.isclose(tank.simulate(inputs={"u": [1.0, 1.0]})["x"][-1], 2.0)
    assert np.isclose(tank.simulate(inputs={"u": 1.0})["x"][-1], 2.0)
    wave = tank.simulate(inputs={"u": np.sin})
    exact = 2.8 * np.exp(-0.5 * wave.time) + 0.4 * np.sin(wave.time) - 0.8 * np.cos(wave.time)
    assert np.allclose(wave["x"], exact, atol=1e-5)


def test_a_table_without_times_is_refused(tank):
    pandas = pytest.importorskip("pandas")
    with pytest.raises(mocc.RequestError, match="no column `time`, and its index counts rows"):
        tank.simulate(inputs=pandas.DataFrame({"u": [0.0, 1.0, 2.0]}))


def test_inputs_are_tables(tank):
    pandas = pytest.importorskip("pandas")
    t = np.linspace(0, 4, 5)
    expected = tank.simulate(inputs={"u": (t, t)})["x"]
    frame = pandas.DataFrame({"time": t, "u": t})
    for table in (frame, frame.set_index("time"), frame.set_index("time")["u"].to_frame(), {"time": t, "u": t}):
        assert (tank.simulate(inputs=table)["x"] == expected).all()
    assert (tank.simulate(inputs={"u": frame.set_index("time")["u"]})["x"] == expected).all()


SWITCHED = """
model Switched
  input Boolean on(start = false);
  input Integer level(start = 0);
  Real x(start = 0, fixed = true);
  Integer switched(start = 0, fixed = true);
equation
  der(x) = if on then 1 else level;
  when on then
    switched = pre(switched) + 1;
  end when;
end Switched;
"""


def test_boolean_and_integer_inputs_keep_their_values():
    model = mocc.compile(SWITCHED)
    assert model.inputs == ["on", "level"]
    # True in two intervals: x is their length.
    result = model.simulate(1, inputs={"on": lambda t: 0.2 < t < 0.53125 or t > 0.8})
    assert result["x"][-1] == pytest.approx(0.33125 + 0.2, abs=1e-9) and result["switched"][-1] == 2
    assert model.simulate(1, inputs={"on": ([0, 0.25, 0.5], [0, 1, 0])})["x"][-1] == pytest.approx(0.25, abs=1e-12)
    assert model.simulate(1, inputs={"on": [True]})["x"][-1] == pytest.approx(1, abs=1e-12)
    table = {"time": [0, 0.5, 0.75], "on": [False, True, False], "level": [2, 0, 4]}
    assert model.simulate(1, inputs=table)["x"][-1] == pytest.approx(2 * 0.5 + 0.25 + 4 * 0.25, abs=1e-12)
    assert model.simulate(1)["x"][-1] == 0
    with pytest.raises(mocc.RequestError, match="is 0.5 in row 1, and `level` is an Integer"):
        model.simulate(1, inputs={"level": ([0, 1], [0, 0.5])})


def test_boolean_and_integer_inputs_at_rest():
    model = mocc.compile("model Rest input Boolean on(start = false); input Integer k(start = 1); "
                         "Real x(start = 0, fixed = true); equation der(x) = (if on then 3 else 0) + k - x; end Rest;")
    assert model.steady_state(inputs={"on": True, "k": 4})["x"] == pytest.approx(7)
    assert model.steady_state()["x"] == pytest.approx(1)
    with pytest.raises(mocc.RequestError, match="`k` is an Integer, and 0.5 is none"):
        model.steady_state(inputs={"k": 0.5})


@pytest.mark.parametrize(
    ("inputs", "text"),
    [
        ({"v": 1.0}, "no input `v`"),
        ({"u": [0.0, float("nan")]}, "nan in row 1"),
        ({"u": ([0.0, 1.0], [1.0])}, "2 times and 1 values"),
        ({"u": ([1.0, 0.0], [1.0, 1.0])}, "times must increase"),
        ({"u": ([0.0, float("inf")], [1.0, 1.0])}, "inf in row 1"),
        ({"u": "high"}, "does not hold numbers"),
        ({"u": []}, "is empty"),
        ({"u": [[1.0]]}, "2 dimensions"),
        ({"u": lambda t: float("nan")}, "nan in row 0"),
        (3, "expected a table"),
        ({"u": None}, "`u` is None; leave `u` out"),
    ],
)
def test_wrong_inputs_are_one_clear_exception(tank, inputs, text):
    with pytest.raises(mocc.RequestError, match=text):
        tank.simulate(inputs=inputs)


def test_the_exception_of_a_function_is_passed_on(tank):
    def broken(t: float) -> float:
        raise LookupError("no value")

    with pytest.raises(LookupError, match="no value") as caught:
        tank.simulate(inputs={"u": broken})
    assert "input `u`" in caught.value.__notes__[0]


# ---- Failures ----


@pytest.mark.parametrize(
    ("arguments", "text"),
    [
        ({"method": "euler"}, "method"),
        ({"events": "none"}, "events"),
        ({"interpolation": "cubic"}, "interpolation"),
        ({"stop": float("nan")}, "stop"),
        ({"stop": "4"}, "stop"),
        ({"stop": -1.0}, "cannot go"),
        ({"tolerance": 2.0}, "olerance"),
        ({"set": {"kk": 1.0}}, "kk"),
        ({"set": {"k": float("inf")}}, "finite"),
    ],
)
def test_wrong_arguments_are_one_clear_exception(tank, arguments, text):
    with pytest.raises(mocc.RequestError, match=text):
        tank.simulate(**arguments)


def test_a_run_that_fails_keeps_its_rows():
    m = mocc.compile("""
        model M
          Real x(start = 1, fixed = true);
        equation
          der(x) = x;
          assert(x < 2, "too much");
        end M;
    """)
    with pytest.raises(mocc.SimulationError, match="too much") as caught:
        m.simulate()
    error = caught.value
    assert error.code == "MO0912" and abs(error.time - np.log(2)) < 1e-2
    assert error.place.startswith("<text>:6")
    assert 100 < len(error.result) < 500 and error.result["x"][0] == 1.0


def test_calls_cost_little_beside_the_engine(valve):
    """A tenth of the limit for a busy computer: 0.2 ms on an idle one."""
    calls = []
    for _ in range(30):
        begun = time.perf_counter()
        r = valve.simulate()
        calls.append(time.perf_counter() - begun - r.statistics["seconds"])
    assert sorted(calls)[10] < 2e-3


def test_ctrl_c_ends_a_run_at_once(tank):
    def press():
        time.sleep(0.3)
        os.kill(os.getpid(), signal.SIGINT)

    slow = mocc.compile("model M Real x(start=1, fixed=true); equation der(x) = 1e3*cos(1e3*time); end M;")
    thread = threading.Thread(target=press)
    thread.start()
    begun = time.monotonic()
    with pytest.raises(KeyboardInterrupt):
        slow.simulate(1e4, interval=1e3)
    assert time.monotonic() - begun < 3
    thread.join()
    # Nothing is left over.
    assert tank.simulate().statistics["end"] == 4.0


def test_threads_run_at_the_same_time(valve):
    """The interpreter lock is released: a Python thread goes on while a run computes."""
    counted = 0
    over = threading.Event()

    def count():
        nonlocal counted
        while not over.is_set():
            counted += 1
            time.sleep(1e-4)

    thread = threading.Thread(target=count)
    thread.start()
    before, begun = counted, time.monotonic()
    while time.monotonic() - begun < 0.5:
        valve.simulate()
    over.set()
    thread.join()
    assert counted - before > 100


# ---- Other libraries ----


def test_results_pickle(ball):
    r = ball.simulate()
    again = pickle.loads(pickle.dumps(r))
    assert again.keys() == r.keys() and again.events == r.events and again.statistics == r.statistics
    assert all((again[name] == r[name]).all() for name in ["time", *r])


def test_pandas(ball):
    pytest.importorskip("pandas")
    r = ball.simulate()
    frame = r.to_pandas()
    assert frame.index.name == "time" and (frame["h"].to_numpy() == r["h"]).all()
    assert frame.attrs["units"]["h"] == "m"


def test_arrow(ball):
    pyarrow = pytest.importorskip("pyarrow")
    r = ball.simulate()
    table = pyarrow.table(r)
    assert table.column_names == ["time", *r.keys()]
    assert (table["h"].to_numpy() == r["h"]).all()
    assert table["h"].chunk(0).buffers()[1].address == r["h"].ctypes.data
    assert table.schema.field("h").metadata == {b"unit": b"m", b"description": b"Height"}
    # The table keeps the memory.
    expected = r["h"].copy()
    del r
    assert (table["h"].to_numpy() == expected).all()
    # A stream that nobody reads is freed.
    ball.simulate().__arrow_c_stream__()


def test_polars(ball):
    polars = pytest.importorskip("polars")
    r = ball.simulate()
    assert (polars.DataFrame(r)["h"].to_numpy() == r["h"]).all()


def test_xarray(ball):
    pytest.importorskip("xarray")
    data = ball.simulate().to_xarray()
    assert data["h"].attrs == {"units": "m", "long_name": "Height"}
    assert abs(float(data["h"].interp(time=0.1)) - (1 - 0.5 * 9.81 * 0.01)) < 1e-3


def test_pictures(valve, tmp_path):
    r = valve.simulate()
    figure = r.plot("s", "p12", title="Valve", events=True)
    assert figure.svg.startswith("<") and "Valve" in figure._repr_svg_()
    for name in ("a.svg", "a.png"):
        figure.save(tmp_path / name)
        assert (tmp_path / name).stat().st_size > 1000
    with pytest.raises(mocc.RequestError, match="ends in .svg or .png"):
        figure.save(tmp_path / "a.pdf")
    with pytest.raises(mocc.RequestError, match="did you mean"):
        r.plot("p21")


def test_lines_that_a_model_prints(capsys):
    m = mocc.compile("""
        function print
          input String text;
          input String file = "";
          external "C" ModelicaInternal_print(text, file);
        end print;
        model M
          Real x = time;
        equation
          when x > 0.5 then
            print("half");
          end when;
        end M;
    """)
    m.simulate()
    assert capsys.readouterr().out == "half\n"


# ---- The command ----


def test_the_command_is_the_same_program(tmp_path):
    def run(*arguments: str) -> subprocess.CompletedProcess[str]:
        return subprocess.run([sys.executable, "-m", "mocc", *arguments], cwd=tmp_path, capture_output=True, text=True)

    assert run("--version").stdout.strip() == f"mocc {mocc.__version__}"
    assert run("simulate", "--help").returncode == 0
    assert run("simulate", "--helpp").returncode == 2
    (tmp_path / "ball.mol").write_text(BALL)
    done = run("simulate", "ball.mol")
    assert done.returncode == 0 and (tmp_path / "ball.csv").exists(), done.stderr
    (tmp_path / "wrong.mol").write_text(TANK.replace("k*", "kk*"))
    done = run("simulate", "wrong.mol")
    assert done.returncode == 1 and "MO02" in done.stderr
    assert Path(mocc.__file__).with_name("py.typed").exists()
