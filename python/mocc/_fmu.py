"""Functional Mock-up Units."""

from __future__ import annotations

import os
import subprocess
import sys
import tempfile
from collections.abc import Iterable, Mapping
from os import PathLike, fspath
from pathlib import Path
from typing import Any

from mocc._errors import Error, ModelError, RequestError
from mocc._model import Model, _expression, settings_of, source_of

_RUNTIME = Path(__file__).with_name("libmocc_fmu.so")


def offer_runtime() -> None:
    """Tells the command where the package keeps the library that runs exported models."""
    if _RUNTIME.exists():
        os.environ.setdefault("MOCC_FMU_RUNTIME", str(_RUNTIME))


def export_fmu(
    path_or_text: str | PathLike[str] | None,
    output: str | PathLike[str],
    model: str | None = None,
    set: Mapping[str, Any] | None = None,
    lib: Iterable[str | PathLike[str]] = (),
    fmi: int = 3,
    type: str = "both",
    runtime: str | PathLike[str] | None = None,
    with_source: bool = False,
) -> Path:
    """Writes a model as a Functional Mock-up Unit; the path of the file.

    `path_or_text`, `model`, `set` and `lib` are those of `compile`. `fmi` is 2 or 3. `type` is `"me"` for Model Exchange,
    `"cs"` for Co-Simulation, or `"both"`. `runtime` is the shared library that runs the model, by default the one of this
    package. `with_source` adds the source files of the model.

    Errors: `ModelError` if the model is wrong, `RequestError` if a file, a model or the runtime does not exist.
    """
    if fmi not in (2, 3):
        raise RequestError(f"fmi is {fmi!r}, not 2 or 3")
    if type not in ("me", "cs", "both"):
        raise RequestError(f"type is {type!r}, not 'me', 'cs' or 'both'")
    offer_runtime()
    if isinstance(path_or_text, Model):
        raise RequestError("`export_fmu` takes the file or the text of a model, not a compiled one; `set` sets its parameters")
    file, text = source_of(path_or_text)
    with tempfile.TemporaryDirectory() as folder:
        if text is not None:
            file = str(Path(folder, "model.mo"))
            Path(file).write_text(text, encoding="utf-8")
        arguments = ["export", "fmu", *([] if file is None else [file])]
        arguments += [] if model is None else ["--model", model]
        for name, value in settings_of(set or {}):
            arguments += ["--set", _expression(name, value)]
        for one in [lib] if isinstance(lib, (str, PathLike)) else lib:
            arguments += ["--lib", fspath(one)]
        arguments += ["--fmi", str(fmi), "--type", type, "--output", fspath(output)]
        arguments += [] if runtime is None else ["--runtime", fspath(runtime)]
        arguments += ["--with-source"] if with_source else []
        done = subprocess.run([sys.executable, "-m", "mocc", *arguments], capture_output=True, text=True)
    if done.returncode:
        kind = {1: ModelError, 2: RequestError}.get(done.returncode, Error)
        raise kind(done.stderr.strip() or "the export failed")
    return Path(output)
