"""Measures what the package and its executors cost: `python python/benches/cluster.py [case-c]`.

Prints the overhead of a call, a loop in Python compared with a sweep, and the efficiency of two workers of a cluster over
one; and compares tables with those of one process. With `case-c` it also diagnoses the recordings of that specimen here and
on the cluster, which takes some minutes, and compares the results.
"""

import json
import os
import statistics
import sys
import time
from pathlib import Path

import numpy as np

import mocc

ROOT = Path(__file__).parents[2]
MEASURES = {"t_switch": "when(s > 0.95*s_max)", "v_mean": "mean(v)"}


def timed(work):
    begun = time.perf_counter()
    found = work()
    return time.perf_counter() - begun, found


def calls(m: mocc.Model) -> None:
    """The overhead of a call, and of a loop of calls."""
    for _ in range(8):
        m.simulate(set={"p_supply": 5e5})
    differences = []
    for k in range(200):
        seconds, r = timed(lambda p=4e5 + k: m.simulate(set={"p_supply": p}))
        differences.append(seconds - r.statistics["seconds"])
    tenth, half = statistics.quantiles(differences, n=10)[0], statistics.median(differences)
    print(f"overhead of a call: {1e3 * half:.3f} ms, a tenth of the calls {1e3 * tenth:.3f} ms or less")

    points = np.linspace(3e5, 8e5, 1000)

    def loop():
        return [m.simulate(set={"p_supply": p})["s"].max() for p in points.tolist()]

    def sweep():
        return mocc.sweep(m, {"p_supply": points}, {"s_top": "max(s)"}, jobs=1)

    ratios = [timed(loop)[0] / timed(sweep)[0] for _ in range(3)]
    print(f"1000 runs in a loop: {min(ratios):.2f} times a sweep on one thread")


def clusters(m: mocc.Model, count: int = 2000) -> None:
    """The efficiency of two workers over one."""
    from distributed import Client, LocalCluster

    keys = {"vary": {"p_supply": (3e5, 8e5), "m": (0.02, 0.04)}, "measures": MEASURES, "sample": count}
    seconds, here = timed(lambda: mocc.sweep(m, jobs=1, **keys))
    print(f"{count} runs in one process: {seconds:.2f} s, {count / seconds:.0f} a second")
    took, used = {}, {}
    for workers in (1, 2):
        with LocalCluster(n_workers=workers, threads_per_worker=1, dashboard_address=None) as cluster, \
                Client(cluster) as client:
            client.wait_for_workers(workers)
            executor = client.get_executor()
            mocc.sweep(m, executor=executor, **{**keys, "sample": 40})
            before = client.run(os.times)
            took[workers], table = timed(lambda: mocc.sweep(m, executor=executor, **keys))
            after = client.run(os.times)
            each = [sum(a[:2]) - sum(b[:2]) for a, b in zip(after.values(), before.values(), strict=True)]
            used[workers] = each
            assert table.to_csv() == here.to_csv()
            shown = ", ".join(f"{seconds:.2f}" for seconds in each)
            print(f"{count} runs on {workers} worker(s): {took[workers]:.2f} s, processor time of each {shown} s")
    print(f"efficiency of two workers: {took[1] / (2 * took[2]):.2f} by the clock")
    # Without the time in which a worker waits for a processor that other work has.
    print(f"efficiency of two workers: {sum(used[2]) / (2 * max(used[2])):.2f} by their processor times")


def case_c() -> None:
    """The diagnosis of a specimen, here and on a cluster."""
    from distributed import Client, LocalCluster

    os.chdir(ROOT)
    keys = {"folder": "tests/data/teststand/case-c"}
    seconds, here = timed(lambda: mocc.diagnose("examples/valve52.toml", **keys))
    print(f"case-c here: {seconds:.0f} s, {here.verdict}")
    with LocalCluster(n_workers=2, threads_per_worker=1, dashboard_address=None) as cluster, Client(cluster) as client:
        seconds, there = timed(lambda: mocc.diagnose("examples/valve52.toml", executor=client.get_executor(), **keys))
    print(f"case-c on two workers: {seconds:.0f} s, {there.verdict}")

    def facts(d):
        return json.dumps({**d.result, "seconds": 0}, sort_keys=True)

    print("diagnosis.json is the same" if facts(here) == facts(there) else "diagnosis.json differs")


if __name__ == "__main__":
    model = mocc.compile(ROOT / "examples" / "valve52.mol")
    if "case-c" in sys.argv:
        case_c()
    else:
        calls(model)
        clusters(model)
