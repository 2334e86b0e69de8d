"""Builds the package by maturin, with the library that runs exported FMUs in it.

In: what PEP 517 passes. Out: maturin's wheels and archives. The library is a crate of its own, `mocc-fmu`, of which maturin
knows nothing: it is built first, with the same profile, so that both share all that they depend on, and lies in the
package as `mocc/libmocc_fmu.so` while maturin packs it.
"""

from __future__ import annotations

import argparse
import json
import os
import shutil
import subprocess
import sys
import tomllib
from collections.abc import Iterator, Mapping
from contextlib import contextmanager
from pathlib import Path
from typing import Any

import maturin

build_sdist = maturin.build_sdist
get_requires_for_build_editable = maturin.get_requires_for_build_editable
get_requires_for_build_sdist = maturin.get_requires_for_build_sdist
get_requires_for_build_wheel = maturin.get_requires_for_build_wheel
prepare_metadata_for_build_editable = maturin.prepare_metadata_for_build_editable
prepare_metadata_for_build_wheel = maturin.prepare_metadata_for_build_wheel

PLACE = Path("mocc/libmocc_fmu.so")
"""Where the package looks for the library."""

Settings = Mapping[str, Any] | None


def build_wheel(folder: str, config_settings: Settings = None, metadata_directory: str | None = None) -> str:
    """Writes a wheel to `folder`; its name."""
    with _runtime(config_settings):
        return maturin.build_wheel(folder, config_settings, metadata_directory)


def build_editable(folder: str, config_settings: Settings = None, metadata_directory: str | None = None) -> str:
    """Writes a wheel that points here; its name. The library stays here, too."""
    with _runtime(config_settings, stays=True):
        return maturin.build_editable(folder, config_settings, metadata_directory)


@contextmanager
def _runtime(config_settings: Settings, stays: bool = False) -> Iterator[None]:
    """The library in its place, which is empty afterwards unless it stays."""
    built = _built(maturin.get_maturin_pep517_args(config_settings))
    try:
        shutil.copy2(built, PLACE)
        yield
    finally:
        if not stays:
            PLACE.unlink(missing_ok=True)


def _built(arguments: list[str]) -> Path:
    """Builds the library as maturin will build the module; its path."""
    with open("pyproject.toml", "rb") as file:
        own = tomllib.load(file)["tool"]["maturin"]
    known = argparse.ArgumentParser(add_help=False, allow_abbrev=False)
    known.add_argument("--profile", default=own["profile"])
    known.add_argument("--target")
    for switch in ("--locked", "--offline", "--frozen"):
        known.add_argument(switch, action="append_const", dest="switches", const=switch, default=[])
    known.add_argument("--release", "-r", action="store_const", dest="profile", const="release")
    given, _ = known.parse_known_args(arguments)
    command = ["cargo", "build", "--manifest-path", own.get("manifest-path", "Cargo.toml"), "--package", "mocc-fmu"]
    # A dependency has the features that all chosen packages ask for. Without the module among them, mocc itself would be
    # compiled a second time for it. On a Mac only maturin knows how to link the module.
    command += [] if sys.platform == "darwin" else ["--package", "mocc-python"]
    command += ["--profile", given.profile, "--message-format", "json-render-diagnostics", *given.switches]
    command += [] if given.target is None else ["--target", given.target]
    print("Running `{}`".format(" ".join(command)), flush=True)
    python = {"PYO3_PYTHON": sys.executable, "PYO3_BUILD_EXTENSION_MODULE": "1"}
    done = subprocess.run(command, env={**os.environ, **python}, stdout=subprocess.PIPE, text=True, check=True)
    messages = map(json.loads, filter(None, done.stdout.splitlines()))
    made = [path for m in messages if m.get("target", {}).get("name") == "mocc_fmu" for path in m.get("filenames", [])]
    return Path(made[-1])
