"""The package is typed, and so are its stubs."""

import pytest
from conftest import ROOT


def test_types_are_strict(tmp_path):
    api = pytest.importorskip("mypy.api")
    flags = ["--strict", "--ignore-missing-imports", "--cache-dir", str(tmp_path)]
    said, wrong, status = api.run([*flags, str(ROOT / "python" / "mocc")])
    assert status == 0, said + wrong
