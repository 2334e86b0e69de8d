"""Runs a case in rumoca, within its virtual environment: `python rumoca_case.py CASE.json`.

Prints, as JSON, the processor time, s, from the source to the result, and the points; or why there is none. The time is
the shorter one of that with an empty session and that with one which has read the libraries.
"""

import json
import pathlib
import sys
import time

import rumoca


def points(session, case):
    """The points of the variable, or its last value for each value of the parameter."""
    model = session.loads(case["text"], model=case["model"], filename="race.mo")
    config = rumoca.SimConfig(rtol=case["tolerance"], dt=case["stop"] / case["rows"])
    span, variable = (0.0, case["stop"]), case["variable"]
    if not case["vary"]:
        result = model.simulate(span, config=config)
        return list(zip(map(float, result.time), map(float, result[variable])))
    name = case["vary"]["name"]
    run = lambda value: model.simulate(span, config=config, params={name: value})
    return [(value, float(run(value)[variable][-1])) for value in case["values"]]


def timed(session, case):
    """The processor time, s, and the points."""
    begun = time.process_time()
    found = points(session, case)
    return time.process_time() - begun, found


def main():
    with open(sys.argv[1], encoding="utf-8") as file:
        case = json.load(file)
    roots = sorted({str(pathlib.Path(library).parent) for library in case["libraries"]})
    empty, informed = rumoca.Session(roots=roots), rumoca.Session(roots=roots)
    try:
        informed.loads(case["first"], model="First", filename="first.mo")
        seconds, found = min(timed(session, case) for session in (empty, informed))
    except rumoca.RumocaError as why:
        print(json.dumps({"error": str(why)}))
        return
    print(json.dumps({"seconds": seconds, "points": found}))


if __name__ == "__main__":
    main()
