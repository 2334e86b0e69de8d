"""Work on executors: the same tables and results, whoever computes them and whoever dies."""

import os
import shutil
import signal
import subprocess
import sys
import threading
import time
from concurrent.futures import ProcessPoolExecutor, ThreadPoolExecutor
from pathlib import Path

import numpy as np
import pytest
from conftest import PLAN, ROOT, TANK, recording

import mocc
from mocc import _cluster

pandas = pytest.importorskip("pandas")

VARY = {"k": np.linspace(0.1, 2, 120), "x_0": [1.0, 2.0, 3.0]}
MEASURES = {"half": "when(x < 1)", "last": "final(y)"}


@pytest.fixture(scope="module")
def table(tank) -> "pandas.DataFrame":
    return mocc.sweep(tank, VARY, MEASURES, jobs=1)


@pytest.fixture(scope="module")
def cluster():
    distributed = pytest.importorskip("distributed")
    settings = {"n_workers": 2, "threads_per_worker": 1, "processes": True, "dashboard_address": None}
    with distributed.LocalCluster(**settings) as made, distributed.Client(made) as client:
        yield made, client


# ---- Any executor ----


@pytest.mark.parametrize("pool", [ThreadPoolExecutor, ProcessPoolExecutor, "loky"])
def test_any_executor_makes_the_same_table(tank, table, pool):
    if pool == "loky":
        loky = pytest.importorskip("loky")
        executor = loky.get_reusable_executor(max_workers=2)
        assert mocc.sweep(tank, VARY, MEASURES, executor=executor).equals(table)
        executor.shutdown()
        return
    with pool(2) as executor:
        assert mocc.sweep(tank, VARY, MEASURES, executor=executor).equals(table)


def test_mpi_makes_the_same_table(table, tmp_path):
    pytest.importorskip("mpi4py")
    start = shutil.which("mpiexec", path=os.path.dirname(sys.executable) + os.pathsep + os.environ.get("PATH", ""))
    if start is None:
        pytest.skip("mpi4py without an MPI")
    script = tmp_path / "script.py"
    script.write_text(f"""
import sys
sys.path.insert(0, {str(ROOT / "python" / "tests")!r})
from mpi4py.futures import MPIPoolExecutor
import mocc
from conftest import TANK
from test_cluster import MEASURES, VARY
if __name__ == "__main__":
    with MPIPoolExecutor() as executor:
        mocc.sweep(mocc.compile(TANK), VARY, MEASURES, executor=executor).to_csv({str(tmp_path / "table.csv")!r})
""")
    command = [start, "-n", "3", sys.executable, "-m", "mpi4py.futures", str(script)]
    ended = subprocess.run(command, capture_output=True, text=True, timeout=300)
    assert ended.returncode == 0, ended.stderr
    assert (tmp_path / "table.csv").read_text() == table.to_csv()


def test_libraries_travel_with_the_model(tmp_path):
    folder = tmp_path / "lib" / "Pipes"
    folder.mkdir(parents=True)
    (folder / "package.mo").write_text("package Pipes\nend Pipes;\n")
    (folder / "Tank.mo").write_text(TANK.replace("\nmodel Tank", "within Pipes;\nmodel Tank"))
    model = mocc.compile(model="Pipes.Tank", lib=[tmp_path / "lib"])
    here = mocc.sweep(model, {"k": [0.5, 1.0]}, MEASURES)
    elsewhere = tmp_path / "elsewhere"
    elsewhere.mkdir()
    with ProcessPoolExecutor(1, initializer=os.chdir, initargs=(elsewhere,)) as executor:
        (folder / "Tank.mo").rename(tmp_path / "Tank.mo")
        with pytest.raises(mocc.Error):
            mocc.sweep(model, {"k": [0.5, 1.0]}, MEASURES, executor=executor)
        (tmp_path / "Tank.mo").rename(folder / "Tank.mo")
        assert mocc.sweep(model, {"k": [0.5, 1.0]}, MEASURES, executor=executor).equals(here)
    part = mocc.compile(folder / "Tank.mo")
    with ThreadPoolExecutor(1) as executor, pytest.raises(mocc.RequestError, match="part of a package"):
        mocc.sweep(part, {"k": [0.5, 1.0]}, executor=executor)


