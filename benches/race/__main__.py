"""A race: the same sources in mocc, in rumoca and, where `omc` is found, in OpenModelica.

    python3 benches/race --mocc target/release/mocc --lib MSL

MSL is the folder that contains the Modelica Standard Library 4.1.0; without it, its examples are left out. rumoca
comes from PyPI into a virtual environment, which is made once, beside the results (`--folder`).

Each cell is the processor time of the fastest of several rounds, in s. It counts only if the result agrees with
mocc's; a tool that does not get there has the reason instead, and the reasons in full follow the table. mocc and
OpenModelica are timed as whole processes that write their rows to a file; rumoca from the source to the arrays in memory,
without the start of Python, and without reading the libraries where that is the faster way.
"""

import argparse
import datetime
import pathlib
import platform

from cases import cases
from compare import deviation
from tools import Failed, Mocc, OpenModelica, Rumoca

# Greatest deviation of two tools, in shares of the range of the variable.
AGREE = 1e-2


def cell(tool, case, rounds, expected, notes):
    """The time of a tool as text, and its points; a reason goes to the notes."""
    try:
        runs = [tool.run(case) for _ in range(rounds)]
    except Failed as why:
        notes.append(f"{case.name}, {tool.name}: {why}")
        return why.brief, None
    seconds, points = min(run.seconds for run in runs), runs[0].points
    apart = deviation(expected, points) if expected else 0.0
    if apart > AGREE:
        notes.append(f"{case.name}, {tool.name}: deviates from mocc by {apart:.1e} of the range, after {seconds:.3g} s")
        return "deviates", points
    return f"{seconds:.3f}" + (f" ({apart:.0e})" if expected else ""), points


def main():
    parser = argparse.ArgumentParser(description=__doc__, formatter_class=argparse.RawDescriptionHelpFormatter)
    parser.add_argument("--mocc", required=True, type=pathlib.Path, help="the program")
    parser.add_argument("--lib", type=pathlib.Path, help="folder that contains the Modelica Standard Library")
    parser.add_argument("--folder", type=pathlib.Path, default="target/race", help="folder of results")
    parser.add_argument("--rounds", type=int, default=3, help="runs of each cell, of which the fastest counts")
    parser.add_argument("--seconds", type=float, default=120, help="limit of a run")
    parser.add_argument("--only", default="", help="only cases whose name contains this text")
    args = parser.parse_args()
    args.folder.mkdir(parents=True, exist_ok=True)
    limits = (args.folder.resolve(), args.seconds)
    tools = [Mocc(args.mocc.resolve(), *limits), Rumoca(*limits), OpenModelica(*limits)]
    tools = [tool for tool in tools if tool.version]
    print(f"{datetime.date.today()}, {platform.machine()}, {platform.system()}; processor time, s; in parentheses, the deviation")
    print(f"\n| case | {' | '.join(f'{tool.name} {tool.version}' for tool in tools)} |\n|{'---|' * (len(tools) + 1)}")
    notes = []
    for case in cases(args.lib and args.lib.resolve()):
        if args.only not in case.name:
            continue
        expected, row = None, []
        for tool in tools:
            text, points = cell(tool, case, args.rounds, expected, notes)
            expected = expected or points
            row.append(text)
        print(f"| {case.name} | {' | '.join(row)} |", flush=True)
    print("\n" + "\n".join(f"- {note}" for note in notes))


if __name__ == "__main__":
    main()
