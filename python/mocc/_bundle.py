"""What travels to other processes: the text of a model, and the folders of its libraries."""

from __future__ import annotations

import os
import re
from collections.abc import Iterable
from os import PathLike, fspath
from pathlib import Path
from typing import Any

from mocc._errors import RequestError

Folders = list[tuple[str, list[tuple[str, bytes]]]]
"""Folders by their names, each with its files by their paths in it."""

MOST = 64_000_000
"""Bytes that the folders of libraries may have together."""


def packed(folders: Iterable[str | PathLike[str]]) -> Folders:
    """The files of folders. Errors: they are too large to travel."""
    left = MOST
    out: Folders = []
    for folder in dict.fromkeys(fspath(f) for f in folders):
        files = []
        for place, subfolders, names in os.walk(folder):
            subfolders[:] = sorted(f for f in subfolders if not f.startswith("."))
            for name in sorted(names):
                path = Path(place, name)
                left -= path.stat().st_size
                if left < 0:
                    raise RequestError(
                        f"`{folder}` has more than {MOST // 1_000_000} MB, too much to send to workers; put the library"
                        " on each of them and set MODELICAPATH there"
                    )
                files.append((path.relative_to(folder).as_posix(), path.read_bytes()))
        # A folder that does not exist is an error of the compiler.
        if os.path.isdir(folder):
            out.append((folder, files))
    return out


def beside(file: str | None) -> Folders:
    """The classes in the folder of a model's file, as the compiler finds them: files and packages next to it.

    Errors: they are too large to travel.
    """
    folder = os.path.dirname(file) or "." if file is not None else ""
    if not os.path.isdir(folder) or os.path.exists(os.path.join(folder, "package.mo")):
        return []
    files: list[tuple[str, bytes]] = []
    for name in sorted(os.listdir(folder)):
        path = os.path.join(folder, name)
        if os.path.isfile(path) and name.endswith(".mo"):
            files.append((name, Path(path).read_bytes()))
        elif os.path.isfile(os.path.join(path, "package.mo")):
            for _, inside in packed([path]):
                files.extend((f"{name}/{inner}", content) for inner, content in inside)
    return [(folder, files)]


def check_travels(file: str | None, text: str | None) -> None:
    """Errors: the file is a part of a package, so that it is not a model without the files around it."""
    if file is None or text is None:
        return
    if Path(file).name == "package.mo" or re.match(r"\s*within\s+\w", text):
        raise RequestError(
            f"`{file}` is a part of a package, which does not travel to workers with it; name the folder that contains the"
            " package with `lib`, and the model with `model`"
        )


def check_executor(executor: Any) -> None:
    """Errors: it cannot be given work."""
    if executor is not None and not callable(getattr(executor, "submit", None)):
        raise RequestError(f"`executor` is a {type(executor).__name__}; give a `concurrent.futures.Executor`, or None for"
                           " threads of this process")