def test_classes_next_to_the_model_travel(tmp_path, monkeypatch):
    """A worker in another folder has the classes in the files next to the model."""
    monkeypatch.chdir(tmp_path)
    Path("Tank.mo").write_text(TANK)
    Path("Parts").mkdir()
    Path("Parts", "package.mo").write_text("package Parts constant Real one = 1; end Parts;\n")
    Path("main.mo").write_text("model Main\n  extends Tank(k = 0.5*Parts.one);\nend Main;\n")
    model = mocc.compile("main.mo")
    here = mocc.sweep(model, {"k": [0.5, 1.0]}, MEASURES)
    elsewhere = tmp_path / "elsewhere"
    elsewhere.mkdir()
    with ProcessPoolExecutor(1, initializer=os.chdir, initargs=(elsewhere,)) as executor:
        assert mocc.sweep(model, {"k": [0.5, 1.0]}, MEASURES, executor=executor).equals(here)


def test_a_model_that_fails_in_a_worker_has_rows_and_errors(tank):
    model = mocc.compile(TANK.replace("equation", "equation\n  assert(k < 1, \"too fast\");"))
    with ProcessPoolExecutor(1) as executor:
        frame = mocc.sweep(model, {"k": [0.5, 2.0]}, executor=executor)
        assert frame["status"].tolist() == ["ok", "failed"] and "too fast" in frame["error"][1]
        with pytest.raises(mocc.RequestError, match="nothing"):
            mocc.sweep(tank, {"nothing": [1.0]}, executor=executor)


def test_a_worker_that_breaks_its_pool_is_one_clear_exception(tank, monkeypatch):
    with ProcessPoolExecutor(1) as executor:
        worker = executor.submit(os.getpid).result()
        os.kill(worker, signal.SIGKILL)
        with pytest.raises(mocc.RequestError, match="worker has died"):
            mocc.sweep(tank, VARY, executor=executor)


def test_workers_of_other_versions_and_machines_are_refused(tank, monkeypatch):
    with ThreadPoolExecutor(1) as executor:
        real = _cluster.work
        monkeypatch.setattr(_cluster, "work", lambda version, *rest: real("0.0.1", *rest))
        with pytest.raises(mocc.RequestError, match="the client has 0.0.1; install one version"):
            mocc.sweep(tank, VARY, executor=executor)
        monkeypatch.setattr(_cluster, "work", lambda version, arithmetic, *rest: real(version, 7, *rest))
        with pytest.raises(mocc.RequestError, match="round differently"):
            mocc.sweep(tank, VARY, executor=executor)


def test_a_task_whose_workers_die_is_done_again_and_given_up_in_the_end(tank, table, monkeypatch):
    class KilledWorker(Exception):
        """As Dask raises it."""

    real, deaths = _cluster.work, []

    def dies(most: int):
        def work(*arguments):
            if len(deaths) < most and arguments[4] == "lines":
                deaths.append(1)
                raise KilledWorker
            return real(*arguments)

        return work

    with ThreadPoolExecutor(2) as executor:
        monkeypatch.setattr(_cluster, "work", dies(6))
        assert mocc.sweep(tank, VARY, MEASURES, executor=executor).equals(table) and len(deaths) == 6
        monkeypatch.setattr(_cluster, "work", dies(10_000))
        with pytest.raises(mocc.RequestError, match="died each time"):
            mocc.sweep(tank, VARY, MEASURES, executor=executor)


# ---- Journals and progress ----


