"""The notebooks that teach run from top to bottom, and are committed without their outputs."""

import json

import pytest
from conftest import ROOT

NOTEBOOKS = sorted((ROOT / "examples" / "notebooks").glob("*.ipynb"))


def test_there_are_notebooks_without_outputs():
    assert len(NOTEBOOKS) == 6
    index = (ROOT / "examples" / "notebooks" / "README.md").read_text(encoding="utf-8")
    for path in NOTEBOOKS:
        assert path.name in index
        cells = json.loads(path.read_text(encoding="utf-8"))["cells"]
        assert all(not cell.get("outputs") and not cell.get("execution_count") for cell in cells), path.name


@pytest.mark.parametrize("path", NOTEBOOKS, ids=lambda path: path.stem)
def test_a_notebook_runs(path, tmp_path, monkeypatch):
    for needed in ("nbclient", "nbformat", "ipykernel", "pandas", "scipy", "matplotlib", "jinja2"):
        pytest.importorskip(needed)
    import nbformat
    from ipykernel.kernelspec import install
    from nbclient import NotebookClient

    monkeypatch.setenv("JUPYTER_PATH", str(tmp_path / "share" / "jupyter"))
    # The kernel of this environment, whatever others are installed.
    install(prefix=str(tmp_path), kernel_name="this")
    # Files that a notebook writes go to a copy of the folders that it reads.
    work = tmp_path / "examples" / "notebooks"
    work.mkdir(parents=True)
    for folder in (ROOT / "examples").iterdir():
        if folder.name != "notebooks":
            (tmp_path / "examples" / folder.name).symlink_to(folder)
    (tmp_path / "docs").symlink_to(ROOT / "docs")
    notebook = nbformat.read(path, as_version=4)
    notebook.metadata.kernelspec = {"name": "this", "display_name": "this", "language": "python"}
    client = NotebookClient(notebook, timeout=600, resources={"metadata": {"path": str(work)}})
    client.execute()
    shown = [output for cell in notebook.cells for output in cell.get("outputs", [])]
    assert shown and all(output.output_type != "error" for output in shown)
