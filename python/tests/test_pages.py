"""The code of the pages runs, and every public name is documented and tested."""

import inspect
import re
import warnings

import pytest
from conftest import ROOT

import mocc


@pytest.mark.parametrize("page", ["README.md", "docs/python.md"])
def test_the_code_of_a_page_runs(page, tmp_path, monkeypatch):
    pytest.importorskip("pandas")
    pytest.importorskip("scipy")
    for folder in ("examples", "docs", "tests"):
        (tmp_path / folder).symlink_to(ROOT / folder)
    monkeypatch.chdir(tmp_path)
    code = re.findall(r"^```python\n(.*?)^```", (ROOT / page).read_text(encoding="utf-8"), re.M | re.S)
    names: dict[str, object] = {}
    with warnings.catch_warnings():
        warnings.simplefilter("error")
        for block in code:
            exec(compile(block, page, "exec"), names)
    assert code and names["d"].verdict == "effect_found"


def public():
    for name in mocc.__all__:
        thing = getattr(mocc, name)
        yield name, thing
        if inspect.isclass(thing):
            yield from ((f"{name}.{k}", v) for k, v in vars(thing).items() if not k.startswith("_"))


def test_everything_public_has_a_description():
    for name, thing in public():
        if callable(thing) or isinstance(thing, property):
            assert inspect.getdoc(thing), name


def test_everything_public_is_tested():
    tests = "".join(file.read_text(encoding="utf-8") for file in (ROOT / "python" / "tests").glob("*.py"))
    missing = [name for name, thing in public() if not re.search(rf"\b{name.split('.')[-1]}\b", tests)]
    assert not missing