def test_a_journal_survives_the_client(tank, table, tmp_path):
    journal = tmp_path / "sweep.journal"
    code = f"""
import os, sys
sys.path.insert(0, {str(ROOT / "python" / "tests")!r})
import mocc
from conftest import TANK
from test_cluster import MEASURES, VARY
def die(done, count):
    if done > 100:
        os.kill(os.getpid(), 9)
mocc.sweep(mocc.compile(TANK), VARY, MEASURES, journal={str(journal)!r}, progress=die, jobs=1)
"""
    ended = subprocess.run([sys.executable, "-c", code], capture_output=True, text=True, timeout=120)
    assert ended.returncode == -signal.SIGKILL, ended.stderr
    lines = len(journal.read_text().splitlines()) - 1
    assert 100 < lines <= len(table)
    seen = []
    again = mocc.sweep(tank, VARY, MEASURES, journal=journal, progress=lambda done, count: seen.append((done, count)))
    assert again.equals(table) and not journal.exists()
    assert seen == [] or seen[0][0] > lines
    assert all(count == len(table) for _, count in seen)


def test_journals_of_other_sweeps_and_machines_are_refused(tank, tmp_path):
    journal = tmp_path / "sweep.journal"
    mocc.sweep(tank, {"k": [1.0]}, journal=journal)
    journal.write_text("mocc journal 2 0000000000000001 0000000000000002\n")
    with pytest.raises(mocc.RequestError, match="another sweep"):
        mocc.sweep(tank, {"k": [1.0]}, journal=journal)


def test_progress_is_a_bar_or_a_function(tank, capsys):
    assert len(mocc.sweep(tank, {"k": [1.0, 2.0]}, progress=True)) == 2
    lines: list[str] = []
    mocc.calibrate(PLAN, {"one": recording(0.8, 1)}, progress=lines.append)
    mocc.calibrate(PLAN, {"one": recording(0.8, 1)}, progress=True)
    assert lines
    pytest.importorskip("tqdm")
    assert "2/2" in capsys.readouterr().err


# ---- Calibration and diagnosis ----


def test_calibrations_are_the_same_with_workers():
    data = {"one": recording(0.8, 1), "two": recording(0.8, 2), "three": recording(0.8, 3)}
    here = mocc.calibrate(PLAN, data)
    with ProcessPoolExecutor(2) as executor:
        there = mocc.calibrate(PLAN, data, executor=executor)
    assert there.values == here.values and (there.covariance == here.covariance).all()
    same = dict(here.result, seconds=0)
    assert dict(there.result, seconds=0) == same
    # The executor has ended; what is asked later is computed here.
    assert (there.residuals({"k": 0.7}) == here.residuals({"k": 0.7})).all()


def test_files_of_a_study_travel(tmp_path):
    folder = ROOT / "docs" / "tutorial"
    here = mocc.calibrate(folder / "plan.toml", profiles=False)
    with ProcessPoolExecutor(1, initializer=os.chdir, initargs=(tmp_path,)) as executor:
        there = mocc.calibrate(folder / "plan.toml", profiles=False, executor=executor)
    assert there.values == here.values


def test_the_best_of_several_starts_counts():
    model = """
        model Wave
          parameter Real w(unit = "1/s") = 1;
          Real x(unit = "m") = sin(w*time);
          annotation(experiment(StopTime = 4));
        end Wave;
    """
    t = np.linspace(0, 4, 81)
    frame = pandas.DataFrame({"t": t, "x": np.sin(7 * t) + np.random.default_rng(1).normal(0, 0.01, t.size)})
    plan = {
        "model": model,
        "time": {"column": "t", "unit": "s"},
        "signals": {"x": {"variable": "x", "unit": "m", "sigma": 0.01}},
        "free": {"w": {"min": 0.5, "max": 20}},
    }
    best = mocc.calibrate(plan, {"wave": frame}, starts=24)
    assert best.values["w"] == pytest.approx(7, abs=0.01)
    with ThreadPoolExecutor(2) as executor:
        assert mocc.calibrate(plan, {"wave": frame}, starts=24, executor=executor).values == best.values
    with pytest.raises(mocc.RequestError, match="`min` and `max`"):
        mocc.calibrate({**plan, "free": {"w": {}}}, {"wave": frame}, starts=2)
    with pytest.raises(mocc.RequestError, match="number of fits"):
        mocc.calibrate(plan, {"wave": frame}, starts=0)


