"""The tools of the race. Each runs a case and returns its time and its points."""

import csv
import dataclasses
import json
import pathlib
import re
import resource
import shutil
import subprocess
import sys

RUMOCA = "0.10.2"


class Failed(Exception):
    """Why a tool has no result: in a word for the table, and in a line."""

    def __init__(self, brief, why):
        lines = [line.strip() for line in why.splitlines() if line.strip()]
        super().__init__(f"{brief}: {lines[0][:300]}" if lines else brief)
        self.brief = brief


@dataclasses.dataclass(frozen=True)
class Run:
    """The processor time, s, and the points."""

    seconds: float
    points: list


def timed(command, folder, limit):
    """Runs a command; its processor time, s, and its standard output."""
    used = resource.getrusage(resource.RUSAGE_CHILDREN)
    try:
        done = subprocess.run(command, cwd=folder, capture_output=True, text=True, errors="replace", timeout=limit)
    except subprocess.TimeoutExpired:
        raise Failed("time", f"not done after {limit:.0f} s") from None
    now = resource.getrusage(resource.RUSAGE_CHILDREN)
    if done.returncode != 0:
        errors = (line for line in done.stderr.splitlines() if line.startswith("error"))
        raise Failed("refused", next(errors, done.stderr[-300:]) or f"exit status {done.returncode}")
    return now.ru_utime + now.ru_stime - used.ru_utime - used.ru_stime, done.stdout


def columns(path, x, y):
    """The points of two columns of a CSV file."""
    with open(path, encoding="utf-8", newline="") as file:
        return [(float(row[x]), float(row[y])) for row in csv.DictReader(file)]


class Tool:
    """What all tools have: a name, a version, or `None` if the tool is not here, a folder, and a limit in s."""

    name = ""
    version = None

    def __init__(self, folder, limit):
        self.folder, self.limit = folder / self.name, limit
        self.folder.mkdir(exist_ok=True)


class Mocc(Tool):
    """The program as a whole process."""

    name = "mocc"

    def __init__(self, program, *limits):
        super().__init__(*limits)
        self.program = program
        said = subprocess.run([program, "--version"], capture_output=True, text=True, check=True).stdout
        self.version = said.split()[1]

    def run(self, case):
        file, table = self.folder / "race.mo", self.folder / "race.csv"
        file.write_text(case.text, encoding="utf-8")
        table.unlink(missing_ok=True)
        words = [self.program, "sweep" if case.vary else "simulate", file, "--model", case.model]
        words += ["--stop", repr(case.stop), "--tolerance", repr(case.tolerance), "--output", table]
        words += [word for folder in {library.parent for library in case.libraries} for word in ("--lib", folder)]
        if case.vary:
            vary = case.vary
            words += ["--vary", f"{vary.name}={vary.first!r}:{vary.last!r}:{vary.count}"]
            words += ["--measure", f"last = final({case.variable})"]
            axes = (vary.name, "last")
        else:
            words += ["--interval", repr(case.stop / case.rows)]
            words += ["--variables", f"^{re.escape(case.variable)}$"]
            axes = ("time", case.variable)
        seconds, _ = timed(words, self.folder, self.limit)
        return Run(seconds, columns(table, *axes))


class Rumoca(Tool):
    """The package of PyPI, in a process of its own for each run."""

    name = "rumoca"
    version = RUMOCA

    def __init__(self, *limits):
        super().__init__(*limits)
        self.python = self.folder / "venv" / "bin" / "python"
        if not self.python.exists():
            subprocess.run([sys.executable, "-m", "venv", self.folder / "venv"], check=True)
        install = [self.python, "-m", "pip", "install", "--quiet", "--disable-pip-version-check", f"rumoca=={RUMOCA}"]
        subprocess.run(install, check=True)

    def run(self, case):
        file = self.folder / "case.json"
        values = case.vary.values() if case.vary else []
        file.write_text(json.dumps({**dataclasses.asdict(case), "values": values}, default=str), encoding="utf-8")
        script = pathlib.Path(__file__).with_name("rumoca_case.py")
        _, said = timed([self.python, script, file], self.folder, self.limit)
        answer = json.loads(said.splitlines()[-1])
        if "error" in answer:
            raise Failed("refused", answer["error"])
        return Run(answer["seconds"], answer["points"])


class OpenModelica(Tool):
    """`omc` with a script: the time of the compiler, of the C compiler and of the simulation."""

    name = "OpenModelica"

    def __init__(self, *limits):
        super().__init__(*limits)
        self.program = shutil.which("omc")
        if self.program:
            said = subprocess.run([self.program, "--version"], capture_output=True, text=True, check=True).stdout
            self.version = re.search(r"[\d.]+\d", said)[0]

    def run(self, case):
        (self.folder / "race.mo").write_text(case.text, encoding="utf-8")
        table = self.folder / f"{case.model}_res.csv"
        table.unlink(missing_ok=True)
        files = [path / "package.mo" if path.is_dir() else path for path in case.libraries]
        loads = [f'loadFile("{path}"); getErrorString();' for path in (*files, "race.mo")]
        options = f'stopTime = {case.stop!r}, numberOfIntervals = {case.rows}, tolerance = {case.tolerance!r}'
        select = f'outputFormat = "csv", variableFilter = "{re.escape(case.variable)}"'
        make = f"{'buildModel' if case.vary else 'simulate'}({case.model}, {options}, {select}); getErrorString();"
        (self.folder / "race.mos").write_text("\n".join([*loads, make]) + "\n", encoding="utf-8")
        seconds, said = timed([self.program, "race.mos"], self.folder, self.limit)
        if case.vary:
            return self.series(case, seconds)
        if not table.exists():
            errors = (line for line in said.splitlines() if "Error:" in line)
            raise Failed("refused", next(errors, said[-300:]))
        return Run(seconds, columns(table, "time", case.variable))

    def series(self, case, seconds):
        """The runs of a model that has been built, each a process."""
        program, points = self.folder / case.model, []
        if not program.exists():
            raise Failed("refused", "the model was not built")
        for value in case.vary.values():
            command = [program, f"-override={case.vary.name}={value!r}"]
            more, _ = timed(command, self.folder, self.limit)
            seconds += more
            points.append((value, columns(self.folder / f"{case.model}_res.csv", "time", case.variable)[-1][1]))
        return Run(seconds, points)