def test_what_a_worker_raises_ends_a_calibration(monkeypatch):
    def broken(*_):
        raise OSError("the disk is full")

    monkeypatch.setattr(_cluster, "work", broken)
    with ThreadPoolExecutor(1) as executor, pytest.raises(OSError, match="disk is full"):
        mocc.calibrate(PLAN, {"one": recording(0.8, 1)}, executor=executor)


# ---- Dask ----


def test_a_cluster_makes_the_same_table_though_workers_die(cluster, tank):
    made, client = cluster
    vary = {"k": np.linspace(0.1, 2, 400), "x_0": [1.0, 2.0, 3.0, 4.0, 5.0]}
    keys = {"tolerance": 1e-10}
    here = mocc.sweep(tank, vary, MEASURES, **keys)
    is_killed = threading.Event()

    def change(done: int, count: int) -> None:
        # Once in the middle: one dies, one more comes.
        if done > count / 4 and not is_killed.is_set():
            is_killed.set()
            worker = next(iter(client.run(os.getpid).values()))
            os.kill(worker, signal.SIGKILL)
            made.scale(3)

    with client.get_executor() as executor:
        there = mocc.sweep(tank, vary, MEASURES, executor=executor, progress=change, **keys)
    assert is_killed.is_set() and there.equals(here)
    assert there.to_csv() == here.to_csv()


def test_dask_workers_of_another_version_are_refused(cluster, tank):
    _, client = cluster
    client.wait_for_workers(2)

    def downgrade(version: str) -> None:
        from mocc import _cluster

        _cluster.VERSION = version

    client.run(downgrade, "0.0.9")
    try:
        with client.get_executor() as executor, pytest.raises(mocc.RequestError, match="has mocc 0.0.9, the client has"):
            mocc.sweep(tank, VARY, MEASURES, executor=executor)
    finally:
        client.run(downgrade, _cluster.VERSION)


def test_the_command_uses_a_cluster(cluster, tmp_path):
    made, _ = cluster
    (tmp_path / "tank.mo").write_text(TANK)
    shown = ["sweep", "tank.mo", "--vary", "k=0.1:2:40", "--measure", "last = final(y)", "--output"]

    def run(*more: str) -> "subprocess.CompletedProcess[str]":
        command = [sys.executable, "-m", "mocc", *shown, *more]
        return subprocess.run(command, cwd=tmp_path, capture_output=True, text=True, timeout=120)

    assert run("here.csv").returncode == 0
    ended = run("there.csv", "--cluster", made.scheduler_address)
    assert ended.returncode == 0 and "of a cluster" in ended.stdout, ended.stderr
    assert (tmp_path / "there.csv").read_bytes() == (tmp_path / "here.csv").read_bytes()
    nowhere = run("nowhere.csv", "--cluster", "tcp://127.0.0.1:9")
    assert nowhere.returncode == 2 and "no cluster answers" in nowhere.stderr
    traces = run("traces", "--traces", "--cluster", made.scheduler_address)
    assert traces.returncode == 2 and "--shard" in traces.stderr


def test_ctrl_c_ends_a_sweep_on_workers(tank):
    def interrupt() -> None:
        time.sleep(0.5)
        os.kill(os.getpid(), signal.SIGINT)

    with ThreadPoolExecutor(2) as executor:
        threading.Thread(target=interrupt).start()
        begun = time.monotonic()
        with pytest.raises(KeyboardInterrupt):
            mocc.sweep(tank, {"k": np.linspace(0.1, 2, 200_000)}, tolerance=1e-10, executor=executor)
        assert time.monotonic() - begun < 10
